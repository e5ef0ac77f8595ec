//! The planner beside Ruckig itself, the C++ library of Berscheid and Kröger (2021), through its own Rust binding.
//!
//! ```text
//! cargo run --release --manifest-path peers/Cargo.toml [one-axis questions] [questions of 2 to 7 axes]
//! ```
//!
//! Asks both the same questions, those that the planner's tests draw, with bounds alike in both directions, which are all that the binding
//! takes. It panics where our motion is longer than the peer's, unless the peer's ends elsewhere than was asked; then it prints what
//! either refuses, and how long both take.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a program that measures may fail by panicking")]

#[path = "../../planner/tests/common/mod.rs"]
mod common;

use std::hint::black_box;
use std::process::Command;
use std::time::Instant;

use common::Random;
use common::axes::questions;
use common::states::{Kind, Question, question};
use planner::{AxisTransfer, BoundsSpec, State, Synchronization, Timing, Transit, plan_transfer, together};
use ruckig::{InputParameter, Result as Answer, Ruckig, Trajectory};

/// Of a duration [1]: how much longer than the peer's ours may be.
const SLACK: f64 = 1e-9;
/// Of how far a motion leads, of its greatest speed and of the limit of acceleration [1]: how the peer's must end to be an answer.
const END: f64 = 1e-12;
/// A time in which nothing moves [s].
const NOTHING: f64 = 1e-12;

/// The peer, for one number of axes.
struct Peer {
    ruckig: Ruckig,
    trajectory: Trajectory,
    input: InputParameter,
}

impl Peer {
    fn new(axes: usize) -> Self {
        let mut input = InputParameter::new(axes);
        input.synchronization = ruckig::Synchronization::Time;
        Self { ruckig: Ruckig::new_direct_and_offline(axes), trajectory: Trajectory::new_direct(axes), input }
    }

    fn ask(&mut self, asked: &[Question]) {
        let all = |of: &dyn Fn(&Question) -> f64| asked.iter().map(of).collect::<Vec<f64>>();
        self.input.current_position = all(&|asked| asked.start.position);
        self.input.current_velocity = all(&|asked| asked.start.velocity);
        self.input.current_acceleration = all(&|asked| asked.start.acceleration);
        self.input.target_position = all(&|asked| asked.goal.position);
        self.input.target_velocity = all(&|asked| asked.goal.velocity);
        self.input.target_acceleration = all(&|asked| asked.goal.acceleration);
        self.input.max_velocity = all(&|asked| asked.bounds.max_velocity);
        self.input.max_acceleration = all(&|asked| asked.bounds.max_acceleration);
        self.input.max_jerk = all(&|asked| asked.bounds.max_jerk);
    }

    /// Its duration [s]; none where it refuses.
    fn duration(&mut self) -> Option<f64> {
        let answer = self.ruckig.calculate(&mut self.input, &mut self.trajectory);
        let answered = matches!(answer, Answer::Working | Answer::Finished);
        answered.then(|| self.trajectory.get_duration()).filter(|duration| duration.is_finite())
    }

    /// Does its last answer end where it should, an instant before its end, from where it only goes on?
    fn arrives(&self, asked: &[Question]) -> bool {
        let end = self.trajectory.get_duration();
        let samples: Vec<_> =
            (0..=64).map(|part| self.trajectory.at_time(end * f64::from(part) / 64.0)).collect();
        let (positions, velocities, accelerations) = self.trajectory.at_time(end * (1.0 - f64::EPSILON));
        asked.iter().enumerate().all(|(axis, asked)| {
            let extent = samples
                .iter()
                .fold(0.0_f64, |most, (p, ..)| most.max((p[axis] - asked.start.position).abs()));
            let fastest = samples.iter().fold(0.0_f64, |most, (_, v, _)| most.max(v[axis].abs()));
            let rounding = 4.0 * f64::EPSILON * asked.start.position.abs().max(asked.goal.position.abs());
            let late = 4.0 * f64::EPSILON * end;
            (positions[axis] - asked.goal.position).abs() <= END * extent + rounding + late * fastest
                && (velocities[axis] - asked.goal.velocity).abs()
                    <= END * fastest + late * asked.bounds.max_acceleration
                && (accelerations[axis] - asked.goal.acceleration).abs()
                    <= END * asked.bounds.max_acceleration + late * asked.bounds.max_jerk
        })
    }
}

