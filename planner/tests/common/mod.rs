//! Problems drawn to hurt: speeds that are equal but for an ulp, limits just reached, lengths at the very borders
//! between the shapes and an ulp beside them, nothing to go, almost nothing, and a million; round numbers; limits twelve
//! decades apart; starts far from zero; travel both ways.

#![allow(dead_code, unused_imports, reason = "each test takes what it needs")]

pub(crate) mod axes;
pub(crate) mod commands;
pub(crate) mod motions;
pub(crate) mod moves;
pub(crate) mod paths;
pub(crate) mod peer;
pub(crate) mod ramp;
pub(crate) mod random;
pub(crate) mod record;
pub(crate) mod s_curve;
pub(crate) mod splices;
pub(crate) mod states;
pub(crate) mod transit;
pub(crate) mod vectors;

use planner::{Limits, LimitsSpec, Problem, ShortPathPolicy, State};
use proptest::prelude::*;

pub(crate) use ramp::{ramp_length, ramp_time};
pub(crate) use random::Random;
pub(crate) use states::nudged;

impl From<&vectors::Record> for states::Question {
    fn from(record: &vectors::Record) -> Self {
        Self { start: record.start(), goal: record.goal(), bounds: record.bounds() }
    }
}

/// A problem before it is checked, so that it can be turned round, scaled and printed.
#[derive(Clone, Debug)]
pub(crate) struct Case {
    pub(crate) start: State,
    pub(crate) goal: State,
    pub(crate) limits: LimitsSpec,
    pub(crate) policy: ShortPathPolicy,
}

impl Case {
    pub(crate) fn limits(&self) -> Limits {
        Limits::try_from(self.limits.clone()).unwrap()
    }

    pub(crate) fn problem(&self) -> Problem {
        Problem::new(self.start, self.goal, self.limits(), self.policy).unwrap()
    }

    pub(crate) fn distance(&self) -> f64 {
        self.goal.position - self.start.position
    }

    /// The least length that the change of speed needs.
    pub(crate) fn least_length(&self) -> f64 {
        self.ramp_length(self.start.velocity.abs(), self.goal.velocity.abs())
    }

    pub(crate) fn ramp_length(&self, from: f64, to: f64) -> f64 {
        let limit = if to < from { self.deceleration() } else { self.limits.max_acceleration };
        ramp_length(from, to, limit, self.limits.max_jerk)
    }

    pub(crate) fn deceleration(&self) -> f64 {
        self.limits.max_deceleration.unwrap_or(self.limits.max_acceleration)
    }

    /// The larger of the limits of speeding up and of slowing down.
    pub(crate) fn hardest(&self) -> f64 {
        self.limits.max_acceleration.max(self.deceleration())
    }

    pub(crate) fn policy(&self, policy: ShortPathPolicy) -> Self {
        Self { policy, ..self.clone() }
    }

    /// Seen from the other side.
    pub(crate) fn mirrored(&self) -> Self {
        let LimitsSpec { max_velocity, max_velocity_reverse, min_position, max_position, .. } = self.limits;
        // The forward speed cannot be forbidden.
        let other_way = max_velocity_reverse.filter(|&limit| limit > 0.0);
        let limits = LimitsSpec {
            max_velocity: other_way.unwrap_or(max_velocity),
            max_velocity_reverse: Some(max_velocity),
            min_position: max_position.map(|position| -position),
            max_position: min_position.map(|position| -position),
            ..self.limits.clone()
        };
        Self { start: self.start.mirrored(), goal: self.goal.mirrored(), limits, policy: self.policy }
    }

    /// Run backwards, and then seen from the other side, so that it travels as before: from the goal's speed to the
    /// start's, and what sped up slows down.
    pub(crate) fn reversed(&self) -> Self {
        let start = State { position: -self.goal.position, ..self.goal };
        let goal = State { position: -self.start.position, ..self.start };
        let LimitsSpec { min_position, max_position, max_acceleration, .. } = self.limits;
        let limits = LimitsSpec {
            max_acceleration: self.deceleration(),
            max_deceleration: Some(max_acceleration),
            min_position: max_position.map(|position| -position),
            max_position: min_position.map(|position| -position),
            ..self.limits.clone()
        };
        Self { start, goal, limits, policy: self.policy }
    }

    /// In a unit of length that is smaller by `length`, and a unit of time that is smaller by `time`.
    pub(crate) fn scaled(&self, length: f64, time: f64) -> Self {
        let velocity = length / time;
        let acceleration = velocity / time;
        let state = |state: State| State {
            position: state.position * length,
            velocity: state.velocity * velocity,
            acceleration: state.acceleration * acceleration,
        };
        let spec = &self.limits;
        let limits = LimitsSpec {
            max_velocity: spec.max_velocity * velocity,
            max_acceleration: spec.max_acceleration * acceleration,
            max_deceleration: spec.max_deceleration.map(|limit| limit * acceleration),
            max_jerk: spec.max_jerk * (acceleration / time),
            max_velocity_reverse: spec.max_velocity_reverse.map(|limit| limit * velocity),
            min_position: spec.min_position.map(|limit| limit * length),
            max_position: spec.max_position.map(|limit| limit * length),
            feed_rate: spec.feed_rate.map(|limit| limit * velocity),
            ..spec.clone()
        };
        Self { start: state(self.start), goal: state(self.goal), limits, policy: self.policy }
    }
}

