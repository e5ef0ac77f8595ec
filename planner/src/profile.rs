use alloc::vec::Vec;

use crate::float::largest;
use crate::segments::{Pieces, Segments};
use crate::{Segment, Setpoint, State};

/// One axis's motion: segments that follow each other from time zero, and the state in which it rests or drifts after.
///
/// Whether the segments join, and whether they keep any limit, is for [`violations`](crate::violations) to say.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    pieces: Pieces,
    /// When each segment begins \[s\]: the running sum of the durations, in order.
    begins: Vec<f64>,
    duration: f64,
    end: State,
}

impl Profile {
    /// The motion through `segments`, which ends in exactly `end`.
    #[must_use]
    pub fn new(segments: impl IntoIterator<Item = Segment>, end: State) -> Self {
        Self::of_pieces(segments.into_iter().collect(), end)
    }

    pub(crate) fn of_pieces(pieces: Pieces, end: State) -> Self {
        let mut duration = 0.0;
        let mut begins = Vec::with_capacity(pieces.len());
        for length in (0..pieces.len()).filter_map(|index| pieces.duration(index)) {
            begins.push(duration);
            duration += length;
        }
        Self { pieces, begins, duration, end }
    }

    /// Makes it another motion, to `end`, that has no pieces yet and the room of those that it had.
    pub(crate) fn begin_again(&mut self, end: State) {
        self.pieces.clear();
        self.begins.clear();
        self.duration = 0.0;
        self.end = end;
    }

    /// Goes on with a piece.
    pub(crate) fn push(&mut self, segment: &Segment) {
        self.begins.push(self.duration);
        self.duration += segment.duration;
        self.pieces.push(segment);
    }

    /// Goes on with a piece of constant jerk.
    #[inline]
    pub(crate) fn push_jerk(&mut self, duration: f64, start: State, jerk: f64) {
        self.begins.push(self.duration);
        self.duration += duration;
        self.pieces.push_jerk(duration, start, jerk);
    }

    /// The greatest jerk of piece number `index`, which there is, if its jerk is a cosine.
    pub(crate) fn peak(&self, index: usize) -> Option<f64> {
        self.pieces.peak(index)
    }

