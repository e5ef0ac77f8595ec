//! Planners that die, vanish or are replaced under an axis that moves, with certificates on every connection.

use client::Error;
use e2e::fifty_millimetres;
use proto::Reason;

use crate::cell::{Cell, undisturbed};
use crate::engine;

#[tokio::test(flavor = "multi_thread")]
async fn the_serving_planner_is_killed() {
    if !engine::is_there() {
        return;
    }
    engine::images();
    let cell = Cell::new("killed");
    let (one, two, axis) = (cell.planner("planner-1"), cell.planner("planner-2"), cell.axis());
    // The controller plans; what is not its cell's is not its own.
    let controller = cell.controller("planner-1").to(&one.secure_endpoint()).await.unwrap();
    assert!(controller.plan(fifty_millimetres()).await.is_ok());
    let hold = proto::stream::Operation {
        request_id: "1".into(),
        not_before_cycle: None,
        ask: Some(proto::stream::Ask::Hold),
    };
    let answer = controller.control("cell-8/x", hold).await.map(|_| ());
    let Err(Error::Rejected(rejected)) = answer else { panic!("{answer:?}") };
    assert_eq!(rejected.reason, Reason::StreamNotAllowed);

    let run = cell.begin(&axis, &["planner-1", "planner-2"], 1.0).await;
    assert_eq!(one.figure("motion_streams ").await, 1.0);
    one.kill();
    let report = undisturbed(run, 1.0).await;
    assert!(report.stream.failovers >= 1, "{:?}", report.stream);
    assert_eq!(two.figure("motion_streams_opened_total").await, 1.0);
    assert!(axis.figure("motion_failovers_total").await >= 1.0);
    assert_eq!(axis.figure("motion_underruns_total").await, 0.0);
    for container in [&two, &axis] {
        assert_eq!(container.page("/healthz").await.0, 200);
        assert_eq!(container.page("/readyz").await, (200, "ready\n".into()));
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_serving_planner_is_cut_off() {
    if !engine::is_there() {
        return;
    }
    engine::images();
    let cell = Cell::new("cut-off");
    let (one, two, axis) = (cell.planner("planner-1"), cell.planner("planner-2"), cell.axis());
    let run = cell.begin(&axis, &["planner-1", "planner-2"], 1.0).await;
    one.disconnect(&cell.network);
    let report = undisturbed(run, 1.0).await;
    assert!(report.stream.failovers >= 1, "{:?}", report.stream);
    assert_eq!(two.figure("motion_streams_opened_total").await, 1.0);
}

/// Each planner in turn is told to stop, and comes back with a certificate of its own that was made since.
#[tokio::test(flavor = "multi_thread")]
async fn certificates_are_replaced_under_a_live_stream() {
    if !engine::is_there() {
        return;
    }
    engine::images();
    let cell = Cell::new("replaced");
    let names = ["planner-1", "planner-2"];
    let (one, two, axis) = (cell.planner(names[0]), cell.planner(names[1]), cell.axis());
    let run = cell.begin(&axis, &names, 6.0).await;
    let run = tokio::spawn(undisturbed(run, 6.0));
    assert_eq!(one.stop(), "0", "{}", one.logs());
    drop(one);
    let again = cell.planner(names[0]);
    assert_eq!(two.stop(), "0", "{}", two.logs());
    let report = run.await.unwrap();
    assert!(report.stream.failovers >= 2, "{:?}", report.stream);
    assert_eq!(again.figure("motion_streams_opened_total").await, 1.0);
    assert!(axis.figure("motion_failovers_total{cause=\"draining\"}").await >= 2.0);
}
