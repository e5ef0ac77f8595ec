//! Every field of every request, spoiled in every way that has a name: code, reason and path. A table made by rules, as that
//! of `bad_plans` is by hand: several hundred rows, each sent over the wire.

use e2e::{Loopback, fifty_millimetres, planned};
use proto::{Reason, Rejected, pb, plan_to_wire};
use tonic::{Code, Status};

/// Axes of the requests, so that paths have an index that is not 0.
const AXES: usize = 3;
const NO_NUMBERS: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// What is asked.
#[derive(Clone)]
enum Ask {
    Plan(pb::PlanRequest),
    Pvt(pb::PlanPvtRequest),
    Verify(Box<pb::VerifyPlanRequest>),
}

struct Row {
    ask: Ask,
    reason: Reason,
    path: String,
}

fn moves() -> pb::PlanRequest {
    let mut request = pb::PlanRequest::from(fifty_millimetres());
    let axis = request.axes[0].clone();
    request.axes =
        (0..AXES).map(|index| pb::AxisMove { axis: format!("x{index}"), ..axis.clone() }).collect();
    request.synchronization = pb::Synchronization::None as i32;
    request
}

fn points() -> pb::PlanPvtRequest {
    let limits = moves().axes[0].limits.clone();
    let axis = |index| pb::PvtAxis {
        axis: format!("x{index}"),
        kind: pb::AxisKind::Prismatic as i32,
        start: Some(pb::AxisState::default()),
        limits: limits.clone(),
        times: vec![0.5, 1.0, 1.5],
        positions: vec![0.01, 0.02, 0.03],
        velocities: vec![0.02, 0.02, 0.0],
    };
    pb::PlanPvtRequest {
        axes: (0..AXES).map(axis).collect(),
        interpolation: pb::PvtInterpolation::SShaped as i32,
        policy: pb::PvtPolicy::Reject as i32,
        ..Default::default()
    }
}

fn plan() -> pb::Plan {
    plan_to_wire(planned(fifty_millimetres()).judged())
}

