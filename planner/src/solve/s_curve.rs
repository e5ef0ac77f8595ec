//! The S-curve between two speeds, in the direction of travel: Bui, Le and Doan (2021), as restored and collapsed in
//! `notes/0003-eight-types.md`.
//!
//! With `S(v) = D(start, v) + D(v, end)` the length of two ramps that meet at the speed `v`, `S` grows with `v` from
//! `D(start, end)` at the larger of both speeds. So the whole case analysis is: compare the length with `S(cruise)`; if
//! there is more, cruise; else solve `S(peak) = length`; and read the type off the two ramps.

use super::ramp::{self, Ramp};
use crate::classify::EightType;
use crate::float::{largest, least, sqrt};
use crate::roots::fall_to_root;

/// Slack on `length ≥ D(start, end)`, relative to the latter \[1\]: its roundings are worth about four ε, and the rest is
/// for callers who computed the length from the same formula in another order.
const LENGTH_SLACK: f64 = 8.0 * f64::EPSILON;

/// A move in the direction of travel: every number a magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Lane {
    /// Speed at the start and at the end, neither above `cruise` [axis units/s].
    pub(super) start: f64,
    pub(super) end: f64,
    /// Way to go [axis units], ≥ 0.
    pub(super) length: f64,
    pub(super) cruise: f64,
    pub(super) acceleration: f64,
    pub(super) jerk: f64,
}

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
}

impl Lane {
    /// The least length that changes from the start to the end speed [axis units].
    pub(super) fn least_length(&self) -> f64 {
        self.ramp_length(self.start, self.end)
    }

    pub(super) fn is_too_short(&self) -> bool {
        self.length < self.least_length() * (1.0 - LENGTH_SLACK)
    }

    pub(super) fn ramp_length(&self, from: f64, to: f64) -> f64 {
        ramp::length(from, to, self.acceleration, self.jerk)
    }

    pub(super) fn reaches(&self, change: f64) -> bool {
        ramp::reaches(change, self.acceleration, self.jerk)
    }

    /// The fastest way, for a lane that is not too short.
    ///
    /// The unknown is `u`, the peak above the faster end, or its root `q`: never a difference of absolute speeds, which
    /// loses the digits that a short path needs.
    pub(super) fn solve(&self) -> Shape {
        let room = Rise::to(self.cruise - largest(self.start, self.end));
        let ramps = self.ramps(room);
        let spare = self.length - self.length_of(room.change, &ramps);
        if spare > 0.0 {
            return self.shape(room, ramps, spare / self.cruise);
        }
        let rise = self.rise(room.change);
        let rise = if rise.change > room.change { room } else { rise };
        self.shape(rise, self.ramps(rise), 0.0)
    }

    /// The ramps on both sides of a peak that is `rise` above the faster end.
    fn ramps(&self, rise: Rise) -> Ramps {
        let gap = (self.end - self.start).abs();
        let near = if self.reaches(rise.change) {
            Ramp::ladder(rise.change, self.acceleration, self.jerk)
        } else {
            Ramp::triangle(rise.root, sqrt(self.jerk))
        };
        // Equal ends have equal ramps; from rest to rest that is half of the roots.
        let far = if gap == 0.0 { near } else { Ramp::over(rise.change + gap, self.acceleration, self.jerk) };
        Ramps { near, far }
    }

    /// `S` at the speed `rise` above the faster end, which has these `ramps`.
    fn length_of(&self, rise: f64, ramps: &Ramps) -> f64 {
        let (faster, sum, _) = self.ends();
        0.5 * ((2.0 * faster + rise) * ramps.near.time() + (sum + rise) * ramps.far.time())
    }

    /// `S` at the speed `rise` above the faster end.
    fn two_ramps(&self, rise: f64) -> f64 {
        self.length_of(rise, &self.ramps(Rise::to(rise)))
    }

