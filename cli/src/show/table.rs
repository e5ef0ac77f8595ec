//! Plans and certificates as tables of at most 80 columns.

use std::io;

use planner::{
    AdjustmentReason, AsymmetricType, AxisKind, AxisPlan, Certificate, Classification, EightType, Family,
    Judged, Method, Plan, Quantity,
};

use crate::show::number::{self, column, plain, unit};
use crate::show::paint::{Paint, Screen, WIDTH, clean, wrapped};

/// The most significant digits that a table shows, and the fewest that it comes down to where it is too wide.
const DIGITS: std::ops::RangeInclusive<i32> = 4..=6;
/// The most of an axis's name that a table shows [characters].
const LONGEST_NAME: usize = 16;

/// Everything about a plan.
pub(crate) fn plan(screen: &mut Screen<'_>, judged: &Judged) -> io::Result<()> {
    let (plan, paint) = (judged.plan(), screen.paint);
    let (seconds, cycles) = (plain(plan.duration()), plan.cycle_count());
    let heading = format!("{seconds} s, {cycles} cycles of {}", number::cycle(plan.cycle_time()));
    let version = clean(&plan.maker().planner_version);
    writeln!(screen.out, "{}; {} by planner {version}", paint.heading(&heading), family(plan.method()))?;
    let critical = &judged.explanation().critical_axis;
    if plan.axes().len() > 1 {
        writeln!(screen.out, "Axis {} takes longest.", clean(critical))?;
    }
    for axis in plan.axes() {
        axis_plan(screen, judged, axis)?;
    }
    writeln!(screen.out)?;
    certificate(screen, plan, judged.certificate())
}

/// What the judge found.
pub(crate) fn certificate(screen: &mut Screen<'_>, plan: &Plan, certificate: &Certificate) -> io::Result<()> {
    let paint = screen.paint;
    let verdict = if certificate.passed() { paint.good("passed") } else { paint.bad("FAILED") };
    writeln!(screen.out, "{}: {verdict}", paint.heading("Certificate"))?;
    screen
        .out
        .write_all(fitted(|digits| limits_table(plan, certificate, digits)).render(paint).as_bytes())?;
    writeln!(screen.out)?;
    screen.out.write_all(ends_table(plan, certificate).render(paint).as_bytes())?;
    // When is in the table for limits, and at the end for ends.
    for join in certificate.joins.iter().filter(|join| !join.passed()) {
        let unit = unit(kind_of(plan, &join.axis), join.quantity);
        let (axis, quantity) = (clean(&join.axis), join.quantity);
        let (jump, time) = (plain(join.worst_jump), plain(join.at_time));
        let text = format!("The {quantity} of {axis} jumps by {jump} {unit} at {time} s.");
        writeln!(screen.out, "{}", wrapped(&text, "  "))?;
    }
    Ok(())
}

fn axis_plan(screen: &mut Screen<'_>, judged: &Judged, axis: &AxisPlan) -> io::Result<()> {
    let paint = screen.paint;
    let name = paint.heading(&format!("Axis {}", clean(&axis.axis)));
    let shape = classification(&axis.classification, axis.kind);
    writeln!(screen.out, "\n{}", wrapped(&format!("{name}, {}: {shape}", kind(axis.kind)), ""))?;
    if !axis.profile.segments().is_empty() {
        screen.out.write_all(fitted(|digits| phases(axis, digits)).render(paint).as_bytes())?;
    }
    writeln!(screen.out)?;
    screen.out.write_all(fitted(|digits| asked(axis, digits)).render(paint).as_bytes())?;
    for adjustment in &axis.adjustments {
        let quantity = adjustment.quantity;
        let text = format!(
            "{} not as asked: {} instead of {} {}, {} ({}).",
            quantity,
            plain(adjustment.planned),
            plain(adjustment.asked),
            unit(axis.kind, quantity),
            why(adjustment.reason),
            adjustment.reason.name(),
        );
        writeln!(screen.out, "{}", wrapped(&text, "  "))?;
    }
    if let Some(text) = held_back(judged, axis) {
        writeln!(screen.out)?;
        writeln!(screen.out, "{}", wrapped(&text, "  "))?;
    }
    Ok(())
}

