//! Many plans over one stream: what `Plan` says of each, in its place.

use std::time::Duration;

use client::Error;
use e2e::{Loopback, fifty_millimetres, move_of};
use planner::{Family, RequestSpec, ShortPathPolicy, State};
use prost::Message as _;
use proto::pb::plan_outcome::Outcome;
use proto::{Detail, Reason, Rejected, pb};
use server::{Config, Limits};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::Status;

/// Longer than anything here takes.
const AMPLE: Duration = Duration::from_secs(20);

/// Requests that have nothing in common but that some are refused, each for another reason and at another path.
fn mixed() -> Vec<pb::PlanRequest> {
    let with = |change: &dyn Fn(&mut RequestSpec)| {
        let mut spec = fifty_millimetres();
        change(&mut spec);
        pb::PlanRequest::from(spec)
    };
    vec![
        with(&|_| {}),
        with(&|spec| spec.axes[0].limits.max_jerk = -1.0),
        with(&|spec| spec.family = Ok(Family::Trapezoidal)),
        with(&|spec| {
            // Too short to reach this velocity, and nothing is to give way.
            spec.axes[0].goal = State { position: 1e-4, velocity: 0.2, acceleration: 0.0 };
            spec.short_path = Ok(ShortPathPolicy::Reject);
        }),
        with(&|spec| spec.axes[0].goal.acceleration = 1.0),
        pb::PlanRequest::default(),
        with(&|spec| spec.axes[0].goal.position = -0.3),
        with(&|spec| spec.axes[0].axis = "x\n".into()),
        with(&|spec| {
            spec.axes = ["x", "y", "z"]
                .map(|axis| planner::AxisMoveSpec { axis: axis.into(), ..spec.axes[0].clone() })
                .into();
            spec.axes[1].goal.position = 0.7;
            spec.synchronization = Ok(planner::Synchronization::Time);
        }),
    ]
}

fn message(requests: Vec<pb::PlanRequest>) -> pb::PlanManyRequest {
    pb::PlanManyRequest { requests, detail: 0, columns: None }
}

/// The answers to `messages`, up to the status that ends them.
async fn asked(
    server: &Loopback,
    messages: Vec<pb::PlanManyRequest>,
) -> (Vec<Vec<pb::PlanOutcome>>, Option<Status>) {
    let mut planner = server.planner().await;
    let mut answers = planner.plan_many(tokio_stream::iter(messages)).await.unwrap().into_inner();
    let mut all = Vec::new();
    loop {
        match answers.message().await {
            Ok(Some(answer)) => all.push(answer.outcomes),
            Ok(None) => return (all, None),
            Err(status) => return (all, Some(status)),
        }
    }
}

#[track_caller]
fn reason(status: Option<&Status>) -> Rejected {
    let status = status.expect("a refusal");
    Rejected::from_status(status).unwrap_or_else(|| panic!("no reason in {status:?}"))
}

#[track_caller]
fn refusal(outcome: &pb::PlanOutcome) -> Rejected {
    match &outcome.outcome {
        Some(Outcome::Refusal(status)) => Rejected::from_bytes(status).expect("a reason"),
        other => panic!("no refusal: {other:?}"),
    }
}

/// Each answer has the bytes of `Plan`'s, each refusal its reason, fields and metadata, at the index of the request.
#[tokio::test]
async fn every_outcome_is_in_its_place_and_what_plan_says() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    // Three messages, one of them empty; the last is the first backwards.
    let (forwards, mut backwards) = (mixed(), mixed());
    backwards.reverse();
    let messages = vec![message(forwards.clone()), message(vec![]), message(backwards.clone())];
    let (answers, end) = asked(&server, messages).await;
    assert!(end.is_none(), "{end:?}");
    assert_eq!(answers.iter().map(Vec::len).collect::<Vec<_>>(), [forwards.len(), 0, forwards.len()]);
    let mut refused = 0;
    for (request, outcome) in forwards.into_iter().chain(backwards).zip(answers.concat()) {
        match planner.plan(request).await {
            Ok(alone) => {
                let Some(Outcome::Plan(plan)) = outcome.outcome else { panic!("{outcome:?}") };
                assert_eq!(plan.encode_to_vec(), alone.into_inner().plan.unwrap().encode_to_vec());
            }
            Err(status) => {
                refused += 1;
                assert_eq!(refusal(&outcome), Rejected::from_status(&status).unwrap());
            }
        }
    }
    assert_eq!(refused, 2 * 4);
}