    /// How far the peak rises above the faster end where there is no cruise: the root of `S = length`, which is at most
    /// `room`, so that only the shapes that fit into that need to be asked about.
    fn rise(&self, room: f64) -> Rise {
        let Self { acceleration, jerk, .. } = *self;
        let gap = (self.end - self.start).abs();
        let corner = acceleration * acceleration / jerk;
        if corner <= room && self.length >= self.two_ramps(corner) {
            return self.rise_both_reach();
        }
        // Where the gap itself reaches the limit, the far ramp always does.
        let bend = corner - gap;
        if self.reaches(gap) || (bend <= room && self.length >= self.two_ramps(bend)) {
            return self.rise_far_reaches();
        }
        self.rise_none_reaches()
    }

    /// Both ramps are ladders: `u²/a + b·u = r`, type 5.
    fn rise_both_reach(&self) -> Rise {
        let Self { acceleration, jerk, .. } = *self;
        let (faster, sum, gap) = self.ends();
        let jerk_time = acceleration / jerk;
        let rest =
            self.length - (faster * jerk_time + 0.5 * sum * gap / acceleration + 0.5 * sum * jerk_time);
        let b = 2.0 * faster / acceleration + jerk_time;
        let change = 2.0 * rest / (b + sqrt(b * b + 4.0 * rest / acceleration));
        Rise { change, root: sqrt(change) }
    }

    /// The ramp on the faster side is a triangle, the other a ladder: a quartic in `q = √u`, types 6 and 7.
    fn rise_far_reaches(&self) -> Rise {
        let Self { acceleration, jerk, .. } = *self;
        let (faster, sum, gap) = self.ends();
        let root_of_jerk = sqrt(jerk);
        let jerk_time = acceleration / jerk;
        let flat = gap / acceleration + jerk_time;
        let rest = largest(0.0, self.length - 0.5 * sum * flat);
        let linear = 0.5 * ((gap + sum) / acceleration + jerk_time);
        let bound = least(
            least(libm::cbrt(rest * root_of_jerk), sqrt(rest / linear)),
            least(sqrt(sqrt(2.0 * acceleration * rest)), rest * root_of_jerk / (2.0 * faster)),
        );
        let root = fall_to_root(bound, |q| {
            let u = q * q;
            let value = (2.0 * faster + u) * q / root_of_jerk + u * (0.5 * u / acceleration + linear) - rest;
            let slope = (2.0 * faster + 3.0 * u) / root_of_jerk + q * (2.0 * u / acceleration + 2.0 * linear);
            (value, slope)
        });
        Rise { change: root * root, root }
    }

    /// Both ramps are triangles: type 8A.
    fn rise_none_reaches(&self) -> Rise {
        let (faster, sum, gap) = self.ends();
        let root_of_gap = sqrt(gap);
        let rest = largest(0.0, self.length * sqrt(self.jerk) - sum * root_of_gap);
        let bound = least(libm::cbrt(0.5 * rest), rest / (2.0 * faster));
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

    /// The faster of both speeds, their sum and their distance.
    fn ends(&self) -> (f64, f64, f64) {
        (largest(self.start, self.end), self.start + self.end, (self.end - self.start).abs())
    }

    fn shape(&self, rise: Rise, ramps: Ramps, cruise: f64) -> Shape {
        let (faster, _, gap) = self.ends();
        let Ramps { near, far } = ramps;
        let (near_reaches, far_reaches) = (self.reaches(rise.change), self.reaches(rise.change + gap));
        let near_is_up = self.start > self.end;
        let (up, down) = if near_is_up { (near, far) } else { (far, near) };
        let (up_reaches, down_reaches) =
            if near_is_up { (near_reaches, far_reaches) } else { (far_reaches, near_reaches) };
        Shape {
            up,
            cruise,
            down,
            peak: faster + rise.change,
            end: self.end,
            kind: EightType::of(cruise > 0.0, up_reaches, down_reaches),
        }
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
struct Rise {
    change: f64,
    root: f64,
}

impl Rise {
    fn to(change: f64) -> Self {
        Self { change, root: sqrt(change) }
    }
}
