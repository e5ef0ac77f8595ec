//! Motions of a given duration that are steady in between: as fast as can be to a velocity, on at it for the time that is left, and
//! as fast as can be from it.

use super::ends::Ends;
use super::upper::{Feet, Flank, Summit, Upper};
use crate::float::{largest, least};
use crate::roots::sign_change;

/// Of the speeds of a motion \[1\]: what its steady velocity is rounded to.
const VELOCITY_ROUNDED: f64 = 16.0 * f64::EPSILON;

/// Newton's steps to a steady velocity: it takes about six; the rest is for numbers that are none.
const MOST_STEPS: usize = 64;

/// To a velocity, on at it, and from it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Steady {
    pub(super) first: Side,
    pub(super) last: Side,
    pub(super) velocity: f64,
    pub(super) time: f64,
}

/// A flank and the side on which it is: 1 where the steady velocity is above what the end comes to by itself, −1 below it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Side {
    pub(super) sign: f64,
    pub(super) flank: Flank,
}

impl Steady {
    pub(super) fn way(&self) -> f64 {
        self.flanks_way() + self.velocity * self.time
    }

    fn flanks_way(&self) -> f64 {
        self.first.sign * self.first.flank.way + self.last.sign * self.last.flank.way
    }

    /// How the way grows with the steady velocity: by the time that is left for it, and by half of each flank's last fall, over which
    /// the velocity is raised more and more.
    fn slope(&self) -> f64 {
        self.time + 0.5 * (self.first.flank.peak + self.last.flank.peak)
    }

    /// Seen from the other side.
    pub(super) fn mirrored(self) -> Self {
        let side = |Side { sign, flank }: Side| Side { sign: -sign, flank };
        Self { first: side(self.first), last: side(self.last), velocity: -self.velocity, ..self }
    }

    /// The steady velocity anew, from the way that is left for it: of velocities that lie close the difference has few digits.
    fn settled(self, way: f64) -> Self {
        let rounding = VELOCITY_ROUNDED * self.fastest();
        let exact = (way - self.flanks_way()) / self.time;
        // Also false for NaN.
        let near = (exact - self.velocity).abs() <= rounding;
        if near { Self { velocity: exact, ..self } } else { self }
    }

    /// Of the velocities between which the flanks lead, about the greatest.
    fn fastest(&self) -> f64 {
        let change = |Side { flank: Flank { rise, hold, peak, .. }, .. }: &Side| {
            rise * rise + peak * (rise.abs() + hold + peak)
        };
        self.velocity.abs() + change(&self.first) + change(&self.last)
    }
}

impl Upper {
    /// Both flanks up to a velocity `above` the lowest at which they meet, and on at it until `time` is over.
    fn steady_at(&self, above: f64, time: f64) -> Steady {
        let Summit { first, last } = self.summit_at(above);
        let side = |flank: Flank| Side { sign: 1.0, flank };
        let left = time - (first.time() + last.time());
        Steady { first: side(first), last: side(last), velocity: self.feet().lowest + above, time: left }
    }

    /// Steady at the velocity that the faster end comes to by itself; none where that takes longer.
    pub(super) fn steady_at_foot(&self, time: f64) -> Option<Steady> {
        let steady = self.steady_at(0.0, time);
        (steady.time >= 0.0).then_some(steady)
    }

    /// Steady at a velocity from that of `foot` up to the limit, over the way; none where it leads beyond what can be gone in this time.
    ///
    /// The way is a concave function of the velocity, so Newton's iterates rise.
    pub(super) fn steady_above(&self, foot: Steady, time: f64) -> Option<Steady> {
        let room = self.room();
        let mut steady = foot;
        let mut above = 0.0;
        for _ in 0..MOST_STEPS {
            let next = above + (self.way - steady.way()) / steady.slope();
            // Also false for NaN, so that the loop ends whatever was given.
            let rises = next > above;
            if !rises {
                return Some(steady.settled(self.way));
            }
            if next > room {
                return None;
            }
            above = next;
            steady = self.steady_at(above, time);
            if steady.time < 0.0 {
                return None;
            }
        }
        Some(steady.settled(self.way))
    }

    /// Steady at a velocity between those that the two ends come to by themselves, over the way; none where all that lead there
    /// take longer.
    pub(super) fn steady_between(&self, time: f64) -> Option<Steady> {
        let Ends { start, goal, .. } = self.ends;
        let Feet { first, last, lowest } = self.feet();
        let Self { up, down, .. } = *self;
        let gap = largest(first, last);
        let below = |above: f64| largest(0.0, gap - above);
        let at = |above: f64| {
            // The slower end rises to it, the faster one falls.
            let (first, last) = if first > 0.0 {
                let flank = Flank::of(goal.reversed().mirrored(), below(above), up);
                (Side { sign: 1.0, flank: Flank::of(start, above, up) }, Side { sign: -1.0, flank })
            } else {
                let flank = Flank::of(start.mirrored(), below(above), down);
                (
                    Side { sign: -1.0, flank },
                    Side { sign: 1.0, flank: Flank::of(goal.reversed(), above, down) },
                )
            };
            let left = time - (first.flank.time() + last.flank.time());
            Steady { first, last, velocity: lowest - below(above), time: left }
        };
        let value_and_slope = |above: f64| {
            let steady = at(above);
            (steady.way() - self.way, steady.slope())
        };
        // Where both ends come to the same velocity there is nothing to choose.
        let above = if gap > 0.0 { sign_change(0.0, gap, value_and_slope)? } else { 0.0 };
        let steady = at(least(gap, above));
        (steady.time >= 0.0).then(|| steady.settled(self.way))
    }
}
