use ::planner::{Judged, certify, certify_against};
use proto::pb::planner_service_server::PlannerService;
use proto::{Rejected, pb, plan_as_it_is_in, plan_request_from_wire, plan_to_wire, within};
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Response, Status};

use super::{aside, plan_pvt, sample};
use crate::Config;

/// `PlannerService`: stateless, so any replica answers any call with the same bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Planner {
    max_pvt_points: usize,
    max_sample_cycles: u64,
}

impl Planner {
    pub(crate) fn new(config: &Config) -> Self {
        let &Config { max_pvt_points, max_sample_cycles, .. } = config;
        Self { max_pvt_points, max_sample_cycles }
    }
}

fn plan(wire: pb::PlanRequest) -> Result<pb::PlanResponse, Rejected> {
    let request = plan_request_from_wire(wire)?;
    let judged = Judged::answer(&request)?;
    Ok(pb::PlanResponse { plan: Some(plan_to_wire(&judged)) })
}

/// A motion that fails the judge is answered with what he found, whatever else the plan says of itself: that is the
/// question. Only of a motion that passes is it an error that the plan misstates it.
fn verify(wire: pb::VerifyPlanRequest) -> Result<pb::VerifyPlanResponse, Rejected> {
    let pb::VerifyPlanRequest { plan, against } = wire;
    let (plan, misstated) = plan_as_it_is_in("plan", plan)?;
    let certificate = if against.is_empty() {
        certify(&plan)
    } else {
        let pairs = proto::against(&plan, against.into_iter().map(Into::into).collect())?;
        certify_against(&plan, pairs.iter().map(|(limits, goal)| (limits, *goal)))
    };
    if certificate.passed() {
        misstated.into_result(()).map_err(|inner| within("plan", inner))?;
        proto::misclassified(&plan).into_result(()).map_err(|inner| within("plan", inner))?;
    }
    Ok(pb::VerifyPlanResponse { certificate: Some((&certificate).into()) })
}

/// From this many segments on, a plan takes longer to read and to judge than the streams of this process may wait: about a
/// millisecond.
const LONG: usize = 2_500;

fn is_long(plan: Option<&pb::Plan>) -> bool {
    plan.is_some_and(|plan| plan.axes.iter().map(|axis| axis.segments.len()).sum::<usize>() >= LONG)
}

#[tonic::async_trait]
impl PlannerService for Planner {
    async fn plan(&self, request: Request<pb::PlanRequest>) -> Result<Response<pb::PlanResponse>, Status> {
        Ok(Response::new(plan(request.into_inner())?))
    }

    async fn plan_pvt(
        &self,
        request: Request<pb::PlanPvtRequest>,
    ) -> Result<Response<pb::PlanPvtResponse>, Status> {
        let (wire, most) = (request.into_inner(), self.max_pvt_points);
        let response = if plan_pvt::is_long(&wire) {
            aside(move || plan_pvt::plan(wire, most)).await?
        } else {
            plan_pvt::plan(wire, most)?
        };
        Ok(Response::new(response))
    }

    async fn verify_plan(
        &self,
        request: Request<pb::VerifyPlanRequest>,
    ) -> Result<Response<pb::VerifyPlanResponse>, Status> {
        let wire = request.into_inner();
        let response =
            if is_long(wire.plan.as_ref()) { aside(move || verify(wire)).await? } else { verify(wire)? };
        Ok(Response::new(response))
    }

    type SamplePlanStream = ReceiverStream<Result<pb::SamplePlanResponse, Status>>;

    async fn sample_plan(
        &self,
        request: Request<pb::SamplePlanRequest>,
    ) -> Result<Response<Self::SamplePlanStream>, Status> {
        let (wire, most) = (request.into_inner(), self.max_sample_cycles);
        let sampling = if is_long(wire.plan.as_ref()) {
            aside(move || sample::sampling(wire, most)).await?
        } else {
            sample::sampling(wire, most)?
        };
        Ok(Response::new(sample::stream(sampling)))
    }
}
