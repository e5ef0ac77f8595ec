//! Single problems at the edge: what the laws found, and what they cannot draw.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and bits are compared as bits"
)]

use planner::{
    AxisKind, AxisMoveSpec, BoundsSpec, CycleTime, EightType, Family, LAST_CYCLE, Law, Limits, LimitsSpec,
    Move, Plan, Problem, Profile, Request, RequestSpec, Segment, Setpoint, ShortPathPolicy, State,
    Synchronization, Transfer, Why, certify, explain, plan, plan_between, plan_move, plan_stop,
    plan_transfer, transfer_violations, violations,
};

fn moving(position: f64, velocity: f64) -> State {
    State { position, velocity, acceleration: 0.0 }
}

fn limits(velocity: f64, acceleration: f64, jerk: f64) -> Limits {
    Limits::symmetric(velocity, acceleration, jerk).unwrap()
}

/// As `limits`, with no way back.
fn one_way(velocity: f64, acceleration: f64, jerk: f64) -> Limits {
    let spec = LimitsSpec {
        max_velocity: velocity,
        max_acceleration: acceleration,
        max_jerk: jerk,
        max_velocity_reverse: Some(0.0),
        ..LimitsSpec::default()
    };
    spec.try_into().unwrap()
}

fn solved(start: State, goal: State, limits: &Limits, policy: ShortPathPolicy) -> Move {
    let problem = Problem::new(start, goal, limits.clone(), policy).unwrap();
    let planned = plan_move(&problem).unwrap();
    assert_eq!(violations(&planned.to_profile(), limits, planned.reached()), []);
    planned
}

fn refused(start: State, goal: State, limits: &Limits) -> Why {
    let problem = Problem::new(start, goal, limits.clone(), ShortPathPolicy::Reject).unwrap();
    plan_move(&problem).unwrap_err().as_slice()[0].why.clone()
}

fn request(start: State, goal: State, limits: LimitsSpec) -> Plan {
    let axis = AxisMoveSpec { axis: "x".into(), kind: Ok(AxisKind::Prismatic), start, goal, limits };
    let spec = RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    };
    plan(&Request::try_from(spec).unwrap()).unwrap()
}

/// A motion that only slows down is laid from its end backwards, and began beside its start by a rounding.
#[test]
fn a_single_ramp_down_begins_at_the_start() {
    let start = moving(-0.0, 0.064723194281909);
    let goal = moving(0.012677975664785021, 1e-13);
    let planned = solved(start, goal, &limits(0.1, 1.0, 1.0), ShortPathPolicy::NearestVelocity);
    assert_eq!(planned.segments()[0].start, start);
    assert_eq!(planned.at(0.0).state, start);
}

/// Speeding up by a²/j was compared with the path as `start + a²/j`, in which a²/j vanished: it took a ramp on no path.
#[test]
fn a_corner_below_one_ulp_of_the_speed_does_not_move() {
    let limits = limits(523.467913785958, 2.7776340248578983e-6, 10710.072668105944);
    let start = moving(1.0, 44.3803052177477);
    let planned = solved(start, moving(1.0, 133.1409156532431), &limits, ShortPathPolicy::NearestVelocity);
    assert!(planned.segments().is_empty());
    assert_eq!(planned.reached(), start);
}

/// The last velocity of a stop is a rounded zero and may be negative; the judge took it for a motion backwards.
#[test]
fn an_axis_that_must_not_turn_back_may_stop() {
    let limits = one_way(3254.26030083537, 5.2200396912030635, 6.497343714959854);
    let stop = plan_stop(moving(0.0, 2397.9972712179538), &limits).unwrap();
    let segments = stop.segments();
    let last = segments.last().unwrap();
    assert!(last.turning_points().iter().any(|&t| last.at(t).state.velocity < 0.0));
    assert_eq!(violations(&stop.to_profile(), &limits, stop.reached()), []);
}

