//! Motions under way and scripts of operations on them, drawn to hurt.

use planner::motion::{AxisGoal, Motion, Operation, Override};
use planner::{
    Accepted, AxisKind, AxisMoveSpec, AxisPlan, Classification, Family, Judged, Law, Limits, LimitsSpec,
    Method, Plan, Profile, Quantity, Request, RequestSpec, Segment, ShortPathPolicy, State, Synchronization,
};

use super::random::Random;

pub(crate) const NAMES: [&str; 6] = ["x", "y", "z", "a", "b", "c"];

/// What a motion is made of.
#[derive(Clone, Debug)]
pub(crate) struct Opening {
    pub(crate) axes: Vec<(State, State, LimitsSpec)>,
    pub(crate) family: Family,
    pub(crate) order: Option<u32>,
    pub(crate) cycle_time_ns: i128,
    /// All on a straight line.
    pub(crate) line: bool,
}

impl Opening {
    pub(crate) fn plan(&self) -> Accepted {
        let plan = if self.line { self.on_a_line() } else { self.each() };
        Judged::new(plan).accepted().unwrap()
    }

    pub(crate) fn motion(&self) -> Motion {
        Motion::open(self.plan()).unwrap()
    }

    fn each(&self) -> Plan {
        let axes = self.axes.iter().zip(NAMES).map(|((start, goal, limits), name)| AxisMoveSpec {
            axis: name.into(),
            kind: Ok(AxisKind::Prismatic),
            start: *start,
            goal: *goal,
            limits: limits.clone(),
        });
        let spec = RequestSpec {
            axes: axes.collect(),
            cycle_time_ns: Some(self.cycle_time_ns),
            family: Ok(self.family),
            order: self.order,
            short_path: Ok(ShortPathPolicy::NearestVelocity),
            synchronization: Ok(Synchronization::None),
            minimum_duration: None,
            end_on_cycle: false,
        };
        planner::plan(&Request::try_from(spec).unwrap()).unwrap()
    }

    /// The first axis as it would go by itself, and the others in proportion; limits that this needs are as wide as they must be.
    fn on_a_line(&self) -> Plan {
        let alone = Self { axes: vec![self.axes[0].clone()], line: false, ..self.clone() }.each();
        let (start, goal, _) = self.axes[0];
        let first = &alone.axes()[0];
        let axes = self.axes.iter().zip(NAMES).map(|(&(from, to, ref limits), name)| {
            let ratio = (to.position - from.position) / (goal.position - start.position);
            let on_line = |state: State| State {
                position: from.position + (state.position - start.position) * ratio,
                velocity: state.velocity * ratio,
                acceleration: state.acceleration * ratio,
            };
            let segments = first.profile.segments().iter().enumerate().map(|(index, segment)| Segment {
                start: if index == 0 { from } else { on_line(segment.start) },
                law: Law::ConstantJerk(segment.at(0.0).jerk * ratio),
                ..segment
            });
            let end = State { position: to.position, ..on_line(first.profile.end()) };
            let limits = Limits::try_from(limits.clone()).unwrap();
            AxisPlan {
                axis: name.into(),
                kind: AxisKind::Prismatic,
                limits,
                profile: Profile::new(segments, end),
                goal: end,
                adjustments: Vec::new(),
                classification: Classification::default(),
                pvt_regions: Vec::new(),
            }
        });
        let method = Method { synchronization: Synchronization::Phase, order: 3, ..Method::default() };
        let guaranteed = vec![Quantity::Velocity, Quantity::Acceleration, Quantity::Jerk];
        Plan::new(method, guaranteed, alone.cycle_time(), axes.collect()).unwrap()
    }

    /// Seen from the other side.
    pub(crate) fn mirrored(&self) -> Self {
        let axes = self
            .axes
            .iter()
            .map(|(start, goal, limits)| (start.mirrored(), goal.mirrored(), mirrored(limits)));
        Self { axes: axes.collect(), ..self.clone() }
    }
}

fn mirrored(limits: &LimitsSpec) -> LimitsSpec {
    LimitsSpec {
        max_velocity: limits.max_velocity_reverse.unwrap_or(limits.max_velocity),
        max_velocity_reverse: Some(limits.max_velocity),
        min_position: limits.max_position.map(|position| -position),
        max_position: limits.min_position.map(|position| -position),
        ..limits.clone()
    }
}

