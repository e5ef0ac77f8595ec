//! A run that somebody looks on at: a bar while it lasts, and what is drawn of it afterwards.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressState, ProgressStyle};
use planner::{Plan, Quantity};
use sim_axis::{Samples, Update};

use crate::show::number::unit;
use crate::show::plot::Tracked;

/// Follows the updates of a run.
pub(crate) struct Watch {
    bar: ProgressBar,
    cycle: f64,
    /// The first axis, if it is to be drawn.
    tracked: Option<Tracked>,
}

impl Watch {
    /// For a run of `plan` whose axes are watched for `settle_window` seconds after it.
    pub(crate) fn new(plan: &Plan, settle_window: f64, drawn: bool) -> Self {
        let cycle = plan.cycle_time().as_seconds();
        let cycles = plan.cycle_count() + (settle_window / cycle) as u64;
        let bar = ProgressBar::new(cycles).with_style(style(cycle));
        let tracked = plan.axes().first().filter(|_| drawn).map(|axis| Tracked {
            axis: axis.axis.clone(),
            unit: unit(axis.kind, Quantity::Position),
            ..Tracked::default()
        });
        Self { bar, cycle, tracked }
    }

    /// Takes one update.
    pub(crate) fn see(&mut self, update: Update) {
        match update {
            Update::Samples(samples) => {
                let last = samples.first_cycle + samples.commanded.cycles() as u64;
                self.bar.set_position(last.saturating_sub(1));
                self.keep(&samples);
            }
            Update::Event(event) => self.bar.set_message(format!("{:?}", event.kind).to_lowercase()),
            Update::Operated(done) => self.bar.set_message(format!("operation {:?} done", done.0.request_id)),
            Update::FailedOver(change) => {
                self.bar.set_message(format!("{}: {} goes on", change.cause.name(), change.to));
            }
        }
    }

    /// What is to be drawn, once the run is over.
    pub(crate) fn finish(self) -> Option<Tracked> {
        self.bar.finish_and_clear();
        self.tracked.map(with_measured_velocity)
    }

    fn keep(&mut self, samples: &Samples) {
        let Some(tracked) = &mut self.tracked else { return };
        for index in 0..samples.commanded.cycles() {
            let Some(setpoint) = samples.commanded.at(0, index) else { return };
            let measured = samples.tracking.measured_position.get(index);
            let error = samples.tracking.following_error.get(index);
            let (Some(measured), Some(error)) = (measured, error) else { return };
            tracked.times.push((samples.first_cycle + index as u64) as f64 * self.cycle);
            tracked.commanded_position.push(setpoint.state.position);
            tracked.commanded_velocity.push(setpoint.state.velocity);
            tracked.commanded_acceleration.push(setpoint.state.acceleration);
            tracked.commanded_jerk.push(setpoint.jerk);
            tracked.measured_position.push(*measured);
            tracked.following_error.push(*error);
        }
    }
}

/// A bar for something that takes `time`, told in milliseconds.
pub(crate) fn waiting(time: Duration) -> ProgressBar {
    ProgressBar::new(u64::try_from(time.as_millis()).unwrap_or(u64::MAX)).with_style(style(1e-3))
}

/// Velocity from the measured positions of the neighbouring cycles.
fn with_measured_velocity(mut tracked: Tracked) -> Tracked {
    let last = tracked.times.len().saturating_sub(1);
    tracked.measured_velocity = (0..tracked.times.len())
        .map(|index| {
            let (before, after) = (index.saturating_sub(1), (index + 1).min(last));
            let time = tracked.times[after] - tracked.times[before];
            let way = tracked.measured_position[after] - tracked.measured_position[before];
            if time > 0.0 { way / time } else { 0.0 }
        })
        .collect();
    tracked
}

fn style(cycle: f64) -> ProgressStyle {
    let template = "  {bar:40} {seconds} of {all} s, {eta_precise} left {msg}";
    // The template is a constant that its test reads.
    ProgressStyle::with_template(template)
        .unwrap_or_else(|_| ProgressStyle::default_bar())
        .with_key("seconds", move |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            let _ = write!(out, "{:.2}", state.pos() as f64 * cycle);
        })
        .with_key("all", move |state: &ProgressState, out: &mut dyn std::fmt::Write| {
            let _ = write!(out, "{:.2}", state.len().unwrap_or_default() as f64 * cycle);
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn velocity_is_the_slope_of_what_was_measured() {
        let tracked = Tracked {
            times: vec![0.0, 0.5, 1.0],
            measured_position: vec![0.0, 1.0, 3.0],
            ..Tracked::default()
        };
        assert_eq!(with_measured_velocity(tracked).measured_velocity, [2.0, 3.0, 4.0]);
    }
}
