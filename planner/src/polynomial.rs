//! The symmetric profile of order n from rest to rest: Nguyen, Ng and Chen (2008), section 3, in the closed recursion of
//! `notes/0006-n-th-order-and-trigonometric.md`.
//!
//! The velocity is a rectangle of time that n − 1 further rectangles have been averaged over, one after the other, each at
//! least as long as all before it together. So one length per derivative says everything: `F₁ ≤ F₂ ≤ … ≤ Fₙ`, with
//!
//! ```text
//! peak of derivative k  =  Xₙ·F₁·F₂·…·Fₙ₋ₖ        distance = Xₙ·F₁·…·Fₙ        total = F₁ + … + Fₙ
//! ```
//!
//! and `T_p = Fₙ₊₁₋ₚ − (the F before it) ≥ 0` is how long derivative `p` stays at its peak.

use arrayvec::ArrayVec;

use crate::classify::{AsymmetricType, Classification, EightType, SixCase};
use crate::derivatives::{RECIPROCAL, setpoint};
use crate::error::{Field, InvalidFields, Why};
use crate::float::{cbrt, least, sqrt};
use crate::roots::fall_to_root;
use crate::segments::Pieces;
use crate::solve::{Adjustment, feed_rate_above_limit};
use crate::{Limits, MAX_ORDER, Problem, Profile, Setpoint, State};

/// Of a length of time \[1\], for each order: a hold shorter than this is rounding. The recursion is worth about one ε a
/// level.
pub(crate) const SNAP: f64 = 2.0 * f64::EPSILON;

/// Scaled limits of order k stop at 2^(64·k): one that is reached within 2⁻⁶⁴ of the time of the move holds nothing back, and so
/// the numbers stay far enough inside their range for what the recursion multiplies.
const GREATEST_EXPONENT: i32 = 64;

/// The pieces before the cruise of the longest template.
const MAX_HALF: usize = (1 << (MAX_ORDER - 1)) - 1;

/// The answer to a [`Problem`] by the symmetric profile of order n: how long each derivative is held, on the stack.
#[derive(Clone, Debug, PartialEq)]
pub struct PolynomialMove {
    order: usize,
    start: State,
    reached: State,
    direction: f64,
    /// `T₁ … Tₙ`.
    holds: [f64; MAX_ORDER],
    /// `F₁ … Fₙ`.
    boxes: [f64; MAX_ORDER],
    /// Distance, then the peak of each derivative up to n.
    peaks: [f64; MAX_ORDER + 1],
    adjustments: ArrayVec<Adjustment, 1>,
    classification: Classification,
}

impl PolynomialMove {
    /// The order n: its highest bounded derivative, constant in pieces.
    #[must_use]
    pub fn order(&self) -> usize {
        self.order
    }

    /// How long each derivative stays at its peak at a time \[s\]: velocity, acceleration … up to n; 0 where it does not reach
    /// its limit for a while.
    #[must_use]
    pub fn holds(&self) -> &[f64] {
        &self.holds[..self.order]
    }

    /// The lengths of the rectangles that the motion is made of \[s\], the shortest first: the time in which the derivative
    /// n − 1, n − 2 … comes to its peak, when the one above it is already there.
    #[must_use]
    pub fn boxes(&self) -> &[f64] {
        &self.boxes[..self.order]
    }

    /// What is reached, as magnitudes: the distance [axis units], then the peak of each derivative [/s, /s² …] up to n.
    #[must_use]
    pub fn peaks(&self) -> &[f64] {
        &self.peaks[..=self.order]
    }

