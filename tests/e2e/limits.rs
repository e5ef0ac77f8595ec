//! How much is taken: each limit with its own reason, and streams that go on meanwhile.

use std::time::Duration;

use client::{Error, Setpoints};
use e2e::{Authority, Loopback, fifty_millimetres, open, planned};
use proto::{Reason, Rejected, pb, plan_to_wire};
use server::{Config, Limits};
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use tokio_stream::wrappers::ReceiverStream;
use tonic::Status;
use tonic::transport::Channel;
use tonic_types::StatusExt as _;

/// Longer than anything here takes.
const AMPLE: Duration = Duration::from_secs(20);

fn with(change: impl FnOnce(&mut Config)) -> Config {
    let mut config = Config::loopback();
    change(&mut config);
    config
}

#[track_caller]
fn rejected(status: &Status) -> Rejected {
    Rejected::from_status(status).unwrap_or_else(|| panic!("no reason in {status:?}"))
}

fn plan() -> pb::Plan {
    plan_to_wire(planned(fifty_millimetres()).judged())
}

/// A request of `count` axes.
fn axes(count: usize) -> pb::PlanRequest {
    let mut request = pb::PlanRequest::from(fifty_millimetres());
    let axis = request.axes[0].clone();
    request.axes =
        (0..count).map(|index| pb::AxisMove { axis: format!("x{index}"), ..axis.clone() }).collect();
    request
}

/// A call whose head is sent, and whose message does not come for as long as the sender is kept.
async fn begun(
    channel: Channel,
    path: &'static str,
) -> (mpsc::Sender<pb::PlanRequest>, JoinHandle<Result<(), Status>>) {
    let mut grpc = tonic::client::Grpc::new(channel);
    grpc.ready().await.unwrap();
    let (sender, requests) = mpsc::channel(1);
    let call = tokio::spawn(async move {
        let codec = tonic_prost::ProstCodec::<pb::PlanRequest, pb::PlanResponse>::default();
        let requests = tonic::Request::new(ReceiverStream::new(requests));
        grpc.client_streaming(requests, path.parse().unwrap(), codec).await.map(|_| ())
    });
    (sender, call)
}

#[tokio::test]
async fn each_size_has_its_own_reason_and_names_its_setting() {
    let limits = Limits { axes: 2, segments: 6, pvt_points: 3, ..Limits::default() };
    let server = Loopback::with(with(|config| config.limits = limits)).await;
    let mut planner = server.planner().await;
    let verify = |plan| pb::VerifyPlanRequest { plan: Some(plan), against: vec![] };
    let pvt = |axes, points| pb::PlanPvtRequest {
        axes: vec![pb::PvtAxis { times: vec![0.1; points], ..Default::default() }; axes],
        ..Default::default()
    };
    let mut wide = plan();
    wide.axes = vec![wide.axes[0].clone(); 3];
    let rows = [
        (planner.plan(axes(3)).await.map(|_| ()), Reason::TooManyAxes, "axes", "max_axes"),
        (planner.plan_pvt(pvt(3, 1)).await.map(|_| ()), Reason::TooManyAxes, "axes", "max_axes"),
        (planner.plan_pvt(pvt(1, 4)).await.map(|_| ()), Reason::TooManyPoints, "axes", "max_pvt_points"),
        (planner.verify_plan(verify(wide)).await.map(|_| ()), Reason::TooManyAxes, "plan.axes", "max_axes"),
        (
            planner.verify_plan(verify(plan())).await.map(|_| ()),
            Reason::TooManySegments,
            "plan.axes",
            "max_segments",
        ),
    ];
    for (answer, reason, field, setting) in rows {
        let rejected = rejected(&answer.unwrap_err());
        assert_eq!((rejected.reason, rejected.fields[0].field.as_str()), (reason, field), "{rejected}");
        assert!(rejected.message.contains(setting), "{rejected}");
    }
    assert!(planner.plan(axes(2)).await.is_ok());
    // A stream is held to the same, and to its cycles.
    let limits = Limits { cycles: 100, ..Limits::default() };
    let server = Loopback::with(with(|config| config.limits = limits)).await;
    let opened = Setpoints::open(&server.client().await, open("x", planned(fifty_millimetres()))).await;
    let Err(Error::Rejected(rejected)) = opened.map(|_| ()) else { panic!("no refusal") };
    assert_eq!((rejected.reason, rejected.metadata["given"].as_str()), (Reason::TooManyCycles, "314"));
}

