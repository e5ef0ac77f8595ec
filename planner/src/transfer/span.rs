use super::course::SIGNS;
use super::ends::{Ends, Phases};
use super::timed::SAME_TIME;
use super::upper::{Flank, Upper};
use crate::float::{largest, least, sqrt};

/// The member of a family that takes a given time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    pub(super) phases: Phases,
    /// How far it goes.
    pub(super) way: f64,
    /// How fast that grows with the time, `v_c + P·B/2`.
    pub(super) pace: f64,
}

impl Upper {
    /// How long the first member lasts that passes zero acceleration on the way down.
    pub(super) fn passes_zero_from(&self) -> f64 {
        self.summit_at(0.0).time()
    }

    /// The member that takes `time`; the nearest, where the family has none.
    pub(super) fn lasting(&self, time: f64) -> Member {
        let lowest = self.summit_at(0.0);
        let from = lowest.time();
        if time < from * (1.0 - SAME_TIME) {
            return self.member_of(self.in_lens(time), 0.0);
        }
        if time <= from {
            return self.member_of(lowest.phases(0.0), 0.0);
        }
        let highest = self.summit_at(self.room());
        let cruise = time - highest.time();
        if cruise >= 0.0 {
            return self.member_of(highest.phases(cruise), cruise);
        }
        self.member_of(self.climbing(time), 0.0)
    }

    /// Above the lowest summit and below the limit of velocity.
    fn climbing(&self, time: f64) -> Phases {
        let Ends { start, goal, .. } = self.ends;
        let feet = self.feet();
        let first_reach = Flank::reach(start, self.up) - feet.first;
        let last_reach = Flank::reach(goal.reversed(), self.down) - feet.last;
        let room = self.room();
        let starts = |reach: f64| reach < room && self.summit_at(largest(0.0, reach)).time() <= time;
        match (starts(first_reach), starts(last_reach)) {
            (false, false) => self.free_lasting(time),
            (true, false) => self.half_held_lasting(time),
            (false, true) => {
                let mut phases = self.reversed().half_held_lasting(time);
                phases.reverse();
                phases
            }
            (true, true) => {
                let mut reached = self.summit_at(largest(0.0, largest(first_reach, last_reach)));
                let Self { up, down, .. } = *self;
                let longer = largest(0.0, time - reached.time()) / (up + down);
                reached.first.hold += longer * down;
                reached.last.hold += longer * up;
                reached.phases(0.0)
            }
        }
    }

    /// Before the acceleration comes to zero: the valley, which is not held, stays above it. The mirror image in time where the
    /// accelerations are negative.
    fn in_lens(&self, time: f64) -> Phases {
        let backwards = !self.ends.change_has_peak();
        let family = if backwards { self.reversed() } else { *self };
        let free = family.free_lasting(time);
        let peak = family.ends.start.acceleration + free[0];
        let mut phases = if peak > family.up { family.half_held_lasting(time) } else { free };
        if backwards {
            phases.reverse();
        }
        phases
    }

    /// Neither acceleration is held: see [`Self::free`] for the formula. `κ/y = W/y − 2·ā` with `W` the [`Ends::peak_excess`], which is
    /// exactly zero where the velocity changes under constant jerk and nothing falls.
    fn free_lasting(&self, time: f64) -> Phases {
        let Ends { change, .. } = self.ends;
        let y = largest(0.0, 0.5 * (time - change.acceleration));
        let excess = self.ends.peak_excess();
        let k =
            if excess == 0.0 || y == 0.0 { 0.0 } else { excess / y } - 2.0 * self.ends.mean_acceleration();
        // Neither rise is less than nothing.
        let sum = largest(0.0, y + change.acceleration);
        let k = largest(-sum, least(sum, k));
        [0.5 * (sum + k), 0.0, y, 0.0, 0.0, 0.0, 0.5 * (sum - k)]
    }

    /// The upper limit is held and the valley free: `A·T = Δv + (r² − f²)/2 + z²`, see [`Self::half_held`].
    fn half_held_lasting(&self, time: f64) -> Phases {
        let Ends { start, goal, change } = self.ends;
        let limit = self.up;
        let (rise, gap) = (limit - start.acceleration, limit - goal.acceleration);
        let square = change.velocity + 0.5 * (rise * rise - gap * gap);
        let z = sqrt(largest(0.0, limit * time - square));
        let climb = largest(0.0, z - gap);
        [rise, largest(0.0, time - rise - z - climb), z, 0.0, 0.0, 0.0, climb]
    }

    /// What the phases go: as they are laid, the first three from the start, the last three back from the goal.
    fn member_of(&self, phases: Phases, cruise: f64) -> Member {
        let Ends { start, goal, .. } = self.ends;
        let [rise, hold, fall, _, last_fall, last_hold, climb] = phases;
        let mut up = start;
        let mut way = up.advance(SIGNS[0], rise);
        if hold > 0.0 {
            up.acceleration = self.up;
            way += up.advance(0.0, hold);
        }
        let peak = up.acceleration;
        let crest = up.velocity + 0.5 * peak * peak;
        way += up.advance(SIGNS[2], fall);
        // Backwards a rise is one too, of an acceleration with the other sign.
        let mut down = goal.reversed();
        let mut back = down.advance(SIGNS[0], climb);
        if last_hold > 0.0 {
            down.acceleration = self.down;
            back += down.advance(0.0, last_hold);
        }
        let valley = down.acceleration;
        back += down.advance(SIGNS[2], last_fall);
        let pace = if cruise > 0.0 { self.top } else { crest + 0.5 * peak * valley };
        Member { phases, way: way + back + self.top * cruise, pace }
    }
}
