//! Nguyen, Ng and Chen (2008), the trigonometric model: a hundred moves solved at 60 digits.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod common;

use common::polynomial_problem;
use planner::{Law, plan_trigonometric};
use serde::Deserialize;

/// Of the total duration [1].
const DURATION: f64 = 1e-12;
/// Of the distance [1].
const POSITION: f64 = 1e-13;
/// Of the limit, or of the peak speed [1].
const DERIVATIVE: f64 = 1e-11;

#[derive(Deserialize)]
struct Record {
    id: u32,
    s: f64,
    v_max: f64,
    a_max: f64,
    j_peak: f64,
    case: String,
    #[serde(rename = "T")]
    durations: [f64; 7],
    total: f64,
    a_peak: f64,
    v_peak: f64,
    samples: Vec<[f64; 5]>,
}

#[track_caller]
fn close(name: &str, ours: f64, expected: f64, tolerance: f64) {
    let off = (ours - expected).abs();
    assert!(off <= tolerance, "{name}: {ours} is {off:e} from {expected}, allowed {tolerance:e}");
}

fn check(record: &Record, direction: f64) {
    let Record { id, s, v_max, a_max, j_peak, case, durations, total, a_peak, v_peak, samples } = record;
    let problem = polynomial_problem(0.0, direction * s, &[*v_max, *a_max, *j_peak]);
    let planned = plan_trigonometric(&problem).unwrap();
    let name = format!("record {id}");
    close(&name, planned.duration(), *total, DURATION * total);
    close(&name, planned.classification().feed_rate, *v_peak, DERIVATIVE * v_peak);
    // The records leave the point out: `C1` is `C.1`.
    let six_case = planned.classification().six_case.map(|case| case.name().replace('.', ""));
    assert_eq!(six_case.as_deref(), Some(case.as_str()), "{name}");
    let ours: Vec<f64> =
        planned.segments().iter().map(|piece| piece.duration).filter(|&t| t > DURATION * total).collect();
    let expected: Vec<f64> = durations.iter().copied().filter(|&t| t > DURATION * total).collect();
    assert_eq!(ours.len(), expected.len(), "{name}: {ours:?} {expected:?}");
    for (ours, expected) in ours.iter().zip(&expected) {
        close(&name, *ours, *expected, DURATION * total);
    }
    let first = planned.segments()[0];
    assert_eq!(first.law, Law::CosineJerk { peak: direction * j_peak });
    close(&name, first.end().acceleration, direction * a_peak, DERIVATIVE * a_peak);
    for &[t, x, v, a, j] in samples {
        let ours = planned.at(t);
        // A rounding of the time is worth as much as the next derivative.
        let late = 4.0 * f64::EPSILON * t;
        let snap = std::f64::consts::PI * j_peak / durations[0];
        close(&name, ours.state.position, direction * x, POSITION * s + late * v_peak);
        close(&name, ours.state.velocity, direction * v, DERIVATIVE * v_peak + late * a_peak);
        close(&name, ours.state.acceleration, direction * a, DERIVATIVE * a_peak + late * j_peak);
        close(&name, ours.jerk, direction * j, DERIVATIVE * j_peak + late * snap);
    }
    let last = planned.segments().last().unwrap().end().position;
    close(&name, last, direction * s, POSITION * s);
}

#[test]
fn moves_solved_at_sixty_digits() {
    let records: Vec<Record> = serde_json::from_str(include_str!("vectors/trigonometric.json")).unwrap();
    for record in &records {
        check(record, 1.0);
        check(record, -1.0);
    }
    assert_eq!(records.len(), 100);
}

/// Limits and distances at which a hold or the cruise is exactly zero, in numbers that are not: no piece is left that is all rounding.
#[test]
fn no_piece_is_a_rounding() {
    let mut ties = 0;
    for tenths in 1..=40 {
        for third in 1..=9 {
            let (acceleration, jerk) = (0.1 * f64::from(tenths), 1.0 / 3.0 * f64::from(third));
            let pulse = acceleration / jerk;
            // The velocity at which the acceleration is just reached, and twice that; the least distance that takes it, and a longer one.
            for velocity in [acceleration * pulse, 2.0 * acceleration * pulse, 0.7 * acceleration * pulse] {
                let ramp = if velocity * jerk > acceleration * acceleration {
                    velocity / acceleration + pulse
                } else {
                    2.0 * (velocity / jerk).sqrt()
                };
                for distance in [velocity * ramp, 2.0 * acceleration * pulse * pulse, 3.0 * velocity * ramp] {
                    let problem = polynomial_problem(0.0, distance, &[velocity, acceleration, 2.0 * jerk]);
                    let planned = plan_trigonometric(&problem).unwrap();
                    let shortest =
                        planned.segments().iter().map(|piece| piece.duration).fold(f64::MAX, f64::min);
                    assert!(
                        shortest > 1e-14 * planned.duration(),
                        "{shortest:e} s of {} s at {distance}, {velocity}, {acceleration}, {jerk}",
                        planned.duration()
                    );
                    ties += usize::from(planned.segments().len() < 7);
                    let third = planner::plan_polynomial(
                        &polynomial_problem(0.0, distance, &[velocity, acceleration, jerk]),
                        3,
                    );
                    // The same recursion: as many pieces.
                    assert_eq!(third.unwrap().to_profile().segments().len(), planned.segments().len());
                }
            }
        }
    }
    assert!(ties > 1000, "{ties}");
}
