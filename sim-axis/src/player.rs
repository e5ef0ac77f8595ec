use client::{Buffer, Revision};
use planner::Setpoint;
use proto::Digest;
use proto::stream::{Batch, Refused, Report};

use crate::axis::{Axis, Observation};
use crate::monitor::ReportCard;

/// Steps in which a lead is gone through on the way to an operation, where time can wait.
const STEPS: u64 = 8;

/// Several axes that play one stream: everything that a run does, except waiting.
///
/// One [`cycle`](Self::cycle) after the other is a run; whoever calls it is the clock. It allocates nothing, waits for
/// nothing and knows no time, so that a thread with deadlines, a thread that hurries and a test in a `for` get the same
/// numbers, bit for bit.
///
/// ```text
///            the lead is full, or the last
///              cycle is held                     the last cycle was played, or
///  ●─► WAITING ─────────────────────► PLAYING ──── the stream is closed and ────► SETTLING ── window ──► OVER
///         │                          ⟲ starved:       nothing is held                                    ▲
///         │                            counted, held                                                     │
///         └── closed before it began ────────────────────────────────────────────────────────────────────┘
///   any ── an axis diverges ──► OVER
/// ```
///
/// # Starvation
/// A cycle that is due in motion and not held is an underrun. From it on the axis plays the way to rest that came with the last cycle
/// that it held, and then stands still; nothing is extrapolated. Where a server goes on after that, play goes on with it. An axis
/// at rest that hears no more stands still, and has lost nothing: the number of the next cycle stays due.
#[derive(Clone, Debug)]
pub struct Player {
    buffer: Buffer,
    axes: Vec<Axis>,
    setpoints: Vec<Setpoint>,
    observations: Vec<Observation>,
    batch_cycles: u64,
    phase: Phase,
    /// Nothing more will come.
    closed: bool,
    /// The last setpoint of the motion was given.
    watches_rest: bool,
    rested: u64,
    digest: Digest,
    reported: u64,
    /// The revision of the last report.
    told_revision: u64,
    /// The last cycle that was held when the server was last told that the lead is low.
    told_low: Option<u64>,
    /// The server is to hear at once.
    urgent: bool,
    tail_used: bool,
    refused: Option<Place>,
    diverged: Option<Divergence>,
}

/// An axis that has left its setpoints beyond any sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Divergence {
    /// Which axis, in plan order.
    pub axis: usize,
    /// In which cycle.
    pub cycle: u64,
}

/// What one cycle did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beat {
    /// Nothing, since execution has not begun.
    Waited,
    /// The servo was given the next setpoint.
    Played,
    /// The next setpoint was due and not held.
    Starved,
    /// The axis stood still in the settle window.
    Rested,
    /// An axis left its setpoints beyond any sense, and the run is over.
    Diverged,
    /// Nothing, since the run is over.
    Over,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Waiting,
    Playing,
    Settling,
    Over,
}

/// Where a batch was refused.
#[derive(Clone, Copy, Debug)]
struct Place {
    accepted: u64,
    first_cycle: u64,
}

impl Player {
    /// `axes` in plan order, for a motion whose last cycle is `motion_end`; reports every `batch_cycles`.
    #[must_use]
    pub fn new(mut buffer: Buffer, axes: Vec<Axis>, motion_end: u64, batch_cycles: u64) -> Self {
        buffer.motion_ends_at(motion_end);
        Self {
            buffer,
            setpoints: vec![Setpoint::default(); axes.len()],
            observations: vec![Observation::default(); axes.len()],
            axes,
            batch_cycles: batch_cycles.max(1),
            phase: Phase::Waiting,
            closed: false,
            watches_rest: false,
            rested: 0,
            digest: Digest::ZERO,
            reported: 0,
            told_revision: 0,
            told_low: None,
            urgent: false,
            tail_used: false,
            refused: None,
            diverged: None,
        }
    }

    /// Takes a batch by the accept rule, and gives the report that is due at once if it cannot be taken.
    ///
    /// Of several batches of one sending, the first that is refused is reported: those behind it are refused too, for the
    /// gap that it left, and are counted.
    pub fn accept(&mut self, epoch: u64, batch: &mut Batch) -> Option<Report> {
        let adopted = self.buffer.revision();
        let Err(refused) = self.buffer.accept(epoch, batch) else {
            if self.buffer.revision() != adopted {
                self.go_on();
            }
            return None;
        };
        let Refused { first_cycle, .. } = refused;
        let accepted = self.buffer.accepted();
        let is_behind =
            self.refused.is_some_and(|last| last.accepted == accepted && first_cycle > last.first_cycle);
        self.refused = Some(Place { accepted, first_cycle });
        (!is_behind).then(|| self.buffer.report(Some(refused)))
    }

