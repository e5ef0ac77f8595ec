//! What an axis holds, and the rule by which it accepts more. Works in place: no allocation, no waiting, no clock, so that
//! a cycle thread can own it.

use planner::{CycleTime, Plan, Setpoint};
use proto::Digest;
use proto::stream::{Batch, Counters, RefusalReason, Refused, Report, Tails};

use crate::Revision;
use crate::starved::Starved;

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
///
/// # Servers
/// While the axis asks another server to go on ([`Buffer::resuming`]) the old one serves on, but begins no revision: the other one
/// was told of the one that is adopted. With [`Buffer::goes_on`] the new epoch holds, and the old one is over.
///
/// # Hearing no more
/// Every batch brings the way to rest from its last cycle. When that cycle is executed and nothing has come, [`Buffer::starve`] begins to play
/// it, one revision later: its cycles count as accepted, and the epoch is over.
#[derive(Clone, Debug)]
pub struct Buffer {
    adopted: Revision,
    announced: Option<Revision>,
    /// By which cycle it is adopted, or never.
    awaits_until: u64,
    /// Was adopted before: freed where there is time for it.
    retired: Option<Revision>,
    epoch: u64,
    /// New revisions are refused.
    resuming: bool,
    lead: u64,
    guard: u64,
    cycle: CycleTime,
    /// The way to rest from the last cycle that came in a batch.
    tails: Tails,
    starved: Option<Starved>,
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
            awaits_until: 0,
            retired: None,
            epoch: standing.epoch,
            resuming: false,
            lead,
            guard: u64::from(standing.axis_guard),
            cycle: standing.plan.cycle_time(),
            tails: Tails::default(),
            starved: None,
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

