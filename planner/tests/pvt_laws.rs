//! What holds for every command of position, velocity and time, and for every sequence of them.

#![allow(clippy::float_cmp, reason = "what is kept is kept to the last bit")]
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use planner::{
    InvalidFields, Limits, LimitsSpec, PvtMove, PvtPlanner, PvtPolicy, PvtTarget, Quantity, Segment, State,
    Why, violations,
};
use proptest::prelude::*;

/// A command from position zero, with limits.
#[derive(Clone, Debug)]
struct Case {
    start: f64,
    end: f64,
    duration: f64,
    /// Where the displacement lies between the extremes, 0 to 1; drawn apart from them, since they depend on the rest.
    part: f64,
    limits: LimitsSpec,
}

impl Case {
    fn limits(&self) -> Limits {
        self.limits.clone().try_into().unwrap()
    }

    fn plan(&self, displacement: f64, policy: PvtPolicy) -> Result<PvtMove, InvalidFields> {
        let start = State { velocity: self.start, ..State::default() };
        let target = PvtTarget { position: displacement, velocity: self.end, duration: self.duration };
        PvtPlanner::new(start, self.limits(), policy)?.command(target)
    }

    /// What can be reached, if there is time for the velocity.
    fn range(&self) -> Option<(f64, f64)> {
        match self.plan(1e30, PvtPolicy::Reject).unwrap_err().as_slice()[0].why {
            Why::PvtOutOfReach { least, greatest, .. } => Some((least, greatest)),
            _ => None,
        }
    }

    fn displacement(&self) -> Option<f64> {
        self.range().map(|(low, high)| low + self.part * (high - low))
    }

    /// The greatest velocities, backward and forward, signed.
    fn velocities(&self) -> [f64; 2] {
        let limits = &self.limits;
        [-limits.max_velocity_reverse.unwrap_or(limits.max_velocity), limits.max_velocity]
    }

    fn deceleration(&self) -> f64 {
        self.limits.max_deceleration.unwrap_or(self.limits.max_acceleration)
    }

    /// The limit of acceleration on the way from one velocity to another of a motion: one that turns back keeps to the smaller.
    fn limit(&self, planned: &PvtMove, from: f64, to: f64) -> f64 {
        let (acceleration, deceleration) = (self.limits.max_acceleration, self.deceleration());
        if course(planned) == Course::BothWays {
            acceleration.min(deceleration)
        } else if to.abs() > from.abs() {
            acceleration
        } else {
            deceleration
        }
    }

    fn limit_over(&self, planned: &PvtMove, segment: &Segment) -> f64 {
        self.limit(planned, segment.start.velocity, segment.end().velocity)
    }

    fn fastest(&self) -> f64 {
        self.limits.max_velocity.max(self.limits.max_velocity_reverse.unwrap_or(0.0))
    }

    /// The longest way of the command.
    fn scale(&self) -> f64 {
        self.fastest() * self.duration
    }

    fn mirrored(&self) -> Self {
        let reverse = self.limits.max_velocity_reverse.unwrap_or(self.limits.max_velocity);
        let limits = LimitsSpec {
            max_velocity: reverse,
            max_velocity_reverse: Some(self.limits.max_velocity),
            ..self.limits.clone()
        };
        Self { start: -self.start, end: -self.end, limits, ..self.clone() }
    }

    fn scaled(&self, length: f64, time: f64) -> Self {
        let velocity = length / time;
        let spec = &self.limits;
        let limits = LimitsSpec {
            max_velocity: spec.max_velocity * velocity,
            max_velocity_reverse: spec.max_velocity_reverse.map(|limit| limit * velocity),
            max_acceleration: spec.max_acceleration * (velocity / time),
            max_deceleration: spec.max_deceleration.map(|limit| limit * (velocity / time)),
            max_jerk: spec.max_jerk * (velocity / time / time),
            ..spec.clone()
        };
        Self {
            start: self.start * velocity,
            end: self.end * velocity,
            duration: self.duration * time,
            limits,
            part: self.part,
        }
    }
}

