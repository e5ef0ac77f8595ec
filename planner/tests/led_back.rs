//! Axes that begin beyond their limits, together: on a line they are led back as fast as the slowest of them can be, in time each as fast as it
//! can, and every answer is accepted by the judge.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may fail by panicking; this one also reports"
)]

mod common;

use common::Random;
use planner::{
    AxisKind, AxisMoveSpec, Family, InvalidFields, Judged, Limits, LimitsSpec, Quantity, Request,
    RequestSpec, ShortPathPolicy, State, Synchronization, Violation, Why, certify_against,
};

type Axis = (State, State, LimitsSpec);

fn limits(max_velocity: f64, max_acceleration: f64, max_jerk: f64) -> LimitsSpec {
    LimitsSpec { max_velocity, max_acceleration, max_jerk, ..LimitsSpec::default() }
}

fn answered(axes: &[Axis], synchronization: Synchronization) -> Result<Judged, InvalidFields> {
    let axes = axes.iter().enumerate().map(|(index, &(start, goal, ref limits))| AxisMoveSpec {
        axis: format!("axis {index}"),
        kind: Ok(AxisKind::Prismatic),
        start,
        goal,
        limits: limits.clone(),
    });
    let spec = RequestSpec {
        axes: axes.collect(),
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reverse),
        synchronization: Ok(synchronization),
        minimum_duration: None,
        end_on_cycle: false,
    };
    Judged::answer(&Request::try_from(spec)?)
}

#[track_caller]
fn accepted(axes: &[Axis], synchronization: Synchronization) -> Judged {
    let judged = answered(axes, synchronization).unwrap_or_else(|refusal| panic!("{refusal}: {axes:?}"));
    let found: Vec<Violation> = judged.certificate().violations().collect();
    assert_eq!(found, [], "{synchronization:?}: {axes:?}");
    judged
}

fn two(limits_of_x: LimitsSpec, limits_of_y: LimitsSpec, start: State) -> [Axis; 2] {
    let goal = State::at_rest(1.0);
    [(start, goal, limits_of_x), (start, goal, limits_of_y)]
}

const FAST: State = State { position: 0.0, velocity: 0.1, acceleration: 2.0 };

/// One axis could be back at its limit of acceleration in 0.01 s; with the other, on their line, it takes 0.1 s.
#[test]
fn a_line_leads_back_by_the_jerk_of_its_slowest() {
    let axes = two(limits(1.0, 1.0, 100.0), limits(1.0, 5.0, 10.0), FAST);
    let judged = accepted(&axes, Synchronization::Phase);
    let back = |axis: usize| {
        let name = judged.plan().axes()[axis].axis.as_str();
        let of_acceleration = |quantity| quantity == Quantity::Acceleration;
        let check = judged.certificate().limits.iter();
        check
            .filter(|check| &*check.axis == name)
            .find(|check| of_acceleration(check.quantity))
            .unwrap()
            .led_back_by
    };
    assert!((back(0).unwrap() - 0.1).abs() < 1e-12, "{:?}", back(0));
    assert_eq!(back(1), None);
    // By itself it is held to what it can do.
    let axes_alone = accepted(&axes[..1], Synchronization::Time);
    let [check] = [axes_alone.certificate().limits[1].led_back_by.unwrap()];
    assert!((check - 0.01).abs() < 1e-12, "{check}");
}

/// What the judge lets pass on a line is no more than the line needs: the same pieces of one that has more jerk dawdle.
#[test]
fn a_line_that_dawdles_is_rejected() {
    let axes = two(limits(1.0, 1.0, 100.0), limits(1.0, 5.0, 10.0), FAST);
    let judged = accepted(&axes, Synchronization::Phase);
    let by_more: Vec<(Limits, State)> = [limits(1.0, 1.0, 100.0), limits(1.0, 5.0, 20.0)]
        .into_iter()
        .map(|limits| (Limits::try_from(limits).unwrap(), State::at_rest(1.0)))
        .collect();
    let certificate = certify_against(judged.plan(), by_more.iter().map(|(limits, goal)| (limits, *goal)));
    let broken: Vec<Quantity> = certificate
        .violations()
        .map(|violation| match violation {
            Violation::Limit(check) => check.quantity,
            other => panic!("{other}"),
        })
        .collect();
    assert_eq!(broken, [Quantity::Acceleration]);
}

