//! Jerk-limited motion.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

mod certified;
mod classify;
mod cycle;
mod error;
mod explain;
mod float;
mod limits;
mod plan;
mod problem;
mod profile;
mod quantity;
mod request;
mod roots;
mod segment;
mod short_path;
mod solve;
mod state;
mod verify;

pub use certified::{Accepted, Judged, Rejection};
pub use classify::{Classification, EightType};
pub use cycle::{CycleTime, LAST_CYCLE};
pub use error::{Field, InvalidField, InvalidFields, Why};
pub use explain::{Binding, Explanation, explain};
pub use limits::{GREATEST_MAGNITUDE, LEAST_LIMIT, Limits, LimitsSpec, MAX_ORDER};
pub use plan::{AxisPlan, Maker, Method, Plan, Sampler, plan};
pub use problem::Problem;
pub use profile::{Cursor, Profile};
pub use quantity::Quantity;
pub use request::{
    AxisKind, AxisMove, AxisMoveSpec, Family, MAX_AXES, Request, RequestSpec, Synchronization,
};
pub use segment::{Law, Segment, Setpoint};
pub use short_path::ShortPathPolicy;
pub use solve::{Adjustment, AdjustmentReason, MAX_PIECES, Move, plan_move, plan_stop};
pub use state::State;
pub use verify::{
    Certificate, EndCheck, JOIN_TOLERANCE, JoinCheck, LIMIT_TOLERANCE, LimitCheck, Violation, certify,
    certify_against, violations,
};

/// Names the bits that a plan samples to: replicas with the same number give the same setpoints for the same plan.
///
/// It changes only when they do; a replica evaluates this version and the one before.
pub const EVALUATION_VERSION: u32 = 1;

/// The versions whose bits this planner gives.
pub const EVALUATION_VERSIONS: core::ops::RangeInclusive<u32> = 1..=EVALUATION_VERSION;
