//! Who serves a stream, decided without a clock, a task or a socket: [`Failover`] takes what happened and when, and says what is to be
//! done. An [`Uplink`](crate::Uplink) does it over gRPC; a simulation does it in a `for`.
//!
//! ```text
//!               opened                 lost, leaving, silent, starved
//!  ●─► OPENING ───────► SERVED ◄──────────────────────────────────────► SEARCHING
//!         │               │ all is held, or the stream is over             │ nobody has gone on for too long
//!         ▼               ▼                                                ▼
//!       OVER            OVER                                             OVER
//! ```
//!
//! Make before break: while another server is looked for, the old one serves on if it can, under its epoch. It begins no new revision
//! from the moment on at which the axis has heeded that (a replica is told the revision which is adopted, and no other). The first server
//! that opens holds from then on, and all others are dropped. A newer open has a larger epoch, so nobody serves twice.

mod search;

use std::collections::VecDeque;
use std::time::Duration;

use planner::CycleTime;
use proto::stream::{
    Batch, FromAxis, Motion, Open, Operation, OperationRefusal, OperationResult, Report, Source, StreamEvent,
    StreamEventKind, ToAxis,
};
use proto::{Digest, Reason, Rejected};

use crate::{Error, Record, Revision};
use search::{Search, Timing};

/// Why another server is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cause {
    /// The stream broke off.
    Lost,
    /// The server has said that it leaves.
    Draining,
    /// The lead has fallen under its half, and nothing comes.
    Silent,
    /// The axis cannot take what it sends.
    Refused,
    /// The axis has come to rest, or is about to.
    Starved,
}

impl Cause {
    /// Every cause.
    pub const ALL: [Self; 5] = [Self::Lost, Self::Draining, Self::Silent, Self::Refused, Self::Starved];

    /// As it is told to people and programs.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Lost => "lost",
            Self::Draining => "draining",
            Self::Silent => "silent",
            Self::Refused => "refused",
            Self::Starved => "starved",
        }
    }
}

/// What the buffer of the axis is to be given, in this order.
#[derive(Debug)]
pub enum Feed {
    /// To be announced.
    Revised(u64, Revision),
    /// To be accepted.
    Batch(u64, Batch),
    /// To be heeded by [`Buffer::resuming`](crate::Buffer::resuming), and said so in a report.
    Resuming,
    /// The search is over: revisions begin again.
    Stays,
    /// For [`Buffer::goes_on`](crate::Buffer::goes_on); a report is due at once.
    GoesOn(u64, Option<(Revision, Digest)>),
}

/// What is to be told to whoever runs the axis.
#[derive(Clone, Debug, PartialEq)]
pub enum News {
    /// The stream is open.
    Opened(Box<Begun>),
    /// Something happened to it.
    Event(StreamEvent),
    /// What became of an operation, by its id.
    Answer(String, Result<OperationResult, Rejected>),
    /// Another server goes on.
    FailedOver(Change),
    /// Nothing more will come.
    Over(Result<(), Failure>),
}

/// What a stream begins with.
#[derive(Clone, Debug, PartialEq)]
pub struct Begun {
    /// What will be played.
    pub motion: Motion,
    /// Who serves.
    pub served_by: String,
}

/// Why a stream is not open any more, or was never opened.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// The number of the endpoint that was asked last, or has served.
    pub endpoint: usize,
    /// What came of that.
    pub cause: Error,
}

/// One server went on where another had served.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// Why.
    pub cause: Cause,
    /// Who served until then.
    pub from: String,
    /// Who serves now.
    pub to: String,
    /// The last cycle that was known to be executed.
    pub executed_cycle: u64,
    /// From the moment at which another server was looked for until it had opened.
    pub took: Duration,
}

/// What is to be done about connections.
#[derive(Debug)]
pub enum Action {
    /// Open a stream at the endpoint of this number, under the epoch of `open`. What comes of it is
    /// [heard](Failover::heard), or [ended](Failover::ended), under that epoch.
    Try {
        /// In the order in which endpoints were given.
        endpoint: usize,
        /// What to open with.
        open: Box<Open>,
    },
    /// Say this on the stream of this epoch.
    Send(u64, FromAxis),
    /// Close the stream of this epoch, or stop opening it.
    Drop(u64),
    /// Give this to the buffer.
    Feed(Feed),
    /// Tell this.
    Tell(News),
}

/// How long an axis looks for a server that goes on before it gives up, where nobody says: longer than a process takes to be started
/// again.
pub const DEFAULT_PATIENCE: Duration = Duration::from_secs(10);

/// How long a server may take to say that the stream has ended, once all of it is executed.
const FAREWELL: Duration = Duration::from_secs(1);

/// How many batches of a server in a row the axis refuses before another is asked: it has sent again what came wrong once.
const MOST_REFUSALS: u32 = 2;

