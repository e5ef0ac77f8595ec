//! Numbers over all the decades that are taken, and below: whatever is asked returns soon, and what is answered is legal. More of it,
//! with the longest time that a question took:
//!
//! ```text
//! cargo test --release -p portamento-planner --test wide -- --ignored --nocapture
//! ```

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may fail by panicking; the long ones report"
)]

mod common;

use std::time::Instant;

use common::Random;
use common::motions::NAMES;
use planner::generator::{AxisLimits, Generator};
use planner::motion::{AxisGoal, Motion, Operation, Override};
use planner::{
    AxisKind, AxisMoveSpec, AxisTransfer, Bounds, BoundsSpec, CycleTime, Family, GREATEST_MAGNITUDE, Judged,
    LAST_CYCLE, LEAST_LIMIT, LONGEST, LimitCheck, Limits, LimitsSpec, NoSuchDuration, Quantity, Request,
    RequestSpec, ShortPathPolicy, State, Synchronization, TimeLaw, Timing, Transfer, Transit, Violation, Why,
    certify, plan_between, plan_transfer, plan_velocity, retime, together, transfer_violations, violations,
};

/// How long full jerk takes to an acceleration, at least, if anything is to be known of it \[s\]. The velocity that it makes goes with the
/// square of that, which in the planner's least unit of time, 2⁻²⁰⁰ s, is a normal number, with what is rounded off it, from here on.
const LEAST_TIME: f64 = 1e-206;

/// How often a question is asked again whose time is measured: the least counts, as others run on this machine.
const AGAIN: usize = 5;

/// The longest time that a question took [s].
#[derive(Default)]
struct Slowest {
    seconds: f64,
}

impl Slowest {
    fn asked<T>(&mut self, question: impl Fn() -> T) -> T {
        let once = || {
            let since = Instant::now();
            let answer = question();
            (since.elapsed().as_secs_f64(), answer)
        };
        let (mut seconds, answer) = once();
        for _ in 0..AGAIN {
            if seconds <= self.seconds {
                break;
            }
            seconds = seconds.min(once().0);
        }
        self.seconds = self.seconds.max(seconds);
        answer
    }
}

/// Numbers of ± `decades` decades, with zero, the ends, one, and the least above zero among them.
struct Wide {
    random: Random,
    decades: f64,
}

impl Wide {
    fn one_in(&mut self, many: u64) -> bool {
        self.random.bits().is_multiple_of(many)
    }

    fn magnitude(&mut self) -> f64 {
        let most = 10f64.powf(self.decades).min(GREATEST_MAGNITUDE);
        let least = (1.0 / most).max(LEAST_LIMIT);
        match self.random.bits() % 8 {
            0 => most,
            1 => least,
            2 => 1.0,
            _ => self.random.decades(least, most).clamp(least, most),
        }
    }

    fn number(&mut self) -> f64 {
        let sign = if self.one_in(2) { 1.0 } else { -1.0 };
        match self.random.bits() % 8 {
            0..=2 => 0.0,
            3 => sign * 5e-324,
            _ => sign * self.magnitude(),
        }
    }

    fn state(&mut self) -> State {
        State { position: self.number(), velocity: self.number(), acceleration: self.number() }
    }

    fn bounds(&mut self) -> BoundsSpec {
        let (max_velocity, max_acceleration) = (self.magnitude(), self.magnitude());
        let min_velocity = match self.random.bits() % 4 {
            0 => -self.magnitude(),
            1 => 0.0,
            _ => -max_velocity,
        };
        let min_acceleration = if self.one_in(2) { -self.magnitude() } else { -max_acceleration };
        BoundsSpec {
            min_velocity,
            max_velocity,
            min_acceleration,
            max_acceleration,
            max_jerk: self.magnitude(),
        }
    }

