//! What holds for every problem. More of them: `PROPTEST_CASES=1000000 cargo test --release --test laws`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and bits are compared as bits"
)]

mod common;

use common::{Case, any_case, case_from_zero, feasible_case};
use planner::{
    AdjustmentReason, AxisKind, AxisPlan, Cursor, CycleTime, Law, Method, Move, Plan, Problem, Profile,
    Quantity, Segment, Setpoint, ShortPathPolicy, State, Why, certify, explain, plan_move, plan_stop,
    plan_trapezoid, violations,
};
use proptest::prelude::*;

/// Of the motion's extent [1]: the end as integrated against the end as asked.
const END: f64 = 1e-12;
/// Of a duration [1]: what two ways to the same duration may differ by.
const DURATION: f64 = 1e-12;
/// Of a speed [1]: the nearest reachable one may be the vertex of a parabola, where half of the digits are lost.
const VERTEX: f64 = 3e-8;

fn settings() -> ProptestConfig {
    let given = ProptestConfig::default();
    ProptestConfig { cases: given.cases.max(16_384), failure_persistence: None, ..given }
}

/// The plan of a case; none where its path is too short and the policy is to say so.
fn planned(case: &Case) -> Option<Move> {
    match plan_move(&case.problem()) {
        Ok(planned) => Some(planned),
        Err(refusal) => {
            assert_eq!(case.policy, ShortPathPolicy::Reject, "{refusal}");
            assert!(case.distance().abs() < case.least_length(), "{refusal}");
            assert!(matches!(refusal.as_slice()[0].why, Why::PathTooShort { .. }), "{refusal}");
            None
        }
    }
}

/// The end to be reached: the goal, but for an end velocity that the adjustments name.
fn promised(case: &Case, planned: &Move) -> State {
    let velocity = planned
        .adjustments()
        .iter()
        .find(|adjustment| adjustment.reason != AdjustmentReason::FeedRateAboveLimit)
        .map_or(case.goal.velocity, |adjustment| {
            assert_eq!(adjustment.asked, case.goal.velocity);
            adjustment.planned
        });
    State { velocity, ..case.goal }
}

fn one_axis(case: &Case, planned: &Move) -> Plan {
    let axis = AxisPlan {
        axis: "x".into(),
        kind: AxisKind::Prismatic,
        limits: case.limits(),
        profile: planned.to_profile(),
        goal: case.goal,
        adjustments: planned.adjustments().to_vec(),
        classification: planned.classification(),
        pvt_regions: Vec::new(),
    };
    let guaranteed = vec![Quantity::Velocity, Quantity::Acceleration, Quantity::Jerk];
    let cycle = CycleTime::from_ns(Some(1_000_000_000)).unwrap();
    Plan::new(Method::default(), guaranteed, cycle, vec![axis]).unwrap()
}

/// A plan of more cycles than can be counted is refused, and has a test of its own.
fn countable(planned: &Move) -> bool {
    planned.duration() < 1e14
}

fn bits(setpoint: Setpoint) -> [u64; 4] {
    setpoint.words().map(f64::to_bits)
}

fn durations(planned: &Move) -> Vec<f64> {
    planned.segments().iter().map(|segment| segment.duration).collect()
}

fn check_legal(case: &Case) {
    let Some(planned) = planned(case) else { return };
    let goal = promised(case, &planned);
    let profile = planned.to_profile();
    assert_eq!(violations(&profile, &case.limits(), goal), []);
    assert_eq!(profile.start(), case.start);
    assert_eq!(profile.end(), goal);
    // Closer than the judge asks for.
    if let Some(last) = planned.segments().last() {
        let extent = case.distance().abs();
        let farthest = case.start.position.abs().max(case.goal.position.abs());
        let off = (last.end().position - goal.position).abs();
        assert!(off <= END * extent + 2.0 * f64::EPSILON * farthest, "ends {off:e} from the goal");
        for (one, next) in planned.segments().iter().zip(&planned.segments()[1..]) {
            let jump = (one.end().position - next.start.position).abs();
            assert!(jump <= END * extent + 4.0 * f64::EPSILON * farthest, "jumps by {jump:e}");
        }
    }
}

