//! Operations on motions that keep to a path of theirs, which is no straight line: axes that arrive together, and points.
//!
//! ```text
//! PROPTEST_CASES=20000 cargo test --release -p portamento-planner --test motion_path
//! ```

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use common::paths::{self, KINDS, Kind};
use planner::motion::{
    AxisGoal, InvalidMotion, Motion, MotionParts, Operation, Override, Phase, Refused, Spliced,
};
use planner::{
    AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, Method, Plan, Profile, Quantity, Request,
    RequestSpec, Segment, ShortPathPolicy, State, Synchronization, TimeLaw, certify, greatest_factor,
};
use proptest::prelude::*;

/// Of the scale of the base [1]: position, velocity and acceleration over a splice, and beside the path.
const NEAR: f64 = 1e-11;

fn settings() -> ProptestConfig {
    let given = ProptestConfig::default();
    ProptestConfig { cases: given.cases.max(400), failure_persistence: None, ..given }
}

/// A plan of one to four axes that arrive together.
fn plan(random: &mut Random, kind: Kind) -> Plan {
    let count = 1 + random.bits() as usize % 4;
    // One axis by itself is no path.
    let count = if matches!(kind, Kind::Cubic | Kind::Quintic) { count } else { count + 1 };
    let drawn = paths::path(random, kind, count.max(2));
    let method = Method { synchronization: Synchronization::Time, ..drawn.method() };
    let guaranteed = drawn.guaranteed().to_vec();
    Plan::new(method, guaranteed, drawn.cycle_time(), drawn.axes().to_vec()).unwrap()
}

fn open(plan: Plan) -> Motion {
    Motion::open(Judged::new(plan).accepted().unwrap()).unwrap()
}

/// The largest position, velocity and acceleration of a path; for the jerk nothing is compared.
fn scales(path: &Profile) -> [f64; 3] {
    let mut scales = [0.0_f64; 3];
    for segment in path.segments() {
        for t in segment.turning_points() {
            let State { position, velocity, acceleration } = segment.at(t).state;
            for (scale, value) in scales.iter_mut().zip([position, velocity, acceleration]) {
                *scale = scale.max(value.abs());
            }
        }
    }
    scales
}

fn words(state: State) -> [f64; 3] {
    [state.position, state.velocity, state.acceleration]
}

#[track_caller]
fn near(ours: [f64; 3], theirs: [f64; 3], scales: [f64; 3], quantities: usize, what: &dyn Fn() -> String) {
    for ((ours, theirs), scale) in ours.into_iter().zip(theirs).zip(scales).take(quantities) {
        assert!((ours - theirs).abs() <= NEAR * scale, "{ours} for {theirs}, scale {scale}: {}", what());
    }
}

/// How many derivatives go on without a jump: cubics through points have jumps of acceleration.
fn continuous(kind: Kind) -> usize {
    if kind == Kind::Cubic { 2 } else { 3 }
}

/// What holds of every splice.
fn check(base: &Plan, kind: Kind, before: &Motion, at: u64, spliced: &Spliced) {
    let motion = &spliced.motion;
    let what = || format!("{kind:?} at {at}: {before:?}\nbecomes {spliced:?}");
    assert!(certify(motion.plan()).passed());
    assert_eq!(spliced.rest_cycle, motion.last_cycle());
    let stopping = motion.phase() == Phase::Stopping;
    for (index, path) in base.axes().iter().enumerate() {
        let scales = scales(&path.profile);
        let (old, new) = (before.state(index, at), motion.state(index, at));
        // A stop of a motion that keeps no limit of jerk may begin with a jump of the acceleration, to zero.
        let jumps = stopping && !base.guarantees(Quantity::Jerk);
        near(words(new), words(old), scales, if jumps { 2 } else { continuous(kind) }, &what);
        assert!(motion.state(index, motion.last_cycle()).is_at_rest());
        if stopping || motion.phase() == Phase::Finished {
            continue;
        }
        // All axes are on the path at one path time.
        let Some(law) = motion.base_time() else { continue };
        assert_eq!(motion.base().unwrap().plan().axes()[index].profile, path.profile);
        let cycle = base.cycle_time();
        for n in (at..=motion.last_cycle()).step_by(7) {
            let t = cycle.as_seconds() * (n - motion.from_cycle()) as f64;
            if t > motion.plan().duration() {
                continue;
            }
            let time = law.at(t);
            let on_path = path.profile.at(time.position).state;
            let there = [on_path.position, on_path.velocity * time.velocity];
            let state = motion.state(index, n);
            near([state.position, state.velocity, 0.0], [there[0], there[1], 0.0], scales, 2, &what);
        }
    }
    assert_eq!(stopping && spliced.changes, !spliced.on_path, "{}", what());
}

