//! The judge: recomputes from the segments alone what a motion does, and holds it against what it promises.
//!
//! Shares no code with the solvers: it sees pieces, limits and the state that is to be reached, nothing of how they were
//! found. Extremes are taken where they can be (the ends of a piece and the zeros of the derivatives inside it), not at
//! samples.

use alloc::string::String;
use alloc::vec::Vec;

use crate::plan::{AxisPlan, Plan};
use crate::verify_led_back::LedBack;
use crate::{
    AdjustmentReason, Alone, Family, Law, Limits, MAX_ORDER, Profile, Quantity, Segment, Setpoint, Shortest,
    State, Workers,
};

/// Of a limit \[1\]: what a motion may be beyond it, since its pieces are rounded.
pub const LIMIT_TOLERANCE: f64 = 1e-9;
/// Of the scale of a motion (its extent, its fastest, its hardest) \[1\]: what two pieces may be apart where they join.
pub const JOIN_TOLERANCE: f64 = 1e-10;
/// Units in the last place of the largest position: what positions far from zero may be apart besides, and beyond the end
/// of their range.
const POSITION_ULPS: f64 = 8.0;
/// Units in the last place of the fastest: a velocity this small is a rounded zero and goes in no direction, so that an
/// axis that must not turn back may stop.
pub(crate) const VELOCITY_ULPS: f64 = 8.0;

/// What the judge found, for all axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Certificate {
    /// One for each axis and limited quantity: velocity, acceleration and jerk; position where there is a range; snap and
    /// above where a limit is stated or promised.
    pub limits: Vec<LimitCheck>,
    /// One for each axis and each of position, velocity, acceleration, and each higher derivative that may not jump.
    pub joins: Vec<JoinCheck>,
    /// One for each axis and each of position, velocity, acceleration.
    pub ends: Vec<EndCheck>,
}

/// The extreme of one quantity on one axis, against its limit.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitCheck {
    /// The axis.
    pub axis: String,
    /// The quantity.
    pub quantity: Quantity,
    /// The limit that is nearest to being broken [unit of the quantity]: a magnitude, but for positions.
    pub limit: f64,
    /// The extreme value, signed; infinite where the derivative below jumps.
    pub extremum: f64,
    /// When it is taken \[s\].
    pub at_time: f64,
    /// How far it is inside \[1\]: (limit − |extremum|) / limit; for positions, of the extent of the motion.
    pub margin: f64,
    /// Does the plan promise to keep it? If not, it is reported and not counted.
    pub guaranteed: bool,
    /// When what was beyond the limit at the start, or bound to come there, is back \[s\], led as fast as can be: the rest is of
    /// the motion but for that. `None`: of all of it.
    pub led_back_by: Option<f64>,
}

/// The worst jump of one quantity where pieces join.
#[derive(Clone, Debug, PartialEq)]
pub struct JoinCheck {
    /// The axis.
    pub axis: String,
    /// The quantity.
    pub quantity: Quantity,
    /// The jump [unit of the quantity], a magnitude.
    pub worst_jump: f64,
    /// What it may be.
    pub allowed: f64,
    /// Where it is \[s\].
    pub at_time: f64,
    /// Does the plan promise that it joins?
    pub guaranteed: bool,
}

/// How far the last piece ends from the state that is to be reached.
#[derive(Clone, Debug, PartialEq)]
pub struct EndCheck {
    /// The axis.
    pub axis: String,
    /// The quantity.
    pub quantity: Quantity,
    /// How far [unit of the quantity], a magnitude.
    pub residual: f64,
    /// What it may be.
    pub allowed: f64,
}

/// One thing that a motion promises and does not keep.
#[derive(Clone, Debug, PartialEq)]
pub enum Violation {
    /// A limit is broken.
    Limit(LimitCheck),
    /// Two pieces do not join.
    Join(JoinCheck),
    /// The end is not reached.
    End(EndCheck),
}

