//! The few functions beyond `+ − × ÷` that the planner uses, in the one form that gives the same bits everywhere.

/// Square root, correctly rounded by IEEE 754, so that hardware and software agree.
#[inline]
pub(crate) fn sqrt(x: f64) -> f64 {
    #[cfg(feature = "std")]
    return x.sqrt();
    #[cfg(not(feature = "std"))]
    return libm::sqrt(x);
}

/// The smaller of two numbers that are not NaN.
#[inline]
pub(crate) fn least(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// The larger of two numbers that are not NaN.
#[inline]
pub(crate) fn largest(a: f64, b: f64) -> f64 {
    if b > a { b } else { a }
}

/// The cube root of a number ≥ 0, to within two units in the last place, by the same few operations on every platform.
///
/// `y = x^(−1/3)` is found without a division: with `e = 1 − x·y³` the wanted factor is
/// `(1 − e)^(−1/3) = 1 + e/3 + 2e²/9 + 14e³/81 + …`, and what is
/// left of `e` after that is about `e⁴/3`. The first guess divides the exponent by −3, the bits of a number being nearly its
/// logarithm; it leaves |e| < 0.103, two steps leave less than 10⁻¹⁵, and the last one is Newton's on the root itself.
#[inline]
pub(crate) fn cbrt(x: f64) -> f64 {
    /// Four thirds of the bits of 1, and what evens out the guess over three powers of two.
    const GUESS: u64 = 0x553e_e978_d4fd_f3b7;
    if x < f64::MIN_POSITIVE {
        return libm::cbrt(x);
    }
    let mut y = f64::from_bits(GUESS - x.to_bits() / 3);
    for _ in 0..2 {
        let e = 1.0 - (x * y) * (y * y);
        y += y * e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0)));
    }
    let root = x * y * y;
    root - (root * root * root - x) * (y * y) * (1.0 / 3.0)
}

/// `s − a·b`, with the digits that are left where both are nearly equal: the product is taken exactly, as the sum of its
/// rounding and what that left out (Dekker, 1971). For magnitudes whose products with 2²⁷ are finite.
#[inline]
pub(crate) fn minus_product(s: f64, a: f64, b: f64) -> f64 {
    const SPLIT: f64 = 134_217_729.0; // 2²⁷ + 1
    let halves = |x: f64| {
        let scaled = SPLIT * x;
        let high = scaled - (scaled - x);
        (high, x - high)
    };
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let rest = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (s - product) - rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cube_roots_are_right_to_two_units() {
        let mut worst = 0.0_f64;
        for exponent in -1000..1000 {
            for part in 0..64 {
                let x = (1.0 + f64::from(part) / 64.0 + 1e-3) * libm::exp2(f64::from(exponent));
                let exact = libm::cbrt(x);
                worst = worst.max((cbrt(x) - exact).abs() / (exact * f64::EPSILON));
            }
        }
        assert!(worst <= 2.0, "{worst} units");
        for x in [0.0, 1e-310] {
            assert_eq!(cbrt(x).to_bits(), libm::cbrt(x).to_bits());
        }
    }
}
