//! From the columns of a request to those of its answer, move by move.

use planner::{Adjustment, Family, Law, Maker, MoveSeries, RequestSpec, SeriesError, SeriesMove, State};

use super::{MoveColumns, columns_from_wire};
use crate::convert::duration::after;
use crate::convert::encode::adjustment_to_wire;
use crate::convert::field::within;
use crate::{Detail, Reason, Rejected, pb};

/// The moves of one message as they are planned: each goes from its place in the columns of the request to that in the columns of the
/// answer.
#[derive(Debug)]
pub struct Moves {
    series: MoveSeries,
    columns: MoveColumns,
    /// Those of what all have in common.
    ends: (State, State),
    /// Do limits differ from move to move?
    limited: bool,
    detail: Detail,
    answer: pb::PlanColumns,
    segments: pb::SegmentColumns,
    /// Of refusals and adjustments in the answer.
    bytes: usize,
    next: usize,
}

impl Moves {
    /// The moves that a message asks for, of each of which `detail` is told; `admit` says whether they are too many, before anything is
    /// done for them.
    ///
    /// # Errors
    /// What `admit` says, and what is wrong with all of them: nothing in common, or not of one axis; columns of different lengths; whatever else
    /// [`MoveSeries::like`] refuses.
    pub fn from_wire(
        wire: pb::MoveColumns,
        detail: Detail,
        admit: impl FnOnce(usize) -> Result<(), Rejected>,
    ) -> Result<Self, Rejected> {
        let (malformed, columns) = columns_from_wire(wire)?;
        admit(columns.len())?;
        let series = after(malformed, MoveSeries::like(columns.like.clone()))
            .map_err(|inner| within("columns.like", inner))?;
        if let Some(ragged) = columns.ragged() {
            return Err(ragged);
        }
        let still = State::at_rest(0.0);
        let ends = columns.like.axes.first().map_or((still, still), |axis| (axis.start, axis.goal));
        let limited = columns.have_limits();
        let Maker { planner_version, evaluation_version } = Maker::default();
        let answer = pb::PlanColumns { planner_version, evaluation_version, ..pb::PlanColumns::default() };
        let segments = pb::SegmentColumns::default();
        let mut moves = Self { series, columns, ends, limited, detail, answer, segments, bytes: 0, next: 0 };
        moves.reserve();
        Ok(moves)
    }

    /// Room for an ordinary answer: to grow step by step is to copy it as often.
    fn reserve(&mut self) {
        let Self { series, detail, answer, segments, .. } = self;
        let count = self.columns.len();
        answer.duration.reserve_exact(count);
        answer.cycle_count.reserve_exact(count);
        answer.segment_count.reserve_exact(count);
        let pieces = planner::MAX_PIECES * count;
        let Told { position, acceleration, jerk } = Told::of(series.family(), *detail);
        let columns = [
            (&mut segments.duration, true),
            (&mut segments.position, position),
            (&mut segments.velocity, position),
            (&mut segments.acceleration, acceleration),
            (&mut segments.jerk, jerk),
        ];
        for (column, told) in columns {
            column.reserve_exact(if told { pieces } else { 0 });
        }
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Is there none?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The family of all.
    #[must_use]
    pub fn family(&self) -> Family {
        self.series.family()
    }

    /// Do they take longer than numbers need, as polynomials do, and what is slowed?
    #[must_use]
    pub fn are_long(&self) -> bool {
        let RequestSpec { end_on_cycle, minimum_duration, .. } = self.columns.like;
        self.family() == Family::Polynomial || end_on_cycle || minimum_duration.is_some()
    }

    /// How large the answer is by now \[bytes\], within a few for each move.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let pb::PlanColumns { duration, cycle_count, segment_count, .. } = &self.answer;
        let segments = &self.segments;
        let doubles = [
            duration,
            &segments.duration,
            &segments.position,
            &segments.velocity,
            &segments.acceleration,
            &segments.jerk,
            &segments.derivatives,
        ];
        let doubles: usize = doubles.into_iter().map(Vec::len).sum();
        // A count of segments or derivatives has one byte, one of cycles mostly two.
        8 * doubles
            + 2 * cycle_count.len()
            + segment_count.len()
            + segments.derivative_count.len()
            + self.bytes
    }

