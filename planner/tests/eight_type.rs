//! Bui, Le and Doan (2021): the eighteen rows of its table 2, and five hundred moves solved at 60 digits.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use common::record::{VELOCITY, check_durations, check_end, check_samples, close};
use planner::{Limits, Problem, ShortPathPolicy, State, Why, plan_move};
use serde::Deserialize;

/// Of the least length of a path [1].
const LENGTH: f64 = 1e-12;

#[derive(Deserialize)]
struct Record {
    id: u32,
    s: f64,
    v_s: f64,
    v_e: f64,
    v_cf: f64,
    a_max: f64,
    j_max: f64,
    dir: f64,
    min_length: f64,
    strict: Expected,
    closest: Expected,
    paper: Expected,
    printed: Option<Printed>,
}

#[derive(Deserialize)]
struct Expected {
    feasible: bool,
    r#type: String,
    #[serde(rename = "T")]
    durations: Vec<f64>,
    total: Option<f64>,
    v_peak: Option<f64>,
    v_e: Option<f64>,
    samples: Vec<[f64; 4]>,
    type_ambiguous: bool,
    times_ambiguous: bool,
}

#[derive(Deserialize)]
struct Printed {
    r#type: String,
    v_max: f64,
    total: f64,
}

impl Record {
    fn problem(&self, short_path: ShortPathPolicy) -> Problem {
        let start = State { velocity: self.v_s, ..State::default() };
        let goal = State { position: self.s, velocity: self.v_e, acceleration: 0.0 };
        let limits = Limits::symmetric(self.v_cf, self.a_max, self.j_max).unwrap();
        Problem::new(start, goal, limits, short_path).unwrap()
    }

    fn check(&self, policy: ShortPathPolicy, expected: &Expected) {
        let name = format!("record {} ({policy:?})", self.id);
        let planned = plan_move(&self.problem(policy));
        if !expected.feasible {
            let refusal = planned.expect_err(&name);
            let Why::PathTooShort { needed, .. } = refusal.as_slice()[0].why else {
                panic!("{name}: {refusal}")
            };
            let least = self.dir * self.min_length;
            close(&name, "least length", needed, least, LENGTH * least.abs());
            return;
        }
        let planned = planned.expect(&name);
        if !expected.type_ambiguous {
            let kind = planned.classification().eight_type.map_or("0", |kind| kind.name());
            assert_eq!(kind, expected.r#type, "{name}");
        }
        let total = expected.total.unwrap();
        if !expected.times_ambiguous {
            check_durations(&name, &planned, &expected.durations, total);
            let (peak, end) = (expected.v_peak.unwrap(), expected.v_e.unwrap());
            close(&name, "peak", planned.classification().feed_rate, peak.abs(), VELOCITY * peak.abs());
            close(&name, "end velocity", planned.reached().velocity, end, VELOCITY * peak.abs());
            check_samples(&name, &planned, &expected.samples, self.s, peak, self.a_max);
        }
        check_end(&name, &planned, self.s);
    }
}

fn records(json: &str) -> Vec<Record> {
    serde_json::from_str(json).unwrap()
}

fn check_all(json: &str) -> usize {
    let records = records(json);
    for record in &records {
        record.check(ShortPathPolicy::Reject, &record.strict);
        record.check(ShortPathPolicy::NearestVelocity, &record.closest);
        record.check(ShortPathPolicy::MatchStartVelocity, &record.paper);
    }
    records.len()
}

#[test]
fn table_2_of_bui_le_doan() {
    assert_eq!(check_all(include_str!("vectors/eight_type_table2.json")), 18);
}

/// As printed, with v_e = 0.05 in group 2 and v_s = 0.05 in group 3, where 0.005 is a misprint.
#[test]
fn table_2_of_bui_le_doan_as_printed() {
    for record in records(include_str!("vectors/eight_type_table2.json")) {
        let printed = record.printed.as_ref().unwrap();
        let planned = plan_move(&record.problem(ShortPathPolicy::MatchStartVelocity)).unwrap();
        let name = format!("row {}", record.id);
        assert_eq!(planned.classification().eight_type.unwrap().name(), printed.r#type, "{name}");
        close(&name, "v_max", planned.classification().feed_rate, printed.v_max, 0.5001e-4);
        close(&name, "total", planned.duration(), printed.total, 0.5001e-4);
    }
}

#[test]
fn moves_solved_at_sixty_digits() {
    assert_eq!(check_all(include_str!("vectors/eight_type.json")), 500);
}
