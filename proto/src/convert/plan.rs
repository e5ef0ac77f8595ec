use planner::{
    Adjustment, AdjustmentReason, AsymmetricType, AxisPlan, Classification, CycleTime, Derivatives,
    EightType, Field, InvalidField, InvalidFields, Law, Limits, LimitsSpec, Maker, Method, Plan, Profile,
    PvtMethod, PvtRegion, Quantity, Segment, SixCase, State, Why,
};

use super::choice::{
    family_from_wire, interpolation_from_wire, kind_from_wire, policy_from_wire, quantity_from_wire,
    short_path_from_wire, synchronization_from_wire,
};
use super::claims::Claims;
use super::duration::{duration_to_ns, note_malformed};
use crate::pb;

/// The most segments of one axis: more than those of 10 000 points for each of six axes would be of one.
const MAX_SEGMENTS: usize = 500_000;

/// What a region may be called.
pub(super) const REGIONS: &str = "R1, R2, R3, R4";

/// The motion that a plan on the wire describes. Certificate and explanation are computed again where they are needed,
/// and not believed; what else it says of itself has to be so.
///
/// # Errors
/// Everything that is not a motion: numbers that are not finite, laws that are not known, no axis. [`Why::Misstated`] and
/// [`Why::FingerprintMismatch`] for a number of cycles, a duration, a method, guarantees or a fingerprint that are not
/// those of the motion. Whether the pieces join and keep the limits is for the judge to say.
pub fn plan_from_wire(wire: pb::Plan) -> Result<Plan, InvalidFields> {
    let (plan, misstated) = plan_as_it_is(wire)?;
    misstated.into_result(plan)
}

/// As [`plan_from_wire`], with what the plan says of itself and is not beside it: for whoever wants the motion judged
/// all the same.
///
/// # Errors
/// Everything that is not a motion.
pub fn plan_as_it_is(wire: pb::Plan) -> Result<(Plan, InvalidFields), InvalidFields> {
    let mut invalid = InvalidFields::default();
    let mut guaranteed = Vec::with_capacity(wire.guaranteed.len());
    for (index, quantity) in wire.guaranteed.iter().enumerate() {
        match quantity_from_wire(*quantity) {
            Ok(quantity) => guaranteed.push(quantity),
            Err(why) => invalid.push(InvalidField::new(Field::element("guaranteed", index), why)),
        }
    }
    let method = wire.method.map(method_from_wire).transpose();
    let method = invalid.take(&Field::named("method"), method).unwrap_or_default();
    let claims = Claims::of(&wire, method, &guaranteed);
    let pb::Plan {
        fingerprint: _,
        planner_version,
        evaluation_version,
        method: _,
        guaranteed: _,
        cycle_time,
        cycle_count: _,
        duration: _,
        axes,
        certificate: _,
        explanation: _,
    } = wire;
    note_malformed(&mut invalid, "cycle_time", cycle_time.as_ref());
    let cycle_time = CycleTime::from_ns(cycle_time.as_ref().map(duration_to_ns));
    let cycle_time = invalid.take(&Field::default(), cycle_time).unwrap_or(CycleTime::MILLISECOND);
    let mut domain_axes = Vec::new();
    if axes.len() > planner::MAX_AXES {
        let why = Why::TooManyAxes { given: axes.len(), allowed: planner::MAX_AXES };
        return Err(InvalidFields::one(Field::named("axes"), why));
    }
    for (index, axis) in axes.into_iter().enumerate() {
        domain_axes.extend(invalid.take_element("axes", index, axis_from_wire(axis)));
    }
    if !invalid.is_empty() {
        return Err(invalid);
    }
    let plan = Plan::new(method.unwrap_or_default(), guaranteed, cycle_time, domain_axes)?;
    // Zero is a plan that somebody wrote by hand: it is ours to evaluate.
    let evaluation_version = match evaluation_version {
        0 => planner::EVALUATION_VERSION,
        given => given,
    };
    let plan = plan.made_by(Maker { planner_version, evaluation_version })?;
    let misstated = claims.against(&plan);
    Ok((plan, misstated))
}

