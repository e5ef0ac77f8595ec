//! What is told: figures for Prometheus, and traces over all processes. Figures are those of the whole test binary, so that only
//! their growth says anything.

use std::collections::HashMap;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::{Arc, Mutex};

use e2e::{Loopback, LoopbackAxis, fifty_millimetres, planned};
use proto::{TraceContext, pb};
use sim_axis::{RemoteAxis, TrackRequest};
use tracing::Subscriber;
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing_subscriber::layer::{Context, SubscriberExt as _};
use tracing_subscriber::{Layer, Registry};

/// The sum of all series of a figure whose line begins so.
fn value(page: &str, beginning: &str) -> f64 {
    let lines = page.lines().filter(|line| line.starts_with(beginning));
    lines.filter_map(|line| line.rsplit(' ').next()?.parse::<f64>().ok()).sum()
}

async fn page(server: &Loopback) -> String {
    reqwest::get(server.page("/metrics")).await.unwrap().text().await.unwrap()
}

#[tokio::test]
async fn figures_grow_with_what_is_done() {
    let mut config = server::Config::loopback();
    config.serving.http = Some(SocketAddr::from((Ipv4Addr::LOCALHOST, 0)));
    let server = Loopback::with(config).await;
    let axis = LoopbackAxis::start().await;
    let before = page(&server).await;
    let mut planner = server.planner().await;
    planner.plan(pb::PlanRequest::from(fifty_millimetres())).await.unwrap();
    planner.plan(pb::PlanRequest::default()).await.unwrap_err();
    let plan = planned(fifty_millimetres());
    let mut request = TrackRequest::new("told/x", server.endpoint(), plan);
    request.lead_cycles = 250;
    let mut run = RemoteAxis::connect(&axis.endpoint()).await.unwrap().track(request).await.unwrap();
    while run.next().await.unwrap().is_some() {}
    let after = page(&server).await;
    for (figure, least) in [
        ("motion_plan_seconds_count{family=\"s_curve\"}", 1.0),
        ("motion_refusals_total{reason=\"NO_AXES\"}", 1.0),
        ("motion_request_seconds_count{method=\"motion.v1.PlannerService/Plan\"}", 2.0),
        ("motion_streams_opened_total", 1.0),
        ("motion_setpoints_sent_total", 314.0),
        ("motion_cycles_executed_total", 300.0),
        ("motion_lead_cycles_count", 1.0),
        ("motion_cycle_jitter_seconds_count", 300.0),
    ] {
        let grown = value(&after, figure) - value(&before, figure);
        assert!(grown >= least, "{figure} has grown by {grown}:\n{after}");
    }
    // Every figure that dashboards and alerts ask for is there from the beginning, or grows out of one that is.
    for figure in [
        "motion_streams ",
        "motion_failovers_total{cause=\"lost\"}",
        "motion_underruns_total",
        "motion_connections_refused_total",
        "motion_refusals_total{reason=\"OVERLOADED\"}",
    ] {
        assert!(after.lines().any(|line| line.starts_with(figure)), "{figure} is not told:\n{after}");
    }
}

/// From the caller through the axis to the planner that serves its stream: each says of which trace its calls are.
#[tokio::test]
async fn a_trace_goes_through_all_processes() {
    let calls = Calls::default();
    // For the whole binary, and once: what a thread without a listener comes across first is else not told to any.
    tracing::subscriber::set_global_default(Registry::default().with(calls.clone())).unwrap();
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let mut request = TrackRequest::new("traced/x", server.endpoint(), planned(fifty_millimetres()));
    request.clock = sim_axis::Clock::Virtual;
    let trace = TraceContext::begin();
    let mut run = trace.scope(remote.track(request)).await.unwrap();
    while run.next().await.unwrap().is_some() {}
    let methods = ["/motion.v1.SetpointService/StreamSetpoints", "/motion.v1.SimAxisService/RunTracking"];
    assert_eq!(calls.of(trace), methods);
}

/// The fields of spans, by span.
#[derive(Clone, Debug, Default)]
struct Calls(Arc<Mutex<HashMap<u64, HashMap<String, String>>>>);

impl Calls {
    /// The methods that were called for `trace`, in alphabetical order.
    fn of(&self, trace: TraceContext) -> Vec<String> {
        let calls = self.0.lock().unwrap();
        let of_trace = calls.values().filter(|fields| fields.get("trace_id") == Some(&trace.trace_id()));
        let mut methods: Vec<String> = of_trace.filter_map(|fields| fields.get("method").cloned()).collect();
        methods.sort();
        methods
    }
}

impl<S: Subscriber> Layer<S> for Calls {
    fn on_new_span(&self, attributes: &Attributes<'_>, id: &Id, _: Context<'_, S>) {
        if attributes.metadata().name() != "rpc" {
            return;
        }
        let mut calls = self.0.lock().unwrap();
        attributes.record(&mut Fields(calls.entry(id.into_u64()).or_default()));
    }

    fn on_record(&self, id: &Id, values: &Record<'_>, _: Context<'_, S>) {
        if let Some(fields) = self.0.lock().unwrap().get_mut(&id.into_u64()) {
            values.record(&mut Fields(fields));
        }
    }
}

struct Fields<'a>(&'a mut HashMap<String, String>);

impl Visit for Fields<'_> {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        let text = format!("{value:?}").trim_matches('"').to_owned();
        self.0.insert(field.name().to_owned(), text);
    }
}
