//! Many moves of one axis: each is what it is by itself, to the last bit, and refused in the same words.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod common;

use common::random::Random;
use common::states::{Kind, question};
use planner::{
    Adjustment, AxisKind, AxisMoveSpec, BoundsSpec, Family, Field, InvalidField, Judged, LimitsSpec,
    MoveSeries, Profile, Rejection, Request, RequestSpec, SeriesError, ShortPathPolicy, State,
    Synchronization, Why,
};

/// Every number of a motion, as bits.
#[derive(Debug, PartialEq)]
struct Bits {
    pieces: Vec<[u64; 4]>,
    laws: Vec<String>,
    duration: u64,
    end: [u64; 3],
    cycle_count: u64,
    adjustments: Vec<Adjustment>,
}

impl Bits {
    fn of(profile: &Profile, cycle_count: u64, adjustments: &[Adjustment]) -> Self {
        let words = |state: &State| [state.position, state.velocity, state.acceleration].map(f64::to_bits);
        let pieces = profile.segments().iter().map(|piece| {
            let [position, velocity, acceleration] = words(&piece.start);
            [piece.duration.to_bits(), position, velocity, acceleration]
        });
        Self {
            pieces: pieces.collect(),
            // The shortest text of a number is the number.
            laws: profile.segments().iter().map(|piece| format!("{:?}", piece.law)).collect(),
            duration: profile.duration().to_bits(),
            end: words(&profile.end()),
            cycle_count,
            adjustments: adjustments.to_vec(),
        }
    }
}

/// The ordinary way.
fn alone(spec: RequestSpec) -> Result<Bits, String> {
    let planned = |spec: RequestSpec| Judged::answer(&Request::try_from(spec)?);
    let accepted = planned(spec).map_err(|invalid| format!("{invalid:?}"))?.accepted();
    let accepted = accepted.map_err(|rejection: Rejection| format!("{rejection:?}"))?;
    let plan = accepted.plan();
    let axis = &plan.axes()[0];
    assert_eq!(plan.duration().to_bits(), axis.profile.duration().to_bits());
    assert_eq!(axis.goal_to_reach(), axis.profile.end(), "what a client takes for the end");
    Ok(Bits::of(&axis.profile, plan.cycle_count(), &axis.adjustments))
}

fn in_series(series: &mut MoveSeries, start: State, goal: State) -> Result<Bits, String> {
    match series.answer(start, goal) {
        Ok(moved) => Ok(Bits::of(moved.profile(), moved.cycle_count(), moved.adjustments())),
        Err(SeriesError::Invalid(invalid)) => Err(format!("{invalid:?}")),
        Err(SeriesError::Rejected(rejection)) => Err(format!("{rejection:?}")),
    }
}

fn like(family: Family, policy: ShortPathPolicy) -> RequestSpec {
    let limits =
        LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..Default::default() };
    let still = State::at_rest(0.0);
    let axis =
        AxisMoveSpec { axis: "x".into(), kind: Ok(AxisKind::Prismatic), start: still, goal: still, limits };
    RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(family),
        order: None,
        short_path: Ok(policy),
        synchronization: Ok(Synchronization::Time),
        minimum_duration: None,
        end_on_cycle: false,
    }
}

const POLICIES: [ShortPathPolicy; 4] = [
    ShortPathPolicy::Reject,
    ShortPathPolicy::Reverse,
    ShortPathPolicy::NearestVelocity,
    ShortPathPolicy::MatchStartVelocity,
];

/// One number in twelve is none, or none that it may be.
fn spoiled(random: &mut Random, value: f64) -> f64 {
    const NUMBERS: [f64; 8] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0, -0.0, 1e61, 1e-61];
    match random.bits() % 96 {
        which @ 0..8 => NUMBERS[which as usize],
        _ => value,
    }
}

/// Drawn to hurt, some of it wrong.
fn asked(random: &mut Random, rests: bool) -> (State, State, LimitsSpec) {
    let kind = Kind::ALL[random.bits() as usize % Kind::ALL.len()];
    let asked = question(random, kind);
    let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
        asked.bounds;
    let mut one_in = |many: u64| random.bits().is_multiple_of(many);
    let mut limits = LimitsSpec { max_velocity, max_acceleration, max_jerk, ..LimitsSpec::default() };
    limits.max_velocity_reverse = one_in(2).then_some(-min_velocity);
    limits.max_deceleration = one_in(2).then_some(-min_acceleration);
    limits.feed_rate = one_in(6).then_some(1.2 * max_velocity);
    limits.min_position = one_in(6).then_some(asked.start.position.min(asked.goal.position) - max_velocity);
    limits.max_position = one_in(6).then_some(asked.start.position.max(asked.goal.position));
    let rest = rests && !one_in(8);
    let along = one_in(2);
    let part = |state: State| match (rest, along) {
        (true, _) => State::at_rest(state.position),
        (_, true) => State { acceleration: 0.0, ..state },
        (_, false) => state,
    };
    let mut states = [part(asked.start), part(asked.goal)];
    for state in &mut states {
        state.position = spoiled(random, state.position);
        state.velocity = spoiled(random, state.velocity);
        state.acceleration = spoiled(random, state.acceleration);
    }
    limits.max_velocity = spoiled(random, limits.max_velocity);
    limits.max_acceleration = spoiled(random, limits.max_acceleration);
    limits.max_jerk = spoiled(random, limits.max_jerk);
    limits.feed_rate = limits.feed_rate.map(|given| spoiled(random, given));
    (states[0], states[1], limits)
}

