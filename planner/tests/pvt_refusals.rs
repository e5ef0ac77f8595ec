//! The words of every refusal of points, and where each is said.

#![allow(clippy::float_cmp, reason = "what is kept is kept to the last bit")]
#![allow(
    clippy::unwrap_used,
    clippy::unwrap_in_result,
    clippy::panic,
    reason = "a test may fail by panicking"
)]

use planner::{
    AxisKind, InvalidFields, LimitsSpec, PvtAxisSpec, PvtInterpolation, PvtPlan, PvtPlanner, PvtPolicy,
    PvtRequest, PvtRequestSpec, PvtTarget, State, Why, plan_pvt,
};

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 1.0, max_acceleration: 2.0, max_jerk: 4.0, ..LimitsSpec::default() }
}

fn axis(name: &str, times: &[f64], positions: &[f64], velocities: &[f64]) -> PvtAxisSpec {
    PvtAxisSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        limits: limits(),
        start: State::at_rest(0.0),
        times: times.to_vec(),
        positions: positions.to_vec(),
        velocities: velocities.to_vec(),
    }
}

fn request(axes: Vec<PvtAxisSpec>) -> PvtRequestSpec {
    PvtRequestSpec {
        axes,
        cycle_time_ns: None,
        interpolation: Ok(PvtInterpolation::SShaped),
        policy: Ok(PvtPolicy::Reject),
        finish_unreached: false,
    }
}

fn plan(spec: PvtRequestSpec) -> Result<PvtPlan, InvalidFields> {
    plan_pvt(&PvtRequest::try_from(spec)?)
}

#[track_caller]
fn check<T: std::fmt::Debug>(result: Result<T, InvalidFields>, expected: &[&str]) {
    let lines: Vec<_> = result.unwrap_err().as_slice().iter().map(ToString::to_string).collect();
    assert_eq!(lines, expected);
}

fn check_axis(spec: PvtAxisSpec, expected: &[&str]) {
    check(plan(request(vec![spec])), expected);
}

#[test]
fn lists_that_are_no_points() {
    check_axis(axis("x", &[], &[], &[]), &["axes[0].times: is empty: give at least one point"]);
    check_axis(
        axis("x", &[1.0, 2.0], &[0.5], &[0.0, 0.0, 0.0]),
        &[
            "axes[0].positions: has 1 elements, and times has 2: give every point a time, a position and a velocity",
            "axes[0].velocities: has 3 elements, and times has 2: give every point a time, a position and a velocity",
        ],
    );
    // What is wrong where one list has no number any more is told at once.
    check_axis(
        axis("x", &[1.0, 2.0], &[0.5], &[0.0, 1.5]),
        &[
            "axes[0].positions: has 1 elements, and times has 2: give every point a time, a position and a velocity",
            "axes[0].velocities[1]: is 1.5, beyond 1: end inside the limit or raise limits.max_velocity",
        ],
    );
    check(plan(request(Vec::new())), &["axes: is empty: give at least one axis"]);
    let point = || axis("x", &[1.0], &[0.0], &[0.0]);
    check(
        plan(request(vec![point(), point()])),
        &["axes[1].axis: the name \"x\" is taken by an axis before it: give every axis a name of its own"],
    );
    check(
        plan(request(vec![point(); 65])),
        &["axes: has 65 axes: a plan takes at most 64, so split the request"],
    );
}

