use arrayvec::ArrayVec;

use super::bounds::{Bounds, BoundsSpec};
use super::course::{Course, SIGNS, Shape};
use super::steady::{Side, Steady};

/// The most strokes of a motion that is blended: those of a member of a family.
const MOST: usize = 7;

/// The most strokes of two of them side by side: each ends where one of theirs does, the last where both do.
const MOST_SIDE_BY_SIDE: usize = 2 * MOST - 1;

/// A stroke in the time unit that makes the jerk limit 1, of motions that are to be blended. A list of them has no stroke without time.
#[derive(Clone, Copy, Debug)]
struct Beat {
    jerk: f64,
    time: f64,
    /// Of the limits of acceleration, up and down: how much of each is held here.
    held: [f64; 2],
}

/// A motion that is known by its strokes, with the way that it goes.
#[derive(Clone, Debug)]
pub(super) struct Strand {
    beats: ArrayVec<Beat, MOST>,
    pub(super) way: f64,
}

impl Strand {
    /// A member of a family.
    pub(super) fn of_member(shape: &Shape, way: f64) -> Self {
        let mut strand = Self { beats: ArrayVec::new(), way };
        let Shape { sign, mut phases } = *shape;
        if phases[3] == 0.0 {
            phases[2] += phases[4];
            phases[4] = 0.0;
        }
        for (index, time) in phases.into_iter().enumerate() {
            let holds = [0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0][index] * sign;
            strand.add(SIGNS[index] * sign, time, holds);
        }
        strand
    }

    /// A steady motion.
    pub(super) fn of_steady(steady: &Steady) -> Self {
        let mut strand = Self { beats: ArrayVec::new(), way: steady.way() };
        let Steady { first, last, time, .. } = *steady;
        let Side { sign, flank } = first;
        strand.add(sign, flank.rise, 0.0);
        strand.add(0.0, flank.hold, sign);
        strand.add(-sign, flank.peak, 0.0);
        strand.add(0.0, time, 0.0);
        let Side { sign, flank } = last;
        strand.add(-sign, flank.peak, 0.0);
        strand.add(0.0, flank.hold, -sign);
        strand.add(sign, flank.rise, 0.0);
        strand
    }

    fn add(&mut self, jerk: f64, time: f64, holds: f64) {
        if time > 0.0 {
            let held = if holds > 0.0 { [holds, 0.0] } else { [0.0, holds.abs()] };
            self.beats.push(Beat { jerk, time, held });
        }
    }
}

impl Course {
    /// Goes on with `upper · part + lower · (1 − part)`, of which both take `time`: all motions of one duration between two ends
    /// are a convex set, so this is one of them.
    ///
    /// Its strokes are those in which neither of both changes its jerk. They are cut off from both ends towards the longest of
    /// them, to which the roundings of all times are left: a short stroke in a long motion keeps its digits.
    pub(super) fn blend(&mut self, strands: [&Strand; 2], part: f64, time: f64, bounds: &Bounds, unit: f64) {
        if strands.iter().any(|strand| strand.beats.is_empty()) {
            return;
        }
        let mut longest = (0.0, [0, 0]);
        for (at, time) in Walk::of(strands, false) {
            if time > longest.0 {
                longest = (time, at);
            }
        }
        let (_, [up, low]) = longest;
        let before = Walk::of(strands, false).take_while(|(at, _)| *at != [up, low]);
        let back = |index: usize, strand: &Strand| strand.beats.len() - 1 - index;
        let from_back = [back(up, strands[0]), back(low, strands[1])];
        let after: ArrayVec<_, MOST_SIDE_BY_SIDE> = Walk::of(strands, true)
            .take_while(|(at, _)| *at != from_back)
            .map(|([up, low], time)| ([back(up, strands[0]), back(low, strands[1])], time))
            .collect();
        let mut left = time;
        let put = |course: &mut Self, [up, low]: [usize; 2], time: f64| {
            let (upper, lower) = (&strands[0].beats[up], &strands[1].beats[low]);
            course.mix([upper, lower], part, time * unit, bounds);
        };
        for (at, time) in before {
            put(self, at, time);
            left -= time;
        }
        let tail = after.iter().fold(0.0, |sum, (_, time)| sum + time);
        put(self, [up, low], left - tail);
        self.anchor = self.strokes.len();
        for &(at, time) in after.iter().rev() {
            put(self, at, time);
        }
    }