    /// How long the motion lasts \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.boxes().iter().fold(0.0, |total, length| total + length)
    }

    /// The state at the end: the goal.
    #[must_use]
    pub fn reached(&self) -> State {
        self.reached
    }

    /// What is not as asked; empty where everything is.
    #[must_use]
    pub fn adjustments(&self) -> &[Adjustment] {
        &self.adjustments
    }

    /// The shape's names in the papers.
    #[must_use]
    pub fn classification(&self) -> Classification {
        self.classification
    }

    /// The setpoint at time `t` \[s\], with the bits of [`Profile::at`] and without laying the pieces: nothing is taken from the heap.
    ///
    /// It walks from the nearer end to the piece that `t` lies in, so whoever asks for many setpoints lays the pieces once.
    ///
    /// ```
    /// # use planner::{LimitsSpec, Problem, ShortPathPolicy, State, plan_polynomial};
    /// # let limits = LimitsSpec { max_velocity: 60.0, max_acceleration: 600.0, max_jerk: 12e3, max_snap: Some(480e3), ..LimitsSpec::default() };
    /// # let problem = Problem::new(State::at_rest(0.0), State::at_rest(50.0), limits.try_into()?, ShortPathPolicy::Reject)?;
    /// let planned = plan_polynomial(&problem, 4)?;
    /// assert_eq!(planned.at(0.5), planned.to_profile().at(0.5));
    /// # Ok::<(), planner::InvalidFields>(())
    /// ```
    #[must_use]
    pub fn at(&self, t: f64) -> Setpoint {
        match self.order {
            2 => self.setpoint::<2, 3>(t),
            3 => self.setpoint::<3, 4>(t),
            4 => self.setpoint::<4, 5>(t),
            5 => self.setpoint::<5, 6>(t),
            6 => self.setpoint::<6, 7>(t),
            7 => self.setpoint::<7, 8>(t),
            _ => self.setpoint::<MAX_ORDER, { MAX_ORDER + 1 }>(t),
        }
    }

    /// The motion as a profile: at most 2ⁿ − 1 pieces, fewer where derivatives do not reach their limits.
    #[must_use]
    pub fn to_profile(&self) -> Profile {
        let pieces = match self.order {
            2 => self.lay::<2, 3>(),
            3 => self.lay::<3, 4>(),
            4 => self.lay::<4, 5>(),
            5 => self.lay::<5, 6>(),
            6 => self.lay::<6, 7>(),
            7 => self.lay::<7, 8>(),
            _ => self.lay::<MAX_ORDER, { MAX_ORDER + 1 }>(),
        };
        Profile::of_pieces(pieces, self.reached)
    }
}

