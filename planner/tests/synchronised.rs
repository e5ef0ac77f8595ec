//! Requests for several axes that arrive together, or on a straight line; minimum durations; ends on a cycle.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use planner::{
    AxisKind, AxisMoveSpec, Family, InvalidFields, Judged, LimitsSpec, Plan, Request, RequestSpec,
    ShortPathPolicy, State, Synchronization, explain,
};
use proptest::prelude::*;

const NAMES: [&str; 6] = ["x", "y", "z", "a", "b", "c"];

fn spec(
    axes: Vec<(State, State, LimitsSpec)>,
    family: Family,
    synchronization: Synchronization,
) -> RequestSpec {
    let axes = axes.into_iter().zip(NAMES).map(|((start, goal, limits), name)| AxisMoveSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        start,
        goal,
        limits,
    });
    RequestSpec {
        axes: axes.collect(),
        cycle_time_ns: None,
        family: Ok(family),
        order: (family == Family::Polynomial).then_some(4),
        short_path: Ok(ShortPathPolicy::NearestVelocity),
        synchronization: Ok(synchronization),
        minimum_duration: None,
        end_on_cycle: false,
    }
}

fn limits() -> LimitsSpec {
    LimitsSpec {
        max_velocity: 0.5,
        max_acceleration: 2.0,
        max_jerk: 20.0,
        max_snap: Some(400.0),
        ..LimitsSpec::default()
    }
}

fn answered(spec: RequestSpec) -> Result<Judged, InvalidFields> {
    Judged::answer(&Request::try_from(spec)?)
}

fn rest(from: f64, to: f64) -> (State, State, LimitsSpec) {
    (State::at_rest(from), State::at_rest(to), limits())
}

/// Do all axes that move last as long as the plan?
fn all_arrive_at_the_end(plan: &Plan) {
    for axis in plan.axes() {
        let lasts = axis.profile.duration();
        assert!(
            lasts == 0.0 || (lasts - plan.duration()).abs() <= 1e-12 * plan.duration(),
            "{lasts}: {plan:?}"
        );
    }
}

#[test]
fn axes_of_every_family_arrive_together() {
    for family in [Family::SCurve, Family::Trapezoidal, Family::Polynomial, Family::Trigonometric] {
        let axes = vec![rest(0.0, 0.1), rest(1.0, 0.4), rest(0.2, 0.2)];
        let alone = answered(spec(vec![rest(1.0, 0.4)], family, Synchronization::None)).unwrap();
        let judged = answered(spec(axes, family, Synchronization::Time)).unwrap();
        let plan = judged.plan();
        assert!(judged.certificate().passed(), "{family:?}");
        assert!((plan.duration() - alone.plan().duration()).abs() <= 1e-12);
        all_arrive_at_the_end(plan);
        assert_eq!(explain(plan).critical_axis, "y", "{family:?}");
        assert_eq!(plan.axes()[1].classification, alone.plan().axes()[0].classification);
        assert_eq!(plan.method().synchronization, Synchronization::Time);
    }
}

#[test]
fn a_line_is_straight_and_held_back_by_the_tightest() {
    let slow = LimitsSpec { max_velocity: 0.05, ..limits() };
    let axes = vec![rest(0.0, 1.0), (State::at_rest(2.0), State::at_rest(1.6), slow)];
    let judged = answered(spec(axes.clone(), Family::SCurve, Synchronization::Phase)).unwrap();
    let plan = judged.plan();
    assert!(judged.certificate().passed());
    for cycle in 0..=plan.cycle_count() {
        let at: Vec<State> = plan.sampler().at(cycle).map(|setpoint| setpoint.state).collect();
        assert!((at[1].position - (2.0 - 0.4 * at[0].position)).abs() <= 1e-14);
    }
    // 0.05 m/s of the second are 0.125 m/s of the first.
    let fastest = plan.axes()[0].classification.feed_rate;
    assert!((fastest - 0.125).abs() <= 1e-15, "{fastest}");
    let refused = answered(spec(axes, Family::Polynomial, Synchronization::Phase)).unwrap_err().to_string();
    assert!(
        refused.starts_with("synchronization: a straight line for several axes of this family"),
        "{refused}"
    );
}

