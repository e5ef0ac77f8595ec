use alloc::string::String;
use alloc::vec::Vec;

use crate::error::{Field, InvalidFields, Why};
use crate::float::{largest, least};
use crate::limits::{GREATEST_MAGNITUDE, not_finite, not_positive};
use crate::problem::is_along_travel;
use crate::solve::note_speeds;
use crate::{CycleTime, Limits, LimitsSpec, Passage, Problem, ShortPathPolicy, State};

/// The most axes of one plan.
pub const MAX_AXES: usize = 64;
/// The longest name of an axis \[bytes\]: it stands many times in a plan.
pub const MAX_NAME_BYTES: usize = 256;

/// What an axis moves in: says the unit of its positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AxisKind {
    /// Metres.
    Prismatic,
    /// Radians.
    Revolute,
    /// Pulses of an encoder or a drive.
    Pulses,
}

/// The family of shapes that a profile is taken from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Family {
    /// Third order: constant jerk in pieces.
    #[default]
    SCurve,
    /// Second order: constant acceleration in pieces. The acceleration jumps, so no jerk is guaranteed, and the limit on
    /// it, which need not be stated, is that of its stops alone.
    Trapezoidal,
    /// Order n, rest to rest.
    Polynomial,
    /// Raised-cosine jerk, rest to rest.
    Trigonometric,
}

impl Family {
    /// The name on the wire.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SCurve => "S_CURVE",
            Self::Trapezoidal => "TRAPEZOIDAL",
            Self::Polynomial => "POLYNOMIAL",
            Self::Trigonometric => "TRIGONOMETRIC",
        }
    }

    /// The order of its profiles; `None` where it has several.
    #[must_use]
    pub fn order(self) -> Option<u32> {
        match self {
            Self::Trapezoidal => Some(2),
            Self::SCurve | Self::Trigonometric => Some(3),
            Self::Polynomial => None,
        }
    }

    /// Does it go from rest to rest only?
    #[must_use]
    pub fn needs_rest(self) -> bool {
        matches!(self, Self::Polynomial | Self::Trigonometric)
    }
}

/// How the axes of one plan go together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Synchronization {
    /// Each axis moves on its own time and then rests.
    None,
    /// All axes arrive together.
    #[default]
    Time,
    /// All axes keep to a straight line.
    Phase,
}

/// One axis's part of a request, not yet checked.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisMoveSpec {
    /// The axis's name, unique in the request.
    pub axis: String,
    /// What it moves in, or why that cannot be told.
    pub kind: Result<AxisKind, Why>,
    /// Where it begins.
    pub start: State,
    /// Where it is asked to end.
    pub goal: State,
    /// What it may do on the way.
    pub limits: LimitsSpec,
}

/// A request as somebody states it, not yet checked. A choice that could not be read is kept as its refusal, so that
/// [`Request::try_from`] can report everything at once.
#[derive(Clone, Debug, PartialEq)]
pub struct RequestSpec {
    /// The axes, in the order that the plan keeps.
    pub axes: Vec<AxisMoveSpec>,
    /// The time between two setpoints \[ns\]; `None`: 1 ms.
    pub cycle_time_ns: Option<i128>,
    /// The family of shapes.
    pub family: Result<Family, Why>,
    /// The order of a polynomial, which needs one; every other family has its own.
    pub order: Option<u32>,
    /// What to give up when a path is too short.
    pub short_path: Result<ShortPathPolicy, Why>,
    /// How the axes go together.
    pub synchronization: Result<Synchronization, Why>,
    /// The least duration of the plan \[s\], ≥ 0; `None` and 0 ask nothing.
    pub minimum_duration: Option<f64>,
    /// Stretch every axis's move to a whole number of cycles? From rest to rest.
    pub end_on_cycle: bool,
}

/// One axis's question, with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisMove {
    /// The axis's name.
    pub axis: String,
    /// What it moves in.
    pub kind: AxisKind,
    /// From where to where, within which limits.
    pub problem: AxisProblem,
}

