//! Plans of one axis between any states, as a request asks for them: beside the durations of Ruckig 0.19.4, and before the judge of
//! plans, who lets a start beyond the limits be led back, and nothing else.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and what is the same number is"
)]

use planner::{
    AxisKind, AxisMoveSpec, AxisPlan, Certificate, Family, Judged, LimitCheck, Limits, LimitsSpec, Method,
    Plan, Profile, Quantity, Request, RequestSpec, ShortPathPolicy, State, Synchronization, Why, certify,
    certify_against, explain,
};
use serde::Deserialize;

/// Of a duration [1]: how much longer than the peer's ours may be.
const SLACK: f64 = 1e-9;
/// Of the scale of a motion [1]: how far it may end from its goal, integrated from its last piece.
const END: f64 = 1e-12;

#[derive(Deserialize)]
struct Record {
    kind: String,
    p0: f64,
    v0: f64,
    a0: f64,
    pf: f64,
    vf: f64,
    af: f64,
    vmax: f64,
    vmin: f64,
    amax: f64,
    amin: f64,
    jmax: f64,
    duration: Option<f64>,
}

#[derive(Deserialize)]
struct Failure {
    p0: Vec<f64>,
    v0: Vec<f64>,
    a0: Vec<f64>,
    pf: Vec<f64>,
    vf: Vec<f64>,
    af: Vec<f64>,
    vmax: Vec<f64>,
    amax: Vec<f64>,
    jmax: Vec<f64>,
}

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

fn answered(spec: RequestSpec) -> Result<Judged, planner::InvalidFields> {
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
fn limits_of(record: &Record) -> LimitsSpec {
    let hardest = record.amax.min(-record.amin);
    LimitsSpec { max_velocity_reverse: Some(-record.vmin), ..limits(record.vmax, hardest, record.jmax) }
}

#[test]
fn no_plan_is_longer_than_the_peers() {
    let records: Vec<Record> = serde_json::from_str(include_str!("vectors/states.json")).unwrap();
    let mut compared = 0;
    for (index, record) in records.iter().enumerate() {
        let Record { p0, v0, a0, pf, vf, af, .. } = *record;
        let (start, goal, limits) = (state(p0, v0, a0), state(pf, vf, af), limits_of(record));
        let name = format!("{index}, {}", record.kind);
        let alike = record.amax == -record.amin;
        if !alike && answered(spec(start, goal, limits.clone())).is_err() {
            // A goal inside the higher of both bounds alone.
            assert!(af.abs() > limits.max_acceleration, "{name}");
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
    let failures: Vec<Failure> = serde_json::from_str(include_str!("vectors/peer_failures.json")).unwrap();
    let mut answered = 0;
    for (index, failure) in failures.iter().enumerate() {
        for axis in 0..failure.p0.len() {
            let Failure { p0, v0, a0, pf, vf, af, vmax, amax, jmax } = failure;
            let start = state(p0[axis], v0[axis], a0[axis]);
            let goal = state(pf[axis], vf[axis], af[axis]);
            let judged = planned(
                &format!("{index}, axis {axis}"),
                start,
                goal,
                limits(vmax[axis], amax[axis], jmax[axis]),
            );
            assert!(residual(&judged.plan().axes()[0].profile, goal, jmax[axis]) <= END);
            answered += 1;
        }
    }
    assert!(answered >= 128, "{answered}");
}
