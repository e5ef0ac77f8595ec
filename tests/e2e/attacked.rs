//! Peers that mean harm, or behave as if they did, beside an axis that moves: it misses no cycle, and memory stays bounded.

use std::time::{Duration, Instant};

use e2e::{Loopback, LoopbackAxis, move_of, planned};
use proto::{Reason, Rejected, pb};
use sim_axis::{RemoteAxis, TrackRequest};
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;
use tonic_types::StatusExt as _;

/// Longer than anything here takes.
const AMPLE: Duration = Duration::from_secs(60);
/// What HTTP/2 begins with. Source: RFC 9113, §3.4.
const PREFACE: &[u8] = b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
/// An empty SETTINGS frame. Source: RFC 9113, §4.1 and §6.5.
const SETTINGS: &[u8] = &[0, 0, 0, 4, 0, 0, 0, 0, 0];

async fn server() -> Loopback {
    let mut config = server::Config::loopback();
    config.serving.max_connections = 80;
    config.serving.keepalive_interval = Duration::from_millis(500);
    config.serving.keepalive_timeout = Duration::from_millis(500);
    config.serving.max_message_bytes = 1 << 20;
    Loopback::with(config).await
}

/// Plays two seconds of motion in real time while `attack` goes on; the report of the axis.
async fn moved_under(
    server: &Loopback,
    attack: impl Future<Output = ()> + Send + 'static,
) -> sim_axis::TrackingReport {
    let axis = LoopbackAxis::start().await;
    let plan = planned(move_of(0.5, 0.25));
    let cycles = plan.plan().cycle_count();
    let mut request = TrackRequest::new("cell-7/x", server.endpoint(), plan);
    // The tests beside this one take the processor for longer than forty cycles now and then.
    request.lead_cycles = 250;
    let mut run = RemoteAxis::connect(&axis.endpoint()).await.unwrap().track(request).await.unwrap();
    assert!(run.next().await.unwrap().is_some(), "it moves");
    let attack = tokio::spawn(attack);
    while run.next().await.unwrap().is_some() {}
    attack.await.unwrap();
    let report = run.finish().unwrap();
    assert_eq!(report.stream.cycles_executed, cycles);
    assert_eq!(report.stream.counters.underruns, 0, "{:?}", report.stream);
    report
}

fn address(server: &Loopback) -> String {
    server.endpoint().trim_start_matches("http://").to_owned()
}

async fn ends(mut socket: TcpStream) {
    let mut rest = Vec::new();
    // However it ends, it ends.
    let _ = tokio::time::timeout(AMPLE, socket.read_to_end(&mut rest)).await.expect("it is left");
}

/// Who connects and says nothing, or says it letter by letter, is left; so is who asks nothing and does not answer when asked
/// whether it is there.
#[tokio::test(flavor = "multi_thread")]
async fn slow_peers_are_left() {
    let server = server().await;
    let address = address(&server);
    moved_under(&server, async move {
        let mut slow = Vec::new();
        for said in [&PREFACE[..0], &PREFACE[..1], &PREFACE[..23], &[PREFACE, SETTINGS].concat()] {
            for _ in 0..15 {
                let mut socket = TcpStream::connect(&address).await.unwrap();
                socket.write_all(said).await.unwrap();
                slow.push(tokio::spawn(ends(socket)));
            }
        }
        for socket in slow {
            socket.await.unwrap();
        }
    })
    .await;
}

/// More connections than there may be: they are closed as they come, and those that are there keep what they have.
#[tokio::test(flavor = "multi_thread")]
async fn a_flood_of_connections() {
    let server = server().await;
    let address = address(&server);
    moved_under(&server, async move {
        let began = Instant::now();
        let mut held = Vec::new();
        let mut closed = 0;
        for _ in 0..600 {
            let mut socket = TcpStream::connect(&address).await.unwrap();
            let _ = socket.write_all(&[PREFACE, SETTINGS].concat()).await;
            held.push(socket);
        }
        // Those that are there and do not answer are left after a second, and others find room.
        let rounds = 1 + began.elapsed().as_secs() as usize;
        for mut socket in held {
            let mut first = [0];
            // Those that found room hear the server's settings.
            let heard =
                tokio::time::timeout(AMPLE, socket.read(&mut first)).await.expect("an answer, or an end");
            closed += usize::from(!matches!(heard, Ok(1)));
        }
        assert!(closed + 80 * rounds >= 600, "{closed} of 600 were closed, in {rounds} s");
    })
    .await;
}

