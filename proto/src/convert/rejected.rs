//! What the planner and the judge object to, as refusals with a reason that programs know.

use planner::{
    Accepted, EndCheck, InvalidField, InvalidFields, JoinCheck, Judged, LimitCheck, Plan, PvtOffers,
    Quantity, Rejection, Shortest, Violation, Why,
};

use crate::{FieldViolation, Reason, Rejected};

impl From<InvalidFields> for Rejected {
    /// Mistakes in what was said come before conditions that do not hold; the first one names the whole.
    fn from(invalid: InvalidFields) -> Self {
        let mut fields: Vec<_> =
            invalid.as_slice().iter().map(|invalid| (rank(&invalid.why), invalid)).collect();
        fields.sort_by_key(|(rank, _)| *rank);
        let violations = fields
            .iter()
            .map(|(_, InvalidField { field, why })| {
                FieldViolation::new(field.as_str(), reason(why), why.to_string())
            })
            .collect();
        let rejected = Self::for_fields(violations)
            .unwrap_or_else(|| Self::new(Reason::NotFinite, "the request is not valid"));
        match fields.first() {
            Some((_, InvalidField { why, .. })) => with_figures(rejected, why),
            None => rejected,
        }
    }
}

impl From<Rejection> for Rejected {
    /// The check that fails worst, in words and for programs. [`accepted`] says besides where it stands.
    fn from(rejection: Rejection) -> Self {
        let Some((worst, violation)) = worst(&rejection) else {
            return Self::new(Reason::PlanRejected, "the judge rejects the plan: plan it again");
        };
        let more = match rejection.violations.len() - 1 {
            0 => String::new(),
            more => format!(", and {more} more"),
        };
        let Failed { axis, quantity, given, allowed, .. } = worst;
        let text = format!("the judge rejects the plan: {violation}{more}; plan it again");
        Self::new(Reason::PlanRejected, text)
            .with("axis", axis)
            .with("quantity", quantity)
            .with("given", given)
            .with("allowed", allowed)
    }
}

/// The plan in the field called `field`, if the judge has nothing against it.
///
/// # Errors
/// [`Reason::PlanRejected`], with the check that fails worst and the part of the plan that it is about.
pub fn accepted(field: &str, plan: Plan) -> Result<Accepted, Rejected> {
    let names: Vec<String> = plan.axes().iter().map(|axis| axis.axis.clone()).collect();
    Judged::new(plan).accepted().map_err(|rejection| {
        let path = worst(&rejection).and_then(|(Failed { axis, part, .. }, _)| {
            let index = names.iter().position(|name| name == axis)?;
            Some(format!("{field}.axes[{index}].{part}"))
        });
        let rejected = Rejected::from(rejection);
        let path = path.unwrap_or_else(|| field.to_owned());
        let violation = FieldViolation::new(path, Reason::PlanRejected, rejected.message.clone());
        Rejected { fields: vec![violation], ..rejected }
    })
}

/// The check that fails worst, the first where several are alike.
fn worst(rejection: &Rejection) -> Option<(Failed<'_>, &Violation)> {
    let failed = rejection.violations.iter().map(|violation| (Failed::of(violation), violation));
    failed.reduce(|worst, next| if next.0.excess() > worst.0.excess() { next } else { worst })
}

/// A check of the judge that failed, in the words that are common to all of them.
struct Failed<'a> {
    axis: &'a str,
    /// The part of an axis's plan that the check is about.
    part: &'static str,
    quantity: Quantity,
    given: f64,
    allowed: f64,
}

impl<'a> Failed<'a> {
    fn of(violation: &'a Violation) -> Self {
        match violation {
            Violation::Limit(LimitCheck { axis, quantity, limit, extremum, .. }) => {
                Self { axis, part: "segments", quantity: *quantity, given: *extremum, allowed: *limit }
            }
            Violation::Join(JoinCheck { axis, quantity, worst_jump, allowed, .. }) => {
                Self { axis, part: "segments", quantity: *quantity, given: *worst_jump, allowed: *allowed }
            }
            Violation::End(EndCheck { axis, quantity, residual, allowed }) => {
                Self { axis, part: "goal", quantity: *quantity, given: *residual, allowed: *allowed }
            }
        }
    }

    /// How far beyond what is allowed \[1\]: the same scale for every quantity.
    fn excess(&self) -> f64 {
        let ratio = (self.given / self.allowed).abs();
        // What cannot be computed is as bad as can be.
        if ratio.is_nan() { f64::INFINITY } else { ratio }
    }
}

/// The order in which reasons are reported: what is not a request, what nobody can do yet, what cannot be met.
fn rank(why: &Why) -> u8 {
    match reason(why).code() {
        tonic::Code::InvalidArgument | tonic::Code::ResourceExhausted => 0,
        tonic::Code::Unimplemented => 1,
        _ => 2,
    }
}

