//! How many instructions does each hot function take?
//!
//! ```text
//! planner/benches/instructions.sh            against the committed counts
//! planner/benches/instructions.sh --record   writes them anew
//! ```
//! A count does not depend on who else uses the machine, so that it can be held in CI, where times cannot. Callgrind counts what runs in
//! [`measured`], which is nothing but rounds of one case. Without it this runs every case once.

#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a bench may fail by panicking, and prints what it ran"
)]

#[path = "../tests/common/mod.rs"]
mod common;

use std::hint::black_box;

use common::Random;
use common::commands::{self, BEAT};
use common::moves::{self, Draw};
use common::paths;
use common::splices::{self, AT};
use common::states::{self, Question};
use planner::generator::{AxisLimits, Generator};
use planner::{
    AxisTransfer, Cursor, CycleTime, Limits, Problem, Profile, PvtPlanner, PvtPolicy, PvtTarget,
    ShortPathPolicy, State, Synchronization, TimeLaw, Timing, Transfer, certify, plan_move, plan_polynomial,
    plan_transfer, plan_trigonometric, retime, together,
};

/// Inputs that a case goes through in a round.
const INPUTS: usize = 256;

/// What is counted: callgrind looks for this name.
#[inline(never)]
fn measured(round: &mut dyn FnMut()) {
    round();
}

/// Runs a round to warm up (what is set up lazily is not counted), then one that is counted; says how many calls it makes.
fn case(name: &str, calls: usize, mut round: impl FnMut()) {
    round();
    measured(&mut round);
    println!("{name} {calls}");
}

fn each<T>(name: &str, inputs: &[T], mut work: impl FnMut(&T)) {
    case(name, inputs.len(), || inputs.iter().for_each(|input| work(black_box(input))));
}

fn moves() {
    let drawn = |rest_to_rest, asymmetric| -> Vec<Problem> {
        let mut random = Random(3);
        let draw = Draw { rest_to_rest, asymmetric, wide: false };
        (0..INPUTS).map(|_| moves::problem(&mut random, draw)).collect()
    };
    let plan = |problem: &Problem| {
        black_box(&plan_move(problem)).as_ref().unwrap();
    };
    each("plan/rest_to_rest", &drawn(true, false), plan);
    each("plan/asymmetric_rest_to_rest", &drawn(true, true), plan);
    each("plan/start_and_end_velocity", &drawn(false, false), plan);
    each("plan/asymmetric_start_and_end_velocity", &drawn(false, true), plan);

    let mut random = Random(5);
    let higher: Vec<Problem> =
        drawn(true, false).iter().map(|problem| moves::with_higher_limits(&mut random, problem)).collect();
    for order in [4, 5] {
        each(&format!("plan/order_{order}_solved"), &higher, |problem| {
            black_box(&plan_polynomial(problem, order).unwrap());
        });
        let solved: Vec<_> = higher.iter().map(|problem| plan_polynomial(problem, order).unwrap()).collect();
        let mut part = 0.0;
        each(&format!("plan/order_{order}_setpoint"), &solved, |planned| {
            part = if part < 0.9 { part + 0.0618 } else { 0.0 };
            black_box(planned.at(black_box(part * planned.duration())));
        });
        each(&format!("plan/order_{order}_laid"), &higher, |problem| {
            black_box(&plan_polynomial(problem, order).unwrap().to_profile());
        });
    }
    each("plan/trigonometric", &higher, |problem| {
        black_box(&plan_trigonometric(problem)).as_ref().unwrap();
    });
}

