//! Goals that speed up, or slow down, harder than the lower of both limits of acceleration lets.
//!
//! A ramp that goes through zero keeps to the lower limit, and so none leads to such a goal from the other direction. By way of rest two
//! motions do, of which the second never turns:
//!
//! ```text
//! v │                    ╱ goal: accelerates by more than slowing down may
//!   │                  ╱
//!   │╲     ╭──╮     ╭╴
//!   └─╲───╱────╲─┴──── t      the first comes to rest from where the second, the fastest change of velocity
//!      ╲_╱       rest         from rest to the goal's, leads to the goal
//! ```
//! Not the fastest that there is: that would go through zero at the lower limit. But it is one, and at rest it can wait as long as it is to.

use super::fastest::Change;
use super::lead_in::LeadIn;
use super::mapped::{bounds, keeps, lower_bounds};
use super::transit::Transit;
use super::{NAMES, Scaled, Transfer, is_same_time, transit_of};
use crate::float::{largest, least};
use crate::{Limits, State};

/// Is there no motion to the goal under the lower of both limits of acceleration?
pub(super) fn is_too_hard(goal: &State, limits: &Limits) -> bool {
    goal.acceleration.abs() > least(limits.acceleration(), limits.deceleration())
}

/// The motion by way of rest, which waits there so that it lasts `duration` \[s\], where that is given; none where it takes longer, or
/// there is none.
pub(super) fn motion(start: State, goal: State, limits: &Limits, duration: Option<f64>) -> Option<Transit> {
    let (up, down) = (limits.acceleration(), limits.deceleration());
    // With no velocity it comes from where its acceleration leads away from.
    let towards = if goal.velocity == 0.0 { -goal.acceleration } else { goal.velocity };
    let bounds = if towards < 0.0 { bounds(limits, down, up) } else { bounds(limits, up, down) };
    let from_rest = |position: f64| Transfer::new(State::at_rest(position), goal, bounds).ok();

    let there = from_rest(goal.position)?;
    let scaled = Scaled::of(&there);
    let change = Change::of(scaled.ends_after(&LeadIn::of(scaled.start, scaled.confines)), scaled.confines);
    let length = bounds.spec().max_jerk * scaled.unit * scaled.unit * scaled.unit;
    let turn = State::at_rest(goal.position - change.goes * length);

    let last = transit_of(&from_rest(turn.position)?, &NAMES).ok().filter(|last| keeps(last, limits))?;
    let first = transit_of(&Transfer::new(start, turn, lower_bounds(limits)).ok()?, &NAMES).ok()?;
    let moves = first.duration() + last.duration();
    let Some(duration) = duration else { return Transit::joined(&first, 0.0, &last) };
    if duration < moves && !is_same_time(duration, moves) {
        return None;
    }
    let mut joined = Transit::joined(&first, largest(0.0, duration - moves), &last)?;
    joined.last(duration);
    Some(joined)
}
