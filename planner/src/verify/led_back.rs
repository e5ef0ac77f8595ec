//! What the judge lets pass where a motion begins beyond its limits: the way back, as fast as can be, and no more.
//!
//! ```text
//! v │  ╭─╮  as far as full jerk against it makes inevitable      a │╲  at full jerk, from the first instant
//!   │╱     ╲  from there it only comes back                        │  ╲
//!   │╌╌╌╌╌╌╌╌╲╌╌╌╌╌ limit                                          │╌╌╌╌╲╌╌╌╌╌ limit
//!   │          ╰──────                                             │      ╲
//!   └─────────┴───── t                                             └─────┴──── t
//!             deadline                                               deadline
//! ```
//!
//! The deadline of the velocity is when the fastest way back comes in with no acceleration left: whoever is later dawdled. It
//! is told by the lower of the limits of speeding up and slowing down, which is that of a ramp that goes on through zero. On a straight line
//! full jerk is what the line has of it, since to be faster an axis would have to leave it.

use crate::float::sqrt;
use crate::verify::{LIMIT_TOLERANCE, Recovery};
use crate::{Limits, Profile, State};

/// Of how far beyond a motion begins, in units in the last place: what it is back at its limit but for, since the end of a piece is no
/// better known than its beginning.
const ROUNDED: f64 = 64.0 * f64::EPSILON;

/// How a start that is beyond limits, or bound to come there, is to be led back.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LedBack {
    /// Of the velocity, upward and downward.
    velocity: [Option<Return>; 2],
    acceleration: Option<Fall>,
}

/// The way back of a velocity; as if its limit were an upper one.
#[derive(Clone, Copy, Debug)]
struct Return {
    limit: f64,
    /// How far it comes whatever is done, and when.
    inevitable: f64,
    turns_at: f64,
    /// When it is to be back \[s\].
    deadline: f64,
    /// The lowest that it has come back to.
    lowest: f64,
}

/// The way back of an acceleration, at full jerk.
#[derive(Clone, Copy, Debug)]
struct Fall {
    start: f64,
    jerk: f64,
    /// When the motion ends \[s\]: no later is anything let pass.
    end: f64,
    /// When it is back at the lowest limit that it was seen beyond \[s\].
    until: f64,
}

impl LedBack {
    /// What is beyond `limits` at the start, led back by `recovery`; nothing where it is inside. `rounding` is what velocities are rounded to.
    pub(crate) fn of(profile: &Profile, limits: &Limits, recovery: Recovery, rounding: f64) -> Self {
        let State { velocity, acceleration, .. } = profile.start();
        let end = profile.duration();
        let back = |sign: f64| {
            let limit = limits.velocity_towards(sign);
            let back = Return::of(sign * velocity, sign * acceleration, limit, recovery, rounding);
            back.map(|back| Return { deadline: back.deadline.min(end), ..back })
        };
        let fall = Fall { start: acceleration, jerk: recovery.jerk, end, until: 0.0 };
        let lower = limits.acceleration().min(limits.deceleration());
        Self { velocity: [back(1.0), back(-1.0)], acceleration: (acceleration.abs() > lower).then_some(fall) }
    }

    /// Is a velocity beyond its limit on its way back? To be asked in order of time, wherever velocities turn.
    pub(crate) fn passes_velocity(&mut self, velocity: f64, time: f64) -> bool {
        let [up, down] = &mut self.velocity;
        let passes = |back: &mut Option<Return>, value: f64| {
            back.as_mut().is_some_and(|back| back.passes(value, time))
        };
        passes(up, velocity) || passes(down, -velocity)
    }

    /// Is an acceleration beyond `limit` on its way back?
    pub(crate) fn passes_acceleration(&mut self, acceleration: f64, limit: f64, time: f64) -> bool {
        self.acceleration.as_mut().is_some_and(|fall| fall.passes(acceleration, limit, time))
    }

    /// The instants from which something is held to its limit \[s\].
    pub(crate) fn deadlines(&self, limits: &Limits) -> impl Iterator<Item = f64> + use<> {
        let (up, down) = (limits.acceleration(), limits.deceleration());
        let of_acceleration = self.acceleration.map(|fall| [fall.deadline(up), fall.deadline(down)]);
        let of_velocity = self.velocity.into_iter().flatten().map(|back| back.deadline);
        of_velocity.chain(of_acceleration.into_iter().flatten())
    }

