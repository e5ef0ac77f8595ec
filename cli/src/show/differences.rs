//! In what two plans differ, as a table.

use std::io;

use planner::Plan;

use crate::command::diff::{Differences, Parting};
use crate::show::columns::short;
use crate::show::number::{percent, plain, unit};
use crate::show::paint::{Screen, clean, wrapped};
use crate::show::table::heading;

/// The differences, for people.
pub(crate) fn table(screen: &mut Screen<'_>, plans: [&Plan; 2], found: &Differences) -> io::Result<()> {
    for (name, plan) in ["A", "B"].into_iter().zip(plans) {
        write!(screen.out, "{name}: ")?;
        heading(screen, plan)?;
    }
    writeln!(screen.out, "{}", wrapped(&durations(found.durations), ""))?;
    for (name, alone) in ["A", "B"].into_iter().zip(&found.alone) {
        for axis in alone {
            let text = format!("Only {name} has axis {}.", clean(axis));
            writeln!(screen.out, "{}", wrapped(&text, ""))?;
        }
    }
    let cycle = plans[0].cycle_time().as_seconds();
    let mut axis = None;
    for worst in &found.worst {
        if axis != Some(&worst.axis) {
            axis = Some(&worst.axis);
            let name = format!("Axis {}", short(&worst.axis));
            let head = format!("{name:<24}{:>18}{:>12}{:>14}", "worst difference", "at [s]", "of greatest");
            writeln!(screen.out, "\n{}", screen.paint.heading(&head))?;
        }
        let quantity = format!("{} [{}]", worst.quantity, unit(worst.kind, worst.quantity));
        let (at, share) = match worst.difference {
            0.0 => (String::new(), String::new()),
            difference => (plain(worst.cycle as f64 * cycle), percent(difference / worst.greatest)),
        };
        let difference = plain(worst.difference);
        writeln!(
            screen.out,
            "{}",
            format!("  {quantity:<22}{difference:>18}{at:>12}{share:>14}").trim_end()
        )?;
    }
    writeln!(screen.out)?;
    let verdict = match &found.first {
        Some(parting) => screen.paint.bad(&wrapped(&parted(parting, cycle), "")),
        None if found.none() => screen.paint.good("No difference."),
        None => screen.paint.bad("What both have does not differ."),
    };
    writeln!(screen.out, "{verdict}")
}

#[expect(clippy::float_cmp, reason = "the same duration is the same bits")]
fn durations([a, b]: [f64; 2]) -> String {
    if a == b {
        return "Both last as long.".to_owned();
    }
    let change = if a > 0.0 { format!(", {}", percent((b - a).abs() / a)) } else { String::new() };
    let word = if b > a { "longer" } else { "shorter" };
    format!("B takes {} s {word}{change}.", plain((b - a).abs()))
}

fn parted(parting: &Parting, cycle: f64) -> String {
    let Parting { cycle: number, axis, kind, quantity, values: [a, b] } = parting;
    format!(
        "They part at cycle {number}, {} s: of axis {} the {} is {a:?} in A and {b:?} in B [{}].",
        plain(*number as f64 * cycle),
        clean(axis),
        quantity,
        unit(*kind, *quantity)
    )
}
