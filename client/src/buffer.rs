//! What an axis holds, and the rule by which it accepts more. Works in place: no allocation, no waiting, no clock, so that
//! a cycle thread can own it.

use planner::{Plan, Setpoint};
use proto::Digest;
use proto::stream::{Batch, Counters, RefusalReason, Refused, Report};

use crate::Revision;

/// The setpoints that an axis holds, from the last one that it executed to the last one that it accepted.
///
/// ```text
///  executed          accepted = executed + lead at most
///     │  ○ ○ ○ ○ ○ ○ ○ ○ │
///     ▼                  ▼
///  ───●──────────────────●───► cycles       a batch begins at accepted + 1, or replaces what is held
///                                           beyond executed + guard
/// ```
///
/// # Revisions
/// What the server announces is [announced](Self::announce) here, and adopted with the first batch of it that is accepted: from
/// then on nothing of the revision before it is. A batch that is refused adopts nothing and changes nothing.
#[derive(Clone, Debug)]
pub struct Buffer {
    adopted: Revision,
    announced: Option<Revision>,
    /// Was adopted before: freed where there is time for it.
    retired: Option<Revision>,
    epoch: u64,
    lead: u64,
    guard: u64,
    /// Ring: the row of cycle c begins at (c mod capacity) · axes. Holds executed ..= accepted.
    rows: Vec<Setpoint>,
    digests: Vec<Digest>,
    executed: u64,
    accepted: u64,
    /// The cycle after which nothing follows, once it is known.
    last: Option<u64>,
    counters: Counters,
}

/// Where an axis stands when it opens a stream.
#[derive(Clone, Debug)]
pub struct Standing<'a> {
    /// Under which epoch it opens.
    pub epoch: u64,
    /// How far ahead it wants to hold setpoints \[cycles\].
    pub lead_cycles: u32,
    /// How far beyond the executed cycle a replacing batch begins \[cycles\].
    pub axis_guard: u32,
    /// The plan that it opens with.
    pub plan: &'a Plan,
    /// Its own commanded state, axis by axis: cycle 0.
    pub setpoints: &'a [Setpoint],
}

/// One cycle that is to be given to the servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Playing<'a> {
    /// Its number.
    pub cycle: u64,
    /// One setpoint for each axis, in plan order.
    pub setpoints: &'a [Setpoint],
    /// The digest of all cycles through this one.
    pub digest: Digest,
}

impl Buffer {
    /// An axis that stands, and holds nothing yet.
    #[must_use]
    pub fn new(standing: &Standing<'_>) -> Self {
        let adopted = Revision::opened(standing.plan);
        let axes = adopted.rules.len();
        let lead = u64::from(standing.lead_cycles.max(1));
        // The executed cycle is held besides, since the next one has to join it.
        let capacity = lead as usize + 1;
        let mut rows = vec![Setpoint::default(); capacity * axes];
        for (row, setpoint) in rows.iter_mut().zip(standing.setpoints).take(axes) {
            *row = *setpoint;
        }
        Self {
            adopted,
            announced: None,
            retired: None,
            epoch: standing.epoch,
            lead,
            guard: u64::from(standing.axis_guard),
            rows,
            digests: vec![Digest::ZERO; capacity],
            executed: 0,
            accepted: 0,
            last: None,
            counters: Counters { least_lead_cycles: lead, ..Counters::default() },
        }
    }

    /// The motion is at rest from `cycle` on: once that is held, a small lead does no harm, and is not counted.
    pub fn motion_ends_at(&mut self, cycle: u64) {
        self.adopted.motion_end = cycle;
    }

    /// The cycle from which the adopted motion is at rest, where that is known.
    #[must_use]
    pub fn motion_end(&self) -> u64 {
        self.adopted.motion_end
    }

