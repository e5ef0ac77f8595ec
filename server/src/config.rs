use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

/// Everything that can be set, with its default.
#[derive(Clone, Debug, PartialEq)]
pub struct Config {
    /// Where to listen; port 0 takes any free one.
    pub listen: SocketAddr,
    /// The name by which axes know this replica; unset: its address.
    pub served_by: Option<String>,
    /// Serve other machines without encryption?
    pub insecure: bool,
    /// How long streams may take to end after the signal to stop \[s\].
    pub drain_deadline: Duration,
    /// The most streams at a time.
    pub max_streams: usize,
    /// The largest message, in either direction \[bytes\].
    pub max_message_bytes: usize,
    /// The farthest cycle that `SamplePlan` gives: its digest is rolled from cycle 1.
    pub max_sample_cycles: u64,
    /// What a stream may hold unread \[bytes\].
    pub stream_window_bytes: u32,
    /// What a connection may hold unread \[bytes\].
    pub connection_window_bytes: u32,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, 50051)),
            served_by: None,
            insecure: false,
            drain_deadline: Duration::from_secs(10),
            max_streams: 10_000,
            max_message_bytes: 16 << 20,
            // Ten hours at 1 ms.
            max_sample_cycles: 36_000_000,
            stream_window_bytes: 4 << 20,
            connection_window_bytes: 16 << 20,
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
    /// A server on any free port of this machine.
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
