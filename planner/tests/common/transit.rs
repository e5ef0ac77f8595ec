//! What is asked of a motion between two states beyond what the judge asks.

use planner::{State, Transit};

/// The largest gap between two pieces, or between the last and the goal: of the extent, of the fastest, of the hardest; of
/// positions, after what they are rounded to.
pub(crate) fn residual(transit: &Transit, jerk: f64) -> f64 {
    let segments = transit.segments();
    let begins: Vec<State> = segments.iter().map(|segment| segment.start).collect();
    let ends: Vec<State> = segments.iter().map(|segment| segment.end()).collect();
    // The extent lies where it turns.
    let turns: Vec<State> = segments
        .iter()
        .flat_map(|segment| segment.turning_points().into_iter().map(|t| segment.at(t).state))
        .collect();
    let all = || begins.iter().chain(&ends).chain(&turns);
    let largest = |part: fn(&State) -> f64| all().map(|state| part(state).abs()).fold(0.0, f64::max);
    let positions =
        |from: f64, choose: fn(f64, f64) -> f64| all().map(|state| state.position).fold(from, choose);
    let extent = positions(f64::NEG_INFINITY, f64::max) - positions(f64::INFINITY, f64::min);
    let rounding = 12.0 * f64::EPSILON * largest(|state| state.position);
    let next = begins.iter().skip(1).copied().chain([transit.end()]);
    let mut worst: f64 = 0.0;
    for (end, begin) in ends.iter().zip(next) {
        let off = |one: f64, other: f64, scale: f64| {
            let apart = (one - other).abs();
            if apart == 0.0 { 0.0 } else { apart / scale }
        };
        let apart = (end.position - begin.position).abs() - rounding;
        worst = worst.max(off(apart.max(0.0), 0.0, extent));
        // What full jerk makes of an ulp of the acceleration is an ulp of the velocity.
        let hardest = largest(|state| state.acceleration);
        let fastest = largest(|state| state.velocity).max(0.05 * hardest * hardest / jerk);
        worst = worst.max(off(end.velocity, begin.velocity, fastest));
        worst = worst.max(off(end.acceleration, begin.acceleration, largest(|state| state.acceleration)));
    }
    worst
}
