//! A session and an axis's buffer without a network: one thread, simulated time, messages that take as long as a test says and
//! cross over as they do on the wire.

use std::collections::VecDeque;

use client::{Buffer, Revision, Standing};
use planner::motion::{Motion as UnderWay, Operation as Planned};
use planner::{Plan, Setpoint};
use proto::stream::{FromAxis, Open, Operation, OperationResult, Report, Source, StreamEvent, ToAxis};
use proto::{Digest, Rejected, request_from_wire, request_to_wire, response_from_wire, response_to_wire};
use server::session::{Event, Output, Session};

/// What became of an operation.
pub type Answer = (String, Result<OperationResult, Rejected>);

/// A stream between a session and a buffer. A tick is a cycle.
#[derive(Debug)]
pub struct Rig {
    session: Session,
    buffer: Buffer,
    epoch: u64,
    batch_cycles: u64,
    /// How long messages take, both ways; asked for each [ticks].
    delays: Delays,
    to_axis: VecDeque<(u64, ToAxis)>,
    to_server: VecDeque<(u64, Event)>,
    now: u64,
    reported: u64,
    told_revision: u64,
    playing: bool,
    /// Every setpoint that was played, from cycle 0 on, axis by axis.
    pub played: Vec<Vec<Setpoint>>,
    /// The digest of each of them.
    pub digests: Vec<Digest>,
    /// In the order in which they came, in band.
    pub answers: Vec<Answer>,
    /// The same of commands.
    pub commanded: Vec<(u64, Result<OperationResult, Rejected>)>,
    /// What happened to the stream.
    pub events: Vec<StreamEvent>,
    /// How the session ended.
    pub ended: Option<Result<(), Rejected>>,
}

/// Numbers that are drawn, the same for the same seed.
#[derive(Clone, Debug)]
pub struct Delays {
    state: u64,
    most: u64,
}

impl Delays {
    /// Up to `most` ticks each way.
    #[must_use]
    pub fn up_to(most: u64, seed: u64) -> Self {
        Self { state: seed, most }
    }

    fn draw(&mut self) -> u64 {
        self.bits() % (self.most + 1)
    }

    /// The next number of all. Steele, Lea and Flood (2014), splitmix64.
    pub fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

impl Rig {
    /// A stream that is opened with `open`.
    #[must_use]
    pub fn new(open: Open, delays: Delays) -> Self {
        let Open { epoch, lead_cycles, axis_guard, batch_cycles, .. } = open;
        let Source::Plan(plan) = &open.source else { panic!("a rig begins with a plan") };
        let plan = plan.plan().clone();
        let setpoints: Vec<Setpoint> = plan.sampler().at(0).collect();
        let session = Session::open(open, "rig").expect("a stream");
        let standing =
            Standing { epoch, lead_cycles, axis_guard, plan: session.motion().plan(), setpoints: &setpoints };
        let mut buffer = Buffer::new(&standing);
        buffer.motion_ends_at(session.motion().last_cycle());
        Self {
            session,
            buffer,
            epoch,
            batch_cycles: u64::from(batch_cycles.min(lead_cycles)),
            delays,
            to_axis: VecDeque::new(),
            to_server: VecDeque::new(),
            now: 0,
            reported: 0,
            told_revision: 0,
            playing: false,
            played: vec![setpoints],
            digests: vec![Digest::ZERO],
            answers: Vec::new(),
            commanded: Vec::new(),
            events: Vec::new(),
            ended: None,
        }
    }

    /// The last cycle that was played.
    #[must_use]
    pub fn executed(&self) -> u64 {
        self.buffer.executed()
    }

    /// What the axis holds.
    #[must_use]
    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// The session.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The axis asks for an operation.
    pub fn ask(&mut self, operation: Operation) {
        self.say(Event::FromAxis(FromAxis::Operation(operation)));
    }

    /// Somebody else does.
    pub fn command(&mut self, ticket: u64, operation: Operation) {
        self.session.handle(Event::Command { ticket, operation });
    }

    /// Loses everything that is on its way to the axis.
    pub fn lose_what_is_on_its_way(&mut self) {
        self.to_axis.clear();
    }

    /// The axis closes its side.
    pub fn close(&mut self) {
        self.say(Event::AxisClosed);
    }

    /// One cycle.
    pub fn tick(&mut self) {
        self.now += 1;
        while let Some((_, event)) = self.to_server.pop_front_if(|(due, _)| *due <= self.now) {
            self.session.handle(event);
        }
        self.carry();
        while let Some((_, message)) = self.to_axis.pop_front_if(|(due, _)| *due <= self.now) {
            self.take(message);
        }
        self.play();
    }

    /// Cycles until `executed` is played, or the session has ended.
    pub fn run_to(&mut self, executed: u64) {
        // A stream that does not go on is to fail a test, not to hang it.
        let deadline = self.now + executed.saturating_sub(self.executed()).min(100_000) + 10_000;
        while self.executed() < executed && !self.is_over() {
            self.tick();
            assert!(self.now < deadline, "stuck at cycle {} of {executed}", self.executed());
        }
    }

