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
