//! Operations over real gRPC: in band, by ControlStream, and by the axis's Command.

use std::time::Duration;

use crate::rehearsed_paths::{FIRST_POINTS, Kind};
use client::{Error, Setpoints, control};
use e2e::{Loopback, LoopbackAxis, move_of, open, planned, replay};
use planner::State;
use planner::motion::Operation as Planned;
use proto::stream::{Ask, GoalSpec, Open, Operation, OperationResult, Phase};
use proto::{Digest, Reason, Rejected};
use sim_axis::{Clock, RemoteAxis, TrackRequest, Tracking};

fn goal(position: f64) -> Ask {
    Ask::Retarget(vec![GoalSpec { axis: "x".into(), goal: Some(State::at_rest(position)), limits: None }])
}

/// Plays on until operation `id` is answered.
pub(super) async fn answered(stream: &mut Setpoints, id: &str) -> Result<OperationResult, Rejected> {
    loop {
        for (answered, result) in stream.take_answers() {
            if answered == id {
                return result;
            }
        }
        stream.next().await.unwrap().expect("the stream goes on");
    }
}

pub(super) async fn play_to(stream: &mut Setpoints, cycle: u64) -> Digest {
    let mut digest = Digest::ZERO;
    while stream.buffer().executed() < cycle {
        digest = stream.next().await.unwrap().expect("the stream goes on").digest;
    }
    digest
}

/// Points are appended to a motion that is then slowed and held: base and law of time travel with each revision.
#[tokio::test]
async fn a_motion_through_points_is_appended_to_and_held_on_its_path() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let plan = crate::rehearsed_paths::opened(Kind::Points);
    let open = Open { close_at_rest: false, ..open("cell-7/xy", plan.clone()) };
    let mut stream = Setpoints::open(&client, open).await.unwrap();
    let mut done = Vec::new();
    let append = |from, to| Ask::Append(crate::rehearsed_paths::points(from, to));
    let steps = [
        (100, "a1", append(FIRST_POINTS, 12)),
        (300, "o", Ask::Override(0.5)),
        (400, "a2", append(12, 14)),
        (600, "h", Ask::Hold),
        (900, "r", Ask::Resume),
    ];
    for (cycle, id, ask) in steps {
        play_to(&mut stream, cycle).await;
        let operation = Operation::now(id, ask);
        let planned = operation.planned().unwrap();
        assert!(stream.operate(operation));
        let result = answered(&mut stream, id).await.unwrap();
        assert_eq!((result.revision, result.on_path), (done.len() as u64 + 1, true), "{id}");
        done.push((result.effective_cycle, planned));
    }
    let rest = stream.motion().last_cycle();
    let digest = play_to(&mut stream, rest).await;
    let (_, replayed, motion) = replay(&plan, &done, stream.buffer().executed());
    assert_eq!(digest, replayed);
    assert_eq!(stream.motion().under_way, motion);
    assert!(motion.base_time().is_some());
    stream.operate(Operation::now("late", append(14, 15)));
    assert_eq!(answered(&mut stream, "late").await.unwrap_err().reason, Reason::AppendTooLate);
}

