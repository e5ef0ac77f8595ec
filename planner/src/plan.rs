use alloc::string::String;
use alloc::vec::Vec;

use crate::error::{Field, InvalidFields, Why};
use crate::request::{AxisKind, Family, Synchronization};
use crate::solve::{Adjustment, AdjustmentReason, plan_stop};
use crate::{
    Classification, Cursor, CycleTime, Limits, Profile, PvtInterpolation, PvtMethod, PvtRegion, Quantity,
    Setpoint, ShortPathPolicy, State,
};

/// How a plan was made, so that an operation on it can be planned the same way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Method {
    /// The family of shapes.
    pub family: Family,
    /// The order of the profile: its highest bounded derivative.
    pub order: u32,
    /// What was to be given up on a path too short.
    pub short_path: ShortPathPolicy,
    /// How the axes go together.
    pub synchronization: Synchronization,
    /// Stretched to a whole number of cycles?
    pub end_on_cycle: bool,
    /// Through points of position, velocity and time? Then `family` and `order` say what the pieces are made of.
    pub pvt: Option<PvtMethod>,
}

impl Method {
    /// How a plan through points is made: the family and the order are those of the pieces that join them.
    #[must_use]
    pub fn through_points(pvt: PvtMethod) -> Self {
        let (family, order) = match pvt.interpolation {
            PvtInterpolation::SShaped => (Family::SCurve, 3),
            PvtInterpolation::Cubic => (Family::Polynomial, 3),
            PvtInterpolation::Quintic => (Family::Polynomial, 5),
        };
        Self { family, order, pvt: Some(pvt), ..Self::default() }
    }

    /// The derivatives that a plan made so keeps within limits: all up to its order, but for points joined by cubics and
    /// quintics, which keep none.
    #[must_use]
    pub fn promises(self) -> &'static [Quantity] {
        if self.pvt.is_some_and(|pvt| pvt.interpolation != PvtInterpolation::SShaped) {
            return &[];
        }
        Quantity::BY_ORDER.get(1..=self.order as usize).unwrap_or_default()
    }
}

/// Who made a plan, and whose arithmetic its setpoints are.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Maker {
    /// The planner's version; informs.
    pub planner_version: String,
    /// Names the bits that the plan samples to; one of [`EVALUATION_VERSIONS`](crate::EVALUATION_VERSIONS).
    pub evaluation_version: u32,
}

impl Default for Maker {
    /// This planner.
    fn default() -> Self {
        Self {
            planner_version: env!("CARGO_PKG_VERSION").into(),
            evaluation_version: crate::EVALUATION_VERSION,
        }
    }
}

/// One axis's motion, with what was asked and what was planned.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisPlan {
    /// The axis's name.
    pub axis: String,
    /// What it moves in.
    pub kind: AxisKind,
    /// What it may do on the way.
    pub limits: Limits,
    /// The motion; it ends in the state that is reached.
    pub profile: Profile,
    /// The end that was asked for.
    pub goal: State,
    /// What is not as asked; empty where everything is.
    pub adjustments: Vec<Adjustment>,
    /// The shape's names in the papers.
    pub classification: Classification,
    /// Of a plan through points, the region of each in turn; empty where polynomials join them, and for a move.
    pub pvt_regions: Vec<PvtRegion>,
}

/// The motion of one or more axes over one time base. Whether it is any good is for [`certify`](crate::certify) to say.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    maker: Maker,
    method: Method,
    guaranteed: Vec<Quantity>,
    cycle_time: CycleTime,
    cycle_count: u64,
    duration: f64,
    axes: Vec<AxisPlan>,
}

