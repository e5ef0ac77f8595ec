//! Why there is no run, or none that is whole, as a refusal that a caller can act on.

use client::Error;
use proto::{Reason, Rejected};

use crate::axis::InvalidConfig;
use crate::run::TrackError;

/// What `error` says to the caller of a request whose models are of the axes `named`.
pub(super) fn of(error: TrackError, named: &[String]) -> Rejected {
    let text = error.to_string();
    match error {
        TrackError::NoEndpoint => Rejected::for_field("endpoints", Reason::FieldMissing, text),
        TrackError::UnknownAxis { .. } => Rejected::for_field("models", Reason::UnknownAxis, text),
        TrackError::Config { axis, cause } => unsuitable(&axis, &cause, named),
        TrackError::NotOpened { cause: Error::Rejected(rejected), .. } => as_asked_here(*rejected),
        TrackError::NotOpened { endpoint, cause } => {
            let reason = match cause {
                Error::Address { .. } => Reason::EndpointInvalid,
                Error::Unreachable { .. } | Error::Unanswered { .. } => Reason::PlannerUnreachable,
                Error::TooLarge { .. } => Reason::MessageTooLarge,
                Error::NotServed { .. } | Error::Protocol(_) | Error::Rejected(_) => Reason::NotAPlanner,
            };
            Rejected::new(reason, format!("{endpoint}: {text}"))
                .with("endpoint", endpoint)
                .with("cause", cause)
        }
        TrackError::Broken { executed, motion_end, cause, .. } => {
            // A planner that says why speaks for itself.
            let ended = match cause {
                Error::Rejected(rejected) => Rejected { message: text, ..*rejected },
                other => Rejected::new(Reason::StreamBroken, text).with("cause", other),
            };
            ended.with("executed_cycle", executed).with("motion_end", motion_end)
        }
        TrackError::Diverged { axis, cycle, .. } => {
            Rejected::new(Reason::AxisDiverged, text).with("axis", axis).with("cycle", cycle)
        }
        TrackError::Abandoned => Rejected::new(Reason::StreamBroken, text),
        TrackError::Thread(_) => Rejected::new(Reason::Overloaded, text),
    }
}

/// A planner names the fields of its own request: what is `open.plan` there is `plan` here.
fn as_asked_here(mut rejected: Rejected) -> Rejected {
    const THERE: &str = "open.";
    for violation in &mut rejected.fields {
        if let Some(here) = violation.field.strip_prefix(THERE) {
            violation.field = here.to_owned();
        }
    }
    if let Some(here) = rejected.message.strip_prefix(THERE) {
        rejected.message = here.to_owned();
    }
    rejected
}

/// Why an axis cannot be run as the request says, with the field that says so.
fn unsuitable(axis: &str, cause: &InvalidConfig, named: &[String]) -> Rejected {
    let place = || named.iter().position(|name| name == axis);
    let (field, reason) = match cause {
        InvalidConfig::SubstepDoesNotDivide { .. } => {
            // A model of the simulator's own is no field of the request, and the plan can have another cycle.
            let field =
                place().map_or("plan.cycle_time".into(), |index| format!("models[{index}].servo.substep"));
            (field, Reason::CycleTimeInvalid)
        }
        InvalidConfig::Cycle { .. } => ("plan.cycle_time".into(), Reason::CycleTimeInvalid),
        InvalidConfig::SettleWindow { .. } => ("settle_window".into(), Reason::ValueOutOfRange),
        InvalidConfig::SettleTolerance { .. } => ("settle_tolerance".into(), Reason::ValueOutOfRange),
        InvalidConfig::Start { .. } => ("plan.axes".into(), Reason::NotFinite),
        InvalidConfig::EffortScale { .. } => ("effort_limit_scale".into(), Reason::ValueOutOfRange),
        InvalidConfig::Unstable { .. } => {
            // Here too; the request can bring another model.
            let field = place().map_or("models".into(), |index| format!("models[{index}].servo"));
            (field, Reason::ServoUnstable)
        }
    };
    let rejected = Rejected::for_field(field, reason, format!("axis {axis:?}: {cause}"));
    match *cause {
        InvalidConfig::Unstable { growth, position_gain, .. } => {
            rejected.with("growth", growth).with("nearest_position_gain", position_gain)
        }
        InvalidConfig::SubstepDoesNotDivide { substep, nearest, .. } => {
            rejected.with("given", substep).with("nearest", nearest)
        }
        _ => rejected,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_substep_that_does_not_divide_is_that_of_the_model_where_the_request_brings_one() {
        let cause = InvalidConfig::SubstepDoesNotDivide { cycle: 1e-3, substep: 7e-5, nearest: 1e-3 / 14.0 };
        let named = ["x".to_owned(), "y".to_owned()];
        for (axis, field) in [("y", "models[1].servo.substep"), ("z", "plan.cycle_time")] {
            let rejected = unsuitable(axis, &cause, &named);
            assert_eq!(
                (rejected.reason, rejected.fields[0].field.as_str()),
                (Reason::CycleTimeInvalid, field)
            );
            assert_eq!(rejected.metadata["given"], "0.00007");
            assert!(rejected.metadata["nearest"].starts_with("0.0000714285714285714"));
        }
    }
}
