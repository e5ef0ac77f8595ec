//! Servers that die.

use client::failover::Cause;
use e2e::{move_of, planned};
use planner::State;
use proto::stream::{Ask, GoalSpec, Operation};
use tokio::task::JoinSet;

use crate::liar::{Lie, lie};
use crate::replica::Replica;
use crate::run::{LEAD, Run, alone, answer, request};

/// Runs at a time: each has a cycle thread and two servers of its own.
const AT_A_TIME: u64 = 4;

fn at(cycle: u64, id: &str, ask: Ask) -> Operation {
    Operation { not_before_cycle: Some(cycle), ..Operation::now(id, ask) }
}

fn goal(position: f64) -> Ask {
    Ask::Retarget(vec![GoalSpec { axis: "x".into(), goal: Some(State::at_rest(position)), limits: None }])
}

/// The promise: killed at any moment of a move, and the axis misses no cycle. Every 50th cycle of a move that goes slower from cycle
/// 150 on, and then, behind the fail-over or ahead of it, faster and elsewhere.
#[tokio::test(flavor = "multi_thread")]
async fn killed_at_every_fiftieth_cycle() {
    let _alone = alone().await;
    let last = 1200;
    let kills: Vec<u64> = (50..=last).step_by(50).collect();
    for kills in kills.chunks(AT_A_TIME as usize) {
        let mut runs = JoinSet::new();
        for kill in kills {
            runs.spawn(killed_at(*kill));
        }
        while let Some(run) = runs.join_next().await {
            run.unwrap();
        }
    }
}

async fn killed_at(kill: u64) {
    let plan = planned(move_of(0.3, 0.25));
    // The lead is sent ahead, and this process looks on up to 50 ms late.
    let behind = kill + 400;
    let first = if behind + 150 < 1400 { behind } else { 350 };
    let steps = [
        (150, "slower", Ask::Override(0.7)),
        (first, "faster", Ask::Override(0.9)),
        (first + 150, "farther", goal(0.35)),
    ];
    let done: Vec<_> = steps
        .iter()
        .map(|(cycle, id, ask)| (*cycle, at(*cycle, id, ask.clone()).planned().unwrap()))
        .collect();
    let operations = steps.into_iter().map(|(cycle, id, ask)| at(cycle, id, ask)).collect();

    let (mut first, second) = (Replica::start("first").await, Replica::start("second").await);
    let endpoints = [first.endpoint(), second.endpoint()];
    let (mut run, answers) = Run::with(request("cell-7/x", &endpoints, &plan, LEAD), operations).await;
    assert_eq!(run.served_by(), "first");
    run.until(kill).await;
    first.kill();
    let played = run.finish().await;
    // On a machine that stalls a splice comes too late for its cycle, and is planned again for a later one.
    let mut late = done;
    for (answered, (cycle, _)) in answers.into_iter().zip(&mut late) {
        let effective = answer(answered).await.unwrap().effective_cycle;
        assert!(effective >= *cycle, "killed at {kill}: {effective} is before {cycle}");
        *cycle = effective;
    }
    let done = late;
    played.is_undisturbed(&plan, &done);
    let [change] = &played.seen.changes[..] else { panic!("killed at {kill}: {:?}", played.seen.changes) };
    assert_eq!((change.cause, change.to.as_str()), (Cause::Lost, "second"));
    assert_eq!(played.report.stream.revisions, 3);
}

/// The axis was told of a revision and never got a cycle of it: it does not count, and who asked for it is answered by the next.
#[tokio::test(flavor = "multi_thread")]
async fn dies_between_a_revision_and_its_first_batch() {
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let second = Replica::start("second").await;
    let endpoints = [lie(Lie::DiesOnceRevised).await, second.endpoint()];
    let slower = at(300, "slower", Ask::Override(0.5));
    let (run, answers) = Run::with(request("cell-7/x", &endpoints, &plan, LEAD), vec![slower.clone()]).await;
    let played = run.finish().await;
    for answered in answers {
        let result = answer(answered).await.unwrap();
        assert!(result.effective_cycle >= 300);
        played.is_undisturbed(&plan, &[(result.effective_cycle, slower.planned().unwrap())]);
    }
    assert_eq!((played.failovers(), played.report.stream.revisions), (1, 1));
}

/// Asked for while nobody serves: whoever goes on does it.
#[tokio::test(flavor = "multi_thread")]
async fn is_slowed_while_another_is_looked_for() {
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let (mut first, second) = (Replica::start("first").await, Replica::start("second").await);
    let endpoints = [first.endpoint(), second.endpoint()];
    let mut run = Run::begin(request("cell-7/x", &endpoints, &plan, LEAD)).await;
    run.until(300).await;
    // It neither answers nor closes its connections until it is killed: the operation is on its way to it, and lost.
    first.signal("STOP");
    let slower = Operation::now("slower", Ask::Override(0.5));
    let commander = run.commander();
    let asked = tokio::spawn({
        let slower = slower.clone();
        async move { commander.operate(slower).await }
    });
    run.until_cycles_more(20).await;
    first.kill();
    let played = run.finish().await;
    let result = asked.await.unwrap().unwrap();
    played.is_undisturbed(&plan, &[(result.effective_cycle, slower.planned().unwrap())]);
    assert_eq!((played.failovers(), played.report.stream.revisions), (1, 1));
}

/// All of three, one after the other, each while it serves; and each comes back.
#[tokio::test(flavor = "multi_thread")]
async fn dies_again_and_again() {
    let _alone = alone().await;
    let plan = planned(move_of(0.5, 0.25));
    let names = ["first", "second", "third"];
    let mut replicas = Vec::new();
    for name in names {
        replicas.push(Replica::start(name).await);
    }
    let endpoints: Vec<String> = replicas.iter().map(Replica::endpoint).collect();
    let mut run = Run::begin(request("cell-7/x", &endpoints, &plan, LEAD)).await;
    for turn in 0..6 {
        run.until(200 + 250 * turn).await;
        let index = turn as usize % 3;
        let address = replicas[index].address();
        replicas[index].kill();
        run.until_changes(turn as usize + 1).await;
        replicas[index] = Replica::with(names[index], address, &[]).await;
    }
    let played = run.finish().await;
    played.is_undisturbed(&plan, &[]);
    assert_eq!(played.failovers(), 6);
    let went_on: Vec<&str> = played.seen.changes.iter().map(|change| change.to.as_str()).collect();
    assert_eq!(went_on, ["second", "third", "first", "second", "third", "first"]);
}