impl Plan {
    /// Puts axes onto one time base. `guaranteed` names the derivatives that are kept within limits.
    ///
    /// # Errors
    /// No axis, more than [`MAX_AXES`](crate::MAX_AXES), a name that is there twice, more cycles than can be counted.
    pub fn new(
        method: Method,
        guaranteed: Vec<Quantity>,
        cycle_time: CycleTime,
        axes: Vec<AxisPlan>,
    ) -> Result<Self, InvalidFields> {
        let mut invalid = InvalidFields::default();
        if axes.is_empty() {
            invalid.note("axes", Some(Why::NoAxes));
        }
        if axes.len() > crate::MAX_AXES {
            invalid.note("axes", Some(Why::TooManyAxes { given: axes.len(), allowed: crate::MAX_AXES }));
            return Err(invalid);
        }
        crate::request::note_names(&mut invalid, axes.iter().map(|axis| axis.axis.as_str()));
        let duration = axes.iter().map(|axis| axis.profile.duration()).fold(0.0, f64::max);
        let cycle_count = cycle_time.count(duration);
        if cycle_count.is_none() {
            invalid.note("axes", Some(Why::TooManyCycles { seconds: duration }));
        }
        let cycle_count = cycle_count.unwrap_or_default();
        let maker = Maker::default();
        invalid.into_result(Self { maker, method, guaranteed, cycle_time, cycle_count, duration, axes })
    }

    /// The same plan, made by another planner.
    ///
    /// # Errors
    /// [`Why::EvaluationVersion`] for a version whose setpoints this planner cannot give.
    pub fn made_by(self, maker: Maker) -> Result<Self, InvalidFields> {
        let given = maker.evaluation_version;
        if crate::EVALUATION_VERSIONS.contains(&given) {
            return Ok(Self { maker, ..self });
        }
        let why = Why::EvaluationVersion { given };
        Err(InvalidFields::one(Field::named("evaluation_version"), why))
    }

    /// Who made the plan.
    #[must_use]
    pub fn maker(&self) -> &Maker {
        &self.maker
    }

    /// How the plan was made.
    #[must_use]
    pub fn method(&self) -> Method {
        self.method
    }

    /// The derivatives that are kept within limits.
    #[must_use]
    pub fn guaranteed(&self) -> &[Quantity] {
        &self.guaranteed
    }

    /// Is `quantity` kept within limits?
    #[must_use]
    pub fn guarantees(&self, quantity: Quantity) -> bool {
        self.guaranteed.contains(&quantity)
    }

    /// The time between two setpoints.
    #[must_use]
    pub fn cycle_time(&self) -> CycleTime {
        self.cycle_time
    }

    /// Cycles 0 ..= this one: the last is the end state.
    #[must_use]
    pub fn cycle_count(&self) -> u64 {
        self.cycle_count
    }

    /// How long the slowest axis moves \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The axes, in the order of the request.
    #[must_use]
    pub fn axes(&self) -> &[AxisPlan] {
        &self.axes
    }

    /// Does every axis rest at the end?
    #[must_use]
    pub fn ends_at_rest(&self) -> bool {
        self.axes.iter().all(|axis| axis.profile.end().is_at_rest())
    }

    /// When `cycle` is due \[s\]. The last cycle of the plan is its end, though it may be due a rounding before that.
    #[must_use]
    pub fn time_of(&self, cycle: u64) -> f64 {
        self.cycle_time.time_of(cycle, self.cycle_count)
    }

    /// Reads setpoints cycle by cycle.
    #[must_use]
    pub fn sampler(&self) -> Sampler<'_> {
        let cursors = self.axes.iter().map(|axis| Cursor::new(&axis.profile)).collect();
        Sampler { cycle_time: self.cycle_time, cycle_count: self.cycle_count, cursors }
    }

    /// The same motion with a jerk-limited stop after it, for a plan that ends at speed; and the first cycle of that
    /// stop. `None` where the plan ends at rest.
    ///
    /// # Errors
    /// [`Why::PositionLimit`] where the stop leaves the position range.
    pub fn with_closing_stop(&self) -> Result<Option<(Self, u64)>, InvalidFields> {
        if self.ends_at_rest() {
            return Ok(None);
        }
        let mut invalid = InvalidFields::default();
        let mut axes = Vec::with_capacity(self.axes.len());
        for (index, axis) in self.axes.iter().enumerate() {
            axes.extend(invalid.take(&Field::element("axes", index), axis.with_closing_stop()));
        }
        if !invalid.is_empty() {
            return Err(invalid);
        }
        let stopped = Self::new(self.method, self.guaranteed.clone(), self.cycle_time, axes)?;
        let stopped = Self { maker: self.maker.clone(), ..stopped };
        Ok(Some((stopped, self.cycle_count)))
    }
}