    /// Mostly one that the bounds allow.
    fn goal(&mut self, bounds: &BoundsSpec) -> State {
        let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } = *bounds;
        let mut goal = self.state();
        if self.one_in(16) {
            return goal;
        }
        goal.velocity = goal.velocity.clamp(min_velocity, max_velocity);
        let room = (max_velocity - goal.velocity).min(goal.velocity - min_velocity);
        let most = (2.0 * max_jerk * room).sqrt() * (1.0 - 1e-12);
        goal.acceleration = goal.acceleration.clamp(min_acceleration, max_acceleration).clamp(-most, most);
        goal
    }

    fn transfer(&mut self) -> Option<Transfer> {
        let bounds = self.bounds();
        let (start, goal) = (self.state(), self.goal(&bounds));
        Transfer::new(start, goal, bounds.try_into().unwrap()).ok()
    }

    fn within_limits(&mut self) -> (State, State, LimitsSpec) {
        let bounds = self.bounds();
        let limits = LimitsSpec {
            max_velocity: bounds.max_velocity,
            max_velocity_reverse: Some(-bounds.min_velocity),
            max_acceleration: bounds.max_acceleration,
            max_deceleration: Some(-bounds.min_acceleration),
            max_jerk: bounds.max_jerk,
            ..LimitsSpec::default()
        };
        let lower = bounds.max_acceleration.min(-bounds.min_acceleration);
        let goal = self.goal(&BoundsSpec { max_acceleration: lower, min_acceleration: -lower, ..bounds });
        let inside = self.one_in(2);
        let start = if inside {
            self.goal(&BoundsSpec { max_acceleration: lower, min_acceleration: -lower, ..bounds })
        } else {
            self.state()
        };
        (start, goal, limits)
    }

    fn timing(&mut self) -> Timing {
        let minimum_duration = if self.one_in(2) { 0.0 } else { self.magnitude() };
        let end_on = self.one_in(2).then_some(CycleTime::MILLISECOND);
        Timing { minimum_duration, end_on }
    }
}

#[track_caller]
fn legal(planned: &Transit, asked: &Transfer) {
    assert!(planned.duration() <= LONGEST, "{asked:?}: {planned:?}");
    let has_digits = |state: State| {
        let time = state.acceleration.abs() / asked.bounds().spec().max_jerk;
        is_normal(state) && (time == 0.0 || time >= LEAST_TIME)
    };
    if !(has_digits(asked.start()) && has_digits(asked.goal())) {
        return;
    }
    let found = transfer_violations(&planned.to_profile(), asked.bounds(), asked.goal());
    assert_eq!(found, [], "{asked:?}: {planned:?}");
}

/// The judge of limits lets nothing begin beyond them; what does, a plan's certificate says.
#[track_caller]
fn legal_within(planned: &Transit, start: State, goal: State, limits: &Limits) {
    assert!(planned.duration() <= LONGEST, "{start:?} to {goal:?} within {limits:?}: {planned:?}");
    let lower = limits.acceleration().min(limits.deceleration());
    let swept = 0.5 * start.acceleration * start.acceleration / limits.jerk();
    let begins_inside = start.acceleration.abs() <= lower
        && start.velocity + swept <= limits.velocity_forward()
        && start.velocity - swept >= -limits.velocity_reverse();
    if begins_inside && is_normal(start) && is_normal(goal) {
        let mut found = violations(&planned.to_profile(), limits, goal);
        // It holds the lesser of two limits to 1e-9 of itself, but the end of a piece under the greater is known to an ulp of that.
        let greatest = |part: fn(&State) -> f64| {
            let ends = planned.segments().into_iter().flat_map(|segment| [segment.start, segment.end()]);
            ends.fold(0.0, |most: f64, state| most.max(part(&state).abs()))
        };
        found.retain(|violation| {
            let Violation::Limit(LimitCheck { quantity, limit, extremum, .. }) = violation else {
                return true;
            };
            let largest = match quantity {
                Quantity::Velocity => greatest(|state| state.velocity),
                Quantity::Acceleration => greatest(|state| state.acceleration),
                _ => 0.0,
            };
            extremum.abs() - limit > 64.0 * f64::EPSILON * largest
        });
        assert_eq!(found, [], "{start:?} to {goal:?} within {limits:?}: {planned:?}");
    }
}

/// What is below the normal numbers has no digits to be judged by.
fn is_normal(state: State) -> bool {
    let State { position, velocity, acceleration } = state;
    ![position, velocity, acceleration].into_iter().any(f64::is_subnormal)
}

#[derive(Default)]
struct Tally {
    asked: u32,
    answered: u32,
    without_digits: u32,
}