/// The same operation, seen from the other side.
pub(crate) fn mirrored_operation(operation: &Operation) -> Operation {
    let Operation::Retarget(goals) = operation else { return operation.clone() };
    let goals = goals.iter().map(|AxisGoal { axis, goal, limits }| AxisGoal {
        axis: axis.clone(),
        goal: goal.mirrored(),
        limits: limits.as_ref().map(|limits| mirrored(limits.spec()).try_into().unwrap()),
    });
    Operation::Retarget(goals.collect())
}

fn pick<T: Copy>(random: &mut Random, from: &[T]) -> T {
    from[random.bits() as usize % from.len()]
}

pub(crate) fn limits(random: &mut Random) -> LimitsSpec {
    let mut spec = if random.bits().is_multiple_of(3) {
        LimitsSpec {
            max_velocity: pick(random, &[0.1, 0.5, 1.0, 2.0]),
            max_acceleration: pick(random, &[0.5, 1.0, 2.0, 10.0]),
            max_jerk: pick(random, &[1.0, 10.0, 20.0, 100.0]),
            ..LimitsSpec::default()
        }
    } else {
        LimitsSpec {
            max_velocity: random.decades(0.03, 3.0),
            max_acceleration: random.decades(0.1, 30.0),
            max_jerk: random.decades(0.5, 500.0),
            ..LimitsSpec::default()
        }
    };
    if random.bits().is_multiple_of(4) {
        spec.max_deceleration = Some(spec.max_acceleration * random.between(0.3, 3.0));
    }
    if random.bits().is_multiple_of(4) {
        spec.feed_rate = Some(spec.max_velocity * random.between(0.2, 1.0));
    }
    if random.bits().is_multiple_of(6) {
        spec.max_velocity_reverse = Some(spec.max_velocity * random.between(0.3, 2.0));
    }
    spec
}

fn position(random: &mut Random) -> f64 {
    match random.bits() % 4 {
        0 => pick(random, &[0.0, 0.1, 1.0, -1.0, 100.0]),
        1 => random.decades(1e-6, 1.0),
        _ => random.between(-1.0, 1.0),
    }
}

pub(crate) fn opening(random: &mut Random, line: bool) -> Opening {
    let count = if line { 2 + random.bits() % 3 } else { pick(random, &[1, 1, 1, 2, 3]) };
    let family = if line {
        Family::SCurve
    } else {
        pick(
            random,
            &[
                Family::SCurve,
                Family::SCurve,
                Family::SCurve,
                Family::Trigonometric,
                Family::Polynomial,
                Family::Trapezoidal,
            ],
        )
    };
    let order = (family == Family::Polynomial).then(|| pick(random, &[3, 4]));
    let mut axes = Vec::new();
    for _ in 0..count {
        let start = position(random);
        let goal = start + pick(random, &[1.0, -1.0]) * random.decades(1e-4, 2.0);
        let mut limits = limits(random);
        limits.max_snap = Some(limits.max_jerk * limits.max_jerk / limits.max_acceleration);
        let mut goal = State::at_rest(goal);
        if count == 1 && family == Family::SCurve && random.bits().is_multiple_of(4) {
            let speed = limits.feed_rate.unwrap_or(limits.max_velocity);
            let speed = speed.min(limits.max_velocity_reverse.unwrap_or(speed));
            goal.velocity = speed * random.unit() * (goal.position - start).signum();
        }
        axes.push((State::at_rest(start), goal, limits));
    }
    if line {
        // First the one whose way has most digits: what it is rounded to, the others are rounded to less.
        let digits = |(from, to, _): &(State, State, LimitsSpec)| {
            (to.position - from.position).abs() / from.position.abs().max(to.position.abs())
        };
        axes.sort_by(|one, other| digits(other).total_cmp(&digits(one)));
        // The first sets the pace; the others have as much room as they need for that, and seldom any more.
        let (start, goal, first) = axes[0].clone();
        let first = LimitsSpec { max_velocity_reverse: None, ..first };
        axes[0].2 = first.clone();
        for (from, to, limits) in &mut axes[1..] {
            let ratio = ((to.position - from.position) / (goal.position - start.position)).abs();
            let room = random.between(1.0, 1.5) * ratio;
            *limits = LimitsSpec {
                max_velocity: room * first.max_velocity,
                max_acceleration: room * first.max_acceleration,
                max_jerk: room * first.max_jerk,
                max_deceleration: first.max_deceleration.map(|limit| limit * room),
                ..LimitsSpec::default()
            };
        }
    }
    let cycle_time_ns = pick(random, &[1_000_000, 1_000_000, 250_000, 4_000_000, 10_000_000]);
    Opening { axes, family, order, cycle_time_ns, line }
}

