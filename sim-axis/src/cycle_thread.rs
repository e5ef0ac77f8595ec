//! The thread that owns the axes. Between it and the tasks that own the network there are rings of fixed size, so that
//! neither waits for the other:
//!
//! ```text
//!                 ── Fed ──────────────────►              ── reports ─► to the server; a newer one replaces an older
//!  network task                               cycle thread
//!                 ◄── emptied batches ──────              ── samples ─► to whoever looks on
//!                                                         ◄── empty chunks ──
//! ```
//!
//! Between two cycles of a run the thread allocates nothing, locks nothing that somebody holds for long, and logs nothing.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::{self, Thread};

use client::Revision;
use planner::CycleTime;
use proto::Digest;
use proto::stream::{Batch, Report};
use rtrb::{Consumer, Producer, RingBuffer};
use tokio::sync::{Notify, oneshot};

use crate::clock::{Clock, Deadlines, be_prompt};
use crate::jitter::Lateness;
use crate::player::{Beat, Player};
use crate::samples::Chunk;

/// What the network says to the cycle thread.
#[derive(Debug)]
pub(crate) enum Fed {
    /// Setpoints, and the epoch that they are of.
    Batch(u64, Batch),
    /// What setpoints will follow from, and the epoch that it is of.
    Revised(u64, Revision),
    /// To begin no revision from here on.
    Resuming,
    /// The server stays.
    Stays,
    /// Another goes on, under this epoch.
    GoesOn(u64, Option<(Revision, Digest)>),
    /// Drives have this share of their effort limit from now on.
    EffortLimitScale(f64),
    /// Nothing more will come.
    Closed,
}

/// What the cycle thread says to the network.
#[derive(Debug)]
pub(crate) struct Word {
    pub(crate) report: Report,
    /// How many times [`Fed::Resuming`] was taken in.
    pub(crate) heeded: u64,
}