/// A row for each piece, and one for the end.
fn phases(axis: &AxisPlan, digits: i32) -> Table {
    let pieces: Vec<_> = axis.profile.timed_segments().collect();
    let values = |of: &dyn Fn(&(f64, &planner::Segment)) -> f64| -> Vec<String> {
        column(&pieces.iter().map(of).collect::<Vec<_>>(), digits)
    };
    let mut table = Table::default();
    table.right("#", "", (1..=pieces.len()).map(|number| number.to_string()).collect());
    table.right("from", "[s]", values(&|(begin, _)| *begin));
    table.right("to", "[s]", values(&|(begin, piece)| begin + piece.duration));
    table.right("lasts", "[s]", values(&|(_, piece)| piece.duration));
    let begins = [
        ("jerk", Quantity::Jerk, 3),
        ("position", Quantity::Position, 0),
        ("velocity", Quantity::Velocity, 1),
        ("acceleration", Quantity::Acceleration, 2),
    ];
    for (name, quantity, word) in begins {
        let cells = values(&|(_, piece)| piece.at(0.0).words()[word]);
        table.right(name, &format!("[{}]", unit(axis.kind, quantity)), cells);
    }
    table
}

/// Start and goal as asked, and the end as planned.
fn asked(axis: &AxisPlan, digits: i32) -> Table {
    let (start, goal, end) = (axis.profile.start(), axis.goal, axis.profile.end());
    let quantities = [
        (Quantity::Position, [start.position, goal.position, end.position]),
        (Quantity::Velocity, [start.velocity, goal.velocity, end.velocity]),
        (Quantity::Acceleration, [start.acceleration, goal.acceleration, end.acceleration]),
    ];
    let mut table = Table::default();
    let labels = ["start", "end asked", "end planned"];
    table.left("", "", labels.iter().map(|label| (*label).to_owned()).collect());
    for (quantity, values) in quantities {
        table.right(
            &quantity.to_string(),
            &format!("[{}]", unit(axis.kind, quantity)),
            column(&values, digits),
        );
    }
    table
}

/// Which limit holds the motion back when, in a sentence.
fn held_back(judged: &Judged, axis: &AxisPlan) -> Option<String> {
    let bindings: Vec<_> =
        judged.explanation().bindings.iter().filter(|binding| binding.axis == axis.axis).collect();
    if bindings.is_empty() {
        return None;
    }
    let times: Vec<f64> = bindings.iter().flat_map(|binding| [binding.from_time, binding.to_time]).collect();
    let times = column(&times, 4);
    let spans = bindings.iter().zip(times.chunks(2)).map(|(binding, times)| {
        let (from, to) = (&times[0], &times[1]);
        format!("{} {from} to {to} s", binding.quantity)
    });
    Some(format!("Limits that hold it back: {}.", spans.collect::<Vec<_>>().join(", ")))
}

fn limits_table(plan: &Plan, certificate: &Certificate, digits: i32) -> Table {
    let checks = &certificate.limits;
    let mut table = Table::default();
    table.left("axis", "", checks.iter().map(|check| short(&check.axis)).collect());
    let what = |axis: &str, quantity| format!("{quantity} [{}]", unit(kind_of(plan, axis), quantity));
    table.left("limit on", "", checks.iter().map(|check| what(&check.axis, check.quantity)).collect());
    // Not of one quantity, so each with digits of its own.
    let each = |of: &dyn Fn(&planner::LimitCheck) -> f64| -> Vec<String> {
        checks.iter().map(|check| column(&[of(check)], digits).remove(0)).collect()
    };
    table.right("limit", "", each(&|check| check.limit));
    table.right("extreme", "", each(&|check| check.extremum));
    table.right("at [s]", "", column(&checks.iter().map(|check| check.at_time).collect::<Vec<_>>(), digits));
    table.right("margin", "", checks.iter().map(|check| number::percent(check.margin)).collect());
    table.verdicts(
        checks
            .iter()
            .map(|check| match (check.passed(), check.guaranteed) {
                (false, _) => Verdict::Failed,
                (true, true) => Verdict::Ok,
                (true, false) => Verdict::NotPromised,
            })
            .collect(),
    );
    table
}