impl Tally {
    fn count<T>(&mut self, answer: Result<T, &[planner::InvalidField]>) -> Option<T> {
        self.asked += 1;
        match answer {
            Ok(answer) => {
                self.answered += 1;
                Some(answer)
            }
            Err(refused) => {
                let digits = |one: &planner::InvalidField| matches!(one.why, Why::NotImplemented { .. });
                self.without_digits += u32::from(refused.iter().any(digits));
                None
            }
        }
    }
}

/// One axis: the fastest, those of other durations, and the way to a velocity.
fn one_axis(count: u32, seed: u64, decades: f64) {
    let mut wide = Wide { random: Random(seed), decades };
    let (mut fastest, mut slowest) = (Slowest::default(), Slowest::default());
    let mut tally = Tally::default();
    for _ in 0..count {
        let Some(asked) = wide.transfer() else { continue };
        let bounds: Bounds = *asked.bounds();
        let to = wide.number().clamp(bounds.spec().min_velocity, bounds.spec().max_velocity);
        if let Ok(planned) = plan_velocity(asked.start(), to, bounds) {
            assert!(planned.duration() <= LONGEST, "{asked:?} to {to}");
        }
        let planned = fastest.asked(|| plan_transfer(&asked));
        let Some(planned) = tally.count(planned.as_ref().map_err(|refused| refused.as_slice())) else {
            continue;
        };
        legal(planned, &asked);
        let axis = AxisTransfer::from(asked);
        let arrivals = slowest.asked(|| axis.arrivals()).unwrap();
        let least = arrivals.least();
        let borders = arrivals.blocked().iter().flat_map(|blocked| [blocked.after, blocked.before]);
        let others = [0.5 * least, 2.0 * least, 1e9 * least, wide.magnitude()];
        for duration in [LONGEST, f64::INFINITY] {
            let endless = slowest.asked(|| axis.lasting(duration));
            assert_eq!(duration == f64::INFINITY, matches!(endless, Err(NoSuchDuration::NotFinite { .. })));
        }
        for duration in borders.chain(others) {
            if let Ok(planned) = slowest.asked(|| axis.lasting(duration)) {
                legal(&planned, &asked);
                let late = (planned.duration() - duration).abs();
                // Below the normal numbers there is no relative rounding.
                let rounding = 4.0 * f64::EPSILON * duration + f64::MIN_POSITIVE;
                assert!(late <= rounding, "{late} late: {asked:?} in {duration}");
            }
        }
    }
    let Tally { asked, answered, without_digits } = tally;
    println!(
        "one axis, ±{decades} decades: of {asked}, {answered} answered, {without_digits} refused for want of digits; at most {:.1} µs, and {:.1} \
         µs of a given duration",
        1e6 * fastest.seconds,
        1e6 * slowest.seconds
    );
    assert!(answered * 20 > asked);
}

/// Speeding up unlike slowing down.
fn one_axis_within_limits(count: u32, seed: u64, decades: f64) {
    let mut wide = Wide { random: Random(seed), decades };
    let mut slowest = Slowest::default();
    let mut tally = Tally::default();
    for _ in 0..count {
        let (start, goal, limits) = wide.within_limits();
        let limits = Limits::try_from(limits).unwrap();
        let planned = slowest.asked(|| plan_between(start, goal, &limits));
        if let Some(planned) = tally.count(planned.as_ref().map_err(|refused| refused.as_slice())) {
            legal_within(planned, start, goal, &limits);
            let duration = wide.magnitude() * planned.duration();
            let axis = AxisTransfer::within_limits(start, goal, &limits).unwrap();
            match slowest.asked(|| axis.lasting(duration)) {
                Ok(planned) => legal_within(&planned, start, goal, &limits),
                Err(NoSuchDuration::Blocked { after, before, .. }) => assert!(after <= before),
                Err(_) => {}
            }
        }
    }
    let Tally { asked, answered, without_digits } = tally;
    println!(
        "within limits, ±{decades} decades: of {asked}, {answered} answered, {without_digits} refused for want of digits; at most {:.1} µs",
        1e6 * slowest.seconds
    );
    assert!(answered * 20 > asked);
}

