//! The columns of an answer, checked once, and read move by move.

use std::ops::Range;

use planner::{
    Accepted, Adjustment, AxisPlan, Classification, Derivatives, Family, Judged, Law, Maker, Method, Plan,
    Profile, Request, Segment, State,
};

use super::MoveColumns;
use super::moves::Told;
use crate::convert::plan::adjustment_from_wire;
use crate::{Detail, Reason, Rejected, pb};

/// What became of the moves of one message of columns.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedMoves {
    answer: pb::PlanColumns,
    segments: pb::SegmentColumns,
    /// Where the segments of each move begin, and where those of the last end.
    begins: Vec<u32>,
    /// The same of derivatives, segment by segment; empty where none are told.
    derivatives: Vec<u32>,
}

/// One move that is planned and has passed the judge of the server: its numbers where they came in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedMove<'a> {
    /// How long it lasts \[s\].
    pub duration: f64,
    /// The cycle in which it has ended, counted from 0.
    pub cycle_count: u64,
    /// How long each segment lasts \[s\].
    pub segment_duration: &'a [f64],
    /// Where each begins [axis units]; empty where that is not told.
    pub position: &'a [f64],
    /// With which velocity [axis units/s]; empty where that is not told.
    pub velocity: &'a [f64],
    /// With which acceleration [axis units/s²]; empty where that is not told.
    pub acceleration: &'a [f64],
    /// The constant jerk, or the peak of a raised cosine [axis units/s³]; empty of polynomials.
    pub jerk: &'a [f64],
}

impl PlannedMoves {
    /// The columns as they came.
    ///
    /// # Errors
    /// [`Reason::MessageInvalid`] where they do not belong together: in length, or what they say of moves that there are not.
    pub fn from_wire(wire: pb::PlanColumns) -> Result<Self, Rejected> {
        let mut answer = wire;
        let segments = answer.segments.take().unwrap_or_default();
        let moves = answer.duration.len();
        let begins = sums(&answer.segment_count).ok_or_else(|| broken("segments"))?;
        let pieces = segments.duration.len();
        if answer.cycle_count.len() != moves || answer.segment_count.len() != moves {
            return Err(broken("durations, cycles and segments of moves"));
        }
        let told = [&segments.position, &segments.velocity, &segments.acceleration, &segments.jerk];
        let fits = |column: &Vec<f64>| column.is_empty() || column.len() == pieces;
        if begins.last().copied() != Some(pieces as u32) || !told.into_iter().all(fits) {
            return Err(broken("segments"));
        }
        let counts = &segments.derivative_count;
        let derivatives = sums(counts).ok_or_else(|| broken("derivatives"))?;
        let counted = counts.is_empty() || counts.len() == pieces;
        if !counted || derivatives.last().copied() != Some(segments.derivatives.len() as u32) {
            return Err(broken("derivatives"));
        }
        let refused = answer.refusals.iter().map(|refused| refused.index);
        let ascends = refused.clone().zip(refused.clone().skip(1)).all(|(one, next)| one < next);
        let adjusted = answer.adjustments.iter().map(|adjusted| adjusted.index);
        let sorted = adjusted.clone().zip(adjusted.clone().skip(1)).all(|(one, next)| one <= next);
        let known = refused.chain(adjusted).all(|index| (index as usize) < moves);
        let empty = answer
            .refusals
            .iter()
            .all(|refused| answer.segment_count.get(refused.index as usize).is_none_or(|count| *count == 0));
        if !(ascends && sorted && known && empty) {
            return Err(broken("refusals and adjustments"));
        }
        Ok(Self { answer, segments, begins, derivatives })
    }

    /// How many moves were asked for.
    #[must_use]
    pub fn len(&self) -> usize {
        self.answer.duration.len()
    }

    /// None?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// How long each lasts \[s\]; 0 of one that is refused.
    #[must_use]
    pub fn durations(&self) -> &[f64] {
        &self.answer.duration
    }

    /// The cycle in which each has ended, counted from 0; 0 of one that is refused.
    #[must_use]
    pub fn cycle_counts(&self) -> &[u64] {
        &self.answer.cycle_count
    }

    /// The moves that are refused, in their order.
    pub fn refusals(&self) -> impl Iterator<Item = (usize, Rejected)> {
        self.answer.refusals.iter().map(|refused| (refused.index as usize, reason(&refused.refusal)))
    }

    /// Is none refused?
    #[must_use]
    pub fn all_planned(&self) -> bool {
        self.answer.refusals.is_empty()
    }

