//! Plans of one axis between any states, as a request asks for them: beside the durations of Ruckig 0.19.4, and before the judge of
//! plans, who lets a start beyond the limits be led back, and nothing else.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and what is the same number is"
)]

mod common;

use common::vectors;
use planner::{
    AxisKind, AxisMoveSpec, Certificate, Classification, CycleTime, Family, InvalidFields, Judged,
    LimitCheck, Limits, LimitsSpec, Method, Plan, Profile, Quantity, Request, RequestSpec, ShortPathPolicy,
    State, Synchronization, Violation, certify, certify_against,
};

/// Of a duration [1]: how much longer than the peer's ours may be.
const SLACK: f64 = 1e-9;
/// Of the scale of a motion [1]: how far it may end from its goal, integrated from its last piece.
const END: f64 = 1e-12;

fn state(position: f64, velocity: f64, acceleration: f64) -> State {
    State { position, velocity, acceleration }
}

fn limits(velocity: f64, acceleration: f64, jerk: f64) -> LimitsSpec {
    LimitsSpec {
        max_velocity: velocity,
        max_acceleration: acceleration,
        max_jerk: jerk,
        ..LimitsSpec::default()
    }
}

fn spec(start: State, goal: State, limits: LimitsSpec) -> RequestSpec {
    let axis = AxisMoveSpec { axis: "x".into(), kind: Ok(AxisKind::Prismatic), start, goal, limits };
    RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reverse),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    }
}

fn answered(spec: RequestSpec) -> Result<Judged, InvalidFields> {
    Judged::answer(&Request::try_from(spec)?)
}

/// Plans, and has the judge accept it.
#[track_caller]
fn planned(name: &str, start: State, goal: State, limits: LimitsSpec) -> Judged {
    let judged = answered(spec(start, goal, limits)).unwrap_or_else(|refusal| panic!("{name}: {refusal}"));
    let violations: Vec<_> = judged.certificate().violations().collect();
    assert!(violations.is_empty(), "{name}: {violations:?} {start:?} {goal:?}");
    judged
}

/// How far the last piece ends from the goal, of the scale of the motion: its positions, its fastest, its hardest.
fn residual(profile: &Profile, goal: State, jerk: f64) -> f64 {
    let Some(last) = profile.segments().last() else { return 0.0 };
    let (mut range, mut fastest, mut hardest) = (0.0_f64, 0.0_f64, 0.0_f64);
    for segment in profile.segments() {
        for t in segment.turning_points() {
            let State { position, velocity, acceleration } = segment.at(t).state;
            range = range.max(position.abs()).max((position - goal.position).abs());
            fastest = fastest.max(velocity.abs());
            hardest = hardest.max(acceleration.abs());
        }
    }
    let end = last.end();
    let of = |missed: f64, scale: f64| if missed == 0.0 { 0.0 } else { missed.abs() / scale };
    let position = of(end.position - goal.position, range);
    let velocity = of(end.velocity - goal.velocity, fastest + hardest * hardest / jerk);
    position.max(velocity).max(of(end.acceleration - goal.acceleration, hardest))
}

/// Bounds with signs as limits of speeding up and slowing down have them: where up and down differ, the lower of both holds.
fn limits_of(record: &vectors::Record) -> LimitsSpec {
    let hardest = record.amax.min(-record.amin);
    LimitsSpec { max_velocity_reverse: Some(-record.vmin), ..limits(record.vmax, hardest, record.jmax) }
}

#[test]
fn no_plan_is_longer_than_the_peers() {
    let records = vectors::records();
    let mut compared = 0;
    for (index, record) in records.iter().enumerate() {
        let (start, goal, limits) = (record.start(), record.goal(), limits_of(record));
        let name = format!("{index}, {}", record.kind);
        let alike = record.amax == -record.amin;
        if !alike && answered(spec(start, goal, limits.clone())).is_err() {
            // A goal inside the higher of both bounds alone.
            assert!(goal.acceleration.abs() > limits.max_acceleration, "{name}");
            continue;
        }
        let jerk = limits.max_jerk;
        let judged = planned(&name, start, goal, limits);
        let off = residual(&judged.plan().axes()[0].profile, goal, jerk);
        assert!(off <= END, "{name}: ends {off:e} from its goal");
        if let (true, Some(theirs)) = (alike, record.duration) {
            compared += 1;
            let ours = judged.plan().duration();
            assert!(ours <= theirs * (1.0 + SLACK), "{name}: {ours} s, and the peer takes {theirs}");
        }
    }
    // The rest have other bounds up than down, or are refused by the peer.
    assert_eq!(compared, 2283);
}