/// What is left out is what follows from the rest: the motion has the same bits, and whoever takes plans takes it.
#[tokio::test]
async fn a_plan_with_less_detail_is_the_same_motion() {
    let server = Loopback::start().await;
    let full = message(mixed());
    let motion = pb::PlanManyRequest { detail: pb::PlanDetail::Motion as i32, ..full.clone() };
    let (answers, _) = asked(&server, vec![full, motion]).await;
    let mut planner = server.planner().await;
    for (full, less) in answers[0].iter().zip(&answers[1]) {
        let (Some(Outcome::Plan(full)), Some(Outcome::Plan(less))) = (&full.outcome, &less.outcome) else {
            assert_eq!(full, less);
            continue;
        };
        let passed = pb::PlanCertificate { passed: true, ..Default::default() };
        let expected =
            pb::Plan { fingerprint: vec![], explanation: None, certificate: Some(passed), ..full.clone() };
        assert_eq!(*less, expected);
        let verify = pb::VerifyPlanRequest { plan: Some(less.clone()), against: vec![] };
        let certificate = planner.verify_plan(verify).await.unwrap().into_inner().certificate;
        assert_eq!(certificate, full.certificate);
    }
    let unknown = pb::PlanManyRequest { detail: 99, ..message(mixed()) };
    let (answers, end) = asked(&server, vec![message(mixed()), unknown]).await;
    let rejected = reason(end.as_ref());
    assert_eq!((answers.len(), rejected.reason), (1, Reason::KindUnspecified));
    assert_eq!(rejected.fields[0].field, "detail");
}

/// A message that is too large ends the stream with its reason; what was answered before holds.
#[tokio::test]
async fn each_size_has_its_reason() {
    let mut config = Config {
        limits: Limits { plans_per_message: 9, axes: 3, ..Limits::default() },
        ..Config::loopback()
    };
    config.serving.max_message_bytes = 30_000;
    let server = Loopback::with(config).await;
    let one = pb::PlanRequest::from(fifty_millimetres());
    let (answers, end) = asked(&server, vec![message(mixed()), message(vec![one.clone(); 10])]).await;
    let rejected = reason(end.as_ref());
    assert_eq!((answers.len(), rejected.reason), (1, Reason::TooManyPlans));
    assert_eq!((&*rejected.metadata["given"], &*rejected.metadata["allowed"]), ("10", "9"));
    assert_eq!(rejected.fields[0].field, "requests");
    assert!(rejected.message.contains("max_plans_per_message"), "{rejected}");
    // Too many axes of one request are refused in its place.
    let mut wide = one.clone();
    wide.axes =
        (0..4).map(|index| pb::AxisMove { axis: format!("x{index}"), ..one.axes[0].clone() }).collect();
    let (answers, end) = asked(&server, vec![message(vec![one.clone(), wide, one.clone()])]).await;
    assert!(end.is_none() && answers[0].len() == 3);
    assert_eq!(refusal(&answers[0][1]).reason, Reason::TooManyAxes);
    assert!(matches!(answers[0][2].outcome, Some(Outcome::Plan(_))));
    // A request that no message may hold.
    let mut long = one.clone();
    long.axes[0].axis = "x".repeat(40_000);
    let (answers, end) = asked(&server, vec![message(vec![one.clone()]), message(vec![long])]).await;
    assert_eq!((answers.len(), reason(end.as_ref()).reason), (1, Reason::MessageTooLarge));
    // And an answer that none may hold, though each of its plans would fit.
    let mut three = one.clone();
    three.axes = (0..3)
        .map(|index| pb::AxisMove { axis: format!("{index}").repeat(250), ..one.axes[0].clone() })
        .collect();
    three.synchronization = pb::Synchronization::None as i32;
    let (answers, end) = asked(&server, vec![message(vec![three.clone()]), message(vec![three; 9])]).await;
    let rejected = reason(end.as_ref());
    assert_eq!((answers.len(), rejected.reason), (1, Reason::MessageTooLarge), "{rejected}");
    assert_eq!(rejected.metadata["allowed"], "30000");
}