    /// What became of move number `index`; `None` where there is no such move.
    #[must_use]
    pub fn outcome(&self, index: usize) -> Option<Result<PlannedMove<'_>, Rejected>> {
        let range = self.range(index)?;
        let refusals = &self.answer.refusals;
        if let Ok(place) = refusals.binary_search_by_key(&index, |refused| refused.index as usize) {
            return Some(Err(reason(&refusals.get(place)?.refusal)));
        }
        let part =
            |column: &'_ [f64]| -> Range<usize> { if column.is_empty() { 0..0 } else { range.clone() } };
        let segments = &self.segments;
        Some(Ok(PlannedMove {
            duration: *self.answer.duration.get(index)?,
            cycle_count: *self.answer.cycle_count.get(index)?,
            segment_duration: segments.duration.get(range.clone())?,
            position: segments.position.get(part(&segments.position))?,
            velocity: segments.velocity.get(part(&segments.velocity))?,
            acceleration: segments.acceleration.get(part(&segments.acceleration))?,
            jerk: segments.jerk.get(part(&segments.jerk))?,
        }))
    }

    /// What is not as asked of move number `index`.
    ///
    /// # Errors
    /// What is no adjustment.
    pub fn adjustments(&self, index: usize) -> Result<Vec<Adjustment>, Rejected> {
        let all = &self.answer.adjustments;
        let from = all.partition_point(|adjusted| (adjusted.index as usize) < index);
        let own = all.iter().skip(from).take_while(|adjusted| adjusted.index as usize == index);
        let adjustment = |adjusted: &pb::plan_columns::AdjustedMove| {
            adjustment_from_wire(adjusted.adjustment.clone().unwrap_or_default()).map_err(Rejected::from)
        };
        own.map(adjustment).collect()
    }

    /// The plan of move number `index` of those that were `asked`: with the bits of the one that `Plan` gives for it, and passed by the
    /// judge here as well.
    ///
    /// The planner here plans it again; where that gives what came, it is the plan. Else, as between two versions, the plan is made of what came,
    /// which takes all of the detail.
    ///
    /// # Errors
    /// The refusal of the move; [`Reason::MessageInvalid`] where another planner has made it and its states are not told, or where there is no such
    /// move; [`Reason::PlanRejected`].
    pub fn plan(&self, index: usize, asked: &MoveColumns) -> Result<Accepted, Rejected> {
        let told = self.outcome(index).unwrap_or_else(|| Err(broken("moves")))?;
        let request = Request::try_from(asked.request(index))?;
        let adjustments = self.adjustments(index)?;
        if let Ok(judged) = Judged::answer(&request)
            && self.is_told(index, &told, judged.plan(), &adjustments)
        {
            return Ok(judged.accepted()?);
        }
        Ok(Judged::new(self.rebuilt(index, &told, &request, adjustments)?).accepted()?)
    }

    /// Is `plan` to the last bit what is told of move number `index`?
    fn is_told(&self, index: usize, told: &PlannedMove<'_>, plan: &Plan, adjustments: &[Adjustment]) -> bool {
        let [axis] = plan.axes() else { return false };
        let pieces = axis.profile.segments();
        let same = |column: &[f64], value: &dyn Fn(&Segment) -> f64| {
            column.is_empty()
                || (column.len() == pieces.len()
                    && column
                        .iter()
                        .zip(pieces)
                        .all(|(told, piece)| told.to_bits() == value(&piece).to_bits()))
        };
        let jerk = |piece: &Segment| match piece.law {
            Law::ConstantJerk(jerk) | Law::CosineJerk { peak: jerk } => jerk,
            Law::Polynomial(_) => f64::NAN,
        };
        let laws = self.derivatives_of(index).is_none_or(|told| {
            let laws = pieces.iter().map(|piece| match piece.law {
                Law::ConstantJerk(jerk) | Law::CosineJerk { peak: jerk } => vec![jerk],
                Law::Polynomial(derivatives) => derivatives.as_slice().to_vec(),
            });
            told.map(<[f64]>::to_vec).eq(laws)
        });
        told.segment_duration.len() == pieces.len()
            && told.duration.to_bits() == plan.duration().to_bits()
            && told.cycle_count == plan.cycle_count()
            && same(told.segment_duration, &|piece| piece.duration)
            && same(told.position, &|piece| piece.start.position)
            && same(told.velocity, &|piece| piece.start.velocity)
            && same(told.acceleration, &|piece| piece.start.acceleration)
            && same(told.jerk, &jerk)
            && laws
            && *adjustments == *axis.adjustments
    }

    /// The derivatives of each segment of move number `index`, where they are told.
    fn derivatives_of(&self, index: usize) -> Option<impl Iterator<Item = &[f64]>> {
        let range = self.range(index).filter(|_| !self.segments.derivative_count.is_empty())?;
        let ends = self.derivatives.get(range.start..=range.end)?;
        Some(ends.windows(2).map(|ends| {
            let range = ends[0] as usize..ends[1] as usize;
            self.segments.derivatives.get(range).unwrap_or_default()
        }))
    }

    fn range(&self, index: usize) -> Option<Range<usize>> {
        Some(*self.begins.get(index)? as usize..*self.begins.get(index.checked_add(1)?)? as usize)
    }

    /// The plan that is told of move number `index`.
    fn rebuilt(
        &self,
        index: usize,
        told: &PlannedMove<'_>,
        request: &Request,
        adjustments: Vec<Adjustment>,
    ) -> Result<Plan, Rejected> {
        let [axis] = request.axes() else { return Err(broken("axes")) };
        let needed = Told::of(request.family(), Detail::Full);
        let complete =
            |column: &[f64], told_too: bool| !told_too || column.len() == told.segment_duration.len();
        let is_told = complete(told.position, needed.position)
            && complete(told.velocity, needed.position)
            && complete(told.acceleration, needed.acceleration)
            && complete(told.jerk, needed.jerk)
            && (needed.jerk || self.derivatives_of(index).is_some() || told.segment_duration.is_empty());
        if !is_told {
            let text = format!(
                "move {index} is not what the planner here makes of it, and its states are not told: ask for detail FULL \
                 where versions differ (the server has {})",
                self.answer.planner_version
            );
            return Err(Rejected::new(Reason::MessageInvalid, text));
        }
        let mut derivatives = self.derivatives_of(index);
        let mut pieces = Vec::with_capacity(told.segment_duration.len());
        for (place, &duration) in told.segment_duration.iter().enumerate() {
            let at = |column: &[f64]| column.get(place).copied().unwrap_or_default();
            let start = State {
                position: at(told.position),
                velocity: at(told.velocity),
                acceleration: at(told.acceleration),
            };
            let law = match derivatives.as_mut().and_then(Iterator::next) {
                Some([jerk]) => Law::ConstantJerk(*jerk),
                Some(given) => Law::Polynomial(Derivatives::new(given).ok_or_else(|| broken("derivatives"))?),
                None if request.family() == Family::Trigonometric && at(told.jerk) != 0.0 => {
                    Law::CosineJerk { peak: at(told.jerk) }
                }
                None => Law::ConstantJerk(at(told.jerk)),
            };
            let numbers = [duration, start.position, start.velocity, start.acceleration, at(told.jerk)];
            if !(numbers.iter().all(|number| number.is_finite()) && duration > 0.0) {
                return Err(broken("segments"));
            }
            pieces.push(Segment { duration, start, law });
        }
        let method = Method {
            family: request.family(),
            order: request.order(),
            short_path: request.short_path(),
            synchronization: request.synchronization(),
            end_on_cycle: request.end_on_cycle(),
            pvt: None,
        };
        let fastest = pieces.iter().flat_map(|piece| {
            let speeds: Vec<f64> =
                piece.turning_points().into_iter().map(|t| piece.at(t).state.velocity.abs()).collect();
            speeds
        });
        let feed_rate = fastest.fold(0.0, f64::max);
        let mut axis = AxisPlan {
            axis: axis.axis.clone(),
            kind: axis.kind,
            limits: axis.problem.limits().clone(),
            profile: Profile::new([], axis.problem.goal()),
            goal: axis.problem.goal(),
            adjustments,
            classification: Classification::of_speed(feed_rate),
            pvt_regions: Vec::new(),
        };
        axis.profile = Profile::new(pieces, axis.goal_to_reach());
        let made = Plan::new(method, method.promises().to_vec(), request.cycle_time(), vec![axis])?;
        let pb::PlanColumns { planner_version, evaluation_version, .. } = &self.answer;
        let (planner_version, evaluation_version) = (planner_version.clone(), *evaluation_version);
        Ok(made.made_by(Maker { planner_version, evaluation_version })?)
    }
}

/// Where each of so many begins, and where the last ends; nothing where that cannot be counted.
fn sums(counts: &[u32]) -> Option<Vec<u32>> {
    let mut sums = Vec::with_capacity(counts.len() + 1);
    let mut sum = 0u32;
    sums.push(sum);
    for count in counts {
        sum = sum.checked_add(*count)?;
        sums.push(sum);
    }
    Some(sums)
}

#[cold]
fn reason(refusal: &[u8]) -> Rejected {
    Rejected::from_bytes(refusal).unwrap_or_else(|| {
        let text = "a move is refused for a reason that this version does not know: compare versions";
        Rejected::new(Reason::MessageInvalid, text)
    })
}

#[cold]
fn broken(what: &str) -> Rejected {
    let text = format!("columns that belong together do not match: {what}; compare versions");
    Rejected::new(Reason::MessageInvalid, text)
}
