//! Who works on a plan through points, and how they share it, is not to be seen in the plan.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use std::ops::Range;

use planner::{
    Alone, AxisKind, JudgedPvt, LimitsSpec, PvtAxisSpec, PvtInterpolation, PvtPolicy, PvtRequest,
    PvtRequestSpec, State, Workers, certify, certify_by, plan_pvt_by,
};

const POINTS: usize = 60;
const BEAT: f64 = 0.05;

/// Share the work in parts of so many, the last part first.
struct Backward(usize);

impl Workers for Backward {
    fn each_range<R: Send>(&self, count: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
        let starts = (0..count).step_by(self.0).rev();
        let mut done: Vec<R> = starts.map(|start| work(start..count.min(start + self.0))).collect();
        done.reverse();
        done
    }
}

/// A target that swings; every seventh point is too far for the time.
fn axis(index: usize) -> PvtAxisSpec {
    let angle = |n: usize| 2.0 * n as f64 * BEAT + index as f64;
    let limits =
        LimitsSpec { max_velocity: 0.5, max_acceleration: 4.0, max_jerk: 160.0, ..LimitsSpec::default() };
    let all = |of: &dyn Fn(usize) -> f64| (1..=POINTS).map(of).collect();
    PvtAxisSpec {
        axis: format!("axis {index}"),
        kind: Ok(AxisKind::Prismatic),
        limits,
        start: State { velocity: 0.2 * angle(0).cos(), ..State::at_rest(0.0) },
        times: all(&|n| n as f64 * BEAT),
        positions: all(&|n| {
            0.1 * (angle(n).sin() - angle(0).sin()) + if n.is_multiple_of(7) { 3e-3 } else { 0.0 }
        }),
        velocities: all(&|n| 0.2 * angle(n).cos()),
    }
}

fn request(policy: PvtPolicy, interpolation: PvtInterpolation) -> PvtRequest {
    let spec = PvtRequestSpec {
        axes: (0..5).map(axis).collect(),
        cycle_time_ns: None,
        interpolation: Ok(interpolation),
        policy: Ok(policy),
        finish_unreached: false,
    };
    PvtRequest::try_from(spec).unwrap()
}

/// The same answer, or the same refusal, from whoever works.
fn check(policy: PvtPolicy, interpolation: PvtInterpolation) {
    let request = request(policy, interpolation);
    let alone = JudgedPvt::answer_by(&request, &Alone);
    for size in 1..=5 {
        let workers = Backward(size);
        assert_eq!(JudgedPvt::answer_by(&request, &workers), alone, "{policy:?}, {size} axes each");
        if let Ok(planned) = plan_pvt_by(&request, &workers) {
            assert_eq!(certify_by(planned.plan(), &workers), certify(planned.plan()));
            let reported = |axis: usize| planned.points()[axis * POINTS..].iter().take(POINTS);
            assert!((0..5).all(|axis| reported(axis).all(|report| report.axis == axis)));
        }
    }
}

#[test]
fn whoever_plans_gives_the_same_plan() {
    for policy in [PvtPolicy::PreferVelocity, PvtPolicy::PreferPosition, PvtPolicy::ExtendTime] {
        check(policy, PvtInterpolation::SShaped);
    }
    check(PvtPolicy::PreferVelocity, PvtInterpolation::Quintic);
}

#[test]
fn whoever_refuses_names_the_same_axes() {
    check(PvtPolicy::Reject, PvtInterpolation::SShaped);
    let refused = plan_pvt_by(&request(PvtPolicy::Reject, PvtInterpolation::SShaped), &Backward(1));
    assert_eq!(refused.unwrap_err().as_slice().len(), 5);
}