    /// Takes note of what the server will send next. Gives back what is not needed any more, to be freed by the caller.
    pub fn announce(&mut self, epoch: u64, revision: Revision) -> Option<Revision> {
        self.refused = None;
        self.buffer.announce(epoch, revision)
    }

    /// Begins no revision any more, until another server goes on or [`stays`](Self::stays); a report is due, which says so.
    pub fn resuming(&mut self) {
        self.buffer.resuming(true);
        self.urgent = true;
    }

    /// The server stays.
    pub fn stays(&mut self) {
        self.buffer.resuming(false);
    }

    /// Another server goes on, as [`Buffer::goes_on`] says.
    pub fn goes_on(&mut self, epoch: u64, rested: Option<(Revision, Digest)>) -> Option<Revision> {
        (self.urgent, self.refused, self.told_low) = (true, None, None);
        self.buffer.goes_on(epoch, rested)
    }

    /// Was a way to rest played?
    #[must_use]
    pub fn tail_used(&self) -> bool {
        self.tail_used
    }

    /// The motion goes on where it had come to rest.
    fn go_on(&mut self) {
        if self.watches_rest && !self.buffer.is_at_rest() {
            self.watches_rest = false;
            self.axes.iter_mut().for_each(Axis::go_on);
        }
    }

    /// Nothing more will come: what is held is played, then the axis rests.
    pub fn close(&mut self) {
        self.closed = true;
    }

    /// One cycle of all axes: take the setpoint, step, observe.
    pub fn cycle(&mut self) -> Beat {
        if self.phase == Phase::Waiting {
            self.begin();
        }
        match self.phase {
            Phase::Waiting => Beat::Waited,
            Phase::Playing => self.play(),
            Phase::Settling => self.rest(),
            Phase::Over => Beat::Over,
        }
    }

    /// Would a cycle now come too early for whoever can wait: has execution not begun, or is more to come and no more than half the lead
    /// held? An axis that hurries through half of it and then waits asks for no more than its credit, and the least lead that it
    /// reports is one that it needed. At rest too: what an operation begins there has to find room ahead of it.
    ///
    /// Within reach of an operation that is asked for and not answered it goes in small steps, so that the server, which measures its way to
    /// the axis in the axis's cycles, does not find that way many times as long from one report to the next and come too late.
    ///
    /// Where the last cycle is held, an operation that is asked for and not answered may still change that: `asked_from` is the first cycle at
    /// which one may take effect, `u64::MAX` where there is none.
    #[must_use]
    pub fn is_short_of_data(&self, asked_from: u64) -> bool {
        match self.phase {
            Phase::Waiting => !self.buffer.is_ready() && !self.closed,
            Phase::Playing => {
                let asked = asked_from <= self.buffer.accepted();
                let goes_on = !self.buffer.has_last();
                let lead = self.buffer.lead();
                let enough = if asked && goes_on { lead - lead / STEPS } else { lead / 2 };
                !self.closed && (asked || goes_on) && self.buffer.held() <= enough
            }
            Phase::Settling | Phase::Over => false,
        }
    }

    /// Does the axis rest, at the end of its motion or held, watched to the end of the settle window, on a stream that stays open?
    #[must_use]
    pub fn is_at_standstill(&self) -> bool {
        self.phase == Phase::Playing && !self.closed && self.buffer.is_at_rest() && self.is_settled()
    }

    /// Which axis has left its setpoints beyond any sense, where one has.
    #[must_use]
    pub fn divergence(&self) -> Option<Divergence> {
        self.diverged
    }