/// Joins and ends: the judge has one of each for every axis and quantity.
fn ends_table(plan: &Plan, certificate: &Certificate) -> Table {
    let pairs: Vec<_> = certificate.joins.iter().zip(&certificate.ends).collect();
    let mut table = Table::default();
    let brief = |value: f64| if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") };
    table.left("axis", "", pairs.iter().map(|(join, _)| short(&join.axis)).collect());
    let what = pairs
        .iter()
        .map(|(join, _)| format!("{} [{}]", join.quantity, unit(kind_of(plan, &join.axis), join.quantity)));
    table.left("joins and end", "", what.collect());
    table.right("worst jump", "", pairs.iter().map(|(join, _)| brief(join.worst_jump)).collect());
    table.right("off the end", "", pairs.iter().map(|(_, end)| brief(end.residual)).collect());
    table.right("allowed", "", pairs.iter().map(|(join, _)| brief(join.allowed)).collect());
    table.verdicts(
        pairs
            .iter()
            .map(|(join, end)| if join.passed() && end.passed() { Verdict::Ok } else { Verdict::Failed })
            .collect(),
    );
    table
}

fn kind_of(plan: &Plan, axis: &str) -> AxisKind {
    plan.axes().iter().find(|plan| plan.axis == axis).map_or(AxisKind::Prismatic, |plan| plan.kind)
}

fn kind(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Prismatic => "prismatic",
        AxisKind::Revolute => "revolute",
        AxisKind::Pulses => "in pulses",
    }
}

fn family(method: Method) -> String {
    match method.family {
        Family::SCurve => "S-curve".to_owned(),
        Family::Trapezoidal => "trapezoid".to_owned(),
        Family::Polynomial => format!("polynomial of order {}", method.order),
        Family::Trigonometric => "trigonometric".to_owned(),
    }
}

/// The shape in words.
pub(crate) fn classification(classification: &Classification, kind: AxisKind) -> String {
    // The six cases tell less than the eight types do, and are given with them.
    let Classification { eight_type, asymmetric_type, six_case: _, feed_rate } = *classification;
    let peak = format!("{} {}", plain(feed_rate), unit(kind, Quantity::Velocity));
    let Some(eight_type) = eight_type else {
        return match asymmetric_type {
            Some(asymmetric) => format!(
                "asymmetric type {} ({}), peak {peak}",
                asymmetric.name(),
                asymmetric_words(asymmetric)
            ),
            None if feed_rate == 0.0 => "stands still".to_owned(),
            None => format!("peak {peak}"),
        };
    };
    let words = match eight_type {
        EightType::Type1 => "cruises, full acceleration both ways",
        EightType::Type2 => "cruises, full acceleration only while speeding up",
        EightType::Type3 => "cruises, full acceleration only while slowing down",
        EightType::Type4 => "cruises, never at full acceleration",
        EightType::Type5 => "no cruise, full acceleration both ways",
        EightType::Type6 => "no cruise, full acceleration only while speeding up",
        EightType::Type7 => "no cruise, full acceleration only while slowing down",
        EightType::Type8A => "no cruise, never at full acceleration",
        EightType::Type8B => "path too short, ends at its start velocity",
        EightType::Type8C => "path too short, one ramp to the nearest velocity",
    };
    format!("type {} ({words}), peak {peak}", eight_type.name())
}

fn asymmetric_words(kind: AsymmetricType) -> &'static str {
    match kind {
        AsymmetricType::Type1 => "cruises, full acceleration both ways",
        AsymmetricType::Type2 => "no cruise, full acceleration both ways",
        AsymmetricType::Type3 => "no cruise, never at full acceleration",
        AsymmetricType::Type4 => "no cruise, full acceleration only while speeding up",
        AsymmetricType::Type5 => "no cruise, full acceleration only while slowing down",
        AsymmetricType::Type6 => "cruises, full acceleration only while speeding up",
        AsymmetricType::Type7 => "cruises, full acceleration only while slowing down",
        AsymmetricType::Type8 => "cruises, never at full acceleration",
    }
}

