//! Two axes track a target that a camera sees 20 times a second: the experiment of the paper on position, velocity and time
//! (doi:10.1177/17298814211072418), its figures 9 to 14 and its table of times.
//!
//! ```text
//! cargo run --release -p portamento-planner --example 05_pvt                                      # the table
//! cargo run --release -p portamento-planner --example 05_pvt -- planner/examples/05_pvt           # README.md and its figures
//! cargo run -p portamento-planner --example 05_pvt -- --record                # the recording, as it was made
//! ```
//! The paper's recording and limits are not printed there; `recording.csv` is made from a seed by `recording.rs`.

#![allow(clippy::print_stdout, reason = "the table is what the example is for")]

#[path = "../chart/mod.rs"]
mod chart;
mod recording;

use std::error::Error;
use std::fmt::Write as _;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use chart::{Chart, Panel, WIDE};
use planner::{
    AxisKind, AxisPlan, Judged, Limits, PvtAxisSpec, PvtInterpolation, PvtPlan, PvtPlanner, PvtPolicy,
    PvtRequest, PvtRequestSpec, PvtTarget, Quantity, Segment, Setpoint, State, plan_pvt,
};
use recording::{BEAT, FASTEST, Row};

const RECORDING: &str = include_str!("recording.csv");
const AXES: [&str; 2] = ["x", "y"];
/// Each method with the number of its figure for the first axis.
const METHODS: [(PvtInterpolation, &str, usize); 3] = [
    (PvtInterpolation::SShaped, "S-shaped", 9),
    (PvtInterpolation::Cubic, "cubic", 11),
    (PvtInterpolation::Quintic, "quintic", 13),
];

fn main() -> Result<(), Box<dyn Error>> {
    let argument = std::env::args().nth(1);
    if argument.as_deref() == Some("--record") {
        print!("{}", recording::table()?);
        return Ok(());
    }
    let rows = recording::read(RECORDING)?;
    let mut table = format!(
        "{} commands for each of {} axes, one every {} ms\n\n\
         method    axis  velocity       acceleration   jerk           reversals   adjusted\n",
        rows.len(),
        AXES.len(),
        BEAT * 1e3
    );
    let mut figures = String::new();
    for (interpolation, name, number) in METHODS {
        let planned = plan_pvt(&request(&rows, interpolation)?)?;
        let adjusted = |axis| {
            let points = planned.points().iter().filter(|report| report.axis == axis);
            points.filter(|report| !report.adjustments.is_empty()).count()
        };
        let adjusted = [adjusted(0), adjusted(1)];
        write_extremes(&mut table, name, &planned, adjusted)?;
        if let Some(folder) = &argument {
            std::fs::create_dir_all(folder)?;
            for (index, axis) in planned.plan().axes().iter().enumerate() {
                let figure = draw(axis, name, &rows, index, adjusted[index]);
                let file = format!("figure_{:02}_{}_{name}.svg", number + index, axis.axis);
                writeln!(figures, "![Axis {}, {name}]({file})", axis.axis)?;
                std::fs::write(Path::new(folder).join(file), figure)?;
            }
        }
    }
    write_times(&mut table, &rows)?;
    print!("{table}");
    if let Some(folder) = &argument {
        let text = README.replace("TABLE\n", &table).replace("FIGURES\n", &figures);
        std::fs::write(Path::new(folder).join("README.md"), text)?;
    }
    Ok(())
}

/// What the folder shows to whoever opens it.
const README: &str = "\
# Two axes after a target

A camera sees a target twenty times a second and says where it is and how fast: positions and velocities are noisy, a few
detections are wrong, and at the end the target runs away faster than the axes can follow, and stops dead. Each command is to
be met after 50 ms. The experiment is that of doi:10.1177/17298814211072418, its figures 9 to 14 and its table of times; the
recording and the limits are not printed there, so `recording.csv` is made from a seed by `recording.rs`.

Extremes as parts of the limits, and times of the machine that wrote this. The worst of all runs has in it whatever interrupted the
process; in the last column each command counts with the best of its runs, which is what the planner itself takes at worst:

```text
TABLE
```

S-shaped motion keeps every limit and says what it does not meet; cubics and quintics meet everything and keep no limit.

FIGURES

Written by

