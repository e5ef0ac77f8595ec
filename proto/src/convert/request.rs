use planner::{
    AxisMoveSpec, Field, InvalidFields, Limits, LimitsSpec, Plan, Request, RequestSpec, State, Why,
};

use super::choice::{
    choice_to_wire, family_from_wire, family_to_wire, kind_from_wire, kind_to_wire, short_path_from_wire,
    short_path_to_wire, synchronization_from_wire, synchronization_to_wire,
};
use super::duration::{after, duration_to_ns, malformed_duration, note_malformed, ns_to_duration};
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

/// The request on the wire, checked, with everything that is wrong with it.
///
/// # Errors
/// Those of [`Request::try_from`]; [`Why::DurationParts`] of a cycle time or a least duration.
pub fn plan_request_from_wire(wire: pb::PlanRequest) -> Result<Request, InvalidFields> {
    let (malformed, spec) = spec_from_wire(wire);
    after(malformed, spec.try_into())
}

/// The request on the wire, not yet checked but for its durations: what is wrong with those comes first.
pub(super) fn spec_from_wire(wire: pb::PlanRequest) -> (InvalidFields, RequestSpec) {
    let mut malformed = InvalidFields::default();
    note_malformed(&mut malformed, "minimum_duration", wire.minimum_duration.as_ref());
    note_malformed(&mut malformed, "cycle_time", wire.cycle_time.as_ref());
    // Said once: what such a sum would be is no further mistake.
    let sound = |duration: &prost_types::Duration| malformed_duration(duration).is_none();
    let cycle_time = wire.cycle_time.filter(sound);
    let minimum_duration = wire.minimum_duration.filter(sound);
    (malformed, RequestSpec::from(pb::PlanRequest { cycle_time, minimum_duration, ..wire }))
}

impl From<AxisMoveSpec> for pb::AxisMove {
    fn from(spec: AxisMoveSpec) -> Self {
        let AxisMoveSpec { axis, kind, start, goal, limits } = spec;
        Self {
            axis,
            kind: choice_to_wire(kind, kind_to_wire),
            start: Some(start.into()),
            goal: Some(goal.into()),
            limits: Some(limits.into()),
        }
    }
}

impl From<RequestSpec> for pb::PlanRequest {
    fn from(spec: RequestSpec) -> Self {
        let RequestSpec {
            axes,
            cycle_time_ns,
            family,
            order,
            short_path,
            synchronization,
            minimum_duration,
            end_on_cycle,
        } = spec;
        Self {
            axes: axes.into_iter().map(Into::into).collect(),
            cycle_time: cycle_time_ns.map(ns_to_duration),
            family: choice_to_wire(family, family_to_wire),
            order,
            short_path_policy: choice_to_wire(short_path, short_path_to_wire),
            synchronization: choice_to_wire(synchronization, synchronization_to_wire),
            minimum_duration: minimum_duration.map(|seconds| ns_to_duration((seconds * 1e9) as i128)),
            end_on_cycle,
        }
    }
}

/// Other limits, or another goal, to hold one axis of a plan against.
#[derive(Clone, Debug, PartialEq)]
pub struct Against {
    /// The axis's name.
    pub axis: String,
    /// Other limits; `None`: its own.
    pub limits: Option<LimitsSpec>,
    /// Another goal; `None`: its own.
    pub goal: Option<State>,
}

impl From<pb::AxisMove> for Against {
    fn from(wire: pb::AxisMove) -> Self {
        let pb::AxisMove { axis, kind: _, start: _, goal, limits } = wire;
        Self { axis, limits: limits.map(Into::into), goal: goal.map(Into::into) }
    }
}

impl From<Against> for pb::AxisMove {
    fn from(against: Against) -> Self {
        let Against { axis, limits, goal } = against;
        Self { axis, goal: goal.map(Into::into), limits: limits.map(Into::into), ..Self::default() }
    }
}

/// What to hold each axis of a plan against, in plan order: its own limits and goal where nothing else is said.
///
/// # Errors
/// A name that no axis of the plan has, or that is there twice; invalid limits or goals. Paths begin with `against`.
pub fn against(plan: &Plan, others: Vec<Against>) -> Result<Vec<(Limits, State)>, InvalidFields> {
    let mut pairs: Vec<_> =
        plan.axes().iter().map(|axis| (axis.limits.clone(), axis.goal_to_reach())).collect();
    let mut seen: Vec<String> = Vec::new();
    let mut invalid = InvalidFields::default();
    for (index, Against { axis: name, limits, goal }) in others.into_iter().enumerate() {
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
            let limits = invalid.take(&Field::named("limits").within(&outer), Limits::try_from(limits));
            pairs[place].0 = limits.unwrap_or_else(|| pairs[place].0.clone());
        }
        if let Some(goal) = goal {
            pairs[place].1 = goal;
            let parts = [
                ("position", goal.position),
                ("velocity", goal.velocity),
                ("acceleration", goal.acceleration),
            ];
            for (part, given) in parts {
                let field = Field::named(part).within(&Field::named("goal").within(&outer));
                invalid.note(field.as_str(), (!given.is_finite()).then_some(Why::NotFinite { given }));
            }
        }
    }
    invalid.into_result(pairs)
}
