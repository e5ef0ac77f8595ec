//! A polynomial with twice the digits: what a zero is closed in on with, to its own last digits.
//!
//! Values are unevaluated sums of two numbers; products are exact by splitting factors (Dekker 1971; Shewchuk 1997 has the proofs). Only
//! `+ − ×`, in a fixed order, and powers of two: the same bits on every platform.

use crate::derivatives::{FACTORIAL, MAX_DEGREE};
use crate::polynomial::{power_of_two, split};
use crate::roots::halved_by_bits;

/// Newton steps before the bracket is halved: two do, where the zero is simple.
const STEPS: usize = 6;

/// Of a zero \[1\]: a step this short is the last. The value is good to twice the digits, so that where it leads is good to a rounding and
/// to what is left of the step, which is far below that: the slope has a single rounding, and the zero is simple.
const LAST_STEP: f64 = 64.0 * f64::EPSILON;

/// Coefficients that are less than 2 to this of the greatest are zero: far inside the range, so that their products are exact.
const LEAST_SCALE: i32 = -600;

/// The sum of two numbers, of which the second is less than a rounding of the first.
#[derive(Clone, Copy, Debug)]
struct Twofold(f64, f64);

impl Twofold {
    /// `a + b`, exactly.
    fn sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        let of_b = sum - a;
        Self(sum, (a - (sum - of_b)) + (b - of_b))
    }

    /// The same for |a| ≥ |b|.
    fn ordered_sum(a: f64, b: f64) -> Self {
        let sum = a + b;
        Self(sum, b - (sum - a))
    }

    /// `a·b`, exactly, where neither is near the ends of the range.
    fn product(a: f64, b: f64) -> Self {
        /// 2²⁷ + 1: halves the digits.
        const SPLITTER: f64 = 134_217_729.0;
        let halves = |x: f64| {
            let spread = SPLITTER * x;
            let high = spread - (spread - x);
            (high, x - high)
        };
        let product = a * b;
        let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
        let rest = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
        Self(product, rest)
    }

    fn times(self, x: f64) -> Self {
        let Self(product, rest) = Self::product(self.0, x);
        Self::ordered_sum(product, rest + self.1 * x)
    }

    fn plus(self, other: Self) -> Self {
        let Self(sum, rest) = Self::sum(self.0, other.0);
        Self::ordered_sum(sum, rest + (self.1 + other.1))
    }
}

/// A Taylor series `Σ vₖ·tᵏ/k!`, times a positive number, in a unit of time that is a power of two: about 1, so that nothing leaves the range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Series {
    coefficients: [Twofold; MAX_DEGREE + 1],
    degree: usize,
    /// `t = τ·2^exponent`.
    exponent: i32,
}

impl Series {
    /// Of the derivatives `values` at zero, over a time of about `duration`: the coefficients have no rounding, as `vₖ·n!/k!` is a product of
    /// two numbers.
    pub(crate) fn of(values: &[f64], duration: f64) -> Self {
        let degree = values.len() - 1;
        let (_, exponent) = split(duration);
        let mut coefficients = [Twofold(0.0, 0.0); MAX_DEGREE + 1];
        let mut parts = [(0.0, i32::MIN); MAX_DEGREE + 1];
        let mut greatest = i32::MIN;
        for (k, (part, &value)) in parts.iter_mut().zip(values).enumerate().filter(|(_, (_, v))| **v != 0.0) {
            let (of_magnitude, of_value) = split(value.abs());
            *part = (of_magnitude.copysign(value), of_value + exponent * k as i32);
            greatest = greatest.max(part.1);
        }
        for (k, &(part, at)) in parts[..values.len()].iter().enumerate().filter(|(_, (part, _))| *part != 0.0)
        {
            // What is so much less than the greatest is nothing beside it.
            let scale = at - greatest;
            if scale > LEAST_SCALE {
                let scaled = part * power_of_two(scale);
                coefficients[k] = Twofold::product(scaled, FACTORIAL[degree] / FACTORIAL[k]);
            }
        }
        Self { coefficients, degree, exponent }
    }

    /// The value at `τ`, good to a rounding unless it is less than 2⁻⁹⁰ of its terms, and about the slope there.
    fn at(&self, t: f64) -> (f64, f64) {
        let mut value = self.coefficients[self.degree];
        let mut slope = 0.0;
        for coefficient in self.coefficients[..self.degree].iter().rev() {
            slope = slope * t + value.0;
            value = value.times(t).plus(*coefficient);
        }
        (value.0, slope)
    }

    /// The zero in `low..=high` that is near to `zero`, to its last digits; `zero` itself where there is none, or an even number of them.
    pub(crate) fn closed_in(&self, zero: f64, (low, high): (f64, f64)) -> f64 {
        // Times of the piece and their parts: no digit is lost on the way, and none on the way back.
        let [start, low, high] = [zero, low, high].map(|t| t * power_of_two(-self.exponent));
        let mut at = start;
        for _ in 0..STEPS {
            let (value, slope) = self.at(at);
            let next = at - value / slope;
            // Also false for NaN.
            if !(next >= low && next <= high) {
                break;
            }
            let step = (next - at).abs();
            at = next;
            if step <= LAST_STEP * at {
                return at * power_of_two(self.exponent);
            }
        }
        let (rises, changes) = {
            let (from, to) = (self.at(low).0, self.at(high).0);
            (from < 0.0, (from < 0.0 && to > 0.0) || (from > 0.0 && to < 0.0))
        };
        if !changes {
            return zero;
        }
        let at = halved_by_bits(low, high, |t| {
            let value = self.at(t).0;
            if rises { value < 0.0 } else { value > 0.0 }
        });
        at * power_of_two(self.exponent)
    }
}
