//! What does a plan cost, beside the peers'?
//!
//! ```text
//! cargo bench -p portamento-planner --bench plan
//! ```
//! One iteration plans one problem of a seeded set that is cycled through; each side gets its inputs ready made.

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
use common::moves::{self, Draw};
use common::peer::{self, Peer};
use common::s_curve;
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, criterion_group, criterion_main};
use planner::{
    AxisKind, AxisMoveSpec, Family, LimitsSpec, Problem, Request, RequestSpec, ShortPathPolicy, State,
    Synchronization, certify, plan, plan_move, plan_polynomial, plan_trigonometric, violations,
};
use rsruckig::prelude::InputParameter;

const PROBLEMS: usize = 4096;

/// Problems that both can do, with the same answer.
fn problems(rest_to_rest: bool, asymmetric: bool) -> Vec<Problem> {
    let draw = Draw { rest_to_rest, asymmetric, wide: false };
    let (mut random, mut peer) = (Random(3), Peer::new());
    let mut problems = Vec::with_capacity(PROBLEMS);
    while problems.len() < PROBLEMS {
        let problem = moves::problem(&mut random, draw);
        let ours = plan_move(&problem).unwrap();
        assert_eq!(violations(&ours.to_profile(), problem.limits(), problem.goal()), []);
        if let Some(theirs) = peer.duration(&peer::input(&problem)) {
            assert!((ours.duration() - theirs).abs() <= 1e-9 * theirs, "{ours:?}: theirs {theirs}");
            problems.push(problem);
        }
    }
    problems
}

fn compare(criterion: &mut Criterion, name: &str, problems: &[Problem]) {
    let inputs: Vec<_> = problems.iter().map(peer::input).collect();
    let mut group = criterion.benchmark_group(name);
    let mut cycle = problems.iter().cycle();
    group.bench_function("ours", |bencher| {
        bencher.iter(|| black_box(&plan_move(black_box(cycle.next().unwrap()))).is_ok());
    });
    let (mut cycle, mut peer) = (inputs.iter().cycle(), Peer::new());
    group.bench_function("rsruckig", |bencher| {
        bencher.iter(|| peer.duration(black_box(cycle.next().unwrap())));
    });
    let mut tally = s_curve::Tally::default();
    let asked: Vec<_> = problems
        .iter()
        .filter_map(|problem| {
            let ours = plan_move(problem).unwrap().duration();
            tally.ask(problem, ours).map(|input| (problem.clone(), input))
        })
        .collect();
    let at_rest = problems.iter().all(|problem| problem.start().is_at_rest() && problem.goal().is_at_rest());
    // Whoever answers wrongly answers as fast as they like.
    let (ours, second): (Vec<_>, Vec<_>) = asked.into_iter().filter(|_| at_rest).unzip();
    let mut cycle = second.iter().cycle();
    if !second.is_empty() {
        group.bench_function("s_curve", |bencher| {
            bencher.iter(|| black_box(&s_curve::plan(black_box(cycle.next().unwrap()))).j_max);
        });
    }
    group.finish();
    print_ratio(name, problems, &inputs, plan_move);
    let s_curve::Tally { asked, right, slower, longest } = tally;
    if asked > 0 {
        println!(
            "{name}: s_curve is asked {asked}, right in {right}, of which {slower} last longer than ours, by {longest:.1e} at most"
        );
    }
    if !second.is_empty() {
        print_by_turns(
            name,
            ("s_curve", second.len()),
            || {
                for problem in &ours {
                    black_box(&plan_move(black_box(problem)));
                }
            },
            || {
                for input in &second {
                    black_box(&s_curve::plan(black_box(input)));
                }
            },
        );
    }
}

/// Our time beside rsruckig's.
fn print_ratio<T>(
    name: &str,
    problems: &[Problem],
    inputs: &[InputParameter<1>],
    plan: impl Fn(&Problem) -> T,
) {
    let mut peer = Peer::new();
    print_by_turns(
        name,
        ("rsruckig", problems.len()),
        || {
            for problem in problems {
                black_box(&plan(black_box(problem)));
            }
        },
        || {
            for input in inputs {
                black_box(peer.duration(black_box(input)));
            }
        },
    );
}

/// The ratio of both, from the best of rounds by turns: other work on the machine slows down some, not all. Each turn is
/// several rounds long, as criterion's are, so that neither is measured with the branches of the other.
fn print_by_turns(
    name: &str,
    (peer, problems): (&str, usize),
    mut ours: impl FnMut(),
    mut theirs: impl FnMut(),
) {
    let mut best = (f64::INFINITY, f64::INFINITY);
    for _ in 0..5 {
        best.0 = best.0.min(best_round(&mut ours));
        best.1 = best.1.min(best_round(&mut theirs));
    }
    let each = |seconds: f64| seconds * 1e9 / problems as f64;
    let (ours, theirs) = (each(best.0), each(best.1));
    println!("{name}: {ours:.1} ns, {:.2} times as fast as {peer} ({theirs:.1} ns)", theirs / ours);
}