/// Points that are asked for later than there is motion are told when they could have been appended; and who commands a stream that is over is
/// told that it is.
#[tokio::test]
async fn what_comes_after_the_end_is_too_late() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let plan = crate::rehearsed_paths::opened(Kind::Points);
    let mut stream = Setpoints::open(&client, open("cell-7/xy", plan)).await.unwrap();
    let append = Ask::Append(crate::rehearsed_paths::points(FIRST_POINTS, 12));
    let later = Operation { not_before_cycle: Some(100_000), ..Operation::now("later", append) };
    assert!(stream.operate(later));
    while stream.next().await.unwrap().is_some() {}
    let answers = stream.take_answers();
    let [(_, Err(refused))] = answers.as_slice() else { panic!("{answers:?}") };
    assert_eq!(refused.reason, Reason::AppendTooLate);
    let closing = refused.metadata.get("closing_from_cycle").unwrap().parse::<u64>().unwrap();
    assert!(0 < closing && closing <= stream.motion().last_cycle(), "{refused}");
    drop(stream);
    let hold = || client.control("cell-7/xy", Operation::now("hold", Ask::Hold));
    // The server learns of the end a moment after the axis.
    let over = loop {
        match hold().await.unwrap_err() {
            client::Error::Rejected(rejected) if rejected.reason == Reason::NotConfirmed => {
                tokio::task::yield_now().await
            }
            other => break other,
        }
    };
    assert!(
        matches!(&over, client::Error::Rejected(rejected) if rejected.reason == Reason::StreamFinished),
        "{over}"
    );
    let never = client.control("cell-7/never", Operation::now("hold", Ask::Hold)).await.unwrap_err();
    assert!(
        matches!(&never, client::Error::Rejected(rejected) if rejected.reason == Reason::StreamNotHere),
        "{never}"
    );
}

#[tokio::test]
async fn every_operation_is_done_in_band() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let plan = planned(move_of(0.5, 0.25));
    let open = Open { close_at_rest: false, ..open("cell-7/x", plan.clone()) };
    let mut stream = Setpoints::open(&client, open).await.unwrap();
    let mut done = Vec::new();
    let steps = [
        (100, "o", Ask::Override(0.5), Planned::Override(planner::motion::Override::new(0.5).unwrap())),
        (400, "h", Ask::Hold, Planned::Hold),
        (800, "r", Ask::Resume, Planned::Resume),
        (1000, "g", goal(0.3), Operation::now("", goal(0.3)).planned().unwrap()),
        (1400, "s", Ask::Stop, Planned::Stop),
    ];
    for (cycle, id, ask, operation) in steps {
        play_to(&mut stream, cycle).await;
        assert!(stream.operate(Operation::now(id, ask)));
        let result = answered(&mut stream, id).await.unwrap();
        assert_eq!((result.revision, result.on_path), (done.len() as u64 + 1, true), "{id}");
        assert_eq!(stream.motion().revision(), result.revision);
        assert_eq!(stream.motion().result_of(id), Some(&result));
        done.push((result.effective_cycle, operation));
    }
    assert_eq!(stream.motion().under_way.phase(), Phase::Stopping);
    stream.operate(Operation::now("late", Ask::Resume));
    // On its way to rest, or there: how fast this axis plays is its own affair.
    let late = answered(&mut stream, "late").await.unwrap_err().reason;
    assert!(matches!(late, Reason::Stopped | Reason::StreamFinished), "{late}");
    let mut digest = Digest::ZERO;
    while let Some(playing) = stream.next().await.unwrap() {
        digest = playing.digest;
    }
    let last = stream.buffer().executed();
    assert_eq!(digest, replay(&plan, &done, last).1);
    // The setpoints of the last motion are those that SamplePlan answers.
    let motion = stream.motion().clone();
    let mut samples = client.sample(motion.accepted().judged(), 0, 0).await.unwrap();
    let mut sampled = motion.digest_before;
    let mut cycle = motion.under_way.from_cycle();
    while let Some(chunk) = samples.next().await.unwrap() {
        for index in 0..chunk.columns.cycles() {
            sampled = sampled.then(cycle, chunk.columns.cycle(index).map(|setpoint| setpoint.words()));
            cycle += 1;
        }
    }
    assert_eq!(cycle, motion.last_cycle() + 1);
    let rest = replay(&plan, &done, motion.last_cycle()).1;
    assert_eq!(sampled, rest);
}

