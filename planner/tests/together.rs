//! Several axes from any state to any state: 800 problems with the durations of Ruckig 0.19.4 (Berscheid and Kröger, 2021), and
//! rsruckig as a second opinion on problems that are drawn to hurt. More of them:
//!
//! ```text
//! cargo test --release -p portamento-planner --test together -- --ignored --nocapture
//! ```

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may fail by panicking; this one also reports"
)]

mod common;

use common::Random;
use common::axes::{Peer, SEVEN, questions};
use common::peer;
use common::states::{Kind, Question};
use planner::{
    AxisTransfer, BoundsSpec, CycleTime, State, Synchronization, Timing, Together, Transit, Why, together,
    transfer_violations,
};
use serde::Deserialize;

/// Of a duration [1]: how much longer than the peer's ours may be.
const SLACK: f64 = 1e-9;
/// Of the scale of a motion [1]: how far its pieces may be apart, and how far it may end from its goal.
const END: f64 = 1e-12;
/// A time in which nothing moves [s], or as good as nothing.
const NOTHING: f64 = 1e-12;

#[derive(Deserialize)]
struct Record {
    dofs: usize,
    sync: String,
    collinear: bool,
    minimum_duration: Option<f64>,
    p0: Vec<f64>,
    v0: Vec<f64>,
    a0: Vec<f64>,
    pf: Vec<f64>,
    vf: Vec<f64>,
    af: Vec<f64>,
    vmax: Vec<f64>,
    amax: Vec<f64>,
    jmax: Vec<f64>,
    duration: f64,
}

impl Record {
    fn questions(&self) -> Vec<Question> {
        let one = |axis: usize| Question {
            start: State { position: self.p0[axis], velocity: self.v0[axis], acceleration: self.a0[axis] },
            goal: State { position: self.pf[axis], velocity: self.vf[axis], acceleration: self.af[axis] },
            bounds: BoundsSpec {
                min_velocity: -self.vmax[axis],
                max_velocity: self.vmax[axis],
                min_acceleration: -self.amax[axis],
                max_acceleration: self.amax[axis],
                max_jerk: self.jmax[axis],
            },
        };
        (0..self.dofs).map(one).collect()
    }
}

fn transfers(asked: &[Question]) -> Vec<AxisTransfer<'static>> {
    asked.iter().map(|asked| AxisTransfer::from(asked.transfer())).collect()
}

/// Plans, and holds the answer against the judge.
#[track_caller]
fn planned(asked: &[Question], how: Synchronization, timing: Timing) -> (Together, Vec<Transit>) {
    let mut transits = Vec::new();
    let agreed = together(&transfers(asked), how, timing, &mut transits)
        .unwrap_or_else(|refusal| panic!("{refusal}: {asked:?}"));
    assert_eq!(transits.len(), asked.len());
    for (asked_of, transit) in asked.iter().zip(&transits) {
        let found = transfer_violations(&transit.to_profile(), &asked_of.bounds(), asked_of.goal);
        assert_eq!(found, [], "{asked:?}: {transit:?}");
        let off = common::transit::residual(transit, asked_of.bounds.max_jerk);
        assert!(off <= END, "{off:e} apart: {asked:?}: {transit:?}");
        assert_eq!((transit.start(), transit.end()), (asked_of.start, asked_of.goal));
        if how != Synchronization::None {
            let late = (transit.duration() - agreed.duration).abs();
            assert!(late <= 4.0 * f64::EPSILON * agreed.duration, "{late} late: {asked:?}");
        }
    }
    (agreed, transits)
}

fn at_least(minimum_duration: Option<f64>) -> Timing {
    Timing { minimum_duration: minimum_duration.unwrap_or_default(), end_on: None }
}

