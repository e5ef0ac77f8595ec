//! Every flag, with its unit in `--help`, and an example for every command.

mod command;
mod limits;
mod pvt;

use std::path::PathBuf;

use clap::{Args, ColorChoice, Parser, Subcommand, ValueEnum};
use planner::{AxisKind, AxisMoveSpec, LimitsSpec, RequestSpec, ShortPathPolicy, State, Synchronization};
use proto::Reason;

use crate::law::{Law, LawFlags};
pub(crate) use command::{CommandArgs, Order};
pub(crate) use limits::{HigherLimitFlags, LimitFlags};
pub(crate) use pvt::PvtArgs;

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
  portamento plan --distance 0.05 --max-velocity 0.25 --max-acceleration 3 \\
      --max-jerk 100 --plot move.svg --output move.json
  portamento pvt --points points.csv --max-velocity 0.5 \\
      --max-acceleration 4 --max-jerk 160 --plot points.svg
  portamento verify --plan move.json
  portamento sample --plan move.json --output move.csv
  portamento track --plan move.json --endpoint http://127.0.0.1:50052
  portamento command hold --axis http://127.0.0.1:50052
  portamento explain PATH_TOO_SHORT

Exit codes:
  0  done
  1  failed; for verify: the plan does not pass
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
    /// Ask the server at this address, as http://127.0.0.1:50051, instead of planning in this process; for track: the
    /// axis simulator.
    #[arg(long, global = true, value_name = "URL", help_heading = EVERYWHERE, value_parser = endpoint)]
    pub(crate) endpoint: Option<String>,
    /// When to use colours; auto: on a terminal, unless NO_COLOR is set.
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto", help_heading = EVERYWHERE)]
    pub(crate) color: ColorChoice,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Demo(DemoArgs),
    Plan(Box<PlanArgs>),
    Pvt(Box<PvtArgs>),
    Compare(Box<CompareArgs>),
    Verify(VerifyArgs),
    Sample(SampleArgs),
    Track(TrackArgs),
    #[command(name = "command")]
    Operate(CommandArgs),
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
    #[arg(long, value_name = "FILE.svg", help_heading = "Output", value_parser = svg)]
    pub(crate) plot: Option<PathBuf>,
    /// Save the Plan as JSON, for verify, sample and track.
    #[arg(long, value_name = "FILE.json", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
}

/// One axis by flags. `u` is the unit of the axis: m, rad or pulses.
#[derive(Debug, Default, Args)]
pub(crate) struct MoveFlags {
    /// How far to go [u]; negative: backwards.
    #[arg(long, value_name = "U", help_heading = "Move", conflicts_with = "to")]
    #[arg(required_unless_present_any = ["to", "files"])]
    distance: Option<f64>,
    /// Where to go [u], instead of how far.
    #[arg(long, value_name = "U", help_heading = "Move")]
    to: Option<f64>,
    /// Where the move begins [u]; 0 if not given.
    #[arg(long, value_name = "U", help_heading = "Move")]
    from: Option<f64>,
    /// Velocity at the start [u/s]; 0 if not given, negative: backwards.
    #[arg(long, value_name = "U/S", help_heading = "Move")]
    start_velocity: Option<f64>,
    /// Velocity at the end [u/s]; 0 if not given, negative: backwards.
    #[arg(long, value_name = "U/S", help_heading = "Move")]
    end_velocity: Option<f64>,
    /// Acceleration at the start [u/s²], signed; 0 if not given. An S-curve's may be any.
    #[arg(long, value_name = "U/S²", help_heading = "Move")]
    start_acceleration: Option<f64>,
    /// Acceleration at the end [u/s²], signed; 0 if not given. An S-curve's may be any within the limits.
    #[arg(long, value_name = "U/S²", help_heading = "Move")]
    end_acceleration: Option<f64>,
    /// What the axis moves in, and with it the unit u: prismatic [m] if not given, revolute [rad], or pulses.
    #[arg(long, value_enum, value_name = "KIND", help_heading = "Axis", hide_possible_values = true)]
    kind: Option<Kind>,
    /// Name of the axis; x if not given.
    #[arg(long, value_name = "NAME", help_heading = "Axis")]
    axis: Option<String>,
    /// What to do when the path is too short for the end velocity; reject if not given.
    #[arg(long, value_enum, value_name = "POLICY", help_heading = "Method")]
    short_path: Option<ShortPath>,
    /// Time between two setpoints, with its unit, as 1ms, 250us or 0.002s; 1ms if not given.
    #[arg(long, value_name = "TIME", help_heading = "Method", value_parser = nanoseconds)]
    cycle_time: Option<i128>,
    /// Arrive no earlier than this, with its unit, as 1.5s or 800ms; 0s asks nothing.
    #[arg(long, value_name = "TIME", help_heading = "Method", value_parser = nanoseconds)]
    minimum_duration: Option<i128>,
    /// Stretch the move, from rest to rest, to a whole number of cycles; an S-curve in each of its pieces.
    #[arg(long, help_heading = "Method")]
    end_on_cycle: bool,
}