    /// Is the motion at rest, with nothing of it to come but what an operation asks for?
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        self.executed >= self.adopted.motion_end
    }

    /// Is it at rest where it was to go, and not held on its way?
    #[must_use]
    pub fn has_arrived(&self) -> bool {
        self.is_at_rest() && self.adopted.arrives
    }

    /// The revision of the motion that is adopted.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.adopted.number
    }

    /// Is a revision announced and not adopted?
    #[must_use]
    pub fn awaits_revision(&self) -> bool {
        self.announced.is_some()
    }

    /// Takes note of what the server will send next; of another epoch it is dropped and counted. Gives back what is not needed
    /// any more, to be freed by the caller.
    pub fn announce(&mut self, epoch: u64, revision: Revision) -> Option<Revision> {
        if epoch != self.epoch {
            self.counters.stale_epochs += 1;
            return Some(revision);
        }
        // What was announced before was refused, or the server would not announce again.
        self.announced.replace(revision).or_else(|| self.retired.take())
    }

    /// How many cycles are held at most.
    #[must_use]
    pub fn lead(&self) -> u64 {
        self.lead
    }

    /// The last cycle that was given to the servo.
    #[must_use]
    pub fn executed(&self) -> u64 {
        self.executed
    }

    /// The last cycle that is held.
    #[must_use]
    pub fn accepted(&self) -> u64 {
        self.accepted
    }

    /// How many cycles are held and not executed.
    #[must_use]
    pub fn held(&self) -> u64 {
        self.accepted - self.executed
    }

    /// May execution begin: is the lead full, or is there no more to come?
    #[must_use]
    pub fn is_ready(&self) -> bool {
        self.held() >= self.lead || self.last.is_some()
    }

    /// Has the last cycle been executed, after which nothing follows?
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.last == Some(self.executed)
    }

    /// The digest of all cycles through the last that was accepted.
    #[must_use]
    pub fn digest(&self) -> Digest {
        self.digests[self.slot(self.accepted)]
    }

    /// How the stream has gone so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Counts a cycle that was due and not held.
    pub fn count_underrun(&mut self) {
        self.counters.underruns += 1;
    }

    /// Counts a cycle that began late.
    pub fn count_late(&mut self) {
        self.counters.late_cycles += 1;
    }

    /// Takes a batch, or says why not and keeps what is held. A batch of another epoch is dropped, and counted: `Ok`.
    ///
    /// # Errors
    /// What to report to the server at once.
    pub fn accept(&mut self, epoch: u64, batch: &Batch) -> Result<(), Refused> {
        if epoch != self.epoch {
            self.counters.stale_epochs += 1;
            return Ok(());
        }
        self.try_accept(batch).map_err(|reason| {
            self.counters.refused_batches += 1;
            Refused { revision: batch.revision, first_cycle: batch.first_cycle, reason }
        })
    }

    fn try_accept(&mut self, batch: &Batch) -> Result<(), RefusalReason> {
        let first = batch.first_cycle;
        let cycles = batch.columns.cycles() as u64;
        if first == 0 || cycles == 0 || batch.columns.axes() != self.adopted.rules.len() {
            return Err(RefusalReason::NotFinite);
        }
        let begins = self.begins_revision(batch)?;
        if first > self.accepted + 1 {
            return Err(RefusalReason::Gap);
        }
        if batch.replaces && first <= self.executed + self.guard {
            return Err(RefusalReason::TooLate);
        }
        let end = first.checked_add(cycles - 1).ok_or(RefusalReason::BeyondGrant)?;
        if end > self.executed + self.lead {
            return Err(RefusalReason::BeyondGrant);
        }
        let known = if batch.replaces { 0 } else { (self.accepted + 1 - first).min(cycles) };
        self.compare_held(batch, known)?;
        let new = known..cycles;
        self.check_new(batch, new.clone(), begins)?;
        self.counters.duplicate_cycles += known;
        if begins {
            self.adopt();
        }
        if new.is_empty() {
            return Ok(());
        }
        for index in new {
            self.hold(batch, index as usize);
        }
        self.accepted = end;
        self.last = batch.last.then_some(end);
        Ok(())
    }

    /// Is it the first batch of the revision that is announced, and not one of the adopted revision?
    fn begins_revision(&self, batch: &Batch) -> Result<bool, RefusalReason> {
        if batch.revision == self.adopted.number {
            return Ok(false);
        }
        let announced = self.announced.as_ref().filter(|announced| announced.number == batch.revision);
        let announced = announced.ok_or(RefusalReason::Revision)?;
        let first = batch.first_cycle;
        if !announced.begins_at(first, &self.adopted) {
            return Err(RefusalReason::Revision);
        }
        let held = first > self.executed && first <= self.accepted + 1;
        let parts = first == announced.from_cycle && held;
        if parts && self.digests[self.slot(first - 1)] != announced.digest_before {
            return Err(RefusalReason::DigestMismatch);
        }
        Ok(true)
    }

    fn adopt(&mut self) {
        if let Some(announced) = self.announced.take() {
            self.retired = Some(std::mem::replace(&mut self.adopted, announced));
        }
    }

    /// Are the first `known` cycles of the batch those that are held? What has been executed is not held any more, and
    /// answered for by the digest of what follows.
    fn compare_held(&self, batch: &Batch, known: u64) -> Result<(), RefusalReason> {
        for index in 0..known {
            let cycle = batch.first_cycle + index;
            if cycle < self.executed {
                continue;
            }
            let same = batch
                .columns
                .cycle(index as usize)
                .zip(self.row(cycle))
                .all(|(new, held)| new.words().map(f64::to_bits) == held.words().map(f64::to_bits));
            if !same {
                return Err(RefusalReason::DigestMismatch);
            }
        }
        Ok(())
    }

    /// Are the cycles at `new` finite, does each join the one before it, and do they have the digest that is claimed?
    ///
    /// Where a revision begins, its first cycle still belongs to the motion before it: it is the end of the last cycle of that.
    fn check_new(&self, batch: &Batch, new: std::ops::Range<u64>, begins: bool) -> Result<(), RefusalReason> {
        let adopted = &self.adopted.rules;
        let announced =
            self.announced.as_ref().filter(|_| begins).map_or(adopted, |revision| &revision.rules);
        let mut digest = self.digests[self.slot(batch.first_cycle + new.start - 1)];
        for index in new.clone() {
            let cycle = batch.first_cycle + index;
            for (axis, (rule, before_it)) in announced.iter().zip(adopted).enumerate() {
                let next = batch.columns.at(axis, index as usize).ok_or(RefusalReason::NotFinite)?;
                let before = if index == new.start {
                    self.row(cycle - 1)[axis]
                } else {
                    batch.columns.at(axis, index as usize - 1).ok_or(RefusalReason::NotFinite)?
                };
                if !next.is_finite() {
                    return Err(RefusalReason::NotFinite);
                }
                let is_first = begins && index == new.start;
                if !(rule.joins(&before, &next) || (is_first && before_it.joins(&before, &next))) {
                    return Err(RefusalReason::JoinMismatch);
                }
            }
            digest = digest.then(cycle, batch.columns.cycle(index as usize).map(|setpoint| setpoint.words()));
        }
        if !new.is_empty() && digest != batch.digest {
            return Err(RefusalReason::DigestMismatch);
        }
        Ok(())
    }

    /// Writes one cycle of a batch that has been checked into its place.
    fn hold(&mut self, batch: &Batch, index: usize) {
        let cycle = batch.first_cycle + index as u64;
        let before = self.digests[self.slot(cycle - 1)];
        let slot = self.slot(cycle);
        let axes = self.adopted.rules.len();
        for (place, setpoint) in
            self.rows[slot * axes..(slot + 1) * axes].iter_mut().zip(batch.columns.cycle(index))
        {
            *place = setpoint;
        }
        let words = batch.columns.cycle(index).map(|setpoint| setpoint.words());
        self.digests[slot] = before.then(cycle, words);
    }

    /// The next cycle for the servo; `None` if none is held.
    pub fn play(&mut self) -> Option<Playing<'_>> {
        if self.executed == self.accepted {
            return None;
        }
        self.executed += 1;
        if self.last.is_none() && self.accepted < self.adopted.motion_end {
            self.counters.least_lead_cycles = self.counters.least_lead_cycles.min(self.held());
        }
        self.playing()
    }

    /// The cycle that was last given to the servo; `None` before the first.
    #[must_use]
    pub fn playing(&self) -> Option<Playing<'_>> {
        let cycle = self.executed;
        let playing = Playing { cycle, setpoints: self.row(cycle), digest: self.digests[self.slot(cycle)] };
        (cycle > 0).then_some(playing)
    }

    /// What the axis says of itself: how far it is, and how far it may be sent.
    #[must_use]
    pub fn report(&self, refused: Option<Refused>) -> Report {
        Report {
            executed_cycle: self.executed,
            accepted_cycle: self.accepted,
            grant_cycle: self.executed + self.lead,
            revision: self.adopted.number,
            digest: self.digest(),
            refused,
            tail_from_cycle: None,
            tracking: None,
            counters: self.counters,
        }
    }

    fn slot(&self, cycle: u64) -> usize {
        (cycle % self.digests.len() as u64) as usize
    }

    fn row(&self, cycle: u64) -> &[Setpoint] {
        let (slot, axes) = (self.slot(cycle), self.adopted.rules.len());
        &self.rows[slot * axes..(slot + 1) * axes]
    }
}
