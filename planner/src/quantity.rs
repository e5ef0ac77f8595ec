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
    /// [s]
    Time,
}
