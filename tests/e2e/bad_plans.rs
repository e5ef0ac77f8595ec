//! What is not a request, not possible or not a plan: the reason, the path, the way out, and nothing lost.

use e2e::{Loopback, fifty_millimetres, planned};
use planner::Judged;
use proto::{Reason, Rejected, pb, plan_to_wire};
use tonic::{Code, Status};

fn good() -> pb::PlanRequest {
    fifty_millimetres().into()
}

fn plan() -> pb::Plan {
    plan_to_wire(planned(fifty_millimetres()).judged())
}

/// A request that is good but for `spoil`.
fn spoiled(spoil: impl FnOnce(&mut pb::PlanRequest)) -> pb::PlanRequest {
    let mut request = good();
    spoil(&mut request);
    request
}

fn axis(request: &mut pb::PlanRequest) -> &mut pb::AxisMove {
    &mut request.axes[0]
}

fn limits(request: &mut pb::PlanRequest) -> &mut pb::AxisLimits {
    axis(request).limits.as_mut().unwrap()
}

fn start(request: &mut pb::PlanRequest) -> &mut pb::AxisState {
    axis(request).start.as_mut().unwrap()
}

fn goal(request: &mut pb::PlanRequest) -> &mut pb::AxisState {
    axis(request).goal.as_mut().unwrap()
}

#[track_caller]
fn refused(status: &Status) -> Rejected {
    Rejected::from_status(status).unwrap_or_else(|| panic!("no reason in {status:?}"))
}

type Row = (&'static str, pb::PlanRequest, Code, Reason, &'static str);

