//! What would be taken in place of a command that is refused.

use super::command::Command;
use super::planner::{Axis, PvtMove, PvtTarget, fits};
use crate::float::{largest, least};
use crate::limits::is_number;
use crate::{Move, State};

/// What would be taken in place of a command that is refused: each of them as it stands, under every policy.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PvtOffers {
    /// In the same time, with the velocity nearest to the one asked for, and with that the nearest position.
    pub nearest: Option<PvtTarget>,
    /// At the same position in the same time, with the nearest velocity that gets there.
    pub same_position: Option<PvtTarget>,
    /// With the same position and velocity, after the first longer time in which both are met.
    pub later: Option<PvtTarget>,
    /// Is there such a time, if the position range is left aside?
    pub time_helps: bool,
}

/// By how much a number is moved until it is taken, doubled from one rounding on \[1\]: what a root may be off beside a very steep
/// function, which is worth less than any drive can tell.
const STEPS: u32 = 26;

/// In how many parts velocities are tried where the range of positions leaves none near, and how often the first that is taken is then
/// halved towards the one before it.
const COARSE: u32 = 16;
const FINE: u32 = 24;

impl Axis {
    /// What would be taken in place of `target`, which is not.
    #[cold]
    pub(super) fn offers(&self, command: &Command, start: State, target: &PvtTarget) -> PvtOffers {
        let later = command.extended(self.lanes());
        let as_late =
            |step: f64| later.map(|duration| PvtTarget { duration: duration * (1.0 + step), ..*target });
        PvtOffers {
            nearest: self.nearest(command, start, target),
            same_position: self.same_position(command, start, target),
            later: moved().find_map(|step| self.taken(start, as_late(step)?)),
            time_helps: later.is_some(),
        }
    }

    fn nearest(&self, command: &Command, start: State, target: &PvtTarget) -> Option<PvtTarget> {
        if let Some(range) = command.range(self.lanes()) {
            return self.nearest_position(range, start, target);
        }
        let nearest = command.nearest_velocity(self.lanes());
        let with = |velocity: f64| {
            let range = Command { end: velocity, ..*command }.range(self.lanes())?;
            self.nearest_position(range, start, &PvtTarget { velocity, ..*target })
        };
        // Towards the velocity of the start, for which any time suffices.
        let back = start.velocity - nearest;
        let scale = largest(nearest.abs(), start.velocity.abs());
        let rounded = moved().find_map(|step| with(nearest + least(step * scale, back.abs()).copysign(back)));
        if rounded.is_some() {
            return rounded;
        }
        // Whatever position it leads to is out of the range, or the way there: the next one on the way to the other end of what the time
        // leads to.
        let end = self.limits().cruise_towards(back).copysign(back);
        let other_end = Command { end, ..*command }.nearest_velocity(self.lanes());
        let at = |step: f64| nearest + step * (other_end - nearest);
        let step = (1..=COARSE)
            .map(|step| f64::from(step) / f64::from(COARSE))
            .find(|&step| with(at(step)).is_some())?;
        let (mut outside, mut inside) = (step - 1.0 / f64::from(COARSE), step);
        for _ in 0..FINE {
            let middle = 0.5 * (inside + outside);
            if with(at(middle)).is_some() { inside = middle } else { outside = middle }
        }
        with(at(inside))
    }

    /// The target with the nearest position that is taken; `range` is what its velocity and time allow.
    fn nearest_position(
        &self,
        (low, high): (f64, f64),
        start: State,
        target: &PvtTarget,
    ) -> Option<PvtTarget> {
        let at = |displacement: f64| PvtTarget { position: start.position + displacement, ..*target };
        let nearest = largest(low, least(high, target.position - start.position));
        if let Some(taken) = self.taken(start, at(nearest)) {
            return Some(taken);
        }
        // It leaves the range. A greater displacement is farther ahead at every instant, so what stays below the upper end of the
        // range are the displacements up to one of them, and what stays above the lower end those from one on.
        let span =
            |displacement: f64| self.laid(start, &at(displacement)).map(|planned| span(planned.motion()));
        let (lowest, highest) = span(nearest)?;
        let (mut inside, mut outside) = if highest > self.limits().max_position() {
            (low, nearest)
        } else if lowest < self.limits().min_position() {
            (high, nearest)
        } else {
            return None;
        };
        let upwards = outside > inside;
        for _ in 0..f64::MANTISSA_DIGITS {
            let middle = 0.5 * (inside + outside);
            let (lowest, highest) = span(middle)?;
            let stays = if upwards {
                highest <= self.limits().max_position()
            } else {
                lowest >= self.limits().min_position()
            };
            if stays {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        self.taken(start, at(inside))
    }

    fn same_position(&self, command: &Command, start: State, target: &PvtTarget) -> Option<PvtTarget> {
        let (velocity, _) = command.velocity_for_position(self.lanes(), None)?;
        let scale = largest(velocity.abs(), largest(start.velocity.abs(), target.velocity.abs()));
        let with = |velocity: f64| self.taken(start, PvtTarget { velocity, ..*target });
        moved().find_map(|step| with(velocity + step * scale).or_else(|| with(velocity - step * scale)))
    }

    fn taken(&self, start: State, target: PvtTarget) -> Option<PvtTarget> {
        let planned = self.laid(start, &target)?;
        let fits = fits(target.position, target.velocity, self.limits());
        (fits && self.outside(planned.motion(), start, 0.0).is_none()).then_some(target)
    }

    /// The motion that meets `target`, wherever it leads.
    fn laid(&self, start: State, target: &PvtTarget) -> Option<PvtMove> {
        if !is_number(target.duration) {
            return None;
        }
        let command = Self::command(start, target, 0.0);
        let reach = command.nearest(self.lanes())?;
        if reach.short_of(command.displacement) != 0.0 {
            return None;
        }
        let mut planned = PvtMove::unplanned();
        self.lay(&mut planned, &command, &command, &reach, start, target);
        Some(planned)
    }
}

/// Parts by which a number is moved: none at first.
fn moved() -> impl Iterator<Item = f64> {
    let steps = (0..STEPS).map(|step| f64::EPSILON * f64::from(1u32 << step));
    core::iter::once(0.0).chain(steps)
}

/// The lowest and the highest position of a motion [axis units].
fn span(motion: &Move) -> (f64, f64) {
    let reached = motion.reached().position;
    let mut span = (reached, reached);
    for segment in motion.segments() {
        for t in segment.turning_points() {
            let position = segment.at(t).state.position;
            span = (least(span.0, position), largest(span.1, position));
        }
    }
    span
}