fn method_from_wire(wire: pb::PlanMethod) -> Result<Method, InvalidFields> {
    let pb::PlanMethod {
        family,
        order,
        short_path_policy,
        synchronization,
        end_on_cycle,
        interpolation,
        policy,
    } = wire;
    let mut invalid = InvalidFields::default();
    let mut keep = |name, result: Result<(), Why>| invalid.note(name, result.err());
    let mut method = Method { order, end_on_cycle, ..Method::default() };
    keep("family", family_from_wire(family).map(|family| method.family = family));
    keep(
        "short_path_policy",
        short_path_from_wire(short_path_policy).map(|policy| method.short_path = policy),
    );
    let mode = synchronization_from_wire(synchronization);
    keep("synchronization", mode.map(|mode| method.synchronization = mode));
    keep(
        "policy",
        policy_from_wire(policy).map(|policy| {
            // The one without the other would be a policy for points that are not joined.
            method.pvt = (interpolation != 0).then_some(PvtMethod { policy, ..PvtMethod::default() });
        }),
    );
    keep(
        "interpolation",
        interpolation_from_wire(interpolation).map(|interpolation| {
            if let Some(pvt) = &mut method.pvt {
                pvt.interpolation = interpolation;
            }
        }),
    );
    if interpolation == 0 && policy != 0 {
        invalid.note("interpolation", Some(Why::Unspecified { choices: "S_SHAPED, CUBIC, QUINTIC" }));
    }
    invalid.into_result(method)
}

fn axis_from_wire(wire: pb::AxisPlan) -> Result<AxisPlan, InvalidFields> {
    let pb::AxisPlan { axis, kind, limits, segments, goal, reached, adjustments, classification } = wire;
    let mut invalid = InvalidFields::default();
    let kind = kind_from_wire(kind).map_err(|why| invalid.note("kind", Some(why))).ok();
    let limits = Limits::try_from(LimitsSpec::from(limits.unwrap_or_default()));
    let limits = invalid.take(&Field::named("limits"), limits);
    let goal = state_from_wire(&mut invalid, "goal", goal);
    let reached = state_from_wire(&mut invalid, "reached", reached);
    if segments.len() > MAX_SEGMENTS {
        let why = Why::TooManySegments { given: segments.len(), allowed: MAX_SEGMENTS };
        return Err(InvalidFields::one(Field::named("segments"), why));
    }
    let mut pieces = Vec::with_capacity(segments.len());
    for (index, segment) in segments.into_iter().enumerate() {
        pieces.extend(invalid.take_element("segments", index, segment_from_wire(segment)));
    }
    let mut domain_adjustments = Vec::with_capacity(adjustments.len());
    for (index, adjustment) in adjustments.into_iter().enumerate() {
        let adjustment = adjustment_from_wire(adjustment);
        domain_adjustments.extend(invalid.take_element("adjustments", index, adjustment));
    }
    let classification = classification_from_wire(classification.unwrap_or_default());
    let classification = invalid.take(&Field::named("classification"), classification);
    match (kind, limits, classification) {
        (Some(kind), Some(limits), Some((classification, pvt_regions))) if invalid.is_empty() => {
            Ok(AxisPlan {
                axis,
                kind,
                limits,
                profile: Profile::new(pieces, reached),
                goal,
                adjustments: domain_adjustments,
                classification,
                pvt_regions,
            })
        }
        _ => Err(invalid),
    }
}

