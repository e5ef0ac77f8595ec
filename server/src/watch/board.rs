use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use planner::{AxisKind, CycleTime};
use proto::stream::{
    Columns, Counters, Motion, Operation, OperationResult, Phase, StreamEvent, Tracking, Watched,
};
use proto::{Reason, Rejected};
use tokio::sync::{mpsc, watch};

use super::Tap;
use super::recorder::{Shelf, Title};

/// The streams that can be watched here, by name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Board {
    hubs: Arc<Mutex<BTreeMap<String, Arc<Hub>>>>,
    /// Where they are written down, if anywhere.
    shelf: Option<Shelf>,
}

/// One stream, under one epoch, and who watches it.
#[derive(Debug)]
pub(super) struct Hub {
    pub(super) stream: String,
    pub(super) axes: Vec<String>,
    kinds: Vec<AxisKind>,
    cycle_time: CycleTime,
    inner: Mutex<Inner>,
    /// Does anybody watch?
    watched: watch::Sender<bool>,
}

#[derive(Debug)]
struct Inner {
    summary: Summary,
    watchers: Vec<Watcher>,
}

/// How a stream stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Summary {
    pub(super) executed_cycle: u64,
    pub(super) lead_cycles: u64,
    pub(super) phase: Phase,
    pub(super) override_factor: f64,
    pub(super) counters: Counters,
}

/// What a watcher is told.
#[derive(Clone, Debug)]
pub(super) enum Seen {
    /// The axis has reported.
    Report(Arc<Reported>),
    /// Something happened.
    Event(StreamEvent),
    /// An operation was done.
    Done(Arc<(Operation, OperationResult)>),
}

/// What a report has shown.
#[derive(Debug)]
pub(super) struct Reported {
    pub(super) summary: Summary,
    /// The first of the cycles that were executed since the report before.
    pub(super) first_cycle: u64,
    /// Their setpoints.
    pub(super) commanded: Columns,
    /// How the axis followed, of these cycles or of some before.
    pub(super) tracking: Option<Tracking>,
}

#[derive(Debug)]
struct Watcher {
    queue: mpsc::Sender<Seen>,
    lost: Arc<AtomicU64>,
}

/// One who watches a stream: what is told, and how much was not because it was too slow.
#[derive(Debug)]
pub(super) struct Watching {
    pub(super) seen: mpsc::Receiver<Seen>,
    pub(super) lost: Arc<AtomicU64>,
    /// Dropped last: the stream learns that nobody is there.
    pub(super) hub: Seat,
}

/// A place at a stream; given up when it is dropped.
#[derive(Debug)]
pub(super) struct Seat(Arc<Hub>);

/// Reports that wait for a watcher's task: half a second of them.
const QUEUE: usize = 64;
/// Reports that wait for a disk: half a minute of them.
const RECORDED: usize = 4096;

impl Board {
    /// Streams are written down in `folder` as well, a file for each.
    pub(crate) fn recorded_in(folder: Option<&Path>) -> Self {
        Self { shelf: folder.map(Shelf::at), ..Self::default() }
    }

    /// Shows `stream` from the cycle after `executed_cycle` on, in place of what an older epoch showed under its name.
    pub(crate) fn open(&self, stream: String, epoch: u64, executed_cycle: u64, motion: &Motion) -> Tap {
        let plan = motion.plan();
        let summary = Summary {
            executed_cycle,
            lead_cycles: 0,
            phase: Phase::Moving,
            override_factor: 1.0,
            counters: Counters::default(),
        };
        let inner = Mutex::new(Inner { summary, watchers: Vec::new() });
        let hub = Arc::new(Hub {
            stream: stream.clone(),
            axes: plan.axes().iter().map(|axis| axis.axis.clone()).collect(),
            kinds: plan.axes().iter().map(|axis| axis.kind).collect(),
            cycle_time: plan.cycle_time(),
            inner,
            watched: watch::Sender::new(false),
        });
        if let Some(shelf) = &self.shelf {
            let title = Title { stream: stream.clone(), epoch, motion: motion.clone() };
            shelf.write_down(title, hub.clone().watch_with(RECORDED));
        }
        lock(&self.hubs).insert(stream, hub.clone());
        // What was commanded before the motion begins only the server before knows.
        let before = motion.under_way.from_cycle().saturating_sub(1);
        Tap::new(self.clone(), hub, executed_cycle.max(before))
    }

