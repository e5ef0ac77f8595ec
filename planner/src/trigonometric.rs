//! The S-curve whose rectangles of jerk are raised cosines, from rest to rest: Nguyen, Ng and Chen (2008), section 5.
//!
//! The mean jerk of a pulse is half its peak, and each pulse is even about its middle. So durations, peaks and distance are
//! exactly those of the third-order profile with half the jerk limit, in all its shapes
//! (`notes/0006-n-th-order-and-trigonometric.md`).

use core::f64::consts::TAU;

use arrayvec::ArrayVec;

use crate::classify::{Classification, SixCase};
use crate::error::InvalidFields;
use crate::float::{cbrt, least, sqrt};
use crate::polynomial::note_motion;
use crate::solve::{MAX_PIECES, Move, Piece, feed_rate_above_limit};
use crate::{Problem, State};

/// The move from rest to rest whose jerk is made of raised cosines, and never jumps.
///
/// ```text
/// jerk │  ╭╮                      ╭╮
///      │ ╱  ╲___  _________  ___╱  ╲       pulse, hold, pulse, cruise, pulse, hold, pulse
///      │        ╲╱         ╲╱
/// ```
/// Each pulse, of length `d` \[s\] and peak `J` \[axis units/s³\], is `j(t) = J/2·(1 − cos(2πt/d))`. Its mean is `J/2`, so durations are those
/// of the S-curve with half the jerk limit.
///
/// Source: Nguyen, Ng and Chen (2008), section 5; their appendix has misprints that `notes/0006-n-th-order-and-trigonometric.md` lists.
///
/// The fastest of its shape. Where all limits are reached it takes `s/v + v/a + 2a/j`: `a/j` longer than the S-curve.
///
/// The shape treats speeding up and slowing down alike: where the limits differ, it keeps to the smaller one for both.
///
/// ```
/// use planner::{Limits, Problem, ShortPathPolicy, State, plan_trigonometric};
///
/// let limits = Limits::symmetric(60.0, 600.0, 12e3)?;
/// let problem = Problem::new(State::at_rest(0.0), State::at_rest(50.0), limits, ShortPathPolicy::Reject)?;
/// let planned = plan_trigonometric(&problem)?;
/// assert!((planned.duration() - 1.033_333_333_333_333_3).abs() < 1e-15);
/// # Ok::<(), planner::InvalidFields>(())
/// ```
///
/// # Errors
/// [`Why::NotAtRest`](crate::Why::NotAtRest) for a start or a goal in motion.
pub fn plan_trigonometric(problem: &Problem) -> Result<Move, InvalidFields> {
    let (start, goal, limits) = (problem.start(), problem.goal(), problem.limits());
    if !(start.is_at_rest() && goal.is_at_rest()) {
        let mut invalid = InvalidFields::default();
        note_motion(&mut invalid, "TRIGONOMETRIC", [("start", &start), ("goal", &goal)]);
        return Err(invalid);
    }
    let direction = problem.direction();
    let peak = limits.jerk();
    let mut planned = Move::of_cosines(goal, feed_rate_above_limit(limits, direction));
    let distance = problem.distance().abs();
    if distance > 0.0 {
        let acceleration = least(limits.acceleration(), limits.deceleration());
        let bounds = [limits.cruise_towards(direction), acceleration, 0.5 * peak];
        let (times, reaches_cruise) = Times::of(distance, bounds);
        let feed_rate = 0.5 * peak * times.pulse * (times.pulse + times.hold);
        let six_case = Some(SixCase::of_move(reaches_cruise, distance, bounds));
        planned.classify(Classification { six_case, ..Classification::of_speed(feed_rate) });
        lay(planned.pieces(), &times, start.position, goal.position, direction * peak);
    }
    Ok(planned)
}