/// Plan one move with several families, have the same simulated axis follow each, and show the differences.
///
/// The axis is a linear motor of 6 kg on an air bearing that carries 1.5 kg on a flexible mount, read by a laser to 10 nm: it
/// swings at 33.5 Hz, with half a percent of critical damping, and the drive's position loop has a gain of 60/s. All of it
/// is simulated in this process, in virtual time: the same request, the same numbers.
#[derive(Debug, Args)]
#[command(
    allow_negative_numbers = true,
    override_usage = "\
portamento compare --distance <U> --max-velocity <U/S>
           --max-acceleration <U/S²> --max-jerk <U/S³> [OPTIONS]
       portamento compare --request <FILE.json>... [OPTIONS]",
    after_help = "\
Limits that a polynomial needs and that are not given are chosen, and printed:
each so that its derivative takes half the time of the one below to its limit,
s = 2 j²/a, c = 2 s²/j and so on. Every limit can then be reached.

Which family leaves least swinging depends on the mount: the third order leaves
nothing where its jerk lasts whole periods of the swing. Here, with the limits
of the first example, it lasts 1.7. Another axis can be given with --model.

Examples:
  The move of Nguyen, Ng and Chen (2008), 50 mm at 60 mm/s, with its figures:
    portamento compare --distance 0.05 --max-velocity 0.06 \\
        --max-acceleration 0.6 --max-jerk 12 --plot compare.svg
  Every order:
    portamento compare --distance 0.05 --max-velocity 0.06 \\
        --max-acceleration 0.6 --max-jerk 12 \\
        --families polynomial:2,polynomial:3,polynomial:6,polynomial:8
  Requests from files, each with a family and limits of its own:
    portamento compare --request gentle.json brisk.json --plot both.svg"
)]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) one: MoveFlags,
    #[command(flatten)]
    pub(crate) limits: LimitFlags,
    #[command(flatten)]
    pub(crate) higher: HigherLimitFlags,
    /// The families: s-curve, trapezoidal, polynomial:N with N from 2 to 8, trigonometric.
    #[arg(long, value_name = "FAMILY,...", value_delimiter = ',', value_parser = Law::named, help_heading = "Method",
        default_values_t = Law::OF_THE_PAPER)]
    pub(crate) families: Vec<Law>,
    /// Compare the PlanRequests in these files, in proto3 JSON.
    #[arg(long, value_name = "FILE.json", num_args = 1.., help_heading = "Input from files", group = "files",
        conflicts_with_all = ["MoveFlags", "LimitFlags", "HigherLimitFlags", "families"])]
    pub(crate) request: Vec<PathBuf>,
    /// What the axis that follows is made of: a list of one AxisModel, in proto3 JSON, instead of the linear motor.
    #[arg(long, value_name = "FILE.json", help_heading = "Input from files")]
    pub(crate) model: Option<PathBuf>,
    /// How near to the goal counts as settled [u]; 1 um, 1 urad or one pulse if not given.
    #[arg(long, value_name = "U", help_heading = "Output")]
    pub(crate) settle_tolerance: Option<f64>,
    /// Draw the velocities over each other, and the errors of motor and load.
    #[arg(long, value_name = "FILE.svg", help_heading = "Output")]
    pub(crate) plot: Option<PathBuf>,
}

