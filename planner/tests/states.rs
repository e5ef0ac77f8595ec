//! From any state to any state: 2858 problems with the durations of Ruckig 0.19.4 (Berscheid and Kröger, 2021), and problems
//! that it refuses although they are valid. Then rsruckig as a second opinion on problems that are drawn to hurt.
//!
//! A million of them, with what the peer does otherwise, takes a minute:
//!
//! ```text
//! cargo test --release -p portamento-planner --test states -- --ignored --nocapture
//! ```
//!
//! What is accepted where the peer's duration is less: that its motion ends elsewhere, by more than ours may (`astray`; almost all with
//! ways of 1e-9 and less, of which it takes some for none). What is counted where it is more: its brake goes on until the velocity is at
//! its limit, comes in with an acceleration and undershoots; and on the last flank of a motion that passes its goal at speed, a
//! rounding sends it round once more.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may fail by panicking; this one also reports"
)]

mod common;

use std::collections::BTreeMap;

use common::Random;
use common::peer::{self, Peer};
use common::states::{self, Kind, Question};
use common::vectors;
use planner::{Bounds, State, Transfer, Transit, plan_transfer, transfer_violations};

/// Of a duration [1]: how much longer than the peer's ours may be.
const SLACK: f64 = 1e-9;
/// Of the scale of a motion [1]: how far its pieces may be apart, and how far it may end from its goal.
const END: f64 = 1e-12;

/// A time in which nothing moves [s], or as good as nothing: there the peer's answer is its rounding.
const NOTHING: f64 = 1e-12;

/// Plans, and holds the answer against the judge and against what a double can do.
#[track_caller]
fn planned(name: &str, start: State, goal: State, bounds: Bounds) -> Transit {
    let transfer = Transfer::new(start, goal, bounds).unwrap_or_else(|refusal| panic!("{name}: {refusal}"));
    let transit = plan_transfer(&transfer).unwrap_or_else(|refusal| panic!("{name}: {refusal}"));
    assert_eq!(transfer_violations(&transit.to_profile(), &bounds, goal), [], "{name}: {transit:?}");
    let off = common::transit::residual(&transit, bounds.spec().max_jerk);
    assert!(off <= END, "{name}: {off:e} of its scale apart: {transit:?}");
    transit
}

#[test]
fn never_longer_than_the_records() {
    let records = vectors::records();
    let mut tally: BTreeMap<&str, (u32, u32, u32, f64)> = BTreeMap::new();
    for (index, record) in records.iter().enumerate() {
        let name = format!("record {index} ({})", record.kind);
        let bounds = record.bounds().try_into().unwrap();
        let ours = planned(&name, record.start(), record.goal(), bounds).duration();
        let (asked, refused, slower, slowest) = tally.entry(&record.kind).or_default();
        *asked += 1;
        match record.duration.filter(|_| record.result == 0) {
            Some(theirs) => {
                assert!(ours <= theirs * (1.0 + SLACK), "{name}: ours {ours}, theirs {theirs}");
                if theirs > ours * (1.0 + SLACK) {
                    *slower += 1;
                    *slowest = slowest.max(theirs / ours);
                }
            }
            None => *refused += 1,
        }
    }
    for (kind, (asked, refused, slower, slowest)) in tally {
        println!(
            "{kind}: of {asked}, the peer refuses {refused} and is slower in {slower}, at most {slowest:.3} times"
        );
    }
}

#[test]
fn what_the_peer_refuses() {
    for (index, failure) in vectors::failures().iter().enumerate() {
        for axis in 0..failure.axes() {
            let name = format!("failure {index}, axis {axis} (kind {})", failure.kind);
            let bounds =
                Bounds::symmetric(failure.vmax[axis], failure.amax[axis], failure.jmax[axis]).unwrap();
            planned(&name, failure.start(axis), failure.goal(axis), bounds);
        }
    }
}

/// What became of the questions of one kind.
#[derive(Default)]
struct Tally {
    asked: u32,
    refused: u32,
    /// The peer is faster and does not arrive.
    astray: u32,
    slower: u32,
    slowest: f64,
    /// The largest by which ours is longer, of the peer's.
    longer: f64,
    apart: f64,
    examples: Vec<String>,
}

impl Tally {
    fn ask(&mut self, peer: &mut Peer, asked: &Question) {
        let name = format!("{asked:?}");
        let ours = planned(&name, asked.start, asked.goal, asked.bounds());
        self.asked += 1;
        self.apart = self.apart.max(common::transit::residual(&ours, asked.bounds.max_jerk));
        let theirs = peer.duration(&peer::question(asked));
        if ours.duration() < NOTHING {
            return;
        }
        // To the peer a path of 1e-9 may be none: no time is no answer to it.
        let Some(theirs) = theirs.filter(|&theirs| theirs > 0.0) else {
            self.refused += 1;
            if self.examples.len() < 2 {
                self.examples.push(format!("refused: {name}"));
            }
            return;
        };
        let longer = ours.duration() / theirs - 1.0;
        if longer > SLACK {
            assert!(!peer.arrives(asked, END), "ours {}, theirs {theirs}: {name}\n{ours:?}", ours.duration());
            self.astray += 1;
            if self.astray == 1 {
                self.examples.push(format!("astray: theirs {theirs}, ours {}: {name}", ours.duration()));
            }
            return;
        }
        self.longer = self.longer.max(longer);
        if theirs > ours.duration() * (1.0 + SLACK) {
            self.slower += 1;
            if theirs / ours.duration() > self.slowest {
                self.slowest = theirs / ours.duration();
                self.examples.truncate(2);
                self.examples.push(format!("theirs {theirs}, ours {}: {name}", ours.duration()));
            }
        }
    }
}

/// `most_astray`: in how many of each kind the peer may be faster, as it does not arrive.
fn compare(count: u32, seed: u64, most_astray: [u32; Kind::ALL.len()]) {
    let mut peer = Peer::new();
    let mut counted = [0; Kind::ALL.len()];
    for (kind, counted) in Kind::ALL.into_iter().zip(&mut counted) {
        let mut random = Random(seed);
        let mut tally = Tally::default();
        for _ in 0..count / Kind::ALL.len() as u32 {
            tally.ask(&mut peer, &states::question(&mut random, kind));
        }
        let Tally { asked, refused, astray, slower, slowest, longer, apart, examples } = tally;
        println!(
            "{kind:?}: of {asked}, the peer refuses {refused}, goes astray in {astray} and is slower in {slower}, at most \
             {slowest:.3} times; ours is longer by at most {longer:.1e}, and its pieces are {apart:.1e} apart"
        );
        for example in examples {
            println!("  {example}");
        }
        *counted = astray;
    }
    let known = counted.iter().zip(&most_astray).all(|(counted, most)| counted <= most);
    assert!(known, "the peer is faster and does not arrive in {counted:?}, known are {most_astray:?}");
}

#[test]
fn never_longer_than_the_peer() {
    compare(14_000, 1, [0, 2, 0, 0, 56, 0, 0]);
}

#[test]
#[ignore = "a minute in release"]
fn never_longer_than_the_peer_in_a_million() {
    compare(1_050_000, 2, [0, 6, 0, 2, 4419, 0, 0]);
}
