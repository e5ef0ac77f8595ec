use std::sync::atomic::Ordering;

use proto::stream::{StreamEvent, Watch, Watched};
use proto::{Reason, Rejected};
use serving::{Caller, Leaving};
use tokio::sync::mpsc;
use tokio::time::{Instant, Interval, MissedTickBehavior, interval};

use super::Board;
use super::board::{Seen, Summary, Watching};
use super::rows::Rows;

/// Where messages go.
type Outgoing = mpsc::Sender<Result<Watched, Rejected>>;

/// Who looks on.
#[derive(Clone, Debug)]
pub(crate) struct Visitor {
    /// And what he may see.
    pub(crate) caller: Caller,
    /// Where he is told.
    pub(crate) outgoing: Outgoing,
    /// Until when at the latest.
    pub(crate) leaving: Leaving,
}

/// Shows one stream until it ends, or nobody looks. Where the axis opens it again here, under a newer epoch, it goes on.
pub(crate) async fn watch_stream(board: Board, watch: Watch, visitor: Visitor) {
    let Visitor { caller, outgoing, leaving } = visitor;
    let name = watch.stream.clone().unwrap_or_default();
    let mut ticks = ticks(&watch);
    let mut dropped = 0;
    let mut found = caller.may_use(&name).and_then(|()| board.find(&name));
    loop {
        let mut watching = match found {
            Ok(hub) => hub.watch(),
            Err(rejected) => {
                let _ = outgoing.send(Err(rejected)).await;
                return;
            }
        };
        let mut view = View { dropped, ..View::new(&watching, &watch) };
        if !show(&mut watching, &mut view, &mut ticks, &outgoing, &leaving).await {
            return;
        }
        dropped = view.dropped + watching.lost.load(Ordering::Relaxed);
        found = board.find(&name);
        // The last message waits for its reader, who may be slow and is to know the end.
        if outgoing.send(Ok(view.message(&watching, true))).await.is_err() || found.is_err() {
            return;
        }
    }
}

/// Shows a stream until it ends; `false` where nobody looks any more, or the server leaves.
async fn show(
    watching: &mut Watching,
    view: &mut View,
    ticks: &mut Interval,
    outgoing: &Outgoing,
    leaving: &Leaving,
) -> bool {
    loop {
        tokio::select! {
            seen = watching.seen.recv() => match seen {
                Some(seen) => view.take(seen),
                None => return true,
            },
            _ = ticks.tick(), if view.has_news => {
                let message = view.message(watching, false);
                match outgoing.try_send(Ok(message)) {
                    Ok(()) => {}
                    Err(mpsc::error::TrySendError::Full(_)) => view.dropped += 1,
                    Err(mpsc::error::TrySendError::Closed(_)) => return false,
                }
            }
            () = outgoing.closed() => return false,
            () = leaving.due() => {
                let _ = outgoing.try_send(Err(draining()));
                return false;
            }
        }
    }
}

/// What is to be shown next of a stream.
struct View {
    most: usize,
    rows: Rows,
    summary: Summary,
    events: Vec<StreamEvent>,
    dropped: u64,
    has_news: bool,
}

/// Events that wait to be shown: a stream has a handful in its life.
const MOST_EVENTS: usize = 64;

impl View {
    fn new(watching: &Watching, watch: &Watch) -> Self {
        let hub = &watching.hub;
        Self {
            most: watch.max_points,
            rows: Rows::of_axes(hub.axes.len()),
            summary: hub.summary(),
            events: Vec::new(),
            dropped: 0,
            has_news: true,
        }
    }

    fn take(&mut self, seen: Seen) {
        self.has_news = true;
        match seen {
            Seen::Report(reported) => {
                self.summary = reported.summary;
                if self.rows.command(reported.first_cycle, &reported.commanded) > 0 {
                    self.dropped += 1;
                }
                if let Some(tracking) = &reported.tracking {
                    self.rows.measure(tracking);
                }
            }
            // What it has changed is seen.
            Seen::Done(_) => {}
            Seen::Event(event) if self.events.len() < MOST_EVENTS => self.events.push(event),
            Seen::Event(_) => self.dropped += 1,
        }
    }

    fn message(&mut self, watching: &Watching, end: bool) -> Watched {
        self.has_news = false;
        let shown = self.rows.show(self.most, end);
        let dropped = self.dropped + watching.lost.load(Ordering::Relaxed);
        Watched {
            cycles: shown.cycles,
            commanded: shown.commanded,
            tracking: shown.tracking,
            events: std::mem::take(&mut self.events),
            ..watching.hub.message(self.summary, dropped)
        }
    }
}

/// Shows how all streams stand, again and again, until nobody looks or the server is told to leave.
///
/// A reader who does not keep up skips rounds, which are counted: what it gets is how the streams stand now.
pub(crate) async fn watch_all(board: Board, watch: Watch, visitor: Visitor) {
    let Visitor { caller, outgoing, leaving } = visitor;
    let mut ticks = ticks(&watch);
    let (mut dropped, mut last) = (0_u64, None::<Instant>);
    loop {
        tokio::select! {
            _ = ticks.tick() => {}
            () = outgoing.closed() => return,
            () = leaving.begun() => {
                let _ = outgoing.send(Err(draining())).await;
                return;
            }
        }
        let now = Instant::now();
        if let Some(last) = last.replace(now) {
            let rounds = (now - last).as_nanos() / watch.period.as_nanos().max(1);
            dropped += u64::try_from(rounds.saturating_sub(1)).unwrap_or(u64::MAX);
        }
        for hub in board.all().into_iter().filter(|hub| caller.sees(&hub.stream)) {
            if outgoing.send(Ok(hub.message(hub.summary(), dropped))).await.is_err() {
                return;
            }
        }
    }
}

fn ticks(watch: &Watch) -> Interval {
    let mut ticks = interval(watch.period);
    // The period is the least time between two messages: what is late is not made up for.
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    ticks
}

fn draining() -> Rejected {
    Rejected::new(Reason::Draining, "this server is about to leave: watch the stream on another")
}