/// The fastest symmetric profile of `order` from rest to rest: 2ⁿ − 1 pieces in which the derivative n is at its limit, at
/// minus its limit, or zero.
///
/// The velocity is a rectangle of time, averaged over n − 1 more of them. With `F₁ ≤ F₂ ≤ … ≤ Fₙ` their lengths \[s\], each at least the
/// sum of those before it, and `Xₖ` the peak of derivative `k` \[axis units/sᵏ\]:
///
/// ```text
/// Xₖ = Xₙ·F₁·F₂·…·Fₙ₋ₖ        distance = Xₙ·F₁·…·Fₙ        T = F₁ + … + Fₙ
/// ```
///
/// Source: Nguyen, Ng and Chen, *On algorithms for planning S-curve motion profiles* (2008), section 3; in closed recursion in
/// `notes/0006-n-th-order-and-trigonometric.md`.
///
/// Time-optimal for orders 2 and 3. From order 4 on it is optimal within this family, the one of the literature; a profile
/// without its symmetry can be shorter, at the price of arbitrarily many switches. How much shorter, by linear programmes
/// that were solved for this project (240 to 900 intervals; the distance, then the limits of velocity, acceleration …):
///
/// | order | distance; limits | this family \[s\] | least \[s\] | gap |
/// |---|---|---|---|---|
/// | 3 | 5; 1, 0.6, 1 | 7.2667 | 7.2667 | 0 % |
/// | 4 | 3; 0.5, 0.4, 0.5, 1 | 8.5616 | 8.5597 | 0.02 % |
/// | 4 | 0.05; 0.3, 0.25, 0.4, 1 | 2.2494 | 2.0944 | 7.4 % |
/// | 5 | 3; 0.5, 0.4, 0.5, 0.6, 1 | 10.0000 | 9.7303 | 2.8 % |
/// | 5 | 1; only the fifth | 6.9644 | 5.7239 | 21.7 % |
/// | 6 | 3; 0.5, 0.4, 0.5, 0.6, 0.7, 1 | 12.1047 | 10.9658 | 10.4 % |
/// | 6 | 1; only the sixth | 10.0794 | 7.0509 | 43 % |
///
/// The family treats speeding up and slowing down alike: where the limits differ, it keeps to the smaller one for both.
///
/// ```
/// use planner::{Limits, LimitsSpec, Problem, ShortPathPolicy, State, plan_polynomial};
///
/// // 50 mm at 60 mm/s, 600 mm/s², 12 000 mm/s³, 480 000 mm/s⁴.
/// let limits = Limits::try_from(LimitsSpec {
///     max_velocity: 60.0,
///     max_acceleration: 600.0,
///     max_jerk: 12e3,
///     max_snap: Some(480e3),
///     ..LimitsSpec::default()
/// })?;
/// let problem = Problem::new(State::at_rest(0.0), State::at_rest(50.0), limits, ShortPathPolicy::Reject)?;
/// let planned = plan_polynomial(&problem, 4)?;
/// assert!((planned.duration() - 1.008_333_333_333_333_3).abs() < 1e-15);
/// assert_eq!(planned.to_profile().segments().len(), 15);
/// # Ok::<(), planner::InvalidFields>(())
/// ```
///
/// # Errors
/// [`Why::OrderUnsupported`] outside 2 to [`MAX_ORDER`]; [`Why::LimitMissing`] and [`Why::LimitsTooFew`] where the order needs
/// limits that are not stated; [`Why::NotAtRest`] for a start or a goal in motion.
pub fn plan_polynomial(problem: &Problem, order: u32) -> Result<PolynomialMove, InvalidFields> {
    let (limits, goal) = (problem.limits(), problem.goal());
    let order = order as usize;
    let fits = unsupported(order).is_none()
        && (4..=order).all(|above| limits.higher(above).is_some())
        && problem.start().is_at_rest()
        && goal.is_at_rest();
    if !fits {
        return Err(refusal(problem, order));
    }
    let direction = problem.direction();
    let mut given = [0.0; MAX_ORDER + 1];
    given[0] = problem.distance().abs();
    given[1] = limits.cruise_towards(direction);
    given[2] = least(limits.acceleration(), limits.deceleration());
    given[3] = limits.jerk();
    for (above, limit) in given.iter_mut().enumerate().skip(4) {
        *limit = limits.higher(above).unwrap_or_default();
    }
    let solution = if given[0] > 0.0 { Solution::of(&given[..=order]) } else { Solution::NOTHING };
    let Solution { holds, boxes, peaks } = solution;
    let (start, reached) = (problem.start(), goal);
    let adjustments = feed_rate_above_limit(limits, direction).into_iter().collect();
    let classification = if order == 3 && given[0] > 0.0 {
        as_s_curve(&given, &solution)
    } else {
        Classification::of_speed(peaks[1])
    };
    Ok(PolynomialMove { order, start, reached, direction, holds, boxes, peaks, adjustments, classification })
}

/// What the papers call the third order, which is the S-curve with one limit for speeding up and slowing down: the S-curve's own names.
fn as_s_curve(given: &[f64; MAX_ORDER + 1], solution: &Solution) -> Classification {
    let [distance, velocity, acceleration, jerk, ..] = *given;
    let [_, speed, force, ..] = solution.peaks;
    let [cruise, hold, ..] = solution.holds;
    // A peak is a product of lengths, each good to what counts as no hold.
    let reaches = |peak: f64, limit: f64| peak >= limit * (1.0 - 3.0 * SNAP);
    let full = reaches(force, acceleration);
    Classification {
        eight_type: Some(EightType::of(cruise > 0.0, full, full)),
        // At the limit for an instant is not constant.
        asymmetric_type: Some(AsymmetricType::of(cruise > 0.0, hold > 0.0, hold > 0.0)),
        six_case: Some(SixCase::of_move(reaches(speed, velocity), distance, [velocity, acceleration, jerk])),
        feed_rate: speed,
    }
}

/// Everything that keeps a problem from having a polynomial of `order`.
#[cold]
fn refusal(problem: &Problem, order: usize) -> InvalidFields {
    let mut invalid = InvalidFields::default();
    invalid.note("order", unsupported(order));
    invalid.extend_within(&Field::named("limits"), missing_limits(problem.limits(), order));
    note_motion(&mut invalid, "POLYNOMIAL", [("start", &problem.start()), ("goal", &problem.goal())]);
    invalid
}

