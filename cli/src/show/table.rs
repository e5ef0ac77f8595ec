//! Plans and certificates as tables of at most 80 columns.

use std::io;

use planner::{
    Adjustment, AxisKind, AxisPlan, Certificate, EndCheck, Explanation, Family, InvalidFields, JoinCheck,
    Judged, Law, LimitCheck, Method, Plan, Quantity, Synchronization, Violation,
};

use crate::show::columns::{Table, Verdict, fitted, short};
use crate::show::number::{self, column, counted, exact_column, plain, unit};
use crate::show::paint::{Screen, clean, wrapped};
use crate::show::words::{classification, family, kind, why};

/// Everything about a plan.
pub(crate) fn plan(screen: &mut Screen<'_>, judged: &Judged) -> io::Result<()> {
    let plan = judged.plan();
    heading(screen, plan)?;
    if let Some(pace) = pace(plan, &judged.explanation()) {
        writeln!(screen.out, "{}", wrapped(&pace, ""))?;
    }
    for axis in plan.axes() {
        axis_plan(screen, judged, axis)?;
    }
    writeln!(screen.out)?;
    certificate(screen, plan, judged.certificate())
}

/// Which of several axes sets the pace, and what that is to the others, in a sentence.
fn pace(plan: &Plan, Explanation { critical_axis, .. }: &Explanation) -> Option<String> {
    if plan.axes().len() < 2 {
        return None;
    }
    let axis = clean(critical_axis);
    let Method { synchronization, pvt, .. } = plan.method();
    Some(match synchronization {
        _ if pvt.is_some() => format!("Axis {axis} takes longest."),
        Synchronization::None => format!("Axis {axis} takes longest."),
        Synchronization::Time | Synchronization::Phase if critical_axis.is_empty() => {
            "All axes arrive together, later than they could: as late as was asked for.".to_owned()
        }
        Synchronization::Time => format!("All axes arrive together, as soon as axis {axis} can."),
        Synchronization::Phase => {
            format!(
                "All axes keep to one line, and arrive as soon as that allows; axis {axis} holds it back most."
            )
        }
    })
}

/// How long a plan takes, and how it was made.
pub(crate) fn heading(screen: &mut Screen<'_>, plan: &Plan) -> io::Result<()> {
    let (seconds, cycles) = (plain(plan.duration()), counted(plan.cycle_count(), "cycle"));
    let heading = format!("{seconds} s, {cycles} of {}", number::cycle(plan.cycle_time()));
    let version = clean(&plan.maker().planner_version);
    let heading = screen.paint.heading(&heading);
    let text = format!("{heading}; {} by planner {version}", family(plan.method()));
    writeln!(screen.out, "{}", wrapped(&text, ""))
}

/// What the judge found.
pub(crate) fn certificate(screen: &mut Screen<'_>, plan: &Plan, certificate: &Certificate) -> io::Result<()> {
    let paint = screen.paint;
    let verdict = if certificate.passed() { paint.good("passed") } else { paint.bad("FAILED") };
    let exceeds = certificate.limits.iter().any(|check| !check.guaranteed && check.margin < 0.0);
    let but =
        if certificate.passed() && exceeds { ", and exceeds limits that it does not promise" } else { "" };
    writeln!(screen.out, "{}: {verdict}{but}", paint.heading("Certificate"))?;
    screen
        .out
        .write_all(fitted(|digits| limits_table(plan, certificate, digits)).render(paint).as_bytes())?;
    for sentence in led_back(certificate) {
        writeln!(screen.out, "{}", wrapped(&sentence, "  "))?;
    }
    for sentence in reversals(plan, certificate) {
        writeln!(screen.out, "{}", wrapped(&sentence, "  "))?;
    }
    writeln!(screen.out)?;
    screen.out.write_all(fitted(|_| ends_table(plan, certificate)).render(paint).as_bytes())?;
    if !certificate.passed() {
        writeln!(screen.out, "\n{}", paint.bad("What is promised and not kept:"))?;
    }
    for violation in certificate.violations() {
        writeln!(screen.out, "{}", wrapped(&finding(plan, &violation), "  "))?;
    }
    Ok(())
}

/// What a plan says of itself and is not.
pub(crate) fn misstated(screen: &mut Screen<'_>, misstated: &InvalidFields) -> io::Result<()> {
    let heading = screen.paint.bad("The plan is not what it says of itself:");
    writeln!(screen.out, "{heading}")?;
    for invalid in misstated.as_slice() {
        writeln!(screen.out, "{}", wrapped(&clean(&format!("{invalid}.")), "  "))?;
    }
    Ok(())
}

