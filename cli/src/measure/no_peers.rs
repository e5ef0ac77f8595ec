//! Built without peers: nobody is asked, and nobody disagrees.

use planner::motion::Motion;
use planner::{Problem, Profile};

use super::inputs::states::Question;
use super::rows::{Beside, Unequal};

pub(super) fn solves_move(_: &Problem, _: f64) -> Result<bool, Unequal> {
    Ok(true)
}

pub(super) fn solves_together<const AXES: usize>(_: &[Question], _: f64) -> Result<bool, Unequal> {
    Ok(true)
}

pub(super) fn moves(_: &[Problem]) -> Beside {
    None
}

pub(super) fn states(_: &[Question]) -> Beside {
    None
}

pub(super) fn together<const AXES: usize>(_: &[Vec<Question>]) -> Beside {
    None
}

pub(super) fn generator(_: usize, _: u64) -> Result<Beside, Unequal> {
    Ok(None)
}

pub(super) fn one_setpoint(_: &Problem, _: &Profile, _: &[f64]) -> Result<Beside, Unequal> {
    Ok(None)
}

pub(super) fn batch(_: &Motion, _: u64) -> Result<Beside, Unequal> {
    Ok(None)
}

pub(super) fn splice(_: &Motion) -> Result<Beside, Unequal> {
    Ok(None)
}