/// One piece that slows down, turns back, and stands where its acceleration is `turning`, as hard as it turned.
fn turned(turning: f64, from: f64, jerk: f64) -> Profile {
    let goal = State { position: 0.0, velocity: 0.0, acceleration: turning };
    let duration = (turning - from) / jerk;
    let start = goal.after(jerk, -duration);
    Profile::new([Segment { duration, start, law: Law::ConstantJerk(jerk) }], goal)
}

/// How hard an axis turns back is known as well as when, and that as well as its velocity: `δa = j·δv/a`. The judge held what is no
/// more than that against the limit of speeding up.
#[test]
fn an_acceleration_where_an_axis_turns_back_is_known_as_its_velocity_is() {
    let judged = |excess: f64, hardest: f64| {
        let limits = LimitsSpec {
            max_velocity: 174.5,
            max_acceleration: 1e-3,
            max_deceleration: Some(hardest),
            max_jerk: 1.16,
            ..LimitsSpec::default()
        };
        let profile = turned(1e-3 * (1.0 + excess), -hardest, 1.16);
        violations(&profile, &limits.try_into().unwrap(), profile.end()).len()
    };
    // Of 73 units/s eight ulps are 1.3e-13; over a²/j they are 1.5e-7.
    assert_eq!(judged(1e-8, 13.0), 0);
    assert_eq!(judged(1e-6, 13.0), 1);
    // Of a slow motion all is known.
    assert_eq!(judged(1e-8, 2e-3), 1);

    let (start, goal) = (
        moving(0.0021071161289944484, -174.49703220650076),
        State { acceleration: 1e-3, ..State::at_rest(0.0) },
    );
    let limits = Limits::try_from(LimitsSpec {
        max_velocity: 174.49703220650076,
        max_acceleration: 1e-3,
        max_deceleration: Some(13.019231244105601),
        max_jerk: 1.1584761656722478,
        ..LimitsSpec::default()
    });
    let limits = limits.unwrap();
    let planned = plan_between(start, goal, &limits).unwrap().to_profile();
    assert_eq!(violations(&planned, &limits, goal), []);
}

/// What is left between the two halves of a motion is closed by its longest piece, where that still joins the next: at full jerk it did
/// not, and one that turned on its way was cut by the velocity of its beginning.
#[test]
fn a_gap_is_closed_where_pieces_still_join() {
    let check = |start: State, goal: State, bounds: BoundsSpec| {
        let asked = Transfer::new(start, goal, bounds.try_into().unwrap()).unwrap();
        // Or it is refused, for want of digits.
        if let Ok(planned) = plan_transfer(&asked) {
            assert_eq!(transfer_violations(&planned.to_profile(), asked.bounds(), goal), []);
        }
    };
    check(
        State { acceleration: 1.0, ..moving(0.0, 15289112.68147163) },
        moving(-1e-20, -12781590.882516447),
        BoundsSpec {
            min_velocity: -1e20,
            max_velocity: 1e-20,
            min_acceleration: -13407801174516.37,
            max_acceleration: 3.620251842445969e-14,
            max_jerk: 1449969785116.7349,
        },
    );
    let tiny = 9.999999999999999e-31;
    check(
        State { acceleration: tiny, ..moving(0.0, -tiny) },
        moving(0.0, -4.173046921075371e-19),
        BoundsSpec {
            min_velocity: -4.173046921075371e-19,
            max_velocity: 1e30,
            min_acceleration: -6.985635008787696e26,
            max_acceleration: tiny,
            max_jerk: 604.8995576111517,
        },
    );
}

/// A motion of 1e-12 far from zero may round to an ulp beyond its goal, which may be the end of the range.
#[test]
fn rounding_at_the_end_of_the_range_is_inside() {
    let mut start = 1e6;
    for step in 0..1000 {
        start += f64::from(step) * 1e-3;
        let goal = start + 1e-9;
        let spec = LimitsSpec {
            max_velocity: 1.0,
            max_acceleration: 1.0,
            max_jerk: 1.0,
            min_position: Some(start),
            max_position: Some(goal),
            ..LimitsSpec::default()
        };
        solved(
            State::at_rest(start),
            State::at_rest(goal),
            &spec.try_into().unwrap(),
            ShortPathPolicy::Reject,
        );
    }
}