#[test]
fn times_that_do_not_go_on() {
    check_axis(
        axis("x", &[0.0, 1.0, 1.0, 0.5, f64::NAN, 2.0, 2.0005], &[0.0; 7], &[0.0; 7]),
        &[
            "axes[0].times[0]: is 0 s, not after 0 s: times count from the start and increase from point to point",
            "axes[0].times[2]: is 1 s, not after 1 s: times count from the start and increase from point to point",
            "axes[0].times[3]: is 0.5 s, not after 1 s: times count from the start and increase from point to point",
            "axes[0].times[4]: is NaN: give a finite number of at most 1e60 in magnitude",
            "axes[0].times[5]: is 2 s, not after NaN s: times count from the start and increase from point to point",
            "axes[0].times[6]: is 0.000500000000000167 s after the point before it, less than a cycle of 0.001 s: leave \
             the point out or shorten cycle_time",
        ],
    );
    // Of many the first.
    let back: Vec<f64> = (0..1000).map(|n| -f64::from(n)).collect();
    assert_eq!(plan(request(vec![axis("x", &back, &back, &[0.0; 1000])])).unwrap_err().as_slice().len(), 8);
    let (x, y) = (axis("x", &[1.0, 2.0], &[0.0; 2], &[0.0; 2]), axis("y", &[1.0, 2.5], &[0.0; 2], &[0.0; 2]));
    check(
        plan(request(vec![x.clone(), y])),
        &["axes[1].times[1]: is 2.5 s, and axes[0] has 2 s: axes share their times, so give the same to all"],
    );
    check(
        plan(request(vec![x, axis("y", &[1.0], &[0.0], &[0.0])])),
        &[
            "axes[1].times: has 1 elements, and axes[0].times has 2: give every point a time, a position and a velocity",
        ],
    );
}

#[test]
fn points_and_starts_outside_the_limits() {
    let ranged = LimitsSpec {
        max_velocity_reverse: Some(0.5),
        min_position: Some(-1.0),
        max_position: Some(2.0),
        ..limits()
    };
    let spec = PvtAxisSpec {
        limits: ranged,
        start: State { position: 3.0, velocity: -0.75, acceleration: 0.0 },
        ..axis("x", &[1.0, 2.0, 3.0], &[-1.5, 2.5, f64::INFINITY], &[1.5, -0.75, 0.0])
    };
    check_axis(
        spec,
        &[
            "axes[0].start.position: is 3, beyond 2: begin inside the limit or raise limits.max_position",
            "axes[0].start.velocity: is -0.75, beyond -0.5: begin inside the limit or raise limits.max_velocity_reverse",
            "axes[0].positions[0]: is -1.5, beyond -1: end inside the limit or raise limits.min_position",
            "axes[0].velocities[0]: is 1.5, beyond 1: end inside the limit or raise limits.max_velocity",
            "axes[0].positions[1]: is 2.5, beyond 2: end inside the limit or raise limits.max_position",
            "axes[0].velocities[1]: is -0.75, beyond -0.5: end inside the limit or raise limits.max_velocity_reverse",
            "axes[0].positions[2]: is inf: give a finite number of at most 1e60 in magnitude",
        ],
    );
    let start = State { position: f64::NAN, velocity: 0.0, acceleration: 0.0 };
    check_axis(
        PvtAxisSpec { start, ..axis("x", &[1.0], &[0.0], &[0.0]) },
        &["axes[0].start.position: is NaN: give a finite number of at most 1e60 in magnitude"],
    );
    let start = State { acceleration: 1.0, ..State::default() };
    check_axis(
        PvtAxisSpec { start, ..axis("x", &[1.0], &[0.0], &[0.0]) },
        &[
            "axes[0].start.acceleration: an acceleration at the start or the goal is not implemented: begin and end with \
             an acceleration of zero, or ask for a move of family S_CURVE",
        ],
    );
}

#[test]
fn choices_and_limits_that_cannot_be_read() {
    let spec = PvtRequestSpec {
        cycle_time_ns: Some(1),
        interpolation: Err(Why::UnknownChoice { given: 9, choices: "S_SHAPED" }),
        policy: Err(Why::UnknownChoice { given: 8, choices: "REJECT" }),
        ..request(vec![PvtAxisSpec {
            kind: Err(Why::Unspecified { choices: "PRISMATIC" }),
            limits: LimitsSpec { max_jerk: 0.0, ..limits() },
            ..axis("x", &[1.0], &[0.0], &[0.0])
        }])
    };
    check(
        plan(spec),
        &[
            "interpolation: is 9, which this version does not know: choose one of S_SHAPED",
            "policy: is 8, which this version does not know: choose one of REJECT",
            "cycle_time: is 1 ns: a cycle lasts from 10000 to 1000000000 ns",
            "axes[0].kind: is not set: choose one of PRISMATIC",
            "axes[0].limits.max_jerk: is 0: a limit is a magnitude, at least 1e-60; its sign is not needed",
        ],
    );
}