/// Limits of snap, and of the derivatives above it, from those of velocity, acceleration …
pub(crate) fn higher_limits(limits: &[f64]) -> (Option<f64>, Vec<f64>) {
    (limits.get(3).copied(), limits.iter().skip(4).copied().collect())
}

/// From rest to rest within the limits of velocity, acceleration … as many as there are; those that every axis has and that
/// are not given hold nothing back.
pub(crate) fn polynomial_problem(from: f64, to: f64, limits: &[f64]) -> Problem {
    let limit = |order: usize| limits.get(order - 1).copied().unwrap_or(1e50);
    let (max_snap, max_higher_derivatives) = higher_limits(limits);
    let spec = LimitsSpec {
        max_velocity: limit(1),
        max_acceleration: limit(2),
        max_jerk: limit(3),
        max_snap,
        max_higher_derivatives,
        ..LimitsSpec::default()
    };
    let limits = Limits::try_from(spec).unwrap();
    Problem::new(State::at_rest(from), State::at_rest(to), limits, ShortPathPolicy::Reject).unwrap()
}

/// Below the normal numbers the laws hold to fewer and fewer digits; what happens there has tests of its own.
fn normal(value: f64) -> f64 {
    if value < 1e-100 { 0.0 } else { value }
}

/// A magnitude over twelve decades, or a round number.
fn magnitude() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => (-6.0..6.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        2 => (-1.0..1.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        2 => prop::sample::select(vec![0.1, 0.2, 0.25, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 10.0, 100.0, 1000.0]),
    ]
}

/// Speed, acceleration, deceleration and jerk.
#[derive(Clone, Copy, Debug)]
struct Four {
    v: f64,
    a: f64,
    d: f64,
    j: f64,
}

impl Four {
    fn ramp(&self, from: f64, to: f64) -> f64 {
        ramp_length(from, to, if to < from { self.d } else { self.a }, self.j)
    }

    /// The length of two ramps over `peak`.
    fn way(&self, from: f64, peak: f64, to: f64) -> f64 {
        ramp_length(from, peak, self.a, self.j) + ramp_length(peak, to, self.d, self.j)
    }
}

/// Limits whose numbers may have to do with each other: `a²/j` equal to the speed, or to a part of it; a deceleration that
/// is the acceleration, nearly the acceleration, or has nothing to do with it.
fn limits() -> impl Strategy<Value = Four> {
    let related = (magnitude(), magnitude(), prop::sample::select(vec![0.5, 1.0, 1.5, 2.0, 3.0]), -1..=1i32)
        .prop_map(|(v, a, part, ulps)| (v, a, nudged(a * a / (v * part), ulps)));
    let three = prop_oneof![3 => (magnitude(), magnitude(), magnitude()), 1 => related];
    (three, 0..12u32, magnitude(), -2..=2i32).prop_map(|((v, a, j), how, other, ulps)| {
        let d = match how {
            0..=3 => a,
            4 => nudged(a, ulps),
            5 => nudged((v * j).sqrt(), ulps),
            6 => a * 2.0,
            7 => a * 0.5,
            8 => a * (0.1 + 10.0 * other / (1.0 + other)),
            9 => (a * a + v * j * other / (1.0 + other)).sqrt(),
            _ => other,
        };
        Four { v, a, d, j }
    })
}

/// One speed in `0..=cruise`; `corner` is a²/j.
fn speed(how: u32, part: f64, other: f64, ulps: i32, cruise: f64, corner: f64) -> f64 {
    let speed = match how {
        0..=2 => 0.0,
        3..=5 => cruise * part,
        6 => cruise,
        7 => nudged(cruise, -ulps.abs()),
        8 => other,
        9 => nudged(other, ulps),
        10 => nudged(other + corner, ulps),
        11 => nudged(other - corner, ulps),
        12 => nudged(other / 3.0, ulps),
        13 => nudged(0.5 * corner, ulps),
        14 => cruise * 1e-12,
        15 => other * (1.0 + 1e-9 * part),
        _ => cruise * part * part * part * part,
    };
    normal(speed.clamp(0.0, cruise))
}

