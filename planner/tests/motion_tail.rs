//! The ways to rest that axes hold in reserve: of every kind of motion, at any cycle, after any operations.
//!
//! ```text
//! PROPTEST_CASES=20000 cargo test --release -p portamento-planner --test motion_tail
//! ```

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use common::motions::{opening, operation};
use common::paths::{self, KINDS, Kind};
use planner::motion::{Motion, MotionParts, Operation, Override, Phase, Refused, Spliced};
use planner::{Accepted, Judged, Method, Plan, Profile, Quantity, State, Synchronization, TimeLaw, certify};
use proptest::prelude::*;

fn settings() -> ProptestConfig {
    let given = ProptestConfig::default();
    ProptestConfig { cases: given.cases.max(512), failure_persistence: None, ..given }
}

/// As a peer sends it.
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

fn profiles(plan: &Plan) -> Vec<Profile> {
    plan.axes().iter().map(|axis| axis.profile.clone()).collect()
}

/// What holds of the way to rest from `at`; gives it, where the motion does not rest already.
fn check_tail(motion: &Motion, at: u64) -> Option<Spliced> {
    let what = || format!("from {at}: {motion:?}");
    let tail = motion.tail(at).unwrap_or_else(|refused| panic!("{refused} {}", what()));
    assert_eq!(tail.is_none(), at >= motion.last_cycle(), "{}", what());
    let tail = tail?;
    let rests = &tail.motion;
    let what = || format!("{tail:?} from {at}: {motion:?}");
    assert_eq!((rests.revision(), rests.from_cycle()), (motion.revision() + 1, at), "{}", what());
    assert!(certify(rests.plan()).passed(), "{}", what());
    let stops = motion.phase() == Phase::Stopping;
    assert_eq!(rests.phase(), if stops { Phase::Stopping } else { Phase::Holding }, "{}", what());
    for (index, axis) in rests.plan().axes().iter().enumerate() {
        let (before, begins) = (motion.state(index, at), rests.state(index, at));
        let jumps = !rests.plan().guarantees(Quantity::Jerk);
        let begins = if jumps { State { acceleration: before.acceleration, ..begins } } else { begins };
        assert_eq!(before.with_positive_zeros(), begins, "{}", what());
        assert!(axis.profile.end().is_at_rest(), "{}", what());
    }
    // Whoever holds the pieces, and the motion that they came with, has the same.
    assert_eq!(motion.starved(at, profiles(rests.plan())).unwrap(), tail);
    assert_eq!(&Motion::try_from(parts(rests)).unwrap(), rests);
    Some(tail)
}

/// Resumed after its way to rest, a motion comes to its goals, at the rate that it had.
fn check_goes_on(tail: &Spliced, at: u64) {
    let Spliced { motion, .. } = tail;
    if motion.phase() == Phase::Stopping {
        let refused = motion.splice(at, &Operation::Resume).unwrap_err();
        assert!(matches!(refused, Refused::Stopped { .. } | Refused::StreamFinished), "{refused}");
        return;
    }
    let full = Operation::Override(Override::FULL);
    let resumed = motion.splice(at, &Operation::Resume).and_then(|on| on.motion.splice(at, &full));
    // From beside its line it can be gone to where the axes are when they rest.
    let Ok(resumed) = resumed else { panic!("{} of {tail:?} at {at}", resumed.unwrap_err()) };
    let motion = resumed.motion;
    assert_eq!(motion.phase_at(motion.last_cycle()), Phase::Standstill, "{motion:?}");
    let asked = motion.base().map_or(motion.plan(), Accepted::plan).axes();
    for (index, axis) in asked.iter().enumerate() {
        if axis.goal.is_at_rest() && motion.closing_from_cycle().is_none() {
            assert_eq!(motion.state(index, motion.last_cycle()), axis.goal, "{motion:?}");
        }
    }
}