/// Inside a range by any distance, without any extent to measure it by.
#[test]
fn a_motion_of_no_extent_is_held_against_its_range() {
    let spec = |max_position| LimitsSpec {
        max_velocity: 1.0,
        max_acceleration: 1.0,
        max_jerk: 1.0,
        min_position: Some(-1e60),
        max_position: Some(max_position),
        ..LimitsSpec::default()
    };
    let plan = request(State::at_rest(0.0), State::at_rest(0.0), spec(2.0));
    assert_eq!(certify(&plan).limits[0].margin, 1.0);
    let profile = &plan.axes()[0].profile;
    assert_eq!(violations(profile, &spec(0.0).try_into().unwrap(), State::at_rest(0.0)), []);
    assert_eq!(violations(profile, &spec(-1.0).try_into().unwrap(), State::at_rest(0.0)).len(), 1);
}

#[test]
fn a_plan_that_does_not_move_lasts_zero_seconds() {
    let planned =
        solved(State::at_rest(3.0), State::at_rest(3.0), &limits(1.0, 1.0, 1.0), ShortPathPolicy::Reject);
    assert!(planned.segments().is_empty());
    assert_eq!(planned.duration().to_bits(), 0);
    assert_eq!(planned.duration().to_bits(), planned.to_profile().duration().to_bits());
    assert_eq!(planned.classification().eight_type, None);
    assert_eq!(planned.at(1.0), Setpoint::held(State::at_rest(3.0)));
}

#[test]
fn a_piece_too_late_to_be_timed_binds_nothing() {
    let spec = LimitsSpec {
        max_velocity: 1.0,
        max_acceleration: 1.0469889995280822e-5,
        max_jerk: 38444.563301437665,
        ..LimitsSpec::default()
    };
    let plan = request(State::at_rest(1.0), State::at_rest(5691457.781559439), spec);
    assert!(explain(&plan).bindings.iter().all(|binding| binding.from_time < binding.to_time));
}

#[test]
fn numbers_below_the_normal_ones_are_planned_and_judged() {
    let least = f64::from_bits(1);
    let limits = limits(1.0, 1.0, 1.0);
    let cases = [
        (State::at_rest(0.0), State::at_rest(least)),
        (moving(0.0, 0.1), moving(least, 0.1)),
        (moving(1.0, 0.0), moving(1.0, least)),
        (moving(0.0, least), moving(1.0, least)),
        (State::at_rest(0.0), State::at_rest(1e-300)),
        (State::at_rest(-0.0), State::at_rest(-1e-310)),
    ];
    for (start, goal) in cases {
        let planned = solved(start, goal, &limits, ShortPathPolicy::Reject);
        assert_eq!(planned.reached(), goal);
        assert!(planned.at(0.5 * planned.duration()).is_finite());
    }
}

/// The greatest and the least numbers that are taken, in every combination.
#[test]
fn the_widest_limits_neither_overflow_nor_vanish() {
    let ends = [1e-60, 1.0, 1e60];
    for velocity in ends {
        for acceleration in ends {
            for jerk in ends {
                for distance in [1e-60, 1e-30, 1.0, 1e60] {
                    for part in [0.0, 0.5, 1.0] {
                        let limits = limits(velocity, acceleration, jerk);
                        let start = moving(0.0, part * velocity);
                        let goal = moving(distance, 0.25 * velocity);
                        let planned = solved(start, goal, &limits, ShortPathPolicy::NearestVelocity);
                        assert!(planned.duration() > 0.0 && planned.duration().is_finite());
                        assert!(planned.at(0.5 * planned.duration()).is_finite());
                    }
                }
            }
        }
    }
}