    /// When the velocity is back \[s\], if it was beyond a limit.
    pub(crate) fn velocity_by(&self) -> Option<f64> {
        self.velocity.into_iter().flatten().map(|back| back.deadline).reduce(f64::max)
    }

    /// When the acceleration is back \[s\], if it was beyond a limit.
    pub(crate) fn acceleration_by(&self) -> Option<f64> {
        self.acceleration.map(|fall| fall.until).filter(|until| *until > 0.0)
    }
}

impl Return {
    /// The fastest way back to `limit`, which ends there without acceleration; nothing where none is needed.
    fn of(v: f64, a: f64, limit: f64, recovery: Recovery, rounding: f64) -> Option<Self> {
        let jerk = recovery.jerk;
        let rises = a.max(0.0);
        let inevitable = v + 0.5 * rises * rises / jerk;
        // Also for NaN.
        let inside = inevitable <= limit * (1.0 + LIMIT_TOLERANCE) + rounding;
        if inside || inevitable.is_nan() {
            return None;
        }
        let deadline = Self::deadline(v, a, limit, recovery.lower(), jerk);
        Some(Self { limit, inevitable, turns_at: rises / jerk, deadline, lowest: inevitable })
    }

    fn deadline(v: f64, a: f64, limit: f64, lower: f64, jerk: f64) -> f64 {
        // An acceleration that slows down beyond its limit comes back first.
        let first = ((-lower - a) / jerk).max(0.0);
        let (v, a) = if first > 0.0 { (v + 0.5 * (a - lower) * first, -lower) } else { (v, a) };
        let beyond = v - limit;
        let square = a * a / jerk;
        if a <= 0.0 && beyond <= 0.5 * square {
            // Full jerk keeps what it is to lose: v + a·t + j·t²/2 is the limit.
            let root = sqrt((a * a - 2.0 * jerk * beyond).max(0.0));
            return first + (2.0 * beyond.max(0.0) / (root - a)).max(0.0);
        }
        // To the valley −d, held for h, and back to zero: what is to be lost is d²/j + d·h.
        let lost = beyond + 0.5 * square;
        let valley = sqrt(lost * jerk).min(lower);
        first + (a + 2.0 * valley) / jerk + (lost / valley - valley / jerk).max(0.0)
    }

    fn passes(&mut self, value: f64, time: f64) -> bool {
        let beyond = value - self.limit;
        let rounded = beyond <= ROUNDED * self.inevitable.abs();
        // Also false for NaN; once it is back the limit holds, but for its rounding then.
        let on_its_way =
            beyond > 0.0 && (time < self.deadline || (rounded && time <= last_of(self.deadline)));
        if !on_its_way {
            return false;
        }
        let highest = if time < self.turns_at { self.inevitable } else { self.lowest };
        let passes = beyond <= highest - self.limit + LIMIT_TOLERANCE * highest.abs();
        if passes && time >= self.turns_at {
            self.lowest = self.lowest.min(value);
        }
        passes
    }
}

impl Fall {
    /// When full jerk has it back at `limit` \[s\].
    fn deadline(&self, limit: f64) -> f64 {
        ((self.start.abs() - limit) / self.jerk).min(self.end)
    }

    fn passes(&mut self, acceleration: f64, limit: f64, time: f64) -> bool {
        let (value, start) = (acceleration * self.start.signum(), self.start.abs());
        let rounded = value <= limit + ROUNDED * start;
        let deadline = self.deadline(limit);
        let falls = value <= start - self.jerk * time + LIMIT_TOLERANCE * limit + ROUNDED * start;
        let passes = value > limit && falls && (time < deadline || (rounded && time <= last_of(deadline)));
        if passes {
            self.until = self.until.max(deadline);
        }
        passes
    }
}

/// An instant that was told from another side may be a rounding later.
fn last_of(deadline: f64) -> f64 {
    deadline * (1.0 + 4.0 * f64::EPSILON)
}