/// Holds samples at random times against limits and against each other: neither asks where pieces begin.
fn check_samples(case: &Case, planned: &Move, parts: &[f64]) {
    let limits = case.limits();
    let direction = case.problem().direction();
    let total = planned.duration();
    let mut times: Vec<f64> = parts.iter().map(|part| part * total).collect();
    times.sort_by(f64::total_cmp);
    let samples: Vec<Setpoint> = times.iter().map(|&t| planned.at(t)).collect();
    let fastest = samples.iter().map(|sample| sample.state.velocity.abs()).fold(0.0, f64::max);
    let farthest = case.start.position.abs().max(case.goal.position.abs());
    let (cruise, hardest, jerk) = (limits.cruise_towards(direction), case.hardest(), limits.jerk());
    let beyond = 1.0 + 1e-12;
    for sample in &samples {
        let State { velocity, acceleration, .. } = sample.state;
        assert!(velocity.abs() <= cruise * beyond, "velocity {velocity} beyond {cruise}");
        assert!(velocity * direction >= -1e-13 * fastest, "turns back: {velocity}");
        let speeds_up = acceleration * direction > 0.0;
        let limit = if speeds_up { limits.acceleration() } else { limits.deceleration() };
        assert!(acceleration.abs() <= limit * beyond, "acceleration {acceleration} beyond {limit}");
        assert!(sample.jerk.abs() <= jerk * beyond, "jerk {}", sample.jerk);
    }
    for (pair, times) in samples.windows(2).zip(times.windows(2)) {
        let (from, to, step) = (pair[0].state, pair[1].state, times[1] - times[0]);
        // The trapezoidal rule, whose remainder the jerk bounds: J·h³/12 for the position and J·h²/4 for the velocity. A
        // rounding of the time is worth as much as a rounding of the whole.
        let hardest = jerk.min(hardest / total.max(1e-300) * 1e3) * total;
        let noise = 64.0 * f64::EPSILON;
        let moved = to.position - from.position - 0.5 * step * (from.velocity + to.velocity);
        let allowed = jerk * step * step * step / 12.0;
        assert!(
            moved.abs() <= allowed * 1.000_001 + noise * (farthest + fastest * total),
            "position is {moved:e} off its velocity, allowed {allowed:e}"
        );
        let sped = to.velocity - from.velocity - 0.5 * step * (from.acceleration + to.acceleration);
        let allowed = jerk * step * step / 4.0;
        assert!(
            sped.abs() <= allowed * 1.000_001 + noise * (cruise + hardest.min(case.hardest()) * total),
            "velocity is {sped:e} off its acceleration, allowed {allowed:e}"
        );
        let hardened = (to.acceleration - from.acceleration).abs();
        assert!(hardened <= jerk * (step * 1.000_001 + noise * total), "acceleration jumps by {hardened:e}");
    }
}

fn check_mirrored(case: &Case) {
    let (Some(ours), Some(mirrored)) = (planned(case), planned(&case.mirrored())) else {
        assert_eq!(planned(case), planned(&case.mirrored()));
        return;
    };
    let turned: Vec<Segment> = mirrored
        .segments()
        .iter()
        .map(|&Segment { duration, start, law }| Segment {
            duration,
            start: start.mirrored(),
            law: law.mirrored(),
        })
        .collect();
    assert_eq!(ours.segments().as_slice(), turned);
    assert_eq!(ours.reached(), mirrored.reached().mirrored());
    assert_eq!(ours.classification(), mirrored.classification());
}

fn check_reversed(case: &Case) {
    let (ours, reversed) = (planned(case).unwrap(), planned(&case.reversed()).unwrap());
    let mut backward = durations(&reversed);
    backward.reverse();
    assert_eq!(durations(&ours), backward);
    assert_eq!(ours.classification().feed_rate, reversed.classification().feed_rate);
    let total = ours.duration();
    let scale = case.distance().abs();
    for part in [0.01, 0.25, 0.5, 0.6, 0.99] {
        let (forward, back) = (ours.at(part * total).state, reversed.at(total - part * total).state);
        let apart = (forward.position + back.position).abs();
        assert!(apart <= 1e-13 * scale, "{apart:e} apart at {part} of {total}");
    }
}