/// Which way a motion travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Course {
    Forward,
    Backward,
    BothWays,
}

fn course(planned: &PvtMove) -> Course {
    let segments = planned.motion().segments();
    let velocities = || segments.iter().flat_map(|segment| [segment.start.velocity, segment.end().velocity]);
    let fastest = velocities().fold(0.0, |most: f64, velocity| most.max(velocity.abs()));
    // A rounded zero goes in no direction.
    let goes = |sign: f64| velocities().any(|velocity| sign * velocity > 1e-12 * fastest);
    match (goes(1.0), goes(-1.0)) {
        (true, true) => Course::BothWays,
        (false, true) => Course::Backward,
        (_, false) => Course::Forward,
    }
}

/// A change of velocity at one go.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    from: f64,
    to: f64,
    time: f64,
    /// The greatest of it, a magnitude.
    jerk: f64,
}

/// The ramps of a motion, from pieces that begin without acceleration to the next that do.
fn ramps(planned: &PvtMove) -> Vec<Ramp> {
    let mut ramps: Vec<Ramp> = Vec::new();
    for segment in planned.motion().segments() {
        let (setpoint, to) = (segment.at(0.0), segment.end().velocity);
        let (from, jerk) = (segment.start.velocity, setpoint.jerk.abs());
        if setpoint.state.acceleration == 0.0 {
            ramps.push(Ramp { from, to, time: segment.duration, jerk });
        } else if let Some(ramp) = ramps.last_mut() {
            *ramp = Ramp { to, time: ramp.time + segment.duration, jerk: ramp.jerk.max(jerk), ..*ramp };
        }
    }
    ramps.retain(|ramp| ramp.jerk > 0.0);
    ramps
}

/// The greatest change of velocity in a time.
fn change_in(time: f64, acceleration: f64, jerk: f64) -> f64 {
    if time <= 2.0 * acceleration / jerk {
        0.25 * jerk * time * time
    } else {
        acceleration * (time - acceleration / jerk)
    }
}

/// A part of the range: its ends, its middle, beside them, anywhere.
fn part() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => 0.0..=1.0f64,
        2 => prop::sample::select(vec![0.0, 1.0, 0.5, 0.25, 1e-12, 1.0 - 1e-12, 1e-6]),
        1 => (-12.0..0.0f64).prop_map(|exponent| 10f64.powf(exponent)),
    ]
}

/// Times from far too short over the very least one to far more than enough; velocities that are equal, nearly equal, zero, at
/// a limit or opposed; one-way axes; decelerations of their own.
fn any_case() -> impl Strategy<Value = Case> {
    let limits = (-3.0..3.0f64, -3.0..3.0f64, -2.0..2.0f64, 0..6u32, 0..5u32, 0.05..3.0f64);
    let ends = (0..8u32, 0..9u32, -1.0..=1.0f64, -1.0..=1.0f64);
    let time = (0..6u32, -1.5..1.5f64, -3..=3i32);
    (limits, ends, time, part()).prop_map(|(limits, ends, time, part)| {
        let (v, a, corner, one_way, other, ratio) = limits;
        let (v, a) = (10f64.powf(v), 10f64.powf(a));
        let jerk = a * a / v * 10f64.powf(corner);
        let max_velocity_reverse = match one_way {
            0 => Some(0.0),
            1 => Some(v * ratio),
            _ => None,
        };
        let reverse = max_velocity_reverse.unwrap_or(v);
        let max_deceleration = match other {
            0 => Some(a * ratio),
            1 => Some(a * ratio.powi(4)),
            _ => None,
        };
        let velocity = |kind: u32, part: f64, other: f64| {
            let velocity = match kind {
                0 => 0.0,
                1 => v,
                2 => -reverse,
                3 => other,
                4 => other * (1.0 + 1e-9 * part),
                5 => -other,
                6 => other + a * a / jerk * part,
                _ => v * part,
            };
            velocity.clamp(-reverse, v)
        };
        let (start_kind, end_kind, start_part, end_part) = ends;
        let start = velocity(start_kind, start_part, v * end_part);
        let end = velocity(end_kind, end_part, start);
        let (kind, exponent, ulps) = time;
        let slowest = max_deceleration.unwrap_or(a).min(a);
        let least = common::ramp_time((end - start).abs(), slowest, jerk);
        let natural = v / a + a / jerk;
        let duration = match kind {
            0 if least > 0.0 => common::nudged(least, ulps),
            1 if least > 0.0 => least * (1.0 + 10f64.powf(4.0 * exponent - 6.0)),
            2 if least > 0.0 => least * 10f64.powf(exponent),
            3 => 2.0 * a / jerk,
            _ => natural * 10f64.powf(exponent),
        };
        let limits = LimitsSpec {
            max_velocity: v,
            max_velocity_reverse,
            max_acceleration: a,
            max_deceleration,
            max_jerk: jerk,
            ..LimitsSpec::default()
        };
        Case { start, end, duration, part, limits }
    })
}

