//! Operations on a motion under way: what each does in each phase, what is refused and in which words, and what is felt on the way.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and compares bits"
)]

mod common;

use common::motions::Opening;
use planner::motion::{
    AxisGoal, Beyond, InvalidMotion, Motion, MotionParts, Operation, Override, Phase, Refused, Spliced,
};
use planner::{
    AdjustmentReason, AxisKind, AxisPlan, Family, Judged, Limits, LimitsSpec, Method, Plan, PvtAxisSpec,
    PvtInterpolation, PvtPolicy, PvtRequest, PvtRequestSpec, Quantity, State, Synchronization, plan_pvt,
};

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 0.5, max_acceleration: 2.0, max_jerk: 20.0, ..LimitsSpec::default() }
}

fn opening(axes: &[(f64, State, LimitsSpec)]) -> Opening {
    let axes = axes.iter().map(|(from, goal, limits)| (State::at_rest(*from), *goal, limits.clone()));
    let (family, order, cycle_time_ns, line) = (Family::SCurve, None, 1_000_000, false);
    Opening { axes: axes.collect(), family, order, cycle_time_ns, line }
}

/// 0.4 m in 1.15 s: it speeds up to cycle 350, cruises at 0.5 m/s to 800, and rests at 1150.
fn motion() -> Motion {
    opening(&[(0.0, State::at_rest(0.4), limits())]).motion()
}

fn factor(factor: f64) -> Operation {
    Operation::Override(Override::new(factor).unwrap())
}

fn goal(axis: &str, goal: State, limits: Option<LimitsSpec>) -> AxisGoal {
    AxisGoal { axis: axis.into(), goal, limits: limits.map(|limits| limits.try_into().unwrap()) }
}

fn retarget(axis: &str, to: State) -> Operation {
    Operation::Retarget(vec![goal(axis, to, None)])
}

#[track_caller]
fn after(motion: &Motion, at: u64, operation: &Operation) -> Spliced {
    motion.splice(at, operation).unwrap()
}

#[track_caller]
fn refusal(motion: &Motion, at: u64, operation: &Operation) -> String {
    motion.splice(at, operation).unwrap_err().to_string()
}

fn velocities(motion: &Motion, cycles: std::ops::RangeInclusive<u64>) -> Vec<f64> {
    cycles.map(|cycle| motion.state(0, cycle).velocity).collect()
}

/// A motion at a cycle, the phase that it is in, an operation; the phase that comes of it and whether a setpoint changes, none where it is
/// refused.
type Row<'a> = (&'a Motion, u64, Phase, &'a Operation, Option<(Phase, bool)>);

