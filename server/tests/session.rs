//! One stream, message by message: no clock, no socket, no task.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking"
)]

use planner::{Accepted, AxisKind, AxisMoveSpec, Judged, LimitsSpec, Request, RequestSpec, State};
use proto::stream::{
    Ask, Batch, FARTHEST_AHEAD, FromAxis, Motion, Open, Operation, OperationResult, Phase, RefusalReason,
    Refused, Report, Source, StreamEvent, StreamEventKind, ToAxis,
};
use proto::{Digest, Reason, Rejected};
use server::session::{Event, Output, Session};

/// A move of 50 mm that takes 314 cycles, and ends at `end_velocity`.
fn plan(end_velocity: f64) -> Accepted {
    let limits =
        LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..LimitsSpec::default() };
    let axis = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State { position: 0.05, velocity: end_velocity, acceleration: 0.0 },
        limits,
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
    Judged::answer(&Request::try_from(spec).unwrap()).unwrap().accepted().unwrap()
}

fn open(plan: Accepted) -> Open {
    Open {
        stream: "cell-7/x".into(),
        epoch: 1,
        lead_cycles: 40,
        batch_cycles: 10,
        axis_guard: 2,
        close_at_rest: true,
        accept_unproved: false,
        compact: false,
        executed_cycle: 0,
        source: Source::Plan(plan),
    }
}

/// A session, and an axis that holds everything that it is sent.
struct Stage {
    session: Session,
    batches: Vec<Batch>,
    events: Vec<StreamEvent>,
    opened: usize,
    revised: Vec<Motion>,
    answers: Vec<Result<OperationResult, Reason>>,
    ended: Option<Result<(), Rejected>>,
}

impl Stage {
    fn new(open: Open) -> Self {
        let session = Session::open(open, "test").unwrap();
        let mut stage = Self {
            session,
            batches: vec![],
            events: vec![],
            opened: 0,
            revised: vec![],
            answers: vec![],
            ended: None,
        };
        stage.drain();
        stage
    }

    fn drain(&mut self) {
        while let Some(output) = self.session.poll_output() {
            match output {
                Output::Send(ToAxis::Opened(_)) => self.opened += 1,
                Output::Send(ToAxis::Batch(batch)) => self.batches.push(batch),
                Output::Send(ToAxis::Event(event)) => self.events.push(event),
                Output::Send(ToAxis::Refusal(refusal)) => self.answers.push(Err(refusal.rejected.reason)),
                Output::Send(ToAxis::Result(result)) => self.answers.push(Ok(result)),
                Output::Send(ToAxis::Revised(revised)) => self.revised.push(revised.motion),
                Output::End(how) => self.ended = Some(how),
            }
        }
        assert!(!self.session.has_output());
    }

    fn held(&self) -> u64 {
        self.batches.last().map_or(0, Batch::last_cycle)
    }

    fn digest(&self, cycle: u64) -> Digest {
        if cycle == 0 {
            return Digest::ZERO;
        }
        self.batches.iter().rev().find(|batch| batch.last_cycle() == cycle).unwrap().digest
    }

    fn report(&mut self, executed: u64, grant: u64) {
        let accepted = self.held();
        let digest = self.digest(accepted);
        self.send(Report {
            executed_cycle: executed,
            accepted_cycle: accepted,
            grant_cycle: grant,
            digest,
            ..Report::default()
        });
    }

    fn send(&mut self, report: Report) {
        self.handle(Event::FromAxis(FromAxis::Report(report)));
    }

    fn handle(&mut self, event: Event) {
        self.session.handle(event);
        self.drain();
    }

    fn reason(&self) -> Reason {
        self.ended.as_ref().expect("the session has ended").as_ref().unwrap_err().reason
    }

    fn kinds(&self) -> Vec<StreamEventKind> {
        self.events.iter().map(|event| event.kind).collect()
    }
}

#[test]
fn the_first_grant_is_the_lead() {
    let stage = Stage::new(open(plan(0.0)));
    assert_eq!(stage.opened, 1);
    assert_eq!(stage.batches.iter().map(|batch| batch.first_cycle).collect::<Vec<_>>(), [1, 11, 21, 31]);
    assert_eq!(stage.held(), 40);
}

#[test]
fn cycles_are_consecutive_to_the_last() {
    let mut stage = Stage::new(open(plan(0.0)));
    while stage.held() < 314 {
        let executed = stage.held().saturating_sub(3);
        stage.report(executed, executed + 43);
    }
    assert!(stage.ended.is_none(), "it may still be held");
    stage.report(314, 354);
    assert_eq!(stage.ended, Some(Ok(())));
    let mut next = 1;
    for batch in &stage.batches {
        assert_eq!(batch.first_cycle, next);
        next = batch.last_cycle() + 1;
    }
    assert_eq!(next, 315);
    assert!(stage.batches.last().unwrap().last);
    assert_eq!(stage.kinds(), [StreamEventKind::Finished]);
    assert_eq!(stage.session.phase(), Phase::Finished);
}

