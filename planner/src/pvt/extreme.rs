//! The two motions that bound what a command can reach: one that gets as far as can be, and one that stays back as far as
//! can be: P1 and P5 in the paper. The equations are derived in `notes/0008-position-velocity-time.md`.

use super::lane::Lane;
use crate::float::{largest, least, sqrt};
use crate::roots::{sign_change, sign_change_within};
use crate::solve::ramp::{Ramp, reaches};

/// A ramp to the turn, a cruise there, a ramp to the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extreme {
    /// The velocity of the cruise [axis units/s].
    pub(super) turn: f64,
    /// How far that is from the nearer end [axis units/s], with digits of its own.
    pub(super) change: f64,
    /// How long the parts last \[s\]; together the duration of the command.
    pub(super) first: f64,
    pub(super) cruise: f64,
    pub(super) last: f64,
    /// How far it leads [axis units], signed.
    pub(super) displacement: f64,
}

impl Extreme {
    pub(super) fn mirrored(self) -> Self {
        Self { turn: -self.turn, displacement: -self.displacement, ..self }
    }

    /// By how much a velocity of the cruise, above or below both ends, changes the displacement \[s\].
    pub(super) fn weight(&self) -> f64 {
        0.5 * (self.first + self.last) + self.cruise
    }
}

/// Both ends of what a command can reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extremes {
    pub(super) greatest: Extreme,
    pub(super) least: Extreme,
}

impl Extremes {
    /// Of all motions of `duration` \[s\] from one velocity to another. The duration is the least time of that change or
    /// longer.
    pub(super) fn of(lane: &Lane, start: f64, end: f64, duration: f64) -> Self {
        let greatest = farthest(lane, start, end, duration);
        let least = farthest(&lane.mirrored(), -start, -end, duration).mirrored();
        Self { greatest, least }
    }

    /// The fastest that any of them gets [axis units/s], a magnitude.
    pub(super) fn fastest(&self) -> f64 {
        largest(self.greatest.turn.abs(), self.least.turn.abs())
    }
}

/// The motion of `duration` that leads farthest: up to a turn above both ends, and down.
pub(super) fn farthest(lane: &Lane, start: f64, end: f64, duration: f64) -> Extreme {
    let peak = Peak::of(lane, start, end);
    let Turn { change, near, far } = peak.turn(duration);
    let (first, last) = if peak.near_is_last { (far, near) } else { (near, far) };
    let turn = peak.faster + change;
    let cruise = largest(0.0, duration - (first + last));
    let displacement = 0.5 * ((start + turn) * first + (turn + end) * last) + turn * cruise;
    Extreme { turn, change, first, cruise, last, displacement }
}

/// The rate at which the greatest displacement grows with the end velocity \[s\], at its extreme.
///
/// With `t₁`, `t₂` the times of both ramps and `g₁`, `g₂` their rates `dv/dt` (√(J·d) of a triangle, A of a ladder):
///
/// ```text
/// with a cruise      t₂/2 + (turn − end)/2g₂
/// without            (g₁·t₁ + (2·g₁ + g₂)·t₂ + start − end) / 2(g₁ + g₂)   … see the note
/// ```
fn growth(lane: &Lane, start: f64, end: f64, extreme: &Extreme) -> f64 {
    let Extreme { turn, first, cruise, last, .. } = *extreme;
    let rate = |change: f64, limit: f64| {
        if reaches(change, limit, lane.jerk) { limit } else { sqrt(lane.jerk * change) }
    };
    let (up, down) = (rate(turn - start, lane.rise), rate(turn - end, lane.fall));
    if cruise > 0.0 || turn >= lane.greatest {
        // A ramp without change has the rate zero.
        let ratio = if down > 0.0 { (turn - end) / down } else { 0.0 };
        return 0.5 * (last + ratio);
    }
    let both = up + down;
    if both > 0.0 { 0.5 * (up * (first + last) + both * last + (start - end)) / both } else { 0.5 * last }
}

