//! What a motion reaches, quantity by quantity, and what of that is nearest to its limit.

use alloc::vec::Vec;

use arrayvec::ArrayVec;

use super::joins::fastest_join;
use super::led_back::LedBack;
use super::recovery::Recovery;
use super::{JOIN_TOLERANCE, LIMIT_TOLERANCE, POSITION_ULPS, VELOCITY_ULPS};
use crate::float::largest;
use crate::segment::turning_points_of_jerk;
use crate::{Limits, MAX_ORDER, Profile, Segment, Setpoint, State};

/// Both ends of a piece of constant jerk, the zeros of its acceleration and its velocity, and the deadlines of both.
const JERK_TIMES: usize = 9;

/// The value of a quantity that is nearest to breaking its limit, or farthest beyond it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Worst {
    pub(super) margin: f64,
    pub(super) limit: f64,
    pub(super) extremum: f64,
    pub(super) at_time: f64,
}

impl Worst {
    const NONE: Self = Self { margin: f64::INFINITY, limit: 0.0, extremum: 0.0, at_time: 0.0 };

    /// Takes `extremum` where its margin is less.
    #[inline]
    fn see(&mut self, margin: f64, limit: f64, extremum: f64, at_time: f64) {
        // NaN counts as worst. Far inside a limit margins round to the same number; the greater magnitude tells.
        let better = margin >= self.margin;
        let same = better && margin <= self.margin;
        if !better || (same && extremum.abs() > self.extremum.abs()) {
            *self = Self { margin, limit, extremum, at_time };
        }
    }

    /// As `see`, for a magnitude.
    #[inline]
    pub(super) fn see_magnitude(&mut self, extremum: f64, limit: f64, at_time: f64) {
        // Mostly it is a smaller value beside the same limit: that needs no quotient. False for NaN, before and after.
        #[expect(clippy::float_cmp, reason = "the very limit of before, or another one")]
        let inside =
            self.margin < f64::INFINITY && extremum.abs() <= self.extremum.abs() && limit == self.limit;
        if inside {
            return;
        }
        self.see((limit - extremum.abs()) / limit, limit, extremum, at_time);
    }
}

/// What a profile reaches, quantity by quantity.
pub(super) struct Extremes {
    least_position: (f64, f64),
    greatest_position: (f64, f64),
    least_velocity: (f64, f64),
    greatest_velocity: (f64, f64),
    /// A speed up to this is a rounded zero.
    zero: f64,
    /// The greatest speed, that of a start beyond its limit too.
    fastest: f64,
    pub(super) led_back: LedBack,
    acceleration: Worst,
    jerk: Worst,
    /// From snap on.
    higher: [Worst; MAX_ORDER - 3],
    /// The greatest magnitude of acceleration, jerk …, at the index of the order.
    hardest: [f64; MAX_ORDER + 1],
    /// Where it is asked for: when each span begins in which the velocity keeps its sign \[s\], and a velocity inside it.
    spans: Option<Vec<(f64, f64)>>,
}

impl Extremes {
    pub(super) fn of(
        profile: &Profile,
        limits: &Limits,
        highest: usize,
        leads_back: Option<Recovery>,
        tells_turns: bool,
    ) -> Self {
        let start = profile.start();
        let zero = VELOCITY_ULPS * f64::EPSILON * fastest_join(profile);
        let moves = !profile.segments().is_empty();
        let recovery = leads_back.filter(|_| moves);
        let led_back =
            recovery.map(|recovery| LedBack::of(profile, limits, recovery, zero)).unwrap_or_default();
        let mut extremes = Self {
            least_position: (start.position, 0.0),
            greatest_position: (start.position, 0.0),
            least_velocity: (f64::INFINITY, 0.0),
            greatest_velocity: (f64::NEG_INFINITY, 0.0),
            fastest: 0.0,
            led_back,
            zero,
            acceleration: Worst::NONE,
            jerk: Worst::NONE,
            higher: [Worst::NONE; MAX_ORDER - 3],
            hardest: [0.0; MAX_ORDER + 1],
            spans: tells_turns.then(Vec::new),
        };
        // By index: to hand each piece from iterator to iterator costs more than to judge it.
        for (index, &begin) in profile.begins().iter().enumerate() {
            if let Some((duration, start, jerk)) = profile.constant_jerk(index) {
                extremes.see_jerk(begin, (duration, start, jerk), limits, highest);
            } else {
                extremes.see_segment(begin, &profile.segment(index), limits, highest);
            }
        }
        if profile.segments().is_empty() {
            extremes.see_setpoint(0.0, Setpoint::held(start), start.velocity, limits);
        }
        for order in 4..=highest {
            let worst = &mut extremes.higher[order - 4];
            if profile.segments().is_empty() {
                worst.see_magnitude(0.0, limits.higher(order).unwrap_or_default(), 0.0);
            }
        }
        extremes
    }