#[test]
fn a_lead_that_is_no_multiple_of_a_batch_is_filled() {
    let stage = Stage::new(Open { lead_cycles: 45, ..open(plan(0.0)) });
    assert_eq!(stage.held(), 45);
}

#[test]
fn a_huge_grant_is_a_free_run_of_bounded_length() {
    let mut stage = Stage::new(Open { close_at_rest: false, ..open(plan(0.0)) });
    stage.report(0, u64::MAX);
    assert_eq!(stage.held(), FARTHEST_AHEAD);
    stage.report(100, 1 << 63);
    assert_eq!(stage.held(), FARTHEST_AHEAD + 100);
}

#[test]
fn no_grant_no_batch() {
    let mut stage = Stage::new(open(plan(0.0)));
    for _ in 0..5 {
        stage.report(0, 40);
    }
    assert_eq!(stage.held(), 40);
    assert!(stage.ended.is_none());
}

#[test]
fn a_stream_that_stays_open_stands_still_after_the_plan() {
    let mut stage = Stage::new(Open { close_at_rest: false, ..open(plan(0.0)) });
    for executed in (0..400).step_by(10) {
        stage.report(executed, executed + 40);
    }
    assert_eq!(stage.events, [StreamEvent { kind: StreamEventKind::Standstill, at_cycle: 314 }]);
    let rest = stage.batches.last().unwrap().columns.at(0, 0).unwrap();
    assert_eq!(rest.words(), [0.05, 0.0, 0.0, 0.0]);
    stage.handle(Event::AxisClosed);
    assert_eq!(stage.ended, Some(Ok(())));
}

#[test]
fn a_plan_that_ends_at_speed_is_stopped_after_it() {
    let mut stage = Stage::new(open(plan(0.1)));
    while stage.ended.is_none() {
        let executed = stage.held();
        stage.report(executed, executed + 40);
    }
    let last = stage.batches.last().unwrap();
    let setpoint = last.columns.at(0, last.columns.cycles() - 1).unwrap();
    assert_eq!((setpoint.state.velocity, setpoint.state.acceleration), (0.0, 0.0));
    assert!(setpoint.state.position > 0.05);
}

#[test]
fn what_was_refused_is_sent_again() {
    let mut stage = Stage::new(open(plan(0.0)));
    let again = stage.batches[2].clone();
    let refused = Refused { revision: 0, first_cycle: 21, reason: RefusalReason::Gap };
    stage.send(Report {
        executed_cycle: 0,
        accepted_cycle: 20,
        grant_cycle: 40,
        digest: stage.digest(20),
        refused: Some(refused),
        ..Report::default()
    });
    assert_eq!(stage.batches[4], again);
    assert_eq!(stage.held(), 40);
}

#[test]
fn refused_in_the_middle_of_a_batch_goes_on_there() {
    let mut stage = Stage::new(open(plan(0.0)));
    let before = stage.digest(10);
    let digest = stage.batches[1].columns.digests(11, before).nth(4).unwrap();
    let refused = Refused { revision: 0, first_cycle: 16, reason: RefusalReason::JoinMismatch };
    stage.send(Report {
        accepted_cycle: 15,
        grant_cycle: 40,
        digest,
        refused: Some(refused),
        ..Report::default()
    });
    assert_eq!(stage.batches[4].first_cycle, 16);
    assert_eq!(stage.batches[6].first_cycle, 36);
    assert_eq!(stage.batches[6].digest, stage.batches[3].digest);
}

#[test]
fn three_refusals_end_the_session() {
    let mut stage = Stage::new(open(plan(0.0)));
    for _ in 0..3 {
        let refused = Refused { revision: 0, first_cycle: 1, reason: RefusalReason::Gap };
        stage.send(Report { grant_cycle: 40, refused: Some(refused), ..Report::default() });
    }
    assert_eq!(stage.reason(), Reason::NotConfirmed);
}

#[test]
fn a_wrong_digest_ends_the_session_and_names_the_cycle() {
    let mut stage = Stage::new(open(plan(0.0)));
    stage.send(Report { accepted_cycle: 20, grant_cycle: 60, digest: Digest::from(7), ..Report::default() });
    assert_eq!(stage.reason(), Reason::DigestMismatch);
    let rejected = stage.ended.unwrap().unwrap_err();
    assert_eq!(rejected.metadata["cycle"], "20");
}

