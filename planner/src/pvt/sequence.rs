//! Point after point, of several axes over one list of times.

use alloc::vec::Vec;
use core::ops::Range;

use arrayvec::ArrayVec;

use super::lane::MAX_LANES;
use super::planner::{Axis, PvtMove, PvtTarget, Refusal};
use super::request::field;
use super::{PvtAxis, PvtInterpolation, PvtPolicy, PvtRegion, PvtRequest, polynomial};
use crate::classify::Classification;
use crate::error::{Field, InvalidField, InvalidFields};
use crate::float::{largest, least};
use crate::segments::Pieces;
use crate::solve::Piece;
use crate::{
    Adjustment, AdjustmentReason, Alone, AxisPlan, AxisTransfer, Method, Plan, Profile, PvtMethod, Quantity,
    Segment, State, Synchronization, Timing, Together, Transit, Why, Workers, plan_between, together,
};

/// The pieces of a command with two ramps, neither of which reaches the acceleration limit: what most have.
const USUAL_PIECES: usize = 5;

/// What became of one point of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PvtPointReport {
    /// Index of the axis in the plan.
    pub axis: usize,
    /// Index of the point.
    pub point: usize,
    /// Where the displacement lies between the extremes; `None` for a polynomial.
    pub region: Option<PvtRegion>,
    /// Where the axis is then [axis units].
    pub position: f64,
    /// How fast it is then [axis units/s].
    pub velocity: f64,
    /// When that is \[s\] from the start.
    pub time: f64,
    /// The least and the greatest displacement from the point before [axis units] that the limits allow, with the velocity
    /// and in the time as planned; where a polynomial has a velocity for which there is no time, with the nearest for which there is.
    /// `None` where whoever answered did not say.
    pub reachable: Option<(f64, f64)>,
    /// What is not as asked: position, velocity, time.
    pub adjustments: ArrayVec<Adjustment, 3>,
}

/// A motion through points, with a report on each of them.
#[derive(Clone, Debug, PartialEq)]
pub struct PvtPlan {
    plan: Plan,
    points: Vec<PvtPointReport>,
}

impl PvtPlan {
    /// The motion.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// One report for each axis and point, axis by axis.
    #[must_use]
    pub fn points(&self) -> &[PvtPointReport] {
        &self.points
    }

    /// The motion and the reports.
    #[must_use]
    pub fn into_parts(self) -> (Plan, Vec<PvtPointReport>) {
        (self.plan, self.points)
    }
}

/// Plans the motion through the points of a request.
///
/// Between two points the velocity goes from the one's to the other's in the time that there is. Two extreme motions bound the way
/// \[axis units\] that it can cover; a point between them is met by ramps of reduced acceleration, whose shape is its
/// [`PvtRegion`](crate::PvtRegion):
///
/// ```text
/// position │         ╱ as far as can be         R1  past the end velocity and back to it
///          │      ╱   R1                        R2  a ramp, then a cruise at the end velocity
///          │   ╱─ ─ ─ R2, R3                    R3  a cruise at the start velocity, then a ramp
///          │ ╱─── ─ ─ R4                        R4  away from the end velocity first
///          └──────────── as little as can be
/// ```
///
/// Source: doi:10.1177/17298814211072418 (Int. J. Adv. Robot. Syst., 2022); extremes, regions and ramps are derived in
/// `notes/0008-position-velocity-time.md`. Its simulation of two axes is `examples/05_pvt`.
///
/// Each point is a command of its own, from where the axis then is: positions are absolute, so what one command does not reach is
/// made up by the next. The times are absolute too and do not drift. Where [`PvtPolicy::ExtendTime`] gives one axis more
/// time for a point, all axes take that time, so that they stay together; the intervals after it keep their lengths, and all
/// later points are met later by as much.
///
/// # Errors
/// Of each axis the first point that cannot be met and that the policy does not adjust: [`Why::PvtTimeTooShort`], [`Why::PvtOutOfReach`],
/// [`Why::PvtLeavesRange`]. Where the last point is to be finished, those of [`plan_between`]; of several
/// axes that end at speed, those of [`together`](crate::together()).
pub fn plan_pvt(request: &PvtRequest) -> Result<PvtPlan, InvalidFields> {
    plan_pvt_by(request, &Alone)
}

