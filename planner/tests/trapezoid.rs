//! Constant acceleration in pieces: the baseline that the papers compare with.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::float_cmp,
    reason = "a test may fail by panicking"
)]

mod common;

use common::{Case, any_case, feasible_case};
use planner::{
    AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, Move, Quantity, Request, RequestSpec,
    ShortPathPolicy, State, Synchronization, Why, explain, plan_move, plan_trapezoid,
};
use proptest::prelude::*;

fn answered(case: &Case) -> Option<Judged> {
    let axis = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: case.start,
        goal: case.goal,
        limits: case.limits.clone(),
    };
    let spec = RequestSpec {
        axes: vec![axis],
        cycle_time_ns: Some(1_000_000_000),
        family: Ok(Family::Trapezoidal),
        order: None,
        short_path: Ok(case.policy),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    };
    Judged::answer(&Request::try_from(spec).unwrap()).ok()
}

fn planned(case: &Case) -> Option<Move> {
    plan_trapezoid(&case.problem()).ok()
}

fn simple(start: (f64, f64), goal: (f64, f64), policy: ShortPathPolicy) -> Case {
    let state = |(position, velocity): (f64, f64)| State { position, velocity, acceleration: 0.0 };
    let limits = LimitsSpec {
        max_velocity: 2.0,
        max_acceleration: 1.0,
        max_deceleration: Some(4.0),
        max_jerk: 1.0,
        ..LimitsSpec::default()
    };
    Case { start: state(start), goal: state(goal), limits, policy }
}

fn durations(planned: &Move) -> Vec<f64> {
    planned.segments().iter().map(|segment| segment.duration).collect()
}

#[test]
fn by_hand() {
    let reject = ShortPathPolicy::Reject;
    for (start, goal, expected) in [
        // s = v²/2a + v²/2d + 2·1: two seconds up, a half down.
        ((0.0, 0.0), (4.5, 0.0), vec![2.0, 1.0, 0.5]),
        // The peak is 1: 1/2 + 1/8.
        ((0.0, 0.0), (0.625, 0.0), vec![1.0, 0.25]),
        ((0.0, 0.0), (-0.625, -0.0), vec![1.0, 0.25]),
        ((0.0, 1.0), (1.5, 2.0), vec![1.0]),
        ((0.0, 2.0), (0.5, 0.0), vec![0.5]),
        ((0.0, 1.0), (3.0, 1.0), vec![1.0, 0.5625, 0.25]),
        ((1.0, 0.0), (1.0, 0.0), vec![]),
    ] {
        let planned = planned(&simple(start, goal, reject)).unwrap();
        let ours = durations(&planned);
        assert_eq!(ours.len(), expected.len(), "{ours:?}");
        for (ours, expected) in ours.iter().zip(&expected) {
            assert!((ours - expected).abs() < 1e-15, "{ours} instead of {expected}");
        }
    }
}

/// v² = 1 + 2·0.5 upwards; v² = 4 − 8·0.375 downwards.
#[test]
fn a_path_too_short() {
    let up = |policy| simple((0.0, 1.0), (0.5, 2.0), policy);
    let refusal = plan_trapezoid(&up(ShortPathPolicy::Reject).problem()).unwrap_err();
    let Why::PathTooShort { needed, given, nearest_velocity } = refusal.as_slice()[0].why else {
        unreachable!("{refusal}")
    };
    assert_eq!((needed, given), (1.5, 0.5));
    assert!((nearest_velocity - 2f64.sqrt()).abs() < 1e-15);
    let nearest = planned(&up(ShortPathPolicy::NearestVelocity)).unwrap();
    assert_eq!(nearest.reached().velocity, nearest_velocity);
    let matched = planned(&up(ShortPathPolicy::MatchStartVelocity)).unwrap();
    assert_eq!(matched.reached().velocity, 1.0);
    assert!(planned(&up(ShortPathPolicy::Reverse)).is_none());
    let down = simple((0.0, 2.0), (0.375, 0.0), ShortPathPolicy::NearestVelocity);
    assert!((planned(&down).unwrap().reached().velocity - 1.0).abs() < 1e-15);
}

