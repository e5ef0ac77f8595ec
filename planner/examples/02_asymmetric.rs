//! Acceleration against deceleration: the four simulations of Li and Chen, each beside the symmetric S-curve.
//!
//! ```text
//! cargo run -p portamento-planner --example 02_asymmetric > asymmetric.csv     # and draws asymmetric.svg
//! ```
//!
//! Source: Li and Chen, *Asymmetric S-type curve acceleration and deceleration control based on the position*. The paper prints
//! 20 000 for the greatest velocity; its results are those of 200 000 (`notes/0005-asymmetric.md`).

#![allow(clippy::print_stdout, reason = "the table is what the example is for")]

mod chart;

use chart::{Chart, NARROW, Panel};
use planner::{Limits, LimitsSpec, Move, Problem, ShortPathPolicy, State, plan_move};

const ACCELERATION: f64 = 100e3;
const DECELERATION: f64 = 160e3;
const JERK: f64 = 160e3;
const VELOCITY: f64 = 200e3;

/// Way to go [pulses]; the duration [s] and peak velocity [pulses/s] that the paper prints for asymmetric limits, and for symmetric ones.
const SIMULATIONS: [(f64, [f64; 2], [f64; 2]); 4] = [
    (600e3, [5.437, 200e3], [5.625, 200e3]),
    (480e3, [4.84, 198e3], [5.05, 190e3]),
    (300e3, [4.038, 149e3], [4.145, 145e3]),
    (30e3, [1.817, 33e3], [1.817, 33e3]),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("length,asymmetric,printed,peak,printed,symmetric,printed,peak,printed,type");
    let mut rows = [Vec::new(), Vec::new(), Vec::new()];
    for (length, printed, printed_symmetric) in SIMULATIONS {
        let (asymmetric, symmetric) = (plan(length, DECELERATION)?, plan(length, ACCELERATION)?);
        let names = asymmetric.classification();
        let kind = names.asymmetric_type.map_or("", |kind| kind.name());
        println!(
            "{length},{},{},{},{},{},{},{},{},{kind}",
            asymmetric.duration(),
            printed[0],
            names.feed_rate,
            printed[1],
            symmetric.duration(),
            printed_symmetric[0],
            symmetric.classification().feed_rate,
            printed_symmetric[1],
        );
        let saved = symmetric.duration() - asymmetric.duration();
        let title = format!("Type {kind}, {length} pulses: {:.4} s, saves {saved:.4}", asymmetric.duration());
        let quantities =
            [("Velocity [pulses/s]", 1), ("Acceleration [pulses/s²]", 2), ("Jerk [pulses/s³]", 3)];
        for (row, (up, word)) in rows.iter_mut().zip(quantities) {
            let mut panel = Panel::new(title.clone(), "Time [s]", up);
            panel.dashed("symmetric", 4, curve(&symmetric, word));
            panel.curve("asymmetric", 1, curve(&asymmetric, word));
            row.push(panel);
        }
    }
    let chart = Chart {
        title: "Faster where braking may be harder than speeding up".into(),
        subtitle: format!(
            "{VELOCITY} pulses/s, {ACCELERATION} up and {DECELERATION} pulses/s² down, {JERK} pulses/s³"
        ),
        columns: SIMULATIONS.len(),
        panel: NARROW,
        panels: rows.into_iter().flatten().collect(),
    };
    Ok(chart.write("asymmetric.svg")?)
}

fn plan(length: f64, deceleration: f64) -> Result<Move, planner::InvalidFields> {
    let limits = Limits::try_from(LimitsSpec {
        max_velocity: VELOCITY,
        max_acceleration: ACCELERATION,
        max_deceleration: Some(deceleration),
        max_jerk: JERK,
        ..LimitsSpec::default()
    })?;
    plan_move(&Problem::new(State::default(), State::at_rest(length), limits, ShortPathPolicy::Reject)?)
}

/// One derivative over time: both ends of each piece, and points between.
fn curve(planned: &Move, word: usize) -> Vec<(f64, f64)> {
    const POINTS: u32 = 24;
    let mut points = vec![(0.0, 0.0)];
    let mut begin = 0.0;
    for piece in planned.segments() {
        points.extend((0..=POINTS).map(|index| {
            let t = piece.duration * f64::from(index) / f64::from(POINTS);
            (begin + t, piece.at(t).words()[word])
        }));
        begin += piece.duration;
    }
    points.push((begin, 0.0));
    points
}
