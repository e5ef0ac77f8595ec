//! The words of every refusal, and where each is said: a copied message is a fault that no compiler sees.

#![allow(clippy::unwrap_used, clippy::unwrap_in_result, reason = "a test may fail by panicking")]

use planner::{
    AxisKind, AxisMoveSpec, CycleTime, Family, Field, InvalidFields, Limits, LimitsSpec, Method, Plan,
    Problem, Request, RequestSpec, ShortPathPolicy, State, Synchronization, Why, plan, plan_move,
    plan_polynomial, plan_trigonometric,
};

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 1.0, max_acceleration: 2.0, max_jerk: 3.0, ..LimitsSpec::default() }
}

fn moving(position: f64, velocity: f64) -> State {
    State { position, velocity, acceleration: 0.0 }
}

fn axis(name: &str, goal: State) -> AxisMoveSpec {
    let (axis, kind, start) = (name.into(), Ok(AxisKind::Prismatic), State::at_rest(0.0));
    AxisMoveSpec { axis, kind, start, goal, limits: limits() }
}

fn request(axes: Vec<AxisMoveSpec>) -> RequestSpec {
    RequestSpec {
        axes,
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    }
}

/// Each refusal on a line of its own.
fn lines(refusal: &InvalidFields) -> Vec<String> {
    refusal.as_slice().iter().map(ToString::to_string).collect()
}

#[track_caller]
fn check<T: std::fmt::Debug>(result: Result<T, InvalidFields>, expected: &[&str]) {
    assert_eq!(lines(&result.unwrap_err()), expected);
}

fn problem(start: State, goal: State, limits: LimitsSpec) -> Result<Problem, InvalidFields> {
    Problem::new(start, goal, limits.try_into().unwrap(), ShortPathPolicy::Reject)
}

