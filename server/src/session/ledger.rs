use std::collections::VecDeque;

use proto::Digest;
use proto::stream::Motion;

/// The digests of what was sent and may still be asked about: one for each batch since the cycle that was executed last.
#[derive(Clone, Debug)]
pub(super) struct Ledger {
    /// Cycle and digest, ascending; never empty.
    entries: VecDeque<(u64, Digest)>,
}

impl Ledger {
    /// Nothing sent after `cycle`, whose digest is known.
    pub(super) fn from(cycle: u64, digest: Digest) -> Self {
        Self { entries: VecDeque::from([(cycle, digest)]) }
    }

    /// Of a stream that another server has sent until now, up to `held`; `known` is an earlier cycle whose digest is known too, since a
    /// splice may replace what is held.
    pub(super) fn resumed(known: (u64, Digest), held: (u64, Digest)) -> Self {
        let earlier = Some(known).filter(|known| known.0 < held.0);
        Self { entries: earlier.into_iter().chain([held]).collect() }
    }

    /// Notes the digest of a batch's last cycle.
    pub(super) fn note(&mut self, cycle: u64, digest: Digest) {
        self.entries.push_back((cycle, digest));
    }

    /// The digest of `cycle`: noted, or computed from the note before it; where there is none, from the beginning of the motion.
    pub(super) fn digest_at(&self, cycle: u64, motion: &Motion) -> Digest {
        let after = self.entries.partition_point(|entry| entry.0 <= cycle);
        let known = after.checked_sub(1).and_then(|index| self.entries.get(index));
        let beginning = (motion.under_way.from_cycle().saturating_sub(1), motion.digest_before);
        motion.digest_from(known.copied().unwrap_or(beginning), cycle)
    }

    /// Drops what nobody can ask about any more, but for the last note at or before `cycle`.
    pub(super) fn forget_before(&mut self, cycle: u64) {
        while self.entries.get(1).is_some_and(|next| next.0 <= cycle) {
            self.entries.pop_front();
        }
    }

    /// Drops what will be sent again.
    pub(super) fn forget_after(&mut self, cycle: u64) {
        while self.entries.len() > 1 && self.entries.back().is_some_and(|last| last.0 > cycle) {
            self.entries.pop_back();
        }
    }
}
