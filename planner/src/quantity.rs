use crate::MAX_ORDER;

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
    /// [axis units/s⁵]
    Crackle,
    /// [axis units/s⁶]
    Pop,
    /// [axis units/s⁷]
    Lock,
    /// [axis units/s⁸]
    Drop,
    /// \[s\]
    Time,
}

impl Quantity {
    /// Position and its derivatives, each at the index of its order.
    pub const BY_ORDER: [Self; MAX_ORDER + 1] = [
        Self::Position,
        Self::Velocity,
        Self::Acceleration,
        Self::Jerk,
        Self::Snap,
        Self::Crackle,
        Self::Pop,
        Self::Lock,
        Self::Drop,
    ];

    /// How often position is derived to give it: 0 for position itself, none for time.
    ///
    /// ```
    /// # use planner::Quantity;
    /// assert_eq!(Quantity::Snap.order(), Some(4));
    /// assert_eq!(Quantity::BY_ORDER[4], Quantity::Snap);
    /// ```
    #[must_use]
    pub fn order(self) -> Option<usize> {
        Self::BY_ORDER.iter().position(|&quantity| quantity == self)
    }
}

impl core::fmt::Display for Quantity {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Snap => "snap",
            Self::Crackle => "crackle",
            Self::Pop => "pop",
            Self::Lock => "lock",
            Self::Drop => "drop",
            Self::Time => "time",
        })
    }
}
