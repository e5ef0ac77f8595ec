//! The flags of a comparison of two plans.

use std::path::PathBuf;

use clap::Args;

/// Compare two plans: duration, worst difference of each quantity, and where they first part.
///
/// Compared are the setpoints, cycle by cycle, as an axis would play them: position, velocity, acceleration and jerk of the
/// axes that both have. After its end a plan rests. The exit code is 0 where there is no difference, 1 where there is.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  portamento diff before.json after.json
  portamento diff before.json after.json --tolerance 1e-9
  portamento plan --request request.json --json | portamento diff move.json -
  portamento diff before.json after.json --json && echo the same")]
pub(crate) struct DiffArgs {
    /// The one plan: a Plan (from plan --output) or a PlanResponse (from plan --json), in JSON; '-' reads standard input.
    #[arg(value_name = "A.json")]
    pub(crate) a: PathBuf,
    /// The other.
    #[arg(value_name = "B.json")]
    pub(crate) b: PathBuf,
    /// The greatest difference that counts as none, as a share [1] of the greatest value of the quantity; 0: equal numbers.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = share)]
    pub(crate) tolerance: f64,
}

fn share(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(share) if (0.0..1.0).contains(&share) => Ok(share),
        _ => Err("give a share from 0 to less than 1, as 1e-9".to_owned()),
    }
}
