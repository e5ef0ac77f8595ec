//! What a change of speed takes, written a second time: independent of the solver.

/// The time of a ramp.
pub(crate) fn ramp_time(change: f64, acceleration: f64, jerk: f64) -> f64 {
    if change * jerk < acceleration * acceleration {
        2.0 * (change / jerk).sqrt()
    } else {
        change / acceleration + acceleration / jerk
    }
}

/// The length of a ramp between two speeds.
pub(crate) fn ramp_length(from: f64, to: f64, acceleration: f64, jerk: f64) -> f64 {
    (from + to) / 2.0 * ramp_time((from - to).abs(), acceleration, jerk)
}
