use super::AxisLimits;
use crate::float::{cbrt, largest, least, sqrt};
use crate::{SixCase, State};

/// A move from rest to rest in closed form: three times and a jerk, for any distance.
///
/// ```text
/// jerk   ┌──┐                                      ┌──┐      t_j  the jerk lasts
///      ──┘  └─────┐  ┌────────────┐  ┌─────┐  ┌────┘  └──    t_a  from jerk to jerk: the acceleration lasts t_a + t_j
///                 └──┘            └──┘     └──┘              t_v  from ramp to ramp
///        │t_j│
///        │── t_a ─│t_j│
///        │───────── t_v ──────────│── t_a ──│t_j│
/// ```
///
/// A jerk that is three boxes wide in turn integrates to their product, so
/// `s = J·t_j·t_a·t_v`, the speed peaks at `J·t_j·t_a`, the acceleration at `J·t_j`, and the whole lasts
/// `t_j + t_a + t_v`. Each time is the least that its limit and the distance allow:
///
/// ```text
/// t_j = min(A/J, √(V/J), ∛(s/2J))
/// t_a = max(t_j, min(V/(J·t_j), 2C/(t_j + √(t_j² + 4C))))        C = s/(J·t_j)
/// t_v = max(t_j + t_a, s/(J·t_j·t_a))
/// ```
///
/// Source: Blejan and Blejan (2020), equations (33) to (39) and (66) to (89), collapsed: the six cases are the branches
/// that the minima and maxima take. Their (88) has been rewritten so that it does not cancel, and is right as printed,
/// though (86) and (87), from which it is said to follow, have a factor of 2 too many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// t_j: how long the first jerk lasts \[s\].
    pub jerk_time: f64,
    /// t_a: from the beginning of the first jerk to that of the second \[s\], at least `jerk_time`.
    pub acceleration_time: f64,
    /// t_v: from the beginning of one ramp to that of the other \[s\], at least the sum of the other two.
    pub velocity_time: f64,
    /// The jerk [axis units/s³], with the sign of the distance.
    pub jerk: f64,
    /// Which of the six.
    pub case: SixCase,
}

impl Shape {
    /// The fastest move over `distance` [axis units], signed, within `limits` that have been checked.
    /// `None` where there is nothing to go.
    pub(crate) fn rest_to_rest(distance: f64, limits: &AxisLimits<f64>) -> Option<Self> {
        let AxisLimits { velocity: v, acceleration: a, jerk: j } = *limits;
        if distance == 0.0 {
            return None;
        }
        let s = largest(distance.abs(), LEAST_DISTANCE);
        let t_j = least(least(a / j, sqrt(v / j)), cbrt(0.5 * s / j));
        let peak = j * t_j;
        let c = s / peak;
        let t_a = largest(t_j, least(v / peak, 2.0 * c / (t_j + sqrt(t_j * t_j + 4.0 * c))));
        let t_v = largest(t_j + t_a, c / t_a);
        Some(Self {
            jerk_time: t_j,
            acceleration_time: t_a,
            velocity_time: t_v,
            jerk: if distance < 0.0 { -j } else { j },
            case: case(s, limits),
        })
    }

    /// How long it lasts \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.jerk_time + self.acceleration_time + self.velocity_time
    }

    /// How long each of the seven pieces lasts \[s\], zero where a piece is left out.
    #[must_use]
    pub fn durations(&self) -> [f64; 7] {
        let jerk = self.jerk_time;
        let hold = self.acceleration_time - jerk;
        let cruise = largest(0.0, self.velocity_time - self.acceleration_time - jerk);
        [jerk, hold, jerk, cruise, jerk, hold, jerk]
    }

    /// The greatest speed [axis units/s], signed.
    #[must_use]
    pub fn peak_velocity(&self) -> f64 {
        self.jerk * self.jerk_time * self.acceleration_time
    }

    /// The greatest acceleration [axis units/s²], signed.
    #[must_use]
    pub fn peak_acceleration(&self) -> f64 {
        self.jerk * self.jerk_time
    }

    /// The state `t` seconds after the start of this move from `start` to `target` [axis units].
    ///
    /// The second half is the first one seen from the target, at `T − t`, so a move of any length keeps its digits at both
    /// ends, and from `T` on this is the target exactly.
    #[must_use]
    pub fn at(&self, t: f64, start: f64, target: f64) -> State {
        let rising = self.rising();
        let of = |t: f64| {
            let due = rising.iter().rev().find(|(begin, _)| t >= *begin);
            due.map_or_else(State::default, |(begin, piece)| piece.start.after(piece.jerk, t - begin))
        };
        let duration = self.duration();
        let from = |origin: f64, state: State| State { position: origin + state.position, ..state };
        if t >= duration {
            State::at_rest(target)
        } else if t > 0.5 * duration {
            from(target, seen_from_the_end(of(duration - t)))
        } else {
            from(start, of(t))
        }
    }

    /// The first half: when each of its four pieces begins \[s\], and how it moves.
    pub(crate) fn rising(&self) -> [(f64, Piece); 4] {
        let [jerk_time, hold, _, _, _, _, _] = self.durations();
        let jerk = self.jerk;
        let first = State::default();
        let second = first.after(jerk, jerk_time);
        let third = second.after(0.0, hold);
        let top = State { acceleration: 0.0, ..third.after(-jerk, jerk_time) };
        let t_a = self.acceleration_time;
        [
            (0.0, Piece { start: first, jerk }),
            (jerk_time, Piece { start: second, jerk: 0.0 }),
            (t_a, Piece { start: third, jerk: -jerk }),
            (t_a + jerk_time, Piece { start: top, jerk: 0.0 }),
        ]
    }
}

/// The case of a move over `distance` [axis units], > 0, within `limits`.
fn case(distance: f64, limits: &AxisLimits<f64>) -> SixCase {
    let AxisLimits { velocity: v, acceleration: a, jerk: j } = *limits;
    let least_cruise = if v * j <= a * a { 2.0 * v * sqrt(v / j) } else { v * (v / a + a / j) };
    SixCase::of_move(distance >= least_cruise, distance, [v, a, j])
}

/// Shorter moves take the times of this one [axis units]: under any limits both are over within 1e-40 s, before the first
/// cycle, and the quotients below do not vanish.
const LEAST_DISTANCE: f64 = 1e-180;

/// A piece of constant jerk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Piece {
    pub(crate) start: State,
    pub(crate) jerk: f64,
}

/// The same motion run backwards: `s − x(T − t)` is as fast at `T − t`, and gains speed where that loses it.
pub(crate) fn seen_from_the_end(state: State) -> State {
    // Subtracted, for that gives no negative zero.
    State { position: 0.0 - state.position, velocity: state.velocity, acceleration: 0.0 - state.acceleration }
}
