use planner::{Certificate, JudgedPvt, PvtPointReport, PvtRegion, Quantity};

use super::figure::{Figure, Ink, Mark, Marks, Span, Strip};
use super::planned::of_plan;
use crate::show::columns::short;
use crate::show::number::{counted, plain, unit};

/// A plan through points: its curves, with what was asked, what was not met, and the region of each point.
pub(crate) fn of_points(judged: &JudgedPvt) -> Figure {
    let plan = judged.judged().plan();
    let mut figure = of_plan(plan);
    // The pieces are five for each point: the regions say more.
    (figure.bands, figure.bands_name) = (Vec::new(), String::new());
    for (index, axis) in plan.axes().iter().enumerate() {
        let reports: Vec<_> = judged.points().iter().filter(|report| report.axis == index).collect();
        for (title, quantity) in [("Position", Quantity::Position), ("Velocity", Quantity::Velocity)] {
            let unit = unit(axis.kind, quantity);
            let panel = figure.panels.iter_mut().find(|panel| panel.title == title && panel.unit == unit);
            if let Some(panel) = panel {
                let ink = if plan.axes().len() > 1 { Ink::Number(index) } else { Ink::Number(DARK) };
                panel.marks.extend(marks(&reports, quantity, ink));
                let certificate = judged.judged().certificate();
                panel.marks.push(reversals(certificate, &axis.axis, quantity, ink));
            }
        }
        let spans = spans(&reports);
        if !spans.is_empty() {
            figure.strips.push(Strip { name: short(&axis.axis), spans });
        }
    }
    let adjusted = judged.points().iter().filter(|report| !report.adjustments.is_empty()).count();
    let points = counted(judged.points().len() as u64, "point");
    let method = plan.method().pvt.unwrap_or_default();
    figure.title = match plan.axes() {
        [axis] => {
            let speed = unit(axis.kind, Quantity::Velocity);
            let (name, peak) = (short(&axis.axis), plain(axis.classification.feed_rate));
            format!("{name}: {points}, {}, peak {peak}\u{a0}{speed}", words(method.interpolation))
        }
        axes => format!("{} axes: {points}, {}", axes.len(), words(method.interpolation)),
    };
    figure.subtitle = format!("{}; {adjusted} of {points} not as asked", figure.subtitle);
    figure
}

/// In the palette: for the marks of an axis by itself.
const DARK: usize = 6;

fn words(interpolation: planner::PvtInterpolation) -> &'static str {
    match interpolation {
        planner::PvtInterpolation::SShaped => "S-shaped",
        planner::PvtInterpolation::Cubic => "joined by cubics",
        planner::PvtInterpolation::Quintic => "joined by quintics",
    }
}

/// What was asked, at the time of the plan; and a ring around what is not so.
fn marks(reports: &[&PvtPointReport], quantity: Quantity, ink: Ink) -> [Marks; 2] {
    let asked = |report: &PvtPointReport| {
        let reached = if quantity == Quantity::Position { report.position } else { report.velocity };
        let said = report.adjustments.iter().find(|adjustment| adjustment.quantity == quantity);
        (report.time, said.map_or(reached, |adjustment| adjustment.asked))
    };
    let is_off = |report: &&&PvtPointReport| {
        let of_this = |said: Quantity| said == quantity || said == Quantity::Time;
        report.adjustments.iter().any(|adjustment| of_this(adjustment.quantity))
    };
    let marks = |name: &str, mark, points| Marks { name: name.to_owned(), ink, mark, points };
    [
        marks("asked", Mark::Dot, reports.iter().map(|report| asked(report)).collect()),
        marks("not met", Mark::Ring, reports.iter().filter(is_off).map(|report| asked(report)).collect()),
    ]
}

/// Where the axis turns back, which only polynomials do unasked.
fn reversals(certificate: &Certificate, axis: &str, quantity: Quantity, ink: Ink) -> Marks {
    let of_axis = certificate.reversals.iter().filter(|reversal| *reversal.axis == *axis);
    let points = of_axis.map(|reversal| {
        (reversal.at_time, if quantity == Quantity::Position { reversal.position } else { 0.0 })
    });
    let (name, points) = ("reverses".to_owned(), points.collect());
    Marks { name, ink, mark: Mark::Cross, points }
}

/// The regions, neighbours of one region together.
fn spans(reports: &[&PvtPointReport]) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    let mut from = 0.0;
    for report in reports {
        let Some(region) = report.region else { return Vec::new() };
        let (label, to) = (region.name(), report.time);
        match spans.last_mut() {
            Some(last) if last.label == label => last.to = to,
            _ => spans.push(Span { from, to, label, ink: ink(region) }),
        }
        from = to;
    }
    spans
}

/// Warm ahead, cold behind.
fn ink(region: PvtRegion) -> Ink {
    match region {
        PvtRegion::R1 => Ink::Number(1),
        PvtRegion::R2 => Ink::Number(5),
        PvtRegion::R3 => Ink::Number(4),
        PvtRegion::R4 => Ink::Number(0),
    }
}
