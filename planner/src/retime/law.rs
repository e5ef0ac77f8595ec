use alloc::vec::Vec;

use super::course::Course;
use super::span::Span;
use super::walk::TOGETHER;
use crate::error::{Field, InvalidFields, Why};
use crate::roots::sign_change;
use crate::{Law, Plan, Profile, Segment, State};

/// A rate of path time \[1\] that is zero but for the rounding of those before it, which are about 1. No plan is slowed so far: it
/// would last for more cycles than can be counted.
const REST: f64 = 1e-14;

/// Path time τ as a function of time: a cubic in pieces.
///
/// On the wire it is its pieces, and from them who goes on with a motion has the same law to the last bit.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeLaw {
    profile: Profile,
}

impl TimeLaw {
    /// That of a plan that nothing has been done to: path time is time.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        let start = State { position: 0.0, velocity: 1.0, acceleration: 0.0 };
        Self::joined(alloc::vec![Span::steady(start, plan.duration()).segment()])
    }

    /// As its pieces come from elsewhere: position is path time \[s\], velocity its rate \[1\].
    ///
    /// # Errors
    /// No piece; one whose jerk is not constant; a number that is not finite; a duration below zero; path time that begins
    /// before zero or goes back there.
    pub fn new(segments: Vec<Segment>) -> Result<Self, InvalidFields> {
        let mut invalid = InvalidFields::default();
        if segments.is_empty() {
            invalid.note("base_time", Some(Why::NoTimeLaw));
        }
        for (index, segment) in segments.iter().enumerate() {
            invalid.note(Field::element("base_time", index).as_str(), fault(segment));
        }
        if invalid.is_empty() { Ok(Self::joined(segments)) } else { Err(invalid) }
    }

    /// Where the pieces lead follows from them alone, so that who gets them has the same law to the last bit. A rate that is zero but
    /// for a rounding is rest.
    fn joined(segments: Vec<Segment>) -> Self {
        let end = segments.last().map_or(State::at_rest(0.0), |last| {
            let end = last.end();
            let rests = end.velocity.abs() <= REST;
            if rests { State::at_rest(end.position) } else { end }
        });
        Self { profile: Profile::new(segments, end) }
    }

    /// Its pieces: position is path time \[s\], velocity its rate \[1\], acceleration the slope of the rate \[1/s\].
    #[must_use]
    pub fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Path time \[s\], its rate \[1\] and the slope of the rate \[1/s\] at `t` \[s\]; after the law's end as they were there, though the path
    /// goes no further.
    #[must_use]
    pub fn at(&self, t: f64) -> State {
        self.profile.at(t).state
    }

    /// What is left of it from `t` on, on a clock that begins there, for a path that begins where it is then. Where it still runs at
    /// its end, it goes on to path time `end`.
    pub(crate) fn since(&self, t: f64, end: f64) -> Self {
        let from = self.at(t).position;
        let behind = |state: State| State { position: (state.position - from).max(0.0), ..state };
        let mut segments: Vec<Segment> = self
            .from(t)
            .into_iter()
            .map(|span| Span { start: behind(span.start), ..span }.segment())
            .collect();
        let last = behind(self.profile.end());
        let left = end - last.position;
        if segments.is_empty() || (last.velocity > 0.0 && left > 0.0) {
            let duration = if last.velocity > 0.0 { left / last.velocity } else { 0.0 };
            segments.push(Span::steady(State { acceleration: 0.0, ..last }, duration).segment());
        }
        Self::joined(segments)
    }

    /// Does time go on as in the path itself?
    #[expect(clippy::float_cmp, reason = "a rate that was brought to 1 is 1")]
    pub(crate) fn is_unchanged(&self) -> bool {
        self.profile.segments().into_iter().all(|segment| {
            let State { velocity, acceleration, .. } = segment.start;
            velocity == 1.0 && acceleration == 0.0 && segment.law == Law::ConstantJerk(0.0)
        })
    }

    /// When path time first comes to `path_time` \[s\]; `None` where it comes to rest, or the law ends, before.
    pub(crate) fn reaches(&self, path_time: f64) -> Option<f64> {
        for (begin, segment) in self.profile.timed_segments() {
            let Law::ConstantJerk(third) = segment.law else { continue };
            if segment.end().position >= path_time {
                let span = Span { duration: segment.duration, start: segment.start, third };
                return Some(begin + upto(&span, path_time).duration);
            }
        }
        None
    }

    /// The spans of a course up to path time `end`; where there is none, `cycle` seconds of what it leads to.
    pub(super) fn cut(course: &Course, end: f64, cycle: f64) -> Self {
        let mut segments = Vec::with_capacity(course.law.len());
        for span in &course.law {
            let beyond = span.end().position >= end;
            let span = if beyond { upto(span, end) } else { *span };
            if span.duration > 0.0 {
                segments.push(span.segment());
            }
            if beyond {
                break;
            }
        }
        if segments.is_empty() {
            segments.push(Span::steady(State::at_rest(course.end.position), cycle).segment());
        }
        Self::joined(segments)
    }

    /// What is left of it from `t` \[s\] on. Of a span that is over but for a rounding nothing is; one that is more than half over is
    /// taken from its end, so that what is left of a ramp leads there to all digits.
    pub(super) fn from(&self, t: f64) -> Vec<Span> {
        let segments = self.profile.segments();
        let mut spans = Vec::with_capacity(segments.len());
        for (index, (begin, segment)) in self.profile.timed_segments().enumerate() {
            let within = (t - begin).max(0.0);
            let left = segment.duration - within;
            if left > TOGETHER * segment.duration.max(t)
                && let Law::ConstantJerk(third) = segment.law
            {
                let end = segments.get(index + 1).map_or(self.profile.end(), |next| next.start);
                let start =
                    if left < within { end.after(third, -left) } else { segment.start.after(third, within) };
                spans.push(Span { duration: left, start, third });
            }
        }
        spans
    }
}

/// What is wrong with a piece of a time law.
fn fault(segment: &Segment) -> Option<Why> {
    let Law::ConstantJerk(third) = segment.law else { return Some(Why::NotRetimed) };
    let State { position, velocity, acceleration } = segment.start;
    let numbers = [segment.duration, position, velocity, acceleration, third];
    if let Some(&given) = numbers.iter().find(|number| !number.is_finite()) {
        return Some(Why::NotFinite { given });
    }
    let negative = numbers.into_iter().take(3).find(|&number| number < 0.0);
    negative.map(|given| Why::BackInTime { given })
}

/// A span that ends at path time `end`, which it reaches.
fn upto(span: &Span, end: f64) -> Span {
    let State { position, velocity, .. } = span.start;
    let duration = if span.is_steady() {
        (end - position) / velocity
    } else {
        let passes = sign_change(0.0, span.duration, |t| {
            let State { position, velocity, .. } = span.at(t);
            (position - end, velocity)
        });
        passes.unwrap_or(span.duration)
    };
    Span { duration: duration.clamp(0.0, span.duration), ..*span }
}
