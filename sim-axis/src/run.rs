//! One tracking run: one stream, its axes, and whoever looks on.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime};

use client::failover::{Change, DEFAULT_PATIENCE, Failure, News};
use client::{Buffer, Connect, Next, Servers, Standing, Uplink};
use planner::{Accepted, AxisKind, Setpoint};
use proto::Digest;
use proto::stream::{
    Counters, DEFAULT_AXIS_GUARD, DEFAULT_BATCH_CYCLES, DEFAULT_LEAD_CYCLES, Motion, Open, Opened, Operation,
    Source, StreamEvent,
};
use tokio::sync::{mpsc, oneshot};

use crate::axis::{Axis, AxisConfig, InvalidConfig};
use crate::clock::Clock;
use crate::commands::{Answered, Command, Commander, Waiting, commander};
use crate::cycle_thread::{Fed, Feed, Outcome, Outside, ReportRing, SampleRing, Word, spawn};
use crate::figures::Figures;
use crate::jitter::Jitter;
use crate::model::AxisModel;
use crate::monitor::ReportCard;
use crate::player::{Divergence, Player};
use crate::samples::Samples;
use crate::watched::WatchedBy;

/// What an axis is asked to follow, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackRequest {
    /// Name of the stream to open.
    pub stream: String,
    /// Where planners are; tried in order until one opens the stream, and again where the one that serves it is lost.
    pub endpoints: Vec<String>,
    /// The motion.
    pub plan: Accepted,
    /// Models by axis name; an axis that is not named follows ideally.
    pub models: Vec<AxisModel>,
    /// What the run goes by.
    pub clock: Clock,
    /// How far ahead setpoints are held [cycles].
    pub lead_cycles: u32,
    /// How long the loads are watched after the last setpoint [s].
    pub settle_window: f64,
    /// How near to the goal is settled [axis units]; `None`: [`default_settle_tolerance`] of each axis's kind.
    pub settle_tolerance: Option<f64>,
    /// Keep the stream open at rest, until it is closed from outside? In virtual time nothing happens then.
    pub stay_open: bool,
    /// Take a plan that does not guarantee velocity and acceleration?
    pub accept_unproved: bool,
    /// How long a planner that goes on is looked for, once there is none.
    pub patience: Duration,
    /// How planners are connected to.
    pub connect: Connect,
}

/// How long loads are watched after the last setpoint where nobody says [s]: two dozen swings of a soft machine.
pub const DEFAULT_SETTLE_WINDOW: f64 = 0.5;

/// How near to the goal is settled where nobody says [axis units]: 10 µm, 10 µrad, or one pulse.
#[must_use]
pub fn default_settle_tolerance(kind: AxisKind) -> f64 {
    match kind {
        AxisKind::Prismatic | AxisKind::Revolute => 1e-5,
        AxisKind::Pulses => 1.0,
    }
}

impl TrackRequest {
    fn servers(&self) -> Servers {
        let (endpoints, connect) = (self.endpoints.clone(), self.connect.clone());
        Servers { endpoints, connect, patience: self.patience }
    }

    /// To follow `plan` from the planner at `endpoint`, with ideal axes, in wall-clock time.
    #[must_use]
    pub fn new(stream: impl Into<String>, endpoint: impl Into<String>, plan: Accepted) -> Self {
        Self {
            stream: stream.into(),
            endpoints: vec![endpoint.into()],
            plan,
            models: Vec::new(),
            clock: Clock::Wall,
            lead_cycles: DEFAULT_LEAD_CYCLES,
            settle_window: DEFAULT_SETTLE_WINDOW,
            settle_tolerance: None,
            stay_open: false,
            accept_unproved: false,
            patience: DEFAULT_PATIENCE,
            connect: Connect::new(),
        }
    }
}

/// How well the axes followed.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackingReport {
    /// One card for each axis, in plan order.
    pub axes: Vec<ReportCard>,
    /// How the stream did.
    pub stream: StreamReport,
}

