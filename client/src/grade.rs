//! How good a link to a server is, and what lead and guard do for it.
//!
//! ```text
//!   report k ──────────► server            round trip: from a report until the first batch that it allowed
//!            ◄────────── batch             arrival gap: from one batch until the next
//!   wakes up late by …                     lateness: of this machine's own clock
//! ```

use std::time::Duration;

use planner::CycleTime;

/// Durations that were measured, in no order.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Measured {
    sorted: Vec<Duration>,
}

impl Measured {
    /// Of what was measured.
    #[must_use]
    pub fn of(mut durations: Vec<Duration>) -> Self {
        durations.sort_unstable();
        Self { sorted: durations }
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.sorted.len()
    }

    /// The one that `share` of all do not exceed, of 0 to 1; zero where nothing was measured.
    #[must_use]
    pub fn quantile(&self, share: f64) -> Duration {
        let rank = (share.clamp(0.0, 1.0) * self.sorted.len() as f64).ceil() as usize;
        self.sorted.get(rank.max(1) - 1).copied().unwrap_or_default()
    }

    /// The longest; zero where nothing was measured.
    #[must_use]
    pub fn worst(&self) -> Duration {
        self.sorted.last().copied().unwrap_or_default()
    }

    /// How many are above `from`, and at most `to`.
    #[must_use]
    pub fn between(&self, from: Duration, to: Duration) -> usize {
        let up_to = |bound: Duration| self.sorted.partition_point(|duration| *duration <= bound);
        up_to(to).saturating_sub(up_to(from))
    }
}

/// What was measured of a link.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Grade {
    /// From a report to the first batch that it allowed.
    pub round_trips: Measured,
    /// From one batch to the next.
    pub arrival_gaps: Measured,
    /// By how much this machine wakes up late.
    pub lateness: Measured,
    /// From connecting to a server until it has opened a stream: what an axis that changes servers waits for.
    pub openings: Measured,
}

/// What an axis on such a link should ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Advice {
    /// How far ahead it should hold setpoints \[cycles\].
    pub lead_cycles: u32,
    /// How near to the executed cycle setpoints may be replaced \[cycles\].
    pub axis_guard: u32,
    /// What a server that serves takes of the lead at worst \[cycles\].
    pub steady_cycles: u64,
    /// What a change of servers takes of it at worst \[cycles\].
    pub takeover_cycles: u64,
    /// Is the link too slow for the longest lead that may be asked for?
    pub is_short: bool,
}

/// For what was not seen while it was measured \[1\].
const MARGIN: u64 = 2;
/// A server that says nothing is given up when three quarters of the lead are gone: what is left has to do \[1\].
const LEFT: u64 = 4;

impl Grade {
    /// The lead and the guard that this link needs, of those in `leads`, where an axis reports every `batch_cycles`.
    ///
    /// While a server serves, the lead falls by a batch that is not reported yet, a round trip and the axis's own lateness; twice that at
    /// worst is the lead. A server that falls silent is given up when half of the lead is gone and a quarter has passed without a word, so
    /// the last quarter has to do for opening elsewhere and for the first batch from there.
    #[must_use]
    pub fn advice(&self, cycle: CycleTime, batch_cycles: u32, leads: (u32, u32)) -> Advice {
        let cycles = |duration: Duration| duration.as_nanos().div_ceil(u128::from(cycle.as_ns())) as u64;
        let late = cycles(self.lateness.worst());
        let regular = Duration::from_nanos(cycle.as_ns().saturating_mul(u64::from(batch_cycles)));
        let silence = self.arrival_gaps.worst().saturating_sub(regular).max(self.round_trips.worst());
        let steady_cycles = u64::from(batch_cycles) + cycles(silence) + late;
        let takeover_cycles = cycles(self.openings.worst() + self.round_trips.worst()) + late;
        let wanted = (MARGIN * steady_cycles).max(LEFT * takeover_cycles);
        let batch = u64::from(batch_cycles.max(1));
        let whole = wanted.div_ceil(batch) * batch;
        let lead = u32::try_from(whole).unwrap_or(u32::MAX).clamp(leads.0, leads.1);
        let guard = u32::try_from(1 + late).unwrap_or(u32::MAX).min(lead / 2).max(1);
        let is_short = u64::from(lead) < wanted;
        Advice { lead_cycles: lead, axis_guard: guard, steady_cycles, takeover_cycles, is_short }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(milliseconds: &[u64]) -> Measured {
        Measured::of(milliseconds.iter().copied().map(Duration::from_millis).collect())
    }

    #[test]
    fn quantiles_are_those_of_the_nearest_rank() {
        let measured = all(&[5, 1, 4, 2, 3]);
        let at = |share: f64| measured.quantile(share).as_millis();
        assert_eq!((at(0.0), at(0.2), at(0.21), at(0.5), at(0.99), at(1.0)), (1, 1, 2, 3, 5, 5));
        assert_eq!(Measured::default().quantile(0.5), Duration::ZERO);
        assert_eq!(measured.between(Duration::from_millis(1), Duration::from_millis(3)), 2);
    }

    #[test]
    fn a_good_link_needs_little_and_what_is_worst_decides() {
        let good = Grade {
            round_trips: Measured::of(vec![Duration::from_micros(300); 9]),
            arrival_gaps: all(&[10; 9]),
            lateness: Measured::of(vec![Duration::from_micros(80)]),
            openings: all(&[1]),
        };
        let advice = good.advice(CycleTime::MILLISECOND, 10, (10, 250));
        // A batch of 10, a round trip and a wake-up of one each, twice; in whole batches.
        assert_eq!((advice.steady_cycles, advice.takeover_cycles), (12, 3));
        assert_eq!((advice.lead_cycles, advice.axis_guard, advice.is_short), (30, 2, false));
        let slow = Grade { openings: all(&[20, 45]), ..good.clone() };
        assert_eq!(slow.advice(CycleTime::MILLISECOND, 10, (10, 250)).lead_cycles, 190);
        let stalls = Grade { arrival_gaps: all(&[10, 300]), ..good };
        let advice = stalls.advice(CycleTime::MILLISECOND, 10, (10, 250));
        assert!(advice.is_short && advice.lead_cycles == 250);
    }
}