#[test]
fn who_is_beside_the_line_is_named() {
    let mut axes = vec![rest(0.0, 1.0), rest(0.0, 1.0)];
    axes[0].0.velocity = 0.2;
    let refused = answered(spec(axes, Family::SCurve, Synchronization::Phase)).unwrap_err();
    assert!(refused.as_slice()[0].field.as_str().starts_with("axes["), "{refused}");
}

#[test]
fn goals_at_speed_are_passed_together() {
    let at = |position: f64, velocity: f64| State { position, velocity, acceleration: 0.0 };
    let axes = || {
        vec![(State::at_rest(0.0), at(0.5, 0.2), limits()), (State::at_rest(0.0), at(-0.1, -0.1), limits())]
    };
    let judged = answered(spec(axes(), Family::SCurve, Synchronization::Time)).unwrap();
    assert!(judged.certificate().passed());
    all_arrive_at_the_end(judged.plan());
    assert_eq!(judged.plan().axes()[1].profile.end(), at(-0.1, -0.1));
    let refused = answered(spec(axes(), Family::SCurve, Synchronization::None)).unwrap_err().to_string();
    assert!(refused.contains("choose SYNCHRONIZATION_TIME"), "{refused}");
    let refused = answered(spec(axes(), Family::Trapezoidal, Synchronization::Time)).unwrap_err().to_string();
    assert!(refused.contains("a longer duration for a trapezoid from or to a speed"), "{refused}");
}

#[test]
fn a_minimum_duration_and_an_end_on_a_cycle() {
    for family in [Family::SCurve, Family::Trapezoidal, Family::Polynomial, Family::Trigonometric] {
        for (synchronization, count) in
            [(Synchronization::None, 1), (Synchronization::Time, 2), (Synchronization::None, 2)]
        {
            let axes = vec![rest(0.0, 0.5), rest(1.0, 0.8)][..count].to_vec();
            let asked = RequestSpec {
                minimum_duration: Some(3.000_4),
                end_on_cycle: true,
                ..spec(axes, family, synchronization)
            };
            let judged = answered(asked).unwrap();
            assert!(judged.certificate().passed(), "{family:?} {synchronization:?}");
            assert_eq!(judged.plan().cycle_count(), 3001, "{family:?} {synchronization:?}");
            assert!((judged.plan().duration() - 3.001).abs() <= 1e-14);
            if synchronization == Synchronization::Time {
                all_arrive_at_the_end(judged.plan());
            }
        }
    }
}

/// Who sets the pace is held back at every instant; where a least duration does, nobody is.
#[test]
fn who_sets_the_pace_is_said() {
    let moving = |velocity: f64, acceleration: f64| State { position: 0.0, velocity, acceleration };
    let axes = || {
        vec![
            (moving(0.1, 0.5), State::at_rest(0.2), limits()),
            (moving(0.2, 1.0), State::at_rest(0.4), limits()),
            (moving(0.1, 0.5), State::at_rest(0.2), LimitsSpec { max_jerk: 5.0, ..limits() }),
        ]
    };
    // The second goes farthest, and takes longest alone. On the line it holds back the cruise, and the third, with a quarter of the jerk,
    // the ramps, which are longer.
    for (synchronization, critical) in
        [(Synchronization::None, "y"), (Synchronization::Time, "y"), (Synchronization::Phase, "z")]
    {
        let judged = answered(spec(axes(), Family::SCurve, synchronization)).unwrap();
        assert_eq!(judged.explanation().critical_axis, critical, "{synchronization:?}");
        let least = judged.plan().duration();
        for (minimum, critical) in [(0.5 * least, critical), (1.5 * least, "")] {
            let minimum_duration = Some(minimum);
            let asked = RequestSpec { minimum_duration, ..spec(axes(), Family::SCurve, synchronization) };
            let said = answered(asked).unwrap().explanation().critical_axis.to_owned();
            // Of axes that do not wait for each other one takes longest, whoever asked for that.
            let critical = if synchronization == Synchronization::None { "y" } else { critical };
            assert_eq!(said, critical, "{synchronization:?}, {minimum} s");
        }
        let on_cycle = RequestSpec { end_on_cycle: true, ..spec(axes(), Family::SCurve, synchronization) };
        if synchronization != Synchronization::None {
            assert_eq!(answered(on_cycle).unwrap().explanation().critical_axis, "", "{synchronization:?}");
        }
    }
}