    /// Plans and judges the next move, and puts what became of it into its place; why it is refused, if it is. `None` when all are done.
    pub fn plan_next(&mut self) -> Option<Result<(), Reason>> {
        let Self { series, columns, ends: (start, goal), limited, detail, answer, segments, bytes, next } =
            self;
        let index = *next;
        if index >= columns.len() {
            return None;
        }
        *next += 1;
        if *limited {
            series.limit(|limits| columns.limit(index, limits));
        }
        let (start, goal) = columns.ends(index, *start, *goal);
        let told = Told::of(series.family(), *detail);
        let rejected = match series.answer(start, goal) {
            Ok(moved) => {
                told.lay(&moved, answer, segments);
                for adjustment in moved.adjustments() {
                    *bytes += adjust(answer, index, adjustment);
                }
                return Some(Ok(()));
            }
            Err(SeriesError::Invalid(invalid)) => Rejected::from(columns.located(index, &invalid)),
            Err(SeriesError::Rejected(rejection)) => Rejected::from(rejection),
        };
        let refused = pb::plan_columns::RefusedMove { index: index as u32, refusal: rejected.to_bytes() };
        *bytes += refused.refusal.len() + ROUND;
        answer.refusals.push(refused);
        answer.duration.push(0.0);
        answer.cycle_count.push(0);
        answer.segment_count.push(0);
        Some(Err(rejected.reason))
    }

    /// The answer, of the moves that are done.
    #[must_use]
    pub fn into_wire(self) -> pb::PlanColumns {
        pb::PlanColumns { segments: Some(self.segments), ..self.answer }
    }
}

/// What is around a message in a message \[bytes\]: keys, lengths, an index.
const ROUND: usize = 12;

/// Tells what is not as asked; how many bytes that takes.
#[cold]
fn adjust(answer: &mut pb::PlanColumns, index: usize, adjustment: &Adjustment) -> usize {
    let adjustment = adjustment_to_wire(adjustment);
    // Two numbers with their keys, and a quantity.
    let bytes = adjustment.reason.len() + 22 + ROUND;
    let adjustment = Some(adjustment);
    answer.adjustments.push(pb::plan_columns::AdjustedMove { index: index as u32, adjustment });
    bytes
}

/// The columns of segments that have numbers: what the rest does not give. The duration is always told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Told {
    /// And the velocity.
    pub(super) position: bool,
    pub(super) acceleration: bool,
    /// Else derivatives.
    pub(super) jerk: bool,
}

impl Told {
    pub(super) fn of(family: Family, detail: Detail) -> Self {
        let position = detail == Detail::Full;
        let acceleration = position || family == Family::Trapezoidal;
        Self { position, acceleration, jerk: family != Family::Polynomial }
    }

    /// Puts a move behind those before it.
    #[inline]
    fn lay(self, moved: &SeriesMove<'_>, answer: &mut pb::PlanColumns, to: &mut pb::SegmentColumns) {
        let profile = moved.profile();
        let segments = profile.segments();
        answer.duration.push(profile.duration());
        answer.cycle_count.push(moved.cycle_count());
        answer.segment_count.push(segments.len() as u32);
        for index in 0..segments.len() {
            let (duration, start, jerk) = match segments.constant_jerk(index) {
                Some(piece) => {
                    if !self.jerk {
                        to.derivative_count.push(1);
                        to.derivatives.push(piece.2);
                    }
                    piece
                }
                None => match segments.get(index) {
                    Some(piece) => (piece.duration, piece.start, self.law(piece.law, to)),
                    None => continue,
                },
            };
            to.duration.push(duration);
            if self.position {
                to.position.push(start.position);
                to.velocity.push(start.velocity);
            }
            if self.acceleration {
                to.acceleration.push(start.acceleration);
            }
            if self.jerk {
                to.jerk.push(jerk);
            }
        }
    }

    /// Tells a law that is not one of constant jerk; the number of those that have one.
    fn law(self, law: Law, to: &mut pb::SegmentColumns) -> f64 {
        match law {
            Law::ConstantJerk(jerk) | Law::CosineJerk { peak: jerk } => jerk,
            Law::Polynomial(derivatives) => {
                to.derivative_count.push(derivatives.as_slice().len() as u32);
                to.derivatives.extend_from_slice(derivatives.as_slice());
                0.0
            }
        }
    }
}
