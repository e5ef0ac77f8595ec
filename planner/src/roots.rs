//! Real roots of small polynomials; has not heard of motion.

use arrayvec::ArrayVec;

use crate::float::{largest, sqrt};

/// The root of `a·x + b`, if `a ≠ 0`.
pub(crate) fn linear(a: f64, b: f64) -> Option<f64> {
    (a != 0.0).then(|| -b / a)
}

/// The real roots of `a·x² + b·x + c`, in no order; none where every `x` is one.
///
/// Takes the sum of like signs in the numerator and gets the other root from the product of both, so that neither
/// loses digits to cancellation (Press et al., Numerical Recipes, §5.6).
pub(crate) fn quadratic(a: f64, b: f64, c: f64) -> ArrayVec<f64, 2> {
    let mut roots = ArrayVec::new();
    if a == 0.0 {
        roots.extend(linear(b, c));
        return roots;
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return roots;
    }
    let q = -0.5 * (b + if b < 0.0 { -sqrt(discriminant) } else { sqrt(discriminant) });
    roots.push(q / a);
    if q != 0.0 {
        roots.push(c / q);
    }
    roots
}

/// The root of an increasing, convex function by Newton's method from `start`, which is at or above it.
///
/// `value_and_slope` gives both at `x`. From above, the iterates of an increasing convex function only fall; the
/// first that does not fall has met the rounding of the function, and the last is returned. So there is no bracket, no
/// tolerance and no count: on the functions solved here it takes at most eight steps over ten decades.
pub(crate) fn fall_to_root(start: f64, value_and_slope: impl Fn(f64) -> (f64, f64)) -> f64 {
    let mut x = start;
    loop {
        let (value, slope) = value_and_slope(x);
        let next = x - value / slope;
        // Also false for NaN, so that the loop ends whatever was given.
        let falls = next < x && next >= 0.0;
        if !falls {
            return x;
        }
        x = next;
    }
}

/// Newton steps before [`sign_change`] halves its bracket only: it takes about six where the function is not flat.
const NEWTON_STEPS: usize = 12;

/// Where a function that is monotone from `from ≥ 0` to `to` changes its sign, to 4 units in the last place of `to`; none
/// where it does not.
///
/// `value_and_slope` gives both at `x`. Newton's method inside a bracket: a step out of the bracket becomes the bracket's
/// middle; a step shorter than the resolution is taken as far as that towards the other end, which is then nearer than
/// asked. Where a function is too flat for that, the bracket is halved to the end, so that it ends whatever was given.
pub(crate) fn sign_change(from: f64, to: f64, value_and_slope: impl Fn(f64) -> (f64, f64)) -> Option<f64> {
    let values = (value_and_slope(from).0, value_and_slope(to).0);
    sign_change_within((from, to), values, value_and_slope)
}

/// As [`sign_change`], of a function whose values at both ends are known.
pub(crate) fn sign_change_within(
    (from, to): (f64, f64),
    (at_from, at_to): (f64, f64),
    value_and_slope: impl Fn(f64) -> (f64, f64),
) -> Option<f64> {
    if at_from == 0.0 || at_to == 0.0 {
        return Some(if at_to == 0.0 { to } else { from });
    }
    let (rises, falls) = (at_from < 0.0 && at_to > 0.0, at_from > 0.0 && at_to < 0.0);
    // Also false for NaN.
    if !(rises || falls) {
        return None;
    }
    let resolution = 4.0 * f64::EPSILON * to;
    let (mut low, mut high) = (from, to);
    let mut steps = 0;
    let mut x = 0.5 * (low + high);
    while high - low > resolution && x > low && x < high {
        let (value, slope) = value_and_slope(x);
        if value == 0.0 {
            return Some(x);
        }
        let is_low = (value < 0.0) == rises;
        *(if is_low { &mut low } else { &mut high }) = x;
        let step = value / slope;
        let aimed = if step.abs() < resolution {
            if is_low { x + resolution } else { x - resolution }
        } else {
            x - step
        };
        steps += 1;
        x = if steps < NEWTON_STEPS && aimed > low && aimed < high { aimed } else { 0.5 * (low + high) };
    }
    Some(0.5 * (low + high))
}

/// The root in `low..=high` of a function that is convex there and rises through it, by Newton's method from `start`.
///
/// `value_and_slope` gives both at `x`. A tangent of a convex function lies below it, so that a step from the left leads beyond
/// the root, and from the right not beyond it: the steps shrink, until all that is left of them is the function's rounding, where one
/// does not. Where the function does not change its sign, the end that is nearer to it is returned.
///
/// How often steps shrink hangs on what is rounded, so after [`CONVEX_STEPS`] the bracket is halved by its bits, of which there are 64: it
/// ends whatever was given.
pub(crate) fn convex_root(
    start: f64,
    low: f64,
    high: f64,
    value_and_slope: impl Fn(f64) -> (f64, f64),
) -> f64 {
    let mut x = start;
    let mut last = f64::INFINITY;
    for _ in 0..CONVEX_STEPS {
        let (value, slope) = value_and_slope(x);
        let aimed = if slope > 0.0 { x - value / slope } else { high };
        let aimed = if aimed > high { high } else { largest(low, aimed) };
        let step = (aimed - x).abs();
        // Also false for NaN, so that the loop ends whatever was given.
        let shrinks = step < last && step > 0.0;
        if !shrinks {
            return x;
        }
        last = step;
        x = aimed;
    }
    halved_by_bits(low, high, |x| value_and_slope(x).0 < 0.0)
}

/// Newton steps of [`convex_root`] before its bracket is halved. Of a million motions over sixty decades none took more than a fifth of it.
const CONVEX_STEPS: usize = 256;

/// The first number of `low ..= high`, both ≥ 0, that is not `below`; `high` where all are. Numbers that are not negative are in the order
/// of their bits, so that at most 63 halvings do.
pub(crate) fn halved_by_bits(low: f64, high: f64, below: impl Fn(f64) -> bool) -> f64 {
    let (mut low, mut high) = (largest(0.0, low).to_bits(), largest(0.0, high).to_bits());
    while low < high {
        let middle = low + (high - low) / 2;
        if below(f64::from_bits(middle)) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    f64::from_bits(high)
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "the very number is asked for")]
mod tests {
    use super::*;

    /// Steps that shrink by next to nothing for ever, as roundings might: the bracket ends them.
    #[test]
    fn a_convex_root_ends_whatever_is_given() {
        let calls = core::cell::Cell::new(0);
        let creeping = |x: f64| {
            calls.set(calls.get() + 1);
            // Each step is a millionth shorter than the last.
            (if x < 0.75 { -1.0 } else { 1.0 }, 1e3 * (1.0 + 1e-6 * f64::from(calls.get())))
        };
        assert_eq!(convex_root(0.0, 0.0, 1.0, creeping), 0.75);
        assert!(calls.get() <= CONVEX_STEPS as i32 + 64, "{} calls", calls.get());
        for value in [f64::NAN, f64::INFINITY, 0.0] {
            let root = convex_root(0.5, 0.0, 1.0, |_| (value, value));
            assert!((0.0..=1.0).contains(&root), "{root}");
        }
    }

    #[test]
    fn halving_by_bits_finds_any_number() {
        for root in [0.0, f64::MIN_POSITIVE * 0.5, 1e-300, 0.75, 1.0, 1e300] {
            assert_eq!(halved_by_bits(0.0, f64::MAX, |x| x < root), root);
        }
        assert_eq!(halved_by_bits(0.0, 2.0, |_| true), 2.0);
    }
}
