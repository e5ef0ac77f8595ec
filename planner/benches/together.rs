//! What do several axes at one time cost, beside the peer?
//!
//! ```text
//! cargo bench -p portamento-planner --bench together
//! ```
//! One iteration plans all axes of one problem, drawn as those of order one in the tests, which the peer solves too; each side gets its
//! inputs ready made.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "criterion's macros write functions without documentation; a bench may fail by panicking and print"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::time::Instant;

use common::Random;
use common::axes::{Fixed, Peer, input};
use common::states::{Kind, Question, question};
use criterion::{Criterion, criterion_group, criterion_main};
use planner::{AxisTransfer, Synchronization, Timing, Transit, together};
use rsruckig::prelude::InputParameter;

/// How many problems are planned in turn.
const PROBLEMS: usize = 1000;

fn plan(axes: &[AxisTransfer<'_>], transits: &mut Vec<Transit>) -> f64 {
    together(axes, Synchronization::Time, Timing::default(), transits).unwrap().duration
}

fn compare<const AXES: usize>(criterion: &mut Criterion) {
    let (mut random, mut peer) = (Random(1), Peer::new());
    let mut problems: Vec<Vec<Question>> = Vec::new();
    while problems.len() < PROBLEMS {
        let asked: Vec<Question> = (0..AXES).map(|_| question(&mut random, Kind::Ordinary)).collect();
        if peer.duration(&asked).is_some() {
            problems.push(asked);
        }
    }
    let ours: Vec<Vec<AxisTransfer<'_>>> = problems
        .iter()
        .map(|asked| asked.iter().map(|asked| AxisTransfer::from(asked.transfer())).collect())
        .collect();
    let theirs: Vec<InputParameter<AXES>> = problems.iter().map(|asked| input(asked)).collect();
    let (mut transits, mut peer) = (Vec::with_capacity(AXES), Fixed::<AXES>::new());

    let name = format!("together/{AXES}");
    let mut group = criterion.benchmark_group(&name);
    let mut cycle = ours.iter().cycle();
    group.bench_function("ours", |bencher| {
        bencher.iter(|| plan(black_box(cycle.next().unwrap()), &mut transits));
    });
    let mut cycle = theirs.iter().cycle();
    group.bench_function("rsruckig", |bencher| {
        bencher.iter(|| peer.duration(black_box(cycle.next().unwrap())));
    });
    group.finish();

    // The ratio of both, from the best of rounds by turns: other work on the machine slows down some, not all.
    let mut best = [f64::INFINITY; 2];
    for _ in 0..40 {
        let ours = timed(|| {
            ours.iter().for_each(|axes| {
                black_box(plan(black_box(axes), &mut transits));
            });
        });
        let theirs = timed(|| {
            theirs.iter().for_each(|input| {
                black_box(peer.duration(black_box(input)));
            });
        });
        best = [best[0].min(ours), best[1].min(theirs)];
    }
    let [mean, other] = best.map(|seconds| seconds * 1e9 / PROBLEMS as f64);
    // Each problem's best, so that what is left of the tail is its own.
    let mut each: Vec<f64> = ours
        .iter()
        .map(|axes| {
            let mut once = || {
                timed(|| {
                    black_box(plan(black_box(axes), &mut transits));
                })
            };
            (0..30).map(|_| once()).fold(f64::INFINITY, f64::min) * 1e9
        })
        .collect();
    each.sort_by(f64::total_cmp);
    let at = |part: f64| each[((each.len() - 1) as f64 * part) as usize];
    println!(
        "{name}: {mean:.0} ns, the peer {other:.0} ns: 1/{:.2}; p99 {:.0}, p99.9 {:.0}, worst {:.0} ns",
        other / mean,
        at(0.99),
        at(0.999),
        at(1.0)
    );
}

fn timed(work: impl FnOnce()) -> f64 {
    let begin = Instant::now();
    work();
    begin.elapsed().as_secs_f64()
}

fn axes(criterion: &mut Criterion) {
    compare::<3>(criterion);
    compare::<6>(criterion);
}

criterion_group!(benches, axes);
criterion_main!(benches);