/// A state all of whose numbers are finite; anything else is reported.
fn state_from_wire(invalid: &mut InvalidFields, name: &str, wire: Option<pb::AxisState>) -> State {
    let state = State::from(wire.unwrap_or_default());
    let parts =
        [("position", state.position), ("velocity", state.velocity), ("acceleration", state.acceleration)];
    for (part, given) in parts {
        if !given.is_finite() {
            let field = Field::named(part).within(&Field::named(name));
            invalid.push(InvalidField::new(field, Why::NotFinite { given }));
        }
    }
    state
}

pub(super) fn segment_to_wire(segment: &Segment) -> pb::AxisSegment {
    let Segment { duration, start, law } = *segment;
    let law = match law {
        Law::ConstantJerk(jerk) => pb::axis_segment::Law::Jerk(jerk),
        Law::Polynomial(derivatives) => {
            let derivatives = derivatives.as_slice().to_vec();
            pb::axis_segment::Law::Polynomial(pb::axis_segment::Polynomial { derivatives })
        }
        Law::CosineJerk { peak } => {
            pb::axis_segment::Law::CosineJerk(pb::axis_segment::CosineJerk { peak_jerk: peak })
        }
    };
    pb::AxisSegment { duration, start: Some(start.into()), law: Some(law) }
}

pub(super) fn segment_from_wire(wire: pb::AxisSegment) -> Result<Segment, InvalidFields> {
    let pb::AxisSegment { duration, start, law } = wire;
    let mut invalid = InvalidFields::default();
    let start = state_from_wire(&mut invalid, "start", start);
    if !duration.is_finite() {
        invalid.note("duration", Some(Why::NotFinite { given: duration }));
    } else if duration <= 0.0 {
        invalid.note("duration", Some(Why::DurationNotPositive { given: duration }));
    }
    match law.map(law_from_wire) {
        Some(law) => match invalid.take(&Field::default(), law) {
            Some(law) if invalid.is_empty() => Ok(Segment { duration, start, law }),
            _ => Err(invalid),
        },
        None => {
            invalid.note("law", Some(Why::Unspecified { choices: "jerk, polynomial, cosine_jerk" }));
            Err(invalid)
        }
    }
}

fn law_from_wire(wire: pb::axis_segment::Law) -> Result<Law, InvalidFields> {
    use pb::axis_segment::{CosineJerk, Law as Wire, Polynomial};
    let not_finite = |given: f64| (!given.is_finite()).then_some(Why::NotFinite { given });
    let mut invalid = InvalidFields::default();
    match wire {
        Wire::Jerk(jerk) => {
            invalid.note("jerk", not_finite(jerk));
            invalid.into_result(Law::ConstantJerk(jerk))
        }
        Wire::Polynomial(Polynomial { derivatives }) => {
            let name = |index| Field::element("polynomial.derivatives", index);
            for (index, &given) in derivatives.iter().enumerate() {
                invalid.note(name(index).as_str(), not_finite(given));
            }
            match Derivatives::new(&derivatives) {
                Some(law) => invalid.into_result(Law::Polynomial(law)),
                None => {
                    // The first of them is that of order 3.
                    let why = Why::OrderUnsupported { given: derivatives.len() + 2 };
                    Err(InvalidFields::one(Field::named("polynomial.derivatives"), why))
                }
            }
        }
        Wire::CosineJerk(CosineJerk { peak_jerk }) => {
            invalid.note("cosine_jerk.peak_jerk", not_finite(peak_jerk));
            invalid.into_result(Law::CosineJerk { peak: peak_jerk })
        }
    }
}