/// What is wrong with an order; nothing if there are polynomials of it.
pub(crate) fn unsupported(order: usize) -> Option<Why> {
    (!(2..=MAX_ORDER).contains(&order)).then_some(Why::OrderUnsupported { given: order })
}

/// The limits that a polynomial of `order` needs and that are not stated.
pub(crate) fn missing_limits(limits: &Limits, order: usize) -> InvalidFields {
    let mut invalid = InvalidFields::default();
    let lower = (4..=order).find(|&above| limits.higher(above).is_none()).map_or(order, |first| first - 1);
    if order > MAX_ORDER {
        return invalid;
    }
    let missing = |is_missing: bool, why: Why| is_missing.then_some(why);
    let (needed, given) = (order.saturating_sub(4), limits.spec().max_higher_derivatives.len());
    let none = Why::LimitMissing { order, lower };
    let too_few = Why::LimitsTooFew { order, needed, given, lower };
    invalid.note("max_snap", missing(order >= 4 && limits.higher(4).is_none(), none.clone()));
    invalid.note("max_higher_derivatives", missing(given < needed, if given == 0 { none } else { too_few }));
    invalid
}

/// Reports every part of an end that is not at rest, for a family that needs it.
pub(crate) fn note_motion(invalid: &mut InvalidFields, family: &'static str, ends: [(&str, &State); 2]) {
    for (end, state) in ends {
        for (part, given) in [("velocity", state.velocity), ("acceleration", state.acceleration)] {
            if given != 0.0 && given.is_finite() {
                let field = Field::named(part).within(&Field::named(end));
                invalid.note(field.as_str(), Some(Why::NotAtRest { given, family }));
            }
        }
    }
}

/// The lengths of time of a move, and what it reaches.
#[derive(Clone, Copy, Debug)]
struct Solution {
    holds: [f64; MAX_ORDER],
    boxes: [f64; MAX_ORDER],
    peaks: [f64; MAX_ORDER + 1],
}

impl Solution {
    const NOTHING: Self =
        Self { holds: [0.0; MAX_ORDER], boxes: [0.0; MAX_ORDER], peaks: [0.0; MAX_ORDER + 1] };

    /// For a distance > 0 and the limits of the derivatives 1 to n.
    ///
    /// Solved in units of length and time that are powers of two, so that no digit changes: the distance is then about 1, and so
    /// is the time that the limit which binds most needs for it.
    fn of(given: &[f64]) -> Self {
        let mut parts = [(0.0, 0); MAX_ORDER + 1];
        for (part, &value) in parts.iter_mut().zip(given) {
            *part = split(value);
        }
        let length = parts[0].1;
        let time = (1..given.len()).map(|order| quotient_up(length - parts[order].1, order));
        let time = time.fold(i32::MIN, i32::max);
        // Of the derivative `order`: a power of two.
        let unit = |order: usize| length - order as i32 * time;
        let mut scaled = [0.0; MAX_ORDER + 1];
        for (order, (value, &(mantissa, exponent))) in
            scaled.iter_mut().zip(&parts[..given.len()]).enumerate()
        {
            let greatest = GREATEST_EXPONENT * order as i32;
            *value = mantissa * power_of_two((exponent - unit(order)).min(greatest));
        }
        let mut solution = Self::scaled(&scaled[..given.len()]);
        let second = power_of_two(time);
        for value in solution.holds.iter_mut().chain(&mut solution.boxes) {
            *value *= second;
        }
        for (order, peak) in solution.peaks[..given.len()].iter_mut().enumerate() {
            *peak *= power_of_two(unit(order));
        }
        solution
    }

