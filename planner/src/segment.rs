use arrayvec::ArrayVec;

use crate::derivatives::{Derivatives, MAX_DEGREE, setpoint};
use crate::float::{largest, least};
use crate::roots::{linear, quadratic, sign_change};
use crate::{MAX_ORDER, State, cosine};

/// One piece of a motion: a start state, a law, and its own clock from zero to `duration`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// How long it lasts \[s\], > 0.
    pub duration: f64,
    /// The state at its own time zero.
    pub start: State,
    /// How the state goes on from there.
    pub law: Law,
}

/// How a [`Segment`] moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// The jerk stays at this value [axis units/s³]; position is a cubic of time.
    ConstantJerk(f64),
    /// The highest of these derivatives stays at its value; position is a polynomial of time.
    Polynomial(Derivatives),
    /// The jerk is one period of a raised cosine over the whole segment: it begins and ends at zero.
    ///
    /// ```text
    /// j │     ╭───╮        j(t) = peak/2·(1 − cos(2π·t/duration))
    ///   │   ╱       ╲
    ///   └─╯───────────╰── t
    /// ```
    CosineJerk {
        /// Jerk in the middle of the segment [axis units/s³], signed.
        peak: f64,
    },
}

/// What an axis is commanded at one instant: its state and the jerk that leads on from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint {
    /// Position, velocity and acceleration.
    pub state: State,
    /// Jerk from this instant on [axis units/s³].
    pub jerk: f64,
}

/// The most instants that [`Segment::turning_points`] gives: both ends, and 14 + 13 + … + 1 zeros of the derivatives of a
/// polynomial of degree [`MAX_DEGREE`].
pub const MAX_TURNING_POINTS: usize = 2 + MAX_DEGREE * (MAX_DEGREE - 1) / 2;

impl Setpoint {
    /// At rest in `state`, or drifting on at its velocity: no jerk.
    #[must_use]
    pub fn held(state: State) -> Self {
        Self { state, jerk: 0.0 }
    }

    /// Position, velocity, acceleration, jerk: the order of the wire and of the digest.
    #[must_use]
    pub fn words(&self) -> [f64; 4] {
        [self.state.position, self.state.velocity, self.state.acceleration, self.jerk]
    }

    /// Neither NaN nor infinite in any part.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.state.is_finite() && self.jerk.is_finite()
    }
}

/// As [`Segment::turning_points`] of a constant jerk, of which there are few: both ends, and the zeros of acceleration and velocity.
#[inline]
pub(crate) fn turning_points_of_jerk<const ROOM: usize>(
    start: &State,
    jerk: f64,
    duration: f64,
) -> ArrayVec<f64, ROOM> {
    const { assert!(ROOM >= 5) };
    let State { velocity, acceleration, .. } = *start;
    let inside = |t: &f64| *t > 0.0 && *t < duration;
    let mut times = ArrayVec::new();
    times.push(0.0);
    times.extend(linear(jerk, acceleration).into_iter().filter(inside));
    times.extend(quadratic(0.5 * jerk, acceleration, velocity).into_iter().filter(inside));
    times.push(duration);
    times.sort_unstable_by(f64::total_cmp);
    times
}

impl Law {
    /// The same law seen from the other side: every sign turned.
    #[must_use]
    pub fn mirrored(self) -> Self {
        match self {
            Self::ConstantJerk(jerk) => Self::ConstantJerk(-jerk),
            Self::Polynomial(derivatives) => Self::Polynomial(derivatives.mirrored()),
            Self::CosineJerk { peak } => Self::CosineJerk { peak: -peak },
        }
    }
}

impl Segment {
    /// The setpoint `t` seconds after the segment's start; meant for `0 ≤ t ≤ duration`.
    #[must_use]
    #[inline]
    pub fn at(&self, t: f64) -> Setpoint {
        match &self.law {
            Law::ConstantJerk(jerk) => Setpoint { state: self.start.after(*jerk, t), jerk: *jerk },
            Law::Polynomial(derivatives) => setpoint(derivatives.as_slice(), &self.start, t),
            Law::CosineJerk { peak } => cosine::setpoint(&self.start, *peak, self.duration, t),
        }
    }

    /// The state in which the segment ends.
    #[must_use]
    #[inline]
    pub fn end(&self) -> State {
        self.at(self.duration).state
    }

    /// What is left of it `t` seconds after its start; `None` of a cosine, which is one only as a whole, and above [`MAX_ORDER`].
    pub(crate) fn rest(&self, t: f64) -> Option<Self> {
        let law = match &self.law {
            Law::ConstantJerk(_) => self.law,
            Law::Polynomial(derivatives) if derivatives.order() <= MAX_ORDER => {
                Law::Polynomial(Derivatives::new(&self.derivatives(t)[3..=derivatives.order()])?)
            }
            Law::Polynomial(_) | Law::CosineJerk { .. } => return None,
        };
        Some(Self { duration: self.duration - t, start: self.at(t).state, law })
    }

