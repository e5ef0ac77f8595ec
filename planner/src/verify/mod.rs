//! The judge: recomputes from the segments alone what a motion does, and holds it against what it promises.
//!
//! Shares no code with the solvers: it sees pieces, limits and the state that is to be reached, nothing of how they were
//! found. Extremes are taken where they can be (the ends of a piece and the zeros of the derivatives inside it), not at
//! samples.
//!
//! - `certificate`: what it says
//! - `extremes`: how far a motion goes, against its limits; `joins`: how well its pieces meet
//! - `led_back`: what it lets pass of a start beyond the limits; `recovery`: what that is led back by
//! - `transfer`: the same for bounds with signs
//! - `plain`: what passes at a glance, of many motions

mod certificate;
mod extremes;
mod joins;
mod led_back;
mod plain;
mod recovery;
mod transfer;

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::plan::{AxisPlan, Plan};
use crate::{Adjustment, AdjustmentReason, Family, Limits, MAX_ORDER, Method, Profile, Quantity, State};
use crate::{Alone, Workers};
pub use certificate::{Certificate, EndCheck, JoinCheck, LimitCheck, Reversal, Violation};
use extremes::{Extremes, Worst, settled};
use joins::Jumps;
pub(crate) use plain::is_plain;
pub(crate) use recovery::{Recoveries, Recovery};
pub use transfer::transfer_violations;

/// Of a limit \[1\]: what a motion may be beyond it, since its pieces are rounded. Where an axis turns back, from one limit of acceleration to
/// another, its acceleration is known no better than the time of that: what it may be beyond besides is `j·δv/a`, of a `δv` of eight ulps of
/// the fastest.
pub const LIMIT_TOLERANCE: f64 = 1e-9;
/// Of the scale of a motion (its extent, its fastest, its hardest) \[1\]: what two pieces may be apart where they join.
pub const JOIN_TOLERANCE: f64 = 1e-10;
/// Units in the last place of the largest position: what positions far from zero may be apart besides, and beyond the end
/// of their range.
const POSITION_ULPS: f64 = 8.0;
/// Units in the last place of the fastest: a velocity this small is a rounded zero and goes in no direction, so that an
/// axis that must not turn back may stop.
pub(crate) const VELOCITY_ULPS: f64 = 8.0;

/// Judges a plan by its own limits and goals.
#[must_use]
pub fn certify(plan: &Plan) -> Certificate {
    certify_by(plan, &Alone)
}

/// As [`certify`], to the last bit, with `workers` who each judge some of the axes.
#[must_use]
pub fn certify_by(plan: &Plan, workers: &impl Workers) -> Certificate {
    let count = plan.axes().len();
    let recoveries = Recoveries::of(plan);
    let mut parts = workers
        .each_range(count, |axes| {
            // Of each axis, but for a range of positions and derivatives above jerk.
            let each = 3 * if axes.start == 0 { count } else { axes.len() };
            let mut certificate = Certificate {
                limits: Vec::with_capacity(each),
                joins: Vec::with_capacity(each),
                ends: Vec::with_capacity(each),
                reversals: Box::default(),
            };
            for axis in &plan.axes()[axes] {
                let (goal, recovery) =
                    (axis.goal_to_reach(), recoveries.of_axis(&axis.profile, &axis.limits));
                certificate.judge(
                    &axis.axis,
                    &axis.profile,
                    &axis.limits,
                    goal,
                    &Promise::of(plan, recovery),
                );
            }
            certificate
        })
        .into_iter();
    let mut whole = parts.next().unwrap_or_default();
    for Certificate { limits, joins, ends, reversals } in parts {
        whole.limits.extend(limits);
        whole.joins.extend(joins);
        whole.ends.extend(ends);
        whole.turn_back(reversals);
    }
    whole
}

/// Judges a plan by other limits or goals: one pair for each axis, in plan order.
#[must_use]
pub fn certify_against<'a>(
    plan: &Plan,
    against: impl IntoIterator<Item = (&'a Limits, State)>,
) -> Certificate {
    let against: Vec<(&Limits, State)> = against.into_iter().collect();
    let recoveries = Recoveries::within(plan, against.iter().map(|(limits, _)| *limits));
    let mut certificate = Certificate::default();
    for (axis, (limits, goal)) in plan.axes().iter().zip(against) {
        let recovery = recoveries.of_axis(&axis.profile, limits);
        certificate.judge(&axis.axis, &axis.profile, limits, goal, &Promise::of(plan, recovery));
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
        goal_as_adjusted(self.goal, self.adjustments.iter().filter(|adjustment| counts(adjustment.reason)))
    }
}