    /// The recursion: the shortest length first, each the longest that the distance and every limit allow while all longer
    /// ones are as short as they can be, that is, the sum of those before.
    fn scaled(given: &[f64]) -> Self {
        let order = given.len() - 1;
        let mut solution = Self::NOTHING;
        solution.peaks[order] = given[order];
        // The peak of the derivative that has just got its length, and the sum of the lengths so far.
        let (mut peak, mut sum) = (given[order], 0.0);
        for level in (0..order).rev() {
            // `limits[r]` is that of the derivative which has r more lengths to go.
            let length =
                if sum == 0.0 { first_length(given, peak) } else { next_length(&given[..=level], peak, sum) };
            let hold = length - sum;
            let hold = if hold > SNAP * order as f64 * length { hold } else { 0.0 };
            let length = sum + hold;
            solution.holds[level] = hold;
            solution.boxes[order - 1 - level] = length;
            peak *= length;
            sum += length;
            solution.peaks[level] = peak;
        }
        solution
    }
}

/// 2^(−r·(r − 1)/2): the inverse of what the lengths multiply to when each is the sum of those before it.
const HALVINGS: [f64; MAX_ORDER] =
    [1.0, 1.0, 0.5, 0.125, 0.015_625, 9.765_625e-4, 3.051_757_812_5e-5, 4.768_371_582_031_25e-7];

/// The first length: the least `y` of `y^(r+1) = C` over the distance and all limits.
///
/// The exponents tell beforehand which is likely to be least, so that mostly one root is taken.
fn first_length(given: &[f64], peak: f64) -> f64 {
    let order = given.len() - 1;
    let unit = 1.0 / peak;
    let target = |r: usize| given[order - 1 - r] * HALVINGS[r] * unit;
    let mut likely = 0;
    let mut least_log = f64::MAX;
    for r in 0..order {
        let log = log2(target(r)) * RECIPROCAL[r + 1];
        if log < least_log {
            (likely, least_log) = (r, log);
        }
    }
    let mut length = root(target(likely), likely + 1);
    for r in 0..order {
        if r != likely && power(length, r + 1) > target(r) {
            length = least(length, root(target(r), r + 1));
        }
    }
    length
}

/// A later length: the least `y` of `y·(sum + y)^r = C`, and no less than `sum`.
fn next_length(limits: &[f64], peak: f64, sum: f64) -> f64 {
    let last = limits.len() - 1;
    let unit = 1.0 / peak;
    let mut length = limits[last] / peak;
    for r in 1..=last {
        let target = limits[last - r] * HALVINGS[r] * unit;
        if length <= sum || sum * power(2.0 * sum, r) >= target {
            return sum;
        }
        if length * power(sum + length, r) <= target {
            continue;
        }
        length = if r == 1 {
            2.0 * target / (sum + sqrt(sum * sum + 4.0 * target))
        } else {
            let bound = least(least(length, target / power(sum, r)), rough_root(target, r + 1));
            fall_to_root(bound, |y| {
                let (base, below) = (sum + y, power(sum + y, r - 1));
                (y * below * base - target, below * (base + r as f64 * y))
            })
        };
    }
    length
}

/// The k-th root.
fn root(x: f64, k: usize) -> f64 {
    match k {
        1 => x,
        2 => sqrt(x),
        3 => cbrt(x),
        4 => sqrt(sqrt(x)),
        _ => fall_to_root(rough_root(x, k), |y| {
            let below = power(y, k - 1);
            (below * y - x, k as f64 * below)
        }),
    }
}

/// A little more than the k-th root, k ≥ 2: at most 13 % more. The bits of a number, read as an integer, grow as its logarithm
/// does, but for 0.086 between two powers of two.
fn rough_root(x: f64, k: usize) -> f64 {
    let bits = 1.0f64.to_bits() as i64 + (log2(x) * RECIPROCAL[k]) as i64;
    1.0625 * f64::from_bits(bits as u64)
}

/// About 2⁵²·log₂ of a positive number.
fn log2(x: f64) -> f64 {
    (x.to_bits() as i64 - 1.0f64.to_bits() as i64) as f64
}

fn power(x: f64, k: usize) -> f64 {
    let mut product = 1.0;
    for _ in 0..k {
        product *= x;
    }
    product
}

