//! One stream, as a pure function of the messages that came: no clock, no socket, no task. The axis's reports are the
//! session's clock.
//!
//! ```text
//!   open                        the plan has been executed
//!  ●────► MOVING ──────────────────────────────────────────► STANDSTILL   (setpoints at rest go on)
//!           │ ▲  ◄──────────────── retarget ─────────────────┘    │ hold
//!      hold │ │ resume                                            │
//!           ▼ │                                                   │
//!          HOLDING ◄──────────────────────────────────────────────┘
//!
//!   MOVING, HOLDING ── stop ──► STOPPING ── at rest ──► FINISHED
//!   close_at_rest: the plan has been executed ──► FINISHED ◄── the axis closes its side
//!   any ── a newer epoch has opened ──► ENDED        any ── drain ──► same phase, the axis is told once
//! ```
//!
//! What an operation makes of a motion is for `planner::motion` to say; here it is decided when, and what may be sent:
//!
//! ```text
//!              due                     its first batch goes out            the report shows its revision
//!  WAITING ──────────► PLANNED ──────────────────────────────────► SENT ─────────────────────────────────► adopted, answered
//!     ▲                   │ refused by the planner: answered         │
//!     └───────────────────┴───────── refused by the axis ────────────┘   three times: answered
//! ```
//!
//! One splice is in flight at a time. What the axis has adopted is what holds; until it says that it has adopted a splice, that
//! is a branch beside it.

mod branch;
mod credit;
mod event;
mod ledger;
mod opening;
mod operations;
mod pace;
mod queue;
mod splice;

use std::collections::VecDeque;

use proto::stream::{
    BATCH_CYCLES, Batch, FromAxis, Motion, Open, Opened, OperationResult, Phase, Report, Source, StreamEvent,
    StreamEventKind, ToAxis,
};
use proto::{Reason, Rejected};

use branch::Branch;
use credit::Credit;
pub use event::{Answer, Event, Output};
use opening::Opening;
use pace::Pace;
use queue::{Asker, Queue};
use splice::{Splice, Turn};

/// How often a batch, or a splice, is sent again that the axis does not take, before the session gives up.
const MOST_REFUSALS: u32 = 3;
/// Messages that wait to be sent before no more is read from the axis.
const MOST_UNSENT: usize = 64;

/// One open stream.
#[derive(Debug)]
pub struct Session {
    /// What the axis has adopted.
    adopted: Branch,
    /// What it is to adopt.
    splice: Option<Splice>,
    queue: Queue,
    /// What became of the last operations, also of those that changed nothing.
    recent: Vec<OperationResult>,
    /// When the last of them took effect, which may be still to come: nothing is done before it.
    effective: u64,
    close_at_rest: bool,
    /// The axis evaluates the motion itself.
    compact: bool,
    batch_cycles: u64,
    credit: Credit,
    pace: Pace,
    /// Refusals of batches since one was taken.
    refusals: u32,
    /// Where the axis was last told to stand still.
    stands_at: Option<u64>,
    finished: bool,
    drained: bool,
    ended: bool,
    /// What is to be said before any further batch.
    outbox: VecDeque<Output>,
    answers: VecDeque<Answer>,
}

impl Session {
    /// Opens a stream for an axis that stands in the plan's first state; or goes on with one that another server has served, at the
    /// next cycle, with the same bits.
    ///
    /// # Errors
    /// A plan that guarantees too little, or whose closing stop leaves the position range; an axis that has already
    /// executed something of a new plan. Of a motion under way, [`Reason::ResumePastEnd`], and [`Reason::DigestMismatch`] where the
    /// axis does not hold the setpoints that are planned here.
    pub fn open(open: Open, served_by: &str) -> Result<Self, Rejected> {
        let Open { epoch, lead_cycles, batch_cycles, axis_guard, close_at_rest, compact, .. } = open;
        let begins = matches!(open.source, Source::Plan(_));
        let Opening { branch, credit, first_cycle } = Opening::of(open)?;
        let motion = begins.then(|| branch.motion.clone());
        let recent = branch.motion.recent.to_vec();
        let effective = recent.last().map_or(0, |result| result.effective_cycle);
        let effective = effective.max(branch.motion.under_way.from_cycle());
        let opened = Opened { motion, first_cycle, served_by: served_by.into(), current_epoch: epoch };
        let batch_cycles = u64::from(batch_cycles.clamp(*BATCH_CYCLES.start(), *BATCH_CYCLES.end()));
        let mut session = Self {
            adopted: branch,
            splice: None,
            queue: Queue::default(),
            recent,
            effective,
            close_at_rest,
            compact,
            batch_cycles,
            credit,
            pace: Pace::new(u64::from(axis_guard), batch_cycles.min(u64::from(lead_cycles))),
            refusals: 0,
            stands_at: None,
            finished: false,
            drained: false,
            ended: false,
            outbox: VecDeque::from([Output::Send(ToAxis::Opened(Box::new(opened)))]),
            answers: VecDeque::new(),
        };
        // Where nothing moves there is no cycle to send, and none to wait for.
        session.observe_end();
        Ok(session)
    }

