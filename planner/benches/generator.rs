//! What does one cycle of a control loop cost, and a new target?
//!
//! ```text
//! cargo bench -p portamento-planner --bench generator
//! ```

#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "criterion's macros write functions without documentation; a bench may fail by panicking"
)]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use planner::CycleTime;
use planner::generator::{AxisLimits, Generator, Real};

/// 50 mm, seven pieces, 314 cycles; and long enough that no step of the bench finds it done.
fn generator<F: Real>(limits: AxisLimits<F>) -> Generator<F> {
    Generator::new(limits, CycleTime::MILLISECOND).unwrap()
}

fn steps<F: Real>(criterion: &mut Criterion, width: &str, limits: AxisLimits<F>, targets: [F; 2]) {
    let mut group = criterion.benchmark_group("generator");
    let mut running = generator(limits);
    let mut turn = 0_usize;
    // A new target every 314 steps is part of what is measured.
    group.bench_function(format!("step/{width}"), |bencher| {
        bencher.iter(|| {
            if running.is_done() {
                running.set_target(targets[turn % 2]).unwrap();
                turn += 1;
            }
            black_box(&mut running).step()
        });
    });
    // In mid-cruise, and called back.
    let mut moving = generator(limits);
    moving.set_target(targets[0]).unwrap();
    for _ in 0..150 {
        moving.step();
    }
    group.bench_function(format!("set_target/{width}, from motion"), |bencher| {
        bencher.iter_batched_ref(
            || moving.clone(),
            |moving| moving.set_target(black_box(targets[1])),
            criterion::BatchSize::SmallInput,
        );
    });
    let resting = generator(limits);
    group.bench_function(format!("set_target/{width}"), |bencher| {
        bencher.iter_batched_ref(
            || resting.clone(),
            |resting| resting.set_target(black_box(targets[0])),
            criterion::BatchSize::SmallInput,
        );
    });
    group.bench_function(format!("set_target/{width}, on whole cycles"), |bencher| {
        bencher.iter_batched_ref(
            || resting.clone().on_whole_cycles(),
            |resting| resting.set_target(black_box(targets[0])),
            criterion::BatchSize::SmallInput,
        );
    });
    group.finish();
}

fn both(criterion: &mut Criterion) {
    steps(criterion, "f64", AxisLimits { velocity: 0.25_f64, acceleration: 3.0, jerk: 100.0 }, [0.05, 0.0]);
    steps(criterion, "f32", AxisLimits { velocity: 0.25_f32, acceleration: 3.0, jerk: 100.0 }, [0.05, 0.0]);
}

criterion_group!(benches, both);
criterion_main!(benches);
