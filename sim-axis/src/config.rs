use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

use crate::models::Models;

/// Everything that can be set, with its default.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Where to listen; port 0 takes any free one.
    pub listen: SocketAddr,
    /// Serve other machines without encryption?
    pub insecure: bool,
    /// The axes of this process.
    pub models: Models,
    /// How long runs may take to end after the signal to stop.
    pub drain_deadline: Duration,
    /// The most runs at a time: each has a thread of its own.
    pub max_runs: usize,
    /// The largest request [bytes].
    pub max_message_bytes: usize,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 50052)),
            insecure: false,
            models: Models::default(),
            drain_deadline: Duration::from_secs(10),
            max_runs: 64,
            max_message_bytes: 16 << 20,
        }
    }
}

/// A setting that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ConfigError {
    /// An address that other machines reach.
    #[error(
        "listen is {0}, which other machines reach, and there is no encryption: listen on 127.0.0.1, or pass \
         --insecure on a network of your own"
    )]
    Insecure(SocketAddr),
}

impl Config {
    /// An axis on any free port of this machine.
    #[must_use]
    pub fn loopback() -> Self {
        Self { listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 0)), ..Self::default() }
    }

    /// Is there anything that cannot be?
    ///
    /// # Errors
    /// An address that other machines reach, without `insecure`.
    pub fn check(&self) -> Result<(), ConfigError> {
        if !self.insecure && !self.listen.ip().is_loopback() {
            return Err(ConfigError::Insecure(self.listen));
        }
        Ok(())
    }
}