/// What jumps is said, and not promised.
#[test]
fn the_certificate_says_that_the_jerk_is_unbounded() {
    let judged = answered(&simple((0.0, 0.0), (4.5, 0.0), ShortPathPolicy::Reject)).unwrap();
    assert_eq!(judged.plan().method().order, 2);
    assert_eq!(judged.plan().guaranteed(), [Quantity::Velocity, Quantity::Acceleration]);
    let certificate = judged.certificate();
    assert!(certificate.passed());
    let jerk = certificate.limits.iter().find(|check| check.quantity == Quantity::Jerk).unwrap();
    assert!(!jerk.guaranteed);
    assert_eq!((jerk.extremum, jerk.margin), (f64::INFINITY, f64::NEG_INFINITY));
    let join = certificate.joins.iter().find(|check| check.quantity == Quantity::Acceleration).unwrap();
    assert!(!join.guaranteed);
    // At the end, from −4 to rest; at the joins it is at most as much.
    assert_eq!(join.worst_jump, 4.0);
    // Promised as an S-curve is, the same motion is refused.
    let axis = &judged.plan().axes()[0];
    assert!(!planner::violations(&axis.profile, &axis.limits, axis.goal).is_empty());
    let bindings = explain(judged.plan()).bindings;
    let quantities: Vec<_> = bindings.iter().map(|binding| binding.quantity).collect();
    assert_eq!(quantities, [Quantity::Acceleration, Quantity::Velocity, Quantity::Acceleration]);
}

#[test]
fn a_plan_that_ends_at_speed_is_stopped_after_it() {
    let judged = answered(&simple((0.0, 0.0), (1.0, 1.0), ShortPathPolicy::Reject)).unwrap();
    let (stopped, _) = judged.plan().with_closing_stop().unwrap().unwrap();
    assert!(stopped.ends_at_rest());
    assert!(planner::certify(&stopped).passed());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// Velocity and acceleration are kept, pieces join but for the acceleration, and the end is reached.
    #[test]
    fn every_trapezoid_keeps_what_it_promises(case in any_case()) {
        let Some(planned) = planned(&case) else { return Ok(()) };
        prop_assert!(planned.segments().len() <= 3);
        if planned.duration() < 1e14 {
            let judged = answered(&case).unwrap();
            let found: Vec<_> = judged.certificate().violations().collect();
            prop_assert!(found.is_empty(), "{:?}", found);
        }
        let start = planned.to_profile().start();
        prop_assert_eq!(State { acceleration: 0.0, ..start }, case.start);
    }

    /// No limit on the jerk is no slower than any.
    #[test]
    fn a_trapezoid_is_no_slower_than_an_s_curve(case in feasible_case()) {
        let (ours, smooth) = (planned(&case).unwrap(), plan_move(&case.problem()).unwrap());
        prop_assert!(ours.duration() <= smooth.duration() * (1.0 + 1e-12));
    }

    #[test]
    fn a_trapezoid_run_backwards_is_the_trapezoid_of_the_problem_run_backwards(case in feasible_case()) {
        let (ours, reversed) = (planned(&case), planned(&case.reversed()));
        let (Some(ours), Some(reversed)) = (ours, reversed) else {
            return Ok(());
        };
        let mut backward = durations(&reversed);
        backward.reverse();
        prop_assert_eq!(durations(&ours), backward);
    }

    #[test]
    fn a_mirrored_problem_has_the_mirrored_trapezoid(case in any_case()) {
        let (ours, mirrored) = (planned(&case), planned(&case.mirrored()));
        prop_assert_eq!(ours.as_ref().map(durations), mirrored.as_ref().map(durations));
        prop_assert_eq!(ours.map(|ours| ours.reached()), mirrored.map(|other| other.reached().mirrored()));
    }

    #[test]
    fn units_that_are_powers_of_four_leave_every_bit(
        case in any_case(), length in -20..20i32, time in -10..10i32,
    ) {
        let case = Case { start: State { position: 0.0, ..case.start }, goal: State {
            position: case.distance(), ..case.goal }, limits: LimitsSpec { min_position: None, max_position: None,
            ..case.limits.clone() }, ..case };
        let (length, time) = (4f64.powi(length), 4f64.powi(time));
        let (ours, scaled) = (planned(&case), planned(&case.scaled(length, time)));
        let expected: Option<Vec<f64>> =
            ours.map(|ours| durations(&ours).iter().map(|duration| duration * time).collect());
        prop_assert_eq!(scaled.as_ref().map(durations), expected);
    }
}
