//! From a request to a plan: each axis by its family, then the axes at one time, or on a line, where that is asked for.

use alloc::vec::Vec;

use crate::error::{Field, InvalidFields, Why};
use crate::float::largest;
use crate::request::{AxisMove, AxisProblem, Family, Request, Synchronization};
use crate::solve::{Adjustment, Move, has_to_turn_back, plan_move, plan_trapezoid};
use crate::transfer::is_same_time;
use crate::{
    AxisPlan, AxisTransfer, Classification, CycleTime, Method, NoSuchDuration, Passage, Plan, Problem,
    Profile, State, Timing, Transit, passage, together,
};
use crate::{grid, plan_polynomial, plan_trigonometric};

/// Plans every axis of a request, and the axes together.
///
/// Axes are synchronised in two steps. First each is planned by itself: that settles what its family and its short path make of its
/// goal, and refuses what cannot be. Then those that have time are planned to take as long as the others: of S-curves by
/// [`together`](crate::together()), of the other families, which go from rest to rest, by slowing the whole motion. Who sets the pace keeps the
/// motion, and the name, that it has by itself.
///
/// # Errors
/// Those of [`plan_move`], [`plan_between`](crate::plan_between), [`plan_trapezoid`], [`plan_polynomial`] or
/// [`plan_trigonometric`] for each axis, and of [`together`](crate::together()), all at once, with the axis in the path; more cycles
/// than can be counted.
pub fn plan(request: &Request) -> Result<Plan, InvalidFields> {
    let method = Method {
        family: request.family(),
        order: request.order(),
        short_path: request.short_path(),
        synchronization: request.synchronization(),
        end_on_cycle: request.end_on_cycle(),
        pvt: None,
    };
    let mut invalid = InvalidFields::default();
    let mut axes = Vec::with_capacity(request.axes().len());
    let synchronised = request.axes().len() > 1 && method.synchronization != Synchronization::None;
    // What they last together is on a cycle then, and not what each of them would.
    let alone = Method { end_on_cycle: method.end_on_cycle && !synchronised, ..method };
    for (index, axis) in request.axes().iter().enumerate() {
        let planned = plan_axis(axis, alone, request.cycle_time());
        axes.extend(invalid.take_element("axes", index, planned));
    }
    if !invalid.is_empty() {
        return Err(invalid);
    }
    let longest = axes.iter().map(|axis| axis.profile.duration()).fold(0.0, largest);
    if synchronised || longest < request.minimum_duration() {
        let timing = Timing {
            minimum_duration: request.minimum_duration(),
            end_on: method.end_on_cycle.then_some(request.cycle_time()),
        };
        if method.family == Family::SCurve {
            between_states(&mut axes, method.synchronization, timing)?;
        } else {
            slowed(&mut axes, synchronised, timing)?;
        }
    }
    Plan::new(method, method.promises().to_vec(), request.cycle_time(), axes)
}

/// S-curves at one time, or on a line.
fn between_states(
    axes: &mut [AxisPlan],
    synchronization: Synchronization,
    timing: Timing,
) -> Result<(), InvalidFields> {
    let mut invalid = InvalidFields::default();
    let mut questions = Vec::with_capacity(axes.len());
    for (index, AxisPlan { profile, limits, .. }) in axes.iter().enumerate() {
        let question = AxisTransfer::within_limits(profile.start(), profile.end(), limits);
        let question = question.map_err(|refusal| passage::named(&refusal, limits));
        questions.extend(invalid.take_element("axes", index, question));
    }
    invalid.into_result(())?;
    let mut transits = Vec::with_capacity(questions.len());
    together(&questions, synchronization, timing, &mut transits)?;
    for (axis, transit) in axes.iter_mut().zip(&transits) {
        // On a line it is the line that is fast.
        let keeps = synchronization != Synchronization::Phase
            && is_same_time(axis.profile.duration(), transit.duration());
        if keeps {
            axis.profile = axis.profile.clone().lasting(transit.duration());
        } else {
            axis.profile = transit.to_profile();
            axis.classification = Classification::of_speed(passage::greatest_speed(transit));
        }
    }
    Ok(())
}

/// Motions from rest to rest, as slow as the slowest; of axes that each move by themselves, that one alone as slow as is asked.
fn slowed(axes: &mut [AxisPlan], synchronised: bool, timing: Timing) -> Result<(), InvalidFields> {
    let longest = axes.iter().map(|axis| axis.profile.duration()).fold(0.0, largest);
    let mut lasts = largest(longest, timing.minimum_duration);
    if let Some(cycle_time) = timing.end_on {
        lasts = grid::whole(lasts, cycle_time)?;
    }
    let mut invalid = InvalidFields::default();
    for (index, axis) in axes.iter_mut().enumerate() {
        let alone = axis.profile.duration();
        let concerned = synchronised || alone >= longest;
        if concerned && alone > 0.0 && alone < lasts {
            // A trapezoid from rest begins with an acceleration.
            if axis.profile.start().velocity != 0.0 || axis.profile.end().velocity != 0.0 {
                let what = "a longer duration for a trapezoid from or to a speed";
                let instead = "rest at both ends, or choose S_CURVE";
                invalid.note(
                    Field::element("axes", index).as_str(),
                    Some(Why::NotImplemented { what, instead }),
                );
                continue;
            }
            let factor = lasts / alone;
            axis.profile = axis.profile.slowed(factor).lasting(lasts);
            axis.classification.feed_rate /= factor;
        }
    }
    invalid.into_result(())
}

