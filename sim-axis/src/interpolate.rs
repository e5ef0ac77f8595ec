use planner::State;

/// The motion between two setpoints as a drive fills it in: the quintic that meets position, velocity and
/// acceleration at both ends.
///
/// ```text
/// p(t) = p₀ + v₀·t + a₀·t²/2 + c₃·t³ + c₄·t⁴ + c₅·t⁵
/// ```
///
/// A cubic would meet position and velocity only and let the acceleration jump at every cycle, which excites
/// the axis at the cycle rate. The quintic is the least polynomial without jumps, and where the jerk is
/// constant over the cycle it is the planned cubic itself: `c₄ = c₅ = 0`.
///
/// Source: Biagiotti & Melchiorri (2008), §2.1.
///
/// ```
/// # use planner::State;
/// # use sim_axis::Quintic;
/// let start = State { position: 1.0, velocity: 0.5, acceleration: 0.0 };
/// let end = start.after(8.0, 0.25);
/// let half = Quintic::through(start, end, 0.25).at(0.125);
/// assert!((half.position - start.after(8.0, 0.125).position).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quintic {
    start: State,
    c3: f64,
    c4: f64,
    c5: f64,
}

impl Quintic {
    /// From `start` to `end` within `duration` [s], above 0.
    #[must_use]
    pub fn through(start: State, end: State, duration: f64) -> Self {
        let reached = start.after(0.0, duration);
        let p = (end.position - reached.position) / (duration * duration * duration);
        let v = (end.velocity - reached.velocity) / (duration * duration);
        let a = (end.acceleration - reached.acceleration) / duration;
        Self {
            start,
            c3: 10.0 * p - 4.0 * v + 0.5 * a,
            c4: (-15.0 * p + 7.0 * v - a) / duration,
            c5: (6.0 * p - 3.0 * v + 0.5 * a) / (duration * duration),
        }
    }

    /// The state `t` seconds after the start.
    #[must_use]
    pub fn at(&self, t: f64) -> State {
        let Self { start, c3, c4, c5 } = *self;
        let State { position, velocity, acceleration } = start;
        State {
            position: position + t * (velocity + t * (0.5 * acceleration + t * (c3 + t * (c4 + t * c5)))),
            velocity: velocity + t * (acceleration + t * (3.0 * c3 + t * (4.0 * c4 + t * (5.0 * c5)))),
            acceleration: acceleration + t * (6.0 * c3 + t * (12.0 * c4 + t * (20.0 * c5))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Slack on a state of size one reached over a second [1]: the acceleration sums terms of up to 20·c₅,
    /// some 500, and each carries a few roundings.
    const ROUNDING: f64 = 1e-12;

    fn any_state() -> impl Strategy<Value = State> {
        (-1.0..1.0, -1.0..1.0, -1.0..1.0).prop_map(|(position, velocity, acceleration)| State {
            position,
            velocity,
            acceleration,
        })
    }

    fn distance(one: State, other: State) -> f64 {
        (one.position - other.position)
            .abs()
            .max((one.velocity - other.velocity).abs())
            .max((one.acceleration - other.acceleration).abs())
    }

    proptest! {
        #[test]
        fn both_ends_are_met(start in any_state(), end in any_state()) {
            let quintic = Quintic::through(start, end, 1.0);
            prop_assert_eq!(quintic.at(0.0), start);
            prop_assert!(distance(quintic.at(1.0), end) < ROUNDING);
        }

        #[test]
        fn constant_jerk_is_kept(start in any_state(), jerk in -1.0..1.0, t in 0.0..1.0) {
            let quintic = Quintic::through(start, start.after(jerk, 1.0), 1.0);
            prop_assert!(distance(quintic.at(t), start.after(jerk, t)) < ROUNDING);
        }
    }
}
