//! What does a command of position, velocity and time cost, and what do ten thousand points of six axes?
//!
//! ```text
//! cargo bench -p portamento-planner --bench pvt
//! ```
//! The paper (doi:10.1177/17298814211072418) measures 1.562 µs on average and 10.523 µs at worst for a command.

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
use common::commands::{BEAT, tracked};
use criterion::{BatchSize, Criterion, criterion_group, criterion_main};
use planner::{
    AxisKind, Judged, Limits, LimitsSpec, PvtAxisSpec, PvtInterpolation, PvtPlanner, PvtPolicy, PvtRequest,
    PvtRequestSpec, PvtTarget, State, certify, plan_pvt,
};

const COMMANDS: usize = 4096;
/// Calls before the measured ones, so that code and data are there.
const WARM: usize = 2;

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 0.5, max_acceleration: 5.0, max_jerk: 200.0, ..LimitsSpec::default() }
}

fn commands(criterion: &mut Criterion) {
    let tracked = tracked(&mut Random(17), COMMANDS);
    let start = State::at_rest(0.0);
    let limits: Limits = limits().try_into().unwrap();
    for (name, policy) in [
        ("prefer_velocity", PvtPolicy::PreferVelocity),
        ("prefer_position", PvtPolicy::PreferPosition),
        ("extend_time", PvtPolicy::ExtendTime),
    ] {
        let planner = PvtPlanner::new(start, limits.clone(), policy).unwrap();
        let (mut axis, mut cycle) = (planner.clone(), tracked.iter().cycle());
        criterion.bench_function(&format!("pvt/command/{name}"), |bencher| {
            bencher.iter(|| {
                let &(position, velocity) = cycle.next().unwrap();
                black_box(&axis.command(black_box(PvtTarget { position, velocity, duration: BEAT }))).is_ok()
            });
        });
        print_tail(name, &planner, &tracked);
    }
}

/// The distribution over all single commands of all runs, clock and whatever interrupts it included; and beside it the worst command in the
/// best of its runs, since what interrupts one run does not interrupt the same command in all of them.
fn print_tail(name: &str, planner: &PvtPlanner, tracked: &[(f64, f64)]) {
    const RUNS: usize = 100;
    let mut all = Vec::with_capacity(RUNS * tracked.len());
    let mut least = vec![u32::MAX; tracked.len()];
    let mut adjusted = 0;
    for run in 0..WARM + RUNS {
        let mut axis = planner.clone();
        adjusted = 0;
        for (least, &(position, velocity)) in least.iter_mut().zip(tracked) {
            let target = black_box(PvtTarget { position, velocity, duration: BEAT });
            let begin = Instant::now();
            let planned = axis.command(target);
            black_box(&planned);
            let took = u32::try_from(begin.elapsed().as_nanos()).unwrap_or(u32::MAX);
            adjusted += usize::from(!planned.unwrap().motion().adjustments().is_empty());
            if run >= WARM {
                all.push(took);
                *least = (*least).min(took);
            }
        }
    }
    all.sort_unstable();
    let mean = all.iter().map(|took| u64::from(*took)).sum::<u64>() as f64 / all.len() as f64;
    let (tail, worst) = (all[all.len() * 999 / 1000], all[all.len() - 1]);
    let quiet = least.iter().max().copied().unwrap_or_default();
    let clock = (0..1000).map(|_| Instant::now().elapsed().as_nanos()).min().unwrap_or_default();
    println!(
        "{name}: mean {mean:.0} ns, p99.9 {tail} ns, worst {worst} ns of {} commands in {RUNS} runs, with the clock, which alone takes \
         {clock} ns; the worst in the best of its runs {quiet} ns; {adjusted} of {} adjusted",
        all.len(),
        tracked.len()
    );
}

fn sequences(criterion: &mut Criterion) {
    let mut random = Random(19);
    let axes = (0..6)
        .map(|index| {
            let points = tracked(&mut random, 10_000);
            PvtAxisSpec {
                axis: format!("axis {index}"),
                kind: Ok(AxisKind::Prismatic),
                limits: limits(),
                start: State::at_rest(0.0),
                times: (1..=10_000).map(|n| f64::from(n) * BEAT).collect(),
                positions: points.iter().map(|point| point.0).collect(),
                velocities: points.iter().map(|point| point.1).collect(),
            }
        })
        .collect();
    let spec = PvtRequestSpec {
        axes,
        cycle_time_ns: None,
        interpolation: Ok(PvtInterpolation::SShaped),
        policy: Ok(PvtPolicy::PreferVelocity),
        finish_unreached: false,
    };
    let request = PvtRequest::try_from(spec.clone()).unwrap();
    let planned = plan_pvt(&request).unwrap();
    assert!(certify(planned.plan()).passed());
    let segments: usize = planned.plan().axes().iter().map(|axis| axis.profile.segments().len()).sum();
    println!("10 000 points of 6 axes: {segments} pieces");
    let mut group = criterion.benchmark_group("pvt/10000_points_of_6_axes");
    group.sample_size(10);
    group.bench_function("check", |bencher| {
        bencher.iter_batched(
            || spec.clone(),
            |spec| PvtRequest::try_from(spec).is_ok(),
            BatchSize::LargeInput,
        );
    });
    group.bench_function("plan", |bencher| bencher.iter(|| plan_pvt(black_box(&request)).is_ok()));
    group.bench_function("verify", |bencher| bencher.iter(|| certify(black_box(planned.plan())).passed()));
    group.bench_function("verify and explain", |bencher| {
        bencher.iter_batched(|| planned.plan().clone(), Judged::new, BatchSize::LargeInput);
    });
    group.finish();
}

criterion_group!(benches, commands, sequences);
criterion_main!(benches);
