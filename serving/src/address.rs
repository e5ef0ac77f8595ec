use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::str::FromStr;

/// Where a process listens.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Address {
    /// At a port of this machine; port 0 takes any free one.
    Tcp(SocketAddr),
    /// At a Unix socket, which only processes of this machine reach: those of its owner and his group.
    Unix(PathBuf),
}

impl Address {
    /// As whoever connects writes it: `http://127.0.0.1:50051`, or `unix:/run/portamento.sock`.
    #[must_use]
    pub fn endpoint(&self) -> String {
        match self {
            Self::Tcp(address) => format!("http://{address}"),
            Self::Unix(_) => self.to_string(),
        }
    }

    /// The port, of an address that has one.
    #[must_use]
    pub fn port(&self) -> Option<u16> {
        match self {
            Self::Tcp(address) => Some(address.port()),
            Self::Unix(_) => None,
        }
    }

    /// Is it every address of this machine?
    #[must_use]
    pub fn is_everywhere(&self) -> bool {
        matches!(self, Self::Tcp(address) if address.ip().is_unspecified())
    }

    /// Do only processes of this machine reach it?
    #[must_use]
    pub fn is_local(&self) -> bool {
        match self {
            Self::Tcp(address) => address.ip().is_loopback(),
            Self::Unix(_) => true,
        }
    }
}

impl From<SocketAddr> for Address {
    fn from(address: SocketAddr) -> Self {
        Self::Tcp(address)
    }
}

/// Why a text is no address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("give ADDRESS:PORT, as 127.0.0.1:50051, or unix:/PATH")]
pub struct InvalidAddress;

impl FromStr for Address {
    type Err = InvalidAddress;

    fn from_str(text: &str) -> Result<Self, InvalidAddress> {
        match text.strip_prefix("unix:") {
            // Relative to what would be a question of where the process was started.
            Some(path) if path.starts_with('/') && !path.ends_with('/') => Ok(Self::Unix(path.into())),
            Some(_) => Err(InvalidAddress),
            None => text.parse().map(Self::Tcp).map_err(|_| InvalidAddress),
        }
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(address) => address.fmt(f),
            Self::Unix(path) => write!(f, "unix:{}", path.display()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_read_is_written_the_same() {
        for (text, is_local, endpoint) in [
            ("127.0.0.1:50051", true, "http://127.0.0.1:50051"),
            ("0.0.0.0:1", false, "http://0.0.0.0:1"),
            ("[::1]:7", true, "http://[::1]:7"),
            ("unix:/run/portamento.sock", true, "unix:/run/portamento.sock"),
        ] {
            let address: Address = text.parse().unwrap();
            assert_eq!((&*address.to_string(), address.is_local()), (text, is_local));
            assert_eq!(address.endpoint(), endpoint);
        }
        for wrong in ["somewhere", "unix:", "unix:socket", "unix:/", "localhost", "/run/socket", ""] {
            assert_eq!(wrong.parse::<Address>(), Err(InvalidAddress), "{wrong:?}");
        }
    }
}
