//! Spans for an OpenTelemetry collector, by OTLP over gRPC. They wait in a queue of a bounded length and go by a thread of their
//! own: a collector that is slow, or is not there, costs spans and delays nothing.

use std::time::Duration;

use opentelemetry::KeyValue;
use opentelemetry::trace::{
    SpanContext, SpanId, TraceContextExt as _, TraceFlags, TraceId, TraceState, TracerProvider as _,
};
use opentelemetry_otlp::{SpanExporter, WithExportConfig as _, WithTonicConfig as _};
use opentelemetry_sdk::Resource;
use opentelemetry_sdk::trace::SdkTracerProvider;
use proto::TraceContext;
use tracing::Subscriber;
use tracing::level_filters::LevelFilter;
use tracing_opentelemetry::OpenTelemetrySpanExt as _;
use tracing_subscriber::Layer;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::registry::LookupSpan;

use crate::collector::{Collector, PATIENCE};

/// Spans that wait to be handed over; what is left is, when it ends.
#[derive(Debug)]
pub(crate) struct Export(Option<SdkTracerProvider>);

/// How long a process that goes waits for the collector to take the last spans.
const GOODBYE: Duration = Duration::from_secs(1);

/// Whose spans are told. Below them are those of the transport, one for every frame that comes or goes: to make them would cost
/// more than the work, and those of the export itself would never come to an end.
const TOLD: [&str; 4] = ["serving", "server", "sim_axis", "client"];

impl Export {
    pub(crate) fn none() -> Self {
        Self(None)
    }

    pub(crate) fn end(self) {
        if let Some(provider) = self.0
            && let Err(error) = provider.shutdown_with_timeout(GOODBYE)
        {
            tracing::warn!(%error, "the last spans were not exported");
        }
    }
}

/// What takes the spans of the process called `name` to `collector`.
pub(crate) fn export<S>(name: &str, collector: &Collector) -> Result<(impl Layer<S> + use<S>, Export), String>
where
    S: Subscriber + for<'a> LookupSpan<'a>,
{
    let exporter = SpanExporter::builder()
        .with_tonic()
        .with_channel(collector.channel())
        .with_timeout(PATIENCE)
        .build()
        .map_err(|error| error.to_string())?;
    // Replicas are told apart by their machines; OTEL_RESOURCE_ATTRIBUTES adds what else a plant wants to know.
    let resource = Resource::builder().with_service_name(name.to_owned()).with_attributes([
        KeyValue::new("service.version", env!("CARGO_PKG_VERSION")),
        KeyValue::new("host.name", rustix::system::uname().nodename().to_string_lossy().into_owned()),
    ]);
    let provider =
        SdkTracerProvider::builder().with_batch_exporter(exporter).with_resource(resource.build()).build();
    // A stream's span is entered with every message: nothing is done then but what its own events need.
    let layer = tracing_opentelemetry::layer()
        .with_tracer(provider.tracer("portamento"))
        .with_tracked_inactivity(false)
        .with_context_activation(false)
        .with_threads(false)
        .with_location(false)
        .with_filter(Targets::new().with_targets(TOLD.map(|target| (target, LevelFilter::INFO))));
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
