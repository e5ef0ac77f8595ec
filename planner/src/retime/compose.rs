//! The path as a function of time: of each stretch one polynomial.

use alloc::vec::Vec;

use super::course::Course;
use super::span::Span;
use super::walk::{Stretch, Walk};
use crate::derivatives::{FACTORIAL, MAX_DEGREE};
use crate::float::largest;
use crate::{Derivatives, Law, Profile, Segment, State};

/// Of the largest position on a path \[1\]: what its pieces may be apart by rounding.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Position and its derivatives by path time; those above the degree are zero.
struct Expansion {
    values: [f64; MAX_DEGREE + 1],
    degree: usize,
}

/// The motion along `path` on a course of path time, and whether it comes to the end of the path; else it comes to rest on the way.
///
/// `joined`: does the acceleration of the path join? Then a piece may be expanded about the state in which the next one begins.
pub(super) fn compose(path: &Profile, course: &Course, joined: bool) -> (Profile, bool) {
    let Course { law, end, .. } = course;
    let begin = law.first().map_or(*end, |first| first.start).position;
    // A hold covers little of a long path.
    let mut segments = Vec::with_capacity(4 * (law.len() + 1));
    let mut walk = Walk::new(path, law, begin, end.velocity > 0.0);
    segments.extend(walk.by_ref().map(|stretch| composed(path, &stretch, joined)));
    if walk.has_arrived() {
        return (Profile::new(segments, path.end()), true);
    }
    close_rounded_jumps(&mut segments, path);
    let rest = segments.last().map_or_else(|| path.at(begin).state, Segment::end);
    (Profile::new(segments, State::at_rest(rest.position).with_positive_zeros()), false)
}

/// Lets each piece begin where the one before it ends, but for what is more than rounding on the path. On the way to rest a motion may
/// be so short that the roundings of a long path are no roundings there; and nowhere does it have to be a digit beyond.
fn close_rounded_jumps(segments: &mut [Segment], path: &Profile) {
    let positions = path.joins().map(|state| state.position.abs());
    let slack = ROUNDING * positions.fold(0.0, largest);
    let mut end: Option<f64> = None;
    for segment in segments {
        let start = &mut segment.start.position;
        if let Some(end) = end.filter(|end| (end - *start).abs() <= slack) {
            *start = end;
        }
        end = Some(segment.end().position);
    }
}

fn composed(path: &Profile, stretch: &Stretch, joined: bool) -> Segment {
    let Stretch { piece, from, span: Span { duration, start, third } } = *stretch;
    let (rate, slope) = (start.velocity, start.acceleration);
    let base = path.segment(piece);
    #[expect(clippy::float_cmp, reason = "a piece that is taken whole and as it is keeps its bits")]
    if slope == 0.0 && third == 0.0 && rate == 1.0 && from == 0.0 && duration == base.duration {
        return base;
    }
    let expansion = Expansion::of(path, piece, from, joined).after_law(rate, slope, third);
    let (state, law) = expansion.law();
    Segment { duration, start: state, law }
}

impl Expansion {
    /// Piece number `piece` about the time `from` after its start.
    ///
    /// From the nearer end: half of a move that ends at zero is then known to all digits of what is left of it, as it
    /// is in the pieces that a solver lays backward from the goal.
    fn of(path: &Profile, piece: usize, from: f64, joined: bool) -> Self {
        let segment = path.segment(piece);
        if from <= 0.5 * segment.duration {
            return Self::about(&segment, from);
        }
        let mut end = segment.end();
        let next = path.segments().get(piece + 1).map_or(path.end(), |next| next.start);
        end.position = next.position;
        end.velocity = next.velocity;
        if joined {
            end.acceleration = next.acceleration;
        }
        let law = match segment.law {
            Law::Polynomial(_) => Self::about(&segment, segment.duration).law().1,
            law => law,
        };
        let reversed = Segment { duration: segment.duration, start: end, law };
        Self::about(&reversed, from - segment.duration)
    }

    fn about(segment: &Segment, t: f64) -> Self {
        let mut values = [0.0; MAX_DEGREE + 1];
        let setpoint = segment.at(t);
        values[..4].copy_from_slice(&setpoint.words());
        let degree = match &segment.law {
            Law::ConstantJerk(_) | Law::CosineJerk { .. } => 3,
            Law::Polynomial(derivatives) => {
                derivatives.higher(t, &mut values[4..]);
                derivatives.order()
            }
        };
        Self { values, degree }.trimmed()
    }

    /// Without derivatives that are zero.
    fn trimmed(mut self) -> Self {
        while self.degree > 0 && self.values[self.degree] == 0.0 {
            self.degree -= 1;
        }
        self
    }

    /// The derivatives by time, where path time goes on as `rate·t + slope·t²/2 + third·t³/6`: Horner's scheme on power series,
    ///
    /// ```text
    /// q(τ) = q₀ + τ·(q₁ + τ·(q₂/2! + τ·(q₃/3! + …)))
    /// ```
    ///
    /// with the polynomial of time for τ, the shortest products first. The first three are the chain rule: v = q′·τ′,
    /// a = q″·τ′² + q′·τ″, j = q‴·τ′³ + 3·q″·τ′·τ″ + q′·τ‴.
    fn after_law(&self, rate: f64, slope: f64, third: f64) -> Self {
        if slope == 0.0 && third == 0.0 {
            let (mut values, mut power) = (self.values, 1.0);
            for value in &mut values[..=self.degree] {
                *value *= power;
                power *= rate;
            }
            return Self { values, degree: self.degree };
        }
        let (half, sixth) = (0.5 * slope, third / 6.0);
        let law_degree = if third == 0.0 { 2 } else { 3 };
        let mut series = [0.0; MAX_DEGREE + 4];
        series[0] = self.values[self.degree] / FACTORIAL[self.degree];
        let mut degree = 0;
        for order in (0..self.degree).rev() {
            degree += law_degree;
            for k in (1..=degree).rev() {
                let one = rate * series[k - 1];
                let two = if k >= 2 { half * series[k - 2] } else { 0.0 };
                let three = if k >= 3 { sixth * series[k - 3] } else { 0.0 };
                series[k] = one + (two + three);
            }
            series[0] = self.values[order] / FACTORIAL[order];
        }
        let mut values = [0.0; MAX_DEGREE + 1];
        for ((value, coefficient), factorial) in values.iter_mut().zip(series).zip(FACTORIAL) {
            *value = coefficient * factorial;
        }
        Self { values, degree }.trimmed()
    }

    fn law(&self) -> (State, Law) {
        let [position, velocity, acceleration, jerk, ..] = self.values;
        let start = State { position, velocity, acceleration }.with_positive_zeros();
        let law = match Derivatives::new(&self.values[3..=largest_degree(self.degree)]) {
            Some(derivatives) if self.degree > 3 => Law::Polynomial(derivatives.with_positive_zeros()),
            _ => Law::ConstantJerk(jerk + 0.0),
        };
        (start, law)
    }
}

/// At least that of a jerk.
fn largest_degree(degree: usize) -> usize {
    degree.clamp(3, MAX_DEGREE)
}
