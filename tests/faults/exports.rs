//! Spans for an OpenTelemetry collector: what is told of a motion, and that streams do not wait for whoever is told.

use std::collections::HashMap;
use std::path::Path;
use std::time::Duration;

use client::{Client, Connect};
use e2e::{Authority, Line, Proxy, fifty_millimetres, move_of, planned};
use proto::TraceContext;
use proto::stream::{Ask, Operation};
use sim_axis::{RemoteAxis, Update};

use crate::collector::{Collector, Span};
use crate::mute::mute;
use crate::replica::Replica;
use crate::run::{LEAD, PATIENCE, alone, request};

const ENDPOINT: &str = "PORTAMENTO_OTLP_ENDPOINT";
/// Within this much after SIGTERM a process has gone whose work has ended, whatever becomes of its last spans.
const SOON: Duration = Duration::from_secs(5);

async fn all_leave(processes: impl IntoIterator<Item = Replica>) {
    for process in processes {
        process.signal("TERM");
        assert!(process.gone(SOON).await.success());
    }
}

/// A controller plans and has an axis follow; the axis streams from one planner and then from another. Every span says in which other
/// it was done, from the controller's down.
#[tokio::test(flavor = "multi_thread")]
async fn spans_of_all_processes_hang_together() {
    let _alone = alone().await;
    let collector = Collector::start().await;
    let to = [(ENDPOINT, format!("http://127.0.0.1:{}", collector.port()))];
    let (one, two) = (Replica::within("one", &to).await, Replica::within("two", &to).await);
    let axis = Replica::axis(&to).await;
    let trace = TraceContext::begin();
    let endpoints = [one.endpoint(), two.endpoint()];
    let told = trace.scope(async {
        let plan = planned(move_of(0.5, 0.25));
        let controller = Client::connect(&endpoints[0]).await.unwrap();
        controller.plan(move_of(0.5, 0.25)).await.unwrap();
        let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
        let mut run = remote.track(request("cell-7/x", &endpoints, &plan, LEAD)).await.unwrap();
        assert!(matches!(run.next().await.unwrap(), Some(Update::Samples(_))), "it moves");
        remote.command("cell-7/x", Operation::now("slower", Ask::Override(0.5))).await.unwrap();
        one.signal("TERM");
        while run.next().await.unwrap().is_some() {}
        assert_eq!(run.finish().unwrap().stream.failovers, 1);
    });
    tokio::time::timeout(PATIENCE, told).await.unwrap();
    assert!(one.gone(SOON).await.success());
    all_leave([axis, two]).await;

    let spans = collector.spans();
    assert!(
        spans.iter().all(|span| ["rpc", "session"].contains(&span.name.as_str())),
        "of ours alone: {spans:#?}"
    );
    let (trace_id, controller, _) = trace.ids();
    let spans: Vec<Span> = spans.into_iter().filter(|span| span.trace == trace_id).collect();
    let by_id: HashMap<u64, &Span> = spans.iter().map(|span| (span.id, span)).collect();
    for span in &spans {
        let hangs = span.parent == controller || by_id.contains_key(&span.parent);
        assert!(hangs, "nobody tells of what {span:?} was done for");
    }
    let called = |method: &str| -> Vec<&Span> {
        let is_of = |span: &&Span| span.fields.get("method").is_some_and(|path| path.ends_with(method));
        spans.iter().filter(is_of).collect()
    };
    let [plan] = called("/Plan")[..] else { panic!("{spans:#?}") };
    assert_eq!((plan.process.as_str(), plan.parent), ("portamento-server", controller));
    let [follows] = called("/RunTracking")[..] else { panic!("{spans:#?}") };
    assert_eq!((follows.process.as_str(), follows.parent), ("portamento-sim-axis", controller));
    assert_eq!(follows.fields["stream"], "cell-7/x");
    let [commanded] = called("/Command")[..] else { panic!("{spans:#?}") };
    assert_eq!((commanded.fields["request"].as_str(), commanded.parent), ("slower", controller));
    let streamed = called("/StreamSetpoints");
    assert_eq!(streamed.len(), 2, "{spans:#?}");
    assert!(streamed.iter().all(|span| span.parent == follows.id && span.process == "portamento-server"));
    let mut epochs = Vec::new();
    let mut done = Vec::new();
    for session in spans.iter().filter(|span| span.name == "session") {
        assert!(streamed.iter().any(|call| call.id == session.parent), "{session:?}");
        assert_eq!(session.fields["stream"], "cell-7/x");
        epochs.push(session.fields["epoch"].parse::<u64>().unwrap());
        done.extend(session.events.iter().filter(|event| event["message"] == "operation done"));
    }
    epochs.sort_unstable();
    assert!(epochs.len() == 2 && epochs[0] < epochs[1], "{epochs:?}");
    let requests: Vec<&str> = done.iter().map(|event| event["request"].as_str()).collect();
    assert_eq!(requests, ["slower"]);
}

