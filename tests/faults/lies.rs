//! Servers that send what no axis may take: it refuses, says so, and moves over.

use client::failover::Cause;
use e2e::{move_of, planned};
use tokio::task::JoinSet;

use crate::liar::{Lie, lie};
use crate::replica::Replica;
use crate::run::{LEAD, Run, alone, request};

#[tokio::test(flavor = "multi_thread")]
async fn no_lie_reaches_the_servo() {
    let _alone = alone().await;
    let mut runs = JoinSet::new();
    let lies = [
        Lie::Gap,
        Lie::BeyondGrant,
        Lie::Jump,
        Lie::WrongDigest,
        Lie::NotFinite,
        Lie::NoTail,
        Lie::OtherTail,
        Lie::Bare,
    ];
    for lie in lies {
        runs.spawn(lied_to(lie));
    }
    while let Some(run) = runs.join_next().await {
        run.unwrap();
    }
}

async fn lied_to(kind: Lie) {
    let plan = planned(move_of(0.2, 0.25));
    let honest = Replica::start("honest").await;
    let endpoints = [lie(kind).await, honest.endpoint()];
    let run = Run::begin(request("cell-7/x", &endpoints, &plan, LEAD)).await;
    assert_eq!(run.served_by(), "liar");
    let played = run.finish().await;
    played.is_undisturbed(&plan, &[]);
    let [change] = &played.seen.changes[..] else { panic!("{kind:?}: {:?}", played.seen.changes) };
    assert_eq!((change.cause, change.to.as_str()), (Cause::Refused, "honest"), "{kind:?}");
    assert!(played.report.stream.counters.refused_batches >= 2, "{kind:?}: {:?}", played.report.stream);
}
