//! The experiment of the paper on position, velocity and time, on the example's recording: what it shows is so.

#![allow(clippy::float_cmp, reason = "what is kept is kept to the last bit")]
#![allow(clippy::unwrap_used, dead_code, reason = "a test may fail by panicking; the example uses the rest")]

#[path = "../examples/05_pvt/recording.rs"]
mod recording;

use planner::{
    AxisKind, Limits, PvtAxisSpec, PvtInterpolation, PvtPolicy, PvtRequest, PvtRequestSpec, Quantity, State,
    certify, plan_pvt,
};

#[test]
fn the_recording_is_what_its_seed_makes() {
    assert_eq!(recording::table().unwrap(), include_str!("../examples/05_pvt/recording.csv"));
}

#[test]
fn ramps_keep_the_limits_that_polynomials_break() {
    let rows = recording::read(include_str!("../examples/05_pvt/recording.csv")).unwrap();
    for interpolation in [PvtInterpolation::SShaped, PvtInterpolation::Cubic, PvtInterpolation::Quintic] {
        let axis = |index: usize| PvtAxisSpec {
            axis: index.to_string(),
            kind: Ok(AxisKind::Prismatic),
            limits: Limits::symmetric(recording::FASTEST, 4.0, 160.0).unwrap().spec().clone(),
            start: State::at_rest(0.0),
            times: rows.iter().map(|row| row.time).collect(),
            positions: rows.iter().map(|row| row.position[index]).collect(),
            velocities: rows.iter().map(|row| row.velocity[index]).collect(),
        };
        let request = PvtRequest::try_from(PvtRequestSpec {
            axes: vec![axis(0), axis(1)],
            cycle_time_ns: None,
            interpolation: Ok(interpolation),
            policy: Ok(PvtPolicy::PreferVelocity),
            finish_unreached: true,
        })
        .unwrap();
        let planned = plan_pvt(&request).unwrap();
        let certificate = certify(planned.plan());
        assert!(certificate.passed());
        let ramps = interpolation == PvtInterpolation::SShaped;
        for check in &certificate.limits {
            assert_eq!(check.guaranteed, ramps);
            let jumps = interpolation == PvtInterpolation::Cubic && check.quantity == Quantity::Jerk;
            assert_eq!(check.margin >= -1e-9, ramps, "{interpolation:?}: {check:?}");
            assert_eq!(check.extremum.is_infinite(), jumps, "{interpolation:?}: {check:?}");
        }
        for (axis, plan) in planned.plan().axes().iter().enumerate() {
            let last = rows.last().unwrap();
            assert_eq!(plan.profile.end(), State::at_rest(last.position[axis]), "{interpolation:?}");
            let reversals = plan.profile.reversals().count();
            let expected = match interpolation {
                PvtInterpolation::SShaped => [1, 0],
                PvtInterpolation::Cubic => [3, 4],
                PvtInterpolation::Quintic => [5, 4],
            };
            assert_eq!(reversals, expected[axis], "{interpolation:?}");
            // Where a limit is not kept the certificate says where it turns back, and between two of these it does not.
            let of_axis = || certificate.reversals.iter().filter(|reversal| *reversal.axis == *plan.axis);
            assert_eq!(of_axis().count(), if ramps { 0 } else { reversals });
            let ends = of_axis().map(|reversal| reversal.at_time).chain([plan.profile.duration()]);
            let mut from = 0.0;
            let mut before = 0.0;
            for (to, reversal) in ends.zip(of_axis().map(Some).chain([None])) {
                let velocities = (1..200)
                    .map(|n| plan.profile.at(from + (to - from) * f64::from(n) / 200.0).state.velocity);
                let sign = velocities
                    .clone()
                    .fold(0.0, |most: f64, v| if v.abs() > most.abs() { v } else { most })
                    .signum();
                assert!(
                    ramps || velocities.clone().all(|velocity| velocity * sign >= -1e-12),
                    "{from} to {to}"
                );
                assert!(before * sign <= 0.0);
                (from, before) = (to, sign);
                let Some(reversal) = reversal else { continue };
                let there = plan.profile.at(reversal.at_time).state;
                assert!(
                    there.position == reversal.position && there.velocity.abs() < 1e-9,
                    "{reversal:?}: {there:?}"
                );
            }
        }
    }
}