#[test]
fn what_the_peer_refuses_is_planned() {
    let mut answered = 0;
    for (index, failure) in vectors::failures().iter().enumerate() {
        for axis in 0..failure.axes() {
            let (start, goal, jerk) = (failure.start(axis), failure.goal(axis), failure.jmax[axis]);
            let limits = limits(failure.vmax[axis], failure.amax[axis], jerk);
            let judged = planned(&format!("{index}, axis {axis}"), start, goal, limits);
            assert!(residual(&judged.plan().axes()[0].profile, goal, jerk) <= END);
            answered += 1;
        }
    }
    assert!(answered >= 128, "{answered}");
}

fn check_of(certificate: &Certificate, quantity: Quantity) -> &LimitCheck {
    certificate.limits.iter().find(|check| check.quantity == quantity).unwrap()
}

fn against(judged: &Judged, limits: LimitsSpec) -> Certificate {
    let goal = judged.plan().axes()[0].goal;
    certify_against(judged.plan(), [(&Limits::try_from(limits).unwrap(), goal)])
}

fn refused(spec: RequestSpec) -> String {
    answered(spec).unwrap_err().to_string()
}

/// 2 m/s where 1 is allowed, with 1 m/s² and 1 m/s³: down in one second to −1, and back to zero in another.
#[test]
fn a_start_beyond_the_velocity_limit_is_led_back() {
    let judged = planned("beyond", state(0.0, 2.0, 0.0), State::at_rest(10.0), limits(1.0, 1.0, 1.0));
    let check = check_of(judged.certificate(), Quantity::Velocity);
    assert!((check.led_back_by.unwrap() - 2.0).abs() < 1e-12, "{check:?}");
    assert!((check.extremum - 1.0).abs() < 1e-12 && check.margin.abs() < 1e-12, "{check:?}");
    for quantity in [Quantity::Acceleration, Quantity::Jerk] {
        assert_eq!(check_of(judged.certificate(), quantity).led_back_by, None);
    }
    let names = judged.plan().axes()[0].classification;
    assert_eq!(names, Classification::of_speed(2.0));
    let bound: Vec<_> = judged.explanation().bindings.iter().map(|binding| binding.quantity).collect();
    assert_eq!(bound, [Quantity::Jerk, Quantity::Velocity, Quantity::Jerk]);
}

/// Its acceleration alone takes a velocity of 0.9 to 1.4; and 3 m/s² are back at 1 after two seconds.
#[test]
fn what_is_bound_to_come_beyond_a_limit_is_led_back() {
    let judged = planned("bound", state(0.0, 0.9, 1.0), State::at_rest(10.0), limits(1.0, 1.0, 1.0));
    let check = check_of(judged.certificate(), Quantity::Velocity);
    // 0.9 m/s² off: down by 1 to zero, on to −√0.4 and back.
    assert!((check.led_back_by.unwrap() - (1.0 + 2.0 * 0.4_f64.sqrt())).abs() < 1e-12, "{check:?}");
    let judged = planned("hard", state(0.0, -2.0, 3.0), State::at_rest(10.0), limits(9.0, 1.0, 1.0));
    let check = check_of(judged.certificate(), Quantity::Acceleration);
    assert_eq!(check.led_back_by, Some(2.0));
    assert!((check.extremum - 1.0).abs() < 1e-12, "{check:?}");
    assert_eq!(check_of(judged.certificate(), Quantity::Velocity).led_back_by, None);
}