#[tokio::test]
async fn others_operate_where_the_stream_is_served() {
    let (server, elsewhere) = (Loopback::start().await, Loopback::start().await);
    let client = server.client().await;
    let mut stream = Setpoints::open(&client, open("cell-7/x", planned(move_of(0.5, 0.25)))).await.unwrap();
    play_to(&mut stream, 100).await;

    let refused = elsewhere.client().await.control("cell-7/x", Operation::now("h", Ask::Hold)).await;
    let Err(Error::Rejected(rejected)) = refused else { panic!("{refused:?}") };
    assert_eq!(rejected.reason, Reason::StreamNotHere);

    let endpoints = [elsewhere.endpoint(), server.endpoint()];
    let hold = Operation::now("h", Ask::Hold);
    let (held, ()) = tokio::join!(control(&endpoints, "cell-7/x", &hold), async {
        while stream.motion().revision() == 0 {
            stream.next().await.unwrap();
        }
        // The report that confirms it has been said; the answer needs no more of them.
    });
    let held = held.unwrap();
    assert_eq!(held.revision, 1);
    // Again, and from elsewhere in the motion: the same answer, at once.
    assert_eq!(control(&endpoints, "cell-7/x", &hold).await, Ok(held));

    let mut bare = server.setpoints().await;
    let unsaid =
        bare.control_stream(proto::pb::ControlStreamRequest { stream: "cell-7/x".into(), operation: None });
    let rejected = Rejected::from_status(&unsaid.await.unwrap_err()).unwrap();
    assert_eq!((rejected.reason, rejected.fields[0].field.as_str()), (Reason::FieldMissing, "operation"));

    // Nobody plays on: the commander hears when the axis goes.
    let later = Operation { not_before_cycle: Some(100_000), ..Operation::now("later", Ask::Stop) };
    let (unconfirmed, ()) = tokio::join!(client.control("cell-7/x", later), async { stream.close() });
    let Err(Error::Rejected(rejected)) = unconfirmed else { panic!("{unconfirmed:?}") };
    assert!(matches!(rejected.reason, Reason::NotConfirmed | Reason::StreamNotHere), "{rejected}");
}

#[tokio::test]
async fn an_axis_is_commanded() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let plan = planned(move_of(0.5, 0.25));
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let nobody = remote.command("", Operation::now("h", Ask::Hold)).await;
    let Err(Error::Rejected(rejected)) = nobody else { panic!("{nobody:?}") };
    assert_eq!(rejected.reason, Reason::StreamNotHere);

    let mut run = remote.track(TrackRequest::new("cell-7/x", server.endpoint(), plan.clone())).await.unwrap();
    let mut done = Vec::new();
    let playing = tokio::spawn(async move {
        while run.next().await.unwrap().is_some() {}
        run.finish().unwrap()
    });
    let half = planner::motion::Override::new(0.5).unwrap();
    for (id, ask, operation) in [
        ("o", Ask::Override(0.5), Planned::Override(half)),
        ("h", Ask::Hold, Planned::Hold),
        ("r", Ask::Resume, Planned::Resume),
    ] {
        let result = remote.command("cell-7/x", Operation::now(id, ask.clone())).await.unwrap();
        assert_eq!(remote.command("", Operation::now(id, ask)).await, Ok(result.clone()));
        done.push((result.effective_cycle, operation));
    }
    for factor in [f64::NAN, -1.0, 1e9] {
        let refused = remote.command("", Operation::now("bad", Ask::Override(factor))).await;
        let Err(Error::Rejected(rejected)) = refused else { panic!("{refused:?}") };
        assert_eq!(rejected.reason, Reason::OverrideOutOfRange);
    }
    let elsewhere = remote.command("cell-8/x", Operation::now("h", Ask::Hold)).await;
    let Err(Error::Rejected(rejected)) = elsewhere else { panic!("{elsewhere:?}") };
    assert!(rejected.message.contains("\"cell-7/x\""), "{rejected}");

    let report = playing.await.unwrap();
    assert_eq!(report.stream.revisions, 3);
    assert_eq!(report.stream.counters.underruns, 0);
    let (_, digest, motion) = replay(&plan, &done, report.stream.cycles_executed);
    assert_eq!((report.stream.digest, report.stream.cycles_executed), (digest, motion.last_cycle()));
}

