use std::borrow::Cow;
use std::fmt;
use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

use tonic::codegen::http::HeaderValue;

use crate::address::Address;
use crate::policy::Policy;
use crate::tls::Tls;

/// What can be set in every serving process.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Where to listen: at a port, of which 0 takes any free one, or at a Unix socket.
    pub listen: Address,
    /// Where the side port listens, for probes, figures and pages; `None`: nowhere. It is not encrypted.
    pub http: Option<SocketAddr>,
    /// Serve other machines without encryption?
    pub insecure: bool,
    /// Encryption, and by whom callers are vouched for; `None`: none.
    pub tls: Option<Tls>,
    /// Who may do what; `None`: whoever is let in, everything.
    pub policy: Option<Policy>,
    /// Tell tools what is served?
    pub reflection: bool,
    /// Answer browsers, which speak gRPC-Web over HTTP/1.1?
    pub grpc_web: bool,
    /// Pages of which origins may call, as `https://console.plant`; `*`: those of any.
    pub cors_origins: Vec<String>,
    /// How long work may take to end after the signal to stop.
    pub drain_deadline: Duration,
    /// The largest message, in either direction \[bytes\].
    pub max_message_bytes: usize,
    /// What a stream may hold unread \[bytes\].
    pub stream_window_bytes: u32,
    /// What a connection may hold unread \[bytes\].
    pub connection_window_bytes: u32,
    /// Connections at a time.
    pub max_connections: usize,
    /// Calls that wait for their answers at a time; open streams are not counted.
    pub max_concurrent_requests: usize,
    /// Calls that each identity may begin \[1/s\]; 0: as many as it likes.
    pub max_request_rate: u32,
    /// From a call to its first message; 0: for ever.
    pub first_message_deadline: Duration,
    /// From one message of a stream to the next; 0: for ever.
    pub idle_deadline: Duration,
    /// How often a silent connection is asked whether it is still there.
    pub keepalive_interval: Duration,
    /// How long it may take to answer that; also, to say something after it has connected.
    pub keepalive_timeout: Duration,
}

impl Settings {
    /// The defaults, listening on `port` of this machine alone.
    #[must_use]
    pub fn on_port(port: u16) -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, port)).into(),
            http: None,
            insecure: false,
            tls: None,
            policy: None,
            reflection: true,
            grpc_web: false,
            cors_origins: Vec::new(),
            drain_deadline: Duration::from_secs(10),
            max_message_bytes: proto::MAX_MESSAGE_BYTES,
            // Larger than any lead, so that credit does the pacing and never a window.
            stream_window_bytes: 4 << 20,
            connection_window_bytes: 16 << 20,
            max_connections: 10_000,
            // A few milliseconds of work for a core: more would only wait, and streams with it.
            max_concurrent_requests: 1024,
            max_request_rate: 0,
            first_message_deadline: Duration::from_secs(10),
            // An axis reports every batch; one that says nothing for ten minutes has been forgotten.
            idle_deadline: Duration::from_mins(10),
            // Half-open connections end, and the work for them.
            keepalive_interval: Duration::from_secs(10),
            keepalive_timeout: Duration::from_secs(5),
        }
    }

    /// Everything that cannot be.
    #[must_use]
    pub fn misfits(&self) -> Misfits {
        let mut misfits = Misfits::default();
        let listen = Some(self.listen.clone()).filter(|_| self.tls.is_none());
        let plain = [("listen", listen), ("http", self.http.map(Address::from))];
        for (setting, address) in plain {
            let Some(address) = address.filter(|address| !self.insecure && !address.is_local()) else {
                continue;
            };
            let way_out = match setting {
                "listen" => {
                    "listen on 127.0.0.1, give --tls-cert and --tls-key, or pass --insecure on a network of your own"
                }
                _ => "listen on 127.0.0.1, or pass --insecure where only those reach it who may",
            };
            let problem =
                format!("is {address}, which other machines reach, and there is no encryption: {way_out}");
            misfits.note(setting, problem);
        }
        if let Some(problem) = self.tls.as_ref().and_then(Tls::problem) {
            misfits.note("tls-cert", problem);
        }
        if self.policy.is_some() && !self.tls.as_ref().is_some_and(Tls::knows_callers) {
            let problem = "says who may do what, and nothing says who calls: give --tls-client-ca as well";
            misfits.note("policy", problem);
        }
        for origin in &self.cors_origins {
            let is_origin = origin == "*"
                || (origin
                    .split_once("://")
                    .is_some_and(|(_, host)| !host.is_empty() && !host.contains('/'))
                    && HeaderValue::from_str(origin).is_ok());
            if !is_origin {
                let problem = format!(
                    "has {origin:?}, which is no origin: write https://HOST or https://HOST:PORT, or *"
                );
                misfits.note("cors-origins", problem);
            }
        }
        if !self.cors_origins.is_empty() && !self.grpc_web {
            misfits.note("cors-origins", "are given, and browsers are not answered: pass --grpc-web as well");
        }
        for (setting, count, usual) in [
            ("max-message-bytes", self.max_message_bytes, 64 << 20),
            ("max-connections", self.max_connections, 10_000),
            ("max-concurrent-requests", self.max_concurrent_requests, 1024),
        ] {
            if count == 0 {
                misfits.note(setting, format!("is 0, so that nothing could be asked: {usual} is usual"));
            }
        }
        for (setting, time) in
            [("keepalive-interval", self.keepalive_interval), ("keepalive-timeout", self.keepalive_timeout)]
        {
            if time.is_zero() {
                misfits.note(
                    setting,
                    "is 0, so that every connection would be taken for dead: give seconds above 0",
                );
            }
        }
        let largest = MOST_WINDOW_BYTES;
        for (setting, given) in [
            ("stream-window-bytes", self.stream_window_bytes),
            ("connection-window-bytes", self.connection_window_bytes),
        ] {
            if given == 0 || given > largest {
                misfits.note(setting, format!("is {given}: give 1 to {largest}"));
            }
        }
        misfits
    }
}