/// As [`plan_pvt`], to the last bit, with `workers` who each plan some of the axes: all policies but
/// [`PvtPolicy::ExtendTime`] let them.
///
/// # Errors
/// Those of [`plan_pvt`].
pub fn plan_pvt_by(request: &PvtRequest, workers: &impl Workers) -> Result<PvtPlan, InvalidFields> {
    let mut invalid = InvalidFields::default();
    let (mut drives, points) = if request.policy() == PvtPolicy::ExtendTime {
        in_step(request)
    } else {
        let count = request.axes().len();
        let mut parts = workers.each_range(count, |axes| one_by_one(request, axes)).into_iter();
        let (mut drives, mut points) = parts.next().unwrap_or_default();
        for (more_drives, more_points) in parts {
            drives.extend(more_drives);
            points.extend(more_points);
        }
        (drives, points)
    };
    for (index, drive) in drives.iter_mut().enumerate() {
        if let Some((point, (quantity, why))) = drive.refusal.take() {
            let outer = Field::element("axes", index);
            invalid.note(field(quantity, point).within(&outer).as_str(), Some(why));
        }
    }
    if invalid.is_empty() && request.finish_unreached() {
        finish_unreached(&mut invalid, &mut drives);
    }
    if !invalid.is_empty() {
        return Err(invalid);
    }
    joined(request, drives, points)
}

/// Axes on their way, and the reports on their points.
type Driven<'a> = (Vec<Drive<'a>>, Vec<PvtPointReport>);

/// Each of some axes through all of its points, since none changes the times of another.
fn one_by_one(request: &PvtRequest, axes: Range<usize>) -> Driven<'_> {
    // Whoever has the first axis gets the reports on the others, too.
    let room = if axes.start == 0 { request.axes().len() } else { axes.len() };
    let mut reports = Vec::with_capacity(room * request.times().len());
    let mut drives = Vec::with_capacity(room);
    let mut planned = PvtMove::unplanned();
    for (axis, spec) in request.axes().iter().enumerate().take(axes.end).skip(axes.start) {
        let mut drive = Drive::new(spec, request);
        for beat in Beat::all(request) {
            match drive.go(&mut planned, axis, request, &beat) {
                Some(report) => reports.push(report),
                None => break,
            }
        }
        drives.push(drive);
    }
    (drives, reports)
}

/// All axes from point to point, each of which may be met later than asked.
fn in_step(request: &PvtRequest) -> Driven<'_> {
    let mut drives: Vec<_> = request.axes().iter().map(|axis| Drive::new(axis, request)).collect();
    let mut reports: Vec<Vec<PvtPointReport>> =
        drives.iter().map(|_| Vec::with_capacity(request.times().len())).collect();
    let mut planned = PvtMove::unplanned();
    // How much later the points are met.
    let mut shift = 0.0;
    for mut beat in Beat::all(request) {
        beat.extend(&mut drives);
        shift += beat.duration - beat.interval;
        beat.time = beat.asked + shift;
        for (axis, drive) in drives.iter_mut().enumerate().filter(|(_, drive)| drive.refusal.is_none()) {
            reports[axis].extend(drive.go(&mut planned, axis, request, &beat));
        }
    }
    (drives, reports.into_iter().flatten().collect())
}

/// Puts the axes onto one time base.
fn joined(
    request: &PvtRequest,
    drives: Vec<Drive<'_>>,
    points: Vec<PvtPointReport>,
) -> Result<PvtPlan, InvalidFields> {
    let pvt = PvtMethod { interpolation: request.interpolation(), policy: request.policy() };
    let method = Method::through_points(pvt);
    let guaranteed = method.promises().to_vec();
    let axes = drives.into_iter().map(|drive| drive.into_plan(request)).collect();
    Ok(PvtPlan { plan: Plan::new(method, guaranteed, request.cycle_time(), axes)?, points })
}

/// One interval, the same for all axes.
struct Beat {
    point: usize,
    /// When its point is to be met \[s\], as asked and as planned.
    asked: f64,
    time: f64,
    /// How long it takes \[s\], as planned and as asked.
    duration: f64,
    interval: f64,
}