    /// What the stream is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        let phase = self.adopted.motion.under_way.phase_at(self.credit.executed());
        if self.finished { Phase::Finished } else { phase }
    }

    /// The motion that the axis has adopted.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.adopted.motion
    }

    /// Is there nothing more to come?
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.ended && self.outbox.is_empty()
    }

    /// Has the session decided to end, though not everything is said yet?
    #[must_use]
    pub fn is_ending(&self) -> bool {
        self.ended
    }

    /// Is so much unsent that the axis is to read before it says more?
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.outbox.len() >= MOST_UNSENT
    }

    /// Would [`poll_output`](Self::poll_output) give something?
    #[must_use]
    pub fn has_output(&self) -> bool {
        !self.outbox.is_empty() || (!self.ended && self.has_batch())
    }

    /// Takes one thing that happened. Nothing is sent here: ask [`poll_output`](Self::poll_output) and
    /// [`poll_answer`](Self::poll_answer).
    pub fn handle(&mut self, event: Event) {
        match event {
            Event::Command { ticket, operation } => self.operate(Asker::Commander(ticket), operation),
            _ if self.ended => {}
            Event::FromAxis(FromAxis::Report(report)) => self.report(&report),
            Event::FromAxis(FromAxis::Operation(operation)) => self.operate(Asker::Axis, operation),
            Event::FromAxis(FromAxis::Open(_)) => {
                let text = "a stream is opened once: send reports, or open another stream";
                self.end(Err(Rejected::new(Reason::ProtocolOrder, text)));
            }
            Event::Unreadable(rejected) => self.end(Err(rejected)),
            Event::AxisClosed => self.end(Ok(())),
            Event::Superseded { by } => {
                self.tell(StreamEventKind::Superseded, self.credit.executed());
                let text = format!("the stream was opened again under epoch {by}: this one is over");
                self.end(Err(Rejected::new(Reason::EpochSuperseded, text).with("current_epoch", by)));
            }
            Event::Leave => {
                let text = "this server has left: open the stream on another";
                self.end(Err(Rejected::new(Reason::Draining, text)));
            }
            Event::Watched(true) => self.tell(StreamEventKind::TrackingWanted, self.credit.executed()),
            Event::Watched(false) => self.tell(StreamEventKind::TrackingUnwanted, self.credit.executed()),
            Event::Drain if self.drained => {}
            Event::Drain => {
                self.drained = true;
                self.tell(StreamEventKind::Draining, self.credit.executed());
            }
        }
    }

    /// The next thing to say to the axis, if there is one. A batch is made when it is asked for, so that what a slow axis has
    /// not taken costs no memory.
    pub fn poll_output(&mut self) -> Option<Output> {
        if let Some(output) = self.outbox.pop_front() {
            return Some(output);
        }
        if self.ended {
            return None;
        }
        match self.next_batch()? {
            Ok(batch) => Some(Output::Send(ToAxis::Batch(batch))),
            Err(rejected) => {
                self.end(Err(rejected));
                self.outbox.pop_front()
            }
        }
    }

    /// What became of a command, if that is known of one.
    pub fn poll_answer(&mut self) -> Option<Answer> {
        self.answers.pop_front()
    }

    fn report(&mut self, report: &Report) {
        if let Err(rejected) = self.credit.report(report) {
            return self.end(Err(rejected));
        }
        let accepted = report.accepted_cycle;
        self.pace.reported(accepted, report.executed_cycle);
        let sent = self.splice.as_ref().filter(|splice| splice.sent().is_some());
        let confirms = sent.is_some_and(|splice| splice.branch.revision() == report.revision);
        let branch = match sent {
            Some(splice) if confirms => &splice.branch,
            _ => &self.adopted,
        };
        if report.revision != branch.revision() {
            let text = format!(
                "the report is of revision {}, and the motion is revision {}",
                report.revision,
                branch.revision()
            );
            return self.end(Err(Rejected::new(Reason::ProtocolOrder, text)));
        }
        let ours = branch.digest_at(accepted);
        if report.digest != ours {
            let text = format!(
                "the setpoints through cycle {accepted} have digest {} at the axis and {ours} here: open the \
                 stream again",
                report.digest
            );
            return self.end(Err(Rejected::new(Reason::DigestMismatch, text).with("cycle", accepted)));
        }
        if confirms {
            self.confirm();
        }
        self.adopted.forget_before(report.executed_cycle);
        if report.tail_from_cycle.is_some() {
            return self.end(Ok(()));
        }
        if let Err(rejected) = self.take_refusal(report) {
            return self.end(Err(rejected));
        }
        self.observe_end();
        self.advance();
    }

    /// Sends again what the axis has not taken.
    fn take_refusal(&mut self, report: &Report) -> Result<(), Rejected> {
        if let Some(splice) = self.splice.as_ref()
            && let Some((first, _)) = splice.sent()
        {
            let is_refused = report.refused.as_ref().is_some_and(|refused| {
                let of_before = refused.revision == report.revision;
                splice.is_refused_by(refused) || (of_before && splice.needs_what_was_sent())
            });
            // Where its first cycle was executed as it was before, it has come to nothing, whatever was said.
            if is_refused || report.executed_cycle >= first {
                self.withdraw(report.accepted_cycle);
            }
            // Anything else is about what it replaces, or about what follows on it.
            return Ok(());
        }
        let Some(refused) = report.refused.as_ref() else {
            self.refusals = 0;
            return Ok(());
        };
        if refused.revision != self.adopted.revision() {
            // Of a splice that was withdrawn.
            return Ok(());
        }
        self.refusals += 1;
        if self.refusals >= MOST_REFUSALS {
            let (cycle, why) = (refused.first_cycle, refused.reason.name());
            let text = format!("the axis has refused cycle {cycle} {MOST_REFUSALS} times: {why}");
            return Err(Rejected::new(Reason::NotConfirmed, text).with("cycle", cycle));
        }
        self.send_again_after(report.accepted_cycle);
        Ok(())
    }

    fn send_again_after(&mut self, accepted: u64) {
        self.credit.send_again_after(accepted);
        self.pace.forget_after(accepted);
        self.adopted.forget_after(accepted);
    }

    /// Notices that the motion has come to its end.
    fn observe_end(&mut self) {
        let executed = self.credit.executed();
        let last = self.adopted.motion.last_cycle();
        if self.adopted.end(self.close_at_rest).is_some_and(|end| executed >= end) {
            self.finished = true;
            self.tell(StreamEventKind::Finished, last);
            self.leave_too_late();
            self.end(Ok(()));
        } else if self.phase() == Phase::Standstill && self.stands_at != Some(last) {
            self.stands_at = Some(last);
            self.tell(StreamEventKind::Standstill, last);
        }
    }

    fn has_batch(&self) -> bool {
        let sent = self.credit.sent();
        match self.splice.as_ref().map(|splice| (splice.turn(sent), splice)) {
            None => self.has_more(),
            Some((Turn::Before(last), _)) => self.credit.has_more(Some(last)),
            Some((Turn::Replace(_), _)) => true,
            Some((Turn::First, splice)) => {
                self.credit.has_more(splice.end_of_first(sent, self.close_at_rest))
            }
            Some((Turn::Going, splice)) => self.credit.has_more(splice.branch.end(self.close_at_rest)),
        }
    }

    /// May more of the adopted motion be sent?
    fn has_more(&self) -> bool {
        self.credit.has_more(self.adopted.end(self.close_at_rest))
    }

    fn next_batch(&mut self) -> Option<Result<Batch, Rejected>> {
        let (sent, executed, close_at_rest) =
            (self.credit.sent(), self.credit.executed(), self.close_at_rest);
        let (branch, cycles, replaces) = match self.splice.as_mut().map(|splice| (splice.turn(sent), splice))
        {
            None => {
                let end = self.adopted.end(close_at_rest);
                (&mut self.adopted, self.credit.next(self.batch_cycles, end)?, false)
            }
            Some((Turn::Before(last), _)) => {
                (&mut self.adopted, self.credit.next(self.batch_cycles, Some(last))?, false)
            }
            Some((Turn::Replace(first), splice)) => {
                splice.begin(first, executed, true);
                // What was sent before, and not as the last, stays at the axis.
                splice.branch.raise_floor(sent);
                (&mut splice.branch, first..=sent, true)
            }
            Some((Turn::First, splice)) => {
                let end = splice.end_of_first(sent, close_at_rest);
                let cycles = self.credit.next(self.batch_cycles, end)?;
                splice.begin(*cycles.start(), executed, false);
                splice.branch.raise_floor(*cycles.start());
                (&mut splice.branch, cycles, false)
            }
            Some((Turn::Going, splice)) => {
                let end = splice.branch.end(close_at_rest);
                (&mut splice.branch, self.credit.next(self.batch_cycles, end)?, false)
            }
        };
        let last = branch.end(close_at_rest) == Some(*cycles.end());
        self.pace.sent(*cycles.end(), executed);
        let batch = branch.batch(cycles, replaces, last, self.compact);
        self.advance();
        Some(batch)
    }

    fn tell(&mut self, kind: StreamEventKind, at_cycle: u64) {
        self.outbox.push_back(Output::Send(ToAxis::Event(StreamEvent { kind, at_cycle })));
    }

    fn end(&mut self, how: Result<(), Rejected>) {
        self.leave_undone();
        self.ended = true;
        self.outbox.push_back(Output::End(how));
    }
}
