//! A motion at the instant at which an operation takes effect, and what is asked of it.

use super::factor::Override;
use super::leg::Turning;
use crate::float::{largest, least};
use crate::roots::linear;
use crate::{AdjustmentReason, AxisPlan, Law, Limits, Plan, Profile, Quantity, State};

/// What a motion is asked for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Errand<'a> {
    /// To come to rest.
    Rest,
    /// To go to its aims.
    Goals {
        /// How fast.
        factor: Override,
        /// And which way.
        turning: Turning,
        /// Which axes have nothing to change, as far as they can tell.
        kept: &'a [bool],
    },
}

/// A plan at an instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct UnderWay<'a> {
    pub(super) plan: &'a Plan,
    /// Of the plan's time \[s\]; ∞ from its last cycle on.
    pub(super) at: f64,
    /// Goals and limits, as they were asked for.
    pub(super) aims: &'a [AxisPlan],
    pub(super) errand: Errand<'a>,
}

impl UnderWay<'_> {
    /// Where a splice begins: where the axis is commanded to be.
    ///
    /// But for a motion whose acceleration may jump (it has no limit of jerk to say otherwise): where full jerk would lead its acceleration
    /// beyond the velocity limit, that jumps once more, to zero.
    pub(super) fn state(&self, axis: usize) -> State {
        let state = self.commanded(axis);
        if self.jumps_on(axis, &state) { State { acceleration: 0.0, ..state } } else { state }
    }

    /// Does a splice begin with a jump of any acceleration?
    pub(super) fn jumps(&self) -> bool {
        (0..self.aims.len()).any(|axis| self.jumps_on(axis, &self.commanded(axis)))
    }

    fn jumps_on(&self, axis: usize, state: &State) -> bool {
        if self.plan.guarantees(Quantity::Jerk) {
            return false;
        }
        let State { velocity, acceleration, .. } = *state;
        let limits = &self.aims[axis].limits;
        let leads_to = velocity + 0.5 * acceleration * acceleration.abs() / limits.jerk();
        let beyond = leads_to.abs() > limits.velocity_towards(leads_to);
        beyond && leads_to.abs() > velocity.abs()
    }

    fn commanded(&self, axis: usize) -> State {
        state_at(&self.plan.axes()[axis].profile, self.at)
    }

    /// Do all axes stand still?
    pub(super) fn is_at_rest(&self) -> bool {
        (0..self.aims.len()).all(|axis| self.state(axis).is_at_rest())
    }
}

/// As a splice begins there: the sign of a zero is not carried.
pub(super) fn state_at(profile: &Profile, at: f64) -> State {
    profile.at(at).state.with_positive_zeros()
}

/// When the closing stop of an axis begins, the instant at which its goal is passed \[s\]; none where it ends at its goal.
pub(super) fn closing_begins(axis: &AxisPlan) -> Option<f64> {
    let is_closing = |reason| reason == AdjustmentReason::ClosingStop;
    axis.adjustments.iter().find(|adjustment| is_closing(adjustment.reason))?;
    let passed = axis.goal_as_adjusted(|reason| !is_closing(reason));
    // The stop begins in exactly the state in which what was before it ended.
    let begins = axis.profile.timed_segments().filter(|(_, segment)| segment.start == passed);
    begins.last().map(|(begin, _)| begin)
}

/// Of a time \[1\]: a cycle that is due this much before an instant is due at it. The roundings of a duration are worth less.
const DUE: f64 = 16.0 * f64::EPSILON;

/// Is the goal of an axis behind it, but for its closing stop?
pub(super) fn has_passed(axis: &AxisPlan, at: f64) -> bool {
    closing_begins(axis).is_some_and(|begins| at >= begins * (1.0 - DUE))
}

/// Does a change of the override from one factor to another change what the axis does from `at` on?
///
/// Not where the cruise speed holds it back neither before nor after: then the fastest motion within the one is the fastest within the
/// other. A goal at speed is always changed.
pub(super) fn binds(axis: &AxisPlan, limits: &Limits, at: f64, [before, after]: [Override; 2]) -> bool {
    if !axis.goal.is_at_rest() {
        return true;
    }
    let (before, after) = (limits.scaled(before.get()), limits.scaled(after.get()));
    let (lowest, highest) = velocity_range(&axis.profile, at);
    [(1.0, highest), (-1.0, -lowest)].into_iter().any(|(sign, fastest)| {
        let (old, new) = (before.velocity_towards(sign), after.velocity_towards(sign));
        fastest > new * (1.0 + AT_THE_LIMIT) || (new > old && fastest >= old * (1.0 - AT_THE_LIMIT))
    })
}

/// Of a velocity \[1\]: this near to a limit it may be held back by it.
const AT_THE_LIMIT: f64 = 1e-9;

/// The lowest and the highest velocity from `at` on, and zero.
pub(super) fn velocity_range(profile: &Profile, at: f64) -> (f64, f64) {
    let end = profile.end().velocity;
    let mut range = (least(end, 0.0), largest(end, 0.0));
    let mut see = |velocity: f64| range = (least(range.0, velocity), largest(range.1, velocity));
    for (begin, segment) in profile.timed_segments() {
        if begin + segment.duration <= at {
            continue;
        }
        let from = largest(0.0, at - begin);
        see(segment.at(from).state.velocity);
        match segment.law {
            Law::ConstantJerk(jerk) => {
                let turn = linear(jerk, segment.start.acceleration);
                if let Some(t) = turn.filter(|&t| t > from && t < segment.duration) {
                    see(segment.at(t).state.velocity);
                }
                see(segment.at(segment.duration).state.velocity);
            }
            Law::Polynomial(_) | Law::CosineJerk { .. } => {
                let turns = segment.turning_points();
                turns.into_iter().filter(|&t| t > from).for_each(|t| see(segment.at(t).state.velocity));
            }
        }
    }
    range
}
