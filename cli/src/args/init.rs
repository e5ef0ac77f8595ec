//! The flags of a request file to begin with.

use std::path::PathBuf;

use clap::Args;

use crate::failure::Failure;

/// Write a request file to begin with, a comment on every field.
///
/// The file is a PlanRequest, or with pvt a PlanPvtRequest, in the proto3 JSON of the schema, with comments as in
/// JavaScript: // to the end of the line. Every command reads it so. Comments are blanks: for a program that does not know
/// them, leave them out with --bare.
#[derive(Debug, Args)]
#[command(
    override_usage = "portamento init [plan|pvt] [FILE.json] [OPTIONS]",
    after_help = "\
Examples:
  portamento init
  portamento plan --request request.json --plot move.svg
  portamento init move.json
  portamento init pvt
  portamento pvt --request points.json
  portamento init plan - --bare | curl --data-binary @- ..."
)]
pub(crate) struct InitArgs {
    /// What to ask for, and where to write it. plan: a move of one axis or several, the default, in request.json. pvt: a
    /// motion through points of position, velocity and time, in points.json. '-' prints it.
    #[arg(value_names = ["plan|pvt", "FILE.json"], num_args = 0..=2)]
    words: Vec<String>,
    /// Write over a file that is there already.
    #[arg(long)]
    pub(crate) force: bool,
    /// Leave the comments out.
    #[arg(long)]
    pub(crate) bare: bool,
}

impl InitArgs {
    /// What to write, and where: in either order, since there is no doubt which is which.
    pub(crate) fn what_and_where(&self) -> Result<(What, PathBuf), Failure> {
        let (mut what, mut file) = (None, None);
        for word in &self.words {
            let known = match word.as_str() {
                "plan" => Some(What::Plan),
                "pvt" => Some(What::Pvt),
                _ => None,
            };
            let is_a_file = word == "-" || word.contains(['.', '/']);
            match known {
                Some(known) if what.is_none() => what = Some(known),
                None if is_a_file && file.is_none() => file = Some(PathBuf::from(word)),
                None if !is_a_file => {
                    return Err(Failure::Usage(format!(
                        "there is nothing to begin {word} with: name plan or pvt, or a file, as {word}.json"
                    )));
                }
                Some(_) | None => {
                    return Err(Failure::Usage(
                        "one request goes into one file: call init again for another, as portamento init pvt points.json"
                            .to_owned(),
                    ));
                }
            }
        }
        let what = what.unwrap_or(What::Plan);
        let usual = match what {
            What::Plan => "request.json",
            What::Pvt => "points.json",
        };
        Ok((what, file.unwrap_or_else(|| PathBuf::from(usual))))
    }
}

/// What there are templates of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum What {
    /// A move of one axis or several; the default.
    Plan,
    /// A motion through points of position, velocity and time.
    Pvt,
}
