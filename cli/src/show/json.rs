//! Messages as JSON, one a line: beside `source` the only place of this tool that names wire types.

use planner::{Certificate, Judged, JudgedPvt, PvtPointReport, Quantity};
use proto::stream::Columns;
use proto::{Digest, JsonError, Rejected, pb};
use serde_json::json;
use sim_axis::TrackingReport;

use crate::command::diff::Differences;

/// A `PlanResponse`.
pub(crate) fn plan_response(judged: &Judged) -> Result<String, JsonError> {
    proto::to_json(&pb::PlanResponse { plan: Some(proto::plan_to_wire(judged)) })
}

/// A `PlanPvtResponse`.
pub(crate) fn pvt_response(judged: &JudgedPvt) -> Result<String, JsonError> {
    proto::to_json(&proto::pvt_to_wire(judged))
}

/// A `PvtPointReport`.
pub(crate) fn point(report: &PvtPointReport, axis: &str) -> Result<String, JsonError> {
    proto::to_json(&proto::point_to_wire(report, axis))
}

/// A `Plan`, over several lines, to be kept in a file.
pub(crate) fn plan_file(judged: &Judged) -> Result<String, JsonError> {
    proto::to_json_pretty(&proto::plan_to_wire(judged))
}

/// A `VerifyPlanResponse`.
pub(crate) fn verify_response(certificate: &Certificate) -> Result<String, JsonError> {
    proto::to_json(&pb::VerifyPlanResponse { certificate: Some(certificate.into()) })
}

/// A `SamplePlanResponse`.
pub(crate) fn sample_response(
    first_cycle: u64,
    columns: Columns,
    digest: Digest,
) -> Result<String, JsonError> {
    let columns = Some(columns.into());
    proto::to_json(&pb::SamplePlanResponse { first_cycle, columns, digest: digest.into() })
}

/// A `TrackingReport`.
pub(crate) fn tracking_report(report: &TrackingReport) -> Result<serde_json::Value, JsonError> {
    proto::to_json_value(&pb::TrackingReport::from(report.clone()))
}

/// In what two plans differ.
pub(crate) fn differences(found: &Differences) -> serde_json::Value {
    let name = |quantity: Quantity| quantity.to_string();
    let worst = found.worst.iter().map(|worst| {
        json!({
            "axis": worst.axis, "quantity": name(worst.quantity), "difference": worst.difference,
            "cycle": worst.cycle, "greatest": worst.greatest,
        })
    });
    let first = found.first.as_ref().map(|parting| {
        json!({
            "axis": parting.axis, "quantity": name(parting.quantity), "cycle": parting.cycle,
            "a": parting.values[0], "b": parting.values[1],
        })
    });
    json!({
        "same": found.none(), "durations": found.durations, "onlyInA": found.alone[0], "onlyInB": found.alone[1],
        "worst": worst.collect::<Vec<_>>(), "first": first,
    })
}

/// `{"error": …}`
pub(crate) fn error(rejected: &Rejected) -> String {
    rejected.to_json().to_string()
}