    /// A piece of constant jerk: its duration, its start, and the jerk.
    fn see_jerk(
        &mut self,
        begin: f64,
        (duration, start, jerk): (f64, State, f64),
        limits: &Limits,
        highest: usize,
    ) {
        let mut times = turning_points_of_jerk(&start, jerk, duration);
        self.add_deadlines::<JERK_TIMES>(&mut times, begin, duration, limits);
        self.see_turns(begin, &times, |t| Setpoint { state: start.after(jerk, t), jerk }, limits);
        for order in 4..=highest {
            let limit = limits.higher(order).unwrap_or_default();
            self.higher[order - 4].see_magnitude(0.0, limit, begin);
        }
    }

    fn see_segment(&mut self, begin: f64, segment: &Segment, limits: &Limits, highest: usize) {
        let mut times = segment.turning_points();
        self.add_deadlines(&mut times, begin, segment.duration, limits);
        self.see_turns(begin, &times, |t| segment.at(t), limits);
        if highest < 4 {
            return;
        }
        for &t in &times {
            let all = segment.derivatives(t);
            for (order, &value) in all.iter().enumerate().take(highest + 1).skip(4) {
                let limit = limits.higher(order).unwrap_or_default();
                self.higher[order - 4].see_magnitude(value, limit, begin + t);
                self.hardest[order] = self.hardest[order].max(value.abs());
            }
        }
    }

    /// Adds the instants from which something is held to its limit again; there are few.
    #[inline]
    fn add_deadlines<const ROOM: usize>(
        &self,
        times: &mut ArrayVec<f64, ROOM>,
        begin: f64,
        duration: f64,
        limits: &Limits,
    ) {
        let inside = |t: &f64| *t > 0.0 && *t < duration;
        for t in self.led_back.deadlines(limits).map(|deadline| deadline - begin).filter(inside) {
            let _full = times.try_push(t);
            times.sort_unstable_by(f64::total_cmp);
        }
    }

    #[inline]
    fn see_turns(&mut self, begin: f64, times: &[f64], at: impl Fn(f64) -> Setpoint, limits: &Limits) {
        let mut ends = times.iter().map(|&t| (t, at(t)));
        let Some((mut from, mut before)) = ends.next() else { return };
        for (to, after) in ends {
            // Between two turning points velocity keeps its sign, which tells speeding up from slowing down.
            let velocity = at(0.5 * (from + to)).state.velocity;
            if let Some(spans) = &mut self.spans {
                spans.push((begin + from, velocity));
            }
            self.see_setpoint(begin + from, before, velocity, limits);
            self.see_setpoint(begin + to, after, velocity, limits);
            (from, before) = (to, after);
        }
    }

    fn see_setpoint(&mut self, time: f64, setpoint: Setpoint, travel: f64, limits: &Limits) {
        let Setpoint { state: State { position, velocity, acceleration }, jerk } = setpoint;
        widen(&mut self.least_position, &mut self.greatest_position, position, time);
        self.fastest = largest(self.fastest, velocity.abs());
        if !self.led_back.passes_velocity(velocity, time) {
            widen(&mut self.least_velocity, &mut self.greatest_velocity, velocity, time);
        }
        let hardest = if travel.abs() <= self.zero {
            // Which of both it does is a matter of rounding.
            limits.acceleration().max(limits.deceleration())
        } else if acceleration * travel >= 0.0 {
            limits.acceleration()
        } else {
            limits.deceleration()
        };
        if !self.led_back.passes_acceleration(acceleration, hardest, time) {
            let beyond = acceleration.abs() > (1.0 + LIMIT_TOLERANCE) * hardest;
            let known = if beyond { self.known_acceleration(setpoint, hardest) } else { acceleration };
            self.acceleration.see_magnitude(known, hardest, time);
        }
        self.jerk.see_magnitude(jerk, limits.jerk(), time);
        self.hardest[2] = largest(self.hardest[2], acceleration.abs());
        self.hardest[3] = largest(self.hardest[3], jerk.abs());
    }

    /// An acceleration beyond `limit` as far as it is known: where an axis turns back, the limit itself, if no more than a rounding is beyond.
    ///
    /// Its velocity is known to `z`, a rounded zero, so that it may as well turn `z/|a|` sooner or later, when another limit holds; by then
    /// its acceleration has changed by `|j|·z/|a|`. As `a²` changes by `2·j·Δv`, an excess that is less and shrinks is over before the speed
    /// is `z`; one that grows has its extreme elsewhere.
    #[cold]
    fn known_acceleration(&self, setpoint: Setpoint, limit: f64) -> f64 {
        let Setpoint { state: State { velocity, acceleration, .. }, jerk } = setpoint;
        let rounding = jerk.abs() * self.zero / acceleration.abs();
        // Both are false for NaN.
        let turns = velocity.abs() <= self.zero && acceleration.abs() - rounding <= limit;
        if turns { limit.copysign(acceleration) } else { acceleration }
    }