/// What the judge objects to, in a sentence.
fn finding(plan: &Plan, violation: &Violation) -> String {
    let with_unit = |value: f64, axis: &str, quantity| {
        format!("{}\u{a0}{}", plain(value), unit(kind_of(plan, axis), quantity))
    };
    match violation {
        Violation::Limit(check) => {
            let LimitCheck { axis, quantity, limit, extremum, at_time, margin, .. } = check;
            let (of, time) = (format!("The {quantity} of {}", clean(axis)), plain(*at_time));
            let limit = with_unit(*limit, axis, *quantity);
            let below = quantity.order().and_then(|order| Quantity::BY_ORDER.get(order.checked_sub(1)?));
            if let (true, Some(below)) = (extremum.is_infinite(), below) {
                return format!(
                    "{of} is infinite at {time}\u{a0}s, where its {below} jumps; its limit is {limit}."
                );
            }
            let reached = format!("{of} reaches {} at {time}\u{a0}s", with_unit(*extremum, axis, *quantity));
            match quantity {
                Quantity::Position => format!("{reached}, outside its range, which ends at {limit}."),
                _ => format!("{reached}, {} beyond its limit of {limit}.", number::percent(-margin)),
            }
        }
        Violation::Join(JoinCheck { axis, quantity, worst_jump, allowed, at_time, .. }) => {
            let [jump, allowed] = [*worst_jump, *allowed].map(|value| with_unit(value, axis, *quantity));
            let (axis, time) = (clean(axis), plain(*at_time));
            format!(
                "The {quantity} of {axis} jumps by {jump} at {time}\u{a0}s, where pieces meet; up to {allowed} is rounding."
            )
        }
        Violation::End(EndCheck { axis, quantity, residual, allowed }) => {
            let [residual, allowed] = [*residual, *allowed].map(|value| with_unit(value, axis, *quantity));
            let axis = clean(axis);
            format!(
                "The {quantity} of {axis} ends {residual} from where it should; up to {allowed} is rounding."
            )
        }
    }
}

fn axis_plan(screen: &mut Screen<'_>, judged: &Judged, axis: &AxisPlan) -> io::Result<()> {
    let (paint, plan) = (screen.paint, judged.plan());
    let name = paint.heading(&format!("Axis {}", clean(&axis.axis)));
    let shape = passing(axis).unwrap_or_else(|| classification(&axis.classification, axis.kind));
    writeln!(screen.out, "\n{}", wrapped(&format!("{name}, {}: {shape}", kind(axis.kind)), ""))?;
    if !axis.profile.segments().is_empty() {
        screen.out.write_all(fitted(|digits| phases(axis, digits)).render(paint).as_bytes())?;
    }
    writeln!(screen.out)?;
    screen.out.write_all(fitted(|digits| asked(axis, digits)).render(paint).as_bytes())?;
    for adjustment in &axis.adjustments {
        adjusted(screen, axis.kind, adjustment)?;
    }
    if let Some(limits) = alike(plan, axis) {
        let family = match plan.method().family {
            Family::Polynomial => "A polynomial",
            Family::SCurve | Family::Trapezoidal | Family::Trigonometric => "This family",
        };
        let text = format!(
            "{family} speeds up and slows down alike, within the smaller limit of both: {limits}. An S-curve uses both."
        );
        writeln!(screen.out, "{}", wrapped(&text, "  "))?;
    }
    if let Some(text) = held_back(judged, axis) {
        writeln!(screen.out)?;
        writeln!(screen.out, "{}", wrapped(&text, "  "))?;
    }
    Ok(())
}

/// The limit that a family keeps to while it speeds up and while it slows down, and the one that it leaves unused: where it has only one for
/// both, and they differ.
pub(crate) fn alike(plan: &Plan, axis: &AxisPlan) -> Option<String> {
    let has_one = match plan.method().family {
        Family::Polynomial | Family::Trigonometric => plan.method().pvt.is_none(),
        Family::SCurve | Family::Trapezoidal => false,
    };
    let pair = [(axis.limits.acceleration(), "acceleration"), (axis.limits.deceleration(), "deceleration")];
    let [kept, unused] = if pair[0].0 > pair[1].0 { [pair[1], pair[0]] } else { pair };
    if !has_one || kept.0 >= unused.0 {
        return None;
    }
    let unit = unit(axis.kind, Quantity::Acceleration);
    let said = |(limit, name)| format!("{}\u{a0}{unit} of {name}", plain(limit));
    Some(format!("{}, not {}", said(kept), said(unused)))
}

/// What is not as asked, and why, in a sentence.
pub(crate) fn adjusted(screen: &mut Screen<'_>, kind: AxisKind, adjustment: &Adjustment) -> io::Result<()> {
    let Adjustment { quantity, asked, planned, reason } = *adjustment;
    let text = format!(
        "{quantity} not as asked: {} instead of {}\u{a0}{}, {} ({}).",
        plain(planned),
        plain(asked),
        unit(kind, quantity),
        why(reason),
        reason.name(),
    );
    writeln!(screen.out, "{}", wrapped(&text, "  "))
}

/// What an axis does that has no way to go and is in motion.
fn passing(axis: &AxisPlan) -> Option<String> {
    let speed = Some(axis.profile.end().velocity).filter(|speed| *speed != 0.0)?;
    let (speed, unit) = (plain(speed), unit(axis.kind, Quantity::Velocity));
    axis.profile.segments().is_empty().then(|| format!("no way to go, passes at {speed}\u{a0}{unit}"))
}