fn parts(motion: &Motion) -> MotionParts {
    MotionParts {
        revision: motion.revision(),
        from_cycle: motion.from_cycle(),
        plan: motion.accepted().clone(),
        factor: motion.factor(),
        phase: motion.phase(),
        base: motion.base().cloned(),
        base_time: motion.base_time().cloned(),
        closing_from_cycle: motion.closing_from_cycle(),
    }
}

fn operation(random: &mut Random) -> Operation {
    match random.bits() % 16 {
        0..=4 => Operation::Hold,
        5..=9 => Operation::Resume,
        10 => Operation::Override(Override::REST),
        11 | 12 => Operation::Override(Override::FULL),
        13 | 14 => Operation::Override(Override::new(random.between(0.05, 1.0)).unwrap()),
        _ if random.bits().is_multiple_of(4) => Operation::Stop,
        _ => Operation::Hold,
    }
}

fn play(seed: u64) {
    let mut random = Random(seed);
    let kind = KINDS[random.bits() as usize % KINDS.len()];
    let base = plan(&mut random, kind);
    let (mut motion, mut cycle) = (open(base.clone()), 0);
    for _ in 0..1 + random.bits() % 6 {
        let left = motion.last_cycle().saturating_sub(cycle);
        cycle += match random.bits() % 8 {
            0 => 0,
            1 => 1,
            2 => left + random.bits() % 100,
            _ => (left as f64 * random.unit()) as u64,
        };
        let operation = operation(&mut random);
        match motion.splice(cycle, &operation) {
            Ok(spliced) => {
                check(&base, kind, &motion, cycle, &spliced);
                let elsewhere = Motion::try_from(parts(&motion)).unwrap();
                assert_eq!(elsewhere.splice(cycle, &operation).unwrap(), spliced);
                motion = spliced.motion;
            }
            Err(Refused::Stopped { .. } | Refused::StreamFinished) => return,
            Err(refused) => panic!("{kind:?}, {operation:?} at {cycle}: {refused}: {motion:?}"),
        }
    }
    if matches!(motion.phase_at(cycle), Phase::Stopping | Phase::Finished) {
        return;
    }
    // Whatever was done, resumed at the full rate it ends where it was to end.
    for operation in [Operation::Override(Override::FULL), Operation::Resume] {
        let spliced = motion.splice(cycle, &operation).unwrap();
        check(&base, kind, &motion, cycle, &spliced);
        motion = spliced.motion;
    }
    assert_eq!(motion.phase_at(motion.last_cycle()), Phase::Standstill);
    for (index, path) in base.axes().iter().enumerate() {
        assert_eq!(motion.state(index, motion.last_cycle()), path.profile.end());
    }
}

proptest! {
    #![proptest_config(settings())]

    #[test]
    fn scripts_stay_on_the_path(seed in any::<u64>()) {
        play(seed);
    }
}

fn together() -> Motion {
    open(plan(&mut Random(3), Kind::Together))
}

#[test]
fn a_hold_rests_on_the_path_and_resumes() {
    let motion = together();
    let held = motion.splice(motion.last_cycle() / 3, &Operation::Hold).unwrap();
    assert!(held.on_path && held.changes && held.rest_cycle < motion.last_cycle());
    assert_eq!(held.motion.phase_at(held.rest_cycle), Phase::Holding);
    let later = held.rest_cycle + 1000;
    assert_eq!(held.motion.state(0, later), held.motion.state(0, held.rest_cycle));
    let resumed = held.motion.splice(later, &Operation::Resume).unwrap().motion;
    assert_eq!(resumed.state(0, resumed.last_cycle()), motion.state(0, motion.last_cycle()));
}

fn retarget(goals: &[(&str, f64)]) -> Operation {
    let goals = goals.iter().map(|&(axis, position)| AxisGoal {
        axis: axis.into(),
        goal: State::at_rest(position),
        limits: None,
    });
    Operation::Retarget(goals.collect())
}

/// All axes that move arrive when the last one does.
fn arrives_together(motion: &Motion) {
    let plan = motion.plan();
    for axis in plan.axes() {
        let lasts = axis.profile.duration();
        assert!(lasts == 0.0 || (lasts - plan.duration()).abs() <= 1e-9 * plan.duration(), "{lasts}");
    }
}

