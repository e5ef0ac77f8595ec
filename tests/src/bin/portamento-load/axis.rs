//! A light axis: it accepts, counts, digests and reports as a real one does, and has no plant.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use client::failover::{Change, Feed, News};
use client::{Buffer, Next, Revision, Standing, Uplink};
use planner::{Accepted, Setpoint};
use proto::stream::{Ask, Motion, Open, Operation, Refused};
use tokio::sync::mpsc;

/// What axes have seen, all together.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) played: AtomicU64,
    pub(crate) underruns: AtomicU64,
    pub(crate) refused: AtomicU64,
    pub(crate) operations_refused: AtomicU64,
    pub(crate) over: AtomicBool,
}

/// What is told of an axis's stream.
pub(crate) enum Told {
    /// It is open, since then.
    Opened(Instant),
    FailedOver(Change),
    /// An operation, and how long it took to its answer.
    Confirmed(Duration),
    /// It is over, with the least lead that it has had; none where it was never opened.
    Ended(Option<u64>),
}

/// An axis without a plant.
pub(crate) struct Axis {
    pub(crate) uplink: Uplink,
    pub(crate) tally: Arc<Tally>,
    pub(crate) told: mpsc::UnboundedSender<Told>,
    pub(crate) operations: Operations,
    /// Reports go out at whole batches from here on.
    pub(crate) beat_from: tokio::time::Instant,
}

/// The overrides that an axis asks for, one after the other.
pub(crate) struct Operations {
    axis: usize,
    every: Option<Duration>,
    asked: u32,
    /// Since when an answer is waited for.
    waits: Option<Instant>,
}

impl Operations {
    pub(crate) fn new(axis: usize, every: Option<Duration>) -> Self {
        Self { axis, every, asked: 0, waits: None }
    }

    /// When to ask; at another phase of the batches for each axis.
    fn clock(&self) -> tokio::time::Interval {
        let every = self.every.unwrap_or(Duration::MAX / 4);
        let first = tokio::time::Instant::now() + every.mul_f64((self.axis as f64 * 0.618).fract());
        let mut clock = tokio::time::interval_at(first, every);
        clock.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        clock
    }

    /// The next one; none while one is not answered.
    fn next(&mut self) -> Option<Operation> {
        if self.waits.is_some() {
            return None;
        }
        self.asked += 1;
        self.waits = Some(Instant::now());
        let factor = if self.asked.is_multiple_of(2) { 1.0 } else { 0.7 };
        Some(Operation::now(format!("{}", self.asked), Ask::Override(factor)))
    }
}

impl Axis {
    /// Plays until all are told to end; gives the least lead that it has had, or none where its stream does not open.
    pub(crate) async fn play(mut self, open: &Open, plan: &Accepted) -> Option<u64> {
        let motion = self.opened().await?;
        let setpoints: Vec<Setpoint> = plan.plan().sampler().at(0).collect();
        let mut buffer = Buffer::new(&Standing {
            epoch: self.uplink.failover().serving_epoch().unwrap_or(open.epoch),
            lead_cycles: open.lead_cycles,
            axis_guard: open.axis_guard,
            plan: motion.plan(),
            setpoints: &setpoints,
        });
        buffer.motion_ends_at(motion.last_cycle());
        // Nobody to tell is not a failure, here and below.
        let _ = self.told.send(Told::Opened(Instant::now()));
        let (mut began, mut heeded) = (None, 0);
        let mut reports = beat(self.beat_from, batch(open));
        let (asks_at_all, mut asks) = (self.operations.every.is_some(), self.operations.clock());
        while !self.tally.over.load(Ordering::Relaxed) {
            let next = tokio::select! {
                next = self.uplink.next() => Some(next),
                _ = reports.tick() => None,
                _ = asks.tick(), if asks_at_all && began.is_some() => {
                    if let Some(operation) = self.operations.next() {
                        self.uplink.operate(operation);
                    }
                    continue;
                }
            };
            if began.is_none() && buffer.is_ready() {
                began = Some(Instant::now());
            }
            // Every cycle that was due before this came: played now, it is played in time.
            if let Some(began) = began
                && !self.play_due(&mut buffer, began)
            {
                break;
            }
            let mut refused = None;
            let is_due = match next {
                Some(Next::Feed(Feed::Batch(epoch, mut batch))) => {
                    let adopted = buffer.revision();
                    refused = buffer.accept(epoch, &mut batch).err();
                    // Who waits for an operation is answered when its revision is adopted.
                    refused.is_some() || buffer.revision() != adopted
                }
                Some(Next::Feed(Feed::Revised(epoch, revision))) => {
                    buffer.announce(epoch, revision);
                    false
                }
                Some(Next::Feed(Feed::Resuming)) => {
                    heeded += 1;
                    buffer.resuming(true);
                    true
                }
                Some(Next::Feed(Feed::Stays)) => {
                    buffer.resuming(false);
                    false
                }
                Some(Next::Feed(Feed::GoesOn(epoch, rested))) => {
                    drop::<Option<Revision>>(buffer.goes_on(epoch, rested));
                    true
                }
                Some(Next::News(News::FailedOver(change))) => {
                    let _ = self.told.send(Told::FailedOver(change));
                    false
                }
                Some(Next::News(News::Answer(_, answer))) => {
                    if let Some(asked) = self.operations.waits.take() {
                        match answer {
                            Ok(_) => drop(self.told.send(Told::Confirmed(asked.elapsed()))),
                            Err(_) => drop(self.tally.operations_refused.fetch_add(1, Ordering::Relaxed)),
                        }
                    }
                    false
                }
                Some(Next::News(News::Over(_))) => break,
                Some(Next::News(_)) => false,
                None => began.is_some(),
            };
            if is_due {
                self.report(&buffer, refused, heeded);
            }
        }
        Some(buffer.counters().least_lead_cycles)
    }

    fn report(&mut self, buffer: &Buffer, refused: Option<Refused>, heeded: u64) {
        self.tally.refused.fetch_add(u64::from(refused.is_some()), Ordering::Relaxed);
        self.uplink.report(buffer.report(refused), heeded);
    }

    /// `false` where a cycle was due and not held: then it is over for this axis.
    fn play_due(&self, buffer: &mut Buffer, began: Instant) -> bool {
        let due = began.elapsed().as_millis() as u64;
        let from = buffer.executed();
        while buffer.executed() < due {
            if buffer.play().is_none() {
                self.tally.underruns.fetch_add(1, Ordering::Relaxed);
                return false;
            }
        }
        self.tally.played.fetch_add(buffer.executed() - from, Ordering::Relaxed);
        true
    }

    async fn opened(&mut self) -> Option<Motion> {
        loop {
            match self.uplink.next().await {
                Next::News(News::Opened(opened)) => return Some(opened.motion),
                Next::News(News::Over(how)) => {
                    eprintln!("portamento-load: a stream does not open: {how:?}");
                    return None;
                }
                Next::News(_) | Next::Feed(_) => {}
            }
        }
    }
}

/// The time that a batch lasts.
pub(crate) fn batch(open: &Open) -> Duration {
    Duration::from_millis(u64::from(open.batch_cycles))
}

/// Whole periods from `zero` on, beginning with the next.
fn beat(zero: tokio::time::Instant, period: Duration) -> tokio::time::Interval {
    let past = zero.elapsed().div_duration_f64(period).ceil();
    tokio::time::interval_at(zero + period.mul_f64(past), period)
}