#[test]
fn the_words_of_every_reason() {
    let choices = "S_CURVE, TRAPEZOIDAL";
    let (given, allowed, limit) = (2.5, 2.0, "limits.max_velocity");
    let rows = [
        (Why::NotFinite { given: f64::NAN }, "is NaN: give a finite number of at most 1e60 in magnitude"),
        (
            Why::NotPositive { given: -1.5 },
            "is -1.5: a limit is a magnitude, at least 1e-60; its sign is not needed",
        ),
        (Why::NotFinite { given: 1.5e300 }, "is 1.5e300: give a finite number of at most 1e60 in magnitude"),
        (Why::DurationNotPositive { given: -2e-5 }, "is -2e-5 s: give a time above 0"),
        (
            Why::NegativeDuration { given: -2.0 },
            "is -2 s: give the least duration, above 0, or 0 to ask nothing",
        ),
        (
            Why::NegativeReverse { given: -1.0 },
            "is -1: a limit is a magnitude, so leave the sign out; 0 forbids to go back",
        ),
        (
            Why::Misstated { given: "5".into(), correct: "314".into() },
            "says 5, and should say 314: correct it, or plan again",
        ),
        (
            Why::FingerprintMismatch { given: "00ff".into(), correct: "1234".into() },
            "is 00ff, that of another plan; this one has 1234: plan again, or leave it out where the change is meant",
        ),
        (
            Why::EmptyRange { min: 2.0, max: 1.0 },
            "the range from 2 to 1 is empty: exchange min_position and max_position",
        ),
        (Why::Unspecified { choices }, "is not set: choose one of S_CURVE, TRAPEZOIDAL"),
        (
            Why::UnknownChoice { given: 9, choices },
            "is 9, which this version does not know: choose one of S_CURVE, TRAPEZOIDAL",
        ),
        (
            Why::UnknownName { given: "S".into(), choices },
            "is \"S\", which this version does not know: use one of S_CURVE, TRAPEZOIDAL",
        ),
        (Why::OrderUnsupported { given: 11 }, "asks for order 11: a polynomial has an order of 2 to 8"),
        (Why::OrderMissing, "is not set: say the order of the polynomial, 2 to 8"),
        (
            Why::OrderOfFamily { given: 4, family: "S_CURVE", order: 3 },
            "asks for order 4: the family S_CURVE has order 3, so leave it out or choose POLYNOMIAL",
        ),
        (
            Why::LimitMissing { order: 5, lower: 4 },
            "is not set, and order 5 needs it: state the limit, or ask for order 4",
        ),
        (
            Why::LimitsTooFew { order: 7, needed: 3, given: 1, lower: 5 },
            "has 1 limit, and order 7 needs 3, of the fifth derivative up to its own: add what is missing, or ask for order 5",
        ),
        (
            Why::NotAtRest { given: 0.5, family: "TRIGONOMETRIC" },
            "is 0.5: the family TRIGONOMETRIC goes from rest to rest, so give 0 or choose S_CURVE",
        ),
        (Why::EvaluationVersion { given: 9 }, "is 9, and this planner evaluates version 1: plan again here"),
        (
            Why::DuplicateAxis { name: "x".into() },
            "the name \"x\" is taken by an axis before it: give every axis a name of its own",
        ),
        (
            Why::NameTooLong { given: 300, allowed: 256 },
            "has 300 bytes: a name has at most 256, so shorten it",
        ),
        (
            Why::UnknownAxis { name: "z".into(), known: "x, y".into() },
            "no axis is called \"z\": the plan has x, y",
        ),
        (Why::NoAxes, "is empty: give at least one axis"),
        (
            Why::TooManyAxes { given: 65, allowed: 64 },
            "has 65 axes: a plan takes at most 64, so split the request",
        ),
        (
            Why::TooManySegments { given: 9, allowed: 8 },
            "has 9 segments: an axis takes at most 8, so split the plan",
        ),
        (
            Why::TooManyCycles { seconds: 1e20 },
            "lasts 1e20 s, more cycles than can be counted: raise the limits or lengthen cycle_time",
        ),
        (
            Why::CycleTime { given_ns: 1, min_ns: 10_000, max_ns: 1_000_000_000 },
            "is 1 ns: a cycle lasts from 10000 to 1000000000 ns",
        ),
        (
            Why::NotImplemented { what: "an order", instead: "leave it out" },
            "an order is not implemented: leave it out",
        ),
        (
            Why::StartOutsideLimits { given, allowed, limit },
            "is 2.5, beyond 2: begin inside the limit or raise limits.max_velocity",
        ),
        (
            Why::GoalOutsideLimits { given, allowed, limit },
            "is 2.5, beyond 2: end inside the limit or raise limits.max_velocity",
        ),
        (
            Why::PositionLimit { reached: 3.0, time: 1.5, allowed, limit: "limits.max_position" },
            "the motion reaches 3 at 1.5 s, beyond 2: stay inside or move limits.max_position",
        ),
        (
            Why::PathTooShort { needed: 2.0, given: 1.0, nearest_velocity: 0.5 },
            "the path of 1 is too short to change from the start to the end velocity, which needs 2: lengthen it, end \
             at a velocity of 0.5, or name a short_path_policy",
        ),
        (
            Why::OffTheLine { given: 0.25, needed: 0.5 },
            "is 0.25, and the straight line needs 0.5: give it that, or let the axes arrive together without a line",
        ),
        (
            Why::ArrivesEarly { given: 3.0, greatest: 2.0 },
            "takes at most 2 s, and the motion lasts 3 s: allow it to go back, or plan it by itself",
        ),
    ];
    for (why, text) in rows {
        assert_eq!(why.to_string(), text);
    }
}

#[test]
fn several_refusals_in_one_text() {
    let mut refusal = InvalidFields::one(Field::named("a"), Why::NoAxes);
    refusal.note("b", None);
    refusal.note("b", Some(Why::NoAxes));
    refusal.note("", Some(Why::NoAxes));
    let each = "is empty: give at least one axis";
    assert_eq!(refusal.to_string(), format!("a: {each}; b: {each}; {each}"));
}

