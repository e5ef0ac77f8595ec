//! Looking for a server that goes on: whom to ask next, and when to give up.

use std::time::Duration;

use planner::CycleTime;
use proto::Reason;
use proto::stream::Opened;
use tonic::Code;

use super::{Action, Begun, Cause, Change, Failover, Failure, Feed, News, Serving};
use crate::{Error, Record, Revision};

/// What is done about it.
#[derive(Debug)]
pub(super) enum Search {
    /// Nothing: the stream is served.
    Idle,
    /// The axis has been told to begin no revision, and has not said yet that it heeds that.
    Asking(Errand),
    /// Servers are asked.
    Trying {
        errand: Errand,
        attempts: Vec<Attempt>,
        /// How many endpoints have been asked in this round.
        tried: usize,
        /// When the next one is asked, if none has opened by then; `None` when all have been.
        next_at: Option<Duration>,
        /// Every one that has answered in this round refuses for good.
        hopeless: bool,
    },
    /// All have been asked, to no avail.
    Waiting { errand: Errand, until: Duration },
}

/// Why, and since when.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errand {
    cause: Cause,
    since: Duration,
    rounds: u32,
    /// How often the server that is to be left has opened again.
    same: u32,
}

/// A stream that is being opened.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attempt {
    epoch: u64,
    endpoint: usize,
    until: Duration,
}

/// How long things may take.
#[derive(Clone, Debug)]
pub(super) struct Timing {
    /// What a full lead lasts.
    lead: Duration,
    patience: Duration,
    jitter: u64,
}

/// How long one server may take to open a stream: longer than that it has not even connected.
const OPENING: Duration = Duration::from_secs(10);
/// The same while an axis moves on what it holds.
const GOING_ON: Duration = Duration::from_secs(2);
/// How long nothing may come of what is granted, however long the lead is, before another server is asked.
const SILENCE: Duration = Duration::from_secs(1);
/// The longest and the shortest wait before the next server is asked beside one that has not answered.
const HEDGES: (Duration, Duration) = (Duration::from_millis(2), Duration::from_millis(250));
/// The longest and the shortest wait after a round in which nobody went on.
const BACK_OFF: (Duration, Duration) = (Duration::from_millis(5), Duration::from_secs(1));
/// How often one that is to be left may open again before it is taken all the same: behind a balancer others come in turn.
const MOST_SAME: u32 = 4;

impl Timing {
    pub(super) fn new(cycle: CycleTime, lead_cycles: u64, patience: Duration, seed: u64) -> Self {
        let lead = Duration::from_nanos(cycle.as_ns().saturating_mul(lead_cycles));
        Self { lead, patience, jitter: seed }
    }

    /// Half to one and a half of it, drawn. Steele, Lea and Flood (2014), splitmix64.
    fn jittered(&mut self, wait: Duration) -> Duration {
        self.jitter = self.jitter.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.jitter;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let unit = (z ^ (z >> 31)) as f64 / u64::MAX as f64;
        wait.mul_f64(0.5 + unit)
    }
}

impl Search {
    pub(super) fn is_idle(&self) -> bool {
        matches!(self, Self::Idle)
    }

    pub(super) fn endpoint_of(&self, epoch: u64) -> Option<usize> {
        let Self::Trying { attempts, .. } = self else { return None };
        attempts.iter().find(|attempt| attempt.epoch == epoch).map(|attempt| attempt.endpoint)
    }

    pub(super) fn wake_at(&self) -> Option<Duration> {
        match self {
            Self::Idle | Self::Asking(_) => None,
            Self::Trying { attempts, next_at, .. } => {
                attempts.iter().map(|attempt| attempt.until).chain(*next_at).min()
            }
            Self::Waiting { until, .. } => Some(*until),
        }
    }

    /// Leaves everything; gives the epochs that were being opened.
    pub(super) fn give_up(&mut self) -> Vec<u64> {
        match std::mem::replace(self, Self::Idle) {
            Self::Trying { attempts, .. } => attempts.iter().map(|attempt| attempt.epoch).collect(),
            Self::Idle | Self::Asking(_) | Self::Waiting { .. } => Vec::new(),
        }
    }

    fn errand(&self) -> Option<Errand> {
        match self {
            Self::Idle => None,
            Self::Asking(errand) | Self::Trying { errand, .. } | Self::Waiting { errand, .. } => {
                Some(*errand)
            }
        }
    }

