//! Limits of speeding up and slowing down, which bound the acceleration by the sign of the velocity, as bounds with signs.
//!
//! The limit of a ramp is told by the velocities at its ends: speeding up, slowing down, or the lower of both where it crosses zero, unless it
//! is parted there ([`turning`](super::turning)). So for each direction of the travel, and each sign of the velocity that is held or touched on the way, the bounds have constant signs:
//!
//! ```text
//! velocities of a motion      raising the velocity     lowering it
//! forward                     speeding up: A           slowing down: D
//! backward                    slowing down: D          speeding up: A
//! through zero                min(A, D) on that ramp, which is the one or the other, or both are; or both, parted at zero
//! ```

use super::axis::AxisTransfer;
use super::bounds::{Bounds, BoundsSpec};
use super::transit::Transit;
use super::turning::{Turn, Turning, does_turn};
use super::{Names, Transfer, by_rest, note_goal, plan_velocity, transit_of};
use crate::error::{Field, InvalidFields, Why};
use crate::float::{largest, least};
use crate::problem::note_not_finite;
use crate::roots::quadratic;
use crate::segment::turning_points_of_jerk;
use crate::solve::Piece;
use crate::{Law, Limits, Segment, State};

/// Of the hardest \[1\]: what an acceleration may be beyond its limit, since it was computed.
const ROUNDED: f64 = 1e-12;

/// Of the fastest \[1\]: what a velocity may be beside zero, since it was computed; less than the judge takes for none.
const STANDSTILL: f64 = 4.0 * f64::EPSILON;

/// The names of signed bounds in [`Limits`].
const NAMES: Names = Names {
    min_velocity: "limits.max_velocity_reverse",
    max_velocity: "limits.max_velocity",
    min_acceleration: "limits.max_deceleration",
    max_acceleration: "limits.max_acceleration",
};

/// The fastest motion of one axis from any state to any state within `limits`, cruising at most at the feed rate: as [`plan_transfer`](crate::plan_transfer),
/// with speeding up and slowing down told apart.
///
/// Each ramp has one limit, told by the velocities at its ends: *acceleration* where the speed grows, *deceleration* where it shrinks; where
/// it crosses zero it has the lower of both, or it is parted there, and each part has its own. Fastest among those with at most two turns
/// of the second kind, each at the greatest acceleration that a turn may have, or at rest.
///
/// # Errors
/// What is wrong with `start` and `goal`, as [`Transfer::new`] says; [`Why::PositionLimit`] where the motion leaves the position range;
/// [`Why::GoalOutsideLimits`] where the goal lies behind and going back is forbidden.
pub fn plan_between(start: State, goal: State, limits: &Limits) -> Result<Transit, InvalidFields> {
    AxisTransfer::within_limits(start, goal, limits)?.fastest()
}

/// Is the goal one that limits allow?
pub(super) fn check(start: &State, goal: &State, limits: &Limits) -> Result<(), InvalidFields> {
    let mut invalid = InvalidFields::default();
    note_not_finite(&mut invalid, start, goal);
    if invalid.is_empty() {
        let hardest = largest(limits.acceleration(), limits.deceleration());
        note_goal(&mut invalid, goal, &bounds(limits, hardest, hardest), &NAMES);
    }
    invalid.into_result(())
}

/// The fastest motion within limits, wherever that leads.
pub(super) fn fastest(start: State, goal: State, limits: &Limits) -> Result<Transit, InvalidFields> {
    let planned = shortest(limits, |bounds| transit_of(&Transfer::new(start, goal, bounds)?, &NAMES));
    if planned.is_err() && by_rest::is_too_hard(&goal, limits) {
        return by_rest::motion(start, goal, limits, None).map_or(planned, Ok);
    }
    match planned {
        Ok(planned) if tells_apart(limits) && does_turn(&planned) => {
            // A hard turn where it is not needed may cost a run-up that rest does not.
            let turning = [Turn::Hard, Turn::AtRest].into_iter().filter_map(|turn| {
                Turning::fastest(start, goal, limits, turn).and_then(|turning| turning.joined(0.0))
            });
            Ok(turning.fold(
                planned,
                |best, turning| {
                    if turning.duration() < best.duration() { turning } else { best }
                },
            ))
        }
        planned => planned,
    }
}