/// What is asked of one axis.
#[derive(Clone, Debug, PartialEq)]
pub enum AxisProblem {
    /// A move along its travel: every family knows it, and the shape has a name in the papers.
    Along(Problem),
    /// From any state to any state, which the S-curve alone does: with accelerations at the ends, velocities against the travel, or
    /// from beyond the limits.
    Between(Passage),
}

impl AxisProblem {
    pub(crate) fn new(
        family: Family,
        start: State,
        goal: State,
        limits: Limits,
        policy: ShortPathPolicy,
    ) -> Result<Self, InvalidFields> {
        let finite = start.is_finite() && goal.is_finite();
        if finite && family == Family::SCurve && !is_along_travel(&start, &goal, &limits) {
            Passage::new(start, goal, limits).map(Self::Between)
        } else {
            Problem::new(start, goal, limits, policy).map(Self::Along)
        }
    }

    /// Where the motion begins.
    #[must_use]
    pub fn start(&self) -> State {
        match self {
            Self::Along(problem) => problem.start(),
            Self::Between(passage) => passage.start(),
        }
    }

    /// Where it is asked to end.
    #[must_use]
    pub fn goal(&self) -> State {
        match self {
            Self::Along(problem) => problem.goal(),
            Self::Between(passage) => passage.goal(),
        }
    }

    /// What the axis may do on the way.
    #[must_use]
    pub fn limits(&self) -> &Limits {
        match self {
            Self::Along(problem) => problem.limits(),
            Self::Between(passage) => passage.limits(),
        }
    }
}

/// A question about one or more axes that has been checked, and that this planner can answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    axes: Vec<AxisMove>,
    cycle_time: CycleTime,
    family: Family,
    order: u32,
    short_path: ShortPathPolicy,
    synchronization: Synchronization,
    minimum_duration: f64,
    end_on_cycle: bool,
}

impl Request {
    /// The axes, one or more, with names of their own.
    #[must_use]
    pub fn axes(&self) -> &[AxisMove] {
        &self.axes
    }

    /// The time between two setpoints.
    #[must_use]
    pub fn cycle_time(&self) -> CycleTime {
        self.cycle_time
    }

    /// The family of shapes.
    #[must_use]
    pub fn family(&self) -> Family {
        self.family
    }

    /// The order of the profiles: the family's own, or that of the polynomial.
    #[must_use]
    pub fn order(&self) -> u32 {
        self.order
    }

    /// What to give up when a path is too short.
    #[must_use]
    pub fn short_path(&self) -> ShortPathPolicy {
        self.short_path
    }

    /// How the axes go together.
    #[must_use]
    pub fn synchronization(&self) -> Synchronization {
        self.synchronization
    }

    /// The least duration of the plan \[s\]; 0 where nothing is asked.
    #[must_use]
    pub fn minimum_duration(&self) -> f64 {
        self.minimum_duration
    }

    /// Is every axis to end on a cycle?
    #[must_use]
    pub fn end_on_cycle(&self) -> bool {
        self.end_on_cycle
    }
}

impl TryFrom<RequestSpec> for Request {
    type Error = InvalidFields;

    fn try_from(spec: RequestSpec) -> Result<Self, InvalidFields> {
        let RequestSpec {
            axes,
            cycle_time_ns,
            family,
            order,
            short_path,
            synchronization,
            minimum_duration,
            end_on_cycle,
        } = spec;
        let mut invalid = InvalidFields::default();
        let several = axes.len() > 1;
        invalid.note("family", family.as_ref().err().cloned());
        let cycle_time = CycleTime::from_ns(cycle_time_ns);
        let law = Shape {
            family: *family.as_ref().unwrap_or(&Family::SCurve),
            order,
            end_on_cycle,
            cycle: *cycle_time.as_ref().unwrap_or(&CycleTime::MILLISECOND),
        };
        invalid.note("order", law.wrong_order());
        let minimum_duration = minimum_duration.unwrap_or_default();
        invalid.note("minimum_duration", wrong_duration(minimum_duration));
        let policy = *short_path.as_ref().unwrap_or(&ShortPathPolicy::Reject);
        invalid.note("short_path_policy", short_path.err());
        let mode = *synchronization.as_ref().unwrap_or(&Synchronization::None);
        invalid.note(
            "synchronization",
            synchronization.err().or(synchronization_gap(mode, several, law.family)),
        );
        let cycle_time = invalid.take(&Field::default(), cycle_time);
        let apart = several && mode == Synchronization::None;
        let axes = checked_axes(&mut invalid, axes, policy, law, apart);
        match cycle_time {
            Some(cycle_time) if invalid.is_empty() => {
                let Shape { family, .. } = law;
                let order = law.order().unwrap_or_default();
                Ok(Self {
                    axes,
                    cycle_time,
                    family,
                    order,
                    short_path: policy,
                    synchronization: mode,
                    minimum_duration,
                    end_on_cycle,
                })
            }
            _ => Err(invalid),
        }
    }
}