/// Judge a plan: recompute its extremes, joins and end from the pieces alone.
///
/// The exit code is 1 where the plan does not pass.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  portamento verify --plan move.json
  portamento verify --plan move.json --against request.json
  portamento plan --request request.json --json | portamento verify --plan -")]
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
#[command(after_help = "\
Examples:
  portamento sample --plan move.json --output move.csv
  portamento sample --plan move.json --first-cycle 100 --cycles 50
  portamento sample --plan move.json --json | head -1")]
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
    #[arg(long, value_name = "FILE.json")]
    pub(crate) plan: PathBuf,
}

/// Watch a move: a server, an axis with a spring in it and a move of 50 mm, all in this process.
///
/// The plan goes over gRPC to the axis, which plays it in real time at one setpoint a millisecond from its own buffer.
/// On its way the move is slowed to half, held and resumed. Prints the plan, the operations and how the axis followed,
/// draws it, and compares families on the same move.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  portamento demo
  portamento demo --plot /tmp/demo.svg
  portamento demo --virtual-time --json")]
pub(crate) struct DemoArgs {
    /// Where to draw s, v, a and j, commanded against measured.
    #[arg(long, value_name = "FILE.svg", default_value = "portamento-demo.svg", value_parser = svg)]
    pub(crate) plot: PathBuf,
    /// As fast as it computes, instead of one cycle a millisecond; operations may then come some cycles later.
    #[arg(long)]
    pub(crate) virtual_time: bool,
}

/// Have a running axis simulator follow a plan, and show how well it did.
///
/// The axis opens a stream at a planner, plays the plan from its own buffer and reports: following error, overshoot,
/// settling, residual vibration, and how the stream went.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  portamento-server & portamento-sim-axis &
  portamento track --plan move.json --endpoint http://127.0.0.1:50052
  portamento track --plan move.json --endpoint http://127.0.0.1:50052 \\
      --planner http://10.0.0.7:50051 --virtual-time --plot track.svg")]
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
    /// Draw s, v, a and j of the axis, commanded against measured; of the first axis, where there are several.
    #[arg(long, value_name = "FILE.svg", value_parser = svg)]
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
    let parsed = name.to_ascii_uppercase().parse();
    parsed.map_err(|error: proto::UnknownReason| format!("{error}; `portamento explain` lists them"))
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Kind {
    Prismatic,
    Revolute,
    Pulses,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum ShortPath {
    /// Refuse, and name the least length.
    Reject,
    /// End at the reachable velocity that is closest.
    NearestVelocity,
    /// End at the start velocity, as the published eight-type S-curve does.
    MatchStartVelocity,
    /// Keep every end condition: overshoot or go back.
    Reverse,
}

impl From<Kind> for AxisKind {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Prismatic => Self::Prismatic,
            Kind::Revolute => Self::Revolute,
            Kind::Pulses => Self::Pulses,
        }
    }
}

/// What is said of a distance that --from swallows.
pub(crate) const LOST_DISTANCE: &str = "--distance is less than the rounding of a position so far away as --from: give a longer one, or begin nearer to 0";

impl MoveFlags {
    /// Is the distance too short to tell the goal from the start?
    #[expect(clippy::float_cmp, reason = "a goal of the same bits is the start")]
    pub(crate) fn distance_is_lost(&self) -> bool {
        let (from, distance) = (self.from.unwrap_or(0.0), self.distance.unwrap_or(0.0));
        self.to.is_none() && distance != 0.0 && from + distance == from
    }