    /// The pieces, in order; none where nothing moves.
    #[must_use]
    #[inline]
    pub fn segments(&self) -> Segments<'_> {
        Segments::of(&self.pieces)
    }

    /// Piece number `index`, which there is.
    #[inline]
    pub(crate) fn segment(&self, index: usize) -> Segment {
        self.pieces.segment(index)
    }

    /// Duration, start and jerk of piece number `index`, which there is, if its jerk is constant.
    #[inline]
    pub(crate) fn constant_jerk(&self, index: usize) -> Option<(f64, State, f64)> {
        self.pieces.constant_jerk(index)
    }

    /// Is any piece a [`Law::Polynomial`](crate::Law::Polynomial)?
    #[inline]
    pub(crate) fn has_polynomials(&self) -> bool {
        self.pieces.have_polynomials()
    }

    /// How long piece number `index` lasts \[s\], if there is one.
    #[inline]
    pub(crate) fn piece_duration(&self, index: usize) -> Option<f64> {
        self.pieces.duration(index)
    }

    /// As [`Segment::at`] of piece number `index`, which there is.
    #[inline]
    pub(crate) fn piece_at(&self, index: usize, t: f64) -> Setpoint {
        self.pieces.at(index, t)
    }

    /// The setpoints with which piece number `index` begins and ends; there is that piece.
    #[inline]
    pub(crate) fn setpoints_at_ends(&self, index: usize) -> [Setpoint; 2] {
        let duration = self.pieces.duration(index).unwrap_or_default();
        [0.0, duration].map(|t| self.pieces.at(index, t))
    }

    /// When each piece begins \[s\].
    #[inline]
    pub(crate) fn begins(&self) -> &[f64] {
        &self.begins
    }

    /// Each piece with the time at which it begins \[s\].
    pub fn timed_segments(&self) -> impl Iterator<Item = (f64, Segment)> {
        self.begins.iter().copied().zip(self.segments())
    }

    /// The state at each join, from that before the motion to that after it.
    pub(crate) fn joins(&self) -> impl Iterator<Item = State> {
        (0..self.pieces.len()).filter_map(|index| self.pieces.start(index)).chain([self.end])
    }

    /// How long the motion lasts \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The state before the motion.
    #[must_use]
    pub fn start(&self) -> State {
        self.pieces.start(0).unwrap_or(self.end)
    }

    /// The state at the end, exactly.
    #[must_use]
    pub fn end(&self) -> State {
        self.end
    }

    /// The setpoint at time `t` \[s\]: the start before zero, and exactly the end from `duration` on, so that an axis that
    /// has arrived never creeps.
    #[must_use]
    pub fn at(&self, t: f64) -> Setpoint {
        Cursor::new(self).at(t)
    }

    /// The same way in `factor ≥ 1` times the time, for a motion from rest to rest: every derivative of order k is divided by
    /// `factorᵏ`, so that whatever limit was kept still is.
    #[must_use]
    pub fn slowed(&self, factor: f64) -> Self {
        Self::new(self.segments().iter().map(|segment| segment.slowed(factor)), self.end)
    }

    /// The same motion, lasting `duration` \[s\], of which it is some roundings short or long.
    pub(crate) fn lasting(self, duration: f64) -> Self {
        let Self { mut pieces, end, .. } = self;
        let mut durations: Vec<f64> = (0..pieces.len()).filter_map(|index| pieces.duration(index)).collect();
        add_up(&mut durations, duration);
        for (index, duration) in durations.into_iter().enumerate() {
            pieces.set_duration(index, duration);
        }
        Self::of_pieces(pieces, end)
    }

    /// When the axis turns back \[s\]: each instant at which the velocity changes its sign, in order. A speed that is a rounded zero beside
    /// the fastest goes in no direction.
    ///
    /// ```
    /// # use planner::{Law, Profile, Segment, State};
    /// let throw = Segment {
    ///     duration: 2.0,
    ///     start: State { position: 0.0, velocity: 4.0, acceleration: -4.0 },
    ///     law: Law::ConstantJerk(0.0),
    /// };
    /// assert_eq!(Profile::new([throw], throw.end()).reversals().collect::<Vec<_>>(), [1.0]);
    /// ```
    pub fn reversals(&self) -> impl Iterator<Item = f64> {
        // Between two turning points the velocity keeps its sign.
        let mut spans: Vec<(f64, f64)> = Vec::with_capacity(self.begins.len());
        for (begin, segment) in self.timed_segments() {
            let times = segment.turning_points();
            spans.extend(times.windows(2).map(|ends| {
                let middle = segment.at(0.5 * (ends[0] + ends[1]));
                (begin + ends[0], middle.state.velocity)
            }));
        }
        turns(spans)
    }

    /// Which piece time `t` lies in, and when in that piece \[s\]; the one after the last from `duration` on.
    pub(crate) fn place_of(&self, t: f64) -> (usize, f64) {
        // Also for NaN: at the end.
        let inside = t < self.duration && !self.begins.is_empty();
        if !inside {
            return (self.pieces.len(), 0.0);
        }
        let index = self.begins.partition_point(|&begin| begin <= t).saturating_sub(1);
        (index, t - self.begins[index])
    }

    /// The ends of the piece that time `t` lies in \[s\]; none where it lies in no piece.
    pub(crate) fn piece_around(&self, t: f64) -> Option<(f64, f64)> {
        let next = self.begins.partition_point(|&begin| begin <= t);
        let (begin, end) = (*self.begins.get(next.checked_sub(1)?)?, self.begins.get(next));
        let end = end.copied().unwrap_or(self.duration);
        (end > t).then_some((begin, end))
    }

    /// The same motion with `more` after it.
    #[must_use]
    pub fn followed_by(&self, more: &Profile) -> Self {
        Self::new(self.segments().iter().chain(more.segments()), more.end)
    }
}