fn checked_axes(
    invalid: &mut InvalidFields,
    specs: Vec<AxisMoveSpec>,
    policy: ShortPathPolicy,
    law: Shape,
    apart: bool,
) -> Vec<AxisMove> {
    let given = specs.len();
    if given == 0 {
        invalid.note("axes", Some(Why::NoAxes));
    }
    if given > MAX_AXES {
        // The rest of what is wrong would drown this.
        invalid.note("axes", Some(Why::TooManyAxes { given, allowed: MAX_AXES }));
        return Vec::new();
    }
    note_names(invalid, specs.iter().map(|spec| spec.axis.as_str()));
    let mut axes = Vec::with_capacity(given);
    for (index, spec) in specs.into_iter().enumerate() {
        axes.extend(invalid.take_element("axes", index, checked_axis(spec, policy, apart, law)));
    }
    axes
}

/// What is wrong with the name of an axis or a stream; nothing if it is one: 1 to [`MAX_NAME_BYTES`] bytes, none of them a
/// control character, since names stand in tables and logs.
#[must_use]
pub fn wrong_name(name: &str) -> Option<Why> {
    if name.is_empty() {
        return Some(Why::NameEmpty);
    }
    if name.len() > MAX_NAME_BYTES {
        return Some(Why::NameTooLong { given: name.len(), allowed: MAX_NAME_BYTES });
    }
    name.chars().find(|character| character.is_control()).map(|given| Why::NameControl { given })
}

/// Reports every axis whose name is none, or was taken before it.
pub(crate) fn note_names<'a>(invalid: &mut InvalidFields, names: impl Iterator<Item = &'a str> + Clone) {
    for (index, name) in names.clone().enumerate() {
        let taken = || names.clone().take(index).any(|before| before == name);
        if let Some(why) =
            wrong_name(name).or_else(|| taken().then(|| Why::DuplicateAxis { name: name.into() }))
        {
            let field = Field::named("axis").within(&Field::element("axes", index));
            invalid.note(field.as_str(), Some(why));
        }
    }
}

fn checked_axis(
    spec: AxisMoveSpec,
    policy: ShortPathPolicy,
    apart: bool,
    law: Shape,
) -> Result<AxisMove, InvalidFields> {
    let AxisMoveSpec { axis, kind, start, goal, limits } = spec;
    let limits = law.with_jerk(limits);
    let mut invalid = InvalidFields::default();
    let kind = kind.map_err(|why| invalid.note("kind", Some(why))).ok();
    let (start, goal) = law.rested(&mut invalid, start, goal);
    for (field, part) in [("goal.velocity", goal.velocity), ("goal.acceleration", goal.acceleration)] {
        if apart && part != 0.0 {
            // Who arrives first would have to wait at speed.
            let what = "a goal at speed for one of several axes that do not arrive together";
            let instead = "choose SYNCHRONIZATION_TIME, or end every axis at rest";
            invalid.note(field, Some(Why::NotImplemented { what, instead }));
        }
    }
    let problem = match Limits::try_from(limits) {
        Ok(limits) => {
            invalid.extend_within(&Field::named("limits"), law.missing_limits(&limits));
            let problem = AxisProblem::new(law.family, start, goal, limits, policy);
            let problem = invalid.take(&Field::default(), problem);
            if let Some(problem) = problem.as_ref().filter(|_| law.end_on_cycle) {
                invalid.take(&Field::default(), law.on_cycles(problem));
            }
            problem
        }
        Err(inner) => {
            invalid.extend_within(&Field::named("limits"), inner);
            crate::problem::note_not_finite(&mut invalid, &start, &goal);
            None
        }
    };
    match (kind, problem) {
        (Some(kind), Some(problem)) if invalid.is_empty() => Ok(AxisMove { axis, kind, problem }),
        _ => Err(invalid),
    }
}

