//! The six cases of Blejan and Blejan, and what adding up cycle by cycle does to the end.
//!
//! ```text
//! cargo run -p portamento-planner --example 03_six_cases > ends.csv     # and draws six_cases.svg and incremental.svg
//! ```
//!
//! Source: Blejan and Blejan: *Mathematics for real-time S-curve profile generator*, Hidraulica 4/2020.

#![allow(clippy::print_stdout, reason = "the table is what the example is for")]

mod chart;

use chart::{Chart, NARROW, Panel};
use planner::generator::{AxisLimits, Generator};
use planner::{CycleTime, Limits, Problem, ShortPathPolicy, State, plan_move};

/// Way [m] and limits [m/s, m/s², m/s³] that make each case; the sketches of the paper's section 3.2 have no numbers.
const CASES: [(f64, [f64; 3]); 6] = [
    (0.05, [0.1, 5.0, 100.0]),
    (0.01, [0.5, 5.0, 100.0]),
    (0.008, [0.05, 5.0, 100.0]),
    (0.004, [0.2, 5.0, 100.0]),
    (0.05, [0.25, 3.0, 100.0]),
    (0.05, [0.3, 2.0, 100.0]),
];

/// The paper's four examples: 50 mm in every one; limits [m/s, m/s², m/s³].
const EXAMPLES: [[f64; 3]; 4] =
    [[0.25, 3.0, 100.0], [0.3, 2.0, 100.0], [0.25, 5.0, 100.0], [0.4, 6.4, 100.0]];
const WAY: f64 = 0.05;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let panels = CASES.iter().map(|(way, limits)| case(*way, *limits)).collect::<Result<_, _>>()?;
    Chart {
        title: "From rest to rest, six cases".into(),
        subtitle: "Velocity, acceleration and jerk as parts of their limits; the last is 100 m/s³ everywhere"
            .into(),
        columns: 3,
        panel: NARROW,
        panels,
    }
    .write("six_cases.svg")?;

    println!("example,added up in f32 [mm],added up in f64 [mm],here in f32 [mm]");
    let panels = EXAMPLES.iter().enumerate().map(|(index, limits)| ends(index + 1, *limits));
    Chart {
        title: "Off the exact motion, cycle by cycle".into(),
        subtitle:
            "50 mm in cycles of a millisecond: each setpoint added to the one before it, and each by itself"
                .into(),
        columns: 2,
        panel: NARROW,
        panels: panels.collect::<Result<_, _>>()?,
    }
    .write("incremental.svg")?;
    Ok(())
}

/// One case in parts of its limits.
fn case(way: f64, [velocity, acceleration, jerk]: [f64; 3]) -> Result<Panel, planner::InvalidFields> {
    let limits = Limits::symmetric(velocity, acceleration, jerk)?;
    let problem = Problem::new(State::default(), State::at_rest(way), limits, ShortPathPolicy::Reject)?;
    let planned = plan_move(&problem)?;
    let name = planned.classification().six_case.map_or("", |case| case.name());
    let title = format!(
        "{name}: {} mm in {:.1} ms, {velocity} m/s, {acceleration} m/s²",
        way * 1e3,
        planned.duration() * 1e3
    );
    let mut panel = Panel::new(title, "Time [ms]", "Part of the limit [1]");
    for (name, ink, word, limit) in
        [("jerk", 4, 3, jerk), ("acceleration", 1, 2, acceleration), ("velocity", 0, 1, velocity)]
    {
        let mut points = vec![(0.0, 0.0)];
        let mut begin = 0.0;
        for piece in planned.segments() {
            points.extend((0..=24).map(|index| {
                let t = piece.duration * f64::from(index) / 24.0;
                ((begin + t) * 1e3, piece.at(t).words()[word] / limit)
            }));
            begin += piece.duration;
        }
        points.push((begin * 1e3, 0.0));
        panel.curve(name, ink, points);
    }
    panel.bound(1.0).bound(-1.0);
    Ok(panel)
}

