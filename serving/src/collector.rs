use std::str::FromStr;
use std::time::Duration;

use rustls_pki_types::CertificateDer;
use rustls_pki_types::pem::PemObject as _;
use tonic::transport::{Certificate, ClientTlsConfig, Endpoint};

/// Where spans go: an OpenTelemetry collector that takes OTLP over gRPC, as `http://127.0.0.1:4317` or `https://collector:4317`.
#[derive(Clone, Debug)]
pub(crate) struct Collector {
    endpoint: Endpoint,
    is_encrypted: bool,
}

impl FromStr for Collector {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let said = |problem: &str| format!("{problem}: write it as http://HOST:4317 or https://HOST:4317");
        let endpoint = Endpoint::from_str(text).map_err(|error| {
            let cause =
                std::error::Error::source(&error).map_or_else(|| error.to_string(), ToString::to_string);
            said(&cause)
        })?;
        let uri = endpoint.uri();
        let is_encrypted = match uri.scheme_str() {
            Some("http") => false,
            Some("https") => true,
            Some(scheme) => return Err(said(&format!("the scheme is {scheme}"))),
            None => return Err(said("it has no scheme")),
        };
        if uri.host().is_none_or(str::is_empty) {
            return Err(said("it names no host"));
        }
        if uri.path() != "/" || uri.query().is_some() {
            return Err(said("gRPC has its own path there, and takes no other"));
        }
        let endpoint = endpoint.connect_timeout(PATIENCE).timeout(PATIENCE);
        Ok(Self { endpoint, is_encrypted })
    }
}

impl Collector {
    /// With the authority, as PEM, that vouches for the collector where spans go to it encrypted.
    ///
    /// # Errors
    /// The setting that is wrong, and what: one of both without the other, and an authority that is none.
    pub(crate) fn vouched_for_by(self, authority: Option<Vec<u8>>) -> Result<Self, (&'static str, String)> {
        let Self { endpoint, is_encrypted } = self;
        match authority {
            None if is_encrypted => {
                let text = "is https, and nothing says who vouches for the collector: give --otlp-ca as well";
                Err(("otlp-endpoint", text.to_owned()))
            }
            Some(_) if !is_encrypted => {
                let text = "is given, and --otlp-endpoint is not encrypted: write that as https://HOST:4317";
                Err(("otlp-ca", text.to_owned()))
            }
            None => Ok(Self { endpoint, is_encrypted }),
            Some(pem) => {
                if !holds_authorities(&pem) {
                    let text = "does not serve: give certificates of authorities as PEM";
                    return Err(("otlp-ca", text.to_owned()));
                }
                let tls = ClientTlsConfig::new().ca_certificate(Certificate::from_pem(pem));
                let endpoint = endpoint.tls_config(tls).map_err(|error| {
                    let text = proto::unreachable(&error).message().to_owned();
                    ("otlp-ca", format!("does not serve: {text}: give certificates of authorities as PEM"))
                })?;
                Ok(Self { endpoint, is_encrypted })
            }
        }
    }

    /// To be connected to when there is something to say.
    #[cfg(feature = "otlp")]
    pub(crate) fn channel(&self) -> tonic::transport::Channel {
        self.endpoint.connect_lazy()
    }
}

/// Is it one certificate of an authority or more, as PEM? TLS itself leaves out what it cannot read, and trusts nobody then.
fn holds_authorities(pem: &[u8]) -> bool {
    let mut authorities = CertificateDer::pem_slice_iter(pem).peekable();
    let sound = |certificate: Result<CertificateDer<'_>, _>| {
        certificate.is_ok_and(|certificate| webpki::anchor_from_trusted_cert(&certificate).is_ok())
    };
    authorities.peek().is_some() && authorities.all(sound)
}

/// How long a collector may take to be there, and to take what it is given. What it does not take is lost, and said in the log.
pub(crate) const PATIENCE: Duration = Duration::from_secs(5);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_collector_is_said_before_anything_is_sent() {
        for good in ["http://127.0.0.1:4317", "http://collector:4317/", "http://[::1]:4317"] {
            assert!(good.parse::<Collector>().unwrap().vouched_for_by(None).is_ok(), "{good}");
        }
        for (bad, said) in [
            ("collector:4317", "no scheme"),
            ("somewhere", "no scheme"),
            ("", "empty"),
            ("http://", "empty"),
            ("http://:4317", "names no host"),
            ("ftp://collector:21", "the scheme is ftp"),
            ("http://collector:4318/v1/traces", "its own path"),
            ("http://collector 4317", "invalid"),
        ] {
            let problem = bad.parse::<Collector>().unwrap_err();
            assert!(problem.contains(said) && problem.contains("http://HOST:4317"), "{bad:?}: {problem}");
        }
    }

    #[test]
    fn encryption_and_an_authority_go_together() {
        let (plain, encrypted) = ("http://collector:4317", "https://collector:4317");
        let misfit = |endpoint: &str, authority: Option<&[u8]>| {
            let collector: Collector = endpoint.parse().unwrap();
            let problem = collector.vouched_for_by(authority.map(<[u8]>::to_vec)).map(drop).unwrap_err();
            problem.0
        };
        assert_eq!(misfit(encrypted, None), "otlp-endpoint");
        assert_eq!(misfit(plain, Some(b"")), "otlp-ca");
        let nonsense = b"-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n";
        assert_eq!(misfit(encrypted, Some(nonsense)), "otlp-ca");
    }
}