/// Alike in both directions; none where the goal is then beyond its bounds, or a start is that was inside, for those are a kind of their own.
fn symmetric(kind: Kind, asked: Question) -> Option<Question> {
    let BoundsSpec { max_velocity, max_acceleration, .. } = asked.bounds;
    let bounds =
        BoundsSpec { min_velocity: -max_velocity, min_acceleration: -max_acceleration, ..asked.bounds };
    let asked = Question { bounds, ..asked };
    let State { velocity, acceleration, .. } = asked.start;
    let leads_to = velocity + 0.5 * acceleration * acceleration.abs() / asked.bounds.max_jerk;
    let inside = velocity.abs().max(leads_to.abs()) <= max_velocity && acceleration.abs() <= max_acceleration;
    let is_one = planner::Transfer::new(asked.start, asked.goal, asked.bounds()).is_ok();
    (is_one && (inside || kind == Kind::Outside)).then_some(asked)
}

#[derive(Default)]
struct Tally {
    asked: u32,
    refused_by_us: u32,
    refused: u32,
    astray: u32,
    slower: u32,
    longer: f64,
}

impl Tally {
    fn see(&mut self, ours: Option<f64>, peer: &mut Peer, asked: &[Question]) {
        self.asked += 1;
        peer.ask(asked);
        let theirs = peer.duration().filter(|&theirs| theirs > 0.0);
        let Some(ours) = ours else {
            self.refused_by_us += 1;
            return;
        };
        if ours < NOTHING {
            return;
        }
        let Some(theirs) = theirs else {
            self.refused += 1;
            return;
        };
        let longer = ours / theirs - 1.0;
        if longer > SLACK {
            assert!(!peer.arrives(asked), "ours {ours}, theirs {theirs}: {asked:?}");
            self.astray += 1;
            return;
        }
        self.longer = self.longer.max(longer);
        self.slower += u32::from(theirs > ours * (1.0 + SLACK));
    }

    fn print(&self, what: &str) {
        let Self { asked, refused_by_us, refused, astray, slower, longer } = self;
        println!("| {what} | {asked} | {refused_by_us} | {refused} | {astray} | {slower} | {longer:.1e} |");
        assert_eq!(*refused_by_us, 0, "{what}");
    }
}

fn one_axis(kind: Kind, count: u32) {
    let mut peer = Peer::new(1);
    let (mut random, mut tally) = (Random(11), Tally::default());
    while tally.asked < count / Kind::ALL.len() as u32 {
        let Some(asked) = symmetric(kind, question(&mut random, kind)) else { continue };
        let ours = plan_transfer(&asked.transfer()).ok().map(|transit| transit.duration());
        tally.see(ours, &mut peer, &[asked]);
    }
    tally.print(&format!("one axis, {kind:?}"));
}

fn several_axes(kind: Kind, count: u32) {
    let mut peers: Vec<Peer> = (2..=7).map(Peer::new).collect();
    let (mut random, mut tally) = (Random(12), Tally::default());
    while tally.asked < count / Kind::ALL.len() as u32 {
        let axes = 2 + random.bits() as usize % 6;
        let drawn = questions(&mut random, kind, axes).into_iter().map(|asked| symmetric(kind, asked));
        let Some(asked) = drawn.collect::<Option<Vec<Question>>>() else { continue };
        let ours = in_time(&asked, &mut Vec::new());
        tally.see(ours, &mut peers[axes - 2], &asked);
    }
    tally.print(&format!("2 to 7 axes, {kind:?}"));
}

/// All at one time.
fn in_time(asked: &[Question], transits: &mut Vec<Transit>) -> Option<f64> {
    let axes: Vec<AxisTransfer<'_>> =
        asked.iter().map(|asked| AxisTransfer::from(asked.transfer())).collect();
    let planned = together(&axes, Synchronization::Time, Timing::default(), transits);
    planned.ok().map(|planned| planned.duration)
}

