//! Everything between the network, the cycle thread and whoever looks on.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use client::failover::{Change, News};
use client::{Next, Uplink};
use proto::Rejected;
use proto::stream::{Operation, OperationResult};
use tokio::sync::mpsc;

use super::{StreamReport, TrackError, TrackingReport, Update};
use crate::clock::Clock;
use crate::commands::{Command, Commands, Waiting};
use crate::cycle_thread::{Fed, Feed, Outcome, Outside, ReportRing, SampleRing, Word};
use crate::faults::Ailing;
use crate::figures::Figures;
use crate::jitter::Jitter;
use crate::player::Divergence;
use crate::watched::WatchedBy;

/// Updates that wait to be handed over [messages of about 50 ms].
const WAITING: usize = 64;
/// Events that wait to be taken up.
const EVENTS: usize = 64;
/// How long the server may take to end a stream that the axis has closed.
const GOODBYE: Duration = Duration::from_secs(1);

/// Carries everything between the network, the cycle thread and whoever looks on, until the cycle thread is done. One
/// task: what wakes it for several reasons wakes it once.
pub(super) async fn carry(
    uplink: Uplink,
    outside: Outside,
    teller: mpsc::Sender<Update>,
    (clock, ailing): (Clock, Ailing),
    (commands, waiting, asked): (Commands, Waiting, VecDeque<Operation>),
) -> Result<TrackingReport, TrackError> {
    // Kept to the end: without it the cycle thread stops at once.
    let Outside { mut feed, reports, samples, outcome } = outside;
    let sampled = Arc::clone(&samples.news);
    let (events, event_queue) = mpsc::channel(EVENTS);
    let nobody = teller.clone();
    let failovers = AtomicU64::new(0);
    let watched = WatchedBy::default();
    let stream = Stream {
        uplink,
        reports,
        commands,
        waiting: &waiting,
        asked,
        told_revision: 0,
        events,
        failovers: &failovers,
        figures: Figures::resolve(),
        watched: &watched,
        ailing,
    };
    let mut streaming = Box::pin(stream.carry(&mut feed));
    let mut telling = Box::pin(tell(samples, event_queue, teller, (clock, &watched)));
    let mut outcome = std::pin::pin!(outcome);
    let (mut ended, mut told) = (None, false);

    let outcome = loop {
        tokio::select! {
            done = &mut outcome => break done,
            how = &mut streaming, if ended.is_none() => ended = Some(how),
            () = &mut telling, if !told => told = true,
            () = nobody.closed() => return Err(TrackError::Abandoned),
        }
    };
    // A thread that ended without a word has not woken anybody.
    sampled.notify_one();
    let finished = outcome.as_ref().is_ok_and(|outcome| outcome.player.buffer().is_finished());
    if ended.is_none() && finished {
        // The server has the last word.
        let goodbye = async {
            loop {
                tokio::select! {
                    how = &mut streaming => break how,
                    () = &mut telling, if !told => told = true,
                }
            }
        };
        ended = tokio::time::timeout(GOODBYE, goodbye).await.ok();
    }
    // Closes the axis's side, and drops what feeds events, so that telling comes to an end.
    drop(streaming);
    if !told {
        telling.await;
    }
    drop(nobody);
    let Outcome { player, lateness } =
        outcome.map_err(|_| TrackError::Thread("it has ended without a word".into()))?;
    let failovers = failovers.load(Ordering::Relaxed);
    let report = tokio::task::spawn_blocking(move || {
        let (executed, arrived) = (player.buffer().executed(), player.has_arrived());
        let motion_end = player.buffer().was_to_end();
        let stream = StreamReport {
            cycles_executed: executed,
            counters: player.buffer().counters(),
            failovers,
            revisions: player.buffer().revision(),
            jitter: if clock == Clock::Wall { lateness.jitter() } else { Jitter::default() },
            digest: player.digest(),
            stop_tail_used: player.tail_used(),
        };
        let report = TrackingReport { axes: player.report_cards(), stream };
        (arrived.then_some(()).ok_or(motion_end), player.divergence(), report)
    });
    let (arrived, diverged, report) = report.await.map_err(|error| TrackError::Thread(error.to_string()))?;
    if let Some(Divergence { axis, cycle }) = diverged {
        let axis = report.axes.get(axis).map(|card| card.axis.clone()).unwrap_or_default();
        return Err(TrackError::Diverged { axis, cycle, report: Box::new(report) });
    }
    let Err(motion_end) = arrived else {
        // However the stream ended, the motion had been played by then.
        return Ok(report);
    };
    let too_early = || client::Error::Protocol("the stream ended before the motion did".into());
    Err(broken(report, motion_end, ended.and_then(Result::err).unwrap_or_else(too_early)))
}

fn broken(report: TrackingReport, motion_end: u64, cause: client::Error) -> TrackError {
    let executed = report.stream.cycles_executed;
    TrackError::Broken { executed, motion_end, cause, report: Box::new(report) }
}

/// A stream, whoever serves it, on its way to the cycle thread and back.
struct Stream<'a> {
    uplink: Uplink,
    reports: ReportRing,
    commands: Commands,
    waiting: &'a Waiting,
    /// What was asked for and is not answered, the latest last.
    asked: VecDeque<Operation>,
    /// The revision of the last operation that was told of.
    told_revision: u64,
    events: mpsc::Sender<Update>,
    failovers: &'a AtomicU64,
    figures: Figures,
    watched: &'a WatchedBy,
    ailing: Ailing,
}

