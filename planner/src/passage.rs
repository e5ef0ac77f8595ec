use arrayvec::ArrayVec;

use crate::error::{Field, InvalidField, InvalidFields, Why};
use crate::problem::{note_not_finite, note_outside_range, too_fast};
use crate::solve::feed_rate_above_limit;
use crate::{Adjustment, Classification, Limits, Problem, State, Transit, plan_between};

/// One axis's question where the moves along the travel do not reach: from any state to any state within `limits`.
///
/// The start may be anywhere inside the range of positions, with any velocity and acceleration: what is beyond a limit is
/// led back first. The goal is inside every limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Passage {
    start: State,
    goal: State,
    limits: Limits,
}

impl Passage {
    /// Asks for the fastest motion from `start` to `goal`.
    ///
    /// # Errors
    /// Every number that is not finite; positions outside the range; of the goal, a velocity or an acceleration beyond its
    /// limit: that of speeding up where it grows the speed, else that of slowing down.
    pub fn new(start: State, goal: State, limits: Limits) -> Result<Self, InvalidFields> {
        let (start, goal) = (start.with_positive_zeros(), goal.with_positive_zeros());
        let mut invalid = InvalidFields::default();
        note_not_finite(&mut invalid, &start, &goal);
        if invalid.is_empty() {
            note_outside_range(&mut invalid, "start", &start, &limits);
            note_outside_range(&mut invalid, "goal", &goal, &limits);
            let mut inner = InvalidFields::default();
            inner.note(
                "velocity",
                too_fast(goal.velocity, &limits).map(|limit| refused(goal.velocity, limit)),
            );
            inner.note(
                "acceleration",
                too_hard(&goal, &limits).map(|limit| refused(goal.acceleration, limit)),
            );
            // A path is spelt only where there is something to say of it.
            if !inner.is_empty() {
                invalid.extend_within(&Field::named("goal"), inner);
            }
        }
        invalid.into_result(Self { start, goal, limits })
    }

    /// The same question as `problem`, whatever it may have to turn back for.
    pub(crate) fn of(problem: &Problem) -> Self {
        Self { start: problem.start(), goal: problem.goal(), limits: problem.limits().clone() }
    }

    /// Where the motion begins.
    #[must_use]
    pub fn start(&self) -> State {
        self.start
    }

    /// Where it ends.
    #[must_use]
    pub fn goal(&self) -> State {
        self.goal
    }

    /// What the axis may do on the way.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The fastest motion, what of it is not as asked, and its greatest speed: no paper names its shape.
    ///
    /// # Errors
    /// Those of [`plan_between`], in the words of the limits.
    pub(crate) fn plan(&self) -> Result<(Transit, Option<Adjustment>, Classification), InvalidFields> {
        let (transit, adjustment) = self.transit()?;
        let speed = Classification::of_speed(greatest_speed(&transit));
        Ok((transit, adjustment, speed))
    }

    /// The same without its greatest speed.
    pub(crate) fn transit(&self) -> Result<(Transit, Option<Adjustment>), InvalidFields> {
        let Self { start, goal, limits } = self;
        let transit = plan_between(*start, *goal, limits).map_err(|refusal| named(&refusal, limits))?;
        let travel = goal.position - start.position;
        Ok((transit, feed_rate_above_limit(limits, travel)))
    }
}

fn refused(given: f64, (allowed, limit): (f64, &'static str)) -> Why {
    Why::GoalOutsideLimits { given, allowed, limit }
}

/// The greatest acceleration in the direction of that of `goal`, signed, and the limit that says so, where it is less. At
/// rest an acceleration is what is left of slowing down.
fn too_hard(goal: &State, limits: &Limits) -> Option<(f64, &'static str)> {
    let State { velocity, acceleration, .. } = *goal;
    let (hardest, limit) = if acceleration * velocity > 0.0 {
        (limits.acceleration(), "limits.max_acceleration")
    } else {
        slowing_down(limits)
    };
    (acceleration.abs() > hardest).then(|| (hardest.copysign(acceleration), limit))
}

fn slowing_down(limits: &Limits) -> (f64, &'static str) {
    let stated = limits.spec().max_deceleration.is_some();
    (limits.deceleration(), if stated { "limits.max_deceleration" } else { "limits.max_acceleration" })
}

/// A refusal that speaks of bounds with signs, in the words of the limits that they came from: where speeding up and slowing
/// down differ, what remains is a goal that only a ramp through zero leads to, which has the lower of both.
pub(crate) fn named(refusal: &InvalidFields, limits: &Limits) -> InvalidFields {
    let lower = if limits.acceleration() <= limits.deceleration() {
        "limits.max_acceleration"
    } else {
        "limits.max_deceleration"
    };
    let mut renamed = InvalidFields::default();
    for InvalidField { field, why } in refusal.as_slice() {
        let mut why = why.clone();
        if let Why::GoalOutsideLimits { limit, .. } = &mut why {
            *limit = match *limit {
                "bounds.min_velocity" => "limits.max_velocity_reverse",
                "bounds.max_velocity" => "limits.max_velocity",
                "bounds.min_acceleration" | "bounds.max_acceleration" => lower,
                other => other,
            };
            if *limit == "limits.max_velocity_reverse" && limits.spec().max_velocity_reverse.is_none() {
                *limit = "limits.max_velocity";
            }
            if *limit == "limits.max_deceleration" && limits.spec().max_deceleration.is_none() {
                *limit = "limits.max_acceleration";
            }
        }
        renamed.push(InvalidField::new(field.clone(), why));
    }
    renamed
}

/// Where the velocity turns, or a piece ends.
pub(crate) fn greatest_speed(transit: &Transit) -> f64 {
    let speeds = transit.segments().into_iter().flat_map(|segment| {
        let speeds: ArrayVec<f64, { crate::MAX_TURNING_POINTS }> =
            segment.turning_points().into_iter().map(|t| segment.at(t).state.velocity.abs()).collect();
        speeds
    });
    speeds.fold(transit.end().velocity.abs(), f64::max)
}
