use core::fmt::Debug;
use core::ops::{Add, Mul, Neg};

/// The two widths in which a [`Generator`](super::Generator) can step: [`f32`] and [`f64`].
///
/// Sealed: what it promises (exact widening, rounding to nearest) holds for these two alone.
pub trait Real:
    Copy + Debug + PartialEq + PartialOrd + Add<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + Sealed
{
}

impl Real for f32 {}
impl Real for f64 {}

/// What stepping needs, and nobody outside.
pub trait Sealed: Sized {
    /// Nothing.
    const ZERO: Self;
    /// The distance from 1 to the next number \[1\].
    const EPSILON: f64;
    /// The least limit: far enough above the least normal number for a sixth of a jerk.
    const LEAST: f64;
    /// The greatest magnitude, far enough below the greatest number for a difference of two positions.
    const GREATEST: f64;

    /// Exactly.
    fn widen(self) -> f64;
    /// To the nearest.
    fn round(exact: f64) -> Self;
    /// A number of cycles; exact up to the width's mantissa, to the nearest beyond.
    fn count(cycles: i64) -> Self;
    /// The nearest number in `-bound..=bound`.
    fn within(self, bound: Self) -> Self;
}

impl Sealed for f64 {
    const ZERO: Self = 0.0;
    const EPSILON: f64 = f64::EPSILON;
    const LEAST: f64 = crate::LEAST_LIMIT;
    const GREATEST: f64 = crate::GREATEST_MAGNITUDE;

    #[inline]
    fn widen(self) -> f64 {
        self
    }

    #[inline]
    fn round(exact: f64) -> Self {
        exact
    }

    #[inline]
    fn count(cycles: i64) -> Self {
        cycles as Self
    }

    #[inline]
    fn within(self, bound: Self) -> Self {
        let low = if self < -bound { -bound } else { self };
        if low > bound { bound } else { low }
    }
}

impl Sealed for f32 {
    const ZERO: Self = 0.0;
    const EPSILON: f64 = f32::EPSILON as f64;
    const LEAST: f64 = 1e-30;
    const GREATEST: f64 = 1e30;

    #[inline]
    fn widen(self) -> f64 {
        f64::from(self)
    }

    #[inline]
    fn round(exact: f64) -> Self {
        exact as Self
    }

    #[inline]
    fn count(cycles: i64) -> Self {
        cycles as Self
    }

    #[inline]
    fn within(self, bound: Self) -> Self {
        let low = if self < -bound { -bound } else { self };
        if low > bound { bound } else { low }
    }
}
