//! What every serving process does alike, whatever it serves: no service of its own, and no motion.
//!
//! [`Settings`] → [`Bound::to`] (so the port is known) → [`Bound::serve`] until told to stop. Each process adds its
//! [`Services`] and gives them the [`Leaving`] by which they learn that the process is about to go.
//!
//! - `settings`: what can be set in each of them, and everything that is wrong with it at once
//! - `serve`: port, health, reflection, keep-alive; serves on while it drains
//! - `refusals`: messages too large, and statuses that come without a reason, become refusals with one
//! - `side_port`: health for probes, figures for Prometheus, and pages for people
//! - `telemetry`: where the figures are kept
//! - `leaving`: the order in which a process goes
//! - `process`: from arguments to an exit code

mod leaving;
mod process;
mod refusals;
mod serve;
mod settings;
mod side_port;
mod telemetry;

/// What pages on the side port are made of.
pub use axum;
pub use leaving::Leaving;
pub use process::{Exit, healthcheck, process, seconds, told_to_stop};
pub use serve::{Bound, ServeError, Services};
pub use settings::{Misfit, Misfits, Settings};
