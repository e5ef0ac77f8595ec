//! What holds for every motion between two states. More of them:
//! `PROPTEST_CASES=1000000 cargo test --release -p portamento-planner --test states_laws`.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use common::states::{Kind, Question, question};
use planner::{BoundsSpec, State, Transfer, Transit, plan_transfer, transfer_violations};
use proptest::prelude::*;

/// A time in which nothing moves [s], or as good as nothing.
const NOTHING: f64 = 1e-12;
/// Of a duration [1]: what two ways to the same duration may differ by.
const DURATION: f64 = 1e-9;
/// Of the farthest and the fastest [1]: what the state on the way is rounded to.
const ROUNDED: f64 = 4.0 * f64::EPSILON;
/// Of the scale of a motion [1]: how far its pieces may be apart.
const END: f64 = 1e-12;

fn settings() -> ProptestConfig {
    let given = ProptestConfig::default();
    let cases = given.cases.max(4096);
    ProptestConfig { cases, max_local_rejects: u32::MAX, failure_persistence: None, ..given }
}

/// A question of any kind: what hurts is in how they are drawn, so there is nothing to shrink but the seed.
fn any_question() -> impl Strategy<Value = Question> {
    (any::<u64>(), prop::sample::select(Kind::ALL.to_vec()))
        .prop_map(|(seed, kind)| question(&mut Random(seed), kind))
}

/// The same from position zero, so that distances are not rounded.
fn from_zero(asked: Question) -> Question {
    let goal = State { position: asked.goal.position - asked.start.position, ..asked.goal };
    Question { start: State { position: 0.0, ..asked.start }, goal, ..asked }
}

/// As [`any_question`], from inside the bounds.
fn inside() -> impl Strategy<Value = Question> {
    any_question().prop_map(from_zero).prop_filter("begins inside", is_inside)
}

/// A question that is not about the last flank of a motion: there a duration hangs on the root of a rounding.
fn well_posed() -> impl Strategy<Value = Question> {
    let kinds: Vec<Kind> = Kind::ALL.into_iter().filter(|&kind| kind != Kind::Underway).collect();
    (any::<u64>(), prop::sample::select(kinds))
        .prop_map(|(seed, kind)| from_zero(question(&mut Random(seed), kind)))
}

fn is_inside(asked: &Question) -> bool {
    let back = asked.reversed();
    Transfer::new(back.start, back.goal, back.bounds()).is_ok()
}

fn planned(asked: &Question) -> Transit {
    plan_transfer(&asked.transfer()).unwrap()
}

/// The same duration, but for its roundings.
#[track_caller]
fn same(asked: &Question, what: &str, ours: f64, other: f64) {
    let off = (ours - other).abs();
    assert!(off <= DURATION * ours.max(other), "{what}: {ours} and {other}: {asked:?}");
}

fn check_legal(asked: &Question) {
    let transit = planned(asked);
    let profile = transit.to_profile();
    assert_eq!(transfer_violations(&profile, &asked.bounds(), asked.goal), [], "{asked:?}: {transit:?}");
    let apart = common::transit::residual(&transit, asked.bounds.max_jerk);
    assert!(apart <= END, "{apart:e} apart: {asked:?}: {transit:?}");
    assert_eq!(transit.end(), profile.end());
    assert_eq!(transit.start(), asked.start);
    for part in [-0.1, 0.0, 0.1, 0.5, 0.9, 1.0, 1.1] {
        let t = part * transit.duration();
        assert_eq!(transit.at(t).words().map(f64::to_bits), profile.at(t).words().map(f64::to_bits));
    }
}

fn check_mirrored(asked: &Question) {
    if let Some(mirrored) = asked.mirrored() {
        same(asked, "mirrored", planned(asked).duration(), planned(&mirrored).duration());
    }
}

fn check_reversed(asked: &Question) {
    same(asked, "reversed", planned(asked).duration(), planned(&asked.reversed()).duration());
}