/// How the stream of a run did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StreamReport {
    /// Cycles given to the servo; those of the settle window are not counted.
    pub cycles_executed: u64,
    /// As in the reports to the server. In virtual time the axis waits for data at half the lead, which is the least that it
    /// then reports.
    pub counters: Counters,
    /// Times that the stream went on with another replica.
    pub failovers: u64,
    /// Revisions of the motion that were adopted: one for each operation that changed it.
    pub revisions: u64,
    /// How late cycles began; 0 in virtual time.
    pub jitter: Jitter,
    /// Of the last cycle of the motion that was played; cycles at rest after it are not in it.
    pub digest: Digest,
    /// Was a stop tail played?
    pub stop_tail_used: bool,
}

/// What a run tells while it goes on.
#[derive(Clone, Debug, PartialEq)]
pub enum Update {
    /// How the axes follow.
    Samples(Samples),
    /// Something happened to the stream.
    Event(StreamEvent),
    /// Another planner goes on with it.
    FailedOver(Change),
}

/// Why a run has no report, or none that is whole.
#[derive(Debug, thiserror::Error)]
pub enum TrackError {
    /// Nowhere to go.
    #[error("no endpoint is given: name at least one planner, as http://127.0.0.1:50051")]
    NoEndpoint,
    /// A model for an axis that does not move.
    #[error("no axis is called {name:?}: the plan has {known}")]
    UnknownAxis {
        /// The name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// An axis that cannot be simulated like this.
    #[error("axis {axis:?}: {cause}")]
    Config {
        /// Its name.
        axis: String,
        /// Why not.
        cause: InvalidConfig,
    },
    /// No planner opened the stream.
    #[error("the stream cannot be opened: {cause}")]
    NotOpened {
        /// The last one that was tried.
        endpoint: String,
        /// What it said.
        cause: client::Error,
    },
    /// The stream broke off before the motion had ended, and no planner went on. The axis has played what it held, and its way to rest.
    #[error(
        "the stream ended at cycle {executed} of {motion_end}: {cause}; the axis rests there: plan from where it stands \
         and run again"
    )]
    Broken {
        /// The last cycle that was played.
        executed: u64,
        /// The last cycle of the motion.
        motion_end: u64,
        /// What happened.
        cause: client::Error,
        /// How well the axis followed until there.
        report: Box<TrackingReport>,
    },
    /// An axis left its setpoints beyond any sense.
    #[error(
        "axis {axis:?} diverged in cycle {cycle}: it was more than a thousand times its travel away from its setpoint; lower \
         the gains of its servo, raise its max_effort, or ask for less acceleration"
    )]
    Diverged {
        /// Its name.
        axis: String,
        /// When.
        cycle: u64,
        /// How well the axes followed until there.
        report: Box<TrackingReport>,
    },
    /// Whoever looked on has gone, and the run with them.
    #[error("nobody looks on any more, so the run was ended")]
    Abandoned,
    /// The process cannot run one more axis.
    #[error("the cycle thread cannot run: {0}")]
    Thread(String),
}

impl TrackError {
    /// How well the axes followed until the run broke off, where it had begun.
    #[must_use]
    pub fn report(&self) -> Option<&TrackingReport> {
        match self {
            Self::Broken { report, .. } | Self::Diverged { report, .. } => Some(report),
            Self::NoEndpoint
            | Self::UnknownAxis { .. }
            | Self::Config { .. }
            | Self::NotOpened { .. }
            | Self::Abandoned
            | Self::Thread(_) => None,
        }
    }
}

/// A run that has begun. Dropping it ends the run.
#[derive(Debug)]
pub struct Tracking {
    motion: Motion,
    served_by: String,
    commander: Commander,
    updates: mpsc::Receiver<Update>,
    result: oneshot::Receiver<Result<TrackingReport, TrackError>>,
}

/// Runs to the end, and gives every update to `on_update`.
///
/// # Errors
/// Those of [`Tracking::begin`] and [`Tracking::finish`].
pub async fn track(
    request: TrackRequest,
    mut on_update: impl FnMut(Update),
) -> Result<TrackingReport, TrackError> {
    let mut tracking = Tracking::begin(request).await?;
    while let Some(update) = tracking.next().await {
        on_update(update);
    }
    tracking.finish().await
}

impl Tracking {
    /// Opens the stream and lets the axes follow it.
    ///
    /// # Errors
    /// A request that cannot be run, before anything is opened; a stream that no planner opens.
    pub async fn begin(request: TrackRequest) -> Result<Self, TrackError> {
        Self::begin_with(request, Vec::new()).await.map(|(tracking, _)| tracking)
    }

