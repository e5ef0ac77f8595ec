use arrayvec::ArrayVec;

use super::span::Member;
use super::timed::{SAME_TIME, Timed};
use super::upper::Upper;
use crate::float::largest;
use crate::roots::sign_change;

/// The most blocked intervals of one question. Each ends where one of the two families crosses the way to go, or where the gap of the
/// changes of velocity ends; a family crosses it three times at most before the gap, and twice after it.
pub const MAX_BLOCKED: usize = 6;

/// Of a duration \[1\]: a blocked interval that is shorter is a rounding.
const SLIVER: f64 = 1e-12;

/// How often a crossing is looked at more closely: over more decades than numbers have.
const MOST_ROUNDS: usize = 24;

/// Durations between which no motion arrives \[s\]; at both ends one does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocked {
    /// The last duration before them.
    pub after: f64,
    /// The first duration beyond them.
    pub before: f64,
}

/// The durations that motions between two states can have: from the least on, but for those that are blocked.
///
/// ```text
///  way │           ╱ farthest       ╱                   An axis that comes in fast arrives at once, or, where it is to take
///      │         ╱         ╭──╮nearest                  longer, cannot be slow enough: it passes the goal and comes back.
///      │╌╌╌╌╌╌╌╱╌╌╌╌╌╌╌╌╌╱╌╌╌╌╌╌╲╌╌╌╌╌ the way
///      │      ╱  ╱ ╱ ╱            ╲
///      └──────┴──────────┴───────┴─── duration
///           least     after    before
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Arrivals {
    pub(super) least: f64,
    pub(super) blocked: ArrayVec<Blocked, MAX_BLOCKED>,
}

impl Arrivals {
    /// The least, and everything from another on.
    pub(super) fn from_both(least: f64, from: f64) -> Self {
        let blocked = Some(Blocked { after: least, before: from });
        let blocked = blocked.filter(|blocked| blocked.before - blocked.after > SLIVER * blocked.before);
        Self { least, blocked: blocked.into_iter().collect() }
    }

    /// The least duration \[s\].
    #[must_use]
    pub fn least(&self) -> f64 {
        self.least
    }

    /// The intervals that are blocked, in order.
    #[must_use]
    pub fn blocked(&self) -> &[Blocked] {
        &self.blocked
    }

    /// The first duration of `duration` \[s\] or more in which a motion arrives.
    #[must_use]
    pub fn first_from(&self, duration: f64) -> f64 {
        let duration = largest(self.least, duration);
        let around =
            self.blocked.iter().find(|blocked| blocked.after < duration && duration < blocked.before);
        around.map_or(duration, |blocked| blocked.before)
    }
}

/// One after the other in time, with what is left over of the way there.
#[derive(Clone, Copy, Debug)]
struct Mark {
    time: f64,
    over: f64,
}

/// Intervals in which something is not reached, in the time unit of a [`Timed`].
type Intervals = ArrayVec<(f64, f64), 16>;

impl Timed {
    /// What lies between `least` \[s\], the least duration, and those that are all allowed.
    pub(super) fn arrivals(&self, least_duration: f64) -> Arrivals {
        // What takes less than the fastest change of velocity counts where the least duration is that of other limits.
        let mut failing: Intervals =
            [(f64::NEG_INFINITY, self.change())].into_iter().chain(self.gap()).collect();
        for family in &self.families {
            self.shortfalls(family, &mut failing);
        }
        failing.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
        let led = self.led_for();
        let mut blocked: ArrayVec<Blocked, MAX_BLOCKED> = ArrayVec::new();
        for (from, to) in failing {
            let after = (from + led) * self.unit;
            let before = (to + led) * self.unit;
            // Where there is nothing to do, whatever takes as good as no time is none.
            let rounding = SAME_TIME * if least_duration > 0.0 { least_duration } else { before };
            let after = if after <= least_duration + rounding { least_duration } else { after };
            match blocked.last_mut() {
                Some(last) if after <= last.before * (1.0 + SAME_TIME) => {
                    last.before = largest(last.before, before)
                }
                _ if before == f64::INFINITY || before - after > SLIVER * before => {
                    let _ = blocked.try_push(Blocked { after, before });
                }
                _ => {}
            }
        }
        Arrivals { least: least_duration, blocked }
    }

