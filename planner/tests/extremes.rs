//! Between two turning points everything is monotone: pieces at random, held against dense samples.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use planner::{Derivatives, Law, MAX_ORDER, MAX_TURNING_POINTS, Segment, State};

/// Of the sum of the magnitudes of all terms of a quantity [1].
const ROUNDING: f64 = 1e-13;

fn factorial(k: usize) -> f64 {
    (1..=k).map(|i| i as f64).product()
}

/// Holds every derivative up to `orders`, between each two turning points, against the values there.
fn check(segment: &Segment, scales: &[f64; MAX_ORDER + 1], orders: usize) {
    let times = segment.turning_points();
    assert!(times.len() <= MAX_TURNING_POINTS);
    assert!(times.is_sorted(), "{times:?}");
    for span in times.windows(2) {
        let (from, to) = (segment.derivatives(span[0]), segment.derivatives(span[1]));
        for step in 1..32 {
            let at = segment.derivatives(span[0] + (span[1] - span[0]) * f64::from(step) / 32.0);
            for order in 0..=orders {
                let (low, high) = (from[order].min(to[order]), from[order].max(to[order]));
                let slack = ROUNDING * scales[order];
                assert!(
                    at[order] >= low - slack && at[order] <= high + slack,
                    "order {order}: {} outside {low} to {high}: {segment:?} {times:?}",
                    at[order]
                );
            }
        }
    }
}

/// Terms of one size over the length of the piece, so that zeros of all derivatives fall inside.
#[test]
fn polynomials_at_random() {
    let mut random = Random(11);
    for _ in 0..20_000 {
        let order = 3 + (random.bits() % 6) as usize;
        let duration = random.decades(1e-3, 1e3);
        let mut values = [0.0; MAX_ORDER + 1];
        let mut sizes = [0.0; MAX_ORDER + 1];
        for (k, value) in values.iter_mut().enumerate().take(order + 1) {
            let part = if random.bits().is_multiple_of(8) { 0.0 } else { random.between(-1.0, 1.0) };
            *value = part * factorial(k) / duration.powi(k as i32);
        }
        check_polynomial(duration, &values, &mut sizes, order);
    }
}

/// Zeros that were put where they are: apart, close together, and one on the other.
#[test]
fn polynomials_with_chosen_zeros() {
    let mut random = Random(12);
    for _ in 0..20_000 {
        let order = 3 + (random.bits() % 6) as usize;
        let mut coefficients = [0.0; MAX_ORDER + 1];
        coefficients[0] = 1.0;
        let mut zero = random.unit();
        for degree in 0..order {
            zero = match random.bits() % 4 {
                0 => zero,
                1 => zero + 1e-7 * random.unit(),
                _ => random.unit(),
            };
            for k in (0..=degree).rev() {
                coefficients[k + 1] += coefficients[k];
                coefficients[k] *= -zero;
            }
        }
        let mut values = [0.0; MAX_ORDER + 1];
        for (k, (value, coefficient)) in values.iter_mut().zip(coefficients).enumerate() {
            *value = coefficient * factorial(k);
        }
        check_polynomial(1.0, &values, &mut [0.0; MAX_ORDER + 1], order);
    }
}

fn check_polynomial(
    duration: f64,
    values: &[f64; MAX_ORDER + 1],
    sizes: &mut [f64; MAX_ORDER + 1],
    order: usize,
) {
    for (k, size) in sizes.iter_mut().enumerate().take(order + 1) {
        *size = (k..=order).map(|i| values[i].abs() * duration.powi((i - k) as i32) / factorial(i - k)).sum();
    }
    let start = State { position: values[0], velocity: values[1], acceleration: values[2] };
    let law = Law::Polynomial(Derivatives::new(&values[3..=order]).unwrap());
    check(&Segment { duration, start, law }, sizes, MAX_ORDER);
    if order == 3 {
        let law = Law::ConstantJerk(values[3]);
        check(&Segment { duration, start, law }, sizes, 3);
    }
}

#[test]
fn cosines_at_random() {
    let mut random = Random(13);
    for _ in 0..20_000 {
        let duration = random.decades(1e-3, 1e3);
        let peak = random.between(-1.0, 1.0);
        let gain = 0.5 * peak * duration;
        let start = State {
            position: random.between(-1.0, 1.0),
            velocity: gain * duration * random.between(-1.0, 1.0),
            acceleration: gain * random.between(-1.5, 0.5),
        };
        let size = peak.abs() + f64::MIN_POSITIVE;
        let mut scales = [0.0; MAX_ORDER + 1];
        scales[0] = start.position.abs() + size * duration.powi(3);
        (scales[1], scales[2], scales[3]) = (size * duration * duration, size * duration, size);
        for order in 4..=MAX_ORDER {
            scales[order] = scales[order - 1] * std::f64::consts::TAU / duration;
        }
        check(&Segment { duration, start, law: Law::CosineJerk { peak } }, &scales, MAX_ORDER);
    }
}

/// 1 − cos θ and the rests of its integrals, against their series.
#[test]
fn a_cosine_is_right_to_its_last_digits() {
    /// Of the value itself [1].
    const RELATIVE: f64 = 2e-14;
    let segment = Segment {
        duration: std::f64::consts::TAU,
        start: State::default(),
        law: Law::CosineJerk { peak: 2.0 },
    };
    let series = |first: i32, angle: f64| {
        let mut terms = Vec::new();
        let mut term = (1..=first).fold(1.0, |product, k| product * angle / f64::from(k));
        let mut k = first;
        while term.abs() > 1e-320 && terms.len() < 60 {
            terms.push(term);
            term *= -angle * angle / f64::from((k + 1) * (k + 2));
            k += 2;
        }
        terms.iter().rev().sum::<f64>()
    };
    let mut worst = [0.0f64; 3];
    for step in 1..=20_000 {
        let angle = std::f64::consts::TAU * f64::from(step) / 20_000.0;
        for angle in [angle, angle * 1e-3, angle * 1e-9, angle * 1e-30] {
            let at = segment.at(angle);
            let values = [at.state.position, at.state.velocity, at.state.acceleration];
            for (index, (value, first)) in values.into_iter().zip([5, 4, 3]).enumerate() {
                let expected = series(first, angle);
                worst[index] = worst[index].max(((value - expected) / expected).abs());
            }
        }
    }
    assert!(worst.iter().all(|&worst| worst <= RELATIVE), "{worst:?}");
    assert_eq!(segment.at(segment.duration).jerk.to_bits(), 0);
}

/// Numbers that no planner would send: whatever is asked, it ends, and NaN does not pass for a number.
#[test]
fn wild_pieces_end() {
    let wild = [0.0, 1e308, -1e308, f64::MIN_POSITIVE, 5e-324, f64::NAN, f64::INFINITY, -1.0];
    let mut random = Random(14);
    for _ in 0..5_000 {
        let mut draw = || wild[(random.bits() % 8) as usize];
        let values = [(); 9].map(|()| draw());
        let start = State { position: values[0], velocity: values[1], acceleration: values[2] };
        for law in [
            Law::Polynomial(Derivatives::new(&values[3..]).unwrap()),
            Law::CosineJerk { peak: values[3] },
            Law::ConstantJerk(values[4]),
        ] {
            let times = Segment { duration: values[8].abs(), start, law }.turning_points();
            assert!(times.len() <= MAX_TURNING_POINTS);
        }
    }
}