    /// The same, with operations that the server knows before the first cycle is played; what becomes of each is told in turn.
    ///
    /// # Errors
    /// Those of [`Tracking::begin`].
    pub async fn begin_with(
        request: TrackRequest,
        operations: Vec<Operation>,
    ) -> Result<(Self, Vec<Answered>), TrackError> {
        let axes = axes(&request)?;
        let open = open_of(&request);
        let cycle = request.plan.plan().cycle_time();
        let mut uplink = Uplink::new(request.servers(), open.clone(), cycle);
        let Opened { motion, served_by, .. } = opened(&mut uplink).await?;
        let player = player(&open, axes, &motion, &uplink);
        let (commander, commands) = commander();
        let outside = spawn(player, cycle, request.clock).map_err(|e| TrackError::Thread(e.to_string()))?;
        let (teller, updates) = mpsc::channel(UPDATES);
        let (done, result) = oneshot::channel();
        let waiting = Waiting::default();
        let mut answers = Vec::with_capacity(operations.len());
        for operation in operations {
            answers.push(waiting.answered(&operation.request_id));
            uplink.operate(operation);
        }
        tokio::spawn(async move {
            let result = carry(uplink, outside, teller, request.clock, (commands, waiting)).await;
            // Nobody to tell is not a failure.
            let _ = done.send(result);
        });
        Ok((Self { motion, served_by, commander, updates, result }, answers))
    }

    /// The motion as it was opened, with the closing stop of a plan that ends at speed.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Who serves the stream.
    #[must_use]
    pub fn served_by(&self) -> &str {
        &self.served_by
    }

    /// Asks for operations on the motion.
    #[must_use]
    pub fn commander(&self) -> Commander {
        self.commander.clone()
    }

    /// What happens next; `None` when there is no more than the report.
    ///
    /// A run by the wall clock waits for nobody: who reads too slowly loses the oldest samples. In virtual time the run
    /// waits for its reader, so that all of them arrive.
    pub async fn next(&mut self) -> Option<Update> {
        self.updates.recv().await
    }

    /// How the run went. Reads what is left to read.
    ///
    /// # Errors
    /// [`TrackError::Broken`] for a stream that ended too early and [`TrackError::Diverged`] for an axis that did not follow,
    /// with the report until there.
    pub async fn finish(mut self) -> Result<TrackingReport, TrackError> {
        while self.next().await.is_some() {}
        let gone = || Err(TrackError::Thread("its task has ended without a word".into()));
        self.result.await.unwrap_or_else(|_| gone())
    }
}

/// Updates that were handed over and not read.
const UPDATES: usize = 4;
/// Updates that wait to be handed over [messages of about 50 ms].
const WAITING: usize = 64;
/// Events that wait to be taken up.
const EVENTS: usize = 64;
/// How long the server may take to end a stream that the axis has closed.
const GOODBYE: Duration = Duration::from_secs(1);

fn axes(request: &TrackRequest) -> Result<Vec<Axis>, TrackError> {
    let plan = request.plan.plan();
    for model in &request.models {
        if plan.axes().iter().all(|axis| axis.axis != model.axis()) {
            let known = plan.axes().iter().map(|axis| axis.axis.as_str()).collect::<Vec<_>>().join(", ");
            return Err(TrackError::UnknownAxis { name: model.axis().into(), known });
        }
    }
    let starts = plan.sampler().at(0).collect::<Vec<Setpoint>>();
    plan.axes()
        .iter()
        .zip(&starts)
        .map(|(axis, start)| {
            let named = request.models.iter().find(|model| model.axis() == axis.axis);
            let model = named.cloned().unwrap_or_else(|| AxisModel::ideal(axis.axis.clone()));
            let config = AxisConfig {
                cycle: plan.cycle_time().as_seconds(),
                settle_window: request.settle_window,
                settle_tolerance: request.settle_tolerance.unwrap_or(default_settle_tolerance(axis.kind)),
            };
            Axis::new(&model, config, &start.state)
                .map_err(|cause| TrackError::Config { axis: axis.axis.clone(), cause })
        })
        .collect()
}

