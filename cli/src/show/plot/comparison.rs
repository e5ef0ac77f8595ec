use super::figure::{Figure, Ink, Panel, Series, Stroke};
use super::planned::decimated;
use crate::show::compared::{Compared, Curves};
use crate::show::number::{plain, unit};
use crate::show::paint::clean;
use planner::Quantity;

/// How long after the last end the axis is still seen, of the longest duration [1].
const AFTER: f64 = 0.25;

/// Velocities over each other, the following error of the motor, and how far the load is from where it should be.
pub(crate) fn of_comparison(all: &[Compared]) -> Figure {
    let longest = all.iter().fold(0.0, |longest: f64, one| longest.max(one.duration));
    let until = (1.0 + AFTER) * longest;
    let kind = all.first().map(|one| one.kind);
    let panel = |title: &str, quantity, of: fn(&Curves) -> &Vec<f64>| Panel {
        title: title.to_owned(),
        unit: kind.map(|kind| unit(kind, quantity)).unwrap_or_default(),
        series: all
            .iter()
            .enumerate()
            .map(|(index, one)| {
                let pairs = one.curves.times.iter().copied().zip(of(&one.curves).iter().copied());
                Series {
                    name: clean(&one.name),
                    ink: Ink::Number(index),
                    stroke: Stroke::Over,
                    points: decimated(pairs.take_while(|(time, _)| *time <= until).collect(), until),
                }
            })
            .collect(),
        ..Panel::default()
    };
    let durations: Vec<String> =
        all.iter().map(|one| format!("{} {} s", clean(&one.name), plain(one.duration))).collect();
    Figure {
        title: "One move, and how one axis followed it".to_owned(),
        subtitle: durations.join(", "),
        panels: vec![
            panel("Velocity", Quantity::Velocity, |curves| &curves.velocity),
            panel("Following error", Quantity::Position, |curves| &curves.following_error),
            panel("Load error", Quantity::Position, |curves| &curves.load_error),
        ],
        ..Figure::default()
    }
}