    /// The last cycle that the motion was to have: also where a way to rest is played instead.
    #[must_use]
    pub fn was_to_end(&self) -> u64 {
        self.starved.as_ref().map_or(self.adopted.motion_end, Starved::was_to_end)
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

    /// Is the lead under its half, with more of the motion to come?
    #[must_use]
    pub fn is_low(&self) -> bool {
        self.last.is_none() && !self.is_starved() && 2 * self.held() < self.lead
    }

    /// From here on until the next call no revision is begun (or, again, is).
    pub fn resuming(&mut self, resuming: bool) {
        self.resuming = resuming;
    }

    /// Another server goes on under `epoch`; what the old one still says is dropped, and counted. After a way to rest `rested` is the
    /// motion that it has become, as that server was told, and the digest of its end. Gives back what is not needed any more.
    pub fn goes_on(&mut self, epoch: u64, rested: Option<(Revision, Digest)>) -> Option<Revision> {
        self.epoch = epoch;
        self.resuming = false;
        let announced = self.announced.take();
        let (Some((revision, digest)), Some(starved)) = (rested, self.starved.as_mut()) else {
            return announced;
        };
        starved.goes_on(digest);
        self.retired = announced;
        Some(std::mem::replace(&mut self.adopted, revision))
    }

    /// Begins to play the way to rest, since nothing has come; `false` where the axis rests, or has done so before.
    ///
    /// The way is that of the last batch, so every cycle that is held has to be executed.
    pub fn starve(&mut self) -> bool {
        let plays = self.held() == 0 && self.last.is_none() && !self.tails.profiles().is_empty();
        if !plays {
            return false;
        }
        let tails = std::mem::take(&mut self.tails);
        let from = self.executed;
        let (held, left) = ((from, self.digest()), (self.adopted.number, self.adopted.motion_end));
        let starved = Starved::new(tails, self.cycle, held, left);
        self.accepted = starved.last_cycle();
        self.adopted.number += 1;
        self.adopted.motion_end = self.accepted;
        self.adopted.arrives = false;
        self.counters.underruns += 1;
        self.starved = Some(starved);
        true
    }

    /// Is, or was, a way to rest played, with no server that goes on after it?
    #[must_use]
    pub fn is_starved(&self) -> bool {
        self.starved.as_ref().is_some_and(Starved::is_alone)
    }

    fn is_over(&self, epoch: u64) -> bool {
        epoch != self.epoch || self.is_starved()
    }

    /// Is a revision announced and not adopted? Not for longer than two leads: the server has withdrawn it then.
    #[must_use]
    pub fn awaits_revision(&self) -> bool {
        self.announced.is_some() && self.executed < self.awaits_until
    }

    /// Is the last cycle of the stream held, or executed?
    #[must_use]
    pub fn has_last(&self) -> bool {
        self.last.is_some()
    }

    /// Takes note of what the server will send next; of another epoch it is dropped and counted. Gives back what is not needed
    /// any more, to be freed by the caller.
    pub fn announce(&mut self, epoch: u64, revision: Revision) -> Option<Revision> {
        if self.is_over(epoch) {
            self.counters.stale_epochs += 1;
            return Some(revision);
        }
        self.awaits_until = self.executed + 2 * self.lead;
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

    /// The digest of all cycles through the last that was accepted; of a way to rest, through the last before it.
    #[must_use]
    pub fn digest(&self) -> Digest {
        match self.starved.as_ref().filter(|starved| starved.is_alone()) {
            Some(starved) => starved.digest_before(),
            None => self.digest_of(self.accepted),
        }
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
    /// Leaves in it the way to rest that is not needed any more, to be freed by the caller.
    ///
    /// # Errors
    /// What to report to the server at once.
    pub fn accept(&mut self, epoch: u64, batch: &mut Batch) -> Result<(), Refused> {
        if self.is_over(epoch) {
            self.counters.stale_epochs += 1;
            return Ok(());
        }
        self.try_accept(batch).map_err(|reason| {
            self.counters.refused_batches += 1;
            Refused { revision: batch.revision, first_cycle: batch.first_cycle, reason }
        })
    }

    fn try_accept(&mut self, batch: &mut Batch) -> Result<(), RefusalReason> {
        let first = batch.first_cycle;
        let cycles = batch.columns.cycles() as u64;
        if first == 0 || cycles == 0 {
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
        if batch.columns.axes() != self.adopted.rules.len() {
            return Err(RefusalReason::NotFinite);
        }
        let known = if batch.replaces { 0 } else { (self.accepted + 1 - first).min(cycles) };
        self.compare_held(batch, known)?;
        let new = known..cycles;
        self.check_new(batch, new.clone(), begins)?;
        if !new.is_empty() {
            self.check_tails(batch, begins)?;
        }
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
        std::mem::swap(&mut self.tails, &mut batch.tails);
        if let Some(played) = self.starved.take_if(|starved| starved.last_cycle() <= self.executed) {
            batch.tails = played.into_tails();
        }
        Ok(())
    }

    /// Is it the first batch of the revision that is announced, and not one of the adopted revision?
    fn begins_revision(&self, batch: &Batch) -> Result<bool, RefusalReason> {
        if batch.revision == self.adopted.number {
            return Ok(false);
        }
        if self.resuming {
            return Err(RefusalReason::Resuming);
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
        let mut digest = self.digest_of(batch.first_cycle + new.start - 1);
        for index in new.clone() {
            let cycle = batch.first_cycle + index;
            for (axis, (rule, before_it)) in announced.iter().zip(adopted).enumerate() {
                let next = batch.columns.at(axis, index as usize).ok_or(RefusalReason::NotFinite)?;
                let before = if index == new.start {
                    self.setpoint(cycle - 1, axis)
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

    /// Does the way to rest follow from the last setpoint of the batch, and end at rest? After the last batch there is none to go.
    fn check_tails(&self, batch: &Batch, begins: bool) -> Result<(), RefusalReason> {
        let announced = self.announced.as_ref().filter(|_| begins);
        let rules = announced.map_or(&self.adopted.rules, |revision| &revision.rules);
        let last = batch.columns.cycles() - 1;
        let tails = batch.tails.profiles();
        let mut rests = rules.iter().enumerate().map(|(axis, rule)| {
            let Some(setpoint) = batch.columns.at(axis, last) else { return false };
            match tails.get(axis) {
                Some(way) => rule.rests(&setpoint, way),
                None => setpoint.state.is_at_rest(),
            }
        });
        let whole = tails.is_empty() || (tails.len() == rules.len() && !batch.last);
        if whole && rests.all(|rests| rests) { Ok(()) } else { Err(RefusalReason::StopTail) }
    }

    /// Writes one cycle of a batch that has been checked into its place.
    fn hold(&mut self, batch: &Batch, index: usize) {
        let cycle = batch.first_cycle + index as u64;
        let before = self.digest_of(cycle - 1);
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
        self.play_starved();
        if self.last.is_none() && self.accepted < self.adopted.motion_end {
            self.counters.least_lead_cycles = self.counters.least_lead_cycles.min(self.held());
        }
        self.playing()
    }

    /// Puts the next cycle of a way to rest where those of batches stand.
    fn play_starved(&mut self) {
        let (cycle, slot, axes) = (self.executed, self.slot(self.executed), self.adopted.rules.len());
        let before = self.digests[self.slot(cycle - 1)];
        let Some(starved) = self.starved.as_ref().filter(|starved| cycle <= starved.last_cycle()) else {
            return;
        };
        let row = &mut self.rows[slot * axes..(slot + 1) * axes];
        for (place, setpoint) in row.iter_mut().zip(starved.setpoints(cycle)) {
            *place = setpoint;
        }
        self.digests[slot] = before.then(cycle, row.iter().map(Setpoint::words));
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
        if let Some(starved) = self.starved.as_ref().filter(|starved| starved.is_alone()) {
            // Of the epoch that is over: how far its setpoints came.
            let from = starved.after_cycle();
            return Report {
                executed_cycle: from,
                accepted_cycle: from,
                grant_cycle: from,
                revision: starved.revision(),
                digest: starved.digest_before(),
                refused,
                tail_from_cycle: Some(from + 1),
                tracking: None,
                counters: self.counters,
            };
        }
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

    /// The digest of a cycle that is held; of a way to rest, of its end alone.
    fn digest_of(&self, cycle: u64) -> Digest {
        let rests = self.starved.as_ref().and_then(|starved| starved.digest_of_end(cycle));
        rests.unwrap_or_else(|| self.digests[self.slot(cycle)])
    }

    /// The setpoint of an axis at a cycle that is held; of a way to rest, at its end alone.
    fn setpoint(&self, cycle: u64, axis: usize) -> Setpoint {
        let rests = self.starved.as_ref().filter(|starved| starved.last_cycle() == cycle);
        let rests = rests.and_then(|starved| starved.rests(axis));
        rests.unwrap_or_else(|| self.row(cycle)[axis])
    }

    fn slot(&self, cycle: u64) -> usize {
        (cycle % self.digests.len() as u64) as usize
    }

    fn row(&self, cycle: u64) -> &[Setpoint] {
        let (slot, axes) = (self.slot(cycle), self.adopted.rules.len());
        &self.rows[slot * axes..(slot + 1) * axes]
    }
}