fn some_cycle(random: &mut Random, from: u64, to: u64) -> u64 {
    match random.bits() % 8 {
        0 => from,
        1 => to,
        2 => to.saturating_sub(1 + random.bits() % 3).max(from),
        3 => from + 1,
        _ => from + ((to - from) as f64 * random.unit()) as u64,
    }
}

fn check_tails(random: &mut Random, motion: &Motion, from: u64) {
    for _ in 0..4 {
        let at = some_cycle(random, from, motion.last_cycle().max(from));
        let Some(tail) = check_tail(motion, at) else { continue };
        // The way to rest has one of its own, at every cycle.
        let on_the_way = some_cycle(random, at, tail.motion.last_cycle());
        check_tail(&tail.motion, on_the_way);
        let rests = tail.motion.last_cycle();
        check_goes_on(&tail, rests + random.bits() % 100);
    }
}

fn check_script(seed: u64, line: bool) {
    let mut random = Random(seed);
    let opened = opening(&mut random, line);
    let (mut motion, mut cycle) = (opened.motion(), 0);
    check_tails(&mut random, &motion, cycle);
    for _ in 0..4 {
        let (at, operation) = operation(&mut random, &opened, &motion, cycle);
        cycle = at;
        if let Ok(spliced) = motion.splice(at, &operation) {
            motion = spliced.motion;
            check_tails(&mut random, &motion, cycle);
        }
    }
}

fn path_motion(random: &mut Random, kind: Kind) -> Motion {
    let count = 2 + random.bits() as usize % 3;
    let drawn = paths::path(random, kind, count);
    let method = Method { synchronization: Synchronization::Time, ..drawn.method() };
    let guaranteed = drawn.guaranteed().to_vec();
    let plan = Plan::new(method, guaranteed, drawn.cycle_time(), drawn.axes().to_vec()).unwrap();
    Motion::open(Judged::new(plan).accepted().unwrap()).unwrap()
}

fn check_path(seed: u64) {
    let mut random = Random(seed);
    let kind = KINDS[random.bits() as usize % KINDS.len()];
    let mut motion = path_motion(&mut random, kind);
    check_tails(&mut random, &motion, 0);
    let mut cycle = 0;
    for _ in 0..3 {
        let operation = match random.bits() % 4 {
            0 => Operation::Hold,
            1 => Operation::Resume,
            2 => Operation::Override(Override::new(random.between(0.1, 1.0)).unwrap()),
            _ => Operation::Stop,
        };
        cycle = some_cycle(&mut random, cycle, motion.last_cycle().max(cycle));
        if let Ok(spliced) = motion.splice(cycle, &operation) {
            motion = spliced.motion;
            check_tails(&mut random, &motion, cycle);
        }
    }
}

proptest! {
    #![proptest_config(settings())]

    #[test]
    fn every_axis_by_itself_has_a_way_to_rest(seed: u64) {
        check_script(seed, false);
    }

    #[test]
    fn axes_on_a_line_have_one_that_stays_on_it(seed: u64) {
        check_script(seed, true);
    }

    #[test]
    fn axes_on_a_path_have_one_beside_it(seed: u64) {
        check_path(seed);
    }
}

#[test]
fn a_way_to_rest_of_another_cycle_is_none() {
    let motion = opening(&mut Random(3), false).motion();
    let at = motion.last_cycle() / 2;
    let tail = motion.tail(at).unwrap().unwrap();
    let taken = profiles(tail.motion.plan());
    let differs = |at_cycle| Err(Refused::TailDiffers { at_cycle });
    assert_eq!(motion.starved(at - 1, taken.clone()), differs(at - 1));
    assert_eq!(motion.starved(at, Vec::new()), differs(at));
    let at_speed = taken.iter().map(|profile| Profile::new(Vec::new(), profile.start())).collect();
    assert_eq!(motion.starved(at, at_speed), differs(at));
    assert!(motion.starved(at, taken).is_ok());
    assert_eq!(motion.base_time(), None::<&TimeLaw>);
}
