use arrayvec::ArrayVec;

use super::lane::Lane;
use super::planned::{MAX_PIECES, Piece};
use super::ramp::Ramp;
use super::s_curve::Shape;
use super::signed;
use super::trapezoid::Trapezoid;
use crate::State;

/// Lays the pieces of a shape end to end, from `start` to `reached`, with a jerk for either ramp.
///
/// Up to the cruise they are laid forward from the start, after it backward from the end, each relative to its own end:
/// both ends are met to the last bit, and what rounding there is meets in the middle; or, where there is nothing before the
/// cruise, at the end of the first piece.
///
/// They are laid into their place, since copying seven of them costs as much as laying two.
pub(super) fn lay(
    pieces: &mut ArrayVec<Piece, MAX_PIECES>,
    shape: &Shape,
    start: State,
    reached: State,
    direction: f64,
    [jerk, down_jerk]: [f64; 2],
) {
    let Shape { up, cruise, down, peak, .. } = *shape;
    let jerk = direction * jerk;
    let mut lay = |duration: f64, origin: f64, from: State, jerk: f64| {
        if duration > 0.0 {
            let position = origin + from.position;
            let start = State { position, ..from };
            pieces.push(Piece { duration, start, jerk: jerk + 0.0 });
        }
    };

    let Ramp { jerk_time, hold_time } = up;
    let first = State { position: 0.0, ..start };
    let second = first.after(jerk, jerk_time);
    let third = second.after(0.0, hold_time);
    lay(jerk_time, start.position, first, jerk);
    lay(hold_time, start.position, second, 0.0);
    lay(jerk_time, start.position, third, -jerk);

    let top = State {
        position: third.after(-jerk, jerk_time).position,
        velocity: signed(direction, peak),
        acceleration: 0.0,
    };
    lay(cruise, start.position, top, 0.0);

    let Ramp { jerk_time, hold_time } = down;
    let jerk = direction * down_jerk;
    let seventh = State { position: 0.0, ..reached }.after(jerk, -jerk_time);
    let sixth = seventh.after(0.0, -hold_time);
    let fifth = State { acceleration: 0.0, ..sixth.after(-jerk, -jerk_time) };
    lay(jerk_time, reached.position, fifth, -jerk);
    lay(hold_time, reached.position, sixth, 0.0);
    lay(jerk_time, reached.position, seventh, jerk);
    if let Some(first) = pieces.first_mut() {
        first.start = start;
    }
}

/// Lays the pieces of a trapezoid in the same way. Its first piece begins with the acceleration that it has.
pub(super) fn lay_trapezoid(
    pieces: &mut ArrayVec<Piece, MAX_PIECES>,
    shape: &Trapezoid,
    start: State,
    reached: State,
    direction: f64,
    lane: &Lane,
) {
    let Trapezoid { up, cruise, down, peak, .. } = *shape;
    let mut lay = |duration: f64, origin: f64, from: State| {
        if duration > 0.0 {
            let start = State { position: origin + from.position, ..from };
            pieces.push(Piece { duration, start, jerk: 0.0 });
        }
    };
    let first =
        State { position: 0.0, velocity: start.velocity, acceleration: direction * lane.acceleration };
    lay(up, start.position, first);
    let top = State {
        position: first.after(0.0, up).position,
        velocity: signed(direction, peak),
        acceleration: 0.0,
    };
    lay(cruise, start.position, top);
    let last =
        State { position: 0.0, velocity: reached.velocity, acceleration: -direction * lane.deceleration };
    lay(down, reached.position, last.after(0.0, -down));
    if let Some(first) = pieces.first_mut() {
        first.start = State { acceleration: first.start.acceleration, ..start };
    }
}
