//! The reachable end speed closest to the one asked for, where the path is too short to keep it: one monotone ramp, at
//! the acceleration if it speeds up and at the deceleration if it slows down; `a` is either.
//!
//! Upwards the length of a ramp grows with its end speed, so there is one answer. Downwards it does not: braking from `v`
//! takes longest to an end speed of `v/3` (or `a²/2j` where the acceleration limit is reached), so the speeds that a
//! short path cannot reach are an interval, and the nearest reachable one is at its upper or its lower end.

use super::lane::Lane;
use super::ramp::Ramp;
use super::s_curve::Shape;
use crate::classify::EightType;
use crate::float::{cbrt, largest, least, sqrt};
use crate::roots::fall_to_root;

/// The nearest end speed [axis units/s] and the ramp to it, for a lane that is too short.
pub(super) fn solve(lane: &Lane) -> Shape {
    if lane.end >= lane.start {
        let (change, ramp) = up(lane);
        return Shape::one_ramp(
            EightType::Type8C,
            ramp,
            Ramp::default(),
            lane.start + change,
            lane.start + change,
        );
    }
    let upper = down_upper(lane);
    let lower = down_lower(lane)
        .filter(|lower| (lane.start - lower.0 - lane.end).abs() < (lane.start - upper.0 - lane.end).abs());
    let (change, ramp) = lower.unwrap_or(upper);
    Shape::one_ramp(EightType::Type8C, Ramp::default(), ramp, lane.start, largest(0.0, lane.start - change))
}

/// `nearest`, the end speed \[axis units/s\] that a lane which is too short can reach, as a goal of its own: rounded away from the one asked for, as far as it takes to be
/// accepted. Near the longest ramp the length hardly depends on the end speed, so that a rounding of the one is many of the
/// other.
pub(super) fn acceptable_end(lane: &Lane, nearest: f64, is_too_short: impl Fn(&Lane) -> bool) -> f64 {
    // Towards the start speed, but for the lower end of what cannot be reached, which is left towards rest.
    let bound = if lane.end < lane.start && nearest < lane.end { 0.0 } else { lane.start };
    let mut step = 0.0;
    #[expect(clippy::float_cmp, reason = "it was set to the bound")]
    loop {
        let end = if nearest > bound { largest(bound, nearest - step) } else { least(bound, nearest + step) };
        // At the bound there is always a way.
        if end == bound || !is_too_short(&Lane { end, ..*lane }) {
            return end;
        }
        step = largest(2.0 * step, f64::EPSILON * largest(nearest, bound));
    }
}

/// A change of speed and its ramp.
type Change = (f64, Ramp);

/// Speeding up by `d`: `(v + d/2)·t(d) = length`, which grows with `d`.
fn up(lane: &Lane) -> Change {
    let Lane { start, length, acceleration, jerk, .. } = *lane;
    let (corner, jerk_time) = (acceleration * acceleration / jerk, acceleration / jerk);
    // The ramp over a²/j, without the sum `start + corner`, in which the corner may vanish.
    if length >= (2.0 * start + corner) * jerk_time {
        // Ladder: d²/2a + b·d = r.
        let rest = largest(0.0, length - start * jerk_time);
        let b = start / acceleration + 0.5 * jerk_time;
        let change = 2.0 * rest / (b + sqrt(b * b + 2.0 * rest / acceleration));
        return (change, Ramp::ladder(change, acceleration, jerk));
    }
    // Triangle, with q = √d: q³ + 2v·q = length·√j.
    let root_of_jerk = sqrt(jerk);
    let rest = length * root_of_jerk;
    let bound = least(cbrt(rest), rest / (2.0 * start));
    let root = fall_to_root(bound, |q| (q * (q * q + 2.0 * start) - rest, 3.0 * q * q + 2.0 * start));
    triangle(root, root_of_jerk)
}

/// Slowing down to the upper end of what cannot be reached: the rising branch of the ramp's length.
fn down_upper(lane: &Lane) -> Change {
    let Lane { start, length, deceleration, jerk, .. } = *lane;
    let corner = deceleration * deceleration / jerk;
    let peak_is_ladder = start >= 1.5 * corner;
    if peak_is_ladder && length > (start - 0.5 * corner) * 2.0 * deceleration / jerk {
        let (b, rest, discriminant) = ladder_down(lane);
        let change = 2.0 * rest / (b + sqrt(discriminant));
        return (change, Ramp::ladder(change, deceleration, jerk));
    }
    let (scale, angle) = triangle_down(lane);
    triangle(scale * libm::sin(angle), sqrt(jerk))
}

/// Slowing down to the lower end of what cannot be reached, if there is one: the falling branch.
fn down_lower(lane: &Lane) -> Option<Change> {
    let Lane { start, length, deceleration, jerk, .. } = *lane;
    if length < lane.ramp_length(start, 0.0) {
        return None;
    }
    let corner = deceleration * deceleration / jerk;
    let falls_as_ladder = start > corner
        && (start >= 1.5 * corner || length < (start - 0.5 * corner) * 2.0 * deceleration / jerk);
    if falls_as_ladder {
        let (b, _, discriminant) = ladder_down(lane);
        let change = least(start, deceleration * (b + sqrt(discriminant)));
        return Some((change, Ramp::ladder(change, deceleration, jerk)));
    }
    let (scale, angle) = triangle_down(lane);
    let root = scale * libm::sin(core::f64::consts::FRAC_PI_3 - angle);
    Some(triangle(least(root, sqrt(start)), sqrt(jerk)))
}

/// Ladder: `d²/2a − b·d + r = 0`; gives `b`, `r` and `b² − 2r/a`.
fn ladder_down(lane: &Lane) -> (f64, f64, f64) {
    let Lane { start, length, deceleration, jerk, .. } = *lane;
    let jerk_time = deceleration / jerk;
    let b = start / deceleration - 0.5 * jerk_time;
    let rest = length - start * jerk_time;
    (b, rest, largest(0.0, b * b - 2.0 * rest / deceleration))
}

/// Triangle, with `q = √d`: `2v·q − q³ = length·√j`, whose roots in reach are `scale·sin(angle)` and
/// `scale·sin(π/3 − angle)`.
fn triangle_down(lane: &Lane) -> (f64, f64) {
    let p = 2.0 * lane.start;
    let third = sqrt(p / 3.0);
    let sine = 1.5 * lane.length * sqrt(lane.jerk) / (p * third);
    (2.0 * third, libm::asin(least(1.0, sine)) / 3.0)
}

fn triangle(root: f64, root_of_jerk: f64) -> Change {
    (root * root, Ramp::triangle(root, root_of_jerk))
}
