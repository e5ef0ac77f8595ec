use crate::float::{largest, least, sqrt};

/// How long each of the seven phases lasts, of jerk `+ 0 − 0 − 0 +`: up to a peak of the acceleration, down to a valley, and up
/// to the end; where the fourth lasts, velocity stays at its limit, else the third and the fifth are one.
pub(super) type Phases = [f64; 7];

/// Of the velocities that are compared \[1\]: what they and the squares of the accelerations are rounded to. A difference below it
/// is none: for a peak takes the root of it, and half of the digits of a duration would be made of roundings.
const ROUNDED: f64 = 32.0 * f64::EPSILON;

/// Of a way \[1\]: one that differs from a motion's by less is that motion's, of which start and goal are rounded, and so was each
/// piece of a longer motion that led there. Beside the fastest change of velocity, and at the end of the lens, the next motion
/// that arrives may take far longer: there every motion lies that is planned again on its last flank.
const WAY_ROUNDED: f64 = 512.0 * f64::EPSILON;

/// The ends of a motion in the time unit that makes the jerk limit 1: accelerations are times, velocities their squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends {
    pub(super) start: Moving,
    pub(super) goal: Moving,
    /// From the start to the goal: of numbers that lie close their difference is known better than they are.
    pub(super) change: Moving,
}

/// Velocity and acceleration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moving {
    pub(super) velocity: f64,
    pub(super) acceleration: f64,
}

impl Moving {
    pub(super) fn to(self, goal: Self) -> Self {
        let Self { velocity, acceleration } = self;
        Self { velocity: goal.velocity - velocity, acceleration: goal.acceleration - acceleration }
    }

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
    /// Where the velocity changes as it does under constant jerk, but for its rounding, it is taken to do so: next to that the
    /// duration is the root of what is left, or jumps.
    pub(super) fn new(start: Moving, goal: Moving, change: Moving) -> Self {
        let mut ends = Self { start, goal, change };
        let beyond = ends.beyond_constant_jerk();
        if ends.beyond_rounding(beyond.abs()) == 0.0 {
            ends.change.velocity = ends.mean_acceleration() * change.acceleration.abs();
        }
        ends
    }

    pub(super) fn mirrored(self) -> Self {
        let Self { start, goal, change } = self;
        Self { start: start.mirrored(), goal: goal.mirrored(), change: change.mirrored() }
    }

    /// Run backwards: from the goal to the start over the same way.
    pub(super) fn reversed(self) -> Self {
        let Self { start, goal, change } = self;
        let change = Moving { velocity: -change.velocity, ..change };
        Self { start: goal.reversed(), goal: start.reversed(), change }
    }

    pub(super) fn mean_acceleration(&self) -> f64 {
        0.5 * (self.start.acceleration + self.goal.acceleration)
    }

    /// What the way of a motion that takes `time` is rounded to, where its positions are exact: of its first terms,
    /// `T·(v₀ + v₁)/2 + T²·(a₀ − a₁)/12`, of which the accelerations count for as long as they last.
    pub(super) fn way_rounding(&self, time: f64) -> f64 {
        let Self { start, goal, .. } = self;
        let speeds = 0.5 * (start.velocity.abs() + goal.velocity.abs());
        let accelerations = start.acceleration.abs() + goal.acceleration.abs();
        WAY_ROUNDED * time * (speeds + least(time, accelerations) * accelerations / 12.0)
    }

    /// Are both ends the same, but for their rounding?
    pub(super) fn are_one(&self) -> bool {
        let Self { start, goal, change } = self;
        let hardest = largest(start.acceleration.abs(), goal.acceleration.abs());
        change.acceleration.abs() <= ROUNDED * hardest && self.beyond_rounding(change.velocity.abs()) == 0.0
    }

    /// `difference` of two velocities, but for what is rounding.
    pub(super) fn beyond_rounding(&self, difference: f64) -> f64 {
        let size = |end: &Moving| end.velocity.abs() + end.acceleration * end.acceleration;
        if difference > ROUNDED * (size(&self.start) + size(&self.goal)) { difference } else { 0.0 }
    }

    /// What the square of a peak is more than that of the valley after it: `Δv − ā·δ`, while neither is held.
    pub(super) fn peak_excess(&self) -> f64 {
        self.change.velocity - self.mean_acceleration() * self.change.acceleration
    }

    /// Does the fastest change from one end to the other raise the acceleration first? That of constant jerk from one
    /// acceleration to the other changes the velocity by `ā·|δ|`; more needs a peak, less a valley.
    ///
    /// Where it is that change, the side is taken on which little more takes little longer: on the other, if both accelerations
    /// have the same sign, the whole way through zero and back lies before the next change.
    pub(super) fn change_has_peak(&self) -> bool {
        let beyond = self.beyond_constant_jerk();
        if beyond == 0.0 { self.mean_acceleration() >= 0.0 } else { beyond > 0.0 }
    }

    /// How much more the velocity changes than under constant jerk.
    fn beyond_constant_jerk(&self) -> f64 {
        self.change.velocity - self.mean_acceleration() * self.change.acceleration.abs()
    }

    /// The fastest change of velocity and acceleration, wherever it leads, where it has a peak: phases 1 to 3. The valley is its
    /// mirror image.
    ///
    /// With the peak at `P`, `2P² = a₀² + a₁² + 2·Δv`. The unknown is what the shorter of both flanks has to go, so that no digits
    /// are lost where that is little.
    pub(super) fn fastest_change(&self, limit: f64) -> [f64; 3] {
        let (first, last) = (self.start.acceleration, self.goal.acceleration);
        let step = self.change.acceleration;
        let beyond = largest(0.0, self.beyond_constant_jerk());
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
        let hold = (self.change.velocity + 0.5 * (up * up + down * down)) / limit - up - down;
        [up, largest(0.0, hold), down]
    }
}
