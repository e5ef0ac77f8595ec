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
use crate::{
    AxisPlan, Classification, Family, InvalidFields, Law, Plan, Profile, Quantity, Rejection, Segment, State,
};

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
    let mut manners = alloc::vec![Manner::Plain; under_way.aims.len()];
    loop {
        let legs = legs(under_way, &manners)?;
        if legs.iter().all(Option::is_none) {
            return Ok(None);
        }
        match laid(under_way, legs) {
            Err(Objection::Rejected(rejection)) => {
                if !simplify(under_way, &mut manners, &rejection) {
                    return Err(Objection::Rejected(rejection).into());
                }
            }
            other => return Ok(Some(other?)),
        }
    }
}

/// The way to rest of each axis, also where that is what it does already; each ends where it comes to rest.
pub(super) fn to_rest(under_way: &UnderWay<'_>) -> Result<Proved, Refused> {
    let mut manners = alloc::vec![Manner::Plain; under_way.aims.len()];
    loop {
        let mut profiles = Vec::with_capacity(manners.len());
        for (index, leg) in legs(under_way, &manners)?.into_iter().enumerate() {
            let rest = match leg {
                Some(leg) => Some(leg.profile),
                None => rest_of(under_way.plan, &under_way.plan.axes()[index].profile, under_way.at),
            };
            profiles.push(rest.map_or_else(|| anew(under_way, index).map(|leg| leg.profile), Ok)?);
        }
        match prove(under_way, resting(under_way.aims, profiles)) {
            Err(Objection::Rejected(rejection)) => {
                if !simplify(under_way, &mut manners, &rejection) {
                    return Err(Objection::Rejected(rejection).into());
                }
            }
            other => return Ok(other?),
        }
    }
}

/// Axes that go ways to rest, and ask for nothing else.
pub(super) fn resting(aims: &[AxisPlan], profiles: Vec<Profile>) -> Vec<AxisPlan> {
    let axes = aims.iter().zip(profiles);
    axes.map(|(aim, profile)| {
        let end = profile.end();
        axis_plan(aim, profile, end, Vec::new())
    })
    .collect()
}

/// How the way of one axis is found.
///
/// What is left of a motion may be so little that the roundings of the whole are too large for the judge; planned anew from its very state it
/// has none. And next to the borders between shapes the fastest motion may hang on what is below a rounding; by way of rest it does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Manner {
    Plain,
    Anew,
    ThroughRest,
}

/// Takes a simpler manner for each axis whose pieces do not join; false where there is none.
fn simplify(under_way: &UnderWay<'_>, manners: &mut [Manner], rejection: &Rejection) -> bool {
    let goes = matches!(under_way.errand, Errand::Goals { .. });
    for (aim, manner) in under_way.aims.iter().zip(manners) {
        let apart = rejection.violations.iter().any(|violation| match violation {
            Violation::Join(JoinCheck { axis, .. }) | Violation::End(EndCheck { axis, .. }) => {
                **axis == *aim.axis
            }
            Violation::Limit(_) => false,
        });
        *manner = match *manner {
            other if !apart => other,
            Manner::Plain => Manner::Anew,
            Manner::Anew if goes => Manner::ThroughRest,
            Manner::Anew | Manner::ThroughRest => return false,
        };
    }
    !rejection.violations.iter().any(|violation| matches!(violation, Violation::Limit(_)))
}

/// The way of each axis; none where it goes on as it does.
fn legs(under_way: &UnderWay<'_>, manners: &[Manner]) -> Result<Vec<Option<Leg>>, InvalidFields> {
    let mut invalid = InvalidFields::default();
    let mut legs = Vec::with_capacity(manners.len());
    for (index, &manner) in manners.iter().enumerate() {
        match leg(under_way, index, manner) {
            Ok(leg) => legs.push(leg),
            Err(inner) => invalid.extend_within(&Field::element("axes", index), inner),
        }
    }
    invalid.into_result(legs)
}

