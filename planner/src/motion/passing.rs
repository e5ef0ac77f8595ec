//! A goal at speed that is too near for the velocity at which it is to be passed.

use arrayvec::ArrayVec;

use crate::float::{largest, least, sqrt};
use crate::roots::sign_change;
use crate::{Law, Limits, Profile, Segment, State};

/// Units in the last place of the positions: a goal this far beyond the end of a motion is its end.
const POSITION_ULPS: f64 = 4.0;

/// How a goal can be passed without turning back.
#[derive(Debug)]
pub(super) enum Passing {
    /// At its own velocity.
    AsAsked,
    /// That is too near: at the nearest velocity to it, by this motion, which has no acceleration at its end.
    Nearest(Profile),
    /// Not: it lies before full jerk has taken the acceleration to zero.
    TooNear,
    /// That is no question: it is a goal at rest, one that lies behind, or one with an acceleration.
    NotAhead,
}

/// How `goal` can be passed by a motion that goes its way and does not turn back.
///
/// The fastest change to a velocity needs the least way. If that is longer than the way to the goal, the nearest velocity that can be reached
/// there is the one whose change is as long as the way.
pub(super) fn passing(start: State, goal: State, limits: &Limits) -> Passing {
    let backward = goal.velocity < 0.0;
    let seen = |state: State| if backward { state.mirrored() } else { state };
    let (from, to) = (seen(start), seen(goal));
    let way = to.position - from.position;
    if to.velocity == 0.0 || to.acceleration != 0.0 || from.velocity < 0.0 || way < 0.0 {
        return Passing::NotAhead;
    }
    let change = Change::towards(to.velocity, from, limits);
    let slack = POSITION_ULPS * f64::EPSILON * largest(from.position.abs(), to.position.abs());
    let asked = change.until(to.velocity);
    if change.way(asked) <= way {
        return Passing::AsAsked;
    }
    let shortest = change.way(0.0) - way;
    if shortest > slack {
        return Passing::TooNear;
    }
    let beyond = |effort: f64| (change.way(effort) - way, change.slope(effort));
    let effort = if shortest.abs() <= slack { Some(0.0) } else { sign_change(0.0, asked, beyond) };
    effort.map_or(Passing::AsAsked, |effort| {
        let mut pieces = alloc::vec::Vec::new();
        let mut at = from;
        for (jerk, duration) in change.pieces(effort) {
            let (start, law) = (seen(at).with_positive_zeros(), Law::ConstantJerk(jerk));
            let law = if backward { law.mirrored() } else { law };
            pieces.push(Segment { duration, start, law });
            at = at.after(jerk, duration);
        }
        let end = State { position: goal.position, acceleration: 0.0, ..seen(at).with_positive_zeros() };
        Passing::Nearest(Profile::new(pieces, end))
    })
}

/// The fastest changes of velocity towards another, from a start that goes forward; one for each *effort* \[acceleration\], from none, by
/// which full jerk takes the acceleration to zero, on.
///
/// ```text
/// acceleration │     ╭───╮             peak P = P₀ + effort, up to the limit L; then it is held, for (effort − (L − P₀))/jerk
///              │   ╱       ╲           P₀: the start's acceleration, if it has the sign of the peak
///              └─╱───────────╲── t
/// ```
#[derive(Clone, Copy, Debug)]
struct Change {
    from: State,
    /// 1 to speed up, −1 to slow down.
    sign: f64,
    jerk: f64,
    /// Of the peak's magnitude.
    least_peak: f64,
    limit: f64,
}

impl Change {
    fn towards(velocity: f64, from: State, limits: &Limits) -> Self {
        let jerk = limits.jerk();
        let coasting = from.velocity + 0.5 * from.acceleration * from.acceleration.abs() / jerk;
        let (sign, limit) =
            if velocity < coasting { (-1.0, limits.deceleration()) } else { (1.0, limits.acceleration()) };
        let least_peak = largest(0.0, sign * from.acceleration);
        // What begins beyond a limit comes back to it first, by as little effort.
        Self { from, sign, jerk, least_peak, limit: largest(limit, least_peak) }
    }

    fn peak(&self, effort: f64) -> f64 {
        least(self.least_peak + effort, self.limit)
    }

    /// Jerk and duration of each piece.
    fn pieces(&self, effort: f64) -> ArrayVec<(f64, f64), 3> {
        let Self { from, sign, jerk, least_peak, limit } = *self;
        let peak = self.peak(effort);
        let held = largest(0.0, effort - (limit - least_peak));
        let rise =
            if sign * from.acceleration > 0.0 { peak - least_peak } else { peak + from.acceleration.abs() };
        let pieces = [(sign * jerk, rise), (0.0, held), (-sign * jerk, peak)];
        pieces.into_iter().map(|(law, time)| (law, time / jerk)).filter(|(_, time)| *time > 0.0).collect()
    }

    fn end(&self, effort: f64) -> State {
        let from = State { position: 0.0, ..self.from };
        self.pieces(effort).into_iter().fold(from, |at, (jerk, time)| at.after(jerk, time))
    }

    fn way(&self, effort: f64) -> f64 {
        self.end(effort).position
    }

    /// The effort that leads to a velocity: `± Δv = (2·P² − a₀²)/(2·jerk) + P·held`.
    fn until(&self, velocity: f64) -> f64 {
        let Self { from, sign, jerk, least_peak, limit } = *self;
        let square = sign * (velocity - from.velocity) * jerk + 0.5 * from.acceleration * from.acceleration;
        let beyond = square - limit * limit;
        if beyond > 0.0 {
            return limit - least_peak + beyond / limit;
        }
        largest(0.0, sqrt(largest(0.0, square)) - least_peak)
    }

    /// Of the way over the effort \[s²\]: `2·v/jerk ± P²/jerk²` while the peak grows, `(v ± P²/(2·jerk))/jerk` while it is held; `v` the
    /// velocity at the end.
    fn slope(&self, effort: f64) -> f64 {
        let Self { sign, jerk, least_peak, limit, .. } = *self;
        let (peak, velocity) = (self.peak(effort), self.end(effort).velocity);
        let rise = sign * peak * peak / jerk;
        if least_peak + effort < limit {
            (2.0 * velocity + rise) / jerk
        } else {
            (velocity + 0.5 * rise) / jerk
        }
    }
}
