//! Every flag, with its unit in `--help`, and an example for every command.

mod bench;
mod command;
mod compare;
mod diff;
mod field;
mod grade;
mod init;
mod limits;
mod motion;
mod pvt;
mod replay;
mod value;
mod watch;

use std::path::{Path, PathBuf};

use clap::{Args, ColorChoice, Parser, Subcommand};
use client::Connect;
use proto::Reason;

use crate::failure::Failure;
use crate::law::LawFlags;
pub(crate) use bench::BenchArgs;
pub(crate) use command::{CommandArgs, Order};
pub(crate) use compare::CompareArgs;
pub(crate) use diff::DiffArgs;
pub(crate) use field::{flag_of, in_flags};
pub(crate) use grade::GradeArgs;
pub(crate) use init::{InitArgs, What};
pub(crate) use limits::{HigherLimitFlags, LimitFlags};
pub(crate) use motion::{Kind, LOST_DISTANCE, MoveFlags};
pub(crate) use pvt::PvtArgs;
pub(crate) use replay::ReplayArgs;
use value::{endpoint, figure, nanoseconds, recording, scale};
pub(crate) use watch::WatchArgs;

/// Smooth, jerk-limited motion for machine axes: plans it, proves it, streams it.
///
/// Units are SI: metres (or radians, or pulses, by the kind of the axis) and seconds.
/// JSON in and out is the proto3 mapping of the messages in motion/v1/*.proto.
#[derive(Debug, Parser)]
#[command(
    name = "portamento",
    version,
    max_term_width = 80,
    arg_required_else_help = true,
    subcommand_required = true,
    after_help = "\
Examples:
  portamento demo
  portamento init
  portamento plan --request request.json --plot move.svg
  portamento plan --distance 0.05 --max-velocity 0.25 --max-acceleration 3 \\
      --max-jerk 100 --plot move.png --output move.json
  portamento pvt --points points.csv --max-velocity 0.5 \\
      --max-acceleration 4 --max-jerk 160 --plot points.svg
  portamento verify move.json
  portamento diff move.json other.json
  portamento sample move.json --output move.csv
  portamento track move.json --endpoint http://127.0.0.1:50052
  portamento command hold --axis http://127.0.0.1:50052
  portamento watch
  portamento replay run.mcap
  portamento grade
  portamento bench
  portamento explain PATH_TOO_SHORT

Exit codes:
  0  done
  1  failed; verify: the plan does not pass; diff, replay: they differ
  2  usage: a flag or an input file cannot be understood
  3  infeasible or refused, with the way out in the message
  4  the endpoint cannot be reached"
)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: Global,
    #[command(subcommand)]
    pub(crate) command: Command,
}

const EVERYWHERE: &str = "With every command";

/// What every command understands.
#[derive(Debug, Args)]
pub(crate) struct Global {
    /// Print JSON for programs, one document a line, instead of tables for people.
    #[arg(long, global = true, help_heading = EVERYWHERE)]
    pub(crate) json: bool,
    /// Ask the server at this address, as http://127.0.0.1:50051 or unix:/run/portamento.sock, instead of planning in this process; for track: the
    /// axis simulator.
    #[arg(long, global = true, value_name = "URL", help_heading = EVERYWHERE, value_parser = endpoint)]
    pub(crate) endpoint: Option<String>,
    #[command(flatten)]
    pub(crate) encryption: EncryptionFlags,
    /// When to use colours; auto: on a terminal, unless NO_COLOR is set.
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto", help_heading = EVERYWHERE)]
    pub(crate) color: ColorChoice,
}

/// For endpoints that begin with https://.
#[derive(Debug, Args)]
pub(crate) struct EncryptionFlags {
    /// Who vouches for servers whose address begins with https://.
    #[arg(long, global = true, env = "PORTAMENTO_TLS_CA", value_name = "FILE.pem", help_heading = EVERYWHERE, hide_env_values = true)]
    tls_ca: Option<PathBuf>,
    /// The certificate that servers know you by.
    #[arg(long, global = true, env = "PORTAMENTO_TLS_IDENTITY_CERT", value_name = "FILE.pem", help_heading = EVERYWHERE, hide_env_values = true)]
    tls_identity_cert: Option<PathBuf>,
    /// The key of that certificate.
    #[arg(long, global = true, env = "PORTAMENTO_TLS_IDENTITY_KEY", value_name = "FILE.pem", help_heading = EVERYWHERE, hide_env_values = true)]
    tls_identity_key: Option<PathBuf>,
}

