use std::time::Instant;

use ::planner::{Judged, certify, certify_against};
use proto::pb::planner_service_server::PlannerService;
use proto::{Rejected, encode_plan, outgoing, pb, plan_as_it_is_in, plan_request_from_wire, within};
use serving::{Leaving, Refusals};
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Response, Status, Streaming};

use super::plan_many::Many;
use super::{Aside, plan_pvt, sample};
use crate::figures::Figures;
use crate::limits::Limits;

/// `PlannerService`: stateless, so any replica answers any call with the same bytes.
#[derive(Clone, Debug)]
pub(crate) struct Planner {
    limits: Limits,
    figures: Figures,
    aside: Aside,
    many: Many,
}

impl Planner {
    /// Answers of at most `most_bytes`, until the process leaves.
    pub(crate) fn new(limits: Limits, most_bytes: usize, figures: Figures, leaving: Leaving) -> Self {
        let aside = Aside::new();
        let many = Many {
            limits,
            most_bytes,
            figures: figures.clone(),
            refusals: Refusals::resolve(),
            aside: aside.clone(),
            leaving,
        };
        Self { limits, figures, aside, many }
    }
}

/// The answer to one request, however it came.
pub(super) fn judged(wire: pb::PlanRequest, figures: &Figures) -> Result<Judged, Rejected> {
    let request = plan_request_from_wire(wire)?;
    let begun = Instant::now();
    let judged = Judged::answer(&request)?;
    figures.planned(request.family(), begun.elapsed());
    Ok(judged)
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
    async fn plan(
        &self,
        request: Request<pb::PlanRequest>,
    ) -> Result<Response<outgoing::PlanResponse>, Status> {
        let wire = request.into_inner();
        self.limits.admit_axes("axes", wire.axes.len())?;
        let judged = judged(wire, &self.figures)?;
        Ok(Response::new(outgoing::PlanResponse { plan: encode_plan(&judged) }))
    }

    type PlanManyStream = ReceiverStream<Result<outgoing::PlanManyResponse, Status>>;

    async fn plan_many(
        &self,
        request: Request<Streaming<pb::PlanManyRequest>>,
    ) -> Result<Response<Self::PlanManyStream>, Status> {
        let outcomes = self.many.clone().begin(request.into_inner());
        Ok(Response::new(ReceiverStream::new(outcomes)))
    }

    async fn plan_pvt(
        &self,
        request: Request<pb::PlanPvtRequest>,
    ) -> Result<Response<outgoing::PlanPvtResponse>, Status> {
        let (wire, most) = (request.into_inner(), self.limits.pvt_points);
        self.limits.admit_axes("axes", wire.axes.len())?;
        let begun = Instant::now();
        let response = if plan_pvt::is_long(&wire) {
            self.aside.run(move || plan_pvt::plan(wire, most)).await?
        } else {
            plan_pvt::plan(wire, most)?
        };
        self.figures.planned_pvt(begun.elapsed());
        Ok(Response::new(response))
    }

    async fn verify_plan(
        &self,
        request: Request<pb::VerifyPlanRequest>,
    ) -> Result<Response<pb::VerifyPlanResponse>, Status> {
        let wire = request.into_inner();
        self.limits.admit_plan(wire.plan.as_ref())?;
        let response = if is_long(wire.plan.as_ref()) {
            self.aside.run(move || verify(wire)).await?
        } else {
            verify(wire)?
        };
        Ok(Response::new(response))
    }

    type SamplePlanStream = ReceiverStream<Result<pb::SamplePlanResponse, Status>>;

    async fn sample_plan(
        &self,
        request: Request<pb::SamplePlanRequest>,
    ) -> Result<Response<Self::SamplePlanStream>, Status> {
        let (wire, most) = (request.into_inner(), self.limits.sample_cycles);
        self.limits.admit_plan(wire.plan.as_ref())?;
        let sampling = if is_long(wire.plan.as_ref()) {
            self.aside.run(move || sample::sampling(wire, most)).await?
        } else {
            sample::sampling(wire, most)?
        };
        Ok(Response::new(sample::stream(sampling)))
    }
}
