//! One axis's move by flags.

use clap::{Args, ValueEnum};
use planner::{AxisKind, AxisMoveSpec, LimitsSpec, RequestSpec, ShortPathPolicy, State, Synchronization};

use super::nanoseconds;
use crate::law::Law;

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
    /// Stretch the move, from rest to rest, to a whole number of cycles; an S-curve in each of its pieces, unless it
    /// waits for --minimum-duration.
    #[arg(long, help_heading = "Method")]
    end_on_cycle: bool,
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
        let distance = self.distance.unwrap_or(0.0);
        // A start that is no number is wrong by itself, and the goal with it.
        let way_end = if start_position.is_finite() { start_position + distance } else { distance };
        let goal_position = self.to.unwrap_or(way_end);
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

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Kind {
    Prismatic,
    Revolute,
    Pulses,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum ShortPath {
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