#[track_caller]
fn legal(case: &Case, planned: &PvtMove) {
    let motion = planned.motion();
    assert_eq!(violations(&motion.to_profile(), &case.limits(), motion.reached()), [], "{case:?}");
    let duration = motion.duration();
    let wanted = motion
        .adjustments()
        .iter()
        .find(|said| said.quantity == Quantity::Time)
        .map_or(case.duration, |said| said.planned);
    assert!((duration - wanted).abs() <= 1e-14 * wanted, "{case:?}: lasts {duration}, not {wanted}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, ..ProptestConfig::default() })]

    /// Whatever lies between the extremes is driven as asked, within the limits.
    #[test]
    fn what_can_be_reached_is_reached(case in any_case()) {
        let Some(displacement) = case.displacement() else { return Ok(()) };
        let planned = case.plan(displacement, PvtPolicy::Reject);
        prop_assert!(planned.is_ok(), "{planned:?}");
        let planned = planned.unwrap();
        let end = State { position: displacement, velocity: case.end, acceleration: 0.0 };
        prop_assert_eq!(planned.motion().reached(), end);
        prop_assert!(planned.motion().adjustments().is_empty());
        legal(&case, &planned);
    }

    /// Beyond the extremes nothing is: every ramp of theirs is at the limit of jerk, and where it is held, at that of acceleration;
    /// a cruise is at a limit of velocity. Just outside is refused.
    #[test]
    fn the_range_is_tight(case in any_case()) {
        let Some((low, high)) = case.range() else { return Ok(()) };
        for (extreme, outward) in [(low, -1.0), (high, 1.0)] {
            let beyond = extreme + outward * 1e-9 * case.scale();
            let refusal = case.plan(beyond, PvtPolicy::Reject).unwrap_err();
            let Why::PvtOutOfReach { least, greatest, .. } = refusal.as_slice()[0].why else {
                panic!("{refusal}");
            };
            prop_assert_eq!((least, greatest), (low, high));
            let planned = case.plan(extreme, PvtPolicy::Reject).unwrap();
            legal(&case, &planned);
            let change = (case.end - case.start).abs();
            for segment in planned.motion().segments() {
                let setpoint = segment.at(0.0);
                // Ramps over what rounding leaves of a velocity say nothing.
                let span = (segment.end().velocity - setpoint.state.velocity).abs();
                let tells = span > 1e-6 * case.fastest() && (change == 0.0 || span > 1e-6 * change);
                if tells && setpoint.jerk != 0.0 {
                    let jerk = setpoint.jerk.abs() / case.limits.max_jerk;
                    prop_assert!((jerk - 1.0).abs() < 1e-6, "{jerk} of the jerk in {segment:?}");
                }
                if tells && setpoint.jerk == 0.0 {
                    let acceleration = setpoint.state.acceleration.abs() / case.limit_over(&planned, &segment);
                    prop_assert!((acceleration - 1.0).abs() < 1e-6, "{acceleration} of it in {segment:?}");
                }
                let cruises = setpoint.jerk == 0.0 && setpoint.state.acceleration == 0.0;
                // In the very least time what is left for a cruise is a rounding.
                if cruises && high - low > 1e-6 * case.scale() && segment.duration > 1e-3 * case.duration {
                    let velocity = setpoint.state.velocity;
                    let [back, ahead] = case.velocities();
                    let mut at_limit = [back, ahead].iter().any(|limit| (velocity - limit).abs() < 1e-9 * case.fastest());
                    // One way it waits at the end of its lane; see the note.
                    at_limit |= case.limits.max_deceleration.is_some() && velocity.abs() < 1e-12 * case.fastest();
                    prop_assert!(at_limit, "cruises at {velocity}");
                }
            }
        }
    }

    /// The velocities that a time leads to: the last of them is taken, with every ramp at a limit; just outside is refused.
    #[test]
    fn the_velocities_of_a_time_are_tight(case in any_case(), upwards: bool) {
        let sign = if upwards { 1.0 } else { -1.0 };
        let one_way = sign * case.start >= 0.0;
        let acceleration = if one_way { case.limits.max_acceleration } else { case.deceleration() };
        let change = change_in(case.duration, acceleration, case.limits.max_jerk);
        let [back, ahead] = case.velocities();
        let to = case.start + sign * change;
        // Where the direction of travel changes another limit holds.
        let in_lane = one_way || sign * to <= 0.0;
        if to < back || to > ahead || !in_lane || change < 1e-6 * case.fastest() {
            return Ok(());
        }
        let ending_at = |change: f64| Case { end: case.start + sign * change, ..case.clone() };
        let (inside, outside) = (ending_at(change * (1.0 - 1e-8)), ending_at(change * (1.0 + 1e-8)));
        let mean = 0.5 * (inside.start + inside.end) * case.duration;
        let (low, high) = inside.range().unwrap();
        prop_assert!((mean - low).abs() <= 1e-6 * case.scale() && (mean - high).abs() <= 1e-6 * case.scale());
        let planned = inside.plan(mean, PvtPolicy::PreferVelocity).unwrap();
        prop_assert_eq!(planned.motion().reached().velocity, inside.end);
        legal(&inside, &planned);
        if outside.end >= back && outside.end <= ahead {
            let refusal = outside.plan(mean, PvtPolicy::Reject).unwrap_err();
            let too_short = matches!(refusal.as_slice()[0].why, Why::PvtTimeTooShort { .. });
            prop_assert!(too_short, "{refusal}");
        }
    }

    /// Each ramp of a motion is the gentlest that changes the velocity by as much in its time: at the peak of jerk that
    /// note 0008 gives for it, and with less of it the time would not suffice.
    #[test]
    fn ramps_are_the_gentlest(case in any_case()) {
        let Some(displacement) = case.displacement() else { return Ok(()) };
        let planned = case.plan(displacement, PvtPolicy::Reject).unwrap();
        for ramp in ramps(&planned) {
            let change = (ramp.to - ramp.from).abs();
            // What rounding leaves of two velocities says nothing of a ramp between them.
            if change < 1e-6 * case.fastest() {
                continue;
            }
            let limit = case.limit(&planned, ramp.from, ramp.to);
            let peak = if 2.0 * change / ramp.time <= limit {
                4.0 * change / (ramp.time * ramp.time)
            } else {
                limit / (ramp.time - change / limit)
            };
            // Near the least time of a ladder its jerk is the inverse of a small difference.
            let spare = (ramp.time - change / limit).abs() / ramp.time;
            let known = 1e-9 / if 2.0 * change / ramp.time <= limit { 1.0 } else { spare.min(1.0) };
            prop_assert!((ramp.jerk / peak - 1.0).abs() <= known, "{ramp:?}: {peak}");
            prop_assert!(ramp.jerk <= case.limits.max_jerk * (1.0 + 1e-9));
            // With less of jerk the time leads to less, where the jerk is much of the ramp.
            if limit * limit / ramp.jerk > 1e-6 * change {
                let less = change_in(ramp.time, limit, 0.99 * ramp.jerk);
                prop_assert!(less < change, "{ramp:?}: {less} with less jerk");
            }
        }
    }

    /// Where no end velocity reaches the position, the one comes nearest that is taken.
    #[test]
    fn the_velocity_for_a_position_comes_nearest(case in any_case(), factor in -3.0..3.0f64, others in prop::collection::vec(0.0..=1.0f64, 8)) {
        let way = factor * case.scale();
        let planned = case.plan(way, PvtPolicy::PreferPosition).unwrap();
        let reached = planned.motion().reached();
        legal(&case, &planned);
        let missed = (reached.position - way).abs();
        if missed == 0.0 {
            return Ok(());
        }
        let [back, ahead] = case.velocities();
        let ends = [reached.velocity, case.start, case.end, back, ahead];
        let near = ends.into_iter().flat_map(|end| [0.0, 1e-6, -1e-6, 1e-2, -1e-2].map(|part| end + part * case.fastest()));
        let far = others.into_iter().map(|part| back + part * (ahead - back));
        for end in near.chain(far).map(|end| end.clamp(back, ahead)) {
            let Some((low, high)) = (Case { end, ..case.clone() }).range() else { continue };
            let other = (way - high).max(low - way);
            prop_assert!(missed <= other + 1e-9 * case.scale(), "{other} with {end}, {missed} with {}", reached.velocity);
        }
    }

    /// A greater displacement is faster at every instant, by no more than its difference in all. So the motion does not
    /// jump from region to region; with two limits of acceleration, as long as both motions travel one way, or neither does.
    #[test]
    fn regions_join(case in any_case(), other in part()) {
        let Some((low, high)) = case.range() else { return Ok(()) };
        let at = |part: f64| low + part * (high - low);
        let (less, more) = (at(case.part.min(other)), at(case.part.max(other)));
        let (slow, fast) = (case.plan(less, PvtPolicy::Reject).unwrap(), case.plan(more, PvtPolicy::Reject).unwrap());
        if case.limits.max_deceleration.is_some() && course(&slow) != course(&fast) {
            // Between two lanes the way changes: note 0008 says why it cannot but do so.
            return Ok(());
        }
        let slack = 1e-12 * case.scale();
        for cycle in 0..=40 {
            let t = case.duration * f64::from(cycle) / 40.0;
            let ahead = fast.at(t).state.position - slow.at(t).state.position;
            prop_assert!(ahead >= -slack && ahead <= more - less + slack, "{ahead} of {} at {t}", more - less);
        }
    }

    #[test]
    fn a_mirrored_command_mirrors_the_motion(case in any_case(), policy in 0..3usize) {
        if case.limits.max_velocity_reverse == Some(0.0) {
            // No axis may only go backwards.
            return Ok(());
        }
        let Some(displacement) = case.displacement() else { return Ok(()) };
        let policy = [PvtPolicy::PreferVelocity, PvtPolicy::PreferPosition, PvtPolicy::ExtendTime][policy];
        for displacement in [displacement, 1.5 * displacement] {
            let (planned, mirrored) = (case.plan(displacement, policy), case.mirrored().plan(-displacement, policy));
            let (planned, mirrored) = (planned.unwrap(), mirrored.unwrap());
            prop_assert_eq!(planned.motion().segments().len(), mirrored.motion().segments().len());
            for (a, b) in planned.motion().segments().iter().zip(mirrored.motion().segments()) {
                prop_assert_eq!((a.duration, a.start), (b.duration, b.start.mirrored()));
            }
        }
    }

    /// In units that are powers of four and of sixty-four apart every digit is the same.
    #[test]
    fn another_unit_changes_no_digit(case in any_case(), length in -20..20i32, time in -5..5i32) {
        let (length, time) = (4f64.powi(length), 4f64.powi(time));
        let scaled = case.scaled(length, time);
        let Some(displacement) = case.displacement() else { return Ok(()) };
        for (displacement, policy) in [
            (displacement, PvtPolicy::Reject),
            (2.0 * displacement, PvtPolicy::PreferVelocity),
        ] {
            let planned = case.plan(displacement, policy).unwrap();
            let other = scaled.plan(displacement * length, policy).unwrap();
            prop_assert_eq!(planned.region(), other.region());
            for (a, b) in planned.motion().segments().iter().zip(other.motion().segments()) {
                prop_assert_eq!(a.duration * time, b.duration);
                prop_assert_eq!(a.start.position * length, b.start.position);
            }
        }
    }

    /// Whatever is asked, what is planned is legal and says what it changes; and nothing nearer could be had.
    #[test]
    fn policies_change_no_more_than_they_must(case in any_case(), factor in -3.0..3.0f64) {
        let way = case.range().map_or(case.scale(), |(low, high)| low + factor * (high - low));
        // Where the range grows slowly it comes within a rounding of the way long before it holds it.
        let slack = 1e-12 * case.scale();
        let reached = |case: &Case, way: f64| {
            case.range().is_some_and(|(low, high)| way > low + slack && way < high - slack)
        };
        let steps = [1e-7, 1e-3, 0.1, 0.5, 0.9];

        let velocity = case.plan(way, PvtPolicy::PreferVelocity).unwrap();
        legal(&case, &velocity);
        let end = velocity.motion().reached();
        if end.velocity == case.end && end.position != way {
            let (low, high) = case.range().unwrap();
            prop_assert!(end.position == low || end.position == high);
        }
        if end.velocity != case.end {
            prop_assert!(case.range().is_none());
            for step in steps {
                let nearer = Case { end: end.velocity + step * (case.end - end.velocity), ..case.clone() };
                if (nearer.end - end.velocity).abs() > 1e-9 * case.fastest() {
                    prop_assert!(nearer.range().is_none(), "{} is nearer than {}", nearer.end, end.velocity);
                }
            }
        }

        let position = case.plan(way, PvtPolicy::PreferPosition).unwrap();
        legal(&case, &position);
        let end = position.motion().reached();
        if end.velocity != case.end {
            for step in steps {
                let nearer = Case { end: end.velocity + step * (case.end - end.velocity), ..case.clone() };
                if (nearer.end - end.velocity).abs() > 1e-9 * case.fastest() && end.position == way {
                    prop_assert!(!reached(&nearer, way), "{} is nearer than {}", nearer.end, end.velocity);
                }
            }
        }

        if let Ok(later) = case.plan(way, PvtPolicy::ExtendTime) {
            legal(&case, &later);
            prop_assert_eq!(later.motion().reached(), State { position: way, velocity: case.end, acceleration: 0.0 });
            let duration = later.motion().duration();
            for step in steps {
                let sooner = Case { duration: duration - step * (duration - case.duration), ..case.clone() };
                if sooner.duration < duration * (1.0 - 1e-9) && sooner.duration >= case.duration {
                    prop_assert!(!reached(&sooner, way), "{} is sooner than {duration}", sooner.duration);
                }
            }
        }
    }

    /// Where speeding up and slowing down differ, more can be reached than within the smaller of both limits.
    #[test]
    fn two_limits_reach_no_less_than_the_smaller_one(case in any_case()) {
        let smaller = case.limits.max_deceleration.unwrap_or(f64::INFINITY).min(case.limits.max_acceleration);
        let limits = LimitsSpec { max_acceleration: smaller, max_deceleration: None, ..case.limits.clone() };
        let strict = Case { limits, ..case.clone() };
        if let Some((low, high)) = strict.range() {
            let (wide_low, wide_high) = case.range().unwrap();
            prop_assert!(wide_low <= low && wide_high >= high);
        }
    }
}

/// Where a forward lane ends and the one for both ways goes on, the way changes, and its ends do not.
#[test]
fn between_two_lanes_the_way_changes() {
    let limits = LimitsSpec {
        max_velocity: 2.0,
        max_acceleration: 1.0,
        max_deceleration: Some(4.0),
        max_jerk: 20.0,
        ..LimitsSpec::default()
    };
    let case = Case { start: 1.0, end: 1.0, duration: 6.0, part: 0.0, limits };
    // Down at 4, a wait, up at 1, with ramps of 0.45 s and 1.05 s: the least way of an axis that does not turn back.
    let border = 0.5 * (0.45 + 1.05);
    let [back, on] = [-1e-9, 1e-9].map(|step| case.plan(border + step, PvtPolicy::Reject).unwrap());
    assert_eq!((course(&back), course(&on)), (Course::BothWays, Course::Forward));
    for planned in [&back, &on] {
        legal(&case, planned);
        assert!((planned.motion().reached().position - border).abs() < 2e-9);
    }
    let apart = (0..=600).map(|n| f64::from(n) / 100.0);
    let apart =
        apart.map(|t| (back.at(t).state.position - on.at(t).state.position).abs()).fold(0.0, f64::max);
    assert!(apart > 0.1 && apart < 1.0, "{apart}");
}

/// Random controls within the limits: none of them gets beyond the extremes. A second opinion on the range, which knows neither
/// ramps nor regions.
#[test]
fn no_motion_gets_beyond_the_extremes() {
    let mut random = Random(11);
    let (mut tried, mut nearest) = (0, f64::INFINITY);
    while tried < 300 {
        let start = random.between(-1.0, 1.0);
        let (acceleration, jerk) = (random.decades(0.3, 10.0), random.decades(1.0, 100.0));
        let duration = random.decades(0.1, 3.0);
        let limits = LimitsSpec {
            max_velocity: 1.5,
            max_acceleration: acceleration,
            max_jerk: jerk,
            ..LimitsSpec::default()
        };
        let Some((end, way)) = wandered(&mut random, start, duration, &limits) else { continue };
        let case = Case { start, end, duration, part: 0.0, limits };
        let (low, high) = case.range().unwrap();
        assert!(way >= low - 1e-12 && way <= high + 1e-12, "{way} is not in {low} ..= {high}: {case:?}");
        nearest = nearest.min((way - low).min(high - way) / (high - low));
        tried += 1;
    }
    // The walks come near enough to the extremes to tell.
    assert!(nearest < 0.02, "{nearest}");
}

/// Bangs of jerk that end without acceleration: the end velocity and the way.
fn wandered(random: &mut Random, start: f64, duration: f64, limits: &LimitsSpec) -> Option<(f64, f64)> {
    let mut state = State { velocity: start, ..State::default() };
    let mut left = duration;
    let pushes = 1 + random.bits() % 3;
    for push in 0..pushes {
        let room = left / (pushes - push) as f64;
        let time = room * if random.bits().is_multiple_of(2) { 1.0 } else { random.unit() };
        // A rounding less than the limit, so that no walk is a rounding beyond an extreme.
        let jerk = limits.max_jerk * (1.0 - 1e-9) * if random.bits().is_multiple_of(2) { 1.0 } else { -1.0 };
        let rise = (0.5 * time).min(limits.max_acceleration / limits.max_jerk);
        for (jerk, time) in [(jerk, rise), (0.0, time - 2.0 * rise), (-jerk, rise)] {
            state = state.after(jerk, time);
            if state.velocity.abs() > limits.max_velocity {
                return None;
            }
        }
        state.acceleration = 0.0;
        left -= time;
    }
    let state = state.after(0.0, left);
    Some((state.velocity, state.position))
}

/// A target far beyond all that can be reached, as a detection gone wrong may be: the axis goes as near as it can, within its limits, and ends
/// where the answer says.
#[test]
fn what_is_out_of_all_reach_is_approached() {
    for (duration, max_jerk) in [(0.001, 10.0), (0.001, 160.0), (0.01, 160.0), (0.05, 160.0)] {
        for exponent in 0..=40 {
            for (sign, velocity) in [(1.0, 0.0), (-1.0, 0.0), (1.0, 0.1), (-1.0, 0.1)] {
                let limits = LimitsSpec {
                    max_velocity: 0.5,
                    max_acceleration: 4.0,
                    max_jerk,
                    ..LimitsSpec::default()
                };
                let case = Case { start: velocity, end: velocity, duration, part: 0.0, limits };
                let position = sign * 10f64.powf(0.5 * f64::from(exponent));
                for policy in [PvtPolicy::PreferVelocity, PvtPolicy::PreferPosition] {
                    let planned = case.plan(position, policy).unwrap();
                    legal(&case, &planned);
                    let profile = planned.motion().to_profile();
                    let (end, reached) =
                        (profile.at(duration).state.position, planned.motion().reached().position);
                    assert!(
                        (end - reached).abs() <= 1e-12 * reached.abs(),
                        "{case:?} {position}: {end} and {reached}"
                    );
                    let nearest = if sign > 0.0 {
                        planned.greatest_displacement()
                    } else {
                        planned.least_displacement()
                    };
                    assert!(
                        policy != PvtPolicy::PreferVelocity
                            || (reached - nearest).abs() <= 1e-12 * nearest.abs()
                    );
                }
            }
        }
    }
}

/// Numbers at the ends of what is taken: every command is answered, with finite numbers, or refused.
#[test]
fn numbers_at_the_ends_of_the_range() {
    let magnitudes = [1e-60, 1e-20, 1.0, 1e20, 1e60];
    let mut planned = 0;
    for pick in 0..5usize.pow(5) {
        let at = |place: u32| magnitudes[pick / 5usize.pow(place) % 5];
        let (velocity, acceleration, jerk, duration, position) = (at(0), at(1), at(2), at(3), at(4));
        for (max_velocity_reverse, start, end) in [
            (None, 0.0, 0.0),
            (None, -velocity, velocity),
            (Some(0.0), velocity, 0.0),
            (None, velocity, 0.5 * velocity),
        ] {
            let limits = LimitsSpec {
                max_velocity: velocity,
                max_acceleration: acceleration,
                max_jerk: jerk,
                max_deceleration: Some(2.0 * acceleration),
                max_velocity_reverse,
                ..LimitsSpec::default()
            };
            // Twice the largest number is too large.
            let Ok(limits) = Limits::try_from(limits) else { continue };
            for policy in [
                PvtPolicy::PreferVelocity,
                PvtPolicy::PreferPosition,
                PvtPolicy::ExtendTime,
                PvtPolicy::Reject,
            ] {
                let start = State { velocity: start, ..State::default() };
                let mut planner = PvtPlanner::new(start, limits.clone(), policy).unwrap();
                let Ok(answer) = planner.command(PvtTarget { position, velocity: end, duration }) else {
                    continue;
                };
                let motion = answer.motion();
                assert!(motion.reached().is_finite() && motion.duration().is_finite(), "{answer:?}");
                assert!(motion.segments().iter().all(|segment| segment.at(0.0).is_finite()), "{answer:?}");
                planned += 1;
            }
        }
    }
    assert!(planned > 10_000, "{planned}");
}