impl Stream<'_> {
    /// Until nothing more will come, and the cycle thread knows that.
    async fn carry(mut self, feed: &mut Feed) -> Result<(), client::Error> {
        let mut asked = true;
        let how = loop {
            tokio::select! {
                biased;
                scale = self.ailing.changes() => if let Some(scale) = scale {
                    feed.push(Fed::EffortLimitScale(scale)).await;
                },
                next = self.uplink.next(), if !self.ailing.is_stalled() => match next {
                    Next::Feed(client::failover::Feed::Batch(..)) if self.ailing.drops() => {}
                    // A cycle thread that is done has no more use for it; the stream is read to its end all the same.
                    Next::Feed(next) => {
                        feed.push(fed(next)).await;
                    }
                    Next::News(News::Over(how)) => break how.map_err(|failure| failure.cause),
                    Next::News(news) => self.hear(news),
                },
                () = self.reports.news.notified(), if !self.ailing.is_silent() => self.report(),
                command = self.commands.inbox.recv(), if asked => match command {
                    Some(Command { operation, answer }) => {
                        self.waiting.expect(&operation.request_id, answer);
                        self.asked.push_back(operation.clone());
                        self.uplink.operate(operation);
                    }
                    None => asked = false,
                },
            }
            feed.asked_from(self.uplink.failover().asked_from());
        };
        self.commands.finished.store(how.is_ok(), Ordering::Release);
        self.waiting.give_up();
        feed.push(Fed::Closed).await;
        how.inspect_err(|error| tracing::warn!(%error, "the stream broke off"))
    }

    fn hear(&mut self, news: News) {
        // Who does not take up events loses the newest: none of them says what a report does not.
        match news {
            News::Opened(_) | News::Over(_) => {}
            News::Answer(id, answer) => {
                self.waiting.tell(&id, &answer);
                self.answered(&id, answer);
            }
            News::Event(event) => {
                self.watched.hear(event);
                drop(self.events.try_send(Update::Event(event)));
            }
            News::FailedOver(change) => {
                let Change { cause, from, to, executed_cycle, took } = &change;
                let cause = cause.name();
                tracing::info!(cause, from, to, executed_cycle, took_ms = took.as_millis(), "failed over");
                self.figures.failed_over(change.cause);
                self.failovers.fetch_add(1, Ordering::Relaxed);
                drop(self.events.try_send(Update::FailedOver(change)));
            }
        }
    }

    /// Tells of an operation that was done, once.
    fn answered(&mut self, id: &str, answer: Result<OperationResult, Rejected>) {
        let place = self.asked.iter().position(|operation| operation.request_id == id);
        let Some(operation) = place.and_then(|place| self.asked.remove(place)) else { return };
        self.asked.retain(|operation| operation.request_id != id);
        // Who asks the same again hears of the same revision, which is told already; and what changed nothing has none.
        if let Ok(result) = answer
            && result.revision > self.told_revision
        {
            self.told_revision = result.revision;
            drop(self.events.try_send(Update::Operated(Box::new((operation, result)))));
        }
    }

    /// Tells the server where the axis is. Of several reports that wait, the newest says it all; refusals go one by one.
    fn report(&mut self) {
        let mut newest = None;
        while let Ok(word) = self.reports.reports.pop() {
            let refuses = word.report.refused.is_some();
            newest = Some(word);
            if refuses {
                break;
            }
        }
        self.reports.thread.wake();
        if let Some(Word { mut report, heeded }) = newest {
            self.figures.report(&report);
            report.tracking = self.watched.take();
            self.uplink.report(report, heeded);
        }
        if !self.reports.reports.is_empty() {
            self.reports.news.notify_one();
        }
    }
}

fn fed(next: client::failover::Feed) -> Fed {
    use client::failover::Feed as Next;
    match next {
        Next::Revised(epoch, revision) => Fed::Revised(epoch, revision),
        Next::Batch(epoch, batch) => Fed::Batch(epoch, batch),
        Next::Resuming => Fed::Resuming,
        Next::Stays => Fed::Stays,
        Next::GoesOn(epoch, rested) => Fed::GoesOn(epoch, rested),
    }
}

/// Tells whoever looks on what the axes do, until the cycle thread is done and everything is told.
async fn tell(
    mut ring: SampleRing,
    mut events: mpsc::Receiver<Update>,
    teller: mpsc::Sender<Update>,
    (clock, watched): (Clock, &WatchedBy),
) {
    let figures = Figures::resolve();
    let mut queue = VecDeque::new();
    let mut has_events = true;
    let mut lost = 0_u64;
    loop {
        let done = ring.full.is_abandoned();
        while clock == Clock::Wall || queue.len() < WAITING {
            let Ok(mut chunk) = ring.full.pop() else { break };
            let samples = chunk.read();
            watched.put(&samples.tracking);
            if clock == Clock::Wall {
                figures.lateness(&samples.tracking.cycle_jitter_ns);
            }
            queue.push_back(Update::Samples(samples));
            chunk.clear();
            // There are as many places as chunks.
            let _ = ring.empty.push(chunk);
            ring.thread.wake();
        }
        while clock == Clock::Wall && queue.len() > WAITING {
            queue.pop_front();
            lost += 1;
        }
        if done && ring.full.is_empty() && queue.is_empty() && !has_events {
            break;
        }
        tokio::select! {
            () = ring.news.notified() => {}
            event = events.recv(), if has_events => match event {
                Some(update) => queue.push_back(update),
                None => has_events = false,
            },
            permit = teller.reserve(), if !queue.is_empty() => {
                let Ok(permit) = permit else { return };
                let Some(update) = queue.pop_front() else { continue };
                permit.send(update);
            }
        }
    }
    if lost > 0 {
        tracing::info!(lost, "a slow reader has lost messages");
    }
}
