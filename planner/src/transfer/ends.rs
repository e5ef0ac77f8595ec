use crate::float::{largest, sqrt};

/// How long each of the seven phases lasts, of jerk `+ 0 − 0 − 0 +`: up to a peak of the acceleration, down to a valley, and up
/// to the end; where the fourth lasts, velocity stays at its limit, else the third and the fifth are one.
pub(super) type Phases = [f64; 7];

/// Of the velocities that are compared \[1\]: what they and the squares of the accelerations are rounded to. A difference below it
/// is none: for a peak takes the root of it, and half of the digits of a duration would be made of roundings.
const ROUNDED: f64 = 8.0 * f64::EPSILON;

/// The ends of a motion in the time unit that makes the jerk limit 1: accelerations are times, velocities their squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    pub(super) start: Moving,
    pub(super) goal: Moving,
}

/// Velocity and acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moving {
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
}

impl Moving {
    pub(super) fn mirrored(self) -> Self {
        Self { velocity: -self.velocity, acceleration: -self.acceleration }
    }

    /// The velocity that is reached when full jerk takes the acceleration to zero.
    pub(super) fn coasting(self) -> f64 {
        self.velocity + 0.5 * self.acceleration * self.acceleration.abs()
    }

    /// Run backwards.
    pub(super) fn reversed(self) -> Self {
        Self { velocity: self.velocity, acceleration: -self.acceleration }
    }

    /// The way under `jerk` for `time`; leaves the state at its end behind.
    pub(super) fn advance(&mut self, jerk: f64, time: f64) -> f64 {
        let Self { velocity, acceleration } = *self;
        self.velocity += time * (acceleration + time * (jerk * 0.5));
        self.acceleration += time * jerk;
        time * (velocity + time * (acceleration * 0.5 + time * (jerk / 6.0)))
    }
}

impl Ends {
    pub(super) fn mirrored(self) -> Self {
        Self { start: self.start.mirrored(), goal: self.goal.mirrored() }
    }

    /// Run backwards: from the goal to the start over the same way.
    pub(super) fn reversed(self) -> Self {
        Self { start: self.goal.reversed(), goal: self.start.reversed() }
    }

    pub(super) fn velocity_change(&self) -> f64 {
        self.goal.velocity - self.start.velocity
    }

    pub(super) fn acceleration_change(&self) -> f64 {
        self.goal.acceleration - self.start.acceleration
    }

    pub(super) fn mean_acceleration(&self) -> f64 {
        0.5 * (self.start.acceleration + self.goal.acceleration)
    }

    /// `difference` of two velocities, but for what is rounding.
    pub(super) fn beyond_rounding(&self, difference: f64) -> f64 {
        let size = |end: &Moving| end.velocity.abs() + end.acceleration * end.acceleration;
        if difference > ROUNDED * (size(&self.start) + size(&self.goal)) { difference } else { 0.0 }
    }

    /// What the square of a peak is more than that of the valley after it: `Δv − ā·δ`, while neither is held.
    pub(super) fn peak_excess(&self) -> f64 {
        self.velocity_change() - self.mean_acceleration() * self.acceleration_change()
    }

    /// Does the fastest change from one end to the other raise the acceleration first? That of constant jerk from one
    /// acceleration to the other changes the velocity by `ā·|δ|`; more needs a peak, less a valley.
    pub(super) fn change_has_peak(&self) -> bool {
        self.velocity_change() >= self.mean_acceleration() * self.acceleration_change().abs()
    }

    /// The fastest change of velocity and acceleration, wherever it leads, where it has a peak: phases 1 to 3. The valley is its
    /// mirror image.
    ///
    /// With the peak at `P`, `2P² = a₀² + a₁² + 2·Δv`. The unknown is what the shorter of both flanks has to go, so that no digits
    /// are lost where that is little.
    pub(super) fn fastest_change(&self, limit: f64) -> [f64; 3] {
        let (first, last) = (self.start.acceleration, self.goal.acceleration);
        let (change, step) = (self.velocity_change(), self.acceleration_change());
        let beyond = self.beyond_rounding(change - self.mean_acceleration() * step.abs());
        let rise = |from: f64| {
            let peak = sqrt(from * from + beyond);
            if from > 0.0 { beyond / (from + peak) } else { peak - from }
        };
        let (up, down) = if step >= 0.0 {
            let down = rise(last);
            (down + step, down)
        } else {
            let up = rise(first);
            (up, up - step)
        };
        if first + up <= limit {
            return [up, 0.0, down];
        }
        let (up, down) = (limit - first, limit - last);
        let hold = (change + 0.5 * (up * up + down * down)) / limit - up - down;
        [up, largest(0.0, hold), down]
    }
}
