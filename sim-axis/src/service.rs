use std::net::SocketAddr;
use std::time::Duration;

use tokio::net::TcpListener;
use tokio_util::sync::CancellationToken;
use tonic::transport::server::TcpIncoming;

use crate::config::{Config, ConfigError};
use crate::rpc::{self, Face};

/// A simulator that has its port and does not serve yet.
#[derive(Debug)]
pub struct SimAxis {
    config: Config,
    listener: TcpListener,
    address: SocketAddr,
}

/// Why a simulator cannot run.
#[derive(Debug, thiserror::Error)]
pub enum SimAxisError {
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

impl SimAxis {
    /// Takes the port.
    ///
    /// # Errors
    /// An address that may not be served without encryption, or that is taken.
    pub async fn bind(config: Config) -> Result<Self, SimAxisError> {
        config.check()?;
        let address = config.listen;
        let bind_error = |cause| SimAxisError::Bind { address, cause };
        let listener = TcpListener::bind(address).await.map_err(bind_error)?;
        let address = listener.local_addr().map_err(bind_error)?;
        Ok(Self { config, listener, address })
    }

    /// Where the simulator listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Serves until `stop` completes; then takes no new run, lets each end, and leaves at the drain deadline whatever is
    /// still going on.
    ///
    /// # Errors
    /// Failures of the transport.
    pub async fn run(self, stop: impl Future<Output = ()> + Send + 'static) -> Result<(), SimAxisError> {
        let Self { config, listener, address } = self;
        let drain = CancellationToken::new();
        let service = rpc::service(&config, drain.clone());
        let (health, health_service) = tonic_health::server::health_reporter();
        health.set_serving::<Face>().await;
        let reflection = || {
            tonic_reflection::server::Builder::configure()
                .register_encoded_file_descriptor_set(proto::FILE_DESCRIPTOR_SET)
                .register_encoded_file_descriptor_set(tonic_health::pb::FILE_DESCRIPTOR_SET)
        };
        let router = tonic::transport::Server::builder()
            .http2_keepalive_interval(Some(KEEPALIVE_INTERVAL))
            .http2_keepalive_timeout(Some(KEEPALIVE_TIMEOUT))
            .add_service(health_service)
            .add_service(reflection().build_v1()?)
            .add_service(reflection().build_v1alpha()?)
            .add_service(service);

        tracing::info!(%address, "serving");
        let stopping = drain.clone();
        let drain_then_stop = async move {
            stop.await;
            tracing::info!("draining: no new runs");
            health.set_not_serving::<Face>().await;
            stopping.cancel();
        };
        let incoming = TcpIncoming::from(listener).with_nodelay(Some(true));
        let serving = router.serve_with_incoming_shutdown(incoming, drain_then_stop);
        let deadline = async {
            drain.cancelled().await;
            #[expect(clippy::disallowed_methods, reason = "the deadline of the drain is a time by itself")]
            tokio::time::sleep(config.drain_deadline).await;
        };
        tokio::select! {
            served = serving => served?,
            () = deadline => tracing::warn!(
                deadline_s = config.drain_deadline.as_secs_f64(),
                "runs are still going on at the deadline, leaving"
            ),
        }
        Ok(())
    }
}

/// How often a silent connection is asked whether it is still there, and how long it may take to answer: the runs of a
/// caller that is gone end.
const KEEPALIVE_INTERVAL: Duration = Duration::from_secs(10);
const KEEPALIVE_TIMEOUT: Duration = Duration::from_secs(5);
