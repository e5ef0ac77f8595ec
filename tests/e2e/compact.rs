//! Streams without setpoints: the axis evaluates the motion itself, and plays the same bits.

use client::Setpoints;
use e2e::{Loopback, difference, fifty_millimetres, move_of, open, planned, replay};
use planner::motion::{Operation as Planned, Override};
use planner::{AxisMoveSpec, Family, RequestSpec, State};
use proto::pb::setpoint_service_client::SetpointServiceClient;
use proto::pb::stream_setpoints_response::Message;
use proto::stream::{Ask, FromAxis, Open, Operation};
use proto::{Digest, request_to_wire};
use sim_axis::{AxisModel, Clock, TrackRequest, Tracking, TrackingReport};

/// Every setpoint of a stream with operations on the way follows from plan, operations and their cycles.
async fn plays_what_follows(server: &Loopback, spec: RequestSpec, compact: bool) {
    let client = server.client().await;
    let plan = planned(spec);
    let opening = Open { compact, lead_cycles: 60, ..open(&format!("compact-{compact}"), plan.clone()) };
    let mut stream = Setpoints::open(&client, opening).await.unwrap();
    let script = [
        (200, "slower", Ask::Override(0.5)),
        (450, "hold", Ask::Hold),
        (900, "on", Ask::Resume),
        (1100, "full", Ask::Override(1.0)),
        (1300, "stop", Ask::Stop),
    ];
    for (cycle, id, ask) in script.clone() {
        assert!(stream.operate(Operation { not_before_cycle: Some(cycle), ..Operation::now(id, ask) }));
    }
    let (mut all, mut digest) = (Vec::new(), Digest::ZERO);
    while let Some(playing) = stream.next().await.unwrap() {
        all.push(playing.setpoints.to_vec());
        digest = playing.digest;
    }
    let done = stream.take_answers().into_iter().map(|(_, answer)| answer.unwrap().effective_cycle);
    let half = Override::new(0.5).unwrap();
    let operations = [
        Planned::Override(half),
        Planned::Hold,
        Planned::Resume,
        Planned::Override(Override::FULL),
        Planned::Stop,
    ];
    let done: Vec<_> = done.zip(operations).collect();
    assert_eq!(done.len(), script.len());
    assert_eq!(stream.buffer().counters().refused_batches, 0);
    let (expected, of_it, _) = replay(&plan, &done, all.len() as u64);
    assert!(all.len() > 1300);
    assert_eq!((difference(&all, &expected), digest), (None, of_it), "compact: {compact}");
}

#[tokio::test]
async fn setpoints_that_the_axis_evaluates_are_those_of_the_server() {
    let server = Loopback::start().await;
    let mut two = move_of(0.3, 0.25);
    two.axes.push(AxisMoveSpec { axis: "y".into(), goal: State::at_rest(-0.2), ..two.axes[0].clone() });
    let mut smooth = RequestSpec { family: Ok(Family::Polynomial), order: Some(4), ..move_of(0.3, 0.25) };
    smooth.axes[0].limits.max_snap = Some(5000.0);
    let cosine = RequestSpec { family: Ok(Family::Trigonometric), ..move_of(0.3, 0.25) };
    for spec in [move_of(0.3, 0.25), two, smooth, cosine] {
        for compact in [false, true] {
            plays_what_follows(&server, spec.clone(), compact).await;
        }
    }
}

async fn tracked(server: &Loopback, compact: bool) -> TrackingReport {
    let request = TrackRequest {
        models: vec![AxisModel::flexible("x")],
        clock: Clock::Virtual,
        compact,
        ..TrackRequest::new("cell-7/x", server.endpoint(), planned(fifty_millimetres()))
    };
    Tracking::begin(request).await.unwrap().finish().await.unwrap()
}

#[tokio::test]
async fn an_axis_that_evaluates_follows_as_any_other() {
    let server = Loopback::start().await;
    let (told, evaluated) = (tracked(&server, false).await, tracked(&server, true).await);
    assert_eq!((told.axes, told.stream.digest), (evaluated.axes, evaluated.stream.digest));
}

/// What goes over the wire is how many cycles there are, and their digest.
#[tokio::test]
async fn a_batch_carries_neither_setpoints_nor_ways_to_rest() {
    let server = Loopback::start().await;
    let plan = planned(fifty_millimetres());
    let opening = Open { compact: true, ..open("cell-7/x", plan.clone()) };
    let first = request_to_wire(&FromAxis::Open(Box::new(opening)));
    let requests = tokio_stream::StreamExt::chain(tokio_stream::once(first), tokio_stream::pending());
    let mut client = SetpointServiceClient::connect(server.endpoint()).await.unwrap();
    let mut answers = client.stream_setpoints(requests).await.unwrap().into_inner();
    let (mut sent, mut digest) = (0, Digest::ZERO);
    let motion = proto::stream::Motion::opened(planner::motion::Motion::open(plan).unwrap());
    while sent < 40 {
        let message = answers.message().await.unwrap().unwrap().message;
        let Some(Message::Batch(batch)) = message else { continue };
        assert_eq!((batch.first_cycle, batch.cycles), (sent + 1, 10));
        assert!(batch.columns.is_none() && batch.stop_tails.is_empty());
        digest = motion.digest_from((sent, digest), sent + 10);
        assert_eq!(batch.digest, u64::from(digest));
        sent += 10;
    }
}
