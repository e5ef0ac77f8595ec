/// A derivative of position by time, or time itself: what a limit, a check or an adjustment is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Quantity {
    /// [axis units]
    Position,
    /// [axis units/s]
    Velocity,
    /// [axis units/s²]
    Acceleration,
    /// [axis units/s³]
    Jerk,
    /// [axis units/s⁴]
    Snap,
    /// \[s\]
    Time,
}

impl core::fmt::Display for Quantity {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Snap => "snap",
            Self::Time => "time",
        })
    }
}
