use arrayvec::ArrayVec;

use crate::Limits;
use crate::float::{least, sqrt};
use crate::solve::ramp::Ramp;

/// The most lanes that a command can be driven in.
pub(super) const MAX_LANES: usize = 3;

/// Bounds that are constant throughout a command: velocity in `least ..= greatest`, acceleration in `−fall ..= rise`.
///
/// With constant bounds what can be driven is a convex set and the displacement a linear function on it. That is why the
/// displacements that a command can reach form an interval, and why its ends grow with the end velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lane {
    /// The velocities [axis units/s], signed; zero is one of them.
    pub(super) least: f64,
    pub(super) greatest: f64,
    /// How fast the velocity may rise and fall [axis units/s²], magnitudes.
    pub(super) rise: f64,
    pub(super) fall: f64,
    pub(super) jerk: f64,
    pub(super) root_of_jerk: f64,
}

impl Lane {
    /// Seen from the other side.
    pub(super) fn mirrored(&self) -> Self {
        let Self { least, greatest, rise, fall, .. } = *self;
        Self { least: -greatest, greatest: -least, rise: fall, fall: rise, ..*self }
    }

    /// Is `velocity` one of this lane's?
    pub(super) fn holds(&self, velocity: f64) -> bool {
        velocity >= self.least && velocity <= self.greatest
    }

    /// The limit of acceleration on the way from one velocity to another.
    pub(super) fn limit(&self, from: f64, to: f64) -> f64 {
        if to < from { self.fall } else { self.rise }
    }

    /// The least time from one velocity to another, at constant acceleration zero at both ends \[s\].
    pub(super) fn least_time(&self, from: f64, to: f64) -> f64 {
        Ramp::over((to - from).abs(), self.limit(from, to), self.jerk).time()
    }

    /// The velocity of this lane nearest to `wanted` that `duration` leads to from `from`.
    pub(super) fn nearest(&self, from: f64, wanted: f64, duration: f64) -> f64 {
        if wanted < from {
            return 0.0 - self.mirrored().nearest(-from, -wanted, duration);
        }
        let change = change_in(duration, self.rise, self.jerk);
        let reached = from + change;
        // Rounded down: near a large velocity one ulp may be much of the change.
        let reached = if reached - from > change { reached.next_down() } else { reached };
        least(least(wanted, self.greatest), reached)
    }
}

/// The greatest change of velocity in a time, the inverse of the least time of a ramp [axis units/s].
pub(super) fn change_in(duration: f64, acceleration: f64, jerk: f64) -> f64 {
    if duration * jerk <= 2.0 * acceleration {
        0.25 * jerk * duration * duration
    } else {
        acceleration * (duration - acceleration / jerk)
    }
}

/// The lanes of an axis.
///
/// Where speeding up and slowing down are limited alike there is one. Otherwise what a given acceleration does depends on the
/// direction of travel, so the bounds are constant only while that does not change: *forward* and *backward*, which end at
/// standstill. A command that changes direction keeps to the smaller of both limits throughout, *either way*.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lanes(ArrayVec<Lane, MAX_LANES>);

impl Lanes {
    pub(super) fn of(limits: &Limits) -> Self {
        let (acceleration, deceleration, jerk) =
            (limits.acceleration(), limits.deceleration(), limits.jerk());
        let smaller = least(acceleration, deceleration);
        let either = Lane {
            least: 0.0 - limits.cruise_towards(-1.0),
            greatest: limits.cruise_towards(1.0),
            rise: smaller,
            fall: smaller,
            jerk,
            root_of_jerk: sqrt(jerk),
        };
        let mut lanes = ArrayVec::new();
        // One way first: it reaches farther in its direction.
        if acceleration > smaller || deceleration > smaller {
            lanes.push(Lane { least: 0.0, rise: acceleration, fall: deceleration, ..either });
            lanes.push(Lane { greatest: 0.0, rise: deceleration, fall: acceleration, ..either });
        }
        lanes.push(either);
        Self(lanes)
    }

    /// Those that a command can begin in.
    pub(super) fn from(&self, velocity: f64) -> impl Iterator<Item = &Lane> {
        self.0.iter().filter(move |lane| lane.holds(velocity))
    }

    /// Is there but one?
    pub(super) fn are_one(&self) -> bool {
        self.0.len() == 1
    }
}
