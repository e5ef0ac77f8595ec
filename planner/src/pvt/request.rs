use alloc::string::String;
use alloc::vec::Vec;

use super::planner::{note_start, wrong_point};
use super::{PvtInterpolation, PvtPolicy};
use crate::error::{Field, InvalidFields, Why};
use crate::limits::not_finite;
use crate::request::note_names;
use crate::{AxisKind, CycleTime, Limits, LimitsSpec, MAX_AXES, Quantity, State};

/// Of one list the first faults are reported: ten thousand of a kind say no more.
const MOST_REPORTED: usize = 8;

/// One axis's points, not yet checked.
#[derive(Clone, Debug, PartialEq)]
pub struct PvtAxisSpec {
    /// The axis's name, unique in the request.
    pub axis: String,
    /// What it moves in, or why that cannot be told.
    pub kind: Result<AxisKind, Why>,
    /// What it may do on the way.
    pub limits: LimitsSpec,
    /// Where it begins.
    pub start: State,
    /// When each point is to be met \[s\] from the start, > 0 and increasing; the same for all axes.
    pub times: Vec<f64>,
    /// Where it is to be at each of these times [axis units].
    pub positions: Vec<f64>,
    /// How fast it is to be there [axis units/s].
    pub velocities: Vec<f64>,
}

/// A request as somebody states it, not yet checked.
#[derive(Clone, Debug, PartialEq)]
pub struct PvtRequestSpec {
    /// The axes, in the order that the plan keeps.
    pub axes: Vec<PvtAxisSpec>,
    /// The time between two setpoints \[ns\]; `None`: 1 ms.
    pub cycle_time_ns: Option<i128>,
    /// How points are joined.
    pub interpolation: Result<PvtInterpolation, Why>,
    /// What to do about points that cannot be met.
    pub policy: Result<PvtPolicy, Why>,
    /// After the last point, go on to its position and velocity without regard to time, if they were not reached?
    pub finish_unreached: bool,
}

/// One axis of a checked request.
#[derive(Clone, Debug, PartialEq)]
pub struct PvtAxis {
    /// The axis's name.
    pub axis: String,
    /// What it moves in.
    pub kind: AxisKind,
    /// What it may do on the way.
    pub limits: Limits,
    /// Where it begins, without acceleration.
    pub start: State,
    /// The states to be met, without acceleration: one for each time.
    pub points: Vec<State>,
}

/// Points of one or more axes over one list of times, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct PvtRequest {
    axes: Vec<PvtAxis>,
    times: Vec<f64>,
    cycle_time: CycleTime,
    interpolation: PvtInterpolation,
    policy: PvtPolicy,
    finish_unreached: bool,
}

impl PvtRequest {
    /// The axes, one or more, with names of their own and a point for each time.
    #[must_use]
    pub fn axes(&self) -> &[PvtAxis] {
        &self.axes
    }

    /// When the points are to be met \[s\], increasing.
    #[must_use]
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The time between two setpoints.
    #[must_use]
    pub fn cycle_time(&self) -> CycleTime {
        self.cycle_time
    }

    /// How points are joined.
    #[must_use]
    pub fn interpolation(&self) -> PvtInterpolation {
        self.interpolation
    }

    /// What to do about points that cannot be met.
    #[must_use]
    pub fn policy(&self) -> PvtPolicy {
        self.policy
    }

    /// Go on to the last point if it was not reached in time?
    #[must_use]
    pub fn finish_unreached(&self) -> bool {
        self.finish_unreached
    }
}

impl TryFrom<PvtRequestSpec> for PvtRequest {
    type Error = InvalidFields;

    fn try_from(spec: PvtRequestSpec) -> Result<Self, InvalidFields> {
        let PvtRequestSpec { axes, cycle_time_ns, interpolation, policy, finish_unreached } = spec;
        let mut invalid = InvalidFields::default();
        invalid.note("interpolation", interpolation.as_ref().err().cloned());
        invalid.note("policy", policy.as_ref().err().cloned());
        let cycle_time = invalid.take(&Field::default(), CycleTime::from_ns(cycle_time_ns));
        let given = axes.len();
        if given == 0 {
            invalid.note("axes", Some(Why::NoAxes));
        }
        if given > MAX_AXES {
            invalid.note("axes", Some(Why::TooManyAxes { given, allowed: MAX_AXES }));
            return Err(invalid);
        }
        note_names(&mut invalid, axes.iter().map(|axis| axis.axis.as_str()));
        let times = axes.first().map(|axis| axis.times.clone()).unwrap_or_default();
        let mut checked = Vec::with_capacity(given);
        for (index, axis) in axes.into_iter().enumerate() {
            let outer = Field::element("axes", index);
            checked.extend(invalid.take(&outer, checked_axis(axis, &times, index == 0, cycle_time)));
        }
        match (interpolation, policy, cycle_time) {
            (Ok(interpolation), Ok(policy), Some(cycle_time)) if invalid.is_empty() => {
                Ok(Self { axes: checked, times, cycle_time, interpolation, policy, finish_unreached })
            }
            _ => Err(invalid),
        }
    }
}

