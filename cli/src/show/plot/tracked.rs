use planner::Plan;

use super::figure::{Band, Figure, Ink, Panel, Series, Stroke};
use super::planned::of_plan;
use crate::show::columns::short;
use crate::show::number::{counted, plain};

/// What an axis was told and what it did, cycle by cycle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tracked {
    pub(crate) axis: String,
    pub(crate) unit: String,
    /// [s]
    pub(crate) times: Vec<f64>,
    pub(crate) commanded_position: Vec<f64>,
    pub(crate) measured_position: Vec<f64>,
    pub(crate) commanded_velocity: Vec<f64>,
    pub(crate) commanded_acceleration: Vec<f64>,
    pub(crate) commanded_jerk: Vec<f64>,
    pub(crate) measured_velocity: Vec<f64>,
    pub(crate) following_error: Vec<f64>,
    /// Operations on the way: when each took effect [s], and what it does from then on.
    pub(crate) operations: Vec<(f64, String)>,
}

/// Commanded against measured position and velocity, and the following error, above what `plan` says of acceleration
/// and jerk; where operations changed it, here or from elsewhere, what was commanded.
pub(crate) fn of_tracking(plan: &Plan, tracked: &Tracked) -> Figure {
    let Tracked { axis, unit, times, .. } = tracked;
    let pairs =
        |values: &[f64]| -> Vec<(f64, f64)> { times.iter().copied().zip(values.iter().copied()).collect() };
    let told = |values| Series {
        name: "commanded".to_owned(),
        ink: Ink::Number(4),
        stroke: Stroke::Under,
        points: pairs(values),
    };
    let did = |name: &str, values| Series {
        name: name.to_owned(),
        ink: Ink::Number(1),
        stroke: Stroke::Over,
        points: pairs(values),
    };
    let mut figure = of_plan(plan);
    let planned = std::mem::take(&mut figure.panels);
    let panel = |title: &str, unit: String, series| {
        let alike = planned.iter().find(|panel| panel.title == title).cloned().unwrap_or_default();
        Panel { title: title.to_owned(), unit, series, ..alike }
    };
    figure.title = format!("{}: commanded against measured", short(axis));
    figure.panels = vec![
        panel(
            "Position",
            unit.clone(),
            vec![told(&tracked.commanded_position), did("measured", &tracked.measured_position)],
        ),
        panel(
            "Velocity",
            format!("{unit}/s"),
            vec![told(&tracked.commanded_velocity), did("measured", &tracked.measured_velocity)],
        ),
        panel("Following error", unit.clone(), vec![did("measured", &tracked.following_error)]),
    ];
    let rest = planned.into_iter().filter(|panel| matches!(panel.title.as_str(), "Acceleration" | "Jerk"));
    let until = times.last().copied().unwrap_or_default();
    let (marks, how) = if tracked.operations.is_empty() {
        let changed = departure(plan, tracked).map(|from| (from, "changed on the way".to_owned()));
        (changed.into_iter().collect(), "not as planned: changed on the way".to_owned())
    } else {
        let count = counted(tracked.operations.len() as u64, "operation");
        (tracked.operations.clone(), format!("with {count}"))
    };
    if !marks.is_empty() {
        let mut played = [&tracked.commanded_acceleration, &tracked.commanded_jerk].into_iter();
        figure.panels.extend(
            rest.zip(&mut played).map(|(panel, values)| Panel { series: vec![told(values)], ..panel }),
        );
        figure.bands_name = "operation".to_owned();
        figure.bands = operations(&marks, until);
        figure.subtitle = format!("{} s, {how}", plain(until));
        return figure;
    }
    figure.panels.extend(rest.map(|mut panel| {
        for series in &mut panel.series {
            "commanded".clone_into(&mut series.name);
            series.ink = Ink::Number(4);
            // The axis is watched for longer than it moves.
            let held = series.points.last().filter(|last| last.0 < until).map(|last| (until, last.1));
            series.points.extend(held);
        }
        panel
    }));
    figure
}

/// When what was commanded ceases to be what was planned \[s\]: somebody else has operated on it.
fn departure(plan: &Plan, tracked: &Tracked) -> Option<f64> {
    /// Of the way: far above the rounding of a sum, and less than any drive can tell.
    const SAME: f64 = 1e-9;
    let axis = plan.axes().first()?;
    let (start, end) = (axis.profile.start().position, axis.profile.end().position);
    let allowed = SAME * (end - start).abs().max(start.abs()).max(end.abs());
    let mut told = tracked.times.iter().zip(&tracked.commanded_position);
    let differs =
        |&(&time, &told): &(&f64, &f64)| (axis.profile.at(time).state.position - told).abs() > allowed;
    told.find(differs).map(|(time, _)| *time)
}

/// From each operation to the next.
fn operations(operations: &[(f64, String)], until: f64) -> Vec<Band> {
    let begins = std::iter::once((0.0, "as planned"))
        .chain(operations.iter().map(|(from, name)| (*from, name.as_str())));
    let ends = operations.iter().map(|operation| operation.0).chain([until]);
    begins.zip(ends).map(|((from, label), to)| Band { from, to, label: label.to_owned() }).collect()
}
