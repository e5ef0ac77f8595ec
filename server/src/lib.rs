//! The planner and the setpoint streams over gRPC.
//!
//! `Config` → [`Server::bind`] (so the port is known) → [`Server::run`] until told to stop. Tests and the command-line
//! tool call the same three.
//!
//! - `rpc`: the services; each handler is translation around one call
//! - [`session`]: what one stream does, decided without a clock or a task
//! - `limits`, `figures`: how large and how many, and what is told of it
//! - `drive`: the loop between the world and a session
//! - `watch`: who looks on
//! - `console`: pages for people, on the side port

mod config;
mod console;
mod drive;
mod figures;
mod limits;
mod rpc;
pub mod session;
mod streams;
mod watch;

use std::net::SocketAddr;

use proto::pb::planner_service_server::PlannerServiceServer;
use proto::pb::setpoint_service_server::SetpointServiceServer;
use serving::{Bound, Caller, Leaving, Services};

pub use config::Config;
use console::Console;
use figures::Figures;
pub use limits::Limits;
use rpc::{Planner, Setpoints};
pub use serving::{Address, Misfits, ServeError, Settings};
use streams::Streams;
use watch::Board;

/// What a replica is called that has no name. All that listen on every address of their machine have the same one, so there it is the machine's
/// name that tells them apart.
fn name_of(address: &Address) -> String {
    let Some(port) = address.port().filter(|_| address.is_everywhere()) else { return address.to_string() };
    let host = std::env::var("HOSTNAME").or_else(|_| std::fs::read_to_string("/etc/hostname"));
    match host.as_deref().map(str::trim) {
        Ok(host) if planner::wrong_name(host).is_none() => format!("{host}:{port}"),
        _ => address.to_string(),
    }
}

/// A server that has its port and does not serve yet.
#[derive(Debug)]
pub struct Server {
    config: Config,
    bound: Bound,
}

impl Server {
    /// Takes the port.
    ///
    /// # Errors
    /// Settings that cannot be, all of them, and a port that is taken.
    pub async fn bind(config: Config) -> Result<Self, ServeError> {
        let config = config.misfits().into_result(config)?;
        let bound = Bound::to(config.serving.clone()).await?;
        Ok(Self { config, bound })
    }

    /// Where the server listens.
    #[must_use]
    pub fn address(&self) -> &Address {
        self.bound.address()
    }

    /// Where its side port is, where it has one.
    #[must_use]
    pub fn http_address(&self) -> Option<SocketAddr> {
        self.bound.http_address()
    }

    /// Serves until `stop` completes; then tells every stream, lets each end, and leaves at the drain deadline whatever is
    /// still open. The axes' own buffers make that safe.
    ///
    /// # Errors
    /// Failures of the transport.
    pub async fn run(self, stop: impl Future<Output = ()> + Send + 'static) -> Result<(), ServeError> {
        let Self { config, bound } = self;
        let served_by = config.served_by.clone().unwrap_or_else(|| name_of(bound.address()));
        let leaving = Leaving::default();
        let figures = Figures::resolve();
        let streams = Streams::new(config.limits, figures.clone());
        // The frame refuses larger ones, with a reason; below it nothing else is to.
        let size = config.serving.max_message_bytes;
        let board = Board::recorded_in(config.record.as_deref());
        let planner = Planner::new(config.limits, size, figures, leaving.clone());
        let setpoints = Setpoints::new(streams, board.clone(), served_by, leaving.clone());
        let caller = Caller::without_a_name(config.serving.policy.clone());
        let console = Console {
            planner: planner.clone(),
            setpoints: setpoints.clone(),
            board,
            leaving: leaving.clone(),
            caller,
        };
        let pages = console.pages(&config.console_hosts, size);
        let (planner, setpoints) =
            (PlannerServiceServer::new(planner), SetpointServiceServer::new(setpoints));
        let services = Services::of_schema(proto::FILE_DESCRIPTOR_SET)
            .with(planner.max_decoding_message_size(size))
            .with(setpoints.max_decoding_message_size(size))
            .with_pages(pages);
        bound.serve(services, leaving, stop).await
    }
}
