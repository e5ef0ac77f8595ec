//! Servers and lines that say nothing, or say it late.

use std::time::Duration;

use client::failover::Cause;
use e2e::{Line, Proxy, move_of, planned};
use proto::stream::{Ask, Operation};

use crate::mute::mute;
use crate::replica::Replica;
use crate::run::{LEAD, Run, alone, answer, request};

fn ms(least: u64, most: u64) -> Line {
    Line::Delays(Duration::from_millis(least), Duration::from_millis(most))
}

/// Stopped for a second, and then it goes on as if nothing had been.
async fn stopped_for_a_second(lead: u32) {
    let plan = planned(move_of(0.5, 0.25));
    let (first, second) = (Replica::start("first").await, Replica::start("second").await);
    let endpoints = [first.endpoint(), second.endpoint()];
    let mut run = Run::begin(request("cell-7/x", &endpoints, &plan, lead)).await;
    run.until(300).await;
    first.signal("STOP");
    run.until_changes(1).await;
    let until = run_length(&run) + 1000;
    run.until(until).await;
    first.signal("CONT");
    let played = run.finish().await;
    played.is_undisturbed(&plan, &[]);
    let [change] = &played.seen.changes[..] else { panic!("{:?}", played.seen.changes) };
    assert_eq!((change.cause, change.to.as_str()), (Cause::Silent, "second"));
}

fn run_length(run: &Run) -> u64 {
    run.seen().setpoints.len() as u64
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_that_is_stopped_for_a_second() {
    let _alone = alone().await;
    stopped_for_a_second(LEAD).await;
}

/// The same with the usual lead, of which no other process may take more than half:
/// `cargo test -p e2e --test faults -- --ignored lead_of_forty`.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "needs a machine that has nothing else to do"]
async fn a_server_that_is_stopped_for_a_second_with_a_lead_of_forty() {
    let _alone = alone().await;
    stopped_for_a_second(40).await;
}

/// The next in the list takes the connection and never says a word: the one after it is asked in time.
#[tokio::test(flavor = "multi_thread")]
async fn the_next_server_never_answers() {
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let (mut first, third) = (Replica::start("first").await, Replica::start("third").await);
    let endpoints = [first.endpoint(), mute().await, third.endpoint()];
    let mut run = Run::begin(request("cell-7/x", &endpoints, &plan, LEAD)).await;
    run.until(300).await;
    first.kill();
    let played = run.finish().await;
    played.is_undisturbed(&plan, &[]);
    let [change] = &played.seen.changes[..] else { panic!("{:?}", played.seen.changes) };
    assert_eq!((change.cause, change.to.as_str()), (Cause::Lost, "third"));
}

/// The cable is pulled out: no end of the connection hears of it.
#[tokio::test(flavor = "multi_thread")]
async fn a_line_that_is_half_open() {
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let (first, second) = (Replica::start("first").await, Replica::start("second").await);
    let line = Proxy::before(first.address(), Line::THROUGH).await;
    let endpoints = [line.endpoint(), second.endpoint()];
    let mut run = Run::begin(request("cell-7/x", &endpoints, &plan, LEAD)).await;
    run.until(300).await;
    line.becomes(Line::Silent);
    run.until_changes(1).await;
    // What was said in the meantime arrives after all.
    line.becomes(Line::THROUGH);
    let played = run.finish().await;
    played.is_undisturbed(&plan, &[]);
    let [change] = &played.seen.changes[..] else { panic!("{:?}", played.seen.changes) };
    assert_eq!((change.cause, change.to.as_str()), (Cause::Silent, "second"));
}

/// Every message takes 3 to 15 ms, each way: the lead is enough, and nobody is asked to go on.
#[tokio::test(flavor = "multi_thread")]
async fn a_line_that_is_slow_and_uneven() {
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let (first, second) = (Replica::start("first").await, Replica::start("second").await);
    let line = Proxy::before(first.address(), ms(3, 15)).await;
    let endpoints = [line.endpoint(), second.endpoint()];
    let slower = Operation { not_before_cycle: Some(400), ..Operation::now("slower", Ask::Override(0.6)) };
    let (run, answers) = Run::with(request("cell-7/x", &endpoints, &plan, LEAD), vec![slower.clone()]).await;
    let played = run.finish().await;
    for answered in answers {
        let effective = answer(answered).await.unwrap().effective_cycle;
        played.is_undisturbed(&plan, &[(effective, slower.planned().unwrap())]);
    }
}

/// The line stalls for 160 ms of a lead of 250 while the only other server never answers: a false alarm. The server stays, and is
/// asked for operations afterwards.
#[tokio::test(flavor = "multi_thread")]
async fn a_false_alarm() {
    let _alone = alone().await;
    let plan = planned(move_of(0.7, 0.25));
    let first = Replica::start("first").await;
    let line = Proxy::before(first.address(), Line::THROUGH).await;
    let endpoints = [line.endpoint(), mute().await];
    let mut run = Run::begin(request("cell-7/x", &endpoints, &plan, LEAD)).await;
    run.until(200).await;
    for _ in 0..3 {
        line.becomes(Line::Silent);
        let stalled = tokio::time::timeout(Duration::from_millis(160), std::future::pending::<()>());
        let _ = stalled.await;
        line.becomes(Line::THROUGH);
        // Until the lead has long been full again: nobody has looked on while the line stalled.
        run.until(run_length(&run) + 560).await;
    }
    let slower = Operation::now("slower", Ask::Override(0.6));
    let planned = slower.planned().unwrap();
    let commander = run.commander();
    let (played, result) = tokio::join!(run.finish(), commander.operate(slower));
    played.is_undisturbed(&plan, &[(result.unwrap().effective_cycle, planned)]);
    assert!(played.seen.changes.iter().all(|change| change.to == "first"), "{:?}", played.seen.changes);
}
