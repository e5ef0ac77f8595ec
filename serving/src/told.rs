//! What is told of every call: a span with the trace that it belongs to, and figures by method.

use std::collections::HashMap;
use std::convert::Infallible;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Instant;

use metrics::{Counter, Histogram};
use proto::{Reason, TraceContext};
use tonic::body::Body;
use tonic::codegen::{Service, http};
use tower::Layer;
use tracing::Instrument as _;

use crate::caller::Caller;

/// Figures of refusals, by reason.
#[derive(Clone)]
pub struct Refusals(Arc<[Counter]>);

impl Refusals {
    /// Where they are counted from now on.
    #[must_use]
    pub fn resolve() -> Self {
        let counter = |reason: &Reason| metrics::counter!("motion_refusals_total", "reason" => reason.name());
        Self(Reason::ALL.iter().map(counter).collect())
    }

    /// One more.
    pub fn count(&self, reason: Reason) {
        let index = Reason::ALL.iter().position(|known| *known == reason);
        if let Some(counter) = index.and_then(|index| self.0.get(index)) {
            counter.increment(1);
        }
    }
}

impl std::fmt::Debug for Refusals {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Refusals")
    }
}

/// Tells of every call to the services that are called so.
#[derive(Clone)]
pub(crate) struct TellLayer {
    /// How long it takes until the answer begins, by path: those that there are, so that nobody makes more by asking.
    methods: Arc<HashMap<String, Histogram>>,
    unknown: Histogram,
}

impl TellLayer {
    /// For methods, as `motion.v1.PlannerService/Plan`.
    pub(crate) fn of(methods: impl IntoIterator<Item = String>) -> Self {
        let resolve = |method: String| metrics::histogram!("motion_request_seconds", "method" => method);
        let unknown = resolve("unknown".to_owned());
        let methods = methods.into_iter().map(|method| (format!("/{method}"), resolve(method))).collect();
        Self { methods: Arc::new(methods), unknown }
    }
}

impl<S> Layer<S> for TellLayer {
    type Service = Told<S>;

    fn layer(&self, inner: S) -> Told<S> {
        Told { tell: self.clone(), inner }
    }
}

/// A service of which is told.
#[derive(Clone)]
pub(crate) struct Told<S> {
    tell: TellLayer,
    inner: S,
}

impl<S> Service<http::Request<Body>> for Told<S>
where
    S: Service<http::Request<Body>, Response = http::Response<Body>, Error = Infallible>,
    S::Future: Send + 'static,
{
    type Response = http::Response<Body>;
    type Error = Infallible;
    type Future = Pin<Box<dyn Future<Output = Result<http::Response<Body>, Infallible>> + Send>>;

    fn poll_ready(&mut self, cx: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        self.inner.poll_ready(cx)
    }

    fn call(&mut self, request: http::Request<Body>) -> Self::Future {
        let figures = self.tell.methods.get(request.uri().path()).unwrap_or(&self.tell.unknown).clone();
        let header = request.headers().get(TraceContext::HEADER).and_then(|value| value.to_str().ok());
        let caller: Option<TraceContext> = header.and_then(|header| header.parse().ok());
        let span = tracing::info_span!(
            "rpc",
            method = request.uri().path(),
            trace_id = tracing::field::Empty,
            identity = tracing::field::Empty,
            // Of what it is about; the service knows.
            stream = tracing::field::Empty,
            request = tracing::field::Empty
        );
        let trace = of_span(&span, caller);
        if !span.is_disabled() {
            span.record("trace_id", trace.trace_id());
            if let Some(identity) = request.extensions().get::<Caller>().and_then(Caller::identity) {
                span.record("identity", identity);
            }
        }
        let begun = Instant::now();
        // Within the span: what the service spawns at once belongs to it.
        let answer = span.in_scope(|| self.inner.call(request));
        let answer = async move {
            let answer = answer.await;
            figures.record(begun.elapsed());
            answer
        };
        Box::pin(trace.scope(answer.instrument(span)))
    }
}

/// Says in the span of the call that is being answered which stream it is about, and which request of whoever asks. What is no name of
/// either stays out of logs and traces.
pub fn about(stream: &str, request: &str) {
    let span = tracing::Span::current();
    for (field, name) in [("stream", stream), ("request", request)] {
        if (1..=MOST_NAME_BYTES).contains(&name.len()) && !name.contains(char::is_control) {
            span.record(field, name);
        }
    }
}

/// As many as names of streams and requests may have.
const MOST_NAME_BYTES: usize = 256;

/// The next step of the caller's trace, or the first of one.
#[cfg(not(feature = "otlp"))]
fn of_span(_: &tracing::Span, caller: Option<TraceContext>) -> TraceContext {
    caller.map_or_else(TraceContext::begin, TraceContext::child)
}

/// As the exported span says it, so that what is called from here hangs below it.
#[cfg(feature = "otlp")]
fn of_span(span: &tracing::Span, caller: Option<TraceContext>) -> TraceContext {
    crate::export::below(span, caller)
        .unwrap_or_else(|| caller.map_or_else(TraceContext::begin, TraceContext::child))
}
