//! The side port: plain HTTP for people, probes and Prometheus, beside the port that serves gRPC.
//!
//! | path | answers |
//! |---|---|
//! | `/healthz` | 200 as long as the process can answer: restart it where this fails |
//! | `/readyz` | 200 while new work is taken, 503 from the signal to stop on: send new work elsewhere |
//! | `/metrics` | figures in Prometheus's text format |
//! | `/grpc.health.v1.Health/*` | the health service over HTTP/2 without encryption, for probes that know no certificates |
//!
//! What a process shows to people beside these it adds with [`Services::with_pages`](crate::Services::with_pages).

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::http::{StatusCode, header};
use axum::response::IntoResponse;
use axum::routing::get;
use hyper_util::rt::{TokioExecutor, TokioIo, TokioTimer};
use hyper_util::server::conn::auto;
use hyper_util::service::TowerToHyperService;
use tokio::net::TcpListener;
use tokio::sync::Semaphore;
use tokio::task::JoinSet;

use crate::leaving::Leaving;
use crate::telemetry;

/// A side port that is taken and not served yet.
#[derive(Debug)]
pub(crate) struct SidePort {
    listener: TcpListener,
    address: SocketAddr,
}

/// Connections at a time: some scrapers and probes, and the people of a shift. More are closed as they come.
const MOST_CONNECTIONS: usize = 256;
/// How long the head of a request may take to come, and a connection may be silent between two.
const HEAD: Duration = Duration::from_secs(10);

impl SidePort {
    pub(crate) async fn to(address: SocketAddr) -> std::io::Result<Self> {
        let listener = TcpListener::bind(address).await?;
        let address = listener.local_addr()?;
        Ok(Self { listener, address })
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.address
    }

    /// Serves until it is dropped, and every connection with it.
    pub(crate) async fn serve(self, router: Router) {
        let Self { listener, address } = self;
        tracing::info!(%address, "serving HTTP");
        let room = Arc::new(Semaphore::new(MOST_CONNECTIONS));
        let mut connections = JoinSet::new();
        loop {
            let socket = tokio::select! {
                accepted = listener.accept() => match accepted {
                    Ok((socket, _)) => socket,
                    // One that has gone already, or no descriptors left: others end, and then there are some.
                    Err(error) => {
                        tracing::debug!(%error, "a connection was not accepted");
                        tokio::task::yield_now().await;
                        continue;
                    }
                },
                Some(_) = connections.join_next() => continue,
            };
            let Ok(place) = Arc::clone(&room).try_acquire_owned() else { continue };
            let service = TowerToHyperService::new(router.clone());
            connections.spawn(async move {
                let _ = socket.set_nodelay(true);
                let mut builder = auto::Builder::new(TokioExecutor::new());
                builder.http1().timer(TokioTimer::new()).header_read_timeout(HEAD);
                builder.http2().timer(TokioTimer::new()).keep_alive_interval(HEAD).keep_alive_timeout(HEAD);
                // A peer that breaks off is no failure of ours.
                let _ = builder.serve_connection_with_upgrades(TokioIo::new(socket), service).await;
                drop(place);
            });
        }
    }
}

/// What every process answers on its side port, and `pages`.
pub(crate) fn router(pages: Router, health: Router, leaving: &Leaving) -> Router {
    let leaving = leaving.clone();
    let ready = move || {
        let answer = if leaving.has_begun() {
            (StatusCode::SERVICE_UNAVAILABLE, "draining: no new work is taken\n")
        } else {
            (StatusCode::OK, "ready\n")
        };
        std::future::ready(answer)
    };
    let figures = || std::future::ready(([(header::CONTENT_TYPE, PROMETHEUS)], telemetry::figures()));
    // The health service would answer whatever it does not know as gRPC does.
    pages
        .merge(health.reset_fallback())
        .route("/healthz", get(|| std::future::ready("alive\n")))
        .route("/readyz", get(ready))
        .route("/metrics", get(figures))
        .fallback(|| std::future::ready(nothing_here().into_response()))
}

fn nothing_here() -> (StatusCode, &'static str) {
    (StatusCode::NOT_FOUND, "nothing is here: /healthz, /readyz and /metrics are\n")
}

/// Source: "Prometheus exposition formats", text format, basic info.
const PROMETHEUS: &str = "text/plain; version=0.0.4; charset=utf-8";