/// A row for each piece.
fn phases(axis: &AxisPlan, digits: i32) -> Table {
    let pieces: Vec<_> = axis.profile.timed_segments().collect();
    let all = |of: &dyn Fn(&(f64, planner::Segment)) -> f64| pieces.iter().map(of).collect::<Vec<_>>();
    let values = |of: &dyn Fn(&(f64, planner::Segment)) -> f64| column(&all(of), digits);
    let times = |of: &dyn Fn(&(f64, planner::Segment)) -> f64| exact_column(&all(of), digits);
    let mut table = Table::default();
    table.right("#", "", (1..=pieces.len()).map(|number| number.to_string()).collect());
    table.right("from", "[s]", times(&|(begin, _)| *begin));
    table.right("to", "[s]", times(&|(begin, piece)| begin + piece.duration));
    table.right("lasts", "[s]", times(&|(_, piece)| piece.duration));
    let begins = [
        ("jerk", Quantity::Jerk, 3),
        ("position", Quantity::Position, 0),
        ("velocity", Quantity::Velocity, 1),
        ("acceleration", Quantity::Acceleration, 2),
    ];
    for (name, quantity, word) in begins {
        let cells = values(&|(_, piece)| match piece.law {
            // It begins and ends at zero: the peak tells more.
            Law::CosineJerk { peak } if quantity == Quantity::Jerk => peak,
            _ => piece.at(0.0).words()[word],
        });
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
    let explanation = judged.explanation();
    let bindings: Vec<_> = explanation.bindings.iter().filter(|binding| binding.axis == axis.axis).collect();
    if bindings.is_empty() {
        return None;
    }
    let times: Vec<f64> = bindings.iter().flat_map(|binding| [binding.from_time, binding.to_time]).collect();
    let times = exact_column(&times, 4);
    let spans = bindings.iter().zip(times.chunks(2)).map(|(binding, times)| {
        let (from, to) = (&times[0], &times[1]);
        let quantity = binding.quantity;
        if from == to {
            // Too short to be told by when it is.
            let lasts = exact_column(&[binding.to_time - binding.from_time], 3).remove(0);
            return format!("{quantity} for {lasts}\u{a0}s at {from}\u{a0}s");
        }
        format!("{quantity} {from} to {to}\u{a0}s")
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
    let each = |of: &dyn Fn(&LimitCheck) -> f64| -> Vec<String> {
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
                (true, true) if check.led_back_by.is_some() => Verdict::LedBack,
                (true, true) => Verdict::Ok,
                (true, false) => Verdict::NotPromised,
            })
            .collect(),
    );
    table
}

/// What begins beyond a limit, and when it is back, in a sentence for each.
fn led_back(certificate: &Certificate) -> impl Iterator<Item = String> {
    certificate.limits.iter().filter(|check| check.passed()).filter_map(|check| {
        let LimitCheck { axis, quantity, .. } = check;
        let by = plain(check.led_back_by?);
        Some(format!(
            "The {quantity} of {} begins beyond its limit, or bound for there, and is led back by {by}\u{a0}s; the row \
             above is of the rest.",
            clean(axis)
        ))
    })
}

/// Where each axis turns back, of motion that keeps no limit of velocity, in a sentence for each.
fn reversals(plan: &Plan, certificate: &Certificate) -> impl Iterator<Item = String> {
    /// Of one axis: who has more to read takes the JSON.
    const MOST: usize = 6;
    certificate.reversals.chunk_by(|a, b| a.axis == b.axis).map(move |reversals| {
        let axis = &reversals[0].axis;
        let length = unit(kind_of(plan, axis), Quantity::Position);
        let told = &reversals[..reversals.len().min(MOST)];
        let times = exact_column(&told.iter().map(|reversal| reversal.at_time).collect::<Vec<_>>(), 4);
        let places = column(&told.iter().map(|reversal| reversal.position).collect::<Vec<_>>(), 4);
        let each = times.iter().zip(&places);
        let each: Vec<_> =
            each.map(|(time, place)| format!("{time}\u{a0}s ({}\u{a0}{length})", place.trim())).collect();
        let rest = reversals.len() - told.len();
        let more = if rest > 0 { format!(", and {rest} more") } else { String::new() };
        let times = counted(reversals.len() as u64, "time");
        format!("The velocity of {} reverses {times}: at {}{more}.", clean(axis), each.join(", "))
    })
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
            .map(|(join, end)| match (join.passed() && end.passed(), join.guaranteed) {
                (false, _) => Verdict::Failed,
                (true, true) => Verdict::Ok,
                (true, false) => Verdict::NotPromised,
            })
            .collect(),
    );
    table
}

fn kind_of(plan: &Plan, axis: &str) -> AxisKind {
    plan.axes().iter().find(|plan| plan.axis == axis).map_or(AxisKind::Prismatic, |plan| plan.kind)
}
