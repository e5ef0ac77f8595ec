//! From rest to rest, the question that is asked most: the S-curve of `s_curve` where both speeds are zero, in closed form
//! and on a path of its own from the problem to the pieces.
//!
//! Bit for bit what the general way gives (the test below holds it against that): the same sums in the same order, without those
//! that add a speed of zero. What is saved is hardly arithmetic: there is no policy, as no path is too short; both ramps leave
//! rest, so that what comes after the cruise is, seen from the goal, what comes before it, seen from the start; and the comparisons
//! that choose the shape name it, too.

use super::planned::{Move, Piece};
use super::ramp::{self, Ramp};
use super::s_curve::Rise;
use super::signed;
use crate::classify::{AsymmetricType, Classification, EightType, SixCase};
use crate::float::{cbrt, sqrt};
use crate::{Problem, State};

/// The fastest move of a problem whose ends are both at rest. There is always one.
pub(super) fn plan(problem: &Problem) -> Move {
    let (limits, direction) = (problem.limits(), problem.direction());
    let mut planned = Move::of_rectangles_to(problem.goal());
    if let Some(adjustment) = super::feed_rate_above_limit(limits, direction) {
        planned.adjust(adjustment);
    }
    let way = Way {
        length: problem.distance().abs(),
        cruise: limits.cruise_towards(direction),
        acceleration: limits.acceleration(),
        deceleration: limits.deceleration(),
        jerk: limits.jerk(),
    };
    let shape = way.solve();
    shape.lay(&mut planned, problem, direction, way.jerk);
    if !planned.laid().is_empty() {
        planned.classify(way.classify(&shape));
    }
    planned
}

/// What is asked, as magnitudes.
struct Way {
    length: f64,
    cruise: f64,
    acceleration: f64,
    deceleration: f64,
    jerk: f64,
}

struct Shape {
    up: Ramp,
    down: Ramp,
    peak: f64,
    /// What is left of the length for the cruise [axis units]; below zero where the peak is lower.
    spare: f64,
    cruise_time: f64,
}

impl Way {
    #[expect(clippy::float_cmp, reason = "the same number given twice is the same limit")]
    fn is_symmetric(&self) -> bool {
        self.acceleration == self.deceleration
    }

    #[inline]
    fn ramps(&self, rise: Rise) -> (Ramp, Ramp) {
        let up = ramp(rise, self.acceleration, self.jerk);
        let down = if self.is_symmetric() { up } else { ramp(rise, self.deceleration, self.jerk) };
        (up, down)
    }

    #[inline]
    fn solve(&self) -> Shape {
        let room = Rise::to(self.cruise);
        let (up, down) = self.ramps(room);
        let spare = self.length - 0.5 * (self.cruise * up.time() + self.cruise * down.time());
        if spare > 0.0 {
            return Shape { up, down, peak: self.cruise, spare, cruise_time: spare / self.cruise };
        }
        let (high, low) = if self.acceleration > self.deceleration {
            (self.acceleration, self.deceleration)
        } else {
            (self.deceleration, self.acceleration)
        };
        let rise = rise(self.length, self.jerk, high, low);
        let rise = if rise.change > room.change { room } else { rise };
        let (up, down) = self.ramps(rise);
        Shape { up, down, peak: rise.change, spare, cruise_time: 0.0 }
    }

    /// What the papers call it.
    #[inline]
    fn classify(&self, shape: &Shape) -> Classification {
        let Self { length, cruise, acceleration, deceleration, jerk } = *self;
        let (force, cruises) = (shape.peak * jerk, shape.spare > 0.0);
        let (up, down) = (acceleration * acceleration, deceleration * deceleration);
        let mut names = Classification::of_speed(shape.peak);
        // Strictly: at the limit for an instant is not constant.
        names.asymmetric_type = Some(AsymmetricType::of(cruises, force > up, force > down));
        if self.is_symmetric() {
            names.eight_type = Some(EightType::of(cruises, force >= up, force >= up));
            let limits = [cruise, acceleration, jerk];
            names.six_case = Some(SixCase::of_move(shape.spare >= 0.0, length, limits));
        }
        names
    }
}

#[inline]
fn ramp(rise: Rise, limit: f64, jerk: f64) -> Ramp {
    if ramp::reaches(rise.change, limit, jerk) {
        Ramp::ladder(rise.change, limit, jerk)
    } else {
        Ramp::triangle(rise.root, sqrt(jerk))
    }
}

/// The speed from which two ramps cover `length`, without a cruise: every shape in closed form. With `h ≥ l` the limits,
/// `2·s·j²` tells the shapes apart.
///
/// Both triangles: `2·q³ = s·√j`. One of them, the paper's case without an analytic solution: `S` is a square there,
/// `(q·(q + l/√j))²/2l`, so that `q² + q·l/√j = √(2·l·s)`. Both ladders: `u²·(1/h + 1/l)/2 + u·(h + l)/2j = s`.
#[inline]
pub(super) fn rise(length: f64, jerk: f64, high: f64, low: f64) -> Rise {
    let way = 2.0 * length * jerk * jerk;
    let both = high * (high + low);
    let root = if way <= 4.0 * low * low * low {
        cbrt(0.5 * length * sqrt(jerk))
    } else if low * way < both * both {
        let (b, square) = (low / sqrt(jerk), sqrt(2.0 * low * length));
        2.0 * square / (b + sqrt(b * b + 4.0 * square))
    } else {
        let (both, slopes) = (high + low, (high + low) / (high * low));
        let b = 0.5 * both / jerk;
        return Rise::to(2.0 * length / (b + sqrt(b * b + 2.0 * length * slopes)));
    };
    Rise { change: root * root, root }
}

