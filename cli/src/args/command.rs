//! Operations on a motion under way.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::endpoint;

/// Hold, resume, slow down, send elsewhere, extend or stop a motion that an axis is playing.
///
/// The axis forwards it to the planner that serves its stream, and the answer comes when the axis plays by it.
#[derive(Debug, Args)]
#[command(
    // `-0.05` is a number, never a flag.
    allow_negative_numbers = true,
    after_help = "\
Examples:
  portamento command hold
  portamento command resume --axis http://127.0.0.1:50052
  portamento command override 0.5 --stream cell-7/x
  portamento command retarget x=0.02 y=-0.1
  portamento command retarget --request slower.json
  portamento command append more.csv
  portamento command stop --not-before 12000")]
pub(crate) struct CommandArgs {
    #[command(subcommand)]
    pub(crate) order: Order,
    /// The axis simulator that plays the motion.
    #[arg(
        long, global = true, value_name = "URL", default_value = "http://127.0.0.1:50052", value_parser = endpoint
    )]
    pub(crate) axis: String,
    /// Name of the stream; the only one that the axis follows, if not given.
    #[arg(long, global = true, value_name = "NAME", default_value = "", hide_default_value = true)]
    pub(crate) stream: String,
    /// Take effect no earlier than this cycle of the stream; as soon as can be, if not given.
    #[arg(long, global = true, value_name = "CYCLE")]
    pub(crate) not_before: Option<u64>,
    /// Name of this request: sent again with the same one it has the same answer, and is not done twice. A new one, if not
    /// given.
    #[arg(long, global = true, value_name = "ID")]
    pub(crate) request_id: Option<String>,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub(crate) enum Order {
    /// Come to rest, ready to resume.
    Hold,
    /// Go on after a hold.
    Resume,
    /// Scale the feed rate: 0 rests, 1 is as planned.
    Override {
        /// From 0 to the velocity limit over the feed rate.
        #[arg(allow_negative_numbers = true)]
        factor: f64,
    },
    /// Go elsewhere; axes that are not named keep their goals.
    Retarget {
        /// Axis and position [u], as x=0.02.
        #[arg(required_unless_present = "request", value_name = "AXIS=POSITION", value_parser = goal)]
        goals: Vec<(String, f64)>,
        /// The goals as a motion.v1.Retarget in JSON, - for standard input: with speeds, and with limits, which may be
        /// lower than those of the motion.
        #[arg(long, value_name = "FILE.json", conflicts_with = "goals")]
        request: Option<PathBuf>,
    },
    /// Go on through further points, for a motion through points, until it begins to stop.
    Append {
        /// Points as a table in CSV, as `portamento pvt --points` reads them; times count from the last point so far, where the
        /// motion is then, and not where a row at time 0 says.
        #[arg(value_name = "FILE.csv")]
        points: PathBuf,
        /// Come to rest at the last of them.
        #[arg(long)]
        last: bool,
    },
    /// Come to rest and forget the rest of the motion.
    Stop,
}

fn goal(text: &str) -> Result<(String, f64), String> {
    let (axis, position) = text.rsplit_once('=').ok_or("write axis and position, as x=0.02")?;
    let position = position.parse().map_err(|_| format!("{position:?} is not a number"))?;
    Ok((axis.to_owned(), position))
}
