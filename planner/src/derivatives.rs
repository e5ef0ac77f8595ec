use arrayvec::ArrayVec;

use crate::roots::{linear, quadratic, sign_change};
use crate::twofold::Series;
use crate::{Setpoint, State};

/// The highest degree of a piece: one of order 5, a quintic, whose time is a cubic of another time. A few more would cost every
/// piece of every plan their room.
pub const MAX_DEGREE: usize = 15;

/// The most derivatives of one law: jerk to the one of order [`MAX_DEGREE`].
const MOST: usize = MAX_DEGREE - 2;

/// 1/k: what Horner's scheme for a Taylor series multiplies by. A product instead of a quotient costs half a unit in the
/// last place and saves most of the time.
pub(crate) const RECIPROCAL: [f64; MAX_DEGREE + 1] = {
    let mut reciprocal = [0.0; MAX_DEGREE + 1];
    let mut k = 1;
    while k <= MAX_DEGREE {
        reciprocal[k] = 1.0 / k as f64;
        k += 1;
    }
    reciprocal
};

/// k!, exactly: from the coefficient of a power series to a derivative.
pub(crate) const FACTORIAL: [f64; MAX_DEGREE + 1] = {
    let mut factorial = [1.0; MAX_DEGREE + 1];
    let (mut product, mut k) = (1u64, 1);
    while k <= MAX_DEGREE {
        product *= k as u64;
        factorial[k] = product as f64;
        k += 1;
    }
    factorial
};

/// Jerk, snap … at the start of a piece [axis units/s³, /s⁴ …]; the last of them stays constant.
///
/// ```
/// # use planner::{Derivatives, Law, Segment, State};
/// let snap = Derivatives::new(&[0.0, 24.0]).expect("at least one of them");
/// let piece = Segment { duration: 1.0, start: State::at_rest(1.0), law: Law::Polynomial(snap) };
/// assert_eq!(piece.end(), State { position: 2.0, velocity: 4.0, acceleration: 12.0 });
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivatives {
    /// Zero from `count` on.
    values: [f64; MOST],
    count: u8,
}

impl Derivatives {
    /// One to 13 derivatives, jerk first, up to the order [`MAX_DEGREE`]; `None` of more or fewer.
    #[must_use]
    pub fn new(given: &[f64]) -> Option<Self> {
        if given.is_empty() || given.len() > MOST {
            return None;
        }
        Some(Self::kept(given))
    }

    /// Those of a piece that was one of these before.
    pub(crate) fn kept(given: &[f64]) -> Self {
        let mut values = [0.0; MOST];
        values[..given.len()].copy_from_slice(given);
        Self { values, count: given.len() as u8 }
    }

