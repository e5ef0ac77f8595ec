use planner::{
    AxisMoveSpec, Field, InvalidFields, Limits, LimitsSpec, Plan, Request, RequestSpec, State, Why,
};

use super::choice::{
    family_from_wire, family_to_wire, kind_from_wire, kind_to_wire, short_path_from_wire, short_path_to_wire,
    synchronization_from_wire, synchronization_to_wire,
};
use super::duration_to_ns;
use crate::pb;

impl From<pb::AxisMove> for AxisMoveSpec {
    fn from(wire: pb::AxisMove) -> Self {
        let pb::AxisMove { axis, kind, start, goal, limits } = wire;
        Self {
            axis,
            kind: kind_from_wire(kind),
            start: start.unwrap_or_default().into(),
            goal: goal.unwrap_or_default().into(),
            limits: limits.unwrap_or_default().into(),
        }
    }
}

impl From<pb::PlanRequest> for RequestSpec {
    fn from(wire: pb::PlanRequest) -> Self {
        let pb::PlanRequest {
            axes,
            cycle_time,
            family,
            order,
            short_path_policy,
            synchronization,
            minimum_duration,
            end_on_cycle,
        } = wire;
        Self {
            axes: axes.into_iter().map(Into::into).collect(),
            cycle_time_ns: cycle_time.as_ref().map(duration_to_ns),
            family: family_from_wire(family),
            order,
            short_path: short_path_from_wire(short_path_policy),
            synchronization: synchronization_from_wire(synchronization),
            minimum_duration: minimum_duration.as_ref().map(|wire| duration_to_ns(wire) as f64 / 1e9),
            end_on_cycle,
        }
    }
}

impl From<&Request> for pb::PlanRequest {
    fn from(request: &Request) -> Self {
        Self {
            axes: request
                .axes()
                .iter()
                .map(|axis| pb::AxisMove {
                    axis: axis.axis.clone(),
                    kind: kind_to_wire(axis.kind),
                    start: Some(axis.problem.start().into()),
                    goal: Some(axis.problem.goal().into()),
                    limits: Some(axis.problem.limits().into()),
                })
                .collect(),
            cycle_time: Some(super::cycle_time_to_wire(request.cycle_time())),
            family: family_to_wire(planner::Family::SCurve),
            order: None,
            short_path_policy: short_path_to_wire(request.short_path()),
            synchronization: synchronization_to_wire(request.synchronization()),
            minimum_duration: None,
            end_on_cycle: false,
        }
    }
}

/// Other limits or goals to hold a plan against: one pair for each axis of the plan, its own where nothing else is said.
///
/// # Errors
/// A name that no axis of the plan has, or that is there twice; invalid limits or goals.
pub fn against_from_wire(
    plan: &Plan,
    against: Vec<pb::AxisMove>,
) -> Result<Vec<(Limits, State)>, InvalidFields> {
    let mut pairs: Vec<_> =
        plan.axes().iter().map(|axis| (axis.limits.clone(), axis.goal_to_reach())).collect();
    let mut seen: Vec<String> = Vec::new();
    let mut invalid = InvalidFields::default();
    for (index, pb::AxisMove { axis: name, kind: _, start: _, goal, limits }) in
        against.into_iter().enumerate()
    {
        let outer = Field::element("against", index);
        let named = Field::named("axis").within(&outer);
        if seen.contains(&name) {
            invalid.note(named.as_str(), Some(Why::DuplicateAxis { name }));
            continue;
        }
        let Some(place) = plan.axes().iter().position(|axis| axis.axis == name) else {
            let known = plan.axes().iter().map(|axis| axis.axis.as_str()).collect::<Vec<_>>().join(", ");
            invalid.note(named.as_str(), Some(Why::UnknownAxis { name, known }));
            continue;
        };
        seen.push(name);
        if let Some(limits) = limits {
            let limits = Limits::try_from(LimitsSpec::from(limits));
            if let Some(limits) = invalid.take(&Field::named("limits").within(&outer), limits) {
                pairs[place].0 = limits;
            }
        }
        if let Some(goal) = goal {
            pairs[place].1 = goal.into();
            if !pairs[place].1.is_finite() {
                let why = Why::NotFinite { given: f64::NAN };
                invalid.note(Field::named("goal").within(&outer).as_str(), Some(why));
            }
        }
    }
    invalid.into_result(pairs)
}