    /// When the motion turns back \[s\], if that was asked for.
    pub(super) fn turns(&mut self) -> impl Iterator<Item = f64> {
        crate::profile::turns(self.spans.take().unwrap_or_default())
    }

    fn extent(&self) -> f64 {
        self.greatest_position.0 - self.least_position.0
    }

    /// What positions far from zero may be apart.
    fn position_rounding(&self) -> f64 {
        POSITION_ULPS * f64::EPSILON * self.least_position.0.abs().max(self.greatest_position.0.abs())
    }

    /// What may be apart at a join or at the end, quantity by quantity. Below the normal numbers there is no relative
    /// rounding, so nothing is asked there.
    pub(super) fn allowed(&self, goal: &State) -> [f64; MAX_ORDER + 1] {
        let rounding = self.position_rounding().max(POSITION_ULPS * f64::EPSILON * goal.position.abs());
        let mut allowed = self.hardest.map(|hardest| JOIN_TOLERANCE * hardest + f64::MIN_POSITIVE);
        allowed[0] = JOIN_TOLERANCE * self.extent() + rounding + f64::MIN_POSITIVE;
        allowed[1] = JOIN_TOLERANCE * self.fastest + f64::MIN_POSITIVE;
        allowed
    }

    /// By order, up to `highest`.
    pub(super) fn worst(&self, limits: &Limits, highest: usize) -> impl Iterator<Item = (usize, Worst)> {
        let position = self.position(limits).map(|worst| (0, worst));
        let higher = (4..=highest).zip(self.higher);
        let each = [(1, self.velocity(limits)), (2, self.acceleration), (3, self.jerk)];
        position.into_iter().chain(each).chain(higher)
    }

    /// The velocity that is nearest to the limit of its direction.
    fn velocity(&self, limits: &Limits) -> Worst {
        let zero = VELOCITY_ULPS * f64::EPSILON * self.fastest;
        let mut worst = Worst::NONE;
        for (velocity, at_time) in [self.greatest_velocity, self.least_velocity] {
            if velocity.abs() <= zero {
                let limit = limits.velocity_forward();
                worst.see(1.0, limit, velocity, at_time);
            } else {
                worst.see_magnitude(velocity, limits.velocity_towards(velocity), at_time);
            }
        }
        worst
    }

    /// The end of the position range that is nearest; none where there is no range.
    fn position(&self, limits: &Limits) -> Option<Worst> {
        let mut worst = Worst::NONE;
        let rounding = self.position_rounding();
        // At the end of the range but for a rounding is at the end of the range.
        let margin = |inside: f64| match self.extent() {
            _ if inside.abs() <= rounding => 0.0,
            // Nothing moves: inside or not.
            0.0 => inside.signum(),
            extent => (inside / extent).clamp(-f64::MAX, f64::MAX),
        };
        if let Some(limit) = limits.spec().max_position {
            let (extremum, at_time) = self.greatest_position;
            worst.see(margin(limit - extremum), limit, extremum, at_time);
        }
        if let Some(limit) = limits.spec().min_position {
            let (extremum, at_time) = self.least_position;
            worst.see(margin(extremum - limit), limit, extremum, at_time);
        }
        (worst.margin < f64::INFINITY || worst.margin.is_nan()).then_some(worst)
    }
}

/// Of a piece's duration \[1\]: how far from where plain arithmetic sees it an extreme is looked for. Where a derivative is next to nothing
/// beside its terms, that is off by more than its own 4 ulp: by 3e-6 for a piece of order 15 with all its zeros inside
/// (`tests/turning_points.rs`).
const SETTLED_WITHIN: f64 = 1e-4;

/// When a derivative that is extreme at about `at_time` is: the zero of the next, which is of `order`, to its last digits. An end of a piece is
/// where it is.
#[cold]
pub(super) fn settled(profile: &Profile, order: usize, at_time: f64) -> f64 {
    let (index, t) = profile.place_of(at_time);
    let inside = t > 0.0 && index < profile.begins().len() && profile.constant_jerk(index).is_none();
    if !inside {
        return at_time;
    }
    let piece = profile.segment(index);
    let within = SETTLED_WITHIN * piece.duration + 2.0 * f64::EPSILON * at_time;
    let zero = piece.zero_near(order, t, within);
    #[expect(clippy::float_cmp, reason = "the very number: nothing nearer was found")]
    let same = zero == t;
    if same { at_time } else { profile.begins()[index] + zero }
}

/// Widens a range to hold `value`, with the times of both its ends. Not `<` and `>` alone: NaN is to be seen.
fn widen(least: &mut (f64, f64), greatest: &mut (f64, f64), value: f64, time: f64) {
    if value.is_nan() || value < least.0 {
        *least = (value, time);
    }
    if value.is_nan() || value > greatest.0 {
        *greatest = (value, time);
    }
}
