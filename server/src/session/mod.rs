//! One stream, as a pure function of the messages that came: no clock, no socket, no task. The axis's reports are the
//! session's clock.
//!
//! ```text
//!   open                        the plan has been executed
//!  ●────► MOVING ──────────────────────────────────────────► STANDSTILL   (setpoints at rest go on)
//!            │                                                    │
//!            └── close_at_rest: the last batch was sent ──► FINISHED ◄── the axis closes its side
//!
//!   any ── a newer epoch has opened ──► ENDED        any ── drain ──► same phase, the axis is told once
//! ```

mod credit;
mod ledger;

use std::collections::VecDeque;

use planner::Quantity;
use proto::stream::{
    BATCH_CYCLES, Batch, Columns, FromAxis, Motion, Open, Opened, OperationRefusal, Phase, Report,
    StreamEvent, StreamEventKind, ToAxis,
};
use proto::{Digest, Reason, Rejected};

use credit::Credit;
use ledger::Ledger;

/// Everything that can happen to a session.
#[derive(Debug)]
pub enum Event {
    /// The axis said something.
    FromAxis(FromAxis),
    /// What the axis said cannot be read.
    Unreadable(Rejected),
    /// The axis has closed its side, or is gone.
    AxisClosed,
    /// The same stream was opened under a newer epoch.
    Superseded {
        /// The newer one.
        by: u64,
    },
    /// This server is about to leave.
    Drain,
    /// This server leaves now.
    Leave,
}

/// Everything that a session does.
#[derive(Debug, PartialEq)]
pub enum Output {
    /// Says this to the axis.
    Send(ToAxis),
    /// The session is over: well, or for a reason.
    End(Result<(), Rejected>),
}

/// How often a batch is sent again that the axis does not take, before the session gives up.
const MOST_REFUSALS: u32 = 3;

/// One open stream.
#[derive(Debug)]
pub struct Session {
    motion: Motion,
    close_at_rest: bool,
    batch_cycles: u64,
    credit: Credit,
    ledger: Ledger,
    /// Refusals of batches since one was taken.
    refusals: u32,
    /// The last batch has been sent, and what ends the session is the axis's word that it has it.
    finished: bool,
    drained: bool,
    ended: bool,
    /// What is to be said before any further batch.
    outbox: VecDeque<Output>,
}

impl Session {
    /// Opens a stream for an axis that stands in the plan's first state.
    ///
    /// # Errors
    /// A plan that guarantees too little, or whose closing stop leaves the position range; an axis that has already
    /// executed something.
    pub fn open(open: Open, served_by: &str) -> Result<Self, Rejected> {
        let Open { epoch, lead_cycles, batch_cycles, close_at_rest, executed_cycle, .. } = open;
        if executed_cycle != 0 {
            let text = format!("is {executed_cycle}: a stream that opens with a plan begins at cycle 0");
            return Err(Rejected::for_field("open.executed_cycle", Reason::ValueOutOfRange, text));
        }
        let motion = motion(&open)?;
        let opened = Opened {
            motion: motion.clone(),
            first_cycle: 1,
            served_by: served_by.into(),
            current_epoch: epoch,
        };
        let mut session = Self {
            motion,
            close_at_rest,
            batch_cycles: u64::from(batch_cycles.clamp(*BATCH_CYCLES.start(), *BATCH_CYCLES.end())),
            credit: Credit::first(u64::from(lead_cycles)),
            ledger: Ledger::default(),
            refusals: 0,
            finished: false,
            drained: false,
            ended: false,
            outbox: VecDeque::from([Output::Send(ToAxis::Opened(Box::new(opened)))]),
        };
        if close_at_rest && session.motion.last_cycle() == 0 {
            // Nothing moves: there is no cycle to send, and none to wait for.
            session.finished = true;
            session.tell(StreamEventKind::Finished, 0);
            session.end(Ok(()));
        }
        Ok(session)
    }

    /// What the stream is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        if self.finished { Phase::Finished } else { self.motion.phase }
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

    /// Would [`poll_output`](Self::poll_output) give something?
    #[must_use]
    pub fn has_output(&self) -> bool {
        !self.outbox.is_empty() || (!self.ended && !self.finished && self.credit.has_more(self.end_cycle()))
    }

    /// The last cycle that will be sent, where there is one.
    fn end_cycle(&self) -> Option<u64> {
        self.close_at_rest.then(|| self.motion.last_cycle())
    }

    /// Takes one thing that happened. Nothing is sent here: ask [`poll_output`](Self::poll_output).
    pub fn handle(&mut self, event: Event) {
        if self.ended {
            return;
        }
        match event {
            Event::FromAxis(FromAxis::Report(report)) => self.report(&report),
            Event::FromAxis(FromAxis::Operation(operation)) => self.refuse(operation.request_id),
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
            Event::Drain if self.drained => {}
            Event::Drain => {
                self.drained = true;
                self.tell(StreamEventKind::Draining, self.credit.executed());
            }
        }
    }

