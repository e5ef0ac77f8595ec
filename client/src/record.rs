//! What another server needs to go on with a stream: kept beside a buffer by whoever carries its messages.

use std::collections::VecDeque;

use proto::stream::{Batch, Columns, FARTHEST_CHECKPOINT, Motion, Report, Resume, Tails};
use proto::{Digest, Rejected};

/// The motion as the axis has adopted it, and how far it holds it.
///
/// The axis is the log: a motion counts as soon as a report shows its revision, and nothing that only a server knows does.
#[derive(Clone, Debug)]
pub struct Record {
    motion: Motion,
    /// Told to the axis, and not in a report yet.
    announced: Option<Motion>,
    /// Digests of cycles that were reported as held, ascending; of the adopted motion alone, and never empty.
    marks: VecDeque<(u64, Digest)>,
    /// The batch that brought the last cycle that is held; `None` where no batch has, as after a way to rest.
    newest: Option<Carried>,
    /// Batches that the axis was given, in that order, and that no report has spoken of yet.
    carried: VecDeque<Carried>,
    executed: u64,
}

/// Of a batch, what is needed once the axis holds it.
#[derive(Clone, Debug)]
struct Carried {
    revision: u64,
    first_cycle: u64,
    last_cycle: u64,
    /// The way to rest from there.
    tails: Tails,
    /// Is that the end of the stream?
    last: bool,
}

/// Batches that no report has spoken of yet: many more than a lead has, however small they are.
const MOST_CARRIED: usize = 1024;

impl Record {
    /// Of a stream that has just been opened.
    #[must_use]
    pub fn opened(motion: Motion) -> Self {
        let marks = VecDeque::from([(0, Digest::ZERO)]);
        Self { motion, announced: None, marks, newest: None, carried: VecDeque::new(), executed: 0 }
    }

    /// The motion that is adopted.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// The last cycle that was reported as executed.
    #[must_use]
    pub fn executed(&self) -> u64 {
        self.executed
    }

    /// The last cycle that is held, as far as is known.
    #[must_use]
    pub fn held(&self) -> u64 {
        self.mark().0
    }