fn checked_axis(
    spec: PvtAxisSpec,
    shared: &[f64],
    first: bool,
    cycle_time: Option<CycleTime>,
) -> Result<PvtAxis, InvalidFields> {
    let PvtAxisSpec { axis, kind, limits, start, times, positions, velocities } = spec;
    let mut invalid = InvalidFields::default();
    let kind = kind.map_err(|why| invalid.note("kind", Some(why))).ok();
    let limits = invalid.take(&Field::named("limits"), Limits::try_from(limits));
    let start = start.with_positive_zeros();
    if let Some(limits) = &limits {
        note_start(&mut invalid, &start, limits);
    }
    if first {
        note_times(&mut invalid, &times, cycle_time);
    } else {
        note_differing_times(&mut invalid, &times, shared);
    }
    for (name, list) in [("positions", &positions), ("velocities", &velocities)] {
        let (given, expected) = (list.len(), times.len());
        let why = Why::LengthMismatch { given, expected, list: "times" };
        invalid.note(name, (given != expected).then_some(why));
    }
    if let Some(limits) = &limits {
        note_points(&mut invalid, &positions, &velocities, limits);
    }
    match (kind, limits) {
        (Some(kind), Some(limits)) if invalid.is_empty() => {
            let point = |(&position, &velocity): (&f64, &f64)| {
                State { position, velocity, acceleration: 0.0 }.with_positive_zeros()
            };
            let points = positions.iter().zip(&velocities).map(point).collect();
            Ok(PvtAxis { axis, kind, limits, start, points })
        }
        _ => Err(invalid),
    }
}

/// What is wrong with the time of a point \[s\] after that of the point before \[s\]: it is to be later, by a cycle at least.
#[must_use]
pub fn wrong_time(given: f64, before: f64, cycle_time: Option<CycleTime>) -> Option<Why> {
    not_finite(given).or_else(|| {
        let interval = given - before;
        if interval.is_nan() || interval <= 0.0 {
            return Some(Why::TimesNotIncreasing { given, before });
        }
        let cycle = cycle_time?.as_seconds();
        // A beat of whole cycles is not shorter than one by the rounding of its times.
        let too_short = interval < cycle - 2.0 * f64::EPSILON * given;
        too_short.then_some(Why::IntervalTooShort { given: interval, cycle })
    })
}

fn note_times(invalid: &mut InvalidFields, times: &[f64], cycle_time: Option<CycleTime>) {
    invalid.note("times", times.is_empty().then_some(Why::NoPoints));
    let mut before = 0.0;
    let mut faults = 0;
    for (index, &given) in times.iter().enumerate() {
        let why = wrong_time(given, before, cycle_time);
        if why.is_some() {
            invalid.note(Field::element("times", index).as_str(), why);
            faults += 1;
            if faults == MOST_REPORTED {
                return;
            }
        }
        before = given;
    }
}

#[expect(clippy::float_cmp, reason = "the same list given twice has the same numbers")]
fn note_differing_times(invalid: &mut InvalidFields, times: &[f64], shared: &[f64]) {
    let (given, expected) = (times.len(), shared.len());
    if given != expected {
        let why = Why::LengthMismatch { given, expected, list: "axes[0].times" };
        invalid.note("times", Some(why));
        return;
    }
    let differs = times.iter().zip(shared).enumerate().find(|(_, (given, expected))| given != expected);
    if let Some((index, (&given, &expected))) = differs {
        let why = Why::TimesDiffer { given, expected };
        invalid.note(Field::element("times", index).as_str(), Some(why));
    }
}

fn note_points(invalid: &mut InvalidFields, positions: &[f64], velocities: &[f64], limits: &Limits) {
    // Where one list is shorter what is wrong in the rest of the other is told as well.
    let count = positions.len().max(velocities.len());
    let at = |list: &[f64], index: usize, other: f64| list.get(index).copied().unwrap_or(other);
    let allowed = 0.0_f64.max(limits.min_position()).min(limits.max_position());
    let wrong = (0..count).flat_map(|index| {
        let (position, velocity) = (at(positions, index, allowed), at(velocities, index, 0.0));
        wrong_point(position, velocity, limits).map(move |(quantity, why)| (index, quantity, why))
    });
    for (index, quantity, why) in wrong.take(MOST_REPORTED) {
        invalid.note(field(quantity, index).as_str(), Some(why));
    }
}

/// The element that a refusal of point number `index` is about.
pub(super) fn field(quantity: Quantity, index: usize) -> Field {
    Field::element(if quantity == Quantity::Velocity { "velocities" } else { "positions" }, index)
}
