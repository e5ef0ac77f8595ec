//! Points of position, velocity and time: what is asked, and what became of each.

use planner::{
    Field, InvalidFields, JudgedPvt, PvtAxisSpec, PvtPointReport, PvtRegion, PvtRequest, PvtRequestSpec, Why,
};

use super::choice::{
    choice_to_wire, interpolation_from_wire, interpolation_to_wire, kind_from_wire, kind_to_wire,
    policy_from_wire, policy_to_wire,
};
use super::duration::{after, duration_to_ns, note_malformed, ns_to_duration};
use super::encode::{plan_to_wire, point_to_wire};
use super::plan::{REGIONS, adjustment_from_wire, plan_from_wire};
use crate::pb;

impl From<pb::PvtAxis> for PvtAxisSpec {
    fn from(wire: pb::PvtAxis) -> Self {
        let pb::PvtAxis { axis, kind, limits, start, times, positions, velocities } = wire;
        Self {
            axis,
            kind: kind_from_wire(kind),
            limits: limits.unwrap_or_default().into(),
            start: start.unwrap_or_default().into(),
            times,
            positions,
            velocities,
        }
    }
}

impl From<PvtAxisSpec> for pb::PvtAxis {
    fn from(spec: PvtAxisSpec) -> Self {
        let PvtAxisSpec { axis, kind, limits, start, times, positions, velocities } = spec;
        Self {
            axis,
            kind: choice_to_wire(kind, kind_to_wire),
            limits: Some(limits.into()),
            start: Some(start.into()),
            times,
            positions,
            velocities,
        }
    }
}

impl From<pb::PlanPvtRequest> for PvtRequestSpec {
    fn from(wire: pb::PlanPvtRequest) -> Self {
        let pb::PlanPvtRequest { axes, cycle_time, interpolation, policy, finish_unreached } = wire;
        Self {
            axes: axes.into_iter().map(Into::into).collect(),
            cycle_time_ns: cycle_time.as_ref().map(duration_to_ns),
            interpolation: interpolation_from_wire(interpolation),
            policy: policy_from_wire(policy),
            finish_unreached,
        }
    }
}

/// The request on the wire, checked, with everything that is wrong with it.
///
/// # Errors
/// Those of [`PvtRequest::try_from`]; [`Why::DurationParts`](planner::Why::DurationParts) of a cycle time.
pub fn pvt_request_from_wire(wire: pb::PlanPvtRequest) -> Result<PvtRequest, InvalidFields> {
    let mut malformed = InvalidFields::default();
    note_malformed(&mut malformed, "cycle_time", wire.cycle_time.as_ref());
    let cycle_time = wire.cycle_time.filter(|_| malformed.is_empty());
    after(malformed, PvtRequestSpec::from(pb::PlanPvtRequest { cycle_time, ..wire }).try_into())
}

impl From<PvtRequestSpec> for pb::PlanPvtRequest {
    fn from(spec: PvtRequestSpec) -> Self {
        let PvtRequestSpec { axes, cycle_time_ns, interpolation, policy, finish_unreached } = spec;
        Self {
            axes: axes.into_iter().map(Into::into).collect(),
            cycle_time: cycle_time_ns.map(ns_to_duration),
            interpolation: choice_to_wire(interpolation, interpolation_to_wire),
            policy: choice_to_wire(policy, policy_to_wire),
            finish_unreached,
        }
    }
}

/// The plan on the wire, as [`plan_to_wire`](super::plan_to_wire), with a report on each of its points.
#[must_use]
pub fn pvt_to_wire(judged: &JudgedPvt) -> pb::PlanPvtResponse {
    let axes = judged.judged().plan().axes();
    let name = |report: &PvtPointReport| axes.get(report.axis).map_or("", |axis| &axis.axis);
    let points = judged.points().iter().map(|report| point_to_wire(report, name(report))).collect();
    pb::PlanPvtResponse { plan: Some(plan_to_wire(judged.judged())), points }
}

/// The plan and the reports of an answer; the certificate is computed again.
///
/// # Errors
/// Those of [`plan_from_wire`], and everything that is not a report on a point of that plan.
pub fn pvt_from_wire(wire: pb::PlanPvtResponse) -> Result<JudgedPvt, InvalidFields> {
    let pb::PlanPvtResponse { plan, points } = wire;
    let plan = plan_from_wire(plan.unwrap_or_default()).map_err(|inner| within("plan", inner))?;
    let mut invalid = InvalidFields::default();
    let mut reports = Vec::with_capacity(points.len());
    // They come axis by axis.
    let mut axis = 0;
    for (index, point) in points.into_iter().enumerate() {
        let is_of = |axis: usize| plan.axes().get(axis).is_some_and(|plan| plan.axis == point.axis);
        if !is_of(axis) {
            axis = (0..plan.axes().len()).find(|&axis| is_of(axis)).unwrap_or(plan.axes().len());
        }
        if axis == plan.axes().len() {
            let known: Vec<_> = plan.axes().iter().map(|axis| axis.axis.as_str()).collect();
            let why = Why::UnknownAxis { name: point.axis, known: known.join(", ") };
            invalid.note(Field::named("axis").within(&Field::element("points", index)).as_str(), Some(why));
            continue;
        }
        reports.extend(invalid.take_element("points", index, point_from_wire(point, axis)));
    }
    invalid.into_result(JudgedPvt::new(plan, reports))
}

fn within(name: &str, inner: InvalidFields) -> InvalidFields {
    let mut invalid = InvalidFields::default();
    invalid.extend_within(&Field::named(name), inner);
    invalid
}

fn point_from_wire(wire: pb::PvtPointReport, axis: usize) -> Result<PvtPointReport, InvalidFields> {
    let pb::PvtPointReport {
        axis: _,
        point,
        region: given,
        position,
        velocity,
        time,
        least_displacement,
        greatest_displacement,
        adjustments,
    } = wire;
    let mut invalid = InvalidFields::default();
    let region = PvtRegion::named(&given);
    if region.is_none() && !given.is_empty() {
        invalid.note("region", Some(Why::UnknownName { given, choices: REGIONS }));
    }
    let mut report = PvtPointReport {
        axis,
        point: point as usize,
        region,
        position,
        velocity,
        time,
        reachable: least_displacement.zip(greatest_displacement),
        adjustments: Default::default(),
    };
    for (index, adjustment) in adjustments.into_iter().enumerate() {
        let outer = Field::element("adjustments", index);
        let adjustment = invalid.take(&outer, adjustment_from_wire(adjustment));
        if adjustment.is_some_and(|adjustment| report.adjustments.try_push(adjustment).is_err()) {
            let (given, correct) = ("more".to_owned(), "position, velocity and time".to_owned());
            invalid.note(outer.as_str(), Some(Why::Misstated { given, correct }));
        }
    }
    invalid.into_result(report)
}