#[test]
fn what_cannot_be_true_ends_the_session() {
    type Row = (u64, u64);
    let rows: [Row; 3] = [(0, 41), (21, 20), (u64::MAX, u64::MAX)];
    for (executed_cycle, accepted_cycle) in rows {
        let mut stage = Stage::new(open(plan(0.0)));
        stage.send(Report { executed_cycle, accepted_cycle, ..Report::default() });
        assert_eq!(stage.reason(), Reason::ProtocolOrder, "{executed_cycle} {accepted_cycle}");
    }
}

#[test]
fn cycles_do_not_run_backward() {
    let mut stage = Stage::new(open(plan(0.0)));
    stage.report(20, 60);
    stage.send(Report {
        executed_cycle: 10,
        accepted_cycle: 40,
        digest: stage.digest(40),
        ..Report::default()
    });
    assert_eq!(stage.reason(), Reason::ProtocolOrder);
}

#[test]
fn a_second_open_is_out_of_order() {
    let mut stage = Stage::new(open(plan(0.0)));
    stage.handle(Event::FromAxis(FromAxis::Open(Box::new(open(plan(0.0))))));
    assert_eq!(stage.reason(), Reason::ProtocolOrder);
}

impl Stage {
    fn ask(&mut self, id: &str, ask: Ask) {
        self.handle(Event::FromAxis(FromAxis::Operation(Operation::now(id, ask))));
    }

    /// The axis reports that it has adopted what it was sent last.
    fn adopt(&mut self, executed: u64) {
        let (accepted, revision) = (self.held(), self.batches.last().unwrap().revision);
        let digest = self.digest(accepted);
        let (executed_cycle, accepted_cycle, grant_cycle) = (executed, accepted, executed + 40);
        self.send(Report {
            executed_cycle,
            accepted_cycle,
            grant_cycle,
            revision,
            digest,
            ..Report::default()
        });
    }
}

#[test]
fn a_splice_replaces_what_was_sent_and_is_answered_when_it_is_adopted() {
    let mut stage = Stage::new(open(plan(0.0)));
    stage.report(10, 50);
    stage.ask("h1", Ask::Hold);
    let batch = stage.batches.last().unwrap().clone();
    // Beyond the report by the guard, the report interval, the round trip and planning: 2 + 10 + 10 + 1.
    assert_eq!((batch.first_cycle, batch.last_cycle(), batch.revision, batch.replaces), (33, 50, 1, true));
    assert_eq!(stage.revised.len(), 1);
    let motion = &stage.revised[0];
    assert_eq!(motion.under_way.from_cycle(), 33);
    assert_eq!(batch.columns.digests(33, motion.digest_before).last(), Some(batch.digest));
    assert_eq!(stage.answers, []);
    // Reports from before it are of the motion before it.
    let before = stage.batches.iter().find(|batch| batch.last_cycle() == 50).unwrap().digest;
    stage.send(Report {
        executed_cycle: 12,
        accepted_cycle: 50,
        grant_cycle: 52,
        digest: before,
        ..Report::default()
    });
    assert_eq!(stage.answers, []);
    assert_eq!(stage.batches.last().unwrap().revision, 1);
    stage.adopt(13);
    let result = stage.answers[0].as_ref().unwrap();
    assert_eq!((result.effective_cycle, result.revision, result.on_path), (33, 1, true));
    assert_eq!(stage.session.phase(), Phase::Holding);
    assert_eq!(stage.session.motion().recent.as_ref(), std::slice::from_ref(result));
}

#[test]
fn a_refused_splice_is_planned_again_later_and_after_three_refusals_not() {
    let mut stage = Stage::new(open(plan(0.0)));
    stage.report(10, 50);
    let old = stage.digest(50);
    stage.ask("h1", Ask::Hold);
    let mut firsts = Vec::new();
    for executed in [20, 22, 24] {
        let batch = stage.batches.iter().rev().find(|batch| batch.revision == 1).unwrap();
        assert!(batch.replaces);
        let (revision, first_cycle) = (1, batch.first_cycle);
        firsts.push(first_cycle);
        let refused = Some(Refused { revision, first_cycle, reason: RefusalReason::TooLate });
        let (executed_cycle, accepted_cycle, grant_cycle) = (executed, 50, executed + 40);
        stage.send(Report {
            executed_cycle,
            accepted_cycle,
            grant_cycle,
            digest: old,
            refused,
            ..Report::default()
        });
    }
    assert_eq!(firsts[0], 33);
    assert!(firsts.windows(2).all(|pair| pair[0] < pair[1]), "{firsts:?}");
    assert_eq!(stage.answers, [Err(Reason::NotConfirmed)]);
    // It goes on as it did.
    let next = stage.batches.iter().rev().find(|batch| batch.first_cycle == 51).unwrap();
    assert_eq!((next.revision, next.replaces), (0, false));
    stage.adopt(40);
    assert!(stage.ended.is_none());
}

