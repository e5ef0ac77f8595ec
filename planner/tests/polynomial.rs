//! Nguyen, Ng and Chen (2008), the model of order n: moves of every order, solved at 60 digits.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use common::{higher_limits, polynomial_problem};
use planner::{Quantity, plan_polynomial};
use serde::Deserialize;

/// Of the total duration [1].
const DURATION: f64 = 1e-12;
/// Of the distance [1].
const POSITION: f64 = 1e-13;
/// Of the peak of a derivative [1].
const DERIVATIVE: f64 = 1e-11;

#[derive(Deserialize)]
struct Record {
    id: u32,
    n: u32,
    #[serde(rename = "X")]
    limits: Vec<f64>,
    #[serde(rename = "T")]
    holds: Vec<f64>,
    #[serde(rename = "F")]
    boxes: Vec<f64>,
    total: f64,
    peaks: Vec<f64>,
    samples: Vec<Vec<f64>>,
}

#[track_caller]
fn close(name: &str, ours: f64, expected: f64, tolerance: f64) {
    let off = (ours - expected).abs();
    assert!(off <= tolerance, "{name}: {ours} is {off:e} from {expected}, allowed {tolerance:e}");
}

fn check(record: &Record, direction: f64) {
    let Record { id, n, limits, holds, boxes, total, peaks, samples } = record;
    let problem = polynomial_problem(0.0, direction * limits[0], &limits[1..]);
    let planned = plan_polynomial(&problem, *n).unwrap();
    close(&format!("record {id}: total"), planned.duration(), *total, DURATION * total);
    for (p, (ours, expected)) in planned.holds().iter().zip(holds).enumerate() {
        close(&format!("record {id}: T{}", p + 1), *ours, *expected, DURATION * total);
    }
    for (i, (ours, expected)) in planned.boxes().iter().zip(boxes).enumerate() {
        close(&format!("record {id}: F{}", i + 1), *ours, *expected, DURATION * total);
    }
    for (k, (ours, expected)) in planned.peaks().iter().zip(peaks).enumerate() {
        close(&format!("record {id}: peak {k}"), *ours, *expected, DERIVATIVE * expected);
    }
    let profile = planned.to_profile();
    close(&format!("record {id}: duration"), profile.duration(), *total, DURATION * total);
    for sample in samples {
        let t = sample[0];
        let Some((begin, segment)) = profile.timed_segments().take_while(|(begin, _)| *begin <= t).last()
        else {
            panic!("record {id}: no piece at {t}")
        };
        let ours = segment.derivatives(t - begin);
        for (k, (ours, expected)) in ours.iter().zip(&sample[1..]).enumerate() {
            let tolerance = if k == 0 { POSITION } else { DERIVATIVE };
            // A rounding of the time is worth as much as the next derivative.
            let late = 4.0 * f64::EPSILON * t * peaks[k + 1];
            let name = format!("record {id} at {t}: {}", Quantity::BY_ORDER[k]);
            close(&name, *ours, direction * expected, tolerance * peaks[k] + late);
        }
    }
    let last = profile.segments().last().unwrap().end();
    close(&format!("record {id}: end"), last.position, direction * limits[0], POSITION * limits[0]);
}

#[test]
fn moves_solved_at_sixty_digits() {
    assert_eq!(check_all(include_str!("vectors/polynomial.json"), 2..=6), 125);
}

/// Orders 7 and 8, by `vectors/polynomial_high.py`.
#[test]
fn high_orders_solved_at_sixty_digits() {
    assert_eq!(check_all(include_str!("vectors/polynomial_high.json"), 7..=8), 48);
}

fn check_all(json: &str, orders: std::ops::RangeInclusive<u32>) -> usize {
    let records: Vec<Record> = serde_json::from_str(json).unwrap();
    for record in &records {
        assert!(orders.contains(&record.n), "record {}", record.id);
        check(record, 1.0);
        check(record, -1.0);
    }
    records.len()
}

/// Limits of velocity, acceleration, jerk, snap and crackle in mm and s, and the durations of orders 2 to 5 and of the cosine.
/// The paper names 50 mm and 60 mm/s and no other limit; these are assumed.
const FIFTY_MILLIMETRES: [([f64; 5], [f64; 5]); 3] = [
    ([60.0, 600.0, 12e3, 4.8e5, 3.84e7], [0.933_333_3, 0.983_333_3, 1.008_333_3, 1.020_833_3, 1.033_333_3]),
    ([60.0, 300.0, 3e3, 6e4, 2.4e6], [1.033_333_3, 1.133_333_3, 1.183_333_3, 1.208_333_3, 1.233_333_3]),
    ([60.0, 1e3, 5e4, 5e6, 1e9], [0.893_333_3, 0.913_333_3, 0.923_333_3, 0.928_333_3, 0.933_333_3]),
];

