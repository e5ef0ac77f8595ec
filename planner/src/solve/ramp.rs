use crate::float::{largest, sqrt};

/// A change of speed with no acceleration at both ends: jerk up, hold, jerk down \[s\].
///
/// ```text
/// a │  ╭────╮         ladder   (d ≥ a²/j):  jerk_time = a/j,    hold_time = d/a − a/j
///   │ ╱      ╲        triangle (d < a²/j):  jerk_time = √(d/j), hold_time = 0
///   └╱────────╲── t   d is the change of speed; both agree at d = a²/j
/// ```
/// Source: Bui, Le and Doan (2021), equations (1) to (3).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Ramp {
    pub(crate) jerk_time: f64,
    pub(crate) hold_time: f64,
}

impl Ramp {
    /// Reaches the acceleration limit.
    pub(crate) fn ladder(change: f64, acceleration: f64, jerk: f64) -> Self {
        let jerk_time = acceleration / jerk;
        Self { jerk_time, hold_time: largest(0.0, change / acceleration - jerk_time) }
    }

    /// Does not reach it. Takes the *root* of the change: near a large speed the change itself may be below one ulp.
    pub(crate) fn triangle(root_of_change: f64, root_of_jerk: f64) -> Self {
        Self { jerk_time: root_of_change / root_of_jerk, hold_time: 0.0 }
    }

    /// The ramp over `change ≥ 0`.
    pub(crate) fn over(change: f64, acceleration: f64, jerk: f64) -> Self {
        if reaches(change, acceleration, jerk) {
            Self::ladder(change, acceleration, jerk)
        } else {
            Self::triangle(sqrt(change), sqrt(jerk))
        }
    }

    pub(crate) fn time(&self) -> f64 {
        2.0 * self.jerk_time + self.hold_time
    }
}

/// Does a change of speed reach the acceleration limit? Written without a quotient, which would round at the boundary.
pub(crate) fn reaches(change: f64, acceleration: f64, jerk: f64) -> bool {
    change * jerk >= acceleration * acceleration
}

/// The length of a ramp between two speeds: its time times their mean, since it is point-symmetric.
pub(crate) fn length(from: f64, to: f64, acceleration: f64, jerk: f64) -> f64 {
    0.5 * (from + to) * Ramp::over((to - from).abs(), acceleration, jerk).time()
}
