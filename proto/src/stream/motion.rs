//! A motion under way on a stream, and what may be asked of it.

use std::sync::Arc;

use planner::motion::{AxisGoal, Operation as Planned, Override, Points, Refused};
use planner::{Accepted, Field, InvalidField, InvalidFields, Limits, LimitsSpec, Plan, State, Why};

use super::Tails;
use crate::{Digest, Reason, Rejected};

/// How many results a motion carries: who repeats a request later than so many others gets no answer, but a second effect.
pub const RECENT_RESULTS: usize = 16;

/// A motion under way, with all that a stream of it needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// What is played, and what operations on it need.
    pub under_way: planner::motion::Motion,
    /// The digest of the cycle before its first.
    pub digest_before: Digest,
    /// The results of the last operations, oldest first; at most [`RECENT_RESULTS`].
    pub recent: Arc<[OperationResult]>,
}

impl Motion {
    /// A motion that begins now, in cycle 0.
    #[must_use]
    pub fn opened(under_way: planner::motion::Motion) -> Self {
        Self { under_way, digest_before: Digest::ZERO, recent: Arc::default() }
    }

    /// 0 at open, one more with every operation that took effect.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.under_way.revision()
    }

    /// What is played, with its certificate.
    #[must_use]
    pub fn accepted(&self) -> &Accepted {
        self.under_way.accepted()
    }

    /// What is played.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        self.under_way.plan()
    }

    /// The cycle of the plan that is played at `cycle` of the stream.
    #[must_use]
    pub fn plan_cycle(&self, cycle: u64) -> u64 {
        cycle.saturating_sub(self.under_way.from_cycle())
    }

    /// The cycle of the stream at which the plan has ended.
    #[must_use]
    pub fn last_cycle(&self) -> u64 {
        self.under_way.last_cycle()
    }

    /// The digest of `cycle`, from that of an earlier one; `known` where it is not earlier.
    ///
    /// Cycle 0 is in no digest.
    #[must_use]
    pub fn digest_from(&self, known: (u64, Digest), cycle: u64) -> Digest {
        let (before, mut digest) = known;
        if before < cycle {
            let mut sampler = self.plan().sampler();
            for cycle in before + 1..=cycle {
                let setpoints = sampler.at(self.plan_cycle(cycle));
                digest = digest.then(cycle, setpoints.map(|setpoint| setpoint.words()));
            }
        }
        digest
    }

    /// The way to rest of each axis from `cycle` on, which the judge accepts.
    ///
    /// # Errors
    /// [`Reason::PlanRejected`] where he does not, which should not be.
    pub fn tails(&self, cycle: u64) -> Result<Tails, Rejected> {
        let tail = self.under_way.tail(cycle)?;
        let plan = tail.as_ref().map(|tail| tail.motion.plan());
        Ok(Tails::new(plan.into_iter().flat_map(Plan::axes).map(|axis| axis.profile.clone())))
    }

    /// The motion of an axis that heard no more after `cycle` and came to rest by `tails`, which came with that cycle.
    ///
    /// `digest_before` is that of the cycle before it.
    ///
    /// # Errors
    /// Another way to rest, or one that the judge does not accept.
    pub fn starved(&self, cycle: u64, tails: &Tails, digest_before: Digest) -> Result<Self, Rejected> {
        let under_way = self.under_way.starved(cycle, tails.profiles().to_vec())?.motion;
        Ok(Self { under_way, digest_before, recent: Arc::clone(&self.recent) })
    }

    /// What became of the request, if it was one of the last.
    #[must_use]
    pub fn result_of(&self, request_id: &str) -> Option<&OperationResult> {
        self.recent.iter().rev().find(|result| result.request_id == request_id)
    }
}

/// An operation on a motion under way, as somebody asks for it.
#[derive(Clone, Debug, PartialEq)]
pub struct Operation {
    /// The same id again has the same answer and no second effect.
    pub request_id: String,
    /// Not before this cycle; `None`: as soon as can be.
    pub not_before_cycle: Option<u64>,
    /// What to do; `None` where that was not said, which is refused.
    pub ask: Option<Ask>,
}

/// What is asked for, not checked yet.
#[derive(Clone, Debug, PartialEq)]
pub enum Ask {
    /// To come to rest, ready to resume.
    Hold,
    /// To go on.
    Resume,
    /// To scale the feed rate by this factor \[1\].
    Override(f64),
    /// To go to these goals.
    Retarget(Vec<GoalSpec>),
    /// To go on through these points.
    Append(Points),
    /// To come to rest and forget the rest.
    Stop,
}

/// A new goal of one axis, not checked yet.
#[derive(Clone, Debug, PartialEq)]
pub struct GoalSpec {
    /// The axis.
    pub axis: String,
    /// Where it is to end; `None` where that was not said, which is refused.
    pub goal: Option<State>,
    /// What it may do from now on; `None`: as before.
    pub limits: Option<LimitsSpec>,
}

impl Operation {
    /// To be done as soon as can be.
    #[must_use]
    pub fn now(request_id: impl Into<String>, ask: Ask) -> Self {
        Self { request_id: request_id.into(), not_before_cycle: None, ask: Some(ask) }
    }

