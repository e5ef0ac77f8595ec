//! Who may ask. Two kinds of strangers are kept out, both of which act through a browser that can reach this port:
//!
//! - a page of another site that sends what it likes and cannot read the answer: what does something needs a header that no
//!   form and no simple request carries, and a browser asks first before it sends one elsewhere; nobody answers it
//! - a page whose own name was made to point here (DNS rebinding), to which this server would be its own: a name that is
//!   neither an address nor known is refused

use std::net::IpAddr;
use std::sync::Arc;

use serving::axum::extract::{Request, State};
use serving::axum::http::uri::Authority;
use serving::axum::http::{HeaderMap, Method, StatusCode, header};
use serving::axum::middleware::Next;
use serving::axum::response::{IntoResponse as _, Response};

/// Set by the pages on whatever is not a mere look.
const OURS: &str = "x-portamento";

/// Names under which the pages are known, beside addresses and `localhost`.
#[derive(Clone, Debug)]
pub(super) struct Hosts(Arc<[String]>);

impl Hosts {
    pub(super) fn named(names: &[String]) -> Self {
        Self(names.iter().map(|name| name.to_ascii_lowercase()).collect())
    }

    fn knows(&self, host: &str) -> bool {
        let Ok(authority) = host.parse::<Authority>() else { return false };
        let name = authority.host().trim_start_matches('[').trim_end_matches(']').to_ascii_lowercase();
        name == "localhost" || name.parse::<IpAddr>().is_ok() || self.0.contains(&name)
    }
}

/// Lets through what pages of this server ask.
pub(super) async fn admit(State(hosts): State<Hosts>, request: Request, next: Next) -> Response {
    match objection(&hosts, &request) {
        Some(why) => (StatusCode::FORBIDDEN, format!("{why}\n")).into_response(),
        None => next.run(request).await,
    }
}

fn objection(hosts: &Hosts, request: &Request) -> Option<String> {
    let headers = request.headers();
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    // Of HTTP/2 the authority stands in the address.
    let host =
        text(header::HOST).or_else(|| request.uri().authority().map(Authority::as_str)).unwrap_or_default();
    if !hosts.knows(host) {
        return Some(format!(
            "this console does not go by the name {host:?}: use the address of the server, or start it with --console-host"
        ));
    }
    let looks = matches!(*request.method(), Method::GET | Method::HEAD);
    if looks {
        return None;
    }
    if headers.get(OURS).is_none() || !is_json(headers) {
        return Some(format!("send JSON, with content-type application/json and the header {OURS}"));
    }
    let origin = text(header::ORIGIN)?;
    let is_own = origin.split_once("://").is_some_and(|(_, authority)| authority.eq_ignore_ascii_case(host));
    (!is_own).then(|| format!("the page of {origin} is not one of this server"))
}

fn is_json(headers: &HeaderMap) -> bool {
    let kind = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    kind.split(';').next().is_some_and(|kind| kind.trim().eq_ignore_ascii_case("application/json"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serving::axum::body::Body;

    fn admitted(method: &str, headers: &[(&str, &str)]) -> bool {
        let hosts = Hosts::named(&["Planner.Cell-7.local".to_owned()]);
        let request = headers
            .iter()
            .fold(Request::builder().method(method).uri("/console/"), |request, (name, value)| {
                request.header(*name, *value)
            });
        objection(&hosts, &request.body(Body::empty()).unwrap()).is_none()
    }

    #[test]
    fn pages_go_by_addresses_and_known_names() {
        let good = ["127.0.0.1:8080", "[::1]:8080", "localhost", "LOCALHOST:1", "planner.cell-7.local:8080"];
        let bad = ["evil.example", "127.0.0.1.evil.example:8080", "localhost.evil.example", ""];
        for host in good {
            assert!(admitted("GET", &[("host", host)]), "{host}");
        }
        for host in bad {
            assert!(!admitted("GET", &[("host", host)]), "{host}");
        }
    }

    #[test]
    fn what_another_site_can_send_does_nothing() {
        let host = ("host", "127.0.0.1:8080");
        let json = ("content-type", "application/json; charset=utf-8");
        let ours = ("x-portamento", "console");
        assert!(admitted("POST", &[host, json, ours]));
        assert!(admitted("POST", &[host, json, ours, ("origin", "http://127.0.0.1:8080")]));
        for bad in [
            &[host, json][..],
            &[host, ours],
            &[host, ours, ("content-type", "text/plain")],
            &[host, ours, ("content-type", "application/x-www-form-urlencoded")],
            &[host, json, ours, ("origin", "http://evil.example")],
            &[host, json, ours, ("origin", "null")],
            &[host, json, ours, ("origin", "http://127.0.0.1:9999")],
        ] {
            assert!(!admitted("POST", bad), "{bad:?}");
        }
    }
}
