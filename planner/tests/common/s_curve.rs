//! The crate `s_curve`, a second peer: the double S of Biagiotti and Melchiorri (2008) between two speeds, with limits alike for speeding up and
//! slowing down, and alike in both directions.

use planner::{Problem, State};
use s_curve::{Derivative, SCurveConstraints, SCurveInput, SCurveParameters, SCurveStartConditions};

/// Of the distance and of each limit \[1\]: how exactly an answer of the peer's arrives and keeps within limits.
const RIGHT: f64 = 1e-9;

/// The peer is asked the same; none where it has no words for the limits.
pub(crate) fn input(problem: &Problem) -> Option<SCurveInput> {
    let (start, goal, limits) = (problem.start(), problem.goal(), problem.limits());
    let symmetric = limits.acceleration().to_bits() == limits.deceleration().to_bits();
    symmetric.then(|| SCurveInput {
        constraints: SCurveConstraints {
            max_velocity: limits.velocity_forward(),
            max_acceleration: limits.acceleration(),
            max_jerk: limits.jerk(),
        },
        start_conditions: SCurveStartConditions {
            q0: start.position,
            q1: goal.position,
            v0: start.velocity,
            v1: goal.velocity,
        },
    })
}

/// Its answer, whatever it is worth: it refuses nothing.
#[inline]
pub(crate) fn plan(input: &SCurveInput) -> SCurveParameters {
    SCurveParameters::new(&input.calc_intervals(), input)
}

/// Position to jerk by time \[s\].
pub(crate) fn functions(input: &SCurveInput) -> [Box<dyn Fn(f64) -> f64>; 4] {
    [Derivative::Position, Derivative::Velocity, Derivative::Acceleration, Derivative::Jerk]
        .map(|derivative| s_curve::s_curve_generator(input, derivative).1)
}

/// How long it lasts \[s\], if its pieces lead where they should within the limits.
pub(crate) fn duration(problem: &Problem, planned: &SCurveParameters) -> Option<f64> {
    let (goal, limits, direction) = (problem.goal(), problem.limits(), problem.direction());
    let (times, jerk) = (&planned.time_intervals, direction * planned.j_max);
    let pieces = [
        (times.t_j1, jerk),
        (times.t_a - 2.0 * times.t_j1, 0.0),
        (times.t_j1, -jerk),
        (times.t_v, 0.0),
        (times.t_j2, -jerk),
        (times.t_d - 2.0 * times.t_j2, 0.0),
        (times.t_j2, jerk),
    ];
    let (mut state, mut total) = (problem.start(), 0.0);
    let (velocity, acceleration) = (limits.velocity_forward(), limits.acceleration());
    let within = |State { velocity: v, acceleration: a, .. }: State| {
        v.abs() <= velocity * (1.0 + RIGHT) && a.abs() <= acceleration * (1.0 + RIGHT)
    };
    for (duration, jerk) in pieces {
        // A hold of nothing may be a rounding short.
        if duration < -RIGHT * times.total_duration() {
            return None;
        }
        state = state.after(jerk, duration);
        total += duration;
        if !within(state) {
            return None;
        }
    }
    let arrives = (state.position - goal.position).abs() <= RIGHT * problem.distance().abs()
        && (state.velocity - goal.velocity).abs() <= RIGHT * velocity
        && state.acceleration.abs() <= RIGHT * acceleration;
    arrives.then_some(total)
}

/// How many of its answers are right, and how much longer they last than ours.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) asked: usize,
    pub(crate) right: usize,
    /// Of the right ones, those that last longer than ours, and by how much at most \[1\].
    pub(crate) slower: usize,
    pub(crate) longest: f64,
}

impl Tally {
    /// Asks for a motion that takes us `ours` \[s\], and gives what was asked if the answer is right.
    pub(crate) fn ask(&mut self, problem: &Problem, ours: f64) -> Option<SCurveInput> {
        let input = input(problem)?;
        self.asked += 1;
        let theirs = duration(problem, &plan(&input))?;
        self.right += 1;
        let longer = theirs / ours - 1.0;
        self.slower += usize::from(longer > RIGHT);
        self.longest = self.longest.max(longer);
        Some(input)
    }
}
