//! How good a link is: a table, a histogram, and what follows from it.

use std::time::Duration;

use client::grade::{Advice, Grade, Measured};
use planner::CycleTime;
use serde_json::{Value, json};

use crate::failure::Failure;
use crate::show::paint::{Screen, wrapped};

/// The widest bar of a histogram [columns].
const BAR: usize = 44;
/// The edge of its first class [µs]; each is twice the one before.
const FIRST_US: u64 = 64;

fn rows(grade: &Grade) -> [(&'static str, &'static str, &Measured); 4] {
    [
        ("round trip", "roundTrip", &grade.round_trips),
        ("arrival gap", "arrivalGap", &grade.arrival_gaps),
        ("wakes up late by", "lateness", &grade.lateness),
        ("opens a stream in", "opening", &grade.openings),
    ]
}

/// Quantiles of all that was measured, and a histogram of round trips.
pub(crate) fn table(
    screen: &mut Screen<'_>,
    endpoint: &str,
    served_by: &str,
    grade: &Grade,
) -> Result<(), Failure> {
    let title = format!("The link to {endpoint}, served by {served_by}");
    writeln!(screen.out, "{}", screen.paint.heading(&title))?;
    let head = format!("  {:<20}{:>10}{:>12}{:>12}{:>12}", "[ms]", "count", "median", "99 %", "worst");
    writeln!(screen.out, "{}", screen.paint.quiet(&head))?;
    for (name, _, measured) in rows(grade) {
        let at = |share| milliseconds(measured.quantile(share));
        let (median, most, worst) = (at(0.5), at(0.99), at(1.0));
        writeln!(screen.out, "  {name:<20}{:>10}{median:>12.3}{most:>12.3}{worst:>12.3}", measured.count())?;
    }
    writeln!(screen.out, "\n{}", screen.paint.heading("Round trips"))?;
    histogram(screen, &grade.round_trips)
}

/// A line for each class that something fell into, and for those between them.
fn histogram(screen: &mut Screen<'_>, measured: &Measured) -> Result<(), Failure> {
    let mut classes = Vec::new();
    let (mut from, mut to) = (Duration::ZERO, Duration::from_micros(FIRST_US));
    while from < measured.worst() {
        // Nothing takes no time at all.
        classes.push((from, to, measured.between(from, to)));
        (from, to) = (to, to * 2);
    }
    let first = classes.iter().position(|(.., count)| *count > 0).unwrap_or(0);
    let most = classes.iter().map(|(.., count)| *count).max().unwrap_or(0).max(1);
    for (_, to, count) in classes.into_iter().skip(first) {
        // What is there can be seen, however little it is.
        let bar = "█".repeat((count * BAR).div_ceil(most));
        let line = format!("  up to {:>9.3} ms{count:>8}  {bar}", milliseconds(to));
        writeln!(screen.out, "{}", line.trim_end())?;
    }
    Ok(())
}

/// What to ask for, and why.
pub(crate) fn advice(
    screen: &mut Screen<'_>,
    advice: &Advice,
    cycle: CycleTime,
    underruns: u64,
) -> Result<(), Failure> {
    let Advice { lead_cycles, axis_guard, steady_cycles, takeover_cycles, is_short } = *advice;
    let ms = f64::from(lead_cycles) * cycle.as_seconds() * 1e3;
    writeln!(screen.out, "\n{}", screen.paint.heading("What it needs"))?;
    writeln!(screen.out, "  {:<20}{lead_cycles:>10} cycles ({ms} ms)", "lead")?;
    writeln!(screen.out, "  {:<20}{axis_guard:>10} cycles", "guard")?;
    let text = format!(
        "At worst {steady_cycles} cycles of the lead were on their way while the server served: twice that. To open \
         elsewhere takes {takeover_cycles}, and a server that falls silent is given up with a quarter of the lead left: four \
         times that. The lead is the larger one, in whole batches."
    );
    writeln!(screen.out, "\n{}", wrapped(&text, "  "))?;
    let warning = if underruns > 0 {
        Some(format!(
            "{underruns} cycles had not come when they were due, with the longest lead that there is."
        ))
    } else if is_short {
        Some(
            "No lead that may be asked for covers that: bring the server nearer, or find what stalls."
                .to_owned(),
        )
    } else {
        None
    };
    if let Some(warning) = warning {
        writeln!(screen.out, "\n{}", screen.paint.bad(&wrapped(&warning, "  ")))?;
    }
    Ok(())
}

/// The same for programs, times in seconds.
pub(crate) fn json(endpoint: &str, served_by: &str, grade: &Grade, advice: &Advice, underruns: u64) -> Value {
    let mut answer = json!({
        "endpoint": endpoint,
        "servedBy": served_by,
        "leadCycles": advice.lead_cycles,
        "axisGuard": advice.axis_guard,
        "steadyCycles": advice.steady_cycles,
        "takeoverCycles": advice.takeover_cycles,
        "isShort": advice.is_short,
        "underruns": underruns,
    });
    for (_, key, measured) in rows(grade) {
        let at = |share| measured.quantile(share).as_secs_f64();
        answer[key] = json!({
            "count": measured.count(),
            "median": at(0.5),
            "p99": at(0.99),
            "worst": at(1.0),
        });
    }
    answer
}

fn milliseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e3
}
