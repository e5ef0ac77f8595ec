//! A whole network in simulated time: axes, replicas that die, hang and come back, and lines that go silent. One thread, no clock, no
//! socket; the same seed gives the same run, so that what fails is run again from its seed.
//!
//! A tick is a cycle. Everything that decides is what decides in production: [`Session`], [`Buffer`], [`Failover`].

use std::collections::{BTreeMap, HashMap};
use std::time::Duration;

use client::failover::{Action, Cause, Failover, Feed, News};
use client::{Buffer, Error, Standing};
use planner::Setpoint;
use proto::stream::{Open, Operation, OperationResult, Report, Source, ToAxis};
use proto::{Digest, Reason, Rejected};
use server::session::{Event, Output, Session};

use crate::Delays;

/// What goes wrong, and how often \[1/tick\].
#[derive(Clone, Copy, Debug)]
pub struct Faults {
    /// A replica dies; it is started again after up to `down_for` ticks.
    pub dies: f64,
    /// \[ticks\]
    pub down_for: u64,
    /// A replica does nothing for up to `hangs_for` ticks.
    pub hangs: f64,
    /// \[ticks\]
    pub hangs_for: u64,
    /// A line goes silent, both ways, for good.
    pub line_dies: f64,
    /// How long a message takes at most \[ticks\].
    pub delay: u64,
}

/// Where a message goes.
#[derive(Debug)]
enum Mail {
    /// To a replica, of a line.
    Open(usize, Line, Box<Open>),
    Say(Line, Box<Event>),
    /// To an axis, of a line.
    Hear(Line, Box<ToAxis>),
    Ended(Line, Result<(), Error>),
}

/// An axis, and the epoch of a stream of it.
type Line = (usize, u64);

/// Axes and replicas.
#[derive(Debug)]
pub struct Network {
    now: u64,
    faults: Faults,
    random: Delays,
    /// By when it is due, and the order in which it was sent.
    mail: BTreeMap<(u64, u64), Mail>,
    sent: u64,
    /// Nothing overtakes what was sent before on the same line, in the same direction.
    last_due: HashMap<(Line, bool), u64>,
    replicas: Vec<Replica>,
    /// Which replica is at the other end of a line.
    lines: HashMap<Line, usize>,
    silent: Vec<Line>,
    /// The axes, in the order in which they were given.
    pub axes: Vec<Axis>,
}

/// A planner.
#[derive(Debug, Default)]
struct Replica {
    up_at: u64,
    hangs_until: u64,
    sessions: HashMap<Line, Session>,
    /// The newest epoch of each axis's stream.
    newest: HashMap<usize, u64>,
}

/// An axis that plays a stream.
#[derive(Debug)]
pub struct Axis {
    open: Open,
    core: Failover,
    buffer: Option<Buffer>,
    heeded: u64,
    batch: u64,
    reported: u64,
    told_revision: u64,
    told_low: u64,
    playing: bool,
    /// Every setpoint that was played, from cycle 0 on, axis by axis.
    pub played: Vec<Vec<Setpoint>>,
    /// The digest of each of them.
    pub digests: Vec<Digest>,
    /// What became of operations, by their ids.
    pub answers: Vec<(String, Result<OperationResult, Rejected>)>,
    /// Why servers were left.
    pub causes: Vec<Cause>,
    /// How the stream ended.
    pub over: Option<Result<(), Error>>,
}

/// Longer than any fault: a network that comes back is waited for.
const PATIENCE: Duration = Duration::from_secs(3600);

impl Network {
    /// Axes that open streams with `opens` at `replicas` servers.
    #[must_use]
    pub fn new(opens: Vec<Open>, replicas: usize, faults: Faults, seed: u64) -> Self {
        Self {
            now: 0,
            faults,
            random: Delays::up_to(0, seed),
            mail: BTreeMap::new(),
            sent: 0,
            last_due: HashMap::new(),
            replicas: (0..replicas).map(|_| Replica::default()).collect(),
            lines: HashMap::new(),
            silent: Vec::new(),
            axes: opens.into_iter().map(|open| Axis::new(open, replicas)).collect(),
        }
    }

    /// No more faults from now on; everybody comes back.
    pub fn heal(&mut self) {
        self.faults = Faults { dies: 0.0, hangs: 0.0, line_dies: 0.0, ..self.faults };
    }

    /// An axis is asked for an operation.
    pub fn operate(&mut self, axis: usize, operation: Operation) {
        self.axes[axis].core.operate(operation);
    }

    /// Are all streams over, and is all played that is held?
    #[must_use]
    pub fn is_over(&self) -> bool {
        let is_played = |axis: &Axis| axis.buffer.as_ref().is_none_or(|buffer| buffer.held() == 0);
        self.axes.iter().all(|axis| axis.over.is_some() && is_played(axis))
    }

