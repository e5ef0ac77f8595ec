//! Who is asked to go on with a stream, and when: [`Failover`] alone, event by event, with sessions that answer.

use std::collections::HashMap;
use std::time::Duration;

use client::failover::{Action, Cause, Failover, Feed, News};
use client::{Buffer, Error, Standing};
use e2e::{move_of, open, planned};
use planner::Setpoint;
use proto::stream::{
    Ask, Batch, Columns, FromAxis, Open, Operation, OperationRefusal, Source, Tails, ToAxis,
};
use proto::{Digest, Reason, Rejected};
use server::session::{Event, Output, Session};

const LEAD: u32 = 40;

/// An axis, and servers of which each says what it has to say when it is told to.
struct Stage {
    now: Duration,
    core: Failover,
    buffer: Option<Buffer>,
    setpoints: Vec<Setpoint>,
    heeded: u64,
    /// What was asked of whom, and not answered: endpoint and what to open with.
    tried: Vec<(usize, Open)>,
    sessions: HashMap<u64, Session>,
    dropped: Vec<u64>,
    said: Vec<(u64, FromAxis)>,
    answers: Vec<(String, Result<(), Reason>)>,
    causes: Vec<(Cause, String, String)>,
    over: Option<Result<(), Error>>,
    /// A batch may be refused.
    lied_to: bool,
}

impl Stage {
    fn new(endpoints: usize) -> Self {
        let open = Open { lead_cycles: LEAD, ..open("cell-7/x", planned(move_of(0.05, 0.25))) };
        let Source::Plan(plan) = &open.source else { unreachable!("it begins with a plan") };
        let setpoints = plan.plan().sampler().at(0).collect();
        let cycle = plan.plan().cycle_time();
        let core = Failover::new(Duration::ZERO, open, cycle, endpoints, Duration::from_secs(10));
        let mut stage = Self {
            now: Duration::ZERO,
            core,
            buffer: None,
            setpoints,
            heeded: 0,
            tried: Vec::new(),
            sessions: HashMap::new(),
            dropped: Vec::new(),
            said: Vec::new(),
            answers: Vec::new(),
            causes: Vec::new(),
            over: None,
            lied_to: false,
        };
        stage.act();
        stage
    }

    /// Opened by the first of `endpoints`, with the lead full.
    fn served(endpoints: usize) -> Self {
        let mut stage = Self::new(endpoints);
        stage.opens("a");
        stage.speak();
        stage.report();
        stage
    }

    fn act(&mut self) {
        while let Some(action) = self.core.poll() {
            match action {
                Action::Try { endpoint, open } => self.tried.push((endpoint, *open)),
                Action::Send(epoch, message) => {
                    if let Some(session) = self.sessions.get_mut(&epoch) {
                        session.handle(Event::FromAxis(message.clone()));
                    }
                    self.said.push((epoch, message));
                }
                Action::Drop(epoch) => {
                    self.sessions.remove(&epoch);
                    self.dropped.push(epoch);
                }
                Action::Feed(feed) => self.feed(feed),
                Action::Tell(news) => self.hear(news),
            }
        }
    }