fn rows() -> Vec<Row> {
    use Code::{FailedPrecondition, InvalidArgument, ResourceExhausted, Unimplemented};
    vec![
        ("no axis", spoiled(|r| r.axes.clear()), InvalidArgument, Reason::NoAxes, "axes"),
        (
            "a thousand axes",
            spoiled(|r| r.axes = vec![r.axes[0].clone(); 1000]),
            ResourceExhausted,
            Reason::TooManyAxes,
            "axes",
        ),
        (
            "two of one name",
            spoiled(|r| {
                r.axes.push(r.axes[0].clone());
                r.synchronization = pb::Synchronization::None as i32;
            }),
            InvalidArgument,
            Reason::DuplicateAxis,
            "axes[1].axis",
        ),
        (
            "a name of ten thousand letters",
            spoiled(|r| axis(r).axis = "x".repeat(10_000)),
            InvalidArgument,
            Reason::NameInvalid,
            "axes[0].axis",
        ),
        ("no name", spoiled(|r| axis(r).axis.clear()), InvalidArgument, Reason::NameInvalid, "axes[0].axis"),
        (
            "a name that rings the bell",
            spoiled(|r| axis(r).axis = "x\u{7}".into()),
            InvalidArgument,
            Reason::NameInvalid,
            "axes[0].axis",
        ),
        ("no kind", spoiled(|r| axis(r).kind = 0), InvalidArgument, Reason::KindUnspecified, "axes[0].kind"),
        (
            "a kind of later",
            spoiled(|r| axis(r).kind = 99),
            InvalidArgument,
            Reason::KindUnspecified,
            "axes[0].kind",
        ),
        (
            "not a number",
            spoiled(|r| goal(r).position = f64::NAN),
            InvalidArgument,
            Reason::NotFinite,
            "axes[0].goal.position",
        ),
        (
            "an infinite limit",
            spoiled(|r| limits(r).max_jerk = f64::INFINITY),
            InvalidArgument,
            Reason::NotFinite,
            "axes[0].limits.max_jerk",
        ),
        (
            "a limit of zero",
            spoiled(|r| limits(r).max_velocity = 0.0),
            InvalidArgument,
            Reason::LimitNotPositive,
            "axes[0].limits.max_velocity",
        ),
        (
            "a negative limit",
            spoiled(|r| limits(r).max_acceleration = -3.0),
            InvalidArgument,
            Reason::LimitNotPositive,
            "axes[0].limits.max_acceleration",
        ),
        (
            "no limits",
            spoiled(|r| axis(r).limits = None),
            InvalidArgument,
            Reason::FieldMissing,
            "axes[0].limits",
        ),
        (
            "a limit that is not stated",
            spoiled(|r| limits(r).max_jerk = 0.0),
            InvalidArgument,
            Reason::LimitNotPositive,
            "axes[0].limits.max_jerk",
        ),
        (
            "a range without inside",
            spoiled(|r| {
                limits(r).min_position = Some(1.0);
                limits(r).max_position = Some(-1.0);
            }),
            InvalidArgument,
            Reason::ValueOutOfRange,
            "axes[0].limits.max_position",
        ),
        (
            "a cycle of nothing",
            spoiled(|r| r.cycle_time = Some(proto_duration(0, 0))),
            InvalidArgument,
            Reason::CycleTimeInvalid,
            "cycle_time",
        ),
        (
            "a cycle of an age",
            spoiled(|r| r.cycle_time = Some(proto_duration(i64::MAX, 999_999_999))),
            InvalidArgument,
            Reason::CycleTimeInvalid,
            "cycle_time",
        ),
        (
            "a start too fast",
            spoiled(|r| {
                r.family = pb::ProfileFamily::Trapezoidal as i32;
                start(r).velocity = 0.3;
            }),
            FailedPrecondition,
            Reason::StartOutsideLimits,
            "axes[0].start.velocity",
        ),
        (
            "a goal too fast",
            spoiled(|r| goal(r).velocity = 0.3),
            FailedPrecondition,
            Reason::GoalOutsideLimits,
            "axes[0].goal.velocity",
        ),
        (
            "a goal out of range",
            spoiled(|r| limits(r).max_position = Some(0.04)),
            FailedPrecondition,
            Reason::GoalOutsideLimits,
            "axes[0].goal.position",
        ),
        (
            "a path too short",
            spoiled(|r| {
                goal(r).velocity = 0.25;
                goal(r).position = 0.001;
            }),
            FailedPrecondition,
            Reason::PathTooShort,
            "axes[0].goal.velocity",
        ),
        (
            "a way that is forbidden",
            spoiled(|r| {
                goal(r).position = -0.05;
                limits(r).max_velocity_reverse = Some(0.0);
            }),
            FailedPrecondition,
            Reason::GoalOutsideLimits,
            "axes[0].goal.position",
        ),
        (
            "against the travel",
            spoiled(|r| {
                r.family = pb::ProfileFamily::Trapezoidal as i32;
                start(r).velocity = -0.1;
            }),
            Unimplemented,
            Reason::NotImplemented,
            "axes[0].start.velocity",
        ),
        (
            "an acceleration",
            spoiled(|r| {
                r.family = pb::ProfileFamily::Trapezoidal as i32;
                goal(r).acceleration = 1.0;
            }),
            Unimplemented,
            Reason::NotImplemented,
            "axes[0].goal.acceleration",
        ),
        (
            "an acceleration beyond its limit",
            spoiled(|r| goal(r).acceleration = 4.0),
            FailedPrecondition,
            Reason::GoalOutsideLimits,
            "axes[0].goal.acceleration",
        ),
        (
            "past the end of the range",
            spoiled(|r| {
                start(r).velocity = 0.2;
                start(r).acceleration = 2.0;
                goal(r).position = 0.001;
                limits(r).max_position = Some(0.002);
            }),
            FailedPrecondition,
            Reason::PositionLimit,
            "axes[0]",
        ),
        (
            "cosines on a straight line",
            spoiled(|r| {
                let mut second = r.axes[0].clone();
                second.axis = "y".into();
                r.axes.push(second);
                r.synchronization = pb::Synchronization::Phase as i32;
                r.family = pb::ProfileFamily::Trigonometric as i32;
            }),
            Unimplemented,
            Reason::NotImplemented,
            "synchronization",
        ),
        ("no such family", spoiled(|r| r.family = 77), InvalidArgument, Reason::KindUnspecified, "family"),
    ]
}