    /// One cycle.
    pub fn tick(&mut self) {
        self.now += 1;
        self.go_wrong();
        while let Some(entry) = self.mail.first_entry().filter(|entry| entry.key().0 <= self.now) {
            let mail = entry.remove();
            self.deliver(mail);
        }
        for axis in 0..self.axes.len() {
            self.axes[axis].core.woken(Duration::from_millis(self.now));
            self.act(axis);
            self.axes[axis].cycle(self.now);
            self.act(axis);
        }
        for replica in 0..self.replicas.len() {
            self.serve(replica);
        }
    }

    fn chance(&mut self, of: f64) -> bool {
        of > 0.0 && (self.random.bits() as f64) < of * u64::MAX as f64
    }

    fn go_wrong(&mut self) {
        let Faults { dies, down_for, hangs, hangs_for, line_dies, .. } = self.faults;
        for index in 0..self.replicas.len() {
            if self.replicas[index].up_at <= self.now && self.chance(dies) {
                let down = 1 + self.random.bits() % down_for.max(1);
                let sessions: Vec<Line> =
                    self.replicas[index].sessions.drain().map(|(line, _)| line).collect();
                self.replicas[index] = Replica { up_at: self.now + down, ..Replica::default() };
                let gone =
                    || Error::Unreachable { endpoint: format!("replica {index}"), cause: "dead".into() };
                for line in sessions {
                    self.post(line, false, Mail::Ended(line, Err(gone())));
                }
            }
            if self.chance(hangs) {
                self.replicas[index].hangs_until = self.now + 1 + self.random.bits() % hangs_for.max(1);
            }
        }
        if self.chance(line_dies) {
            let lines: Vec<Line> = self.lines.keys().copied().collect();
            if !lines.is_empty() {
                let mut lines = lines;
                lines.sort_unstable();
                let line = lines[self.random.bits() as usize % lines.len()];
                self.silent.push(line);
            }
        }
    }

    /// Sends something that arrives after what was sent before it.
    fn post(&mut self, line: Line, to_replica: bool, mail: Mail) {
        if self.silent.contains(&line) {
            return;
        }
        let due = self.now + self.random.bits() % (self.faults.delay + 1);
        let last = self.last_due.entry((line, to_replica)).or_default();
        *last = due.max(*last);
        self.sent += 1;
        self.mail.insert((*last, self.sent), mail);
    }

    fn deliver(&mut self, mail: Mail) {
        let now = Duration::from_millis(self.now);
        match mail {
            Mail::Hear(line, message) => {
                self.axes[line.0].core.heard(now, line.1, *message);
                self.act(line.0);
            }
            Mail::Ended(line, how) => {
                self.axes[line.0].core.ended(now, line.1, how);
                self.act(line.0);
            }
            Mail::Open(index, line, open) => {
                let replica = &mut self.replicas[index];
                if replica.up_at > self.now {
                    let error =
                        Error::Unreachable { endpoint: format!("replica {index}"), cause: "down".into() };
                    return self.post(line, false, Mail::Ended(line, Err(error)));
                }
                if replica.hangs_until > self.now {
                    // It waits where it is.
                    let again = Mail::Open(index, line, open);
                    self.sent += 1;
                    self.mail.insert((self.replicas[index].hangs_until, self.sent), again);
                    return;
                }
                let newest = replica.newest.get(&line.0).copied().unwrap_or(0);
                let opened = if newest >= line.1 {
                    let rejected = Rejected::new(Reason::EpochSuperseded, "an older epoch");
                    Err(rejected.with("current_epoch", newest))
                } else {
                    Session::open(*open, &format!("replica {index}"))
                };
                match opened {
                    Ok(session) => {
                        let before = (line.0, newest);
                        if let Some(older) = replica.sessions.get_mut(&before) {
                            older.handle(Event::Superseded { by: line.1 });
                        }
                        replica.newest.insert(line.0, line.1);
                        replica.sessions.insert(line, session);
                    }
                    Err(rejected) => {
                        let error = Error::Rejected(Box::new(rejected));
                        self.post(line, false, Mail::Ended(line, Err(error)));
                    }
                }
            }
            Mail::Say(line, event) => {
                let Some(&index) = self.lines.get(&line) else { return };
                let replica = &mut self.replicas[index];
                if replica.hangs_until > self.now {
                    self.sent += 1;
                    self.mail.insert((replica.hangs_until, self.sent), Mail::Say(line, event));
                } else if let Some(session) = replica.sessions.get_mut(&line) {
                    session.handle(*event);
                }
            }
        }
    }

    /// Everything that the sessions of a replica have to say.
    fn serve(&mut self, index: usize) {
        let replica = &mut self.replicas[index];
        if replica.up_at > self.now || replica.hangs_until > self.now {
            return;
        }
        let mut lines: Vec<Line> = replica.sessions.keys().copied().collect();
        lines.sort_unstable();
        for line in lines {
            let Some(mut session) = self.replicas[index].sessions.remove(&line) else { continue };
            let mut ended = false;
            while let Some(output) = session.poll_output() {
                match output {
                    Output::Send(message) => self.post(line, false, Mail::Hear(line, Box::new(message))),
                    Output::End(how) => {
                        let how = how.map_err(|rejected| Error::Rejected(Box::new(rejected)));
                        self.post(line, false, Mail::Ended(line, how));
                        ended = true;
                    }
                }
            }
            if !ended {
                self.replicas[index].sessions.insert(line, session);
            }
        }
    }