    /// The next thing to do, if there is one. A batch is made when it is asked for, so that what a slow axis has not
    /// taken costs no memory.
    pub fn poll_output(&mut self) -> Option<Output> {
        self.outbox.pop_front().or_else(|| self.next_batch().map(|batch| Output::Send(ToAxis::Batch(batch))))
    }

    fn report(&mut self, report: &Report) {
        if let Err(rejected) = self.credit.report(report) {
            return self.end(Err(rejected));
        }
        if report.revision != self.motion.revision {
            let text = format!(
                "the report is of revision {}, and the motion is revision {}",
                report.revision, self.motion.revision
            );
            return self.end(Err(Rejected::new(Reason::ProtocolOrder, text)));
        }
        let accepted = report.accepted_cycle;
        let ours = self.ledger.digest_at(accepted, &self.motion);
        if report.digest != ours {
            let text = format!(
                "the setpoints through cycle {accepted} have digest {} at the axis and {ours} here: open the \
                 stream again",
                report.digest
            );
            return self.end(Err(Rejected::new(Reason::DigestMismatch, text).with("cycle", accepted)));
        }
        self.ledger.forget_before(accepted);
        if report.tail_from_cycle.is_some() {
            return self.end(Ok(()));
        }
        match &report.refused {
            Some(refused) => {
                self.refusals += 1;
                if self.refusals >= MOST_REFUSALS {
                    let (cycle, why) = (refused.first_cycle, refused.reason.name());
                    let text = format!("the axis has refused cycle {cycle} {MOST_REFUSALS} times: {why}");
                    return self.end(Err(Rejected::new(Reason::NotConfirmed, text).with("cycle", cycle)));
                }
                self.credit.send_again_after(accepted);
                self.ledger.forget_after(accepted);
                self.finished = false;
            }
            None => self.refusals = 0,
        }
        self.observe_end(report);
    }

    /// Notices that the plan has come to its end.
    fn observe_end(&mut self, report: &Report) {
        let last = self.motion.last_cycle();
        if self.finished && report.accepted_cycle >= last {
            self.end(Ok(()));
        } else if self.motion.phase == Phase::Moving && !self.close_at_rest && report.executed_cycle >= last {
            self.motion.phase = Phase::Standstill;
            self.tell(StreamEventKind::Standstill, last);
        }
    }

    fn next_batch(&mut self) -> Option<Batch> {
        if self.ended || self.finished {
            return None;
        }
        let end = self.end_cycle();
        let cycles = self.credit.next(self.batch_cycles, end)?;
        let of_plan = self.motion.plan_cycle(*cycles.start())..self.motion.plan_cycle(*cycles.end()) + 1;
        let columns = Columns::of_plan(self.motion.plan.plan(), of_plan);
        let before = self.ledger.last();
        let digest = columns.digests(*cycles.start(), before).last().unwrap_or(before);
        self.ledger.note(*cycles.end(), digest);
        let last = end == Some(*cycles.end());
        if last {
            self.finished = true;
            self.tell(StreamEventKind::Finished, *cycles.end());
        }
        let (first_cycle, revision) = (*cycles.start(), self.motion.revision);
        Some(Batch { first_cycle, revision, replaces: false, last, columns, digest })
    }

    fn refuse(&mut self, request_id: String) {
        let text = "operations on a motion under way are not implemented: let it end, then open a new stream";
        let rejected = Rejected::new(Reason::NotImplemented, text);
        let refusal = OperationRefusal { request_id, rejected };
        // An axis that asks faster than it reads is answered the latest, not all.
        const MOST_WAITING: usize = 64;
        if self.outbox.len() < MOST_WAITING {
            self.outbox.push_back(Output::Send(ToAxis::Refusal(refusal)));
        }
    }

    fn tell(&mut self, kind: StreamEventKind, at_cycle: u64) {
        self.outbox.push_back(Output::Send(ToAxis::Event(StreamEvent { kind, at_cycle })));
    }

    fn end(&mut self, how: Result<(), Rejected>) {
        self.ended = true;
        self.outbox.push_back(Output::End(how));
    }
}

/// The motion that an opened plan becomes: with a stop after it, if it ends at speed.
fn motion(open: &Open) -> Result<Motion, Rejected> {
    let plan = open.plan.plan();
    let proved = plan.guarantees(Quantity::Velocity) && plan.guarantees(Quantity::Acceleration);
    if !proved && !open.accept_unproved {
        let text = "the plan does not guarantee velocity and acceleration: plan with a family that does, or set \
                    accept_unproved";
        return Err(Rejected::for_field("open.plan", Reason::NotProved, text));
    }
    let within_plan = |invalid| proto::within("open.plan", invalid);
    let (plan, closing_from_cycle) = match plan.with_closing_stop().map_err(within_plan)? {
        Some((stopped, from)) => (proto::accepted("open.plan", stopped)?, Some(from)),
        None => (open.plan.clone(), None),
    };
    Ok(Motion {
        revision: 0,
        from_cycle: 0,
        digest_before: Digest::ZERO,
        plan,
        override_factor: 1.0,
        phase: Phase::Moving,
        closing_from_cycle,
    })
}