impl Certificate {
    /// Nothing that is promised is broken.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.limits.iter().all(LimitCheck::passed)
            && self.joins.iter().all(JoinCheck::passed)
            && self.ends.iter().all(EndCheck::passed)
    }

    /// Does the motion begin beyond a limit, and is it led back?
    #[must_use]
    pub fn is_led_back(&self) -> bool {
        self.limits.iter().any(|check| check.led_back_by.is_some())
    }

    /// Everything that is promised and broken.
    pub fn violations(&self) -> impl Iterator<Item = Violation> {
        let limits = self.limits.iter().filter(|check| !check.passed()).cloned().map(Violation::Limit);
        let joins = self.joins.iter().filter(|check| !check.passed()).cloned().map(Violation::Join);
        let ends = self.ends.iter().filter(|check| !check.passed()).cloned().map(Violation::End);
        joins.chain(limits).chain(ends)
    }
}

// Each comparison is false for NaN, so that what cannot be computed does not pass.
impl LimitCheck {
    /// Kept, or not promised.
    #[must_use]
    pub fn passed(&self) -> bool {
        !self.guaranteed || self.margin >= -LIMIT_TOLERANCE
    }
}

impl JoinCheck {
    /// Joined, or not promised.
    #[must_use]
    pub fn passed(&self) -> bool {
        !self.guaranteed || self.worst_jump <= self.allowed
    }
}

impl EndCheck {
    /// Reached.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.residual <= self.allowed
    }
}

impl core::fmt::Display for Violation {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Limit(LimitCheck { axis, quantity, limit, extremum, at_time, .. }) => {
                let [extremum, at_time, limit] = [*extremum, *at_time, *limit].map(Shortest);
                write!(f, "axis {axis}: {quantity} reaches {extremum} at {at_time} s, the limit is {limit}")
            }
            Self::Join(JoinCheck { axis, quantity, worst_jump, allowed, at_time, .. }) => {
                let [jump, at_time, allowed] = [*worst_jump, *at_time, *allowed].map(Shortest);
                write!(f, "axis {axis}: {quantity} jumps by {jump} at {at_time} s, allowed is {allowed}")
            }
            Self::End(EndCheck { axis, quantity, residual, allowed }) => {
                let [residual, allowed] = [*residual, *allowed].map(Shortest);
                write!(
                    f,
                    "axis {axis}: {quantity} ends {residual} from where it should, allowed is {allowed}"
                )
            }
        }
    }
}

/// Judges a plan by its own limits and goals.
#[must_use]
pub fn certify(plan: &Plan) -> Certificate {
    certify_by(plan, &Alone)
}

/// As [`certify`], to the last bit, with `workers` who each judge some of the axes.
#[must_use]
pub fn certify_by(plan: &Plan, workers: &impl Workers) -> Certificate {
    let count = plan.axes().len();
    let mut parts = workers
        .each_range(count, |axes| {
            // Of each axis, but for a range of positions and derivatives above jerk.
            let each = 3 * if axes.start == 0 { count } else { axes.len() };
            let mut certificate = Certificate {
                limits: Vec::with_capacity(each),
                joins: Vec::with_capacity(each),
                ends: Vec::with_capacity(each),
            };
            for axis in &plan.axes()[axes] {
                let goal = axis.goal_to_reach();
                certificate.judge(&axis.axis, &axis.profile, &axis.limits, goal, &Promise::of(plan));
            }
            certificate
        })
        .into_iter();
    let mut whole = parts.next().unwrap_or_default();
    for Certificate { limits, joins, ends } in parts {
        whole.limits.extend(limits);
        whole.joins.extend(joins);
        whole.ends.extend(ends);
    }
    whole
}

/// Judges a plan by other limits or goals: one pair for each axis, in plan order.
#[must_use]
pub fn certify_against<'a>(
    plan: &Plan,
    against: impl IntoIterator<Item = (&'a Limits, State)>,
) -> Certificate {
    let mut certificate = Certificate::default();
    for (axis, (limits, goal)) in plan.axes().iter().zip(against) {
        certificate.judge(&axis.axis, &axis.profile, limits, goal, &Promise::of(plan));
    }
    certificate
}

impl AxisPlan {
    /// The end to hold the motion against: the goal, but for what adjustments say of it.
    #[must_use]
    pub fn goal_to_reach(&self) -> State {
        self.goal_as_adjusted(|_| true)
    }

