use tonic::transport::Endpoint;

use crate::Error;

/// The address that `endpoint` writes, as something to connect to: `http://127.0.0.1:50051`, the same without the scheme, `https://`, or
/// `unix:/run/portamento.sock`, a socket of this machine, without encryption.
///
/// # Errors
/// [`Error::Address`] where it is none. Whether anybody answers there is
/// not asked.
pub fn address(endpoint: &str) -> Result<Endpoint, Error> {
    let invalid = |cause: String| Error::Address { endpoint: endpoint.into(), cause };
    if let Some(path) = endpoint.strip_prefix("unix:") {
        // With a host it would be an address of something else.
        if !path.starts_with('/') || path.starts_with("//") || path.len() == 1 {
            return Err(invalid("it names no path from the root, as unix:/run/portamento.sock".into()));
        }
        return Endpoint::from_shared(endpoint.to_owned())
            .map_err(|error| invalid(proto::unreachable(&error).message().to_owned()));
    }
    let uri = if endpoint.contains("://") { endpoint.into() } else { format!("http://{endpoint}") };
    let address = Endpoint::from_shared(uri)
        .map_err(|error| invalid(proto::unreachable(&error).message().to_owned()))?;
    // A word alone is a slip of the finger rather than a host: with a scheme, port 80 is meant.
    if !endpoint.contains("://") && address.uri().port_u16().is_none() {
        return Err(invalid("it names no port".into()));
    }
    match (address.uri().scheme_str(), address.uri().host()) {
        (Some("http" | "https"), Some(host)) if !host.is_empty() => Ok(address),
        (Some("http" | "https") | None, _) => Err(invalid("it names no host".into())),
        (Some(scheme), _) => Err(invalid(format!("the scheme is {scheme}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_address_is_said_before_anybody_is_asked() {
        for good in [
            "http://127.0.0.1:50051",
            "127.0.0.1:50051",
            "planner:50051",
            "http://[::1]:50051/",
            "https://planner:443",
            "unix:/run/portamento.sock",
        ] {
            assert!(address(good).is_ok(), "{good}");
        }
        let rows = [
            ("foo bar", "invalid uri character"),
            ("", "invalid"),
            ("http://", "invalid"),
            ("https://:443", "it names no host"),
            ("ftp://planner:21", "the scheme is ftp"),
            ("http://:50051", "it names no host"),
            ("unix:", "it names no path"),
            ("unix:socket", "it names no path"),
            ("unix://host/socket", "it names no path"),
            ("foo", "it names no port"),
            ("127.0.0.1", "it names no port"),
        ];
        for (bad, said) in rows {
            let Err(error) = address(bad) else { panic!("{bad:?} is no address") };
            let text = error.to_string();
            assert!(text.contains(said) && text.contains("http://host:port"), "{bad:?}: {text}");
        }
    }
}