#[test]
fn what_each_operation_does_in_each_phase() {
    let held = after(&motion(), 300, &Operation::Hold).motion;
    let stopping = after(&motion(), 300, &Operation::Stop).motion;
    let away = retarget("x", State::at_rest(0.1));
    use Phase::{Finished, Holding, Moving, Standstill, Stopping};
    let rows: [Row; 29] = [
        (&motion(), 300, Moving, &Operation::Hold, Some((Holding, true))),
        (&motion(), 300, Moving, &Operation::Resume, Some((Moving, false))),
        (&motion(), 300, Moving, &factor(0.2), Some((Moving, true))),
        (&motion(), 300, Moving, &factor(0.0), Some((Moving, true))),
        (&motion(), 300, Moving, &away, Some((Moving, true))),
        (&motion(), 300, Moving, &Operation::Stop, Some((Stopping, true))),
        (&held, 400, Holding, &Operation::Hold, Some((Holding, false))),
        (&held, 400, Holding, &Operation::Resume, Some((Moving, true))),
        (&held, 400, Holding, &factor(0.2), Some((Holding, false))),
        (&held, 400, Holding, &away, Some((Holding, false))),
        (&held, 400, Holding, &Operation::Stop, Some((Stopping, false))),
        (&held, 9000, Holding, &Operation::Resume, Some((Moving, true))),
        (&held, 9000, Holding, &Operation::Stop, Some((Finished, false))),
        (&motion(), 1150, Standstill, &Operation::Hold, Some((Holding, false))),
        (&motion(), 1150, Standstill, &Operation::Resume, Some((Standstill, false))),
        (&motion(), 9000, Standstill, &factor(0.2), Some((Standstill, false))),
        (&motion(), 1150, Standstill, &away, Some((Moving, true))),
        (&motion(), 1150, Standstill, &Operation::Stop, Some((Finished, false))),
        (&motion(), 1149, Moving, &Operation::Stop, Some((Stopping, false))),
        (&stopping, 400, Stopping, &Operation::Hold, None),
        (&stopping, 400, Stopping, &Operation::Resume, None),
        (&stopping, 400, Stopping, &factor(0.2), None),
        (&stopping, 400, Stopping, &away, None),
        (&stopping, 400, Stopping, &Operation::Stop, Some((Stopping, false))),
        (&stopping, 9000, Finished, &Operation::Hold, None),
        (&stopping, 9000, Finished, &Operation::Resume, None),
        (&stopping, 9000, Finished, &factor(0.2), None),
        (&stopping, 9000, Finished, &away, None),
        (&stopping, 9000, Finished, &Operation::Stop, Some((Finished, false))),
    ];
    for (motion, at, phase, operation, expected) in rows {
        assert_eq!(motion.phase_at(at), phase);
        let found = motion.splice(at, operation).ok();
        let found = found.map(|spliced| (spliced.motion.phase_at(at), spliced.changes));
        assert_eq!(found, expected, "{phase:?} {operation:?}");
    }
}

#[test]
fn refusals_say_what_would_do() {
    let moving = motion();
    let stopping = after(&moving, 300, &Operation::Stop).motion;
    let rows = [
        (
            refusal(&moving, 300, &factor(1.5)),
            "an override of 1.5 is out of range: give 0 (rest) to 1, where the feed rate meets the velocity limit",
        ),
        (
            Override::new(f64::NAN).unwrap_err().to_string(),
            "an override of NaN: give 0 to rest, or a finite factor above it",
        ),
        (
            refusal(&stopping, 310, &Operation::Resume),
            "the motion is stopping and rests from cycle 700: open a new one from there",
        ),
        (refusal(&stopping, 700, &Operation::Hold), "the motion is finished: open a new one"),
        (
            refusal(&after(&moving, 300, &Operation::Hold).motion, 299, &Operation::Resume),
            "cycle 299 is before the motion, which begins at 300: take effect at 300 or later",
        ),
        (
            refusal(&moving, 300, &retarget("w", State::at_rest(0.0))),
            "goals[0].axis: no axis is called \"w\": the plan has x",
        ),
        (
            refusal(&moving, 300, &Operation::Retarget(vec![goal("x", State::default(), None); 2])),
            "goals[1].axis: the name \"x\" is taken by an axis before it: give every axis a name of its own",
        ),
        (
            refusal(&moving, 300, &retarget("x", State { velocity: 0.6, ..State::at_rest(0.4) })),
            "goals[0].goal.velocity: is 0.6, beyond 0.5: end inside the limit or raise limits.max_velocity",
        ),
        (
            refusal(&moving, 300, &retarget("x", State::at_rest(f64::INFINITY))),
            "goals[0].goal.position: is inf: give a finite number of at most 1e60 in magnitude",
        ),
    ];
    for (found, expected) in rows {
        assert_eq!(found, expected);
    }
}