impl Beat {
    /// Of a time \[1\]: what a difference of two times may be off, since each is rounded …
    const TIME_ROUNDING: f64 = 2.0 * f64::EPSILON;
    /// … and of the interval \[1\]: as much as the judge lets pass of a limit, ten times over.
    const MOST_TIME_ROUNDING: f64 = 1e-10;

    /// The intervals of a request, as asked.
    fn all(request: &PvtRequest) -> impl Iterator<Item = Self> {
        let mut before = 0.0;
        request.times().iter().enumerate().map(move |(point, &time)| {
            let interval = time - before;
            before = time;
            Self { point, asked: time, time, duration: interval, interval }
        })
    }

    fn time_rounding(&self) -> f64 {
        least(Self::TIME_ROUNDING * self.time, Self::MOST_TIME_ROUNDING * self.interval)
    }

    /// Takes the first duration in which every axis meets its point.
    ///
    /// Each axis moves it on to the first one that suits itself, until all agree. In each lane what suits an axis are at most three
    /// windows of time: the displacement may get out of reach beyond either extreme, once each. So no axis moves it more often
    /// than it has windows, and the rounds end.
    fn extend(&mut self, drives: &mut [Drive<'_>]) {
        for drive in &mut *drives {
            drive.needs_time = false;
        }
        for _ in 0..=3 * MAX_LANES * drives.len() {
            let mut agreed = true;
            for drive in drives.iter_mut().filter(|drive| drive.refusal.is_none()) {
                let target = drive.target(self);
                match drive.axis.extended(drive.state, &target, self.time_rounding()) {
                    Ok(duration) if duration > self.duration => {
                        self.duration = duration;
                        drive.needs_time = true;
                        agreed = false;
                    }
                    Ok(_) => {}
                    Err(refusal) => drive.refusal = Some((self.point, refusal)),
                }
            }
            if agreed {
                return;
            }
        }
    }
}

/// One axis on its way from point to point.
struct Drive<'a> {
    spec: &'a PvtAxis,
    axis: Axis,
    state: State,
    pieces: Pieces,
    /// The end of the last of them \[s\], summed up as [`Profile`] does.
    clock: f64,
    fastest: f64,
    /// Where each command lay; none of a polynomial.
    regions: Vec<PvtRegion>,
    /// What is not as asked of the point that it came to last.
    adjustments: ArrayVec<Adjustment, 3>,
    /// Is it this axis that needs more time for the point?
    needs_time: bool,
    refusal: Option<(usize, Refusal)>,
    /// Where it went after the last point.
    finished: bool,
}

impl<'a> Drive<'a> {
    fn new(spec: &'a PvtAxis, request: &PvtRequest) -> Self {
        let points = spec.points.len();
        let pieces = if request.interpolation() == PvtInterpolation::SShaped { USUAL_PIECES } else { 1 };
        Self {
            spec,
            axis: Axis::new(spec.limits.clone()),
            state: spec.start,
            pieces: Pieces::with_capacity(pieces * points, 0),
            clock: 0.0,
            fastest: spec.start.velocity.abs(),
            regions: Vec::with_capacity(points),
            adjustments: ArrayVec::new(),
            needs_time: false,
            refusal: None,
            finished: false,
        }
    }

    fn target(&self, beat: &Beat) -> PvtTarget {
        let State { position, velocity, .. } = self.spec.points[beat.point];
        PvtTarget { position, velocity, duration: beat.duration }
    }