/// How many servers in a row may say what cannot be read while operations are asked for, before it is taken for what they make of
/// those: whoever is asked next would say it again.
const MOST_UNREADABLE: u32 = 3;

/// The server of a stream, and the search for another.
#[derive(Debug)]
pub struct Failover {
    /// What every open of this stream says; the source is that of the first.
    open: Open,
    endpoints: usize,
    timing: Timing,
    /// The newest that was used.
    epoch: u64,
    /// Of a stream that has been open.
    record: Option<Record>,
    serving: Option<Serving>,
    search: Search,
    /// How often the axis was told to begin no revision.
    asked: u64,
    /// The digest of the end of a way to rest that no server knows of yet.
    rested: Option<Digest>,
    unanswered: Vec<Operation>,
    /// Those of them that a server has left undone: the next one is asked, and if there is none they are answered so.
    undone: Vec<(String, Rejected)>,
    /// Why the stream is not served any more.
    lost_for: Option<Failure>,
    last_failure: Option<Failure>,
    /// The server said that the stream has ended.
    finished: bool,
    /// All is executed, and only the farewell of the server is waited for, until then.
    farewell_until: Option<Duration>,
    over: bool,
    /// When setpoints last came, or the server was opened.
    fed_at: Duration,
    /// The last cycle that came, as far as it was not refused.
    fed_to: u64,
    granted: u64,
    /// Batches that were refused since it does.
    refusals: u32,
    /// Servers that have said what cannot be read while operations were asked for, since one was answered.
    unreadable: u32,
    actions: VecDeque<Action>,
}

/// The server that holds the stream.
#[derive(Clone, Debug)]
struct Serving {
    epoch: u64,
    endpoint: usize,
    served_by: String,
    /// It still speaks.
    is_there: bool,
}

impl Failover {
    /// Begins to open a stream at one of `endpoints` servers, the first of them first; with none it is over.
    #[must_use]
    pub fn new(now: Duration, open: Open, cycle: CycleTime, endpoints: usize, patience: Duration) -> Self {
        let epoch = open.epoch;
        let timing = Timing::new(cycle, u64::from(open.lead_cycles), patience, epoch);
        let mut failover = Self {
            open,
            endpoints,
            timing,
            epoch: epoch.saturating_sub(1),
            record: None,
            serving: None,
            search: Search::Idle,
            asked: 0,
            rested: None,
            unanswered: Vec::new(),
            undone: Vec::new(),
            lost_for: None,
            last_failure: None,
            finished: false,
            farewell_until: None,
            over: false,
            fed_at: now,
            fed_to: 0,
            granted: 0,
            refusals: 0,
            unreadable: 0,
            actions: VecDeque::new(),
        };
        if endpoints == 0 {
            failover.end(Ok(()));
        } else {
            failover.begin_opening(now);
        }
        failover
    }

    /// What is to be done next, if anything.
    pub fn poll(&mut self) -> Option<Action> {
        self.actions.pop_front()
    }

    /// When [`woken`](Self::woken) is to be called at the latest; `None` where only what happens counts.
    #[must_use]
    pub fn wake_at(&self) -> Option<Duration> {
        let wakes = [self.search.wake_at(), self.suspects_at(), self.farewell_until];
        if self.over { None } else { wakes.into_iter().flatten().min() }
    }

