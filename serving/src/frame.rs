//! What every call passes, in this order, whatever is called; and what every connection is held to.
//!
//! ```text
//!   origins of pages ── gRPC-Web ── refusals get their reasons and are counted ── who calls, and may he?
//!       ── span, trace and figures ── rate ── room ── size and time of messages ── the service
//! ```

use std::convert::Infallible;
use std::time::Duration;

use tonic::body::Body;
use tonic::codegen::Service;
use tonic::codegen::http::{HeaderName, HeaderValue, Method, Request, Response};
use tonic::service::Routes;
use tonic::transport::Server;
use tonic_web::GrpcWebLayer;
use tower::util::{MapRequestLayer, MapResponseLayer};
use tower::{Layer, ServiceBuilder};
use tower_http::cors::{AllowOrigin, CorsLayer};

use crate::admission::{CheckLayer, Permission, Rate, Room};
use crate::refusals::{Measure, of_request, of_response};
use crate::settings::Settings;
use crate::told::{Refusals, TellLayer};

/// The layers around services with these methods.
pub(crate) fn frame(
    settings: &Settings,
    methods: Vec<String>,
) -> impl Layer<
    Routes,
    Service = impl Service<
        Request<Body>,
        Response = Response<Body>,
        Error = Infallible,
        Future = impl Future<Output = Result<Response<Body>, Infallible>> + Send + 'static,
    > + Clone
              + Send
              + 'static,
> + Clone {
    let some = |time: Duration| (!time.is_zero()).then_some(time);
    let measure = Measure {
        most_bytes: settings.max_message_bytes,
        first: some(settings.first_message_deadline),
        idle: some(settings.idle_deadline),
    };
    let refusals = Refusals::resolve();
    ServiceBuilder::new()
        .layer(origins(&settings.cors_origins))
        .layer(GrpcWebLayer::new())
        .layer(MapResponseLayer::new(move |response| of_response(response, measure, &refusals)))
        .layer(CheckLayer(Permission::by(settings.policy.clone())))
        .layer(TellLayer::of(methods))
        .layer(CheckLayer(Rate::of(settings.max_request_rate)))
        .layer(CheckLayer(Room::of(settings.max_concurrent_requests)))
        .layer(MapRequestLayer::new(move |request| of_request(request, measure)))
        .into_inner()
}

/// What a connection is held to. Streams of it are not bounded: a cell's gateway has one for each axis.
///
/// # Errors
/// A certificate that does not serve.
pub(crate) fn transport(settings: &Settings) -> Result<Server, tonic::transport::Error> {
    let server = Server::builder()
        .initial_stream_window_size(settings.stream_window_bytes)
        .initial_connection_window_size(settings.connection_window_bytes)
        .http2_keepalive_interval(Some(settings.keepalive_interval))
        .http2_keepalive_timeout(Some(settings.keepalive_timeout))
        .accept_http1(settings.grpc_web);
    match &settings.tls {
        Some(tls) => server.tls_config(tls.config()),
        None => Ok(server),
    }
}

/// What pages of other origins may do: what gRPC-Web needs, and nothing of any other origin than those that are named.
fn origins(allowed: &[String]) -> CorsLayer {
    let origins = if allowed.iter().any(|origin| origin == "*") {
        AllowOrigin::any()
    } else {
        AllowOrigin::list(allowed.iter().filter_map(|origin| HeaderValue::from_str(origin).ok()))
    };
    CorsLayer::new()
        .allow_origin(origins)
        .allow_methods([Method::POST])
        .allow_headers(ASKED.map(HeaderName::from_static))
        .expose_headers(TOLD.map(HeaderName::from_static))
        .max_age(PREFLIGHT)
}

/// What clients of gRPC-Web send. Source: "gRPC Web", protocol differences vs gRPC over HTTP2; `traceparent` is ours.
const ASKED: [&str; 5] = ["content-type", "x-grpc-web", "x-user-agent", "grpc-timeout", "traceparent"];
/// What they are to read.
const TOLD: [&str; 3] = ["grpc-status", "grpc-message", "grpc-status-details-bin"];
/// How long a browser may remember what it was allowed.
const PREFLIGHT: Duration = Duration::from_hours(1);
