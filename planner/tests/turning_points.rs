//! The zeros of every derivative of pieces of polynomial motion, which is where a certificate says that extremes are, measured in units in
//! the last place against zeros of 32 digits (`vectors/turning_points.py`).

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use planner::{
    AxisKind, AxisPlan, Classification, CycleTime, Derivatives, Law, LimitsSpec, Method, Plan, Profile,
    Quantity, Segment, State, certify,
};
use serde::Deserialize;

/// How far a zero may be from where it is [units in the last place].
const ULPS: f64 = 4.0;

#[derive(Deserialize)]
struct Record {
    kind: String,
    duration: f64,
    values: Vec<f64>,
    zeros: Vec<Zero>,
}

/// Of which derivative, the nearest double, and what is missing.
#[derive(Clone, Copy, Deserialize)]
struct Zero(usize, f64, f64);

impl Zero {
    /// How far `ours` is off [units in the last place].
    fn ulps(self, ours: f64) -> f64 {
        let Self(_, nearest, missing) = self;
        ((ours - nearest) - missing).abs() / (nearest.next_up() - nearest)
    }
}

fn records() -> Vec<Record> {
    serde_json::from_str(include_str!("vectors/turning_points.json")).unwrap()
}

fn piece(Record { duration, values, .. }: &Record) -> Segment {
    let start = State { position: values[0], velocity: values[1], acceleration: values[2] };
    let law = Law::Polynomial(Derivatives::new(&values[3..]).unwrap());
    Segment { duration: *duration, start, law }
}

#[test]
fn zeros_are_good_to_four_ulps() {
    let (mut settled, mut plain, mut count) = (0.0f64, 0.0f64, 0);
    for record in records() {
        let piece = piece(&record);
        let times = piece.turning_points();
        let inside = &times[1..times.len() - 1];
        assert_eq!(inside.len(), record.zeros.len(), "{}: {inside:?}", record.kind);
        for (&near, zero) in inside.iter().zip(&record.zeros) {
            plain = plain.max(zero.ulps(near));
            settled = settled.max(zero.ulps(piece.zero_near(zero.0, near, 1e-4 * piece.duration)));
            count += 1;
        }
    }
    println!("{count} zeros: the farthest is {settled} ulp off, and {plain} ulp in plain arithmetic");
    assert!(count > 4000, "{count}");
    assert!(settled <= ULPS, "{settled} ulp");
    // What twice the digits are for.
    assert!(plain > ULPS, "{plain} ulp");
}

/// Each extreme that the judge finds inside a piece is where the next derivative is zero.
#[test]
fn a_certificate_says_when_to_four_ulps() {
    let (mut farthest, mut count) = (0.0f64, 0);
    for record in records() {
        let piece = piece(&record);
        let limits = LimitsSpec {
            max_velocity: 1e9,
            max_acceleration: 1e9,
            max_jerk: 1e9,
            max_snap: Some(1e9),
            min_position: Some(-1e9),
            max_position: Some(1e9),
            ..LimitsSpec::default()
        };
        let axis = AxisPlan {
            axis: "x".into(),
            kind: AxisKind::Prismatic,
            limits: limits.try_into().unwrap(),
            goal: piece.end(),
            profile: Profile::new([piece], piece.end()),
            adjustments: Vec::new(),
            classification: Classification::default(),
            pvt_regions: Vec::new(),
        };
        let promised = vec![Quantity::Velocity];
        let plan = Plan::new(Method::default(), promised, CycleTime::MILLISECOND, vec![axis]).unwrap();
        for check in certify(&plan).limits {
            let inside = check.extremum.is_finite() && check.at_time > 0.0 && check.at_time < record.duration;
            let order = check.quantity.order().unwrap() + 1;
            if inside && order + 1 < record.values.len() {
                let of_next = record.zeros.iter().filter(|zero| zero.0 == order);
                let off = of_next.map(|zero| zero.ulps(check.at_time)).fold(f64::INFINITY, f64::min);
                farthest = farthest.max(off);
                count += 1;
            }
        }
    }
    println!("{count} extremes: the farthest is {farthest} ulp off");
    assert!(count > 30, "{count}");
    assert!(farthest <= ULPS, "{farthest} ulp");
}

#[derive(Deserialize)]
struct Pulse {
    duration: f64,
    peak: f64,
    velocity: f64,
    acceleration: f64,
    zeros: Vec<Zero>,
}

/// Of a pulse that begins anywhere (no family plans one), `vectors/cosine_turning_points.py`: to 4 ulp of the duration, and what the velocity and
/// the acceleration do not tell by their own roundings.
#[test]
fn a_cosine_turns_where_it_does() {
    /// Of the terms of a velocity or an acceleration [1]: `tests/extremes.rs` measures 4e-15 for the larger of both.
    const ROUNDING: f64 = 4e-15;
    let pulses: Vec<Pulse> =
        serde_json::from_str(include_str!("vectors/cosine_turning_points.json")).unwrap();
    assert_eq!(pulses.len(), 100);
    let (mut count, mut farthest) = (0, 0.0f64);
    for Pulse { duration, peak, velocity, acceleration, zeros } in pulses {
        let start = State { position: 0.0, velocity, acceleration };
        let piece = Segment { duration, start, law: Law::CosineJerk { peak } };
        let times = piece.turning_points();
        for Zero(order, nearest, missing) in zeros {
            let off = |time: &f64| ((time - nearest) - missing).abs();
            let nearest_time = times.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            let at = piece.at(nearest);
            let (terms, slope) = match order {
                1 => (
                    velocity.abs() + nearest * (acceleration.abs() + 0.25 * (peak * nearest).abs()),
                    at.state.acceleration,
                ),
                _ => (acceleration.abs() + 0.5 * (peak * nearest).abs(), at.jerk),
            };
            let allowed = 4.0 * f64::EPSILON * duration + ROUNDING * terms / slope.abs();
            assert!(off(&nearest_time) <= allowed, "order {order}: {} of {allowed}", off(&nearest_time));
            farthest = farthest.max(off(&nearest_time) / (f64::EPSILON * duration));
            count += 1;
        }
    }
    println!("{count} zeros: the farthest is {farthest} eps of the duration off");
    assert!(count > 150, "{count}");
}
