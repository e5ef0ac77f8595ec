//! A motion under way.

use planner::motion::{InvalidMotion, MotionParts, Override};
use planner::{Accepted, Family, Field, InvalidFields, Judged, Plan, Quantity, TimeLaw, Why};

use super::choice::{phase_from_wire, phase_to_wire};
use super::encode::plan_unexplained;
use super::field::missing;
use super::plan::{segment_from_wire, segment_to_wire};
use super::{accepted, plan_as_it_is_in, plan_to_wire, within};
use crate::stream::{Motion, OperationResult, RECENT_RESULTS};
use crate::{Digest, Reason, Rejected, pb};

/// The motion of a message that has to have one.
pub(super) fn motion_in(wire: Option<pb::Motion>) -> Result<Motion, Rejected> {
    motion_from_wire(wire.ok_or_else(|| missing("motion", "a motion"))?)
}

/// A motion under way, with plans that the judge accepts.
///
/// # Errors
/// What is wrong with it, field by field, and plans that the judge rejects.
pub fn motion_from_wire(wire: pb::Motion) -> Result<Motion, Rejected> {
    let pb::Motion {
        revision,
        from_cycle,
        digest_before,
        plan,
        override_factor,
        phase,
        base,
        base_time,
        closing_from_cycle,
        recent,
    } = wire;
    let factor = Override::new(override_factor).map_err(|refused| {
        Rejected::for_field("motion.override_factor", Reason::OverrideOutOfRange, refused.to_string())
    })?;
    let base_time = base_time_from_wire(base_time).map_err(|invalid| within("motion", invalid))?;
    let made = if revision > 0 { Made::OperatedOn } else { Made::Planned };
    let parts = MotionParts {
        revision,
        from_cycle,
        plan: spliced_in("motion.plan", plan, made)?,
        factor,
        phase: phase_from_wire(phase).map_err(|why| of_field("motion.phase", why))?,
        base: base.map(|base| spliced_in("motion.base", Some(base), Made::Planned)).transpose()?,
        base_time,
        closing_from_cycle,
    };
    let under_way = planner::motion::Motion::try_from(parts).map_err(rejected)?;
    let forgotten = recent.len().saturating_sub(RECENT_RESULTS);
    let recent = recent.into_iter().skip(forgotten).map(OperationResult::from).collect();
    Ok(Motion { under_way, digest_before: Digest::from(digest_before), recent })
}

/// A motion under way, with everything that another server needs to go on with it.
#[must_use]
pub fn motion_to_wire(motion: &Motion) -> pb::Motion {
    motion_with(motion, plan_to_wire)
}

/// For a server that judges it anew: without what follows from the rest of its plans.
pub(super) fn motion_unexplained(motion: &Motion) -> pb::Motion {
    motion_with(motion, plan_unexplained)
}

fn motion_with(motion: &Motion, plan_to_wire: fn(&Judged) -> pb::Plan) -> pb::Motion {
    let Motion { under_way, digest_before, recent } = motion;
    pb::Motion {
        revision: under_way.revision(),
        from_cycle: under_way.from_cycle(),
        digest_before: u64::from(*digest_before),
        plan: Some(plan_to_wire(under_way.accepted().judged())),
        override_factor: under_way.factor().get(),
        phase: phase_to_wire(under_way.phase()),
        base: under_way.base().map(|base| plan_to_wire(base.judged())),
        base_time: under_way.base_time().map_or_else(Vec::new, base_time_to_wire),
        closing_from_cycle: under_way.closing_from_cycle(),
        recent: recent.iter().cloned().map(Into::into).collect(),
    }
}

/// Empty: the motion is not re-timed.
fn base_time_from_wire(wire: Vec<pb::AxisSegment>) -> Result<Option<TimeLaw>, InvalidFields> {
    if wire.is_empty() {
        return Ok(None);
    }
    let mut invalid = InvalidFields::default();
    let mut segments = Vec::with_capacity(wire.len());
    for (index, segment) in wire.into_iter().enumerate() {
        segments.extend(invalid.take_element("base_time", index, segment_from_wire(segment)));
    }
    invalid.into_result(())?;
    TimeLaw::new(segments).map(Some)
}

fn base_time_to_wire(law: &TimeLaw) -> Vec<pb::AxisSegment> {
    law.profile().segments().iter().map(|segment| segment_to_wire(&segment)).collect()
}

/// How the plan of a motion came about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Made {
    /// As any other, or by a splice.
    Planned,
    /// Perhaps by another law of time: then its method is that of the path, its pieces are of a higher degree, and what they keep is what
    /// it says, which the judge holds it to. It may be played on where the path is forgotten, by a stop or for other goals.
    OperatedOn,
}

/// The plan of a motion in the field called `field`, accepted as any other; but what was spliced into a motion whose
/// acceleration may jump promises no jerk, which an S-curve otherwise does.
fn spliced_in(field: &str, wire: Option<pb::Plan>, made: Made) -> Result<Accepted, Rejected> {
    let (plan, misstated) = plan_as_it_is_in(field, wire)?;
    let plan = accepted(field, plan)?;
    let jumps = jumps_into_its_start(plan.plan());
    let excused = |name: &str| match name {
        "guaranteed" => jumps || made == Made::OperatedOn,
        _ => made == Made::OperatedOn && name.starts_with("method."),
    };
    let mut wrong = InvalidFields::default();
    for invalid in misstated.as_slice().iter().filter(|invalid| !excused(invalid.field.as_str())) {
        wrong.push(invalid.clone());
    }
    wrong.into_result(plan).map_err(|inner| within(field, inner))
}

fn jumps_into_its_start(plan: &Plan) -> bool {
    plan.method().family == Family::SCurve
        && plan.method().pvt.is_none()
        && plan.guarantees(Quantity::Velocity)
        && plan.guarantees(Quantity::Acceleration)
}

fn of_field(field: &str, why: Why) -> Rejected {
    InvalidFields::one(Field::named(field), why).into()
}

/// Each of them begins with the field that it is about.
fn rejected(invalid: InvalidMotion) -> Rejected {
    let text = invalid.to_string();
    let field = match invalid {
        InvalidMotion::EndsAtSpeed { .. } => "motion.plan",
        InvalidMotion::TooManyCycles { .. } => "motion.from_cycle",
        InvalidMotion::BaseMissing | InvalidMotion::BaseDiffers => "motion.base",
        InvalidMotion::BaseTimeAlone | InvalidMotion::OffBase => "motion.base_time",
        InvalidMotion::ClosingOutside { .. } => "motion.closing_from_cycle",
        _ => "motion",
    };
    let reason = match invalid {
        InvalidMotion::EndsAtSpeed { .. } => Reason::StateNotAtRest,
        InvalidMotion::BaseMissing | InvalidMotion::BaseTimeAlone => Reason::FieldMissing,
        InvalidMotion::OffBase => Reason::JoinMismatch,
        _ => Reason::ValueOutOfRange,
    };
    Rejected::for_field(field, reason, text)
}
