//! Laws of operations on a motion under way: scripts of them, drawn to hurt, at random cycles.
//!
//! ```text
//! PROPTEST_CASES=100000 cargo test --release -p portamento-planner --test motion_laws
//! ```

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and compares bits"
)]

mod common;

use common::Random;
use common::motions::{Opening, asked, mirrored_operation, opening, operation};
use planner::motion::{AxisGoal, Motion, Operation, Override, Phase, Refused, Spliced};
use planner::{
    Bounds, BoundsSpec, Family, Limits, Setpoint, State, Synchronization, Violation, certify,
    transfer_violations,
};
use proptest::prelude::*;

/// Units in the last place of the values.
const ULPS: f64 = 4.0;
/// Of the farthest position of a motion [1]: how near its pieces join, and what is computed from where they begin is rounded to.
const JOIN: f64 = 1e-12;
/// Cycles that are looked at after a splice, at either end of what is played of it.
const LOOKED_AT: u64 = 40;

fn settings() -> ProptestConfig {
    let given = ProptestConfig::default();
    ProptestConfig { cases: given.cases.max(2048), failure_persistence: None, ..given }
}

/// The rule by which an axis accepts setpoints: what full jerk can do in one cycle.
#[track_caller]
fn joins(before: Setpoint, after: Setpoint, cycle: f64, jerk: f64, farthest: f64, what: &dyn Fn() -> String) {
    let (a, b) = (before.state, after.state);
    let ulps = |x: f64, y: f64| ULPS * f64::EPSILON * x.abs().max(y.abs());
    let slack = 1.0 + 1e-6;
    let off = (b.acceleration - a.acceleration).abs();
    assert!(
        off <= jerk * cycle * slack + ulps(a.acceleration, b.acceleration),
        "acceleration {off}: {}",
        what()
    );
    let off = (b.velocity - a.velocity - 0.5 * cycle * (a.acceleration + b.acceleration)).abs();
    // The terms are rounded too.
    let rounded = ulps(a.velocity, b.velocity) + cycle * ulps(a.acceleration, b.acceleration);
    assert!(off <= 0.25 * jerk * cycle * cycle * slack + rounded, "velocity {off}: {}", what());
    let off = (b.position - a.position - 0.5 * cycle * (a.velocity + b.velocity)).abs();
    let rounded = JOIN * farthest + cycle * ulps(a.velocity, b.velocity);
    assert!(off <= jerk * cycle * cycle * cycle / 12.0 * slack + rounded, "position {off}: {}", what());
}

/// The cycles from `from` to `to` that are looked at.
fn looked_at(from: u64, to: u64) -> impl Iterator<Item = u64> {
    let first = from..to.min(from + LOOKED_AT);
    first.chain(to.saturating_sub(LOOKED_AT).max(from + LOOKED_AT)..to)
}

/// What is played of a motion from `from` to `to` joins and keeps its limits.
fn check_played(motion: &Motion, from: u64, to: u64) {
    let cycle = motion.plan().cycle_time().as_seconds();
    let guarantees_jerk = motion.plan().guarantees(planner::Quantity::Jerk);
    for n in looked_at(from, to) {
        let next: Vec<Setpoint> = motion.setpoints(n + 1).collect();
        for (axis, (before, after)) in motion.plan().axes().iter().zip(motion.setpoints(n).zip(next)) {
            let limits = &axis.limits;
            let what = || format!("axis {} at cycle {n}: {before:?} {after:?} {motion:?}", axis.axis);
            if guarantees_jerk {
                let begins = axis.profile.segments().iter().map(|segment| segment.start.position.abs());
                let farthest = begins.fold(axis.profile.end().position.abs(), f64::max);
                joins(before, after, cycle, limits.jerk(), farthest, &what);
            }
            let State { velocity, acceleration, .. } = after.state;
            let rounding = 1.0 + 1e-9;
            assert!(velocity.abs() <= limits.velocity_towards(velocity) * rounding + 1e-15, "{}", what());
            assert!(
                acceleration.abs() <= limits.acceleration().max(limits.deceleration()) * rounding,
                "{}",
                what()
            );
        }
    }
}

