//! Position, velocity and time together: the axis is to be at a position with a velocity at an instant, again and again.
//!
//! Follows the method of doi:10.1177/17298814211072418 (Int. J. Adv. Robot. Syst., 2022). Its extremes, regions and ramps are
//! derived in `notes/0008-position-velocity-time.md`.

mod command;
mod extreme;
mod lane;
mod offers;
mod pieces;
mod planner;
mod polynomial;
mod request;
mod sequence;

pub use offers::PvtOffers;
pub use planner::{PvtMove, PvtPlanner, PvtTarget};
pub use request::{PvtAxis, PvtAxisSpec, PvtRequest, PvtRequestSpec, wrong_time};
pub use sequence::{PvtPlan, PvtPointReport, plan_pvt, plan_pvt_by};

/// How a plan through points was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PvtMethod {
    /// How points are joined.
    pub interpolation: PvtInterpolation,
    /// What was to be done about points that cannot be met.
    pub policy: PvtPolicy,
}

/// What to do about a command whose position, velocity and time cannot all be met.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PvtPolicy {
    /// Keep velocity and time and come as near to the position as can be; where the time is too short even for the
    /// velocity, the nearest velocity.
    #[default]
    PreferVelocity,
    /// Keep position and time, with the nearest end velocity that reaches it; where none does, the one that comes nearest.
    PreferPosition,
    /// Keep position and velocity, and take the first later time in which both can be met.
    ExtendTime,
    /// Refuse, and say what could be met.
    Reject,
}

/// How a motion goes from one point to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PvtInterpolation {
    /// Ramps of constant jerk and a cruise: keeps every limit, and every acceleration at a point is zero.
    #[default]
    SShaped,
    /// The cubic through both states: the acceleration jumps at the points, and no limit is kept.
    Cubic,
    /// The quintic through both states with an acceleration of zero at both: no limit is kept, and it may swing back.
    Quintic,
}

/// Where a command lies between what stays back farthest (R4) and what leads farthest (R1), in the direction of the change of
/// velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PvtRegion {
    /// Past the end velocity, cruise, and back to it.
    R1,
    /// A ramp, then a cruise at the end velocity.
    R2,
    /// A cruise at the start velocity, then a ramp.
    R3,
    /// Away from the end velocity, cruise, and then to it.
    R4,
}

impl PvtPolicy {
    /// The name on the wire.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::PreferVelocity => "PREFER_VELOCITY",
            Self::PreferPosition => "PREFER_POSITION",
            Self::ExtendTime => "EXTEND_TIME",
            Self::Reject => "REJECT",
        }
    }
}

impl PvtInterpolation {
    /// The name on the wire.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SShaped => "S_SHAPED",
            Self::Cubic => "CUBIC",
            Self::Quintic => "QUINTIC",
        }
    }
}

impl PvtRegion {
    /// The name in the paper and on the wire.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::R1 => "R1",
            Self::R2 => "R2",
            Self::R3 => "R3",
            Self::R4 => "R4",
        }
    }

    /// The region called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        [Self::R1, Self::R2, Self::R3, Self::R4].into_iter().find(|region| region.name() == name)
    }
}
