//! What does an operation on a motion under way cost, planned and judged?
//!
//! ```text
//! cargo bench -p portamento-planner --bench splice
//! ```
//! One iteration is one splice: of one axis, of six that go their own ways, of six on a straight line, and of six that arrive together,
//! which are re-timed on their path. Beside it what the peer
//! takes to plan six axes from the same states, without a judge, and our own judge alone.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    reason = "criterion's macros write functions without documentation; a bench may fail by panicking"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::peer::{self, Peer};
use common::splices::{self, AT};
use criterion::{Criterion, criterion_group, criterion_main};
use planner::certify;

fn splice(criterion: &mut Criterion) {
    for (name, motion) in splices::motions() {
        let mut group = criterion.benchmark_group(format!("splice/{name}"));
        for (operation_name, motion, operation) in splices::operations(&motion) {
            group.bench_function(operation_name, |bencher| {
                bencher.iter(|| black_box(&motion).splice(AT + 1, black_box(&operation)).unwrap());
            });
        }
        group.bench_function("judge_alone", |bencher| bencher.iter(|| certify(black_box(motion.plan()))));
        if name == "6_axes" {
            let questions: Vec<_> = (0..motion.plan().axes().len())
                .map(|axis| peer::question(&splices::question(&motion, axis)))
                .collect();
            let mut peer = Peer::new();
            group.bench_function("rsruckig_without_a_judge", |bencher| {
                bencher.iter(|| {
                    questions
                        .iter()
                        .map(|question| peer.duration(black_box(question)).unwrap_or_default())
                        .sum::<f64>()
                });
            });
        }
        group.finish();
    }
}

criterion_group!(benches, splice);
criterion_main!(benches);