#[test]
fn a_negative_zero_is_a_zero() {
    let limits = limits(1.0, 2.0, 3.0);
    for (start, goal) in [(0.0, 1.0), (0.0, -1.0), (-1.0, 0.0), (0.0, 0.0)] {
        let plain = solved(State::at_rest(start), State::at_rest(goal), &limits, ShortPathPolicy::Reject);
        let start = State { position: start * 1.0, velocity: -0.0, acceleration: -0.0 };
        let goal =
            State { position: if goal == 0.0 { -0.0 } else { goal }, velocity: -0.0, acceleration: -0.0 };
        let negative = solved(start, goal, &limits, ShortPathPolicy::Reject);
        assert_eq!(negative, plain);
    }
    // A forbidden way back does not forbid standing still.
    let one_way = one_way(1.0, 2.0, 3.0);
    solved(moving(0.0, -0.0), moving(0.0, -0.0), &one_way, ShortPathPolicy::Reject);
}

#[test]
fn without_a_distance_only_the_same_speed_can_be_kept() {
    let limits = limits(1.0, 1.0, 1.0);
    for velocity in [0.5, -0.5] {
        let at = moving(2.0, velocity);
        let drifting = solved(at, at, &limits, ShortPathPolicy::Reject);
        assert!(drifting.segments().is_empty());
        assert_eq!(drifting.reached(), at);
        assert_eq!(drifting.classification().feed_rate, 0.5);
        let faster = moving(2.0, 1.5 * velocity);
        let Why::PathTooShort { needed, given, nearest_velocity } = refused(at, faster, &limits) else {
            panic!("a path of no length was taken");
        };
        assert_eq!((given, nearest_velocity), (0.0, velocity));
        assert_eq!(needed, 1.25 * velocity * 0.25f64.sqrt() * 2.0);
        let nearest = solved(at, faster, &limits, ShortPathPolicy::NearestVelocity);
        assert_eq!(nearest.reached(), at);
        let matched = solved(at, faster, &limits, ShortPathPolicy::MatchStartVelocity);
        assert_eq!(matched.reached(), at);
    }
}

/// D(0.5, 1) = 0.75·2·√0.5 with a = 1, j = 1: the least length that keeps the end velocity.
#[test]
fn an_ulp_of_the_length_does_not_decide_whether_it_is_enough() {
    let limits = limits(2.0, 1.0, 1.0);
    let least = 0.75 * (2.0 * 0.5f64.sqrt());
    let start = moving(0.0, 0.5);
    let (mut below, mut above) = (least, least);
    for _ in 0..4 {
        for length in [below, above] {
            let planned = solved(start, moving(length, 1.0), &limits, ShortPathPolicy::Reject);
            assert_eq!(planned.reached().velocity, 1.0);
            assert!((planned.duration() - 2.0 * 0.5f64.sqrt()).abs() < 1e-15);
        }
        (below, above) = (below.next_down(), above.next_up());
    }
    let why = refused(start, moving(least * (1.0 - 1e-14), 1.0), &limits);
    assert!(matches!(why, Why::PathTooShort { needed, .. } if needed == least), "{why}");
}

/// Two ways to be nearest: below the interval that cannot be reached, and above it.
#[test]
fn the_nearest_velocity_may_be_below_the_one_asked_for() {
    // Braking from 1 with j = 1 and a out of reach: D(1, 0) = 1, D(1, 1/3) = 1.0887, and D(1, v) = 1.05 at about 0.1181
    // and 0.5275, which are equally far from 0.3228.
    let limits = limits(2.0, 10.0, 1.0);
    let length = 1.05;
    for (asked, below) in [(0.2, true), (0.3, true), (0.34, false), (0.5, false)] {
        let planned =
            solved(moving(0.0, 1.0), moving(length, asked), &limits, ShortPathPolicy::NearestVelocity);
        let got = planned.reached().velocity;
        assert_eq!(got < asked, below, "{asked}: {got}");
        let reach = (1.0 + got) * (1.0 - got).sqrt();
        assert!((reach - length).abs() < 1e-14, "{got} needs {reach}");
        assert_eq!(planned.classification().eight_type, Some(EightType::Type8C));
    }
}