    /// What the planner is to do.
    ///
    /// # Errors
    /// An operation that does not say what, or in numbers that are none; each invalid field, with its path in the operation.
    pub fn planned(&self) -> Result<Planned, Rejected> {
        match &self.ask {
            Some(Ask::Hold) => Ok(Planned::Hold),
            Some(Ask::Resume) => Ok(Planned::Resume),
            Some(Ask::Stop) => Ok(Planned::Stop),
            Some(Ask::Override(factor)) => {
                Override::new(*factor).map(Planned::Override).map_err(Rejected::from)
            }
            Some(Ask::Retarget(goals)) => {
                goals_of(goals).map(Planned::Retarget).map_err(|invalid| crate::within("retarget", invalid))
            }
            Some(Ask::Append(points)) => Ok(Planned::Append(points.clone())),
            None => {
                let text = "the operation says not what to do: set one of hold, resume, set_override, retarget, \
                            append_pvt or stop";
                Err(Rejected::new(Reason::ProtocolOrder, text))
            }
        }
    }
}

fn goals_of(goals: &[GoalSpec]) -> Result<Vec<AxisGoal>, InvalidFields> {
    let mut invalid = InvalidFields::default();
    let mut checked = Vec::with_capacity(goals.len());
    for (index, GoalSpec { axis, goal, limits }) in goals.iter().enumerate() {
        let field = Field::named("limits").within(&Field::element("goals", index));
        let limits = match limits.clone().map(Limits::try_from).transpose() {
            Ok(limits) => limits,
            Err(inner) => {
                invalid.extend_within(&field, inner);
                None
            }
        };
        let Some(goal) = *goal else {
            let path = Field::named("goal").within(&Field::element("goals", index));
            invalid.push(InvalidField::new(path, Why::Missing { what: "where the axis is to end" }));
            continue;
        };
        checked.push(AxisGoal { axis: axis.clone(), goal, limits });
    }
    invalid.into_result(checked)
}

/// Why `operation` is not done, with paths in the operation on the wire.
#[must_use]
pub fn refused_operation(operation: &Planned, refused: Refused) -> Rejected {
    match (operation, refused) {
        (Planned::Retarget(_), Refused::Invalid(invalid)) => crate::within("retarget", invalid),
        (Planned::Append(_), Refused::Invalid(invalid)) => crate::within("append_pvt", invalid),
        (_, refused) => refused.into(),
    }
}

impl From<Refused> for Rejected {
    /// Why an operation is not done: paths are those in the operation.
    fn from(refused: Refused) -> Self {
        let text = refused.to_string();
        match refused {
            Refused::NotAFactor { given } => {
                Self::for_field("set_override.factor", Reason::OverrideOutOfRange, text)
                    .with("given", planner::Shortest(given))
            }
            Refused::OverrideOutOfRange { given, greatest } => {
                Self::for_field("set_override.factor", Reason::OverrideOutOfRange, text)
                    .with("given", planner::Shortest(given))
                    .with("nearest", planner::Shortest(greatest))
            }
            Refused::Stopped { rest_cycle } => {
                Self::new(Reason::Stopped, text).with("rest_cycle", rest_cycle)
            }
            Refused::StreamFinished => Self::new(Reason::StreamFinished, text),
            Refused::BeforeMotion { given, first } => {
                Self::for_field("not_before_cycle", Reason::ValueOutOfRange, text)
                    .with("given", given)
                    .with("nearest", first)
            }
            Refused::PositionLimit { axis, reached, allowed, limit, .. } => {
                Self::new(Reason::PositionLimit, text)
                    .with("axis", axis)
                    .with("limit", limit)
                    .with("given", planner::Shortest(reached))
                    .with("nearest", planner::Shortest(allowed))
            }
            Refused::OffLine { axis, given, nearest, .. } => {
                Self::new(Reason::PhaseSynchronizationImpossible, text)
                    .with("axis", axis)
                    .with("given", planner::Shortest(given))
                    .with("nearest", planner::Shortest(nearest))
            }
            Refused::NotThroughPoints => Self::for_field("append_pvt", Reason::ProtocolOrder, text),
            Refused::AppendTooLate { closing_from_cycle } => {
                Self::new(Reason::AppendTooLate, text).with("closing_from_cycle", closing_from_cycle)
            }
            Refused::Invalid(invalid) => invalid.into(),
            Refused::Rejected(rejection) => Self { message: text, ..rejection.into() },
            // Reasons of a later planner.
            _ => Self::new(Reason::PlanRejected, text),
        }
    }
}

/// What became of an operation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OperationResult {
    /// Of the operation.
    pub request_id: String,
    /// The first cycle whose setpoint may differ for it.
    pub effective_cycle: u64,
    /// The first cycle at rest.
    pub rest_cycle: u64,
    /// Of the motion from then on.
    pub revision: u64,
    /// Does the motion stay on its path?
    pub on_path: bool,
    /// Of what was [asked for](Operation::digest); 0 where that is not known.
    pub operation_digest: u64,
}

/// Why an operation was not done; nothing has changed.
#[derive(Clone, Debug, PartialEq)]
pub struct OperationRefusal {
    /// Of the operation.
    pub request_id: String,
    /// Why.
    pub rejected: Rejected,
}
