use crate::float::largest;
use crate::{Limits, Problem};

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
    /// Greatest while the speed grows, and while it shrinks [axis units/s²].
    pub(super) acceleration: f64,
    pub(super) deceleration: f64,
    pub(super) jerk: f64,
}

impl Lane {
    pub(super) fn of(problem: &Problem, direction: f64) -> Self {
        let limits: &Limits = problem.limits();
        Self {
            start: problem.start().velocity.abs(),
            end: problem.goal().velocity.abs(),
            length: problem.distance().abs(),
            cruise: limits.cruise_towards(direction),
            acceleration: limits.acceleration(),
            deceleration: limits.deceleration(),
            jerk: limits.jerk(),
        }
    }

    /// The limit of the one ramp between two speeds.
    pub(super) fn limit(&self, from: f64, to: f64) -> f64 {
        if to < from { self.deceleration } else { self.acceleration }
    }

    /// Is the way less than the change from the start to the end speed needs?
    pub(super) fn is_shorter_than(&self, least_length: f64) -> bool {
        self.length < least_length * (1.0 - LENGTH_SLACK)
    }

    pub(super) fn is_from_rest_to_rest(&self) -> bool {
        self.start == 0.0 && self.end == 0.0
    }

    /// Are speeding up and slowing down limited alike?
    #[expect(clippy::float_cmp, reason = "the same number given twice is the same limit")]
    pub(super) fn is_symmetric(&self) -> bool {
        self.acceleration == self.deceleration
    }

    pub(super) fn sides(&self) -> Sides {
        let Self { start, end, acceleration, deceleration, .. } = *self;
        let gap = (end - start).abs();
        // Between equal ends the lower limit is far: it is the one that is reached first, and alone.
        let near_is_up = if gap == 0.0 { acceleration > deceleration } else { start > end };
        let (near, far) =
            if near_is_up { (acceleration, deceleration) } else { (deceleration, acceleration) };
        Sides { faster: largest(start, end), sum: start + end, gap, near, far, near_is_up }
    }
}

/// What is on both sides of a peak. *Near* is the side of the faster end, *far* that of the slower one: over the rise
/// `u` from the faster end to the peak, the near ramp changes the speed by `u` and the far one by `u + gap`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sides {
    /// The faster of both ends [axis units/s], their sum and their distance.
    pub(super) faster: f64,
    pub(super) sum: f64,
    pub(super) gap: f64,
    /// The limit of the near and of the far ramp [axis units/s²].
    pub(super) near: f64,
    pub(super) far: f64,
    /// Is the near side the one that speeds up?
    pub(super) near_is_up: bool,
}

impl Sides {
    /// What belongs to the near and to the far side, as what belongs to speeding up and to slowing down.
    pub(super) fn up_and_down<T>(&self, near: T, far: T) -> (T, T) {
        if self.near_is_up { (near, far) } else { (far, near) }
    }
}
