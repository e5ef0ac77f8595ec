//! Motions asked for on their last flank: the start holds a limit of the acceleration, or falls from it, and the goal lies where
//! that leads, but for a rounding. There the way hardly changes with the duration, and its rounding must not be taken for time.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use common::states::{Kind, question};
use planner::{
    BoundsSpec, Limits, LimitsSpec, State, Transfer, plan_between, plan_transfer, transfer_violations,
    violations,
};

/// Of the scale of a motion [1]: how far its pieces may be apart.
const END: f64 = 1e-12;

fn check(start: State, goal: State, limits: &Limits) {
    let asked = || format!("{start:?} to {goal:?} within {limits:?}");
    let planned =
        plan_between(start, goal, limits).unwrap_or_else(|refusal| panic!("{refusal}: {}", asked()));
    assert_eq!(violations(&planned.to_profile(), limits, goal), [], "{}: {planned:?}", asked());
    let lower = limits.acceleration().min(limits.deceleration());
    let bounds = BoundsSpec {
        min_velocity: -limits.velocity_forward(),
        max_velocity: limits.velocity_forward(),
        min_acceleration: -lower,
        max_acceleration: lower,
        max_jerk: limits.jerk(),
    };
    let bounds = bounds.try_into().unwrap();
    let planned = plan_transfer(&Transfer::new(start, goal, bounds).unwrap()).unwrap();
    assert_eq!(transfer_violations(&planned.to_profile(), &bounds, goal), [], "{}: {planned:?}", asked());
    let off = common::transit::residual(&planned, limits.jerk());
    assert!(off <= END, "{off:e} of its scale apart: {}: {planned:?}", asked());
}

#[test]
fn a_last_flank_that_was_torn() {
    let limits = LimitsSpec {
        max_velocity: 2.0157844946535977,
        max_acceleration: 0.10467573098375711,
        max_deceleration: Some(0.0752285684004445),
        max_jerk: 12.875251432112622,
        ..LimitsSpec::default()
    };
    let start = State {
        position: 0.00017971564974975486,
        velocity: -0.00038725585189899187,
        acceleration: 0.0752285684004445,
    };
    check(start, State::at_rest(0.00017861189643796288), &limits.try_into().unwrap());
}

#[test]
fn last_flanks_are_whole() {
    let mut random = Random(5);
    for _ in 0..100_000 {
        let decades = if random.bits().is_multiple_of(2) { 1.0 } else { 3.0 };
        let mut limit = || random.decades(10f64.powf(-decades), 10f64.powf(decades));
        let (up, down, jerk) = (limit(), limit(), limit());
        let acceleration = up.min(down);
        // Held for a while, or not at all, and then full jerk to rest.
        let hold = acceleration / jerk * [0.0, random.decades(1e-3, 10.0)][random.bits() as usize % 2];
        let fall = State { acceleration, velocity: -0.5 * acceleration * acceleration / jerk, position: 0.0 };
        let start = fall.after(0.0, -hold);
        let end = fall.after(-jerk, acceleration / jerk);
        // Off by as little as makes a difference, or not even that.
        let mut off = || {
            [0.0, 1e-16, 1e-15, 1e-13, 1e-11, 1e-9][random.bits() as usize % 6] * random.between(-1.0, 1.0)
        };
        let extent = (end.position - start.position).abs();
        let goal = State::at_rest(end.position - start.position + extent * off());
        let start = State { position: 0.0, velocity: start.velocity * (1.0 + off()), ..start };
        let sign = if random.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
        let from = [0.0, extent, 10.0 * extent][random.bits() as usize % 3];
        let place = |state: State| {
            let placed = if sign > 0.0 { state } else { state.mirrored() };
            State { position: placed.position + from, ..placed }
        };
        let limits = LimitsSpec {
            max_velocity: start.velocity.abs() * random.decades(1.0, 100.0),
            max_acceleration: up,
            max_deceleration: Some(down),
            max_jerk: jerk,
            ..LimitsSpec::default()
        };
        check(place(start), place(goal), &limits.try_into().unwrap());
    }
}

/// The next state of a motion under way, and a goal that is moved off its way by up to a billionth: next to nothing is to be done
/// beside the last flank, and each of it is found.
#[test]
fn beside_the_way_of_another_motion_all_are_answered() {
    let mut random = Random(100);
    for _ in 0..100_000 {
        let mut asked = question(&mut random, Kind::Underway);
        let way = asked.goal.position - asked.start.position;
        asked.goal.position += way * random.between(-1.0, 1.0) * random.decades(1e-12, 1e-9);
        let planned =
            plan_transfer(&asked.transfer()).unwrap_or_else(|refusal| panic!("{refusal}: {asked:?}"));
        let objections = transfer_violations(&planned.to_profile(), &asked.bounds(), asked.goal);
        assert_eq!(objections, [], "{asked:?}: {planned:?}");
        let off = common::transit::residual(&planned, asked.bounds.max_jerk);
        assert!(off <= END, "{off:e} of its scale apart: {asked:?}: {planned:?}");
    }
}