/// Order 2 keeps no jerk: what its stops may have follows from the acceleration and the cycle.
#[test]
fn order_two_needs_no_jerk() {
    let without = LimitsSpec { max_jerk: 0.0, max_deceleration: Some(3.0), ..limits() };
    let asked = |family, order, limits: &LimitsSpec| {
        let axes = vec![(State::at_rest(0.0), State::at_rest(0.2), limits.clone())];
        answered(RequestSpec {
            order,
            cycle_time_ns: Some(2_000_000),
            ..spec(axes, family, Synchronization::None)
        })
    };
    let symmetric = LimitsSpec { max_deceleration: None, ..without.clone() };
    for (family, order, limits, hardest) in
        [(Family::Trapezoidal, None, &without, 3.0), (Family::Polynomial, Some(2), &symmetric, 2.0)]
    {
        let judged = asked(family, order, limits).unwrap();
        assert!(judged.certificate().passed(), "{family:?}");
        let stated = judged.plan().axes()[0].limits.jerk();
        assert!((stated / (hardest / 0.002) - 1.0).abs() <= f64::EPSILON, "{family:?}: {stated}");
        // The plan is the one that any other limit gives, and the limit that is stated is kept as it is.
        let stated = asked(family, order, &LimitsSpec { max_jerk: 7.0, ..limits.clone() }).unwrap();
        assert_eq!(stated.plan().axes()[0].profile, judged.plan().axes()[0].profile, "{family:?}");
    }
    for (family, order) in
        [(Family::SCurve, None), (Family::Polynomial, Some(3)), (Family::Trigonometric, None)]
    {
        let refused = asked(family, order, &without).unwrap_err().to_string();
        assert!(refused.contains("axes[0].limits.max_jerk: is 0"), "{family:?}: {refused}");
    }
}

/// States as they come, in bounds that are drawn with them.
fn drawn(seed: u64) -> RequestSpec {
    let mut random = Random(seed);
    let count = 2 + random.bits() as usize % 4;
    let axes = (0..count).map(|_| {
        let limits = LimitsSpec {
            max_velocity: random.decades(0.05, 2.0),
            max_acceleration: random.decades(0.2, 10.0),
            max_jerk: random.decades(1.0, 200.0),
            max_deceleration: None,
            ..LimitsSpec::default()
        };
        let limits = if random.unit() < 0.3 {
            LimitsSpec {
                max_deceleration: Some(limits.max_acceleration * random.decades(0.5, 2.0)),
                ..limits
            }
        } else {
            limits
        };
        let mut state = |moving: bool| {
            let part = |random: &mut Random| if moving { random.between(-0.5, 0.5) } else { 0.0 };
            State {
                position: random.between(-1.0, 1.0),
                velocity: part(&mut random) * limits.max_velocity,
                acceleration: part(&mut random)
                    * limits.max_acceleration.min(limits.max_deceleration.unwrap_or(f64::MAX))
                    * 0.3,
            }
        };
        let (start, goal) = (state(true), state(false));
        (start, goal, limits)
    });
    let axes = axes.collect();
    RequestSpec {
        short_path: Ok(ShortPathPolicy::Reverse),
        ..spec(axes, Family::SCurve, Synchronization::Time)
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_states_arrive_together(seed in any::<u64>(), on_cycle in any::<bool>()) {
        let asked = RequestSpec { end_on_cycle: on_cycle, ..drawn(seed) };
        let judged = answered(asked).unwrap();
        prop_assert!(judged.certificate().passed());
        all_arrive_at_the_end(judged.plan());
        if on_cycle {
            let plan = judged.plan();
            prop_assert!((plan.duration() - plan.cycle_time().start_of(plan.cycle_count())).abs() <= 1e-12 * plan.duration());
        }
    }
}
