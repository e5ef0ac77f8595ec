/// Where an axis is at one instant [axis units, axis units/s, axis units/s²].
///
/// Any finite triple is a state; whether limits allow it is asked when a [`Problem`](crate::Problem) is made.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Position [axis units].
    pub position: f64,
    /// Velocity [axis units/s], signed.
    pub velocity: f64,
    /// Acceleration [axis units/s²], signed.
    pub acceleration: f64,
}

impl State {
    /// Standing still at `position` [axis units].
    #[must_use]
    pub const fn at_rest(position: f64) -> Self {
        Self { position, velocity: 0.0, acceleration: 0.0 }
    }

    /// The state after `t` seconds at constant jerk `j` [axis units/s³]: the one place where this cubic is written.
    ///
    /// ```text
    /// p(t) = p + v·t + a·t²/2 + j·t³/6      v(t) = v + a·t + j·t²/2      a(t) = a + j·t
    /// ```
    ///
    /// Evaluated in Horner form, in this order, without fused multiply-add: replicas on other machines
    /// get the same bits, which [`EVALUATION_VERSION`](crate::EVALUATION_VERSION) names.
    ///
    /// ```
    /// # use planner::State;
    /// let moved = State::at_rest(1.0).after(6.0, 2.0);
    /// assert_eq!(moved, State { position: 9.0, velocity: 12.0, acceleration: 12.0 });
    /// ```
    #[must_use]
    #[inline]
    pub fn after(self, j: f64, t: f64) -> Self {
        Self {
            position: self.position + t * (self.velocity + t * (self.acceleration * 0.5 + t * (j / 6.0))),
            velocity: self.velocity + t * (self.acceleration + t * (j * 0.5)),
            acceleration: self.acceleration + t * j,
        }
    }

    /// The same motion seen from the other side: every sign turned.
    #[must_use]
    pub fn mirrored(self) -> Self {
        Self { position: -self.position, velocity: -self.velocity, acceleration: -self.acceleration }
    }

    /// The same state with every zero positive: the wire does not carry the sign of a zero, and replicas that got a plan
    /// over it must sample the same bits as the one that made it.
    #[must_use]
    pub fn with_positive_zeros(self) -> Self {
        Self {
            position: self.position + 0.0,
            velocity: self.velocity + 0.0,
            acceleration: self.acceleration + 0.0,
        }
    }

    /// Neither moving nor accelerating?
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.velocity == 0.0 && self.acceleration == 0.0
    }

    /// Neither NaN nor infinite in any part.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.position.is_finite() && self.velocity.is_finite() && self.acceleration.is_finite()
    }
}
