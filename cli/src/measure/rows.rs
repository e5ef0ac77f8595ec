//! What is asked, and that its answers are right, which is seen before anything is timed.

use std::fmt;
use std::hint::black_box;

use planner::generator::{AxisLimits, Generator};
use planner::motion::{Motion, Operation};
use planner::{
    AxisTransfer, CycleTime, InvalidFields, Limits, PolynomialMove, Problem, Profile, PvtPlanner, PvtPolicy,
    PvtTarget, ShortPathPolicy, State, Synchronization, Timing, Transit, certify, plan_move, plan_polynomial,
    plan_transfer, plan_trigonometric, together, transfer_violations, violations,
};
use prost::Message as _;
use proto::stream::{Batch, Columns, Tails, ToAxis};
use proto::{Digest, pb};

use super::Budget;
use super::inputs::commands::{BEAT, tracked};
use super::inputs::moves::{self, Draw};
use super::inputs::random::Random;
use super::inputs::splices;
use super::inputs::states::{Kind, Question, question};
use super::peers;
use super::timing::{Each, Side};

/// The name of a peer, and its side; none where no peer does it, or none is built in.
pub(super) type Beside = Option<(&'static str, Box<dyn Side>)>;

/// One row: both sides of a question.
pub(crate) struct Row {
    pub(crate) ours: Box<dyn Side>,
    pub(crate) peer: Beside,
    pub(crate) budget: Budget,
}

/// An answer is not what it should be.
#[derive(Debug)]
pub(crate) struct Unequal(pub(super) String);

impl fmt::Display for Unequal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A refusal of what is known to be possible.
fn refused(why: impl fmt::Debug) -> Unequal {
    Unequal(format!("{why:?}"))
}

fn ensure(holds: bool, otherwise: impl Fn() -> String) -> Result<(), Unequal> {
    if holds { Ok(()) } else { Err(Unequal(otherwise())) }
}

/// How a row is made: its inputs drawn, its answers checked.
type Make = fn() -> Result<Row, Unequal>;

/// Every row by its name, in their order.
pub(crate) const ROWS: [(&str, Make); 21] = [
    ("rest to rest", || moves(draw(true, false), Budget::share(6.0))),
    ("start and end velocity", || moves(draw(false, false), Budget::share(4.0))),
    ("asymmetric, rest to rest", || moves(draw(true, true), Budget::share(5.0))),
    ("asymmetric", || moves(draw(false, true), Budget::default())),
    ("any state to any state", any_states),
    ("order 4", || smoother(polynomial::<4>, |planned| planned.to_profile(), Budget::default())),
    ("order 5", || smoother(polynomial::<5>, |planned| planned.to_profile(), Budget::share(1.2))),
    ("order 5, with pieces", || smoother(laid_polynomial::<5>, Profile::clone, Budget::share(1.2))),
    ("trigonometric", || smoother(plan_trigonometric, |planned| planned.to_profile(), Budget::share(5.0))),
    ("PVT command", pvt_command),
    ("generator step", generator_step),
    ("3 axes at one time", || at_one_time::<3>(Budget::default())),
    ("6 axes at one time", || at_one_time::<SIX>(Budget::share(2.0))),
    ("one setpoint", one_setpoint),
    ("setpoint of a batch", setpoint_of_a_batch),
    ("judge 6 axes", judge),
    ("encode a plan", encode_plan),
    ("decode a plan", decode_plan),
    ("encode a batch", encode_batch),
    ("decode a batch", decode_batch),
    ("splice 6 axes", splice),
];

/// Axes of a plan that is sampled, judged, encoded and spliced.
pub(super) const SIX: usize = 6;
/// Problems of one axis, and of several.
const PROBLEMS: usize = 4096;
const PROBLEMS_OF_SEVERAL: usize = 1000;
/// How often an operation with one input only is done in a round.
pub(super) const REPEATED: usize = 64;
/// Cycles of a thousand milliseconds, and of a batch on its way.
const CYCLES: u64 = 1000;
const BATCH: u64 = 10;

fn draw(rest_to_rest: bool, asymmetric: bool) -> Draw {
    Draw { rest_to_rest, asymmetric, wide: false }
}

/// Problems that the peer solves too; ours are legal, and never longer.
fn problems(draw: Draw) -> Result<Vec<Problem>, Unequal> {
    let (mut random, mut problems) = (Random(3), Vec::with_capacity(PROBLEMS));
    while problems.len() < PROBLEMS {
        let problem = moves::problem(&mut random, draw);
        let ours = plan_move(&problem).map_err(refused)?;
        let found = violations(&ours.to_profile(), problem.limits(), problem.goal());
        ensure(found.is_empty(), || format!("{found:?}"))?;
        if peers::solves_move(&problem, ours.duration())? {
            problems.push(problem);
        }
    }
    Ok(problems)
}

fn moves(draw: Draw, budget: Budget) -> Result<Row, Unequal> {
    let problems = problems(draw)?;
    let peer = peers::moves(&problems);
    let work = |_: &mut (), problem: &Problem| {
        black_box(&plan_move(problem));
    };
    Ok(Row { ours: Box::new(Each::new(problems, || (), work)), peer, budget })
}

fn any_states() -> Result<Row, Unequal> {
    let (mut random, mut asked) = (Random(1), Vec::with_capacity(PROBLEMS));
    while asked.len() < PROBLEMS {
        let one = question(&mut random, Kind::Ordinary);
        let ours = plan_transfer(&one.transfer()).map_err(refused)?;
        let found = transfer_violations(&ours.to_profile(), &one.bounds(), one.goal);
        ensure(found.is_empty(), || format!("{found:?}"))?;
        if peers::solves_together::<1>(&[one], ours.duration())? {
            asked.push(one);
        }
    }
    let peer = peers::states(&asked);
    let work = |_: &mut (), transfer: &_| {
        black_box(&plan_transfer(transfer));
    };
    let asked = asked.iter().map(Question::transfer).collect();
    let budget = Budget { p999_ns: Some(1500.0), ..Budget::share(2.0) };
    Ok(Row { ours: Box::new(Each::new(asked, || (), work)), peer, budget })
}

/// A family of higher order on moves from rest to rest. No peer has one: beside it what its third order takes.
fn smoother<T>(
    plan: impl Fn(&Problem) -> Result<T, planner::InvalidFields> + 'static,
    laid: impl Fn(&T) -> Profile,
    budget: Budget,
) -> Result<Row, Unequal> {
    let mut random = Random(5);
    let problems: Vec<Problem> = problems(draw(true, false))?
        .iter()
        .map(|problem| moves::with_higher_limits(&mut random, problem))
        .collect();
    for problem in &problems {
        let planned = plan(problem).map_err(refused)?;
        let found = violations(&laid(&planned), problem.limits(), problem.goal());
        ensure(found.is_empty(), || format!("{found:?}"))?;
    }
    let peer = peers::moves(&problems);
    let work = move |_: &mut (), problem: &Problem| {
        black_box(&plan(problem));
    };
    Ok(Row { ours: Box::new(Each::new(problems, || (), work)), peer, budget })
}

/// How long each phase lasts, which is all that there is to solve.
fn polynomial<const ORDER: u32>(problem: &Problem) -> Result<PolynomialMove, InvalidFields> {
    plan_polynomial(problem, ORDER)
}

/// The same as what is played: 2ⁿ − 1 pieces.
fn laid_polynomial<const ORDER: u32>(problem: &Problem) -> Result<Profile, InvalidFields> {
    plan_polynomial(problem, ORDER).map(|planned| planned.to_profile())
}

fn pvt_command() -> Result<Row, Unequal> {
    let targets: Vec<PvtTarget> = tracked(&mut Random(17), PROBLEMS)
        .into_iter()
        .map(|(position, velocity)| PvtTarget { position, velocity, duration: BEAT })
        .collect();
    let limits = Limits::symmetric(0.5, 5.0, 200.0).map_err(refused)?;
    let fresh = PvtPlanner::new(State::at_rest(0.0), limits, PvtPolicy::PreferVelocity).map_err(refused)?;
    let mut axis = fresh.clone();
    for target in &targets {
        axis.command(*target).map_err(refused)?;
    }
    let work = |axis: &mut PvtPlanner, target: &PvtTarget| {
        black_box(&axis.command(*target));
    };
    let budget = Budget { share: None, ns: Some(150.0), p999_ns: Some(1000.0) };
    Ok(Row { ours: Box::new(Each::new(targets, move || fresh.clone(), work)), peer: None, budget })
}

/// To and fro between these [m].
pub(super) const TARGETS: [f64; 2] = [0.05, 0.0];

pub(super) fn generator_limits() -> AxisLimits<f64> {
    AxisLimits { velocity: 0.25, acceleration: 3.0, jerk: 100.0 }
}

/// One cycle of a control loop; a new target every 314 cycles is part of it.
fn generator_step() -> Result<Row, Unequal> {
    let fresh = Generator::new(generator_limits(), CycleTime::MILLISECOND).map_err(refused)?;
    let mut running = fresh.clone();
    running.set_target(TARGETS[0]).map_err(refused)?;
    let mut cycles = 0;
    while !running.is_done() {
        running.step();
        cycles += 1;
    }
    ensure(running.position().to_bits() == TARGETS[0].to_bits(), || format!("at {}", running.position()))?;
    let peer = peers::generator(PROBLEMS, cycles)?;
    let work = |(running, turn): &mut (Generator<f64>, usize), _: &()| {
        if running.is_done() {
            // The targets are those that were reached above.
            let _ = running.set_target(TARGETS[*turn % TARGETS.len()]);
            *turn += 1;
        }
        black_box(running.step());
    };
    let side = Each::new(vec![(); PROBLEMS], move || (fresh.clone(), 0), work);
    Ok(Row { ours: Box::new(side), peer, budget: Budget { ns: Some(10.0), ..Budget::default() } })
}

fn at_one_time<const AXES: usize>(budget: Budget) -> Result<Row, Unequal> {
    let mut random = Random(1);
    let mut transits = Vec::with_capacity(AXES);
    let (mut problems, mut asked): (Vec<Vec<Question>>, Vec<Vec<AxisTransfer<'static>>>) = Default::default();
    while problems.len() < PROBLEMS_OF_SEVERAL {
        let drawn: Vec<Question> = (0..AXES).map(|_| question(&mut random, Kind::Ordinary)).collect();
        let axes: Vec<_> = drawn.iter().map(|one| AxisTransfer::from(one.transfer())).collect();
        let planned = in_time(&axes, &mut transits).map_err(refused)?;
        for (one, transit) in drawn.iter().zip(&transits) {
            let found = transfer_violations(&transit.to_profile(), &one.bounds(), one.goal);
            ensure(found.is_empty(), || format!("{found:?}"))?;
        }
        if peers::solves_together::<AXES>(&drawn, planned)? {
            problems.push(drawn);
            asked.push(axes);
        }
    }
    let peer = peers::together::<AXES>(&problems);
    let work = move |_: &mut (), axes: &Vec<AxisTransfer<'static>>| {
        black_box(&in_time(axes, &mut transits));
    };
    Ok(Row { ours: Box::new(Each::new(asked, || (), work)), peer, budget })
}

/// How long all axes take together [s].
fn in_time(axes: &[AxisTransfer<'_>], transits: &mut Vec<Transit>) -> Result<f64, planner::InvalidFields> {
    Ok(together(axes, Synchronization::Time, Timing::default(), transits)?.duration)
}

/// At any time of a move of seven pieces.
fn one_setpoint() -> Result<Row, Unequal> {
    let limits = Limits::symmetric(0.5, 2.0, 20.0).map_err(refused)?;
    let (start, goal) = (State::at_rest(0.0), State::at_rest(0.425));
    let problem = Problem::new(start, goal, limits, ShortPathPolicy::Reject).map_err(refused)?;
    let profile = plan_move(&problem).map_err(refused)?.to_profile();
    let part = profile.duration() / CYCLES as f64;
    // 619 and 1000 have no divisor in common: every time once, in no order.
    let times: Vec<f64> = (0..CYCLES).map(|number| part * (number * 619 % CYCLES) as f64).collect();
    let peer = peers::one_setpoint(&problem, &profile, &times)?;
    let work = move |_: &mut (), time: &f64| {
        black_box(profile.at(*time));
    };
    Ok(Row { ours: Box::new(Each::new(times, || (), work)), peer, budget: Budget::default() })
}

/// Six axes half a metre or so from their goals, each on its own time.
fn six_axes() -> Result<Motion, Unequal> {
    let motion = splices::motions().into_iter().find(|(name, _)| *name == "6_axes").map(|(_, motion)| motion);
    let motion = motion.ok_or_else(|| Unequal("there are no six axes".to_owned()))?;
    ensure(certify(motion.plan()).passed(), || "the judge does not pass it".to_owned())?;
    Ok(motion)
}

/// A thousand cycles of six axes in a row.
fn setpoint_of_a_batch() -> Result<Row, Unequal> {
    let motion = six_axes()?;
    let peer = peers::batch(&motion, CYCLES)?;
    let columns = [(); 4].map(|()| vec![0.0; CYCLES as usize * SIX]);
    let mut side = Filled { motion, columns };
    side.fill();
    let plan = side.motion.plan();
    let axes = (0..)
        .zip(plan.axes())
        .flat_map(|(axis, planned)| (0..CYCLES).map(move |cycle| (axis, planned, cycle)));
    for (place, (axis, planned, cycle)) in axes.enumerate() {
        let (ours, expected) =
            (side.columns.each_ref().map(|column| column[place]), planned.profile.at(plan.time_of(cycle)));
        ensure(ours.map(f64::to_bits) == expected.words().map(f64::to_bits), || {
            format!("{ours:?} of axis {axis} at cycle {cycle}, not {expected:?}")
        })?;
    }
    let budget = Budget { share: None, ns: Some(2.0), p999_ns: None };
    Ok(Row { ours: Box::new(side), peer, budget })
}

/// Position, velocity, acceleration and jerk, all cycles of the first axis, then all of the second …
struct Filled {
    motion: Motion,
    columns: [Vec<f64>; 4],
}

impl Filled {
    fn fill(&mut self) {
        let plan = black_box(self.motion.plan());
        let mut sampler = plan.sampler();
        let cycles = CYCLES as usize;
        for axis in 0..plan.axes().len() {
            let filled = axis * cycles..(axis + 1) * cycles;
            sampler.fill(axis, 0, self.columns.each_mut().map(|column| &mut column[filled.clone()]));
        }
    }
}

impl Side for Filled {
    fn operations(&self) -> usize {
        self.columns[0].len()
    }

    fn round(&mut self) {
        self.fill();
        black_box(&self.columns);
    }

    fn each(&mut self) -> Option<Vec<f64>> {
        None
    }
}

/// An operation with one input and no peer.
fn alone<T: Clone + 'static, R>(input: T, work: impl Fn(&T) -> R + 'static) -> Row {
    let work = move |_: &mut (), input: &T| {
        black_box(&work(input));
    };
    let side = Each::new(vec![input; REPEATED], || (), work);
    Row { ours: Box::new(side), peer: None, budget: Budget::default() }
}

fn judge() -> Result<Row, Unequal> {
    Ok(alone(six_axes()?, |motion| certify(motion.plan())))
}

/// From a plan to the bytes that are sent, and back.
fn encode_plan() -> Result<Row, Unequal> {
    let judged = planner::Judged::new(six_axes()?.plan().clone());
    ensure(plan_of(&plan_bytes(&judged))? == *judged.plan(), || "another plan comes back".to_owned())?;
    Ok(alone(std::rc::Rc::new(judged), |judged| plan_bytes(judged)))
}

fn decode_plan() -> Result<Row, Unequal> {
    let bytes = plan_bytes(&planner::Judged::new(six_axes()?.plan().clone()));
    plan_of(&bytes)?;
    Ok(alone(bytes, |bytes| plan_of(bytes).is_ok()))
}

fn plan_bytes(judged: &planner::Judged) -> prost::bytes::Bytes {
    proto::encode_plan(judged)
}

fn plan_of(bytes: &[u8]) -> Result<planner::Plan, Unequal> {
    proto::plan_from_wire(pb::Plan::decode(bytes).map_err(refused)?).map_err(refused)
}

/// What a server sends at once: ten cycles of six axes, and the way to rest from the last of them.
fn ten_cycles() -> Result<Batch, Unequal> {
    let motion = six_axes()?;
    let first_cycle = splices::AT;
    let columns = Columns::of_plan(motion.plan(), first_cycle..first_cycle + BATCH);
    let digest = columns.digests(first_cycle, Digest::ZERO).last().unwrap_or_default();
    let tail = motion.tail(first_cycle + BATCH - 1).map_err(refused)?;
    let tail = tail.ok_or_else(|| Unequal("there is no way to rest".to_owned()))?;
    let tails = Tails::new(tail.motion.plan().axes().iter().map(|axis| axis.profile.clone()));
    Ok(Batch { first_cycle, revision: 1, replaces: false, last: false, columns, digest, tails })
}

fn encode_batch() -> Result<Row, Unequal> {
    let batch = ten_cycles()?;
    ensure(batch_of(&batch_bytes(&batch))? == batch, || "another batch comes back".to_owned())?;
    Ok(alone(batch, batch_bytes))
}

fn decode_batch() -> Result<Row, Unequal> {
    let bytes = batch_bytes(&ten_cycles()?);
    batch_of(&bytes)?;
    Ok(alone(bytes, |bytes| batch_of(bytes).is_ok()))
}

fn batch_bytes(batch: &Batch) -> Vec<u8> {
    proto::response_to_wire(1, ToAxis::Batch(batch.clone())).encode_to_vec()
}

fn batch_of(bytes: &[u8]) -> Result<Batch, Unequal> {
    let wire = pb::StreamSetpointsResponse::decode(bytes).map_err(refused)?;
    match proto::response_from_wire(wire).map_err(refused)? {
        (_, ToAxis::Batch(batch)) => Ok(batch),
        _ => Err(Unequal("something else comes back".to_owned())),
    }
}

/// New goals for six axes under way, planned and judged; the peer's are planned alone.
fn splice() -> Result<Row, Unequal> {
    let motion = six_axes()?;
    let found = splices::operations(&motion).into_iter().find(|(name, ..)| *name == "retarget");
    let (_, motion, operation): (_, Motion, Operation) =
        found.ok_or_else(|| Unequal("there is no retarget".to_owned()))?;
    let spliced = motion.splice(splices::AT + 1, &operation).map_err(refused)?;
    ensure(certify(spliced.motion.plan()).passed(), || "the judge does not pass it".to_owned())?;
    let peer = peers::splice(&motion)?;
    let row = alone(motion, move |motion| motion.splice(splices::AT + 1, &operation).is_ok());
    Ok(Row { peer, ..row })
}
