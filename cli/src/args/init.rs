//! The flags of a request file to begin with.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Write a request file to begin with, a comment on every field.
///
/// The file is a PlanRequest, or with pvt a PlanPvtRequest, in the proto3 JSON of the schema, with comments as in
/// JavaScript: // to the end of the line. Every command reads it so. Comments are blanks: for a program that does not know
/// them, leave them out with --bare.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  portamento init
  portamento plan --request request.json --plot move.svg
  portamento init pvt points.json
  portamento pvt --request points.json
  portamento init plan - --bare | curl --data-binary @- ...")]
pub(crate) struct InitArgs {
    /// What to ask for.
    #[arg(value_enum, default_value = "plan", hide_default_value = true)]
    pub(crate) what: What,
    /// Where to write it; '-' prints it.
    #[arg(value_name = "FILE.json", default_value = "request.json")]
    pub(crate) file: PathBuf,
    /// Write over a file that is there already.
    #[arg(long)]
    pub(crate) force: bool,
    /// Leave the comments out.
    #[arg(long)]
    pub(crate) bare: bool,
}

/// What there are templates of.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum What {
    /// A move of one axis or several; the default.
    Plan,
    /// A motion through points of position, velocity and time.
    Pvt,
}