fn proto_duration(seconds: i64, nanos: i32) -> prost_types::Duration {
    prost_types::Duration { seconds, nanos }
}

#[tokio::test]
async fn every_bad_request_has_its_reason_and_path() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    for (name, request, code, reason, field) in rows() {
        let status = planner.plan(request).await.expect_err(name);
        assert_eq!(status.code(), code, "{name}: {status:?}");
        let rejected = refused(&status);
        assert_eq!(rejected.reason, reason, "{name}: {rejected:?}");
        assert!(rejected.fields.iter().any(|violation| violation.field == field), "{name}: {rejected:?}");
        assert!(rejected.message.contains(':'), "{name} has no way out: {}", rejected.message);
    }
    // Nothing of it has harmed the server.
    assert!(planner.plan(good()).await.is_ok());
}

/// A start and a goal are at rest at 0 where nothing is said of them.
#[tokio::test]
async fn ends_that_are_not_set_are_at_rest_at_zero() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let from_there = spoiled(|r| {
        start(r).position = -0.05;
        axis(r).goal = None;
    });
    for request in [spoiled(|r| axis(r).start = None), from_there] {
        let plan = planner.plan(request).await.unwrap().into_inner().plan.unwrap();
        assert_eq!(plan.cycle_count, 314);
    }
}

#[tokio::test]
async fn a_path_too_short_says_what_would_do() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let request = spoiled(|r| {
        goal(r).velocity = 0.25;
        goal(r).position = 0.001;
    });
    let rejected = refused(&planner.plan(request.clone()).await.unwrap_err());
    let needed: f64 = rejected.metadata["needed"].parse().unwrap();
    let nearest: f64 = rejected.metadata["nearest"].parse().unwrap();
    assert_eq!(rejected.metadata["given"], "0.001");
    let mut longer = request.clone();
    goal(&mut longer).position = needed;
    assert!(planner.plan(longer).await.is_ok());
    let mut slower = request.clone();
    goal(&mut slower).velocity = nearest;
    assert!(planner.plan(slower).await.is_ok());
    for policy in [pb::ShortPathPolicy::NearestVelocity, pb::ShortPathPolicy::MatchStartVelocity] {
        let adjusted = pb::PlanRequest { short_path_policy: policy as i32, ..request.clone() };
        let plan = planner.plan(adjusted).await.unwrap().into_inner().plan.unwrap();
        assert_eq!(plan.axes[0].adjustments.len(), 1, "{policy:?}");
        assert!(plan.certificate.unwrap().passed);
    }
    let reverse = pb::PlanRequest { short_path_policy: pb::ShortPathPolicy::Reverse as i32, ..request };
    let plan = planner.plan(reverse).await.unwrap().into_inner().plan.unwrap();
    assert!(plan.axes[0].adjustments.is_empty());
    assert!(plan.certificate.unwrap().passed);
}

/// A plan in which somebody has changed one number, and taken out what that makes untrue of the whole.
fn tampered(change: impl FnOnce(&mut pb::AxisPlan)) -> pb::Plan {
    let mut plan = pb::Plan { fingerprint: vec![], cycle_count: 0, duration: 0.0, ..plan() };
    change(&mut plan.axes[0]);
    plan
}

/// A plan that calls its shape something else.
fn named(change: impl FnOnce(&mut pb::Classification)) -> pb::Plan {
    tampered(|axis| change(axis.classification.as_mut().unwrap()))
}

