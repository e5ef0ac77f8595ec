//! rsruckig, a pure Rust port of Ruckig (Berscheid and Kröger, 2021), asked the same questions.

use std::hint::black_box;

use planner::motion::Motion;
use planner::{Problem, Profile};
use rsruckig::prelude::{
    DataArrayOrVec, InputParameter, OutputParameter, Ruckig, RuckigResult, ThrowErrorHandler, Trajectory,
};

use super::inputs::axes::{Fixed, input};
use super::inputs::peer::{self, Peer};
use super::inputs::splices;
use super::inputs::states::Question;
use super::rows::{Beside, REPEATED, SIX, TARGETS, Unequal, generator_limits};
use super::timing::Each;

const NAME: &str = "rsruckig";
/// Of a duration [1]: how much longer than the peer's ours may be.
const SLACK: f64 = 1e-9;
/// Between positions, velocities and accelerations of order one.
const EQUAL: f64 = 1e-9;

/// Does the peer solve it too? Ours is never longer.
fn solves(theirs: Option<f64>, ours: f64) -> Result<bool, Unequal> {
    match theirs {
        Some(theirs) if ours > theirs * (1.0 + SLACK) => {
            Err(Unequal(format!("ours lasts {ours} s, that of {NAME} {theirs} s")))
        }
        theirs => Ok(theirs.is_some()),
    }
}

fn ensure_solved(theirs: Option<f64>) -> Result<(), Unequal> {
    theirs.map(|_| ()).ok_or_else(|| Unequal(format!("{NAME} refuses it")))
}

pub(super) fn solves_move(problem: &Problem, ours: f64) -> Result<bool, Unequal> {
    solves(Peer::new().duration(&peer::input(problem)), ours)
}

pub(super) fn solves_together<const AXES: usize>(asked: &[Question], ours: f64) -> Result<bool, Unequal> {
    solves(Fixed::<AXES>::new().duration(&input(asked)), ours)
}

fn one_axis(inputs: Vec<InputParameter<1>>) -> Beside {
    let mut peer = Peer::new();
    let work = move |_: &mut (), input: &InputParameter<1>| {
        black_box(peer.duration(input));
    };
    Some((NAME, Box::new(Each::new(inputs, || (), work))))
}

pub(super) fn moves(problems: &[Problem]) -> Beside {
    one_axis(problems.iter().map(peer::input).collect())
}

pub(super) fn states(questions: &[Question]) -> Beside {
    one_axis(questions.iter().map(peer::question).collect())
}

pub(super) fn together<const AXES: usize>(asked: &[Vec<Question>]) -> Beside {
    let inputs: Vec<InputParameter<AXES>> = asked.iter().map(|asked| input(asked)).collect();
    let mut peer = Fixed::<AXES>::new();
    let work = move |_: &mut (), input: &InputParameter<AXES>| {
        black_box(peer.duration(input));
    };
    Some((NAME, Box::new(Each::new(inputs, || (), work))))
}

/// Each axis by itself, without a judge.
pub(super) fn splice(motion: &Motion) -> Result<Beside, Unequal> {
    let inputs: Vec<_> = (0..motion.plan().axes().len())
        .map(|axis| peer::question(&splices::question(motion, axis)))
        .collect();
    let mut peer = Peer::new();
    inputs.iter().try_for_each(|input| ensure_solved(peer.duration(input)))?;
    let work = move |_: &mut (), inputs: &Vec<InputParameter<1>>| {
        for input in inputs {
            black_box(peer.duration(input));
        }
    };
    Ok(Some((NAME, Box::new(Each::new(vec![inputs; REPEATED], || (), work)))))
}

/// A control loop of the peer's, to and fro between the same targets.
struct Loop {
    ruckig: Ruckig<1, ThrowErrorHandler>,
    input: InputParameter<1>,
    output: OutputParameter<1>,
    finished: bool,
    turn: usize,
}

impl Loop {
    fn new() -> Self {
        let one = |value| DataArrayOrVec::Stack([value]);
        let limits = generator_limits();
        let mut input = InputParameter::new(None);
        input.max_velocity = one(limits.velocity);
        input.max_acceleration = one(limits.acceleration);
        input.max_jerk = one(limits.jerk);
        Self {
            ruckig: Ruckig::new(None, 1e-3),
            input,
            output: OutputParameter::new(None),
            finished: true,
            turn: 0,
        }
    }

    fn step(&mut self) {
        if self.finished {
            self.input.target_position = DataArrayOrVec::Stack([TARGETS[self.turn % TARGETS.len()]]);
            self.turn += 1;
        }
        let result = self.ruckig.update(&self.input, &mut self.output);
        self.finished = !matches!(result, Ok(RuckigResult::Working));
        self.output.pass_to_input(&mut self.input);
    }
}

