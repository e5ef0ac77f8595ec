//! Spans for an OpenTelemetry collector, by OTLP over gRPC.

use opentelemetry::trace::{
    SpanContext, SpanId, TraceContextExt as _, TraceFlags, TraceId, TraceState, TracerProvider as _,
};
use opentelemetry_otlp::{SpanExporter, WithExportConfig as _};
use opentelemetry_sdk::Resource;
use opentelemetry_sdk::trace::SdkTracerProvider;
use proto::TraceContext;
use tracing::Subscriber;
use tracing_opentelemetry::OpenTelemetrySpanExt as _;
use tracing_subscriber::Layer;
use tracing_subscriber::registry::LookupSpan;

/// Spans that wait to be handed over; what is left is, when it ends.
#[derive(Debug)]
pub(crate) struct Export(Option<SdkTracerProvider>);

impl Export {
    pub(crate) fn none() -> Self {
        Self(None)
    }

    pub(crate) fn end(self) {
        if let Some(provider) = self.0
            && let Err(error) = provider.shutdown()
        {
            tracing::warn!(%error, "the last spans were not exported");
        }
    }
}

/// What takes the spans of the process called `name` to `endpoint`.
pub(crate) fn export<S>(name: &str, endpoint: &str) -> Result<(impl Layer<S> + use<S>, Export), String>
where
    S: Subscriber + for<'a> LookupSpan<'a>,
{
    let exporter = SpanExporter::builder()
        .with_tonic()
        .with_endpoint(endpoint)
        .build()
        .map_err(|error| format!("{error}: write it as http://HOST:4317"))?;
    let provider = SdkTracerProvider::builder()
        .with_batch_exporter(exporter)
        .with_resource(Resource::builder().with_service_name(name.to_owned()).build())
        .build();
    let layer = tracing_opentelemetry::layer().with_tracer(provider.tracer("portamento"));
    Ok((layer, Export(Some(provider))))
}

/// Hangs `span` below the caller's, and gives what is to be sent with calls that are made within it.
pub(crate) fn below(span: &tracing::Span, caller: Option<TraceContext>) -> Option<TraceContext> {
    if let Some(caller) = caller {
        let (trace, of_caller, is_recorded) = caller.ids();
        let flags = if is_recorded { TraceFlags::SAMPLED } else { TraceFlags::default() };
        let context = SpanContext::new(
            TraceId::from(trace),
            SpanId::from(of_caller),
            flags,
            true,
            TraceState::default(),
        );
        // A span that is not exported has no place for it.
        let _ = span.set_parent(opentelemetry::Context::new().with_remote_span_context(context));
    }
    let context = span.context();
    let context = context.span().span_context().clone();
    TraceContext::from_ids(
        u128::from_be_bytes(context.trace_id().to_bytes()),
        u64::from_be_bytes(context.span_id().to_bytes()),
        context.is_sampled(),
    )
}
