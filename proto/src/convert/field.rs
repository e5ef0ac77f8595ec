//! A plan as it stands in a field of a request: what is wrong with it is said with the path from the request down.

use planner::{Accepted, Field, InvalidFields, Plan};

use super::{accepted, plan_as_it_is};
use crate::{Reason, Rejected, pb};

/// The plan in the field called `field`.
///
/// # Errors
/// [`Reason::FieldMissing`] where there is none, and everything that is not a motion.
pub fn plan_in(field: &str, wire: Option<pb::Plan>) -> Result<Plan, Rejected> {
    let (plan, misstated) = plan_as_it_is_in(field, wire)?;
    misstated.into_result(plan).map_err(|inner| within(field, inner))
}

/// As [`plan_in`], with what the plan says of itself and is not beside it.
///
/// # Errors
/// [`Reason::FieldMissing`] where there is none, and everything that is not a motion.
pub fn plan_as_it_is_in(field: &str, wire: Option<pb::Plan>) -> Result<(Plan, InvalidFields), Rejected> {
    let wire = wire.ok_or_else(|| missing(field, "a plan, as Plan answers it"))?;
    plan_as_it_is(wire).map_err(|inner| within(field, inner))
}

/// The plan in the field called `field`, which the judge has nothing against. What he finds comes before what the plan says
/// of itself, since a change of the motion makes that untrue as well.
///
/// # Errors
/// Those of [`plan_in`] and of [`accepted`].
pub fn accepted_in(field: &str, wire: Option<pb::Plan>) -> Result<Accepted, Rejected> {
    let (plan, misstated) = plan_as_it_is_in(field, wire)?;
    let plan = accepted(field, plan)?;
    misstated.into_result(plan).map_err(|inner| within(field, inner))
}

/// Says that what is wrong is wrong within the field called `field`.
#[must_use]
pub fn within(field: &str, inner: InvalidFields) -> Rejected {
    let mut invalid = InvalidFields::default();
    invalid.extend_within(&Field::named(field), inner);
    invalid.into()
}

/// The refusal of a request without the field called `field`, which is to be `what`.
pub(super) fn missing(field: &str, what: &str) -> Rejected {
    Rejected::for_field(field, Reason::FieldMissing, format!("is not set: give {what}"))
}