/// When a motion turns back, of spans in which its velocity keeps its sign: when each begins \[s\], and a velocity inside it.
pub(crate) fn turns(spans: Vec<(f64, f64)>) -> impl Iterator<Item = f64> {
    let fastest = spans.iter().fold(0.0, |most, (_, velocity)| largest(most, velocity.abs()));
    let mut sign = 0.0;
    let directed = spans.into_iter().filter(move |(_, velocity)| velocity.abs() > ROUNDED_SPEED * fastest);
    directed.filter_map(move |(time, velocity)| {
        let turns = velocity * sign < 0.0;
        sign = velocity.signum();
        turns.then_some(time)
    })
}

/// Of the fastest \[1\]: a speed up to this may be that of a motion which has arrived, at a zero of its velocity that was found a rounding
/// early. Zeros are closed in on to 4ε of a duration T, and where a polynomial of degree n and greatest magnitude M vanishes its slope is at
/// most 2n²M/T (Markov): for the velocity of a quintic, n = 4, that is 128ε of M.
const ROUNDED_SPEED: f64 = 128.0 * f64::EPSILON;

/// Makes the running sum of `durations` come to `total`, of which it is some roundings short or long, to the last bit or two, by a
/// change of the longest, where it is worth least.
pub(crate) fn add_up<'a>(durations: impl IntoIterator<Item = &'a mut f64>, total: f64) {
    let (mut sum, mut longest) = (0.0, None::<&mut f64>);
    for duration in durations {
        sum += *duration;
        // The last of several that are as long.
        if longest.as_ref().is_none_or(|longest| **longest <= *duration) {
            longest = Some(duration);
        }
    }
    if let Some(longest) = longest {
        *longest += total - sum;
    }
}

/// Reads a [`Profile`] at times that mostly go forward, without searching from the beginning each time.
///
/// The answer depends on the time alone, never on what was asked before: replicas that start in the middle get the
/// same bits.
#[derive(Clone, Debug)]
pub struct Cursor<'a> {
    profile: &'a Profile,
    index: usize,
}

/// A piece of constant jerk, and when it begins and ends \[s\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    pub(crate) begin: f64,
    pub(crate) end: f64,
    pub(crate) start: State,
    pub(crate) jerk: f64,
}

impl<'a> Cursor<'a> {
    /// At the beginning of `profile`.
    #[must_use]
    pub fn new(profile: &'a Profile) -> Self {
        Self { profile, index: 0 }
    }

    /// As [`Profile::at`].
    #[inline]
    pub fn at(&mut self, t: f64) -> Setpoint {
        let Profile { pieces, begins, duration, end } = self.profile;
        // Also for NaN: nothing moves.
        let inside = t < *duration;
        if !inside {
            return Setpoint::held(*end);
        }
        if t < 0.0 {
            return Setpoint::held(self.profile.start());
        }
        self.seek(t);
        pieces.at(self.index, t - begins[self.index])
    }

    /// The piece of constant jerk that time `t` lies in, if it lies in one.
    #[inline]
    pub(crate) fn constant_jerk(&mut self, t: f64) -> Option<Span> {
        let Profile { pieces, begins, duration, .. } = self.profile;
        if !(0.0..*duration).contains(&t) {
            return None;
        }
        self.seek(t);
        let (_, start, jerk) = pieces.constant_jerk(self.index)?;
        let end = *begins.get(self.index + 1).unwrap_or(duration);
        Some(Span { begin: begins[self.index], end, start, jerk })
    }

    /// Goes to the piece that time `t` lies in; it lies in one.
    #[inline]
    fn seek(&mut self, t: f64) {
        let begins = self.profile.begins();
        if begins[self.index] > t {
            self.index = begins.partition_point(|&begin| begin <= t) - 1;
        } else if begins.get(self.index + 1).is_some_and(|&next| next <= t) {
            self.index += 1;
            if begins.get(self.index + 1).is_some_and(|&next| next <= t) {
                self.index = begins.partition_point(|&begin| begin <= t) - 1;
            }
        }
    }
}
