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
