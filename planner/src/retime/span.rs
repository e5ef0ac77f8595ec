use arrayvec::ArrayVec;

use crate::float::{largest, sqrt};
use crate::{Law, Segment, State};

/// A piece of a time law, whose third derivative is constant: path time, its rate and the slope of the rate are a [`State`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Span {
    /// \[s\]
    pub(super) duration: f64,
    /// Path time \[s\], its rate \[1\], the slope of the rate \[1/s\].
    pub(super) start: State,
    /// The third derivative of path time \[1/s²\].
    pub(super) third: f64,
}

impl Span {
    /// From `start` on without change of rate.
    pub(super) fn steady(start: State, duration: f64) -> Self {
        Self { duration, start: State { acceleration: 0.0, ..start }, third: 0.0 }
    }

    pub(super) fn at(&self, t: f64) -> State {
        self.start.after(self.third, t)
    }

    pub(super) fn end(&self) -> State {
        self.at(self.duration)
    }

    /// Does the rate stay as it is?
    pub(super) fn is_steady(&self) -> bool {
        self.third == 0.0 && self.start.acceleration == 0.0
    }

    pub(super) fn segment(&self) -> Segment {
        let start = self.start.with_positive_zeros();
        Segment { duration: self.duration, start, law: Law::ConstantJerk(self.third + 0.0) }
    }
}

/// The fastest change of a rate to one that then stays, its slope and third derivative within bounds.
///
/// ```text
/// slope │    ╭────╮          up to the peak, hold, back to zero; from a slope above its bound down to that first,
///       │   ╱      ╲         from a slope of the other sign through zero
///       └──╱────────╲── t
/// ```
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ramp {
    pub(super) spans: ArrayVec<Span, 3>,
    /// Path time at the end, the rate that was asked for, no slope.
    pub(super) end: State,
    /// The greatest slope on the way \[1/s\], a magnitude; without that at the start, which is not the ramp's choice.
    pub(super) peak: f64,
}

impl Ramp {
    /// From `start` to `rate` with the slope within ±`slope` and the third derivative within ±`third`; `None` where path time
    /// would go back on the way.
    ///
    /// With the sign of the change taken out, `c` the bound of the third derivative, `s` the slope at the start and `g` the change
    /// of rate, the slope goes from `s` to a peak `p` and to zero: `(p² − s²)/2c + p²/2c = g`, so `p² = c·g + s²/2`; where that is
    /// more than the bound `b`, it is `b`, held for what of `g` is left.
    pub(super) fn of(start: State, rate: f64, slope: f64, third: f64) -> Option<Self> {
        let State { velocity: before, acceleration: given, .. } = start;
        // The rate, were the slope brought to zero at once.
        let stopped = before + given * given.abs() / (2.0 * third);
        let direction = if rate < stopped { -1.0 } else { 1.0 };
        let (s, change) = (direction * given, direction * (rate - before));
        let square = largest(0.0, third * change + 0.5 * s * s);
        let peak = sqrt(square);
        let (peak, held) = if peak <= slope || peak <= 0.0 {
            (peak, 0.0)
        } else {
            // Below the bound up to it, above it down to it.
            let flanks = 2.0 * slope * slope - s * s;
            let to_bound = if s > slope { 0.5 * s * s / third } else { 0.5 * flanks / third };
            (slope, largest(0.0, (change - to_bound) / slope))
        };
        let toward = if s > peak { -third } else { third };
        let parts = [((peak - s).abs() / third, toward), (held, 0.0), (peak / third, -third)];
        let (mut spans, mut now) = (ArrayVec::new(), start);
        for (duration, third) in parts {
            if duration > 0.0 {
                let span = Span { duration, start: now, third: direction * third };
                // The least rate is at an end, or where the slope is zero.
                let turn = -now.acceleration / span.third;
                if turn > 0.0 && turn < duration && span.at(turn).velocity < 0.0 {
                    return None;
                }
                spans.push(span);
                now = span.end();
            }
        }
        let end = State { velocity: rate, acceleration: 0.0, ..now };
        let fits =
            now.position.is_finite() && now.velocity.is_finite() && (!spans.is_empty() || change == 0.0);
        fits.then_some(Self { spans, end, peak })
    }

    /// How long it takes \[s\].
    pub(super) fn duration(&self) -> f64 {
        self.spans.iter().map(|span| span.duration).fold(0.0, |sum, duration| sum + duration)
    }
}