/// Do speeding up and slowing down have limits of their own?
fn tells_apart(limits: &Limits) -> bool {
    limits.acceleration().to_bits() != limits.deceleration().to_bits()
}

/// As [`fastest`], by way of rest, where nothing else is known to lead to the goal in any longer time, or that in less.
pub(super) fn by_way_of_rest(start: State, goal: State, limits: &Limits) -> Option<Transit> {
    if by_rest::is_too_hard(&goal, limits) {
        return by_rest::motion(start, goal, limits, None);
    }
    if !tells_apart(limits) {
        return None;
    }
    let lower = transit_of(&lower(start, goal, limits).ok()?, &NAMES).ok().filter(does_turn)?;
    let turning = Turning::fastest(start, goal, limits, Turn::AtRest)?;
    if turning.duration() < lower.duration() { turning.joined(0.0) } else { None }
}

/// Lays the motion within limits that takes `duration` \[s\]: under the lower of both limits of acceleration, which keeps them whatever it
/// does; under one for each direction, where only that is fast enough and the motion keeps the limits. What is laid is of no use where there
/// is none.
pub(super) fn lay_lasting(
    start: State,
    goal: State,
    limits: &Limits,
    duration: f64,
    transit: &mut Transit,
) -> bool {
    let gently = lower(start, goal, limits);
    if gently.is_ok_and(|gently| super::lay_lasting(&gently, duration, transit)) {
        return true;
    }
    if !tells_apart(limits) {
        return false;
    }
    let (up, down) = (limits.acceleration(), limits.deceleration());
    let planned = |up: f64, down: f64| {
        let transfer = Transfer::new(start, goal, bounds(limits, up, down)).ok()?;
        let mut planned = Transit::unlaid();
        super::lay_lasting(&transfer, duration, &mut planned).then_some(planned)
    };
    let both = [(up, down), (down, up)].into_iter();
    let each = both.filter_map(|(up, down)| planned(up, down)).find(|planned| keeps(planned, limits));
    let planned = each.or_else(|| {
        if by_rest::is_too_hard(&goal, limits) {
            return by_rest::motion(start, goal, limits, Some(duration));
        }
        Turning::fastest(start, goal, limits, Turn::AtRest)?.lasting(duration)
    });
    planned.map(|planned| *transit = planned).is_some()
}

/// The question under the lower of both limits of acceleration.
pub(super) fn lower(start: State, goal: State, limits: &Limits) -> Result<Transfer, InvalidFields> {
    Transfer::new(start, goal, lower_bounds(limits))
}

pub(super) fn lower_bounds(limits: &Limits) -> Bounds {
    let lower = least(limits.acceleration(), limits.deceleration());
    bounds(limits, lower, lower)
}

/// The fastest stop from any state within `limits`.
///
/// # Errors
/// What is wrong with `from`; [`Why::PositionLimit`] where it leaves the position range.
pub(crate) fn stop(from: State, limits: &Limits) -> Result<Transit, InvalidFields> {
    let planned = shortest(limits, |bounds| plan_velocity(from, 0.0, bounds))?;
    within_range(&planned, limits)?;
    Ok(planned)
}

/// The shortest of the motions under the signed bounds that limits can mean, among those that keep the limits.
fn shortest(
    limits: &Limits,
    plan: impl Fn(Bounds) -> Result<Transit, InvalidFields>,
) -> Result<Transit, InvalidFields> {
    let (up, down) = (limits.acceleration(), limits.deceleration());
    if !tells_apart(limits) {
        return plan(bounds(limits, up, down));
    }
    let lower = least(up, down);
    // The last of them keeps the limits whatever it does.
    let mut best = plan(bounds(limits, lower, lower));
    for candidate in [(up, down), (down, up)] {
        let Ok(planned) = plan(bounds(limits, candidate.0, candidate.1)) else { continue };
        let is_shorter = best.as_ref().map_or(true, |best| planned.duration() < best.duration());
        if is_shorter && keeps(&planned, limits) {
            best = Ok(planned);
        }
    }
    best
}