    /// The stream called `name`.
    pub(super) fn find(&self, name: &str) -> Result<Arc<Hub>, Rejected> {
        lock(&self.hubs).get(name).cloned().ok_or_else(|| {
            let text = format!(
                "stream {name:?} is not served here: watch without a name to see which are, or ask the other replicas"
            );
            Rejected::new(Reason::StreamNotHere, text)
        })
    }

    /// All streams, by name.
    pub(super) fn all(&self) -> Vec<Arc<Hub>> {
        lock(&self.hubs).values().cloned().collect()
    }

    /// Shows `hub` no more: its watchers come to an end.
    pub(super) fn close(&self, hub: &Arc<Hub>) {
        let mut hubs = lock(&self.hubs);
        // A newer epoch may stand there already.
        if hubs.get(&hub.stream).is_some_and(|shown| Arc::ptr_eq(shown, hub)) {
            hubs.remove(&hub.stream);
        }
        drop(hubs);
        lock(&hub.inner).watchers.clear();
    }
}

impl Hub {
    /// Takes a place.
    pub(super) fn watch(self: Arc<Self>) -> Watching {
        self.watch_with(QUEUE)
    }

    fn watch_with(self: Arc<Self>, room: usize) -> Watching {
        let (queue, seen) = mpsc::channel(room);
        let lost = Arc::new(AtomicU64::new(0));
        lock(&self.inner).watchers.push(Watcher { queue, lost: lost.clone() });
        self.watched.send_replace(true);
        Watching { seen, lost, hub: Seat(self) }
    }

    /// Whether anybody watches, now and from now on.
    pub(super) fn watched(&self) -> watch::Receiver<bool> {
        self.watched.subscribe()
    }

    pub(super) fn summary(&self) -> Summary {
        lock(&self.inner).summary
    }

    /// Tells everybody, and waits for nobody.
    pub(super) fn tell(&self, seen: &Seen) {
        let mut inner = lock(&self.inner);
        if let Seen::Report(reported) = seen {
            inner.summary = reported.summary;
        }
        inner.watchers.retain(|watcher| match watcher.queue.try_send(seen.clone()) {
            Ok(()) => true,
            Err(mpsc::error::TrySendError::Full(_)) => {
                watcher.lost.fetch_add(1, Ordering::Relaxed);
                true
            }
            Err(mpsc::error::TrySendError::Closed(_)) => false,
        });
    }

    /// As a message without columns.
    pub(super) fn message(&self, summary: Summary, dropped: u64) -> Watched {
        let Summary { executed_cycle, lead_cycles, phase, override_factor, counters } = summary;
        Watched {
            stream: self.stream.clone(),
            axes: self.axes.clone(),
            executed_cycle,
            lead_cycles,
            phase,
            override_factor,
            cycles: Vec::new(),
            commanded: Columns::default(),
            tracking: None,
            counters,
            messages_dropped: dropped,
            events: Vec::new(),
            cycle_time: Some(self.cycle_time),
            kinds: self.kinds.clone(),
        }
    }
}

impl std::ops::Deref for Seat {
    type Target = Arc<Hub>;

    fn deref(&self) -> &Arc<Hub> {
        &self.0
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        let mut inner = lock(&self.0.inner);
        // This one's queue closes with it, or has.
        inner.watchers.retain(|watcher| !watcher.queue.is_closed());
        if inner.watchers.is_empty() {
            self.0.watched.send_replace(false);
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
