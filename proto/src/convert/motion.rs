//! A motion under way.

use planner::motion::{InvalidMotion, MotionParts, Override};
use planner::{Accepted, Family, Field, InvalidFields, Plan, Quantity, Why};

use super::choice::{phase_from_wire, phase_to_wire};
use super::field::missing;
use super::{accepted, plan_as_it_is_in, plan_to_wire, within};
use crate::stream::{Motion, OperationResult, RECENT_RESULTS};
use crate::{Digest, Reason, Rejected, pb};

pub(super) fn motion_from_wire(wire: Option<pb::Motion>) -> Result<Motion, Rejected> {
    let wire = wire.ok_or_else(|| missing("motion", "a motion"))?;
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
    if !base_time.is_empty() {
        let why = Why::NotImplemented {
            what: "a motion that is re-timed along its path",
            instead: "a motion without base_time",
        };
        return Err(of_field("motion.base_time", why));
    }
    let factor = Override::new(override_factor).map_err(|refused| {
        Rejected::for_field("motion.override_factor", Reason::OverrideOutOfRange, refused.to_string())
    })?;
    let parts = MotionParts {
        revision,
        from_cycle,
        plan: spliced_in("motion.plan", plan)?,
        factor,
        phase: phase_from_wire(phase).map_err(|why| of_field("motion.phase", why))?,
        base: base.map(|base| spliced_in("motion.base", Some(base))).transpose()?,
        closing_from_cycle,
    };
    let under_way = planner::motion::Motion::try_from(parts).map_err(rejected)?;
    let forgotten = recent.len().saturating_sub(RECENT_RESULTS);
    let recent = recent.into_iter().skip(forgotten).map(OperationResult::from).collect();
    Ok(Motion { under_way, digest_before: Digest::from(digest_before), recent })
}

pub(super) fn motion_to_wire(motion: &Motion) -> pb::Motion {
    let Motion { under_way, digest_before, recent } = motion;
    pb::Motion {
        revision: under_way.revision(),
        from_cycle: under_way.from_cycle(),
        digest_before: u64::from(*digest_before),
        plan: Some(plan_to_wire(under_way.accepted().judged())),
        override_factor: under_way.factor().get(),
        phase: phase_to_wire(under_way.phase()),
        base: under_way.base().map(|base| plan_to_wire(base.judged())),
        base_time: Vec::new(),
        closing_from_cycle: under_way.closing_from_cycle(),
        recent: recent.iter().cloned().map(Into::into).collect(),
    }
}

/// The plan of a motion in the field called `field`, accepted as any other; but what was spliced into a motion whose
/// acceleration may jump promises no jerk, which an S-curve otherwise does.
fn spliced_in(field: &str, wire: Option<pb::Plan>) -> Result<Accepted, Rejected> {
    let (plan, misstated) = plan_as_it_is_in(field, wire)?;
    let plan = accepted(field, plan)?;
    let jumps = jumps_into_its_start(plan.plan());
    let mut wrong = InvalidFields::default();
    for invalid in
        misstated.as_slice().iter().filter(|invalid| !(jumps && invalid.field.as_str() == "guaranteed"))
    {
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
        InvalidMotion::ClosingOutside { .. } => "motion.closing_from_cycle",
        _ => "motion",
    };
    let reason = match invalid {
        InvalidMotion::EndsAtSpeed { .. } => Reason::StateNotAtRest,
        InvalidMotion::BaseMissing => Reason::FieldMissing,
        _ => Reason::ValueOutOfRange,
    };
    Rejected::for_field(field, reason, text)
}