impl EncryptionFlags {
    /// How to connect to servers.
    pub(crate) fn connect(&self) -> Result<Connect, Failure> {
        let read = |path: &PathBuf| {
            std::fs::read(path).map_err(|cause| Failure::Unreadable { path: path.clone(), cause })
        };
        let authority = self.tls_ca.as_ref().map(read).transpose()?;
        let connect = authority.into_iter().fold(Connect::new(), Connect::with_authority);
        match (&self.tls_identity_cert, &self.tls_identity_key) {
            (Some(certificate), Some(key)) => Ok(connect.with_identity(read(certificate)?, read(key)?)),
            (None, None) => Ok(connect),
            _ => Err(Failure::Usage(
                "--tls-identity-cert and --tls-identity-key go together: give both".to_owned(),
            )),
        }
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(DemoArgs),
    Init(InitArgs),
    Plan(Box<PlanArgs>),
    Pvt(Box<PvtArgs>),
    Compare(Box<CompareArgs>),
    Verify(VerifyArgs),
    Diff(DiffArgs),
    Sample(SampleArgs),
    Track(TrackArgs),
    #[command(name = "command")]
    Operate(CommandArgs),
    Watch(WatchArgs),
    Replay(ReplayArgs),
    Grade(GradeArgs),
    Bench(BenchArgs),
    Explain(ExplainArgs),
}

/// Plan a move and show it: phases, limits, certificate.
///
/// Ask by flags for one axis, by --request for one PlanRequest in JSON, or by --batch for one PlanRequest a line.
#[derive(Debug, Args)]
#[command(
    // `-0.05` is a number, never a flag.
    allow_negative_numbers = true,
    override_usage = "\
portamento plan --distance <U> --max-velocity <U/S>
           --max-acceleration <U/S²> --max-jerk <U/S³> [OPTIONS]
       portamento plan --request <FILE.json> [OPTIONS]
       portamento plan --batch <FILE.jsonl> [OPTIONS]",
    after_help = "\
Examples:
  50 mm, from rest to rest, with a plot and a file for verify and sample:
    portamento plan --distance 0.05 --max-velocity 0.25 \\
        --max-acceleration 3 --max-jerk 100 --plot move.svg --output move.json
  Backwards, leaving at speed; as near to it as so short a path allows:
    portamento plan --distance=-0.002 --end-velocity=-0.2 --max-velocity 0.25 \\
        --max-acceleration 3 --max-jerk 100 --short-path nearest-velocity
  From full motion to rest just ahead, past it and back:
    portamento plan --distance 0.01 --start-velocity 0.2 \\
        --start-acceleration 2 --max-velocity 0.25 --max-acceleration 3 \\
        --max-jerk 100 --short-path reverse
  Several axes that arrive together, one of them in motion, no earlier than
  after 0.8 s and on a cycle, from a file such as this one (_PHASE: on a
  straight line; _NONE: each as fast as it can):
    portamento plan --request request.json
    {\"synchronization\": \"SYNCHRONIZATION_TIME\",
     \"minimumDuration\": \"0.8s\", \"endOnCycle\": true, \"axes\": [
      {\"axis\": \"x\", \"kind\": \"AXIS_KIND_PRISMATIC\",
       \"start\": {\"velocity\": 0.1, \"acceleration\": 0.5},
       \"goal\": {\"position\": 0.05}, \"limits\": {\"maxVelocity\": 0.25,
       \"maxAcceleration\": 3, \"maxJerk\": 100}},
      {\"axis\": \"c\", \"kind\": \"AXIS_KIND_REVOLUTE\",
       \"goal\": {\"position\": 1.5}, \"limits\": {\"maxVelocity\": 6,
       \"maxAcceleration\": 40, \"maxJerk\": 900}}]}
  Many at once, an answer a line:
    portamento plan --batch requests.jsonl > answers.jsonl"
)]
pub(crate) struct PlanArgs {
    #[command(flatten)]
    pub(crate) one: MoveFlags,
    #[command(flatten)]
    pub(crate) limits: LimitFlags,
    #[command(flatten)]
    pub(crate) higher: HigherLimitFlags,
    #[command(flatten)]
    pub(crate) law: LawFlags,
    /// Plan the PlanRequest in this file, in proto3 JSON; '-' reads standard input.
    #[arg(long, value_name = "FILE.json", help_heading = "Input from files", group = "files",
        conflicts_with_all = ["batch", "MoveFlags", "LimitFlags", "HigherLimitFlags", "LawFlags"])]
    pub(crate) request: Option<PathBuf>,
    /// Plan every line of this file, a PlanRequest in proto3 JSON each, and print a line of JSON for each, in order:
    /// the PlanResponse, or {"error": ...}. Empty lines are skipped. '-' reads standard input. The exit code is 0
    /// whatever the lines say: each has its own answer.
    #[arg(long, value_name = "FILE.jsonl", help_heading = "Input from files", group = "files",
        conflicts_with_all = ["MoveFlags", "LimitFlags", "HigherLimitFlags", "LawFlags", "plot", "output"])]
    pub(crate) batch: Option<PathBuf>,
    /// Write a plot of position, velocity, acceleration and jerk over time.
    #[arg(long, value_name = "FILE.svg|png", help_heading = "Output", value_parser = figure)]
    pub(crate) plot: Option<PathBuf>,
    /// Save the Plan as JSON, for verify, sample and track.
    #[arg(long, value_name = "FILE.json", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
}