/// What the cycle thread does not need any more: it is freed where it came from.
#[derive(Debug)]
pub(crate) enum Emptied {
    Batch(#[expect(dead_code, reason = "is there to be dropped")] Batch),
    Revision(#[expect(dead_code, reason = "is there to be dropped")] Revision),
}

/// The ends of the rings that belong to the network.
#[derive(Debug)]
pub(crate) struct Outside {
    pub(crate) feed: Feed,
    pub(crate) reports: ReportRing,
    pub(crate) samples: SampleRing,
    /// What became of it; dropped without an answer if the thread has gone.
    pub(crate) outcome: oneshot::Receiver<Outcome>,
}

/// Where batches go in.
#[derive(Debug)]
pub(crate) struct Feed {
    // Dropped before the thread is woken: a ring without its other end tells the thread to stop.
    batches: Producer<Fed>,
    emptied: Consumer<Emptied>,
    room: Arc<Notify>,
    asked_from: Arc<AtomicU64>,
    thread: Waker,
}

/// Where reports come out.
#[derive(Debug)]
pub(crate) struct ReportRing {
    pub(crate) reports: Consumer<Word>,
    pub(crate) news: Arc<Notify>,
    pub(crate) thread: Waker,
}

/// Where samples come out.
#[derive(Debug)]
pub(crate) struct SampleRing {
    pub(crate) full: Consumer<Chunk>,
    pub(crate) empty: Producer<Chunk>,
    pub(crate) news: Arc<Notify>,
    pub(crate) thread: Waker,
}

/// Wakes the cycle thread where it waits for data, not where it waits for a deadline; when dropped, a last time.
#[derive(Clone, Debug)]
pub(crate) struct Waker(Thread);

/// What is left of a run.
#[derive(Debug)]
pub(crate) struct Outcome {
    pub(crate) player: Player,
    pub(crate) lateness: Lateness,
}

/// What the cycle thread works with.
#[derive(Debug)]
struct Inside {
    player: Player,
    lateness: Lateness,
    batches: Consumer<Fed>,
    emptied: Producer<Emptied>,
    room: Arc<Notify>,
    /// From which cycle on an operation is asked for that is not answered.
    asked_from: Arc<AtomicU64>,
    reports: Producer<Word>,
    /// The newest report that found no room.
    unsent: Option<Report>,
    heeded: u64,
    reported: Arc<Notify>,
    chunk: Option<Chunk>,
    full: Producer<Chunk>,
    empty: Consumer<Chunk>,
    sampled: Arc<Notify>,
}

/// The network has gone: nobody waits for the outcome.
struct Abandoned;

/// Batches on their way; any lead fits many times.
const BATCHES: usize = 64;
/// Reports on their way.
const REPORTS: usize = 16;
/// Chunks of samples on their way or being written.
const CHUNKS: usize = 8;
/// How much time a chunk covers [ns].
const CHUNK_NS: u64 = 50_000_000;
/// Rows of a chunk at most: one for each axis and cycle.
const CHUNK_ROWS: usize = 4096;

/// Starts the thread that plays `player`.
///
/// # Errors
/// What the system says where it has no more threads.
pub(crate) fn spawn(player: Player, cycle: CycleTime, clock: Clock) -> std::io::Result<Outside> {
    let axes = player.setpoints().len().max(1);
    let chunk_cycles =
        usize::try_from(CHUNK_NS / cycle.as_ns()).unwrap_or(CHUNK_ROWS).clamp(1, (CHUNK_ROWS / axes).max(1));
    let (batch_in, batch_out) = RingBuffer::new(BATCHES);
    // What was taken before the last look at it, and all that can be waiting since.
    let (emptied_in, emptied_out) = RingBuffer::new(2 * BATCHES);
    let (report_in, report_out) = RingBuffer::new(REPORTS);
    let (full_in, full_out) = RingBuffer::new(CHUNKS);
    let (mut empty_in, empty_out) = RingBuffer::new(CHUNKS);
    for _ in 0..CHUNKS {
        // There is room for exactly these.
        let _ = empty_in.push(Chunk::with_room_for(chunk_cycles, axes));
    }
    let (room, reported, sampled) = (Arc::default(), Arc::default(), Arc::default());
    let asked_from = Arc::new(AtomicU64::new(u64::MAX));
    let inside = Inside {
        player,
        lateness: Lateness::default(),
        batches: batch_out,
        emptied: emptied_in,
        room: Arc::clone(&room),
        asked_from: Arc::clone(&asked_from),
        reports: report_in,
        unsent: None,
        heeded: 0,
        reported: Arc::clone(&reported),
        chunk: None,
        full: full_in,
        empty: empty_out,
        sampled: Arc::clone(&sampled),
    };
    let (done, outcome) = oneshot::channel();
    let handle = thread::Builder::new().name("cycles".into()).spawn(move || {
        if let Ok(left) = inside.run(cycle, clock) {
            // Nobody to tell is not a failure.
            let _ = done.send(left);
        }
    })?;
    let thread = Waker(handle.thread().clone());
    Ok(Outside {
        feed: Feed { batches: batch_in, emptied: emptied_out, room, asked_from, thread: thread.clone() },
        reports: ReportRing { reports: report_out, news: reported, thread: thread.clone() },
        samples: SampleRing { full: full_out, empty: empty_in, news: sampled, thread },
        outcome,
    })
}

impl Inside {
    fn run(mut self, cycle: CycleTime, clock: Clock) -> Result<Outcome, Abandoned> {
        match clock {
            Clock::Wall => self.keep_time(cycle)?,
            Clock::Virtual => self.hurry()?,
        }
        self.put_out_report();
        self.put_out_chunk();
        let Self { player, lateness, batches, reports, full, room, reported, sampled, .. } = self;
        // Whoever is woken finds the rings closed.
        drop((batches, reports, full));
        for waiting in [room, reported, sampled] {
            waiting.notify_one();
        }
        Ok(Outcome { player, lateness })
    }

    /// One cycle per period. Late cycles run back to back until they have caught up.
    fn keep_time(&mut self, cycle: CycleTime) -> Result<(), Abandoned> {
        be_prompt();
        while self.player.is_waiting() && self.player.is_short_of_data(u64::MAX) {
            self.put_out_report();
            thread::park();
            self.take_in()?;
        }
        let mut deadlines = Deadlines::from_now(cycle);
        while !self.player.is_over() {
            let lateness_ns = deadlines.wait();
            self.lateness.note(lateness_ns);
            if deadlines.is_late(lateness_ns) {
                self.player.count_late();
            }
            self.take_in()?;
            let beat = self.player.cycle();
            self.put_out(beat, lateness_ns);
        }
        Ok(())
    }

    /// One cycle after the other, as data is there and samples are read. While nothing moves, time stands still: a stream
    /// that stays open would else be a flood of setpoints at rest.
    fn hurry(&mut self) -> Result<(), Abandoned> {
        while !self.player.is_over() {
            self.take_in()?;
            // A revision begins with cycles that are still to be granted: for that, time goes on.
            if self.player.is_at_standstill() && !self.player.buffer().awaits_revision() {
                self.put_out_report();
                self.put_out_chunk();
                thread::park();
                continue;
            }
            let asked_from = self.asked_from.load(Ordering::Acquire);
            if self.player.is_short_of_data(asked_from) || !self.has_chunk() {
                self.put_out_report();
                thread::park();
                continue;
            }
            let beat = self.player.cycle();
            self.put_out(beat, 0);
        }
        Ok(())
    }

    /// Takes what the network has brought.
    fn take_in(&mut self) -> Result<(), Abandoned> {
        if self.batches.is_abandoned() {
            return Err(Abandoned);
        }
        let mut taken = 0;
        // No more than there was at once: who brings faster than this takes does not hold up a cycle.
        while taken < BATCHES {
            let Ok(fed) = self.batches.pop() else { break };
            taken += 1;
            match fed {
                Fed::Closed => self.player.close(),
                Fed::Revised(epoch, revision) => {
                    if let Some(old) = self.player.announce(epoch, revision) {
                        let _ = self.emptied.push(Emptied::Revision(old));
                    }
                }
                Fed::Resuming => {
                    self.heeded += 1;
                    self.player.resuming();
                }
                Fed::Stays => self.player.stays(),
                Fed::EffortLimitScale(scale) => self.player.scale_effort_limits(scale),
                Fed::GoesOn(epoch, rested) => {
                    if let Some(old) = self.player.goes_on(epoch, rested) {
                        let _ = self.emptied.push(Emptied::Revision(old));
                    }
                }
                Fed::Batch(epoch, mut batch) => {
                    let refusal = self.player.accept(epoch, &mut batch);
                    let _ = self.emptied.push(Emptied::Batch(batch));
                    if let Some(report) = refusal {
                        self.report(report);
                    }
                }
            }
        }
        if taken >= BATCHES / 2 {
            self.room.notify_one();
        }
        if taken > 0
            && let Some(report) = self.player.report_due()
        {
            self.report(report);
        }
        Ok(())
    }

    /// Hands out what a cycle has left to say.
    fn put_out(&mut self, beat: Beat, lateness_ns: u64) {
        match self.player.report_due() {
            Some(report) => self.report(report),
            None => self.put_out_report(),
        }
        let has_number = match beat {
            Beat::Played | Beat::Rested => true,
            Beat::Waited | Beat::Starved | Beat::Diverged | Beat::Over => false,
        };
        if has_number && self.has_chunk() {
            let Some(chunk) = &mut self.chunk else { return };
            chunk.note(&self.player, lateness_ns);
            if chunk.is_full() {
                self.put_out_chunk();
            }
        }
    }

    fn report(&mut self, report: Report) {
        // A newer report says all that an older one did, except what it refused.
        let refused = self.unsent.take().and_then(|older| older.refused);
        self.unsent = Some(Report { refused: report.refused.clone().or(refused), ..report });
        self.put_out_report();
    }

    fn put_out_report(&mut self) {
        let Some(report) = self.unsent.take() else { return };
        let word = Word { report, heeded: self.heeded };
        if let Err(rtrb::PushError::Full(Word { report, .. })) = self.reports.push(word) {
            self.unsent = Some(report);
        }
        self.reported.notify_one();
    }

    /// Is there a chunk to write to? Not while all of them wait to be read.
    fn has_chunk(&mut self) -> bool {
        if self.chunk.is_none() {
            self.chunk = self.empty.pop().ok();
        }
        self.chunk.is_some()
    }

    fn put_out_chunk(&mut self) {
        let Some(chunk) = self.chunk.take() else { return };
        // There are as many places as chunks.
        let _ = self.full.push(chunk);
        self.sampled.notify_one();
    }
}

impl Feed {
    /// Hands `fed` to the cycle thread, waiting while the ring is full. `false` if the thread has gone.
    pub(crate) async fn push(&mut self, mut fed: Fed) -> bool {
        loop {
            while self.emptied.pop().is_ok() {}
            match self.batches.push(fed) {
                Ok(()) => {
                    self.thread.wake();
                    return true;
                }
                Err(rtrb::PushError::Full(back)) => fed = back,
            }
            if self.batches.is_abandoned() {
                return false;
            }
            self.room.notified().await;
        }
    }

    /// Tells from which cycle on an operation is asked for that is not answered: virtual time waits for the answer before the motion ends.
    pub(crate) fn asked_from(&self, cycle: u64) {
        if self.asked_from.swap(cycle, Ordering::AcqRel) != cycle {
            self.thread.wake();
        }
    }
}

impl Waker {
    pub(crate) fn wake(&self) {
        self.0.unpark();
    }
}

impl Drop for Waker {
    fn drop(&mut self) {
        self.wake();
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use client::Standing;
    use planner::{Judged, LimitsSpec, Request, RequestSpec, Setpoint, State};

    use super::*;
    use crate::{Axis, AxisConfig, AxisModel};

    fn player() -> Player {
        let axis = planner::AxisMoveSpec {
            axis: "x".into(),
            kind: Ok(planner::AxisKind::Prismatic),
            start: State::at_rest(0.0),
            goal: State::at_rest(0.05),
            limits: LimitsSpec {
                max_velocity: 0.25,
                max_acceleration: 3.0,
                max_jerk: 100.0,
                ..LimitsSpec::default()
            },
        };
        let spec = RequestSpec {
            axes: vec![axis],
            cycle_time_ns: None,
            family: Ok(planner::Family::SCurve),
            order: None,
            short_path: Ok(planner::ShortPathPolicy::Reject),
            synchronization: Ok(planner::Synchronization::None),
            minimum_duration: None,
            end_on_cycle: false,
        };
        let judged = Judged::answer(&Request::try_from(spec).unwrap()).unwrap();
        let plan = judged.plan();
        let setpoints: Vec<Setpoint> = plan.sampler().at(0).collect();
        let standing = Standing { epoch: 1, lead_cycles: 40, axis_guard: 2, plan, setpoints: &setpoints };
        let config = AxisConfig { cycle: 1e-3, settle_window: 60.0, settle_tolerance: 1e-5 };
        let axis = Axis::new(&AxisModel::ideal("x"), config, &setpoints[0].state).unwrap();
        Player::new(client::Buffer::new(&standing), vec![axis], plan.cycle_count(), 10)
    }

    #[tokio::test]
    async fn a_thread_that_nobody_feeds_any_more_ends() {
        for clock in [Clock::Wall, Clock::Virtual] {
            let Outside { feed, reports, samples, outcome } =
                spawn(player(), CycleTime::MILLISECOND, clock).unwrap();
            drop(feed);
            let gone = tokio::time::timeout(Duration::from_secs(10), outcome).await;
            assert!(gone.unwrap().is_err(), "it has left, and has nothing to say");
            assert!(reports.reports.is_abandoned() && samples.full.is_abandoned());
        }
    }

    #[tokio::test]
    async fn a_full_ring_waits_for_the_thread_and_not_the_other_way_round() {
        let Outside { mut feed, mut reports, outcome, .. } =
            spawn(player(), CycleTime::MILLISECOND, Clock::Virtual).unwrap();
        let stale = Batch {
            first_cycle: 1,
            revision: 0,
            replaces: false,
            last: false,
            columns: proto::stream::Columns::default(),
            digest: proto::Digest::ZERO,
            tails: proto::stream::Tails::default(),
        };
        for _ in 0..100 * BATCHES {
            assert!(feed.push(Fed::Batch(0, stale.clone())).await);
        }
        assert!(feed.push(Fed::Batch(1, stale.clone())).await);
        reports.news.notified().await;
        assert!(reports.reports.pop().unwrap().report.refused.is_some());
        assert!(feed.push(Fed::Closed).await);
        let left = outcome.await.unwrap();
        assert_eq!(left.player.buffer().counters().stale_epochs, 100 * BATCHES as u64);
    }
}
