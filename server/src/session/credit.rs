use std::ops::RangeInclusive;

use proto::stream::{FARTHEST_AHEAD, Report};
use proto::{Reason, Rejected};

/// How far the axis is, how far it may be sent ahead, and how far it has been sent.
///
/// ```text
///  executed ≤ accepted ≤ sent ≤ min(grant, executed + 4096)
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Credit {
    executed: u64,
    accepted: u64,
    grant: u64,
    sent: u64,
    /// The farthest that was ever sent: the axis may hold it even where it is to be sent again.
    farthest: u64,
    /// Another server has sent until now: how far, the first report says.
    follows: bool,
}

impl Credit {
    /// Nothing is executed, and `lead` cycles are granted.
    pub(super) fn first(lead: u64) -> Self {
        Self { grant: lead, ..Self::default() }
    }

    /// `executed` is executed and `held` is held of what another server has sent; `lead` cycles are granted.
    pub(super) fn resumed(executed: u64, held: u64, lead: u64) -> Self {
        let grant = executed.saturating_add(lead);
        Self { executed, accepted: held, grant, sent: held, farthest: held, follows: true }
    }

    pub(super) fn executed(&self) -> u64 {
        self.executed
    }

    /// The last cycle that was sent.
    pub(super) fn sent(&self) -> u64 {
        self.sent
    }

    /// Takes over what a report says, if it can be true.
    pub(super) fn report(&mut self, report: &Report) -> Result<(), Rejected> {
        let Report { executed_cycle, accepted_cycle, grant_cycle, .. } = *report;
        let impossible = |text: String| Err(Rejected::new(Reason::ProtocolOrder, text));
        if executed_cycle > accepted_cycle {
            return impossible(format!(
                "executed_cycle {executed_cycle} is past accepted_cycle {accepted_cycle}"
            ));
        }
        // The other server went on until this one had opened, as far as was granted.
        let elsewhere =
            if self.follows { grant_cycle.min(executed_cycle.saturating_add(FARTHEST_AHEAD)) } else { 0 };
        let farthest = self.farthest.max(elsewhere);
        if accepted_cycle > farthest {
            let sent = farthest;
            return impossible(format!(
                "accepted_cycle {accepted_cycle} is past {sent}, the last cycle sent"
            ));
        }
        if executed_cycle < self.executed || accepted_cycle < self.accepted {
            let (executed, accepted) = (self.executed, self.accepted);
            return impossible(format!(
                "cycles {executed_cycle} and {accepted_cycle} are before {executed} and {accepted}, which were \
                 reported executed and accepted"
            ));
        }
        self.executed = executed_cycle;
        self.accepted = accepted_cycle;
        self.grant = grant_cycle;
        self.sent = self.sent.max(accepted_cycle);
        self.farthest = self.farthest.max(accepted_cycle);
        self.follows = false;
        Ok(())
    }

    /// Goes back to the cycle after `accepted`.
    pub(super) fn send_again_after(&mut self, accepted: u64) {
        self.sent = accepted;
    }

    /// May more be sent?
    pub(super) fn has_more(&self, end: Option<u64>) -> bool {
        self.sent < self.allowed(end)
    }

    fn allowed(&self, end: Option<u64>) -> u64 {
        self.grant.min(self.executed.saturating_add(FARTHEST_AHEAD)).min(end.unwrap_or(u64::MAX))
    }

    /// Takes the cycles of the next batch: as many as `most`, as are granted, and as there are up to `end`.
    pub(super) fn next(&mut self, most: u64, end: Option<u64>) -> Option<RangeInclusive<u64>> {
        let last = self.allowed(end).min(self.sent.saturating_add(most));
        if last <= self.sent {
            return None;
        }
        let cycles = self.sent + 1..=last;
        self.sent = last;
        self.farthest = self.farthest.max(last);
        Some(cycles)
    }
}