fn tampered_plans() -> Vec<(&'static str, pb::Plan)> {
    let jerk = |segment: &mut pb::AxisSegment| {
        if let Some(pb::axis_segment::Law::Jerk(jerk)) = &mut segment.law {
            *jerk *= 1.01;
        }
    };
    vec![
        ("a jerk", tampered(|axis| jerk(&mut axis.segments[0]))),
        ("a duration", tampered(|axis| axis.segments[3].duration *= 1.01)),
        ("a start", tampered(|axis| axis.segments[2].start.as_mut().unwrap().position += 1e-6)),
        ("a limit", tampered(|axis| axis.limits.as_mut().unwrap().max_velocity = 0.2)),
        ("the goal", tampered(|axis| axis.goal.as_mut().unwrap().position = 0.06)),
        ("the end", tampered(|axis| axis.reached.as_mut().unwrap().position = 0.06)),
        ("a piece is gone", tampered(|axis| drop(axis.segments.remove(1)))),
    ]
}

#[tokio::test]
async fn a_tampered_plan_does_not_pass_and_is_not_played() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let mut setpoints = server.setpoints().await;
    for (name, plan) in tampered_plans() {
        let request = pb::VerifyPlanRequest { plan: Some(plan.clone()), against: vec![] };
        let certificate = planner.verify_plan(request).await.unwrap().into_inner().certificate.unwrap();
        assert!(!certificate.passed, "{name}");
        let sample = pb::SamplePlanRequest { plan: Some(plan.clone()), ..Default::default() };
        let rejected = refused(&planner.sample_plan(sample).await.expect_err(name));
        assert_eq!(rejected.reason, Reason::PlanRejected, "{name}");
        // What the judge found worst, for programs, and where each thing is.
        assert_eq!(rejected.metadata["axis"], "x", "{name}");
        let figure = |key: &str| rejected.metadata[key].parse::<f64>().unwrap().abs();
        assert!(figure("given") > figure("allowed"), "{name}: {rejected:?}");
        assert!(!rejected.metadata["quantity"].is_empty(), "{name}");
        assert!(!rejected.fields.is_empty(), "{name}");
        for violation in &rejected.fields {
            assert!(["plan.axes[0].segments", "plan.axes[0].goal"].contains(&violation.field.as_str()));
        }
        let source = Some(pb::open::Source::Plan(plan));
        let open = pb::Open { stream: "x".into(), epoch: 1, source, ..Default::default() };
        let message = Some(pb::stream_setpoints_request::Message::Open(Box::new(open)));
        let first = pb::StreamSetpointsRequest { message };
        let mut answers = setpoints.stream_setpoints(tokio_stream::iter([first])).await.unwrap().into_inner();
        let status = answers.message().await.expect_err(name);
        let rejected = refused(&status);
        assert_eq!(rejected.reason, Reason::PlanRejected, "{name}");
        assert!(rejected.fields[0].field.starts_with("open.plan.axes[0]."), "{name}: {rejected:?}");
    }
}

#[tokio::test]
async fn a_plan_that_is_not_there_is_missing() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let statuses = [
        planner.verify_plan(pb::VerifyPlanRequest::default()).await.unwrap_err(),
        planner.sample_plan(pb::SamplePlanRequest::default()).await.unwrap_err(),
    ];
    for status in statuses {
        let rejected = refused(&status);
        assert_eq!((rejected.reason, rejected.fields[0].field.as_str()), (Reason::FieldMissing, "plan"));
    }
}

