//! A move from rest to rest, cycle by cycle, as a table for a plotting program.
//!
//! ```text
//! cargo run -p portamento-planner --example 01_rest_to_rest > move.csv
//! ```

#![allow(clippy::print_stdout, reason = "the table is what the example is for")]

use planner::{CycleTime, InvalidFields, Limits, Problem, Setpoint, ShortPathPolicy, State, plan_move};

fn main() -> Result<(), InvalidFields> {
    // 0.4 m at 0.5 m/s, 2 m/s², 20 m/s³.
    let limits = Limits::symmetric(0.5, 2.0, 20.0)?;
    let problem = Problem::new(State::at_rest(0.1), State::at_rest(0.5), limits, ShortPathPolicy::Reject)?;
    let planned = plan_move(&problem)?;

    let cycle = CycleTime::MILLISECOND;
    let last = cycle.count(planned.duration()).unwrap_or_default();
    println!("time,position,velocity,acceleration,jerk");
    for number in 0..=last {
        let time = cycle.start_of(number);
        // The last cycle is the end, though it may be due a rounding before that.
        let setpoint = if number < last { planned.at(time) } else { Setpoint::held(planned.reached()) };
        let [position, velocity, acceleration, jerk] = setpoint.words();
        println!("{time},{position},{velocity},{acceleration},{jerk}");
    }
    Ok(())
}
