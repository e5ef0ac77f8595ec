//! What does a setpoint cost, beside the peer's?
//!
//! ```text
//! cargo bench -p portamento-planner --bench sample
//! ```

#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "criterion's macros write functions without documentation; a bench may fail by panicking"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::peer::{self, Peer};
use common::splices;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use planner::{Cursor, CycleTime, Limits, Problem, Profile, ShortPathPolicy, State, plan_move};
use rsruckig::prelude::{DataArrayOrVec, Trajectory};

const CYCLES: u64 = 1000;

/// A move of seven pieces that lasts 1.2 s, so that a thousand cycles of 1.2 ms see them all.
fn problem() -> Problem {
    let limits = Limits::symmetric(0.5, 2.0, 20.0).unwrap();
    Problem::new(State::at_rest(0.0), State::at_rest(0.425), limits, ShortPathPolicy::Reject).unwrap()
}

fn theirs(trajectory: &Trajectory<1>, time: f64) -> [f64; 4] {
    let mut parts = [0.0; 4].map(|zero| DataArrayOrVec::Stack([zero]));
    let [position, velocity, acceleration, jerk] = &mut parts;
    trajectory.at_time(
        time,
        &mut Some(position),
        &mut Some(velocity),
        &mut Some(acceleration),
        &mut Some(jerk),
        &mut None,
    );
    parts.map(|part| part[0])
}

fn assert_equal(profile: &Profile, trajectory: &Trajectory<1>, cycle: CycleTime) {
    for number in 0..CYCLES {
        let time = cycle.start_of(number);
        // Jerk may be that of either piece where two join.
        for (ours, theirs) in profile.at(time).words().into_iter().zip(theirs(trajectory, time)).take(3) {
            assert!((ours - theirs).abs() < 1e-9, "{ours} and {theirs} at {time}");
        }
    }
}

fn samples(criterion: &mut Criterion) {
    let (problem, cycle) = (problem(), CycleTime::from_ns(Some(1_200_000)).unwrap());
    let planned = plan_move(&problem).unwrap();
    let profile = planned.to_profile();
    let mut peer = Peer::new();
    peer.duration(&peer::input(&problem)).unwrap();
    let trajectory = peer.trajectory;
    assert_equal(&profile, &trajectory, cycle);

    let mut group = criterion.benchmark_group("sample/one_setpoint");
    let times: Vec<f64> = (0..CYCLES).map(|number| cycle.start_of(number * 619 % CYCLES)).collect();
    let mut at = times.iter().cycle();
    group.bench_function("ours", |bencher| {
        bencher.iter(|| profile.at(black_box(*at.next().unwrap())));
    });
    let mut at = times.iter().cycle();
    group.bench_function("ours, on the stack", |bencher| {
        bencher.iter(|| planned.at(black_box(*at.next().unwrap())));
    });
    let mut at = times.iter().cycle();
    group.bench_function("rsruckig", |bencher| {
        bencher.iter(|| theirs(&trajectory, black_box(*at.next().unwrap())));
    });
    group.finish();

    let mut group = criterion.benchmark_group("sample/1000_cycles");
    group.throughput(Throughput::Elements(CYCLES));
    let mut column = vec![[0.0; 4]; CYCLES as usize];
    group.bench_function("ours", |bencher| {
        bencher.iter(|| {
            let mut cursor = Cursor::new(black_box(&profile));
            for (number, row) in (0..).zip(&mut column) {
                *row = cursor.at(cycle.start_of(number)).words();
            }
            black_box(&column);
        });
    });
    let plan = splices::one_axis(&profile, problem.limits().clone(), cycle);
    group.bench_function("ours, in a row", |bencher| {
        bencher.iter(|| {
            let mut rows = column.iter_mut();
            black_box(&plan).sampler().columns(0, 0..CYCLES, |setpoint| {
                if let Some(row) = rows.next() {
                    *row = setpoint.words();
                }
            });
            black_box(&column);
        });
    });
    group.bench_function("rsruckig", |bencher| {
        bencher.iter(|| {
            let trajectory = black_box(&trajectory);
            for (number, row) in (0..).zip(&mut column) {
                *row = theirs(trajectory, cycle.start_of(number));
            }
            black_box(&column);
        });
    });
    group.finish();
}

criterion_group!(benches, samples);
criterion_main!(benches);
