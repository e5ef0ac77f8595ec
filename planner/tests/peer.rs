//! rsruckig as a second opinion: on feasible problems with speeds along the travel, it is never faster.
//!
//! Two millions of them, with what the peer does otherwise, takes a few seconds:
//!
//! ```text
//! cargo test --release -p portamento-planner --test peer -- --ignored --nocapture
//! ```

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test may fail by panicking; this one also reports"
)]

mod common;

use common::Random;
use common::moves::{self, Draw};
use common::peer::{self, Peer};
use planner::{Problem, plan_move, violations};

/// Of a duration [1]: how much longer than the peer's ours may be. The peer itself is content with 1e-9 of the distance.
const SLACK: f64 = 1e-9;
/// Of a duration [1]: from here on the peer's is counted as longer, not as rounded.
const SLOWER: f64 = 1e-9;

#[derive(Default)]
struct Tally {
    asked: u32,
    refused: u32,
    slower: u32,
    slowest: f64,
    /// The largest by which ours is longer, of the peer's.
    longer: f64,
    /// The largest gap between two pieces, or the last and the goal, of the path.
    residual: f64,
    /// A few that the peer refuses or takes long over.
    examples: Vec<String>,
}

impl Tally {
    fn ask(&mut self, peer: &mut Peer, problem: &Problem) {
        let ours = plan_move(problem).unwrap();
        let profile = ours.to_profile();
        assert_eq!(violations(&profile, problem.limits(), problem.goal()), []);
        self.asked += 1;
        let segments = ours.segments();
        let begins = segments.iter().skip(1).map(|next| next.start.position);
        let ends = segments.iter().map(|segment| segment.end().position);
        let gaps = ends.zip(begins.chain([problem.goal().position])).map(|(end, begin)| (end - begin).abs());
        let residual = gaps.fold(0.0, f64::max) / problem.distance().abs();
        self.residual = self.residual.max(residual);
        let example = |what: String| {
            let (from, to, limits) = (problem.start(), problem.goal(), problem.limits());
            format!(
                "{what}: {} at {} to {} at {}, v {} a {} d {} j {}",
                from.position,
                from.velocity,
                to.position,
                to.velocity,
                limits.velocity_forward(),
                limits.acceleration(),
                limits.deceleration(),
                limits.jerk(),
            )
        };
        // To the peer a path of 1e-9 may be none, whatever the unit: no time is no answer to it.
        let theirs = peer.duration(&peer::input(problem)).filter(|&theirs| theirs > 0.0);
        let Some(theirs) = theirs else {
            self.refused += 1;
            if self.refused <= 3 {
                self.examples.push(example("refused".into()));
            }
            return;
        };
        let longer = ours.duration() / theirs - 1.0;
        self.longer = self.longer.max(longer);
        assert!(longer <= SLACK, "{}", example(format!("ours {}, theirs {theirs}", ours.duration())));
        if theirs > ours.duration() * (1.0 + SLOWER) {
            self.slower += 1;
            self.slowest = self.slowest.max(theirs / ours.duration());
            if self.slower <= 3 {
                self.examples.push(example(format!("theirs {} times ours", theirs / ours.duration())));
            }
        }
    }
}

fn compare(count: u32, seed: u64) {
    let mut peer = Peer::new();
    for (name, rest_to_rest, asymmetric, wide) in [
        ("rest to rest, order one", true, false, false),
        ("rest to rest, six decades", true, false, true),
        ("start and end velocity, order one", false, false, false),
        ("start and end velocity, six decades", false, false, true),
        ("asymmetric, rest to rest, order one", true, true, false),
        ("asymmetric, rest to rest, six decades", true, true, true),
        ("asymmetric, start and end velocity, order one", false, true, false),
        ("asymmetric, start and end velocity, six decades", false, true, true),
    ] {
        let draw = Draw { rest_to_rest, asymmetric, wide };
        let mut random = Random(seed);
        let mut tally = Tally::default();
        for _ in 0..count / 8 {
            tally.ask(&mut peer, &moves::problem(&mut random, draw));
        }
        let Tally { asked, refused, slower, slowest, longer, residual, examples } = tally;
        println!(
            "{name}: of {asked}, the peer refuses {refused} and is slower in {slower}, at most {slowest:.3} times; \
             ours is longer by at most {longer:.1e}, and its pieces are {residual:.1e} of the path apart"
        );
        for example in examples {
            println!("  {example}");
        }
    }
}

#[test]
fn never_longer_than_the_peer() {
    compare(20_000, 1);
}

#[test]
#[ignore = "a few seconds in release"]
fn never_longer_than_the_peer_in_two_millions() {
    compare(2_000_000, 2);
}