/// How long each call takes [ns]: the median, and what one in a thousand takes longer than; of each question the least of several calls,
/// since the machine has other things to do.
fn times(count: usize, mut call: impl FnMut(usize)) -> (f64, f64) {
    let mut least = vec![f64::INFINITY; count];
    for _ in 0..20 {
        for (index, least) in least.iter_mut().enumerate() {
            let begin = Instant::now();
            call(index);
            *least = least.min(begin.elapsed().as_nanos() as f64);
        }
    }
    least.sort_unstable_by(f64::total_cmp);
    (least[count / 2], least[count * 999 / 1000])
}

fn speed(axes: usize) {
    let mut random = Random(13);
    let mut asked: Vec<Vec<Question>> = Vec::new();
    while asked.len() < 4000 {
        let drawn = (0..axes).map(|_| symmetric(Kind::Ordinary, question(&mut random, Kind::Ordinary)));
        asked.extend(drawn.collect::<Option<Vec<Question>>>());
    }
    let mut transits = Vec::with_capacity(axes);
    let transfers: Vec<_> = asked.iter().map(|asked| asked[0].transfer()).collect();
    let several: Vec<Vec<AxisTransfer<'_>>> = asked
        .iter()
        .map(|asked| asked.iter().map(|asked| AxisTransfer::from(asked.transfer())).collect())
        .collect();
    let ours = times(asked.len(), |index| {
        if axes == 1 {
            black_box(plan_transfer(black_box(&transfers[index])).is_ok());
        } else {
            let planned =
                together(black_box(&several[index]), Synchronization::Time, Timing::default(), &mut transits);
            black_box(planned.is_ok());
        }
    });
    let mut peer = Peer::new(axes);
    let mut inputs: Vec<InputParameter> = Vec::with_capacity(asked.len());
    for asked in &asked {
        peer.ask(asked);
        inputs.push(std::mem::replace(&mut peer.input, InputParameter::new(axes)));
    }
    let theirs = times(asked.len(), |index| {
        black_box(peer.ruckig.calculate(black_box(&mut inputs[index]), &mut peer.trajectory));
    });
    // The same with nothing to plan: what crossing over to the other language costs.
    let still =
        asked[0].iter().map(|asked| Question { goal: asked.start, start: asked.start, bounds: asked.bounds });
    let mut at_rest = Peer::new(axes);
    at_rest.ask(
        &still
            .map(|asked| Question {
                start: State::at_rest(asked.start.position),
                goal: State::at_rest(asked.start.position),
                ..asked
            })
            .collect::<Vec<_>>(),
    );
    let crossing = times(asked.len(), |_| {
        black_box(at_rest.ruckig.calculate(black_box(&mut at_rest.input), &mut at_rest.trajectory));
    });
    println!(
        "| {axes} | {:.0} / {:.0} | {:.0} / {:.0} | {:.0} | 1/{:.2} |",
        ours.0,
        ours.1,
        theirs.0,
        theirs.1,
        crossing.0,
        theirs.0 / ours.0
    );
}

/// One kind of questions, in a process of its own: on some of them the peer dies.
fn part(axes: &str, kind: usize, count: u32) {
    match axes {
        "1" => one_axis(Kind::ALL[kind], count),
        _ => several_axes(Kind::ALL[kind], count),
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let [axes, kind, count] = arguments.as_slice() {
        return part(axes, kind.parse().unwrap(), count.parse().unwrap());
    }
    let mut counts = arguments.iter().map(|count| count.parse().unwrap());
    let (one, several): (u32, u32) = (counts.next().unwrap_or(1_050_000), counts.next().unwrap_or(105_000));
    println!(
        "| questions | asked | we refuse | the peer refuses | goes astray | is slower | ours longer by at most |"
    );
    println!("|---|---|---|---|---|---|---|");
    for (axes, count) in [("1", one), ("2 to 7", several)] {
        for kind in 0..Kind::ALL.len() {
            let arguments = [axes, &kind.to_string(), &count.to_string()];
            let ended = Command::new(std::env::current_exe().unwrap()).args(arguments).status().unwrap();
            match ended.code() {
                Some(code) => assert_eq!(code, 0, "ours is longer"),
                None => println!("| {axes} axes, {:?} | the peer dies: {ended} | | | | | |", Kind::ALL[kind]),
            }
        }
    }
    println!();
    println!(
        "| axes | ours, median / p99.9 [ns] | Ruckig | of that nothing planned | ratio of the medians |"
    );
    println!("|---|---|---|---|---|");
    speed(1);
    speed(6);
}