#[tokio::test]
async fn streams_are_counted_in_all_and_of_each() {
    let authority = Authority::default();
    let limits = Limits { streams: 3, streams_per_identity: 2, ..Limits::default() };
    let server = Loopback::with(with(|config| {
        config.limits = limits;
        config.serving.tls = Some(authority.server());
    }))
    .await;
    let endpoint = server.secure_endpoint();
    let one = authority.connect_as("one").to(&endpoint).await.unwrap();
    let other = authority.connect_as("other").to(&endpoint).await.unwrap();
    let opened = async |client: &client::Client, name: &str| {
        Setpoints::open(client, open(name, planned(fifty_millimetres()))).await
    };
    let _held = [opened(&one, "a").await.unwrap(), opened(&one, "b").await.unwrap()];
    let Err(Error::Rejected(greedy)) = opened(&one, "c").await.map(|_| ()) else { panic!("no refusal") };
    assert_eq!(greedy.reason, Reason::TooManyStreams);
    assert_eq!(greedy.metadata["limit"], "max_streams_per_identity");
    let _third = opened(&other, "c").await.unwrap();
    let Err(Error::Rejected(full)) = opened(&other, "d").await.map(|_| ()) else { panic!("no refusal") };
    assert_eq!((full.reason, full.metadata["given"].as_str()), (Reason::TooManyStreams, "4"));
}

#[tokio::test]
async fn who_asks_too_often_is_told_when_to_ask_again() {
    let server = Loopback::with(with(|config| config.serving.max_request_rate = 3)).await;
    let mut planner = server.planner().await;
    let mut refused = None;
    for _ in 0..50 {
        refused = planner.plan(axes(1)).await.err();
        if refused.is_some() {
            break;
        }
    }
    let status = refused.expect("fifty calls take less than ten seconds");
    let rejected = rejected(&status);
    assert_eq!(rejected.reason, Reason::Overloaded);
    assert_eq!(rejected.metadata["limit"], "max_request_rate");
    // As clients of other languages read it.
    let retry = status.get_details_retry_info().unwrap().retry_delay.unwrap();
    assert!(retry > Duration::ZERO && retry <= Duration::from_secs(1), "{retry:?}");
    assert_eq!(rejected.retry_delay(), Some(retry));
}

/// Calls that wait for their messages take all the room there is; a stream that is open needs none of it.
#[tokio::test]
async fn an_overloaded_server_sheds_calls_and_keeps_streams() {
    let server = Loopback::with(with(|config| config.serving.max_concurrent_requests = 4)).await;
    let client = server.client().await;
    let mut stream = Setpoints::open(&client, open("x", planned(fifty_millimetres()))).await.unwrap();
    let channel = server.channel().await;
    let mut waiting = Vec::new();
    for _ in 0..4 {
        waiting.push(begun(channel.clone(), "/motion.v1.PlannerService/Plan").await);
    }
    let mut planner = server.planner().await;
    let shed = async {
        loop {
            if let Err(status) = planner.plan(axes(1)).await {
                return rejected(&status);
            }
        }
    };
    let rejected = tokio::time::timeout(AMPLE, shed).await.expect("four calls take all the room");
    assert_eq!(rejected.reason, Reason::Overloaded);
    assert_eq!(rejected.metadata["limit"], "max_concurrent_requests");
    assert!(rejected.retry_delay().is_some());
    let mut cycles = 0;
    while stream.next().await.unwrap().is_some() {
        cycles += 1;
    }
    assert_eq!(cycles, 314);
    // Once those that waited have gone there is room again.
    drop(waiting);
    let answered = async { while planner.plan(axes(1)).await.is_err() {} };
    tokio::time::timeout(AMPLE, answered).await.expect("there is room again");
}

#[tokio::test]
async fn a_message_that_does_not_come_is_not_waited_for() {
    let server = Loopback::with(with(|config| {
        config.serving.first_message_deadline = Duration::from_millis(100);
        config.serving.idle_deadline = Duration::from_millis(300);
    }))
    .await;
    // A call without its message, and a stream without its Open.
    let (_kept, call) = begun(server.channel().await, "/motion.v1.PlannerService/Plan").await;
    let late = tokio::time::timeout(AMPLE, call).await.unwrap().unwrap().unwrap_err();
    assert_eq!(rejected(&late).reason, Reason::FirstMessageLate);
    let (_silent, requests) = mpsc::channel::<pb::StreamSetpointsRequest>(1);
    let mut setpoints = server.setpoints().await;
    let mut answers = setpoints.stream_setpoints(ReceiverStream::new(requests)).await.unwrap().into_inner();
    let late = tokio::time::timeout(AMPLE, answers.message()).await.unwrap().unwrap_err();
    assert_eq!(rejected(&late).reason, Reason::FirstMessageLate);
    // An axis that opens and then says nothing.
    let (reports, mut link) =
        server.client().await.open(open("x", planned(fifty_millimetres()))).await.unwrap();
    let idle = async {
        loop {
            match link.next().await {
                Ok(Some(_)) => {}
                Ok(None) => panic!("the stream ended without a reason"),
                Err(error) => return error,
            }
        }
    };
    let error = tokio::time::timeout(AMPLE, idle).await.unwrap();
    let Error::Rejected(rejected) = error else { panic!("{error:?}") };
    assert_eq!(rejected.reason, Reason::StreamIdle);
    drop(reports);
}
