//! Servers that are told to leave.

use std::time::{Duration, Instant};

use client::failover::Cause;
use e2e::{move_of, open, planned};
use proto::pb::setpoint_service_client::SetpointServiceClient;
use proto::pb::stream_setpoints_response::Message;
use proto::stream::FromAxis;
use tokio::sync::mpsc;
use tokio::task::JoinSet;
use tokio_stream::wrappers::ReceiverStream;

use crate::replica::Replica;
use crate::run::{LEAD, Run, alone, request};

/// Streams move over, and the process is gone as soon as they have: long before its deadline.
#[tokio::test(flavor = "multi_thread")]
async fn told_to_leave() {
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let (first, second) = (Replica::start("first").await, Replica::start("second").await);
    let endpoints = [first.endpoint(), second.endpoint()];
    let mut run = Run::begin(request("cell-7/x", &endpoints, &plan, LEAD)).await;
    run.until(300).await;
    first.signal("TERM");
    let (played, status) = tokio::join!(run.finish(), first.gone(Duration::from_secs(5)));
    assert_eq!(status.code(), Some(0));
    played.is_undisturbed(&plan, &[]);
    let [change] = &played.seen.changes[..] else { panic!("{:?}", played.seen.changes) };
    assert_eq!((change.cause, change.to.as_str()), (Cause::Draining, "second"));
}

/// An axis that hears that its server leaves, and stays: the process is gone at its deadline all the same, and says that it is well.
#[tokio::test(flavor = "multi_thread")]
async fn told_to_leave_and_nobody_moves_over() {
    let _alone = alone().await;
    let any = std::net::SocketAddr::from(([127, 0, 0, 1], 0));
    let server = Replica::with("only", any, &["--drain-deadline", "1"]).await;
    let (says, requests) = mpsc::channel(4);
    let mut stubborn = SetpointServiceClient::connect(server.endpoint()).await.unwrap();
    let mut hears = stubborn.stream_setpoints(ReceiverStream::new(requests)).await.unwrap().into_inner();
    let opening = open("stubborn", planned(move_of(0.3, 0.25)));
    says.send(proto::request_to_wire(&FromAxis::Open(Box::new(opening)))).await.unwrap();
    assert!(matches!(hears.message().await.unwrap().unwrap().message, Some(Message::Opened(_))));
    let told = Instant::now();
    server.signal("TERM");
    let status = server.gone(Duration::from_secs(10)).await;
    let took = told.elapsed();
    assert_eq!(status.code(), Some(0));
    // A second, and two farewells of half a second at most.
    assert!((Duration::from_secs(1)..Duration::from_secs(4)).contains(&took), "{took:?}");
    drop(says);
}

/// All three servers are started again, one after the other, under four axes that move: none of them misses a cycle.
#[tokio::test(flavor = "multi_thread")]
async fn a_rolling_restart() {
    let _alone = alone().await;
    let plan = planned(move_of(1.5, 0.25));
    let names = ["first", "second", "third"];
    let mut replicas = Vec::new();
    for name in names {
        replicas.push(Replica::start(name).await);
    }
    let endpoints: Vec<String> = replicas.iter().map(Replica::endpoint).collect();
    let mut runs = JoinSet::new();
    for axis in 0..4_usize {
        let mut endpoints = endpoints.clone();
        endpoints.rotate_left(axis % 3);
        let request = request(&format!("cell-{axis}/x"), &endpoints, &plan, LEAD);
        let run = Run::begin(request).await;
        let plan = plan.clone();
        runs.spawn(async move {
            let played = run.finish().await;
            played.is_undisturbed(&plan, &[]);
            let changes = &played.seen.changes;
            assert!(
                !changes.is_empty() && changes.iter().all(|change| change.cause == Cause::Draining),
                "{changes:?}"
            );
        });
    }
    for name in names {
        let old = replicas.remove(0);
        let address = old.address();
        old.signal("TERM");
        assert_eq!(old.gone(Duration::from_secs(5)).await.code(), Some(0));
        replicas.push(Replica::with(name, address, &[]).await);
    }
    assert!(runs.try_join_next().is_none(), "the axes were to move for longer than that");
    while let Some(run) = runs.join_next().await {
        run.unwrap();
    }
}