#[tokio::test]
async fn bytes_that_are_no_message_end_the_stream_with_a_reason() {
    let server = Loopback::start().await;
    let mut grpc = tonic::client::Grpc::new(server.channel().await);
    grpc.ready().await.unwrap();
    // A text where requests belong.
    let garbage = pb::CommandRequest { stream: "\u{7f}garbage".into(), operation: None };
    let path = "/motion.v1.PlannerService/PlanMany".parse().unwrap();
    let codec = tonic_prost::ProstCodec::<pb::CommandRequest, pb::PlanManyResponse>::default();
    let requests = tonic::Request::new(tokio_stream::iter([garbage]));
    let mut answers = grpc.streaming(requests, path, codec).await.unwrap().into_inner();
    let status = answers.message().await.unwrap_err();
    assert_eq!(reason(Some(&status)).reason, Reason::MessageInvalid);
}

/// Plans that nobody waits for any more are not made: a server that has an hour to leave has nothing left to do.
#[tokio::test]
async fn a_caller_who_has_gone_is_not_planned_for() {
    let mut config = Config::loopback();
    config.serving.drain_deadline = Duration::from_hours(1);
    let mut server = Loopback::with(config).await;
    let (sender, requests) = mpsc::channel(8);
    let mut planner = server.planner().await;
    // More than the server makes ahead, so that it waits for a reader.
    for _ in 0..8 {
        sender.send(message(vec![pb::PlanRequest::from(fifty_millimetres()); 4096])).await.unwrap();
    }
    let mut answers = planner.plan_many(ReceiverStream::new(requests)).await.unwrap().into_inner();
    assert_eq!(answers.message().await.unwrap().unwrap().outcomes.len(), 4096);
    drop((sender, answers, planner));
    server.tell_to_stop();
    tokio::time::timeout(AMPLE, server.stopped()).await.expect("nothing is left to do");
}

#[tokio::test]
async fn a_server_that_leaves_says_so_after_what_it_has_answered() {
    let mut server = Loopback::start().await;
    let client = server.client().await;
    let (asking, mut answers) = client.plan_many(Detail::Motion).await.unwrap();
    assert!(asking.ask(vec![fifty_millimetres(); 3]).await.unwrap());
    assert_eq!(answers.next().await.unwrap().unwrap().len(), 3);
    server.tell_to_stop();
    let Err(Error::Rejected(rejected)) = answers.next().await else { panic!("no refusal") };
    assert_eq!(rejected.reason, Reason::Draining);
    drop((asking, answers, client));
    tokio::time::timeout(AMPLE, server.stopped()).await.expect("the stream is over");
}

/// Through the client, over several messages: what it gives for each request is what it gives for it alone.
#[tokio::test]
async fn the_client_gives_what_it_gives_for_each_alone() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let request = |index: usize| match index % 50 {
        // The velocity limit below 0.
        7 => move_of(0.05, -1.0),
        _ => move_of(1e-3 * (index + 1) as f64, 0.25),
    };
    let all = client.plan_all((0..500).map(request).collect()).await.unwrap();
    assert_eq!(all.len(), 500);
    for (index, outcome) in all.into_iter().enumerate() {
        let alone = match client.plan(request(index)).await {
            Ok(judged) => Ok(judged),
            Err(Error::Rejected(rejected)) => Err(*rejected),
            Err(error) => panic!("{error}"),
        };
        assert_eq!(outcome.is_err(), index % 50 == 7);
        assert_eq!(outcome, alone, "{index}");
    }
    assert_eq!(client.plan_all(vec![]).await.unwrap(), []);
    // What this side is not to send.
    let small = client.with_message_limit(500);
    let error = small.plan_all(vec![fifty_millimetres(); 20]).await.unwrap_err();
    assert!(matches!(error, Error::TooLarge { .. }), "{error:?}");
}