/// A way back is passed only where there is need of one, and only if it takes no longer than it must.
#[test]
fn whoever_takes_longer_on_the_way_back_fails() {
    let broken = |certificate: &Certificate| -> Vec<Quantity> {
        let limit = |violation| match violation {
            Violation::Limit(check) => Some(check.quantity),
            Violation::Join(_) | Violation::End(_) => None,
        };
        certificate.violations().filter_map(limit).collect()
    };
    let at = limits(1.0, 1.0, 1.0);
    // Led back with half the jerk, or half the deceleration: the start calls for it, and it dawdles.
    let start = state(0.0, 2.0, 0.0);
    for slack in [limits(1.0, 1.0, 0.5), limits(1.0, 0.5, 1.0)] {
        let dawdling = planned("dawdling", start, State::at_rest(10.0), slack);
        assert_eq!(broken(&against(&dawdling, at.clone())), [Quantity::Velocity]);
    }
    let dawdling = planned("dawdling", state(0.0, 0.0, 3.0), State::at_rest(10.0), limits(9.0, 1.0, 0.5));
    assert_eq!(broken(&against(&dawdling, limits(9.0, 1.0, 1.0))), [Quantity::Acceleration]);
    // Never led back, though it is just as fast as at the start.
    let cruising = planned("cruising", start, state(10.0, 2.0, 0.0), limits(2.0, 1.0, 1.0));
    assert_eq!(broken(&against(&cruising, at.clone())), [Quantity::Velocity]);
    // From rest there is no need.
    let fast = planned("fast", State::at_rest(0.0), State::at_rest(10.0), limits(2.0, 1.0, 1.0));
    let certificate = against(&fast, at.clone());
    assert_eq!(broken(&certificate), [Quantity::Velocity]);
    assert!(!certificate.is_led_back());
    // What begins beyond a limit and comes back, and goes beyond it once more.
    let led = planned("led back", start, State::at_rest(20.0), limits(1.0, 1.0, 1.0));
    let again = planned(
        "again",
        led.plan().axes()[0].profile.at(2.0).state,
        State::at_rest(9.0),
        limits(1.5, 1.0, 1.0),
    );
    let back: Vec<_> = led.plan().axes()[0].profile.segments().iter().take(2).collect();
    let joined = Profile::new(back, again.plan().axes()[0].profile.start())
        .followed_by(&again.plan().axes()[0].profile);
    let axis =
        planner::AxisPlan { profile: joined, goal: State::at_rest(9.0), ..led.plan().axes()[0].clone() };
    let plan =
        Plan::new(led.plan().method(), led.plan().guaranteed().to_vec(), CycleTime::MILLISECOND, vec![axis]);
    assert_eq!(broken(&certify(&plan.unwrap())), [Quantity::Velocity]);
}

/// A trapezoid from beyond its limit has nobody to lead it back.
#[test]
fn only_the_s_curve_leads_back() {
    let judged = planned("beyond", state(0.0, 2.0, 0.0), State::at_rest(10.0), limits(1.0, 1.0, 1.0));
    let method = Method { family: Family::Polynomial, ..judged.plan().method() };
    let axes = judged.plan().axes().to_vec();
    let other = Plan::new(method, judged.plan().guaranteed().to_vec(), CycleTime::MILLISECOND, axes).unwrap();
    assert!(!certify(&other).passed());
    assert_eq!(
        refused(RequestSpec {
            family: Ok(Family::Trapezoidal),
            ..spec(state(0.0, 2.0, 0.0), State::at_rest(10.0), limits(1.0, 1.0, 1.0))
        }),
        "axes[0].start.velocity: is 2, beyond 1: begin inside the limit or raise limits.max_velocity"
    );
}

/// Past the goal and back, where the path is too short to stop; refused, where the caller names no other way out.
#[test]
fn a_path_too_short_is_gone_past_and_back() {
    let (start, goal) = (state(0.0, 0.5, 0.0), State::at_rest(0.01));
    let judged = planned("past", start, goal, limits(1.0, 2.0, 6.0));
    let axis = &judged.plan().axes()[0];
    assert!(axis.adjustments.is_empty());
    assert_eq!(axis.classification, Classification::of_speed(0.5));
    let farthest = axis.profile.segments().iter().map(|piece| piece.start.position).fold(0.0, f64::max);
    assert!(farthest > 0.05, "{farthest}");
    let rejecting =
        RequestSpec { short_path: Ok(ShortPathPolicy::Reject), ..spec(start, goal, limits(1.0, 2.0, 6.0)) };
    assert!(refused(rejecting).contains("too short"));
    // Slows down, goes back as hard, and slows down again.
    let hard = planned("hard", state(0.0, 0.2, 2.0), goal, limits(0.25, 3.0, 100.0));
    let bound: Vec<_> = hard.explanation().bindings.iter().map(|binding| binding.quantity).collect();
    use Quantity::{Acceleration, Jerk};
    assert_eq!(bound, [Jerk, Acceleration, Jerk, Acceleration, Jerk]);
    // Long enough: what the closed form says.
    let names = planned("long", start, State::at_rest(2.0), limits(1.0, 2.0, 6.0));
    assert!(names.plan().axes()[0].classification.eight_type.is_some());
}