/// How far axes are from the line between start and goal at worst, of the longest way [1].
fn off_line(asked: &[Question], transits: &[Transit]) -> f64 {
    let ways: Vec<f64> = asked.iter().map(|asked| asked.goal.position - asked.start.position).collect();
    let longest = (0..ways.len()).max_by(|&a, &b| ways[a].abs().total_cmp(&ways[b].abs())).unwrap();
    let mut worst: f64 = 0.0;
    for step in 0..=64 {
        let t = transits[0].duration() * f64::from(step) / 64.0;
        let gone = |axis: usize| transits[axis].at(t).state.position - asked[axis].start.position;
        for axis in 0..asked.len() {
            let off = gone(axis) - gone(longest) * ways[axis] / ways[longest];
            let rounding =
                16.0 * f64::EPSILON * (asked[axis].start.position.abs() + asked[axis].goal.position.abs());
            worst = worst.max((off.abs() - rounding) / ways[longest].abs());
        }
    }
    worst
}

/// The line as a question of its own: the axis that goes farthest, with what all of them allow it.
fn line_of(asked: &[Question]) -> Question {
    let way = |asked: &Question| asked.goal.position - asked.start.position;
    let leader = asked.iter().max_by(|a, b| way(a).abs().total_cmp(&way(b).abs())).unwrap();
    let allowed = |limit: fn(&BoundsSpec) -> f64| {
        asked
            .iter()
            .filter(|asked| way(asked) != 0.0)
            .map(|asked| limit(&asked.bounds) / (way(asked) / way(leader)).abs())
            .fold(f64::INFINITY, f64::min)
    };
    let (velocity, acceleration) =
        (allowed(|bounds| bounds.max_velocity), allowed(|bounds| bounds.max_acceleration));
    let bounds = BoundsSpec {
        min_velocity: -velocity,
        max_velocity: velocity,
        min_acceleration: -acceleration,
        max_acceleration: acceleration,
        max_jerk: allowed(|bounds| bounds.max_jerk),
    };
    let start = State { position: 0.0, ..leader.start };
    let goal = State { position: way(leader), ..leader.goal };
    Question { start, goal, bounds }
}

#[test]
fn never_longer_than_the_records() {
    let records: Vec<Record> = serde_json::from_str(include_str!("vectors/states_axes.json")).unwrap();
    assert_eq!(records.len(), 800);
    let (mut faster, mut on_line, mut left_by_the_peer, mut swept_beyond) = (0, 0, 0, 0);
    let mut line_peer = peer::Peer::new();
    for (index, record) in records.iter().enumerate() {
        let asked = record.questions();
        let timing = at_least(record.minimum_duration);
        let (agreed, _) = planned(&asked, Synchronization::Time, timing);
        if record.collinear {
            // Where one axis alone does not bind all the way, the peer leaves the line; so it is asked for the line itself.
            if let Err(refusal) =
                together(&transfers(&asked), Synchronization::Phase, timing, &mut Vec::new())
            {
                let swept =
                    refusal.as_slice().iter().all(|one| matches!(one.why, Why::StartOutsideLimits { .. }));
                assert!(swept, "{index}: {refusal}");
                swept_beyond += 1;
                continue;
            }
            let (agreed, transits) = planned(&asked, Synchronization::Phase, timing);
            let theirs =
                line_peer.duration(&peer::question(&line_of(&asked))).unwrap().max(timing.minimum_duration);
            assert!(agreed.duration <= theirs * (1.0 + SLACK), "{index}: {agreed:?}, theirs {theirs}");
            assert!(
                agreed.duration >= record.duration * (1.0 - SLACK),
                "{index}: {agreed:?}, theirs {}",
                record.duration
            );
            left_by_the_peer += u32::from(agreed.duration > record.duration * (1.0 + SLACK));
            let off = off_line(&asked, &transits);
            assert!(off <= END, "{index}: {off:e} off the line");
            on_line += 1;
        } else {
            // Where there is no line the peer synchronizes in time.
            assert!(
                agreed.duration <= record.duration * (1.0 + SLACK),
                "{index}: {agreed:?}, theirs {}",
                record.duration
            );
            if record.sync == "phase" {
                let refusal = together(&transfers(&asked), Synchronization::Phase, timing, &mut Vec::new())
                    .unwrap_err();
                assert!(
                    refusal.as_slice().iter().all(|one| matches!(one.why, Why::OffTheLine { .. })),
                    "{refusal}"
                );
            }
        }
        if agreed.duration < record.duration * (1.0 - SLACK) {
            faster += 1;
        }
    }
    assert_eq!((on_line, swept_beyond), (97, 2));
    println!(
        "of {}, ours is shorter in {faster}; of {on_line} lines the peer leaves {left_by_the_peer}",
        records.len()
    );
}

