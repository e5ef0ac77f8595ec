//! What does it cost to write and to read a plan of six axes, and ten cycles of them as a stream carries them?
//!
//! ```text
//! cargo bench -p portamento-proto --bench wire
//! ```

#![allow(
    missing_docs,
    dead_code,
    clippy::unwrap_used,
    clippy::panic,
    reason = "criterion's macros write functions without documentation; a bench may fail by panicking, and takes what it needs"
)]

#[path = "../../planner/tests/common/motions.rs"]
mod motions;
#[path = "../../planner/tests/common/paths.rs"]
mod paths;
#[path = "../../planner/tests/common/random.rs"]
mod random;
#[path = "../../planner/tests/common/splices.rs"]
mod splices;
#[path = "../../planner/tests/common/states.rs"]
mod states;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use planner::motion::Motion;
use planner::{Judged, Plan};
use prost::Message as _;
use prost::bytes::Bytes;
use proto::stream::{Batch, Columns, Tails, ToAxis};
use proto::{Digest, pb};

const BATCH: u64 = 10;

fn six_axes() -> Motion {
    splices::motions().into_iter().find(|(name, _)| *name == "6_axes").unwrap().1
}

fn plan_bytes(judged: &Judged) -> Bytes {
    proto::encode_plan(judged)
}

fn plan_of(bytes: &[u8]) -> Plan {
    proto::plan_from_wire(pb::Plan::decode(bytes).unwrap()).unwrap()
}

fn plan(criterion: &mut Criterion) {
    let judged = Judged::new(six_axes().plan().clone());
    let bytes = plan_bytes(&judged);
    assert_eq!(plan_of(&bytes), *judged.plan());
    let mut group = criterion.benchmark_group("wire/plan_of_6_axes");
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    group.bench_function("encode", |bencher| bencher.iter(|| plan_bytes(black_box(&judged))));
    group.bench_function("decode", |bencher| bencher.iter(|| plan_of(black_box(&bytes))));
    group.finish();
}

fn batch_bytes(batch: &Batch) -> Vec<u8> {
    proto::response_to_wire(1, ToAxis::Batch(batch.clone())).encode_to_vec()
}

fn batch_of(bytes: &[u8]) -> Batch {
    let wire = pb::StreamSetpointsResponse::decode(bytes).unwrap();
    let (_, ToAxis::Batch(batch)) = proto::response_from_wire(wire).unwrap() else { panic!("not a batch") };
    batch
}

/// With the way to rest from its last cycle.
fn batch(criterion: &mut Criterion) {
    let motion = six_axes();
    let cycles = splices::AT..splices::AT + BATCH;
    let columns = Columns::of_plan(motion.plan(), cycles.clone());
    let digest = columns.digests(cycles.start, Digest::ZERO).last().unwrap();
    let tail = motion.tail(cycles.end - 1).unwrap().unwrap();
    let tails = Tails::new(tail.motion.plan().axes().iter().map(|axis| axis.profile.clone()));
    let batch = Batch {
        first_cycle: cycles.start,
        revision: 1,
        replaces: false,
        last: false,
        columns,
        digest,
        tails,
    };
    let bytes = batch_bytes(&batch);
    assert_eq!(batch_of(&bytes), batch);
    let mut group = criterion.benchmark_group("wire/batch_of_10_cycles_of_6_axes");
    group.throughput(Throughput::Bytes(bytes.len() as u64));
    group.bench_function("encode", |bencher| bencher.iter(|| batch_bytes(black_box(&batch))));
    group.bench_function("decode", |bencher| bencher.iter(|| batch_of(black_box(&bytes))));
    group.finish();
}

criterion_group!(benches, plan, batch);
criterion_main!(benches);