/// A number in a message, by its name.
type Number<M> = (&'static str, fn(&mut M, f64));

const STATE: [Number<pb::AxisState>; 3] = [
    ("position", |state, value| state.position = value),
    ("velocity", |state, value| state.velocity = value),
    ("acceleration", |state, value| state.acceleration = value),
];

/// Those that have to be above 0 where they are stated.
const MAGNITUDES: [Number<pb::AxisLimits>; 5] = [
    ("max_velocity", |limits, value| limits.max_velocity = value),
    ("max_acceleration", |limits, value| limits.max_acceleration = value),
    ("max_jerk", |limits, value| limits.max_jerk = value),
    ("max_deceleration", |limits, value| limits.max_deceleration = Some(value)),
    ("feed_rate", |limits, value| limits.feed_rate = Some(value)),
];

const RANGES: [Number<pb::AxisLimits>; 3] = [
    ("max_velocity_reverse", |limits, value| limits.max_velocity_reverse = Some(value)),
    ("min_position", |limits, value| limits.min_position = Some(value)),
    ("max_position", |limits, value| limits.max_position = Some(value)),
];

/// A column of a table of points, by its name.
type Column = (&'static str, fn(&mut pb::PvtAxis) -> &mut Vec<f64>);

const COLUMNS: [Column; 3] = [
    ("times", |axis| &mut axis.times),
    ("positions", |axis| &mut axis.positions),
    ("velocities", |axis| &mut axis.velocities),
];

/// Times that no cycle has, and such that are none.
fn durations() -> impl Iterator<Item = (Reason, prost_types::Duration)> {
    let wrong = [(0, 0), (-1, 0), (0, -1), (0, 1), (i64::MAX, 0), (i64::MIN, 0)];
    let malformed = [(0, i32::MAX), (1, -1), (-1, 1), (0, i32::MIN)];
    let with = |reason| move |(seconds, nanos)| (reason, prost_types::Duration { seconds, nanos });
    let wrong = wrong.into_iter().map(with(Reason::CycleTimeInvalid));
    wrong.chain(malformed.into_iter().map(with(Reason::ValueOutOfRange)))
}

fn names() -> [String; 4] {
    [String::new(), "x".repeat(257), "x\n".to_owned(), "\u{7f}".to_owned()]
}

fn of_moves() -> Vec<Row> {
    let mut rows = Vec::new();
    let mut row = |reason, path: String, spoil: &dyn Fn(&mut pb::PlanRequest)| {
        let mut request = moves();
        spoil(&mut request);
        rows.push(Row { ask: Ask::Plan(request), reason, path });
    };
    for index in 0..AXES {
        let at = |field: &str| format!("axes[{index}].{field}");
        for value in NO_NUMBERS {
            for (name, set) in STATE {
                row(Reason::NotFinite, at(&format!("start.{name}")), &|request| {
                    set(request.axes[index].start.as_mut().unwrap(), value);
                });
                row(Reason::NotFinite, at(&format!("goal.{name}")), &|request| {
                    set(request.axes[index].goal.as_mut().unwrap(), value);
                });
            }
            for (name, set) in MAGNITUDES.into_iter().chain(RANGES) {
                row(Reason::NotFinite, at(&format!("limits.{name}")), &|request| {
                    set(request.axes[index].limits.as_mut().unwrap(), value);
                });
            }
        }
        for value in [0.0, -0.0, -1.0, -f64::MIN_POSITIVE] {
            for (name, set) in MAGNITUDES {
                row(Reason::LimitNotPositive, at(&format!("limits.{name}")), &|request| {
                    set(request.axes[index].limits.as_mut().unwrap(), value);
                });
            }
        }
        for kind in [0, 4, 99, -1, i32::MIN] {
            row(Reason::KindUnspecified, at("kind"), &|request| request.axes[index].kind = kind);
        }
        for name in names() {
            row(Reason::NameInvalid, at("axis"), &|request| request.axes[index].axis.clone_from(&name));
        }
        row(Reason::FieldMissing, at("limits"), &|request| request.axes[index].limits = None);
        if index > 0 {
            row(Reason::DuplicateAxis, at("axis"), &|request| request.axes[index].axis = "x0".into());
        }
    }
    for wrong in [5, 99, -1, i32::MAX] {
        row(Reason::KindUnspecified, "family".into(), &|request| request.family = wrong);
        row(Reason::KindUnspecified, "short_path_policy".into(), &|request| {
            request.short_path_policy = wrong;
        });
        row(Reason::KindUnspecified, "synchronization".into(), &|request| request.synchronization = wrong);
    }
    for (reason, duration) in durations() {
        row(reason, "cycle_time".into(), &|request| request.cycle_time = Some(duration));
    }
    row(Reason::NoAxes, "axes".into(), &|request| request.axes.clear());
    rows
}

fn of_points() -> Vec<Row> {
    let mut rows = Vec::new();
    let mut row = |reason, path: String, spoil: &dyn Fn(&mut pb::PlanPvtRequest)| {
        let mut request = points();
        spoil(&mut request);
        rows.push(Row { ask: Ask::Pvt(request), reason, path });
    };
    for index in 0..AXES {
        let at = |field: &str| format!("axes[{index}].{field}");
        for (name, column) in COLUMNS {
            // Times are those of the first axis: in another, what differs from them is at fault, whatever it is.
            let is_shared = name == "times" && index > 0;
            let reason = if is_shared { Reason::LengthMismatch } else { Reason::NotFinite };
            for value in NO_NUMBERS {
                for point in 0..3 {
                    row(reason, at(&format!("{name}[{point}]")), &|request| {
                        column(&mut request.axes[index])[point] = value;
                    });
                }
            }
        }
        for kind in [0, 4, -1] {
            row(Reason::KindUnspecified, at("kind"), &|request| request.axes[index].kind = kind);
        }
        for name in names() {
            row(Reason::NameInvalid, at("axis"), &|request| request.axes[index].axis.clone_from(&name));
        }
    }
    row(Reason::NoAxes, "axes".into(), &|request| request.axes.clear());
    for wrong in [99, -1] {
        row(Reason::KindUnspecified, "interpolation".into(), &|request| request.interpolation = wrong);
        row(Reason::KindUnspecified, "policy".into(), &|request| request.policy = wrong);
    }
    rows
}

fn of_plans() -> Vec<Row> {
    let mut rows = Vec::new();
    let mut row = |reason, path: String, spoil: &dyn Fn(&mut pb::Plan)| {
        let mut plan = plan();
        spoil(&mut plan);
        let request = pb::VerifyPlanRequest { plan: Some(plan), against: vec![] };
        rows.push(Row { ask: Ask::Verify(Box::new(request)), reason, path });
    };
    let segments = plan().axes[0].segments.len();
    for segment in 0..segments {
        let at = |field: &str| format!("plan.axes[0].segments[{segment}].{field}");
        for value in NO_NUMBERS {
            row(Reason::NotFinite, at("duration"), &|plan| plan.axes[0].segments[segment].duration = value);
            row(Reason::NotFinite, at("jerk"), &|plan| {
                plan.axes[0].segments[segment].law = Some(pb::axis_segment::Law::Jerk(value));
            });
            for (name, set) in STATE {
                row(Reason::NotFinite, at(&format!("start.{name}")), &|plan| {
                    set(plan.axes[0].segments[segment].start.as_mut().unwrap(), value);
                });
            }
        }
    }
    rows
}

/// All of them in one message: each has its own refusal, and what stands between them is planned.
#[tokio::test]
async fn many_at_once_have_their_reasons_and_paths() {
    let server = Loopback::start().await;
    let rows = of_moves();
    let requests = rows.iter().flat_map(|row| match &row.ask {
        Ask::Plan(request) => [request.clone(), moves()],
        Ask::Pvt(_) | Ask::Verify(_) => panic!("not a move"),
    });
    let message = pb::PlanManyRequest { requests: requests.collect(), ..Default::default() };
    let mut planner = server.planner().await;
    let answers = planner.plan_many(tokio_stream::iter([message])).await.unwrap();
    let outcomes = answers.into_inner().message().await.unwrap().unwrap().outcomes;
    assert_eq!(outcomes.len(), 2 * rows.len());
    for (Row { reason, path, .. }, pair) in rows.iter().zip(outcomes.chunks(2)) {
        let Some(pb::plan_outcome::Outcome::Refusal(status)) = &pair[0].outcome else {
            panic!("{path} {reason}")
        };
        let rejected = Rejected::from_bytes(status).unwrap();
        let is_there = rejected.fields.iter().any(|field| field.field == *path && field.reason == *reason);
        assert!(is_there, "{path} {reason}: {rejected}");
        assert!(matches!(pair[1].outcome, Some(pb::plan_outcome::Outcome::Plan(_))), "after {path} {reason}");
    }
}

#[tokio::test]
async fn every_field_has_its_reason_and_path() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let rows: Vec<Row> = of_moves().into_iter().chain(of_points()).chain(of_plans()).collect();
    assert!(rows.len() > 400, "{} rows", rows.len());
    let mut wrong = Vec::new();
    for Row { ask, reason, path } in rows {
        let status: Result<(), Status> = match ask {
            Ask::Plan(request) => planner.plan(request).await.map(|_| ()),
            Ask::Pvt(request) => planner.plan_pvt(request).await.map(|_| ()),
            Ask::Verify(request) => planner.verify_plan(*request).await.map(|_| ()),
        };
        let Err(status) = status else {
            wrong.push(format!("{path} {reason}: answered"));
            continue;
        };
        let Some(rejected) = Rejected::from_status(&status) else {
            wrong.push(format!("{path} {reason}: no reason in {status:?}"));
            continue;
        };
        let is_there = rejected.fields.iter().any(|field| field.field == path && field.reason == reason);
        let is_right = is_there && status.code() == reason.code() && status.code() != Code::Internal;
        if !is_right {
            wrong.push(format!("{path} {reason}: {rejected}"));
        }
    }
    assert!(wrong.is_empty(), "{} rows:\n{}", wrong.len(), wrong.join("\n"));
    // Nothing of it has harmed the server.
    assert!(planner.plan(moves()).await.is_ok() && planner.plan_pvt(points()).await.is_ok());
}
