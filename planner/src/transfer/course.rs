use arrayvec::ArrayVec;

use super::Transfer;
use super::bounds::{Bounds, BoundsSpec};
use super::ends::Phases;
use super::lead_in::LeadIn;

/// The most pieces of a motion between two states: two to lead a start back into its limits, and seven to rest, a wait there, and three to the
/// goal. Of all others nine follow the first two.
pub const MAX_TRANSIT_PIECES: usize = 13;

/// The jerk of each phase, of the limit.
pub(super) const SIGNS: Phases = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0];

/// A member of the upper family, or of the lower one seen from the other side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    /// −1 for the lower family.
    pub(super) sign: f64,
    pub(super) phases: Phases,
}

impl Shape {
    pub(super) fn duration(&self) -> f64 {
        self.phases.iter().sum()
    }
}

/// One piece of a motion before it has a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// The jerk [axis units/s³].
    pub(super) jerk: f64,
    /// How long it lasts [s].
    pub(super) time: f64,
    /// The acceleration at its start, where that is known better than what comes before it adds up to.
    pub(super) acceleration: Option<f64>,
    /// The velocity at its start, where that is known so.
    pub(super) velocity: Option<f64>,
}

/// The pieces of a motion in units of the axis, in order. Those before the anchor, and itself, hang on the start, those after it on the goal.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    pub(super) strokes: ArrayVec<Stroke, MAX_TRANSIT_PIECES>,
    pub(super) anchor: usize,
}

impl Course {
    /// The way back into the limits, with room for what comes after it. An acceleration that is held is the limit itself: what
    /// little it were off by would add up.
    pub(super) fn led(lead: &LeadIn, bounds: &Bounds, unit: f64) -> Self {
        let mut course = Self::default();
        course.lead(lead, bounds, unit);
        course
    }

    /// Begins with the way back into the limits.
    pub(super) fn lead(&mut self, lead: &LeadIn, bounds: &Bounds, unit: f64) {
        let BoundsSpec { min_acceleration, max_acceleration, max_jerk, .. } = *bounds.spec();
        let limit = if lead.held < 0.0 { min_acceleration } else { max_acceleration };
        for &(sign, time) in &lead.pieces {
            self.add(sign * max_jerk, time * unit, (sign == 0.0).then_some(limit), None);
        }
        self.anchor = self.strokes.len();
    }

    /// The way back into the limits, and a member of a family; `unit` is the time unit \[s\] of both.
    pub(super) fn of(lead: &LeadIn, shape: &Shape, transfer: &Transfer, unit: f64) -> Self {
        let Transfer { bounds, .. } = transfer;
        let mut course = Self::led(lead, bounds, unit);
        course.phases(shape, bounds, unit);
        course
    }

    /// Goes on with a member of a family.
    pub(super) fn phases(&mut self, shape: &Shape, bounds: &Bounds, unit: f64) {
        let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
            *bounds.spec();
        let Shape { sign, mut phases } = *shape;
        if phases[3] == 0.0 {
            phases[2] += phases[4];
            phases[4] = 0.0;
        }
        let (raised, lowered) = if sign < 0.0 {
            (min_acceleration, max_acceleration)
        } else {
            (max_acceleration, min_acceleration)
        };
        let cruise = if sign < 0.0 { min_velocity } else { max_velocity };
        let known = [None, Some(raised), None, Some(0.0), Some(0.0), Some(lowered), None];
        for (index, phase) in phases.into_iter().enumerate() {
            if index == 4 {
                self.anchor = self.strokes.len();
            }
            let velocity = (index == 3).then_some(cruise);
            self.add(SIGNS[index] * sign * max_jerk + 0.0, phase * unit, known[index], velocity);
        }
    }

    /// What takes no time is left out.
    pub(super) fn add(&mut self, jerk: f64, time: f64, acceleration: Option<f64>, velocity: Option<f64>) {
        if time > 0.0 {
            // One more than there can be is one of no more than a rounding.
            let _ = self.strokes.try_push(Stroke { jerk, time, acceleration, velocity });
        }
    }
}