    /// The request that the flags and the law stand for; nothing but clap has checked it.
    pub(crate) fn to_spec(&self, limits: LimitsSpec, law: Law) -> RequestSpec {
        let start_position = self.from.unwrap_or(0.0);
        let goal_position = self.to.unwrap_or(start_position + self.distance.unwrap_or(0.0));
        let at = |position, velocity: Option<f64>, acceleration: Option<f64>| State {
            position,
            velocity: velocity.unwrap_or(0.0),
            acceleration: acceleration.unwrap_or(0.0),
        };
        let axis = AxisMoveSpec {
            axis: self.axis.clone().unwrap_or_else(|| "x".to_owned()),
            kind: Ok(self.kind.map_or(AxisKind::Prismatic, AxisKind::from)),
            start: at(start_position, self.start_velocity, self.start_acceleration),
            goal: at(goal_position, self.end_velocity, self.end_acceleration),
            limits,
        };
        RequestSpec {
            axes: vec![axis],
            cycle_time_ns: self.cycle_time,
            family: Ok(law.family),
            order: law.order,
            short_path: Ok(match self.short_path {
                None | Some(ShortPath::Reject) => ShortPathPolicy::Reject,
                Some(ShortPath::NearestVelocity) => ShortPathPolicy::NearestVelocity,
                Some(ShortPath::MatchStartVelocity) => ShortPathPolicy::MatchStartVelocity,
                Some(ShortPath::Reverse) => ShortPathPolicy::Reverse,
            }),
            synchronization: Ok(Synchronization::default()),
            minimum_duration: self.minimum_duration.map(|ns| ns as f64 / 1e9),
            end_on_cycle: self.end_on_cycle,
        }
    }
}

/// Fields of a request made from flags, and the flags that set them. Where one name begins with another, it
/// comes first.
const FLAGS: [(&str, &str); 25] = [
    ("interpolation", "--interpolation"),
    ("policy", "--policy"),
    ("finish_unreached", "--finish-unreached"),
    ("cycle_time", "--cycle-time"),
    ("family", "--family"),
    ("order", "--order"),
    ("short_path_policy", "--short-path"),
    ("minimum_duration", "--minimum-duration"),
    ("end_on_cycle", "--end-on-cycle"),
    ("start.position", "--from"),
    ("start.velocity", "--start-velocity"),
    ("start.acceleration", "--start-acceleration"),
    ("goal.position", "--to or --distance"),
    ("goal.velocity", "--end-velocity"),
    ("goal.acceleration", "--end-acceleration"),
    ("limits.max_velocity_reverse", "--max-velocity-reverse"),
    ("limits.max_velocity", "--max-velocity"),
    ("limits.max_acceleration", "--max-acceleration"),
    ("limits.max_jerk", "--max-jerk"),
    ("limits.max_deceleration", "--max-deceleration"),
    ("limits.min_position", "--min-position"),
    ("limits.max_position", "--max-position"),
    ("limits.feed_rate", "--feed-rate"),
    ("limits.max_snap", "--max-snap"),
    ("limits.max_higher_derivatives", "--max-higher-derivatives"),
];

/// The flag that sets the field, so that a refusal speaks of what was typed. All axes have what the flags say.
pub(crate) fn flag_of(field: &str) -> Option<&'static str> {
    let of_axis = field.strip_prefix("axes[").and_then(|rest| rest.split_once("]."));
    let field = of_axis.map_or(field, |(_, field)| field);
    FLAGS.iter().find(|(name, _)| *name == field).map(|(_, flag)| *flag)
}

/// A text with flags in place of the fields that it names.
pub(crate) fn in_flags(text: &str) -> String {
    // `order` and `family` are words as well.
    let names = FLAGS.iter().filter(|(name, _)| name.contains(['.', '_']));
    names.fold(text.to_owned(), |text, (name, flag)| text.replace(name, flag))
}