#[test]
fn everything_that_is_wrong_is_said_at_once() {
    let mut first = axis("x", moving(f64::INFINITY, 0.0));
    first.limits.max_velocity = -1.0;
    first.limits.max_jerk = -2.0;
    first.limits.min_position = Some(1.0);
    first.limits.max_position = Some(0.0);
    first.limits.feed_rate = Some(f64::NAN);
    let mut second = axis("x", moving(1.0, 2.0));
    second.start = State { position: 0.0, velocity: 3.0, acceleration: 1.0 };
    let third = AxisMoveSpec {
        kind: Err(Why::Unspecified { choices: "PRISMATIC" }),
        ..axis("z", State::at_rest(2e60))
    };
    let spec = RequestSpec {
        cycle_time_ns: Some(-5),
        family: Ok(Family::Trapezoidal),
        order: Some(4),
        short_path: Err(Why::UnknownChoice { given: 7, choices: "REJECT" }),
        synchronization: Ok(Synchronization::Phase),
        minimum_duration: Some(f64::NAN),
        end_on_cycle: true,
        ..request(vec![first, second, third])
    };
    check(
        Request::try_from(spec),
        &[
            "order: asks for order 4: the family TRAPEZOIDAL has order 2, so leave it out or choose POLYNOMIAL",
            "minimum_duration: is NaN: give a finite number of at most 1e60 in magnitude",
            "short_path_policy: is 7, which this version does not know: choose one of REJECT",
            "synchronization: a straight line for several axes of this family is not implemented: choose S_CURVE, or \
             SYNCHRONIZATION_TIME: the axes then arrive together",
            "cycle_time: is -5 ns: a cycle lasts from 10000 to 1000000000 ns",
            "axes[1].axis: the name \"x\" is taken by an axis before it: give every axis a name of its own",
            "axes[0].limits.max_velocity: is -1: a limit is a magnitude, at least 1e-60; its sign is not needed",
            "axes[0].limits.max_jerk: is -2: a limit is a magnitude, at least 1e-60; its sign is not needed",
            "axes[0].limits.feed_rate: is NaN: give a finite number of at most 1e60 in magnitude",
            "axes[0].limits.max_position: the range from 1 to 0 is empty: exchange min_position and max_position",
            "axes[0].goal.position: is inf: give a finite number of at most 1e60 in magnitude",
            "axes[1].start.velocity: is 3, beyond 1: begin inside the limit or raise limits.max_velocity",
            "axes[1].start.acceleration: an acceleration at the start or the goal is not implemented: begin and end \
             with an acceleration of zero, or ask for a move of family S_CURVE",
            "axes[1].goal.velocity: is 2, beyond 1: end inside the limit or raise limits.max_velocity",
            "axes[2].kind: is not set: choose one of PRISMATIC",
            "axes[2].goal.position: is 2e60: give a finite number of at most 1e60 in magnitude",
        ],
    );
}

#[test]
fn every_number_of_a_limit_is_checked() {
    let mut spec = LimitsSpec {
        max_velocity: f64::NAN,
        max_acceleration: -2.0,
        max_jerk: 1e61,
        max_deceleration: Some(0.0),
        max_velocity_reverse: Some(-1.0),
        min_position: Some(f64::NEG_INFINITY),
        max_position: Some(f64::NAN),
        max_snap: Some(1e-61),
        feed_rate: Some(-0.0),
        ..LimitsSpec::default()
    };
    spec.max_higher_derivatives.push(-1.0);
    let fields: Vec<_> =
        Limits::try_from(spec).unwrap_err().as_slice().iter().map(|f| f.field.to_string()).collect();
    let expected = [
        "max_velocity",
        "max_acceleration",
        "max_jerk",
        "max_deceleration",
        "max_snap",
        "feed_rate",
        "max_higher_derivatives[0]",
        "max_velocity_reverse",
        "min_position",
        "max_position",
    ];
    assert_eq!(fields, expected);
}

#[test]
fn ends_outside_the_limits() {
    let ranged = LimitsSpec { min_position: Some(-1.0), max_position: Some(1.0), ..limits() };
    check(
        problem(State::at_rest(-2.0), State::at_rest(3.0), ranged),
        &[
            "start.position: is -2, beyond -1: begin inside the limit or raise limits.min_position",
            "goal.position: is 3, beyond 1: end inside the limit or raise limits.max_position",
        ],
    );
    let slow = LimitsSpec { feed_rate: Some(0.5), max_velocity_reverse: Some(0.25), ..limits() };
    check(
        problem(moving(0.0, 0.75), moving(1.0, 1.5), slow.clone()),
        &[
            "start.velocity: is 0.75, beyond 0.5: begin inside the limit or raise limits.feed_rate",
            "goal.velocity: is 1.5, beyond 1: end inside the limit or raise limits.max_velocity",
        ],
    );
    check(
        problem(moving(0.0, -0.375), moving(-1.0, 0.0), slow),
        &[
            "start.velocity: is -0.375, beyond -0.25: begin inside the limit or raise limits.max_velocity_reverse",
        ],
    );
    let one_way = LimitsSpec { max_velocity_reverse: Some(0.0), ..limits() };
    check(
        problem(State::at_rest(0.0), State::at_rest(-1.0), one_way),
        &["goal.position: is -1, beyond 0: end inside the limit or raise limits.max_velocity_reverse"],
    );
}