fn why(reason: AdjustmentReason) -> &'static str {
    match reason {
        AdjustmentReason::PathTooShortStartVelocity => {
            "since the path is too short and policy takes the start velocity"
        }
        AdjustmentReason::PathTooShortNearestVelocity => "the nearest that so short a path can reach",
        AdjustmentReason::FeedRateAboveLimit => "since the feed rate is above the velocity limit",
        AdjustmentReason::ClosingStop => "since a stop was put after the end",
        AdjustmentReason::Override => "since an override scales every velocity",
    }
}

/// A name that fits a column.
pub(crate) fn short(name: &str) -> String {
    let name = clean(name);
    if name.chars().count() <= LONGEST_NAME {
        return name;
    }
    name.chars().take(LONGEST_NAME - 1).chain(['…']).collect()
}

/// The table with as many digits as fit.
fn fitted(table: impl Fn(i32) -> Table) -> Table {
    let mut digits = *DIGITS.end();
    loop {
        let fitting = table(digits);
        if fitting.width() <= WIDTH {
            return fitting;
        }
        if digits == *DIGITS.start() {
            return Table { gap: " ", ..fitting };
        }
        digits -= 1;
    }
}

/// Columns of text, each as wide as its widest cell.
#[derive(Debug)]
struct Table {
    columns: Vec<Column>,
    verdicts: Vec<Verdict>,
    /// Between columns.
    gap: &'static str,
}

impl Default for Table {
    fn default() -> Self {
        Self { columns: Vec::new(), verdicts: Vec::new(), gap: "  " }
    }
}

#[derive(Debug)]
struct Column {
    heading: String,
    unit: String,
    cells: Vec<String>,
    right: bool,
    width: usize,
}

/// What the judge says of one row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    Ok,
    NotPromised,
    Failed,
}

impl Verdict {
    fn text(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::NotPromised => "not promised",
            Self::Failed => "FAILED",
        }
    }

    fn painted(self, paint: Paint) -> String {
        match self {
            Self::Ok => paint.good(self.text()),
            Self::NotPromised => paint.quiet(self.text()),
            Self::Failed => paint.bad(self.text()),
        }
    }
}

impl Table {
    fn right(&mut self, heading: &str, unit: &str, cells: Vec<String>) {
        self.push(heading, unit, cells, true);
    }

    fn left(&mut self, heading: &str, unit: &str, cells: Vec<String>) {
        self.push(heading, unit, cells, false);
    }

    fn push(&mut self, heading: &str, unit: &str, cells: Vec<String>, right: bool) {
        let lengths = cells.iter().map(|cell| cell.chars().count());
        let width = lengths.chain([heading.chars().count(), unit.chars().count()]).max().unwrap_or(0);
        self.columns.push(Column { heading: heading.into(), unit: unit.into(), cells, right, width });
    }

    fn verdicts(&mut self, verdicts: Vec<Verdict>) {
        self.verdicts = verdicts;
    }

    fn width(&self) -> usize {
        let verdicts =
            self.verdicts.iter().map(|verdict| verdict.text().len() + self.gap.len()).max().unwrap_or(0);
        INDENT.len() + self.columns.iter().map(|column| column.width + self.gap.len()).sum::<usize>()
            - self.gap.len()
            + verdicts
    }

    fn render(&self, paint: Paint) -> String {
        let mut text = String::new();
        let rows = self.columns.first().map_or(0, |column| column.cells.len());
        for heading in [
            self.line(self.columns.iter().map(|c| (c, &c.heading))),
            self.line(self.columns.iter().map(|c| (c, &c.unit))),
        ] {
            if !heading.trim().is_empty() {
                text.push_str(&format!("{}\n", paint.quiet(&heading)));
            }
        }
        for row in 0..rows {
            text.push_str(&self.line(self.columns.iter().map(|column| (column, &column.cells[row]))));
            if let Some(verdict) = self.verdicts.get(row) {
                text.push_str(&format!("{}{}", self.gap, verdict.painted(paint)));
            }
            text.push('\n');
        }
        text
    }

    fn line<'a>(&self, cells: impl Iterator<Item = (&'a Column, &'a String)>) -> String {
        let cells = cells.map(|(column, cell)| {
            let width = column.width;
            if column.right { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
        });
        format!("{INDENT}{}", cells.collect::<Vec<_>>().join(self.gap)).trim_end().to_owned()
    }
}

const INDENT: &str = "  ";
