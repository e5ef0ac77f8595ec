//! Goals that accelerate by more than the lower of the limits of speeding up and slowing down: from the other direction they are
//! reached by way of rest, in whatever longer time is asked for.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use planner::{AxisTransfer, Limits, LimitsSpec, State, Violation, plan_between, violations};

fn limits(max_acceleration: f64, max_deceleration: f64) -> Limits {
    let spec = LimitsSpec {
        max_velocity: 1.0,
        max_acceleration,
        max_deceleration: Some(max_deceleration),
        max_jerk: 20.0,
        ..LimitsSpec::default()
    };
    spec.try_into().unwrap()
}

fn moving(position: f64, velocity: f64, acceleration: f64) -> State {
    State { position, velocity, acceleration }
}

/// Answered, and legal, at once and in any longer time that there is said to be.
#[track_caller]
fn check(start: State, goal: State, limits: &Limits) {
    let asked = || format!("{start:?} to {goal:?} within {limits:?}");
    let planned =
        plan_between(start, goal, limits).unwrap_or_else(|refusal| panic!("{refusal}: {}", asked()));
    assert_eq!(violations(&planned.to_profile(), limits, goal), [], "{}: {planned:?}", asked());
    let axis = AxisTransfer::within_limits(start, goal, limits).unwrap();
    let arrivals = axis.arrivals().unwrap();
    for factor in [1.0, 1.1, 3.0] {
        let duration = arrivals.first_from(factor * planned.duration());
        let lasting = axis.lasting(duration).unwrap_or_else(|none| panic!("{none}: {}", asked()));
        assert!((lasting.duration() - duration).abs() <= 1e-14 * duration, "{lasting:?} in {duration}");
        assert_eq!(violations(&lasting.to_profile(), limits, goal), [], "{}: {lasting:?}", asked());
    }
}

#[test]
fn speeding_up_harder_than_slowing_down_from_the_other_direction() {
    let limits = limits(3.0, 1.0);
    check(moving(0.0, -0.5, 0.0), moving(0.2, 0.5, 2.0), &limits);
    check(moving(0.0, 0.5, 0.0), moving(-0.2, -0.5, -2.0), &limits);
    // The run-up begins behind the start, or far before it, or at it.
    for position in [-1.0, 0.0, 1e-9, 10.0] {
        check(moving(0.0, -0.5, 0.0), moving(position, 0.5, 3.0), &limits);
        check(moving(0.0, 0.0, 0.0), moving(position, 0.5, 3.0), &limits);
    }
}

#[test]
fn slowing_down_harder_than_speeding_up_from_either_direction() {
    let limits = limits(1.0, 3.0);
    for velocity in [-0.5, 0.0, 0.5] {
        for position in [-1.0, 0.0, 10.0] {
            check(moving(0.0, velocity, 0.0), moving(position, 0.7, -2.0), &limits);
        }
    }
}

/// From beyond the limits it is led back first, which this judge objects to, and to nothing else.
#[test]
fn from_beyond_the_limits() {
    let (goal, limits) = (moving(0.2, 0.5, 2.0), limits(3.0, 1.0));
    for start in [moving(0.0, -0.9, -6.0), moving(0.0, -2.0, 0.5)] {
        let planned = plan_between(start, goal, &limits).unwrap();
        let objections = violations(&planned.to_profile(), &limits, goal);
        let at_start =
            |objection: &Violation| matches!(objection, Violation::Limit(check) if check.at_time < 1.0);
        assert!(objections.iter().all(at_start), "{objections:?}");
    }
}

#[test]
fn any_goal_that_the_limits_hold_is_reached() {
    let mut random = Random(1);
    for _ in 0..20_000 {
        let (up, down) = (random.decades(0.5, 8.0), random.decades(0.5, 8.0));
        let limits = limits(up, down);
        let mut velocity = || random.between(-0.9, 0.9);
        let (from, to) = (velocity(), velocity());
        // That of speeding up where it does, else that of slowing down; and no more than comes from velocities that there are.
        let sign = if random.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
        let limit = if sign * to > 0.0 { up } else { down };
        let room = if sign > 0.0 { to + 1.0 } else { 1.0 - to };
        let hardest = limit.min((2.0 * 20.0 * room).sqrt());
        // Through zero at no more than slowing down may.
        let through_zero = to * sign > 0.0 && hardest * hardest > 2.0 * 20.0 * to.abs();
        let hardest =
            if through_zero { (down * down + 40.0 * to.abs()).sqrt().min(hardest) } else { hardest };
        let acceleration = sign * hardest * random.between(0.5, 0.999);
        check(moving(0.0, from, 0.0), moving(random.between(-2.0, 2.0), to, acceleration), &limits);
    }
}
