//! What Prometheus is told of plans and streams. Each figure is resolved once; recording one is an atomic addition, or a
//! place in a block of them: never per cycle, at most per batch.

use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

use metrics::{Counter, Gauge, Histogram};
use planner::Family;
use proto::pb;
use proto::pb::stream_setpoints_response::Message;

/// Where the figures of a server are kept.
#[derive(Clone)]
pub(crate) struct Figures(Arc<Resolved>);

struct Resolved {
    s_curve: Histogram,
    trapezoidal: Histogram,
    polynomial: Histogram,
    trigonometric: Histogram,
    pvt: Histogram,
    moves: [Counter; 4],
    streams: Gauge,
    opened: Counter,
    setpoints: Counter,
    operation: Histogram,
}

impl Figures {
    /// From now on.
    pub(crate) fn resolve() -> Self {
        let plan = |family| metrics::histogram!("motion_plan_seconds", "family" => family);
        let many = |family| metrics::counter!("motion_column_plans_total", "family" => family);
        Self(Arc::new(Resolved {
            s_curve: plan("s_curve"),
            trapezoidal: plan("trapezoidal"),
            polynomial: plan("polynomial"),
            trigonometric: plan("trigonometric"),
            pvt: plan("pvt"),
            moves: ["s_curve", "trapezoidal", "polynomial", "trigonometric"].map(many),
            streams: metrics::gauge!("motion_streams"),
            opened: metrics::counter!("motion_streams_opened_total"),
            setpoints: metrics::counter!("motion_setpoints_sent_total"),
            operation: metrics::histogram!("motion_operation_seconds"),
        }))
    }

    /// A plan was made.
    pub(crate) fn planned(&self, family: Family, took: Duration) {
        self.seconds(family).record(took);
    }

    /// So many were made of one message of columns. A million a second are not timed one by one: what they took on the mean is told once
    /// for a message.
    pub(crate) fn planned_many(&self, family: Family, count: u32, took: Duration) {
        let [s_curve, trapezoidal, polynomial, trigonometric] = &self.0.moves;
        let counter = match family {
            Family::SCurve => s_curve,
            Family::Trapezoidal => trapezoidal,
            Family::Polynomial => polynomial,
            Family::Trigonometric => trigonometric,
        };
        counter.increment(u64::from(count));
        if let Some(mean) = took.checked_div(count) {
            self.seconds(family).record(mean);
        }
    }

    fn seconds(&self, family: Family) -> &Histogram {
        match family {
            Family::SCurve => &self.0.s_curve,
            Family::Trapezoidal => &self.0.trapezoidal,
            Family::Polynomial => &self.0.polynomial,
            Family::Trigonometric => &self.0.trigonometric,
        }
    }

    /// A plan through points was made.
    pub(crate) fn planned_pvt(&self, took: Duration) {
        self.0.pvt.record(took);
    }

    /// A stream was opened, so that there are as many.
    pub(crate) fn opened(&self, streams: usize) {
        self.0.opened.increment(1);
        self.open(streams);
    }

    /// There are as many streams.
    pub(crate) fn open(&self, streams: usize) {
        self.0.streams.set(streams as f64);
    }

    /// A message goes out to an axis.
    pub(crate) fn sent(&self, message: &pb::StreamSetpointsResponse) {
        if let Some(Message::Batch(batch)) = &message.message {
            let cycles = batch.columns.as_ref().map_or(batch.cycles, |columns| columns.cycles);
            self.0.setpoints.increment(u64::from(cycles));
        }
    }

    /// An operation was answered that was asked for at `asked`.
    pub(crate) fn operated(&self, asked: Instant) {
        self.0.operation.record(asked.elapsed());
    }
}

impl fmt::Debug for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Figures")
    }
}
