//! Li and Chen, Research on the asymmetric S-type curve based on the position: its four simulations, and two hundred and
//! fifty moves solved at 60 digits.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test may fail by panicking")]

mod common;

use common::record::{VELOCITY, check_durations, check_end, check_samples, close};
use planner::{
    AxisKind, AxisMoveSpec, Family, Judged, Limits, LimitsSpec, Move, Problem, Quantity, Request,
    RequestSpec, ShortPathPolicy, State, Synchronization, plan_move, violations,
};
use serde::Deserialize;

#[derive(Deserialize)]
struct Record {
    id: u32,
    #[serde(rename = "L")]
    length: f64,
    v_max: f64,
    a_max: f64,
    d_max: f64,
    j_max: f64,
    r#type: u32,
    #[serde(rename = "T")]
    durations: Vec<f64>,
    v_peak: f64,
    total: f64,
    type_ambiguous: bool,
    samples: Vec<[f64; 4]>,
    symmetric: Option<Symmetric>,
}

/// The same with the acceleration for the deceleration, too.
#[derive(Deserialize)]
struct Symmetric {
    #[serde(rename = "T")]
    durations: Vec<f64>,
    v_peak: f64,
    total: f64,
}

fn limits(record: &Record, deceleration: f64) -> Limits {
    let spec = LimitsSpec {
        max_velocity: record.v_max,
        max_acceleration: record.a_max,
        max_deceleration: Some(deceleration),
        max_jerk: record.j_max,
        ..LimitsSpec::default()
    };
    spec.try_into().unwrap()
}

fn planned(length: f64, limits: Limits) -> Move {
    let problem =
        Problem::new(State::at_rest(0.0), State::at_rest(length), limits, ShortPathPolicy::Reject).unwrap();
    let planned = plan_move(&problem).unwrap();
    assert_eq!(violations(&planned.to_profile(), problem.limits(), problem.goal()), []);
    planned
}

fn check_peak(name: &str, planned: &Move, peak: f64) {
    close(name, "peak", planned.classification().feed_rate, peak.abs(), VELOCITY * peak.abs());
}

fn check(record: &Record) {
    let name = format!("record {}", record.id);
    let ours = planned(record.length, limits(record, record.d_max));
    if !record.type_ambiguous {
        let kind = ours.classification().asymmetric_type.expect(&name).name();
        assert_eq!(kind, record.r#type.to_string(), "{name}");
        assert_eq!(
            ours.classification().eight_type.is_some(),
            record.a_max.to_bits() == record.d_max.to_bits()
        );
    }
    check_durations(&name, &ours, &record.durations, record.total);
    check_peak(&name, &ours, record.v_peak);
    let hardest = record.a_max.max(record.d_max);
    check_samples(&name, &ours, &record.samples, record.length, record.v_peak, hardest);
    check_end(&name, &ours, record.length);
    if let Some(symmetric) = &record.symmetric {
        let ours = planned(record.length, limits(record, record.a_max));
        check_durations(&name, &ours, &symmetric.durations, symmetric.total);
        check_peak(&name, &ours, symmetric.v_peak);
    }
}

fn check_all(json: &str) -> usize {
    let records: Vec<Record> = serde_json::from_str(json).unwrap();
    records.iter().for_each(check);
    records.len()
}

#[test]
fn simulations_of_li_and_chen_at_sixty_digits() {
    assert_eq!(check_all(include_str!("vectors/asymmetric_paper.json")), 4);
}

#[test]
fn moves_solved_at_sixty_digits() {
    assert_eq!(check_all(include_str!("vectors/asymmetric.json")), 252);
}

/// J = 160000 p/s³, A = 100000 p/s², D = 160000 p/s², and V = 200000 p/s, of which the paper prints a tenth; through a
/// request, on an axis that counts pulses.
fn simulated(length: f64, deceleration: f64) -> Judged {
    let axis = AxisMoveSpec {
        axis: "motor".into(),
        kind: Ok(AxisKind::Pulses),
        start: State::at_rest(0.0),
        goal: State::at_rest(length),
        limits: LimitsSpec {
            max_velocity: 200_000.0,
            max_acceleration: 100_000.0,
            max_deceleration: Some(deceleration),
            max_jerk: 160_000.0,
            ..LimitsSpec::default()
        },
    };
    let spec = RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    };
    let judged = Judged::answer(&Request::try_from(spec).unwrap()).unwrap();
    assert!(judged.certificate().passed());
    judged
}

/// One figure of the paper: the duration and the peak speed, asymmetric and symmetric, to as many digits as it gives.
fn figure(length: f64, kind: &str, asymmetric: (f64, f64), symmetric: (f64, f64), last_digits: (f64, f64)) {
    for (deceleration, (total, peak)) in [(160_000.0, asymmetric), (100_000.0, symmetric)] {
        let judged = simulated(length, deceleration);
        let classification = judged.plan().axes()[0].classification;
        let name = format!("{length} p, D = {deceleration} p/s²");
        if deceleration > 100_000.0 {
            assert_eq!(classification.asymmetric_type.unwrap().name(), kind, "{name}");
            assert_eq!((classification.eight_type, classification.six_case), (None, None), "{name}");
        }
        close(&name, "duration", judged.plan().duration(), total, last_digits.0);
        close(&name, "peak", classification.feed_rate, peak, last_digits.1);
    }
}

#[test]
fn figure_3_of_li_and_chen_seven_pieces() {
    figure(600_000.0, "1", (5.437, 200_000.0), (5.625, 200_000.0), (0.6e-3, 1e-9));
}

#[test]
fn figure_4_of_li_and_chen_no_cruise() {
    figure(480_000.0, "2", (4.84, 198_000.0), (5.05, 190_000.0), (0.5e-2, 500.0));
}

#[test]
fn figure_5_of_li_and_chen_constant_acceleration_only() {
    figure(300_000.0, "4", (4.038, 149_000.0), (4.145, 145_000.0), (0.5e-3, 500.0));
}

#[test]
fn figure_6_of_li_and_chen_nothing_constant() {
    figure(30_000.0, "3", (1.817, 33_000.0), (1.817, 33_000.0), (0.5e-3, 500.0));
}

/// While it slows down, the deceleration holds it back.
#[test]
fn the_explanation_tells_speeding_up_from_slowing_down() {
    let judged = simulated(600_000.0, 160_000.0);
    let bindings: Vec<_> =
        judged.explanation().bindings.iter().map(|binding| (binding.quantity, binding.from_time)).collect();
    let expected = [
        (Quantity::Jerk, 0.0),
        (Quantity::Acceleration, 0.625),
        (Quantity::Jerk, 2.0),
        (Quantity::Velocity, 2.625),
        (Quantity::Jerk, 3.1875),
        (Quantity::Acceleration, 4.1875),
        (Quantity::Jerk, 4.4375),
    ];
    assert_eq!(bindings.len(), expected.len(), "{bindings:?}");
    for (ours, expected) in bindings.iter().zip(expected) {
        assert_eq!(ours.0, expected.0);
        close("bindings", "begin", ours.1, expected.1, 1e-12);
    }
    let checked = |quantity| {
        let check = judged.certificate().limits.iter().find(|check| check.quantity == quantity).unwrap();
        (check.limit, check.extremum.abs())
    };
    let (limit, extremum) = checked(Quantity::Acceleration);
    close("certificate", "acceleration", extremum, limit, 1e-9 * limit);
}
