use alloc::vec::Vec;
use core::iter::FusedIterator;
use core::ops::Range;

use crate::derivatives::{Derivatives, setpoint};
use crate::{Law, Segment, Setpoint, State, cosine};

/// Segments as they are kept: 48 bytes for each, and what is above jerk in a list of its own.
///
/// A [`Segment`] has room for a polynomial of the highest degree, of which hardly any piece of a plan makes use: kept as such, ten
/// thousand points of six axes would be 29 MB, most of them zeros, and half of the time to plan them would be the system's, for
/// fresh memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Pieces {
    list: Vec<Kept>,
    /// Jerk, snap … of the polynomials, one piece after the other.
    derivatives: Vec<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Kept {
    duration: f64,
    start: State,
    law: KeptLaw,
}

/// As [`Law`].
#[derive(Clone, Copy, Debug, PartialEq)]
enum KeptLaw {
    ConstantJerk(f64),
    CosineJerk { peak: f64 },
    Polynomial { first: usize, count: u8 },
}

impl Pieces {
    /// Room for so many pieces, and so many derivatives from jerk on of the polynomials among them.
    pub(crate) fn with_capacity(pieces: usize, derivatives: usize) -> Self {
        Self { list: Vec::with_capacity(pieces), derivatives: Vec::with_capacity(derivatives) }
    }

    #[inline]
    pub(crate) fn push(&mut self, segment: &Segment) {
        let Segment { duration, start, law } = segment;
        match law {
            Law::ConstantJerk(jerk) => self.push_jerk(*duration, *start, *jerk),
            Law::CosineJerk { peak } => self.keep(*duration, *start, KeptLaw::CosineJerk { peak: *peak }),
            Law::Polynomial(derivatives) => self.push_polynomial(*duration, *start, derivatives.as_slice()),
        }
    }

    #[inline]
    pub(crate) fn push_jerk(&mut self, duration: f64, start: State, jerk: f64) {
        self.keep(duration, start, KeptLaw::ConstantJerk(jerk));
    }

    /// `derivatives`: jerk, snap …, at most as many as [`Derivatives`] has room for.
    #[inline]
    pub(crate) fn push_polynomial(&mut self, duration: f64, start: State, derivatives: &[f64]) {
        let (first, count) = (self.derivatives.len(), derivatives.len() as u8);
        self.derivatives.extend_from_slice(derivatives);
        self.keep(duration, start, KeptLaw::Polynomial { first, count });
    }

    #[inline]
    fn keep(&mut self, duration: f64, start: State, law: KeptLaw) {
        self.list.push(Kept { duration, start, law });
    }

    #[inline]
    pub(crate) fn len(&self) -> usize {
        self.list.len()
    }

    /// Takes all of them away, and keeps their room.
    pub(crate) fn clear(&mut self) {
        self.list.clear();
        self.derivatives.clear();
    }

    /// The greatest jerk of segment number `index`, which there is, if its jerk is a cosine.
    pub(crate) fn peak(&self, index: usize) -> Option<f64> {
        match self.list[index].law {
            KeptLaw::CosineJerk { peak } => Some(peak),
            KeptLaw::ConstantJerk(_) | KeptLaw::Polynomial { .. } => None,
        }
    }

    /// Is any of them a polynomial?
    #[inline]
    pub(crate) fn have_polynomials(&self) -> bool {
        !self.derivatives.is_empty()
    }

    /// Segment number `index`, which there is.
    #[inline]
    pub(crate) fn segment(&self, index: usize) -> Segment {
        let Kept { duration, start, law } = self.list[index];
        let law = match law {
            KeptLaw::ConstantJerk(jerk) => Law::ConstantJerk(jerk),
            KeptLaw::CosineJerk { peak } => Law::CosineJerk { peak },
            KeptLaw::Polynomial { first, count } => Law::Polynomial(self.polynomial(first, count)),
        };
        Segment { duration, start, law }
    }

    /// Duration, start and jerk of segment number `index`, which there is, if its jerk is constant.
    #[inline]
    pub(crate) fn constant_jerk(&self, index: usize) -> Option<(f64, State, f64)> {
        let Kept { duration, start, law } = &self.list[index];
        match law {
            KeptLaw::ConstantJerk(jerk) => Some((*duration, *start, *jerk)),
            KeptLaw::CosineJerk { .. } | KeptLaw::Polynomial { .. } => None,
        }
    }

    // Apart, so that a constant jerk does not clear the room of thirteen derivatives.
    #[inline(never)]
    fn polynomial(&self, first: usize, count: u8) -> Derivatives {
        Derivatives::kept(self.derivatives(first, count))
    }

    #[inline]
    fn derivatives(&self, first: usize, count: u8) -> &[f64] {
        &self.derivatives[first..first + usize::from(count)]
    }

