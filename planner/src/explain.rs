use alloc::vec::Vec;

use crate::float::least;
use crate::plan::{AxisPlan, Plan};
use crate::transfer::is_same_time;
use crate::{Law, Limits, Quantity, Segment, Synchronization};

/// Of the duration of a plan \[1\]: what may be held back by nothing in a motion that is as fast as it can be, since a piece that is all
/// rounding is.
const FREE_SLACK: f64 = 1e-6;
/// Of a limit \[1\]: this near to it counts as held back by it.
const BINDING_SLACK: f64 = 1e-9;

/// Why a plan lasts as long as it does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Explanation<'a> {
    /// The axis that sets the duration. Empty of axes that arrive together where none does, but a least duration or a whole number of
    /// cycles.
    pub critical_axis: &'a str,
    /// Which limit holds the motion back, when; in order of time for each axis.
    pub bindings: Vec<Binding<'a>>,
}

/// One limit that holds one axis back for a while.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding<'a> {
    /// The axis.
    pub axis: &'a str,
    /// The quantity whose limit is reached.
    pub quantity: Quantity,
    /// From when \[s\].
    pub from_time: f64,
    /// Until when \[s\].
    pub to_time: f64,
}

/// Says which limits a plan reaches, when, and which axis takes longest: of those that arrive together, the one that limits hold back most of
/// the time. As fast as it can be is a motion that some limit holds back at every instant: its own, or on a line that of any axis. A plan
/// through points takes as long as they say: no limit holds it back.
#[must_use]
pub fn explain(plan: &Plan) -> Explanation<'_> {
    let mut bindings = Vec::new();
    if plan.method().pvt.is_none() {
        bindings.reserve(plan.axes().iter().map(|axis| axis.profile.segments().len()).sum());
        plan.axes().iter().for_each(|axis| note_bindings(axis, &mut bindings));
    }
    let held_back = |axis: &AxisPlan| {
        let own = bindings.iter().filter(|binding: &&Binding| binding.axis == axis.axis);
        own.fold(0.0, |sum, binding| sum + (binding.to_time - binding.from_time))
    };
    let lasts = |axis: &AxisPlan| axis.profile.duration();
    let slowest = plan.axes().iter().fold(None, |slowest: Option<&AxisPlan>, axis| match slowest {
        Some(other) if is_same_time(lasts(other), lasts(axis)) && held_back(other) >= held_back(axis) => {
            slowest
        }
        Some(other) if !is_same_time(lasts(other), lasts(axis)) && lasts(other) > lasts(axis) => slowest,
        _ => Some(axis),
    });
    let sets_the_pace = |axis: &AxisPlan| match plan.method().synchronization {
        _ if plan.method().pvt.is_some() || plan.axes().len() < 2 => true,
        Synchronization::None => true,
        Synchronization::Time => held_back(axis) >= lasts(axis) * (1.0 - FREE_SLACK),
        Synchronization::Phase => covered(&bindings) >= lasts(axis) * (1.0 - FREE_SLACK),
    };
    let critical_axis =
        slowest.filter(|axis| sets_the_pace(axis)).map(|axis| &*axis.axis).unwrap_or_default();
    Explanation { critical_axis, bindings }
}

/// For how long some limit of some axis holds the motion back \[s\].
fn covered(bindings: &[Binding<'_>]) -> f64 {
    let mut spans: Vec<(f64, f64)> =
        bindings.iter().map(|binding| (binding.from_time, binding.to_time)).collect();
    spans.sort_unstable_by(|one, other| one.0.total_cmp(&other.0));
    let (mut sum, mut until) = (0.0, 0.0);
    for (from, to) in spans {
        if to > until {
            sum += to - if from > until { from } else { until };
            until = to;
        }
    }
    sum
}

fn note_bindings<'a>(axis: &'a AxisPlan, bindings: &mut Vec<Binding<'a>>) {
    let before = bindings.len();
    for (from_time, segment) in axis.profile.timed_segments() {
        let Some(quantity) = binding(&segment, &axis.limits) else { continue };
        let to_time = from_time + segment.duration;
        // A piece so late and so short that its times do not differ held nothing back.
        if to_time <= from_time {
            continue;
        }
        match bindings[before..].last_mut() {
            #[expect(
                clippy::float_cmp,
                reason = "the next piece begins at the very number at which this one ended"
            )]
            Some(last) if last.quantity == quantity && last.to_time == from_time => last.to_time = to_time,
            _ => bindings.push(Binding { axis: &axis.axis, quantity, from_time, to_time }),
        }
    }
}

/// The limit that one piece is held at from end to end: the lowest derivative that stays at its limit; of a pulse of jerk, which
/// stays nowhere, the one that its peak reaches.
fn binding(segment: &Segment, limits: &Limits) -> Option<Quantity> {
    let reaches = |value: f64, limit: f64| value.abs() >= limit * (1.0 - BINDING_SLACK);
    // A start beyond a limit is not held by it.
    let at = |value: f64, limit: f64| reaches(value, limit) && value.abs() <= limit * (1.0 + BINDING_SLACK);
    if let Law::CosineJerk { peak } = segment.law {
        return reaches(peak, limits.jerk()).then_some(Quantity::Jerk);
    }
    let (start, end) = (segment.at(0.0), segment.at(segment.duration));
    let throughout = |value: fn(&crate::Setpoint) -> f64, limit: f64| {
        let (start, end) = (value(&start), value(&end));
        // From one limit straight to the other is held by neither.
        at(start, limit) && at(end, limit) && start * end > 0.0
    };
    let cruise = limits.cruise_towards(start.state.velocity);
    let slows_down = start.state.acceleration * start.state.velocity < 0.0;
    let hardest = if slows_down { limits.deceleration() } else { limits.acceleration() };
    // Of a ramp that goes through zero, on either side of it.
    let lower = least(limits.acceleration(), limits.deceleration());
    if start.jerk == 0.0 && throughout(|setpoint| setpoint.state.velocity, cruise) {
        return Some(Quantity::Velocity);
    }
    if [hardest, lower].into_iter().any(|limit| throughout(|setpoint| setpoint.state.acceleration, limit)) {
        return Some(Quantity::Acceleration);
    }
    if throughout(|setpoint| setpoint.jerk, limits.jerk()) {
        return Some(Quantity::Jerk);
    }
    let Law::Polynomial(law) = segment.law else { return None };
    if law.order() < 4 {
        return None;
    }
    let (start, end) = (segment.derivatives(0.0), segment.derivatives(segment.duration));
    (4..=law.order())
        .find(|&order| {
            limits
                .higher(order)
                .is_some_and(|limit| reaches(start[order], limit) && reaches(end[order], limit))
        })
        .map(|order| Quantity::BY_ORDER[order])
}