/// From above, without undershoot, as fast as the limits let it; and never above what was asked for.
#[test]
fn an_override_is_approached_from_above() {
    let far = opening(&[(0.0, State::at_rest(2.0), limits())]).motion();
    let slowed = after(&far, 500, &factor(0.5)).motion;
    let found = velocities(&slowed, 500..=2000);
    assert!(found.windows(2).all(|pair| pair[1] <= pair[0]), "{found:?}");
    // From 0.5 to 0.25 m/s: 0.25/2 + 2/20 s.
    assert!(found[224] > 0.25 && found[225] == 0.25 && found[1500] == 0.25, "{found:?}");
    let slower = after(&slowed, 600, &factor(0.05)).motion;
    let found = velocities(&slower, 600..=2000);
    assert!(found.windows(2).all(|pair| pair[1] <= pair[0]) && found[1400] == 0.025, "{found:?}");
    let full = after(&slower, 700, &factor(1.0)).motion;
    let found = velocities(&full, 700..=full.last_cycle());
    assert_eq!(found.iter().copied().fold(0.0, f64::max), 0.5);
    assert_eq!(full.state(0, full.last_cycle()), State::at_rest(2.0));
}

#[test]
fn an_override_goes_up_to_the_velocity_limit() {
    let slow = LimitsSpec { feed_rate: Some(0.2), ..limits() };
    let motion = opening(&[(0.0, State::at_rest(2.0), slow)]).motion();
    let faster = after(&motion, 1000, &factor(2.5)).motion;
    let found = velocities(&faster, 1000..=faster.last_cycle());
    assert_eq!(found.iter().copied().fold(0.0, f64::max), 0.5);
    assert_eq!(
        refusal(&motion, 0, &factor(2.6)),
        "an override of 2.6 is out of range: give 0 (rest) to 2.5, where the feed rate meets the velocity limit"
    );
}

/// What the cruise speed does not hold back is left alone, to the bit.
#[test]
fn an_override_that_changes_nothing_keeps_the_plan() {
    for (at, to) in [(900, 0.9), (1100, 0.1), (1149, 0.5)] {
        let spliced = after(&motion(), at, &factor(to));
        assert!(!spliced.changes);
        assert_eq!(spliced.motion.plan(), motion().plan());
        assert_eq!((spliced.motion.revision(), spliced.motion.factor().get()), (1, to));
    }
}

#[test]
fn an_override_of_zero_rests_until_there_is_more() {
    let paused = after(&motion(), 400, &factor(0.0));
    let rest = paused.rest_cycle;
    let paused = paused.motion;
    assert!(paused.state(0, rest).is_at_rest());
    assert_eq!(paused.phase_at(rest + 1000), Phase::Moving);
    let held = after(&paused, rest + 10, &Operation::Hold).motion;
    let resumed = after(&held, rest + 20, &Operation::Resume);
    assert!(!resumed.changes, "both a factor above 0 and no hold");
    let on = after(&resumed.motion, rest + 30, &factor(0.5)).motion;
    let found = velocities(&on, rest + 30..=on.last_cycle());
    assert_eq!(found.iter().copied().fold(0.0, f64::max), 0.25);
    assert_eq!(on.state(0, on.last_cycle()), State::at_rest(0.4));
    let full = after(&on, on.last_cycle(), &factor(0.0)).motion;
    assert_eq!(full.phase_at(full.last_cycle()), Phase::Standstill);
    let waits = after(&full, 9000, &retarget("x", State::at_rest(1.0)));
    assert!(!waits.changes);
    assert_eq!(waits.motion.phase_at(9000), Phase::Moving);
    let on = after(&waits.motion, 9001, &factor(1.0)).motion;
    assert_eq!(on.state(0, on.last_cycle()), State::at_rest(1.0));
}

#[test]
fn what_is_held_goes_on_from_wherever_it_has_got_to() {
    let undisturbed = motion().last_cycle();
    for (hold, resume) in
        [(0, 1), (100, 101), (400, 401), (400, 500), (400, 5000), (1149, 1149), (1150, 1150)]
    {
        let held = after(&motion(), hold, &Operation::Hold);
        assert!(held.motion.state(0, held.rest_cycle).is_at_rest());
        let resumed = after(&held.motion, resume, &Operation::Resume).motion;
        assert_eq!(resumed.state(0, resumed.last_cycle()), State::at_rest(0.4));
        if resume == hold + 1 {
            assert!(resumed.last_cycle() <= undisturbed + 3, "{hold}: {}", resumed.last_cycle());
        }
    }
}

