//! What may be asked of a motion under way, and what became of it.

use planner::motion::{AxisPoints, Points};
use planner::{LimitsSpec, State};

use prost::Message as _;
use xxhash_rust::xxh3::xxh3_64;

use crate::pb;
use crate::stream::{Ask, GoalSpec, Operation, OperationResult};
use pb::operation::Operation as Wire;

impl From<pb::Operation> for Operation {
    fn from(wire: pb::Operation) -> Self {
        let pb::Operation { request_id, not_before_cycle, operation } = wire;
        Self { request_id, not_before_cycle, ask: operation.map(Into::into) }
    }
}

impl From<Operation> for pb::Operation {
    fn from(operation: Operation) -> Self {
        let Operation { request_id, not_before_cycle, ask } = operation;
        Self { request_id, not_before_cycle, operation: ask.map(Into::into) }
    }
}

impl Operation {
    /// What is asked for, whatever it is called and whenever it is to be done: XXH3-64, seed 0, of its encoding without either. Never 0.
    #[must_use]
    pub fn digest(&self) -> u64 {
        let what = Self { request_id: String::new(), not_before_cycle: None, ask: self.ask.clone() };
        xxh3_64(&pb::Operation::from(what).encode_to_vec()).max(1)
    }
}

impl From<Wire> for Ask {
    fn from(wire: Wire) -> Self {
        match wire {
            Wire::Hold(pb::Hold {}) => Self::Hold,
            Wire::Resume(pb::ResumeMotion {}) => Self::Resume,
            Wire::SetOverride(pb::SetOverride { factor }) => Self::Override(factor),
            Wire::Retarget(pb::Retarget { goals }) => {
                Self::Retarget(goals.into_iter().map(Into::into).collect())
            }
            Wire::AppendPvt(pb::AppendPvt { axes, last }) => {
                let axes = axes.into_iter().map(Into::into).collect();
                Self::Append(Points { axes, last })
            }
            Wire::Stop(pb::Stop {}) => Self::Stop,
        }
    }
}

impl From<Ask> for Wire {
    fn from(ask: Ask) -> Self {
        match ask {
            Ask::Hold => Self::Hold(pb::Hold {}),
            Ask::Resume => Self::Resume(pb::ResumeMotion {}),
            Ask::Override(factor) => Self::SetOverride(pb::SetOverride { factor }),
            Ask::Retarget(goals) => {
                Self::Retarget(pb::Retarget { goals: goals.into_iter().map(Into::into).collect() })
            }
            Ask::Append(Points { axes, last }) => {
                let axes = axes.into_iter().map(Into::into).collect();
                Self::AppendPvt(pb::AppendPvt { axes, last })
            }
            Ask::Stop => Self::Stop(pb::Stop {}),
        }
    }
}

impl From<pb::AxisMove> for GoalSpec {
    /// The axis is known to the stream: its kind, and where it starts, are what they are.
    fn from(wire: pb::AxisMove) -> Self {
        let pb::AxisMove { axis, kind: _, start: _, goal, limits } = wire;
        Self { axis, goal: goal.map(State::from), limits: limits.map(LimitsSpec::from) }
    }
}

impl From<GoalSpec> for pb::AxisMove {
    fn from(spec: GoalSpec) -> Self {
        let GoalSpec { axis, goal, limits } = spec;
        Self { axis, goal: goal.map(Into::into), limits: limits.map(Into::into), ..Self::default() }
    }
}

impl From<pb::PvtAxis> for AxisPoints {
    /// The axis is known to the stream: kind, limits and where it starts are what they are.
    fn from(wire: pb::PvtAxis) -> Self {
        let pb::PvtAxis { axis, kind: _, limits: _, start: _, times, positions, velocities } = wire;
        Self { axis, times, positions, velocities }
    }
}

impl From<AxisPoints> for pb::PvtAxis {
    fn from(points: AxisPoints) -> Self {
        let AxisPoints { axis, times, positions, velocities } = points;
        Self { axis, times, positions, velocities, ..Self::default() }
    }
}

impl From<pb::OperationResult> for OperationResult {
    fn from(wire: pb::OperationResult) -> Self {
        let pb::OperationResult {
            request_id,
            effective_cycle,
            rest_cycle,
            revision,
            on_path,
            operation_digest,
        } = wire;
        Self { request_id, effective_cycle, rest_cycle, revision, on_path, operation_digest }
    }
}

impl From<OperationResult> for pb::OperationResult {
    fn from(result: OperationResult) -> Self {
        let OperationResult { request_id, effective_cycle, rest_cycle, revision, on_path, operation_digest } =
            result;
        Self { request_id, effective_cycle, rest_cycle, revision, on_path, operation_digest }
    }
}
