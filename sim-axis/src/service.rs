use std::net::SocketAddr;

use serving::{Address, Bound, Leaving, ServeError, Services};

use crate::config::Config;
use crate::rpc;

/// A simulator that has its port and does not serve yet.
#[derive(Debug)]
pub struct SimAxis {
    config: Config,
    bound: Bound,
}

impl SimAxis {
    /// Takes the port.
    ///
    /// # Errors
    /// Settings that cannot be, all of them, and a port that is taken.
    pub async fn bind(config: Config) -> Result<Self, ServeError> {
        let config = config.misfits().into_result(config)?;
        let bound = Bound::to(config.serving.clone()).await?;
        Ok(Self { config, bound })
    }

    /// Where the simulator listens.
    #[must_use]
    pub fn address(&self) -> &Address {
        self.bound.address()
    }

    /// Where its side port is, where it has one.
    #[must_use]
    pub fn http_address(&self) -> Option<SocketAddr> {
        self.bound.http_address()
    }

    /// Serves until `stop` completes; then takes no new run, lets each end, and leaves at the drain deadline whatever is
    /// still going on.
    ///
    /// # Errors
    /// Failures of the transport.
    pub async fn run(self, stop: impl Future<Output = ()> + Send + 'static) -> Result<(), ServeError> {
        let Self { config, bound } = self;
        let leaving = Leaving::default();
        let services =
            Services::of_schema(proto::FILE_DESCRIPTOR_SET).with(rpc::service(&config, leaving.clone()));
        bound.serve(services, leaving, stop).await
    }
}