#[test]
fn what_cannot_be_planned_between_states_is_refused() {
    let (start, goal) = (state(0.0, 0.5, 1.0), State::at_rest(0.01));
    let at = limits(1.0, 2.0, 6.0);
    let later =
        answered(RequestSpec { minimum_duration: Some(1e3), ..spec(start, goal, at.clone()) }).unwrap();
    assert!((later.plan().duration() - 1e3).abs() <= 1e-9 && later.certificate().passed());
    let on_cycle = answered(RequestSpec { end_on_cycle: true, ..spec(start, goal, at.clone()) }).unwrap();
    let plan = on_cycle.plan();
    assert_eq!(plan.duration(), plan.cycle_time().start_of(plan.cycle_count()));
    assert!(on_cycle.certificate().passed());
    let narrow = LimitsSpec { max_position: Some(0.02), ..at.clone() };
    let error = answered(spec(start, goal, narrow)).unwrap_err();
    let planner::Why::PositionLimit { reached, time, allowed, limit } = error.as_slice()[0].why else {
        panic!("{error}")
    };
    assert_eq!(
        (error.as_slice()[0].field.as_str(), allowed, limit),
        ("axes[0]", 0.02, "limits.max_position")
    );
    // The farthest, where it turns, and not the first instant outside.
    let free = planned("free", start, goal, at.clone());
    let turns = free.plan().axes()[0].profile.at(time).state;
    assert!((turns.position - reached).abs() < 1e-12 && turns.velocity.abs() < 1e-9, "{turns:?}");
    for (goal, text) in [
        (
            state(1.0, 1.5, 0.0),
            "goal.velocity: is 1.5, beyond 1: end inside the limit or raise limits.max_velocity",
        ),
        (
            state(1.0, 0.5, 2.5),
            "goal.acceleration: is 2.5, beyond 2: end inside the limit or raise limits.max_acceleration",
        ),
        // 0.9 m/s with −2 m/s² was 0.9 + 2²/12 before.
        (
            state(1.0, 0.9, -2.0),
            "goal.acceleration: is -2, beyond -1.0954451150103321: end inside the limit or raise limits.max_velocity",
        ),
    ] {
        assert_eq!(refused(spec(start, goal, at.clone())), format!("axes[0].{text}"));
    }
    let outside = LimitsSpec { max_position: Some(-1.0), min_position: Some(-2.0), ..at };
    let text = refused(spec(start, State::at_rest(-1.5), outside));
    assert_eq!(
        text,
        "axes[0].start.position: is 0, beyond -1: begin inside the limit or raise limits.max_position"
    );
}

/// Speeding up and slowing down limited apart: a goal that only a ramp through zero leads to has the lower of both.
#[test]
fn limits_of_speeding_up_and_slowing_down() {
    let apart = LimitsSpec { max_deceleration: Some(0.5), ..limits(1.0, 2.0, 6.0) };
    for (start, goal) in [
        (state(0.0, 0.5, 1.0), state(1.0, 0.25, -0.4)),
        (state(0.0, -0.5, 0.3), state(1.0, 0.5, 0.4)),
        (state(0.0, 2.0, 4.0), State::at_rest(1.0)),
        (state(0.0, -3.0, -4.0), State::at_rest(1.0)),
        (state(0.0, -0.02, 0.5), State::at_rest(-1.0)),
    ] {
        planned("apart", start, goal, apart.clone());
    }
    assert_eq!(
        refused(spec(State::at_rest(0.0), state(1.0, 0.01, 0.9), apart)),
        "axes[0].goal.acceleration: is 0.9, beyond 0.5: end inside the limit or raise limits.max_deceleration"
    );
}