    /// Does what the fail-over of an axis decides.
    fn act(&mut self, axis: usize) {
        while let Some(action) = self.axes[axis].core.poll() {
            match action {
                Action::Try { endpoint, open } => {
                    let line = (axis, open.epoch);
                    self.lines.insert(line, endpoint);
                    self.post(line, true, Mail::Open(endpoint, line, open));
                }
                Action::Send(epoch, message) => {
                    let line = (axis, epoch);
                    self.post(line, true, Mail::Say(line, Box::new(Event::FromAxis(message))));
                }
                Action::Drop(epoch) => {
                    let line = (axis, epoch);
                    self.post(line, true, Mail::Say(line, Box::new(Event::AxisClosed)));
                }
                Action::Feed(feed) => self.axes[axis].feed(self.now, feed),
                Action::Tell(news) => self.axes[axis].hear(news),
            }
        }
    }
}

impl Axis {
    fn new(open: Open, replicas: usize) -> Self {
        let Source::Plan(plan) = &open.source else { panic!("an axis begins with a plan") };
        let setpoints: Vec<Setpoint> = plan.plan().sampler().at(0).collect();
        let cycle = plan.plan().cycle_time();
        Self {
            core: Failover::new(Duration::ZERO, open.clone(), cycle, replicas, PATIENCE),
            batch: u64::from(open.batch_cycles.min(open.lead_cycles)),
            open,
            buffer: None,
            heeded: 0,
            reported: 0,
            told_revision: 0,
            told_low: 0,
            playing: false,
            played: vec![setpoints],
            digests: vec![Digest::ZERO],
            answers: Vec::new(),
            causes: Vec::new(),
            over: None,
        }
    }

    /// What is held, once the stream is open.
    #[must_use]
    pub fn buffer(&self) -> Option<&Buffer> {
        self.buffer.as_ref()
    }

    /// Has it come to rest by itself?
    #[must_use]
    pub fn has_starved(&self) -> bool {
        self.buffer.as_ref().is_some_and(|buffer| buffer.counters().underruns > 0)
    }

    /// What was decided so far.
    #[must_use]
    pub fn failover(&self) -> &Failover {
        &self.core
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Opened(opened) => {
                let Open { lead_cycles, axis_guard, .. } = self.open;
                let epoch = self.core.serving_epoch().expect("it is open");
                let (plan, setpoints) = (opened.motion.plan(), &self.played[0]);
                let mut buffer = Buffer::new(&Standing { epoch, lead_cycles, axis_guard, plan, setpoints });
                buffer.motion_ends_at(opened.motion.last_cycle());
                self.buffer = Some(buffer);
            }
            News::Event(_) => {}
            News::Answer(id, answer) => self.answers.push((id, answer)),
            News::FailedOver(change) => self.causes.push(change.cause),
            News::Over(how) => self.over = Some(how.map_err(|failure| failure.cause)),
        }
    }

    fn feed(&mut self, now: u64, feed: Feed) {
        let Some(buffer) = &mut self.buffer else { return };
        let report = match feed {
            Feed::Revised(epoch, revision) => {
                buffer.announce(epoch, revision);
                return;
            }
            Feed::Batch(epoch, mut batch) => match buffer.accept(epoch, &mut batch) {
                Err(refused) => buffer.report(Some(refused)),
                Ok(()) => return,
            },
            Feed::Resuming => {
                buffer.resuming(true);
                self.heeded += 1;
                buffer.report(None)
            }
            Feed::Stays => {
                buffer.resuming(false);
                return;
            }
            Feed::GoesOn(epoch, rested) => {
                buffer.goes_on(epoch, rested);
                buffer.report(None)
            }
        };
        self.report(now, report);
    }

    /// Plays a cycle, and tells how far it is.
    fn cycle(&mut self, now: u64) {
        let Some(buffer) = &mut self.buffer else { return };
        self.playing |= buffer.is_ready();
        let mut starved = false;
        if self.playing && !buffer.is_finished() {
            if buffer.held() == 0 && !buffer.is_at_rest() {
                starved = buffer.starve();
            }
            if let Some(playing) = buffer.play() {
                self.played.push(playing.setpoints.to_vec());
                self.digests.push(playing.digest);
            }
        }
        let (executed, revision) = (buffer.executed(), buffer.revision());
        let is_low = buffer.is_low() && self.playing && self.told_low != buffer.accepted();
        let is_last = buffer.is_finished() && executed > self.reported;
        let due = executed >= self.reported + self.batch || is_last || revision != self.told_revision;
        if is_low {
            self.told_low = buffer.accepted();
        }
        if due || is_low || starved {
            let report = buffer.report(None);
            self.report(now, report);
        }
    }

    fn report(&mut self, now: u64, report: Report) {
        let buffer = self.buffer.as_ref().expect("it reports");
        (self.reported, self.told_revision) = (buffer.executed(), buffer.revision());
        self.core.reported(Duration::from_millis(now), report, self.heeded);
    }
}