/// Each axis's first point that cannot be met, with what could be; and what is offered is accepted.
#[test]
fn points_that_cannot_be_met() {
    let spec = request(vec![
        axis("x", &[0.5, 1.5], &[0.0, 0.5], &[0.0, 0.0]),
        axis("y", &[0.5, 1.5], &[0.0, 0.1], &[1.0, 0.0]),
    ]);
    check(
        plan(spec),
        &[
            "axes[0].positions[1]: is 0.5, and 1 s lead to between -0.125 and 0.125: move the point to 0.125, keep the \
             position with a velocity of 1, allow 1.5874010519681987 s, or name a policy that adjusts",
            "axes[1].velocities[0]: is 1, and 0.5 s do not suffice for that: ask for a velocity of 0.25 at the position \
             0.0625, keep the position with a velocity of 0.059016994374947424, allow 2.1021287890229274 s, or name a \
             policy that adjusts",
        ],
    );
    assert!(plan(request(vec![axis("x", &[1.5874010519681987], &[0.5], &[0.0])])).is_ok());
    assert!(plan(request(vec![axis("y", &[2.1021287890229274], &[0.0], &[1.0])])).is_ok());
    assert!(plan(request(vec![axis("y", &[0.5], &[0.0625], &[0.25])])).is_ok());
    assert!(plan(request(vec![axis("y", &[0.5], &[0.0], &[0.059016994374947424])])).is_ok());
    assert!(plan(request(vec![axis("x", &[1.0], &[0.125], &[0.0])])).is_ok());
}

/// An axis that must not go back cannot wait.
#[test]
fn no_time_helps_an_axis_that_is_past_its_point() {
    let one_way = PvtAxisSpec {
        limits: LimitsSpec { max_velocity_reverse: Some(0.0), ..limits() },
        start: State { velocity: 1.0, ..State::default() },
        ..axis("x", &[2.0], &[0.1], &[1.0])
    };
    for policy in [PvtPolicy::ExtendTime, PvtPolicy::Reject] {
        let spec = PvtRequestSpec { policy: Ok(policy), ..request(vec![one_way.clone()]) };
        let said = plan(spec).unwrap_err().to_string();
        assert!(said.starts_with("axes[0].positions[0]: is 0.1, and 2 s lead to between 1 and 2:"), "{said}");
        assert!(said.contains("allow the axis to go back, since no longer time helps"), "{said}");
    }
}

#[test]
fn a_range_that_the_way_leaves() {
    // It ends inside, at a speed towards the outside that it gets by swinging out.
    let over = axis("x", &[2.0], &[0.55], &[-0.25]);
    let limits = LimitsSpec { max_position: Some(0.6), ..limits() };
    assert!(plan(request(vec![over.clone()])).is_ok());
    let said =
        plan(request(vec![PvtAxisSpec { limits: limits.clone(), ..over.clone() }])).unwrap_err().to_string();
    assert!(said.starts_with("axes[0].positions[0]: the motion to 0.55 reaches 0.60025"), "{said}");
    assert!(said.contains(" at 1.4682458"), "{said}");
    let way_out = "s, beyond 0.6: move the point to 0.5345758313396782, ask for less on the way to it, or move limits.max_position";
    assert!(said.ends_with(way_out), "{said}");
    let mended = PvtAxisSpec { positions: vec![0.5345758313396782], limits: limits.clone(), ..over.clone() };
    assert!(plan(request(vec![mended])).is_ok());
    // Time counts from the start, whatever point it is.
    let later = PvtAxisSpec {
        times: vec![1.0, 3.0],
        positions: vec![0.0, 0.55],
        velocities: vec![0.0, -0.25],
        limits: limits.clone(),
        ..over
    };
    let said = plan(request(vec![later])).unwrap_err().to_string();
    assert!(said.starts_with("axes[0].positions[1]: the motion to 0.55 reaches 0.60025"), "{said}");
    assert!(said.contains(" at 2.4682458"), "{said}");
    // And so it does of the way to a last point that was missed.
    let finish = PvtRequestSpec {
        policy: Ok(PvtPolicy::PreferVelocity),
        finish_unreached: true,
        ..request(vec![PvtAxisSpec { limits, ..axis("x", &[1.0, 2.0], &[0.0, 0.55], &[0.0, -0.25]) }])
    };
    let said = plan(finish).unwrap_err();
    let Why::PositionLimit { reached, time, .. } = said.as_slice()[0].why else { panic!("{said}") };
    assert!(reached > 0.6 && time > 2.0, "{said}");
}

