//! Laws of growth: cost = fixed + each · n^power.

use nalgebra::{DMatrix, DVector};

/// A law, and how far it is from what was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fit {
    pub(crate) fixed: f64,
    pub(crate) each: f64,
    pub(crate) power: f64,
    /// The largest distance of a measured point, as a part of it [1].
    pub(crate) worst: f64,
}

/// What is no farther than this from one number does not grow.
const LEVEL: f64 = 0.05;
/// A straight line that is no farther than this from any point is not bent to come nearer: the spread of rounds is as large.
const NEAR: f64 = 0.1;
/// A bent line has to come so much nearer, or it says nothing that a straight one does not.
const GAIN: f64 = 0.7;

impl Fit {
    /// The law with the least squares of relative distances. Powers other than 1 are taken where a straight line is far off, and a
    /// power is much nearer; there are four points at least then. None for less than two points.
    pub(crate) fn of(points: &[(f64, f64)]) -> Option<Self> {
        let straight = Self::with_power(points, 1.0)?;
        let level = Self::level(points);
        if level.worst <= LEVEL {
            return Some(level);
        }
        if straight.worst <= NEAR || points.len() < 4 {
            return Some(straight);
        }
        let powers = (-200..=250)
            .filter(|hundredths| *hundredths != 0)
            .map(|hundredths| f64::from(hundredths) / 100.0);
        let bent = powers.filter_map(|power| Self::with_power(points, power));
        // More costs more, or by a negative power less: a difference of two large numbers is no law.
        let best = bent.filter(|fit| fit.each > 0.0).min_by(|a, b| a.worst.total_cmp(&b.worst))?;
        Some(if best.worst < GAIN * straight.worst { best } else { straight })
    }

    fn level(points: &[(f64, f64)]) -> Self {
        let (sum, squares) = points
            .iter()
            .fold((0.0, 0.0), |(sum, squares), (_, cost)| (sum + 1.0 / cost, squares + 1.0 / (cost * cost)));
        let fixed = sum / squares;
        let worst = points.iter().map(|(_, cost)| (fixed / cost - 1.0).abs()).fold(0.0, f64::max);
        Self { fixed, each: 0.0, power: 1.0, worst }
    }

    fn with_power(points: &[(f64, f64)], power: f64) -> Option<Self> {
        let both = Self::solved(points, power, true)?;
        // Nothing costs less than nothing.
        if both.fixed < 0.0 { Self::solved(points, power, false) } else { Some(both) }
    }

    fn solved(points: &[(f64, f64)], power: f64, has_fixed: bool) -> Option<Self> {
        if points.len() < 2 || points.iter().any(|(n, cost)| *n <= 0.0 || *cost <= 0.0) {
            return None;
        }
        let columns = if has_fixed { 2 } else { 1 };
        let rows = DMatrix::from_fn(points.len(), columns, |row, column| {
            let (n, cost) = points[row];
            if column == 0 { n.powf(power) / cost } else { 1.0 / cost }
        });
        let ones = DVector::from_element(points.len(), 1.0);
        let found = rows.svd(true, true).solve(&ones, f64::EPSILON).ok()?;
        let fit = Self { each: found[0], fixed: if has_fixed { found[1] } else { 0.0 }, power, worst: 0.0 };
        let distance = |(n, cost): &(f64, f64)| (fit.at(*n) / cost - 1.0).abs();
        Some(Self { worst: points.iter().map(distance).fold(0.0, f64::max), ..fit })
    }

    pub(crate) fn at(&self, n: f64) -> f64 {
        self.fixed + self.each * n.powf(self.power)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(law: impl Fn(f64) -> f64, expected: [f64; 3]) {
        let points: Vec<(f64, f64)> = [1.0, 2.0, 5.0, 10.0, 30.0, 100.0].map(|n| (n, law(n))).into();
        let fit = Fit::of(&points).unwrap();
        for (found, expected) in [fit.fixed, fit.each, fit.power].into_iter().zip(expected) {
            assert!((found - expected).abs() <= 1e-6 * (1.0 + expected.abs()), "{fit:?} {expected}");
        }
        assert!(fit.worst < 1e-6, "{fit:?}");
    }

    #[test]
    fn laws_are_found_again() {
        check(|n| 5.0 + 0.25 * n, [5.0, 0.25, 1.0]);
        check(|n| 3.0 * n, [0.0, 3.0, 1.0]);
        check(|n| 2.0 + 0.5 * n.powf(1.5), [2.0, 0.5, 1.5]);
        check(|n| 0.1 + 4.0 / n, [0.1, 4.0, -1.0]);
        check(|_| 7.0, [7.0, 0.0, 1.0]);
    }

    #[test]
    fn a_law_says_how_far_it_is_from_the_farthest_point_and_costs_nothing_below_zero() {
        let fit = Fit::of(&[(1.0, 1.0), (2.0, 2.0), (3.0, 3.3)]).unwrap();
        assert!(fit.worst > 0.02 && fit.worst < 0.1, "{fit:?}");
        assert_eq!((fit.power, fit.fixed), (1.0, 0.0));
        assert!(Fit::of(&[(1.0, 1.0)]).is_none());
    }
}