#[test]
fn what_is_done_to_a_hold_is_done_when_it_is_resumed() {
    let held = after(&motion(), 400, &Operation::Hold).motion;
    let slower = after(&held, 450, &factor(0.4));
    let other = after(&slower.motion, 460, &retarget("x", State::at_rest(-0.2)));
    assert!(!slower.changes && !other.changes);
    assert_eq!(other.motion.plan(), held.plan());
    assert_eq!(other.motion.revision(), 3);
    let resumed = after(&other.motion, 470, &Operation::Resume).motion;
    let found = velocities(&resumed, 470..=resumed.last_cycle());
    assert_eq!(found.iter().copied().fold(0.0, f64::min), -0.2);
    assert_eq!(resumed.state(0, resumed.last_cycle()), State::at_rest(-0.2));
}

#[test]
fn the_same_target_again_changes_nothing() {
    for at in [0, 1, 200, 400, 1149, 1150, 9000] {
        for limits in [None, Some(limits())] {
            let same = Operation::Retarget(vec![goal("x", State::at_rest(0.4), limits)]);
            assert_eq!(after(&motion(), at, &same).motion, motion());
        }
        assert_eq!(after(&motion(), at, &Operation::Retarget(Vec::new())).motion, motion());
    }
}

/// Lower limits in motion: led back as fast as can be, said, and kept from then on.
#[test]
fn lowered_limits_are_approached() {
    let far = opening(&[(0.0, State::at_rest(2.0), limits())]).motion();
    let lower = LimitsSpec { max_velocity: 0.1, ..limits() };
    let slowed = after(&far, 500, &Operation::Retarget(vec![goal("x", State::at_rest(2.0), Some(lower))]));
    let beyond = Beyond { axis: "x".into(), quantity: Quantity::Velocity, limit: 0.1, inevitable: 0.5 };
    assert_eq!(slowed.beyond, [beyond.clone(), Beyond { limit: -0.1, ..beyond }][..1]);
    let slowed = slowed.motion;
    let found = velocities(&slowed, 500..=2000);
    assert!(found.windows(2).all(|pair| pair[1] <= pair[0]) && found[1500] == 0.1, "{found:?}");
    assert_eq!(slowed.plan().axes()[0].limits.velocity_forward(), 0.5);
    assert_eq!(slowed.base().unwrap().plan().axes()[0].limits.velocity_forward(), 0.1);
    let held = after(&slowed, 2000, &Operation::Hold).motion;
    let resumed = after(&held, 2100, &Operation::Resume).motion;
    assert_eq!(velocities(&resumed, 2100..=9000).into_iter().fold(0.0, f64::max), 0.1);
    assert_eq!(resumed.base(), None);
}

#[test]
fn other_axes_go_on_as_they_do() {
    let two =
        opening(&[(0.0, State::at_rest(0.4), limits()), (1.0, State::at_rest(-1.0), limits())]).motion();
    let other = after(&two, 500, &retarget("x", State::at_rest(0.1))).motion;
    for cycle in 500..two.last_cycle() {
        let (before, now) = (two.state(1, cycle), other.state(1, cycle));
        assert!((before.position - now.position).abs() <= 1e-14, "{cycle}");
        assert!((before.velocity - now.velocity).abs() <= 1e-14, "{cycle}");
    }
    assert_eq!(other.state(0, other.last_cycle()), State::at_rest(0.1));
    assert_eq!(other.state(1, other.last_cycle()), State::at_rest(-1.0));
}

