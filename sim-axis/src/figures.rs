use std::fmt;
use std::sync::Arc;

use metrics::{Counter, Histogram};
use proto::stream::{Counters, Report};

/// What Prometheus is told of runs. Recorded where the network task reads what the cycle thread has left for it: per report
/// and per chunk of samples, never in a cycle.
#[derive(Clone)]
pub struct Figures {
    resolved: Arc<Resolved>,
    /// What the last report of this run said.
    told: Counters,
    executed: u64,
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
    take_overs: [Counter; TakeOver::ALL.len()],
    stop_tails: Counter,
}

/// Why a stream went on with another replica.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TakeOver {
    /// The stream broke off.
    Broken,
    /// The server said that it leaves.
    Draining,
    /// The lead fell under half, and nothing came.
    Starving,
}

impl TakeOver {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Broken, Self::Draining, Self::Starving];

    /// As the label `cause`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Broken => "broken",
            Self::Draining => "draining",
            Self::Starving => "starving",
        }
    }
}

impl Figures {
    /// Of one run, from now on.
    #[must_use]
    pub fn resolve() -> Self {
        let fail_over =
            |cause: TakeOver| metrics::counter!("motion_failovers_total", "cause" => cause.name());
        let resolved = Resolved {
            cycles: metrics::counter!("motion_cycles_executed_total"),
            underruns: metrics::counter!("motion_underruns_total"),
            late_cycles: metrics::counter!("motion_late_cycles_total"),
            refused_batches: metrics::counter!("motion_refused_batches_total"),
            duplicate_cycles: metrics::counter!("motion_duplicate_cycles_total"),
            stale_epochs: metrics::counter!("motion_stale_epochs_total"),
            lead: metrics::histogram!("motion_lead_cycles"),
            jitter: metrics::histogram!("motion_cycle_jitter_seconds"),
            take_overs: TakeOver::ALL.map(fail_over),
            stop_tails: metrics::counter!("motion_stop_tails_total"),
        };
        Self { resolved: Arc::new(resolved), told: Counters::default(), executed: 0 }
    }

    /// The axis tells where it is.
    pub fn report(&mut self, report: &Report) {
        let Resolved {
            cycles,
            underruns,
            late_cycles,
            refused_batches,
            duplicate_cycles,
            stale_epochs,
            lead,
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
        (self.told, self.executed) = (now, report.executed_cycle);
    }

    /// How late cycles began [ns].
    pub fn lateness(&self, lateness_ns: &[i32]) {
        for lateness in lateness_ns {
            self.resolved.jitter.record(f64::from(*lateness) * 1e-9);
        }
    }

    /// The stream went on with another replica.
    pub fn taken_over(&self, why: TakeOver) {
        let index = TakeOver::ALL.iter().position(|known| *known == why);
        if let Some(counter) = index.and_then(|index| self.resolved.take_overs.get(index)) {
            counter.increment(1);
        }
    }

    /// The axis came to rest by itself.
    pub fn stop_tail(&self) {
        self.resolved.stop_tails.increment(1);
    }
}

impl fmt::Debug for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Figures").field("told", &self.told).finish_non_exhaustive()
    }
}