/// The names of the shape of `axis`, planned again by the method of `plan`; nothing where that gives another motion, of which its names
/// tell nothing.
#[must_use]
pub fn classified_again(plan: &Plan, axis: &AxisPlan) -> Option<Classification> {
    let method = plan.method();
    if method.pvt.is_some() {
        return None;
    }
    let AxisPlan { limits, profile, goal, .. } = axis;
    let start = State { acceleration: 0.0, ..profile.start() };
    let problem = Problem::new(start, *goal, limits.clone(), method.short_path).ok()?;
    let (again, _, classification) = plan_along(&problem, method, plan.cycle_time()).ok()?;
    let near = (again.duration() - profile.duration()).abs() <= crate::LIMIT_TOLERANCE * again.duration();
    let same = near && again.segments().len() == profile.segments().len();
    same.then_some(classification)
}

fn plan_axis(axis: &AxisMove, method: Method, cycle_time: CycleTime) -> Result<AxisPlan, InvalidFields> {
    let AxisMove { axis, kind, problem } = axis;
    let (profile, adjustments, classification) = match problem {
        AxisProblem::Along(problem) => plan_along(problem, method, cycle_time)?,
        AxisProblem::Between(passage) => plan_passage(passage, method.end_on_cycle.then_some(cycle_time))?,
    };
    Ok(AxisPlan {
        axis: axis.clone(),
        kind: *kind,
        limits: problem.limits().clone(),
        profile,
        goal: problem.goal(),
        adjustments,
        classification,
        pvt_regions: Vec::new(),
    })
}

/// A motion, what of it is not as asked, and what its shape is called.
type Planned = (Profile, Vec<Adjustment>, Classification);

fn plan_along(problem: &Problem, method: Method, cycle_time: CycleTime) -> Result<Planned, InvalidFields> {
    let Method { family, order, end_on_cycle, .. } = method;
    let cycle_time = end_on_cycle.then_some(cycle_time);
    let (profile, adjustments, mut classification) = match family {
        Family::Polynomial => {
            let planned = plan_polynomial(problem, order)?;
            (planned.to_profile(), planned.adjustments().to_vec(), planned.classification())
        }
        Family::Trigonometric => laid(&plan_trigonometric(problem)?),
        Family::SCurve if has_to_turn_back(problem) => plan_passage(&Passage::of(problem), cycle_time)?,
        Family::SCurve => match cycle_time {
            Some(cycle_time) if is_from_rest_to_rest(problem) => laid(&grid::plan_move(problem, cycle_time)?),
            Some(cycle_time) => {
                let fastest = plan_move(problem)?;
                let (_, adjustments, _) = laid(&fastest);
                let reached = fastest.to_profile().end();
                let passage = Passage::new(problem.start(), reached, problem.limits().clone())?;
                let (profile, _, classification) = plan_passage(&passage, Some(cycle_time))?;
                (profile, adjustments, classification)
            }
            None => laid(&plan_move(problem)?),
        },
        Family::Trapezoidal => laid(&plan_trapezoid(problem)?),
    };
    // The S-curve ends on a cycle already, and with it each of its pieces.
    let (profile, factor) = match cycle_time.filter(|_| family != Family::SCurve) {
        Some(cycle_time) => grid::slowed(&profile, cycle_time)?,
        None => (profile, 1.0),
    };
    classification.feed_rate /= factor;
    Ok((profile, adjustments, classification))
}

/// From any state to any state, on a whole cycle where there is one.
fn plan_passage(passage: &Passage, end_on: Option<CycleTime>) -> Result<Planned, InvalidFields> {
    let (mut transit, adjustment, mut classification) = passage.plan()?;
    if let Some(cycle_time) = end_on {
        transit = on_cycle(passage, transit.duration(), cycle_time)?;
        classification = Classification::of_speed(passage::greatest_speed(&transit));
    }
    Ok((transit.to_profile(), adjustment.into_iter().collect(), classification))
}

/// In the first whole number of cycles that the way can take.
fn on_cycle(passage: &Passage, fastest: f64, cycle_time: CycleTime) -> Result<Transit, InvalidFields> {
    let limits = passage.limits();
    let named = |refusal: InvalidFields| passage::named(&refusal, limits);
    let question = AxisTransfer::within_limits(passage.start(), passage.goal(), limits).map_err(named)?;
    let mut lasts = grid::whole(fastest, cycle_time)?;
    let mut step = 0.5 * cycle_time.as_seconds();
    loop {
        let border = match question.lasting(lasts) {
            Ok(transit) => return Ok(transit),
            Err(NoSuchDuration::Invalid(refusal)) => return Err(named(refusal)),
            Err(NoSuchDuration::Blocked { before, .. }) if before < f64::INFINITY => before,
            Err(NoSuchDuration::TooShort { least, .. }) => least,
            Err(NoSuchDuration::Blocked { given, after, .. }) => {
                let why = Why::ArrivesEarly { given, greatest: after };
                return Err(InvalidFields::one(Field::default(), why));
            }
            Err(NoSuchDuration::NotFinite { given }) => {
                let why = Why::TooManyCycles { seconds: given };
                return Err(InvalidFields::one(Field::default(), why));
            }
        };
        // A border may be inside by a rounding: then it is the next cycle, or twice as many on, so that it ends.
        let passes = border > lasts;
        lasts = grid::whole(largest(border, lasts + step), cycle_time)?;
        if !passes {
            step *= 2.0;
        }
    }
}

fn is_from_rest_to_rest(problem: &Problem) -> bool {
    problem.start().is_at_rest() && problem.goal().is_at_rest()
}

fn laid(planned: &Move) -> Planned {
    (planned.to_profile(), planned.adjustments().to_vec(), planned.classification())
}