#[test]
fn a_goal_at_speed_is_passed_and_a_stop_closes() {
    let passing = State { velocity: 0.3, ..State::at_rest(0.4) };
    let motion = opening(&[(0.0, passing, limits())]).motion();
    let closing = motion.closing_from_cycle().unwrap();
    let end = motion.state(0, motion.last_cycle());
    assert!(end.is_at_rest() && end.position > 0.4);

    // Under an override it is passed as much slower, which is said.
    let slower = after(&motion, 200, &factor(0.5)).motion;
    let axis = &slower.plan().axes()[0];
    let said = axis.adjustments.iter().find(|said| said.reason == AdjustmentReason::Override).unwrap();
    assert_eq!((said.quantity, said.asked, said.planned), (Quantity::Velocity, 0.3, 0.15));
    assert!(slower.closing_from_cycle().unwrap() > closing);
    assert!(axis.profile.segments().iter().any(|piece| piece.start == State { velocity: 0.15, ..passing }));

    // Too late for that: as near as can be without turning back.
    let late = after(&motion, closing - 150, &factor(0.1)).motion;
    let found = velocities(&late, closing - 150..=late.last_cycle());
    assert!(found.iter().all(|&velocity| velocity >= 0.0));
    let adjustments = &late.plan().axes()[0].adjustments;
    assert!(adjustments.iter().any(|said| said.reason == AdjustmentReason::PathTooShortNearestVelocity));
    let at_goal = late.plan().axes()[0].goal_to_reach();
    assert_eq!(at_goal, late.state(0, late.last_cycle()));

    // Behind the goal there is only the stop.
    for operation in [Operation::Hold, factor(0.5), factor(0.0)] {
        let spliced = after(&motion, closing + 10, &operation);
        assert!(!spliced.changes, "{operation:?}");
        let on = if operation == Operation::Hold { Operation::Resume } else { factor(1.0) };
        let on = after(&spliced.motion, closing + 20, &on).motion;
        assert_eq!(on.state(0, on.last_cycle()), end, "{operation:?}");
    }
    // The same goal again is a new one there, and is passed again.
    let again = after(&motion, closing + 10, &retarget("x", passing));
    assert!(again.changes && again.motion.closing_from_cycle().is_some());
    let held = after(&motion, closing - 300, &Operation::Hold).motion;
    let resumed = after(&held, closing, &Operation::Resume).motion;
    assert_eq!(resumed.state(0, resumed.last_cycle()), end);
}

#[test]
fn the_position_range_is_kept_or_what_leaves_it_is_named() {
    let ranged = LimitsSpec { max_position: Some(0.45), ..limits() };
    let motion = opening(&[(0.0, State::at_rest(0.4), ranged.clone())]).motion();
    assert_eq!(
        refusal(&motion, 500, &retarget("x", State::at_rest(0.5))),
        "goals[0].goal.position: is 0.5, beyond 0.45: end inside the limit or raise limits.max_position"
    );
    // To pass 0.44 on the way back it has to come from farther.
    let back = State { velocity: -0.3, ..State::at_rest(0.44) };
    let refused = motion.splice(500, &retarget("x", back)).unwrap_err();
    let Refused::PositionLimit { axis, reached, time, allowed, limit } = &refused else {
        panic!("{refused}")
    };
    assert!(
        axis == "x" && *reached > 0.45 && *time > 0.0 && *allowed == 0.45 && *limit == "limits.max_position"
    );
    assert!(refused.to_string().ends_with("choose a nearer goal, go slower, or move limits.max_position"));

    // A range that is drawn in too late is left, as little as can be, and that is said.
    let drawn_in = LimitsSpec { max_position: Some(0.2), ..limits() };
    let moved = Operation::Retarget(vec![goal("x", State::at_rest(0.1), Some(drawn_in))]);
    let spliced = after(&motion, 550, &moved);
    let stop = after(&motion, 550, &Operation::Stop);
    let [Beyond { quantity: Quantity::Position, limit, inevitable, .. }] = spliced.beyond[..] else {
        panic!("{:?}", spliced.beyond)
    };
    assert_eq!((limit, inevitable), (0.2, stop.motion.state(0, stop.rest_cycle).position));
    // Outside, it still stops, and comes back.
    let held = after(&spliced.motion, 560, &Operation::Hold);
    assert_eq!(held.beyond.len(), 1);
    let back = after(&held.motion, 9000, &Operation::Resume).motion;
    assert_eq!(back.state(0, back.last_cycle()), State::at_rest(0.1));
}

