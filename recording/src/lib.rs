//! Recordings of streams, for people who want to look at a run again, or to have it played again.
//!
//! - [`Recorder`]: writes MCAP, with the schema of every message inside, or CSV
//! - [`Recording`]: reads MCAP back
//! - [`replay`]: plans and streams again what a recording says, and finds where it first differs
//!
//! Time in a recording is that of the stream: cycle 0 is 0, whenever it was.

mod mcap_file;
mod read;
mod record;
mod replay;
mod table;

pub use read::{Beginning, Recording, UnreadableRecording};
pub use record::{Head, Measured, Recorder};
pub use replay::{Difference, Replayed, replay};