/// The next operation, and when: at the same cycle, at the next, on the way, at the very end, and long after it.
pub(crate) fn operation(
    random: &mut Random,
    opened: &Opening,
    motion: &Motion,
    cycle: u64,
) -> (u64, Operation) {
    let last = motion.last_cycle().max(cycle);
    let on_the_way = cycle + ((last - cycle) as f64 * random.unit()) as u64;
    let at = match random.bits() % 12 {
        0 => cycle,
        1 | 2 => cycle + 1,
        3 => cycle + 1 + random.bits() % 20,
        4 => last,
        5 => last.saturating_sub(1 + random.bits() % 3).max(cycle),
        6 => last + random.bits() % 5000,
        _ => on_the_way,
    };
    let greatest = greatest(motion);
    let operation = match random.bits() % 24 {
        0..=4 => Operation::Hold,
        5..=8 => Operation::Resume,
        9 => Operation::Override(Override::new(greatest).unwrap()),
        10 => Operation::Override(Override::REST),
        11 | 12 => Operation::Override(Override::FULL),
        13..=16 => Operation::Override(Override::new(random.between(0.05, 1.0) * greatest).unwrap()),
        17 if random.bits().is_multiple_of(4) => Operation::Stop,
        _ => Operation::Retarget(goals(random, opened, motion, at)),
    };
    (at, operation)
}

pub(crate) fn greatest(motion: &Motion) -> f64 {
    let asked = motion.base().map_or(motion.plan(), Accepted::plan);
    Override::greatest(asked.axes().iter().map(|axis| &axis.limits))
}

/// The goals and limits that the motion goes to.
pub(crate) fn asked(motion: &Motion) -> &[AxisPlan] {
    motion.base().map_or(motion.plan(), Accepted::plan).axes()
}

fn goals(random: &mut Random, opened: &Opening, motion: &Motion, at: u64) -> Vec<AxisGoal> {
    let axes = asked(motion);
    if opened.line {
        let part = pick(random, &[0.0, 0.5, 0.9, 1.0, 1.5, -3.0]) + random.between(0.0, 0.1);
        let on_line = opened.axes.iter().zip(axes).map(|((from, to, _), axis)| {
            let goal = State::at_rest(from.position + part * (to.position - from.position));
            AxisGoal { axis: axis.axis.clone(), goal, limits: None }
        });
        return on_line.collect();
    }
    let mut goals = Vec::new();
    for (index, axis) in axes.iter().enumerate() {
        if axes.len() > 1 && random.bits().is_multiple_of(2) {
            continue;
        }
        let now = motion.state(index, at).position;
        let far = pick(random, &[1.0, -1.0]) * random.decades(1e-6, 3.0);
        let mut limits = (!random.bits().is_multiple_of(3))
            .then_some(())
            .map_or_else(|| Some(changed(random, axis.limits.spec())), |()| None);
        let mut goal = match random.bits() % 6 {
            0 => axis.goal,
            1 => State::at_rest(now),
            2 => State::at_rest(axis.goal.position + far * 1e-3),
            _ => State::at_rest(now + far),
        };
        let current = limits.as_ref().unwrap_or(axis.limits.spec());
        let fastest = current.feed_rate.unwrap_or(current.max_velocity).min(current.max_velocity);
        let slowest = current
            .feed_rate
            .unwrap_or(f64::MAX)
            .min(current.max_velocity_reverse.unwrap_or(current.max_velocity));
        if random.bits().is_multiple_of(8) {
            goal.velocity = random.between(-slowest, fastest);
        }
        goal.velocity = goal.velocity.clamp(-slowest, fastest);
        let limits = limits.take().map(|spec| Limits::try_from(spec).unwrap());
        goals.push(AxisGoal { axis: axis.axis.clone(), goal, limits });
    }
    goals
}

/// Limits up to ten times lower, or a little higher.
fn changed(random: &mut Random, spec: &LimitsSpec) -> LimitsSpec {
    let mut factor = || match random.bits() % 3 {
        0 => 1.0,
        1 => random.decades(0.1, 1.0),
        _ => random.between(0.5, 1.5),
    };
    LimitsSpec {
        max_velocity: spec.max_velocity * factor(),
        max_acceleration: spec.max_acceleration * factor(),
        max_jerk: spec.max_jerk * factor(),
        max_deceleration: spec.max_deceleration.map(|limit| limit * factor()),
        feed_rate: None,
        ..spec.clone()
    }
}