/// The address of a server, as far as it can be told without asking there.
fn endpoint(text: &str) -> Result<String, String> {
    let wanted = "give http://HOST:PORT, as http://127.0.0.1:50051";
    let authority = text.strip_prefix("http://").ok_or_else(|| match text.starts_with("https://") {
        true => format!("encryption is not implemented: {wanted}"),
        false => wanted.to_owned(),
    })?;
    let authority = authority.strip_suffix('/').unwrap_or(authority);
    let (host, port) = match authority.rsplit_once(':') {
        Some((host, port)) if !port.ends_with(']') => (host, Some(port)),
        _ => (authority, None),
    };
    // What resolves is for the resolver to say; what could not be a name or a number is a slip of the finger.
    let of_host = |c: char| c.is_ascii_alphanumeric() || "-._~[]:%".contains(c);
    if host.is_empty() || !host.chars().all(of_host) {
        return Err(format!("{host:?} is not a host: {wanted}"));
    }
    match port.map(str::parse::<u16>) {
        Some(Err(_)) => Err(format!("{:?} is not a port: {wanted}", port.unwrap_or_default())),
        Some(Ok(_)) | None => Ok(text.to_owned()),
    }
}

/// A file for a plot: of the one format that is written, so that no file holds what its name does not say.
fn svg(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_svg = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg"));
    if is_svg {
        return Ok(path);
    }
    let named = path.with_extension("svg");
    Err(format!("plots are SVG, and other formats are made from it: name a file such as {}", named.display()))
}

/// A time with its unit, in whole nanoseconds. Whether it is long enough is for the planner to say.
fn nanoseconds(text: &str) -> Result<i128, String> {
    const UNITS: [(&str, f64); 5] = [("ns", 1.0), ("us", 1e3), ("µs", 1e3), ("ms", 1e6), ("s", 1e9)];
    let (number, scale) = UNITS
        .iter()
        .find_map(|(unit, scale)| Some((text.strip_suffix(unit)?, *scale)))
        .ok_or("give its unit as well: 1ms, 250us or 0.002s")?;
    let number: f64 = number.trim().parse().map_err(|_| format!("{number:?} is not a number"))?;
    let ns = (number * scale).round();
    // Beyond this a double does not count nanoseconds any more, and no plan lasts as long.
    const LONGEST_NS: f64 = 9e15;
    if ns.abs() <= LONGEST_NS { Ok(ns as i128) } else { Err("give at most 9000000s".to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory as _;

    #[test]
    fn flags_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn endpoints_are_addresses() {
        let good = ["http://127.0.0.1:50051", "http://cell-7.local:80/", "http://[::1]:50051", "http://host"];
        for text in good {
            assert_eq!(endpoint(text), Ok(text.to_owned()));
        }
        let bad =
            ["foo bar", "localhost:50051", "http://", "http://a b:1", "http://h:99999", "https://h:1", ""];
        for text in bad {
            assert!(endpoint(text).is_err_and(|why| why.contains("http://127.0.0.1:50051")), "{text}");
        }
    }

    #[test]
    fn plots_are_named_for_what_they_are() {
        assert_eq!(svg("a/b.SVG"), Ok(PathBuf::from("a/b.SVG")));
        for (text, named) in [("x.png", "x.svg"), ("plot", "plot.svg"), ("a.svg/b", "a.svg/b.svg")] {
            assert!(svg(text).is_err_and(|why| why.ends_with(named)), "{text}");
        }
    }

    #[test]
    fn times_have_units() {
        let rows = [("1ms", 1_000_000), ("250us", 250_000), ("0.002s", 2_000_000), ("-1 ms", -1_000_000)];
        for (text, ns) in rows {
            assert_eq!(nanoseconds(text), Ok(ns), "{text}");
        }
        for text in ["1", "ms", "NaNs", "1e300s"] {
            assert!(nanoseconds(text).is_err(), "{text}");
        }
    }
}
