//! What the planner and the judge object to, as refusals with a reason that programs know.

use planner::{InvalidField, InvalidFields, Rejection, Shortest, Why};

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
    fn from(rejection: Rejection) -> Self {
        Self::new(Reason::PlanRejected, format!("the judge rejects the plan: {rejection}; plan it again"))
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
        Why::NotPositive { .. } | Why::EmptyRange { .. } => Reason::LimitNotPositive,
        Why::Unspecified { .. } | Why::UnknownChoice { .. } | Why::UnknownName { .. } => {
            Reason::KindUnspecified
        }
        Why::DuplicateAxis { .. } => Reason::DuplicateAxis,
        Why::UnknownAxis { .. } => Reason::UnknownAxis,
        Why::NoAxes => Reason::NoAxes,
        Why::NameTooLong { .. } => Reason::MessageTooLarge,
        Why::TooManyAxes { .. } => Reason::TooManyAxes,
        Why::TooManySegments { .. } => Reason::TooManySegments,
        Why::TooManyCycles { .. } => Reason::TooManyCycles,
        Why::CycleTime { .. } => Reason::CycleTimeInvalid,
        Why::OrderUnsupported { .. } | Why::OrderMissing | Why::OrderOfFamily { .. } => {
            Reason::OrderUnsupported
        }
        Why::LimitMissing { .. } => Reason::LimitNotPositive,
        Why::NotAtRest { .. } => Reason::StateNotAtRest,
        Why::EvaluationVersion { .. } | Why::Misstated { .. } | Why::FingerprintMismatch { .. } => {
            Reason::PlanRejected
        }
        Why::StartOutsideLimits { .. } => Reason::StartOutsideLimits,
        Why::GoalOutsideLimits { .. } => Reason::GoalOutsideLimits,
        Why::PositionLimit { .. } => Reason::PositionLimit,
        Why::PathTooShort { .. } => Reason::PathTooShort,
        // The enum grows with the planner: what this version cannot name is what it cannot do.
        _ => Reason::NotImplemented,
    }
}

/// What was needed, what was given, and the nearest that would do, for programs.
fn with_figures(rejected: Rejected, why: &Why) -> Rejected {
    let number = |number: f64| Some(Shortest(number).to_string());
    let (needed, given, nearest) = match why {
        Why::PathTooShort { needed, given, nearest_velocity } => {
            (number(*needed), number(*given), number(*nearest_velocity))
        }
        Why::StartOutsideLimits { given, allowed, .. }
        | Why::GoalOutsideLimits { given, allowed, .. }
        | Why::PositionLimit { reached: given, allowed, .. } => {
            (number(*allowed), number(*given), number(*allowed))
        }
        Why::Misstated { given, correct } | Why::FingerprintMismatch { given, correct } => {
            (Some(correct.clone()), Some(given.clone()), None)
        }
        Why::NotFinite { given }
        | Why::NotPositive { given }
        | Why::DurationNotPositive { given }
        | Why::NotAtRest { given, .. } => (None, number(*given), None),
        _ => return rejected,
    };
    let figures = [("needed", needed), ("given", given), ("nearest", nearest)];
    let known = figures.into_iter().filter_map(|(key, value)| Some((key, value?)));
    known.fold(rejected, |rejected, (key, value)| rejected.with(key, value))
}