/// A family with the order that was asked for, and whether its moves are to end on a cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    pub(crate) family: Family,
    pub(crate) order: Option<u32>,
    pub(crate) end_on_cycle: bool,
    pub(crate) cycle: CycleTime,
}

impl Shape {
    /// `limits` with a limit of jerk where order 2, which keeps none, has left it out: stops, holds and what else may
    /// follow on a stream keep one. The acceleration comes to its limit within a cycle, as it does in the setpoints of such a motion.
    pub(crate) fn with_jerk(self, limits: LimitsSpec) -> LimitsSpec {
        let left_out = limits.max_jerk == 0.0 && self.order() == Some(2);
        // Wrong limits are not the place to take another from.
        let hardest = largest(limits.max_acceleration, limits.max_deceleration.unwrap_or_default());
        if !left_out || not_positive(hardest).is_some() {
            return limits;
        }
        LimitsSpec { max_jerk: least(hardest / self.cycle.as_seconds(), GREATEST_MAGNITUDE), ..limits }
    }

    fn order(self) -> Option<u32> {
        self.family.order().or(self.order)
    }

    fn wrong_order(self) -> Option<Why> {
        let Self { family, order: given, .. } = self;
        match (family.order(), given) {
            (Some(order), Some(given)) if given != order => {
                Some(Why::OrderOfFamily { given, family: family.name(), order })
            }
            (Some(_), _) => None,
            (None, Some(given)) => crate::polynomial::unsupported(given as usize),
            (None, None) => Some(Why::OrderMissing),
        }
    }

    fn missing_limits(self, limits: &Limits) -> InvalidFields {
        match (self.family, self.order) {
            (Family::Polynomial, Some(order)) => crate::polynomial::missing_limits(limits, order as usize),
            _ => InvalidFields::default(),
        }
    }

    /// Can the move end on a cycle?
    fn on_cycles(self, problem: &AxisProblem) -> Result<(), InvalidFields> {
        match problem {
            // It can take a little longer; a motion that is slowed as a whole must be at rest at both ends.
            AxisProblem::Along(problem) if self.family != Family::SCurve => note_speeds(problem),
            AxisProblem::Along(_) | AxisProblem::Between(_) => Ok(()),
        }
    }

    /// The ends, put to rest where the family needs it, which is reported of each part that was not.
    fn rested(self, invalid: &mut InvalidFields, start: State, goal: State) -> (State, State) {
        if !self.family.needs_rest() {
            return (start, goal);
        }
        crate::polynomial::note_motion(invalid, self.family.name(), [("start", &start), ("goal", &goal)]);
        let zero = |value: f64| if value.is_finite() { 0.0 } else { value };
        let rested = |state: State| State {
            velocity: zero(state.velocity),
            acceleration: zero(state.acceleration),
            ..state
        };
        (rested(start), rested(goal))
    }
}

fn wrong_duration(given: f64) -> Option<Why> {
    not_finite(given).or((given < 0.0).then_some(Why::NegativeDuration { given }))
}

/// A straight line of the families from rest to rest is not drawn yet.
fn synchronization_gap(mode: Synchronization, several: bool, family: Family) -> Option<Why> {
    let what = "a straight line for several axes of this family";
    let instead = "choose S_CURVE, or SYNCHRONIZATION_TIME: the axes then arrive together";
    (several && mode == Synchronization::Phase && family != Family::SCurve)
        .then_some(Why::NotImplemented { what, instead })
}