fn open_of(request: &TrackRequest) -> Open {
    Open {
        stream: request.stream.clone(),
        epoch: fresh_epoch(),
        lead_cycles: request.lead_cycles.max(1),
        // Several reports a lead, or the credit would run out between them.
        batch_cycles: DEFAULT_BATCH_CYCLES.min(request.lead_cycles.div_ceil(2)).max(1),
        axis_guard: DEFAULT_AXIS_GUARD,
        close_at_rest: !request.stay_open,
        accept_unproved: request.accept_unproved,
        executed_cycle: 0,
        source: Source::Plan(request.plan.clone()),
    }
}

/// Larger than that of any run before, over restarts of the process too: the time [ns].
#[expect(clippy::disallowed_methods, reason = "only numbers a run; no setpoint depends on it")]
fn fresh_epoch() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}

/// Waits until one planner has opened the stream, or all have been asked.
async fn opened(uplink: &mut Uplink) -> Result<Opened, TrackError> {
    loop {
        match uplink.next().await {
            Next::News(News::Opened(opened)) => return Ok(*opened),
            Next::News(News::Over(Err(Failure { endpoint, cause }))) => {
                let endpoint = uplink.endpoint(endpoint).to_owned();
                return Err(TrackError::NotOpened { endpoint, cause });
            }
            Next::News(News::Over(Ok(()))) => return Err(TrackError::NoEndpoint),
            Next::News(_) | Next::Feed(_) => {}
        }
    }
}

fn player(open: &Open, axes: Vec<Axis>, motion: &Motion, uplink: &Uplink) -> Player {
    let plan = motion.plan();
    // A closing stop changes nothing at the beginning.
    let setpoints: Vec<Setpoint> = plan.sampler().at(0).collect();
    let buffer = Buffer::new(&Standing {
        epoch: uplink.failover().serving_epoch().unwrap_or(open.epoch),
        lead_cycles: open.lead_cycles,
        axis_guard: open.axis_guard,
        plan,
        setpoints: &setpoints,
    });
    Player::new(buffer, axes, motion.last_cycle(), u64::from(open.batch_cycles))
}

/// Carries everything between the network, the cycle thread and whoever looks on, until the cycle thread is done. One
/// task: what wakes it for several reasons wakes it once.
async fn carry(
    uplink: Uplink,
    outside: Outside,
    teller: mpsc::Sender<Update>,
    clock: Clock,
    (commands, waiting): (mpsc::Receiver<Command>, Waiting),
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
        events,
        failovers: &failovers,
        figures: Figures::resolve(),
        watched: &watched,
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
    commands: mpsc::Receiver<Command>,
    waiting: &'a Waiting,
    events: mpsc::Sender<Update>,
    failovers: &'a AtomicU64,
    figures: Figures,
    watched: &'a WatchedBy,
}

impl Stream<'_> {
    /// Until nothing more will come, and the cycle thread knows that.
    async fn carry(mut self, feed: &mut Feed) -> Result<(), client::Error> {
        let mut asked = true;
        let how = loop {
            tokio::select! {
                biased;
                next = self.uplink.next() => match next {
                    // A cycle thread that is done has no more use for it; the stream is read to its end all the same.
                    Next::Feed(next) => {
                        feed.push(fed(next)).await;
                    }
                    Next::News(News::Over(how)) => break how.map_err(|failure| failure.cause),
                    Next::News(news) => self.hear(news),
                },
                () = self.reports.news.notified() => self.report(),
                command = self.commands.recv(), if asked => match command {
                    Some(Command { operation, answer }) => {
                        self.waiting.expect(&operation.request_id, answer);
                        self.uplink.operate(operation);
                    }
                    None => asked = false,
                },
            }
            feed.asked_from(self.uplink.failover().asked_from());
        };
        self.waiting.give_up();
        feed.push(Fed::Closed).await;
        how.inspect_err(|error| tracing::warn!(%error, "the stream broke off"))
    }

    fn hear(&mut self, news: News) {
        // Who does not take up events loses the newest: none of them says what a report does not.
        match news {
            News::Opened(_) | News::Over(_) => {}
            News::Answer(id, answer) => self.waiting.tell(&id, &answer),
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
