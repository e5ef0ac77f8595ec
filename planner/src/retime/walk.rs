use super::span::Span;
use crate::float::largest;
use crate::roots::sign_change;
use crate::{Profile, State};

/// Of a time \[1\]: what is over but for this is over. Times are sums of durations, and exact to a few roundings.
pub(super) const TOGETHER: f64 = 8.0 * f64::EPSILON;
/// Of the last span \[1\]: how much longer it may last until the path ends, as both are sums of rounded durations.
const OVERTIME: f64 = 1e-9;

/// A stretch in which the path is one polynomial of path time, and path time one cubic of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stretch {
    /// Which piece of the path.
    pub(super) piece: usize,
    /// Where in that piece it begins \[s of path time\].
    pub(super) from: f64,
    /// Path time within it: zero at its start.
    pub(super) span: Span,
}

/// The stretches of one axis under a time law, in order; ends with the path or with the law.
///
/// Counts path time from the start of each piece, so that nothing is lost on long paths.
#[derive(Debug)]
pub(super) struct Walk<'a> {
    path: &'a Profile,
    law: core::slice::Iter<'a, Span>,
    piece: usize,
    from: f64,
    /// What is left of the present span; path time zero at its start.
    left: Option<Span>,
    /// The law goes on where its spans end.
    runs_on: bool,
}

impl<'a> Walk<'a> {
    /// From path time `begin` on, at which the law begins. A law that `runs_on` does not end before the path by a rounding: its last
    /// span goes on for a little, or without end where its rate stays.
    pub(super) fn new(path: &'a Profile, law: &'a [Span], begin: f64, runs_on: bool) -> Self {
        Self::from_place(path, law, place_of(path, begin), runs_on)
    }

    /// As [`Self::new`], where the place on the path is known.
    pub(super) fn from_place(
        path: &'a Profile,
        law: &'a [Span],
        (piece, from): (usize, f64),
        runs_on: bool,
    ) -> Self {
        let mut walk = Self { path, law: law.iter(), piece, from, left: None, runs_on };
        walk.left = walk.next_span();
        walk
    }

    /// Has it come to the end of the path?
    pub(super) fn has_arrived(&self) -> bool {
        self.piece >= self.path.segments().len()
    }

    fn next_span(&mut self) -> Option<Span> {
        let span = self.law.next()?;
        let start = State { position: 0.0, ..span.start };
        let duration = match self.runs_on && self.law.as_slice().is_empty() {
            true if span.is_steady() => f64::INFINITY,
            true => {
                let State { position, velocity, .. } = span.end();
                span.duration * (1.0 + OVERTIME) + TOGETHER * position / velocity
            }
            false => span.duration,
        };
        Some(Span { duration, start, third: span.third })
    }
}

impl Iterator for Walk<'_> {
    type Item = Stretch;

    fn next(&mut self) -> Option<Stretch> {
        loop {
            let length = self.path.segments().get(self.piece)?.duration;
            let span = self.left?;
            let rest = length - self.from;
            let whole = span.end();
            let passed = crossing(&span, &whole, rest);
            let duration = passed.unwrap_or(span.duration);
            let stretch = Stretch { piece: self.piece, from: self.from, span: Span { duration, ..span } };
            let end = if passed.is_some() { span.at(duration) } else { whole };
            // What was planned to begin or end at a join does so, though rounding put it beside it: in the sliver between, the
            // jerk would be that of neither. No such care at the end of the path, which would not be reached.
            let (left, slack) = (span.duration - duration, TOGETHER * self.path.duration());
            let at_join = self.piece + 1 < self.path.segments().len() && rest - end.position <= slack;
            let at_end = left * end.velocity <= slack && left <= OVERTIME * span.duration;
            if passed.is_some() || at_join {
                (self.piece, self.from) = (self.piece + 1, 0.0);
            } else {
                self.from += end.position;
            }
            self.left = if at_end {
                self.next_span()
            } else {
                let start = State { position: 0.0, ..end };
                Some(Span { duration: largest(0.0, left), start, third: span.third })
            };
            if duration > 0.0 {
                return Some(stretch);
            }
        }
    }
}

/// The piece in which path time `begin` lies, but for a rounding, and where in it.
pub(super) fn place_of(path: &Profile, begin: f64) -> (usize, f64) {
    let (piece, from) = path.place_of(begin);
    match path.piece_duration(piece) {
        // A path time is as exact as itself, however short the piece that it lies in.
        Some(duration) if duration - from <= TOGETHER * largest(duration, begin) => (piece + 1, 0.0),
        _ => (piece, from),
    }
}

/// When path time has come `rest` further \[s\]; `None` where it does not. `whole` is where the span ends.
fn crossing(span: &Span, whole: &State, rest: f64) -> Option<f64> {
    if span.is_steady() {
        let passes = span.start.velocity * span.duration >= rest;
        return passes.then(|| rest / span.start.velocity);
    }
    if whole.position < rest {
        return None;
    }
    let beyond = |t: f64| {
        let State { position, velocity, .. } = span.at(t);
        (position - rest, velocity)
    };
    let near = sign_change(0.0, span.duration, beyond)?;
    // That is known to a rounding of the span, and needed to one of the rest, which may be much shorter.
    let (value, slope) = beyond(near);
    let polished = near - value / slope;
    Some(if polished >= 0.0 && polished <= span.duration { polished } else { near })
}
