use std::ops::RangeInclusive;

use proto::stream::{Batch, Columns, Motion, Phase, Tails};
use proto::{Digest, Rejected};

use super::ledger::Ledger;

/// A motion, and the digests of its cycles as they were sent.
///
/// A splice parts from what the axis has adopted; until the axis says which of the two it holds, both go on:
///
/// ```text
///  adopted   ───●───────●───────●───────●        sent before the splice
///                          ╲
///  spliced                  n──────●───────●──►  replaces from n on
/// ```
#[derive(Clone, Debug)]
pub(super) struct Branch {
    pub(super) motion: Motion,
    ledger: Ledger,
    /// The first cycle that may be the last of the stream: those before it were sent, and not as the last.
    floor: u64,
}

impl Branch {
    /// From the beginning of a stream.
    pub(super) fn opened(motion: Motion) -> Self {
        Self { motion, ledger: Ledger::from(0, Digest::ZERO), floor: 0 }
    }

    /// From the cycle on that an axis does not hold; `held` is the last that it holds, with its digest, and `known` an earlier one.
    pub(super) fn resumed(motion: Motion, known: (u64, Digest), held: (u64, Digest)) -> Self {
        Self { motion, ledger: Ledger::resumed(known, held), floor: held.0 + 1 }
    }

    /// What `motion` will have been sent from its first cycle on.
    pub(super) fn parting(motion: Motion) -> Self {
        let before = motion.under_way.from_cycle().saturating_sub(1);
        let ledger = Ledger::from(before, motion.digest_before);
        Self { motion, ledger, floor: 0 }
    }

    /// The same setpoints as `of`, under another revision.
    pub(super) fn renamed(motion: Motion, of: &Self) -> Self {
        Self { motion, ledger: of.ledger.clone(), floor: 0 }
    }

    pub(super) fn revision(&self) -> u64 {
        self.motion.revision()
    }

    /// The last cycle of a stream that ends with this motion; `None` where it goes on after it.
    pub(super) fn end(&self, close_at_rest: bool) -> Option<u64> {
        let last = self.motion.last_cycle();
        let ends = match self.motion.under_way.phase_at(last) {
            Phase::Standstill => close_at_rest,
            Phase::Finished => true,
            // At rest, and more is to come.
            Phase::Moving | Phase::Holding | Phase::Stopping => false,
        };
        ends.then(|| last.max(self.floor))
    }

    /// Nothing before `cycle` is the last of the stream.
    pub(super) fn raise_floor(&mut self, cycle: u64) {
        self.floor = self.floor.max(cycle);
    }

    /// The setpoints of `cycles`, with the way to rest from the last of them; of a compact stream only their digest.
    pub(super) fn batch(
        &mut self,
        cycles: RangeInclusive<u64>,
        replaces: bool,
        last: bool,
        compact: bool,
    ) -> Result<Batch, Rejected> {
        let (first_cycle, last_cycle) = cycles.into_inner();
        // The axis finds the same, and judges it.
        let tails = if compact { Tails::default() } else { self.motion.tails(last_cycle)? };
        // What was sent from there on, as this or as another branch, is replaced, or was not taken.
        self.ledger.forget_after(first_cycle - 1);
        let before = self.ledger.digest_at(first_cycle - 1, &self.motion);
        let of_plan = self.motion.plan_cycle(first_cycle)..self.motion.plan_cycle(last_cycle) + 1;
        let columns = Columns::of_plan(self.motion.plan(), of_plan);
        let digest = columns.digests(first_cycle, before).last().unwrap_or(before);
        self.ledger.note(last_cycle, digest);
        let columns = if compact { Columns::bare(columns.cycles()) } else { columns };
        Ok(Batch { first_cycle, revision: self.revision(), replaces, last, columns, digest, tails })
    }

    /// The digest of `cycle`, not before the motion and not before what was forgotten.
    pub(super) fn digest_at(&self, cycle: u64) -> Digest {
        self.ledger.digest_at(cycle, &self.motion)
    }

    /// Nobody will ask about cycles before `cycle` any more.
    pub(super) fn forget_before(&mut self, cycle: u64) {
        self.ledger.forget_before(cycle);
    }

    /// What comes after `cycle` will be sent again.
    pub(super) fn forget_after(&mut self, cycle: u64) {
        self.ledger.forget_after(cycle);
    }
}