/// Powers of four, as roots of them are exact.
fn check_scaled_exactly(case: &Case, length: i32, time: i32) {
    let (length, time) = (4f64.powi(length), 4f64.powi(time));
    let (ours, scaled) = (planned(case), planned(&case.scaled(length, time)));
    let (Some(ours), Some(scaled)) = (ours, scaled) else {
        assert!(planned(case).is_none() && planned(&case.scaled(length, time)).is_none());
        return;
    };
    let expected: Vec<f64> = durations(&ours).iter().map(|duration| duration * time).collect();
    assert_eq!(durations(&scaled), expected);
    assert_eq!(scaled.reached().velocity, ours.reached().velocity * (length / time));
    assert_eq!(scaled.classification().eight_type, ours.classification().eight_type);
}

fn check_scaled(case: &Case, length: f64, time: f64) {
    // One ulp decides whether a path is too short; it need not be the same one in another unit.
    let (Some(ours), Some(scaled)) = (planned(case), planned(&case.scaled(length, time))) else { return };
    let (expected, total) = (ours.duration() * time, scaled.duration());
    assert!((total - expected).abs() <= DURATION * expected, "{total} instead of {expected}");
}

fn check_nearest(case: &Case) {
    let planned = planned(case).unwrap();
    let direction = case.problem().direction();
    let (asked, got) = (case.goal.velocity * direction, planned.reached().velocity * direction);
    let (from, length) = (case.start.velocity.abs(), case.distance().abs());
    assert!(got >= 0.0 && got <= case.limits().cruise_towards(direction));
    let reach = |to: f64| case.ramp_length(from, to);
    // An ulp of the speed is worth far more than an ulp of a short path.
    let rounding = 4.0 * f64::EPSILON * from.max(got);
    let least = reach(got).min(reach(from.clamp(got - rounding, got + rounding)));
    assert!(least <= length * (1.0 + END), "{got} is not reachable");
    if asked == got {
        return;
    }
    // Strictly between, and on the other side of the asked one just as near: nothing that can be reached.
    let steps = 1000;
    for step in 1..=steps {
        let part = f64::from(step) / f64::from(steps);
        let margin = VERTEX * from.max(asked);
        for candidate in [got + part * (asked - got), asked + (1.0 - part) * (asked - got)] {
            let nearer = (candidate - asked).abs() < (got - asked).abs() - margin;
            if nearer && candidate >= 0.0 {
                assert!(
                    reach(candidate) > length,
                    "{candidate} can be reached, and is nearer to {asked} than {got}"
                );
            }
        }
    }
}

fn check_bits(case: &Case, parts: &[f64]) {
    let Some(planned) = planned(case) else { return };
    let profile = planned.to_profile();
    let mut times = vec![0.0, -0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, profile.duration()];
    times.extend(parts.iter().map(|part| part * profile.duration()));
    for (begin, segment) in profile.timed_segments() {
        let end = begin + segment.duration;
        times.extend([begin, begin.next_down(), begin.next_up(), end, end.next_down(), end.next_up()]);
    }
    // Forward in part, backward in part, and in the disorder in which they were found.
    let mut orders = vec![times.clone(), times.iter().rev().copied().collect()];
    times.sort_by(f64::total_cmp);
    orders.push(times);
    for order in orders {
        let mut cursor = Cursor::new(&profile);
        for t in order {
            let expected = bits(planned.at(t));
            assert_eq!(bits(profile.at(t)), expected, "profile at {t}");
            assert_eq!(bits(cursor.at(t)), expected, "cursor at {t}");
        }
    }
}

