//! The flags of grading a link.

use clap::Args;

use super::nanoseconds;

/// Measure the link to a server, and say what lead and guard it needs.
///
/// Opens streams at the server as an axis does, plays one of them for a few seconds in real time, moves nothing, and measures: how long a
/// report takes until the batch that it allows has come, the gaps between batches, how late this machine wakes up, and how
/// long it takes to open a stream. Run it on the machine of the axis, while the network carries what it usually does.
#[derive(Debug, Args)]
#[command(after_help = "\
The lead is to cover twice the worst that a serving server was seen to take of
it, and in its last quarter the opening of a stream elsewhere: a server that
falls silent is given up when three quarters are gone. What was not measured is
not covered: take more where a stall may be longer than what was seen.

Examples:
  portamento grade
  portamento grade --endpoint http://10.0.0.7:50051 --time 60s
  portamento grade --json")]
pub(crate) struct GradeArgs {
    /// How long to measure, with its unit, 1s to 1h.
    #[arg(long, value_name = "TIME", value_parser = nanoseconds, default_value = "5s")]
    pub(crate) time: i128,
    /// Cycles per batch, 1 to 125.
    #[arg(long, value_name = "CYCLES", default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=125))]
    pub(crate) batch: u32,
}