/// Judge a plan: recompute its extremes, joins and end from the pieces alone.
///
/// The exit code is 1 where the plan does not pass.
#[derive(Debug, Args)]
#[command(
    override_usage = "portamento verify <PLAN.json> [OPTIONS]",
    after_help = "\
Examples:
  portamento verify move.json
  portamento verify move.json --against request.json
  portamento plan --request request.json --json | portamento verify -"
)]
pub(crate) struct VerifyArgs {
    #[command(flatten)]
    pub(crate) source: PlanSource,
    /// Hold the plan against the limits and goals of this PlanRequest in JSON, by axis name, instead of its own;
    /// what an axis leaves out stays its own.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) against: Option<PathBuf>,
}

/// Print the setpoints of a plan, cycle by cycle, as CSV.
///
/// Numbers have as many digits as it takes to read the same bits back; cycle 0 is the start. The digest through the
/// last cycle goes to standard error; it is the one that an axis reports for the same setpoints.
/// A plan that does not pass the judge is refused.
#[derive(Debug, Args)]
#[command(
    override_usage = "portamento sample <PLAN.json> [OPTIONS]",
    after_help = "\
Examples:
  portamento sample move.json --output move.csv
  portamento sample move.json --first-cycle 100 --cycles 50
  portamento sample move.json --json | head -1"
)]
pub(crate) struct SampleArgs {
    #[command(flatten)]
    pub(crate) source: PlanSource,
    /// First cycle to print, from 0.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) first_cycle: u64,
    /// How many cycles to print, at most 36000000; to the end of the plan if not given, or 0.
    #[arg(long, value_name = "N", default_value_t = 0, hide_default_value = true)]
    pub(crate) cycles: u64,
    /// Write to this file instead of standard output.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) output: Option<PathBuf>,
}

/// Where a plan is read from.
#[derive(Debug, Args)]
pub(crate) struct PlanSource {
    /// The plan: a Plan (from plan --output) or a PlanResponse (from plan --json), in JSON; '-' reads standard input.
    #[arg(value_name = "PLAN.json", required_unless_present = "plan")]
    file: Option<PathBuf>,
    /// The same.
    #[arg(long, value_name = "PLAN.json", conflicts_with = "file")]
    plan: Option<PathBuf>,
}

impl PlanSource {
    /// Where it is read from.
    pub(crate) fn path(&self) -> &Path {
        let path = self.file.as_ref().or(self.plan.as_ref());
        // Clap wants one of them.
        path.map_or(Path::new("-"), PathBuf::as_path)
    }
}

/// Watch a move: two servers, an axis with a spring in it and a move of 50 mm, all in this process.
///
/// The plan goes over gRPC to the axis, which plays it in real time at one setpoint a millisecond from its own buffer.
/// While the axis speeds up its server is killed, and the other one goes on; then the move is slowed to half, held and resumed. Prints the plan, the operations and how the axis followed,
/// draws it, and compares families on the same move.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  portamento demo
  portamento demo --plot demo.png --record demo.mcap
  portamento demo --virtual-time --json")]