    /// As [`Segment::at`] of segment number `index`, which there is.
    #[inline]
    pub(crate) fn at(&self, index: usize, t: f64) -> Setpoint {
        let Kept { duration, start, law } = &self.list[index];
        match law {
            KeptLaw::ConstantJerk(jerk) => Setpoint { state: start.after(*jerk, t), jerk: *jerk },
            KeptLaw::CosineJerk { peak } => cosine::setpoint(start, *peak, *duration, t),
            KeptLaw::Polynomial { first, count } => setpoint(self.derivatives(*first, *count), start, t),
        }
    }

    /// The state in which segment number `index` begins, if there is one.
    #[inline]
    pub(crate) fn start(&self, index: usize) -> Option<State> {
        self.list.get(index).map(|kept| kept.start)
    }

    /// How long segment number `index` lasts \[s\], if there is one.
    #[inline]
    pub(crate) fn duration(&self, index: usize) -> Option<f64> {
        self.list.get(index).map(|kept| kept.duration)
    }

    /// Lets segment number `index`, which there is, last `duration` \[s\].
    pub(crate) fn set_duration(&mut self, index: usize, duration: f64) {
        self.list[index].duration = duration;
    }
}

impl FromIterator<Segment> for Pieces {
    fn from_iter<I: IntoIterator<Item = Segment>>(segments: I) -> Self {
        let segments = segments.into_iter();
        let mut pieces = Self::with_capacity(segments.size_hint().0, 0);
        segments.for_each(|segment| pieces.push(&segment));
        pieces
    }
}

/// The segments of a [`Profile`](crate::Profile), in order.
///
/// ```
/// # use planner::{Law, Profile, Segment, State};
/// let away = Segment { duration: 1.0, start: State::at_rest(0.0), law: Law::ConstantJerk(6.0) };
/// let profile = Profile::new([away], away.end());
/// assert_eq!(profile.segments().len(), 1);
/// assert_eq!(profile.segments().first(), Some(away));
/// assert!(profile.segments().iter().all(|segment| segment.duration > 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segments<'a> {
    pieces: &'a Pieces,
}

impl<'a> Segments<'a> {
    #[inline]
    pub(crate) fn of(pieces: &'a Pieces) -> Self {
        Self { pieces }
    }

    /// How many there are.
    #[must_use]
    pub fn len(self) -> usize {
        self.pieces.len()
    }

    /// Is there none, since nothing moves?
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Segment number `index`, counted from zero, if there is one.
    #[must_use]
    #[inline]
    pub fn get(self, index: usize) -> Option<Segment> {
        (index < self.len()).then(|| self.pieces.segment(index))
    }

    /// Duration \[s\], start and jerk [axis units/s³] of segment number `index`, if there is one and its jerk is constant: as [`get`](Self::get),
    /// without the room that a [`Segment`] has for polynomials.
    ///
    /// ```
    /// # use planner::{Law, Profile, Segment, State};
    /// let away = Segment { duration: 1.0, start: State::at_rest(0.0), law: Law::ConstantJerk(6.0) };
    /// let profile = Profile::new([away], away.end());
    /// assert_eq!(profile.segments().constant_jerk(0), Some((1.0, State::at_rest(0.0), 6.0)));
    /// assert_eq!(profile.segments().constant_jerk(1), None);
    /// ```
    #[must_use]
    #[inline]
    pub fn constant_jerk(self, index: usize) -> Option<(f64, State, f64)> {
        (index < self.len()).then(|| self.pieces.constant_jerk(index)).flatten()
    }

    /// The first, if there is one.
    #[must_use]
    pub fn first(self) -> Option<Segment> {
        self.get(0)
    }

    /// The last, if there is one.
    #[must_use]
    pub fn last(self) -> Option<Segment> {
        self.len().checked_sub(1).and_then(|last| self.get(last))
    }

    /// All of them, to be changed.
    #[must_use]
    pub fn to_vec(self) -> Vec<Segment> {
        self.iter().collect()
    }

    /// One after the other, from either end.
    #[must_use]
    #[inline]
    pub fn iter(self) -> SegmentsIter<'a> {
        SegmentsIter { pieces: self.pieces, indices: 0..self.len() }
    }
}

impl<'a> IntoIterator for Segments<'a> {
    type Item = Segment;
    type IntoIter = SegmentsIter<'a>;

    fn into_iter(self) -> SegmentsIter<'a> {
        self.iter()
    }
}

/// Gives the [`Segments`] of a profile one after the other.
#[derive(Clone, Debug)]
pub struct SegmentsIter<'a> {
    pieces: &'a Pieces,
    indices: Range<usize>,
}

impl Iterator for SegmentsIter<'_> {
    type Item = Segment;

    #[inline]
    fn next(&mut self) -> Option<Segment> {
        self.indices.next().map(|index| self.pieces.segment(index))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.indices.size_hint()
    }

    fn nth(&mut self, n: usize) -> Option<Segment> {
        self.indices.nth(n).map(|index| self.pieces.segment(index))
    }
}

impl DoubleEndedIterator for SegmentsIter<'_> {
    fn next_back(&mut self) -> Option<Segment> {
        self.indices.next_back().map(|index| self.pieces.segment(index))
    }
}

impl ExactSizeIterator for SegmentsIter<'_> {}
impl FusedIterator for SegmentsIter<'_> {}