/// How far each way of making setpoints is from the exact motion, over one example.
fn ends(number: usize, limits: [f64; 3]) -> Result<Panel, Box<dyn std::error::Error>> {
    let [velocity, acceleration, jerk] = limits;
    let exact = {
        let limits = Limits::symmetric(velocity, acceleration, jerk)?;
        // To the number that f32 has for 50 mm, so that what is off is not how it was asked.
        let goal = State::at_rest(f64::from(WAY as f32));
        plan_move(&Problem::new(State::default(), goal, limits, ShortPathPolicy::Reject)?)?
    };
    // In millimetres and milliseconds, as the paper has it, with a cycle of one.
    let (v, a, j) = (velocity, acceleration / 1e3, jerk / 1e6);
    let short = added_up_f32(WAY as f32 * 1e3, [v as f32, a as f32, j as f32]);
    let wide = added_up_f64(WAY * 1e3, [v, a, j]);
    let mut generator = Generator::new(
        AxisLimits { velocity: velocity as f32, acceleration: acceleration as f32, jerk: jerk as f32 },
        CycleTime::MILLISECOND,
    )?;
    generator.set_target(WAY as f32)?;
    let mut ours = Vec::new();
    while !generator.is_done() {
        ours.push(f64::from(generator.step().position) * 1e3);
    }
    let off = |positions: &[f64]| -> Vec<(f64, f64)> {
        let at = |index: usize, position: &f64| {
            let cycle = index as f64 + 1.0;
            (cycle, position - exact.at(cycle / 1e3).state.position * 1e3)
        };
        positions.iter().enumerate().map(|(index, position)| at(index, position)).collect()
    };
    let [short, wide, ours] = [&short, &wide, &ours].map(|positions| off(positions));
    let last = |curve: &[(f64, f64)]| curve.last().map_or(0.0, |(_, off)| *off);
    println!("{number},{},{},{}", last(&short), last(&wide), last(&ours));
    let name = exact.classification().six_case.map_or("", |case| case.name());
    let title = format!("Example {number}, case {name}: {:+.2} mm in f32", last(&short));
    let mut panel = Panel::new(title, "Cycle", "Off the exact position [mm]");
    panel.curve("added up, f32", 1, short);
    panel.dashed("added up, f64", 3, wide);
    panel.curve("generator of this crate, f32", 0, ours);
    Ok(panel)
}

/// The generator of the paper's figure 7: each cycle starts from the state of the one before it, under the jerk of that instant.
/// Written for both widths, since the width is the point.
macro_rules! added_up {
    ($name:ident, $width:ty) => {
        fn $name(s: $width, [v_max, a_max, j_max]: [$width; 3]) -> Vec<f64> {
            let t_j = (a_max / j_max).min((v_max / j_max).sqrt()).min((s / (2.0 * j_max)).cbrt());
            let c = s / (j_max * t_j);
            let t_a = t_j.max((v_max / (j_max * t_j)).min(2.0 * c / (t_j + (t_j * t_j + 4.0 * c).sqrt())));
            let t_v = (t_j + t_a).max(s / (j_max * t_j * t_a));
            let ends = [t_j, t_a, t_j + t_a, t_v, t_j + t_v, t_v + t_a, t_v + t_a + t_j];
            let jerks = [j_max, 0.0, -j_max, 0.0, -j_max, 0.0, j_max];
            let (mut p, mut v, mut a, mut t): ($width, $width, $width, $width) = (0.0, 0.0, 0.0, 0.0);
            let mut positions = Vec::new();
            while let Some(phase) = ends.iter().position(|end| t < *end) {
                let j = jerks[phase];
                p += v + a / 2.0 + j / 6.0;
                v += a + j / 2.0;
                a += j;
                t += 1.0;
                positions.push(f64::from(p));
            }
            positions
        }
    };
}

added_up!(added_up_f32, f32);
added_up!(added_up_f64, f64);