/// On a line an axis has no more jerk than its share of what all of them can give it, and is led back by that.
fn on_line(asked: &Transfer, all: &[Transfer]) -> Option<Transfer> {
    // On a line all of these are in proportion; some may be zero for all.
    let parts: [fn(&Transfer) -> f64; 5] = [
        |one| (one.goal().position - one.start().position).abs(),
        |one| one.start().velocity.abs(),
        |one| one.start().acceleration.abs(),
        |one| one.goal().velocity.abs(),
        |one| one.goal().acceleration.abs(),
    ];
    let share = parts.into_iter().find(|part| all.iter().any(|one| part(one) > 0.0))?;
    let jerks =
        all.iter().filter(|one| share(one) > 0.0).map(|one| one.bounds().spec().max_jerk / share(one));
    let spec = *asked.bounds().spec();
    let max_jerk = spec.max_jerk.min(share(asked) * jerks.fold(f64::INFINITY, f64::min));
    let bounds = Bounds::try_from(BoundsSpec { max_jerk, ..spec }).ok()?;
    Transfer::new(asked.start(), asked.goal(), bounds).ok()
}

fn several_axes(count: u32, seed: u64, decades: f64) {
    let mut wide = Wide { random: Random(seed), decades };
    let mut slowest = Slowest::default();
    let mut tally = Tally::default();
    for _ in 0..count {
        let axes = 1 + (wide.random.bits() % 6) as usize;
        let mut drawn: Vec<Transfer> = Vec::new();
        while drawn.len() < axes {
            // An axis that moves at all, so that several of them do.
            drawn.extend(wide.transfer().filter(|asked| plan_transfer(asked).is_ok()));
        }
        let first = drawn[0];
        if wide.one_in(4) {
            // On a line, with limits of their own.
            for one in &mut drawn[1..] {
                let share = wide.random.between(-1.0, 1.0);
                let of = |state: State| State {
                    position: share * state.position,
                    velocity: share * state.velocity,
                    acceleration: share * state.acceleration,
                };
                *one = Transfer::new(of(first.start()), of(first.goal()), *one.bounds())
                    .or(Transfer::new(of(first.start()), of(first.goal()), *first.bounds()))
                    .unwrap_or(*one);
            }
        }
        let asked: Vec<AxisTransfer<'_>> = drawn.iter().copied().map(AxisTransfer::from).collect();
        let timing = wide.timing();
        for how in [Synchronization::None, Synchronization::Time, Synchronization::Phase] {
            let answer = slowest.asked(|| {
                let mut transits = Vec::with_capacity(axes);
                together(&asked, how, timing, &mut transits).map(|agreed| (agreed, transits))
            });
            let Some((agreed, transits)) = tally.count(answer.as_ref().map_err(|refused| refused.as_slice()))
            else {
                continue;
            };
            assert!(agreed.duration <= LONGEST && agreed.duration >= timing.minimum_duration * (1.0 - 1e-15));
            for (transit, asked) in transits.iter().zip(&drawn) {
                let on_line = (how == Synchronization::Phase).then(|| on_line(asked, &drawn)).flatten();
                legal(transit, &on_line.unwrap_or(*asked));
            }
        }
    }
    let Tally { asked, answered, without_digits } = tally;
    println!(
        "several axes, ±{decades} decades: of {asked}, {answered} answered, {without_digits} refused for want of digits; at most {:.1} µs",
        1e6 * slowest.seconds
    );
    assert!(answered * 50 > asked);
}

/// New targets in motion: setpoints stay numbers.
fn generators(count: u32, seed: u64, decades: f64) {
    let mut wide = Wide { random: Random(seed), decades };
    let mut slowest = Slowest::default();
    let (mut taken, mut asked) = (0, 0);
    for _ in 0..count {
        let limits =
            AxisLimits { velocity: wide.magnitude(), acceleration: wide.magnitude(), jerk: wide.magnitude() };
        let mut generator = Generator::new(limits, CycleTime::MILLISECOND).unwrap();
        for _ in 0..4 {
            let target = wide.number();
            let mut next = generator.clone();
            let answer = slowest.asked(|| generator.clone().set_target(target));
            assert_eq!(answer, next.set_target(target));
            asked += 1;
            taken += u32::from(answer.is_ok());
            generator = next;
            for _ in 0..wide.random.bits() % 8 {
                let setpoint = generator.step();
                assert!(
                    setpoint.position.is_finite()
                        && setpoint.velocity.abs() <= limits.velocity * (1.0 + 1e-12)
                        && setpoint.acceleration.abs() <= limits.acceleration * (1.0 + 1e-12)
                        && setpoint.jerk.abs() <= limits.jerk,
                    "{setpoint:?} within {limits:?} to {target}"
                );
            }
        }
    }
    println!(
        "generator, ±{decades} decades: {taken} of {asked} targets taken; at most {:.1} µs",
        1e6 * slowest.seconds
    );
    assert!(taken * 4 > asked);
}