#[derive(Default)]
struct Tally {
    asked: u32,
    refused: u32,
    astray: u32,
    slower: u32,
    slowest: f64,
    longer: f64,
    /// Where another than the slowest axis was critical.
    blocked: u32,
}

fn compare(count: u32, seed: u64) {
    let mut peer = Peer::new();
    for kind in Kind::ALL {
        let (mut random, mut tally) = (Random(seed), Tally::default());
        for _ in 0..count / Kind::ALL.len() as u32 {
            let axes = 2 + random.bits() as usize % (SEVEN - 1);
            let asked = questions(&mut random, kind, axes);
            let (ours, _) = planned(&asked, Synchronization::Time, Timing::default());
            tally.asked += 1;
            let least =
                transfers(&asked).iter().map(|axis| axis.fastest().unwrap().duration()).fold(0.0, f64::max);
            tally.blocked += u32::from(ours.duration > least * (1.0 + SLACK));
            if ours.duration < NOTHING {
                continue;
            }
            let Some(theirs) = peer.duration(&asked).filter(|&theirs| theirs > 0.0) else {
                tally.refused += 1;
                continue;
            };
            let longer = ours.duration / theirs - 1.0;
            if longer > SLACK {
                assert!(!peer.arrives(&asked, END), "ours {ours:?}, theirs {theirs}: {asked:?}");
                tally.astray += 1;
                continue;
            }
            tally.longer = tally.longer.max(longer);
            if theirs > ours.duration * (1.0 + SLACK) {
                tally.slower += 1;
                tally.slowest = tally.slowest.max(theirs / ours.duration);
            }
        }
        let Tally { asked, refused, astray, slower, slowest, longer, blocked } = tally;
        println!(
            "{kind:?}: of {asked}, {blocked} with a blocked interval; the peer refuses {refused}, goes astray in {astray} and is slower in \
             {slower}, at most {slowest:.3} times; ours is longer by at most {longer:.1e}"
        );
    }
}

#[test]
fn never_longer_than_the_peer() {
    compare(10_500, 1);
}

#[test]
#[ignore = "a minute in release"]
fn never_longer_than_the_peer_in_many() {
    compare(350_000, 2);
}

/// A whole number of cycles, the first that there can be.
#[test]
fn ends_on_a_cycle() {
    let cycle = CycleTime::MILLISECOND;
    for kind in Kind::ALL {
        let mut random = Random(3);
        for _ in 0..200 {
            let asked = questions(&mut random, kind, 3);
            let (free, _) = planned(&asked, Synchronization::Time, Timing::default());
            if free.duration > 1e6 {
                continue;
            }
            let timing = Timing { minimum_duration: 0.0, end_on: Some(cycle) };
            let (agreed, _) = planned(&asked, Synchronization::Time, timing);
            let cycles = cycle.count(agreed.duration).unwrap();
            assert!(
                (agreed.duration - cycle.start_of(cycles)).abs() <= 1e-11 * agreed.duration,
                "{agreed:?}: {asked:?}"
            );
            assert!(agreed.duration >= free.duration * (1.0 - 1e-11));
            // Nothing less: each whole number of cycles before it is blocked for one of them.
            let before = cycle.start_of(cycles - cycles.min(1));
            let each_can = transfers(&asked).iter().all(|axis| axis.lasting(before).is_ok());
            assert!(cycles == 0 || !each_can, "{before} would do: {asked:?}");
        }
    }
}