    fn errand_mut(&mut self) -> Option<&mut Errand> {
        match self {
            Self::Idle => None,
            Self::Asking(errand) | Self::Trying { errand, .. } | Self::Waiting { errand, .. } => Some(errand),
        }
    }
}

impl Failover {
    pub(super) fn begin_opening(&mut self, now: Duration) {
        let errand = Errand { cause: Cause::Lost, since: now, rounds: 0, same: 0 };
        self.begin_round(now, errand);
    }

    /// Time has passed.
    pub fn woken(&mut self, now: Duration) {
        if self.over {
            return;
        }
        if self.farewell_until.is_some_and(|until| until <= now) {
            return self.end(Ok(()));
        }
        if self.suspects_at().is_some_and(|at| at <= now) {
            self.look_elsewhere(now, Cause::Silent);
        }
        match &self.search {
            Search::Idle | Search::Asking(_) => {}
            Search::Waiting { errand, until } if *until <= now => {
                let errand = *errand;
                if self.has_come_back(&errand) {
                    self.search = Search::Idle;
                    self.ask_again();
                } else {
                    self.begin_asking(errand, now);
                }
            }
            Search::Waiting { .. } => {}
            Search::Trying { errand, .. } if self.has_come_back(errand) => {
                for epoch in self.search.give_up() {
                    self.drop_line(epoch);
                }
                self.feed(Feed::Stays);
                self.ask_again();
            }
            Search::Trying { attempts, .. } => {
                let late: Vec<Attempt> =
                    attempts.iter().filter(|attempt| attempt.until <= now).copied().collect();
                for Attempt { epoch, endpoint, .. } in late {
                    self.drop_line(epoch);
                    let text = "no answer in time";
                    self.failed(now, epoch, endpoint, Error::Unanswered { cause: text.into() });
                }
                self.try_due(now);
            }
        }
    }

    /// When too little will have come for too long; `None` while nothing is missing.
    ///
    /// The lead is what there is to lose: half of it is gone, and for a quarter of it nothing has come. And where the lead is long, or the
    /// axis does not play, that what is granted does not come.
    pub(super) fn suspects_at(&self) -> Option<Duration> {
        let record = self.record.as_ref()?;
        let is_served = self.is_served();
        if !self.search.is_idle() || !is_served || record.is_whole() || self.finished {
            return None;
        }
        let low = record.executed() > 0 && 2 * self.ahead(record) < u64::from(self.open.lead_cycles);
        let missing = self.fed_to < self.granted;
        let low = low.then_some(self.fed_at + self.timing.lead / 4);
        let silent = missing.then_some(self.fed_at + SILENCE.max(self.timing.lead));
        [low, silent].into_iter().flatten().min()
    }

    /// How many cycles are held, or on their way to the axis.
    fn ahead(&self, record: &Record) -> u64 {
        record.held().max(self.fed_to).saturating_sub(record.executed())
    }

    /// Was it only slow?
    fn has_come_back(&self, errand: &Errand) -> bool {
        let Some(record) = &self.record else { return false };
        let is_served = self.is_served();
        let is_fed = self.fed_at > errand.since && 2 * self.ahead(record) >= u64::from(self.open.lead_cycles);
        errand.cause == Cause::Silent && is_served && is_fed
    }

    /// Begins to look for another server, or goes on with that for one more reason.
    pub(super) fn look_elsewhere(&mut self, now: Duration, cause: Cause) {
        match self.search.errand_mut() {
            None => self.begin_asking(Errand { cause, since: now, rounds: 0, same: 0 }, now),
            Some(errand) if errand.cause == Cause::Silent => errand.cause = cause,
            Some(_) => {}
        }
    }

    /// The axis has come to rest by itself: whoever goes on has to be told of that, and nobody else may.
    pub(super) fn begin_again(&mut self, now: Duration) {
        let since = self.search.errand().map_or(now, |errand| errand.since);
        for epoch in self.search.give_up() {
            self.drop_line(epoch);
        }
        // It begins no revision any more, and need not be asked.
        self.begin_round(now, Errand { cause: Cause::Starved, since, rounds: 0, same: 0 });
    }

    fn begin_asking(&mut self, errand: Errand, now: Duration) {
        if self.record.is_none() || self.rested.is_some() {
            return self.begin_round(now, errand);
        }
        self.search = Search::Asking(errand);
        self.asked += 1;
        self.feed(Feed::Resuming);
    }

