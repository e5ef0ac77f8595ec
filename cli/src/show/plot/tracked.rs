use planner::Plan;

use super::figure::{Figure, Ink, Panel, Series, Stroke};
use super::planned::of_plan;
use crate::show::table::short;

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
    pub(crate) measured_velocity: Vec<f64>,
    pub(crate) following_error: Vec<f64>,
}

/// Commanded against measured position and velocity, and the following error, above what `plan` says of acceleration
/// and jerk.
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