/// States that are equal but for an ulp or two may be one in one unit and two in another.
fn check_scaled(asked: &Question, length: f64, time: f64) {
    let ours = planned(asked).duration();
    if ours * time > planner::LONGEST {
        return;
    }
    let scaled = planned(&asked.scaled(length, time)).duration() / time;
    if ours.min(scaled) > NOTHING {
        same(asked, "scaled", ours, scaled);
    }
}

/// In units that are powers of two nothing is rounded otherwise.
fn check_scaled_exactly(asked: &Question, length: i32, time: i32) {
    let (length, time) = (2f64.powi(length), 2f64.powi(time));
    let ours = planned(asked);
    if ours.duration() * time > planner::LONGEST {
        return;
    }
    let scaled = planned(&asked.scaled(length, time));
    let durations = |transit: &Transit, time: f64| -> Vec<f64> {
        transit.segments().iter().map(|segment| segment.duration * time).collect()
    };
    assert_eq!(durations(&ours, time), durations(&scaled, 1.0), "{asked:?}");
}

/// The rest of the fastest motion is the fastest motion from there (Bellman); or from where that is but for the rounding of the
/// whole: where the goal is passed at speed, on one side of it the next chance may come far later. Where it is passed under
/// acceleration, the last flank has no neighbours at all, and a law about it would be one about roundings.
fn check_rest(asked: &Question, part: f64) {
    let whole = planned(asked);
    let (total, t) = (whole.duration(), part * whole.duration());
    let last_flank = whole.segments().last().map_or(0.0, |last| last.duration);
    if asked.goal.acceleration != 0.0 && t > total - last_flank {
        return;
    }
    let turns = || {
        let turns = whole.segments().into_iter();
        turns.flat_map(|segment| segment.turning_points().into_iter().map(move |t| segment.at(t).state))
    };
    let farthest = END * turns().map(|state| state.position.abs()).fold(0.0, f64::max);
    let fastest = END * turns().map(|state| state.velocity.abs()).fold(0.0, f64::max);
    let known = ROUNDED / END;
    let allowed = DURATION * total + known_to(&asked.bounds, known * farthest, known * fastest);
    let at = whole.at(t).state;
    let off = |position: f64, velocity: f64| {
        let start = State { position: at.position + position, velocity: at.velocity + velocity, ..at };
        // Some ulps off the last flank there may be no motion that the digits tell.
        let rest = plan_transfer(&Question { start, ..*asked }.transfer());
        rest.map_or(f64::INFINITY, |rest| (t + rest.duration() - total).abs())
    };
    let best = off(0.0, 0.0);
    let best = if best <= allowed {
        best
    } else {
        let parts = || [0.0, 1e-3, 1e-2, 0.1, 1.0].into_iter().flat_map(|part| [part, -part]);
        let all = parts().flat_map(|position| parts().map(move |velocity| (position, velocity)));
        all.map(|(position, velocity)| off(position * farthest, velocity * fastest)).fold(best, f64::min)
    };
    assert!(best <= allowed, "off by {best} s after {t} s of {total}: {asked:?}");
}

/// What a duration is known to where positions and velocities are known to these: a part of the way of `position` that is gone at a jerk, an
/// acceleration or a velocity, whichever takes longest; the change of velocity likewise.
fn known_to(bounds: &BoundsSpec, position: f64, velocity: f64) -> f64 {
    let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } = *bounds;
    let (slowest, gentlest) = (max_velocity.min(-min_velocity), max_acceleration.min(-min_acceleration));
    let gone = 4.0 * (position / max_jerk).cbrt() + 4.0 * (position / gentlest).sqrt() + position / slowest;
    let changed = 4.0 * (velocity / max_jerk).sqrt() + velocity / gentlest;
    gone + changed
}

/// Room above a limit is not held against the motion.
fn check_slack(asked: &Question, which: usize, factor: f64) {
    let mut bounds = asked.bounds;
    let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } = &mut bounds;
    *[min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk][which] *= factor;
    let (ours, freer) = (planned(asked).duration(), planned(&Question { bounds, ..*asked }).duration());
    assert!(freer <= ours * (1.0 + DURATION), "{freer} instead of {ours} with {bounds:?}: {asked:?}");
}

