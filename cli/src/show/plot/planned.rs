use planner::{AxisKind, AxisPlan, Family, Law, Plan, Quantity, Synchronization};

use super::figure::{Band, Baseline, Figure, Ink, Limit, Panel, Series, Stroke};
use super::layout::{LEFT, RIGHT};
use crate::show::columns::short;
use crate::show::number::{self, plain, unit};
use crate::show::words::classification;

/// Position, velocity, acceleration and jerk of a plan, with its limits and phases.
pub(crate) fn of_plan(plan: &Plan) -> Figure {
    let axes: Vec<_> = plan.axes().iter().enumerate().collect();
    let mut panels = Vec::new();
    for kind in [AxisKind::Prismatic, AxisKind::Revolute, AxisKind::Pulses] {
        let of_kind: Vec<_> = axes.iter().copied().filter(|(_, axis)| axis.kind == kind).collect();
        if of_kind.is_empty() {
            continue;
        }
        for (word, (name, quantity)) in QUANTITIES.into_iter().enumerate() {
            let series = of_kind.iter().map(|(index, axis)| Series {
                name: short(&axis.axis),
                ink: Ink::Number(*index),
                stroke: Stroke::Plain,
                points: curve(axis, plan.duration(), word),
            });
            let several = axes.len() > 1;
            let limits = of_kind.iter().flat_map(|(index, axis)| {
                let ink = if several { Ink::Number(*index) } else { Ink::Grey };
                limits(axis, quantity).into_iter().map(move |value| Limit { value, ink })
            });
            panels.push(Panel {
                title: match (quantity, plan.method().family) {
                    (Quantity::Jerk, Family::Trapezoidal) => {
                        format!("{name}, without bound where the acceleration jumps")
                    }
                    _ => name.to_owned(),
                },
                unit: unit(kind, quantity),
                baseline: baseline(quantity),
                series: series.collect(),
                limits: distinct(limits),
                marks: Vec::new(),
            });
        }
    }
    // Where no axis sets the pace, the phases of the first are as good as any.
    let critical = planner::explain(plan).critical_axis;
    let slowest = plan.axes().iter().find(|axis| axis.axis == critical).or(plan.axes().first());
    let (title, bands_name) = match (slowest, plan.axes().len()) {
        (Some(axis), 1) => (
            format!("{}: {}", short(&axis.axis), classification(&axis.classification, axis.kind)),
            "phase".to_owned(),
        ),
        (Some(axis), axes) => {
            let name = short(&axis.axis);
            let shape = classification(&axis.classification, axis.kind);
            let together = match plan.method().synchronization {
                _ if plan.method().pvt.is_some() || critical.is_empty() => format!("{axes} axes"),
                Synchronization::None => format!("{axes} axes; {name} takes longest"),
                Synchronization::Time => {
                    format!("{axes} axes that arrive together, {name} as fast as it can")
                }
                Synchronization::Phase => format!("{axes} axes on one line, which {name} holds back most"),
            };
            (format!("{together}; {name}: {shape}"), format!("phase of {name}"))
        }
        (None, _) => (String::new(), String::new()),
    };
    let bands = slowest.into_iter().flat_map(|axis| axis.profile.timed_segments()).enumerate();
    let bands = bands.map(|(index, (from, segment))| Band {
        from,
        to: from + segment.duration,
        label: (index + 1).to_string(),
    });
    let (seconds, cycles) = (plain(plan.duration()), number::counted(plan.cycle_count(), "cycle"));
    Figure {
        title,
        subtitle: format!("{seconds} s, {cycles} of {}", number::cycle(plan.cycle_time())),
        panels,
        bands_name,
        bands: bands.collect(),
        strips: Vec::new(),
    }
}

const QUANTITIES: [(&str, Quantity); 4] = [
    ("Position", Quantity::Position),
    ("Velocity", Quantity::Velocity),
    ("Acceleration", Quantity::Acceleration),
    ("Jerk", Quantity::Jerk),
];

/// What values of `quantity` are seen against.
pub(super) fn baseline(quantity: Quantity) -> Baseline {
    if quantity == Quantity::Position { Baseline::Themselves } else { Baseline::Zero }
}

/// One derivative over time, as far as `until` [s]: enough points to look smooth, and both ends of each piece.
pub(super) fn curve(axis: &AxisPlan, until: f64, word: usize) -> Vec<(f64, f64)> {
    /// Over the whole width.
    const POINTS: f64 = 900.0;
    /// In one piece, however short.
    const LEAST: usize = 12;
    let mut points = Vec::new();
    let is_jerk = word == 3;
    if is_jerk {
        points.push((0.0, 0.0));
    }
    let few = axis.profile.segments().len() <= 200;
    for (begin, segment) in axis.profile.timed_segments() {
        let share = (segment.duration / until * POINTS).ceil() as usize;
        let steps = is_jerk && matches!(segment.law, Law::ConstantJerk(_));
        let count = match (steps, few) {
            (true, _) => 1,
            (false, true) => share.max(LEAST),
            (false, false) => share.max(1),
        };
        points.extend((0..=count).map(|index| {
            let time = segment.duration * index as f64 / count as f64;
            (begin + time, segment.at(time).words()[word])
        }));
    }
    let held = planner::Setpoint::held(axis.profile.end()).words()[word];
    points.push((axis.profile.duration(), held));
    points.push((until, held));
    decimated(points, until)
}

/// At most four points for each column of the picture: the first, the least, the greatest and the last.
pub(super) fn decimated(points: Vec<(f64, f64)>, until: f64) -> Vec<(f64, f64)> {
    const COLUMNS: f64 = 2.0 * (RIGHT - LEFT);
    if points.len() <= 4 * COLUMNS as usize {
        return points;
    }
    let column = |point: &(f64, f64)| (point.0 / until * COLUMNS) as i64;
    let mut kept = Vec::new();
    for points in points.chunk_by(|a, b| column(a) == column(b)) {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let ends = [points.first(), points.last()];
        let extremes = [points.iter().min_by(by_value), points.iter().max_by(by_value)];
        let mut column: Vec<(f64, f64)> = ends.into_iter().chain(extremes).flatten().copied().collect();
        column.sort_by(|a, b| a.0.total_cmp(&b.0));
        column.dedup();
        kept.extend(column);
    }
    kept
}

fn limits(axis: &AxisPlan, quantity: Quantity) -> Vec<f64> {
    let limits = &axis.limits;
    let hardest = limits.acceleration().max(limits.deceleration());
    match quantity {
        Quantity::Position => [limits.min_position(), limits.max_position()].into(),
        Quantity::Velocity => [limits.velocity_forward(), -limits.velocity_reverse()].into(),
        Quantity::Acceleration => [hardest, -hardest].into(),
        Quantity::Jerk => [limits.jerk(), -limits.jerk()].into(),
        _ => Vec::new(),
    }
}

/// Each value once; one that several share belongs to none of them.
fn distinct(limits: impl Iterator<Item = Limit>) -> Vec<Limit> {
    let mut kept: Vec<Limit> = Vec::new();
    for limit in limits.filter(|limit| limit.value.is_finite()) {
        match kept.iter_mut().find(|other| other.value.to_bits() == limit.value.to_bits()) {
            Some(other) => other.ink = Ink::Grey,
            None => kept.push(limit),
        }
    }
    kept
}
