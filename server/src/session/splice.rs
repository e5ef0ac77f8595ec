use planner::motion::Spliced;
use proto::stream::{Motion, OperationResult, RECENT_RESULTS, RefusalReason, Refused};

use super::branch::Branch;
use super::queue::Waiting;

/// An operation whose motion is planned, until the axis confirms it or does not.
#[derive(Clone, Debug)]
pub(super) struct Splice {
    pub(super) waiting: Waiting,
    pub(super) branch: Branch,
    pub(super) result: OperationResult,
    begins: Begins,
    /// The first cycle that was sent of it, and the executed cycle at that time.
    sent: Option<(u64, u64)>,
    replaces: bool,
}

/// How a splice is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Begins {
    /// At its cycle, in place of what was sent from there on.
    At(u64),
    /// With the next batch: no setpoint changes.
    Next,
}

/// What of a splice may be sent now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    /// What comes before it, up to this cycle.
    Before(u64),
    /// Its first batch, in place of what was sent from this cycle on.
    Replace(u64),
    /// Its first batch, after all that was sent.
    First,
    /// What comes after its first batch.
    Going,
}

impl Splice {
    /// `spliced` parts from `adopted`, whose stream has ended with what was sent where `ended`.
    pub(super) fn new(
        waiting: Waiting,
        spliced: Spliced,
        adopted: &Branch,
        ended: bool,
        recent: &[OperationResult],
    ) -> Self {
        let result = result(&waiting, &spliced);
        let kept = recent.len().saturating_sub(RECENT_RESULTS - 1);
        let recent = recent[kept..].iter().cloned().chain([result.clone()]).collect();
        let Spliced { motion: under_way, effective_cycle, .. } = spliced;
        // A plan that goes on keeps its cycle and what came before it.
        let parts = under_way.from_cycle() == effective_cycle;
        let digest_before = match effective_cycle.checked_sub(1) {
            Some(before) if parts => adopted.digest_at(before),
            _ => adopted.motion.digest_before,
        };
        let motion = Motion { under_way, digest_before, recent };
        let branch = if parts { Branch::parting(motion) } else { Branch::renamed(motion, adopted) };
        let begins = if parts || ended { Begins::At(effective_cycle) } else { Begins::Next };
        Self { waiting, branch, result, begins, sent: None, replaces: false }
    }

    /// What comes next, after `sent`.
    pub(super) fn turn(&self, sent: u64) -> Turn {
        match (self.sent, self.begins) {
            (Some(_), _) => Turn::Going,
            (None, Begins::At(cycle)) if cycle <= sent => Turn::Replace(cycle),
            (None, Begins::At(cycle)) if cycle > sent + 1 => Turn::Before(cycle - 1),
            (None, Begins::At(_) | Begins::Next) => Turn::First,
        }
    }

    /// The last cycle that may be in its first batch, after `sent`: the stream does not end before the cycle that says so.
    pub(super) fn end_of_first(&self, sent: u64, close_at_rest: bool) -> Option<u64> {
        self.branch.end(close_at_rest).map(|end| end.max(sent + 1))
    }

    /// Its first batch is sent.
    pub(super) fn begin(&mut self, first_cycle: u64, executed: u64, replaces: bool) {
        self.sent = Some((first_cycle, executed));
        self.replaces = replaces;
    }

    /// Is it refused, if a report says so of `refused`?
    ///
    /// A batch that follows on one which was refused is refused too, since its revision does not begin there, or for the gap. Such
    /// a refusal may come when the splice has been planned again, and begins where that batch did.
    pub(super) fn is_refused_by(&self, refused: &Refused) -> bool {
        let Some((first, _)) = self.sent else { return false };
        let follows = matches!(refused.reason, RefusalReason::Revision | RefusalReason::Gap);
        refused.revision == self.branch.revision() && refused.first_cycle == first && !follows
    }

    /// Does it begin after all that was sent, and so not at all if the axis has not taken that?
    pub(super) fn needs_what_was_sent(&self) -> bool {
        self.sent.is_some() && !self.replaces
    }

    /// The first cycle that was sent of it, and the executed cycle at that time; `None` before.
    pub(super) fn sent(&self) -> Option<(u64, u64)> {
        self.sent
    }
}

/// What is answered to whoever waits for `spliced`.
pub(super) fn result(waiting: &Waiting, spliced: &Spliced) -> OperationResult {
    OperationResult {
        request_id: waiting.request_id.clone(),
        effective_cycle: spliced.effective_cycle,
        rest_cycle: spliced.rest_cycle,
        revision: spliced.motion.revision(),
        on_path: spliced.on_path,
        operation_digest: waiting.digest,
    }
}