pub(super) fn adjustment_from_wire(wire: pb::Adjustment) -> Result<Adjustment, InvalidFields> {
    let pb::Adjustment { quantity, asked, planned, reason: given } = wire;
    let mut invalid = InvalidFields::default();
    for (name, given) in [("asked", asked), ("planned", planned)] {
        invalid.note(name, (!given.is_finite()).then_some(Why::NotFinite { given }));
    }
    let quantity = quantity_from_wire(quantity).map_err(|why| invalid.note("quantity", Some(why))).ok();
    let reason = AdjustmentReason::ALL.into_iter().find(|reason| reason.name() == given);
    let choices = "PATH_TOO_SHORT_START_VELOCITY, PATH_TOO_SHORT_NEAREST_VELOCITY, FEED_RATE_ABOVE_LIMIT, \
                   CLOSING_STOP, PVT_TIME_TOO_SHORT, PVT_OUT_OF_REACH, PVT_TIME_EXTENDED, PVT_TIME_SHIFTED, \
                   PVT_FINISHED_LATE";
    if reason.is_none() {
        invalid.note("reason", Some(Why::UnknownName { given, choices }));
    }
    if let (Some(given), Some(reason)) = (quantity, reason)
        && !quantities(reason).contains(&given)
    {
        let names: Vec<_> = quantities(reason).iter().map(|one| one.to_string().to_uppercase()).collect();
        let (given, correct) = (given.to_string().to_uppercase(), names.join(" or "));
        invalid.note("quantity", Some(Why::Misstated { given, correct }));
    }
    match (quantity, reason) {
        (Some(quantity), Some(reason)) if invalid.is_empty() => {
            Ok(Adjustment { quantity, asked, planned, reason })
        }
        _ => Err(invalid),
    }
}

/// What gives way for a reason.
fn quantities(reason: AdjustmentReason) -> &'static [Quantity] {
    use Quantity::{Acceleration, Position, Time, Velocity};
    match reason {
        AdjustmentReason::PathTooShortStartVelocity
        | AdjustmentReason::PathTooShortNearestVelocity
        | AdjustmentReason::FeedRateAboveLimit
        | AdjustmentReason::PvtTimeTooShort => &[Velocity],
        AdjustmentReason::Override => &[Velocity, Acceleration],
        AdjustmentReason::PvtOutOfReach => &[Position, Velocity],
        AdjustmentReason::ClosingStop => &[Position, Velocity, Acceleration],
        AdjustmentReason::PvtTimeExtended | AdjustmentReason::PvtTimeShifted => &[Time],
        AdjustmentReason::PvtFinishedLate => &[Position, Velocity, Time],
    }
}

fn classification_from_wire(
    wire: pb::Classification,
) -> Result<(Classification, Vec<PvtRegion>), InvalidFields> {
    let pb::Classification { eight_type, asymmetric_type, six_case, pvt_regions, feed_rate } = wire;
    let mut invalid = InvalidFields::default();
    let choices = "1, 2, 3, 4, 5, 6, 7, 8A, 8B, 8C";
    let eight_type = named(&mut invalid, "eight_type", eight_type, EightType::named, choices);
    let choices = "1, 2, 3, 4, 5, 6, 7, 8";
    let asymmetric_type =
        named(&mut invalid, "asymmetric_type", asymmetric_type, AsymmetricType::named, choices);
    let choices = "A, B, C.1, C.2, D.1, D.2";
    let six_case = named(&mut invalid, "six_case", six_case, SixCase::named, choices);
    let mut regions = Vec::with_capacity(pvt_regions.len());
    for (index, given) in pvt_regions.into_iter().enumerate() {
        match PvtRegion::named(&given) {
            Some(region) => regions.push(region),
            None => {
                let why = Why::UnknownName { given, choices: REGIONS };
                invalid.note(Field::element("pvt_regions", index).as_str(), Some(why));
            }
        }
    }
    invalid.into_result((Classification { eight_type, asymmetric_type, six_case, feed_rate }, regions))
}

/// What a name stands for, if there is one; a name that is not known is reported.
fn named<T>(
    invalid: &mut InvalidFields,
    field: &str,
    given: Option<String>,
    known: impl Fn(&str) -> Option<T>,
    choices: &'static str,
) -> Option<T> {
    let given = given?;
    let found = known(&given);
    if found.is_none() {
        invalid.note(field, Some(Why::UnknownName { given, choices }));
    }
    found
}
