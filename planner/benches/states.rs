//! What does a motion between any two states cost, beside the peer's?
//!
//! ```text
//! cargo bench -p portamento-planner --bench states
//! ```
//! One iteration plans one of the committed problems that the peer solves too; each side gets its inputs ready made.

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

use common::peer::{self, Peer};
use common::states::Question;
use common::vectors;
use criterion::{Criterion, criterion_group, criterion_main};
use planner::plan_transfer;

fn compare(criterion: &mut Criterion, name: &str, questions: &[Question]) {
    let ours: Vec<_> = questions.iter().map(Question::transfer).collect();
    let theirs: Vec<_> = questions.iter().map(peer::question).collect();
    let mut group = criterion.benchmark_group(name);
    let mut cycle = ours.iter().cycle();
    group.bench_function("ours", |bencher| {
        bencher.iter(|| black_box(&plan_transfer(black_box(cycle.next().unwrap()))).is_ok());
    });
    let (mut cycle, mut peer) = (theirs.iter().cycle(), Peer::new());
    group.bench_function("rsruckig", |bencher| {
        bencher.iter(|| peer.duration(black_box(cycle.next().unwrap())));
    });
    group.finish();

    // The ratio of both, from the best of rounds by turns: other work on the machine slows down some, not all.
    let mut best = [f64::INFINITY; 2];
    for _ in 0..100 {
        let ours = timed(|| {
            ours.iter().for_each(|transfer| {
                black_box(&plan_transfer(black_box(transfer)));
            })
        });
        let theirs = timed(|| {
            theirs.iter().for_each(|input| {
                black_box(peer.duration(black_box(input)));
            })
        });
        best = [best[0].min(ours), best[1].min(theirs)];
    }
    let [mean, other] = best.map(|seconds| seconds * 1e9 / questions.len() as f64);
    // Each problem's best, so that what is left of the tail is its own.
    let mut each: Vec<f64> = ours
        .iter()
        .map(|transfer| {
            let once = || {
                timed(|| {
                    (0..16).for_each(|_| {
                        black_box(&plan_transfer(black_box(transfer)));
                    })
                })
            };
            (0..20).map(|_| once()).fold(f64::INFINITY, f64::min) * 1e9 / 16.0
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

fn states(criterion: &mut Criterion) {
    let records = vectors::records();
    let of = |kind: Option<&str>| -> Vec<Question> {
        let solved = records.iter().filter(|record| record.result == 0);
        solved.filter(|record| kind.is_none_or(|kind| record.kind == kind)).map(Question::from).collect()
    };
    for kind in ["rest", "v0vf", "full", "asym_full", "retarget", "outside"] {
        compare(criterion, &format!("states/{kind}"), &of(Some(kind)));
    }
    compare(criterion, "states/all", &of(None));
}

criterion_group!(benches, states);
criterion_main!(benches);