/// What HTTP/2 allows. Source: RFC 9113, §6.9.1.
const MOST_WINDOW_BYTES: u32 = (1 << 31) - 1;

/// One setting that cannot be.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misfit {
    /// Its name on the command line, without the dashes.
    pub setting: Cow<'static, str>,
    /// What was given, what is allowed, and the way out.
    pub problem: String,
}

/// All settings that cannot be.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Misfits(Vec<Misfit>);

impl Misfits {
    /// Adds one.
    pub fn note(&mut self, setting: impl Into<Cow<'static, str>>, problem: impl Into<String>) {
        self.0.push(Misfit { setting: setting.into(), problem: problem.into() });
    }

    /// Adds all of `others`.
    pub fn extend(&mut self, others: Self) {
        self.0.extend(others.0);
    }

    /// All of them, in the order in which they were found.
    #[must_use]
    pub fn as_slice(&self) -> &[Misfit] {
        &self.0
    }

    /// `value`, if there is none.
    ///
    /// # Errors
    /// `self`, if there is one.
    pub fn into_result<T>(self, value: T) -> Result<T, Self> {
        if self.0.is_empty() { Ok(value) } else { Err(self) }
    }
}

impl fmt::Display for Misfits {
    /// A line for each.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, Misfit { setting, problem }) in self.0.iter().enumerate() {
            let separator = if index == 0 { "" } else { "\n" };
            write!(f, "{separator}{setting} {problem}")?;
        }
        Ok(())
    }
}

impl std::error::Error for Misfits {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_that_cannot_be_is_said_at_once() {
        assert_eq!(Settings::on_port(0).misfits(), Misfits::default());
        let listen = Address::from(SocketAddr::from((Ipv4Addr::UNSPECIFIED, 50051)));
        let wrong = Settings {
            listen: listen.clone(),
            max_message_bytes: 0,
            connection_window_bytes: 0,
            ..Settings::on_port(0)
        };
        assert_eq!(
            wrong.misfits().to_string(),
            "listen is 0.0.0.0:50051, which other machines reach, and there is no encryption: listen on 127.0.0.1, give \
             --tls-cert and --tls-key, or pass --insecure on a network of your own\n\
             max-message-bytes is 0, so that nothing could be asked: 67108864 is usual\n\
             connection-window-bytes is 0: give 1 to 2147483647"
        );
        let allowed = Settings { listen, insecure: true, ..Settings::on_port(0) };
        assert_eq!(allowed.misfits().into_result(7), Ok(7));
        // Nobody reaches a Unix socket from elsewhere.
        let listen = Address::Unix("/run/portamento.sock".into());
        assert_eq!(Settings { listen, ..Settings::on_port(0) }.misfits(), Misfits::default());
    }
}