    /// Cycles until all of `count` operations are answered.
    pub fn run_to_answers(&mut self, count: usize) {
        let deadline = self.now + 100_000;
        while self.answers.len() + self.commanded.len() < count && !self.is_over() {
            self.tick();
            assert!(self.now < deadline, "{} of {count} answers", self.answers.len());
        }
    }

    /// Has the session ended, and is all that it said heard?
    fn is_over(&self) -> bool {
        self.ended.is_some() && self.to_axis.is_empty()
    }

    fn carry(&mut self) {
        while let Some(output) = self.session.poll_output() {
            match output {
                Output::Send(message) => {
                    let message = over_the_wire(self.epoch, message);
                    let due = self.arrives(self.to_axis.back().map(|last| last.0));
                    self.to_axis.push_back((due, message));
                }
                Output::End(how) => self.ended = Some(how),
            }
        }
        while let Some(answer) = self.session.poll_answer() {
            self.commanded.push((answer.ticket, answer.result));
        }
    }

    fn say(&mut self, event: Event) {
        let event = match event {
            Event::FromAxis(message) => match request_from_wire(request_to_wire(&message)) {
                Ok(message) => Event::FromAxis(message),
                Err(rejected) => Event::Unreadable(rejected),
            },
            event => event,
        };
        let due = self.arrives(self.to_server.back().map(|last| last.0));
        self.to_server.push_back((due, event));
    }

    /// Nothing overtakes what was sent before.
    fn arrives(&mut self, last: Option<u64>) -> u64 {
        (self.now + self.delays.draw()).max(last.unwrap_or(0))
    }

    fn take(&mut self, message: ToAxis) {
        match message {
            ToAxis::Opened(_) => {}
            ToAxis::Revised(revised) => {
                self.buffer.announce(self.epoch, Revision::of(&revised.motion));
            }
            ToAxis::Batch(mut batch) => {
                if let Err(refused) = self.buffer.accept(self.epoch, &mut batch) {
                    self.report(self.buffer.report(Some(refused)));
                }
            }
            ToAxis::Event(event) => self.events.push(event),
            ToAxis::Result(result) => self.answers.push((result.request_id.clone(), Ok(result))),
            ToAxis::Refusal(refusal) => self.answers.push((refusal.request_id, Err(refusal.rejected))),
        }
    }

    fn play(&mut self) {
        self.playing |= self.buffer.is_ready();
        if self.playing && !self.buffer.is_finished() {
            match self.buffer.play() {
                Some(playing) => {
                    self.played.push(playing.setpoints.to_vec());
                    self.digests.push(playing.digest);
                }
                None => self.buffer.count_underrun(),
            }
        }
        let (executed, revision) = (self.buffer.executed(), self.buffer.revision());
        let is_last = self.buffer.is_finished() && executed > self.reported;
        if executed >= self.reported + self.batch_cycles || is_last || revision != self.told_revision {
            self.report(self.buffer.report(None));
        }
    }

    fn report(&mut self, report: Report) {
        (self.reported, self.told_revision) = (report.executed_cycle, report.revision);
        self.say(Event::FromAxis(FromAxis::Report(report)));
    }
}

/// What an axis reads of what a server says. Whatever a session sends can be read.
fn over_the_wire(epoch: u64, message: ToAxis) -> ToAxis {
    let (said, message) = response_from_wire(response_to_wire(epoch, message)).expect("it can be read");
    assert_eq!(said, epoch);
    message
}

/// The first cycle at which two runs differ, with what each has there; `None` where neither has more than the other.
#[must_use]
pub fn difference(one: &[Vec<Setpoint>], other: &[Vec<Setpoint>]) -> Option<String> {
    let differs = |index: &usize| one.get(*index) != other.get(*index);
    let index = (0..one.len().max(other.len())).find(differs)?;
    Some(format!("cycle {}: {:?} and {:?}", index + 1, one.get(index), other.get(index)))
}

/// The setpoints of `plan` with `operations` done to it, each at its cycle, from cycle 1 to `last`: what an axis plays, without a
/// stream. With the motion that is left.
///
/// # Panics
/// Where an operation is refused.
#[must_use]
pub fn replay(
    plan: &planner::Accepted,
    operations: &[(u64, Planned)],
    last: u64,
) -> (Vec<Vec<Setpoint>>, Digest, UnderWay) {
    let mut motion = UnderWay::open(plan.clone()).expect("a motion");
    let (mut played, mut digest) = (Vec::new(), Digest::ZERO);
    let mut play = |motion: &UnderWay, to: u64| {
        for cycle in played.len() as u64 + 1..=to {
            let setpoints = setpoints(motion.plan(), cycle - motion.from_cycle());
            digest = digest.then(cycle, setpoints.iter().map(Setpoint::words));
            played.push(setpoints);
        }
    };
    for (cycle, operation) in operations {
        play(&motion, cycle.saturating_sub(1).min(last));
        motion = motion.splice(*cycle, operation).expect("an operation").motion;
    }
    play(&motion, last);
    (played, digest, motion)
}

fn setpoints(plan: &Plan, cycle: u64) -> Vec<Setpoint> {
    plan.sampler().at(cycle).collect()
}
