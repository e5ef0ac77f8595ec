//! Blejan and Blejan, Mathematics for real-time S-curve profile generator: its four examples, and two hundred and fifty
//! moves solved at 60 digits.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test may fail by panicking")]

mod common;

use common::record::{VELOCITY, check_durations, check_end, check_samples, close};
use planner::{EightType, Limits, Move, Problem, ShortPathPolicy, SixCase, State, plan_move};
use serde::Deserialize;

#[derive(Deserialize)]
struct Record {
    id: u32,
    s: f64,
    v_max: f64,
    a_max: f64,
    j_max: f64,
    case: String,
    #[serde(rename = "T")]
    durations: Vec<f64>,
    total: f64,
    v_peak: f64,
    type_ambiguous: bool,
    samples: Vec<[f64; 4]>,
}

fn planned(distance: f64, velocity: f64, acceleration: f64, jerk: f64) -> Move {
    let limits = Limits::symmetric(velocity, acceleration, jerk).unwrap();
    let problem =
        Problem::new(State::at_rest(0.0), State::at_rest(distance), limits, ShortPathPolicy::Reject).unwrap();
    plan_move(&problem).unwrap()
}

fn case(planned: &Move) -> &'static str {
    planned.classification().six_case.unwrap().name()
}

fn check_all(json: &str) -> usize {
    let records: Vec<Record> = serde_json::from_str(json).unwrap();
    for record in &records {
        let name = format!("record {}", record.id);
        let ours = planned(record.s, record.v_max, record.a_max, record.j_max);
        if !record.type_ambiguous {
            assert_eq!(case(&ours).replace('.', ""), record.case, "{name}");
        }
        check_durations(&name, &ours, &record.durations, record.total);
        let peak = record.v_peak.abs();
        close(&name, "peak", ours.classification().feed_rate, peak, VELOCITY * peak);
        check_samples(&name, &ours, &record.samples, record.s, record.v_peak, record.a_max);
        check_end(&name, &ours, record.s);
    }
    records.len()
}

#[test]
fn examples_of_blejan_at_sixty_digits() {
    assert_eq!(check_all(include_str!("vectors/six_case_paper.json")), 4);
}

#[test]
fn moves_solved_at_sixty_digits() {
    assert_eq!(check_all(include_str!("vectors/six_case.json")), 254);
}

/// Equalities, of which the paper says nothing: with j = 1 and a = 1 both v_a = 1 and s_a = 2.
#[test]
fn ties_between_the_cases() {
    for (v, s, expected) in [
        // v = v_a: the acceleration is not taken for longer than an instant.
        (1.0, 3.0, "A"),
        (1.0, 2.0, "C.1"),
        (1.0, 1.9, "C.2"),
        // s = s_v = v·(v + 1) = 6.
        (2.0, 6.0, "D.1"),
        (2.0, 6.0 - 1e-9, "D.2"),
        // s = s_a.
        (2.0, 2.0, "B"),
        (2.0, 2.0 + 1e-9, "D.2"),
    ] {
        assert_eq!(case(&planned(s, v, 1.0, 1.0)), expected, "v = {v}, s = {s}");
    }
}

#[test]
fn names_lead_back_to_their_cases() {
    for case in SixCase::ALL {
        assert_eq!(SixCase::named(case.name()), Some(case));
    }
    assert_eq!(SixCase::named("E"), None);
    for kind in planner::AsymmetricType::ALL {
        assert_eq!(planner::AsymmetricType::named(kind.name()), Some(kind));
    }
    assert_eq!(planner::AsymmetricType::named("8A"), None);
}

/// The three papers name the same moves.
#[test]
fn the_papers_agree_on_what_is_reached() {
    for (v, s) in [(0.5, 9.0), (0.5, 0.1), (2.0, 9.0), (2.0, 3.0), (2.0, 1.0)] {
        let names = planned(s, v, 1.0, 1.0).classification();
        let expected = match names.eight_type.unwrap() {
            EightType::Type1 => ("1", vec!["D.1"]),
            EightType::Type4 => ("8", vec!["A", "C.1"]),
            EightType::Type5 => ("2", vec!["D.2"]),
            EightType::Type8A => ("3", vec!["B", "C.2"]),
            other => unreachable!("{other:?} from rest to rest"),
        };
        assert_eq!(names.asymmetric_type.unwrap().name(), expected.0);
        assert!(expected.1.contains(&names.six_case.unwrap().name()), "{names:?}");
    }
}
