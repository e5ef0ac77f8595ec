//! The flags of looking on.

use clap::Args;

use super::nanoseconds;

/// Look on at the streams that a server serves: all of them, or one with how its axes follow.
///
/// Looking on delays no stream: where the terminal or the network is too slow, messages are lost, and counted.
#[derive(Debug, Args)]
#[command(after_help = "\
Without a name each line is a stream as it stands: its last executed cycle, how
many cycles it holds ahead, what it does, the factor on its feed rate, and
counts of cycles that were missing and of messages that were lost.

With a name each line is a moment of that stream: besides, where each axis is
commanded to be, and its following error, commanded minus measured. It ends when
the stream does.

Examples:
  portamento watch
  portamento watch cell-7/x --endpoint http://127.0.0.1:50051
  portamento watch cell-7/x --every 500ms
  portamento watch cell-7/x --every 50ms --json > cell-7-x.jsonl
  portamento watch --once --json")]
pub(crate) struct WatchArgs {
    /// Name of a stream; all streams, if not given.
    #[arg(value_name = "STREAM")]
    pub(crate) stream: Option<String>,
    /// The least time between two lines of a stream, with its unit, as 200ms or 1s, up to 60s.
    #[arg(long, value_name = "TIME", value_parser = nanoseconds, default_value = "200ms")]
    pub(crate) every: i128,
    /// The most cycles in one message with --json; beyond it those that say least are left out. 0: 500.
    #[arg(long, value_name = "CYCLES", default_value_t = 0, hide_default_value = true)]
    pub(crate) max_points: u32,
    /// Say how the streams stand now, and end.
    #[arg(long)]
    pub(crate) once: bool,
}
