use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use proto::TraceContext;
use tonic::service::Interceptor;
use tonic::transport::{Certificate, Channel, ClientTlsConfig, Endpoint, Identity};
use tonic::{Request, Status};

use crate::shared::Shared;
use crate::{Client, Error, address};

/// How to connect: with what encryption, and what a connection is held to. The same for every server of a list.
///
/// ```no_run
/// # async fn connect() -> Result<(), Box<dyn std::error::Error>> {
/// let connect = client::Connect::new()
///     .with_authority(std::fs::read("ca.pem")?)
///     .with_identity(std::fs::read("axis.pem")?, std::fs::read("axis.key")?);
/// let client = connect.to("https://planner.plant:50051").await?;
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Connect {
    tls: Arc<Tls>,
    timeout: Duration,
    keepalive_interval: Duration,
    keepalive_timeout: Duration,
    stream_window: u32,
    connection_window: u32,
    /// The connections of all clones of this; none where every client has its own.
    shared: Option<Arc<Shared>>,
}

#[derive(Clone, Default, PartialEq, Eq)]
struct Tls {
    authority: Option<Vec<u8>>,
    identity: Option<(Vec<u8>, Vec<u8>)>,
    server_name: Option<String>,
}

impl Default for Connect {
    fn default() -> Self {
        Self {
            tls: Arc::default(),
            timeout: Duration::from_secs(5),
            keepalive_interval: Duration::from_secs(10),
            keepalive_timeout: Duration::from_secs(5),
            // Larger than any lead, so that credit does the pacing and never a window.
            stream_window: 4 << 20,
            connection_window: 16 << 20,
            shared: None,
        }
    }
}

impl Connect {
    /// Without encryption, with limits that are usual.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Who vouches for servers, as PEM: needed for `https://`.
    #[must_use]
    pub fn with_authority(mut self, pem: impl Into<Vec<u8>>) -> Self {
        Arc::make_mut(&mut self.tls).authority = Some(pem.into());
        self.anew()
    }

    /// Who this side is: its certificate and its key, as PEM.
    #[must_use]
    pub fn with_identity(mut self, certificate: impl Into<Vec<u8>>, key: impl Into<Vec<u8>>) -> Self {
        Arc::make_mut(&mut self.tls).identity = Some((certificate.into(), key.into()));
        self.anew()
    }

    /// The name in the server's certificate, where it is not that of the endpoint.
    #[must_use]
    pub fn with_server_name(mut self, name: impl Into<String>) -> Self {
        Arc::make_mut(&mut self.tls).server_name = Some(name.into());
        self.anew()
    }

    /// How long a connection may take: 5 s where nothing is said.
    #[must_use]
    pub fn with_timeout(self, timeout: Duration) -> Self {
        Self { timeout, ..self }.anew()
    }

    /// How often a silent connection is asked whether it is still there, and how long it may take to answer: 10 s and 5 s
    /// where nothing is said.
    #[must_use]
    pub fn with_keepalive(self, interval: Duration, timeout: Duration) -> Self {
        Self { keepalive_interval: interval, keepalive_timeout: timeout, ..self }.anew()
    }

    /// Up to `streams` clients of the same server share a connection, of all that are made by this and its clones: for a gateway of
    /// many axes, whose messages then go out and come in together. What a network loses on the way holds up all of them, and a
    /// server takes up to 200 streams over one connection unless it says otherwise.
    #[must_use]
    pub fn shared_by(self, streams: usize) -> Self {
        Self { shared: Some(Arc::new(Shared::by(streams))), ..self }
    }

    /// With connections that nobody else uses.
    pub(crate) fn alone(&self) -> Self {
        Self { shared: None, ..self.clone() }
    }

    /// What is connected to otherwise is not shared with what was.
    fn anew(self) -> Self {
        let shared = self.shared.as_ref().map(|shared| Arc::new(shared.anew()));
        Self { shared, ..self }
    }