impl AxisPlan {
    fn with_closing_stop(&self) -> Result<Self, InvalidFields> {
        let end = self.profile.end();
        if end.is_at_rest() {
            return Ok(self.clone());
        }
        Ok(self.stopped_by(&plan_stop(end, &self.limits)?.to_profile()))
    }

    /// With a closing stop after it.
    pub(crate) fn stopped_by(&self, stop: &Profile) -> Self {
        let (end, rest) = (self.profile.end(), stop.end());
        let mut adjustments = self.adjustments.clone();
        adjustments.extend(adjusted(self.goal, end, rest, AdjustmentReason::ClosingStop));
        Self { profile: self.profile.followed_by(stop), adjustments, ..self.clone() }
    }
}

/// What is said where `goal` was asked for and the end that was planned `before` becomes `planned`.
#[expect(clippy::float_cmp, reason = "what is as it was is left alone")]
pub(crate) fn adjusted(
    goal: State,
    before: State,
    planned: State,
    reason: AdjustmentReason,
) -> impl Iterator<Item = Adjustment> {
    [
        (Quantity::Position, goal.position, before.position, planned.position),
        (Quantity::Velocity, goal.velocity, before.velocity, planned.velocity),
        (Quantity::Acceleration, goal.acceleration, before.acceleration, planned.acceleration),
    ]
    .into_iter()
    .filter(|(_, _, before, planned)| before != planned)
    .map(move |(quantity, asked, _, planned)| Adjustment { quantity, asked, planned, reason })
}

/// Setpoints that are computed at once.
const RUN: usize = 8;

/// Reads the setpoints of a [`Plan`]. The answer depends on the cycle alone, never on what was read before.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    cycle_time: CycleTime,
    cycle_count: u64,
    cursors: Vec<Cursor<'a>>,
}

impl Sampler<'_> {
    /// The setpoints of all axes at `cycle`, in plan order.
    pub fn at(&mut self, cycle: u64) -> impl Iterator<Item = Setpoint> {
        let time = self.time_of(cycle);
        self.cursors.iter_mut().map(move |cursor| cursor.at(time))
    }

    /// The setpoints of axis number `axis` at `cycles`, appended column by column.
    pub fn columns(&mut self, axis: usize, cycles: core::ops::Range<u64>, mut put: impl FnMut(Setpoint)) {
        let mut cycle = cycles.start;
        while cycle < cycles.end {
            if cycles.end.min(self.cycle_count).saturating_sub(cycle) >= RUN as u64
                && let Some(run) = self.run(axis, cycle)
            {
                run.into_iter().for_each(&mut put);
                cycle += RUN as u64;
            } else {
                let time = self.time_of(cycle);
                put(self.cursors[axis].at(time));
                cycle += 1;
            }
        }
    }

    /// Cycles in a row, if they lie in one piece of constant jerk: with the bits of each by itself, but without a branch between
    /// them, so that some are computed at once.
    #[inline]
    fn run(&mut self, axis: usize, first: u64) -> Option<[Setpoint; RUN]> {
        let ends = [first, first + RUN as u64 - 1].map(|cycle| self.cycle_time.start_of(cycle));
        let (begin, start, jerk) = self.cursors[axis].constant_jerk(ends[0], ends[1])?;
        let (mut times, first) = ([0.0; RUN], first as f64);
        for (index, time) in times.iter_mut().enumerate() {
            // Whole numbers of cycles are exact.
            *time = self.cycle_time.after(first + index as f64) - begin;
        }
        Some(times.map(|time| Setpoint { state: start.after(jerk, time), jerk }))
    }

    fn time_of(&self, cycle: u64) -> f64 {
        self.cycle_time.time_of(cycle, self.cycle_count)
    }
}