fn reason(why: &Why) -> Reason {
    match why {
        Why::NotFinite { .. } => Reason::NotFinite,
        Why::DurationNotPositive { .. } => Reason::TimesNotIncreasing,
        Why::NotPositive { .. } | Why::NotNegative { .. } | Why::NegativeReverse { .. } => {
            Reason::LimitNotPositive
        }
        Why::NegativeDuration { .. } | Why::DurationParts { .. } => Reason::ValueOutOfRange,
        Why::EmptyRange { .. } => Reason::ValueOutOfRange,
        Why::Missing { .. } | Why::LimitMissing { .. } | Why::LimitsTooFew { .. } => Reason::FieldMissing,
        Why::Unspecified { .. } | Why::UnknownChoice { .. } | Why::UnknownName { .. } => {
            Reason::KindUnspecified
        }
        Why::DuplicateAxis { .. } => Reason::DuplicateAxis,
        Why::UnknownAxis { .. } => Reason::UnknownAxis,
        Why::NoAxes => Reason::NoAxes,
        Why::NameEmpty | Why::NameControl { .. } | Why::NameTooLong { .. } => Reason::NameInvalid,
        Why::TooManyAxes { .. } | Why::NotOneAxis { .. } => Reason::TooManyAxes,
        Why::TooManySegments { .. } => Reason::TooManySegments,
        Why::TooManyCycles { .. } => Reason::TooManyCycles,
        Why::CycleTime { .. } => Reason::CycleTimeInvalid,
        Why::OrderUnsupported { .. } | Why::OrderMissing | Why::OrderOfFamily { .. } => {
            Reason::OrderUnsupported
        }
        Why::NotAtRest { .. } | Why::LastNotAtRest { .. } => Reason::StateNotAtRest,
        Why::EvaluationVersion { .. } | Why::Misstated { .. } | Why::FingerprintMismatch { .. } => {
            Reason::PlanRejected
        }
        Why::StartOutsideLimits { .. } => Reason::StartOutsideLimits,
        Why::GoalOutsideLimits { .. } => Reason::GoalOutsideLimits,
        Why::PositionLimit { .. } | Why::PvtLeavesRange { .. } => Reason::PositionLimit,
        Why::PathTooShort { .. } => Reason::PathTooShort,
        Why::OffTheLine { .. } | Why::SweptOffLimits { .. } => Reason::PhaseSynchronizationImpossible,
        Why::ArrivesEarly { .. } => Reason::ValueOutOfRange,
        Why::NoPoints => Reason::NoPoints,
        Why::LengthMismatch { .. } | Why::TimesDiffer { .. } => Reason::LengthMismatch,
        Why::TimesNotIncreasing { .. } | Why::IntervalTooShort { .. } => Reason::TimesNotIncreasing,
        Why::PvtTimeTooShort { .. } | Why::PvtOutOfReach { .. } => Reason::PvtUnreachable,
        Why::FactorOutOfRange { .. } => Reason::OverrideOutOfRange,
        Why::NoTimeLaw => Reason::FieldMissing,
        Why::EndsAtSpeed { .. } | Why::BackInTime { .. } => Reason::ValueOutOfRange,
        Why::NotRetimed | Why::NotImplemented { .. } => Reason::NotImplemented,
    }
}