/// The end velocity in `from ..= lane.greatest` nearest to `from` whose greatest displacement in `duration` is
/// `displacement`, which `from`, with the extreme `at_from`, falls short of; the greatest that can be reached at all where none is.
pub(super) fn end_velocity_for(
    lane: &Lane,
    start: f64,
    (from, at_from): (f64, &Extreme),
    duration: f64,
    displacement: f64,
) -> f64 {
    let top = lane.nearest(start, lane.greatest, duration);
    let room = largest(0.0, top - from);
    let value_and_slope = |more: f64| {
        let extreme = farthest(lane, start, from + more, duration);
        (extreme.displacement - displacement, growth(lane, start, from + more, &extreme))
    };
    // The displacement grows all the way, more and more slowly, so Newton's step falls short. Twice that is a bracket near the
    // root, which is closed in on relative to its upper end; where the whole room is short too, nothing reaches.
    let (value, slope) = (at_from.displacement - displacement, growth(lane, start, from, at_from));
    let step = 2.0 * -value / slope;
    let mut to = if step > 0.0 && step < room { step } else { room };
    let mut at_to = farthest(lane, start, from + to, duration).displacement - displacement;
    while to < room && at_to < 0.0 {
        to = least(room, 2.0 * to);
        at_to = farthest(lane, start, from + to, duration).displacement - displacement;
    }
    let more = sign_change_within((0.0, to), (value, at_to), value_and_slope).unwrap_or(to);
    // The sum may be a rounding beyond what the lane holds, or there is time for.
    largest(from, least(from + more, top))
}

/// The least time from `duration` on in which the greatest displacement is `displacement`, of which it falls short at
/// `duration`; none where it never gets there, though it may be short of it by `slack` [axis units].
///
/// As time grows the greatest displacement may shrink at first, while all velocities are negative, and then grows. So it
/// comes up to any value once. Below the limit of velocity it is the length of two ramps, a function of the turn.
pub(super) fn duration_for(
    lane: &Lane,
    start: f64,
    end: f64,
    duration: f64,
    displacement: f64,
    slack: f64,
) -> Option<f64> {
    let peak = Peak::of(lane, start, end);
    let now = peak.turn(duration);
    let full = peak.ramps(peak.room);
    let missing = displacement - peak.length(&full);
    if now.change >= peak.room || missing >= 0.0 {
        let reached = farthest(lane, start, end, largest(duration, full.near + full.far));
        let missing = largest(0.0, displacement - reached.displacement);
        let time = reached.first + reached.cruise + reached.last;
        if missing <= slack {
            return Some(time);
        }
        return (lane.greatest > 0.0).then(|| time + missing / lane.greatest);
    }
    let value_and_slope = |root: f64| peak.length_and_slope(root, displacement);
    let (from, room) = (sqrt(now.change), sqrt(peak.room));
    // A bracket near the root, since it is closed in on relative to its upper end.
    let steep = least(lane.jerk * duration, least(lane.rise, lane.fall));
    let mut to = least(room, largest(2.0 * from, sqrt(steep * duration)));
    while to < room && value_and_slope(to).0 < 0.0 {
        to = least(room, 2.0 * to);
    }
    let root = sign_change(from, to, value_and_slope).unwrap_or(to);
    let ramps = peak.ramps(root * root);
    Some(ramps.near + ramps.far)
}

/// The search for the turn above two velocities. *Near* is the side of the faster end, *far* that of the slower one: over the
/// change `x` from the faster end to the turn, the near ramp changes the velocity by `x` and the far one by `x + gap`.
struct Peak {
    faster: f64,
    slower: f64,
    gap: f64,
    /// From the faster end to the limit of velocity.
    room: f64,
    near: f64,
    far: f64,
    near_is_last: bool,
    jerk: f64,
    root_of_jerk: f64,
}

/// How far the turn is from the faster end [axis units/s], and the times of both ramps \[s\].
#[derive(Clone, Copy)]
struct Turn {
    change: f64,
    near: f64,
    far: f64,
}

impl Peak {
    fn of(lane: &Lane, start: f64, end: f64) -> Self {
        let near_is_last = end >= start;
        let (near, far) = if near_is_last { (lane.fall, lane.rise) } else { (lane.rise, lane.fall) };
        let (slower, faster) = if near_is_last { (start, end) } else { (end, start) };
        Self {
            faster,
            slower,
            gap: faster - slower,
            room: largest(0.0, lane.greatest - faster),
            near,
            far,
            near_is_last,
            jerk: lane.jerk,
            root_of_jerk: lane.root_of_jerk,
        }
    }

