//! Axes that go their own ways, each planned anew by itself.

use alloc::vec::Vec;

use super::Refused;
use super::errand::{Errand, UnderWay, closing_begins, state_at, velocity_range};
use super::factor::Override;
use super::leg::{Leg, Turning, adjustments};
use super::prove::{Objection, Proved, prove};
use crate::error::Field;
use crate::float::largest;
use crate::verify::{EndCheck, JoinCheck, Violation};
use crate::{AxisPlan, Classification, Family, InvalidFields, Law, Plan, Profile, Rejection, Segment, State};

/// Of a duration \[1\]: a motion that rests this much later than the fastest stop is one, but for roundings.
pub(super) const AS_FAST: f64 = 1e-9;

/// A splice of axes that go their own ways.
#[derive(Debug)]
pub(super) struct Planned {
    pub(super) proved: Proved,
    /// When the last of the goals that are passed at speed is \[s\]; none where all end at rest.
    pub(super) closes: Option<f64>,
}

/// What becomes of the motion under an errand; none where every axis goes on as it does.
pub(super) fn planned(under_way: &UnderWay<'_>) -> Result<Option<Planned>, Refused> {
    let mut legs = Vec::with_capacity(under_way.aims.len());
    let mut invalid = InvalidFields::default();
    for index in 0..under_way.aims.len() {
        legs.extend(invalid.take(&Field::element("axes", index), leg(under_way, index)));
    }
    let legs: Vec<Option<Leg>> = invalid.into_result(legs)?;
    if legs.iter().all(Option::is_none) {
        return Ok(None);
    }
    let mut ways = Vec::with_capacity(legs.len());
    for (index, leg) in legs.into_iter().enumerate() {
        ways.push(match leg {
            Some(leg) => Way::To(leg),
            None => match rest_of(under_way.plan, &under_way.plan.axes()[index].profile, under_way.at) {
                Some(rest) => Way::On(rest),
                None => Way::To(anew(under_way, index)?),
            },
        });
    }
    loop {
        match laid(under_way, &ways) {
            Err(Objection::Rejected(rejection)) => {
                if !simplify(under_way, &mut ways, &rejection)? {
                    return Err(Objection::Rejected(rejection).into());
                }
            }
            other => return Ok(Some(other?)),
        }
    }
}

/// What one axis does from now on.
enum Way {
    /// What it does already: the rest of its pieces.
    On(Profile),
    To(Leg),
}

/// The way to what an axis is asked for; none where it goes on as it does.
fn leg(under_way: &UnderWay<'_>, index: usize) -> Result<Option<Leg>, InvalidFields> {
    let start = under_way.state(index);
    let aim = &under_way.aims[index];
    match under_way.errand {
        Errand::Rest => {
            let leg = Leg::to_rest(start, &aim.limits.scaled(1.0))?;
            let left = under_way.plan.axes()[index].profile.duration() - under_way.at;
            let stops_already = left <= leg.profile.duration() * (1.0 + AS_FAST);
            Ok((!stops_already).then_some(leg))
        }
        Errand::Goals { kept, .. } if kept[index] => Ok(None),
        Errand::Goals { factor, turning, .. } => to_aim(start, aim, factor, turning),
    }
}

fn to_aim(
    start: State,
    aim: &AxisPlan,
    factor: Override,
    turning: Turning,
) -> Result<Option<Leg>, InvalidFields> {
    let limits = aim.limits.scaled(factor.get());
    Leg::to_goal(start, factor.at_goal(aim.goal, &limits), &limits, turning)
}

/// The way of an axis that goes on as it does, planned from its very state.
fn anew(under_way: &UnderWay<'_>, index: usize) -> Result<Leg, InvalidFields> {
    let (start, aim) = (under_way.state(index), &under_way.aims[index]);
    let rests = || Leg::to_rest(start, &aim.limits.scaled(1.0));
    match under_way.errand {
        Errand::Rest => rests(),
        Errand::Goals { factor, .. } => to_aim(start, aim, factor, Turning::Avoided)?.map_or_else(rests, Ok),
    }
}