    /// Nothing more will come.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.over
    }

    /// The motion as the axis has adopted it, of a stream that is open.
    #[must_use]
    pub fn record(&self) -> Option<&Record> {
        self.record.as_ref()
    }

    /// Who serves, or did last.
    #[must_use]
    pub fn served_by(&self) -> &str {
        self.serving.as_ref().map_or("", |serving| &serving.served_by)
    }

    /// The epoch that holds, while somebody serves.
    #[must_use]
    pub fn serving_epoch(&self) -> Option<u64> {
        self.serving.as_ref().filter(|serving| serving.is_there).map(|serving| serving.epoch)
    }

    fn is_served(&self) -> bool {
        self.serving_epoch().is_some()
    }

    /// The number of the endpoint that serves, or did last.
    #[must_use]
    pub fn endpoint(&self) -> Option<usize> {
        self.serving.as_ref().map(|serving| serving.endpoint)
    }

    /// A server said something under `epoch`.
    pub fn heard(&mut self, now: Duration, epoch: u64, message: ToAxis) {
        if self.over {
            return;
        }
        if self.serving.as_ref().is_some_and(|serving| serving.is_there && serving.epoch == epoch) {
            self.heard_serving(now, epoch, message);
        } else if let Some(endpoint) = self.search.endpoint_of(epoch) {
            match message {
                ToAxis::Opened(opened) => self.opened(now, epoch, endpoint, *opened),
                _ => {
                    let text = "the first message does not open the stream";
                    self.ended(now, epoch, Err(Error::Protocol(text.into())));
                }
            }
        }
    }

    fn heard_serving(&mut self, now: Duration, epoch: u64, message: ToAxis) {
        match message {
            ToAxis::Opened(_) => {
                let text = "the stream was opened twice";
                self.ended(now, epoch, Err(Error::Protocol(text.into())));
            }
            ToAxis::Revised(revised) => {
                let revision = Revision::of(&revised.motion);
                if let Some(record) = &mut self.record {
                    record.announce(revised.motion);
                }
                self.feed(Feed::Revised(epoch, revision));
            }
            ToAxis::Batch(mut batch) => {
                (self.fed_at, self.fed_to) = (now, batch.last_cycle());
                if let Some(record) = &mut self.record {
                    if self.open.compact {
                        record.evaluate(&mut batch, u64::from(self.open.lead_cycles));
                    }
                    record.carry(&batch);
                }
                self.feed(Feed::Batch(epoch, batch));
            }
            ToAxis::Event(event) => {
                self.finished |= event.kind == StreamEventKind::Finished;
                self.tell(News::Event(event));
                if event.kind == StreamEventKind::Draining {
                    self.look_elsewhere(now, Cause::Draining);
                }
            }
            ToAxis::Result(result) => {
                self.answer(result.request_id.clone(), Ok(result));
            }
            ToAxis::Refusal(OperationRefusal { request_id, rejected }) => {
                // What a session leaves undone, the next one is asked again; and an axis that looks for another server begins no
                // revision.
                let again = rejected.is_left_undone()
                    || (rejected.reason == Reason::NotConfirmed && !self.search.is_idle());
                if again {
                    return self.undone.push((request_id, rejected));
                }
                self.answer(request_id, Err(rejected));
            }
        }
    }

    /// The stream of `epoch` has ended, or cannot be opened: well, or for a reason.
    pub fn ended(&mut self, now: Duration, epoch: u64, how: Result<(), Error>) {
        if self.over {
            return;
        }
        let serves = |serving: &&mut Serving| serving.is_there && serving.epoch == epoch;
        if let Some(serving) = self.serving.as_mut().filter(serves) {
            serving.is_there = false;
            self.drop_line(epoch);
            return self.lost(now, how);
        }
        if let Some(endpoint) = self.search.endpoint_of(epoch) {
            let too_early = || Error::Protocol("the stream ended before it was opened".into());
            self.failed(now, epoch, endpoint, how.err().unwrap_or_else(too_early));
        }
    }

    fn lost(&mut self, now: Duration, how: Result<(), Error>) {
        let whole = self.record.as_ref().is_some_and(Record::is_whole);
        if whole || (self.finished && how.is_ok()) {
            // How the farewell goes does not matter any more.
            return self.end(Ok(()));
        }
        if let Err(Error::Rejected(rejected)) = &how
            && rejected.reason == Reason::EpochSuperseded
            && rejected.metadata.get("current_epoch").and_then(|by| by.parse().ok()) > Some(self.epoch)
        {
            // Somebody else has opened it.
            return self.fail(Error::Rejected(rejected.clone()));
        }
        let too_early = || Error::Protocol("the stream ended before the motion did".into());
        let cause = how.err().unwrap_or_else(too_early);
        if let Error::Protocol(problem) = &cause {
            self.count_unreadable(problem);
        }
        self.lost_for = self.endpoint().map(|endpoint| Failure { endpoint, cause });
        self.look_elsewhere(now, Cause::Lost);
    }

    /// A server broke the protocol. Where that goes on, operations are to blame, and are asked for no more.
    fn count_unreadable(&mut self, problem: &str) {
        if self.unanswered.is_empty() {
            self.unreadable = 0;
            return;
        }
        self.unreadable += 1;
        if self.unreadable < MOST_UNREADABLE {
            return;
        }
        self.unreadable = 0;
        self.undone.clear();
        let text =
            format!("{MOST_UNREADABLE} servers in a row have made of it what cannot be read: {problem}");
        for Operation { request_id, .. } in std::mem::take(&mut self.unanswered) {
            self.tell(News::Answer(request_id, Err(Rejected::new(Reason::NotConfirmed, text.clone()))));
        }
    }

    /// What became of an operation.
    fn answer(&mut self, request_id: String, answer: Result<OperationResult, Rejected>) {
        self.unreadable = 0;
        self.unanswered.retain(|operation| operation.request_id != request_id);
        self.tell(News::Answer(request_id, answer));
    }

    /// The axis says how far it is; `heeded` counts the times that it was told to begin no revision, and does not.
    pub fn reported(&mut self, now: Duration, report: Report, heeded: u64) {
        let Some(record) = self.record.as_mut().filter(|_| !self.over) else { return };
        self.granted = report.grant_cycle;
        if let Some(first) = report.tail_from_cycle {
            return self.starved(now, first - 1, report);
        }
        let held = record.held();
        record.report(&report);
        if record.held() != held {
            self.refusals = 0;
        }
        if report.refused.is_some() {
            self.fed_to = record.held();
        }
        let is_whole = record.is_whole();
        // A line that has gone silent must not keep the axis from its end.
        self.farewell_until =
            if record.is_executed() { self.farewell_until.or(Some(now + FAREWELL)) } else { None };
        if let Some(refused) = report.refused.as_ref().filter(|refused| refused.reason.is_of_its_server()) {
            self.refusals += 1;
            if self.refusals >= MOST_REFUSALS {
                self.lost_for =
                    self.endpoint().map(|endpoint| Failure { endpoint, cause: Error::refused(refused) });
                self.look_elsewhere(now, Cause::Refused);
            }
        }
        // What came while its server went was the rest: there is nothing to go on with.
        if is_whole && !self.is_served() {
            return self.end(Ok(()));
        }
        self.say(FromAxis::Report(report));
        if heeded >= self.asked {
            self.heeded(now);
        }
    }

    /// The axis has heard no more after `from`, and plays its way to rest.
    fn starved(&mut self, now: Duration, from: u64, report: Report) {
        let Some(record) = &mut self.record else { return };
        // It says so until somebody goes on.
        if self.rested.is_some() || record.motion().revision() > report.revision {
            return;
        }
        let digest = report.digest;
        record.report(&Report { tail_from_cycle: None, ..report.clone() });
        match record.starve(from, digest) {
            Ok(end) => self.rested = Some(end),
            Err(rejected) => return self.fail(Error::Rejected(Box::new(rejected))),
        }
        self.say(FromAxis::Report(report));
        if let Some(serving) = self.serving.as_mut().filter(|serving| serving.is_there) {
            serving.is_there = false;
            let epoch = serving.epoch;
            self.drop_line(epoch);
        }
        self.begin_again(now);
    }

    /// Asks for an operation; what becomes of it is told, also where another server goes on in the meantime.
    pub fn operate(&mut self, operation: Operation) {
        self.unanswered.push(operation.clone());
        self.say(FromAxis::Operation(operation));
    }

    /// The first cycle at which an operation may take effect that is asked for and not answered; `u64::MAX` where there is none.
    #[must_use]
    pub fn asked_from(&self) -> u64 {
        let from = self.unanswered.iter().map(|operation| operation.not_before_cycle.unwrap_or(0));
        from.min().unwrap_or(u64::MAX)
    }

    /// Asks again for what was left undone meanwhile.
    fn ask_again(&mut self) {
        let undone = std::mem::take(&mut self.undone);
        let again = self
            .unanswered
            .iter()
            .filter(|operation| undone.iter().any(|(id, _)| *id == operation.request_id));
        for operation in again.cloned().collect::<Vec<_>>() {
            self.say(FromAxis::Operation(operation));
        }
    }

    /// The axis has no more use for the stream.
    pub fn close(&mut self) {
        if !self.over {
            self.end(Ok(()));
        }
    }

    fn fail(&mut self, cause: Error) {
        let endpoint = self.endpoint().unwrap_or_default();
        self.end(Err(Failure { endpoint, cause }));
    }

    fn end(&mut self, how: Result<(), Failure>) {
        if let Some(serving) = self.serving.as_ref().filter(|serving| serving.is_there) {
            self.actions.push_back(Action::Drop(serving.epoch));
        }
        for epoch in self.search.give_up() {
            self.actions.push_back(Action::Drop(epoch));
        }
        self.over = true;
        for (request_id, rejected) in std::mem::take(&mut self.undone) {
            self.answer(request_id, Err(rejected));
        }
        self.tell(News::Over(how));
    }

    fn feed(&mut self, feed: Feed) {
        self.actions.push_back(Action::Feed(feed));
    }

    fn tell(&mut self, news: News) {
        self.actions.push_back(Action::Tell(news));
    }

    /// Says something to the server, if there is one.
    fn say(&mut self, message: FromAxis) {
        if let Some(serving) = self.serving.as_ref().filter(|serving| serving.is_there) {
            self.actions.push_back(Action::Send(serving.epoch, message));
        }
    }

    fn drop_line(&mut self, epoch: u64) {
        self.actions.push_back(Action::Drop(epoch));
    }

    /// What to open with now.
    fn opening(&self, epoch: u64) -> Open {
        match &self.record {
            None => Open { epoch, ..self.open.clone() },
            Some(record) => {
                let source = Source::Resume(Box::new(record.resume()));
                Open { epoch, executed_cycle: record.executed(), source, ..self.open.clone() }
            }
        }
    }
}
