//! Nobody serves any more: the axis comes to rest by itself, and goes on when somebody is back.

use std::time::Duration;

use client::failover::Cause;
use e2e::{difference, move_of, planned};
use planner::motion::Operation as Planned;
use planner::{Accepted, Setpoint};
use proto::Digest;
use proto::stream::{Ask, Motion, Operation};
use sim_axis::{TrackError, TrackRequest};

use crate::replica::Replica;
use crate::run::{LEAD, Run, alone, request};

/// The motion of an axis on `plan` that held nothing after `cycle`.
fn starved(plan: &Accepted, cycle: u64) -> Motion {
    let motion = Motion::opened(planner::motion::Motion::open(plan.clone()).unwrap());
    let digest_before = motion.digest_from((0, Digest::ZERO), cycle - 1);
    motion.starved(cycle, &motion.tails(cycle).unwrap(), digest_before).unwrap()
}

/// Every setpoint of `motion` from `first` to `last`.
fn setpoints(motion: &planner::motion::Motion, first: u64, last: u64) -> Vec<Vec<Setpoint>> {
    let mut sampler = motion.plan().sampler();
    (first..=last).map(|cycle| sampler.at(cycle - motion.from_cycle()).collect()).collect()
}

/// The last cycle of `plan` that was played before the axis went its way to rest.
fn left_at(played: &[Vec<Setpoint>], plan: &Accepted) -> u64 {
    let motion = planner::motion::Motion::open(plan.clone()).unwrap();
    let planned = setpoints(&motion, 1, played.len() as u64);
    played.iter().zip(&planned).take_while(|(one, other)| one == other).count() as u64
}

/// Both servers die; one comes back. The axis has come to rest by the way that came with its last cycle, opens again held, and goes on
/// to its goal when it is asked to.
#[tokio::test(flavor = "multi_thread")]
async fn both_servers_die_and_one_comes_back() {
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let (mut first, mut second) = (Replica::start("first").await, Replica::start("second").await);
    let endpoints = [first.endpoint(), second.endpoint()];
    let mut run = Run::begin(request("cell-7/x", &endpoints, &plan, LEAD)).await;
    run.until(300).await;
    first.kill();
    second.kill();
    // Long after the last cycle that was held, and its way to rest.
    let rested = tokio::time::timeout(Duration::from_millis(1500), run.until(u64::MAX)).await;
    assert!(rested.is_err());
    let back = Replica::with("back", second.address(), &[]).await;
    run.until_changes(1).await;
    let change = run.seen().changes[0].clone();
    assert_eq!((change.cause, change.to.as_str()), (Cause::Starved, "back"));
    let commander = run.commander();
    let resume = commander.operate(Operation::now("on", Ask::Resume));
    let (played, result) = tokio::join!(run.finish(), resume);
    let result = result.unwrap();
    drop(back);

    let from = left_at(&played.seen.setpoints, &plan);
    let rest = starved(&plan, from);
    let on = rest.under_way.splice(result.effective_cycle, &Planned::Resume).unwrap().motion;
    assert!(rest.last_cycle() < result.effective_cycle);
    let planned = [
        setpoints(&planner::motion::Motion::open(plan.clone()).unwrap(), 1, from),
        setpoints(&rest.under_way, from + 1, result.effective_cycle - 1),
        setpoints(&on, result.effective_cycle, on.last_cycle()),
    ]
    .concat();
    let executed = played.report.stream.cycles_executed;
    assert_eq!(executed, on.last_cycle());
    assert_eq!(difference(&played.seen.setpoints[..executed as usize], &planned), None);
    played.seen.is_smooth(&plan);
    let digest = (1..).zip(&planned).fold(Digest::ZERO, |digest: Digest, (cycle, setpoints)| {
        digest.then(cycle, setpoints.iter().map(Setpoint::words))
    });
    assert_eq!(played.digest(), digest);
    let stream = &played.report.stream;
    assert!(stream.stop_tail_used);
    assert_eq!((stream.failovers, stream.counters.underruns, stream.revisions), (1, 1, 2), "{stream:?}");
    let goal = played.seen.setpoints.last().unwrap()[0].state;
    assert!(goal.is_at_rest() && (goal.position - 0.3).abs() < 1e-12, "{goal:?}");
}

/// Nobody comes back: the axis rests where its way to rest ends, and says so when its patience is over.
#[tokio::test(flavor = "multi_thread")]
async fn nobody_comes_back() {
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let mut only = Replica::start("only").await;
    let patience = Duration::from_millis(700);
    let request = TrackRequest { patience, ..request("cell-7/x", &[only.endpoint()], &plan, LEAD) };
    let mut run = Run::begin(request).await;
    run.until(300).await;
    let began = std::time::Instant::now();
    only.kill();
    let (seen, how) = run.end().await;
    assert!(began.elapsed() >= patience, "{:?}", began.elapsed());
    let Err(TrackError::Broken { executed, motion_end, report, .. }) = how else { panic!("{how:?}") };
    let from = left_at(&seen.setpoints, &plan);
    let rest = starved(&plan, from);
    assert_eq!((executed, motion_end), (rest.last_cycle(), plan.plan().cycle_count()));
    assert_eq!(
        difference(
            &seen.setpoints[from as usize..executed as usize],
            &setpoints(&rest.under_way, from + 1, executed)
        ),
        None
    );
    seen.is_smooth(&plan);
    assert!(seen.setpoints.last().unwrap()[0].state.is_at_rest());
    assert!(report.stream.stop_tail_used);
    assert_eq!((report.stream.failovers, report.stream.counters.underruns), (0, 1));
}
