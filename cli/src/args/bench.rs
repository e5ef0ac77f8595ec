//! The flags of a measurement.

use clap::Args;

use super::nanoseconds;

/// Measure how fast this machine plans, samples and encodes, beside a peer that answers the same questions.
///
/// Every answer is checked before anything is timed. Ours and the peer's then go by turns through the same inputs, so that what else
/// the machine does slows down both: take the ratios, and let it be idle for the rest.
#[derive(Debug, Args)]
#[command(after_help = "\
What each row asks, and how it is measured: docs/how-to/measure.md.

Examples:
  portamento bench
  portamento bench axes splice --time 3s
  portamento bench --json > measured.jsonl")]
pub(crate) struct BenchArgs {
    /// Only rows whose name has one of these in it; all rows if not given.
    #[arg(value_name = "NAME")]
    pub(crate) rows: Vec<String>,
    /// How long each row is timed, with its unit, 1ms to 60s.
    #[arg(long, value_name = "TIME", value_parser = nanoseconds, default_value = "1s")]
    pub(crate) time: i128,
}