/// Of the length of time before it \[1\]: a hold or a cruise shorter than this is rounding, where there is none.
///
/// Where the exact length is zero, in units `u = ε/2` of what one operation rounds, to the first order: the pulse is `a/j`, good to u, or
/// `√(v/j)`, to 3/2·u. The rate `j·pulse` is off as the pulse is, and by u.
///
/// - *A hold* where the velocity is just reached, `v/rate − pulse`: the pulse counts twice, the product and the quotient once each: 5 u.
///   Where the distance is, `2·area/(pulse + √(pulse² + 4·area)) − pulse` with `area = distance/rate`: the pulse counts twice, what else is
///   wrong with the area 2/3, and the five operations that follow make 19/6 u: 7.5 u.
/// - *A cruise*, `area/ramp − (pulse + ramp)`. With `ramp = v/rate` the rate falls out of the quotient, 3 u, and the sum has 4 u. With a ramp of
///   one pulse of `√(v/j)` the pulse counts three times, and four operations once each: 8.5 u.
///
/// So 8.5 u = 4.25 ε. The rest is margin: it is 2 ε for each of the three lengths, as in the recursion of order n.
const SNAP: f64 = 3.0 * crate::polynomial::SNAP;

/// How long a pulse lasts, how long the acceleration is held, how long the velocity \[s\].
#[derive(Clone, Copy, Debug)]
struct Times {
    pulse: f64,
    hold: f64,
    cruise: f64,
}

impl Times {
    /// The third-order profile from rest to rest within the limits of velocity, acceleration and mean jerk: Blejan and Blejan
    /// (2020) without their six cases; and whether the path takes the velocity. The first length is the least that a limit or
    /// the distance allows, the second the least beyond that, and the third is left.
    fn of(distance: f64, [velocity, acceleration, jerk]: [f64; 3]) -> (Self, bool) {
        let mut pulse = acceleration / jerk;
        let velocity_is_low = jerk * pulse * pulse >= velocity;
        if velocity_is_low {
            pulse = sqrt(velocity / jerk);
        }
        let two_ramps = 2.0 * jerk * pulse * pulse * pulse;
        if two_ramps >= distance {
            let pulse = cbrt(0.5 * distance / jerk);
            return (Self { pulse, hold: 0.0, cruise: 0.0 }, velocity_is_low && two_ramps <= distance);
        }
        let rate = jerk * pulse;
        let area = distance / rate;
        let reach = velocity / rate;
        // Cruises, or comes to the distance first: `ramp·(pulse + ramp) = area`.
        if reach * (pulse + reach) <= area {
            let hold = beyond(pulse, reach);
            let ramp = pulse + hold;
            return (Self { pulse, hold, cruise: beyond(pulse + ramp, area / ramp) }, true);
        }
        let ramp = 2.0 * area / (pulse + sqrt(pulse * pulse + 4.0 * area));
        (Self { pulse, hold: beyond(pulse, ramp), cruise: 0.0 }, false)
    }
}

/// How much longer than `before` a length is; zero where that is no more than [`SNAP`] of it.
fn beyond(before: f64, length: f64) -> f64 {
    let rest = length - before;
    if rest > SNAP * before { rest } else { 0.0 }
}

/// Lays the pieces end to end, those after the cruise as the mirror image of those before it, from the goal.
fn lay(pieces: &mut ArrayVec<Piece, MAX_PIECES>, times: &Times, from: f64, to: f64, peak: f64) {
    let Times { pulse, hold, cruise } = *times;
    let half = 0.5 * peak;
    // What one pulse from rest gains, and what the second one loses of that: its middle is a centre of symmetry.
    let acceleration = half * pulse;
    let rise = 0.5 * acceleration * pulse;
    let rest = 1.0 / 6.0 - 1.0 / (TAU * TAU);
    let way = acceleration * pulse * pulse * rest;
    let second = State { position: way, velocity: rise, acceleration };
    let third = second.after(0.0, hold);
    let top = acceleration * (pulse + hold);
    let end = third.position + pulse * (third.velocity + pulse * acceleration * 0.5) - way;

    let mut lay = |duration: f64, position: f64, velocity: f64, acceleration: f64, jerk: f64| {
        if duration > 0.0 {
            let acceleration = acceleration + 0.0;
            pieces.push(Piece { duration, start: State { position, velocity, acceleration }, jerk });
        }
    };
    let (up, down, still) = (peak, -peak, 0.0);
    lay(pulse, from, 0.0, 0.0, up);
    lay(hold, from + second.position, second.velocity, acceleration, still);
    lay(pulse, from + third.position, third.velocity, acceleration, down);
    lay(cruise, from + end, top, 0.0, still);
    lay(pulse, to - end, top, 0.0, down);
    lay(hold, to - third.position, third.velocity, -acceleration, still);
    lay(pulse, to - second.position, second.velocity, -acceleration, up);
}