#[test]
fn a_splice_that_a_report_passes_over_is_planned_again() {
    let mut stage = Stage::new(open(plan(0.0)));
    stage.report(10, 50);
    let old = stage.digest(50);
    stage.ask("h1", Ask::Hold);
    let first = stage.batches.last().unwrap().first_cycle;
    // It never arrived.
    stage.send(Report {
        executed_cycle: first,
        accepted_cycle: 50,
        grant_cycle: 80,
        digest: old,
        ..Report::default()
    });
    let again = stage.batches.iter().rev().find(|batch| batch.revision == 1).unwrap();
    assert!(again.first_cycle > first && stage.ended.is_none());
}

#[test]
fn what_changes_no_setpoint_begins_with_the_next_batch() {
    let mut stage = Stage::new(Open { close_at_rest: false, ..open(plan(0.0)) });
    for executed in (0..=400).step_by(10) {
        stage.report(executed, executed + 40);
    }
    stage.ask("h1", Ask::Hold);
    assert_eq!(stage.batches.last().unwrap().revision, 0, "nothing more is granted");
    stage.report(410, 450);
    let batch = stage.batches.last().unwrap();
    assert_eq!((batch.first_cycle, batch.revision, batch.replaces), (441, 1, false));
    stage.adopt(411);
    assert_eq!(stage.session.phase(), Phase::Holding);
}

#[test]
fn what_was_to_take_effect_after_the_end_is_refused_at_the_end() {
    let mut stage = Stage::new(open(plan(0.0)));
    let beyond = |id: &str, ask| Operation { not_before_cycle: Some(100_000), ..Operation::now(id, ask) };
    stage.handle(Event::FromAxis(FromAxis::Operation(beyond("hold", Ask::Hold))));
    stage.report(10, 400);
    assert_eq!(stage.answers, []);
    stage.report(314, 400);
    assert_eq!(stage.answers, [Err(Reason::StreamFinished)]);
    assert_eq!(stage.ended, Some(Ok(())));
}

#[test]
fn a_hold_in_the_last_cycles_keeps_the_stream_open() {
    let mut stage = Stage::new(open(plan(0.0)));
    while stage.held() < 314 {
        let executed = stage.held();
        stage.report(executed.min(280), executed.min(280) + 40);
    }
    assert!(stage.batches.last().unwrap().last);
    stage.ask("h1", Ask::Hold);
    let batch = stage.batches.iter().find(|batch| batch.revision == 1).unwrap();
    // It rests as soon as can be as it is: no setpoint changes, and the last cycle is not the last any more.
    assert!(batch.replaces && !batch.last && batch.last_cycle() == 314);
    stage.adopt(290);
    stage.adopt(320);
    assert!(stage.ended.is_none());
    assert_eq!(stage.session.phase(), Phase::Holding);
}

#[test]
fn an_axis_that_asks_for_much_is_read_no_more_until_it_reads() {
    let mut session = Session::open(open(plan(0.0)), "test").unwrap();
    let nothing = Operation { request_id: "n".into(), not_before_cycle: None, ask: None };
    let mut asked = 0;
    while !session.is_full() {
        session.handle(Event::FromAxis(FromAxis::Operation(nothing.clone())));
        asked += 1;
        assert!(asked < 1000);
    }
    while session.poll_output().is_some() {}
    assert!(!session.is_full());
}

#[test]
fn a_newer_epoch_ends_the_session() {
    let mut stage = Stage::new(open(plan(0.0)));
    stage.handle(Event::Superseded { by: 5 });
    assert_eq!(stage.kinds(), [StreamEventKind::Superseded]);
    assert_eq!(stage.reason(), Reason::EpochSuperseded);
}

#[test]
fn a_drain_is_told_once_and_the_stream_goes_on() {
    let mut stage = Stage::new(open(plan(0.0)));
    stage.handle(Event::Drain);
    stage.handle(Event::Drain);
    assert_eq!(stage.kinds(), [StreamEventKind::Draining]);
    stage.report(10, 50);
    assert_eq!(stage.held(), 50);
}

#[test]
fn a_server_that_leaves_says_so() {
    let mut stage = Stage::new(open(plan(0.0)));
    stage.handle(Event::Drain);
    stage.handle(Event::Leave);
    assert_eq!(stage.reason(), Reason::Draining);
}

#[test]
fn an_open_with_a_past_is_refused() {
    let rejected = Session::open(Open { executed_cycle: 7, ..open(plan(0.0)) }, "test").unwrap_err();
    assert_eq!(rejected.reason, Reason::ValueOutOfRange);
}