#[test]
fn what_a_later_version_will_do() {
    check(
        problem(moving(0.0, -0.5), moving(1.0, -0.5), limits()),
        &["start.velocity", "goal.velocity"].map(|end| {
            format!(
                "{end}: a velocity against the direction of travel is not implemented: begin and end with velocities \
                 that point from the start to the goal, or choose S_CURVE"
            )
        })
        .each_ref()
        .map(String::as_str),
    );
    let reverse = Problem::new(
        moving(0.0, 0.5),
        State::at_rest(1e-3),
        limits().try_into().unwrap(),
        ShortPathPolicy::Reverse,
    );
    check(
        plan_move(&reverse.unwrap()),
        &[
            "goal.velocity: short_path_policy REVERSE on a path that is too short is not implemented: choose REJECT, \
           NEAREST_VELOCITY or MATCH_START_VELOCITY",
        ],
    );
}

/// What is due anyway asks nothing.
#[test]
fn a_minimum_duration_that_asks_something() {
    // Neither 1 m/s nor 2 m/s² is reached: T = 4·∛(s/2j).
    let least = 4.0 * (0.5 / 6.0f64).cbrt();
    let asked = |minimum_duration| {
        let spec = RequestSpec { minimum_duration, ..request(vec![axis("x", State::at_rest(0.5))]) };
        Request::try_from(spec).and_then(|request| plan(&request))
    };
    for nothing in [None, Some(0.0), Some(-0.0), Some(1e-60), Some(0.999 * least)] {
        let plan = asked(nothing).unwrap();
        assert!((plan.duration() - least).abs() < 1e-12, "{nothing:?}: {} {least}", plan.duration());
    }
    let more = asked(Some(1.001 * least)).unwrap();
    assert!((more.duration() - 1.001 * least).abs() < 1e-12 && planner::certify(&more).passed());
    let seconds = "lasts 1e60 s";
    let refused = asked(Some(1e60)).unwrap_err().to_string();
    assert!(refused.contains(seconds), "{refused}");
    check(
        asked(Some(-1.0)),
        &["minimum_duration: is -1 s: give the least duration, above 0, or 0 to ask nothing"],
    );
    let infinite = "minimum_duration: is inf: give a finite number of at most 1e60 in magnitude";
    check(asked(Some(f64::INFINITY)), &[infinite]);
}

fn ask(family: Family, order: Option<u32>, axis: AxisMoveSpec) -> Result<Request, InvalidFields> {
    Request::try_from(RequestSpec { family: Ok(family), order, ..request(vec![axis]) })
}

#[test]
fn orders_that_a_family_does_not_have() {
    let axis = || axis("x", State::at_rest(1.0));
    check(
        ask(Family::Polynomial, None, axis()),
        &["order: is not set: say the order of the polynomial, 2 to 8"],
    );
    for order in [0, 1, 9, 40, u32::MAX] {
        let said = format!("order: asks for order {order}: a polynomial has an order of 2 to 8");
        check(ask(Family::Polynomial, Some(order), axis()), &[&said]);
    }
    for (family, own) in [(Family::SCurve, 3), (Family::Trapezoidal, 2), (Family::Trigonometric, 3)] {
        assert_eq!(ask(family, Some(own), axis()).unwrap().order(), own);
        let said = format!(
            "order: asks for order 5: the family {} has order {own}, so leave it out or choose POLYNOMIAL",
            family.name()
        );
        check(ask(family, Some(5), axis()), &[&said]);
    }
    for order in [0, 1, 9] {
        let problem = problem(State::at_rest(0.0), State::at_rest(1.0), limits()).unwrap();
        check(
            plan_polynomial(&problem, order),
            &[&format!("order: asks for order {order}: a polynomial has an order of 2 to 8")],
        );
    }
}