#[test]
fn a_finish_that_cannot_be() {
    // Past its point, it would have to go back.
    let limits = LimitsSpec { max_velocity_reverse: Some(0.0), ..limits() };
    let start = State { velocity: 1.0, ..State::default() };
    let spec = PvtAxisSpec { start, limits, ..axis("x", &[0.5], &[0.1], &[1.0]) };
    let spec = PvtRequestSpec {
        policy: Ok(PvtPolicy::PreferVelocity),
        finish_unreached: true,
        ..request(vec![spec])
    };
    let said = plan(spec).unwrap_err().to_string();
    assert!(said.starts_with("axes[0].positions[0]: is 0.1, beyond "), "{said}");
    assert!(said.ends_with("end inside the limit or raise limits.max_velocity_reverse"), "{said}");
}

/// It has met its point at speed, and may neither go back nor wait for the other.
#[test]
fn a_finish_that_one_axis_cannot_wait_for() {
    let forward = LimitsSpec { max_velocity_reverse: Some(0.0), ..limits() };
    let start = State { velocity: 0.5, ..State::default() };
    let met = PvtAxisSpec { start, limits: forward, ..axis("y", &[0.1], &[0.05], &[0.5]) };
    let spec = PvtRequestSpec {
        policy: Ok(PvtPolicy::PreferVelocity),
        finish_unreached: true,
        ..request(vec![axis("x", &[0.1], &[0.5], &[0.0]), met])
    };
    let said = plan(spec).unwrap_err().to_string();
    assert!(said.starts_with("axes[1].positions[0]: takes at most 0 s, and the motion lasts "), "{said}");
    assert!(said.ends_with("allow it to go back, or plan it by itself"), "{said}");
}

#[test]
fn commands_one_by_one() {
    let mut axis =
        PvtPlanner::new(State::at_rest(0.0), limits().try_into().unwrap(), PvtPolicy::Reject).unwrap();
    let mut refused = |position, velocity, duration, expected: &[&str]| {
        check(axis.command(PvtTarget { position, velocity, duration }), expected);
        assert_eq!(axis.state(), State::at_rest(0.0));
    };
    refused(
        f64::NAN,
        -2.0,
        0.0,
        &[
            "position: is NaN: give a finite number of at most 1e60 in magnitude",
            "velocity: is -2, beyond -1: end inside the limit or raise limits.max_velocity",
            "duration: is 0 s: give a time above 0",
        ],
    );
    refused(
        0.0,
        0.0,
        f64::INFINITY,
        &["duration: is inf: give a finite number of at most 1e60 in magnitude"],
    );
    refused(
        1.0,
        0.0,
        1.0,
        &[
            "position: is 1, and 1 s lead to between -0.125 and 0.125: move the point to 0.125, allow 2 s, or \
             name a policy that adjusts",
        ],
    );
    refused(
        0.0,
        1.0,
        0.5,
        &[
            "velocity: is 1, and 0.5 s do not suffice for that: ask for a velocity of 0.25 at the position 0.0625, keep the \
             position with a velocity of 0.059016994374947424, allow 2.1021287890229274 s, or name a policy that adjusts",
        ],
    );
}