/// Time stands still at rest, and goes on for an operation.
#[tokio::test]
async fn an_axis_in_virtual_time_is_commanded_at_rest() {
    let server = Loopback::start().await;
    let plan = planned(move_of(0.05, 0.25));
    let request = TrackRequest {
        clock: Clock::Virtual,
        stay_open: true,
        settle_window: 0.05,
        ..TrackRequest::new("cell-7/x", server.endpoint(), plan.clone())
    };
    let mut run = Tracking::begin(request).await.unwrap();
    let commander = run.commander();
    let commanding = async move {
        let there = commander.operate(Operation::now("g", goal(0.2))).await.unwrap();
        let held = commander.operate(Operation::now("h", Ask::Hold)).await.unwrap();
        let resumed = commander.operate(Operation::now("r", Ask::Resume)).await.unwrap();
        let stopped = commander.operate(Operation::now("s", Ask::Stop)).await.unwrap();
        [there, held, resumed, stopped].map(|result| result.revision)
    };
    let playing = async { while run.next().await.is_some() {} };
    let both = async { tokio::join!(commanding, playing) };
    let (revisions, ()) = tokio::time::timeout(Duration::from_secs(60), both).await.expect("no stand-still");
    assert!(revisions.windows(2).all(|pair| pair[0] <= pair[1]) && revisions[3] >= 2, "{revisions:?}");
    let report = run.finish().await.unwrap();
    assert_eq!(report.stream.revisions, revisions[3]);
    assert_eq!(report.stream.counters.underruns, 0);
}

/// How long from asking an axis to the answer, which comes when it has adopted the splice. Says so in a table:
/// `cargo test --release -p e2e --test e2e -- --ignored --nocapture reaction`.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "measures; takes 20 s"]
async fn reaction_takes_a_few_cycles() {
    const RUNS: usize = 10;
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let mut answered = Vec::new();
    // Those of a machine that has other things to do; they say how far the figures are to be trusted.
    let (mut underruns, mut refused) = (0, 0);
    for run in 0..RUNS {
        let name = format!("cell-{run}/x");
        let plan = planned(move_of(5.0, 0.25));
        let request = TrackRequest { stay_open: true, ..TrackRequest::new(&name, server.endpoint(), plan) };
        let mut tracking = remote.track(request).await.unwrap();
        let playing = tokio::spawn(async move {
            while tracking.next().await.unwrap().is_some() {}
            tracking.finish().unwrap()
        });
        for step in 0..60_u32 {
            let ask = Ask::Override(if step % 2 == 0 { 0.6 } else { 1.0 });
            let asked = std::time::Instant::now();
            let id = format!("{run}/{step}");
            remote.command(&name, Operation::now(id, ask)).await.unwrap();
            answered.push(asked.elapsed().as_secs_f64() * 1e3);
            // A commander asks when it likes, not when a report has just come.
            let until =
                tokio::time::Instant::now() + Duration::from_micros(20_000 + 370 * u64::from(step % 27));
            let mut next = tokio::time::interval_at(until, Duration::from_secs(1));
            next.tick().await;
        }
        remote.command(&name, Operation::now("stop", Ask::Stop)).await.unwrap();
        let report = playing.await.unwrap();
        assert_eq!(report.stream.revisions, 61);
        underruns += report.stream.counters.underruns;
        refused += report.stream.counters.refused_batches;
    }
    answered.sort_by(f64::total_cmp);
    let at = |share: f64| answered[((answered.len() - 1) as f64 * share) as usize];
    println!("operation to confirmed splice [cycles of 1 ms], {} operations", answered.len());
    println!("  p50 {:6.2}\n  p90 {:6.2}\n  p99 {:6.2}\n  max {:6.2}", at(0.5), at(0.9), at(0.99), at(1.0));
    println!("  underruns {underruns}, batches refused {refused}");
    assert!(at(0.99) <= 20.0, "p99 is {} cycles", at(0.99));
}
