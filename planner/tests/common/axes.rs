//! Several axes at once: problems, and the peer's answers to them.

use rsruckig::prelude::{
    DataArrayOrVec, InputParameter, Ruckig, RuckigResult, Synchronization, ThrowErrorHandler, Trajectory,
};

use super::random::Random;
use super::states::{Kind, Question, question};

/// The most axes that are drawn.
pub(crate) const SEVEN: usize = 7;

/// Problems of a kind for several axes, of which some are the same, or nearly so.
pub(crate) fn questions(random: &mut Random, kind: Kind, axes: usize) -> Vec<Question> {
    let mut drawn: Vec<Question> = Vec::with_capacity(axes);
    for _ in 0..axes {
        let mut one = question(random, kind);
        match (random.bits() % 8, drawn.last()) {
            (0, Some(&last)) => one = last,
            (1, Some(&last)) => {
                one = last;
                one.goal.position += (one.goal.position - one.start.position) * random.between(-1e-9, 1e-9);
            }
            // At rest where it is.
            (2, _) => {
                let there = planner::State::at_rest(one.start.position);
                (one.start, one.goal) = (there, there);
            }
            _ => {}
        }
        drawn.push(one);
    }
    drawn
}

/// The peer, of as many axes as are asked for.
pub(crate) struct Peer {
    solvers: Vec<Solver>,
}

struct Solver {
    ruckig: Ruckig<0, ThrowErrorHandler>,
    trajectory: Trajectory<0>,
}

/// As the peer is asked: of a number of axes that it knows beforehand, or, where that is zero, of any.
pub(crate) fn input<const AXES: usize>(asked: &[Question]) -> InputParameter<AXES> {
    let mut input = InputParameter::new((AXES == 0).then_some(asked.len()));
    let all = |part: fn(&Question) -> f64| {
        if AXES == 0 {
            return DataArrayOrVec::Heap(asked.iter().map(part).collect());
        }
        DataArrayOrVec::Stack(std::array::from_fn(|axis| part(&asked[axis])))
    };
    input.synchronization = Synchronization::Time;
    input.current_position = all(|asked| asked.start.position);
    input.current_velocity = all(|asked| asked.start.velocity);
    input.current_acceleration = all(|asked| asked.start.acceleration);
    input.target_position = all(|asked| asked.goal.position);
    input.target_velocity = all(|asked| asked.goal.velocity);
    input.target_acceleration = all(|asked| asked.goal.acceleration);
    input.max_velocity = all(|asked| asked.bounds.max_velocity);
    input.min_velocity = Some(all(|asked| asked.bounds.min_velocity));
    input.max_acceleration = all(|asked| asked.bounds.max_acceleration);
    input.min_acceleration = Some(all(|asked| asked.bounds.min_acceleration));
    input.max_jerk = all(|asked| asked.bounds.max_jerk);
    input
}

impl Peer {
    pub(crate) fn new() -> Self {
        let solver = |axes: usize| Solver {
            ruckig: Ruckig::new(Some(axes), 0.001),
            trajectory: Trajectory::new(Some(axes)),
        };
        Self { solvers: (0..=SEVEN).map(solver).collect() }
    }

    /// The peer's duration [s]; none where it refuses.
    pub(crate) fn duration(&mut self, asked: &[Question]) -> Option<f64> {
        let input = input::<0>(asked);
        let Solver { ruckig, trajectory } = &mut self.solvers[asked.len()];
        match ruckig.calculate(&input, trajectory) {
            Ok(RuckigResult::Working | RuckigResult::Finished) => Some(trajectory.get_duration()),
            _ => None,
        }
    }

    /// Does every axis of the peer's last answer end at its goal, as exactly as ours?
    pub(crate) fn arrives(&self, asked: &[Question], end: f64) -> bool {
        let trajectory = &self.solvers[asked.len()].trajectory;
        let Some(section) = trajectory.profiles.last() else { return false };
        asked.iter().zip(section.iter()).all(|(asked, last)| {
            let start = asked.start.position;
            let extent = last.p.iter().fold(0.0f64, |most, p| most.max((p - start).abs()));
            let rounding = 4.0 * f64::EPSILON * start.abs().max(asked.goal.position.abs());
            let fastest = last.v.iter().fold(0.0f64, |most, v| most.max(v.abs()));
            (last.p[7] - asked.goal.position).abs() <= end * extent + rounding
                && (last.v[7] - asked.goal.velocity).abs() <= end * fastest
        })
    }
}

/// The peer, of a number of axes that it knows beforehand, as it is fastest.
pub(crate) struct Fixed<const AXES: usize> {
    ruckig: Ruckig<AXES, ThrowErrorHandler>,
    pub(crate) trajectory: Trajectory<AXES>,
}

impl<const AXES: usize> Fixed<AXES> {
    pub(crate) fn new() -> Self {
        Self { ruckig: Ruckig::new(None, 0.001), trajectory: Trajectory::new(None) }
    }

    /// The peer's duration [s]; none where it refuses.
    pub(crate) fn duration(&mut self, input: &InputParameter<AXES>) -> Option<f64> {
        match self.ruckig.calculate(input, &mut self.trajectory) {
            Ok(RuckigResult::Working | RuckigResult::Finished) => Some(self.trajectory.get_duration()),
            _ => None,
        }
    }
}
