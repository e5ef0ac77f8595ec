//! One pulse of jerk in the shape of a raised cosine, and its integrals.
//!
//! With `θ = 2π·t/d` and `ω = 2π/d`:
//!
//! ```text
//! j = J/2·(1 − cos θ)
//! a = a₀ + J/2ω·(θ − sin θ)
//! v = v₀ + a₀·t + J/2ω²·(θ²/2 − (1 − cos θ))
//! p = p₀ + v₀·t + a₀·t²/2 + J/2ω³·(θ³/6 − (θ − sin θ))
//! ```
//!
//! For small θ each bracket is the rest of a Taylor series, of which a difference would leave few digits; below 1 the rest is
//! summed instead. So every bracket is right to 2·10⁻¹⁴ of itself everywhere (`tests/extremes.rs`).
//!
//! Source: Nguyen, Ng and Chen (2008), appendix A, as corrected in `notes/0006-n-th-order-and-trigonometric.md`.

use core::f64::consts::{PI, TAU};

use crate::{Setpoint, State};

/// Below this angle \[rad\] the brackets are summed as series.
const SERIES_BELOW: f64 = 1.0;

// Apart, so that the S-curve's few operations stay small where they are inlined.
#[inline(never)]
pub(crate) fn setpoint(start: &State, peak: f64, duration: f64, t: f64) -> Setpoint {
    let angle = TAU * (t / duration);
    let (versine, brackets) =
        if angle < SERIES_BELOW { by_series(angle) } else { directly(angle, t / duration) };
    let [cubic, quadratic, linear] = brackets;
    let unit = duration / TAU;
    let half = 0.5 * peak;
    let State { position, velocity, acceleration } = *start;
    let state = State {
        position: position + t * (velocity + t * (acceleration * 0.5)) + half * unit * unit * unit * cubic,
        velocity: velocity + t * acceleration + half * unit * unit * quadratic,
        acceleration: acceleration + half * unit * linear,
    };
    Setpoint { state, jerk: half * versine }
}

/// Snap and the derivatives above it, as many as `all` has room for: J/2·ω·sin θ, J/2·ω²·cos θ …
pub(crate) fn higher(peak: f64, duration: f64, t: f64, all: &mut [f64]) {
    let (sine, cosine) = sine_and_cosine(t / duration);
    let cycle = [sine, cosine, -sine, -cosine];
    let mut factor = 0.5 * peak;
    for (value, wave) in all.iter_mut().zip(cycle.iter().cycle()) {
        factor *= TAU / duration;
        *value = factor * wave;
    }
}

/// sin and cos of half the turn's angle, π·`part`, from the nearer end of the turn: both ends are exact zeros of the sine.
fn half_angle(part: f64) -> (f64, f64) {
    if part > 0.5 {
        let rest = PI * (1.0 - part);
        (libm::sin(rest), -libm::cos(rest))
    } else {
        let angle = PI * part;
        (libm::sin(angle), libm::cos(angle))
    }
}

/// sin and cos of the angle of `part` of a turn, 2π·`part`.
fn sine_and_cosine(part: f64) -> (f64, f64) {
    let (sine, cosine) = half_angle(part);
    (2.0 * sine * cosine, (cosine - sine) * (cosine + sine))
}

/// 1 − cos θ, and the brackets of position, velocity and acceleration.
fn directly(angle: f64, part: f64) -> (f64, [f64; 3]) {
    let (sine, cosine) = half_angle(part);
    let versine = 2.0 * sine * sine;
    let linear = angle - 2.0 * sine * cosine;
    let square = angle * angle;
    (versine, [angle * square / 6.0 - linear, 0.5 * square - versine, linear])
}

/// As [`directly`], from the first terms that are left: θ⁵/5!·(1 − θ²/6·7·(1 − θ²/8·9·(…))) and θ⁴/4!·(1 − θ²/5·6·(…)). After
/// seven factors the rest is below 3·10⁻¹⁸ for angles up to 1. The lower brackets follow by differences that lose nothing.
fn by_series(angle: f64) -> (f64, [f64; 3]) {
    let square = angle * angle;
    let cube = angle * square;
    let rest = |factors: &[f64; 7]| factors.iter().rev().fold(1.0, |sum, factor| 1.0 - square * factor * sum);
    let cubic = cube * square / 120.0 * rest(&ODD);
    let quadratic = square * square / 24.0 * rest(&EVEN);
    (0.5 * square - quadratic, [cubic, quadratic, cube / 6.0 - cubic])
}

/// 1/6·7, 1/8·9 …, and 1/5·6, 1/7·8 …
const ODD: [f64; 7] = reciprocals_from(6.0);
const EVEN: [f64; 7] = reciprocals_from(5.0);

const fn reciprocals_from(first: f64) -> [f64; 7] {
    let mut factors = [0.0; 7];
    let (mut index, mut order) = (0, first);
    while index < factors.len() {
        factors[index] = 1.0 / (order * (order + 1.0));
        index += 1;
        order += 2.0;
    }
    factors
}