fn check_extremes(case: &Case, parts: &[f64]) {
    let Some(planned) = planned(case).filter(countable) else { return };
    let plan = one_axis(case, &planned);
    let certificate = certify(&plan);
    assert!(certificate.passed(), "{:?}", certificate.violations().collect::<Vec<_>>());
    let profile = &plan.axes()[0].profile;
    let fastest = case.limits.max_velocity;
    for check in &certificate.limits {
        let part = |setpoint: Setpoint| match check.quantity {
            Quantity::Position => setpoint.state.position,
            Quantity::Velocity => setpoint.state.velocity,
            Quantity::Acceleration => setpoint.state.acceleration,
            _ => setpoint.jerk,
        };
        let scale = match check.quantity {
            Quantity::Position => {
                case.distance().abs() + case.start.position.abs() + case.goal.position.abs()
            }
            Quantity::Velocity => fastest,
            Quantity::Acceleration => case.hardest(),
            _ => case.limits.max_jerk,
        };
        // At a join the jerk is that of either piece, and after the end nothing moves.
        if check.quantity != Quantity::Jerk {
            let attained = part(profile.at(check.at_time));
            // Late in a long motion a rounding of the time is worth more.
            let rate = match check.quantity {
                Quantity::Position => fastest,
                Quantity::Velocity => case.hardest(),
                _ => case.limits.max_jerk,
            };
            let allowed = 1e-9 * scale + 4.0 * f64::EPSILON * profile.duration() * rate;
            assert!((attained - check.extremum).abs() <= allowed, "{check:?}: {attained} at that time");
        }
        for sample in parts.iter().map(|part| profile.at(part * profile.duration())) {
            let value = part(sample);
            let bounded = match check.quantity {
                Quantity::Position => {
                    value >= case.limits.min_position.unwrap() - 1e-15 * scale
                        && value <= case.limits.max_position.unwrap() + 1e-15 * scale
                }
                // The other direction has a limit of its own.
                Quantity::Velocity if value * check.extremum < 0.0 => value.abs() <= 1e-13 * scale,
                // Against the limit of what it does there.
                Quantity::Acceleration => {
                    let speeds_up = value * case.problem().direction() > 0.0;
                    let limit = if speeds_up { case.limits.max_acceleration } else { case.deceleration() };
                    value.abs() / limit <= check.extremum.abs() / check.limit + 1e-15
                }
                _ => value.abs() <= check.extremum.abs() + 1e-15 * scale,
            };
            assert!(bounded, "{check:?}: {value}");
        }
    }
}

fn check_closing_stop(case: &Case) {
    let limits = planner::LimitsSpec { min_position: None, max_position: None, ..case.limits.clone() };
    let case = Case { limits, ..case.clone() };
    let Some(planned) = planned(&case).filter(countable) else { return };
    let plan = one_axis(&case, &planned);
    match plan.with_closing_stop().unwrap() {
        None => assert!(planned.reached().is_at_rest()),
        Some((stopped, first)) => {
            assert!(!planned.reached().is_at_rest());
            assert!(stopped.ends_at_rest());
            assert_eq!(first, plan.cycle_count());
            assert!(stopped.cycle_count() >= first);
            let certificate = certify(&stopped);
            assert!(certificate.passed(), "{:?}", certificate.violations().collect::<Vec<_>>());
        }
    }
}

fn check_bindings(case: &Case) {
    let Some(planned) = planned(case).filter(countable) else { return };
    let plan = one_axis(case, &planned);
    let explanation = explain(&plan);
    assert_eq!(explanation.critical_axis, "x");
    let mut last = 0.0;
    for binding in &explanation.bindings {
        assert!(binding.from_time >= last, "{:?}", explanation.bindings);
        assert!(binding.to_time > binding.from_time, "{:?}", explanation.bindings);
        last = binding.to_time;
    }
    assert!(last <= plan.duration());
    for pair in explanation.bindings.windows(2) {
        let split = pair[0].quantity == pair[1].quantity && pair[0].to_time == pair[1].from_time;
        assert!(!split, "{:?}", explanation.bindings);
    }
}

