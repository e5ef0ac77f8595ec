//! The S-curve between two speeds, in the direction of travel: Bui, Le and Doan (2021), as restored and collapsed in
//! `notes/0003-eight-types.md`; with a deceleration of its own as in Li and Chen, `notes/0005-asymmetric.md`.
//!
//! With `S(v) = D(start, v) + D(v, end)` the length of two ramps that meet at the speed `v`, `S` grows with `v` from
//! `D(start, end)` at the larger of both speeds. So the whole case analysis is: compare the length with `S(cruise)`; if
//! there is more, cruise; else solve `S(peak) = length`; and read the type off the two ramps.

use super::lane::{Lane, Sides};
use super::ramp::{self, Ramp};
use super::rest;
use crate::classify::EightType;
use crate::float::{cbrt, largest, least, sqrt};
use crate::roots::fall_to_root;

/// What a lane is solved to: a ramp to the peak, a cruise \[s\], a ramp to the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    pub(super) up: Ramp,
    pub(super) cruise: f64,
    pub(super) down: Ramp,
    /// The greatest speed [axis units/s].
    pub(super) peak: f64,
    pub(super) end: f64,
    pub(super) kind: EightType,
    /// Is the path long enough for the cruise speed, though it be for an instant?
    pub(super) reaches_cruise: bool,
}

impl Shape {
    /// One ramp, up or down.
    pub(super) fn one_ramp(kind: EightType, up: Ramp, down: Ramp, peak: f64, end: f64) -> Self {
        Self { up, cruise: 0.0, down, peak, end, kind, reaches_cruise: false }
    }
}

impl Lane {
    /// The least length that changes from the start to the end speed [axis units].
    pub(super) fn least_length(&self) -> f64 {
        self.ramp_length(self.start, self.end)
    }

    pub(super) fn is_too_short(&self) -> bool {
        // Equal speeds need no length, and no roots to know it.
        self.sides().gap > 0.0 && self.is_shorter_than(self.least_length())
    }

    pub(super) fn ramp_length(&self, from: f64, to: f64) -> f64 {
        ramp::length(from, to, self.limit(from, to), self.jerk)
    }

    /// The fastest way, for a lane that is not too short.
    ///
    /// The unknown is `u`, the peak above the faster end, or a root of it: never a difference of absolute speeds, which
    /// loses the digits that a short path needs.
    pub(super) fn solve(&self) -> Shape {
        let peak = Peak { length: self.length, jerk: self.jerk, sides: self.sides() };
        let room = Rise::to(self.cruise - peak.sides.faster);
        let ramps = peak.ramps(room);
        let spare = self.length - peak.length_of(room.change, &ramps);
        if spare > 0.0 {
            return self.shape(&peak, room, ramps, spare);
        }
        let rise = peak.rise(room.change);
        let rise = if rise.change > room.change { room } else { rise };
        self.shape(&peak, rise, peak.ramps(rise), spare)
    }

    fn shape(&self, peak: &Peak, rise: Rise, ramps: Ramps, spare: f64) -> Shape {
        let Sides { faster, gap, near, far, .. } = peak.sides;
        let (up, down) = peak.sides.up_and_down(ramps.near, ramps.far);
        let (up_reaches, down_reaches) = peak.sides.up_and_down(
            ramp::reaches(rise.change, near, self.jerk),
            ramp::reaches(rise.change + gap, far, self.jerk),
        );
        let cruise = if spare > 0.0 { spare / self.cruise } else { 0.0 };
        Shape {
            up,
            cruise,
            down,
            peak: faster + rise.change,
            end: self.end,
            kind: EightType::of(spare > 0.0, up_reaches, down_reaches),
            reaches_cruise: spare >= 0.0,
        }
    }
}

/// The search for the peak of two ramps that have a length to cover.
struct Peak {
    length: f64,
    jerk: f64,
    sides: Sides,
}

impl Peak {
    /// The ramps on both sides of a peak that is `rise` above the faster end.
    fn ramps(&self, rise: Rise) -> Ramps {
        let Sides { gap, near: near_limit, far: far_limit, .. } = self.sides;
        let near = self.ramp(rise, near_limit);
        let far = if gap > 0.0 {
            Ramp::over(rise.change + gap, far_limit, self.jerk)
        } else if far_limit < near_limit {
            self.ramp(rise, far_limit)
        } else {
            // Equal ends with equal limits have equal ramps; from rest to rest that is half of the roots.
            near
        };
        Ramps { near, far }
    }

    fn ramp(&self, rise: Rise, limit: f64) -> Ramp {
        if ramp::reaches(rise.change, limit, self.jerk) {
            Ramp::ladder(rise.change, limit, self.jerk)
        } else {
            Ramp::triangle(rise.root, sqrt(self.jerk))
        }
    }

    /// `S` at the speed `rise` above the faster end, which has these `ramps`.
    fn length_of(&self, rise: f64, ramps: &Ramps) -> f64 {
        let Sides { faster, sum, .. } = self.sides;
        0.5 * ((2.0 * faster + rise) * ramps.near.time() + (sum + rise) * ramps.far.time())
    }

    /// `S` at the speed `rise` above the faster end.
    fn two_ramps(&self, rise: f64) -> f64 {
        self.length_of(rise, &self.ramps(Rise::to(rise)))
    }