/// Where a ramp from rest is after its first jerk, after its hold, and at its end, as magnitudes from where it began.
#[derive(Clone, Copy)]
struct Climb {
    second: State,
    third: State,
    end: State,
}

impl Climb {
    #[inline]
    fn of(Ramp { jerk_time, hold_time }: Ramp, jerk: f64) -> Self {
        let second = State::at_rest(0.0).after(jerk, jerk_time);
        let third = second.after(0.0, hold_time);
        Self { second, third, end: third.after(-jerk, jerk_time) }
    }
}

impl Shape {
    /// Lays the pieces end to end: up to the cruise from the start, after it as the climb from the goal backward in time, so that both ends are
    /// met to the last bit.
    #[inline]
    fn lay(&self, planned: &mut Move, problem: &Problem, direction: f64, jerk: f64) {
        let Self { up, down, peak, cruise_time, .. } = *self;
        let climb = Climb::of(up, jerk);
        let fall = if up == down { climb } else { Climb::of(down, jerk) };
        let (from, to) = (problem.start().position, problem.goal().position);
        let pieces = planned.pieces();
        // Without a negative zero.
        let at = |origin: f64, position: f64, velocity: f64, acceleration: f64| State {
            position: origin + direction * position,
            velocity: signed(direction, velocity),
            acceleration: signed(direction, acceleration),
        };
        let mut lay = |duration: f64, start: State, jerk: f64| {
            if duration > 0.0 {
                pieces.push(Piece { duration, start, jerk });
            }
        };
        let rising = direction * jerk;
        let Climb { second, third, end } = climb;
        lay(up.jerk_time, problem.start(), rising);
        lay(up.hold_time, at(from, second.position, second.velocity, second.acceleration), 0.0);
        lay(up.jerk_time, at(from, third.position, third.velocity, third.acceleration), -rising);
        lay(cruise_time, at(from, end.position, peak, 0.0), 0.0);
        let Climb { second, third, end } = fall;
        lay(down.jerk_time, at(to, -end.position, end.velocity, 0.0), -rising);
        lay(down.hold_time, at(to, -third.position, third.velocity, -third.acceleration), 0.0);
        lay(down.jerk_time, at(to, -second.position, second.velocity, -second.acceleration), rising);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

    use super::*;
    use crate::{Limits, LimitsSpec, ShortPathPolicy};

    /// A number of about 2^±24, as xorshift gives them.
    fn draw(seed: &mut u64) -> f64 {
        *seed ^= *seed << 13;
        *seed ^= *seed >> 7;
        *seed ^= *seed << 17;
        let exponent = (*seed % 48) as i32 - 24;
        libm::ldexp(1.0 + (*seed >> 12) as f64 / (1u64 << 52) as f64, exponent)
    }

    /// Holds the short way against the general one: pieces, names and all that is said of them, in every shape.
    fn check(limits: LimitsSpec, from: f64, to: f64) {
        let limits = Limits::try_from(limits).unwrap();
        let ends = [from, to].map(State::at_rest);
        let problem = Problem::new(ends[0], ends[1], limits, ShortPathPolicy::Reject).unwrap();
        let general = crate::solve::plan_with_speeds(&problem).unwrap();
        let short = plan(&problem);
        assert_eq!(short, general, "{problem:?}");
        let bits = |planned: &Move| -> alloc::vec::Vec<_> {
            let pieces = planned.laid().iter();
            pieces
                .flat_map(|&Piece { duration, start, jerk }| {
                    [duration, start.position, start.velocity, start.acceleration, jerk].map(f64::to_bits)
                })
                .collect()
        };
        assert_eq!(bits(&short), bits(&general), "{problem:?}");
    }

    #[test]
    fn the_short_way_has_the_bits_of_the_general_one() {
        let mut seed = 0x2545_f491_4f6c_dd1d;
        for round in 0..40_000 {
            let [velocity, acceleration, deceleration, jerk, length, from] =
                core::array::from_fn(|_| draw(&mut seed));
            let limits = LimitsSpec {
                max_velocity: velocity,
                max_acceleration: acceleration,
                max_deceleration: (round % 2 == 0).then_some(deceleration),
                max_jerk: jerk,
                feed_rate: (round % 5 == 0).then(|| draw(&mut seed)),
                ..LimitsSpec::default()
            };
            // At a border between two shapes, every third time.
            let border = [2.0 * acceleration * (acceleration / jerk) * (acceleration / jerk), length];
            let way = border[usize::from(round % 3 > 0)];
            let from = if round % 4 < 2 { 0.0 } else { from };
            check(limits.clone(), from, from + way);
            check(limits.clone(), from, from - way);
            check(limits, from, from);
        }
    }
}