    /// Goes on to the next point; `None` where it is refused.
    fn go(
        &mut self,
        planned: &mut PvtMove,
        axis: usize,
        request: &PvtRequest,
        beat: &Beat,
    ) -> Option<PvtPointReport> {
        let target = self.target(beat);
        let mut report = PvtPointReport {
            axis,
            point: beat.point,
            region: None,
            position: target.position,
            velocity: target.velocity,
            time: beat.time,
            reachable: None,
            adjustments: ArrayVec::new(),
        };
        if let Some(piece) = polynomial::piece(request.interpolation(), self.state, &target) {
            report.reachable = self.axis.reachable(self.state, &target, beat.time_rounding());
            self.state = self.spec.points[beat.point];
            let speed = |t: &f64| piece.at(*t).state.velocity.abs();
            self.fastest = piece.turning_points().iter().map(speed).fold(self.fastest, largest);
            self.lay_whole(piece, beat.time);
        } else {
            // Whatever needed more time has it.
            let policy = match request.policy() {
                PvtPolicy::ExtendTime => PvtPolicy::Reject,
                policy => policy,
            };
            let rounding = beat.time_rounding();
            match self.axis.plan(planned, self.state, &target, policy, rounding) {
                Ok(()) => self.follow(planned, &mut report, beat.time),
                Err((quantity, mut why)) => {
                    if let Why::PvtLeavesRange { time, .. } = &mut why {
                        *time += beat.time - beat.duration;
                    }
                    self.refusal = Some((beat.point, (quantity, why)));
                    return None;
                }
            }
        }
        if beat.time > beat.asked {
            let reason = if self.needs_time {
                AdjustmentReason::PvtTimeExtended
            } else {
                AdjustmentReason::PvtTimeShifted
            };
            let (quantity, asked, planned) = (Quantity::Time, beat.asked, beat.time);
            report.adjustments.push(Adjustment { quantity, asked, planned, reason });
        }
        self.regions.extend(report.region);
        self.adjustments.clone_from(&report.adjustments);
        Some(report)
    }

    fn follow(&mut self, planned: &PvtMove, report: &mut PvtPointReport, end: f64) {
        let motion = planned.motion();
        self.state = motion.reached();
        self.fastest = largest(self.fastest, motion.classification().feed_rate);
        report.region = Some(planned.region());
        report.position = self.state.position;
        report.velocity = self.state.velocity;
        report.reachable = Some((planned.least_displacement(), planned.greatest_displacement()));
        report.adjustments.extend(motion.adjustments().iter().copied());
        self.lay(motion.laid(), end);
    }

    /// Lays pieces that end at the time `end` \[s\].
    ///
    /// The longest of them takes what their sum lacks of that, roundings of the time: so the sum of ten thousand durations is the
    /// time that was asked for, to an ulp or two, and all axes agree on it.
    fn lay(&mut self, pieces: &[Piece], end: f64) {
        let missing = self.missing(pieces.iter().map(|piece| piece.duration), end);
        let longest = (0..pieces.len()).fold(0, |longest, index| {
            if pieces[index].duration > pieces[longest].duration { index } else { longest }
        });
        for (index, &Piece { duration, start, jerk }) in pieces.iter().enumerate() {
            let duration = if index == longest { duration + missing } else { duration };
            self.clock += duration;
            self.pieces.push_jerk(duration, start, jerk);
        }
    }

    /// As [`lay`](Self::lay), a piece that is all there is.
    fn lay_whole(&mut self, piece: Segment, end: f64) {
        let duration = piece.duration + self.missing([piece.duration], end);
        self.clock += duration;
        self.pieces.push(&Segment { duration, ..piece });
    }

    /// What the sum of all durations with these lacks of `end` \[s\].
    fn missing(&self, durations: impl IntoIterator<Item = f64>, end: f64) -> f64 {
        end - durations.into_iter().fold(self.clock, |sum, duration| sum + duration)
    }

    /// Goes where the last command should have led, to be there at the time `end` \[s\].
    fn finish(&mut self, motion: &Transit, end: f64) {
        let segments = motion.segments();
        let speed = |segment: &Segment, t: &f64| segment.at(*t).state.velocity.abs();
        for segment in &segments {
            let times = segment.turning_points();
            self.fastest = times.iter().map(|t| speed(segment, t)).fold(self.fastest, largest);
        }
        self.state = motion.end();
        // What was missed by a rounding takes no time.
        self.finished = !segments.is_empty();
        self.lay(motion.pieces(), end);
    }

    /// Says why it cannot go there, of its last position.
    fn note_unfinished(&self, invalid: &mut InvalidFields, index: usize, refused: &InvalidFields) {
        let last = self.spec.points.len() - 1;
        let field = field(Quantity::Position, last).within(&Field::element("axes", index));
        for refused in refused.as_slice() {
            let mut why = refused.why.clone();
            if let Why::PositionLimit { time, .. } = &mut why {
                *time += self.clock;
            }
            invalid.note(field.as_str(), Some(why));
        }
    }

