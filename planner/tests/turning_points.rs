//! The zeros of every derivative of pieces of polynomial motion, which is where a certificate looks for extremes, measured in units in the
//! last place against zeros of 32 digits (`vectors/turning_points.py`).

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use planner::{Derivatives, Law, Segment, State};
use serde::Deserialize;

/// How far a zero may be from where it is [units in the last place].
const ULPS: f64 = 4.0;

#[derive(Deserialize)]
struct Record {
    kind: String,
    duration: f64,
    values: Vec<f64>,
    /// The nearest double, and what is missing.
    zeros: Vec<[f64; 2]>,
}

fn piece(Record { duration, values, .. }: &Record) -> Segment {
    let start = State { position: values[0], velocity: values[1], acceleration: values[2] };
    let law = Law::Polynomial(Derivatives::new(&values[3..]).unwrap());
    Segment { duration: *duration, start, law }
}

/// The most that a zero is off [units in the last place].
fn farthest(record: &Record, times: &[f64]) -> f64 {
    let inside = &times[1..times.len() - 1];
    assert_eq!(inside.len(), record.zeros.len(), "{}: {inside:?} {:?}", record.kind, record.zeros);
    let off = inside.iter().zip(&record.zeros).map(|(ours, [nearest, missing])| {
        let ulp = nearest.next_up() - nearest;
        ((ours - nearest) - missing).abs() / ulp
    });
    off.fold(0.0, f64::max)
}

#[test]
fn zeros_are_good_to_four_ulps() {
    let records: Vec<Record> = serde_json::from_str(include_str!("vectors/turning_points.json")).unwrap();
    assert_eq!(records.len(), 192);
    let (mut settled, mut plain) = (0.0f64, 0.0f64);
    for record in &records {
        let piece = piece(record);
        settled = settled.max(farthest(record, &piece.settled_turning_points()));
        plain = plain.max(farthest(record, &piece.turning_points()));
    }
    assert!(settled <= ULPS, "{settled} ulp");
    // What the judge's own digits are for: without them the zeros near the start of a piece are off by more than that.
    assert!(plain > ULPS, "{plain} ulp");
    println!("farthest: {settled} ulp, and {plain} ulp in plain arithmetic");
}