#[tokio::test]
async fn what_is_not_a_plan_is_refused_with_its_path() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let rows: Vec<(&str, pb::Plan, Reason, &str)> = vec![
        ("nothing", pb::Plan::default(), Reason::NoAxes, "plan.axes"),
        (
            "NaN",
            tampered(|axis| axis.segments[1].duration = f64::NAN),
            Reason::NotFinite,
            "plan.axes[0].segments[1].duration",
        ),
        (
            "no time",
            tampered(|axis| axis.segments[1].duration = 0.0),
            Reason::TimesNotIncreasing,
            "plan.axes[0].segments[1].duration",
        ),
        (
            "no law",
            tampered(|axis| axis.segments[2].law = None),
            Reason::KindUnspecified,
            "plan.axes[0].segments[2].law",
        ),
        (
            "a bad state",
            tampered(|axis| axis.segments[0].start.as_mut().unwrap().velocity = f64::INFINITY),
            Reason::NotFinite,
            "plan.axes[0].segments[0].start.velocity",
        ),
        (
            "another evaluation",
            pb::Plan { evaluation_version: 99, ..plan() },
            Reason::PlanRejected,
            "plan.evaluation_version",
        ),
        ("a cycle more", pb::Plan { cycle_count: 315, ..plan() }, Reason::PlanRejected, "plan.cycle_count"),
        ("twice as long", pb::Plan { duration: 1.0, ..plan() }, Reason::PlanRejected, "plan.duration"),
        (
            "a promise less",
            pb::Plan { guaranteed: vec![2, 3], ..plan() },
            Reason::PlanRejected,
            "plan.guaranteed",
        ),
        (
            "another method",
            pb::Plan {
                method: Some(pb::PlanMethod {
                    family: pb::ProfileFamily::Trapezoidal as i32,
                    ..Default::default()
                }),
                ..plan()
            },
            Reason::PlanRejected,
            "plan.method.family",
        ),
        (
            "another shape",
            named(|names| names.eight_type = Some("2".into())),
            Reason::PlanRejected,
            "plan.axes[0].classification.eight_type",
        ),
        (
            "another case",
            named(|names| names.six_case = Some("A".into())),
            Reason::PlanRejected,
            "plan.axes[0].classification.six_case",
        ),
        (
            "another speed",
            named(|names| names.feed_rate = 0.2),
            Reason::PlanRejected,
            "plan.axes[0].classification.feed_rate",
        ),
        (
            "a reason that is of another quantity",
            tampered(|axis| {
                let quantity = pb::Quantity::Acceleration as i32;
                let reason = "FEED_RATE_ABOVE_LIMIT".into();
                axis.adjustments = vec![pb::Adjustment { quantity, reason, ..Default::default() }];
            }),
            Reason::PlanRejected,
            "plan.axes[0].adjustments[0].quantity",
        ),
        (
            "of another",
            pb::Plan { fingerprint: vec![1; 16], ..plan() },
            Reason::PlanRejected,
            "plan.fingerprint",
        ),
    ];
    for (name, plan, reason, field) in rows {
        let request = pb::VerifyPlanRequest { plan: Some(plan), against: vec![] };
        let rejected = refused(&planner.verify_plan(request).await.expect_err(name));
        assert_eq!(rejected.reason, reason, "{name}: {rejected:?}");
        assert!(rejected.fields.iter().any(|violation| violation.field == field), "{name}: {rejected:?}");
    }
}

#[tokio::test]
async fn a_plan_is_held_against_other_limits() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let mut against = good().axes.remove(0);
    against.limits.as_mut().unwrap().max_velocity = 0.2;
    let request = |against| pb::VerifyPlanRequest { plan: Some(plan()), against };
    let certificate =
        planner.verify_plan(request(vec![against.clone()])).await.unwrap().into_inner().certificate.unwrap();
    assert!(!certificate.passed);
    against.axis = "z".into();
    let rejected = refused(&planner.verify_plan(request(vec![against])).await.unwrap_err());
    assert_eq!(
        (rejected.reason, rejected.fields[0].field.as_str()),
        (Reason::UnknownAxis, "against[0].axis")
    );
    // Its own certificate travels with the plan, and says the same as the judge.
    let own = planner.verify_plan(request(vec![])).await.unwrap().into_inner().certificate;
    assert_eq!(own, plan().certificate);
    let _ = Judged::new(planned(fifty_millimetres()).plan().clone());
}

#[tokio::test]
async fn sampling_past_the_end_names_the_last_cycle() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let request = pb::SamplePlanRequest { plan: Some(plan()), first_cycle: 315, cycles: 1 };
    let rejected = refused(&planner.sample_plan(request).await.unwrap_err());
    assert_eq!((rejected.reason, rejected.metadata["nearest"].as_str()), (Reason::ValueOutOfRange, "314"));
    assert_eq!(rejected.fields[0].field, "first_cycle");
}
