//! What was planned, before the judge; and what cannot be kept, since it was broken before the operation.

use alloc::string::{String, ToString as _};
use alloc::vec::Vec;

use super::Refused;
use super::errand::UnderWay;
use super::leg::Leg;
use crate::float::{largest, least, sqrt};
use crate::verify::{Recoveries, Recovery, Violation};
use crate::{
    Accepted, AxisPlan, Family, InvalidFields, Judged, LimitCheck, Limits, LimitsSpec, Method, Plan,
    Quantity, State,
};

/// A limit that a motion begins beyond, or will come beyond whatever is done: it is led back as fast as can be.
#[derive(Clone, Debug, PartialEq)]
pub struct Beyond {
    /// The axis.
    pub axis: String,
    /// The quantity.
    pub quantity: Quantity,
    /// The limit as it was asked for, in the unit of the quantity; signed for velocities and positions.
    pub limit: f64,
    /// As far as cannot be avoided, which the plan states as its limit, and is judged by.
    pub inevitable: f64,
}

/// An accepted plan, and the limits that it states wider than they were asked for.
#[derive(Debug)]
pub(super) struct Proved {
    pub(super) plan: Accepted,
    pub(super) beyond: Vec<Beyond>,
}

/// How every splice is made: constant jerk in pieces, whatever the motion was made of before, and to a goal.
pub(super) fn method_of_splice(method: Method) -> Method {
    Method { family: Family::SCurve, order: 3, end_on_cycle: false, pvt: None, ..method }
}

/// Why the judge does not accept what was planned.
#[derive(Debug)]
pub(super) enum Objection {
    Invalid(InvalidFields),
    Rejected(crate::Rejection),
}

impl From<InvalidFields> for Objection {
    fn from(invalid: InvalidFields) -> Self {
        Self::Invalid(invalid)
    }
}

impl From<Objection> for Refused {
    /// A range of positions that is left is the caller's to mend, whatever else there is.
    fn from(objection: Objection) -> Self {
        let rejection = match objection {
            Objection::Invalid(invalid) => return Self::Invalid(invalid),
            Objection::Rejected(rejection) => rejection,
        };
        let left = rejection.violations.iter().find_map(|violation| match violation {
            Violation::Limit(check) if check.quantity == Quantity::Position => Some(check),
            Violation::Limit(_) | Violation::Join(_) | Violation::End(_) => None,
        });
        match left {
            Some(LimitCheck { axis, limit, extremum, at_time, .. }) => Self::PositionLimit {
                axis: axis.to_string(),
                reached: *extremum,
                time: *at_time,
                allowed: *limit,
                limit: if extremum > limit { "limits.max_position" } else { "limits.min_position" },
            },
            None => Self::Rejected(rejection),
        }
    }
}

/// Puts axes before the judge. Where he objects, limits that the start breaks are stated as wide as is inevitable from there, and he is
/// asked again.
pub(super) fn prove(under_way: &UnderWay<'_>, axes: Vec<AxisPlan>) -> Result<Proved, Objection> {
    let (method, cycle_time) = (method_of_splice(under_way.plan.method()), under_way.plan.cycle_time());
    // Velocity, acceleration and jerk; but an acceleration that jumps to where the splice begins has no limit of jerk there.
    let highest = if under_way.jumps() { 2 } else { 3 };
    let judge = |axes: Vec<AxisPlan>| -> Result<Judged, InvalidFields> {
        let guaranteed = Quantity::BY_ORDER[1..=highest].to_vec();
        Ok(Judged::new(Plan::new(method, guaranteed, cycle_time, axes)?))
    };
    let judged = judge(axes)?;
    let accept = |judged: Judged, beyond| match judged.accepted() {
        Ok(plan) => Ok(Proved { plan, beyond }),
        Err(rejection) => Err(Objection::Rejected(rejection)),
    };
    // What the judge lets pass on its way back is stated all the same.
    if judged.certificate().passed() && !judged.certificate().is_led_back() {
        return accept(judged, Vec::new());
    }
    let mut beyond = Vec::new();
    let (mut axes, recoveries) = (judged.plan().axes().to_vec(), Recoveries::of(judged.plan()));
    for axis in &mut axes {
        let recovery = recoveries.of_axis(&axis.profile, &axis.limits);
        widen(axis, recovery, &mut beyond)?;
    }
    if beyond.is_empty() { accept(judged, beyond) } else { accept(judge(axes)?, beyond) }
}