/// `x` over `k` in 1..=8, rounded up, for |x| up to 2200: by a product, as quotients of integers are slow.
fn quotient_up(x: i32, k: usize) -> i32 {
    /// A multiple of 1 to 8, so that what is divided is positive.
    const SHIFT: i32 = 3360;
    const PARTS: [i32; MAX_ORDER + 1] = {
        let mut parts = [0; MAX_ORDER + 1];
        let mut k = 1;
        while k <= MAX_ORDER {
            parts[k] = (1 << 16) / k as i32 + 1;
            k += 1;
        }
        parts
    };
    let whole = ((x + SHIFT + k as i32 - 1) * PARTS[k]) >> 16;
    whole - ((SHIFT * PARTS[k]) >> 16)
}

/// A positive number as a part in 1..2 and a power of two; in 0.5..1 below the normal numbers.
pub(crate) fn split(x: f64) -> (f64, i32) {
    const MANTISSA: u64 = (1 << 52) - 1;
    let bits = x.to_bits();
    if x < f64::MIN_POSITIVE {
        return libm::frexp(x);
    }
    (f64::from_bits((bits & MANTISSA) | 1.0f64.to_bits()), (bits >> 52) as i32 - 1023)
}

/// 2^`exponent`, or the nearest normal number to it.
pub(crate) fn power_of_two(exponent: i32) -> f64 {
    let biased = (exponent + 1023).clamp(1, 2046);
    f64::from_bits((biased as u64) << 52)
}

impl PolynomialMove {
    /// Lays the pieces end to end: those up to the cruise forward from the start, and those after it as their mirror image
    /// from the goal, each relative to its own end, so that both ends are met to the last bit.
    ///
    /// Piece k of the template holds derivative p = n − (number of zeros at the end of k in binary). Where a block that raises a
    /// derivative to its peak ends (of blocks that go + − − + − + + −, as Thue and Morse have it), the derivative and all above it are known and are put there exactly: what a long hold
    /// multiplies carries no rounding of the short pieces before it.
    /// `M` is N + 1: derivatives from the position to that of order N.
    fn lay<const N: usize, const M: usize>(&self) -> Pieces {
        let held = |p: usize| if self.holds[p - 1] > 0.0 { 1 << (p - 1) } else { 0 };
        let count: usize = (1..=N).map(held).sum();
        let derivatives = (4..=N).map(|p| held(p) * (p - 2)).sum();
        let mut pieces = Pieces::with_capacity(count, derivatives);
        // The derivatives where each piece before the cruise ends, and which of them it holds.
        let mut ends = ArrayVec::<(usize, [f64; M]), MAX_HALF>::new();
        let (from, to) = (self.start.position, self.reached.position);
        self.climb::<N, M>(|_, p, start, end| {
            push(&mut pieces, self.holds[p - 1], p, from, start);
            if p > 1 {
                ends.push((p, *end));
            }
            true
        });
        for (p, back) in ends.iter_mut().rev() {
            mirror(back);
            push(&mut pieces, self.holds[*p - 1], *p, to, back);
        }
        pieces
    }

    /// Walks over the pieces that last, up to the cruise, as long as it is told to go on: the number of each in the template, the derivative
    /// that it holds, and the derivatives where it starts and ends, the position counted from where the motion starts.
    #[inline]
    fn climb<const N: usize, const M: usize>(
        &self,
        mut see: impl FnMut(usize, usize, &[f64; M], &[f64; M]) -> bool,
    ) {
        // Signed peaks, and of each hold the powers of its length over the factorials.
        let mut peaks = [0.0; M];
        for (signed, peak) in peaks.iter_mut().zip(&self.peaks) {
            *signed = self.direction * peak;
        }
        let mut powers = [[0.0; M]; M];
        for (powers, hold) in powers[1..].iter_mut().zip(&self.holds[..N]) {
            let mut power = *hold;
            for i in 1..N {
                powers[i] = power;
                power *= hold * RECIPROCAL[i + 1];
            }
            powers[N] = power;
        }
        let turned = |block: usize, peak: f64| if block.count_ones() % 2 == 1 { -peak } else { peak };
        let mut now = [0.0; M];
        for k in 1..=1usize << (N - 1) {
            let p = N - k.trailing_zeros() as usize;
            now[N] = if p == N { turned(k >> 1, peaks[N]) } else { 0.0 };
            let start = now;
            let lasts = self.holds[p - 1] > 0.0;
            if lasts {
                // What is above p is zero, and adds nothing.
                advance(&mut now, &powers[p]);
            }
            if p == N {
                let raised = k.trailing_ones() as usize;
                now[N - raised + 1..N].fill(0.0);
                now[N - raised] = turned(k >> raised, peaks[N - raised]);
            }
            if lasts && !see(k, p, &start, &now) {
                return;
            }
        }
    }

