//! The only translation between wire types and domain types: both directions of a type stand side by side, and every
//! field is taken apart by name, so that a field added to the schema stops the build here and nowhere else. Plans, of which there are
//! many and large ones, go out as bytes (`encode`, which has numbers of fields in the place of names; tests hold it to the schema), and
//! come in as trees.
//!
//! From the wire, everything that is wrong is reported at once, with its path (`axes[2].limits.max_jerk`).

mod certificate;
mod choice;
mod claims;
mod columns;
mod duration;
mod encode;
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
pub use encode::{Outcomes, encode_plan, encode_pvt, plan_to_wire, point_to_wire};
pub use field::{accepted_in, plan_as_it_is_in, plan_in, within};
pub use many::outcome_from_wire;
pub use motion::{motion_from_wire, motion_to_wire};
pub use plan::{plan_as_it_is, plan_from_wire};
pub use pvt::{pvt_from_wire, pvt_request_from_wire, pvt_to_wire};
pub use rejected::accepted;
pub use request::{Against, against, plan_request_from_wire};
pub use stream::{request_from_wire, request_to_wire, response_from_wire, response_to_wire};