    fn feed(&mut self, feed: Feed) {
        let buffer = self.buffer.as_mut().expect("it is open");
        match feed {
            Feed::Revised(epoch, revision) => drop(buffer.announce(epoch, revision)),
            Feed::Batch(epoch, mut batch) => {
                let refused = buffer.accept(epoch, &mut batch).err();
                assert!(refused.is_none() || self.lied_to, "{refused:?}");
                let (report, heeded) = (buffer.report(refused.clone()), self.heeded);
                if refused.is_some() {
                    self.core.reported(self.now, report, heeded);
                }
            }
            Feed::Resuming => {
                buffer.resuming(true);
                self.heeded += 1;
                self.report();
            }
            Feed::Stays => buffer.resuming(false),
            Feed::GoesOn(epoch, rested) => {
                buffer.goes_on(epoch, rested);
                self.report();
            }
        }
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Opened(opened) => {
                let epoch = self.core.serving_epoch().expect("somebody serves");
                let (plan, setpoints) = (opened.motion.plan(), &self.setpoints);
                let standing = Standing { epoch, lead_cycles: LEAD, axis_guard: 2, plan, setpoints };
                let mut buffer = Buffer::new(&standing);
                buffer.motion_ends_at(opened.motion.last_cycle());
                self.buffer = Some(buffer);
            }
            News::Event(_) => {}
            News::Answer(id, answer) => {
                self.answers.push((id, answer.map(drop).map_err(|rejected| rejected.reason)));
            }
            News::FailedOver(change) => self.causes.push((change.cause, change.from, change.to)),
            News::Over(how) => self.over = Some(how.map_err(|failure| failure.cause)),
        }
    }

    /// The one that was asked last opens the stream, as `served_by`; gives the number of its endpoint.
    fn opens(&mut self, served_by: &str) -> usize {
        let (endpoint, open) = self.tried.pop().expect("somebody was asked");
        let epoch = open.epoch;
        let mut session = Session::open(open, served_by).expect("it may be opened");
        let Some(Output::Send(opened)) = session.poll_output() else { panic!("it says that it is open") };
        self.sessions.insert(epoch, session);
        self.core.heard(self.now, epoch, opened);
        self.act();
        endpoint
    }

    fn serving(&self) -> u64 {
        self.core.serving_epoch().expect("somebody serves")
    }

    /// Whoever serves says all that it has to say.
    fn speak(&mut self) {
        let epoch = self.serving();
        while let Some(output) = self.sessions.get_mut(&epoch).and_then(Session::poll_output) {
            match output {
                Output::Send(message) => self.core.heard(self.now, epoch, message),
                Output::End(how) => {
                    let how = how.map_err(|rejected| Error::Rejected(Box::new(rejected)));
                    self.core.ended(self.now, epoch, how);
                }
            }
            self.act();
        }
    }

    fn report(&mut self) {
        let report = self.buffer.as_ref().expect("it is open").report(None);
        self.core.reported(self.now, report, self.heeded);
        self.act();
    }

    /// Plays `cycles` cycles, as far as they are held, and says so.
    fn play(&mut self, cycles: u64) {
        for _ in 0..cycles {
            self.now += Duration::from_millis(1);
            self.buffer.as_mut().expect("it is open").play();
        }
        self.report();
    }

    fn wait(&mut self, milliseconds: u64) {
        self.now += Duration::from_millis(milliseconds);
        self.core.woken(self.now);
        self.act();
    }

    fn dies(&mut self) {
        let epoch = self.serving();
        let gone = Error::Unreachable { endpoint: "a".into(), cause: "connection reset".into() };
        self.core.ended(self.now, epoch, Err(gone));
        self.act();
    }
}

#[test]
fn one_that_never_answers_is_not_waited_for() {
    let mut stage = Stage::served(3);
    stage.play(10);
    stage.dies();
    assert_eq!(stage.tried.len(), 1, "the axis heeds at once, and the next one is asked");
    let mute = stage.tried[0].clone();
    assert_eq!(mute.0, 1);
    // A quarter of what is held, 30 cycles, is soon over.
    stage.wait(10);
    assert_eq!(stage.tried.len(), 2);
    assert_eq!(stage.opens("c"), 2);
    assert_eq!(stage.causes, [(Cause::Lost, "a".to_owned(), "c".to_owned())]);
    assert!(stage.dropped.contains(&mute.1.epoch), "and the mute one is not asked any more");
    assert!(stage.said.iter().any(|(epoch, _)| *epoch == stage.serving()), "the new one hears of the axis");
}

