//! `portamento bench`: what it measures and how it says so; how fast anything is, no test asks.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test may fail by panicking"
)]

mod common;

use common::portamento;
use serde_json::Value;

/// Rows that hold against a peer, and rows without one.
const BESIDE: [&str; 14] = [
    "rest to rest",
    "start and end velocity",
    "asymmetric, rest to rest",
    "asymmetric",
    "any state to any state",
    "order 4",
    "order 5",
    "order 5, with pieces",
    "trigonometric",
    "generator step",
    "3 axes at one time",
    "6 axes at one time",
    "one setpoint",
    "setpoint of a batch",
];
const ALONE: [&str; 6] =
    ["PVT command", "judge 6 axes", "encode a plan", "decode a plan", "encode a batch", "decode a batch"];
const KEYS: [&str; 8] = ["name", "ns", "p999Ns", "peer", "peerNs", "ratio", "budget", "met"];

#[track_caller]
fn number(row: &Value, key: &str) -> f64 {
    row[key].as_f64().unwrap_or_else(|| panic!("{key} of {row}"))
}

#[test]
fn every_row_is_measured_beside_its_peer_on_answers_that_were_checked() {
    let rows = portamento(&["bench", "--json", "--time", "1ms"], "").with(0).lines();
    let names: Vec<&str> = rows.iter().map(|row| row["name"].as_str().unwrap()).collect();
    let expected: Vec<&str> = BESIDE.into_iter().chain(ALONE).chain(["splice 6 axes"]).collect();
    assert_eq!(names.len(), expected.len(), "{names:?}");
    assert!(expected.iter().all(|name| names.contains(name)), "{names:?}");
    for row in &rows {
        let keys: Vec<&str> = row.as_object().unwrap().keys().map(String::as_str).collect();
        assert_eq!(keys, KEYS, "{row}");
        assert!(number(row, "ns") > 0.0, "{row}");
        let alone = ALONE.contains(&row["name"].as_str().unwrap());
        if alone {
            assert!(["peer", "peerNs", "ratio"].iter().all(|key| row[*key].is_null()), "{row}");
        } else {
            assert_eq!(row["peer"], "rsruckig", "{row}");
            let ratio = number(row, "ns") / number(row, "peerNs");
            assert!((number(row, "ratio") - ratio).abs() <= 1e-12 * ratio, "{row}");
        }
        assert_eq!(row["budget"].is_null(), row["met"].is_null(), "{row}");
    }
    let budgets: Vec<(&str, &str)> =
        rows.iter().filter_map(|row| Some((row["name"].as_str()?, row["budget"].as_str()?))).collect();
    let expected = [
        ("rest to rest", "1/6"),
        ("start and end velocity", "1/4"),
        ("asymmetric, rest to rest", "1/5"),
        ("any state to any state", "1/2; 1500 ns"),
        ("order 5", "1/1.2"),
        ("order 5, with pieces", "1/1.2"),
        ("trigonometric", "1/5"),
        ("PVT command", "150 ns; 1000 ns"),
        ("generator step", "10 ns"),
        ("6 axes at one time", "1/2"),
        ("setpoint of a batch", "2 ns"),
    ];
    assert_eq!(budgets, expected);
    // Where one of many inputs may take longer than most.
    let tails: Vec<&str> = rows
        .iter()
        .filter(|row| row["p999Ns"].is_number())
        .map(|row| row["name"].as_str().unwrap())
        .collect();
    assert!(tails.contains(&"any state to any state") && tails.contains(&"PVT command"), "{tails:?}");
    assert!(!tails.contains(&"judge 6 axes"), "{tails:?}");
}

#[test]
fn rows_are_chosen_by_name_and_shown_in_eighty_columns() {
    let shown = portamento(&["bench", "order 4", "batch", "PVT", "--time", "1ms"], "").with(0).out;
    for part in
        ["median", "99.9 %", "peer", "ratio", "budget", "met", "order 4", "encode a batch", "150 ns; 1000 ns"]
    {
        assert!(shown.contains(part), "{part}: {shown}");
    }
    assert!(!shown.contains("splice") && !shown.contains("order 5"), "{shown}");
    assert!(shown.lines().all(|line| line.chars().count() <= 80), "{shown}");
}

#[test]
fn what_cannot_be_measured_is_said() {
    let refused = portamento(&["bench", "knots"], "").with(2).err;
    assert!(refused.contains("no row has such a name") && refused.contains("rest to rest"), "{refused}");
    let refused = portamento(&["bench", "--time", "2h"], "").with(2).err;
    assert!(refused.contains("--time"), "{refused}");
    let refused = portamento(&["bench", "--time", "100us"], "").with(2).err;
    assert!(refused.contains("1ms to 60s"), "{refused}");
    let refused = portamento(&["bench", "--endpoint", "http://127.0.0.1:1"], "").with(2).err;
    assert!(refused.contains("leave --endpoint out"), "{refused}");
}
