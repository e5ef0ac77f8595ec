//! Motions under way that another server has served until now: what is taken, what goes on, and what is refused.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test may fail by panicking")]

use planner::{Accepted, AxisKind, AxisMoveSpec, Judged, LimitsSpec, Request, RequestSpec, State};
use proto::stream::{Ask, Batch, FromAxis, Motion, Open, Operation, Resume, Source, ToAxis};
use proto::{Digest, Reason};
use server::session::{Event, Output, Session};

/// 50 mm in 314 cycles.
fn plan() -> Accepted {
    let limits =
        LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..LimitsSpec::default() };
    let axis = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(0.05),
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

fn motion() -> Motion {
    Motion::opened(planner::motion::Motion::open(plan()).unwrap())
}

fn digest(cycle: u64) -> Digest {
    motion().digest_from((0, Digest::ZERO), cycle)
}

/// An axis that has executed `executed`, holds `held`, and knows the digest before cycle `checkpoint`.
fn resume(executed: u64, held: u64, checkpoint: u64) -> Open {
    let resume = Resume {
        motion: motion(),
        next_cycle: held + 1,
        digest: digest(held),
        checkpoint_cycle: checkpoint,
        checkpoint_digest: digest(checkpoint.saturating_sub(1)),
    };
    Open {
        stream: "cell-7/x".into(),
        epoch: 2,
        lead_cycles: 100,
        batch_cycles: 10,
        axis_guard: 2,
        close_at_rest: true,
        accept_unproved: false,
        compact: false,
        executed_cycle: executed,
        source: Source::Resume(Box::new(resume)),
    }
}

/// Everything that is said without another word from the axis.
fn said(session: &mut Session) -> Vec<ToAxis> {
    std::iter::from_fn(|| session.poll_output())
        .map(|output| match output {
            Output::Send(message) => message,
            Output::End(how) => panic!("it ends: {how:?}"),
        })
        .collect()
}

#[test]
fn it_goes_on_with_the_next_cycle_and_the_same_bits() {
    for (executed, held, checkpoint) in
        [(0, 0, 0), (100, 137, 0), (100, 137, 90), (100, 137, 138), (100, 200, 120)]
    {
        let mut session = Session::open(resume(executed, held, checkpoint), "test").unwrap();
        let mut next = held + 1;
        for message in said(&mut session) {
            let ToAxis::Batch(Batch { first_cycle, digest: of_last, columns, .. }) = message else {
                continue;
            };
            assert_eq!(first_cycle, next);
            next += columns.cycles() as u64;
            assert_eq!(of_last, digest(next - 1));
        }
        assert_eq!(next, executed + 101, "as far as the lead goes");
    }
}

/// A splice replaces cycles that the server before had sent: what comes before them has the digest that the axis has for it, wherever
/// the checkpoint was.
#[test]
fn an_operation_replaces_what_another_server_has_sent() {
    for checkpoint in [0, 90, 120, 201] {
        let mut session = Session::open(resume(100, 200, checkpoint), "test").unwrap();
        said(&mut session);
        let slower = Operation::now("slower", Ask::Override(0.5));
        session.handle(Event::FromAxis(FromAxis::Operation(slower)));
        let messages = said(&mut session);
        let [ToAxis::Revised(revised), ToAxis::Batch(batch), ..] = &messages[..] else {
            panic!("{messages:?}")
        };
        let first = batch.first_cycle;
        assert!(batch.replaces && first > 102 && first < 200, "cycle {first}");
        assert_eq!(revised.motion.under_way.from_cycle(), first);
        assert_eq!(revised.motion.digest_before, digest(first - 1), "checkpoint {checkpoint}");
        let of_last = revised.motion.digest_from((first - 1, digest(first - 1)), batch.last_cycle());
        assert_eq!(batch.digest, of_last, "checkpoint {checkpoint}");
    }
}

#[test]
fn what_cannot_be_is_refused() {
    type Change = fn(&mut Open, &mut Resume);
    let rows: [(&str, Reason, &str, Change); 6] = [
        ("another digest", Reason::DigestMismatch, "", |_, resume| resume.digest = digest(1)),
        ("another checkpoint", Reason::DigestMismatch, "", |_, resume| resume.checkpoint_digest = digest(1)),
        ("past the end", Reason::ResumePastEnd, "", |_, resume| resume.next_cycle = 400),
        ("past what is held", Reason::ValueOutOfRange, "open.resume.next_cycle", |open, resume| {
            (open.close_at_rest, resume.next_cycle) = (false, 400);
        }),
        ("executed and not held", Reason::ValueOutOfRange, "open.executed_cycle", |open, _| {
            open.executed_cycle = 201
        }),
        ("executed and not held, past the end", Reason::ValueOutOfRange, "open.executed_cycle", |open, _| {
            open.executed_cycle = u64::MAX;
        }),
    ];
    for (what, reason, field, change) in rows {
        let mut open = resume(150, 200, 90);
        let Source::Resume(mut resume) = open.source.clone() else { panic!("a resume") };
        change(&mut open, &mut resume);
        let open = Open { source: Source::Resume(resume), ..open };
        let refused = Session::open(open, "test").expect_err(what);
        let at = refused.fields.first().map_or("", |violation| violation.field.as_str());
        assert_eq!((refused.reason, at), (reason, field), "{what}: {refused}");
        if reason == Reason::DigestMismatch {
            assert_eq!(refused.metadata["cycle"], "200", "{what}");
        }
    }
}
