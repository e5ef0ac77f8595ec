//! Bui, Le and Doan (2021): the eighteen rows of its table 2, and five hundred moves solved at 60 digits.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::float_cmp,
    reason = "a test may fail by panicking"
)]

use planner::{Limits, Move, Problem, ShortPathPolicy, State, plan_move};
use serde::Deserialize;

/// Of the total duration [1].
const DURATION: f64 = 1e-12;
/// Of the distance [1]; or two units in the last place of the position, whichever is larger.
const POSITION: f64 = 1e-13;
/// Of the acceleration limit [1].
const ACCELERATION: f64 = 1e-11;
/// Of the peak speed [1].
const VELOCITY: f64 = 1e-12;

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
            let error = planned.expect_err(&name).to_string();
            assert!(error.contains("too short"), "{name}: {error}");
            let needed = (self.dir * self.min_length).to_string();
            let digits = &needed[..needed.len().min(10)];
            assert!(error.contains(digits), "{name}: {error} does not name {needed}");
            return;
        }
        let planned = planned.expect(&name);
        if !expected.type_ambiguous {
            let kind = planned.classification().eight_type.map_or("0", |kind| kind.name());
            assert_eq!(kind, expected.r#type, "{name}");
        }
        let total = expected.total.unwrap();
        if !expected.times_ambiguous {
            close(&name, "total", planned.duration(), total, DURATION * total);
            self.check_durations(&name, &planned, expected, total);
            let (peak, end) = (expected.v_peak.unwrap(), expected.v_e.unwrap());
            close(&name, "peak", planned.classification().feed_rate, peak.abs(), VELOCITY * peak.abs());
            close(&name, "end velocity", planned.reached().velocity, end, VELOCITY * peak.abs());
            for &[t, x, v, a] in &expected.samples {
                let state = planned.at(t).state;
                close(&name, "position", state.position, x, position_tolerance(self.s, x));
                close(&name, "velocity", state.velocity, v, VELOCITY * peak.abs());
                close(&name, "acceleration", state.acceleration, a, ACCELERATION * self.a_max);
            }
        }
        // The end as integrated, not as stored.
        let integrated = planned.segments().last().map_or(0.0, |last| last.end().position);
        close(&name, "end", integrated, self.s, position_tolerance(self.s, self.s));
        assert_eq!(planned.reached().position, self.s, "{name}: reached");
    }

    fn check_durations(&self, name: &str, planned: &Move, expected: &Expected, total: f64) {
        let durations: Vec<f64> =
            expected.durations.iter().copied().filter(|&t| t > DURATION * total).collect();
        let ours: Vec<f64> = planned
            .segments()
            .iter()
            .map(|segment| segment.duration)
            .filter(|&t| t > DURATION * total)
            .collect();
        assert_eq!(ours.len(), durations.len(), "{name}: {ours:?} {durations:?}");
        for (ours, expected) in ours.iter().zip(&durations) {
            close(name, "duration", *ours, *expected, DURATION * total);
        }
    }
}

fn position_tolerance(distance: f64, position: f64) -> f64 {
    (POSITION * distance.abs()).max(2.0 * f64::EPSILON * position.abs())
}

#[track_caller]
fn close(name: &str, what: &str, ours: f64, expected: f64, tolerance: f64) {
    let off = (ours - expected).abs();
    assert!(off <= tolerance, "{name}: {what} {ours} is {off:e} from {expected}, allowed {tolerance:e}");
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
