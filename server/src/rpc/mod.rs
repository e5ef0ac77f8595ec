//! The services. A handler translates, calls one function of the core, and translates back.

mod planner;
mod sample;
mod setpoints;

pub(crate) use planner::Planner;
pub(crate) use setpoints::Setpoints;

use proto::{Reason, Rejected};
use tonic::Status;

/// What a later version will answer.
fn not_implemented(what: &str, instead: &str) -> Status {
    Rejected::new(Reason::NotImplemented, format!("{what} is not implemented: {instead}")).into()
}
