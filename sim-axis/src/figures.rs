use std::fmt;
use std::sync::Arc;

use client::failover::Cause;
use metrics::{Counter, Histogram};
use proto::stream::{Counters, Report};

/// What Prometheus is told of runs. Recorded where the network task reads what the cycle thread has left for it: per report
/// and per chunk of samples, never in a cycle.
#[derive(Clone)]
pub(crate) struct Figures {
    resolved: Arc<Resolved>,
    /// What the last report of this run said.
    told: Counters,
    executed: u64,
    tail: Option<u64>,
}

struct Resolved {
    cycles: Counter,
    underruns: Counter,
    late_cycles: Counter,
    refused_batches: Counter,
    duplicate_cycles: Counter,
    stale_epochs: Counter,
    lead: Histogram,
    jitter: Histogram,
    failovers: [Counter; Cause::ALL.len()],
    stop_tails: Counter,
}

impl Figures {
    /// Of one run, from now on.
    pub(crate) fn resolve() -> Self {
        let fail_over = |cause: Cause| metrics::counter!("motion_failovers_total", "cause" => cause.name());
        let resolved = Resolved {
            cycles: metrics::counter!("motion_cycles_executed_total"),
            underruns: metrics::counter!("motion_underruns_total"),
            late_cycles: metrics::counter!("motion_late_cycles_total"),
            refused_batches: metrics::counter!("motion_refused_batches_total"),
            duplicate_cycles: metrics::counter!("motion_duplicate_cycles_total"),
            stale_epochs: metrics::counter!("motion_stale_epochs_total"),
            lead: metrics::histogram!("motion_lead_cycles"),
            jitter: metrics::histogram!("motion_cycle_jitter_seconds"),
            failovers: Cause::ALL.map(fail_over),
            stop_tails: metrics::counter!("motion_stop_tails_total"),
        };
        Self { resolved: Arc::new(resolved), told: Counters::default(), executed: 0, tail: None }
    }

    /// The axis tells where it is.
    pub(crate) fn report(&mut self, report: &Report) {
        let Resolved {
            cycles,
            underruns,
            late_cycles,
            refused_batches,
            duplicate_cycles,
            stale_epochs,
            lead,
            stop_tails,
            ..
        } = &*self.resolved;
        let (before, now) = (self.told, report.counters);
        for (counter, before, now) in [
            (cycles, self.executed, report.executed_cycle),
            (underruns, before.underruns, now.underruns),
            (late_cycles, before.late_cycles, now.late_cycles),
            (refused_batches, before.refused_batches, now.refused_batches),
            (duplicate_cycles, before.duplicate_cycles, now.duplicate_cycles),
            (stale_epochs, before.stale_epochs, now.stale_epochs),
        ] {
            counter.increment(now.saturating_sub(before));
        }
        lead.record(report.accepted_cycle.saturating_sub(report.executed_cycle) as f64);
        if report.tail_from_cycle.is_some() && report.tail_from_cycle != self.tail {
            stop_tails.increment(1);
        }
        (self.told, self.executed, self.tail) = (now, report.executed_cycle, report.tail_from_cycle);
    }

    /// How late cycles began [ns].
    pub(crate) fn lateness(&self, lateness_ns: &[i32]) {
        for lateness in lateness_ns {
            self.resolved.jitter.record(f64::from(*lateness) * 1e-9);
        }
    }

    /// The stream went on with another replica.
    pub(crate) fn failed_over(&self, why: Cause) {
        let index = Cause::ALL.iter().position(|known| *known == why);
        if let Some(counter) = index.and_then(|index| self.resolved.failovers.get(index)) {
            counter.increment(1);
        }
    }
}

impl fmt::Debug for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Figures").field("told", &self.told).finish_non_exhaustive()
    }
}
