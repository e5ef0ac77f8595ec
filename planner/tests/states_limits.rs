//! From any state, what the other questions are: stop, reach a velocity, limits that were lowered on the way, the same target again,
//! speeding up unlike slowing down; and what is refused.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking"
)]

mod common;

use common::states::{Kind, Question, question};
use common::{Random, feasible_case};
use planner::{
    Bounds, BoundsSpec, EndCheck, InvalidFields, JoinCheck, Law, LimitCheck, Limits, LimitsSpec, Profile,
    Quantity, Segment, State, Transfer, Transit, Violation, plan_between, plan_move, plan_stop,
    plan_transfer, plan_velocity, transfer_violations, violations,
};
use proptest::prelude::*;

fn state(position: f64, velocity: f64, acceleration: f64) -> State {
    State { position, velocity, acceleration }
}

fn any_question() -> impl Strategy<Value = Question> {
    (any::<u64>(), prop::sample::select(Kind::ALL.to_vec()))
        .prop_map(|(seed, kind)| question(&mut Random(seed), kind))
}

/// As [`any_question`], with limits that the judge, who allows 1e-9 of each, can tell from roundings of the others.
fn of_one_size() -> impl Strategy<Value = Question> {
    let kinds: Vec<Kind> = Kind::ALL.into_iter().filter(|&kind| kind != Kind::Decades).collect();
    let any = (any::<u64>(), prop::sample::select(kinds));
    any.prop_map(|(seed, kind)| question(&mut Random(seed), kind)).prop_filter("inside", is_inside)
}

/// Limits in which speeding up and slowing down differ.
fn limits(asked: &Question) -> Limits {
    let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
        asked.bounds;
    LimitsSpec {
        max_velocity,
        max_velocity_reverse: Some(-min_velocity),
        max_acceleration,
        max_deceleration: Some(-min_acceleration),
        max_jerk,
        ..LimitsSpec::default()
    }
    .try_into()
    .unwrap()
}

/// With the start inside both limits, and so the goal, whichever they do to the speed.
fn tame(asked: &Question) -> Question {
    let lower = asked.bounds.max_acceleration.min(-asked.bounds.min_acceleration);
    let within = |state: State| State { acceleration: state.acceleration.clamp(-lower, lower), ..state };
    Question { start: within(asked.start), goal: within(asked.goal), ..*asked }
}

fn settings() -> ProptestConfig {
    let given = ProptestConfig::default();
    let cases = given.cases.max(4096);
    ProptestConfig { cases, max_local_rejects: u32::MAX, failure_persistence: None, ..given }
}

fn is_inside(asked: &Question) -> bool {
    let back = asked.reversed();
    Transfer::new(back.start, back.goal, back.bounds()).is_ok()
}

