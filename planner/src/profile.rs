use alloc::vec::Vec;

use crate::{Segment, Setpoint, State};

/// One axis's motion: segments that follow each other from time zero, and the state in which it rests or drifts after.
///
/// Whether the segments join, and whether they keep any limit, is for [`violations`](crate::violations) to say.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    segments: Vec<Segment>,
    /// When each segment begins \[s\]: the running sum of the durations, in order.
    begins: Vec<f64>,
    duration: f64,
    end: State,
}

impl Profile {
    /// The motion through `segments`, which ends in exactly `end`.
    #[must_use]
    pub fn new(segments: Vec<Segment>, end: State) -> Self {
        let mut duration = 0.0;
        let begins = segments
            .iter()
            .map(|segment| {
                let begin = duration;
                duration += segment.duration;
                begin
            })
            .collect();
        Self { segments, begins, duration, end }
    }

    /// The pieces, in order; none where nothing moves.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Each piece with the time at which it begins \[s\].
    pub fn timed_segments(&self) -> impl Iterator<Item = (f64, &Segment)> {
        self.begins.iter().copied().zip(&self.segments)
    }

    /// How long the motion lasts \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The state before the motion.
    #[must_use]
    pub fn start(&self) -> State {
        self.segments.first().map_or(self.end, |first| first.start)
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
        let slowed = |segment: &Segment| segment.slowed(factor);
        Self::new(self.segments.iter().map(slowed).collect(), self.end)
    }

    /// The same motion, lasting `duration` \[s\], of which it is some roundings short or long.
    pub(crate) fn lasting(self, duration: f64) -> Self {
        let Self { mut segments, end, .. } = self;
        let mut durations: Vec<f64> = segments.iter().map(|segment| segment.duration).collect();
        add_up(&mut durations, duration);
        for (segment, duration) in segments.iter_mut().zip(durations) {
            segment.duration = duration;
        }
        Self::new(segments, end)
    }

    /// When the axis turns back \[s\]: each instant at which the velocity changes its sign, in order.
    ///
    /// ```
    /// # use planner::{Law, Profile, Segment, State};
    /// let throw = Segment {
    ///     duration: 2.0,
    ///     start: State { position: 0.0, velocity: 4.0, acceleration: -4.0 },
    ///     law: Law::ConstantJerk(0.0),
    /// };
    /// assert_eq!(Profile::new(vec![throw], throw.end()).reversals().collect::<Vec<_>>(), [1.0]);
    /// ```
    pub fn reversals(&self) -> impl Iterator<Item = f64> {
        let mut sign = 0.0;
        self.timed_segments()
            .flat_map(|(begin, segment)| {
                let times = segment.turning_points();
                // Between two turning points the velocity keeps its sign.
                (1..times.len()).map(move |index| {
                    let middle = 0.5 * (times[index - 1] + times[index]);
                    (begin + times[index - 1], segment.at(middle).state.velocity)
                })
            })
            .filter_map(move |(time, velocity)| {
                let turns = velocity * sign < 0.0;
                if velocity != 0.0 {
                    sign = velocity.signum();
                }
                turns.then_some(time)
            })
    }

    /// Which piece time `t` lies in, and when in that piece \[s\]; the one after the last from `duration` on.
    pub(crate) fn place_of(&self, t: f64) -> (usize, f64) {
        // Also for NaN: at the end.
        let inside = t < self.duration && !self.begins.is_empty();
        if !inside {
            return (self.segments.len(), 0.0);
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
        let mut segments = self.segments.clone();
        segments.extend_from_slice(&more.segments);
        Self::new(segments, more.end)
    }
}

/// Makes the running sum of `durations` come to `total`, of which it is some roundings short or long, to the last bit or two, by a
/// change of the longest, where it is worth least.
pub(crate) fn add_up(durations: &mut [f64], total: f64) {
    let sum = durations.iter().fold(0.0, |sum, duration| sum + duration);
    if let Some(longest) = durations.iter_mut().max_by(|a, b| a.total_cmp(b)) {
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

impl<'a> Cursor<'a> {
    /// At the beginning of `profile`.
    #[must_use]
    pub fn new(profile: &'a Profile) -> Self {
        Self { profile, index: 0 }
    }

    /// As [`Profile::at`].
    #[inline]
    pub fn at(&mut self, t: f64) -> Setpoint {
        let Profile { segments, begins, duration, end } = self.profile;
        // Also for NaN: nothing moves.
        let inside = t < *duration;
        if !inside {
            return Setpoint::held(*end);
        }
        if t < 0.0 {
            return Setpoint::held(self.profile.start());
        }
        if begins[self.index] > t {
            self.index = begins.partition_point(|&begin| begin <= t) - 1;
        } else if begins.get(self.index + 1).is_some_and(|&next| next <= t) {
            self.index += 1;
            if begins.get(self.index + 1).is_some_and(|&next| next <= t) {
                self.index = begins.partition_point(|&begin| begin <= t) - 1;
            }
        }
        segments[self.index].at(t - begins[self.index])
    }
}