#[test]
fn limits_that_an_order_needs() {
    let with = |max_snap: Option<f64>, higher: usize| AxisMoveSpec {
        limits: LimitsSpec { max_snap, max_higher_derivatives: vec![7.0; higher], ..limits() },
        ..axis("x", State::at_rest(1.0))
    };
    let snap = "axes[0].limits.max_snap: is not set, and order";
    let higher = "axes[0].limits.max_higher_derivatives: is not set, and order";
    let rows = [
        (4, with(None, 0), vec![format!("{snap} 4 needs it: state the limit, or ask for order 3")]),
        (
            5,
            with(None, 0),
            vec![
                format!("{snap} 5 needs it: state the limit, or ask for order 3"),
                format!("{higher} 5 needs it: state the limit, or ask for order 3"),
            ],
        ),
        (5, with(None, 1), vec![format!("{snap} 5 needs it: state the limit, or ask for order 3")]),
        (
            8,
            with(Some(1.0), 3),
            vec![
                "axes[0].limits.max_higher_derivatives: has 3 limits, and order 8 needs 4, of the fifth derivative up to its own: \
                 add what is missing, or ask for order 7"
                    .to_owned(),
            ],
        ),
    ];
    for (order, axis, said) in rows {
        let said: Vec<&str> = said.iter().map(String::as_str).collect();
        check(ask(Family::Polynomial, Some(order), axis), &said);
    }
    for (order, axis) in
        [(2, with(None, 0)), (3, with(None, 0)), (4, with(Some(1.0), 0)), (8, with(Some(1.0), 4))]
    {
        assert_eq!(ask(Family::Polynomial, Some(order), axis).unwrap().order(), order);
    }
}

#[test]
fn ends_in_motion_for_families_that_need_rest() {
    for (family, order) in [(Family::Polynomial, Some(2)), (Family::Trigonometric, None)] {
        let start = State { position: 0.0, velocity: -0.5, acceleration: 0.25 };
        let axis = AxisMoveSpec { start, ..axis("x", moving(1.0, 0.125)) };
        let rest =
            format!("the family {} goes from rest to rest, so give 0 or choose S_CURVE", family.name());
        check(
            ask(family, order, axis),
            &[
                &format!("axes[0].start.velocity: is -0.5: {rest}"),
                &format!("axes[0].start.acceleration: is 0.25: {rest}"),
                &format!("axes[0].goal.velocity: is 0.125: {rest}"),
            ],
        );
        let nan = AxisMoveSpec { start: moving(0.0, f64::NAN), ..self::axis("x", State::at_rest(1.0)) };
        let said = "axes[0].start.velocity: is NaN: give a finite number of at most 1e60 in magnitude";
        check(ask(family, order, nan), &[said]);
    }
    let problem = problem(moving(0.0, 0.5), State::at_rest(1.0), limits()).unwrap();
    let said = |family: &str| {
        format!(
            "start.velocity: is 0.5: the family {family} goes from rest to rest, so give 0 or choose S_CURVE"
        )
    };
    check(plan_polynomial(&problem, 3), &[&said("POLYNOMIAL")]);
    check(plan_trigonometric(&problem), &[&said("TRIGONOMETRIC")]);
}

#[test]
fn plans_that_are_too_large() {
    check(Request::try_from(request(vec![])), &["axes: is empty: give at least one axis"]);
    let many = (0..65).map(|index| axis(&format!("a{index}"), moving(f64::NAN, 0.0))).collect();
    check(
        Request::try_from(request(many)),
        &["axes: has 65 axes: a plan takes at most 64, so split the request"],
    );
    let all = (0..64).map(|index| axis(&format!("a{index}"), State::at_rest(1.0))).collect();
    assert_eq!(plan(&Request::try_from(request(all)).unwrap()).unwrap().axes().len(), 64);

    let mut slow = axis("x", State::at_rest(1e20));
    slow.limits.max_velocity = 0.5;
    let slow = Request::try_from(request(vec![slow])).unwrap();
    check(
        plan(&slow),
        &["axes: lasts 2e20 s, more cycles than can be counted: raise the limits or lengthen cycle_time"],
    );
    let nothing = Plan::new(Method::default(), vec![], CycleTime::MILLISECOND, vec![]);
    check(nothing, &["axes: is empty: give at least one axis"]);
}

#[test]
fn a_short_path_is_named_with_its_axis_and_its_sign() {
    let spec = request(vec![AxisMoveSpec { start: moving(0.0, -0.5), ..axis("x", State::at_rest(-0.125)) }]);
    // D(0.5, 0) = 0.25·2·√(1/6) = 0.204.
    let refusal = plan(&Request::try_from(spec).unwrap()).unwrap_err();
    let text = refusal.to_string();
    assert!(text.starts_with("axes[0].goal.velocity: the path of -0.125 is too short"), "{text}");
    assert!(text.contains("which needs -0.204124145"), "{text}");
    let Why::PathTooShort { nearest_velocity, .. } = refusal.as_slice()[0].why else { panic!("{text}") };
    assert!(nearest_velocity < 0.0 && nearest_velocity > -0.5, "{text}");
}