    /// The goal, but for what those adjustments say of it whose reason `counts`.
    pub(crate) fn goal_as_adjusted(&self, counts: impl Fn(AdjustmentReason) -> bool) -> State {
        let mut state = self.goal;
        for adjustment in self.adjustments.iter().filter(|adjustment| counts(adjustment.reason)) {
            match adjustment.quantity {
                Quantity::Position => state.position = adjustment.planned,
                // The feed rate is a speed on the way.
                Quantity::Velocity if adjustment.reason == AdjustmentReason::FeedRateAboveLimit => {}
                Quantity::Velocity => state.velocity = adjustment.planned,
                Quantity::Acceleration => state.acceleration = adjustment.planned,
                Quantity::Jerk
                | Quantity::Snap
                | Quantity::Crackle
                | Quantity::Pop
                | Quantity::Lock
                | Quantity::Drop
                | Quantity::Time => {}
            }
        }
        state
    }
}

/// What a plan promises of each derivative, at the index of its order.
struct Promise {
    /// It keeps its limit.
    limited: [bool; MAX_ORDER + 1],
    /// It does not jump.
    joined: [bool; MAX_ORDER + 1],
    /// A start beyond the limits is led back: what a move of limited jerk may begin with, and no other.
    leads_back: bool,
}

impl Promise {
    fn of(plan: &Plan) -> Self {
        let mut promise = Self::keeping(plan.guaranteed());
        // Each pulse begins and ends without jerk.
        promise.joined[3] |= plan.method().family == Family::Trigonometric;
        promise.leads_back = plan.method().family == Family::SCurve && plan.method().pvt.is_none();
        promise
    }

    fn keeping(guaranteed: &[Quantity]) -> Self {
        let limited = Quantity::BY_ORDER.map(|quantity| guaranteed.contains(&quantity));
        let mut joined = [false; MAX_ORDER + 1];
        // A jump is an unlimited derivative.
        joined[..MAX_ORDER].copy_from_slice(&limited[1..]);
        joined[..2].fill(true);
        Self { limited, joined, leads_back: false }
    }
}

impl Certificate {
    /// Adds what one axis's motion does: its extremes, its joins, and how near it ends to `goal`.
    fn judge(&mut self, axis: &str, profile: &Profile, limits: &Limits, goal: State, promise: &Promise) {
        let asked = |order: usize| promise.limited[order] || limits.higher(order).is_some();
        let highest = (4..=MAX_ORDER).rev().find(|&order| asked(order)).unwrap_or(3);
        let highest_joined = (3..MAX_ORDER).rev().find(|&order| promise.joined[order]).unwrap_or(2);
        let extremes = Extremes::of(profile, limits, highest.max(highest_joined), promise.leads_back);
        let allowed = extremes.allowed(&goal);
        let jumps = Jumps::of(profile, highest.max(highest_joined + 1), promise);

        for (order, worst) in extremes.worst(limits, highest) {
            if order >= 4 && !asked(order) {
                continue;
            }
            let (quantity, guaranteed) = (Quantity::BY_ORDER[order], promise.limited[order]);
            // A position range is promised by being stated.
            let guaranteed = order == 0 || guaranteed;
            let mut worst = worst;
            if order >= 3 && !promise.joined[order - 1] {
                let (jump, at_time) = jumps.worst[order - 1];
                if jump.abs() > allowed[order - 1] {
                    worst.see_magnitude(f64::INFINITY, worst.limit, at_time);
                }
            }
            let Worst { margin, limit, extremum, at_time } = worst;
            let led_back_by = match order {
                1 => extremes.led_back.velocity_by(),
                2 => extremes.led_back.acceleration_by(),
                _ => None,
            };
            let axis = axis.into();
            let check =
                LimitCheck { axis, quantity, limit, extremum, at_time, margin, guaranteed, led_back_by };
            self.limits.push(check);
        }

        let last = profile.segments().last().map_or(profile.end(), |last| last.end());
        let (last, end, goal) = (parts(&last), parts(&profile.end()), parts(&goal));
        for order in 0..=highest_joined {
            let (axis, quantity, allowed) = (axis, Quantity::BY_ORDER[order], allowed[order]);
            if order < 3 || promise.joined[order] {
                let (worst_jump, at_time) = jumps.worst[order];
                let (worst_jump, guaranteed) = (worst_jump.abs(), promise.joined[order]);
                let join =
                    JoinCheck { axis: axis.into(), quantity, worst_jump, allowed, at_time, guaranteed };
                self.joins.push(join);
            }
            if order < 3 {
                let missed = (end[order] - goal[order]).abs();
                // What may jump may jump to its end.
                let residual = if promise.joined[order] {
                    largest((last[order] - end[order]).abs(), missed)
                } else {
                    missed
                };
                self.ends.push(EndCheck { axis: axis.into(), quantity, residual, allowed });
            }
        }
    }
}

