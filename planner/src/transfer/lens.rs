use arrayvec::ArrayVec;

use super::ends::{Ends, Phases};
use super::upper::Upper;
use crate::float::{largest, least, sqrt};
use crate::roots::{quadratic, sign_change};

/// What the motions whose acceleration never comes to zero say about a way.
#[derive(Clone, Copy, Debug)]
pub(super) enum Lens {
    /// One of them goes it.
    Found(Phases),
    /// None of them goes it, and the family goes on from the last of them.
    Open,
    /// None of them goes it, and the next in the family takes longer at once.
    Closed,
}

/// A member of the family before its acceleration comes to zero.
struct Member {
    rise: f64,
    hold: f64,
    fall: f64,
    way: f64,
    /// Of the way over the last rise.
    slope: f64,
}

impl Upper {
    /// The first member that goes the way among those whose acceleration stays positive; the fastest change of velocity has
    /// a peak and ends at a positive acceleration.
    ///
    /// Over the last rise `s`, from zero, the valley is at `c = a₁ − s` and the peak at `√(W + c²)`, `W = Δv − ā·δ`, or at the limit. It ends
    /// where the valley comes to zero, or, before, where the peak comes down to `a₀`.
    pub(super) fn lens(&self) -> Lens {
        let Ends { start, goal, .. } = self.ends;
        let excess = largest(0.0, self.ends.peak_excess());
        let below = start.acceleration * start.acceleration - excess;
        let closes = start.acceleration > 0.0 && below > 0.0;
        let end = if closes { largest(0.0, goal.acceleration - sqrt(below)) } else { goal.acceleration };
        let (mut from, mut to) = (0.0, end);
        let slowest = self.member(end, excess);
        let slack = self.slack + self.ends.way_rounding(slowest.rise + slowest.hold + slowest.fall + end);
        let mut found = slowest.way >= self.way - slack;
        if let Some(farthest) = self.farthest(excess, end) {
            if self.member(farthest, excess).way >= self.way {
                (to, found) = (farthest, true);
            } else {
                from = farthest;
            }
        }
        if !found {
            return if closes { Lens::Closed } else { Lens::Open };
        }
        let value_and_slope = |rise: f64| {
            let Member { way, slope, .. } = self.member(rise, excess);
            (way - self.way, slope)
        };
        // Nothing changes its sign where the way is reached at an end but for a rounding.
        let last = sign_change(from, to, value_and_slope).unwrap_or_else(|| {
            let off = |rise: f64| (self.member(rise, excess).way - self.way).abs();
            if off(from) < off(to) { from } else { to }
        });
        let Member { rise, hold, fall, .. } = self.member(last, excess);
        Lens::Found([rise, hold, fall, 0.0, 0.0, 0.0, last])
    }

    /// How long the last member lasts whose acceleration keeps its sign, where no change of velocity takes a little longer.
    pub(super) fn lens_closes(&self) -> Option<f64> {
        let family = if self.ends.change_has_peak() { *self } else { self.reversed() };
        let Ends { start, goal, .. } = family.ends;
        let excess = largest(0.0, family.ends.peak_excess());
        let below = start.acceleration * start.acceleration - excess;
        (start.acceleration > 0.0 && goal.acceleration > 0.0 && below > 0.0).then(|| {
            let last = largest(0.0, goal.acceleration - sqrt(below));
            let Member { rise, hold, fall, .. } = family.member(last, excess);
            rise + hold + fall + last
        })
    }

    /// Where the way of a member whose acceleration keeps its sign may turn from growing to shrinking or back, as durations: roots of
    /// the [`Self::pace`], while the limit is held and while it is not.
    pub(super) fn lens_turns(&self) -> ArrayVec<f64, 4> {
        let family = if self.ends.change_has_peak() { *self } else { self.reversed() };
        let goal = family.ends.goal;
        let excess = largest(0.0, family.ends.peak_excess());
        let vertex = goal.velocity - 0.5 * goal.acceleration * goal.acceleration;
        let held = quadratic(1.0, -0.5 * family.up, vertex);
        let squares = quadratic(0.75, 2.0 * vertex - 0.25 * excess, vertex * vertex);
        let free = squares.into_iter().filter(|square| *square >= 0.0).map(sqrt);
        let valleys =
            held.into_iter().chain(free).filter(|valley| (0.0..=goal.acceleration).contains(valley));
        let duration = |valley: f64| {
            let last = goal.acceleration - valley;
            let Member { rise, hold, fall, .. } = family.member(last, excess);
            rise + hold + fall + last
        };
        valleys.map(duration).collect()
    }

    /// The member whose last rise lasts so long.
    fn member(&self, last: f64, excess: f64) -> Member {
        let Ends { start, goal, .. } = self.ends;
        let valley = goal.acceleration - last;
        let free_peak = sqrt(valley * valley + excess);
        let peak = least(free_peak, self.up);
        let (rise, hold, fall);
        if free_peak > self.up {
            let gap = self.up - goal.acceleration;
            (rise, fall) = (self.up - start.acceleration, gap + last);
            let time = (self.ends.change.velocity + 0.5 * (rise * rise - gap * gap) + fall * fall) / self.up;
            hold = largest(0.0, time - rise - fall - last);
        } else {
            fall = if free_peak > 0.0 { excess / (valley + free_peak) } else { 0.0 };
            rise = largest(0.0, fall - last + self.ends.change.acceleration);
            hold = 0.0;
        }
        let mut state = start;
        let mut way = state.advance(1.0, rise);
        if hold > 0.0 {
            state.acceleration = self.up;
            way += state.advance(0.0, hold);
        }
        way += state.advance(-1.0, fall) + state.advance(1.0, last);
        let ratio = if peak > 0.0 { valley / peak } else { 0.0 };
        Member { rise, hold, fall, way, slope: self.pace(valley, peak) * 2.0 * (1.0 - ratio) }
    }

    /// How the way grows with the duration.
    fn pace(&self, valley: f64, peak: f64) -> f64 {
        let goal = self.ends.goal;
        goal.velocity - 0.5 * goal.acceleration * goal.acceleration + valley * (valley - 0.5 * peak)
    }

    /// The last rise, before `end`, of the member that goes farthest before the way shrinks again: where the [`Self::pace`] falls
    /// through zero. Only a motion that goes backwards at first has one.
    fn farthest(&self, excess: f64, end: f64) -> Option<f64> {
        let Ends { start, goal, .. } = self.ends;
        let pace_of = |valley: f64| self.pace(valley, least(self.up, sqrt(valley * valley + excess)));
        let slowest = if start.acceleration < 0.0 { start.coasting() } else { start.velocity };
        if slowest >= 0.0 || pace_of(goal.acceleration) <= 0.0 {
            return None;
        }
        let vertex = goal.velocity - 0.5 * goal.acceleration * goal.acceleration;
        // c² − A·c/2 + vertex = 0, while the limit is held.
        let root = sqrt(largest(0.0, self.up * self.up / 16.0 - vertex));
        let held = 0.25 * self.up + root;
        let is_held = held * held + excess > self.up * self.up;
        let valley = if is_held && vertex * 16.0 <= self.up * self.up {
            held
        } else {
            // (c² + vertex)² = c²·(c² + W)/4, of which c² + vertex ≥ 0.
            let b = 2.0 * vertex - 0.25 * excess;
            let discriminant = b * b - 3.0 * vertex * vertex;
            if discriminant < 0.0 {
                return None;
            }
            sqrt(largest(0.0, (sqrt(discriminant) - b) / 1.5))
        };
        let last = goal.acceleration - valley;
        (last > 0.0 && last < end).then_some(last)
    }
}
