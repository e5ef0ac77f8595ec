//! Messages that are too large, or none: in every direction, with a reason and both figures.

use client::{Client, Error};
use e2e::{Loopback, LoopbackAxis, fifty_millimetres, planned};
use proto::pb::sim_axis_service_client::SimAxisServiceClient;
use proto::pb::stream_setpoints_request::Message;
use proto::{Reason, Rejected, pb, plan_to_wire};
use tonic::{Code, Status};

/// A limit that an ordinary plan fits and a long one does not.
const LIMIT: usize = 20_000;

async fn small_server() -> Loopback {
    let mut config = server::Config::loopback();
    config.serving.max_message_bytes = LIMIT;
    Loopback::with(config).await
}

fn plan() -> pb::Plan {
    plan_to_wire(planned(fifty_millimetres()).judged())
}

/// A plan in which a text has grown.
fn long_plan() -> pb::Plan {
    pb::Plan { planner_version: "x".repeat(2 * LIMIT), ..plan() }
}

/// A request for so many axes that the answer is larger than it is.
fn many_axes(count: usize) -> pb::PlanRequest {
    let mut request = pb::PlanRequest::from(fifty_millimetres());
    request.axes = (0..count)
        .map(|index| pb::AxisMove { axis: format!("x{index}"), ..request.axes[0].clone() })
        .collect();
    request
}

#[track_caller]
fn is_too_large(status: &Status) {
    assert_eq!(status.code(), Code::ResourceExhausted, "{status:?}");
    let rejected = Rejected::from_status(status).unwrap_or_else(|| panic!("no reason in {status:?}"));
    assert_eq!(rejected.reason, Reason::MessageTooLarge);
    assert_eq!(rejected.metadata["allowed"], LIMIT.to_string());
    assert!(rejected.metadata["given"].parse::<usize>().unwrap() > LIMIT, "{rejected:?}");
    assert!(rejected.message.contains("max_message_bytes"), "{rejected}");
}

#[tokio::test]
async fn a_request_and_an_answer_that_are_too_large() {
    let server = small_server().await;
    let mut planner = server.planner().await;
    let verify = |plan| pb::VerifyPlanRequest { plan: Some(plan), against: vec![] };
    is_too_large(&planner.verify_plan(verify(long_plan())).await.unwrap_err());
    // The request of sixty axes has some 6 kB, its answer some 100 kB.
    is_too_large(&planner.plan(many_axes(60)).await.unwrap_err());
    let sample = pb::SamplePlanRequest { plan: Some(long_plan()), ..Default::default() };
    is_too_large(&planner.sample_plan(sample).await.unwrap_err());
    // An answer that is a stream ends so.
    let sample = pb::SamplePlanRequest { plan: Some(plan()), ..Default::default() };
    let fits = planner.sample_plan(sample).await.unwrap().into_inner().message().await;
    assert!(fits.is_ok(), "314 cycles have 10 kB: {fits:?}");
    let plan = planned(e2e::move_of(1.0, 0.25));
    let sample = pb::SamplePlanRequest { plan: Some(plan_to_wire(plan.judged())), ..Default::default() };
    let mut chunks = planner.sample_plan(sample).await.unwrap().into_inner();
    is_too_large(&chunks.message().await.unwrap_err());
    // Nothing of it has harmed the connection.
    assert!(planner.verify_plan(verify(self::plan())).await.is_ok());
}

#[tokio::test]
async fn a_stream_with_a_message_that_is_too_large() {
    let server = small_server().await;
    let mut setpoints = server.setpoints().await;
    let open = pb::Open {
        stream: "x".into(),
        epoch: 1,
        source: Some(pb::open::Source::Plan(long_plan())),
        ..Default::default()
    };
    let first = pb::StreamSetpointsRequest { message: Some(Message::Open(Box::new(open))) };
    let mut answers = setpoints.stream_setpoints(tokio_stream::iter([first])).await.unwrap().into_inner();
    is_too_large(&answers.message().await.unwrap_err());
}

#[tokio::test]
async fn a_simulator_refuses_as_a_server_does() {
    let mut config = sim_axis::Config::loopback();
    config.serving.max_message_bytes = LIMIT;
    let axis = LoopbackAxis::with(config).await;
    let mut service = SimAxisServiceClient::new(axis.channel().await);
    let run = pb::RunTrackingRequest { plan: Some(long_plan()), ..Default::default() };
    is_too_large(&service.run_tracking(run).await.unwrap_err());
}

/// What a client of ours is not to take, it says itself.
#[tokio::test]
async fn a_client_has_a_limit_of_its_own() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let judged = client.plan(fifty_millimetres()).await.unwrap();
    let small: Client = client.with_message_limit(500);
    let answered = small.plan(fifty_millimetres()).await;
    let Err(Error::TooLarge { endpoint, cause }) = answered else { panic!("{answered:?}") };
    assert_eq!(endpoint, server.endpoint());
    assert!(cause.contains("500"), "{cause}");
    let sent = small.verify(judged.plan(), vec![]).await;
    assert!(matches!(sent, Err(Error::TooLarge { .. })), "the request has some 2 kB: {sent:?}");
}

/// What is not a message at all.
#[tokio::test]
async fn bytes_that_are_no_message_have_a_reason_too() {
    let server = Loopback::start().await;
    let mut grpc = tonic::client::Grpc::new(server.channel().await);
    grpc.ready().await.unwrap();
    // A text where the plan belongs.
    let request = tonic::Request::new(pb::CommandRequest { stream: "\u{7f}garbage".into(), operation: None });
    let codec = tonic_prost::ProstCodec::<pb::CommandRequest, pb::VerifyPlanResponse>::default();
    let path = "/motion.v1.PlannerService/VerifyPlan".parse().unwrap();
    let status = grpc.unary(request, path, codec).await.unwrap_err();
    assert_eq!(status.code(), Code::InvalidArgument, "{status:?}");
    assert_eq!(Rejected::from_status(&status).unwrap().reason, Reason::MessageInvalid);
    // On a stream it ends the session, and nothing else.
    let path = "/motion.v1.SetpointService/StreamSetpoints".parse().unwrap();
    let codec = tonic_prost::ProstCodec::<pb::CommandRequest, pb::StreamSetpointsResponse>::default();
    let garbage = pb::CommandRequest { stream: "\u{7f}garbage".into(), operation: None };
    grpc.ready().await.unwrap();
    let requests = tonic::Request::new(tokio_stream::iter([garbage]));
    let mut answers = grpc.streaming(requests, path, codec).await.unwrap().into_inner();
    let status = answers.message().await.unwrap_err();
    assert_eq!(Rejected::from_status(&status).unwrap().reason, Reason::MessageInvalid, "{status:?}");
    let mut setpoints = server.setpoints().await;
    let silent =
        setpoints.stream_setpoints(tokio_stream::iter([])).await.unwrap().into_inner().message().await;
    assert_eq!(Rejected::from_status(&silent.unwrap_err()).unwrap().reason, Reason::ProtocolOrder);
}