pub(super) fn bounds(limits: &Limits, up: f64, down: f64) -> Bounds {
    Bounds::of(BoundsSpec {
        min_velocity: 0.0 - limits.cruise_towards(-1.0),
        max_velocity: limits.cruise_towards(1.0),
        min_acceleration: -down,
        max_acceleration: up,
        max_jerk: limits.jerk(),
    })
}

/// Does the acceleration keep the limit of what it does to the speed? An acceleration at the start that is beyond it may be on its way
/// back. A velocity that is a rounded zero goes in no direction.
pub(super) fn keeps(planned: &Transit, limits: &Limits) -> bool {
    let segments = planned.segments();
    let begins = segments.iter().map(|segment| segment.start.velocity.abs());
    let standstill = STANDSTILL * begins.fold(planned.end().velocity.abs(), largest);
    let begins = segments.iter().map(|segment| segment.start.acceleration.abs());
    let rounding = ROUNDED * begins.fold(planned.end().acceleration.abs(), largest);
    segments.iter().enumerate().all(|(index, segment)| {
        let mut times = segment.turning_points();
        times.extend(standstills(segment).into_iter().filter(|t| *t > 0.0 && *t < segment.duration));
        times.sort_unstable_by(f64::total_cmp);
        times.windows(2).all(|span| {
            let (from, to) = (segment.at(span[0]).state, segment.at(span[1]).state);
            let velocity = segment.at(0.5 * (span[0] + span[1])).state.velocity;
            if velocity.abs() <= standstill {
                return true;
            }
            let limit = |acceleration: f64| {
                if acceleration * velocity >= 0.0 { limits.acceleration() } else { limits.deceleration() }
            };
            let kept = |acceleration: f64| acceleration.abs() <= limit(acceleration) + rounding;
            let comes_back = index == 0 && to.acceleration.abs() < from.acceleration.abs();
            (kept(from.acceleration) && kept(to.acceleration)) || comes_back
        })
    })
}

/// Where the velocity of a piece is zero.
fn standstills(segment: &Segment) -> arrayvec::ArrayVec<f64, 2> {
    let Law::ConstantJerk(jerk) = segment.law else { return arrayvec::ArrayVec::new() };
    quadratic(0.5 * jerk, segment.start.acceleration, segment.start.velocity)
}

/// Does the motion stay inside the position range? If not, where it goes farthest.
pub(super) fn within_range(planned: &Transit, limits: &Limits) -> Result<(), InvalidFields> {
    let spec = limits.spec();
    if spec.min_position.is_none() && spec.max_position.is_none() {
        return Ok(());
    }
    let mut begin = 0.0;
    let mut farthest: Option<(f64, Why)> = None;
    for &Piece { duration, start, jerk } in planned.pieces() {
        for t in turning_points_of_jerk::<5>(&start, jerk, duration) {
            let reached = start.after(jerk, t).position;
            let time = begin + t;
            let rounding = 8.0 * f64::EPSILON * reached.abs();
            for (outside, allowed, limit) in [
                (reached - limits.max_position(), limits.max_position(), "limits.max_position"),
                (limits.min_position() - reached, limits.min_position(), "limits.min_position"),
            ] {
                if outside > farthest.as_ref().map_or(rounding, |(outside, _)| *outside) {
                    farthest = Some((outside, Why::PositionLimit { reached, time, allowed, limit }));
                }
            }
        }
        begin += duration;
    }
    farthest.map_or(Ok(()), |(_, why)| Err(InvalidFields::one(Field::default(), why)))
}