#[test]
fn one_that_was_only_slow_is_kept() {
    let mut stage = Stage::served(2);
    stage.play(25);
    stage.wait(11);
    assert_eq!(stage.tried.len(), 1, "the lead is under its half, and nothing has come for a quarter of it");
    let (_, asked) = stage.tried.pop().expect("it was asked");
    stage.now += Duration::from_millis(1);
    stage.speak();
    stage.report();
    stage.wait(1);
    assert_eq!(stage.dropped, [asked.epoch]);
    assert!(stage.causes.is_empty() && stage.over.is_none());
}

#[test]
fn one_that_leaves_is_not_taken_again_from_behind_a_balancer() {
    let mut stage = Stage::served(1);
    stage.play(5);
    let epoch = stage.serving();
    if let Some(session) = stage.sessions.get_mut(&epoch) {
        session.handle(Event::Drain);
    }
    stage.speak();
    assert_eq!(stage.tried.len(), 1);
    stage.opens("a");
    assert!(stage.causes.is_empty(), "it is the same one");
    assert_eq!(stage.serving(), epoch, "which serves on under the epoch that it has");
    stage.wait(20);
    stage.opens("b");
    assert_eq!(stage.causes, [(Cause::Draining, "a".to_owned(), "b".to_owned())]);
}

#[test]
fn an_end_that_is_not_told_is_an_end() {
    let mut stage = Stage::served(2);
    while !stage.buffer.as_ref().is_some_and(Buffer::has_last) {
        stage.play(10);
        stage.speak();
    }
    // The last report never arrives, nor does the farewell.
    let epoch = stage.serving();
    stage.sessions.remove(&epoch);
    stage.play(u64::from(LEAD));
    stage.wait(999);
    assert_eq!(stage.over, None, "it may only be late");
    stage.wait(1);
    assert_eq!(stage.over, Some(Ok(())));
    assert!(stage.tried.is_empty(), "nobody has anything to go on with");
}

/// The last batch came, and the server went before the axis had said so.
#[test]
fn what_is_whole_needs_nobody_to_go_on() {
    let mut stage = Stage::served(2);
    while !stage.buffer.as_ref().is_some_and(Buffer::has_last) {
        stage.play(10);
        stage.speak();
    }
    stage.dies();
    assert_eq!(stage.over, Some(Ok(())), "{:?}", stage.tried);
    assert!(stage.tried.is_empty());
}

/// What the serving server sends again, of the last ten cycles that are held, otherwise than it was.
fn lies(stage: &mut Stage, change: impl FnOnce(Batch) -> Batch) {
    let held = u64::from(LEAD);
    let plan = planned(move_of(0.05, 0.25));
    let columns = Columns::of_plan(plan.plan(), held - 9..held + 1);
    let batch = Batch {
        first_cycle: held - 9,
        revision: 0,
        replaces: false,
        last: false,
        columns,
        digest: Digest::from(1),
        tails: Tails::default(),
    };
    stage.lied_to = true;
    stage.core.heard(stage.now, stage.serving(), ToAxis::Batch(change(batch)));
    stage.act();
}

/// A batch that brings nothing new, or is refused, says nothing of where the stream ends.
#[test]
fn the_end_is_that_of_what_is_held() {
    let refused = |batch| Batch { replaces: true, last: true, revision: 7, ..batch };
    for change in [|batch| Batch { last: true, ..batch }, refused] {
        let mut stage = Stage::served(2);
        lies(&mut stage, change);
        stage.report();
        stage.dies();
        assert_eq!(stage.over, None);
        assert_eq!(stage.opens("b"), 1);
        assert_eq!(stage.causes.len(), 1);
    }
}

