//! The planner and the setpoint streams over gRPC.
//!
//! `Config` → [`Server::bind`] (so the port is known) → [`Server::run`] until told to stop. Tests and the command-line
//! tool call the same three.
//!
//! - `rpc`: the services; each handler is translation around one call
//! - [`session`]: what one stream does, decided without a clock or a task
//! - `drive`: the loop between the world and a session

mod config;
mod drive;
mod rpc;
pub mod session;
mod streams;

use std::net::SocketAddr;
use std::time::Duration;

use proto::pb::planner_service_server::PlannerServiceServer;
use proto::pb::setpoint_service_server::SetpointServiceServer;
use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tonic::transport::server::TcpIncoming;

pub use config::{Config, ConfigError};
use rpc::{Planner, Setpoints};
use streams::Streams;

/// A server that has its port and does not serve yet.
#[derive(Debug)]
pub struct Server {
    config: Config,
    listener: TcpListener,
    address: SocketAddr,
}

/// Why a server cannot run.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The configuration is not one.
    #[error(transparent)]
    Config(#[from] ConfigError),
    /// The port cannot be had.
    #[error("cannot listen on {address}: {cause}; choose another with --listen")]
    Bind {
        /// The address.
        address: SocketAddr,
        /// What the system says.
        cause: std::io::Error,
    },
    /// Serving failed.
    #[error("cannot serve: {0}")]
    Serve(#[from] tonic::transport::Error),
    /// The reflection service cannot read the schema.
    #[error("cannot offer reflection: {0}")]
    Reflection(#[from] tonic_reflection::server::Error),
}

impl Server {
    /// Takes the port.
    ///
    /// # Errors
    /// An address that may not be served without encryption, or that is taken.
    pub async fn bind(config: Config) -> Result<Self, ServerError> {
        config.check()?;
        let address = config.listen;
        let bind_error = |cause| ServerError::Bind { address, cause };
        let listener = TcpListener::bind(address).await.map_err(bind_error)?;
        let address = listener.local_addr().map_err(bind_error)?;
        Ok(Self { config, listener, address })
    }

    /// Where the server listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Serves until `stop` completes; then tells every stream, lets each end, and leaves at the drain deadline whatever is
    /// still open. The axes' own buffers make that safe.
    ///
    /// # Errors
    /// Failures of the transport.
    pub async fn run(self, stop: impl Future<Output = ()> + Send + 'static) -> Result<(), ServerError> {
        let Self { config, listener, address } = self;
        let served_by = config.served_by.clone().unwrap_or_else(|| address.to_string());
        let leaving = Leaving::default();
        let streams = Streams::new(config.max_streams);
        let size = config.max_message_bytes;
        let planner = PlannerServiceServer::new(Planner::new(config.max_sample_cycles))
            .max_decoding_message_size(size)
            .max_encoding_message_size(size);
        let setpoints = SetpointServiceServer::new(Setpoints::new(streams, served_by, leaving.clone()))
            .max_decoding_message_size(size)
            .max_encoding_message_size(size);

        let (health, health_service) = tonic_health::server::health_reporter();
        health.set_serving::<PlannerServiceServer<Planner>>().await;
        health.set_serving::<SetpointServiceServer<Setpoints>>().await;
        let reflection = || {
            tonic_reflection::server::Builder::configure()
                .register_encoded_file_descriptor_set(proto::FILE_DESCRIPTOR_SET)
                .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
        };
        let router = tonic::transport::Server::builder()
            // Larger than any lead, so that credit does the pacing and never a window.
            .initial_stream_window_size(config.stream_window_bytes)
            .initial_connection_window_size(config.connection_window_bytes)
            .http2_keepalive_interval(Some(KEEPALIVE_INTERVAL))
            .http2_keepalive_timeout(Some(KEEPALIVE_TIMEOUT))
            .add_service(health_service)
            .add_service(reflection().build_v1()?)
            .add_service(reflection().build_v1alpha()?)
            .add_service(planner)
            .add_service(setpoints);

        tracing::info!(%address, "serving");
        let gone = CancellationToken::new();
        let leave = {
            let gone = gone.clone();
            async move {
                stop.await;
                tracing::info!("draining: no new streams, those that are open are told to move over");
                health.set_not_serving::<PlannerServiceServer<Planner>>().await;
                health.set_not_serving::<SetpointServiceServer<Setpoints>>().await;
                leaving.leave(config.drain_deadline).await;
                gone.cancel();
            }
        };
        let incoming = TcpIncoming::from(listener).with_nodelay(Some(true));
        let serving = router.serve_with_incoming_shutdown(incoming, leave);
        let farewell = async {
            gone.cancelled().await;
            #[expect(
                clippy::disallowed_methods,
                reason = "who does not close is waited for this long and no longer"
            )]
            tokio::time::sleep(FAREWELL).await;
        };
        tokio::select! {
            served = serving => served?,
            () = farewell => {}
        }
        Ok(())
    }
}

/// How a server leaves: it says so, and later it goes. Meanwhile it answers, so that whoever asks learns that it leaves.
#[derive(Clone, Debug, Default)]
struct Leaving {
    /// Streams are told to move over, and no new ones begin.
    soon: CancellationToken,
    /// The deadline has passed: what is still open ends.
    now: CancellationToken,
    /// What is open.
    streams: TaskTracker,
}

impl Leaving {
    /// Completes when every stream has ended, or a while after the deadline.
    async fn leave(self, deadline: Duration) {
        self.soon.cancel();
        self.streams.close();
        if tokio::time::timeout(deadline, self.streams.wait()).await.is_ok() {
            return;
        }
        tracing::warn!(
            deadline_s = deadline.as_secs_f64(),
            "streams are still open at the deadline, leaving"
        );
        self.now.cancel();
        // Long enough to say so; who does not listen is left.
        let _ = tokio::time::timeout(FAREWELL, self.streams.wait()).await;
    }
}

/// How long it may take to tell streams that they end at the deadline, and connections that they are closed.
const FAREWELL: Duration = Duration::from_millis(500);

/// How often a silent connection is asked whether it is still there, and how long it may take to answer: half-open
/// connections end, and their sessions with them.
const KEEPALIVE_INTERVAL: Duration = Duration::from_secs(10);
const KEEPALIVE_TIMEOUT: Duration = Duration::from_secs(5);
