//! Threads share work, and what comes out is what one of them alone makes of it.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use planner::{JudgedPvt, PvtRequest, PvtRequestSpec, Workers};
use prost::Message as _;
use proto::{Threads, encode_pvt, fingerprint, pb, pvt_to_wire};

#[test]
fn threads_take_every_item_once_and_in_order() {
    for threads in 0..=9 {
        for count in [0, 1, 2, 7, 8, 9, 1000] {
            let parts = Threads::new(threads).each_range(count, |range| range);
            assert_eq!(parts.len(), threads.min(count).max(1));
            assert_eq!(parts.into_iter().flatten().collect::<Vec<_>>(), (0..count).collect::<Vec<_>>());
        }
    }
}

#[test]
fn the_machine_lends_one_thread_at_least() {
    assert_eq!(Threads::of_machine(0), Threads::new(1));
    assert_eq!(Threads::of_machine(1), Threads::new(1));
}

/// Points of an axis that swings.
fn axis(index: usize) -> pb::PvtAxis {
    let angle = |n: usize| 0.1 * n as f64 + index as f64;
    let all = |of: &dyn Fn(usize) -> f64| (1..=90).map(of).collect();
    pb::PvtAxis {
        axis: format!("axis {index}"),
        kind: pb::AxisKind::Prismatic as i32,
        limits: Some(pb::AxisLimits {
            max_velocity: 0.5,
            max_acceleration: 4.0,
            max_jerk: 160.0,
            ..Default::default()
        }),
        start: Some(pb::AxisState { velocity: 0.2 * angle(0).cos(), ..Default::default() }),
        times: all(&|n| 0.05 * n as f64),
        positions: all(&|n| 0.1 * (angle(n).sin() - angle(0).sin()) + if n % 7 == 0 { 3e-3 } else { 0.0 }),
        velocities: all(&|n| 0.2 * angle(n).cos()),
    }
}

#[test]
fn an_answer_has_the_same_bytes_from_any_number_of_threads() {
    let wire = pb::PlanPvtRequest { axes: (0..5).map(axis).collect(), ..Default::default() };
    let request = PvtRequest::try_from(PvtRequestSpec::from(wire)).unwrap();
    let judged = JudgedPvt::answer(&request).unwrap();
    let alone = pvt_to_wire(&judged);
    assert_eq!(alone.points.len(), 450);
    for threads in [1, 2, 3, 4, 5, 8] {
        let threads = Threads::new(threads);
        let answer = encode_pvt(&JudgedPvt::answer_by(&request, &threads).unwrap(), &threads);
        // What is written is what generated code makes of what is read.
        assert_eq!(answer.encode_to_vec(), alone.encode_to_vec(), "{threads:?}");
    }
    let plan = alone.plan.unwrap();
    assert_eq!(plan.fingerprint, fingerprint(&plan));
}
