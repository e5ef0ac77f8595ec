//! Plans of one to six axes whose time can be stretched: S-curves of different lengths, the same over one duration, fifth
//! order, and splines through points.

use planner::{
    AxisKind, AxisPlan, Classification, CycleTime, Derivatives, Law, Limits, LimitsSpec, Method, Plan,
    Problem, Profile, Quantity, Segment, ShortPathPolicy, State, plan_move, plan_polynomial,
};

use super::random::Random;

/// What a plan is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Each axis on its own time.
    Free,
    /// Each axis as slow as the slowest: the same shape, stretched.
    Together,
    /// Fifth order, each on its own time.
    FifthOrder,
    /// Cubics through points, whose accelerations jump: nothing is promised.
    Cubic,
    /// Quintics through points: nothing is promised.
    Quintic,
}

pub(crate) const KINDS: [Kind; 5] =
    [Kind::Free, Kind::Together, Kind::FifthOrder, Kind::Cubic, Kind::Quintic];

/// One axis of a plan.
pub(crate) fn axis(index: usize, limits: Limits, profile: Profile) -> AxisPlan {
    AxisPlan {
        axis: format!("axis {index}"),
        kind: AxisKind::Prismatic,
        limits,
        goal: profile.end(),
        profile,
        adjustments: Vec::new(),
        classification: Classification::default(),
        pvt_regions: Vec::new(),
    }
}

/// The same path in `factor` times the time.
pub(crate) fn stretched(profile: &Profile, factor: f64) -> Profile {
    let rate = 1.0 / factor;
    let slowed = |state: State| State {
        velocity: state.velocity * rate,
        acceleration: state.acceleration * rate * rate,
        ..state
    };
    let segments = profile.segments().iter().map(|segment| {
        let Law::ConstantJerk(jerk) = segment.law else { unreachable!("an S-curve has constant jerks") };
        let law = Law::ConstantJerk(jerk * rate * rate * rate);
        Segment { duration: segment.duration * factor, start: slowed(segment.start), law }
    });
    Profile::new(segments, slowed(profile.end()))
}

fn limits(random: &mut Random) -> LimitsSpec {
    let velocity = random.decades(0.05, 5.0);
    let acceleration = velocity * random.decades(0.5, 20.0);
    let jerk = acceleration * random.decades(1.0, 50.0);
    let snap = jerk * random.decades(3.0, 100.0);
    LimitsSpec {
        max_velocity: velocity,
        max_acceleration: acceleration,
        max_deceleration: (random.unit() < 0.4).then(|| acceleration * random.decades(0.4, 2.5)),
        max_jerk: jerk,
        max_velocity_reverse: (random.unit() < 0.3).then_some(velocity * random.decades(0.5, 2.0)),
        max_snap: Some(snap),
        max_higher_derivatives: vec![snap * random.decades(3.0, 100.0)],
        ..LimitsSpec::default()
    }
}

/// A cubic or quintic between two states in `duration`.
fn between(from: State, to: State, duration: f64, quintic: bool) -> Segment {
    let h = duration;
    let (way, dv) = (to.position - from.position, to.velocity - from.velocity);
    if !quintic {
        let acceleration = (6.0 * way / h - 4.0 * from.velocity - 2.0 * to.velocity) / h;
        let jerk = (6.0 * (from.velocity + to.velocity) - 12.0 * way / h) / (h * h);
        let start = State { acceleration, ..from };
        return Segment { duration, start, law: Law::ConstantJerk(jerk) };
    }
    let gap = way - from.velocity * h - 0.5 * from.acceleration * h * h;
    let dv = dv - from.acceleration * h;
    let da = to.acceleration - from.acceleration;
    let jerk = (60.0 * gap - 24.0 * dv * h + 3.0 * da * h * h) / (h * h * h);
    let snap = (-360.0 * gap + 168.0 * dv * h - 24.0 * da * h * h) / (h * h * h * h);
    let crackle = (720.0 * gap - 360.0 * dv * h + 60.0 * da * h * h) / (h * h * h * h * h);
    let law = Law::Polynomial(Derivatives::new(&[jerk, snap, crackle]).unwrap());
    Segment { duration, start: from, law }
}

/// Through points at common times.
fn spline(random: &mut Random, times: &[f64], limits: &LimitsSpec, quintic: bool) -> Profile {
    let start = random.between(-1.0, 1.0);
    let mut now = State::at_rest(start);
    let mut segments = Vec::new();
    for (index, &duration) in times.iter().enumerate() {
        let last = index + 1 == times.len();
        let speed = limits.max_velocity * random.between(-0.3, 0.6);
        let next = State {
            position: now.position + 0.5 * duration * (now.velocity + speed),
            velocity: if last { 0.0 } else { speed },
            acceleration: 0.0,
        };
        segments.push(between(now, next, duration, quintic));
        now = next;
    }
    Profile::new(segments, now)
}

/// A plan of `count` axes.
pub(crate) fn path(random: &mut Random, kind: Kind, count: usize) -> Plan {
    let specs: Vec<LimitsSpec> = (0..count).map(|_| limits(random)).collect();
    let seconds = random.decades(0.2, 2.0);
    let times: Vec<f64> = (0..4).map(|_| seconds * random.between(0.3, 1.0)).collect();
    let mut profiles = Vec::new();
    for spec in &specs {
        let profile = match kind {
            Kind::Cubic => spline(random, &times, spec, false),
            Kind::Quintic => spline(random, &times, spec, true),
            Kind::Free | Kind::Together | Kind::FifthOrder => {
                let from = if random.unit() < 0.3 { 0.0 } else { random.between(-1.0, 1.0) };
                let way = spec.max_velocity * random.decades(0.05, 3.0);
                // Forward, where backward may be slower; and now and then home to zero.
                let (from, to) = match random.bits() % 4 {
                    0 => (from, from - way.min(spec.max_velocity_reverse.unwrap_or(way))),
                    1 => (-way, 0.0),
                    _ => (from, from + way),
                };
                let limits = Limits::try_from(spec.clone()).unwrap();
                let ends = (State::at_rest(from), State::at_rest(to));
                let problem = Problem::new(ends.0, ends.1, limits, ShortPathPolicy::Reject).unwrap();
                if kind == Kind::FifthOrder {
                    plan_polynomial(&problem, 5).unwrap().to_profile()
                } else {
                    plan_move(&problem).unwrap().to_profile()
                }
            }
        };
        profiles.push(profile);
    }
    if kind == Kind::Together {
        let longest = profiles.iter().map(Profile::duration).fold(0.0, f64::max);
        profiles = profiles
            .iter()
            .map(|profile| {
                let factor = longest / profile.duration();
                if factor > 1.0 { stretched(profile, factor) } else { profile.clone() }
            })
            .collect();
    }
    let axes = specs.into_iter().zip(profiles).enumerate();
    let axes = axes.map(|(index, (spec, profile))| axis(index, spec.try_into().unwrap(), profile)).collect();
    let promised: &[Quantity] = match kind {
        Kind::Free | Kind::Together => &Quantity::BY_ORDER[1..=3],
        Kind::FifthOrder => &Quantity::BY_ORDER[1..=5],
        Kind::Cubic | Kind::Quintic => &[],
    };
    Plan::new(Method::default(), promised.to_vec(), CycleTime::MILLISECOND, axes).unwrap()
}
