//! The HTTP port beside gRPC: health, readiness and figures, as probes and Prometheus ask for them.

use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

use e2e::{Loopback, LoopbackAxis, fifty_millimetres, planned};
use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tonic::transport::Endpoint;
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_check_response::ServingStatus;
use tonic_health::pb::health_client::HealthClient;

fn free_port() -> Option<SocketAddr> {
    Some(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)))
}

async fn server() -> Loopback {
    let mut config = server::Config::loopback();
    config.serving.http = free_port();
    Loopback::with(config).await
}

async fn get(page: String) -> (u16, String) {
    let answer = reqwest::get(page).await.unwrap();
    (answer.status().as_u16(), answer.text().await.unwrap())
}

#[tokio::test]
async fn both_processes_say_that_they_are_alive_and_ready() {
    let mut config = sim_axis::Config::loopback();
    config.serving.http = free_port();
    let (server, axis) = (server().await, LoopbackAxis::with(config).await);
    for page in [server.page(""), axis.page("")] {
        let ask = |path: &str| get(format!("{page}{path}"));
        assert_eq!(ask("/healthz").await, (200, "alive\n".to_owned()));
        assert_eq!(ask("/readyz").await, (200, "ready\n".to_owned()));
        assert_eq!(ask("/nowhere").await.0, 404);
        assert_eq!(ask("/metrics").await.0, 200);
    }
}

/// Probes know no certificates, and ask here.
#[tokio::test]
async fn the_health_service_answers_here_too() {
    let server = server().await;
    let channel = Endpoint::from_shared(server.page("")).unwrap().connect().await.unwrap();
    let request = HealthCheckRequest { service: "motion.v1.PlannerService".into() };
    let answer = HealthClient::new(channel).check(request).await.unwrap().into_inner();
    assert_eq!(answer.status(), ServingStatus::Serving);
}

/// Alive to the end, and not ready from the signal on.
#[tokio::test]
async fn a_server_that_drains_is_alive_and_not_ready() {
    let mut server = server().await;
    let client = server.client().await;
    let opened = client::Setpoints::open(&client, e2e::open("x", planned(fifty_millimetres()))).await;
    let mut stream = opened.unwrap();
    server.tell_to_stop();
    while stream.take_events().is_empty() {
        assert!(stream.next().await.unwrap().is_some(), "the stream ended without being told");
    }
    let (code, said) = get(server.page("/readyz")).await;
    assert_eq!((code, said.starts_with("draining")), (503, true), "{said}");
    assert_eq!(get(server.page("/healthz")).await.0, 200);
    while stream.next().await.unwrap().is_some() {}
    drop((stream, client));
    server.stopped().await;
}

/// A head that never ends is waited for ten seconds, and others are answered meanwhile.
#[tokio::test]
async fn a_slow_head_holds_up_nobody_and_is_left() {
    let server = server().await;
    let address = server.page("").trim_start_matches("http://").to_owned();
    let mut slow = tokio::net::TcpStream::connect(address).await.unwrap();
    slow.write_all(b"GET /healthz HTTP/1.1\r\nHost: slo").await.unwrap();
    assert_eq!(get(server.page("/healthz")).await.0, 200);
    let mut rest = Vec::new();
    let ended = tokio::time::timeout(Duration::from_secs(30), slow.read_to_end(&mut rest)).await;
    assert!(ended.is_ok(), "the connection is still open");
}
