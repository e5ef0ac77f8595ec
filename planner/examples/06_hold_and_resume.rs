//! A move that is held on its way and resumed, and slowed by an override: one row for each cycle, as comma-separated values.
//!
//! ```text
//! cargo run -p portamento-planner --example 06_hold_and_resume > motion.csv
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use planner::motion::{Motion, Operation, Override};
use planner::{
    AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, Request, RequestSpec, ShortPathPolicy, State,
    Synchronization,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let limits =
        LimitsSpec { max_velocity: 0.5, max_acceleration: 2.0, max_jerk: 20.0, ..LimitsSpec::default() };
    let axis = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(0.6),
        limits,
    };
    let request = Request::try_from(RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    })?;
    let mut motion = Motion::open(Judged::answer(&request)?.accepted()?)?;
    let half = Operation::Override(Override::new(0.5)?);
    let operations = [(400, Operation::Hold), (900, Operation::Resume), (1300, half)];
    let mut next = operations.into_iter().peekable();

    println!("cycle,phase,position_m,velocity_m_s,acceleration_m_s2,jerk_m_s3");
    let mut cycle = 0;
    while cycle <= motion.last_cycle() || next.peek().is_some() {
        if let Some((at, operation)) = next.next_if(|(at, _)| *at == cycle) {
            let spliced = motion.splice(at, &operation)?;
            eprintln!("cycle {at}: {operation:?}, at rest from cycle {}", spliced.rest_cycle);
            motion = spliced.motion;
        }
        for setpoint in motion.setpoints(cycle) {
            let [position, velocity, acceleration, jerk] = setpoint.words();
            let phase = motion.phase_at(cycle);
            println!("{cycle},{phase:?},{position},{velocity},{acceleration},{jerk}");
        }
        cycle += 1;
    }
    Ok(())
}