#[test]
fn fifty_millimetres_of_nguyen_ng_and_chen() {
    for (limits, durations) in FIFTY_MILLIMETRES {
        let problem = polynomial_problem(0.0, 50.0, &limits);
        for (order, expected) in (2..=5).zip(durations) {
            let planned = plan_polynomial(&problem, order).unwrap();
            close(&format!("order {order}"), planned.duration(), expected, 0.51e-7);
            let exact: f64 = 50.0 / limits[0]
                + limits.windows(2).take(order as usize - 1).map(|pair| pair[0] / pair[1]).sum::<f64>();
            close(&format!("order {order}"), planned.duration(), exact, 1e-14);
        }
        let cosine = planner::plan_trigonometric(&problem).unwrap();
        close("cosine", cosine.duration(), durations[4], 0.51e-7);
        // A fifth order with the snap and the crackle that the cosine has: a little shorter than the cosine.
        let pulse = 2.0 * limits[1] / limits[2];
        let snap = std::f64::consts::PI * limits[2] / pulse;
        let crackle = 2.0 * std::f64::consts::PI / pulse * snap;
        let alike = polynomial_problem(0.0, 50.0, &[limits[0], limits[1], limits[2], snap, crackle]);
        let fifth = plan_polynomial(&alike, 5).unwrap().duration();
        let third = plan_polynomial(&problem, 3).unwrap().duration();
        close("in units of a/j", (fifth - third) / (limits[1] / limits[2]), 0.954_93, 1e-5);
    }
}

/// Every limit reached gives the sum of the quotients.
#[test]
fn high_orders_with_every_limit_reached() {
    let limits = [0.5, 2.0, 16.0, 256.0, 8192.0, 524_288.0, 67_108_864.0, 17_179_869_184.0];
    for order in 2..=8 {
        let problem = polynomial_problem(0.25, 4.25, &limits);
        let planned = plan_polynomial(&problem, order).unwrap();
        let exact: f64 = 4.0 / limits[0]
            + limits.windows(2).take(order as usize - 1).map(|pair| pair[0] / pair[1]).sum::<f64>();
        close(&format!("order {order}"), planned.duration(), exact, 1e-14 * exact);
        let reached: Vec<f64> = std::iter::once(4.0).chain(limits).take(order as usize + 1).collect();
        assert_eq!(planned.peaks(), reached);
        assert_eq!(planned.to_profile().segments().len(), (1 << order) - 1);
        assert_eq!(higher_limits(&limits).1.len(), 4);
    }
}

/// The names of a record, where it has them: `Classification` says which.
#[derive(Deserialize)]
struct Named {
    id: u32,
    #[serde(alias = "s", alias = "L")]
    distance: f64,
    #[serde(alias = "v_cf")]
    v_max: f64,
    a_max: f64,
    #[serde(default)]
    d_max: Option<f64>,
    j_max: f64,
    #[serde(default)]
    v_s: f64,
    #[serde(default)]
    v_e: f64,
    #[serde(default)]
    case: Option<String>,
    #[serde(default)]
    r#type: Option<u8>,
    #[serde(default)]
    strict: Option<Strict>,
    #[serde(default)]
    type_ambiguous: bool,
}

#[derive(Deserialize)]
struct Strict {
    #[serde(default)]
    r#type: Option<String>,
    #[serde(default)]
    type_ambiguous: bool,
}

/// Order 3 is the S-curve with one limit for speeding up and slowing down, and has its names: those of every record of the three papers
/// that it covers, and those of the S-curve itself, which also has the speed.
#[test]
#[expect(clippy::float_cmp, reason = "the very number given twice is one limit")]
fn the_third_order_has_the_names_of_the_s_curve() {
    let mut counts = [0; 3];
    let files = [
        include_str!("vectors/six_case_paper.json"),
        include_str!("vectors/six_case.json"),
        include_str!("vectors/asymmetric_paper.json"),
        include_str!("vectors/asymmetric.json"),
        include_str!("vectors/eight_type.json"),
    ];
    for json in files {
        for record in serde_json::from_str::<Vec<Named>>(json).unwrap() {
            let ambiguous =
                record.type_ambiguous || record.strict.as_ref().is_some_and(|strict| strict.type_ambiguous);
            let rests = record.v_s == 0.0 && record.v_e == 0.0;
            let alike = record.d_max.is_none_or(|d_max| d_max == record.a_max);
            if ambiguous || !rests || !alike || record.distance == 0.0 {
                continue;
            }
            let limits = [record.v_max.abs(), record.a_max, record.j_max];
            let problem = polynomial_problem(0.0, record.distance, &limits);
            let names = plan_polynomial(&problem, 3).unwrap().classification();
            let id = record.id;
            if let Some(case) = &record.case {
                let ours = names.six_case.map(|case| case.name().replace('.', ""));
                assert_eq!(ours.as_deref(), Some(case.as_str()), "case {id}");
                counts[0] += 1;
            }
            if let Some(kind) = record.r#type.filter(|_| record.d_max.is_some()) {
                let ours = names.asymmetric_type.map(|kind| kind.name().to_owned());
                assert_eq!(ours, Some(kind.to_string()), "asymmetric {id}");
                counts[1] += 1;
            }
            if let Some(kind) = record.strict.and_then(|strict| strict.r#type) {
                assert_eq!(
                    names.eight_type.map(planner::EightType::name),
                    Some(kind.as_str()),
                    "eight type {id}"
                );
                counts[2] += 1;
            }
            let s_curve = planner::plan_move(&problem).unwrap().classification();
            close(&format!("speed {id}"), names.feed_rate, s_curve.feed_rate, DERIVATIVE * names.feed_rate);
            let speed = names.feed_rate;
            assert_eq!(names, planner::Classification { feed_rate: speed, ..s_curve }, "{id}");
        }
    }
    assert!(counts[0] >= 200 && counts[1] >= 1 && counts[2] >= 1, "{counts:?}");
}