/// Messages that say that they are huge are refused when they say so, and are not kept.
#[tokio::test(flavor = "multi_thread")]
async fn giant_messages() {
    let server = server().await;
    let mut planner = server.planner().await;
    let before = resident();
    moved_under(&server, async move {
        let plan = pb::Plan { planner_version: "x".repeat(32 << 20), ..Default::default() };
        for _ in 0..10 {
            let request = pb::VerifyPlanRequest { plan: Some(plan.clone()), against: vec![] };
            let status = planner.verify_plan(request).await.unwrap_err();
            assert_eq!(Rejected::from_status(&status).unwrap().reason, Reason::MessageTooLarge);
        }
    })
    .await;
    // Client and server share this process: one message being sent is there at a time, in a few copies.
    let grown = resident().saturating_sub(before);
    assert!(grown < 200 << 20, "{} MiB more than before", grown >> 20);
}

/// More large requests at once than there is room for: those beyond it are shed with the time to wait, whoever waits so long is served,
/// and the axis does not notice.
#[tokio::test(flavor = "multi_thread")]
async fn an_overload_is_shed() {
    let mut config = server::Config::loopback();
    config.serving.max_concurrent_requests = 4;
    let server = Loopback::with(config).await;
    let planner = server.planner().await;
    let before = resident();
    moved_under(&server, async move {
        let calls = (0..64).map(|_| {
            let mut planner = planner.clone();
            tokio::spawn(async move {
                let mut shed = 0_u32;
                while let Err(status) = planner.plan_pvt(table()).await {
                    let rejected = Rejected::from_status(&status).expect("a reason");
                    assert_eq!(rejected.reason, Reason::Overloaded, "{status:?}");
                    let wait = status.get_details_retry_info().and_then(|info| info.retry_delay);
                    let wait = wait.expect("the time to wait, as clients of other languages read it");
                    assert!(wait > Duration::ZERO && wait <= Duration::from_secs(1), "{wait:?}");
                    shed += 1;
                    tokio::time::sleep_until(tokio::time::Instant::now() + wait).await;
                }
                shed
            })
        });
        let calls: Vec<_> = calls.collect();
        let mut shed = 0;
        for call in calls {
            shed += tokio::time::timeout(AMPLE, call).await.expect("it is served in the end").unwrap();
        }
        assert!(shed >= 60, "of 64 at once at most 4 find room: {shed}");
    })
    .await;
    let grown = resident().saturating_sub(before);
    assert!(grown < 200 << 20, "{} MiB more than before", grown >> 20);
}

/// A table of a thousand points there and back, at which a core works for a millisecond or so.
fn table() -> pb::PlanPvtRequest {
    let points = 1..=1000;
    let axis = pb::PvtAxis {
        axis: "x".into(),
        kind: pb::AxisKind::Prismatic.into(),
        times: points.clone().map(|point| 0.2 * f64::from(point)).collect(),
        positions: points.clone().map(|point| if point % 2 == 1 { 0.01 } else { 0.0 }).collect(),
        velocities: points.map(|_| 0.0).collect(),
        limits: pb::PlanRequest::from(move_of(0.5, 0.25)).axes[0].limits.clone(),
        ..Default::default()
    };
    pb::PlanPvtRequest {
        axes: vec![axis],
        policy: pb::PvtPolicy::PreferVelocity.into(),
        interpolation: pb::PvtInterpolation::SShaped.into(),
        ..Default::default()
    }
}

/// What this process holds in memory [bytes]. Source: proc_pid_statm(5).
fn resident() -> usize {
    let statm = std::fs::read_to_string("/proc/self/statm").unwrap();
    statm.split(' ').nth(1).unwrap().parse::<usize>().unwrap() * 4096
}
