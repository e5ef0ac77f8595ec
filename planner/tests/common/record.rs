//! Moves that were solved at 60 digits, and how near a double can come.

use planner::Move;

/// Of the total duration [1].
pub(crate) const DURATION: f64 = 1e-12;
/// Of the distance [1]; or two units in the last place of the position, whichever is larger.
pub(crate) const POSITION: f64 = 1e-13;
/// Of the acceleration limit [1].
pub(crate) const ACCELERATION: f64 = 1e-11;
/// Of the peak speed [1].
pub(crate) const VELOCITY: f64 = 1e-12;

/// Holds the pieces against the seven durations, of which some are zero.
pub(crate) fn check_durations(name: &str, planned: &Move, expected: &[f64], total: f64) {
    let lasting = |durations: Vec<f64>| -> Vec<f64> {
        durations.into_iter().filter(|&t| t > DURATION * total).collect()
    };
    let expected = lasting(expected.to_vec());
    let ours = lasting(planned.segments().iter().map(|segment| segment.duration).collect());
    assert_eq!(ours.len(), expected.len(), "{name}: {ours:?} {expected:?}");
    for (ours, expected) in ours.iter().zip(&expected) {
        close(name, "duration", *ours, *expected, DURATION * total);
    }
    close(name, "total", planned.duration(), total, DURATION * total);
}

/// Holds time, position, velocity and acceleration of each sample; `hardest` is the limit of the acceleration.
pub(crate) fn check_samples(
    name: &str,
    planned: &Move,
    samples: &[[f64; 4]],
    distance: f64,
    peak: f64,
    hardest: f64,
) {
    for &[t, x, v, a] in samples {
        let state = planned.at(t).state;
        close(name, "position", state.position, x, position_tolerance(distance, x));
        close(name, "velocity", state.velocity, v, VELOCITY * peak.abs());
        close(name, "acceleration", state.acceleration, a, ACCELERATION * hardest);
    }
}

/// Holds the end as integrated, not as stored; and as stored.
pub(crate) fn check_end(name: &str, planned: &Move, distance: f64) {
    let integrated = planned.segments().last().map_or(0.0, |last| last.end().position);
    close(name, "end", integrated, distance, position_tolerance(distance, distance));
    // The wire does not carry the sign of a zero.
    assert_eq!(planned.reached().position.to_bits(), (distance + 0.0).to_bits(), "{name}: reached");
}

pub(crate) fn position_tolerance(distance: f64, position: f64) -> f64 {
    (POSITION * distance.abs()).max(2.0 * f64::EPSILON * position.abs())
}

#[track_caller]
pub(crate) fn close(name: &str, what: &str, ours: f64, expected: f64, tolerance: f64) {
    let off = (ours - expected).abs();
    assert!(off <= tolerance, "{name}: {what} {ours} is {off:e} from {expected}, allowed {tolerance:e}");
}
