use crate::error::{Field, InvalidField, InvalidFields, Why};
use crate::limits::not_finite;
use crate::{Limits, ShortPathPolicy, State};

/// One axis's question: from `start` to `goal` within `limits`, each checked against the others.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    start: State,
    goal: State,
    limits: Limits,
    short_path: ShortPathPolicy,
}

impl Problem {
    /// Asks for the move from `start` to `goal`. Velocities may be up to the cruise speed and point along the travel;
    /// accelerations are zero at both ends. Positions stay within ±1e60, as all numbers do.
    ///
    /// # Errors
    /// Every field of `start` and `goal` that is not finite or not within `limits`, and what only a general solver can
    /// do: velocities against the travel, accelerations at the ends.
    pub fn new(
        start: State,
        goal: State,
        limits: Limits,
        short_path: ShortPathPolicy,
    ) -> Result<Self, InvalidFields> {
        let (start, goal) = (start.with_positive_zeros(), goal.with_positive_zeros());
        let mut invalid = InvalidFields::default();
        note_not_finite(&mut invalid, &start, &goal);
        if invalid.is_empty() {
            within_limits(&mut invalid, "start", &start, &limits);
            within_limits(&mut invalid, "goal", &goal, &limits);
        }
        if invalid.is_empty() {
            passable(&mut invalid, &start, &goal, &limits);
        }
        invalid.into_result(Self { start, goal, limits, short_path })
    }

    /// Where the motion begins.
    #[must_use]
    pub fn start(&self) -> State {
        self.start
    }

    /// Where it is asked to end.
    #[must_use]
    pub fn goal(&self) -> State {
        self.goal
    }

    /// What the axis may do on the way.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// What to give up when the path is too short.
    #[must_use]
    pub fn short_path(&self) -> ShortPathPolicy {
        self.short_path
    }

    /// The distance to go [axis units], signed.
    #[must_use]
    pub fn distance(&self) -> f64 {
        self.goal.position - self.start.position
    }

    /// 1 where the travel is towards larger positions, −1 where it is towards smaller ones.
    #[must_use]
    pub fn direction(&self) -> f64 {
        direction(&self.start, &self.goal)
    }
}

/// The sign of the travel: of the distance, or where there is none, of whichever velocity there is.
fn direction(start: &State, goal: &State) -> f64 {
    let backward = [goal.position - start.position, start.velocity, goal.velocity]
        .into_iter()
        .find(|&sign| sign != 0.0)
        .is_some_and(|sign| sign < 0.0);
    if backward { -1.0 } else { 1.0 }
}

/// Is this a move along its travel, from inside the limits: without acceleration at the ends, and with no velocity against
/// the travel or, at the start, beyond its limit? What it asks of the goal's velocity is for [`Problem::new`] to say.
pub(crate) fn is_along_travel(start: &State, goal: &State, limits: &Limits) -> bool {
    let direction = direction(start, goal);
    start.acceleration == 0.0
        && goal.acceleration == 0.0
        && start.velocity * direction >= 0.0
        && goal.velocity * direction >= 0.0
        && too_fast(start.velocity, limits).is_none()
}

/// Reports every number of both ends that is not finite.
pub(crate) fn note_not_finite(invalid: &mut InvalidFields, start: &State, goal: &State) {
    finite(invalid, "start", start);
    finite(invalid, "goal", goal);
}

fn finite(invalid: &mut InvalidFields, name: &str, state: &State) {
    let mut inner = InvalidFields::default();
    inner.note("position", not_finite(state.position));
    inner.note("velocity", not_finite(state.velocity));
    inner.note("acceleration", not_finite(state.acceleration));
    // A path is spelt only where there is something to say of it.
    if !inner.is_empty() {
        invalid.extend_within(&Field::named(name), inner);
    }
}

/// Which of the two ends a refusal is about.
fn outside(end: &str, given: f64, allowed: f64, limit: &'static str) -> Why {
    match end {
        "start" => Why::StartOutsideLimits { given, allowed, limit },
        _ => Why::GoalOutsideLimits { given, allowed, limit },
    }
}

/// The fastest that is allowed in the direction of `velocity`, signed, and the limit that says so, where it is less.
pub(crate) fn too_fast(velocity: f64, limits: &Limits) -> Option<(f64, &'static str)> {
    let fastest = limits.velocity_towards(velocity);
    let cruise = limits.cruise_towards(velocity);
    if velocity.abs() > fastest {
        let backward = velocity < 0.0 && limits.spec().max_velocity_reverse.is_some();
        let limit = if backward { "limits.max_velocity_reverse" } else { "limits.max_velocity" };
        Some((fastest.copysign(velocity), limit))
    } else {
        (velocity.abs() > cruise).then(|| (cruise.copysign(velocity), "limits.feed_rate"))
    }
}

/// Reports a position of `end` that is outside the range.
pub(crate) fn note_outside_range(invalid: &mut InvalidFields, end: &str, state: &State, limits: &Limits) {
    let State { position, .. } = *state;
    let clamped = position.max(limits.min_position()).min(limits.max_position());
    let limit = if position < clamped {
        "limits.min_position"
    } else if position > clamped {
        "limits.max_position"
    } else {
        return;
    };
    let field = Field::named("position").within(&Field::named(end));
    invalid.push(InvalidField::new(field, outside(end, position, clamped, limit)));
}

pub(crate) fn within_limits(invalid: &mut InvalidFields, end: &str, state: &State, limits: &Limits) {
    note_outside_range(invalid, end, state, limits);
    let mut inner = InvalidFields::default();
    let State { velocity, acceleration, .. } = *state;
    let too_fast = too_fast(velocity, limits);
    inner.note("velocity", too_fast.map(|(allowed, limit)| outside(end, velocity, allowed, limit)));
    if acceleration != 0.0 {
        let instead = "begin and end with an acceleration of zero, or ask for a move of family S_CURVE";
        let what = "an acceleration at the start or the goal";
        inner.note("acceleration", Some(Why::NotImplemented { what, instead }));
    }
    if !inner.is_empty() {
        invalid.extend_within(&Field::named(end), inner);
    }
}

/// Is there a way in the direction of travel, for the solver that there is?
fn passable(invalid: &mut InvalidFields, start: &State, goal: &State, limits: &Limits) {
    let direction = direction(start, goal);
    for (end, state) in [("start.velocity", start), ("goal.velocity", goal)] {
        if state.velocity * direction < 0.0 {
            let what = "a velocity against the direction of travel";
            let instead =
                "begin and end with velocities that point from the start to the goal, or choose S_CURVE";
            invalid.note(end, Some(Why::NotImplemented { what, instead }));
        }
    }
    let distance = goal.position - start.position;
    if distance != 0.0 && limits.velocity_towards(direction) == 0.0 {
        let (given, allowed) = (goal.position, start.position);
        let limit = "limits.max_velocity_reverse";
        invalid.note("goal.position", Some(Why::GoalOutsideLimits { given, allowed, limit }));
    }
}