    /// The highest turn for which there is time, or that the limit of velocity allows: the root of `t(x) + t(x + gap) = T`.
    ///
    /// ```text
    /// both ramps triangles    √x + √(x + gap) = T·√J/2       √x = (τ² − gap)/2τ,  τ = T·√J/2
    /// far ladder              x + 2b·√x = c                  b = F/√J,  c = F·(T − F/J) − gap
    /// near ladder             y + 2b·√y = c,  y = x + gap    b = N/√J,  c = N·(T − N/J) + gap
    /// both ladders            x·(1/N + 1/F) = T − N/J − F/J − gap/F
    /// ```
    /// The sum of the times grows with `x`, so the first of these whose root keeps to its own shape is the one.
    fn turn(&self, duration: f64) -> Turn {
        let Self { gap, near: near_limit, far: far_limit, jerk, root_of_jerk, .. } = *self;
        let tau = 0.5 * duration * root_of_jerk;
        let root = 0.5 * largest(0.0, tau * tau - gap) / tau;
        let change = root * root;
        if !reaches(change + gap, far_limit, jerk) && !reaches(change, near_limit, jerk) {
            return self.within(duration, change, 2.0 * root / root_of_jerk);
        }
        let far_first = far_limit * far_limit - gap * jerk <= near_limit * near_limit;
        if far_first {
            let (b, c) = (far_limit / root_of_jerk, far_limit * (duration - far_limit / jerk) - gap);
            let c = largest(0.0, c);
            let root = c / (b + sqrt(b * b + c));
            if !reaches(root * root, near_limit, jerk) {
                return self.within(duration, root * root, 2.0 * root / root_of_jerk);
            }
        } else {
            let (b, c) = (near_limit / root_of_jerk, near_limit * (duration - near_limit / jerk) + gap);
            let root = c / (b + sqrt(b * b + c));
            if !reaches(root * root, far_limit, jerk) {
                let change = largest(0.0, root * root - gap);
                return self.within(duration, change, duration - 2.0 * root / root_of_jerk);
            }
        }
        let spare = duration - (far_limit + near_limit) / jerk - gap / far_limit;
        let change = largest(0.0, spare) * (far_limit * near_limit / (far_limit + near_limit));
        self.within(duration, change, change / near_limit + near_limit / jerk)
    }

    /// The turn at `change`, whose near ramp takes the time `near`, or at the limit of velocity.
    fn within(&self, duration: f64, change: f64, near: f64) -> Turn {
        if change > self.room { self.ramps(self.room) } else { Turn { change, near, far: duration - near } }
    }

    fn ramps(&self, change: f64) -> Turn {
        let near = Ramp::over(change, self.near, self.jerk).time();
        let far = Ramp::over(change + self.gap, self.far, self.jerk).time();
        Turn { change, near, far }
    }

    /// How far both ramps lead.
    fn length(&self, ramps: &Turn) -> f64 {
        let turn = self.faster + ramps.change;
        0.5 * ((self.faster + turn) * ramps.near + (self.slower + turn) * ramps.far)
    }

    /// What the ramps to the turn `root²` above the faster end lack of `displacement`, with its derivative by `root`.
    fn length_and_slope(&self, root: f64, displacement: f64) -> (f64, f64) {
        let ramps = self.ramps(root * root);
        let turn = self.faster + ramps.change;
        // dt/d(root) of a ramp: 2·root/rate, which for a triangle over `root²` is 2/√J.
        let slope = |change: f64, limit: f64| {
            if reaches(change, limit, self.jerk) {
                2.0 * root / limit
            } else if change > 0.0 {
                2.0 * (root / sqrt(change)) / self.root_of_jerk
            } else {
                2.0 / self.root_of_jerk
            }
        };
        let near = slope(ramps.change, self.near);
        let far = slope(ramps.change + self.gap, self.far);
        let rate = root * (ramps.near + ramps.far)
            + 0.5 * ((self.faster + turn) * near + (self.slower + turn) * far);
        (self.length(&ramps) - displacement, rate)
    }
}
