//! How fast the planner is on this machine, beside peers that answer the same questions.
//!
//! - `inputs`: the problems, drawn as the planner's tests and benches draw them
//! - `rows`: what is asked, checked before it is timed
//! - `peers`: how a peer is asked the same
//! - `timing`: both sides by turns

mod budget;
mod inputs;
#[cfg(feature = "peers")]
mod peers;
#[cfg(not(feature = "peers"))]
#[path = "no_peers.rs"]
mod peers;
mod rows;
mod timing;

pub(crate) use budget::Budget;
pub(crate) use rows::{ROWS, Row};
pub(crate) use timing::{Timed, time};
