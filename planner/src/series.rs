use alloc::vec::Vec;

use crate::certified::Rejection;
use crate::error::{Field, InvalidFields, Why};
use crate::request::{AxisProblem, Family, Request, RequestSpec, Shape};
use crate::solve::{Adjustment, Move, has_to_turn_back, plan_move, plan_trapezoid};
use crate::verify::{Promise, goal_as_adjusted, is_plain, violations_of};
use crate::{
    CycleTime, Judged, Limits, LimitsSpec, Method, Passage, Profile, ShortPathPolicy, State,
    plan_trigonometric,
};

/// Many moves of one axis that have all but their ends and limits in common, each planned and judged as [`Judged::answer`] does it, to the last bit,
/// for a fraction of what that costs.
///
/// What all have in common is checked once. From then on a move is numbers: its pieces are laid into the room of the move before it, and what the
/// judge can pass at a glance gets no certificate. Nothing is taken from the heap but for a refusal, a polynomial, a move that is to end on a cycle
/// or to last a least duration which it does not, and where the judge has to look closely (a start beyond the limits, a standstill).
///
/// ```
/// use planner::{AxisKind, AxisMoveSpec, Family, LimitsSpec, MoveSeries, RequestSpec, ShortPathPolicy, State, Synchronization};
///
/// let limits = LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..LimitsSpec::default() };
/// let (start, goal) = (State::at_rest(0.0), State::at_rest(0.0));
/// let axis = AxisMoveSpec { axis: "x".into(), kind: Ok(AxisKind::Prismatic), start, goal, limits };
/// let mut series = MoveSeries::like(RequestSpec {
///     axes: vec![axis],
///     cycle_time_ns: None,
///     family: Ok(Family::SCurve),
///     order: None,
///     short_path: Ok(ShortPathPolicy::Reject),
///     synchronization: Ok(Synchronization::Time),
///     minimum_duration: None,
///     end_on_cycle: false,
/// })?;
/// let durations: Result<Vec<f64>, _> = [0.05, 0.1]
///     .into_iter()
///     .map(|to| Ok(series.answer(start, State::at_rest(to))?.profile().duration()))
///     .collect::<Result<_, planner::SeriesError>>();
/// assert_eq!(durations?.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct MoveSeries {
    /// Of one axis, with the limits that hold now.
    like: RequestSpec,
    shape: Shape,
    method: Method,
    short_path: ShortPathPolicy,
    cycle_time: CycleTime,
    minimum_duration: f64,
    /// None where they are not valid.
    limits: Option<Limits>,
    profile: Profile,
    adjustments: Vec<Adjustment>,
}

/// A move of a series, planned, and passed by the judge.
#[derive(Clone, Copy, Debug)]
pub struct SeriesMove<'a> {
    profile: &'a Profile,
    adjustments: &'a [Adjustment],
    cycle_count: u64,
}

/// Why there is no such move.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SeriesError {
    /// Nobody can plan it: with the paths of a request of its own, `axes[0].goal.position`.
    #[error(transparent)]
    Invalid(#[from] InvalidFields),
    /// It is planned, and the judge has something against it.
    #[error(transparent)]
    Rejected(#[from] Rejection),
}

impl SeriesMove<'_> {
    /// The motion; it ends in the state that is reached.
    #[must_use]
    pub fn profile(&self) -> &Profile {
        self.profile
    }

    /// What is not as asked; empty where everything is.
    #[must_use]
    pub fn adjustments(&self) -> &[Adjustment] {
        self.adjustments
    }

    /// Cycles 0 ..= this one: the last is the end state.
    #[must_use]
    pub fn cycle_count(&self) -> u64 {
        self.cycle_count
    }
}

impl MoveSeries {
    /// Moves like `spec`, which has one axis; of this, start and goal do not count.
    ///
    /// # Errors
    /// Everything that would be wrong with each of the moves, whatever its start, its goal and its limits: no axis or several, a name, a choice, a cycle time, an
    /// order, a least duration. Paths are those of the request.
    pub fn like(spec: RequestSpec) -> Result<Self, InvalidFields> {
        if spec.axes.len() > 1 {
            let why = Why::NotOneAxis { given: spec.axes.len() };
            return Err(InvalidFields::one(Field::named("axes"), why));
        }
        let common = Request::try_from(harmless(spec.clone()))?;
        let method = Method {
            family: common.family(),
            order: common.order(),
            short_path: common.short_path(),
            synchronization: common.synchronization(),
            end_on_cycle: common.end_on_cycle(),
            pvt: None,
        };
        let cycle_time = common.cycle_time();
        let Method { family, end_on_cycle, .. } = method;
        let mut series = Self {
            shape: Shape { family, order: spec.order, end_on_cycle, cycle: cycle_time },
            method,
            short_path: common.short_path(),
            cycle_time,
            minimum_duration: common.minimum_duration(),
            limits: None,
            profile: Profile::new([], State::at_rest(0.0)),
            adjustments: Vec::new(),
            like: spec,
        };
        series.limit(|_| ());
        Ok(series)
    }