    /// Does the axis hold everything up to the last cycle of the stream?
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.last().is_some()
    }

    /// Has the axis executed the last cycle of the stream?
    #[must_use]
    pub fn is_executed(&self) -> bool {
        self.last().is_some_and(|last| self.executed >= last)
    }

    /// The last cycle of the stream, once it is held.
    fn last(&self) -> Option<u64> {
        self.newest.as_ref().filter(|batch| batch.last).map(|batch| batch.last_cycle)
    }

    fn mark(&self) -> (u64, Digest) {
        self.marks.back().copied().unwrap_or_default()
    }

    /// Takes note of a motion that the axis is told of.
    pub fn announce(&mut self, motion: Motion) {
        self.announced = Some(motion);
    }

    /// Makes of a bare batch one with setpoints and way to rest, by the motion that it follows from. What is of no motion, not within it, or
    /// beyond what an axis grants that holds `lead_cycles`, stays as it is, and no axis takes that.
    pub(crate) fn evaluate(&self, batch: &mut Batch, lead_cycles: u64) {
        let granted = self.executed.saturating_add(lead_cycles);
        if !batch.columns.is_bare() || batch.last_cycle() > granted {
            return;
        }
        let motions = [Some(&self.motion), self.announced.as_ref()];
        let of_it = motions.into_iter().flatten().find(|motion| motion.revision() == batch.revision);
        let (first, last) = (batch.first_cycle, batch.last_cycle());
        let Some(motion) = of_it.filter(|motion| first >= motion.under_way.from_cycle().max(1)) else {
            return;
        };
        // Where there is no way to rest, that is why no axis takes the batch.
        batch.tails = motion.tails(last).unwrap_or_default();
        batch.columns =
            Columns::of_plan(motion.plan(), motion.plan_cycle(first)..motion.plan_cycle(last) + 1);
    }

    /// Takes note of a batch that the axis is given. It counts once a report shows that the axis holds it: it may be refused, or bring
    /// nothing that is not held already.
    pub fn carry(&mut self, batch: &Batch) {
        let &Batch { revision, first_cycle, last, .. } = batch;
        let (last_cycle, tails) = (batch.last_cycle(), batch.tails.clone());
        if self.carried.len() < MOST_CARRIED {
            self.carried.push_back(Carried { revision, first_cycle, last_cycle, tails, last });
        }
    }

    /// Takes over what the axis says of itself.
    pub fn report(&mut self, report: &Report) {
        let &Report { executed_cycle, accepted_cycle, revision, digest, .. } = report;
        self.executed = self.executed.max(executed_cycle);
        self.settle(report);
        if let Some(adopted) = self.announced.take_if(|announced| announced.revision() == revision) {
            self.adopt(adopted);
        }
        if revision != self.motion.revision() {
            // Of a way to rest that is known already, or of nothing that was announced.
            return;
        }
        while self.marks.back().is_some_and(|(cycle, _)| *cycle >= accepted_cycle) {
            self.marks.pop_back();
        }
        self.marks.push_back((accepted_cycle, digest));
        let oldest = accepted_cycle.saturating_sub(FARTHEST_CHECKPOINT);
        while self.marks.len() > 1 && self.marks.front().is_some_and(|(cycle, _)| *cycle + 1 < oldest) {
            self.marks.pop_front();
        }
    }

    /// Finds out which of the batches that were carried the axis holds, and which it has refused.
    fn settle(&mut self, report: &Report) {
        let of_it = |batch: &Carried| (batch.revision, batch.last_cycle);
        let held = (report.revision, report.accepted_cycle);
        if self.newest.as_ref().map(of_it) != Some(held) {
            // Of those with one end the first was taken: what came after it brought nothing, or was refused.
            let place = self.carried.iter().position(|batch| of_it(batch) == held);
            self.newest = place.and_then(|place| self.carried.remove(place));
        }
        if let Some(refused) = &report.refused {
            let is_refused = |batch: &Carried| {
                (batch.revision, batch.first_cycle) == (refused.revision, refused.first_cycle)
            };
            let place = self.carried.iter().position(is_refused);
            place.and_then(|place| self.carried.remove(place));
        }
        self.carried.retain(|batch| of_it(batch) > held);
    }

    fn adopt(&mut self, motion: Motion) {
        let from = motion.under_way.from_cycle();
        // Where its setpoints are those of the motion before it, so are the digests.
        if from != self.motion.under_way.from_cycle() {
            self.marks.clear();
            self.marks.push_back((from.saturating_sub(1), motion.digest_before));
        }
        self.motion = motion;
    }

    /// The axis has heard no more after `from`, the last cycle that it held, and comes to rest: the motion becomes that, and all of its cycles
    /// count as held. Gives the digest of the last.
    ///
    /// # Errors
    /// A way to rest that did not come with that cycle, or that the judge does not accept.
    pub fn starve(&mut self, from: u64, digest: Digest) -> Result<Digest, Rejected> {
        let revision = self.motion.revision();
        let newest =
            self.newest.take().filter(|batch| (batch.revision, batch.last_cycle) == (revision, from));
        let tails = newest.map(|batch| batch.tails).unwrap_or_default();
        let known = self.marks.iter().rev().find(|(cycle, _)| *cycle < from);
        let first = self.motion.under_way.from_cycle();
        let known = known.copied().unwrap_or((first.saturating_sub(1), self.motion.digest_before));
        let digest_before = self.motion.digest_from(known, from.saturating_sub(1));
        let motion = self.motion.starved(from, &tails, digest_before)?;
        let rests = motion.last_cycle();
        // The farthest from which a server may be asked to check.
        let checkpoint = from.max(rests.saturating_sub(FARTHEST_CHECKPOINT));
        let at_checkpoint = motion.digest_from((from, digest), checkpoint);
        let end = motion.digest_from((checkpoint, at_checkpoint), rests);
        self.motion = motion;
        self.announced = None;
        self.marks = VecDeque::from([(checkpoint, at_checkpoint), (rests, end)]);
        self.carried.clear();
        Ok(end)
    }

    /// What to open with elsewhere.
    #[must_use]
    pub fn resume(&self) -> Resume {
        let (held, digest) = self.mark();
        let first = self.motion.under_way.from_cycle();
        let earliest = first.max((held + 1).saturating_sub(FARTHEST_CHECKPOINT));
        // All that is held and not executed is checked, and no more: a thousand axes may come at once.
        let mut marks = self.marks.iter().rev().filter(|(cycle, _)| *cycle + 1 >= earliest);
        let executed = |(cycle, _): &&(u64, Digest)| *cycle <= self.executed;
        let &(cycle, checkpoint_digest) =
            marks.clone().find(executed).or_else(|| marks.next_back()).unwrap_or(&(held, digest));
        // The digest before cycle 0 is that of cycle 0, which is not in it.
        let checkpoint_cycle = if cycle == 0 && first == 0 { 0 } else { cycle + 1 };
        Resume {
            motion: self.motion.clone(),
            next_cycle: held + 1,
            digest,
            checkpoint_cycle,
            checkpoint_digest,
        }
    }
}