/// A splice is of constant jerk, whatever the motion was made of.
#[test]
fn smoother_families_go_on_as_s_curves() {
    for (family, order) in [(Family::Trigonometric, None), (Family::Polynomial, Some(4))] {
        let limits = LimitsSpec { max_snap: Some(400.0), ..limits() };
        let opened = Opening { family, order, ..opening(&[(0.0, State::at_rest(0.4), limits)]) };
        let held = after(&opened.motion(), 200, &Operation::Hold).motion;
        assert_eq!((held.plan().method().family, held.plan().method().order), (Family::SCurve, 3));
        assert_eq!(held.state(0, 200), opened.motion().state(0, 200));
        let resumed = after(&held, 250, &Operation::Resume).motion;
        assert_eq!(resumed.state(0, resumed.last_cycle()), State::at_rest(0.4));
    }
}

/// Without a limit of jerk the acceleration may jump; where full jerk would take too long to take it back, it does once more.
#[test]
fn a_trapezoid_is_not_led_beyond_its_velocity_limit() {
    for (jerk, jumps) in [(20.0, false), (2.0, true)] {
        let limits = LimitsSpec { max_jerk: jerk, ..limits() };
        let opened =
            Opening { family: Family::Trapezoidal, ..opening(&[(0.0, State::at_rest(0.4), limits)]) };
        let motion = opened.motion();
        let before = motion.state(0, 100);
        assert_eq!(before.acceleration, 2.0);
        for operation in [Operation::Hold, Operation::Stop, retarget("x", State::at_rest(2.0))] {
            let spliced = after(&motion, 100, &operation);
            assert_eq!(spliced.beyond, []);
            let now = spliced.motion.state(0, 100);
            assert_eq!((now.position, now.velocity), (before.position, before.velocity));
            assert_eq!(now.acceleration, if jumps { 0.0 } else { 2.0 });
            assert_eq!(spliced.motion.plan().guarantees(Quantity::Jerk), !jumps);
            let found = velocities(&spliced.motion, 100..=spliced.rest_cycle);
            assert!(found.iter().all(|velocity| velocity.abs() <= 0.5 * (1.0 + 1e-12)));
        }
    }
}

fn line() -> Motion {
    let axes = [(0.0, State::at_rest(0.4), limits()), (1.0, State::at_rest(0.7), limits())];
    Opening { line: true, ..opening(&axes) }.motion()
}

#[test]
fn a_line_is_kept() {
    let slower = after(&line(), 300, &factor(0.3)).motion;
    let held = after(&slower, 700, &Operation::Hold).motion;
    let resumed = after(&held, 730, &Operation::Resume).motion;
    for (motion, cycles) in [(&slower, 300..700), (&held, 700..730), (&resumed, 730..resumed.last_cycle())] {
        for cycle in cycles {
            let (x, y) = (motion.state(0, cycle), motion.state(1, cycle));
            assert!((y.position - (1.0 - 0.75 * x.position)).abs() <= 1e-15, "{cycle}: {x:?} {y:?}");
            assert!((y.velocity + 0.75 * x.velocity).abs() <= 1e-15, "{cycle}: {x:?} {y:?}");
        }
    }
    let ends = [0, 1].map(|axis| resumed.state(axis, resumed.last_cycle()));
    assert_eq!(ends, [State::at_rest(0.4), State::at_rest(0.7)]);
}