fn parts(state: &State) -> [f64; 3] {
    [state.position, state.velocity, state.acceleration]
}

/// The largest difference at a join, signed, and when; by the order of the derivative.
struct Jumps {
    worst: [(f64, f64); MAX_ORDER + 1],
}

impl Jumps {
    /// Before the first piece and after the last nothing is joined, but for the derivatives from jerk on, up to `highest`, which
    /// join standstill there or constant speed, and for an acceleration that may jump, which may jump to its end.
    fn of(profile: &Profile, highest: usize, promise: &Promise) -> Self {
        let mut jumps = Self { worst: [(0.0, 0.0); MAX_ORDER + 1] };
        let mut still = [0.0; MAX_ORDER + 1];
        let mut end = None;
        for (index, &time) in profile.begins().iter().enumerate() {
            let [start, last] = ends(profile, index, highest);
            let lowest = if end.is_none() { 3 } else { 0 };
            jumps.see(lowest, highest, end.as_ref().unwrap_or(&still), &start, time);
            end = Some(last);
        }
        if let Some(end) = end {
            still[2] = profile.end().acceleration;
            let lowest = if promise.joined[2] { 3 } else { 2 };
            jumps.see(lowest, highest, &end, &still, profile.duration());
        }
        jumps
    }

    fn see(
        &mut self,
        lowest: usize,
        highest: usize,
        before: &[f64; MAX_ORDER + 1],
        after: &[f64; MAX_ORDER + 1],
        time: f64,
    ) {
        for order in lowest..=highest {
            let (worst, jump) = (&mut self.worst[order], after[order] - before[order]);
            // NaN counts as worst.
            let smaller = jump.abs() <= worst.0.abs();
            if !smaller {
                *worst = (jump, time);
            }
        }
    }
}

/// The fastest at the start, at the end and where pieces meet: what tells a speed from a rounded zero.
fn fastest_join(profile: &Profile) -> f64 {
    profile.joins().map(|state| state.velocity.abs()).fold(0.0, f64::max)
}

/// The derivatives where a piece begins and where it ends, those above jerk only where they are asked for.
#[inline]
fn ends(profile: &Profile, index: usize, highest: usize) -> [[f64; MAX_ORDER + 1]; 2] {
    if highest > 3 {
        let segment = profile.segment(index);
        return [0.0, segment.duration].map(|t| segment.derivatives(t));
    }
    profile.setpoints_at_ends(index).map(|setpoint| {
        let mut all = [0.0; MAX_ORDER + 1];
        all[..4].copy_from_slice(&setpoint.words());
        all
    })
}