proptest! {
    #![proptest_config(settings())]

    /// No way to rest is faster than the fastest stop, and the one to where it ends is as fast.
    #[test]
    fn the_fastest_stop(asked in any_question(), part in -1.0..1.0f64) {
        let Question { start, bounds, .. } = asked;
        let stop = plan_velocity(start, 0.0, asked.bounds()).unwrap();
        let end = stop.end();
        prop_assert_eq!(transfer_violations(&stop.to_profile(), &asked.bounds(), State::at_rest(end.position)), []);
        let to = |position: f64| {
            plan_transfer(&Transfer::new(start, State::at_rest(position), asked.bounds()).unwrap()).unwrap().duration()
        };
        let elsewhere = to(end.position + part * bounds.max_velocity * stop.duration().max(1e-3));
        prop_assert!(stop.duration() <= elsewhere * (1.0 + 1e-9), "{} against {elsewhere}: {asked:?}", stop.duration());
        let there = to(end.position);
        prop_assert!((there - stop.duration()).abs() <= 1e-5 * there, "{there} {}: {asked:?}", stop.duration());
    }

    #[test]
    fn a_velocity_is_reached(asked in any_question()) {
        let to = State { velocity: asked.goal.velocity, ..State::default() };
        let reached = plan_velocity(asked.start, to.velocity, asked.bounds()).unwrap();
        let goal = State { position: reached.end().position, ..to };
        prop_assert_eq!(reached.end(), goal);
        prop_assert_eq!(transfer_violations(&reached.to_profile(), &asked.bounds(), goal), []);
        prop_assert!(common::transit::residual(&reached, asked.bounds.max_jerk) < 1e-12, "{:?}", reached);
    }

    /// Speeding up and slowing down, by the judge who knows of nothing else; and not slower than under the lower of both.
    #[test]
    fn speeding_up_and_slowing_down(asked in of_one_size()) {
        let asked = tame(&asked);
        let limits = limits(&asked);
        let planned = plan_between(asked.start, asked.goal, &limits).unwrap();
        prop_assert_eq!(violations(&planned.to_profile(), &limits, asked.goal), [], "{:?}: {:?}", asked, planned);
        let lower = limits.acceleration().min(limits.deceleration());
        let bounds = BoundsSpec { min_acceleration: -lower, max_acceleration: lower, ..asked.bounds };
        let slower = plan_transfer(&Question { bounds, ..asked }.transfer()).unwrap();
        prop_assert!(planned.duration() <= slower.duration() * (1.0 + 1e-9));
    }

    /// Never slower than what goes in the direction of travel alone.
    #[test]
    fn never_slower_than_straight_on(case in feasible_case()) {
        let limits = case.limits();
        let unranged = LimitsSpec { min_position: None, max_position: None, ..limits.spec().clone() };
        if case.distance().abs() > 0.0 {
            let theirs = plan_move(&case.problem()).unwrap().duration();
            let ours = plan_between(case.start, case.goal, &unranged.try_into().unwrap());
            // One that cannot be counted is refused.
            prop_assume!(theirs <= planner::LONGEST);
            let ours = ours.unwrap().duration();
            prop_assert!(ours <= theirs * (1.0 + 1e-9), "{ours} {theirs}");
        }
    }

    /// Never slower than to stop and to go on from there, which anybody could ask for one after the other.
    #[test]
    fn never_slower_than_by_way_of_rest(asked in of_one_size()) {
        let asked = tame(&asked);
        let limits = limits(&asked);
        let planned = plan_between(asked.start, asked.goal, &limits).unwrap();
        let stop = plan_stop(asked.start, &limits).unwrap();
        if let Ok(on) = plan_between(stop.reached(), asked.goal, &limits) {
            let by_rest = stop.duration() + on.duration();
            prop_assert!(planned.duration() <= by_rest * (1.0 + 1e-9), "{:?}: {} and {by_rest}", asked, planned.duration());
        }
    }

    /// Run backwards, what speeds up slows down.
    #[test]
    fn backwards_it_takes_as_long(asked in of_one_size()) {
        let asked = tame(&asked);
        let limits = limits(&asked);
        let planned = plan_between(asked.start, asked.goal, &limits).unwrap().duration();
        let back = asked.reversed();
        let exchanged = LimitsSpec {
            max_acceleration: limits.deceleration(),
            max_deceleration: Some(limits.acceleration()),
            ..limits.spec().clone()
        };
        let back = plan_between(back.start, back.goal, &exchanged.try_into().unwrap()).unwrap().duration();
        prop_assert!((planned - back).abs() <= 1e-9 * planned, "{:?}: {planned} and {back}", asked);
    }

    /// More room never costs time.
    #[test]
    fn slack_never_lengthens(asked in of_one_size(), room in prop::array::uniform5(1.0..1.5f64)) {
        let asked = tame(&asked);
        let limits = limits(&asked);
        let [forward, reverse, up, down, jerk] = room;
        let wider = LimitsSpec {
            max_velocity: forward * limits.velocity_forward(),
            max_velocity_reverse: Some(reverse * limits.velocity_reverse()),
            max_acceleration: up * limits.acceleration(),
            max_deceleration: Some(down * limits.deceleration()),
            max_jerk: jerk * limits.jerk(),
            ..limits.spec().clone()
        };
        let planned = plan_between(asked.start, asked.goal, &limits).unwrap().duration();
        let faster = plan_between(asked.start, asked.goal, &wider.try_into().unwrap()).unwrap().duration();
        prop_assert!(faster <= planned * (1.0 + 1e-9), "{:?} {room:?}: {planned} and {faster}", asked);
    }

    /// The stop of the service, from a state with acceleration.
    #[test]
    fn stops_while_accelerating(asked in of_one_size()) {
        let asked = tame(&asked);
        let limits = limits(&asked);
        let stop = plan_stop(asked.start, &limits).unwrap();
        prop_assert!(stop.reached().is_at_rest());
        prop_assert_eq!(violations(&stop.to_profile(), &limits, stop.reached()), [], "{:?}: {:?}", asked, stop);
    }
}

