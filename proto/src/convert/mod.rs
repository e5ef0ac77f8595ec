//! The only translation between wire types and domain types: both directions of a type stand side by side, and every
//! field is taken apart by name, so that a field added to the schema stops the build here and nowhere else.
//!
//! From the wire, everything that is wrong is reported at once, with its path (`axes[2].limits.max_jerk`).

mod certificate;
mod choice;
mod claims;
mod columns;
mod duration;
mod field;
mod limits;
mod many;
mod motion;
mod operation;
mod plan;
mod pvt;
mod rejected;
mod request;
mod state;
mod stream;
mod watched;

pub use claims::misclassified;
pub use columns::{MoveColumns, Moves, PlannedMove, PlannedMoves};
pub use duration::malformed_duration;
pub use field::{accepted_in, plan_as_it_is_in, plan_in, within};
pub use many::{outcome_from_wire, outcome_to_wire};
pub use motion::{motion_from_wire, motion_to_wire};
pub use plan::{plan_as_it_is, plan_from_wire, plan_to_wire};
pub use pvt::{point_to_wire, pvt_from_wire, pvt_request_from_wire, pvt_to_wire, pvt_to_wire_by};
pub use rejected::accepted;
pub use request::{Against, against, plan_request_from_wire};
pub use stream::{request_from_wire, request_to_wire, response_from_wire, response_to_wire};