#[test]
fn a_boundary_that_other_planners_refuse_is_planned() {
    // From 0.3 to 0.32 with v = 5, a = 1, j = 10: exactly d = 2a³/j².
    let planned =
        solved(State::at_rest(0.3), State::at_rest(0.32), &limits(5.0, 1.0, 10.0), ShortPathPolicy::Reject);
    assert!((planned.duration() - 0.4).abs() < 1e-15);
}

#[test]
fn a_stop_leaves_the_range_or_not() {
    let spec = |max| LimitsSpec {
        max_velocity: 1.0,
        max_acceleration: 1.0,
        max_jerk: 1.0,
        max_position: Some(max),
        ..LimitsSpec::default()
    };
    // From 1 it takes 2 s and a length of 1.
    let stop = plan_stop(moving(0.0, 1.0), &spec(1.0).try_into().unwrap()).unwrap();
    assert_eq!(stop.reached(), State::at_rest(1.0));
    let refusal = plan_stop(moving(0.0, 1.0), &spec(0.75).try_into().unwrap()).unwrap_err();
    assert_eq!(
        refusal.to_string(),
        "the motion reaches 1 at 2 s, beyond 0.75: stay inside or move limits.max_position"
    );
}

#[test]
fn whole_cycles_are_counted_exactly() {
    for ns in [10_000, 62_500, 125_000, 250_000, 333_333, 1_000_000, 4_000_000, 1_000_000_000i128] {
        let cycle = CycleTime::from_ns(Some(ns)).unwrap();
        for count in (0..2000).chain([123_457, 86_400_000, 1 << 40, 1 << 48]) {
            let duration = cycle.start_of(count);
            assert_eq!(cycle.count(duration), Some(count), "{count} cycles of {ns} ns");
            assert_eq!(
                cycle.count(duration.next_down().max(0.0)),
                Some(count),
                "{count} cycles of {ns} ns, less an ulp"
            );
            if count > 0 {
                assert_eq!(
                    cycle.count(duration.next_up()),
                    Some(count),
                    "{count} cycles of {ns} ns and an ulp"
                );
                let more = duration + 1e-6 * cycle.as_seconds();
                let seen = more > duration * (1.0 + 1e-15);
                assert_eq!(
                    cycle.count(more),
                    Some(count + u64::from(seen)),
                    "{count} cycles of {ns} ns and more"
                );
            }
        }
    }
    let cycle = CycleTime::MILLISECOND;
    assert_eq!(cycle.count(0.0), Some(0));
    assert_eq!(cycle.count(-0.0), Some(0));
    assert_eq!(cycle.count(f64::from_bits(1)), Some(1));
    assert_eq!(cycle.count(1e-9), Some(1));
    assert!(cycle.count(cycle.start_of(LAST_CYCLE)).is_some());
    for uncountable in [f64::NAN, f64::INFINITY, -1.0, 1e13] {
        assert_eq!(cycle.count(uncountable), None, "{uncountable}");
    }
}

/// The duration is asked for in cycles, and the setpoint of the last cycle is the goal to the last bit.
#[test]
fn the_last_cycle_is_the_goal() {
    // Durations of hundredths of a second, which is whole cycles but for a rounding.
    for hundredth in 25..5000 {
        let duration = f64::from(hundredth) * 0.01;
        let goal = State::at_rest(0.5 * (duration - 0.15));
        let spec =
            LimitsSpec { max_velocity: 0.5, max_acceleration: 5.0, max_jerk: 100.0, ..LimitsSpec::default() };
        let plan = request(State::at_rest(0.0), goal, spec);
        let mut sampler = plan.sampler();
        assert_eq!(sampler.at(plan.cycle_count()).next(), Some(Setpoint::held(goal)));
        assert_ne!(sampler.at(plan.cycle_count() - 1).next(), Some(Setpoint::held(goal)));
    }
}