fn planned(start: State, goal: State, bounds: BoundsSpec) -> Result<Transit, InvalidFields> {
    plan_transfer(&Transfer::new(start, goal, Bounds::try_from(bounds)?)?)
}

fn symmetric(velocity: f64, acceleration: f64, jerk: f64) -> BoundsSpec {
    *Bounds::symmetric(velocity, acceleration, jerk).unwrap().spec()
}

/// The limit was 2 and is 1: down to it, no farther, and on.
#[test]
fn a_lowered_limit_is_approached_without_undershoot() {
    for (velocity, acceleration) in [(2.0, 0.0), (2.0, 0.5), (1.5, -0.2), (1.001, 0.0), (0.9, 0.7)] {
        let (start, goal) = (state(0.0, velocity, acceleration), State::at_rest(20.0));
        let bounds = symmetric(1.0, 1.0, 2.0);
        let transit = planned(start, goal, bounds).unwrap();
        let cruise = transit
            .segments()
            .into_iter()
            .position(|segment| segment.law == Law::ConstantJerk(0.0) && segment.start.acceleration == 0.0);
        let cruise = cruise.expect("it goes far enough to cruise");
        let before = transit.segments().into_iter().take(cruise);
        let slowest = before
            .flat_map(|segment| {
                segment.turning_points().into_iter().map(move |t| segment.at(t).state.velocity)
            })
            .fold(f64::INFINITY, f64::min);
        assert!(
            slowest >= 1.0f64.min(velocity) - 1e-12,
            "undershoots to {slowest} from {velocity}, {acceleration}"
        );
        assert_eq!(transit.segments()[cruise].start.velocity, 1.0);
        assert_eq!(transfer_violations(&transit.to_profile(), &Bounds::try_from(bounds).unwrap(), goal), []);
    }
}

#[test]
fn the_same_target_again_is_nothing() {
    let bounds = symmetric(1.0, 2.0, 30.0);
    for there in [State::default(), State::at_rest(5.3), state(-1.0, 0.5, 0.0), state(1e6, 0.1, -0.3)] {
        let transit = planned(there, there, bounds).unwrap();
        assert_eq!((transit.segments().len(), transit.duration()), (0, 0.0));
        assert_eq!(
            (transit.at(-1.0).state, transit.at(0.0).state, transit.at(9.0).state),
            (there, there, there)
        );
        // Nor is it much, up to what positions are rounded to.
        if there.position == 0.0 {
            continue;
        }
        let rounded = State { position: there.position.next_up(), ..there };
        assert_eq!(planned(there, rounded, bounds).unwrap().duration(), 0.0, "{there:?}");
    }
}

#[test]
fn what_is_refused() {
    let bounds = symmetric(1.0, 2.0, 10.0);
    let to = |goal: State| planned(State::default(), goal, bounds).unwrap_err().to_string();
    let rows = [
        (
            to(state(1.0, 1.5, 0.0)),
            "goal.velocity: is 1.5, beyond 1: end inside the limit or raise bounds.max_velocity",
        ),
        (
            to(state(1.0, -1.5, 0.0)),
            "goal.velocity: is -1.5, beyond -1: end inside the limit or raise bounds.min_velocity",
        ),
        (
            to(state(1.0, 0.0, 2.5)),
            "goal.acceleration: is 2.5, beyond 2: end inside the limit or raise bounds.max_acceleration",
        ),
        // From 0.92 + 1/20, or faster.
        (
            to(state(1.0, 0.95, -2.0)),
            "goal.acceleration: is -2, beyond -1.0000000000000004: end inside the limit or raise bounds.max_velocity",
        ),
        (
            to(state(f64::NAN, 0.0, 0.0)),
            "goal.position: is NaN: give a finite number of at most 1e60 in magnitude",
        ),
        (
            planned(State::default(), State::at_rest(-1.0), BoundsSpec { min_velocity: 0.0, ..bounds })
                .unwrap_err()
                .to_string(),
            "goal.position: is -1, beyond 0: end inside the limit or raise bounds.min_velocity",
        ),
        (
            Bounds::try_from(BoundsSpec {
                min_velocity: 1.0,
                max_acceleration: -1.0,
                min_acceleration: 0.0,
                ..bounds
            })
            .unwrap_err()
            .to_string(),
            "min_velocity: is 1: a lower bound is below zero, by at least 1e-60; min_acceleration: is 0: a lower bound is \
             below zero, by at least 1e-60; max_acceleration: is -1: a limit is a magnitude, at least 1e-60; its sign is not \
             needed",
        ),
    ];
    for (given, expected) in rows {
        assert_eq!(given, expected);
    }
}