    /// How far the peak rises above the faster end where there is no cruise: the root of `S = length`, which is at most
    /// `room`, so that only the shapes that fit into that need to be asked about.
    fn rise(&self, room: f64) -> Rise {
        let Sides { faster, gap, near, far, .. } = self.sides;
        if faster == 0.0 {
            return rest::rise(self.length, self.jerk, near, far);
        }
        // Where the near and the far ramp begin to reach their limits.
        let near_bend = near * near / self.jerk;
        let far_bend = if ramp::reaches(gap, far, self.jerk) { 0.0 } else { far * far / self.jerk - gap };
        // A ladder over less than its corner takes longer than the triangle that belongs there, so the rise as if both were
        // ladders is too small where they are not, and beyond both bends just where they are.
        let upper = largest(near_bend, far_bend);
        if upper <= room {
            let rise = self.rise_both_reach();
            if rise.change >= upper {
                return rise;
            }
        }
        let lower = least(near_bend, far_bend);
        if lower > 0.0 && !(lower <= room && self.length >= self.two_ramps(lower)) {
            return self.rise_none_reaches();
        }
        if far_bend <= near_bend { self.rise_far_reaches() } else { self.rise_near_reaches() }
    }

    /// Both ramps are ladders: `u²·(1/n + 1/f)/2 + b·u = r`, type 5.
    fn rise_both_reach(&self) -> Rise {
        let Sides { faster, sum, gap, near, far, .. } = self.sides;
        let (both, slopes) = (near + far, (near + far) / (near * far));
        let flat = faster * near + 0.5 * sum * far;
        let rest = largest(0.0, self.length - flat / self.jerk - 0.5 * sum * gap / far);
        let b = faster * slopes + 0.5 * both / self.jerk;
        let change = 2.0 * rest / (b + sqrt(b * b + 2.0 * rest * slopes));
        Rise { change, root: sqrt(change) }
    }

    /// The near ramp is a triangle, the far one a ladder: a quartic in `q = √u`, types 6 and 7.
    fn rise_far_reaches(&self) -> Rise {
        let Sides { faster, sum, gap, far, .. } = self.sides;
        let root_of_jerk = sqrt(self.jerk);
        let jerk_time = far / self.jerk;
        let flat = gap / far + jerk_time;
        // Times √j, so that no step divides but by the slope.
        let rest = largest(0.0, self.length - 0.5 * sum * flat) * root_of_jerk;
        let linear = 0.5 * ((gap + sum) / far + jerk_time) * root_of_jerk;
        let square = 0.5 * root_of_jerk / far;
        let bound = least(
            least(cbrt(rest), sqrt(rest / linear)),
            least(sqrt(sqrt(rest / square)), rest / (2.0 * faster)),
        );
        let root = fall_to_root(bound, |q| {
            let u = q * q;
            let value = (2.0 * faster + u) * q + u * (u * square + linear) - rest;
            let slope = 2.0 * faster + 3.0 * u + q * (4.0 * u * square + 2.0 * linear);
            (value, slope)
        });
        Rise { change: root * root, root }
    }

    /// The near ramp is a ladder, the far one still a triangle, though it is the longer: its limit is so much higher.
    ///
    /// The unknown is `k = √(u + gap) − √gap`, the root of the far ramp's change beyond what it has at `u = 0`: in it the
    /// length is increasing and convex, which it is not in `u`, and `u = k·(k + 2·√gap)` loses no digits where it is tiny.
    fn rise_near_reaches(&self) -> Rise {
        let Sides { faster, sum, gap, near, .. } = self.sides;
        let (root_of_jerk, root_of_gap) = (sqrt(self.jerk), sqrt(gap));
        let jerk_time = near / self.jerk;
        let linear = faster / near + 0.5 * jerk_time;
        let rest = largest(0.0, self.length - faster * jerk_time - sum * root_of_gap / root_of_jerk);
        let change = least(sqrt(2.0 * near * rest), rest / (linear + root_of_gap / root_of_jerk));
        let bound = least(change / (sqrt(change + gap) + root_of_gap), cbrt(rest * root_of_jerk));
        let root = fall_to_root(bound, |k| {
            let h = root_of_gap + k;
            let u = k * (h + root_of_gap);
            let value = u * (0.5 * u / near + linear) + (u * h + sum * k) / root_of_jerk - rest;
            let slope = 2.0 * h * (u / near + linear) + (2.0 * h * h + u + sum) / root_of_jerk;
            (value, slope)
        });
        Rise::to(root * (root + 2.0 * root_of_gap))
    }

    /// Both ramps are triangles, so that no limit matters: type 8A.
    fn rise_none_reaches(&self) -> Rise {
        let Sides { faster, sum, gap, .. } = self.sides;
        let root_of_gap = sqrt(gap);
        let rest = largest(0.0, self.length * sqrt(self.jerk) - sum * root_of_gap);
        let bound = least(cbrt(0.5 * rest), rest / (2.0 * faster));
        if bound == 0.0 {
            return Rise::default();
        }
        let root = fall_to_root(bound, |q| {
            let u = q * q;
            let far = sqrt(u + gap);
            let value = (2.0 * faster + u) * q + u * (far + sum / (far + root_of_gap)) - rest;
            let slope = 2.0 * faster + 3.0 * u + q * (2.0 * far + (u + sum) / far);
            (value, slope)
        });
        Rise { change: root * root, root }
    }
}

/// The ramps from the faster end to the peak, and from the slower end to it.
#[derive(Clone, Copy, Debug)]
struct Ramps {
    near: Ramp,
    far: Ramp,
}

/// How far the peak is above the faster end [axis units/s], and the root of that.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rise {
    pub(super) change: f64,
    pub(super) root: f64,
}

impl Rise {
    pub(super) fn to(change: f64) -> Self {
        Self { change, root: sqrt(change) }
    }
}