/// Changes one number of one piece, and expects the judge to see it.
fn check_mutations(case: &Case) {
    const CHANGE: f64 = 1e-6;
    let Some(planned) = planned(case) else { return };
    let (segments, goal) = (planned.segments(), promised(case, &planned));
    let extent = case.distance().abs();
    let largest = |of: fn(&State) -> f64| {
        let ends = segments.iter().flat_map(|segment| [segment.start, segment.end()]);
        ends.map(|state| of(&state).abs()).fold(0.0, f64::max)
    };
    let (fastest, hardest) = (largest(|state| state.velocity), largest(|state| state.acceleration));
    for index in 0..segments.len() {
        for field in 0..5 {
            for sign in [-1.0, 1.0] {
                let change = sign * CHANGE;
                let mut pieces = segments.to_vec();
                let piece = &mut pieces[index];
                match field {
                    0 => piece.start.position += change * extent,
                    1 => piece.start.velocity += change * fastest,
                    2 if hardest > 0.0 => piece.start.acceleration += change * hardest,
                    // Without acceleration there is no scale to hold a change of it against.
                    2 | 3 if hardest == 0.0 => continue,
                    // As much as changes the acceleration by a part of the hardest.
                    3 => {
                        let Law::ConstantJerk(jerk) = piece.law else { panic!("{:?}", piece.law) };
                        piece.law = Law::ConstantJerk(jerk + change * hardest / piece.duration);
                    }
                    _ => piece.duration += change * planned.duration(),
                }
                let changed = Profile::new(pieces, planned.reached());
                let found = violations(&changed, &case.limits(), goal);
                assert!(!found.is_empty(), "field {field} of piece {index}, {change:e}: {segments:#?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(settings())]

    #[test]
    fn every_plan_is_legal_and_arrives(case in any_case()) {
        check_legal(&case);
    }

    #[test]
    fn samples_keep_limits_and_belong_together(
        case in any_case(), parts in prop::collection::vec(0.0..1.0f64, 24),
    ) {
        if let Some(planned) = planned(&case) {
            check_samples(&case, &planned, &parts);
        }
    }

    #[test]
    fn a_mirrored_problem_has_the_mirrored_plan(case in any_case()) {
        check_mirrored(&case);
    }

    #[test]
    fn a_problem_run_backwards_has_the_plan_run_backwards(case in feasible_case()) {
        check_reversed(&case);
    }

    #[test]
    fn units_that_are_powers_of_four_leave_every_bit(
        case in case_from_zero(), length in -20..20i32, time in -10..10i32,
    ) {
        check_scaled_exactly(&case, length, time);
    }

    #[test]
    fn units_leave_the_duration(
        case in feasible_case(), length in -6.0..6.0f64, time in -6.0..6.0f64,
    ) {
        check_scaled(&case, 10f64.powf(length), 10f64.powf(time));
    }

    #[test]
    fn the_nearest_velocity_is_nearest(case in case_from_zero()) {
        check_nearest(&case.policy(ShortPathPolicy::NearestVelocity));
    }

    /// The end velocity that a refusal advises is accepted.
    #[test]
    fn the_way_out_is_a_way_out(case in case_from_zero()) {
        let problem = case.policy(ShortPathPolicy::Reject).problem();
        for planner in [plan_move, plan_trapezoid] {
            let Err(refusal) = planner(&problem) else { continue };
            let Why::PathTooShort { nearest_velocity, .. } = refusal.as_slice()[0].why else {
                return Err(TestCaseError::fail(refusal.to_string()));
            };
            let asked = |position, velocity| {
                let goal = State { position, velocity, acceleration: 0.0 };
                Problem::new(problem.start(), goal, problem.limits().clone(), ShortPathPolicy::Reject).unwrap()
            };
            let slower = planner(&asked(problem.goal().position, nearest_velocity));
            prop_assert!(slower.is_ok(), "at {nearest_velocity}: {slower:?}");
        }
    }

    #[test]
    fn reading_depends_on_the_time_alone(
        case in any_case(), parts in prop::collection::vec(0.0..1.0f64, 8),
    ) {
        check_bits(&case, &parts);
    }

    #[test]
    fn the_judges_extremes_bound_all_samples(
        case in any_case(), parts in prop::collection::vec(0.0..1.0f64, 64),
    ) {
        check_extremes(&case, &parts);
    }

    #[test]
    fn a_closing_stop_is_legal(case in any_case()) {
        check_closing_stop(&case);
    }

    #[test]
    fn bindings_follow_each_other(case in any_case()) {
        check_bindings(&case);
    }

    #[test]
    fn the_judge_sees_every_change(case in case_from_zero()) {
        check_mutations(&case);
    }

    #[test]
    fn a_stop_is_legal(case in any_case()) {
        let limits = planner::LimitsSpec { min_position: None, max_position: None, ..case.limits.clone() };
        let limits = planner::Limits::try_from(limits).unwrap();
        let stop = plan_stop(case.start, &limits).unwrap();
        prop_assert!(stop.reached().is_at_rest());
        prop_assert_eq!(violations(&stop.to_profile(), &limits, stop.reached()), []);
    }
}