    /// The axis begins no revision any more.
    pub(super) fn heeded(&mut self, now: Duration) {
        if let Search::Asking(errand) = self.search {
            self.begin_round(now, errand);
        }
    }

    fn begin_round(&mut self, now: Duration, errand: Errand) {
        self.search =
            Search::Trying { errand, attempts: Vec::new(), tried: 0, next_at: Some(now), hopeless: true };
        self.try_due(now);
    }

    /// Asks the next server, if it is time for that.
    fn try_due(&mut self, now: Duration) {
        let first = self.endpoint().map_or(0, |serving| serving + 1);
        let (opens, endpoints) = (self.record.is_none(), self.endpoints);
        let hedge = self.hedge();
        let again = self.search.errand().map(|errand| now + self.back_off(errand.rounds));
        let Search::Trying { errand, attempts, tried, next_at, .. } = &mut self.search else { return };
        if next_at.is_none_or(|at| at > now) {
            return;
        }
        if *tried >= endpoints {
            (*tried, errand.rounds) = (0, errand.rounds + 1);
        }
        let is_idle = |endpoint: &usize| attempts.iter().all(|attempt| attempt.endpoint != *endpoint);
        let mut rest = (*tried..endpoints).map(|number| (number + 1, (first + number) % endpoints));
        let Some((number, endpoint)) = rest.find(|(_, endpoint)| is_idle(endpoint)) else {
            (*tried, *next_at) = (endpoints, None);
            return;
        };
        *tried = number;
        self.epoch += 1;
        // Nothing moves yet: one after the other.
        let (patience, wait) = if opens { (OPENING, OPENING) } else { (GOING_ON, hedge) };
        // One that never answers is no reason not to ask the others again.
        let others = !opens && attempts.len() + 1 < endpoints;
        *next_at = if *tried < endpoints { Some(now + wait) } else { again.filter(|_| others) };
        attempts.push(Attempt { epoch: self.epoch, endpoint, until: now + patience });
        let open = Box::new(self.opening(self.epoch));
        self.actions.push_back(Action::Try { endpoint, open });
    }

    /// A quarter of what is left to play.
    fn hedge(&self) -> Duration {
        let held = self.record.as_ref().map_or(0, |record| self.ahead(record));
        let lead = u64::from(self.open.lead_cycles).max(1);
        let left = self.timing.lead.mul_f64(held.min(lead) as f64 / lead as f64);
        (left / 4).clamp(HEDGES.0, HEDGES.1)
    }

    /// A server has opened the stream.
    pub(super) fn opened(&mut self, now: Duration, epoch: u64, endpoint: usize, opened: Opened) {
        let Some(errand) = self.search.errand() else { return };
        let serving = Serving { epoch, endpoint, served_by: opened.served_by.clone(), is_there: true };
        let Some(record) = &self.record else {
            let Some(motion) = opened.motion else {
                self.drop_line(epoch);
                let text = "the stream was opened without a motion";
                return self.failed(now, epoch, endpoint, Error::Protocol(text.into()));
            };
            self.record = Some(Record::opened(motion.clone()));
            let served_by = serving.served_by.clone();
            self.goes_on_with(now, serving);
            self.tell(News::Opened(Box::new(Begun { motion, served_by })));
            return self.ask_everything();
        };
        // It may be left out, since it was given.
        let is_other = opened.motion.is_some_and(|motion| motion.revision() != record.motion().revision());
        if opened.current_epoch != epoch || is_other {
            self.drop_line(epoch);
            let text = "the stream that was opened is not the one that was asked for";
            return self.failed(now, epoch, endpoint, Error::Protocol(text.into()));
        }
        let from = self.served_by().to_owned();
        // One that was silent and opens speaks again; and it has closed the old stream for it.
        let is_same = matches!(errand.cause, Cause::Draining | Cause::Refused) && from == serving.served_by;
        if is_same && errand.same < MOST_SAME && now < errand.since + self.timing.lead / 4 {
            self.drop_line(epoch);
            if let Some(errand) = self.search.errand_mut() {
                errand.same += 1;
            }
            let text = format!("{from} is to be left, and has opened again");
            return self.failed(now, epoch, endpoint, Error::Unanswered { cause: text });
        }
        let change = Change {
            cause: errand.cause,
            from,
            to: serving.served_by.clone(),
            executed_cycle: record.executed(),
            took: now.saturating_sub(errand.since),
        };
        let rested = self.rested.take().map(|end| (Revision::of(record.motion()), end));
        self.feed(Feed::GoesOn(epoch, rested));
        self.goes_on_with(now, serving);
        self.tell(News::FailedOver(change));
        self.ask_everything();
    }

