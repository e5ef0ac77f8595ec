use std::sync::Arc;

use planner::Setpoint;
use proto::stream::{Columns, FromAxis, Motion, StreamEvent, ToAxis, Tracking};
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
}

/// What a report says before the session has taken it.
#[derive(Debug)]
pub(crate) struct Glance {
    executed: u64,
    accepted: u64,
    revision: u64,
    counters: proto::stream::Counters,
    tracking: Option<Tracking>,
    /// The setpoints since the last report by the motion that was adopted until now, if anybody watches.
    commanded: Option<Columns>,
}

/// The most cycles that a report executes: what a session sends ahead. More are refused, and not shown.
const MOST_CYCLES: u64 = proto::stream::FARTHEST_AHEAD;

impl Tap {
    pub(super) fn new(board: Board, hub: Arc<Hub>, shown: u64) -> Self {
        let watched = hub.watched();
        Self { board, hub, watched, shown }
    }

    /// Completes when somebody comes to watch, or nobody does any more.
    pub(crate) async fn wanted(&mut self) -> bool {
        // The sender lives as long as the hub, which this holds.
        let _ = self.watched.changed().await;
        *self.watched.borrow_and_update()
    }

    /// Looks at what has come, before `session` takes it. Takes the tracking out, for which a session has no use.
    pub(crate) fn before(&self, session: &Session, event: &mut Event) -> Option<Glance> {
        let Event::FromAxis(FromAxis::Report(report)) = event else { return None };
        let tracking = report.tracking.take();
        let watched = *self.watched.borrow();
        Some(Glance {
            executed: report.executed_cycle,
            accepted: report.accepted_cycle,
            revision: session.motion().revision(),
            counters: report.counters,
            tracking: tracking.filter(|_| watched),
            commanded: watched.then(|| self.between(session.motion(), report.executed_cycle)),
        })
    }

    /// Shows what has come, now that `session` has taken it.
    pub(crate) fn after(&mut self, session: &Session, glance: Option<Glance>) {
        let Some(Glance { executed, accepted, revision, counters, tracking, commanded }) = glance else {
            return;
        };
        let motion = session.motion();
        let (first_cycle, axes) = (self.shown + 1, motion.plan().axes().len());
        let commanded = commanded.unwrap_or_default();
        let from = motion.under_way.from_cycle();
        let commanded = if motion.revision() != revision && from <= executed {
            // The splice has begun among these cycles.
            let kept = usize::try_from(from.saturating_sub(first_cycle)).unwrap_or(usize::MAX);
            spliced(&commanded, kept, &self.between(motion, executed), axes)
        } else {
            commanded
        };
        self.shown = executed;
        let summary = Summary {
            executed_cycle: executed,
            lead_cycles: accepted.saturating_sub(executed),
            phase: session.phase(),
            override_factor: motion.under_way.factor().get(),
            counters,
        };
        self.hub.tell(&Seen::Report(Arc::new(Reported { summary, first_cycle, commanded, tracking })));
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

    /// The setpoints of `motion` from the last one shown through cycle `executed`.
    fn between(&self, motion: &Motion, executed: u64) -> Columns {
        let last = executed.min(self.shown.saturating_add(MOST_CYCLES));
        if last <= self.shown {
            return Columns::default();
        }
        let cycles = motion.plan_cycle(self.shown + 1)..motion.plan_cycle(last) + 1;
        let whole = cycles.end - cycles.start == last - self.shown;
        if whole {
            return Columns::of_plan(motion.plan(), cycles);
        }
        // Those before the motion stand where it begins; they are not kept.
        let at = |cycle| motion.under_way.setpoints(cycle).collect::<Vec<Setpoint>>();
        let rows: Vec<_> = (self.shown + 1..=last).map(at).collect();
        by_axis(&rows, motion.plan().axes().len())
    }
}

impl Drop for Tap {
    fn drop(&mut self) {
        self.board.close(&self.hub);
    }
}

/// The first `kept` cycles of `before`, and the rest of `after`.
fn spliced(before: &Columns, kept: usize, after: &Columns, axes: usize) -> Columns {
    let cycles = after.cycles();
    let mut columns = Columns::with_capacity(cycles, axes);
    for axis in 0..axes {
        for cycle in 0..cycles {
            let of = if cycle < kept.min(before.cycles()) { before } else { after };
            columns.push(of.at(axis, cycle).unwrap_or_default());
        }
    }
    columns
}

fn by_axis(rows: &[Vec<Setpoint>], axes: usize) -> Columns {
    let mut columns = Columns::with_capacity(rows.len(), axes);
    for axis in 0..axes {
        for row in rows {
            columns.push(row.get(axis).copied().unwrap_or_default());
        }
    }
    columns
}
