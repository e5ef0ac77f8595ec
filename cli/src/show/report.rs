//! How well axes followed, as a table.

use std::io;

use planner::{AxisKind, Plan, Quantity};
use sim_axis::{ReportCard, StreamReport, TrackingReport};

use crate::show::number::{counted, plain, unit};
use crate::show::paint::{Screen, clean, wrapped};

/// What is written before a value [characters].
const LABEL: usize = 24;

/// The report of a run.
pub(crate) fn tracking(screen: &mut Screen<'_>, plan: &Plan, report: &TrackingReport) -> io::Result<()> {
    let TrackingReport { axes, stream } = report;
    for card in axes {
        let kind = plan.axes().iter().find(|axis| axis.axis == card.axis).map(|axis| axis.kind);
        axis(screen, card, kind.unwrap_or(AxisKind::Prismatic))?;
        writeln!(screen.out)?;
    }
    stream_report(screen, plan, stream)
}

fn axis(screen: &mut Screen<'_>, card: &ReportCard, kind: AxisKind) -> io::Result<()> {
    let ReportCard {
        axis,
        max_following_error,
        max_following_error_time,
        rms_following_error,
        overshoot,
        settling_time,
        residual_vibration_amplitude,
        residual_vibration_frequency,
        max_effort,
        effort_saturated_time,
    } = card;
    let length = |value: f64| in_small(value, kind);
    let effort = match kind {
        AxisKind::Revolute => "N m",
        AxisKind::Prismatic | AxisKind::Pulses => "N",
    };
    let settled = match settling_time {
        Some(0.0) => "at once".to_owned(),
        Some(time) => format!("{} ms after the last setpoint", plain(time * 1e3)),
        None => "not within the window".to_owned(),
    };
    let vibration = match residual_vibration_frequency {
        Some(frequency) => {
            format!("{} at {} Hz", length(*residual_vibration_amplitude), plain(round(*frequency)))
        }
        None => format!("{}, no swing stands out", length(*residual_vibration_amplitude)),
    };
    let saturated = match *effort_saturated_time {
        0.0 => "never at its limit".to_owned(),
        time => format!("at its limit for {} s", plain(time)),
    };
    writeln!(screen.out, "{}", screen.paint.heading(&format!("Axis {} followed", clean(axis))))?;
    let rows = [
        (
            "following error, most",
            format!("{} at {} s", length(*max_following_error), plain(round(*max_following_error_time))),
        ),
        ("following error, RMS", length(*rms_following_error)),
        ("overshoot of the load", length(*overshoot)),
        ("settled", settled),
        ("residual vibration", vibration),
        ("effort, most", format!("{} {effort}, {saturated}", plain(round(*max_effort)))),
    ];
    write_rows(screen, &rows)?;
    // A drive that needs no effort and is nowhere off is none.
    if *max_following_error == 0.0 && *max_effort == 0.0 {
        let text = "It followed exactly: an axis without a model of its drive and mechanics does. Start the simulator with --model \
                    for one that has them.";
        writeln!(screen.out, "{}", wrapped(text, "  "))?;
    }
    Ok(())
}

fn stream_report(screen: &mut Screen<'_>, plan: &Plan, stream: &StreamReport) -> io::Result<()> {
    let StreamReport { cycles_executed, counters, failovers, revisions, jitter, digest, stop_tail_used } =
        stream;
    // What is planned on the way has another length than what was planned at first.
    let executed = match revisions {
        0 => format!("{cycles_executed} of {}", plan.cycle_count()),
        _ => format!("{cycles_executed}, with {}", counted(*revisions, "operation")),
    };
    let underruns = match counters.underruns {
        0 => screen.paint.good("no underrun"),
        some => screen.paint.bad(&counted(some, "underrun")),
    };
    let microseconds = |seconds: f64| plain(round(seconds * 1e6));
    let tail = if *stop_tail_used { ", a stop tail was played" } else { "" };
    let rows = [
        ("cycles executed", format!("{executed}, {underruns}")),
        (
            "least lead",
            format!(
                "{}; {} began late and were made up for",
                counted(counters.least_lead_cycles, "cycle"),
                counters.late_cycles
            ),
        ),
        (
            "cycle jitter",
            format!(
                "median {}, 99 % {}, most {} µs",
                microseconds(jitter.p50),
                microseconds(jitter.p99),
                microseconds(jitter.max)
            ),
        ),
        (
            "batches",
            format!(
                "{} refused, {} came twice, {} of a past epoch",
                counters.refused_batches,
                counted(counters.duplicate_cycles, "cycle"),
                counters.stale_epochs
            ),
        ),
        ("fail-overs", format!("{failovers}{tail}")),
        ("digest", format!("{digest}")),
    ];
    writeln!(screen.out, "{}", screen.paint.heading("The stream"))?;
    write_rows(screen, &rows)
}

fn write_rows(screen: &mut Screen<'_>, rows: &[(&str, String)]) -> io::Result<()> {
    for (label, value) in rows {
        writeln!(screen.out, "  {label:LABEL$}{value}")?;
    }
    Ok(())
}

/// A small length in the unit in which people say it.
fn in_small(value: f64, kind: AxisKind) -> String {
    let (scale, unit) = match kind {
        AxisKind::Prismatic => (1e6, "µm".to_owned()),
        AxisKind::Revolute => (1e6, "µrad".to_owned()),
        AxisKind::Pulses => (1.0, unit(kind, Quantity::Position)),
    };
    format!("{} {unit}", plain(round(value * scale)))
}

/// To four significant digits: what a measurement is worth.
fn round(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
