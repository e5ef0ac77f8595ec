//! Motions that turn, where speeding up and slowing down have limits of their own.
//!
//! A motion that keeps the lower of both limits throughout turns slower than it may: before its velocity is zero it may slow down as hard as
//! slowing down may, and after it speed up as hard as that may. At the turn itself its acceleration does both, and is at most the lower.
//!
//! ```text
//! v │╲                                  a │             slowing down: D
//!   │ ╲                                   │╲          ╭──
//!   │  ╲  turn                            │ ╲_______╱     the turn: min(A, D), or 0
//!   └───╲─────┴──── t                     └─────────┴──── t
//!        ╲    ╱                              speeding up: A
//!         ╲_╱ goal
//! ```
//!
//! The turn is a state of no velocity that parts the motion in two, each with the bounds of one direction of travel. Where it lies is told
//! by one of its sides: as near as the fastest change of velocity *to* it leads, or as far as the fastest change *from* it to the goal's
//! velocity comes from. With the acceleration that it may have at most, a turn loses no time; with none the axis rests there, and can wait
//! as long as it is to. Whether what is laid keeps the limits is for [`keeps`] to say: short ramps need no turn of their own.

use super::fastest::Change;
use super::lead_in::LeadIn;
use super::mapped::{bounds, keeps};
use super::transit::Transit;
use super::{Bounds, NAMES, Scaled, Transfer, is_same_time, transit_of};
use crate::float::{largest, least, sqrt};
use crate::{Limits, State};

/// Turns of a motion: away, to have room for a velocity that it comes in with, and back.
const MOST_TURNS: u32 = 2;

/// A motion that turns.
pub(super) struct Turning {
    first: Transit,
    last: Transit,
}

/// What acceleration a turn has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    /// As much as it may.
    Hard,
    /// None.
    AtRest,
}

impl Turning {
    /// The fastest of those that keep `limits`.
    pub(super) fn fastest(start: State, goal: State, limits: &Limits, turn: Turn) -> Option<Self> {
        Self::of(start, goal, limits, turn, MOST_TURNS)
    }

    /// With `turns` turns at most, of which all but one are hard.
    fn of(start: State, goal: State, limits: &Limits, turn: Turn, turns: u32) -> Option<Self> {
        let hardest = match turn {
            Turn::Hard => hardest(limits),
            Turn::AtRest => 0.0,
        };
        // A part in the other direction, which may have to turn again.
        let onward = |from, to, bounds| {
            let straight = part(from, to, bounds);
            let is_straight = straight.as_ref().is_some_and(|straight| !does_turn(straight));
            let again = (turns > 1 && !is_straight)
                .then(|| Self::of(from, to, limits, Turn::Hard, turns - 1))
                .flatten();
            let again = again.and_then(|again| again.joined(0.0));
            [straight, again].into_iter().flatten().reduce(|one, other| {
                if other.duration() < one.duration() || !keeps(&one, limits) { other } else { one }
            })
        };
        let mut best: Option<Self> = None;
        for towards in [1.0, -1.0] {
            let turn = State { position: start.position, velocity: 0.0, acceleration: towards * hardest };
            let (before, after) = (one_way(limits, -towards), one_way(limits, towards));
            let nearest = goes(start, turn, before).map(|goes| start.position + goes);
            let nearest = nearest.and_then(|position| {
                let turn = State { position, ..turn };
                Some(Self { first: part(start, turn, before)?, last: onward(turn, goal, after)? })
            });
            let farthest = goes(turn, goal, after).map(|goes| goal.position - goes);
            let farthest = farthest.and_then(|position| {
                let turn = State { position, ..turn };
                Some(Self { first: onward(start, turn, before)?, last: part(turn, goal, after)? })
            });
            for turning in [nearest, farthest].into_iter().flatten() {
                let shortest = best.as_ref().map_or(f64::INFINITY, Self::duration);
                if turning.duration() < shortest
                    && turning.joined(0.0).is_some_and(|joined| keeps(&joined, limits))
                {
                    best = Some(turning);
                }
            }
        }
        best
    }

    pub(super) fn duration(&self) -> f64 {
        self.first.duration() + self.last.duration()
    }

    /// As one motion that waits at the turn for so long \[s\]; none where it has too many pieces.
    pub(super) fn joined(&self, wait: f64) -> Option<Transit> {
        Transit::joined(&self.first, wait, &self.last)
    }

    /// As one motion that takes `duration` \[s\], and waits at rest for what is left of it; none where that is too little.
    pub(super) fn lasting(&self, duration: f64) -> Option<Transit> {
        let moves = self.duration();
        if duration < moves && !is_same_time(duration, moves) {
            return None;
        }
        let mut joined = self.joined(largest(0.0, duration - moves))?;
        joined.last(duration);
        Some(joined)
    }
}

/// A motion in one direction, if the numbers have it.
fn part(from: State, to: State, bounds: Bounds) -> Option<Transit> {
    transit_of(&Transfer::new(from, to, bounds).ok()?, &NAMES).ok()
}

/// The acceleration that a turn may have: what both directions allow, from which full jerk leads to no velocity that either forbids.
fn hardest(limits: &Limits) -> f64 {
    let slower = least(limits.cruise_towards(1.0), limits.cruise_towards(-1.0));
    least(least(limits.acceleration(), limits.deceleration()), sqrt(2.0 * limits.jerk() * slower))
}

/// Does the velocity change its sign?
pub(super) fn does_turn(planned: &Transit) -> bool {
    let (mut forward, mut backward) = (false, false);
    for velocity in planned.pieces().iter().map(|piece| piece.start.velocity).chain([planned.end().velocity])
    {
        forward |= velocity > 0.0;
        backward |= velocity < 0.0;
    }
    forward && backward
}

/// What an axis may do that goes one way.
fn one_way(limits: &Limits, towards: f64) -> Bounds {
    let (up, down) = (limits.acceleration(), limits.deceleration());
    if towards < 0.0 { bounds(limits, down, up) } else { bounds(limits, up, down) }
}

/// How far the fastest change of velocity and acceleration goes.
fn goes(from: State, to: State, bounds: Bounds) -> Option<f64> {
    let there = State { position: from.position, ..to };
    let transfer = Transfer::new(from, there, bounds).ok()?;
    let scaled = Scaled::of(&transfer);
    let lead = LeadIn::of(scaled.start, scaled.confines);
    let change = Change::of(scaled.ends_after(&lead), scaled.confines);
    Some((lead.way + change.goes) * (bounds.spec().max_jerk * scaled.unit * scaled.unit * scaled.unit))
}