/// As many steps as ours, which takes `cycles` to its first target.
pub(super) fn generator(steps: usize, cycles: u64) -> Result<Beside, Unequal> {
    let mut first = Loop::new();
    let mut taken = 0_u64;
    while taken == 0 || !first.finished {
        first.step();
        taken += 1;
        if taken > cycles + 1 {
            return Err(Unequal(format!("{NAME} takes more than {taken} cycles, ours {cycles}")));
        }
    }
    if (first.output.new_position[0] - TARGETS[0]).abs() > EQUAL || taken + 1 < cycles {
        return Err(Unequal(format!("{NAME} takes {taken} cycles, ours {cycles}")));
    }
    let work = |running: &mut Loop, _: &()| {
        running.step();
        black_box(&running.output);
    };
    Ok(Some((NAME, Box::new(Each::new(vec![(); steps], Loop::new, work)))))
}

/// Position, velocity, acceleration and jerk of every axis.
type Parts<const AXES: usize> = [DataArrayOrVec<f64, AXES>; 4];

fn at<const AXES: usize>(trajectory: &Trajectory<AXES>, time: f64, parts: &mut Parts<AXES>) {
    let [position, velocity, acceleration, jerk] = parts;
    let (position, velocity) = (&mut Some(position), &mut Some(velocity));
    trajectory.at_time(time, position, velocity, &mut Some(acceleration), &mut Some(jerk), &mut None);
}

fn parts<const AXES: usize>() -> Parts<AXES> {
    [0.0; 4].map(|zero| DataArrayOrVec::Stack([zero; AXES]))
}

/// Jerk may be that of either piece where two join.
fn equal(ours: [f64; 4], theirs: [f64; 4], time: f64) -> Result<(), Unequal> {
    let differ = ours.iter().zip(theirs).take(3).any(|(ours, theirs)| (ours - theirs).abs() > EQUAL);
    if differ { Err(Unequal(format!("{ours:?} and {theirs:?} at {time} s"))) } else { Ok(()) }
}

pub(super) fn one_setpoint(problem: &Problem, profile: &Profile, times: &[f64]) -> Result<Beside, Unequal> {
    let mut peer = Peer::new();
    ensure_solved(peer.duration(&peer::input(problem)))?;
    let trajectory = peer.trajectory;
    for &time in times {
        let mut theirs = parts();
        at(&trajectory, time, &mut theirs);
        equal(profile.at(time).words(), theirs.map(|part| part[0]), time)?;
    }
    let work = move |parts: &mut Parts<1>, time: &f64| {
        at(&trajectory, *time, parts);
        black_box(parts);
    };
    Ok(Some((NAME, Box::new(Each::new(times.to_vec(), parts::<1>, work)))))
}

/// All axes of `motion`, planned by the peer each at its own time, at as many cycles of a millisecond; one setpoint of one axis is an
/// operation.
pub(super) fn batch(motion: &Motion, cycles: u64) -> Result<Beside, Unequal> {
    let plan = motion.plan();
    let asked: Vec<Question> = (0..SIX).map(|axis| splices::whole(motion, axis)).collect();
    let mut asked = input::<SIX>(&asked);
    asked.synchronization = rsruckig::prelude::Synchronization::None;
    let mut peer = Fixed::<SIX>::new();
    ensure_solved(peer.duration(&asked))?;
    let trajectory = peer.trajectory;
    for cycle in 0..cycles {
        let (time, mut theirs) = (plan.time_of(cycle), parts());
        at(&trajectory, time, &mut theirs);
        for (axis, ours) in plan.axes().iter().enumerate() {
            let theirs = [0, 1, 2, 3].map(|part| theirs[part][axis]);
            equal(ours.profile.at(time).words(), theirs, time)?;
        }
    }
    let times: Vec<f64> = (0..cycles).map(|cycle| plan.time_of(cycle)).collect();
    let rows = vec![parts::<SIX>(); times.len()];
    let work = Rows { trajectory, times, rows };
    Ok(Some((NAME, Box::new(work))))
}

/// Setpoints in a row, kept as they come.
struct Rows {
    trajectory: Trajectory<SIX>,
    times: Vec<f64>,
    rows: Vec<Parts<SIX>>,
}

impl super::timing::Side for Rows {
    fn operations(&self) -> usize {
        self.times.len() * SIX
    }

    fn round(&mut self) {
        for (row, time) in self.rows.iter_mut().zip(&self.times) {
            at(black_box(&self.trajectory), *time, row);
        }
        black_box(&self.rows);
    }

    fn each(&mut self) -> Option<Vec<f64>> {
        None
    }
}
