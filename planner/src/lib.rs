//! Jerk-limited motion.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

mod classify;
mod error;
mod float;
mod limits;
mod problem;
mod profile;
mod quantity;
mod roots;
mod segment;
mod short_path;
mod solve;
mod state;

pub use classify::{Classification, EightType};
pub use error::{Field, InvalidField, InvalidFields, Why};
pub use limits::{GREATEST_MAGNITUDE, LEAST_LIMIT, Limits, LimitsSpec, MAX_ORDER};
pub use problem::Problem;
pub use profile::{Cursor, Profile};
pub use quantity::Quantity;
pub use segment::{Law, Segment, Setpoint};
pub use short_path::ShortPathPolicy;
pub use solve::{Adjustment, AdjustmentReason, MAX_PIECES, Move, plan_move};
pub use state::State;

/// Names the bits that a plan samples to: replicas with the same number give the same setpoints for the same plan.
///
/// It changes only when they do; a replica evaluates this version and the one before.
pub const EVALUATION_VERSION: u32 = 1;