fn any_state() {
    let mut random = Random(1);
    for (name, kind) in [("ordinary", states::Kind::Ordinary), ("underway", states::Kind::Underway)] {
        let asked: Vec<Transfer> =
            (0..INPUTS).map(|_| states::question(&mut random, kind).transfer()).collect();
        each(&format!("states/{name}"), &asked, |transfer| {
            black_box(&plan_transfer(transfer).unwrap());
        });
    }
    for axes in [3, 6] {
        let problems: Vec<Vec<Question>> = (0..INPUTS / 4)
            .map(|_| (0..axes).map(|_| states::question(&mut random, states::Kind::Ordinary)).collect())
            .collect();
        let asked: Vec<Vec<AxisTransfer<'_>>> = problems
            .iter()
            .map(|asked| asked.iter().map(|asked| AxisTransfer::from(asked.transfer())).collect())
            .collect();
        let mut transits = Vec::with_capacity(axes);
        each(&format!("together/{axes}_axes"), &asked, |asked| {
            black_box(together(asked, Synchronization::Time, Timing::default(), &mut transits).unwrap());
        });
    }
}

fn points() {
    let tracked = commands::tracked(&mut Random(17), 16 * INPUTS);
    let limits = Limits::symmetric(0.5, 5.0, 200.0).unwrap();
    for (name, policy) in [
        ("prefer_velocity", PvtPolicy::PreferVelocity),
        ("prefer_position", PvtPolicy::PreferPosition),
        ("extend_time", PvtPolicy::ExtendTime),
    ] {
        let fresh = PvtPlanner::new(State::at_rest(0.0), limits.clone(), policy).unwrap();
        case(&format!("pvt/{name}"), tracked.len(), || {
            let mut axis = fresh.clone();
            for &(position, velocity) in &tracked {
                let target = PvtTarget { position, velocity, duration: BEAT };
                black_box(&axis.command(black_box(target))).as_ref().unwrap();
            }
        });
    }
}

fn under_way() {
    for (name, motion) in splices::motions() {
        for (operation_name, motion, operation) in splices::operations(&motion) {
            each(&format!("splice/{name}/{operation_name}"), &[motion], |motion| {
                black_box(motion.splice(AT + 1, &operation).unwrap());
            });
        }
        each(&format!("verify/{name}"), &[motion], |motion| {
            black_box(certify(motion.plan()));
        });
    }
    let mut random = Random(7);
    for kind in [paths::Kind::Together, paths::Kind::Quintic] {
        let asked: Vec<_> = (0..INPUTS / 4)
            .map(|_| {
                let base = paths::path(&mut random, kind, 6);
                let at = base.duration() * random.unit();
                (TimeLaw::of(&base), base, at)
            })
            .collect();
        each(&format!("retime/{kind:?}/hold").to_lowercase(), &asked, |(law, base, at)| {
            black_box(retime(base, law, *at, 0.0).is_ok());
        });
    }
}

fn setpoints() {
    let limits = Limits::symmetric(0.5, 2.0, 20.0).unwrap();
    let problem =
        Problem::new(State::at_rest(0.0), State::at_rest(0.425), limits, ShortPathPolicy::Reject).unwrap();
    let profile: Profile = plan_move(&problem).unwrap().to_profile();
    let cycle = CycleTime::from_ns(Some(1_200_000)).unwrap();
    let mut rows = vec![[0.0; 4]; 1000];
    case("sample/cursor", rows.len(), || {
        let mut cursor = Cursor::new(black_box(&profile));
        for (number, row) in (0..).zip(&mut rows) {
            *row = cursor.at(cycle.start_of(number)).words();
        }
        black_box(&rows);
    });
    let plan = splices::one_axis(&profile, problem.limits().clone(), cycle);
    let mut columns = [(); 4].map(|()| vec![0.0; 1000]);
    case("sample/columns", 1000, || {
        black_box(&plan).sampler().fill(0, 0, columns.each_mut().map(Vec::as_mut_slice));
        black_box(&columns);
    });
    let limits = AxisLimits { velocity: 0.25, acceleration: 3.0, jerk: 100.0 };
    let mut running = Generator::new(limits, CycleTime::MILLISECOND).unwrap();
    let mut targets = [0.05, 0.0].into_iter().cycle();
    // A new target is part of it: to 50 mm, in 314 cycles, and back.
    case("generator/step", 314, || {
        running.set_target(targets.next().unwrap()).unwrap();
        for _ in 0..314 {
            black_box(black_box(&mut running).step());
        }
    });
}

fn main() {
    moves();
    any_state();
    points();
    under_way();
    setpoints();
}
