use std::collections::VecDeque;
use std::sync::Arc;

use planner::Setpoint;
use proto::stream::{Columns, Counters, FromAxis, Motion, Operation, StreamEvent, ToAxis, Tracking};
use tokio::sync::watch;

use super::Board;
use super::board::{Hub, Reported, Seen, Summary};
use crate::session::{Event, Session};

/// What a session's task shows of its stream; the stream is shown no more when it is dropped.
#[derive(Debug)]
pub(crate) struct Tap {
    board: Board,
    hub: Arc<Hub>,
    watched: watch::Receiver<bool>,
    /// The last cycle that was shown.
    shown: u64,
    /// What follows it of the motion before, where the one that is adopted begins later.
    until_splice: Vec<Row>,
    /// Operations that were asked for and may be done yet, the latest last.
    asked: VecDeque<Operation>,
}

/// The setpoints of all axes in one cycle.
type Row = Vec<Setpoint>;

/// What a report says before the session has taken it.
#[derive(Debug)]
pub(crate) struct Glance {
    executed: u64,
    accepted: u64,
    revision: u64,
    counters: Counters,
    tracking: Option<Tracking>,
    /// What follows the last cycle shown by the motion that was adopted until now, through the last cycle that is held;
    /// empty where nobody watches.
    rows: Vec<Row>,
}

/// The most cycles that a report shows: what a session sends ahead. More are refused.
const MOST_CYCLES: u64 = proto::stream::FARTHEST_AHEAD;

/// Operations that wait on a stream, and some that are refused.
const MOST_ASKED: usize = 64;

impl Tap {
    pub(super) fn new(board: Board, hub: Arc<Hub>, shown: u64) -> Self {
        let watched = hub.watched();
        Self { board, hub, watched, shown, until_splice: Vec::new(), asked: VecDeque::new() }
    }

    /// Completes when somebody comes to watch, or nobody does any more.
    pub(crate) async fn wanted(&mut self) -> bool {
        // The sender lives as long as the hub, which this holds.
        let _ = self.watched.changed().await;
        *self.watched.borrow_and_update()
    }

    /// Looks at what has come, before `session` takes it. Takes the tracking out, for which a session has no use.
    pub(crate) fn before(&mut self, session: &Session, event: &mut Event) -> Option<Glance> {
        let report = match event {
            Event::FromAxis(FromAxis::Report(report)) => report,
            Event::FromAxis(FromAxis::Operation(operation)) | Event::Command { operation, .. } => {
                self.hears(operation);
                return None;
            }
            _ => return None,
        };
        let tracking = report.tracking.take();
        let watched = *self.watched.borrow();
        let mut rows = Vec::new();
        if watched {
            rows.clone_from(&self.until_splice);
            let last = report.accepted_cycle.min(self.shown.saturating_add(2 * MOST_CYCLES));
            rows.extend(setpoints(session.motion(), self.shown + 1 + rows.len() as u64, last));
        }
        Some(Glance {
            executed: report.executed_cycle,
            accepted: report.accepted_cycle,
            revision: session.motion().revision(),
            counters: report.counters,
            tracking: tracking.filter(|_| watched),
            rows,
        })
    }

    /// Shows what has come, now that `session` has taken it.
    pub(crate) fn after(&mut self, session: &Session, glance: Option<Glance>) {
        let Some(Glance { executed, accepted, revision, counters, tracking, mut rows }) = glance else {
            return;
        };
        let motion = session.motion();
        let first_cycle = self.shown + 1;
        let now = usize::try_from(executed.saturating_sub(self.shown)).unwrap_or(usize::MAX);
        if !rows.is_empty() && motion.revision() != revision {
            // What is adopted begins among these cycles, or after them: until then it goes on as it did.
            let from = motion.under_way.from_cycle();
            rows.truncate(usize::try_from(from.saturating_sub(first_cycle)).unwrap_or(usize::MAX));
            self.until_splice = rows.get(now..).unwrap_or_default().to_vec();
            rows.extend(setpoints(motion, first_cycle + rows.len() as u64, executed));
        } else {
            self.until_splice.drain(..now.min(self.until_splice.len()));
        }
        rows.truncate(now);
        self.shown = self.shown.max(executed);
        if motion.revision() != revision {
            self.tells_what_was_done(motion);
        }
        let summary = Summary {
            executed_cycle: executed,
            lead_cycles: accepted.saturating_sub(executed),
            phase: session.phase(),
            override_factor: motion.under_way.factor().get(),
            counters,
        };
        let commanded = by_axis(&rows, motion.plan().axes().len());
        self.hub.tell(&Seen::Report(Arc::new(Reported { summary, first_cycle, commanded, tracking })));
    }

    /// Keeps what is asked for, until it is known what became of it.
    fn hears(&mut self, operation: &Operation) {
        if self.asked.len() >= MOST_ASKED {
            self.asked.pop_front();
        }
        self.asked.push_back(operation.clone());
    }

    fn tells_what_was_done(&mut self, motion: &Motion) {
        let Some(result) = motion.recent.last() else { return };
        let place = self.asked.iter().rposition(|operation| operation.request_id == result.request_id);
        if let Some(operation) = place.and_then(|place| self.asked.remove(place)) {
            self.hub.tell(&Seen::Done(Arc::new((operation, result.clone()))));
        }
    }

    /// Shows what the axis is told, as far as watchers care.
    pub(crate) fn said(&self, message: &ToAxis) {
        use proto::stream::StreamEventKind::{TrackingUnwanted, TrackingWanted};
        match message {
            ToAxis::Event(StreamEvent { kind: TrackingWanted | TrackingUnwanted, .. }) => {}
            ToAxis::Event(event) => self.hub.tell(&Seen::Event(*event)),
            ToAxis::Opened(_)
            | ToAxis::Revised(_)
            | ToAxis::Batch(_)
            | ToAxis::Result(_)
            | ToAxis::Refusal(_) => {}
        }
    }
}

/// The setpoints of `motion` from cycle `first` through `last`, cycle by cycle.
fn setpoints(motion: &Motion, first: u64, last: u64) -> Vec<Row> {
    if last < first {
        return Vec::new();
    }
    let columns = Columns::of_plan(motion.plan(), motion.plan_cycle(first)..motion.plan_cycle(last) + 1);
    (0..columns.cycles()).map(|index| columns.cycle(index).collect()).collect()
}

impl Drop for Tap {
    fn drop(&mut self) {
        self.board.close(&self.hub);
    }
}

fn by_axis(rows: &[Row], axes: usize) -> Columns {
    let mut columns = Columns::with_capacity(rows.len(), axes);
    for axis in 0..axes {
        for row in rows {
            columns.push(row.get(axis).copied().unwrap_or_default());
        }
    }
    columns
}