/// What is asked a little otherwise.
#[derive(Clone, Copy, Debug)]
enum Nudged {
    Goal,
    StartVelocity,
    StartAcceleration,
    MaxVelocity,
    MinVelocity,
    MaxAcceleration,
    MinAcceleration,
    MaxJerk,
}

const NUDGED: [Nudged; 8] = [
    Nudged::Goal,
    Nudged::StartVelocity,
    Nudged::StartAcceleration,
    Nudged::MaxVelocity,
    Nudged::MinVelocity,
    Nudged::MaxAcceleration,
    Nudged::MinAcceleration,
    Nudged::MaxJerk,
];

/// Of what is nudged [1].
const NUDGE: f64 = 1e-9;

/// Towards rest, what is asked a little otherwise takes a little longer or shorter: there the duration does not jump. Towards a velocity it
/// does, where the goal can no longer be met on the way and is met on the way back.
fn check_continuous(asked: &Question, nudged: Nudged, part: f64) {
    let goal = State::at_rest(asked.goal.position);
    let asked = Question { goal, ..*asked };
    let ours = planned(&asked);
    let turns: Vec<State> = ours
        .segments()
        .into_iter()
        .flat_map(|segment| segment.turning_points().into_iter().map(move |t| segment.at(t).state))
        .collect();
    let most = |of: fn(&State) -> f64| turns.iter().map(|state| of(state).abs()).fold(0.0, f64::max);
    let (farthest, fastest) = (most(|state| state.position), most(|state| state.velocity));
    let mut other = asked;
    let times = 1.0 + NUDGE * part;
    match nudged {
        Nudged::Goal => other.goal.position += NUDGE * part * farthest,
        Nudged::StartVelocity => other.start.velocity *= times,
        Nudged::StartAcceleration => other.start.acceleration *= times,
        Nudged::MaxVelocity => other.bounds.max_velocity *= times,
        Nudged::MinVelocity => other.bounds.min_velocity *= times,
        Nudged::MaxAcceleration => other.bounds.max_acceleration *= times,
        Nudged::MinAcceleration => other.bounds.min_acceleration *= times,
        Nudged::MaxJerk => other.bounds.max_jerk *= times,
    }
    if !is_inside(&other) {
        return;
    }
    let other_duration = planned(&other).duration();
    let off = (ours.duration() - other_duration).abs();
    let known = 4.0 * NUDGE;
    let allowed = known * ours.duration() + known_to(&asked.bounds, known * farthest, known * fastest);
    assert!(off <= allowed, "{} and {other_duration}: {nudged:?} by {part}: {asked:?}", ours.duration());
}

proptest! {
    #![proptest_config(settings())]

    #[test]
    fn legal_and_arrives(asked in any_question()) {
        check_legal(&asked);
    }

    #[test]
    fn mirrored(asked in any_question()) {
        check_mirrored(&asked);
    }

    #[test]
    fn run_backwards(asked in well_posed().prop_filter("begins inside", is_inside)) {
        check_reversed(&asked);
    }

    #[test]
    fn in_any_unit(asked in well_posed(), length in -6.0..6.0f64, time in -6.0..6.0f64) {
        check_scaled(&asked, 10f64.powf(length), 10f64.powf(time));
    }

    #[test]
    fn in_powers_of_two(asked in any_question(), length in -40..40i32, time in -20..20i32) {
        check_scaled_exactly(&asked, length, time);
    }

    #[test]
    fn the_rest_is_the_fastest_from_there(asked in inside(), part in 0.0..1.0f64) {
        check_rest(&asked, part);
    }

    #[test]
    fn slack_never_lengthens(asked in well_posed().prop_filter("begins inside", is_inside), which in 0..5usize, factor in 1.0..3.0f64) {
        check_slack(&asked, which, factor);
    }

    #[test]
    fn towards_rest_the_duration_is_continuous(
        asked in inside(),
        nudged in prop::sample::select(NUDGED.to_vec()),
        part in -1.0..1.0f64,
    ) {
        check_continuous(&asked, nudged, part);
    }
}