/// An axis that starves plays the way to rest that it holds, whatever came after that and was not taken.
#[test]
fn the_way_to_rest_is_that_of_what_is_held() {
    let other = |batch| Batch { replaces: true, revision: 7, ..batch };
    // It begins as one that is held, and goes on for longer than is granted.
    let longer = |batch: Batch| {
        let plan = planned(move_of(0.05, 0.25));
        let cycles = batch.first_cycle..u64::from(LEAD) + 11;
        Batch { columns: Columns::of_plan(plan.plan(), cycles), ..batch }
    };
    for change in [other, longer] {
        let mut stage = Stage::served(2);
        lies(&mut stage, change);
        stage.dies();
        stage.play(u64::from(LEAD));
        assert!(stage.buffer.as_mut().unwrap().starve(), "it moves");
        stage.report();
        assert_eq!(stage.over, None);
        stage.opens("b");
        assert_eq!(stage.causes.last().map(|cause| cause.0), Some(Cause::Starved));
    }
}

#[test]
fn what_a_session_leaves_undone_the_next_one_is_asked() {
    let mut stage = Stage::served(2);
    stage
        .core
        .operate(Operation { not_before_cycle: Some(200), ..Operation::now("slower", Ask::Override(0.5)) });
    stage.act();
    let epoch = stage.serving();
    let refusal = OperationRefusal { request_id: "slower".into(), rejected: Rejected::left_undone() };
    stage.core.heard(stage.now, epoch, ToAxis::Refusal(refusal));
    stage.act();
    assert!(stage.answers.is_empty(), "nothing was done, and nothing was refused");
    stage.dies();
    stage.opens("b");
    let asked = |(to, said): &(u64, FromAxis)| {
        *to == stage.serving() && matches!(said, FromAxis::Operation(asked) if asked.request_id == "slower")
    };
    assert_eq!(stage.said.iter().filter(|said| asked(said)).count(), 1);
    while stage.over.is_none() {
        stage.play(10);
        if stage.over.is_none() {
            stage.speak();
        }
    }
    assert_eq!(stage.answers, [("slower".to_owned(), Ok(()))]);
}

/// Else the axis would ask one server after the other for it, for ever.
#[test]
fn what_makes_every_server_say_what_cannot_be_read_is_asked_for_no_more() {
    let mut stage = Stage::served(2);
    stage.core.operate(Operation::now("poison", Ask::Override(0.5)));
    stage.act();
    for server in ["b", "c", "d"] {
        assert!(stage.answers.is_empty());
        stage.core.ended(stage.now, stage.serving(), Err(Error::Protocol("no such piece".into())));
        stage.act();
        while stage.tried.is_empty() {
            stage.wait(1);
        }
        stage.opens(server);
    }
    assert_eq!(stage.answers, [("poison".to_owned(), Err(Reason::NotConfirmed))]);
    let asked =
        |(to, said): &&(u64, FromAxis)| *to == stage.serving() && matches!(said, FromAxis::Operation(_));
    assert_eq!(stage.said.iter().filter(asked).count(), 0, "the stream goes on without it");
    assert_eq!(stage.over, None);
}

#[test]
fn what_nobody_has_done_is_answered_when_all_is_over() {
    let mut stage = Stage::served(1);
    stage
        .core
        .operate(Operation { not_before_cycle: Some(200), ..Operation::now("slower", Ask::Override(0.5)) });
    stage.act();
    let epoch = stage.serving();
    let refusal = OperationRefusal { request_id: "slower".into(), rejected: Rejected::left_undone() };
    stage.core.heard(stage.now, epoch, ToAxis::Refusal(refusal));
    stage.core.close();
    stage.act();
    assert_eq!(stage.answers, [("slower".to_owned(), Err(Reason::NotConfirmed))]);
    assert_eq!(stage.over, Some(Ok(())));
}

#[test]
fn a_stream_that_somebody_else_has_opened_is_not_taken_back() {
    let mut stage = Stage::served(2);
    let epoch = stage.serving();
    let rejected = Rejected::new(Reason::EpochSuperseded, "a newer one").with("current_epoch", epoch + 7);
    stage.core.ended(stage.now, epoch, Err(Error::Rejected(Box::new(rejected))));
    stage.act();
    assert!(stage.tried.is_empty());
    assert!(matches!(&stage.over, Some(Err(Error::Rejected(why))) if why.reason == Reason::EpochSuperseded));
}
