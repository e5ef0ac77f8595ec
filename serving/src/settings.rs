use std::fmt;
use std::net::{Ipv4Addr, SocketAddr};
use std::time::Duration;

/// What can be set in every serving process.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Where to listen; port 0 takes any free one.
    pub listen: SocketAddr,
    /// Where the side port listens, for probes, figures and pages; `None`: nowhere.
    pub http: Option<SocketAddr>,
    /// Serve other machines without encryption?
    pub insecure: bool,
    /// How long work may take to end after the signal to stop.
    pub drain_deadline: Duration,
    /// The largest message, in either direction \[bytes\].
    pub max_message_bytes: usize,
    /// What a stream may hold unread \[bytes\].
    pub stream_window_bytes: u32,
    /// What a connection may hold unread \[bytes\].
    pub connection_window_bytes: u32,
}

impl Settings {
    /// The defaults, listening on `port` of this machine alone.
    #[must_use]
    pub fn on_port(port: u16) -> Self {
        Self {
            listen: SocketAddr::from((Ipv4Addr::LOCALHOST, port)),
            http: None,
            insecure: false,
            drain_deadline: Duration::from_secs(10),
            max_message_bytes: proto::MAX_MESSAGE_BYTES,
            // Larger than any lead, so that credit does the pacing and never a window.
            stream_window_bytes: 4 << 20,
            connection_window_bytes: 16 << 20,
        }
    }

    /// Everything that cannot be.
    #[must_use]
    pub fn misfits(&self) -> Misfits {
        let mut misfits = Misfits::default();
        for (setting, address) in [("listen", Some(self.listen)), ("http", self.http)] {
            let Some(address) = address.filter(|address| !self.insecure && !address.ip().is_loopback())
            else {
                continue;
            };
            misfits.note(
                setting,
                format!(
                    "is {address}, which other machines reach, and there is no encryption: listen on 127.0.0.1, or pass \
                     --insecure on a network of your own"
                ),
            );
        }
        if self.max_message_bytes == 0 {
            misfits.note("max-message-bytes", "is 0, so that no message could be read: 67108864 is usual");
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
    pub setting: &'static str,
    /// What was given, what is allowed, and the way out.
    pub problem: String,
}

/// All settings that cannot be.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Misfits(Vec<Misfit>);

impl Misfits {
    /// Adds one.
    pub fn note(&mut self, setting: &'static str, problem: impl Into<String>) {
        self.0.push(Misfit { setting, problem: problem.into() });
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
        let listen = SocketAddr::from((Ipv4Addr::UNSPECIFIED, 50051));
        let wrong =
            Settings { listen, max_message_bytes: 0, connection_window_bytes: 0, ..Settings::on_port(0) };
        assert_eq!(
            wrong.misfits().to_string(),
            "listen is 0.0.0.0:50051, which other machines reach, and there is no encryption: listen on 127.0.0.1, or \
             pass --insecure on a network of your own\n\
             max-message-bytes is 0, so that no message could be read: 67108864 is usual\n\
             connection-window-bytes is 0: give 1 to 2147483647"
        );
        let allowed = Settings { listen, insecure: true, ..Settings::on_port(0) };
        assert_eq!(allowed.misfits().into_result(7), Ok(7));
    }
}
