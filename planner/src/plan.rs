use alloc::string::String;
use alloc::vec::Vec;

use crate::error::{Field, InvalidFields, Why};
use crate::profile::Span;
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
            axes.extend(invalid.take_element("axes", index, axis.with_closing_stop()));
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

/// Reads the setpoints of a [`Plan`]. The answer depends on the cycle alone, never on what was read before.
#[derive(Clone, Debug)]
pub struct Sampler<'a> {
    cycle_time: CycleTime,
    cycle_count: u64,
    cursors: Vec<Cursor<'a>>,
}

/// Of cycles that are computed at once: they are numbered by what the processor turns into two doubles at a time.
const LONGEST_RUN: u64 = i32::MAX as u64;

impl Sampler<'_> {
    /// The setpoints of all axes at `cycle`, in plan order.
    pub fn at(&mut self, cycle: u64) -> impl Iterator<Item = Setpoint> {
        let time = self.time_of(cycle);
        self.cursors.iter_mut().map(move |cursor| cursor.at(time))
    }

    /// Fills columns, position to jerk, with the setpoints of axis number `axis` at as many cycles, from `first` on; as many as the
    /// shortest has room for. From the last cycle on that is the end of the motion.
    ///
    /// # Panics
    /// Where the plan has no such axis.
    ///
    /// ```
    /// # use planner::{AxisKind, AxisPlan, CycleTime, Limits, Method, Plan, Problem, ShortPathPolicy, State, plan_move};
    /// # let limits = Limits::symmetric(0.25, 3.0, 100.0)?;
    /// # let goal = State::at_rest(0.05);
    /// # let problem = Problem::new(State::at_rest(0.0), goal, limits.clone(), ShortPathPolicy::Reject)?;
    /// # let planned = plan_move(&problem)?;
    /// # let axis = AxisPlan {
    /// #     axis: "x".into(), kind: AxisKind::Prismatic, limits, profile: planned.to_profile(), goal,
    /// #     adjustments: Vec::new(), classification: planned.classification(), pvt_regions: Vec::new(),
    /// # };
    /// # let plan = Plan::new(Method::default(), Vec::new(), CycleTime::MILLISECOND, vec![axis])?;
    /// let mut columns = [(); 4].map(|()| [0.0; 10]);
    /// let mut sampler = plan.sampler();
    /// sampler.fill(0, 100, columns.each_mut().map(|column| column.as_mut_slice()));
    /// let eighth = sampler.at(107).next().ok_or("an axis")?;
    /// assert_eq!(columns.map(|column| column[7]), eighth.words());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn fill(&mut self, axis: usize, first: u64, columns: [&mut [f64]; 4]) {
        let count = columns.iter().map(|column| column.len()).min().unwrap_or_default();
        let [position, velocity, acceleration, jerk] = columns.map(|column| &mut column[..count]);
        let mut done = 0;
        while done < count {
            // Far behind the end it stays at the end.
            let cycle = first.saturating_add(done as u64);
            let run = self.run(axis, cycle, (count - done) as u64);
            if let Some(run) = run {
                let filled = done..done + run.count;
                run.fill(
                    &mut position[filled.clone()],
                    &mut velocity[filled.clone()],
                    &mut acceleration[filled.clone()],
                );
                jerk[filled].fill(run.span.jerk);
                done += run.count;
            } else {
                let time = self.time_of(cycle);
                [position[done], velocity[done], acceleration[done], jerk[done]] =
                    self.cursors[axis].at(time).words();
                done += 1;
            }
        }
    }

    /// The cycles from `first` on, at most so many, that lie in the piece in which that one lies, if its jerk is constant.
    fn run(&mut self, axis: usize, first: u64, most: u64) -> Option<Run> {
        let time = self.time_of(first);
        let span = self.cursors[axis].constant_jerk(time)?;
        let most = most.min(self.cycle_count - first).min(LONGEST_RUN);
        let count = self.cycle_time.cycles_before(span.end, first, most) as usize;
        Some(Run { cycle_time: self.cycle_time, first: first as f64, count, span })
    }

    fn time_of(&self, cycle: u64) -> f64 {
        self.cycle_time.time_of(cycle, self.cycle_count)
    }
}

/// Cycles in a row that lie in one piece of constant jerk.
struct Run {
    cycle_time: CycleTime,
    /// A whole number.
    first: f64,
    count: usize,
    span: Span,
}

impl Run {
    /// With the bits of each cycle by itself, but without a branch between them, so that some are computed at once.
    fn fill(&self, position: &mut [f64], velocity: &mut [f64], acceleration: &mut [f64]) {
        let Self { cycle_time, first, span: Span { begin, start, jerk, .. }, .. } = *self;
        let columns = position.iter_mut().zip(velocity).zip(acceleration);
        for (index, ((position, velocity), acceleration)) in columns.enumerate() {
            // Whole numbers of cycles are exact.
            let time = cycle_time.after(first + f64::from(index as i32)) - begin;
            let state = start.after(jerk, time);
            (*position, *velocity, *acceleration) = (state.position, state.velocity, state.acceleration);
        }
    }
}
