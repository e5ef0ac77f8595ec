use arrayvec::ArrayVec;

use super::ends::Moving;
use crate::float::{largest, sqrt};

/// Of the velocities that a limit is compared with \[1\]: by this much a velocity may be beyond it and is still on it, since it
/// was computed. A start on the limit would else be led back over nothing.
const ON_THE_LIMIT: f64 = 16.0 * f64::EPSILON;

/// Limits of velocity and acceleration, the latter as magnitudes, in the unit of [`Ends`](super::ends::Ends).
#[derive(Clone, Copy, Debug)]
pub(super) struct Confines {
    pub(super) bottom: f64,
    pub(super) top: f64,
    pub(super) up: f64,
    pub(super) down: f64,
}

impl Confines {
    /// Seen from the other side.
    pub(super) fn mirrored(self) -> Self {
        Self { bottom: -self.top, top: -self.bottom, up: self.down, down: self.up }
    }
}

/// The way back of a start that is beyond its limits, or will be whatever is done: each piece's jerk and time.
#[derive(Clone, Debug)]
pub(super) struct LeadIn {
    pub(super) pieces: ArrayVec<(f64, f64), 3>,
    pub(super) reached: Moving,
    pub(super) way: f64,
    /// The sign of the acceleration that is held, where one is: of times that add up to far more it could not be told.
    pub(super) held: f64,
}

impl LeadIn {
    /// First the acceleration, at full jerk; then the velocity, as fast as it can without coming out on the other side of its
    /// limit: until full jerk back leads to the limit exactly.
    ///
    /// ```text
    /// v │─╮                           a │╮
    ///   │   ╲                           │ ╲        ╱      the lead-in ends where full jerk back
    ///   │     ╲                         └──╲─────╱── t    brings v to its limit and a to zero:
    ///   │╌╌╌╌╌╌╌╌╲╴╴╴╴ limit               ╲__╱           what follows may do that, or brake on
    ///   └────────┴──── t                       ┴
    /// ```
    pub(super) fn of(start: Moving, limits: Confines) -> Self {
        let mut lead = Self { pieces: ArrayVec::new(), reached: start, way: 0.0, held: 0.0 };
        let Confines { bottom, top, up, down } = limits;
        if start.acceleration > up {
            lead.go(-1.0, start.acceleration - up);
            lead.reached.acceleration = up;
        } else if start.acceleration < -down {
            lead.go(1.0, -down - start.acceleration);
            lead.reached.acceleration = -down;
        }
        let coasting = lead.reached.coasting();
        let Moving { velocity, acceleration } = lead.reached;
        let slack = ON_THE_LIMIT * (velocity.abs() + acceleration * acceleration);
        if coasting > top + slack {
            lead.fall(1.0, lead.reached, limits);
        } else if coasting < bottom - slack {
            lead.fall(-1.0, lead.reached.mirrored(), limits.mirrored());
        }
        lead
    }

    /// Down from `from` until full jerk leads to the top; seen from the other side where `sign` is negative.
    fn fall(&mut self, sign: f64, from: Moving, limits: Confines) {
        let Confines { top, down, .. } = limits;
        let Moving { velocity, acceleration } = from;
        let beyond = largest(0.0, velocity - top + 0.5 * acceleration * acceleration);
        let valley = largest(sqrt(beyond), -acceleration);
        let (depth, hold) =
            if valley <= down { (valley, 0.0) } else { (down, (beyond - down * down) / down) };
        self.go(-sign, acceleration + depth);
        self.reached.acceleration = -sign * depth;
        self.go(0.0, hold);
        self.held = -sign;
        let reached = Moving { velocity: top + 0.5 * depth * depth, acceleration: -depth };
        self.reached = if sign < 0.0 { reached.mirrored() } else { reached };
    }

    fn go(&mut self, jerk: f64, time: f64) {
        if time > 0.0 {
            self.way += self.reached.advance(jerk, time);
            match self.pieces.last_mut() {
                #[expect(clippy::float_cmp, reason = "one of three numbers")]
                Some(last) if last.0 == jerk => last.1 += time,
                _ => self.pieces.push((jerk, time)),
            }
        }
    }
}
