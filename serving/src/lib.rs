//! What every serving process does alike, whatever it serves: no service of its own, and no motion.
//!
//! [`Settings`] → [`Bound::to`] (so the port is known) → [`Bound::serve`] until told to stop. Each process adds its
//! [`Services`] and gives them the [`Leaving`] by which they learn that the process is about to go.
//!
//! From outside inwards:
//! - `process`: from arguments to an exit code
//! - `flags`, `file`, `given`: what is set by arguments, environment and a file, and what is wrong with it
//! - `settings`: what can be set in each of them, and everything that is wrong with it at once
//! - `logs`, `telemetry`: what is told, and where figures are kept; `collector`, `export`: where spans go, and how
//! - `serve`: ports, health, reflection; serves on while it drains
//! - `connections`: how many, and that they say something
//! - `tls`, `caller`, `policy`: who calls, and what he may do
//! - `frame`: what every call passes, in one order; `admission`, `told`, `refusals` are its layers: who is let in, what is told
//!   of a call, and that messages too large or too late, and statuses without a reason, become refusals with one
//! - `ended`: what has lately come to an end, for those who come too late
//! - `side_port`: health for probes, figures for Prometheus, and pages for people
//! - `leaving`: the order in which a process goes

mod address;
mod admission;
mod caller;
mod collector;
mod connections;
mod ended;
#[cfg(feature = "otlp")]
mod export;
mod file;
mod flags;
mod frame;
mod given;
mod leaving;
mod listener;
mod logs;
mod policy;
mod process;
mod refusals;
mod serve;
mod settings;
mod side_port;
mod telemetry;
mod tls;
mod told;

pub use address::{Address, InvalidAddress};
/// What pages on the side port are made of.
pub use axum;
pub use caller::Caller;
pub use ended::Ended;
pub use file::{settings_file, with_settings};
pub use flags::{Flags, LogFormat};
pub use given::{Given, List, Seconds};
pub use leaving::Leaving;
pub use policy::{InvalidPolicy, Policy};
pub use process::{Arguments, Exit, healthcheck, print, process, seconds, told_to_stop};
pub use serve::{Bound, ServeError, Services};
pub use settings::{Misfit, Misfits, Settings};
pub use tls::Tls;
pub use told::{Refusals, about};
