//! Motions of a given duration: which there are, and one of them.

use super::blend::Strand;
use super::course::{Course, Shape};
use super::ends::Ends;
use super::fastest::Change;
use super::lead_in::{Confines, LeadIn};
use super::span::Member;
use super::steady::Steady;
use super::upper::Upper;
use super::{Scaled, Transfer};
use crate::float::{largest, least};

/// Of a duration \[1\]: one that differs by less is the same.
pub(super) const SAME_TIME: f64 = 16.0 * f64::EPSILON;

/// Of a way \[1\]: what is left of it for a cruise is rounded to.
const CRUISE_ROUNDED: f64 = 16.0 * f64::EPSILON;

/// Do two durations differ by no more than their roundings?
pub(crate) fn is_same_time(one: f64, other: f64) -> bool {
    (one - other).abs() <= SAME_TIME * other
}

/// The ways that can be gone between two ends, over the duration: those between the upper and the lower family.
#[derive(Clone, Debug)]
pub(super) struct Timed {
    pub(super) lead: LeadIn,
    /// The family that goes farthest, and the mirror image of the one that goes least far; both with the way to go.
    pub(super) families: [Upper; 2],
    confines: Confines,
    /// The time unit \[s\].
    pub(super) unit: f64,
}

impl Timed {
    pub(super) fn of(transfer: &Transfer) -> Self {
        let scaled = Scaled::of(transfer);
        let Scaled { confines, way, slack, unit, .. } = scaled;
        let lead = LeadIn::of(scaled.start, confines);
        let ends = scaled.ends_after(&lead);
        let families = [1.0, -1.0].map(|sign| Upper::of(sign, ends, confines, way - lead.way, slack));
        Self { families, confines, lead, unit }
    }

    /// How long the fastest change of velocity takes.
    pub(super) fn change(&self) -> f64 {
        Change::of(self.families[0].ends, self.confines).shape.duration()
    }

    /// How long the way back into the limits lasts.
    pub(super) fn led_for(&self) -> f64 {
        self.lead.pieces.iter().fold(0.0, |sum, (_, time)| sum + time)
    }

    /// Goes on, after the way back into the limits, with the motion that takes `duration` \[s\] with it. Is there one?
    pub(super) fn go_on(&self, course: &mut Course, transfer: &Transfer, duration: f64) -> bool {
        let time = duration / self.unit - self.led_for();
        let [upper, _] = &self.families;
        let feet = self.families.map(|family| family.steady_at_foot(time));
        // A steady motion comes after both. Also false for NaN.
        let changes = feet.iter().any(Option::is_some)
            || (time >= self.change() * (1.0 - SAME_TIME) && !self.in_gap(time));
        if !changes {
            return false;
        }
        let (bounds, unit) = (&transfer.bounds, self.unit);
        for (index, family) in self.families.iter().enumerate() {
            if let Some(foot) = feet[index].filter(|foot| foot.way() <= family.way) {
                if let Some(steady) = family.steady_above(foot, time) {
                    let steady = if index == 0 { steady } else { steady.mirrored() };
                    course.steady(&steady, bounds, unit);
                    return true;
                }
                let member = self.member(index, time);
                if let Some(shape) = &member {
                    course.phases(shape, bounds, unit);
                }
                return member.is_some();
            }
        }
        let between = if feet.iter().all(Option::is_some) { upper.steady_between(time) } else { None };
        if let Some(steady) = between {
            course.steady(&steady, bounds, unit);
            return true;
        }
        let strands = [0, 1].map(|index| self.strand(index, feet[index].as_ref(), time));
        let [farthest, nearest] = &strands;
        let off = largest(upper.way - farthest.way, nearest.way - upper.way);
        if off > 0.0 && off > self.slack(time) {
            return false;
        }
        let room = farthest.way - nearest.way;
        let part = if room > 0.0 { (upper.way - nearest.way) / room } else { 0.0 };
        course.blend([farthest, nearest], least(1.0, largest(0.0, part)), time, bounds, unit);
        true
    }

    /// What is blended on the side of a family: the motion that is steady at its foot, or, where that takes longer, its member.
    fn strand(&self, index: usize, foot: Option<&Steady>, time: f64) -> Strand {
        match foot {
            Some(foot) if index == 0 => Strand::of_steady(foot),
            Some(foot) => Strand::of_steady(&foot.mirrored()),
            None => {
                let Member { phases, way, .. } = self.families[index].lasting(time);
                let sign = if index == 0 { 1.0 } else { -1.0 };
                Strand::of_member(&Shape { sign, phases }, sign * way)
            }
        }
    }

    /// The member of a family that takes `time`, where it goes the way but for a rounding.
    fn member(&self, index: usize, time: f64) -> Option<Shape> {
        let family = &self.families[index];
        let Member { phases, way, .. } = family.lasting(time);
        let sign = if index == 0 { 1.0 } else { -1.0 };
        (way >= family.way - self.slack(time)).then_some(Shape { sign, phases })
    }

    /// What the way is rounded to, of which the two ends have no part while the motion cruises.
    pub(super) fn slack(&self, time: f64) -> f64 {
        let [upper, lower] = &self.families;
        let moves = |family: &Upper| family.summit_at(family.room()).time();
        let moving = least(time, largest(moves(upper), moves(lower)));
        upper.slack + upper.ends.way_rounding(moving) + CRUISE_ROUNDED * upper.way.abs()
    }

    /// Durations that no change of velocity takes: from the last motion whose acceleration keeps its sign to the first that turns it
    /// round.
    pub(super) fn gap(&self) -> Option<(f64, f64)> {
        let [upper, _] = &self.families;
        let Ends { start, goal, .. } = upper.ends;
        if start.acceleration * goal.acceleration <= 0.0 {
            return None;
        }
        let from = upper.lens_closes()?;
        let to = upper.passes_zero_from();
        (to - from > SAME_TIME * to).then_some((from, to))
    }

    fn in_gap(&self, time: f64) -> bool {
        self.gap().is_some_and(|(from, to)| time > from * (1.0 + SAME_TIME) && time < to * (1.0 - SAME_TIME))
    }
}
