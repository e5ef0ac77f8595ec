use super::figure::{Figure, Ink, Panel, Series, Stroke};
use super::planned::decimated;
use crate::show::compared::{Compared, Curves};
use crate::show::number::{plain, unit};
use crate::show::paint::clean;
use planner::Quantity;

/// How long after the last end the axis is still seen, of the longest duration [1].
const AFTER: f64 = 0.25;

/// Of the greatest velocity [1]: curves that are this near to each other are drawn as one.
const ONE_CURVE: f64 = 1e-3;

/// Would one curve hide the other, as that of the third order does the S-curve's?
fn coincide(one: &Compared, other: &Compared) -> bool {
    let (ours, theirs) = (&one.curves.velocity, &other.curves.velocity);
    let largest = ours.iter().fold(0.0, |largest: f64, velocity| largest.max(velocity.abs()));
    let near = |(ours, theirs): (&f64, &f64)| (ours - theirs).abs() <= ONE_CURVE * largest;
    ours.iter().zip(theirs).all(near)
}

/// Velocities over each other, the following error of the motor, and how far the load is from where it should be; `machine` says what
/// followed.
pub(crate) fn of_comparison(all: &[Compared], machine: &str) -> Figure {
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
                let is_covered = all[index + 1..].iter().any(|other| coincide(one, other));
                Series {
                    name: format!("{}, {}\u{a0}s", clean(&one.name), plain(one.duration)),
                    ink: Ink::Number(index),
                    stroke: if is_covered { Stroke::Under } else { Stroke::Over },
                    points: decimated(pairs.take_while(|(time, _)| *time <= until).collect(), until),
                }
            })
            .collect(),
        ..Panel::default()
    };
    Figure {
        title: "One move, and how one axis followed it".to_owned(),
        subtitle: machine.to_owned(),
        panels: vec![
            panel("Velocity", Quantity::Velocity, |curves| &curves.velocity),
            panel("Following error", Quantity::Position, |curves| &curves.following_error),
            panel("Load error", Quantity::Position, |curves| &curves.load_error),
        ],
        ..Figure::default()
    }
}