/// Same state, but for the sign of a zero.
fn same(one: State, other: State) -> bool {
    let bits = |state: State| {
        let State { position, velocity, acceleration } = state.with_positive_zeros();
        [position, velocity, acceleration].map(f64::to_bits)
    };
    bits(one) == bits(other)
}

fn bounds(limits: &Limits, factor: f64) -> Option<Bounds> {
    let cruise = |sign: f64| limits.velocity_towards(sign).min(factor * limits.cruise_towards(sign));
    let (a, d) = (limits.acceleration(), limits.deceleration());
    (a == d).then(|| {
        Bounds::try_from(BoundsSpec {
            min_velocity: -cruise(-1.0),
            max_velocity: cruise(1.0),
            min_acceleration: -d,
            max_acceleration: a,
            max_jerk: limits.jerk(),
        })
        .unwrap()
    })
}

/// What must hold of a splice by itself.
fn check_splice(before: &Motion, at: u64, operation: &Operation, spliced: &Spliced) {
    let Spliced { motion, effective_cycle, rest_cycle, on_path, changes, beyond } = spliced;
    let what = || format!("{operation:?} at {at}: {before:?}\nbecomes {spliced:?}");
    assert_eq!(*effective_cycle, at);
    assert_eq!(*rest_cycle, motion.last_cycle());
    assert!(on_path);
    assert_eq!(&before.splice(at, operation).unwrap(), spliced);
    let untouched = motion.revision() == before.revision();
    assert!(untouched || motion.revision() == before.revision() + 1);
    assert!(!untouched || motion == before, "{}", what());
    assert!(certify(motion.plan()).passed());
    for (axis, plan) in motion.plan().axes().iter().enumerate() {
        // Only an acceleration that may jump does.
        let begins = if motion.plan().guarantees(planner::Quantity::Jerk) {
            motion.state(axis, at)
        } else {
            State { acceleration: before.state(axis, at).acceleration, ..motion.state(axis, at) }
        };
        assert!(same(before.state(axis, at), begins), "{}", what());
        assert!(motion.state(axis, motion.last_cycle()).is_at_rest());
        if !changes {
            for n in [at, at + 1, at + 2, before.last_cycle(), before.last_cycle() + 1] {
                assert!(n < at || same(before.state(axis, n), motion.state(axis, n)), "{}", what());
            }
            continue;
        }
        let (name, asked) = (&plan.axis, &asked(motion)[axis]);
        if motion.phase() != Phase::Stopping && beyond.iter().all(|beyond| beyond.axis != *name) {
            assert_eq!(plan.limits, asked.limits, "{}", what());
        }
        // Beyond the limits that were asked for it only comes back, and then stays: no undershoot, no reversal.
        let goes = motion.phase() == Phase::Moving && !motion.factor().rests();
        let ends_at_goal = plan.profile.end() == plan.goal;
        // On a line it is the line's limits that count.
        let alone = motion.plan().method().synchronization == Synchronization::None;
        if goes
            && alone
            && ends_at_goal
            && let Some(bounds) = bounds(&asked.limits, motion.factor().get())
        {
            let violations: Vec<Violation> = transfer_violations(&plan.profile, &bounds, plan.profile.end());
            let limits = violations.iter().filter(|violation| matches!(violation, Violation::Limit(_)));
            assert_eq!(limits.count(), 0, "{violations:?} {}", what());
        }
    }
}

/// Plays a script; gives what it left, and the cycle of the last operation.
fn play(opened: &Opening, seed: u64, count: usize) -> (Motion, u64, Vec<(u64, Operation)>) {
    let mut random = Random(seed);
    let (mut motion, mut cycle) = (opened.motion(), 0);
    let mut script = Vec::new();
    for _ in 0..count {
        let (at, operation) = operation(&mut random, opened, &motion, cycle);
        script.push((at, operation.clone()));
        check_played(&motion, cycle, at);
        cycle = at;
        match motion.splice(at, &operation) {
            Ok(spliced) => {
                check_splice(&motion, at, &operation, &spliced);
                motion = spliced.motion;
            }
            Err(Refused::Stopped { .. } | Refused::StreamFinished) => {
                assert!(matches!(motion.phase_at(at), Phase::Stopping | Phase::Finished));
            }
            // A line is drawn through where the axes are.
            Err(Refused::OffLine { .. }) if opened.line => {}
            Err(refused) => panic!("{operation:?} at {at}: {refused}: {motion:?}\n{script:?}"),
        }
    }
    (motion, cycle, script)
}

