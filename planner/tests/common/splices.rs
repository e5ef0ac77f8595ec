//! Motions of which each is under way in its own manner, and what is done to them.

use planner::motion::{AxisGoal, Motion, Operation, Override};
use planner::{
    AxisKind, AxisMoveSpec, BoundsSpec, CycleTime, Family, Judged, Limits, LimitsSpec, Method, Plan, Profile,
    Request, RequestSpec, ShortPathPolicy, State, Synchronization,
};

use super::motions::{NAMES, Opening};
use super::states::Question;

/// Half a metre or so from zero, each axis another way.
fn opening(axes: usize, line: bool) -> Opening {
    let axis = |index: usize| {
        let size = 1.0 - 0.1 * index as f64;
        let limits = LimitsSpec {
            max_velocity: 0.5 * size,
            max_acceleration: 2.0 * size,
            max_jerk: 20.0 * size,
            ..LimitsSpec::default()
        };
        (State::at_rest(0.0), State::at_rest(0.8 * size), limits)
    };
    let axes = (0..axes).map(axis).collect();
    Opening { axes, family: Family::SCurve, order: None, cycle_time_ns: 1_000_000, line }
}

/// The same, at one time: all move at full speed, so each is slowed in its own way.
fn together() -> Motion {
    let axes = opening(6, false).axes.into_iter().zip(NAMES).enumerate();
    let axes = axes.map(|(index, ((start, goal, limits), name))| AxisMoveSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        start,
        goal: State::at_rest(goal.position * (1.0 - 0.05 * index as f64)),
        limits,
    });
    let spec = RequestSpec {
        axes: axes.collect(),
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::Time),
        minimum_duration: None,
        end_on_cycle: false,
    };
    let judged = Judged::answer(&Request::try_from(spec).unwrap()).unwrap();
    Motion::open(judged.accepted().unwrap()).unwrap()
}

/// While it speeds up.
pub(crate) const AT: u64 = 200;

/// A plan of one axis that goes as `profile` says.
pub(crate) fn one_axis(profile: &Profile, limits: Limits, cycle: CycleTime) -> Plan {
    let axis = super::paths::axis(0, limits, profile.clone());
    Plan::new(Method::default(), Vec::new(), cycle, vec![axis]).unwrap()
}

/// Each kind by its name.
pub(crate) fn motions() -> [(&'static str, Motion); 4] {
    [
        ("1_axis", opening(1, false).motion()),
        ("6_axes", opening(6, false).motion()),
        ("6_axes_on_a_line", opening(6, true).motion()),
        ("6_axes_together", together()),
    ]
}

/// What is done, and to what: `motion`, or the same on hold.
pub(crate) fn operations(motion: &Motion) -> [(&'static str, Motion, Operation); 4] {
    let held = motion.splice(AT, &Operation::Hold).unwrap().motion;
    [
        ("hold", motion.clone(), Operation::Hold),
        ("resume", held, Operation::Resume),
        ("override", motion.clone(), Operation::Override(Override::new(0.5).unwrap())),
        ("retarget", motion.clone(), retarget(motion, 0.7)),
    ]
}

fn retarget(motion: &Motion, factor: f64) -> Operation {
    let goals = motion.plan().axes().iter().map(|axis| AxisGoal {
        axis: axis.axis.clone(),
        goal: State::at_rest(axis.goal.position * factor),
        limits: None,
    });
    Operation::Retarget(goals.collect())
}

/// What is asked of a planner alone for that retarget of one axis: from where `motion` is just after [`AT`].
pub(crate) fn question(motion: &Motion, axis: usize) -> Question {
    Question {
        start: motion.state(axis, AT + 1),
        goal: State::at_rest(0.7 * motion.plan().axes()[axis].goal.position),
        ..whole(motion, axis)
    }
}

/// What is asked of a planner alone for one axis of `motion`, from its beginning to its goal.
pub(crate) fn whole(motion: &Motion, axis: usize) -> Question {
    let planned = &motion.plan().axes()[axis];
    let (velocity, acceleration) = (planned.limits.velocity_forward(), planned.limits.acceleration());
    Question {
        start: planned.profile.start(),
        goal: planned.goal,
        bounds: BoundsSpec {
            min_velocity: -velocity,
            max_velocity: velocity,
            min_acceleration: -acceleration,
            max_acceleration: acceleration,
            max_jerk: planned.limits.jerk(),
        },
    }
}