/// A length for two speeds, at a border between shapes or beside it.
fn length(how: u32, part: f64, ulps: i32, ends: (f64, f64), limits: &Four) -> f64 {
    let (from, to) = ends;
    let (slower, faster) = (from.min(to), from.max(to));
    let gap = faster - slower;
    let Four { v, a, d, j } = *limits;
    let (near, far) = if from < to { (d, a) } else { (a, d) };
    let (near_corner, far_corner) = (near * near / j, far * far / j);
    let way = |peak: f64| limits.way(from, peak, to);
    let direct = limits.ramp(from, to);
    let length = match how {
        0 => 0.0,
        1 => 1e-12,
        2 => 1e6,
        3 | 4 => nudged(way(v), ulps),
        5 => nudged(way(faster + near_corner), ulps),
        6 | 7 => nudged(direct, ulps),
        8 => nudged(way(faster + (far_corner - gap).max(0.0)), ulps),
        9 => direct * part,
        10 => direct + (way(v) - direct) * part,
        11 => direct + (way(v) - direct) * part * part * part * part,
        12 => way(v) * (1.0 + part),
        13 => direct * (1.0 + 1e-12 * part),
        14 => nudged(limits.ramp(faster, 0.0), ulps),
        15 => nudged(limits.ramp(faster, faster / 3.0), ulps),
        16 => part,
        17 => (part * 10.0).round() / 10.0,
        18 => way(v) * 1e-9 * part,
        _ => way(v) * 10f64.powf(6.0 * part),
    };
    normal(length.clamp(0.0, 1e30))
}

const POLICIES: [ShortPathPolicy; 3] =
    [ShortPathPolicy::Reject, ShortPathPolicy::NearestVelocity, ShortPathPolicy::MatchStartVelocity];

fn drawn(policies: &'static [ShortPathPolicy], far: bool, feasible: bool) -> impl Strategy<Value = Case> {
    let kinds = (0..17u32, 0..17u32, 0..20u32, prop::sample::select(policies), 0..12u32);
    let parts = (0.0..1.0f64, 0.0..1.0f64, 0.0..1.0f64, -1.0..1.0f64);
    let nudges = (-2..=2i32, -2..=2i32, any::<bool>(), any::<bool>());
    (limits(), kinds, parts, nudges).prop_map(move |(limits, kinds, parts, nudges)| {
        let Four { v, a, d, j } = limits;
        let (start_kind, goal_kind, length_kind, policy, place) = kinds;
        let (start_part, goal_part, length_part, place_part) = parts;
        let (speed_ulps, length_ulps, backward, with_feed_rate) = nudges;
        let corner = |limit: f64| limit * limit / j;
        let from = speed(start_kind, start_part, v * goal_part, speed_ulps, v, corner(d));
        let to = speed(
            goal_kind,
            goal_part,
            from,
            speed_ulps,
            v,
            corner(if length_kind % 2 == 0 { a } else { d }),
        );
        let length = length(length_kind, length_part, length_ulps, (from, to), &limits);
        let length = if feasible { length.max(limits.ramp(from, to)) } else { length };
        let sign = if backward { -1.0 } else { 1.0 };
        let start_position = match place {
            _ if !far => 0.0,
            0 => 1.0,
            1 => 1e6 * place_part,
            2 => 1e9 * length * place_part,
            3 => -length * place_part * sign,
            4 => -sign * length,
            5 => -0.0,
            _ => 0.0,
        };
        // The cruise speed is the feed rate or the limit; the other one does nothing.
        let feed_rate = with_feed_rate.then_some(v);
        let max_velocity = if with_feed_rate { v * (1.0 + start_part) } else { v };
        let goal_position = start_position + sign * length;
        let ranged = place % 2 == 0;
        let (min, max) = (start_position.min(goal_position), start_position.max(goal_position));
        Case {
            start: State { position: start_position, velocity: sign * from, acceleration: 0.0 },
            goal: State { position: goal_position, velocity: sign * to, acceleration: 0.0 },
            limits: LimitsSpec {
                max_velocity: if backward && ranged { v * 7.0 } else { max_velocity },
                max_acceleration: a,
                // Left out, or the same number, or another one.
                max_deceleration: (d.to_bits() != a.to_bits() || ranged).then_some(d),
                max_jerk: j,
                max_velocity_reverse: ranged.then_some(if backward { max_velocity } else { 0.0 }),
                min_position: ranged.then_some(min),
                max_position: ranged.then_some(max),
                feed_rate,
                ..LimitsSpec::default()
            },
            policy,
        }
    })
}

/// Any problem that the planner takes.
pub(crate) fn any_case() -> impl Strategy<Value = Case> {
    drawn(&POLICIES, true, false)
}

/// As [`any_case`], from zero, where positions lose no digits.
pub(crate) fn case_from_zero() -> impl Strategy<Value = Case> {
    drawn(&POLICIES, false, false)
}

/// As [`case_from_zero`], and long enough to keep its end velocity.
pub(crate) fn feasible_case() -> impl Strategy<Value = Case> {
    drawn(&[ShortPathPolicy::Reject], false, true)
}