#[test]
fn a_line_is_left_only_at_rest() {
    let turn = |x, y| {
        Operation::Retarget(vec![goal("x", State::at_rest(x), None), goal("y", State::at_rest(y), None)])
    };
    assert_eq!(
        refusal(&line(), 300, &turn(0.2, 0.5)),
        "axis y: position 0.5 is not on the straight line that the axes move along, which has 0.85 there: \
         name goals on the line, or hold, and go on from rest"
    );
    let back = after(&line(), 300, &turn(-0.4, 1.3)).motion;
    assert_eq!(back.state(1, back.last_cycle()), State::at_rest(1.3));
    let at_rest = after(&line(), 5000, &turn(0.2, 0.5)).motion;
    assert_eq!(at_rest.state(1, at_rest.last_cycle()), State::at_rest(0.5));
    let held = after(&line(), 300, &Operation::Hold);
    let turned = after(&held.motion, 310, &turn(0.2, 0.5)).motion;
    assert!(matches!(turned.splice(320, &Operation::Resume), Err(Refused::OffLine { .. })));
    let resumed = after(&turned, held.rest_cycle, &Operation::Resume).motion;
    assert_eq!(resumed.state(1, resumed.last_cycle()), State::at_rest(0.5));
}

#[test]
fn a_line_that_ends_at_speed_stops_on_it() {
    let passing = |goal: f64, velocity: f64| State { velocity, ..State::at_rest(goal) };
    let axes = [(0.0, passing(0.4, 0.2), limits()), (1.0, passing(0.7, -0.15), limits())];
    let motion = Opening { line: true, ..opening(&axes) }.motion();
    assert!(motion.closing_from_cycle().is_some());
    for cycle in 0..=motion.last_cycle() {
        let (x, y) = (motion.state(0, cycle).position, motion.state(1, cycle).position);
        assert!((y - (1.0 - 0.75 * x)).abs() <= 1e-15, "{cycle}: {x} {y}");
    }
    let slower = after(&motion, 300, &factor(0.5)).motion;
    let planned = slower.plan().axes().iter().map(|axis| {
        axis.adjustments.iter().find(|said| said.reason == AdjustmentReason::Override).unwrap().planned
    });
    for (planned, expected) in planned.zip([0.1, -0.075]) {
        assert!((planned - expected).abs() <= 1e-16, "{planned} {expected}");
    }
}

/// A hold keeps them on their path, a stop does not.
#[test]
fn axes_that_arrive_together_stop_each_by_itself() {
    let two = opening(&[(0.0, State::at_rest(0.4), limits()), (1.0, State::at_rest(-1.0), limits())]).plan();
    let method = Method { synchronization: Synchronization::Time, ..two.plan().method() };
    let axes: Vec<AxisPlan> = two.plan().axes().to_vec();
    let plan = Plan::new(method, two.plan().guaranteed().to_vec(), two.plan().cycle_time(), axes).unwrap();
    let motion = Motion::open(Judged::new(plan).accepted().unwrap()).unwrap();
    let stopped = after(&motion, 300, &Operation::Stop);
    assert!(!stopped.on_path && stopped.motion.state(1, stopped.rest_cycle).is_at_rest());
    for operation in [Operation::Hold, factor(0.5)] {
        assert!(after(&motion, 300, &operation).on_path);
    }
    let elsewhere = after(&motion, 300, &retarget("x", State::at_rest(0.1))).motion;
    assert_eq!(elsewhere.state(0, elsewhere.last_cycle()), State::at_rest(0.1));
    assert!(motion.splice(motion.last_cycle(), &Operation::Hold).is_ok());
}