pub(crate) struct DemoArgs {
    /// Where to draw s, v, a and j, commanded against measured.
    #[arg(long, value_name = "FILE.svg|png", default_value = "portamento-demo.svg", value_parser = figure)]
    pub(crate) plot: PathBuf,
    /// Write down the run, for `portamento replay`, Foxglove and PlotJuggler; or its cycles, as a table.
    #[arg(long, value_name = "FILE.mcap|csv", value_parser = recording)]
    pub(crate) record: Option<PathBuf>,
    /// As fast as it computes, instead of one cycle a millisecond; operations may then come some cycles later.
    #[arg(long)]
    pub(crate) virtual_time: bool,
}

/// Have a running axis simulator follow a plan, and show how well it did.
///
/// The axis opens a stream at a planner, plays the plan from its own buffer and reports: following error, overshoot,
/// settling, residual vibration, and how the stream went.
#[derive(Debug, Args)]
#[command(
    override_usage = "portamento track <PLAN.json> [OPTIONS]",
    after_help = "\
Examples:
  portamento-server & portamento-sim-axis &
  portamento track move.json
  portamento track move.json --endpoint http://127.0.0.1:50052 \\
      --planner http://10.0.0.7:50051 --virtual-time --plot track.svg"
)]
pub(crate) struct TrackArgs {
    #[command(flatten)]
    pub(crate) source: PlanSource,
    /// The planner that the axis is to stream from, as the axis reaches it; several are tried in order.
    #[arg(long, value_name = "URL", default_value = "http://127.0.0.1:50051", value_parser = endpoint)]
    pub(crate) planner: Vec<String>,
    /// Name of the stream to open.
    #[arg(long, value_name = "NAME", default_value = "portamento-track")]
    pub(crate) stream: String,
    /// How far ahead the axis holds setpoints, 10 to 250 cycles: what a stall of server or network may take.
    #[arg(long, value_name = "CYCLES", default_value_t = 40, value_parser = clap::value_parser!(u32).range(10..=250))]
    pub(crate) lead: u32,
    /// As fast as it computes, instead of one cycle a millisecond; the numbers are the same.
    #[arg(long)]
    pub(crate) virtual_time: bool,
    /// How long to watch the axis after its last setpoint, with its unit, as 500ms; 500ms if not given.
    #[arg(long, value_name = "TIME", value_parser = nanoseconds)]
    pub(crate) settle_window: Option<i128>,
    /// How near to the goal counts as settled [u]; 10 um, 10 urad or one pulse if not given.
    #[arg(long, value_name = "U")]
    pub(crate) settle_tolerance: Option<f64>,
    /// Follow a plan too that promises no limits, as one through points joined by cubics or quintics.
    #[arg(long)]
    pub(crate) accept_unproved: bool,
    /// Have the axis evaluate the motion itself, with the same bits: the stream carries no setpoints.
    #[arg(long)]
    pub(crate) compact: bool,
    /// Have the axis try the planners in an order that follows from the name of the stream, so that the streams of a plant are
    /// spread over them.
    #[arg(long)]
    pub(crate) spread: bool,
    /// Write down the run, for `portamento replay`, Foxglove and PlotJuggler; or its cycles, as a table.
    #[arg(long, value_name = "FILE.mcap|csv", value_parser = recording)]
    pub(crate) record: Option<PathBuf>,
    /// Draw s, v, a and j of the axis, commanded against measured; of the first axis, where there are several.
    #[arg(long, value_name = "FILE.svg|png", value_parser = figure)]
    pub(crate) plot: Option<PathBuf>,
}

/// Say what the reason of a refusal means, and what to do about it.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  portamento explain PATH_TOO_SHORT
  portamento explain")]
pub(crate) struct ExplainArgs {
    /// The reason, as it stands in an error; all of them if not given.
    #[arg(value_parser = reason)]
    pub(crate) reason: Option<Reason>,
}

fn reason(name: &str) -> Result<Reason, String> {
    // As it stands in an error, or as flags are written.
    let upper = name.to_ascii_uppercase().replace('-', "_");
    let unknown = |error: proto::UnknownReason| {
        let closest = Reason::ALL.iter().map(|reason| (strsim::jaro(&upper, reason.name()), reason.name()));
        match closest.max_by(|a, b| a.0.total_cmp(&b.0)) {
            Some((likeness, name)) if likeness > 0.75 => {
                format!("did you mean {name}? `portamento explain` lists all of them")
            }
            _ => format!("{error}; `portamento explain` lists them"),
        }
    };
    upper.parse().map_err(unknown)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn flags_are_consistent() {
        Cli::command().debug_assert();
    }
}
