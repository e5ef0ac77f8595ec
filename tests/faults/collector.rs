//! An OpenTelemetry collector that keeps what it is given.

use std::collections::HashMap;
use std::sync::{Arc, Mutex};

use e2e::Authority;
use opentelemetry_proto::tonic::collector::trace::v1::trace_service_server::{
    TraceService, TraceServiceServer,
};
use opentelemetry_proto::tonic::collector::trace::v1::{
    ExportTraceServiceRequest, ExportTraceServiceResponse,
};
use opentelemetry_proto::tonic::common::v1::any_value::Value;
use opentelemetry_proto::tonic::common::v1::{AnyValue, KeyValue};
use tokio::net::TcpListener;
use tokio_stream::wrappers::TcpListenerStream;
use tonic::transport::{Identity, Server, ServerTlsConfig};
use tonic::{Request, Response, Status};

/// For as long as the runtime lives, on a port of its own.
#[derive(Debug)]
pub(crate) struct Collector {
    port: u16,
    kept: Kept,
}

/// A span as it was told.
#[derive(Clone, Debug)]
pub(crate) struct Span {
    /// The process that it is of.
    pub(crate) process: String,
    pub(crate) name: String,
    pub(crate) trace: u128,
    pub(crate) id: u64,
    /// 0: it has none.
    pub(crate) parent: u64,
    pub(crate) fields: HashMap<String, String>,
    /// The fields of what happened in it.
    pub(crate) events: Vec<HashMap<String, String>>,
}

#[derive(Clone, Debug, Default)]
struct Kept(Arc<Mutex<Vec<Span>>>);

impl Collector {
    pub(crate) async fn start() -> Self {
        Self::serving(Server::builder()).await
    }

    /// One that is spoken to with encryption, as `localhost`.
    pub(crate) async fn encrypted(authority: &Authority) -> Self {
        let of_this = authority.vouch_for("localhost");
        let identity = Identity::from_pem(of_this.certificate, of_this.key);
        let tls = ServerTlsConfig::new().identity(identity);
        Self::serving(Server::builder().tls_config(tls).unwrap()).await
    }

    async fn serving(mut server: Server) -> Self {
        let listener = TcpListener::bind(("127.0.0.1", 0)).await.unwrap();
        let (port, kept) = (listener.local_addr().unwrap().port(), Kept::default());
        let service = TraceServiceServer::new(kept.clone());
        let serving = server.add_service(service).serve_with_incoming(TcpListenerStream::new(listener));
        tokio::spawn(serving);
        Self { port, kept }
    }

    pub(crate) fn port(&self) -> u16 {
        self.port
    }

    /// What it was given so far.
    pub(crate) fn spans(&self) -> Vec<Span> {
        self.kept.0.lock().unwrap().clone()
    }
}

#[tonic::async_trait]
impl TraceService for Kept {
    async fn export(
        &self,
        request: Request<ExportTraceServiceRequest>,
    ) -> Result<Response<ExportTraceServiceResponse>, Status> {
        for of_process in request.into_inner().resource_spans {
            let mut resource = texts(of_process.resource.unwrap().attributes);
            assert!(!resource["host.name"].is_empty() && !resource["service.version"].is_empty());
            let process = resource.remove("service.name").unwrap();
            for span in of_process.scope_spans.into_iter().flat_map(|scope| scope.spans) {
                self.0.lock().unwrap().push(Span {
                    process: process.clone(),
                    name: span.name,
                    trace: u128::from_be_bytes(span.trace_id.try_into().unwrap()),
                    id: u64::from_be_bytes(span.span_id.try_into().unwrap()),
                    parent: span.parent_span_id.try_into().map_or(0, u64::from_be_bytes),
                    fields: texts(span.attributes),
                    events: span
                        .events
                        .into_iter()
                        .map(|event| {
                            let mut fields = texts(event.attributes);
                            fields.insert("message".into(), event.name);
                            fields
                        })
                        .collect(),
                });
            }
        }
        Ok(Response::new(ExportTraceServiceResponse::default()))
    }
}

fn texts(fields: Vec<KeyValue>) -> HashMap<String, String> {
    let text = |value: Option<AnyValue>| match value.and_then(|value| value.value) {
        Some(Value::StringValue(text)) => text,
        Some(Value::IntValue(number)) => number.to_string(),
        other => format!("{other:?}"),
    };
    fields.into_iter().map(|field| (field.key, text(field.value))).collect()
}