/// Whatever was done, resumed at full feed rate it comes to what it was asked for.
fn check_arrives(motion: &Motion, mut cycle: u64) {
    if matches!(motion.phase_at(cycle), Phase::Stopping | Phase::Finished) {
        return;
    }
    let go_on = |cycle: u64| -> Result<Motion, Refused> {
        let resumed = motion.splice(cycle, &Operation::Resume)?;
        check_splice(motion, cycle, &Operation::Resume, &resumed);
        let full = Operation::Override(Override::FULL);
        let spliced = resumed.motion.splice(cycle, &full)?;
        check_splice(&resumed.motion, cycle, &full, &spliced);
        Ok(spliced.motion)
    };
    // Goals that were given while it was held are gone to straight, if they are not on the line that it comes to rest on.
    let straight = motion.base().is_some_and(|base| base.plan().duration() == 0.0);
    let mut gone_on = go_on(cycle);
    if straight && matches!(gone_on, Err(Refused::OffLine { .. })) {
        cycle = motion.last_cycle();
        gone_on = go_on(cycle);
    }
    let motion = gone_on.unwrap();
    check_played(&motion, cycle, motion.last_cycle() + 3);
    assert_eq!(motion.phase_at(motion.last_cycle()), Phase::Standstill, "{motion:?}");
    for (axis, asked) in asked(&motion).iter().enumerate() {
        let end = motion.state(axis, motion.last_cycle());
        if asked.goal.is_at_rest() {
            assert_eq!(end, asked.goal, "{motion:?}");
        }
        assert_eq!(end, motion.state(axis, motion.last_cycle() + 100_000));
    }
    // The same target again changes nothing.
    let goals = asked(&motion).iter().map(|axis| AxisGoal {
        axis: axis.axis.clone(),
        goal: axis.goal,
        limits: Some(axis.limits.clone()),
    });
    let again = Operation::Retarget(goals.collect());
    if motion.closing_from_cycle().is_none() {
        for at in [cycle, cycle + 1, motion.last_cycle(), motion.last_cycle() + 7] {
            assert_eq!(motion.splice(at, &again).unwrap().motion, motion);
        }
    }
}

fn check_script(seed: u64, line: bool) {
    let opened = opening(&mut Random(seed), line);
    let (motion, cycle, _) = play(&opened, seed ^ 0x5555, 6);
    check_arrives(&motion, cycle);
}

/// The same script from the other side.
fn check_mirrored(seed: u64, line: bool) {
    let opened = opening(&mut Random(seed), line);
    let (_, _, script) = play(&opened, seed ^ 0x5555, 4);
    let (mut one, mut other) = (opened.motion(), opened.mirrored().motion());
    for (at, operation) in script {
        let (Ok(left), Ok(right)) =
            (one.splice(at, &operation), other.splice(at, &mirrored_operation(&operation)))
        else {
            assert!(other.splice(at, &mirrored_operation(&operation)).is_err(), "{operation:?} {one:?}");
            continue;
        };
        assert_eq!(left.changes, right.changes);
        (one, other) = (left.motion, right.motion);
        assert!(one.last_cycle().abs_diff(other.last_cycle()) <= 1, "{one:?} {other:?}");
        for n in [at, at + 1, at + 10, (at + one.last_cycle()) / 2, one.last_cycle()] {
            for (axis, plan) in one.plan().axes().iter().enumerate() {
                let (a, b) = (one.state(axis, n), other.state(axis, n).mirrored());
                let scale = a.position.abs().max(plan.profile.start().position.abs()).max(1e-3);
                assert!(
                    (a.position - b.position).abs() <= 1e-9 * scale,
                    "{n}: {a:?} {b:?}: {one:?} {other:?}"
                );
            }
        }
    }
}