```sh
cargo run --release -p portamento-planner --example 05_pvt -- planner/examples/05_pvt
```

and to look at every point, with its region and what could be reached:

```sh
cargo run --release -- pvt --points planner/examples/05_pvt/recording.csv --finish-unreached \\
    --max-velocity 0.5 --max-acceleration 4 --max-jerk 160 --plot points.svg
```
";

fn limits() -> Result<Limits, planner::InvalidFields> {
    Limits::symmetric(FASTEST, 4.0, 160.0)
}

fn request(rows: &[Row], interpolation: PvtInterpolation) -> Result<PvtRequest, Box<dyn Error>> {
    let limits = limits()?.spec().clone();
    let axis = |(index, name): (usize, &&str)| PvtAxisSpec {
        axis: (*name).into(),
        kind: Ok(AxisKind::Prismatic),
        limits: limits.clone(),
        start: State::at_rest(0.0),
        times: rows.iter().map(|row| row.time).collect(),
        positions: rows.iter().map(|row| row.position[index]).collect(),
        velocities: rows.iter().map(|row| row.velocity[index]).collect(),
    };
    Ok(PvtRequest::try_from(PvtRequestSpec {
        axes: AXES.iter().enumerate().map(axis).collect(),
        cycle_time_ns: None,
        interpolation: Ok(interpolation),
        policy: Ok(PvtPolicy::PreferVelocity),
        finish_unreached: true,
    })?)
}

/// What the judge finds: each extreme, as a part of its limit.
fn write_extremes(
    table: &mut String,
    name: &str,
    planned: &PvtPlan,
    adjusted: [usize; 2],
) -> std::fmt::Result {
    let judged = Judged::new(planned.plan().clone());
    for (index, axis) in planned.plan().axes().iter().enumerate() {
        let cell = |quantity| {
            let mut checks = judged.certificate().limits.iter();
            let check = checks.find(|check| *check.axis == *axis.axis && check.quantity == quantity);
            check.map_or_else(String::new, |check| {
                let part = 100.0 * (1.0 - check.margin);
                if part.is_infinite() {
                    "jumps".into()
                } else {
                    // Rounding is not worth a word.
                    format!("{part:.0} %{}", if check.margin < -1e-9 { " BROKEN" } else { "" })
                }
            })
        };
        writeln!(
            table,
            "{name:<10}{:<6}{:<15}{:<15}{:<15}{:<12}{}",
            axis.axis,
            cell(Quantity::Velocity),
            cell(Quantity::Acceleration),
            cell(Quantity::Jerk),
            axis.profile.reversals().count(),
            adjusted[index]
        )?;
    }
    Ok(())
}

/// One command at a time, as they come: what each takes, the reading of the clock included.
///
/// The worst of all runs is that of a process among others, which are let in now and then. What interrupts one run does not interrupt the
/// same command in all of them: so the worst command in the best of its runs is shown beside it, the planner's own.
fn write_times(table: &mut String, rows: &[Row]) -> Result<(), Box<dyn Error>> {
    let (commands, processors) = (AXES.len() * rows.len(), std::thread::available_parallelism()?);
    let clock = (0..ROUNDS).map(|_| Instant::now().elapsed().as_nanos()).min().unwrap_or_default();
    writeln!(
        table,
        "\ntime for one command [ns]: all {ROUNDS} runs of {commands} commands, by the monotonic clock, whose reading takes\n\
         {clock} ns of it; {processors} processors, {}\n\n\
         {:<10}{:>8}{:>8}{:>8}   worst, each in its best run",
        std::env::consts::ARCH,
        "method",
        "mean",
        "p99.9",
        "worst",
    )?;
    for (interpolation, name, _) in METHODS {
        let mut took = times(rows, interpolation)?;
        let quiet =
            (0..commands).filter_map(|command| took.iter().skip(command).step_by(commands).min()).max();
        let quiet = quiet.copied().unwrap_or_default();
        took.sort_unstable();
        let mean = took.iter().map(|took| u64::from(*took)).sum::<u64>() as f64 / took.len() as f64;
        let (tail, worst) = (took[took.len() * 999 / 1000], took[took.len() - 1]);
        writeln!(table, "{name:<10}{mean:>8.0}{tail:>8}{worst:>8}{quiet:>8}")?;
    }
    writeln!(table, "{:<10}{:>8}{:>8}{:>8}", "the paper", 1562, "-", 10523)?;
    Ok(())
}