    /// The same way in `factor` times the time: each derivative of order k is divided by `factorᵏ`.
    pub(crate) fn slowed(&self, factor: f64) -> Self {
        let State { position, velocity, acceleration } = self.start;
        let square = factor * factor;
        let start = State { position, velocity: velocity / factor, acceleration: acceleration / square };
        let law = match self.law {
            Law::ConstantJerk(jerk) => Law::ConstantJerk(jerk / (square * factor)),
            Law::Polynomial(derivatives) => Law::Polynomial(derivatives.slowed(factor)),
            Law::CosineJerk { peak } => Law::CosineJerk { peak: peak / (square * factor) },
        };
        Self { duration: self.duration * factor, start, law }
    }

    /// Position and its derivatives `t` seconds after the segment's start, each at the index of its order.
    #[must_use]
    pub fn derivatives(&self, t: f64) -> [f64; MAX_ORDER + 1] {
        let Setpoint { state: State { position, velocity, acceleration }, jerk } = self.at(t);
        let mut all = [0.0; MAX_ORDER + 1];
        all[..4].copy_from_slice(&[position, velocity, acceleration, jerk]);
        match &self.law {
            Law::ConstantJerk(_) => {}
            Law::Polynomial(derivatives) => derivatives.higher(t, &mut all[4..]),
            Law::CosineJerk { peak } => cosine::higher(*peak, self.duration, t, &mut all[4..]),
        }
        all
    }

    /// The zero of the derivative of `order` that is nearer than `within` to `near` \[s\], to 4 units in its last place; `near` where there is
    /// none, or none that can be told from its neighbours.
    ///
    /// In a [`Law::Polynomial`], by arithmetic of twice the digits: [`Self::turning_points`] come as near as 4 units in the last place of the
    /// duration. Other laws have closed forms, but for an acceleration that a cosine begins with.
    #[must_use]
    pub fn zero_near(&self, order: usize, near: f64, within: f64) -> f64 {
        let Law::Polynomial(derivatives) = &self.law else { return near };
        let span = (largest(0.0, near - within), least(self.duration, near + within));
        derivatives.zero_in(&self.start, order, self.duration, near, span)
    }

    /// Every instant of the segment at which position or one of its derivatives can be extreme \[s\], in order: both ends,
    /// and the zeros of the derivatives between them. Between two neighbours position and all derivatives are monotone.
    ///
    /// Zeros of linear and quadratic functions are taken in closed form. Above that a derivative has at most one zero between
    /// two neighbouring extremes, that is, zeros of the next derivative; its change of sign is closed in on to 4 units in
    /// the last place of the duration.
    #[must_use]
    pub fn turning_points(&self) -> ArrayVec<f64, MAX_TURNING_POINTS> {
        if let Law::ConstantJerk(jerk) = self.law {
            return turning_points_of_jerk(&self.start, jerk, self.duration);
        }
        let mut times = ArrayVec::new();
        times.push(0.0);
        let inside = |t: &f64| *t > 0.0 && *t < self.duration;
        match &self.law {
            // Its own, above.
            Law::ConstantJerk(_) => {}
            Law::Polynomial(derivatives) => {
                let mut zeros = ArrayVec::<f64, MAX_DEGREE>::new();
                for order in (1..derivatives.order()).rev() {
                    zeros = derivatives.zeros(&self.start, order, self.duration, &zeros);
                    times.extend(zeros.iter().copied());
                }
            }
            // Jerk and what is above it turn at quarters of the period. The jerk keeps its sign, so the acceleration has at
            // most one zero, and the velocity one on either side of that.
            Law::CosineJerk { .. } => {
                times.extend([0.25, 0.5, 0.75].map(|part| part * self.duration).into_iter().filter(inside));
                let rate = |t| {
                    let Setpoint { state, jerk } = self.at(t);
                    (state.acceleration, jerk)
                };
                let turn = sign_change(0.0, self.duration, rate);
                let speed = |t| {
                    let State { velocity, acceleration, .. } = self.at(t).state;
                    (velocity, acceleration)
                };
                let middle = turn.unwrap_or(self.duration);
                let zeros =
                    [turn, sign_change(0.0, middle, speed), sign_change(middle, self.duration, speed)];
                times.extend(zeros.into_iter().flatten().filter(inside));
            }
        }
        times.push(self.duration);
        times.sort_unstable_by(f64::total_cmp);
        times
    }
}