    fn mix(&mut self, beats: [&Beat; 2], part: f64, time: f64, bounds: &Bounds) {
        let BoundsSpec { min_acceleration, max_acceleration, max_jerk, .. } = *bounds.spec();
        let [upper, lower] = beats;
        let mixed = |upper: f64, lower: f64| lower + part * (upper - lower);
        let held = |beat: &Beat| beat.held[0] * max_acceleration + beat.held[1] * min_acceleration;
        let jerk = mixed(upper.jerk, lower.jerk) * max_jerk;
        // Only where neither has a jerk the acceleration is known.
        let known = upper.jerk == 0.0 && lower.jerk == 0.0;
        self.add(jerk, time, known.then(|| mixed(held(upper), held(lower))), None);
    }

    /// Goes on with a steady motion.
    pub(super) fn steady(&mut self, steady: &Steady, bounds: &Bounds, unit: f64) {
        let BoundsSpec { min_acceleration, max_acceleration, max_jerk, .. } = *bounds.spec();
        let limit = |sign: f64| if sign < 0.0 { min_acceleration } else { max_acceleration };
        let Steady { first, last, velocity, time } = *steady;
        let Side { sign, flank } = first;
        self.add(sign * max_jerk, flank.rise * unit, None, None);
        self.add(0.0, flank.hold * unit, Some(limit(sign)), None);
        self.add(-sign * max_jerk, flank.peak * unit, None, None);
        self.add(0.0, time * unit, Some(0.0), Some(velocity * (unit * unit) * max_jerk));
        self.anchor = self.strokes.len();
        let Side { sign, flank } = last;
        self.add(-sign * max_jerk, flank.peak * unit, Some(0.0), None);
        self.add(0.0, flank.hold * unit, Some(limit(-sign)), None);
        self.add(sign * max_jerk, flank.rise * unit, None, None);
    }
}

/// The strokes of two motions side by side, cut where either goes on to its next: the numbers of both, and for how long. From the
/// front, or with numbers and times from the back.
struct Walk<'a> {
    strands: [&'a Strand; 2],
    backwards: bool,
    at: [usize; 2],
    left: [f64; 2],
}

impl<'a> Walk<'a> {
    fn of(strands: [&'a Strand; 2], backwards: bool) -> Self {
        let mut walk = Self { strands, backwards, at: [0, 0], left: [0.0, 0.0] };
        walk.left = [0, 1].map(|which| walk.beat(which).map_or(0.0, |beat| beat.time));
        walk
    }

    fn beat(&self, which: usize) -> Option<&'a Beat> {
        let beats = &self.strands[which].beats;
        let index = self.at[which];
        if self.backwards { beats.iter().nth_back(index) } else { beats.get(index) }
    }
}

impl Iterator for Walk<'_> {
    type Item = ([usize; 2], f64);

    fn next(&mut self) -> Option<Self::Item> {
        self.beat(0)?;
        self.beat(1)?;
        let at = self.at;
        let [first, second] = self.left;
        // One of both ends whatever was given: of times that are no numbers a difference is never zero.
        let outlasts = first > second;
        let time = if outlasts { second } else { first };
        for (which, ends) in [!outlasts, first >= second].into_iter().enumerate() {
            if ends {
                self.at[which] += 1;
                self.left[which] = self.beat(which).map_or(0.0, |beat| beat.time);
            } else {
                self.left[which] -= time;
            }
        }
        Some((at, time))
    }
}
