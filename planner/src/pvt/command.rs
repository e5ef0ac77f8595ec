//! One command: from one velocity to another over a displacement in a time, without acceleration at both ends.

use super::PvtRegion;
use super::extreme::{Extremes, duration_for, end_velocity_for};
use super::lane::{Lane, Lanes};
use crate::float::{largest, least, minus_product};

/// Of the least time of a change of velocity \[1\]: a time shorter than it by this is as long, for callers who computed it
/// from the same formula in another order.
const TIME_SLACK: f64 = 8.0 * f64::EPSILON;
/// Of the product of duration and greatest speed \[1\]: a displacement beyond what can be reached by this is not, for the
/// same reason.
const DISPLACEMENT_SLACK: f64 = 16.0 * f64::EPSILON;

/// What is asked of an axis that moves at `start` [axis units/s] without acceleration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Command {
    pub(super) start: f64,
    pub(super) end: f64,
    pub(super) displacement: f64,
    /// \[s\], > 0
    pub(super) duration: f64,
    /// What of the displacement may be the rounding of two positions [axis units].
    pub(super) rounding: f64,
    /// What of the duration may be the rounding of two times \[s\].
    pub(super) time_rounding: f64,
}

/// What can be reached in one lane with the end velocity and in the time that are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reach<'a> {
    lane: &'a Lane,
    extremes: Extremes,
    slack: f64,
}

impl Command {
    fn has_time(&self, lane: &Lane) -> bool {
        let slack = TIME_SLACK * self.duration + self.time_rounding;
        self.duration + slack >= lane.least_time(self.start, self.end)
    }

    /// What `lane` reaches, if its time is long enough and it holds the end velocity.
    pub(super) fn reach<'a>(&self, lane: &'a Lane) -> Option<Reach<'a>> {
        (lane.holds(self.end) && self.has_time(lane)).then(|| {
            let extremes = Extremes::of(lane, self.start, self.end, self.duration);
            let fastest = extremes.fastest();
            let slack =
                DISPLACEMENT_SLACK * self.duration * fastest + self.rounding + self.time_rounding * fastest;
            Reach { lane, extremes, slack }
        })
    }

    /// The first lane that reaches the displacement, or the one that comes nearest to it, of those that have the time for the
    /// end velocity.
    #[inline]
    pub(super) fn nearest<'a>(&self, lanes: &'a Lanes) -> Option<Reach<'a>> {
        let mut nearest: Option<(f64, Reach<'a>)> = None;
        for reach in lanes.from(self.start).filter_map(|lane| self.reach(lane)) {
            let short = reach.short_of(self.displacement).abs();
            if short == 0.0 {
                return Some(reach);
            }
            if nearest.as_ref().is_none_or(|&(other, _)| short < other) {
                nearest = Some((short, reach));
            }
        }
        nearest.map(|(_, reach)| reach)
    }

    /// The least and the greatest displacement of all lanes: an interval, since each of them can drive the plain ramp.
    pub(super) fn range(&self, lanes: &Lanes) -> Option<(f64, f64)> {
        lanes
            .from(self.start)
            .filter_map(|lane| self.reach(lane))
            .map(|reach| reach.range())
            .reduce(|(low, high), (other_low, other_high)| (least(low, other_low), largest(high, other_high)))
    }

    /// The least time in which the end velocity can be reached \[s\].
    pub(super) fn least_time(&self, lanes: &Lanes) -> f64 {
        lanes
            .from(self.start)
            .filter(|lane| lane.holds(self.end))
            .map(|lane| lane.least_time(self.start, self.end))
            .fold(f64::INFINITY, least)
    }

    /// The velocity nearest to the one asked for that the time suffices for.
    pub(super) fn nearest_velocity(&self, lanes: &Lanes) -> f64 {
        let mut nearest = self.start;
        for lane in lanes.from(self.start) {
            let velocity = lane.nearest(self.start, self.end, self.duration);
            if (velocity - self.end).abs() < (nearest - self.end).abs() {
                nearest = velocity;
            }
        }
        nearest
    }

    /// The end velocity nearest to the one asked for with which the displacement is reached, and what is reached with it; where none
    /// reaches it, the one that comes nearest. `known` is what is reached with the one asked for, in one of the lanes.
    pub(super) fn velocity_for_position<'a>(
        &self,
        lanes: &'a Lanes,
        known: Option<Reach<'a>>,
    ) -> Option<(f64, Reach<'a>)> {
        let mut best: Option<(f64, f64, f64, Reach<'a>)> = None;
        for lane in lanes.from(self.start) {
            let wanted = lane.nearest(self.start, self.end, self.duration);
            let is_known =
                |known: &Reach<'_>| core::ptr::eq(known.lane, lane) && wanted.to_bits() == self.end.to_bits();
            let reach = known.filter(is_known).or_else(|| (Self { end: wanted, ..*self }).reach(lane));
            let Some(reach) = reach else { continue };
            let short = reach.short_of(self.displacement);
            let Extremes { greatest, least } = &reach.extremes;
            let velocity = if short > 0.0 {
                end_velocity_for(lane, self.start, (wanted, greatest), self.duration, self.displacement)
            } else if short < 0.0 {
                let (mirror, least) = (lane.mirrored(), least.mirrored());
                let ends = (-self.start, (-wanted, &least));
                0.0 - end_velocity_for(&mirror, ends.0, ends.1, self.duration, -self.displacement)
            } else {
                wanted
            };
            let Some(reach) = (Self { end: velocity, ..*self }).reach(lane) else { continue };
            let (short, change) = (reach.short_of(self.displacement).abs(), (velocity - self.end).abs());
            if best.as_ref().is_none_or(|best| short < best.0 || (short <= best.0 && change < best.1)) {
                best = Some((short, change, velocity, reach));
            }
        }
        best.map(|(_, _, velocity, reach)| (velocity, reach))
    }

    /// The first duration from the one asked for on in which everything else can be met \[s\]; none where the displacement
    /// is out of reach for good.
    pub(super) fn extended(&self, lanes: &Lanes) -> Option<f64> {
        let extended = |lane: &Lane| {
            let duration =
                if self.has_time(lane) { self.duration } else { lane.least_time(self.start, self.end) };
            let command = Self { duration, ..*self };
            let reach = command.reach(lane)?;
            let short = reach.short_of(self.displacement);
            let slack = reach.slack;
            if short > 0.0 {
                duration_for(lane, self.start, self.end, duration, self.displacement, slack)
            } else if short < 0.0 {
                let mirror = lane.mirrored();
                duration_for(&mirror, -self.start, -self.end, duration, -self.displacement, slack)
            } else {
                Some(duration)
            }
        };
        lanes.from(self.start).filter_map(extended).reduce(least)
    }
}

