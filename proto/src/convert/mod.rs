//! The only translation between wire types and domain types: both directions of a type stand side by side, and every
//! field is taken apart by name, so that a field added to the schema stops the build here and nowhere else.
//!
//! From the wire, everything that is wrong is reported at once, with its path (`axes[2].limits.max_jerk`).

mod certificate;
mod choice;
mod claims;
mod field;
mod limits;
mod motion;
mod operation;
mod plan;
mod pvt;
mod rejected;
mod request;
mod state;
mod stream;

pub use claims::misclassified;
pub use field::{accepted_in, plan_as_it_is_in, plan_in, within};
pub use plan::{plan_as_it_is, plan_from_wire, plan_to_wire};
pub use pvt::{point_to_wire, pvt_from_wire, pvt_to_wire, pvt_to_wire_by};
pub use rejected::accepted;
pub use request::{Against, against};
pub use stream::{request_from_wire, request_to_wire, response_from_wire, response_to_wire};

use prost_types::Duration;

/// Nanoseconds of a wire duration, whatever its parts are.
fn duration_to_ns(wire: &Duration) -> i128 {
    let Duration { seconds, nanos } = *wire;
    i128::from(seconds) * 1_000_000_000 + i128::from(nanos)
}

/// A wire duration of so many nanoseconds; at the end of its range where they do not fit.
fn ns_to_duration(ns: i128) -> Duration {
    let seconds = i64::try_from(ns / 1_000_000_000).unwrap_or(if ns < 0 { i64::MIN } else { i64::MAX });
    Duration { seconds, nanos: (ns % 1_000_000_000) as i32 }
}

/// A wire duration of a cycle.
fn cycle_time_to_wire(cycle: planner::CycleTime) -> Duration {
    ns_to_duration(i128::from(cycle.as_ns()))
}