/// What was needed, what was given, and the nearest that would do, for programs.
fn with_figures(rejected: Rejected, why: &Why) -> Rejected {
    let text = |number: &f64| Shortest(*number).to_string();
    let figures = match why {
        Why::PathTooShort { needed, given, nearest_velocity } => {
            vec![("needed", text(needed)), ("given", text(given)), ("nearest", text(nearest_velocity))]
        }
        Why::StartOutsideLimits { given, allowed, .. }
        | Why::GoalOutsideLimits { given, allowed, .. }
        | Why::SweptOffLimits { given, allowed, .. }
        | Why::PositionLimit { reached: given, allowed, .. } => {
            vec![("needed", text(allowed)), ("given", text(given)), ("nearest", text(allowed))]
        }
        Why::PvtTimeTooShort { given, duration, offers } => {
            let nearest = offers.nearest.map(|offer| offer.velocity);
            let with = offers.nearest.map(|offer| ("nearest_position", offer.position));
            let mut figures = point_figures("VELOCITY", *given, nearest, *duration, offers);
            figures.extend(with.map(|(key, position)| (key, text(&position))));
            figures
        }
        Why::PvtOutOfReach { given, velocity: _, duration, least, greatest, offers } => {
            let nearest = offers.nearest.map(|offer| offer.position);
            let mut figures = point_figures("POSITION", *given, nearest, *duration, offers);
            figures.extend([("least", text(least)), ("greatest", text(greatest))]);
            figures
        }
        Why::PvtLeavesRange { given, velocity: _, reached, time, allowed, limit: _, offers } => {
            let nearest = offers.nearest.map(|offer| offer.position);
            let with = offers.nearest.map(|offer| ("nearest_velocity", offer.velocity));
            let mut figures = vec![("quantity", "POSITION".to_owned()), ("given", text(given))];
            figures.extend(nearest_figures(nearest));
            figures.extend(with.map(|(key, velocity)| (key, text(&velocity))));
            figures.extend([("reached", text(reached)), ("at_time", text(time)), ("allowed", text(allowed))]);
            figures.extend(other_figures(offers));
            figures
        }
        Why::OffTheLine { given, needed } => vec![("needed", text(needed)), ("given", text(given))],
        Why::ArrivesEarly { given, greatest } => vec![("given", text(given)), ("greatest", text(greatest))],
        Why::IntervalTooShort { given, cycle } => vec![("needed", text(cycle)), ("given", text(given))],
        Why::TimesNotIncreasing { given, before } => vec![("given", text(given)), ("before", text(before))],
        Why::TimesDiffer { given, expected } => vec![("needed", text(expected)), ("given", text(given))],
        Why::LengthMismatch { given, expected, .. } => {
            vec![("needed", expected.to_string()), ("given", given.to_string())]
        }
        Why::Misstated { given, correct } | Why::FingerprintMismatch { given, correct } => {
            vec![("needed", correct.clone()), ("given", given.clone())]
        }
        Why::NotOneAxis { given } => {
            vec![("given", given.to_string()), ("allowed", "1".to_owned())]
        }
        Why::TooManyAxes { given, allowed } | Why::TooManySegments { given, allowed } => {
            vec![("given", given.to_string()), ("allowed", allowed.to_string())]
        }
        Why::TooManyCycles { seconds } => {
            let allowed = format!("{} cycles", planner::LAST_CYCLE);
            vec![("given", format!("{} s", Shortest(*seconds))), ("allowed", allowed)]
        }
        Why::DurationParts { seconds, nanos } => vec![("given", format!("{seconds} s and {nanos} ns"))],
        Why::OrderUnsupported { given } => {
            vec![("given", given.to_string()), ("allowed", format!("2 to {}", planner::MAX_ORDER))]
        }
        Why::LimitsTooFew { needed, given, .. } => {
            vec![("given", given.to_string()), ("needed", needed.to_string())]
        }
        Why::OrderOfFamily { given, order, .. } => {
            vec![("given", given.to_string()), ("allowed", order.to_string())]
        }
        Why::CycleTime { given_ns, min_ns, max_ns } => {
            vec![("given", format!("{given_ns} ns")), ("allowed", format!("{min_ns} to {max_ns} ns"))]
        }
        Why::NotFinite { given }
        | Why::NotPositive { given }
        | Why::DurationNotPositive { given }
        | Why::NegativeDuration { given }
        | Why::NegativeReverse { given }
        | Why::NotAtRest { given, .. }
        | Why::LastNotAtRest { given } => vec![("given", text(given))],
        // The sentence has all that there is to say.
        _ => Vec::new(),
    };
    figures.into_iter().fold(rejected, |rejected, (key, value)| rejected.with(key, value))
}

/// Of a point that cannot be met: its value of the quantity that gives way first, and in the same unit the nearest that is taken; and
/// what else is.
fn point_figures(
    quantity: &str,
    given: f64,
    nearest: Option<f64>,
    duration: f64,
    offers: &PvtOffers,
) -> Vec<(&'static str, String)> {
    let mut figures = vec![("quantity", quantity.to_owned()), ("given", Shortest(given).to_string())];
    figures.extend(nearest_figures(nearest));
    figures.push(("given_time", Shortest(duration).to_string()));
    figures.extend(other_figures(offers));
    figures
}

fn nearest_figures(nearest: Option<f64>) -> impl Iterator<Item = (&'static str, String)> {
    let text = nearest.map(|nearest| Shortest(nearest).to_string());
    ["needed", "nearest"].into_iter().filter_map(move |key| Some((key, text.clone()?)))
}

/// The velocity with which the position is reached in the time, and the time in which both are.
fn other_figures(offers: &PvtOffers) -> impl Iterator<Item = (&'static str, String)> {
    let velocity = offers.same_position.map(|offer| ("velocity_for_position", offer.velocity));
    let time = offers.later.map(|offer| ("needed_time", offer.duration));
    velocity.into_iter().chain(time).map(|(key, value)| (key, Shortest(value).to_string()))
}
