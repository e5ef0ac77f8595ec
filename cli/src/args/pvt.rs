use std::path::PathBuf;

use clap::{ArgGroup, Args, ValueEnum};
use planner::{AxisKind, PvtInterpolation, PvtPolicy};

use super::{Kind, LimitFlags, figure, nanoseconds};

/// Plan a motion through points of position, velocity and time, and show what becomes of each.
///
/// Ask by a table of points with --points, by --request for one PlanPvtRequest in JSON, by --batch for one a line, or
/// command by command with --follow.
#[derive(Debug, Args)]
#[command(
    allow_negative_numbers = true,
    group = ArgGroup::new("asked").args(["points", "follow", "request", "batch"]).required(true),
    override_usage = "\
portamento pvt --points <FILE.csv> --max-velocity <U/S>
           --max-acceleration <U/S²> --max-jerk <U/S³> [OPTIONS]
       portamento pvt --follow --max-velocity <U/S>
           --max-acceleration <U/S²> --max-jerk <U/S³> [OPTIONS]
       portamento pvt --request <FILE.json> [OPTIONS]
       portamento pvt --batch <FILE.jsonl> [OPTIONS]",
    after_help = "\
Points in CSV are a head and a row for each point, in the order of their times:
    time,x.position,x.velocity,y.position,y.velocity
    0.05,0.0012,0.031,-0.0003,0.012
    0.10,0.0031,0.046,0.0002,0.009
Times are in s from the start, positions in u, velocities in u/s, where u is m,
rad or pulses, by --kind. Every axis has both columns, in any order. A first row
at time 0 says where the axes start; without it they rest at 0. All axes have
the limits given by flags; where they differ, use --request.

With --follow each line of standard input is time,position,velocity of one axis,
and is answered before the next one is read; a first line at time 0 says where
the axis starts. What is refused leaves the axis where it was, and the next line
goes on from there; without a start that is taken nothing goes on.

Of each point the table gives its region, the positions that can be reached by
then, where the axis is and how fast, and by how much position (p), velocity (v)
and time (t) are not as asked. Regions are R1: past the end velocity and back to
it; R2: a ramp, then a cruise; R3: a cruise, then a ramp; R4: away from the end
velocity first.

Examples:
  A table, with a plot and a file for verify, sample and track:
    portamento pvt --points points.csv --max-velocity 0.5 \\
        --max-acceleration 4 --max-jerk 160 --plot points.svg --output plan.json
  Positions before velocities, and the last point even if it takes longer:
    portamento pvt --points points.csv --policy prefer-position \\
        --finish-unreached --max-velocity 0.5 --max-acceleration 4 \\
        --max-jerk 160
  Commands as a camera sends them, answered in JSON:
    camera | portamento pvt --follow --json --max-velocity 0.5 \\
        --max-acceleration 4 --max-jerk 160
  Several axes with limits of their own, from a file such as this one:
    portamento pvt --request request.json
    {\"policy\": \"PVT_POLICY_REJECT\", \"axes\": [
      {\"axis\": \"x\", \"kind\": \"AXIS_KIND_PRISMATIC\",
       \"limits\": {\"maxVelocity\": 0.5, \"maxAcceleration\": 4, \"maxJerk\": 160},
       \"times\": [0.2, 0.4], \"positions\": [0.02, 0.04],
       \"velocities\": [0.15, 0]}]}"
)]
pub(crate) struct PvtArgs {
    /// Plan the points in this table; '-' reads standard input.
    #[arg(long, value_name = "FILE.csv", help_heading = "Points")]
    pub(crate) points: Option<PathBuf>,
    /// Answer commands as they come on standard input, for one axis, in this process.
    #[arg(long, help_heading = "Points",
        conflicts_with_all = ["interpolation", "finish_unreached", "plot", "output", "endpoint"])]
    pub(crate) follow: bool,
    /// Plan the PlanPvtRequest in this file, in proto3 JSON; '-' reads standard input.
    #[arg(long, value_name = "FILE.json", help_heading = "Points", group = "files",
        conflicts_with_all = ["LimitFlags", "PointFlags"])]
    pub(crate) request: Option<PathBuf>,
    /// Plan every line of this file, a PlanPvtRequest in proto3 JSON each, and print a line of JSON for each, in order:
    /// the PlanPvtResponse, or {"error": ...}. Empty lines are skipped. '-' reads standard input.
    #[arg(long, value_name = "FILE.jsonl", help_heading = "Points", group = "files",
        conflicts_with_all = ["LimitFlags", "PointFlags", "plot", "output"])]
    pub(crate) batch: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) limits: LimitFlags,
    #[command(flatten)]
    pub(crate) method: PointFlags,
    /// Write a plot of position, velocity, acceleration and jerk over time, with the regions, what was asked, and what
    /// was not met.
    #[arg(long, value_name = "FILE.svg|png", help_heading = "Output", value_parser = figure)]
    pub(crate) plot: Option<PathBuf>,
    /// Save the Plan as JSON, for verify, sample and track.
    #[arg(long, value_name = "FILE.json", help_heading = "Output")]
    pub(crate) output: Option<PathBuf>,
}