    /// Asks for all that was not answered by whoever served before, or that was asked before anybody did.
    fn ask_everything(&mut self) {
        self.undone.clear();
        for operation in self.unanswered.clone() {
            self.say(proto::stream::FromAxis::Operation(operation));
        }
    }

    /// From now on this one holds, and no other.
    fn goes_on_with(&mut self, now: Duration, serving: Serving) {
        let before = self.serving.replace(serving).filter(|before| before.is_there);
        let mine = self.serving.as_ref().map_or(0, |serving| serving.epoch);
        let others = self.search.give_up().into_iter().filter(|epoch| *epoch != mine);
        for epoch in before.map(|before| before.epoch).into_iter().chain(others).collect::<Vec<_>>() {
            self.drop_line(epoch);
        }
        self.fed_at = now;
        self.fed_to = self.record.as_ref().map_or(0, Record::held);
        self.granted = 0;
        self.finished = false;
        self.refusals = 0;
        (self.lost_for, self.last_failure) = (None, None);
    }

    /// A server does not open the stream.
    pub(super) fn failed(&mut self, now: Duration, epoch: u64, endpoint: usize, cause: Error) {
        let opens = self.record.is_none();
        let refuses = refuses_for_good(&cause);
        self.last_failure = Some(Failure { endpoint, cause });
        let again = self.search.errand().filter(|errand| !self.is_too_late(now, errand));
        let again = again.map(|errand| now + self.back_off(errand.rounds));
        let Search::Trying { attempts, next_at, hopeless, tried, .. } = &mut self.search else { return };
        attempts.retain(|attempt| attempt.epoch != epoch);
        *hopeless &= refuses;
        let more = *tried < self.endpoints;
        *next_at = if more { Some(now) } else { again.filter(|_| !opens && !attempts.is_empty()) };
        // Before anything moves, one that refuses the request speaks for all.
        if opens && refuses {
            return self.end_with_last_failure();
        }
        if more {
            self.try_due(now);
        } else if attempts.is_empty() {
            self.round_over(now);
        }
    }

    /// Nobody went on.
    fn round_over(&mut self, now: Duration) {
        let (hopeless, Some(errand)) =
            (matches!(self.search, Search::Trying { hopeless: true, .. }), self.search.errand())
        else {
            return;
        };
        let is_served = self.is_served();
        if self.record.is_none() || (!is_served && (hopeless || self.is_too_late(now, &errand))) {
            return self.end_with_last_failure();
        }
        if is_served {
            self.feed(Feed::Stays);
        }
        let until = now + self.back_off(errand.rounds);
        let errand = Errand { rounds: errand.rounds + 1, ..errand };
        self.search = Search::Waiting { errand, until };
    }

    /// How long nobody is asked after so many rounds: while the axis moves, no longer than what it holds allows.
    fn back_off(&mut self, rounds: u32) -> Duration {
        let is_served = self.is_served();
        let longest = if is_served || self.rested.is_none() { self.hedge() } else { BACK_OFF.1 };
        let wait = BACK_OFF.0.saturating_mul(1 << rounds.min(10)).min(longest).max(BACK_OFF.0);
        self.timing.jittered(wait)
    }

    fn is_too_late(&self, now: Duration, errand: &Errand) -> bool {
        now.saturating_sub(errand.since) >= self.timing.patience
    }

    fn end_with_last_failure(&mut self) {
        // What ended the stream says more than that nobody answers since.
        let how = self.lost_for.take().or(self.last_failure.take()).map_or(Ok(()), Err);
        self.end(how);
    }
}

/// Does a server refuse what no other would take, and will not take it later either?
fn refuses_for_good(error: &Error) -> bool {
    match error {
        Error::Rejected(rejected) => {
            // What was played then is told after the way to rest.
            let may_change = rejected.reason == Reason::DigestMismatch;
            !may_change && !matches!(rejected.reason.code(), Code::Unavailable | Code::ResourceExhausted)
        }
        Error::Address { .. } | Error::TooLarge { .. } => true,
        Error::Unreachable { .. }
        | Error::Unanswered { .. }
        | Error::NotServed { .. }
        | Error::Protocol(_) => false,
    }
}