/// The goal, but for what adjustments say of it.
pub(crate) fn goal_as_adjusted<'a>(
    goal: State,
    adjustments: impl IntoIterator<Item = &'a Adjustment>,
) -> State {
    let mut state = goal;
    for adjustment in adjustments {
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

/// What a plan promises of each derivative, at the index of its order.
#[derive(Clone, Debug)]
pub(crate) struct Promise {
    /// It keeps its limit.
    limited: [bool; MAX_ORDER + 1],
    /// It does not jump.
    joined: [bool; MAX_ORDER + 1],
    /// A start beyond the limits is led back by that: what a move of limited jerk may begin with, and no other.
    leads_back: Option<Recovery>,
}

impl Promise {
    fn of(plan: &Plan, recovery: Recovery) -> Self {
        Self::made_by(plan.method(), plan.guaranteed(), recovery)
    }

    /// Of a motion that is made by `method` and guarantees those derivatives.
    fn made_by(method: Method, guaranteed: &[Quantity], recovery: Recovery) -> Self {
        let mut promise = Self::keeping(guaranteed);
        // Each pulse begins and ends without jerk.
        promise.joined[3] |= method.family == Family::Trigonometric;
        let leads_back = method.family == Family::SCurve && method.pvt.is_none();
        promise.leads_back = leads_back.then_some(recovery);
        promise
    }

    /// Of one axis by itself.
    pub(crate) fn alone(method: Method, limits: &Limits) -> Self {
        Self::made_by(method, method.promises(), Recovery::alone(limits))
    }

    fn keeping(guaranteed: &[Quantity]) -> Self {
        let limited = Quantity::BY_ORDER.map(|quantity| guaranteed.contains(&quantity));
        let mut joined = [false; MAX_ORDER + 1];
        // A jump is an unlimited derivative.
        joined[..MAX_ORDER].copy_from_slice(&limited[1..]);
        joined[..2].fill(true);
        Self { limited, joined, leads_back: None }
    }
}

impl Certificate {
    /// Adds what one axis's motion does: its extremes, its joins, how near it ends to `goal`, and where it turns back.
    fn judge(&mut self, axis: &str, profile: &Profile, limits: &Limits, goal: State, promise: &Promise) {
        let asked = |order: usize| promise.limited[order] || limits.higher(order).is_some();
        let highest = (4..=MAX_ORDER).rev().find(|&order| asked(order)).unwrap_or(3);
        let highest_joined = (3..MAX_ORDER).rev().find(|&order| promise.joined[order]).unwrap_or(2);
        let (orders, tells_turns) = (highest.max(highest_joined), !promise.limited[1]);
        let mut extremes = Extremes::of(profile, limits, orders, promise.leads_back, tells_turns);
        let allowed = extremes.allowed(&goal);
        let jumps = Jumps::of(profile, highest.max(highest_joined + 1), promise);
        let axis: Arc<str> = axis.into();

        // The derivative of a jump is an impulse, and so is whatever is derived from that.
        let mut impulse = None;
        for (order, worst) in extremes.worst(limits, highest) {
            if order >= 3 && !promise.joined[order - 1] {
                let (jump, at_time) = jumps.worst[order - 1];
                if jump.abs() > allowed[order - 1] {
                    impulse = Some(at_time);
                }
            }
            if order >= 4 && !asked(order) {
                continue;
            }
            let (quantity, guaranteed) = (Quantity::BY_ORDER[order], promise.limited[order]);
            // A position range is promised by being stated.
            let guaranteed = order == 0 || guaranteed;
            let mut worst = worst;
            if let Some(at_time) = impulse {
                worst.see_magnitude(f64::INFINITY, worst.limit, at_time);
            }
            let Worst { margin, limit, extremum, at_time } = worst;
            let at_time =
                if profile.has_polynomials() { settled(profile, order + 1, at_time) } else { at_time };
            let led_back_by = match order {
                1 => extremes.led_back.velocity_by(),
                2 => extremes.led_back.acceleration_by(),
                _ => None,
            };
            let axis = Arc::clone(&axis);
            let check =
                LimitCheck { axis, quantity, limit, extremum, at_time, margin, guaranteed, led_back_by };
            self.limits.push(check);
        }

        let last = profile.segments().last().map_or(profile.end(), |last| last.end());
        let (last, end, goal) = (parts(&last), parts(&profile.end()), parts(&goal));
        for order in 0..=highest_joined {
            let (quantity, allowed) = (Quantity::BY_ORDER[order], allowed[order]);
            if order < 3 || promise.joined[order] {
                let (worst_jump, at_time) = jumps.worst[order];
                let (worst_jump, guaranteed) = (worst_jump.abs(), promise.joined[order]);
                let axis = Arc::clone(&axis);
                let join = JoinCheck { axis, quantity, worst_jump, allowed, at_time, guaranteed };
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
                let axis = Arc::clone(&axis);
                self.ends.push(EndCheck { axis, quantity, residual, allowed });
            }
        }

        if tells_turns {
            self.turn_back(extremes.turns().map(|at_time| Reversal {
                axis: Arc::clone(&axis),
                at_time,
                position: profile.at(at_time).state.position,
            }));
        }
    }

    fn turn_back(&mut self, more: impl IntoIterator<Item = Reversal>) {
        let mut reversals = core::mem::take(&mut self.reversals).into_vec();
        reversals.extend(more);
        self.reversals = reversals.into();
    }
}

/// Everything that one axis's motion promises and does not keep.
pub(crate) fn violations_of(
    axis: &str,
    profile: &Profile,
    limits: &Limits,
    goal: State,
    promise: &Promise,
) -> Vec<Violation> {
    let mut certificate = Certificate::default();
    certificate.judge(axis, profile, limits, goal, promise);
    certificate.violations().collect()
}

fn parts(state: &State) -> [f64; 3] {
    [state.position, state.velocity, state.acceleration]
}

/// Everything that one axis's motion promises and does not keep: velocity, acceleration and jerk within `limits`, joins,
/// and the end at `goal`. Empty: no objection.
#[must_use]
pub fn violations(profile: &Profile, limits: &Limits, goal: State) -> Vec<Violation> {
    let promise = Promise::keeping(&[Quantity::Velocity, Quantity::Acceleration, Quantity::Jerk]);
    violations_of("", profile, limits, goal, &promise)
}

/// The larger of two magnitudes; NaN where one is, so that what cannot be computed is not passed.
fn largest(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