/// What is the same for all points.
#[derive(Debug, Args)]
pub(crate) struct PointFlags {
    /// What the axes move in, and with it the unit u: prismatic [m] if not given, revolute [rad], or pulses.
    #[arg(long, value_enum, value_name = "KIND", help_heading = "Axes", hide_possible_values = true)]
    kind: Option<Kind>,
    /// What to do about a point that cannot be met; prefer-velocity if not given.
    #[arg(long, value_enum, value_name = "POLICY", help_heading = "Method")]
    policy: Option<Policy>,
    /// How points are joined; s-shaped if not given.
    #[arg(long, value_enum, value_name = "NAME", help_heading = "Method")]
    interpolation: Option<Interpolation>,
    /// After the last point, go on to its position and velocity without regard to time, if they were not reached.
    #[arg(long, help_heading = "Method")]
    pub(crate) finish_unreached: bool,
    /// Time between two setpoints, with its unit, as 1ms, 250us or 0.002s; 1ms if not given.
    #[arg(long, value_name = "TIME", help_heading = "Method", value_parser = nanoseconds)]
    pub(crate) cycle_time: Option<i128>,
}

impl PointFlags {
    pub(crate) fn kind(&self) -> AxisKind {
        self.kind.map_or(AxisKind::Prismatic, AxisKind::from)
    }

    pub(crate) fn policy(&self) -> PvtPolicy {
        match self.policy {
            None | Some(Policy::PreferVelocity) => PvtPolicy::PreferVelocity,
            Some(Policy::PreferPosition) => PvtPolicy::PreferPosition,
            Some(Policy::ExtendTime) => PvtPolicy::ExtendTime,
            Some(Policy::Reject) => PvtPolicy::Reject,
        }
    }

    pub(crate) fn interpolation(&self) -> PvtInterpolation {
        match self.interpolation {
            None | Some(Interpolation::SShaped) => PvtInterpolation::SShaped,
            Some(Interpolation::Cubic) => PvtInterpolation::Cubic,
            Some(Interpolation::Quintic) => PvtInterpolation::Quintic,
        }
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Policy {
    /// Keep velocity and time, come as near to the position as can be; the next point makes it up.
    PreferVelocity,
    /// Keep position and time, with the nearest velocity that reaches it.
    PreferPosition,
    /// Keep position and velocity, take the least extra time; later points keep their distance in time.
    ExtendTime,
    /// Refuse, and name the point, what can be reached, and when it could be met.
    Reject,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum Interpolation {
    /// Ramps of limited jerk: every limit is kept.
    SShaped,
    /// A cubic per interval, for comparison: acceleration jumps, no limit is kept.
    Cubic,
    /// A quintic per interval, for comparison: smooth, and swings; no limit is kept.
    Quintic,
}
