//! Plans of which many go into one message: how much is told of each, and what stands in the place of one that is refused.

use planner::{InvalidFields, Judged, Why};

use super::choice::{detail_from_wire, detail_to_wire};
use super::plan::plan_from_wire;
use crate::{Detail, Reason, Rejected, pb};

impl Detail {
    /// From the field called `detail`.
    ///
    /// # Errors
    /// [`Why::UnknownChoice`].
    pub fn from_wire(given: i32) -> Result<Self, InvalidFields> {
        detail_from_wire(given).map_err(|why: Why| InvalidFields::one(planner::Field::named("detail"), why))
    }

    /// As the field called `detail`.
    #[must_use]
    pub fn to_wire(self) -> i32 {
        detail_to_wire(self)
    }
}

/// What became of one request of many, as [`Outcomes`](super::Outcomes) tells it. The certificate is computed here again, from the
/// segments that came.
///
/// # Errors
/// What is no outcome: a plan that is none, a refusal with a reason that this version does not know, nothing at all.
pub fn outcome_from_wire(wire: pb::PlanOutcome) -> Result<Result<Judged, Rejected>, Rejected> {
    let pb::PlanOutcome { outcome } = wire;
    match outcome {
        Some(pb::plan_outcome::Outcome::Plan(plan)) => Ok(Ok(Judged::new(plan_from_wire(plan)?))),
        Some(pb::plan_outcome::Outcome::Refusal(status)) => {
            Rejected::from_bytes(&status).map(Err).ok_or_else(|| {
                let text =
                    "a request is refused for a reason that this version does not know: compare versions";
                Rejected::new(Reason::MessageInvalid, text)
            })
        }
        None => Err(Rejected::new(Reason::MessageInvalid, "an outcome is neither a plan nor a refusal")),
    }
}