    /// The derivatives, jerk first.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        &self.values[..usize::from(self.count)]
    }

    /// The order of the highest derivative, which is constant: 3 for jerk.
    #[must_use]
    pub fn order(&self) -> usize {
        usize::from(self.count) + 2
    }

    pub(crate) fn mirrored(self) -> Self {
        Self { values: self.values.map(|value| 0.0 - value), ..self }
    }

    /// Divided by `factor³`, `factor⁴` …
    pub(crate) fn slowed(self, factor: f64) -> Self {
        let mut divisor = factor * factor;
        let slowed = |value: f64| {
            divisor *= factor;
            value / divisor
        };
        Self { values: self.values.map(slowed), ..self }
    }

    pub(crate) fn with_positive_zeros(self) -> Self {
        Self { values: self.values.map(|value| value + 0.0), ..self }
    }

    /// Snap and the derivatives above it at `t`, as many as `all` has room for.
    pub(crate) fn higher(&self, t: f64, all: &mut [f64]) {
        for (value, order) in all.iter_mut().zip(4..=self.order()) {
            *value = taylor(&self.values[order - 3..usize::from(self.count)], t);
        }
    }

    /// The zero of the derivative of `order` in `span`, near to `near`, to its last digits; `near` where there is none.
    pub(crate) fn zero_in(
        &self,
        start: &State,
        order: usize,
        duration: f64,
        near: f64,
        span: (f64, f64),
    ) -> f64 {
        if order >= self.order() {
            return near;
        }
        let values = self.all(start);
        Series::of(&values[order..=self.order()], duration).closed_in(near, span)
    }

    /// Position and all derivatives at the start of a piece.
    fn all(&self, start: &State) -> [f64; MAX_DEGREE + 1] {
        let mut values = [0.0; MAX_DEGREE + 1];
        values[..3].copy_from_slice(&[start.position, start.velocity, start.acceleration]);
        values[3..].copy_from_slice(&self.values);
        values
    }

    /// The zeros of the derivative of `order` inside a piece of length `duration`, in order, given those of the next one:
    /// between these it is monotone.
    pub(crate) fn zeros(
        &self,
        start: &State,
        order: usize,
        duration: f64,
        of_next: &[f64],
    ) -> ArrayVec<f64, MAX_DEGREE> {
        let values = self.all(start);
        let values = &values[order..=self.order()];
        let mut zeros = ArrayVec::new();
        let inside = |t: &f64| *t > 0.0 && *t < duration;
        match *values {
            [b, a] => zeros.extend(linear(a, b).into_iter().filter(inside)),
            [c, b, a] => {
                zeros.extend(quadratic(0.5 * a, b, c).into_iter().filter(inside));
                zeros.sort_unstable_by(f64::total_cmp);
            }
            _ => {
                let value_and_slope = |t| (taylor(values, t), taylor(&values[1..], t));
                let mut from = 0.0;
                for to in of_next.iter().copied().chain([duration]) {
                    zeros.extend(sign_change(from, to, value_and_slope).filter(inside));
                    from = to;
                }
            }
        }
        zeros
    }
}

/// What a piece commands `t` seconds after its `start`; `values` are its jerk, snap … there.
///
/// Horner's scheme for all four words at once, highest derivative first, in this order and without fused multiply-add:
///
/// ```text
/// p(t) = p + t·(v + t/2·(a + t/3·(j + t/4·(…))))      v(t) = v + t·(a + t/2·(j + t/3·(…)))      …
/// ```
// Apart, so that the S-curve's few operations stay small where they are inlined.
#[inline(never)]
pub(crate) fn setpoint(values: &[f64], start: &State, t: f64) -> Setpoint {
    let (jerk, above) = values.split_first().map_or((0.0, values), |(jerk, above)| (*jerk, above));
    // What each word gets from above jerk, already times t.
    let (mut position, mut velocity, mut acceleration, mut change) = (0.0, 0.0, 0.0, 0.0);
    for (index, &value) in above.iter().enumerate().rev() {
        position = t * RECIPROCAL[index + 4] * (value + position);
        velocity = t * RECIPROCAL[index + 3] * (value + velocity);
        acceleration = t * RECIPROCAL[index + 2] * (value + acceleration);
        change = t * RECIPROCAL[index + 1] * (value + change);
    }
    let (half, third) = (t * RECIPROCAL[2], t * RECIPROCAL[3]);
    let state = State {
        position: start.position
            + t * (start.velocity + half * (start.acceleration + third * (jerk + position))),
        velocity: start.velocity + t * (start.acceleration + half * (jerk + velocity)),
        acceleration: start.acceleration + t * (jerk + acceleration),
    };
    Setpoint { state, jerk: jerk + change }
}

/// `values[0] + t·(values[1] + t/2·(values[2] + …))`.
fn taylor(values: &[f64], t: f64) -> f64 {
    let Some((last, rest)) = values.split_last() else { return 0.0 };
    rest.iter()
        .enumerate()
        .rev()
        .fold(*last, |above, (index, &value)| value + t * RECIPROCAL[index + 1] * above)
}