    /// Has execution not begun?
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        self.phase == Phase::Waiting
    }

    /// Is there nothing more to do?
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.phase == Phase::Over
    }

    /// Was the motion played to its last cycle, and is there nothing that it was held from?
    #[must_use]
    pub fn has_arrived(&self) -> bool {
        self.buffer.has_arrived()
    }

    /// The number of the last cycle, counted on while the axis settles.
    #[must_use]
    pub fn cycle_number(&self) -> u64 {
        self.buffer.executed() + self.rested
    }

    /// What the servos were last given, in plan order.
    #[must_use]
    pub fn setpoints(&self) -> &[Setpoint] {
        &self.setpoints
    }

    /// What the axes did with it, in plan order.
    #[must_use]
    pub fn observations(&self) -> &[Observation] {
        &self.observations
    }

    /// What is held, and how the stream has gone.
    #[must_use]
    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// The digest of the motion as far as it was played; cycles at rest after it are not in it.
    #[must_use]
    pub fn digest(&self) -> Digest {
        self.digest
    }

    /// How each axis has done. Takes milliseconds: not for a control cycle. Where the motion broke off no axis has settled,
    /// since none is where it was to go.
    #[must_use]
    pub fn report_cards(&self) -> Vec<ReportCard> {
        let card = |axis: &Axis| {
            let card = axis.report();
            ReportCard { settling_time: card.settling_time.filter(|_| self.has_arrived()), ..card }
        };
        self.axes.iter().map(card).collect()
    }

    /// The report to the server, when a batch has been executed since the last one; and at once when a revision was adopted,
    /// since somebody waits for that.
    pub fn report_due(&mut self) -> Option<Report> {
        let executed = self.buffer.executed();
        let is_last = self.buffer.is_finished() || self.is_at_standstill();
        let revision = self.buffer.revision();
        // Whoever looks for another server is to hear of a low lead while there is some left; once.
        let low = self.buffer.is_low().then(|| self.buffer.accepted());
        let is_low = low.is_some() && low != self.told_low;
        let is_due = executed >= self.reported + self.batch_cycles
            || (is_last && executed > self.reported)
            || revision != self.told_revision
            || (is_low && self.phase == Phase::Playing)
            || self.urgent;
        if is_due {
            (self.reported, self.told_revision) = (executed, revision);
            (self.told_low, self.urgent) = (low.or(self.told_low), false);
        }
        is_due.then(|| self.buffer.report(None))
    }

    /// From now on every drive has `scale` of its effort limit; nothing where that is no share, 0 to 1.
    pub fn scale_effort_limits(&mut self, scale: f64) {
        for axis in &mut self.axes {
            // Whoever asks has been told what a share is.
            let _ = axis.scale_effort_limit(scale);
        }
    }

    /// Counts a cycle that began late.
    pub fn count_late(&mut self) {
        self.buffer.count_late();
    }

    fn begin(&mut self) {
        if self.buffer.is_ready() {
            self.phase = Phase::Playing;
        } else if self.closed {
            // A motion that is known to break off is not begun; one of no cycles has ended.
            self.phase = if self.buffer.motion_end() == 0 { Phase::Settling } else { Phase::Over };
        } else {
            return;
        }
        if self.buffer.motion_end() == 0 {
            self.watch_rest();
        }
        self.end_if_settled();
    }

    fn play(&mut self) -> Beat {
        if self.buffer.held() == 0 && !self.buffer.is_at_rest() && self.buffer.starve() {
            (self.tail_used, self.urgent) = (true, true);
        }
        let motion_end = self.buffer.motion_end();
        let Some(playing) = self.buffer.play() else { return self.starve() };
        let cycle = playing.cycle;
        if cycle <= motion_end {
            self.digest = playing.digest;
        }
        self.setpoints.copy_from_slice(playing.setpoints);
        for ((axis, setpoint), seen) in self.axes.iter_mut().zip(&self.setpoints).zip(&mut self.observations)
        {
            *seen = axis.step(&setpoint.state);
        }
        if self.ends_diverged(cycle) {
            return Beat::Diverged;
        }
        if cycle == motion_end {
            self.watch_rest();
        }
        if self.buffer.is_finished() {
            self.settle();
        }
        Beat::Played
    }

    /// Stands still, since there is nothing to play.
    fn starve(&mut self) -> Beat {
        if !self.buffer.is_at_rest() {
            // A server that sent no way to rest.
            self.buffer.count_underrun();
        }
        if self.closed {
            self.settle();
            return if self.is_over() { Beat::Over } else { self.rest() };
        }
        self.hold();
        if self.ends_diverged(self.cycle_number() + 1) { Beat::Diverged } else { Beat::Starved }
    }

    fn rest(&mut self) -> Beat {
        self.hold();
        if self.ends_diverged(self.cycle_number() + 1) {
            return Beat::Diverged;
        }
        self.rested += 1;
        self.end_if_settled();
        Beat::Rested
    }

    /// Ends the run if an axis has diverged in `cycle`.
    fn ends_diverged(&mut self, cycle: u64) -> bool {
        let Some(axis) = self.observations.iter().position(|seen| seen.diverged) else { return false };
        self.diverged = Some(Divergence { axis, cycle });
        self.phase = Phase::Over;
        true
    }

    fn hold(&mut self) {
        for ((axis, setpoint), seen) in
            self.axes.iter_mut().zip(&mut self.setpoints).zip(&mut self.observations)
        {
            *seen = axis.rest();
            *setpoint = Setpoint::held(planner::State::at_rest(setpoint.state.position));
        }
    }

    fn settle(&mut self) {
        if !self.watches_rest {
            self.watch_rest();
        }
        self.phase = Phase::Settling;
        self.end_if_settled();
    }

    fn watch_rest(&mut self) {
        self.watches_rest = true;
        self.axes.iter_mut().for_each(Axis::begin_settling);
    }

    fn end_if_settled(&mut self) {
        if self.phase == Phase::Settling && self.is_settled() {
            self.phase = Phase::Over;
        }
    }

    fn is_settled(&self) -> bool {
        self.axes.iter().all(Axis::settle_window_is_over)
    }
}
