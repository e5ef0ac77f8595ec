//! The digest against `vectors/digest.json`, which was made with the reference implementation of XXH3.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may panic as tests do")]

use proto::{Digest, RaggedColumns, pb::SetpointColumns};
use serde_json::Value;

const VECTORS: &str = include_str!("../vectors/digest.json");

#[test]
fn digests_are_those_of_the_reference_implementation() {
    let file: Value = serde_json::from_str(VECTORS).unwrap();
    let vectors = file["vectors"].as_array().unwrap();
    assert_eq!(vectors.len(), 9);
    for vector in vectors {
        check(vector);
    }
}

/// Cycle by cycle, and as columns.
fn check(vector: &Value) {
    let name = vector["name"].as_str().unwrap();
    let before = Digest::from(hex(&vector["before"]));
    let cycles = vector["cycles"].as_array().unwrap();
    let first_cycle = cycles[0]["cycle"].as_u64().unwrap();
    let expected: Vec<Digest> = cycles.iter().map(|cycle| hex(&cycle["digest"]).into()).collect();

    let mut digest = before;
    let mut rows = Vec::new();
    for (cycle, expected) in cycles.iter().zip(&expected) {
        let axes: Vec<[f64; 4]> = cycle["bits"].as_array().unwrap().iter().map(axis_of_bits).collect();
        let decimal: Vec<[f64; 4]> = cycle["axes"].as_array().unwrap().iter().map(axis_of_decimals).collect();
        assert_eq!(bits(&decimal), bits(&axes), "{name}");
        digest = digest.then(cycle["cycle"].as_u64().unwrap(), axes.iter().copied());
        assert_eq!(digest, *expected, "{name}");
        assert_eq!(digest.to_string(), cycle["digest"], "{name}");
        rows.push(axes);
    }

    let columns = columns(&rows);
    let rolled: Vec<Digest> = before.rolling(first_cycle, &columns).unwrap().collect();
    assert_eq!(rolled, expected, "{name}");
}

#[test]
fn ragged_columns_are_refused() {
    let whole = columns(&[vec![[1.0; 4]; 2], vec![[2.0; 4]; 2]]);
    assert_eq!(Digest::ZERO.rolling(1, &whole).unwrap().count(), 2);

    let mut short = whole.clone();
    short.jerk.pop();
    let error = Digest::ZERO.rolling(1, &short).err().unwrap();
    assert_eq!(error, RaggedColumns { cycles: 2, lengths: [4, 4, 4, 3] });
    assert_eq!(
        error.to_string(),
        "columns of 4 positions, 4 velocities, 4 accelerations and 3 jerks do not make 2 cycles: \
         each needs cycles x axes values, and at least one axis"
    );
    for cycles in [0, 3, u32::MAX] {
        assert!(Digest::ZERO.rolling(1, &SetpointColumns { cycles, ..whole.clone() }).is_err(), "{cycles}");
    }
}

#[test]
fn columns_without_axes_hold_no_cycles() {
    assert_eq!(Digest::ZERO.rolling(1, &SetpointColumns::default()).unwrap().last(), None);
    let columns = SetpointColumns { cycles: u32::MAX, ..Default::default() };
    assert!(Digest::ZERO.rolling(1, &columns).is_err());
}

#[test]
fn a_peer_may_name_the_last_cycle_there_is() {
    let columns = columns(&[vec![[1.0; 4]], vec![[2.0; 4]]]);
    assert_eq!(Digest::ZERO.rolling(u64::MAX, &columns).unwrap().count(), 2);
}

fn columns(rows: &[Vec<[f64; 4]>]) -> SetpointColumns {
    let axes = rows[0].len();
    let column =
        |which: usize| (0..axes).flat_map(|axis| rows.iter().map(move |row| row[axis][which])).collect();
    SetpointColumns {
        cycles: rows.len().try_into().unwrap(),
        position: column(0),
        velocity: column(1),
        acceleration: column(2),
        jerk: column(3),
    }
}

fn hex(value: &Value) -> u64 {
    u64::from_str_radix(value.as_str().unwrap(), 16).unwrap()
}

fn axis_of_bits(axis: &Value) -> [f64; 4] {
    [0, 1, 2, 3].map(|which| f64::from_bits(hex(&axis[which])))
}

fn axis_of_decimals(axis: &Value) -> [f64; 4] {
    [0, 1, 2, 3].map(|which| axis[which].as_f64().unwrap())
}

fn bits(axes: &[[f64; 4]]) -> Vec<u64> {
    axes.iter().flatten().map(|value| value.to_bits()).collect()
}