/// How many were planned and how many refused.
fn check(mut spec: RequestSpec, seed: u64, count: usize, rests: bool) -> [usize; 2] {
    let mut series = MoveSeries::like(spec.clone()).unwrap();
    let mut random = Random(seed);
    let mut counts = [0; 2];
    for number in 0..count {
        let (start, goal, limits) = asked(&mut random, rests);
        let axis = &mut spec.axes[0];
        (axis.start, axis.goal, axis.limits) = (
            start,
            goal,
            LimitsSpec {
                max_snap: axis.limits.max_snap,
                max_higher_derivatives: axis.limits.max_higher_derivatives.clone(),
                ..limits
            },
        );
        series.limit(|limits| limits.clone_from(&axis.limits));
        let (one, other) = (in_series(&mut series, start, goal), alone(spec.clone()));
        assert_eq!(one, other, "{number}: {spec:?}");
        counts[usize::from(one.is_err())] += 1;
    }
    counts
}

#[test]
fn a_move_of_a_series_is_what_it_is_alone() {
    let mut all = [0; 2];
    for (index, policy) in (0..).zip(POLICIES) {
        for (family, count, rests) in [
            (Family::SCurve, 20_000, false),
            (Family::SCurve, 5_000, true),
            (Family::Trapezoidal, 8_000, true),
            (Family::Trigonometric, 4_000, true),
        ] {
            let [planned, refused] = check(like(family, policy), 100 + index, count, rests);
            assert!(
                planned > count / 4 && refused > count / 20,
                "{family:?} {policy:?}: {planned} {refused}"
            );
            all = [all[0] + planned, all[1] + refused];
        }
    }
    assert!(all[0] + all[1] >= 100_000, "{all:?}");
}

/// What takes the longer way.
#[test]
fn so_it_is_of_every_order_on_cycles_and_of_a_least_duration() {
    for order in 2..=6 {
        let mut spec = like(Family::Polynomial, ShortPathPolicy::Reject);
        spec.order = Some(order);
        spec.axes[0].limits.max_snap = (order >= 4).then_some(3.0);
        spec.axes[0].limits.max_higher_derivatives = vec![20.0; (order as usize).saturating_sub(4)];
        let [planned, refused] = check(spec, u64::from(order), 300, true);
        assert!(planned > 100 && refused > 10, "order {order}: {planned} {refused}");
    }
    for family in [Family::SCurve, Family::Trapezoidal, Family::Trigonometric] {
        let spec = like(family, ShortPathPolicy::Reject);
        let on_cycle = RequestSpec { end_on_cycle: true, ..spec.clone() };
        let long = RequestSpec { minimum_duration: Some(3.0), ..spec.clone() };
        let slow = RequestSpec { cycle_time_ns: Some(250_000), ..spec };
        for (seed, spec) in (0..).zip([on_cycle, long, slow]) {
            let [planned, refused] = check(spec, seed, 500, seed == 0 || family != Family::SCurve);
            assert!(planned > 100 && refused > 10, "{family:?}: {planned} {refused}");
        }
    }
}

/// A trapezoid's limit of jerk, where it is left out, is that of its stops: it comes from the limits of each move.
#[test]
fn a_jerk_that_is_left_out_follows_the_limits() {
    let mut spec = like(Family::Trapezoidal, ShortPathPolicy::Reject);
    spec.axes[0].limits.max_jerk = 0.0;
    let mut series = MoveSeries::like(spec.clone()).unwrap();
    for acceleration in [1.0, 2.0, 4.0] {
        spec.axes[0].limits.max_acceleration = acceleration;
        spec.axes[0].goal = State::at_rest(acceleration);
        series.limit(|limits| limits.max_acceleration = acceleration);
        let goal = spec.axes[0].goal;
        assert_eq!(in_series(&mut series, State::at_rest(0.0), goal), alone(spec.clone()));
    }
}

type Change<'a> = &'a dyn Fn(&mut RequestSpec);

#[test]
fn what_is_wrong_with_all_is_said_once() {
    let wrong = |change: Change<'_>| {
        let mut spec = like(Family::SCurve, ShortPathPolicy::Reject);
        change(&mut spec);
        MoveSeries::like(spec).unwrap_err()
    };
    let rows: [(Change<'_>, &str, Why); 5] = [
        (&|spec| spec.axes.clear(), "axes", Why::NoAxes),
        (
            &|spec| {
                let other = spec.axes[0].clone();
                spec.axes.push(other);
            },
            "axes",
            Why::NotOneAxis { given: 2 },
        ),
        (&|spec| spec.axes[0].axis.clear(), "axes[0].axis", Why::NameEmpty),
        (&|spec| spec.family = Ok(Family::Polynomial), "order", Why::OrderMissing),
        (
            &|spec| spec.minimum_duration = Some(-1.0),
            "minimum_duration",
            Why::NegativeDuration { given: -1.0 },
        ),
    ];
    for (change, field, why) in rows {
        let expected = InvalidField::new(Field::named(field), why);
        assert_eq!(wrong(change).as_slice(), [expected]);
    }
    // Start, goal and limits are for each move to say.
    let mut spec = like(Family::SCurve, ShortPathPolicy::Reject);
    spec.axes[0].limits = LimitsSpec::default();
    spec.axes[0].start.position = f64::NAN;
    assert!(MoveSeries::like(spec).is_ok());
}