/// The judge objects to what it should: rows of jerk and time, from a velocity and an acceleration, and what is wrong with them. The
/// bounds are 1, 1 and 1.
#[test]
fn the_judge_objects() {
    type Row<'a> = (f64, f64, &'a [(f64, f64)], &'a [Quantity]);
    let rows: [Row; 9] = [
        // Inside; and led back from 1.5 as it should be, onto the limit or below it.
        (0.0, 0.0, &[(1.0, 1.0), (-1.0, 1.0)], &[]),
        (1.5, 0.0, &[(-1.0, 0.5f64.sqrt()), (1.0, 0.5f64.sqrt())], &[]),
        (1.5, 0.0, &[(-1.0, 1.0), (1.0, 1.0)], &[]),
        // Beyond the limit from inside it.
        (0.5, 0.0, &[(1.0, 1.0), (-1.0, 1.0)], &[Quantity::Velocity]),
        // Beyond it whatever is done, and farther than that.
        (0.8, 1.0, &[(-1.0, 1.0)], &[]),
        (0.8, 1.0, &[(-0.5, 2.0)], &[Quantity::Velocity]),
        // Back, and out again.
        (1.5, 0.0, &[(-1.0, 1.0), (1.0, 2.0), (-1.0, 1.0)], &[Quantity::Velocity]),
        // The acceleration comes back, but not at once.
        (-0.9, 1.5, &[(0.5, 0.2), (-1.0, 1.6)], &[Quantity::Acceleration]),
        (0.0, 0.0, &[(2.0, 0.1), (-1.0, 0.2)], &[Quantity::Jerk]),
    ];
    let bounds = Bounds::symmetric(1.0, 1.0, 1.0).unwrap();
    for (velocity, acceleration, pieces, expected) in rows {
        let mut at = state(0.0, velocity, acceleration);
        let segments = pieces.iter().map(|&(jerk, duration)| {
            let segment = Segment { duration, start: at, law: Law::ConstantJerk(jerk) };
            at = segment.end();
            segment
        });
        let segments: Vec<_> = segments.collect();
        let profile = Profile::new(segments, at);
        let objections = |profile: &Profile, goal: State| -> Vec<Quantity> {
            let found = transfer_violations(profile, &bounds, goal);
            let of = |violation: &Violation| match violation {
                Violation::Limit(LimitCheck { quantity, .. })
                | Violation::Join(JoinCheck { quantity, .. })
                | Violation::End(EndCheck { quantity, .. }) => *quantity,
            };
            found.iter().map(of).collect()
        };
        assert_eq!(objections(&profile, at), expected, "{velocity} {acceleration} {pieces:?}");
        let elsewhere = State { position: at.position + 1e-6, ..at };
        assert!(objections(&profile, elsewhere).contains(&Quantity::Position));
        let mut torn = profile.segments().to_vec();
        if let Some(last) = torn.get_mut(1) {
            last.start.velocity += 1e-6;
            assert!(objections(&Profile::new(torn, at), at).contains(&Quantity::Velocity));
        }
    }
}

/// Nothing that comes in makes it panic, hang or answer what is not a number.
#[test]
fn the_ends_of_the_numbers() {
    let mut random = Random(7);
    let extreme = |random: &mut Random| {
        let magnitude = [0.0, 1e-60, 1e60, 1.0, 1e-30, 1e30, 5e-324, 1e-300][random.bits() as usize % 8];
        if random.bits().is_multiple_of(2) { magnitude } else { -magnitude }
    };
    let mut answered = 0;
    for _ in 0..20_000 {
        let mut limit = || [1e-60, 1e60, 1.0, 1e-30, 1e30][random.bits() as usize % 5];
        let bounds = BoundsSpec {
            min_velocity: -limit(),
            max_velocity: limit(),
            min_acceleration: -limit(),
            max_acceleration: limit(),
            max_jerk: limit(),
        };
        let mut any = || state(extreme(&mut random), extreme(&mut random), extreme(&mut random));
        let (start, goal) = (any(), any());
        if let Ok(transit) = planned(start, goal, bounds) {
            assert!(!transit.duration().is_nan(), "{start:?} {goal:?} {bounds:?}");
            answered += 1;
        }
    }
    assert!(answered > 1000, "{answered}");
}
