use super::command::{GentleRamp, Shape};
use crate::State;
use crate::solve::{Move, Piece};

/// Lays the pieces of a shape end to end, from `start` to `reached`: up to the cruise forward from the start, after it
/// backward from the end, so that both are met to the last bit and what rounding there is meets in the middle.
///
/// They are laid into their place, since copying seven of them costs as much as laying two.
#[inline]
pub(super) fn lay(motion: &mut Move, shape: &Shape, start: State, reached: State) {
    motion.begin(reached);
    let Shape { first, cruise, last, cruise_velocity, .. } = *shape;
    let pieces = motion.pieces();
    let mut lay = |duration: f64, origin: f64, from: State, jerk: f64| {
        if duration > 0.0 {
            let state = State { position: origin + from.position, ..from }.with_positive_zeros();
            pieces.push(Piece { duration, start: state, jerk: jerk + 0.0 });
        }
    };
    // A ramp without change is part of the cruise.
    let level = |ramp: &GentleRamp| if ramp.jerk == 0.0 { 2.0 * ramp.jerk_time } else { 0.0 };
    let cruise = level(&first) + cruise + level(&last);
    let ramps = 2.0 * (first.jerk_time + last.jerk_time) + first.hold_time + last.hold_time;
    let cruise = if cruise > ROUNDED_TIME * ramps { cruise } else { 0.0 };

    let mut top = State { position: 0.0, velocity: cruise_velocity, acceleration: 0.0 };
    if first.jerk != 0.0 {
        let GentleRamp { jerk_time, hold_time, jerk } = first;
        let begin = State { position: 0.0, ..start };
        let second = begin.after(jerk, jerk_time);
        let third = second.after(0.0, hold_time);
        lay(jerk_time, start.position, begin, jerk);
        lay(hold_time, start.position, second, 0.0);
        lay(jerk_time, start.position, third, -jerk);
        top.position = third.after(-jerk, jerk_time).position;
    }
    lay(cruise, start.position, top, 0.0);
    if last.jerk != 0.0 {
        let GentleRamp { jerk_time, hold_time, jerk } = last;
        let seventh = State { position: 0.0, ..reached }.after(-jerk, -jerk_time);
        let sixth = seventh.after(0.0, -hold_time);
        let fifth = State {
            velocity: cruise_velocity,
            acceleration: 0.0,
            position: sixth.after(jerk, -jerk_time).position,
        };
        lay(jerk_time, reached.position, fifth, jerk);
        lay(hold_time, reached.position, sixth, 0.0);
        lay(jerk_time, reached.position, seventh, -jerk);
    }
    if let Some(first) = pieces.first_mut() {
        first.start = start;
    }
}

/// Of a duration \[1\]: a cruise of this is what rounding leaves of none.
const ROUNDED_TIME: f64 = 4.0 * f64::EPSILON;
