//! The way of one axis, or of all along a line, from a state under way.

use alloc::vec::Vec;

use crate::error::InvalidFields;
use crate::float::largest;
use crate::plan::adjusted;
use crate::roots::sign_change;
use crate::solve::feed_rate_above_limit;
use crate::{
    Adjustment, AdjustmentReason, Bounds, BoundsSpec, Law, Limits, Profile, Segment, State, plan_between,
    plan_stop, plan_velocity,
};

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
    /// Does it come to rest on its way?
    pub(super) through_rest: bool,
}

impl Leg {
    /// To `goal` within `limits`; none where it would have to turn back, and never does.
    pub(super) fn to_goal(
        start: State,
        goal: State,
        limits: &Limits,
        turning: Turning,
    ) -> Result<Option<Self>, InvalidFields> {
        let goal = match turning {
            Turning::Allowed => Some(goal),
            Turning::Avoided => Some(without_turning(start, goal, limits)?.unwrap_or(goal)),
            Turning::Never => without_turning(start, goal, limits)?,
        };
        let Some(reached) = goal else { return Ok(None) };
        // What cannot be slower than the limit any more is passed as slow as can be.
        let faster = reached.velocity.abs() > limits.velocity_towards(reached.velocity);
        let limits =
            if faster && turning != Turning::Allowed { &limits.reaching(reached.velocity) } else { limits };
        let profile = plan_between(start, reached, limits)?.to_profile();
        let profile = if profile.start() == start { profile } else { rounded_off(start, reached, limits) };
        if reached.is_at_rest() {
            return Ok(Some(Self { profile, reached, closing: None, through_rest: false }));
        }
        let stop = plan_stop(reached, limits)?.to_profile();
        let closing = Some(profile.segments().len());
        let profile = profile.followed_by(&stop);
        Ok(Some(Self { profile, reached, closing, through_rest: false }))
    }

    /// To rest, as fast as `limits` allow.
    pub(super) fn to_rest(start: State, limits: &Limits) -> Result<Self, InvalidFields> {
        let profile = if start.is_at_rest() {
            Profile::new(Vec::new(), start)
        } else {
            plan_stop(start, limits)?.to_profile()
        };
        let reached = profile.end();
        Ok(Self { profile, reached, closing: None, through_rest: false })
    }

    /// To rest, and on to `goal` from there: never the fastest, and never next to where the fastest changes its shape.
    pub(super) fn through_rest(start: State, goal: State, limits: &Limits) -> Result<Self, InvalidFields> {
        let to_rest = Self::to_rest(start, limits)?;
        let rest = to_rest.profile.end();
        let from_rest =
            Self::to_goal(rest, goal, limits, Turning::Allowed)?.unwrap_or_else(|| to_rest.clone());
        let pieces = to_rest.profile.segments().len();
        Ok(Self {
            profile: to_rest.profile.followed_by(&from_rest.profile),
            closing: from_rest.closing.map(|index| index + pieces),
            through_rest: true,
            ..from_rest
        })
    }

    /// When the goal is reached \[s\].
    pub(super) fn arrives(&self) -> f64 {
        let closing = self.closing.and_then(|index| self.profile.timed_segments().nth(index));
        closing.map_or(self.profile.duration(), |(begin, _)| begin)
    }
}

/// Of the bracket \[1\]: twice what [`sign_change`] finds a root to.
const ROOT_SLACK: f64 = 8.0 * f64::EPSILON;

/// From a start that is the goal but for a rounding to the goal: it stays where it is for as long as the way would take, and ends where it
/// should.
fn rounded_off(start: State, goal: State, limits: &Limits) -> Profile {
    let way = (goal.position - start.position).abs();
    // From rest to rest over so little, full jerk up, down twice as long, and up: s = jerk·T³/32.
    let duration = libm::cbrt(32.0 * way / limits.jerk());
    let waits = Segment { duration, start, law: Law::ConstantJerk(0.0) };
    Profile::new(alloc::vec![waits], goal)
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

/// The goal, with the velocity nearest to its own at which it is passed without turning back; none where it is not at any.
///
/// The fastest change to a velocity needs the least way. If that is longer than the way to the goal, the velocity lies between the one that
/// full jerk leads to, which needs the least of all, and the one that was asked for; the way grows from the former to the latter, by
///
/// ```text
/// d way / d velocity = ± velocity/peak + peak/(2·jerk)        + speeding up, − slowing down; peak: of the acceleration
/// ```
///
/// in every case, whether the peak is held or not: `dT = dv/peak`, over the motion at the end, and half of a wider change before it.
fn without_turning(start: State, goal: State, limits: &Limits) -> Result<Option<State>, InvalidFields> {
    let backward = goal.velocity < 0.0;
    let seen = |state: State| if backward { state.mirrored() } else { state };
    let (from, to) = (seen(start), seen(goal));
    if to.velocity == 0.0 || to.acceleration != 0.0 || from.velocity < 0.0 || to.position < from.position {
        return Ok(Some(goal));
    }
    let coasting = from.velocity + 0.5 * from.acceleration * from.acceleration.abs() / limits.jerk();
    let least = coasting.max(0.0);
    let bounds = Bounds::try_from(BoundsSpec {
        min_velocity: 0.0,
        max_velocity: largest(limits.velocity_towards(goal.velocity), least),
        min_acceleration: -limits.deceleration(),
        max_acceleration: limits.acceleration(),
        max_jerk: limits.jerk(),
    })?;
    let beyond = |velocity: f64| -> Result<(f64, f64), InvalidFields> {
        let change = plan_velocity(from, velocity, bounds)?;
        let peak = change.segments().iter().map(|segment| segment.start.acceleration).fold(
            0.0f64,
            |peak, acceleration| if acceleration.abs() > peak.abs() { acceleration } else { peak },
        );
        let slope = velocity / peak + 0.5 * peak.abs() / limits.jerk();
        Ok((change.end().position - to.position, slope))
    };
    if beyond(to.velocity)?.0 <= 0.0 {
        return Ok(Some(goal));
    }
    if beyond(least)?.0 > 0.0 {
        return Ok(None);
    }
    let asked = to.velocity - least;
    let part = sign_change(0.0, 1.0, |part| {
        let (value, slope) = beyond(least + part * asked).unwrap_or((f64::NAN, f64::NAN));
        (value, slope * asked)
    });
    // On the near side of the root: beyond it the motion would turn back, if only by a rounding.
    let velocity = part.map_or(least, |part| least + (part - ROOT_SLACK).max(0.0) * asked);
    Ok(Some(seen(State { velocity, ..to }).with_positive_zeros()))
}