/// An axis that goes through points must not forget them.
#[test]
fn points_are_a_path() {
    let axis = PvtAxisSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        limits: limits(),
        start: State::at_rest(0.0),
        times: vec![1.0, 2.0],
        positions: vec![0.2, 0.1],
        velocities: vec![0.0, 0.0],
    };
    let request = PvtRequest::try_from(PvtRequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        interpolation: Ok(PvtInterpolation::SShaped),
        policy: Ok(PvtPolicy::Reject),
        finish_unreached: false,
    });
    let plan = plan_pvt(&request.unwrap()).unwrap().plan().clone();
    let motion = Motion::open(Judged::new(plan).accepted().unwrap()).unwrap();
    let held = after(&motion, 300, &Operation::Hold);
    assert!(held.on_path && held.motion.base_time().is_some());
    let elsewhere = after(&motion, 300, &retarget("x", State::at_rest(0.15))).motion;
    assert!(elsewhere.plan().method().pvt.is_none());
    assert_eq!(elsewhere.state(0, elsewhere.last_cycle()), State::at_rest(0.15));
    let stopped = after(&motion, 300, &Operation::Stop);
    assert!(!stopped.on_path && stopped.motion.plan().method().pvt.is_none());
    assert!(stopped.motion.state(0, stopped.rest_cycle).is_at_rest());
}

#[test]
fn parts_that_do_not_make_a_motion_are_refused() {
    let held = after(&motion(), 300, &Operation::Hold).motion;
    let parts = || MotionParts {
        revision: held.revision(),
        from_cycle: held.from_cycle(),
        plan: held.accepted().clone(),
        factor: held.factor(),
        phase: held.phase(),
        base: held.base().cloned(),
        base_time: held.base_time().cloned(),
        closing_from_cycle: held.closing_from_cycle(),
    };
    assert_eq!(Motion::try_from(parts()).unwrap(), held);
    let other = opening(&[(0.0, State::at_rest(0.4), limits()), (1.0, State::at_rest(2.0), limits())]).plan();
    let at_speed = opening(&[(0.0, State { velocity: 0.3, ..State::at_rest(0.4) }, limits())]).plan();
    let rows: [(MotionParts, &str); 5] = [
        (
            MotionParts { plan: at_speed, ..parts() },
            "plan: axis x ends at a velocity of 0.3: put a closing stop after it",
        ),
        (
            MotionParts { from_cycle: u64::MAX, ..parts() },
            "from_cycle 18446744073709551615 and 400 cycles are more than can be counted, 9007199254740992",
        ),
        (
            MotionParts { base: None, ..parts() },
            "base: is not set, and a motion that is held needs the plan that is to be resumed",
        ),
        (
            MotionParts { base: Some(other), ..parts() },
            "base: is a plan of other axes or another cycle time than plan: give the plan that is to be gone on with",
        ),
        (
            MotionParts { closing_from_cycle: Some(299), ..parts() },
            "closing_from_cycle is 299: a closing stop begins in the plan, from cycle 300 to 700",
        ),
    ];
    for (parts, expected) in rows {
        assert_eq!(
            Motion::try_from(parts).map_err(|invalid: InvalidMotion| invalid.to_string()).unwrap_err(),
            expected
        );
    }
}

/// A replica that got a motion as parts gives the same bits.
#[test]
fn a_motion_is_all_that_an_operation_needs() {
    let slowed = after(&motion(), 300, &factor(0.5)).motion;
    let parts = MotionParts {
        revision: slowed.revision(),
        from_cycle: slowed.from_cycle(),
        plan: slowed.accepted().clone(),
        factor: slowed.factor(),
        phase: slowed.phase(),
        base: slowed.base().cloned(),
        base_time: slowed.base_time().cloned(),
        closing_from_cycle: slowed.closing_from_cycle(),
    };
    let elsewhere = Motion::try_from(parts).unwrap();
    for operation in [Operation::Hold, factor(1.0), retarget("x", State::at_rest(0.0)), Operation::Stop] {
        assert_eq!(after(&elsewhere, 320, &operation), after(&slowed, 320, &operation));
    }
}

/// Far more cycles than there are.
#[test]
fn an_override_that_would_take_for_ever_is_refused() {
    let refused = refusal(&motion(), 300, &factor(1e-300));
    assert!(refused.contains("more cycles than can be counted"), "{refused}");
    let limits = Limits::try_from(limits()).unwrap();
    assert_eq!(Override::greatest([&limits]), 1.0);
}
