//! What a vision system says of a target: where it is and how fast, 20 times a second.
//!
//! Made, not measured: from a seed, with all that makes a tracker's life hard. The target wanders slowly and fast; positions and
//! velocities are noisy, each with noise of its own; a few detections are wrong; at the end the target runs away faster than the
//! axes can follow, and stops dead.

use std::error::Error;
use std::fmt::Write;

/// The time between two commands [s].
pub(crate) const BEAT: f64 = 0.05;
const COMMANDS: usize = 120;

/// The fastest that is reported of a target [m/s]: what the axes can do.
pub(crate) const FASTEST: f64 = 0.5;

/// One command for both axes: when [s], where [m], how fast [m/s].
pub(crate) struct Row {
    pub(crate) time: f64,
    pub(crate) position: [f64; 2],
    pub(crate) velocity: [f64; 2],
}

/// As `portamento pvt --points` reads it: [s], [m], [m/s].
const HEAD: &str = "time,x.position,x.velocity,y.position,y.velocity";

/// Reads what [`table`] writes.
pub(crate) fn read(csv: &str) -> Result<Vec<Row>, Box<dyn Error>> {
    let row = |line: &str| -> Result<Row, Box<dyn Error>> {
        let mut numbers = [0.0; 5];
        let mut cells = line.split(',');
        for number in &mut numbers {
            *number = cells.next().ok_or("a row has five cells")?.parse()?;
        }
        let [time, x, x_velocity, y, y_velocity] = numbers;
        Ok(Row { time, position: [x, y], velocity: [x_velocity, y_velocity] })
    };
    csv.lines().skip(1).map(row).collect()
}

/// The recording as text: micrometres and micrometres per second, as a camera with 10 µm pixels would have them.
pub(crate) fn table() -> Result<String, std::fmt::Error> {
    let mut text = format!("{HEAD}\n");
    for Row { time, position: [x, y], velocity: [x_velocity, y_velocity] } in recorded() {
        writeln!(text, "{time:.2},{x:.6},{x_velocity:.6},{y:.6},{y_velocity:.6}")?;
    }
    Ok(text)
}

fn recorded() -> Vec<Row> {
    let mut noise = Noise(2022);
    let mut truth = [0.0, 0.0];
    let mut rows = Vec::with_capacity(COMMANDS);
    for command in 1..=COMMANDS {
        let time = command as f64 * BEAT;
        // The way of the target over the beat, by its velocity in the middle.
        let middle = speeds(time - 0.5 * BEAT);
        let (mut position, mut velocity) = ([0.0; 2], speeds(time));
        for axis in 0..2 {
            truth[axis] += middle[axis] * BEAT;
            position[axis] = truth[axis] + 1.2e-4 * noise.normal() + wrong(axis, command);
            velocity[axis] = (velocity[axis] + 3e-3 * noise.normal()).clamp(0.0, FASTEST);
        }
        if command == COMMANDS {
            velocity = [0.0; 2];
        }
        rows.push(Row { time, position, velocity });
    }
    rows
}

/// How fast the target is [m/s].
fn speeds(time: f64) -> [f64; 2] {
    use std::f64::consts::TAU;
    if time > 5.0 {
        return [0.8, 0.65];
    }
    let x = 0.24 - 0.2 * (TAU * time / 2.9).cos();
    let y = 0.14 + 0.1 * (TAU * time / 2.1).sin() * (time / 0.8).min(1.0);
    [x * (time / 0.4).min(1.0), y * (time / 0.4).min(1.0)]
}

/// Detections of something else [m].
fn wrong(axis: usize, command: usize) -> f64 {
    match (axis, command) {
        (0, 30) | (1, 76) => 3e-3,
        (0, 57..=59) => -2.5e-3,
        (0, 60) | (1, 33) => -4e-3,
        (1, 34) => -2e-3,
        (1, 90..=92) => 1.5e-3,
        _ => 0.0,
    }
}

/// SplitMix64 (Steele, Lea and Flood, 2014).
struct Noise(u64);

impl Noise {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        (z >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Of unit variance: twelve uniform numbers are normal enough.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}