/// On a line the axes stay on it.
fn check_straight(seed: u64) {
    let opened = opening(&mut Random(seed), true);
    let mut random = Random(seed ^ 0xaaaa);
    let (mut motion, mut cycle) = (opened.motion(), 0);
    for _ in 0..6 {
        let (at, operation) = operation(&mut random, &opened, &motion, cycle);
        cycle = at;
        let Ok(spliced) = motion.splice(at, &operation) else { continue };
        motion = spliced.motion;
        let (last, axes) = (motion.last_cycle(), &opened.axes);
        for n in [at, at + 1, (3 * at + last) / 4, (at + last) / 2, (at + 3 * last) / 4, last] {
            let first = motion.state(0, n).position;
            let (from, to, _) = &axes[0];
            let along = (first - from.position) / (to.position - from.position);
            for (axis, (from, to, _)) in axes.iter().enumerate() {
                let expected = from.position + along * (to.position - from.position);
                let found = motion.state(axis, n).position;
                let length = (to.position - from.position).abs() * along.abs().max(1.0);
                // A line that was drawn through neighbouring points is known as well as they are.
                let allowed = 1e-6 * length + 1e-13 * from.position.abs().max(found.abs());
                // What axis 0 is rounded to is magnified where it goes less far than others.
                let rounded = 1e-13 * first.abs() * (to.position - from.position).abs()
                    / (axes[0].1.position - axes[0].0.position).abs();
                assert!(
                    (found - expected).abs() <= allowed + rounded,
                    "{n}: {found} {expected}: {operation:?} {motion:?}"
                );
            }
        }
    }
    assert_eq!(motion.plan().method().synchronization, Synchronization::Phase);
}

/// An override changes how fast a goal at speed is passed, not which way.
fn check_passing(seed: u64) {
    let mut random = Random(seed);
    let limits = common::motions::limits(&mut random);
    let start = random.between(-1.0, 1.0);
    let sign = if random.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
    let far = sign * random.decades(1e-3, 3.0);
    let reverse = limits.max_velocity_reverse.unwrap_or(limits.max_velocity);
    let fastest = limits.feed_rate.unwrap_or(limits.max_velocity).min(limits.max_velocity).min(reverse);
    let goal = State { velocity: sign * fastest * random.unit(), ..State::at_rest(start + far) };
    let (family, order, cycle_time_ns, line) = (Family::SCurve, None, 1_000_000, false);
    let axes = vec![(State::at_rest(start), goal, limits)];
    let mut motion = Opening { axes, family, order, cycle_time_ns, line }.motion();
    let scale = far.abs().max(fastest);
    let mut cycle = 0;
    for _ in 0..4 {
        cycle += ((motion.last_cycle().saturating_sub(cycle)) as f64 * random.unit()) as u64;
        let operation = Operation::Override(Override::new(random.between(0.05, 1.0)).unwrap());
        motion = motion.splice(cycle, &operation).unwrap().motion;
        for (_, piece) in motion.plan().axes()[0].profile.timed_segments() {
            for t in piece.turning_points() {
                let velocity = sign * piece.at(t).state.velocity;
                assert!(velocity >= -1e-9 * scale, "{velocity}: {operation:?} at {cycle}: {motion:?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(settings())]

    #[test]
    fn an_override_does_not_turn_back(seed in any::<u64>()) {
        check_passing(seed);
    }

    #[test]
    fn scripts_join_keep_limits_and_arrive(seed in any::<u64>()) {
        check_script(seed, false);
    }

    #[test]
    fn scripts_on_a_line_join_keep_limits_and_arrive(seed in any::<u64>()) {
        check_script(seed, true);
    }

    #[test]
    fn mirrored_scripts_mirror(seed in any::<u64>()) {
        check_mirrored(seed, false);
    }

    #[test]
    fn a_line_stays_straight(seed in any::<u64>()) {
        check_straight(seed);
    }
}