/// The larger of two magnitudes; NaN where one is, so that what cannot be computed is not passed.
fn largest(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The value of a quantity that is nearest to breaking its limit, or farthest beyond it.
#[derive(Clone, Copy, Debug)]
struct Worst {
    margin: f64,
    limit: f64,
    extremum: f64,
    at_time: f64,
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
    fn see_magnitude(&mut self, extremum: f64, limit: f64, at_time: f64) {
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
struct Extremes {
    least_position: (f64, f64),
    greatest_position: (f64, f64),
    least_velocity: (f64, f64),
    greatest_velocity: (f64, f64),
    /// A speed up to this is a rounded zero.
    zero: f64,
    /// The greatest speed, that of a start beyond its limit too.
    fastest: f64,
    led_back: LedBack,
    acceleration: Worst,
    jerk: Worst,
    /// From snap on.
    higher: [Worst; MAX_ORDER - 3],
    /// The greatest magnitude of acceleration, jerk …, at the index of the order.
    hardest: [f64; MAX_ORDER + 1],
}

impl Extremes {
    fn of(profile: &Profile, limits: &Limits, highest: usize, leads_back: bool) -> Self {
        let start = profile.start();
        let zero = VELOCITY_ULPS * f64::EPSILON * fastest_join(profile);
        let moves = !profile.segments().is_empty();
        let led_back =
            if leads_back && moves { LedBack::of(profile, limits, zero) } else { LedBack::default() };
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
        };
        // By index: to hand each piece from iterator to iterator costs more than to judge it.
        for (index, &begin) in profile.begins().iter().enumerate() {
            extremes.see_segment(begin, &profile.segment(index), limits, highest);
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

    fn see_segment(&mut self, begin: f64, segment: &Segment, limits: &Limits, highest: usize) {
        let mut times = segment.turning_points();
        let inside = |t: &f64| *t > 0.0 && *t < segment.duration;
        // Of constant jerk there are few of the others.
        for t in self.led_back.deadlines(limits).map(|deadline| deadline - begin).filter(inside) {
            let _full = times.try_push(t);
            times.sort_unstable_by(f64::total_cmp);
        }
        let mut ends = times.iter().map(|&t| (t, segment.at(t)));
        let Some((mut from, mut before)) = ends.next() else { return };
        for (to, after) in ends {
            // Between two turning points velocity keeps its sign, which tells speeding up from slowing down.
            let velocity = segment.at(0.5 * (from + to)).state.velocity;
            self.see_setpoint(begin + from, before, velocity, limits);
            self.see_setpoint(begin + to, after, velocity, limits);
            (from, before) = (to, after);
        }
        if highest < 4 {
            return;
        }
        let constant = matches!(segment.law, Law::ConstantJerk(_));
        for &t in if constant { &times[..1] } else { &times[..] } {
            let all = segment.derivatives(t);
            for (order, &value) in all.iter().enumerate().take(highest + 1).skip(4) {
                let limit = limits.higher(order).unwrap_or_default();
                self.higher[order - 4].see_magnitude(value, limit, begin + t);
                self.hardest[order] = self.hardest[order].max(value.abs());
            }
        }
    }

    fn see_setpoint(&mut self, time: f64, setpoint: Setpoint, travel: f64, limits: &Limits) {
        let Setpoint { state: State { position, velocity, acceleration }, jerk } = setpoint;
        widen(&mut self.least_position, &mut self.greatest_position, position, time);
        self.fastest = self.fastest.max(velocity.abs());
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
            self.acceleration.see_magnitude(acceleration, hardest, time);
        }
        self.jerk.see_magnitude(jerk, limits.jerk(), time);
        self.hardest[2] = self.hardest[2].max(acceleration.abs());
        self.hardest[3] = self.hardest[3].max(jerk.abs());
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
    fn allowed(&self, goal: &State) -> [f64; MAX_ORDER + 1] {
        let rounding = self.position_rounding().max(POSITION_ULPS * f64::EPSILON * goal.position.abs());
        let mut allowed = self.hardest.map(|hardest| JOIN_TOLERANCE * hardest + f64::MIN_POSITIVE);
        allowed[0] = JOIN_TOLERANCE * self.extent() + rounding + f64::MIN_POSITIVE;
        allowed[1] = JOIN_TOLERANCE * self.fastest + f64::MIN_POSITIVE;
        allowed
    }

    /// By order, up to `highest`.
    fn worst(&self, limits: &Limits, highest: usize) -> impl Iterator<Item = (usize, Worst)> {
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

/// Widens a range to hold `value`, with the times of both its ends. Not `<` and `>` alone: NaN is to be seen.
fn widen(least: &mut (f64, f64), greatest: &mut (f64, f64), value: f64, time: f64) {
    if value.is_nan() || value < least.0 {
        *least = (value, time);
    }
    if value.is_nan() || value > greatest.0 {
        *greatest = (value, time);
    }
}

/// Everything that one axis's motion promises and does not keep: velocity, acceleration and jerk within `limits`, joins,
/// and the end at `goal`. Empty: no objection.
#[must_use]
pub fn violations(profile: &Profile, limits: &Limits, goal: State) -> Vec<Violation> {
    let mut certificate = Certificate::default();
    let promise = Promise::keeping(&[Quantity::Velocity, Quantity::Acceleration, Quantity::Jerk]);
    certificate.judge("", profile, limits, goal, &promise);
    certificate.violations().collect()
}