/// One that is spoken to with encryption: who vouches for it is asked.
#[tokio::test(flavor = "multi_thread")]
async fn an_encrypted_collector() {
    let _alone = alone().await;
    let (authority, other) = (Authority::default(), Authority::default());
    let collector = Collector::encrypted(&authority).await;
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    for (name, vouches, told) in [("right", &authority, 1), ("wrong", &other, 1)] {
        let path = folder.join(format!("collector-{name}-{}.pem", std::process::id()));
        std::fs::write(&path, vouches.pem()).unwrap();
        let environment = [
            (ENDPOINT, format!("https://localhost:{}", collector.port())),
            ("PORTAMENTO_OTLP_CA", path.display().to_string()),
        ];
        let server = Replica::within(name, &environment).await;
        let client = Connect::new().to(&server.endpoint()).await.unwrap();
        client.plan(fifty_millimetres()).await.unwrap();
        drop(client);
        all_leave([server]).await;
        // Who is not vouched for is told nothing.
        assert_eq!(collector.spans().len(), told, "{name}");
        std::fs::remove_file(&path).unwrap();
    }
}

/// Nobody there, somebody who takes connections and says nothing, and somebody who takes seconds for each answer.
#[tokio::test(flavor = "multi_thread")]
async fn a_collector_that_does_not_take_spans_disturbs_nobody() {
    let _alone = alone().await;
    let absent = {
        let free = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        format!("http://{}", free.local_addr().unwrap())
    };
    let kept = Collector::start().await;
    let delays = Line::Delays(Duration::from_secs(2), Duration::from_secs(3));
    let slow = Proxy::before(([127, 0, 0, 1], kept.port()).into(), delays).await;
    for collector in [absent, mute().await, slow.endpoint()] {
        let to = [(ENDPOINT, collector.clone()), ("OTEL_BSP_SCHEDULE_DELAY", "100".into())];
        let (server, axis) = (Replica::within("one", &to).await, Replica::axis(&to).await);
        let plan = planned(move_of(0.4, 0.25));
        let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
        let mut run = remote.track(request("cell-7/x", &[server.endpoint()], &plan, LEAD)).await.unwrap();
        assert!(run.next().await.unwrap().is_some(), "it moves");
        let before = resident(server.pid());
        // More spans than wait anywhere.
        let client = Client::connect(&server.endpoint()).await.unwrap();
        let calls = (0..64).map(|_| {
            let client = client.clone();
            tokio::spawn(async move {
                for _ in 0..50 {
                    client.plan(fifty_millimetres()).await.unwrap();
                }
            })
        });
        for call in calls.collect::<Vec<_>>() {
            call.await.unwrap();
        }
        let grown = resident(server.pid()).saturating_sub(before);
        while run.next().await.unwrap().is_some() {}
        let report = run.finish().unwrap().stream;
        assert_eq!((report.counters.underruns, report.failovers), (0, 0), "{collector}: {report:?}");
        assert_eq!(report.cycles_executed, plan.plan().cycle_count());
        assert!(grown < 32 << 20, "{collector}: {} KiB more than before", grown >> 10);
        drop((client, remote));
        all_leave([axis, server]).await;
    }
}

/// What a process holds in memory \[bytes\]. Source: proc_pid_statm(5).
fn resident(process: u32) -> usize {
    let statm = std::fs::read_to_string(format!("/proc/{process}/statm")).unwrap();
    statm.split(' ').nth(1).unwrap().parse::<usize>().unwrap() * 4096
}
