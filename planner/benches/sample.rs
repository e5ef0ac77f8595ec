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

use common::axes::{self, Fixed};
use common::peer::{self, Peer};
use common::s_curve;
use common::splices;
use common::states::Question;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use planner::{Cursor, CycleTime, Limits, Problem, Profile, ShortPathPolicy, State, plan_move};
use rsruckig::prelude::{DataArrayOrVec, Synchronization, Trajectory};

const CYCLES: u64 = 1000;
const SIX: usize = 6;

/// A move of seven pieces that lasts 1.2 s, so that a thousand cycles of 1.2 ms see them all.
fn problem() -> Problem {
    let limits = Limits::symmetric(0.5, 2.0, 20.0).unwrap();
    Problem::new(State::at_rest(0.0), State::at_rest(0.425), limits, ShortPathPolicy::Reject).unwrap()
}

/// Position, velocity, acceleration and jerk of every axis.
type Parts<const AXES: usize> = [DataArrayOrVec<f64, AXES>; 4];

fn all<const AXES: usize>(trajectory: &Trajectory<AXES>, time: f64) -> Parts<AXES> {
    let mut parts = [0.0; 4].map(|zero| DataArrayOrVec::Stack([zero; AXES]));
    let [position, velocity, acceleration, jerk] = &mut parts;
    trajectory.at_time(
        time,
        &mut Some(position),
        &mut Some(velocity),
        &mut Some(acceleration),
        &mut Some(jerk),
        &mut None,
    );
    parts
}

fn theirs(trajectory: &Trajectory<1>, time: f64) -> [f64; 4] {
    all(trajectory, time).map(|part| part[0])
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
    // Four functions, each of which looks for its piece.
    let second = s_curve::functions(&s_curve::input(&problem).unwrap());
    for &time in &times {
        for (ours, theirs) in profile.at(time).words().into_iter().zip(&second).take(3) {
            assert!((ours - theirs(time)).abs() < 1e-9, "{ours} and {} at {time}", theirs(time));
        }
    }
    let mut at = times.iter().cycle();
    group.bench_function("s_curve", |bencher| {
        bencher.iter(|| {
            let time = black_box(*at.next().unwrap());
            second.each_ref().map(|part| part(time))
        });
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
    let mut columns = [(); 4].map(|()| vec![0.0; CYCLES as usize]);
    group.bench_function("ours, in columns", |bencher| {
        bencher.iter(|| {
            black_box(&plan).sampler().fill(0, 0, columns.each_mut().map(Vec::as_mut_slice));
            black_box(&columns);
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

/// As a batch is made: six axes, each at its own time, all cycles of the first, then all of the second …
fn six_axes(criterion: &mut Criterion) {
    let motion = splices::motions().into_iter().find(|(name, _)| *name == "6_axes").unwrap().1;
    let plan = motion.plan();
    let asked: Vec<Question> = (0..SIX).map(|axis| splices::whole(&motion, axis)).collect();
    let mut asked = axes::input::<SIX>(&asked);
    asked.synchronization = Synchronization::None;
    let mut peer = Fixed::<SIX>::new();
    peer.duration(&asked).unwrap();
    let trajectory = peer.trajectory;
    for number in 0..CYCLES {
        let time = plan.time_of(number);
        let theirs = all(&trajectory, time);
        for (axis, planned) in plan.axes().iter().enumerate() {
            let ours = planned.profile.at(time).words();
            for (ours, theirs) in ours.iter().zip(&theirs).take(3) {
                assert!((ours - theirs[axis]).abs() < 1e-9, "{ours} and {} at {time}", theirs[axis]);
            }
        }
    }

    let mut group = criterion.benchmark_group("sample/1000_cycles_of_6_axes");
    group.throughput(Throughput::Elements(CYCLES * SIX as u64));
    let mut columns = [(); 4].map(|()| vec![0.0; CYCLES as usize * SIX]);
    let cycles = |axis: usize| axis * CYCLES as usize..(axis + 1) * CYCLES as usize;
    let fill = |columns: &mut [Vec<f64>; 4]| {
        let mut sampler = black_box(plan).sampler();
        for axis in 0..SIX {
            sampler.fill(axis, 0, columns.each_mut().map(|column| &mut column[cycles(axis)]));
        }
    };
    fill(&mut columns);
    for (axis, planned) in plan.axes().iter().enumerate() {
        for (number, place) in (0..).zip(cycles(axis)) {
            let filled = columns.each_ref().map(|column| column[place]);
            let expected = planned.profile.at(plan.time_of(number)).words();
            assert_eq!(filled.map(f64::to_bits), expected.map(f64::to_bits), "{axis} at {number}");
        }
    }
    group.bench_function("ours, in columns", |bencher| {
        bencher.iter(|| {
            fill(&mut columns);
            black_box(&columns);
        });
    });
    // What no way of computing them gets below: the same bytes, written and not computed.
    group.bench_function("one number, written", |bencher| {
        bencher.iter(|| {
            for column in &mut columns {
                column.fill(black_box(1.0));
            }
            black_box(&columns);
        });
    });
    let times: Vec<f64> = (0..CYCLES).map(|number| plan.time_of(number)).collect();
    group.bench_function("rsruckig", |bencher| {
        bencher.iter(|| {
            for time in &times {
                black_box(all(black_box(&trajectory), *time));
            }
        });
    });
    group.finish();
}

criterion_group!(benches, samples, six_axes);
criterion_main!(benches);