    /// As [`Self::at`].
    fn setpoint<const N: usize, const M: usize>(&self, t: f64) -> Setpoint {
        if t < 0.0 {
            // An acceleration that jumps has done so before the first piece.
            return Setpoint::held(self.setpoint::<N, M>(0.0).state);
        }
        // Which piece: the running sum is that of the profile, and so are its bits. Also false for NaN.
        let (mut begin, mut found) = (0.0, None);
        for k in 1..1usize << N {
            let p = N - k.trailing_zeros() as usize;
            let next = begin + self.holds[p - 1];
            if t < next {
                found = Some((k, p));
                break;
            }
            begin = next;
        }
        let Some((k, p)) = found else { return Setpoint::held(self.reached) };
        let back = k > 1 << (N - 1);
        let wanted = if back { (1 << N) - k } else { k };
        let mut piece = [0.0; M];
        self.climb::<N, M>(|k, _, start, end| {
            if k == wanted {
                piece = if back { *end } else { *start };
            }
            k < wanted
        });
        let origin = if back { self.reached.position } else { self.start.position };
        if back {
            mirror(&mut piece);
        }
        evaluate(p, origin, &piece, t - begin)
    }
}

/// Seen from the goal, run backwards.
#[inline]
fn mirror<const M: usize>(derivatives: &mut [f64; M]) {
    derivatives.iter_mut().step_by(2).for_each(|even| *even = 0.0 - *even);
}

/// The setpoint of the piece that [`push`] lays, `t` seconds after its start.
#[inline]
fn evaluate<const M: usize>(p: usize, origin: f64, now: &[f64; M], t: f64) -> Setpoint {
    let [position, velocity, acceleration] = [0, 1, 2].map(|order| now[order]);
    let start = State { position: origin + position, velocity, acceleration };
    match now.get(3..=p).unwrap_or_default() {
        [] => Setpoint { state: start.after(0.0, t), jerk: 0.0 },
        [jerk] => Setpoint { state: start.after(*jerk, t), jerk: *jerk },
        higher => setpoint(higher, &start, t),
    }
}

/// The derivatives after a hold whose `powers` are its length's over the factorials: each gains the Taylor series of those above it.
///
/// Two sums side by side: each piece waits for the one before it, so what counts is how long the longest sum takes.
#[inline]
fn advance<const M: usize>(now: &mut [f64; M], powers: &[f64; M]) {
    for m in 0..M - 1 {
        let (mut sum, mut other) = (now[m], 0.0);
        for i in 1..M - m {
            let term = powers[i] * now[m + i];
            if i % 2 == 1 {
                sum += term;
            } else {
                other += term;
            }
        }
        now[m] = sum + other;
    }
}

/// Lays a piece whose highest derivative is p, from the derivatives at its start; those above p are zero.
#[inline]
fn push<const M: usize>(pieces: &mut Pieces, duration: f64, p: usize, origin: f64, now: &[f64; M]) {
    let [position, velocity, acceleration] = [0, 1, 2].map(|order| now[order]);
    let start = State { position: origin + position, velocity, acceleration };
    // One for each length, as a copy of a known length is no call.
    match now.get(3..=p).unwrap_or_default() {
        [] => pieces.push_jerk(duration, start, 0.0),
        [jerk] => pieces.push_jerk(duration, start, *jerk),
        &[j, s] => pieces.push_polynomial(duration, start, &[j, s]),
        &[j, s, c] => pieces.push_polynomial(duration, start, &[j, s, c]),
        &[j, s, c, b] => pieces.push_polynomial(duration, start, &[j, s, c, b]),
        higher => pieces.push_polynomial(duration, start, higher),
    }
}
