//! rsruckig, the peer: a pure Rust port of Ruckig (Berscheid and Kröger, 2021), asked the same questions.

use planner::{Limits, Problem, ShortPathPolicy, State};
use rsruckig::prelude::{
    DataArrayOrVec, InputParameter, Ruckig, RuckigResult, Synchronization, ThrowErrorHandler, Trajectory,
};

use super::{Random, ramp_length};

/// One axis, with nothing asked that would cost the peer time.
pub(crate) struct Peer {
    ruckig: Ruckig<1, ThrowErrorHandler>,
    pub(crate) trajectory: Trajectory<1>,
}

impl Peer {
    pub(crate) fn new() -> Self {
        Self { ruckig: Ruckig::new(None, 0.001), trajectory: Trajectory::new(None) }
    }

    /// The peer's duration [s]; none where it refuses.
    #[inline]
    pub(crate) fn duration(&mut self, input: &InputParameter<1>) -> Option<f64> {
        match self.ruckig.calculate(input, &mut self.trajectory) {
            Ok(RuckigResult::Working | RuckigResult::Finished) => Some(self.trajectory.get_duration()),
            _ => None,
        }
    }
}

pub(crate) fn input(problem: &Problem) -> InputParameter<1> {
    let mut input = InputParameter::new(None);
    let (start, goal, limits) = (problem.start(), problem.goal(), problem.limits());
    input.synchronization = Synchronization::None;
    input.current_position = one(start.position);
    input.current_velocity = one(start.velocity);
    input.target_position = one(goal.position);
    input.target_velocity = one(goal.velocity);
    input.max_velocity = one(limits.velocity_forward());
    input.max_acceleration = one(limits.acceleration());
    input.max_jerk = one(limits.jerk());
    input
}

fn one(value: f64) -> DataArrayOrVec<f64, 1> {
    DataArrayOrVec::Stack([value])
}

/// Numbers of order one, or over six decades, as feasible problems: one in eight at a border between two shapes.
pub(crate) fn problem(random: &mut Random, rest_to_rest: bool, wide: bool) -> Problem {
    let mut limit = || if wide { random.decades(1e-3, 1e3) } else { random.decades(0.1, 10.0) };
    let (velocity, acceleration, jerk) = (limit(), limit(), limit());
    let mut speed = || if rest_to_rest { 0.0 } else { velocity * random.unit() };
    let (from, to) = (speed(), speed());
    let way =
        |peak: f64| ramp_length(from, peak, acceleration, jerk) + ramp_length(peak, to, acceleration, jerk);
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
    let limits = Limits::symmetric(velocity, acceleration, jerk).unwrap();
    Problem::new(state(0.0, from), state(length, to), limits, ShortPathPolicy::Reject).unwrap()
}