fn opened(wide: &mut Wide) -> Option<Motion> {
    let axes = 1 + (wide.random.bits() % 3) as usize;
    let one = |wide: &mut Wide, name: &str| {
        let (start, goal, limits) = wide.within_limits();
        let resting = wide.one_in(2);
        let rested = |state: State| if resting { State::at_rest(state.position) } else { state };
        AxisMoveSpec {
            axis: name.into(),
            kind: Ok(AxisKind::Prismatic),
            start: rested(start),
            goal: rested(goal),
            limits,
        }
    };
    let spec = RequestSpec {
        axes: NAMES.iter().take(axes).map(|name| one(wide, name)).collect(),
        cycle_time_ns: Some(1_000_000),
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::NearestVelocity),
        synchronization: Ok(if wide.one_in(2) { Synchronization::Time } else { Synchronization::None }),
        minimum_duration: None,
        end_on_cycle: wide.one_in(3),
    };
    let plan = planner::plan(&Request::try_from(spec).ok()?).ok()?;
    Motion::open(Judged::new(plan).accepted().ok()?).ok()
}

/// Operations on a motion, and its time: whatever they answer has passed the judge.
fn operations(count: u32, seed: u64, decades: f64) {
    let mut wide = Wide { random: Random(seed), decades };
    let (mut splices, mut retimes) = (Slowest::default(), Slowest::default());
    let (mut motions, mut asked, mut answered) = (0, 0, 0);
    for _ in 0..count {
        let Some(mut motion) = opened(&mut wide) else { continue };
        motions += 1;
        let at = motion.plan().duration() * wide.random.unit();
        let factor = [0.0, 0.5, 1e-9][wide.random.bits() as usize % 3];
        if let Ok(retimed) = retimes.asked(|| retime(motion.plan(), &TimeLaw::of(motion.plan()), at, factor))
        {
            assert!(certify(retimed.plan().plan()).passed());
        }
        for _ in 0..3 {
            let last = motion.last_cycle().min(LAST_CYCLE);
            let cycle =
                motion.from_cycle() + (last - motion.from_cycle()).min(wide.random.bits() % (last + 2));
            let operation = match wide.random.bits() % 4 {
                0 => Operation::Hold,
                1 => Operation::Stop,
                2 => Operation::Override(Override::new(wide.random.unit()).unwrap()),
                _ => Operation::Retarget(vec![AxisGoal {
                    axis: NAMES[0].into(),
                    goal: State::at_rest(wide.number()),
                    limits: None,
                }]),
            };
            asked += 1;
            if let Ok(spliced) = splices.asked(|| motion.splice(cycle, &operation)) {
                answered += 1;
                assert!(certify(spliced.motion.plan()).passed());
                motion = spliced.motion;
            }
        }
    }
    println!(
        "operations, ±{decades} decades: {answered} of {asked} on {motions} motions; at most {:.1} µs, and {:.1} µs to retime",
        1e6 * splices.seconds,
        1e6 * retimes.seconds
    );
    assert!(motions > 10 && answered * 4 > asked);
}

const DECADES: [f64; 5] = [3.0, 10.0, 20.0, 30.0, 60.0];

#[test]
fn of_one_axis() {
    for decades in DECADES {
        one_axis(4_000, 7, decades);
        one_axis_within_limits(2_000, 8, decades);
    }
}

#[test]
fn of_several_axes() {
    for decades in DECADES {
        several_axes(500, 9, decades);
    }
}

#[test]
fn of_generators() {
    for decades in DECADES {
        generators(1_000, 10, decades);
    }
}

#[test]
fn of_operations() {
    for decades in DECADES {
        operations(300, 11, decades);
    }
}

#[test]
#[ignore = "a minute in release"]
fn of_many() {
    for decades in DECADES {
        one_axis(200_000, 17, decades);
        one_axis_within_limits(100_000, 18, decades);
        several_axes(20_000, 19, decades);
        generators(50_000, 20, decades);
        operations(10_000, 21, decades);
    }
}
