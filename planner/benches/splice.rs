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

use common::motions::{NAMES, Opening};
use common::peer::{self, Peer};
use common::states::Question;
use criterion::{Criterion, criterion_group, criterion_main};
use planner::motion::{AxisGoal, Motion, Operation, Override};
use planner::{
    AxisKind, AxisMoveSpec, BoundsSpec, Family, Judged, LimitsSpec, Request, RequestSpec, ShortPathPolicy,
    State, Synchronization, certify,
};

/// Half a metre or so from zero, each axis another way.
fn opening(axes: usize, line: bool) -> Opening {
    let axis = |index: usize| {
        let size = 1.0 - 0.1 * index as f64;
        let limits = LimitsSpec {
            max_velocity: 0.5 * size,
            max_acceleration: 2.0 * size,
            max_jerk: 20.0 * size,
            ..LimitsSpec::default()
        };
        (State::at_rest(0.0), State::at_rest(0.8 * size), limits)
    };
    let axes = (0..axes).map(axis).collect();
    Opening { axes, family: Family::SCurve, order: None, cycle_time_ns: 1_000_000, line }
}

/// The same, at one time: all move at full speed, so each is slowed in its own way.
fn together() -> Motion {
    let axes = opening(6, false).axes.into_iter().zip(NAMES).enumerate();
    let axes = axes.map(|(index, ((start, goal, limits), name))| AxisMoveSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        start,
        goal: State::at_rest(goal.position * (1.0 - 0.05 * index as f64)),
        limits,
    });
    let spec = RequestSpec {
        axes: axes.collect(),
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::Time),
        minimum_duration: None,
        end_on_cycle: false,
    };
    let judged = Judged::answer(&Request::try_from(spec).unwrap()).unwrap();
    Motion::open(judged.accepted().unwrap()).unwrap()
}

/// While it speeds up.
const AT: u64 = 200;

fn retarget(motion: &Motion, factor: f64) -> Operation {
    let goals = motion.plan().axes().iter().map(|axis| AxisGoal {
        axis: axis.axis.clone(),
        goal: State::at_rest(axis.goal.position * factor),
        limits: None,
    });
    Operation::Retarget(goals.collect())
}

fn splice(criterion: &mut Criterion) {
    let cases = [
        ("1_axis", opening(1, false).motion(), false),
        ("6_axes", opening(6, false).motion(), true),
        ("6_axes_on_a_line", opening(6, true).motion(), false),
        ("6_axes_together", together(), false),
    ];
    for (name, motion, beside_the_peer) in cases {
        let held = motion.splice(AT, &Operation::Hold).unwrap().motion;
        let operations = [
            ("hold", &motion, Operation::Hold),
            ("resume", &held, Operation::Resume),
            ("override", &motion, Operation::Override(Override::new(0.5).unwrap())),
            ("retarget", &motion, retarget(&motion, 0.7)),
        ];
        let mut group = criterion.benchmark_group(format!("splice/{name}"));
        for (operation_name, motion, operation) in &operations {
            group.bench_function(*operation_name, |bencher| {
                bencher.iter(|| black_box(motion).splice(AT + 1, black_box(operation)).unwrap());
            });
        }
        group.bench_function("judge_alone", |bencher| bencher.iter(|| certify(black_box(motion.plan()))));
        if beside_the_peer {
            let questions: Vec<_> = (0..motion.plan().axes().len())
                .map(|axis| peer::question(&question(&motion, axis)))
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

fn question(motion: &Motion, axis: usize) -> Question {
    let limits = &motion.plan().axes()[axis].limits;
    let (velocity, acceleration) = (limits.velocity_forward(), limits.acceleration());
    Question {
        start: motion.state(axis, AT + 1),
        goal: State::at_rest(0.7 * motion.plan().axes()[axis].goal.position),
        bounds: BoundsSpec {
            min_velocity: -velocity,
            max_velocity: velocity,
            min_acceleration: -acceleration,
            max_acceleration: acceleration,
            max_jerk: limits.jerk(),
        },
    }
}

criterion_group!(benches, splice);
criterion_main!(benches);
