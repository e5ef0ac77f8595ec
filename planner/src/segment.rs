use arrayvec::ArrayVec;

use crate::State;

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
}

/// What an axis is commanded at one instant: its state and the jerk that leads on from it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint {
    /// Position, velocity and acceleration.
    pub state: State,
    /// Jerk from this instant on [axis units/s³].
    pub jerk: f64,
}

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

impl Segment {
    /// The setpoint `t` seconds after the segment's start; meant for `0 ≤ t ≤ duration`.
    #[must_use]
    #[inline]
    pub fn at(&self, t: f64) -> Setpoint {
        match self.law {
            Law::ConstantJerk(jerk) => Setpoint { state: self.start.after(jerk, t), jerk },
        }
    }

    /// The state in which the segment ends.
    #[must_use]
    #[inline]
    pub fn end(&self) -> State {
        self.at(self.duration).state
    }

    /// Every instant of the segment at which position, velocity or acceleration can be extreme \[s\]: both ends, and
    /// the zeros of velocity and acceleration between them. Between two neighbours all three are monotone.
    ///
    /// Two zeros of a quadratic velocity and one of a linear acceleration make five at the most.
    #[must_use]
    pub fn turning_points(&self) -> ArrayVec<f64, 5> {
        let mut times = ArrayVec::new();
        times.push(0.0);
        match self.law {
            Law::ConstantJerk(jerk) => {
                let inside = |t: &f64| *t > 0.0 && *t < self.duration;
                let State { velocity, acceleration, .. } = self.start;
                times.extend(crate::roots::linear(jerk, acceleration).into_iter().filter(inside));
                times.extend(
                    crate::roots::quadratic(0.5 * jerk, acceleration, velocity).into_iter().filter(inside),
                );
            }
        }
        times.push(self.duration);
        times.sort_unstable_by(f64::total_cmp);
        times
    }
}