#[test]
fn new_goals_are_gone_to_together_from_wherever_it_is() {
    let motion = together();
    let at = motion.last_cycle() / 3;
    let names: Vec<String> = motion.plan().axes().iter().map(|axis| axis.axis.clone()).collect();
    let goals = [(names[0].as_str(), 0.1), (names[1].as_str(), -0.3)];
    for factor in [1.0, 0.5] {
        let slowed = motion.splice(at, &Operation::Override(Override::new(factor).unwrap())).unwrap().motion;
        let spliced = slowed.splice(at + 50, &retarget(&goals)).unwrap();
        let after = &spliced.motion;
        assert!(certify(after.plan()).passed());
        arrives_together(after);
        for (index, (_, goal)) in goals.iter().enumerate() {
            let (old, new) = (slowed.state(index, at + 50), after.state(index, at + 50));
            near(words(new), words(old), [1.0, 1.0, 1.0], 3, &|| format!("{factor}"));
            assert_eq!(after.state(index, after.last_cycle()), State::at_rest(*goal));
        }
        // Held and resumed it goes on to them.
        let held = after.splice(at + 80, &Operation::Hold).unwrap().motion;
        let resumed = held.splice(held.last_cycle() + 9, &Operation::Resume).unwrap().motion;
        assert_eq!(resumed.state(1, resumed.last_cycle()), State::at_rest(-0.3));
        assert_eq!(after.splice(at + 60, &retarget(&goals)).unwrap().motion.revision(), after.revision());
    }
}

#[test]
fn new_goals_of_a_hold_are_gone_to_when_it_is_resumed() {
    let motion = together();
    let name = motion.plan().axes()[1].axis.clone();
    let held = motion.splice(motion.last_cycle() / 3, &Operation::Hold).unwrap().motion;
    let named = held.splice(held.from_cycle() + 5, &retarget(&[(&name, 0.25)])).unwrap();
    assert!(!named.changes && named.motion.phase() == Phase::Holding);
    for cycle in [held.from_cycle() + 20, held.last_cycle() + 100] {
        let resumed = named.motion.splice(cycle, &Operation::Resume).unwrap().motion;
        arrives_together(&resumed);
        let elsewhere = Motion::try_from(parts(&resumed)).unwrap();
        assert_eq!(elsewhere, resumed);
        assert_eq!(resumed.state(1, resumed.last_cycle()), State::at_rest(0.25));
        assert_eq!(resumed.state(0, resumed.last_cycle()), motion.state(0, motion.last_cycle()));
    }
}

/// Cosines cannot be re-timed: each axis stops fastest, and they go on together.
#[test]
fn what_cannot_be_re_timed_is_held_beside_its_path() {
    let axis = |name: &str, goal: f64| AxisMoveSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(goal),
        limits: LimitsSpec {
            max_velocity: 0.5,
            max_acceleration: 2.0,
            max_jerk: 20.0,
            ..LimitsSpec::default()
        },
    };
    let spec = RequestSpec {
        axes: vec![axis("x", 0.5), axis("y", -0.2)],
        cycle_time_ns: None,
        family: Ok(Family::Trigonometric),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::Time),
        minimum_duration: None,
        end_on_cycle: false,
    };
    let motion = open(planner::plan(&Request::try_from(spec).unwrap()).unwrap());
    let held = motion.splice(400, &Operation::Hold).unwrap();
    assert!(!held.on_path && held.motion.state(0, held.rest_cycle).is_at_rest());
    for cycle in [held.rest_cycle - 20, held.rest_cycle + 100] {
        let resumed = held.motion.splice(cycle, &Operation::Resume).unwrap().motion;
        arrives_together(&resumed);
        assert_eq!(resumed.state(1, resumed.last_cycle()), State::at_rest(-0.2));
    }
    let slowed = motion.splice(400, &Operation::Override(Override::new(0.4).unwrap())).unwrap().motion;
    assert_eq!(slowed.state(0, slowed.last_cycle()), State::at_rest(0.5));
}

#[test]
fn parts_that_contradict_each_other_are_refused() {
    let motion = together();
    let slowed = motion
        .splice(motion.last_cycle() / 3, &Operation::Override(Override::new(0.5).unwrap()))
        .unwrap()
        .motion;
    let says = |parts: MotionParts| {
        Motion::try_from(parts).map_err(|invalid: InvalidMotion| invalid.to_string()).unwrap_err()
    };
    let alone = MotionParts { base: None, ..parts(&slowed) };
    assert_eq!(
        says(alone),
        "base_time: is set, and base is not: give the plan whose time it is, or leave it empty"
    );
    let advice = "base_time: plan does not begin or end where base is under it: give the plan, base and base_time of one revision";
    let of_before = MotionParts { base_time: Some(TimeLaw::of(motion.plan())), ..parts(&slowed) };
    assert_eq!(says(of_before), advice);
    let mut segments: Vec<Segment> = slowed.base_time().unwrap().profile().segments().to_vec();
    segments[0].start.velocity *= 1.0 + 1e-6;
    let forged = MotionParts { base_time: Some(TimeLaw::new(segments).unwrap()), ..parts(&slowed) };
    assert_eq!(says(forged), advice);
}

#[test]
fn what_the_path_has_no_room_for_is_refused() {
    let motion = together();
    let refused = motion.splice(10, &Operation::Override(Override::new(1.5).unwrap())).unwrap_err();
    assert!(matches!(refused, Refused::OverrideOutOfRange { given, .. } if given > 1.4), "{refused}");
    assert!(greatest_factor(motion.plan(), 0.0) >= 1.0);
}