/// How often all commands are planned.
const ROUNDS: usize = 1000;

/// How long each command of each run took \[ns\], run by run; the first few runs are not among them, so that code and data are there.
fn times(rows: &[Row], interpolation: PvtInterpolation) -> Result<Vec<u32>, Box<dyn Error>> {
    const WARM: usize = 20;
    let mut took = Vec::with_capacity(ROUNDS * AXES.len() * rows.len());
    for round in 0..WARM + ROUNDS {
        for axis in 0..AXES.len() {
            let mut state = State::at_rest(0.0);
            let mut planner = PvtPlanner::new(state, limits()?, PvtPolicy::PreferVelocity)?;
            for row in rows {
                let (position, velocity) = (row.position[axis], row.velocity[axis]);
                let target = black_box(PvtTarget { position, velocity, duration: BEAT });
                let begin = Instant::now();
                if let Some(piece) = target.joined_from(state, interpolation) {
                    black_box(piece);
                } else {
                    black_box(planner.command(target))?;
                }
                let nanoseconds = begin.elapsed().as_nanos();
                state = State { position, velocity, acceleration: 0.0 };
                if round >= WARM {
                    took.push(u32::try_from(nanoseconds).unwrap_or(u32::MAX));
                }
            }
        }
    }
    Ok(took)
}

/// Position, velocity, acceleration and jerk over time.
fn draw(axis: &AxisPlan, name: &str, rows: &[Row], index: usize, adjusted: usize) -> String {
    let profile = &axis.profile;
    let mut curves: [Vec<(f64, f64)>; 4] = Default::default();
    for (begin, segment) in profile.timed_segments() {
        for (time, setpoint) in samples(&segment) {
            for (curve, value) in curves.iter_mut().zip(setpoint.words()) {
                curve.push((begin + time, value));
            }
        }
    }
    let limits = &axis.limits;
    let dots = |value: fn(&Row, usize) -> f64| rows.iter().map(|row| (row.time, value(row, index))).collect();
    let commanded: [Vec<(f64, f64)>; 4] =
        [dots(|row, axis| row.position[axis]), dots(|row, axis| row.velocity[axis]), vec![], vec![]];
    let bounds = [None, Some(limits.velocity_forward()), Some(limits.acceleration()), Some(limits.jerk())];
    let titles = [("position", "[m]"), ("velocity", "[m/s]"), ("acceleration", "[m/s²]"), ("jerk", "[m/s³]")];
    let panels = titles.into_iter().zip(curves).zip(commanded.into_iter().zip(bounds));
    let panels = panels.map(|(((title, unit), curve), (commanded, bound))| {
        let mut panel = Panel::new(title, "time [s]", unit);
        panel.curve("planned", 0, curve);
        if !commanded.is_empty() {
            panel.dots("commanded", 1, commanded);
        }
        let turns: Vec<_> = profile.reversals().map(|time| (time, profile.at(time).state)).collect();
        if title == "position" && !turns.is_empty() {
            panel.dots("turns back", 2, turns.iter().map(|(time, state)| (*time, state.position)).collect());
        }
        for bound in bound.into_iter().flat_map(|bound| [-bound, bound]) {
            panel.bound(bound);
        }
        panel
    });
    let chart = Chart {
        title: format!("Axis {}, {name}", axis.axis),
        subtitle: format!(
            "dots: commands every {} ms, {adjusted} of {} adjusted; dashed: limits; reversals: {}",
            BEAT * 1e3,
            rows.len(),
            profile.reversals().count()
        ),
        columns: 1,
        panel: WIDE,
        panels: panels.collect(),
    };
    chart.svg()
}

/// Both ends of a piece and what lies between, closer than the pixels of a figure are.
fn samples(segment: &Segment) -> impl Iterator<Item = (f64, Setpoint)> {
    const STEP: f64 = 6e-3;
    let steps = (segment.duration / STEP).ceil().max(1.0) as u32;
    (0..=steps).map(move |step| {
        let time = segment.duration * f64::from(step) / f64::from(steps);
        (time, segment.at(time))
    })
}
