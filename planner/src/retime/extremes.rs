use crate::verify::VELOCITY_ULPS;
use crate::{Plan, Profile, Quantity, State};

/// The greatest magnitudes on a path from some path time on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Extremes {
    /// In the positive direction [axis units/s].
    pub(super) forward: f64,
    /// In the negative direction [axis units/s].
    pub(super) reverse: f64,
    /// While the speed grows [axis units/s²].
    pub(super) acceleration: f64,
    /// While the speed shrinks [axis units/s²].
    pub(super) deceleration: f64,
    /// [axis units/s³]
    pub(super) jerk: f64,
}

impl Extremes {
    pub(super) fn of(path: &Profile, from: f64) -> Self {
        let mut extremes = Self::default();
        let (first, within) = path.place_of(from);
        for (index, segment) in path.segments().iter().enumerate().skip(first) {
            let begin = if index == first { within } else { 0.0 };
            let times = segment.turning_points();
            for span in times.windows(2) {
                let (from, to) = (span[0].max(begin), span[1]);
                if to <= begin {
                    continue;
                }
                // Between two turning points the velocity keeps its sign.
                let travel = segment.at(0.5 * (from + to)).state.velocity;
                for t in [from, to] {
                    let setpoint = segment.at(t);
                    let State { velocity, acceleration, .. } = setpoint.state;
                    extremes.forward = extremes.forward.max(velocity);
                    extremes.reverse = extremes.reverse.max(-velocity);
                    let hardest = if acceleration * travel >= 0.0 {
                        &mut extremes.acceleration
                    } else {
                        &mut extremes.deceleration
                    };
                    *hardest = hardest.max(acceleration.abs());
                    extremes.jerk = extremes.jerk.max(setpoint.jerk.abs());
                }
            }
        }
        extremes
    }
}

/// The greatest rate at which the rest of a plan, from path time `from` \[s\] on, keeps the limits that it promises to keep: 1
/// where it is on one of them.
///
/// Infinite where nothing moves any more. A rate multiplies velocities by itself, accelerations by its square and jerks by its cube. What a plan does not promise, it
/// may exceed as far as it does anyway.
#[must_use]
pub fn greatest_factor(base: &Plan, from: f64) -> f64 {
    let mut greatest = f64::INFINITY;
    for axis in base.axes() {
        let (limits, taken) = (&axis.limits, Extremes::of(&axis.profile, from));
        // A speed this small is a rounded zero, as it is for the judge.
        let still = VELOCITY_ULPS * f64::EPSILON * taken.forward.max(taken.reverse);
        let mut room = |quantity, least: f64, pairs: &[(f64, f64)], root: fn(f64) -> f64| {
            let promised = base.guarantees(quantity);
            for &(limit, taken) in pairs.iter().filter(|(_, taken)| *taken > least) {
                greatest = greatest.min(root(if promised { limit } else { limit.max(taken) } / taken));
            }
        };
        let forward = (limits.velocity_forward(), taken.forward);
        let reverse = (limits.velocity_reverse(), taken.reverse);
        let growth = (limits.acceleration(), taken.acceleration);
        let shrinking = (limits.deceleration(), taken.deceleration);
        room(Quantity::Velocity, still, &[forward, reverse], |ratio| ratio);
        room(Quantity::Acceleration, 0.0, &[growth, shrinking], crate::float::sqrt);
        room(Quantity::Jerk, 0.0, &[(limits.jerk(), taken.jerk)], libm::cbrt);
    }
    // A plan that is on a limit may be a rounding beyond it.
    greatest.max(1.0)
}
