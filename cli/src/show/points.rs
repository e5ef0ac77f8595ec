//! What became of points, as tables.

use std::io;

use planner::{Adjustment, AdjustmentReason, AxisKind, AxisPlan, JudgedPvt, PvtPointReport, Quantity};

use crate::show::columns::{Table, fitted};
use crate::show::number::{column, counted, exact_column, plain, unit};
use crate::show::paint::{Screen, clean, wrapped};
use crate::show::table;
use crate::show::words::kind;

/// Everything about a plan through points.
pub(crate) fn plan(screen: &mut Screen<'_>, judged: &JudgedPvt) -> io::Result<()> {
    let plan = judged.judged().plan();
    table::heading(screen, plan)?;
    for (index, axis) in plan.axes().iter().enumerate() {
        let reports: Vec<_> = judged.points().iter().filter(|report| report.axis == index).collect();
        axis_points(screen, axis, &reports)?;
    }
    writeln!(screen.out)?;
    table::certificate(screen, plan, judged.judged().certificate())
}

fn axis_points(screen: &mut Screen<'_>, axis: &AxisPlan, reports: &[&PvtPointReport]) -> io::Result<()> {
    let name = screen.paint.heading(&format!("Axis {}", clean(&axis.axis)));
    let peak = plain(axis.classification.feed_rate);
    let speed = unit(axis.kind, Quantity::Velocity);
    let points = counted(reports.len() as u64, "point");
    let text = format!("{name}, {}: {points}, peak {peak}\u{a0}{speed}", kind(axis.kind));
    writeln!(screen.out, "\n{}", wrapped(&text, ""))?;
    let table = fitted(|digits| points_table(axis, reports, digits));
    screen.out.write_all(table.render(screen.paint).as_bytes())?;
    if let Some(text) = summary(reports) {
        writeln!(screen.out, "{}", wrapped(&text, "  "))?;
    }
    // The others are those of the last point.
    let of_axis =
        |reason| matches!(reason, AdjustmentReason::PvtFinishedLate | AdjustmentReason::FeedRateAboveLimit);
    for adjustment in axis.adjustments.iter().filter(|adjustment| of_axis(adjustment.reason)) {
        table::adjusted(screen, axis.kind, adjustment)?;
    }
    Ok(())
}

fn points_table(axis: &AxisPlan, reports: &[&PvtPointReport], digits: i32) -> Table {
    let all =
        |of: &dyn Fn(&PvtPointReport) -> f64| reports.iter().map(|report| of(report)).collect::<Vec<_>>();
    let [length, speed] =
        [Quantity::Position, Quantity::Velocity].map(|quantity| format!("[{}]", unit(axis.kind, quantity)));
    let begins = std::iter::once(axis.profile.start().position).chain(all(&|report| report.position));
    let ends: Vec<_> = begins
        .zip(reports)
        .map(|(begin, report)| report.reachable.map(|(least, most)| [begin + least, begin + most]))
        .collect();
    // One column of positions, so that they can be compared.
    let mut positions: Vec<f64> = ends.iter().flatten().flatten().copied().collect();
    positions.extend(all(&|report| report.position));
    let mut cells = column(&positions, digits).into_iter();
    let reachable: Vec<_> = ends
        .iter()
        .map(|ends| match ends {
            Some(_) => [(); 2].map(|()| cells.next().unwrap_or_default()),
            None => [(); 2].map(|()| "-".to_owned()),
        })
        .collect();
    let [from, to] = [0, 1].map(|end| reachable.iter().map(|ends| ends[end].clone()).collect());
    let mut table = Table::default();
    table.right("#", "", reports.iter().map(|report| report.point.to_string()).collect());
    table.right("time", "[s]", exact_column(&all(&|report| report.time), digits));
    // Polynomials have none.
    if reports.iter().any(|report| report.region.is_some()) {
        table.left("region", "", reports.iter().map(|report| region(report).to_owned()).collect());
    }
    table.right("reach from", &length, from);
    table.right("to", &length, to);
    table.right("position", &length, cells.collect());
    table.right("velocity", &speed, column(&all(&|report| report.velocity), digits));
    table.left("not as asked", "", reports.iter().map(|report| off(report)).collect());
    table
}

fn region(report: &PvtPointReport) -> &'static str {
    report.region.map_or("-", planner::PvtRegion::name)
}

/// By how much a point is not as asked.
fn off(report: &PvtPointReport) -> String {
    let part = |adjustment: &Adjustment| {
        let letter = match adjustment.quantity {
            Quantity::Position => 'p',
            Quantity::Velocity => 'v',
            _ => 't',
        };
        let off = column(&[adjustment.planned - adjustment.asked], 3).remove(0);
        let sign = if off.starts_with('-') { "" } else { "+" };
        format!("{letter} {sign}{off}")
    };
    report.adjustments.iter().map(part).collect::<Vec<_>>().join(" ")
}

/// How many points are not as asked, and why.
fn summary(reports: &[&PvtPointReport]) -> Option<String> {
    let adjusted = reports.iter().filter(|report| !report.adjustments.is_empty()).count();
    let count = |reason| {
        let has = |report: &&&PvtPointReport| report.adjustments.iter().any(|said| said.reason == reason);
        reports.iter().filter(has).count()
    };
    let reasons: Vec<_> = AdjustmentReason::ALL
        .into_iter()
        .map(|reason| (count(reason), reason.name()))
        .filter(|(count, _)| *count > 0)
        .map(|(count, name)| format!("{name} {count}"))
        .collect();
    let all = counted(reports.len() as u64, "point");
    (adjusted > 0).then(|| {
        let reasons = reasons.join(", ");
        format!("{adjusted} of {all} not as asked (p position, v velocity, t time): {reasons}.")
    })
}

/// Above the rows of points that come one by one, in columns that nothing is known of yet.
pub(crate) fn heading(screen: &mut Screen<'_>, kind: AxisKind) -> io::Result<()> {
    let length = format!("[{}]", unit(kind, Quantity::Position));
    let speed = format!("[{}]", unit(kind, Quantity::Velocity));
    let names = ["#", "time", "region", "reach from", "to", "position", "velocity", "not as asked"];
    let units = ["", "[s]", "", length.as_str(), length.as_str(), length.as_str(), speed.as_str(), ""];
    for cells in [names, units] {
        let line = line(cells);
        writeln!(screen.out, "{}", screen.paint.quiet(&line))?;
    }
    Ok(())
}

/// What became of one point, which the axis began to head for at `from` [u].
pub(crate) fn row(screen: &mut Screen<'_>, report: &PvtPointReport, from: f64) -> io::Result<()> {
    let (least, most) =
        report.reachable.map_or((f64::NAN, f64::NAN), |(least, most)| (from + least, from + most));
    let number = report.point.to_string();
    let numbers = [report.time, least, most, report.position, report.velocity];
    let [time, least, most, position, velocity] = numbers.map(|value| column(&[value], 5).remove(0));
    let off = off(report);
    writeln!(
        screen.out,
        "{}",
        line([&number, &time, region(report), &least, &most, &position, &velocity, &off])
    )
}

fn line([number, time, region, from, to, position, velocity, off]: [&str; 8]) -> String {
    let text =
        format!("{number:>5} {time:>8} {region:<6} {from:>10} {to:>9} {position:>9} {velocity:>9}  {off}");
    text.trim_end().to_owned()
}
