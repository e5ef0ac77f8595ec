//! Who looks on: streams as they run, shown to watchers without ever waiting for one.
//!
//! ```text
//!  session's task                                 watcher's task
//!  Tap ──summary──► Hub ◄──────────────────────── asks for summaries, or
//!   │                 └── bounded queue a watcher ─► Rows ─ decimated ─► messages, at most one a period
//!   └◄─ is anybody there? ── so the axis is told whether tracking is wanted
//! ```
//!
//! A tap never waits: where a queue is full the watcher loses what does not fit, which is counted. Time passes in the
//! watcher's task alone; the session does not know that anybody watches, but for one event.
//!
//! - [`Board`]: the streams that can be watched here
//! - [`Tap`]: what a session's task shows
//! - [`Rows`]: commanded beside measured, cycle by cycle
//! - [`recorder`]: a watcher that writes a file
//! - [`decimate`]: the cycles of a message that say most

mod board;
mod decimate;
mod recorder;
mod rows;
mod tap;
mod watcher;

pub(crate) use board::Board;
pub(crate) use tap::Tap;
pub(crate) use watcher::{Visitor, watch_all, watch_stream};
