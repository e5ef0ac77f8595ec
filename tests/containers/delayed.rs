//! An axis whose line to its planner is slow and uneven, and stalls.

use std::time::{Duration, Instant};

use e2e::fifty_millimetres;

use crate::cell::{Cell, undisturbed};
use crate::engine::{self, Container};

/// 5 ms and 3 ms more or less in each direction, and twice a second nothing comes through for 30 ms.
#[tokio::test(flavor = "multi_thread")]
async fn a_line_that_delays_and_stalls() {
    if !engine::is_there() {
        return;
    }
    engine::images();
    let cell = Cell::new("delayed");
    let planner = cell.planner_called("planner-1", "behind-the-line");
    let how = ["--least=2", "--most=8", "--stall-every=500", "--stall=30"];
    let line = Container::line(&cell.network, "planner-1", 50051, "behind-the-line:50051", &how);
    let axis = cell.axis();
    // It does delay, what is said to the planner and what it answers.
    let controller = cell.controller("planner-1").to(&line.secure_endpoint()).await.unwrap();
    let asked = Instant::now();
    controller.plan(fifty_millimetres()).await.unwrap();
    assert!(asked.elapsed() >= Duration::from_millis(4), "{:?}", asked.elapsed());

    let run = cell.begin(&axis, &["planner-1"], 1.0).await;
    let report = undisturbed(run, 1.0).await;
    assert_eq!(report.stream.failovers, 0, "{:?}", report.stream);
    // Of 250 cycles as many were played while nothing came.
    assert!(report.stream.counters.least_lead_cycles <= 220, "{:?}", report.stream);
    assert_eq!(planner.figure("motion_streams_opened_total").await, 1.0);
}
