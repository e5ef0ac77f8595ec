use std::fmt;
use std::path::Path;
use std::time::Duration;

use tonic::transport::{Certificate, Identity, Server, ServerTlsConfig};

/// With what a process proves who it is, and by whom its callers have to be vouched for.
#[derive(Clone, PartialEq, Eq)]
pub struct Tls {
    certificate: Vec<u8>,
    key: Vec<u8>,
    client_ca: Option<Vec<u8>>,
}

impl Tls {
    /// From PEM: the certificate with those between it and its authority, its key, and the authorities of callers. With the
    /// last, whoever has no certificate of theirs is not let in.
    #[must_use]
    pub fn new(certificate: Vec<u8>, key: Vec<u8>, client_ca: Option<Vec<u8>>) -> Self {
        Self { certificate, key, client_ca }
    }

    /// From files.
    ///
    /// # Errors
    /// The setting whose file cannot be read, and what is wrong with it.
    pub fn read(
        certificate: &Path,
        key: &Path,
        client_ca: Option<&Path>,
    ) -> Result<Self, Vec<(&'static str, String)>> {
        let read = |setting, path: &Path| {
            std::fs::read(path).map_err(|error| {
                (setting, format!("{} cannot be read: {error}: name a PEM file", path.display()))
            })
        };
        let certificate = read("tls-cert", certificate);
        let key = read("tls-key", key);
        let client_ca = client_ca.map(|path| read("tls-client-ca", path)).transpose();
        match (certificate, key, client_ca) {
            (Ok(certificate), Ok(key), Ok(client_ca)) => Ok(Self { certificate, key, client_ca }),
            (certificate, key, client_ca) => {
                Err([certificate.err(), key.err(), client_ca.err()].into_iter().flatten().collect())
            }
        }
    }

    /// Are callers known by their certificates?
    #[must_use]
    pub fn knows_callers(&self) -> bool {
        self.client_ca.is_some()
    }

    pub(crate) fn config(&self) -> ServerTlsConfig {
        let Self { certificate, key, client_ca } = self;
        let config = ServerTlsConfig::new().identity(Identity::from_pem(certificate, key)).timeout(HANDSHAKE);
        match client_ca {
            Some(ca) => config.client_ca_root(Certificate::from_pem(ca)),
            None => config,
        }
    }

    /// What is wrong with it, as far as that can be told before anybody connects.
    pub(crate) fn problem(&self) -> Option<String> {
        let error = Server::builder().tls_config(self.config()).err()?;
        let cause = proto::unreachable(&error);
        Some(format!(
            "does not serve: {}: give a certificate and its key as PEM, and authorities that are certificates",
            cause.message()
        ))
    }
}

impl fmt::Debug for Tls {
    /// Without the key.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Tls").field("knows_callers", &self.knows_callers()).finish_non_exhaustive()
    }
}

/// How long a handshake may take.
const HANDSHAKE: Duration = Duration::from_secs(5);