    /// Connects to the server at `endpoint`: `http://127.0.0.1:50051`, the same without the scheme, or `https://`.
    ///
    /// # Errors
    /// [`Error::Address`] where the address is none, or wants encryption and nobody vouches for servers;
    /// [`Error::Unreachable`] where nobody answers, or not who was expected.
    pub async fn to(&self, endpoint: &str) -> Result<Client, Error> {
        let place = self.shared.as_ref().map(|shared| shared.place(endpoint));
        let channel = match &place {
            Some(place) => place.channel(|| self.channel(endpoint)).await?,
            None => self.channel(endpoint).await?,
        };
        Ok(Client::over(self, endpoint, channel, place))
    }

    /// A connection of its own for services that this crate does not know.
    ///
    /// # Errors
    /// Those of [`to`](Self::to).
    pub async fn channel(&self, endpoint: &str) -> Result<Channel, Error> {
        let server = self.endpoint(endpoint)?;
        // Boxed, since it is some kilobytes, seldom needed, and would be part of whatever may connect.
        Box::pin(server.connect()).await.map_err(|error| Error::unreachable(endpoint, &error))
    }

    fn endpoint(&self, endpoint: &str) -> Result<Endpoint, Error> {
        let address = address(endpoint)?;
        let is_encrypted = address.uri().scheme_str() == Some("https");
        let address = address
            .connect_timeout(self.timeout)
            .initial_stream_window_size(self.stream_window)
            .initial_connection_window_size(self.connection_window)
            .http2_keep_alive_interval(self.keepalive_interval)
            .keep_alive_timeout(self.keepalive_timeout)
            .tcp_nodelay(true);
        if !is_encrypted {
            return Ok(address);
        }
        let invalid = |cause: String| Error::Address { endpoint: endpoint.into(), cause };
        let Tls { authority, identity, server_name } = &*self.tls;
        let Some(authority) = authority else {
            return Err(invalid("it is encrypted, and nobody is named who vouches for servers".into()));
        };
        let mut tls =
            ClientTlsConfig::new().ca_certificate(Certificate::from_pem(authority)).timeout(self.timeout);
        if let Some((certificate, key)) = identity {
            tls = tls.identity(Identity::from_pem(certificate, key));
        }
        if let Some(name) = server_name {
            tls = tls.domain_name(name);
        }
        address.tls_config(tls).map_err(|error| {
            invalid(format!("its encryption cannot be: {}", proto::unreachable(&error).message()))
        })
    }
}

impl PartialEq for Connect {
    /// To the same servers, by the same means: whether connections are shared is not asked.
    fn eq(&self, other: &Self) -> bool {
        let means = |it: &Self| {
            (it.timeout, it.keepalive_interval, it.keepalive_timeout, it.stream_window, it.connection_window)
        };
        self.tls == other.tls && means(self) == means(other)
    }
}

impl Eq for Connect {}

impl fmt::Debug for Connect {
    /// Without keys.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Tls { authority, identity, server_name } = &*self.tls;
        f.debug_struct("Connect")
            .field("has_authority", &authority.is_some())
            .field("has_identity", &identity.is_some())
            .field("server_name", server_name)
            .field("timeout", &self.timeout)
            .finish_non_exhaustive()
    }
}

/// Sends the trace that the calling task works for with every call.
#[derive(Clone, Copy, Debug, Default)]
pub struct Traced;

impl Interceptor for Traced {
    fn call(&mut self, mut request: Request<()>) -> Result<Request<()>, Status> {
        if let Some(header) = TraceContext::for_call().to_header() {
            request.metadata_mut().insert(TraceContext::HEADER, header);
        }
        Ok(request)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encryption_needs_somebody_who_vouches() {
        let refused = Connect::new().endpoint("https://planner:50051").unwrap_err().to_string();
        assert!(refused.contains("vouches"), "{refused}");
        assert!(Connect::new().endpoint("http://planner:50051").is_ok());
        let shown = format!("{:?}", Connect::new().with_identity("certificate", "secret"));
        assert!(shown.contains("has_identity: true") && !shown.contains("secret"), "{shown}");
    }
}
