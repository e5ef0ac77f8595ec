use super::course::Shape;
use super::ends::{Ends, Phases};
use super::lead_in::Confines;
use super::lens::Lens;
use super::upper::Upper;

/// The fastest motion between two ends that goes `way`; none where no velocity within the limits leads there.
///
/// Which family it belongs to is told by what the fastest change of velocity goes: the motions that go farther, in the least
/// time in which that can be, are the upper family's. But for the lens (see [`Upper::lens`]) there is no second candidate.
/// `slack` is what the way is rounded to.
pub(super) fn fastest(ends: Ends, confines: Confines, way: f64, slack: f64) -> Option<Shape> {
    let change = Change::of(ends, confines);
    if ends.are_one() && way.abs() <= slack {
        return Some(Shape { sign: 1.0, phases: [0.0; 7] });
    }
    if (way - change.goes).abs() <= slack + ends.way_rounding(change.shape.duration()) {
        return Some(change.shape);
    }
    let sign = if way > change.goes { 1.0 } else { -1.0 };
    let towards = |sign: f64| Upper::of(sign, ends, confines, way, slack);
    let family = towards(sign);
    let begins_with_peak = sign * change.shape.sign > 0.0;
    let shape = |phases: Phases| Shape { sign, phases };
    let lens = if begins_with_peak && family.ends.goal.acceleration > 0.0 {
        family.lens()
    } else if !begins_with_peak && family.ends.start.acceleration < 0.0 {
        match family.reversed().lens() {
            Lens::Found(mut phases) => {
                phases.reverse();
                Lens::Found(phases)
            }
            other => other,
        }
    } else {
        Lens::Open
    };
    match lens {
        Lens::Found(phases) => Some(shape(phases)),
        Lens::Open => family.summit().map(shape),
        Lens::Closed => {
            let (phases, goes) = towards(1.0).lowest();
            let lowest = Shape { sign: 1.0, phases };
            if (way - goes).abs() <= slack + ends.way_rounding(lowest.duration()) {
                return Some(lowest);
            }
            let sign = if way > goes { 1.0 } else { -1.0 };
            towards(sign).summit().map(|phases| Shape { sign, phases })
        }
    }
}

/// The fastest change of velocity and acceleration, wherever it leads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Change {
    pub(super) shape: Shape,
    /// How far it goes.
    pub(super) goes: f64,
}

impl Change {
    pub(super) fn of(ends: Ends, confines: Confines) -> Self {
        let (sign, ends, limit) = if ends.change_has_peak() {
            (1.0, ends, confines.up)
        } else {
            (-1.0, ends.mirrored(), confines.down)
        };
        let [up, hold, down] = ends.fastest_change(limit);
        let mut state = ends.start;
        let mut goes = state.advance(1.0, up);
        if hold > 0.0 {
            state.acceleration = limit;
            goes += state.advance(0.0, hold);
        }
        goes += state.advance(-1.0, down);
        let phases = [up, hold, down, 0.0, 0.0, 0.0, 0.0];
        Self { shape: Shape { sign, phases }, goes: sign * goes }
    }
}