    /// Where the family does not come as far as the way.
    fn shortfalls(&self, family: &Upper, failing: &mut Intervals) {
        let over = |time: f64| family.lasting(time).way - family.way;
        let mark = |time: f64| Mark { time, over: over(time) };
        let is_short = |mark: &Mark| mark.over < -self.slack(mark.time);
        let marks = self.marks(family);
        let mut since: Option<f64> = None;
        for pair in marks.windows(2) {
            let (one, other) = (mark(pair[0]), mark(pair[1]));
            if since.is_none() && is_short(&one) {
                since = Some(one.time);
            }
            if is_short(&one) != is_short(&other) {
                let crossing = crossing(family, one, other);
                match since.take() {
                    Some(begin) => failing.push((begin, crossing)),
                    None => since = Some(crossing),
                }
            }
        }
        // Then the family cruises.
        let last = mark(marks.last().copied().unwrap_or_else(|| self.change()));
        if since.is_some() || is_short(&last) {
            let begin = since.unwrap_or(last.time);
            let end = if family.top > 0.0 {
                last.time + largest(0.0, -last.over) / family.top
            } else {
                f64::INFINITY
            };
            failing.push((begin, end));
        }
    }

    /// The times between which the way of a family is monotone, from the fastest change of velocity to where it begins to cruise.
    fn marks(&self, family: &Upper) -> ArrayVec<f64, 10> {
        let (from, cruises) = (self.change(), family.summit_at(family.room()).time());
        let passes = family.passes_zero_from();
        let mut marks: ArrayVec<f64, 10> = ArrayVec::new();
        let inside = |time: &f64| *time > from && *time < cruises;
        marks.push(from);
        let closes = self.gap().map_or(passes, |(closes, _)| closes);
        if passes > from * (1.0 + SAME_TIME) {
            marks.extend(family.lens_turns().into_iter().filter(|time| *time < closes).filter(inside));
            marks.extend([closes, passes].into_iter().filter(inside));
        }
        marks.extend(family.turns_round().filter(inside));
        marks.push(largest(from, cruises));
        marks.sort_unstable_by(f64::total_cmp);
        marks
    }
}

impl Upper {
    /// How long the member takes that goes least far, of those that pass zero acceleration on the way down: where `v_c + P·B/2`, which
    /// rises with the summit, comes to zero.
    fn turns_round(&self) -> Option<f64> {
        let pace = |above: f64| {
            let summit = self.summit_at(above);
            let (peak, valley) = (summit.first.peak, summit.last.peak);
            self.feet().lowest + above + 0.5 * peak * valley
        };
        // No slope is given: the bracket is halved.
        let above = sign_change(0.0, self.room(), |above| (pace(above), 0.0))?;
        Some(self.summit_at(above).time())
    }
}

/// Where a family crosses the way between two times, at one of which it falls short.
fn crossing(family: &Upper, one: Mark, other: Mark) -> f64 {
    let value_and_slope = |time: f64| {
        let Member { way, pace, .. } = family.lasting(time);
        (way - family.way, pace)
    };
    let Some(near) = sign_change(one.time, other.time, value_and_slope) else {
        return if one.over.abs() < other.over.abs() { one.time } else { other.time };
    };
    // As exactly as the later of both times is known may be little for one far before it.
    let (mut near, mut to) = (near, other.time);
    // Each round is worth fifteen digits, so the second is seldom needed.
    for _ in 0..MOST_ROUNDS {
        if near >= 0.5 * to {
            break;
        }
        let rounding = 8.0 * f64::EPSILON * to;
        let from = largest(one.time, near - rounding);
        to = near + rounding;
        let Some(nearer) = sign_change(from, to, value_and_slope) else { break };
        near = nearer;
    }
    near
}