    /// Did the last command not get where it should?
    fn misses(&self) -> bool {
        let missed =
            |adjustment: &Adjustment| matches!(adjustment.quantity, Quantity::Position | Quantity::Velocity);
        self.adjustments.iter().any(missed)
    }

    fn goal(&self) -> State {
        self.spec.points.last().copied().unwrap_or(self.spec.start)
    }

    /// The motion, with what became of the last point.
    fn into_plan(self, request: &PvtRequest) -> AxisPlan {
        let goal = self.goal();
        let Self { spec, state, pieces, fastest, finished, regions, adjustments: last, clock, .. } = self;
        let mut adjustments = Vec::new();
        if let (true, Some(&asked)) = (finished, request.times().last()) {
            let (quantity, reason) = (Quantity::Time, AdjustmentReason::PvtFinishedLate);
            adjustments.push(Adjustment { quantity, asked, planned: clock, reason });
        } else {
            adjustments.extend(last);
        }
        adjustments.extend(crate::solve::feed_rate_above_limit(&spec.limits, 1.0));
        AxisPlan {
            axis: spec.axis.clone(),
            kind: spec.kind,
            limits: spec.limits.clone(),
            profile: Profile::of_pieces(pieces, state),
            goal,
            adjustments,
            classification: Classification::of_speed(fastest),
            pvt_regions: regions,
        }
    }
}

/// Takes each axis that has missed its last point there, without regard to time.
///
/// Where every axis ends at rest each goes by itself, and who is there waits. At speed nobody can wait: all axes that move go on
/// to their last states together, those that had met theirs as well.
fn finish_unreached(invalid: &mut InvalidFields, drives: &mut [Drive<'_>]) {
    if !drives.iter().any(Drive::misses) {
        return;
    }
    if drives.len() > 1 && drives.iter().any(|drive| drive.goal().velocity != 0.0) {
        finish_together(invalid, drives);
        return;
    }
    for (index, drive) in drives.iter_mut().enumerate().filter(|(_, drive)| drive.misses()) {
        // Beside the motion of several axes together the one place that asks another solver.
        match plan_between(drive.state, drive.goal(), &drive.spec.limits) {
            Ok(motion) => drive.finish(&motion, drive.clock + motion.duration()),
            Err(refused) => drive.note_unfinished(invalid, index, &refused),
        }
    }
}

/// Takes all axes that are not at rest where they should be to their last states at one time.
fn finish_together(invalid: &mut InvalidFields, drives: &mut [Drive<'_>]) {
    let mut moving: Vec<(usize, AxisTransfer<'_>)> = Vec::with_capacity(drives.len());
    for (index, drive) in drives.iter().enumerate() {
        if !drive.misses() && drive.goal().velocity == 0.0 {
            continue;
        }
        let question = AxisTransfer::within_limits(drive.state, drive.goal(), &drive.spec.limits);
        // Asked by itself first, so that what is wrong is said of each axis.
        match question.and_then(|question| question.quickest().map(|_| question)) {
            Ok(question) => moving.push((index, question)),
            Err(refused) => drive.note_unfinished(invalid, index, &refused),
        }
    }
    if !invalid.is_empty() {
        return;
    }
    let questions: Vec<AxisTransfer<'_>> = moving.iter().map(|(_, question)| *question).collect();
    let mut transits = Vec::with_capacity(questions.len());
    let planned = together(&questions, Synchronization::Time, Timing::default(), &mut transits);
    let begin = drives.iter().map(|drive| drive.clock).fold(0.0, largest);
    match planned {
        Ok(Together { duration, .. }) => {
            for ((index, _), transit) in moving.iter().zip(&transits) {
                drives[*index].finish(transit, begin + duration);
            }
        }
        Err(refused) => {
            for InvalidField { field, why } in refused.as_slice() {
                let of =
                    |number: &usize| field.as_str().starts_with(Field::element("axes", *number).as_str());
                let number = (0..moving.len()).find(of).unwrap_or_default();
                let index = moving[number].0;
                let refused = InvalidFields::one(Field::default(), why.clone());
                drives[index].note_unfinished(invalid, index, &refused);
            }
        }
    }
}
