//! The stepped form in a control loop: there, and back, as a table for a plotting program.
//!
//! ```text
//! cargo run -p portamento-planner --example 04_generator > generator.csv
//! ```

#![allow(clippy::print_stdout, reason = "the table is what the example is for")]

use planner::CycleTime;
use planner::generator::{AxisLimits, Generator};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // The first example of Blejan and Blejan (2020): 50 mm at 0.25 m/s, 3 m/s², 100 m/s³, in the width that they use.
    let limits = AxisLimits { velocity: 0.25_f32, acceleration: 3.0, jerk: 100.0 };
    let mut generator = Generator::new(limits, CycleTime::MILLISECOND)?;

    println!("cycle,position,velocity,acceleration,jerk,case");
    let mut targets = [0.05, 0.0].into_iter();
    for cycle in 1.. {
        if generator.is_done() {
            let Some(target) = targets.next() else { break };
            generator.set_target(target)?;
        }
        let setpoint = generator.step();
        let case = generator.case().map_or("", |case| case.name());
        let planner::generator::Setpoint { position, velocity, acceleration, jerk } = setpoint;
        println!("{cycle},{position},{velocity},{acceleration},{jerk},{case}");
    }
    Ok(())
}
