//! The way of one axis, or of all along a line, from a state under way.

use alloc::vec::Vec;

use super::errand::velocity_range;
use super::passing::{Passing, passing};
use crate::error::InvalidFields;
use crate::float::largest;
use crate::plan::adjusted;
use crate::solve::feed_rate_above_limit;
use crate::{Adjustment, AdjustmentReason, Law, Limits, Profile, Segment, State, plan_between, plan_stop};

/// May a motion turn back on its way to a goal at speed that lies ahead?
///
/// An override or a hold changes how fast a motion goes, not which way: where the goal can be passed without turning back, it is, at
/// the nearest velocity to the one asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turning {
    /// Where that is faster, or takes it to the velocity asked for.
    Allowed,
    /// Only where the goal cannot be passed without it.
    Avoided,
    /// Not at all.
    Never,
}

/// A motion to a goal, and to rest where the goal is passed at speed.
#[derive(Clone, Debug)]
pub(super) struct Leg {
    pub(super) profile: Profile,
    /// The state at the goal.
    pub(super) reached: State,
    /// The first piece of the closing stop, where there is one.
    pub(super) closing: Option<usize>,
}

impl Leg {
    /// To `goal` within `limits`; none where it would have to turn back, and never does.
    pub(super) fn to_goal(
        start: State,
        goal: State,
        limits: &Limits,
        turning: Turning,
    ) -> Result<Option<Self>, InvalidFields> {
        if turning == Turning::Allowed {
            return Self::fastest(start, goal, limits).map(Some);
        }
        let leg = match passing(start, goal, limits) {
            Passing::Nearest(change) => {
                return Self::closed(from_exactly(start, change, limits), limits).map(Some);
            }
            Passing::NotAhead => return Self::fastest(start, goal, limits).map(Some),
            Passing::AsAsked | Passing::TooNear => Self::fastest(start, goal, limits)?,
        };
        Ok((turning == Turning::Avoided || !leg.turns_back()).then_some(leg))
    }

    /// The fastest to `reached`.
    pub(super) fn fastest(start: State, reached: State, limits: &Limits) -> Result<Self, InvalidFields> {
        let profile = plan_between(start, reached, limits)?.to_profile();
        let profile = from_exactly(start, profile, limits);
        if reached.is_at_rest() {
            return Ok(Self { profile, reached, closing: None });
        }
        Self::closed(profile, limits)
    }

    /// With a closing stop after it.
    fn closed(profile: Profile, limits: &Limits) -> Result<Self, InvalidFields> {
        let reached = profile.end();
        let stop = plan_stop(reached, limits)?.to_profile();
        let closing = Some(profile.segments().len());
        Ok(Self { profile: profile.followed_by(&stop), reached, closing })
    }

    /// Does it go against the velocity at the goal?
    fn turns_back(&self) -> bool {
        let (lowest, highest) = velocity_range(&self.profile, 0.0);
        let back = if self.reached.velocity < 0.0 { highest } else { -lowest };
        back > STANDSTILL * largest(highest, -lowest)
    }

    /// To rest, as fast as `limits` allow.
    pub(super) fn to_rest(start: State, limits: &Limits) -> Result<Self, InvalidFields> {
        let profile = if start.is_at_rest() {
            Profile::new(Vec::new(), start)
        } else {
            plan_stop(start, limits)?.to_profile()
        };
        let reached = profile.end();
        Ok(Self { profile, reached, closing: None })
    }

    /// To rest, and on to `goal` from there: never the fastest, and never next to where the fastest changes its shape.
    pub(super) fn through_rest(start: State, goal: State, limits: &Limits) -> Result<Self, InvalidFields> {
        let to_rest = Self::to_rest(start, limits)?;
        let from_rest = Self::fastest(to_rest.reached, goal, limits)?;
        let pieces = to_rest.profile.segments().len();
        Ok(Self {
            profile: to_rest.profile.followed_by(&from_rest.profile),
            closing: from_rest.closing.map(|index| index + pieces),
            ..from_rest
        })
    }

    /// When the goal is reached \[s\].
    pub(super) fn arrives(&self) -> f64 {
        let closing = self.closing.and_then(|index| self.profile.timed_segments().nth(index));
        closing.map_or(self.profile.duration(), |(begin, _)| begin)
    }
}

/// Of the fastest \[1\]: a velocity below it is a rounded zero, and turns nothing back.
const STANDSTILL: f64 = 1e-12;

/// A motion that begins in exactly `start`. Where that is its end but for a rounding, it has no pieces: then it stays where it is for as long
/// as the way would take, and ends where it should.
fn from_exactly(start: State, motion: Profile, limits: &Limits) -> Profile {
    if motion.start() == start {
        return motion;
    }
    let end = motion.end();
    // From rest to rest over so little, full jerk up, down twice as long, and up: s = jerk·T³/32.
    let duration = libm::cbrt(32.0 * (end.position - start.position).abs() / limits.jerk());
    let waits = Segment { duration, start, law: Law::ConstantJerk(0.0) };
    Profile::new(alloc::vec![waits], end)
}

/// What is said of a motion within `limits` to `goal`, which an override made `scaled`, which is passed as `reached`, before an `end` at rest.
pub(super) fn adjustments(
    limits: &Limits,
    start: State,
    [goal, scaled, reached, end]: [State; 4],
) -> Vec<Adjustment> {
    let direction = if goal.position < start.position { -1.0 } else { 1.0 };
    let mut adjustments = Vec::new();
    adjustments.extend(feed_rate_above_limit(limits, direction));
    adjustments.extend(adjusted(goal, goal, scaled, AdjustmentReason::Override));
    adjustments.extend(adjusted(goal, scaled, reached, AdjustmentReason::PathTooShortNearestVelocity));
    adjustments.extend(adjusted(goal, reached, end, AdjustmentReason::ClosingStop));
    adjustments
}