    /// The family of all moves.
    #[must_use]
    pub fn family(&self) -> Family {
        self.method.family
    }

    /// How each move is made.
    #[must_use]
    pub fn method(&self) -> Method {
        self.method
    }

    /// Changes the limits of the moves from now on. Limits that are not valid are refused move by move.
    pub fn limit(&mut self, change: impl FnOnce(&mut LimitsSpec)) {
        let Some(axis) = self.like.axes.first_mut() else { return };
        change(&mut axis.limits);
        self.limits = Limits::try_from(self.shape.with_jerk(axis.limits.clone())).ok();
    }

    /// The move from `start` to `goal`: the fastest of its kind, and judged.
    ///
    /// # Errors
    /// Those of [`Request::try_from`] and of [`plan`](crate::plan()), with the same paths and in the same order; what the judge has against the plan.
    pub fn answer(&mut self, start: State, goal: State) -> Result<SeriesMove<'_>, SeriesError> {
        let cycle_count = match self.at_a_glance(start, goal) {
            Some(cycle_count) => cycle_count,
            None => self.by_itself(start, goal)?,
        };
        let Self { profile, adjustments, .. } = self;
        Ok(SeriesMove { profile, adjustments, cycle_count })
    }

    /// Plans and judges a move without a word; nothing where there is something to say, or a longer way to go.
    fn at_a_glance(&mut self, start: State, goal: State) -> Option<u64> {
        let Method { family, end_on_cycle, .. } = self.method;
        if end_on_cycle || family == Family::Polynomial {
            return None;
        }
        let limits = self.limits.as_ref()?;
        let problem = AxisProblem::new(family, start, goal, limits.clone(), self.short_path).ok()?;
        match &problem {
            AxisProblem::Between(passage) => self.pass(passage)?,
            AxisProblem::Along(problem) => match family {
                Family::SCurve if has_to_turn_back(problem) => self.pass(&Passage::of(problem))?,
                Family::SCurve => self.lay(&plan_move(problem).ok()?),
                Family::Trapezoidal => self.lay(&plan_trapezoid(problem).ok()?),
                Family::Trigonometric => self.lay(&plan_trigonometric(problem).ok()?),
                Family::Polynomial => return None,
            },
        }
        let duration = self.profile.duration();
        let cycle_count = self.cycle_time.count(duration)?;
        let (goal, limits) = (goal_as_adjusted(problem.goal(), &self.adjustments), problem.limits());
        let is_long_enough = duration >= self.minimum_duration;
        let promise = Promise::alone(self.method, limits);
        let passes = is_plain(&self.profile, limits, goal, &promise)
            || violations_of("", &self.profile, limits, goal, &promise).is_empty();
        (is_long_enough && passes).then_some(cycle_count)
    }

    fn lay(&mut self, planned: &Move) {
        planned.lay_into(&mut self.profile);
        self.adjustments.clear();
        self.adjustments.extend_from_slice(planned.adjustments());
    }

    fn pass(&mut self, passage: &Passage) -> Option<()> {
        let (transit, adjustment) = passage.transit().ok()?;
        transit.lay_into(&mut self.profile);
        self.adjustments.clear();
        self.adjustments.extend(adjustment);
        Some(())
    }

    /// Plans and judges a move as a request of its own.
    #[cold]
    fn by_itself(&mut self, start: State, goal: State) -> Result<u64, SeriesError> {
        let accepted = Judged::answer(&self.request(start, goal)?)?.accepted()?;
        let plan = accepted.plan();
        if let [axis] = plan.axes() {
            self.profile.clone_from(&axis.profile);
            self.adjustments.clone_from(&axis.adjustments);
        }
        Ok(plan.cycle_count())
    }

    /// The request that asks for a move by itself.
    ///
    /// # Errors
    /// Those of [`Request::try_from`].
    pub fn request(&self, start: State, goal: State) -> Result<Request, InvalidFields> {
        let mut spec = self.like.clone();
        for axis in &mut spec.axes {
            (axis.start, axis.goal) = (start, goal);
        }
        spec.try_into()
    }
}

/// The same with a start, a goal and limits that nothing is wrong with.
fn harmless(mut spec: RequestSpec) -> RequestSpec {
    for axis in &mut spec.axes {
        (axis.start, axis.goal) = (State::at_rest(0.0), State::at_rest(0.0));
        axis.limits = LimitsSpec {
            max_velocity: 1.0,
            max_acceleration: 1.0,
            max_jerk: 1.0,
            max_snap: Some(1.0),
            max_higher_derivatives: alloc::vec![1.0; crate::MAX_ORDER - 4],
            ..LimitsSpec::default()
        };
    }
    spec
}