/// Takes a simpler way for each axis whose pieces do not join; false where there is none.
///
/// What is left of a motion may be so little that the roundings of the whole are too large for the judge; planned anew from its very state it
/// has none. And next to the borders between shapes the fastest motion may hang on what is below a rounding; by way of rest it does not.
fn simplify(
    under_way: &UnderWay<'_>,
    ways: &mut [Way],
    rejection: &Rejection,
) -> Result<bool, InvalidFields> {
    let mut apart = alloc::vec![false; ways.len()];
    for violation in &rejection.violations {
        let axis = match violation {
            Violation::Join(JoinCheck { axis, .. }) | Violation::End(EndCheck { axis, .. }) => axis,
            Violation::Limit(_) => return Ok(false),
        };
        let Some(index) = under_way.aims.iter().position(|aim| aim.axis == *axis) else { return Ok(false) };
        apart[index] = true;
    }
    for (index, way) in ways.iter_mut().enumerate().filter(|(index, _)| apart[*index]) {
        *way = match (&*way, under_way.errand) {
            (Way::On(_), _) => Way::To(anew(under_way, index)?),
            (Way::To(leg), Errand::Goals { factor, .. }) if !leg.through_rest => {
                let limits = under_way.aims[index].limits.scaled(factor.get());
                Way::To(Leg::through_rest(under_way.state(index), leg.reached, &limits)?)
            }
            (Way::To(_), _) => return Ok(false),
        };
    }
    Ok(true)
}

/// The ways as a plan, which the judge accepts.
fn laid(under_way: &UnderWay<'_>, ways: &[Way]) -> Result<Planned, Objection> {
    let mut axes = Vec::with_capacity(ways.len());
    let (mut arrives, mut closes) = (0.0, false);
    for (index, way) in ways.iter().enumerate() {
        let (now, aim) = (&under_way.plan.axes()[index], &under_way.aims[index]);
        match way {
            Way::On(rest) => {
                // Where its goal is not its aim any more, that is behind it.
                let ahead = now.goal == aim.goal;
                let closing = if ahead { closing_begins(now) } else { None };
                let adjustments = if ahead { now.adjustments.clone() } else { Vec::new() };
                closes |= closing.is_some();
                arrives = largest(arrives, closing.map_or(rest.duration(), |begins| begins - under_way.at));
                axes.push(axis_plan(aim, rest.clone(), aim.goal, adjustments));
            }
            Way::To(leg) => {
                closes |= leg.closing.is_some();
                arrives = largest(arrives, leg.arrives());
                axes.push(towards(under_way, aim, leg));
            }
        }
    }
    let proved = prove(under_way, axes)?;
    Ok(Planned { proved, closes: closes.then_some(arrives) })
}

fn towards(under_way: &UnderWay<'_>, aim: &AxisPlan, leg: &Leg) -> AxisPlan {
    let (profile, end) = (leg.profile.clone(), leg.profile.end());
    match under_way.errand {
        Errand::Rest => axis_plan(aim, profile, end, Vec::new()),
        Errand::Goals { factor, .. } => {
            let scaled = factor.at_goal(aim.goal, &aim.limits.scaled(factor.get()));
            let said = adjustments(&aim.limits, profile.start(), [aim.goal, scaled, leg.reached, end]);
            axis_plan(aim, profile, aim.goal, said)
        }
    }
}

/// An axis with the name, kind and limits of its aim.
pub(super) fn axis_plan(
    aim: &AxisPlan,
    profile: Profile,
    goal: State,
    adjustments: Vec<crate::Adjustment>,
) -> AxisPlan {
    let (lowest, highest) = velocity_range(&profile, 0.0);
    AxisPlan {
        axis: aim.axis.clone(),
        kind: aim.kind,
        limits: aim.limits.clone(),
        profile,
        goal,
        adjustments,
        classification: Classification::of_speed(largest(highest, -lowest)),
        pvt_regions: Vec::new(),
    }
}

/// What is left of a profile from `at` on; none where that is not of constant jerk, or its acceleration may jump.
fn rest_of(plan: &Plan, profile: &Profile, at: f64) -> Option<Profile> {
    if plan.method().family != Family::SCurve {
        return None;
    }
    let mut segments = Vec::new();
    for (begin, segment) in profile.timed_segments() {
        let duration = begin + segment.duration - at;
        if at <= begin {
            segments.push(*segment);
        } else if duration > 0.0 {
            segments.push(Segment { duration, start: state_at(profile, at), law: segment.law });
        }
    }
    let constant = segments.iter().all(|segment| matches!(segment.law, Law::ConstantJerk(_)));
    constant.then(|| Profile::new(segments, profile.end()))
}
