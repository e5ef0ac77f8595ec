//! A server of this process that can be killed.

use server::{Config, Server};
use tokio::runtime::{Builder, Runtime};

use crate::failure::Failure;

/// A server in a runtime of its own, on a free port of this machine.
#[derive(Debug)]
pub(crate) struct Replica {
    /// There until it is dropped.
    runtime: Option<Runtime>,
    endpoint: String,
}

impl Replica {
    /// Starts to serve under `name`. Not from within another runtime.
    pub(crate) fn start(name: &str) -> Result<Self, Failure> {
        let internal = |error: &dyn std::error::Error| Failure::Internal(error.to_string());
        let runtime = Builder::new_multi_thread().worker_threads(1).enable_all().build();
        let runtime = runtime.map_err(|error| internal(&error))?;
        let config = Config { served_by: Some(name.into()), ..Config::loopback() };
        let server = runtime.block_on(Server::bind(config)).map_err(|error| internal(&error))?;
        let endpoint = server.address().endpoint();
        runtime.spawn(server.run(std::future::pending()));
        Ok(Self { runtime: Some(runtime), endpoint })
    }

    pub(crate) fn endpoint(&self) -> String {
        self.endpoint.clone()
    }

    /// Ends it without a word, as a process ends that is killed: its connections are cut where they are.
    pub(crate) fn kill(self) {
        drop(self);
    }
}

impl Drop for Replica {
    /// A runtime that is dropped waits for its tasks, which another runtime does not allow.
    fn drop(&mut self) {
        self.runtime.take().into_iter().for_each(Runtime::shutdown_background);
    }
}
