//! Messages as JSON, one a line: beside `source` the only place of this tool that names wire types.

use planner::{Certificate, Judged, JudgedPvt, PvtPointReport};
use proto::stream::Columns;
use proto::{Digest, JsonError, Rejected, pb};
use sim_axis::TrackingReport;

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

/// `{"error": …}`
pub(crate) fn error(rejected: &Rejected) -> String {
    rejected.to_json().to_string()
}
