//! The flags of a replay.

use std::path::PathBuf;

use clap::Args;

/// Plan and stream again what a recording holds, and compare bit for bit.
///
/// Plans the request again, where there is one, does each operation again at the cycle at which it took effect, and holds
/// every setpoint against the one recorded. A server that took a stream over recorded the motion that it went on with, and
/// that is played again from there. The exit code is 0 where all are the same, 1 where one is not, or where the
/// recording does not hold all that was done. Neither server nor axis is needed.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  portamento demo --record demo.mcap
  portamento replay demo.mcap
  portamento track move.json --record run.mcap
  portamento replay run.mcap

Recordings are MCAP with the schema of every message inside: Foxglove and
PlotJuggler open them, and so does PyPI's mcap-protobuf-support. On /axes/<name>
there is a message for each cycle: position, velocity, acceleration and jerk as
commanded, measured position, following error and load position [u, s].")]
pub(crate) struct ReplayArgs {
    /// The recording, as --record has written it.
    #[arg(value_name = "FILE.mcap")]
    pub(crate) recording: PathBuf,
}