/// The shortest of twenty rounds in a row [s].
fn best_round(mut round: impl FnMut()) -> f64 {
    let timed = |_| {
        let begin = Instant::now();
        round();
        begin.elapsed().as_secs_f64()
    };
    (0..20).map(timed).fold(f64::INFINITY, f64::min)
}

/// The same moves from rest to rest with limits of snap and crackle that are reached about as often as the others, by the
/// families of higher order, beside the peer's third order. *Solved*: how long each derivative is held; *laid*: the pieces too,
/// on the heap.
fn families(criterion: &mut Criterion) {
    let mut random = Random(5);
    let problems: Vec<Problem> = problems(true, false)
        .into_iter()
        .map(|problem| moves::with_higher_limits(&mut random, &problem))
        .collect();
    for (name, order) in [("plan/order_4", 4), ("plan/order_5", 5)] {
        let mut group = criterion.benchmark_group(name);
        let mut cycle = problems.iter().cycle();
        group.bench_function("ours, solved", |bencher| {
            bencher.iter(|| black_box(plan_polynomial(black_box(cycle.next().unwrap()), order)).is_ok());
        });
        let mut cycle = problems.iter().cycle();
        group.bench_function("ours, laid", |bencher| {
            bencher.iter(|| plan_polynomial(black_box(cycle.next().unwrap()), order).unwrap().to_profile());
        });
        let solved: Vec<_> =
            problems.iter().map(|problem| plan_polynomial(problem, order).unwrap()).collect();
        let (mut cycle, mut part) = (solved.iter().cycle(), 0.0);
        group.bench_function("ours, one setpoint of a solved one", |bencher| {
            bencher.iter(|| {
                let planned = cycle.next().unwrap();
                part = if part < 0.9 { part + 0.0618 } else { 0.0 };
                planned.at(black_box(part * planned.duration()))
            });
        });
        let inputs = peers(&mut group, &problems);
        group.finish();
        print_ratio(&format!("{name}, solved"), &problems, &inputs, |problem| {
            plan_polynomial(problem, order)
        });
        print_ratio(&format!("{name}, laid"), &problems, &inputs, |problem| {
            plan_polynomial(problem, order).unwrap().to_profile()
        });
    }
    let mut group = criterion.benchmark_group("plan/trigonometric");
    let mut cycle = problems.iter().cycle();
    group.bench_function("ours", |bencher| {
        bencher.iter(|| black_box(plan_trigonometric(black_box(cycle.next().unwrap()))).is_ok());
    });
    let inputs = peers(&mut group, &problems);
    group.finish();
    print_ratio("plan/trigonometric", &problems, &inputs, plan_trigonometric);
}

fn peers(group: &mut BenchmarkGroup<'_, WallTime>, problems: &[Problem]) -> Vec<InputParameter<1>> {
    let inputs: Vec<_> = problems.iter().map(peer::input).collect();
    let (mut cycle, mut peer) = (inputs.iter().cycle(), Peer::new());
    group.bench_function("rsruckig", |bencher| {
        bencher.iter(|| peer.duration(black_box(cycle.next().unwrap())));
    });
    inputs
}

/// The judge, on moves of seven pieces or fewer, of fifteen, and of thirty-one.
fn verdicts(criterion: &mut Criterion) {
    let limits: LimitsSpec = LimitsSpec {
        max_velocity: 0.5,
        max_acceleration: 2.0,
        max_jerk: 20.0,
        max_snap: Some(400.0),
        max_higher_derivatives: vec![1e4],
        ..LimitsSpec::default()
    };
    let mut group = criterion.benchmark_group("verify");
    for (name, family, order) in [
        ("s_curve", Family::SCurve, None),
        ("trigonometric", Family::Trigonometric, None),
        ("order_4", Family::Polynomial, Some(4)),
        ("order_5", Family::Polynomial, Some(5)),
    ] {
        let axis = AxisMoveSpec {
            axis: "x".into(),
            kind: Ok(AxisKind::Prismatic),
            start: State::at_rest(0.0),
            goal: State::at_rest(0.425),
            limits: limits.clone(),
        };
        let spec = RequestSpec {
            axes: vec![axis],
            cycle_time_ns: None,
            family: Ok(family),
            order,
            short_path: Ok(ShortPathPolicy::Reject),
            synchronization: Ok(Synchronization::None),
            minimum_duration: None,
            end_on_cycle: false,
        };
        let plan = plan(&Request::try_from(spec).unwrap()).unwrap();
        assert!(certify(&plan).passed());
        group.bench_function(name, |bencher| bencher.iter(|| certify(black_box(&plan))));
    }
}

fn plans(criterion: &mut Criterion) {
    compare(criterion, "plan/rest_to_rest", &problems(true, false));
    compare(criterion, "plan/asymmetric_rest_to_rest", &problems(true, true));
    compare(criterion, "plan/start_and_end_velocity", &problems(false, false));
    compare(criterion, "plan/asymmetric_start_and_end_velocity", &problems(false, true));
    families(criterion);
    verdicts(criterion);
}

criterion_group!(benches, plans);
criterion_main!(benches);
