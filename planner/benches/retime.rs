//! What does a change of the rate cost: hold, override and resume, for one axis and for six, with the judge; and the judge alone,
//! on the plan that comes of it?
//!
//! ```text
//! cargo bench -p portamento-planner --bench retime
//! ```
//! One iteration is one splice of a seeded set that is cycled through: fifty plans, each at twenty instants.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "criterion's macros write functions without documentation; a bench may fail by panicking and print"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::time::Instant;

use common::Random;
use common::paths::{self, Kind};
use criterion::{Criterion, criterion_group, criterion_main};
use planner::{Plan, TimeLaw, certify, retime};

/// A plan, its time law, when it is spliced, and the factor to go to.
type Splice = (Plan, TimeLaw, f64, f64);

fn splices(kind: Kind, axes: usize, name: &str) -> Vec<Splice> {
    let mut random = Random(7);
    let mut splices = Vec::new();
    for _ in 0..50 {
        let base = paths::path(&mut random, kind, axes);
        for _ in 0..20 {
            let law = TimeLaw::of(&base);
            let at = base.duration() * random.unit();
            match name {
                "hold" => splices.push((base.clone(), law, at, 0.0)),
                "override" => splices.push((base.clone(), law, at, 0.6)),
                _ => {
                    let held = retime(&base, &law, at, 0.0).unwrap();
                    let rest = held.law().profile().duration();
                    splices.push((base.clone(), held.law().clone(), rest, 1.0));
                }
            }
        }
    }
    splices
}

fn retimes(criterion: &mut Criterion) {
    for (kind, axes) in [(Kind::Together, 1), (Kind::Together, 6), (Kind::Quintic, 6)] {
        let mut group = criterion.benchmark_group(format!("retime/{kind:?}/{axes}_axes"));
        for name in ["hold", "override", "resume"] {
            let splices = splices(kind, axes, name);
            let mut cycle = splices.iter().cycle();
            group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    let (base, law, at, factor) = cycle.next().unwrap();
                    retime(black_box(base), law, *at, *factor).is_ok()
                });
            });
            print_quantiles(&splices);
        }
        group.finish();
    }
}

/// Each splice at its best of three, as other work on the machine slows down some.
fn print_quantiles(splices: &[Splice]) {
    let best = |work: &mut dyn FnMut()| {
        let timed = |_| {
            let begin = Instant::now();
            work();
            begin.elapsed().as_secs_f64()
        };
        (0..3).map(timed).fold(f64::INFINITY, f64::min)
    };
    let (mut whole, mut judge) = (Vec::new(), Vec::new());
    for (base, law, at, factor) in splices {
        whole.push(best(&mut || drop(black_box(retime(base, law, *at, *factor)))));
        let retimed = retime(base, law, *at, *factor).unwrap();
        judge.push(best(&mut || drop(black_box(certify(retimed.plan().plan())))));
    }
    for (name, mut times) in [("whole", whole), ("the judge once", judge)] {
        times.sort_by(f64::total_cmp);
        let at = |part: f64| 1e6 * times[((times.len() - 1) as f64 * part) as usize];
        println!("{name}: median {:.1} µs, p90 {:.1} µs, p99 {:.1} µs", at(0.5), at(0.9), at(0.99));
    }
}

criterion_group!(benches, retimes);
criterion_main!(benches);