/// An axis that is inside its limits is not taken beyond them for the sake of the line.
#[test]
fn an_axis_inside_its_limits_is_not_swept_beyond_them() {
    let start = State { position: 0.0, velocity: -0.1, acceleration: -0.9 };
    let axes = two(
        LimitsSpec { max_velocity_reverse: Some(0.11), ..limits(1.0, 1.0, 100.0) },
        limits(1.0, 5.0, 10.0),
        start,
    );
    accepted(&axes, Synchronization::Time);
    let refusal = answered(&axes, Synchronization::Phase).unwrap_err();
    let [invalid] = refusal.as_slice() else { panic!("{refusal}") };
    assert_eq!(invalid.field.as_str(), "axes[0].start.acceleration");
    let Why::SweptOffLimits { given, allowed, limit, slowest } = invalid.why else { panic!("{refusal}") };
    assert_eq!((given, limit, slowest), (-0.9, "limits.max_velocity_reverse", 1));
    // v² − 2·j·(limit − v): as much as the jerk of the other ends in time.
    assert!((allowed + f64::sqrt(2.0 * 10.0 * 0.01)).abs() < 1e-12, "{allowed}");
    // The way out that is offered is one.
    let mut gentler = axes.clone();
    for (start, _, _) in &mut gentler {
        start.acceleration = allowed;
    }
    accepted(&gentler, Synchronization::Phase);
}

/// Up to twice beyond the limits, collinear, in every synchronization.
#[test]
fn every_answer_is_accepted() {
    let mut random = Random(41);
    let (mut led_back, mut refused) = (0, 0);
    for _ in 0..4000 {
        let count = 2 + random.bits() as usize % 4;
        let limits: Vec<LimitsSpec> = (0..count)
            .map(|_| {
                let any = random.bits().is_multiple_of(2);
                LimitsSpec {
                    max_velocity_reverse: any.then(|| random.decades(0.2, 2.0)),
                    max_deceleration: random.bits().is_multiple_of(2).then(|| random.decades(0.3, 10.0)),
                    ..limits(random.decades(0.2, 2.0), random.decades(0.3, 10.0), random.decades(3.0, 300.0))
                }
            })
            .collect();
        let shares: Vec<f64> = (0..count).map(|_| random.between(-2.0, 2.0)).collect();
        let way = random.between(-2.0, 2.0);
        // The line's own limits, of which the start is beyond by up to a half.
        let least = |of: fn(&LimitsSpec) -> f64| {
            limits
                .iter()
                .zip(&shares)
                .map(|(limits, share)| of(limits) / share.abs())
                .fold(f64::INFINITY, f64::min)
        };
        let velocity = least(|limits| limits.max_velocity) * random.between(-1.5, 1.5);
        let acceleration = least(|limits| limits.max_acceleration) * random.between(-1.5, 1.5);
        let axes: Vec<Axis> = shares
            .iter()
            .zip(&limits)
            .map(|(share, limits)| {
                let start =
                    State { position: 0.0, velocity: share * velocity, acceleration: share * acceleration };
                (start, State::at_rest(share * way), limits.clone())
            })
            .collect();
        for synchronization in [Synchronization::None, Synchronization::Time] {
            accepted(&axes, synchronization);
        }
        match answered(&axes, Synchronization::Phase) {
            Ok(judged) => {
                let found: Vec<Violation> = judged.certificate().violations().collect();
                assert_eq!(found, [], "{axes:?}");
                led_back += u32::from(judged.certificate().is_led_back());
            }
            Err(refusal) => {
                let swept =
                    |invalid: &planner::InvalidField| matches!(invalid.why, Why::SweptOffLimits { .. });
                assert!(refusal.as_slice().iter().all(swept), "{refusal}: {axes:?}");
                refused += 1;
            }
        }
    }
    println!(
        "led back on their line: {led_back}; refused, since the line would take one beyond its limits: {refused}"
    );
    assert!(led_back > 1000 && refused > 100, "{led_back} {refused}");
}
