//! rsruckig, the peer: a pure Rust port of Ruckig (Berscheid and Kröger, 2021), asked the same questions.

use planner::{BoundsSpec, Problem};
use rsruckig::prelude::{
    DataArrayOrVec, InputParameter, Ruckig, RuckigResult, Synchronization, ThrowErrorHandler, Trajectory,
};

use super::states::Question;

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

    /// Does the peer's last answer end at the goal, as exactly as ours? The peer is content with 1e-8 of whatever the unit is.
    pub(crate) fn arrives(&self, asked: &Question, end: f64) -> bool {
        let last = self.trajectory.profiles.last().and_then(|section| section.first());
        let Some(last) = last else { return false };
        let start = asked.start.position;
        let extent = last.p.iter().fold(0.0f64, |most, p| most.max((p - start).abs()));
        let rounding = 4.0 * f64::EPSILON * start.abs().max(asked.goal.position.abs());
        let fastest = last.v.iter().fold(0.0f64, |most, v| most.max(v.abs()));
        (last.p[7] - asked.goal.position).abs() <= end * extent + rounding
            && (last.v[7] - asked.goal.velocity).abs() <= end * fastest
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
    // The peer's limits have signs: with a velocity that does not change its own they are those of speeding up and
    // slowing down.
    let direction = problem.direction();
    let (up, down) = (limits.acceleration(), limits.deceleration());
    let (forward, backward) = if direction < 0.0 { (down, up) } else { (up, down) };
    input.max_acceleration = one(forward);
    input.min_acceleration = Some(one(-backward));
    input.max_jerk = one(limits.jerk());
    input
}

/// As the peer is asked for the motion between two states.
pub(crate) fn question(asked: &Question) -> InputParameter<1> {
    let mut input = InputParameter::new(None);
    let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
        asked.bounds;
    input.synchronization = Synchronization::None;
    input.current_position = one(asked.start.position);
    input.current_velocity = one(asked.start.velocity);
    input.current_acceleration = one(asked.start.acceleration);
    input.target_position = one(asked.goal.position);
    input.target_velocity = one(asked.goal.velocity);
    input.target_acceleration = one(asked.goal.acceleration);
    input.max_velocity = one(max_velocity);
    input.min_velocity = Some(one(min_velocity));
    input.max_acceleration = one(max_acceleration);
    input.min_acceleration = Some(one(min_acceleration));
    input.max_jerk = one(max_jerk);
    input
}

fn one(value: f64) -> DataArrayOrVec<f64, 1> {
    DataArrayOrVec::Stack([value])
}