/// States the limits of an axis as wide as its start makes inevitable.
///
/// ```text
/// velocity       full jerk against the acceleration: v ± a²/(2·jerk); on a line the line's, as of all that follows
/// acceleration   that of the start; and where slowing down leads through zero, what is left of it there, √(a² − 2·jerk·|v|),
///                which then speeds up
/// position       where the fastest stop leads
/// ```
fn widen(axis: &mut AxisPlan, recovery: Recovery, beyond: &mut Vec<Beyond>) -> Result<(), InvalidFields> {
    let limits = axis.limits.clone();
    let start = axis.profile.start();
    let Inevitable { lowest, highest, speeding_up, slowing_down, least_position, greatest_position } =
        Inevitable::of(start, &limits, recovery)?;
    let mut spec = LimitsSpec {
        // What is unset follows its counterpart, which may be about to change.
        max_deceleration: Some(limits.deceleration()),
        max_velocity_reverse: Some(limits.velocity_reverse()),
        feed_rate: Some(limits.spec().feed_rate.unwrap_or(limits.velocity_forward())),
        ..limits.spec().clone()
    };
    let before = beyond.len();
    let mut note = |quantity, limit: f64, inevitable: f64| {
        beyond.push(Beyond { axis: axis.axis.clone(), quantity, limit, inevitable });
    };
    if highest > limits.velocity_forward() {
        note(Quantity::Velocity, limits.velocity_forward(), highest);
        spec.max_velocity = highest;
    }
    if lowest < -limits.velocity_reverse() {
        note(Quantity::Velocity, 0.0 - limits.velocity_reverse(), lowest);
        spec.max_velocity_reverse = Some(-lowest);
    }
    if speeding_up > limits.acceleration() {
        note(Quantity::Acceleration, limits.acceleration(), speeding_up);
        spec.max_acceleration = speeding_up;
    }
    if slowing_down > limits.deceleration() {
        note(Quantity::Acceleration, limits.deceleration(), slowing_down);
        spec.max_deceleration = Some(slowing_down);
    }
    if greatest_position > limits.max_position() {
        note(Quantity::Position, limits.max_position(), greatest_position);
        spec.max_position = Some(greatest_position);
    }
    if least_position < limits.min_position() {
        note(Quantity::Position, limits.min_position(), least_position);
        spec.min_position = Some(least_position);
    }
    if beyond.len() > before {
        axis.limits = Limits::try_from(spec)?;
    }
    Ok(())
}

/// How far a motion comes whatever is done.
struct Inevitable {
    lowest: f64,
    highest: f64,
    speeding_up: f64,
    slowing_down: f64,
    least_position: f64,
    greatest_position: f64,
}

impl Inevitable {
    fn of(start: State, limits: &Limits, recovery: Recovery) -> Result<Self, InvalidFields> {
        let State { position, velocity, acceleration } = start;
        let change = 0.5 * acceleration * acceleration.abs() / recovery.jerk;
        let hardest = acceleration.abs();
        let (speeding_up, slowing_down) = if acceleration * velocity >= 0.0 {
            (hardest, 0.0)
        } else {
            (sqrt(largest(0.0, 2.0 * recovery.jerk * (change.abs() - velocity.abs()))), hardest)
        };
        let led_back_by = LimitsSpec {
            max_acceleration: recovery.acceleration,
            max_deceleration: Some(recovery.deceleration),
            max_jerk: recovery.jerk,
            ..limits.scaled(1.0).spec().clone()
        };
        let stop = Leg::to_rest(start, &led_back_by.try_into()?)?.profile;
        let (mut least_position, mut greatest_position) = (position, position);
        for segment in stop.segments() {
            for t in segment.turning_points() {
                let State { position, .. } = segment.at(t).state;
                least_position = least(least_position, position);
                greatest_position = largest(greatest_position, position);
            }
        }
        Ok(Self {
            lowest: least(velocity, velocity + change),
            highest: largest(velocity, velocity + change),
            speeding_up,
            slowing_down,
            least_position,
            greatest_position,
        })
    }
}