/// What a command is solved to: a ramp, a cruise, a ramp, of which two may be missing.
///
/// ```text
///            R1  S₂ … S₁           R2  S₃ … S₂         R3  S₄ … S₃         R4  S₅ … S₄
///        │    ╭────╮            │     ╭──────       │          ╭──       │            ╭── end
/// end    │   ╱      ╲──         │   ╱               │        ╱           │          ╱
///        │ ╱                    │ ╱                 │      ╱             │──╲      ╱
/// start  │╯                     │╯                  │─────╯              │   ╰────╯
/// ```
/// Each ramp is the gentlest for its time: at its least possible peak of jerk, half of it up and half of it down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shape {
    pub(super) region: PvtRegion,
    pub(super) first: GentleRamp,
    /// \[s\]
    pub(super) cruise: f64,
    pub(super) last: GentleRamp,
    /// The velocity of the cruise [axis units/s].
    pub(super) cruise_velocity: f64,
    /// How far it leads [axis units]: what was asked for, but for what is out of reach.
    pub(super) displacement: f64,
    /// Is that what was asked for?
    pub(super) arrives: bool,
}

impl Reach<'_> {
    /// The least and the greatest displacement [axis units].
    pub(super) fn range(&self) -> (f64, f64) {
        let (low, high) = (self.extremes.least.displacement, self.extremes.greatest.displacement);
        if low <= high {
            return (low, high);
        }
        // In the very least time both are one motion, and roundings may exchange them.
        let only = 0.5 * (low + high);
        (only, only)
    }

    /// By how much this falls short of `displacement` (> 0) or goes beyond it at least (< 0); zero where it is reached.
    pub(super) fn short_of(&self, displacement: f64) -> f64 {
        let (low, high) = self.range();
        if displacement > high + self.slack {
            displacement - high
        } else if displacement < low - self.slack {
            displacement - low
        } else {
            0.0
        }
    }

    /// The one motion of these regions that covers the displacement of `command`, or the nearest that can be.
    ///
    /// With `d = |v_e − v_s|`, and for `v_e ≥ v_s` (else seen from the other side) `e = S − v_e·T`, `f = S − v_s·T`:
    ///
    /// ```text
    /// R1   e > −d·t₁/2     v_c = v_e + (e + d·t₁/2)/w      times of P1, w = t₁/2 + t_c + t₂/2
    /// R2   f ≥ d·T/2       t = −2e/d                       a ramp of this time, then v_e
    /// R3   f ≥ d·t₅/2      t = 2f/d                        v_s, then a ramp of this time
    /// R4                   v_c = v_s + (f − d·t₅/2)/w      times of P5
    /// ```
    /// where `t₁` and `t₅` are the times of the rising ramps of P1 and P5. Each is linear in S, and at the borders they agree.
    pub(super) fn shape(&self, command: &Command) -> Shape {
        let Command { start, end, duration, .. } = *command;
        let (low, high) = self.range();
        let arrives = self.short_of(command.displacement) == 0.0;
        let displacement =
            if arrives { command.displacement } else { largest(low, least(high, command.displacement)) };
        let Extremes { greatest, least: lowest } = &self.extremes;
        let sign = if end < start { -1.0 } else { 1.0 };
        // The extreme beyond the end velocity, and the one on the other side of the start velocity.
        let (beyond, before) = if end < start { (lowest, greatest) } else { (greatest, lowest) };
        let gap = (end - start).abs();
        let past_end = sign * minus_product(displacement, end, duration);
        let past_start = sign * minus_product(displacement, start, duration);
        let over_end = past_end + 0.5 * gap * beyond.first;
        let under_start = past_start - 0.5 * gap * before.last;
        let ramp = |change: f64, time: f64| GentleRamp::new(self.lane, sign * change, time);
        // A difference of two positions is seldom the product of a velocity and a time, to the last digit; but the slack is what a position
        // that is reached is rounded to, and says nothing of how near the nearest is to standing still.
        let straight = gap == 0.0 && past_start.abs() <= if arrives { self.slack } else { 0.0 };
        let (region, cruise_velocity, first, cruise, last) = if straight {
            (PvtRegion::R1, start, GentleRamp::default(), duration, GentleRamp::default())
        } else if over_end > 0.0 {
            let over = telling(least(beyond.change, over_end / beyond.weight()), end);
            let (up, down) = (ramp(gap + over, beyond.first), ramp(-over, beyond.last));
            (PvtRegion::R1, end + sign * over, up, beyond.cruise, down)
        } else if under_start < 0.0 {
            let under = telling(least(before.change, -under_start / before.weight()), start);
            let (down, up) = (ramp(-under, before.first), ramp(gap + under, before.last));
            (PvtRegion::R4, start - sign * under, down, before.cruise, up)
        } else if past_start >= 0.5 * gap * duration {
            let time = largest(beyond.first, least(duration, -2.0 * past_end / gap));
            (PvtRegion::R2, end, ramp(gap, time), duration - time, GentleRamp::default())
        } else {
            let time = largest(before.last, least(duration, 2.0 * past_start / gap));
            (PvtRegion::R3, start, GentleRamp::default(), duration - time, ramp(gap, time))
        };
        Shape { region, first, cruise, last, cruise_velocity, displacement, arrives }
    }
}

