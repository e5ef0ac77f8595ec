//! What does a server do for ten thousand points of six axes, from the bytes of the request to those of the answer?
//!
//! ```text
//! cargo bench -p portamento-proto --bench pvt
//! ```

#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "criterion's macros write functions without documentation; a bench may fail by panicking and print"
)]

use std::hint::black_box;
use std::time::Instant;

use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use planner::{Alone, JudgedPvt, PvtRequest, PvtRequestSpec, Workers};
use prost::Message as _;
use proto::{Threads, encode_pvt, pb};

const POINTS: usize = 10_000;
const BEAT: f64 = 0.05;
const ROUNDS: usize = 30;

/// A target that swings, seen twenty times a second, now and then wrongly.
fn axis(index: usize) -> pb::PvtAxis {
    let angle = |n: usize| 2.0 * n as f64 * BEAT + index as f64;
    let all = |of: &dyn Fn(usize) -> f64| (1..=POINTS).map(of).collect();
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
        times: all(&|n| n as f64 * BEAT),
        positions: all(&|n| {
            0.1 * (angle(n).sin() - angle(0).sin()) + if n.is_multiple_of(17) { 3e-3 } else { 0.0 }
        }),
        velocities: all(&|n| 0.2 * angle(n).cos()),
    }
}

fn answer(bytes: &[u8], workers: &impl Workers) -> Vec<u8> {
    let wire = pb::PlanPvtRequest::decode(bytes).unwrap();
    let request = PvtRequest::try_from(PvtRequestSpec::from(wire)).unwrap();
    encode_pvt(&JudgedPvt::answer_by(&request, workers).unwrap(), workers).encode_to_vec()
}

/// The shortest of thirty rounds [ms]: other work on the machine slows down some, not all; and their mean processor time.
fn print_best<T>(name: &str, mut round: impl FnMut() -> T) {
    let timed = |_| {
        let begin = Instant::now();
        let made = round();
        let seconds = begin.elapsed().as_secs_f64();
        drop(black_box(made));
        seconds
    };
    let before = processor_time();
    let best = (0..ROUNDS).map(timed).fold(f64::INFINITY, f64::min);
    let processors = before.zip(processor_time()).map(|(before, after)| (after - before) / ROUNDS as f64);
    let processors =
        processors.map(|mean| format!(", {mean:.1} ms of processor time each")).unwrap_or_default();
    println!("{name}: {:.1} ms at best{processors}", best * 1e3);
}

/// What all threads of this process have taken of the processors so far, for itself and for the system [ms], where Linux tells it:
/// it hardly depends on what else the machine does.
fn processor_time() -> Option<f64> {
    /// Of the counts in `stat`; the same on every platform of Linux.
    const TICK: f64 = 10.0;
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The name of the program may hold blanks; after it `utime` and `stime` are the twelfth and the thirteenth.
    let after_name = stat.rsplit_once(')')?.1;
    let ticks = after_name.split_whitespace().skip(11).take(2).map(str::parse::<f64>);
    Some(TICK * ticks.sum::<Result<f64, _>>().ok()?)
}

fn largest(criterion: &mut Criterion) {
    let wire = pb::PlanPvtRequest { axes: (0..6).map(axis).collect(), ..Default::default() };
    let bytes = wire.encode_to_vec();
    let request = PvtRequest::try_from(PvtRequestSpec::from(wire)).unwrap();
    let judged = JudgedPvt::answer(&request).unwrap();
    assert!(judged.judged().certificate().passed());
    let response = encode_pvt(&judged, &Alone);
    let segments: usize =
        judged.judged().plan().axes().iter().map(|axis| axis.profile.segments().len()).sum();
    let adjusted = judged.points().iter().filter(|report| !report.adjustments.is_empty()).count();
    println!(
        "{segments} pieces, {adjusted} of {} points adjusted; request of {} bytes, answer of {}",
        judged.points().len(),
        bytes.len(),
        response.encoded_len()
    );
    let mut group = criterion.benchmark_group("pvt/10000_points_of_6_axes");
    group.sample_size(10);
    group.bench_function("read", |bencher| {
        bencher.iter_batched(
            || bytes.clone(),
            |bytes| {
                let wire = pb::PlanPvtRequest::decode(bytes.as_slice()).unwrap();
                PvtRequest::try_from(PvtRequestSpec::from(wire)).is_ok()
            },
            BatchSize::LargeInput,
        );
    });
    group.bench_function("plan and judge", |bencher| {
        bencher.iter(|| JudgedPvt::answer(black_box(&request)).is_ok());
    });
    group.bench_function("to bytes", |bencher| bencher.iter(|| encode_pvt(black_box(&judged), &Alone)));
    group.bench_function("all of it", |bencher| bencher.iter(|| answer(black_box(&bytes), &Alone).len()));
    let threads = Threads::of_machine(4);
    group.bench_function("all of it, threads", |bencher| {
        bencher.iter(|| answer(black_box(&bytes), &threads).len());
    });
    group.finish();
    assert_eq!(answer(&bytes, &Alone), answer(&bytes, &threads));
    print_best("plan and judge", || JudgedPvt::answer(black_box(&request)));
    print_best("to bytes", || encode_pvt(black_box(&judged), &Alone));
    print_best("all of it", || answer(black_box(&bytes), &Alone));
    print_best("plan and judge, threads", || JudgedPvt::answer_by(black_box(&request), &threads));
    print_best("to bytes, threads", || encode_pvt(black_box(&judged), &threads));
    print_best("all of it, threads", || answer(black_box(&bytes), &threads));
}

criterion_group!(benches, largest);
criterion_main!(benches);
