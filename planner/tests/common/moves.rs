//! Moves of one axis along its travel, as both the planner and a peer plan them.

use planner::{LimitsSpec, Problem, ShortPathPolicy, State};

use super::ramp::ramp_length;
use super::random::Random;

/// What kind of problems to draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Draw {
    pub(crate) rest_to_rest: bool,
    /// A deceleration of its own.
    pub(crate) asymmetric: bool,
    /// Limits over six decades, not of order one.
    pub(crate) wide: bool,
}

/// A feasible problem: one in eight at a border between two shapes.
pub(crate) fn problem(random: &mut Random, draw: Draw) -> Problem {
    let Draw { rest_to_rest, asymmetric, wide } = draw;
    let mut limit = || if wide { random.decades(1e-3, 1e3) } else { random.decades(0.1, 10.0) };
    let (velocity, acceleration, jerk) = (limit(), limit(), limit());
    let deceleration = if asymmetric { limit() } else { acceleration };
    let mut speed = || if rest_to_rest { 0.0 } else { velocity * random.unit() };
    let (from, to) = (speed(), speed());
    let way =
        |peak: f64| ramp_length(from, peak, acceleration, jerk) + ramp_length(peak, to, deceleration, jerk);
    let faster = from.max(to);
    let least = way(faster);
    let length = match random.bits() % 8 {
        0 => way(faster + (velocity - faster) * random.unit()),
        1 => way(velocity),
        2..=4 => least + (way(velocity) - least) * random.unit(),
        _ => way(velocity) * (1.0 + 3.0 * random.unit()),
    };
    let length = length.max(least * (1.0 + 1e-12));
    let sign = if random.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
    let state = |position: f64, velocity: f64| State {
        position: sign * position,
        velocity: sign * velocity,
        acceleration: 0.0,
    };
    let limits = LimitsSpec {
        max_velocity: velocity,
        max_acceleration: acceleration,
        max_deceleration: asymmetric.then_some(deceleration),
        max_jerk: jerk,
        ..LimitsSpec::default()
    };
    let limits = limits.try_into().unwrap();
    Problem::new(state(0.0, from), state(length, to), limits, ShortPathPolicy::Reject).unwrap()
}

/// The same with limits of snap and crackle that are reached about as often as the others.
pub(crate) fn with_higher_limits(random: &mut Random, problem: &Problem) -> Problem {
    let mut spec = problem.limits().spec().clone();
    let snap = spec.max_jerk * spec.max_jerk / spec.max_acceleration * random.decades(0.5, 8.0);
    spec.max_snap = Some(snap);
    spec.max_higher_derivatives = vec![snap * snap / spec.max_jerk * random.decades(0.5, 8.0)];
    let limits = spec.try_into().unwrap();
    Problem::new(problem.start(), problem.goal(), limits, ShortPathPolicy::Reject).unwrap()
}