/// A change of `velocity`, or zero where it changes no digit of it: no drive could tell, and no piece is made for it.
fn telling(change: f64, velocity: f64) -> f64 {
    if change > 0.5 * f64::EPSILON * velocity.abs() { change } else { 0.0 }
}

/// The symmetric ramp of a given time with the least peak of jerk that keeps the limit of acceleration.
///
/// ```text
/// 2d/t ≤ A    jerk for t/2, back for t/2                              at J' = 4d/t²
/// else        jerk for t − d/A, hold for 2d/A − t, back for t − d/A    at J' = A/(t − d/A)
/// ```
/// `J' ≤ J` if and only if `t` is at least the least time of the ramp.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct GentleRamp {
    pub(super) jerk_time: f64,
    pub(super) hold_time: f64,
    /// Of the first part [axis units/s³], signed.
    pub(super) jerk: f64,
}

impl GentleRamp {
    /// The ramp over `change` [axis units/s], signed: given as such, since the difference of two velocities may have no digit
    /// of it.
    fn new(lane: &Lane, change: f64, time: f64) -> Self {
        let limit = lane.limit(0.0, change);
        let half = 0.5 * time;
        if time <= 0.0 || change == 0.0 {
            return Self { jerk_time: half, hold_time: 0.0, jerk: 0.0 };
        }
        let (jerk_time, hold_time) = if change.abs() <= limit * half {
            (half, 0.0)
        } else {
            // Of two long times: the quotient is its least value, and keeps the digits where they are equal but for it.
            let jerk_time = least(half, largest(time - change.abs() / limit, limit / lane.jerk));
            (jerk_time, time - 2.0 * jerk_time)
        };
        // A displacement that is beyond the extreme by its slack would take a little more than there is.
        let steepest = least(lane.jerk, limit / jerk_time);
        let jerk = least(steepest, change.abs() / (jerk_time * (jerk_time + hold_time)));
        Self { jerk_time, hold_time, jerk: jerk.copysign(change) }
    }
}