fn leg(under_way: &UnderWay<'_>, index: usize, manner: Manner) -> Result<Option<Leg>, InvalidFields> {
    let start = under_way.state(index);
    let aim = &under_way.aims[index];
    let leg = match under_way.errand {
        Errand::Rest => {
            let leg = Leg::to_rest(start, &aim.limits.scaled(1.0))?;
            let left = under_way.plan.axes()[index].profile.duration() - under_way.at;
            let stops_already = left <= leg.profile.duration() * (1.0 + AS_FAST);
            if stops_already { None } else { Some(leg) }
        }
        Errand::Goals { kept, .. } if kept[index] => None,
        Errand::Goals { factor, turning, .. } => to_aim(start, aim, factor, turning)?,
    };
    let leg = match manner {
        Manner::Plain => return Ok(leg),
        Manner::Anew | Manner::ThroughRest => leg.map_or_else(|| anew(under_way, index), Ok)?,
    };
    match under_way.errand {
        Errand::Goals { factor, .. } if manner == Manner::ThroughRest => {
            let limits = aim.limits.scaled(factor.get());
            Leg::through_rest(start, factor.at_goal(aim.goal, &limits), &limits).map(Some)
        }
        Errand::Goals { .. } | Errand::Rest => Ok(Some(leg)),
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

/// The ways as a plan, which the judge accepts. What goes on as it does is cut off, or planned anew where it cannot be.
fn laid(under_way: &UnderWay<'_>, legs: Vec<Option<Leg>>) -> Result<Planned, Objection> {
    let mut axes = Vec::with_capacity(legs.len());
    let (mut arrives, mut closes) = (0.0, false);
    for (index, leg) in legs.into_iter().enumerate() {
        let (now, aim) = (&under_way.plan.axes()[index], &under_way.aims[index]);
        let rest = match leg {
            Some(_) => None,
            None => rest_of(under_way.plan, &now.profile, under_way.at),
        };
        if let Some(rest) = rest {
            // Where its goal is not its aim any more, that is behind it.
            let ahead = now.goal == aim.goal;
            let closing = if ahead { closing_begins(now) } else { None };
            let adjustments = if ahead { now.adjustments.clone() } else { Vec::new() };
            closes |= closing.is_some();
            arrives = largest(arrives, closing.map_or(rest.duration(), |begins| begins - under_way.at));
            axes.push(axis_plan(aim, rest, aim.goal, adjustments));
        } else {
            let leg = leg.map_or_else(|| anew(under_way, index), Ok)?;
            closes |= leg.closing.is_some();
            arrives = largest(arrives, leg.arrives());
            axes.push(towards(under_way, aim, leg));
        }
    }
    let proved = prove(under_way, axes)?;
    Ok(Planned { proved, closes: closes.then_some(arrives) })
}

fn towards(under_way: &UnderWay<'_>, aim: &AxisPlan, leg: Leg) -> AxisPlan {
    let Leg { profile, reached, .. } = leg;
    let end = profile.end();
    match under_way.errand {
        Errand::Rest => axis_plan(aim, profile, end, Vec::new()),
        Errand::Goals { factor, .. } => {
            let scaled = factor.at_goal(aim.goal, &aim.limits.scaled(factor.get()));
            let said = adjustments(&aim.limits, profile.start(), [aim.goal, scaled, reached, end]);
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

/// What is left of a profile from `at` on; none where that is not of constant jerk, its acceleration may jump, or it keeps no limits.
fn rest_of(plan: &Plan, profile: &Profile, at: f64) -> Option<Profile> {
    if plan.method().family != Family::SCurve || !plan.guarantees(Quantity::Acceleration) {
        return None;
    }
    let mut segments = Vec::new();
    for (begin, segment) in profile.timed_segments() {
        let duration = begin + segment.duration - at;
        if at <= begin {
            segments.push(segment);
        } else if duration > 0.0 {
            segments.push(Segment { duration, start: state_at(profile, at), law: segment.law });
        }
    }
    let constant = segments.iter().all(|segment| matches!(segment.law, Law::ConstantJerk(_)));
    constant.then(|| Profile::new(segments, profile.end()))
}
