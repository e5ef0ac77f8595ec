//! Position, velocity and time over the wire: planned, judged, sampled, streamed, followed; and refused where it cannot be.

use client::Error;
use e2e::{Loopback, LoopbackAxis, open};
use planner::{
    AdjustmentReason, AxisKind, JudgedPvt, LimitsSpec, PvtAxisSpec, PvtInterpolation, PvtPolicy, PvtRequest,
    PvtRequestSpec, Quantity, State,
};
use proto::{Reason, Rejected, pb};
use sim_axis::{AxisModel, Clock, RemoteAxis, TrackRequest, Update};
use tonic::Code;

/// Points that a target makes which is seen twenty times a second: most can be met.
fn axis(name: &str, phase: f64, count: usize) -> PvtAxisSpec {
    const BEAT: f64 = 0.05;
    let angle = |n: usize| 2.0 * n as f64 * BEAT + phase;
    let all = |of: &dyn Fn(usize) -> f64| (1..=count).map(of).collect::<Vec<f64>>();
    let reached = |n: usize| 0.1 * (angle(n).sin() - angle(0).sin());
    PvtAxisSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        limits: LimitsSpec {
            max_velocity: 0.5,
            max_acceleration: 4.0,
            max_jerk: 160.0,
            ..LimitsSpec::default()
        },
        start: State { velocity: 0.2 * angle(0).cos(), ..State::default() },
        times: all(&|n| n as f64 * BEAT),
        // One detection in seventeen is wrong.
        positions: all(&|n| reached(n) + if n.is_multiple_of(17) { 3e-3 } else { 0.0 }),
        velocities: all(&|n| 0.2 * angle(n).cos()),
    }
}

fn request(axes: Vec<PvtAxisSpec>) -> PvtRequestSpec {
    PvtRequestSpec {
        axes,
        cycle_time_ns: None,
        interpolation: Ok(PvtInterpolation::SShaped),
        policy: Ok(PvtPolicy::PreferVelocity),
        finish_unreached: false,
    }
}

fn six() -> Vec<PvtAxisSpec> {
    (0..6).map(|index| axis(&format!("axis {index}"), 0.7 * f64::from(index), 40)).collect()
}

#[tokio::test]
async fn what_is_planned_there_is_what_is_planned_here() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let policies = [PvtPolicy::PreferVelocity, PvtPolicy::PreferPosition, PvtPolicy::ExtendTime];
    for interpolation in [PvtInterpolation::SShaped, PvtInterpolation::Cubic, PvtInterpolation::Quintic] {
        for policy in policies {
            let spec =
                PvtRequestSpec { interpolation: Ok(interpolation), policy: Ok(policy), ..request(six()) };
            let here = JudgedPvt::answer(&PvtRequest::try_from(spec.clone()).unwrap()).unwrap();
            let there = client.plan_pvt(spec).await.unwrap();
            assert_eq!(there, here, "{interpolation:?} {policy:?}");
            assert_eq!(there.points().len(), 240);
            let certificate = client.verify(there.judged().plan(), vec![]).await.unwrap();
            assert!(certificate.passed());
            assert_eq!(&certificate, there.judged().certificate());
            let method = there.judged().plan().method().pvt.unwrap();
            assert_eq!((method.interpolation, method.policy), (interpolation, policy));
        }
    }
}

#[tokio::test]
async fn the_wire_says_what_was_made_of_each_point() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let wire = pb::PlanPvtRequest::from(request(vec![axis("x", 0.0, 20)]));
    let answer = planner.plan_pvt(wire).await.unwrap().into_inner();
    let plan = answer.plan.unwrap();
    let method = plan.method.unwrap();
    assert_eq!(method.interpolation(), pb::PvtInterpolation::SShaped);
    assert_eq!(method.policy(), pb::PvtPolicy::PreferVelocity);
    assert_eq!((method.family(), method.order), (pb::ProfileFamily::SCurve, 3));
    let regions: Vec<_> = answer.points.iter().map(|point| point.region.clone()).collect();
    assert_eq!(plan.axes[0].classification.as_ref().unwrap().pvt_regions, regions);
    assert!(regions.iter().all(|region| ["R1", "R2", "R3", "R4"].contains(&region.as_str())));
    let wrong = &answer.points[16];
    assert_eq!((wrong.axis.as_str(), wrong.point), ("x", 16));
    assert_eq!(wrong.adjustments[0].quantity(), pb::Quantity::Position);
    assert_eq!(wrong.adjustments[0].reason, "PVT_OUT_OF_REACH");
    assert_eq!(wrong.adjustments[0].planned, wrong.position);
    let way = wrong.position - answer.points[15].position;
    assert!((way - wrong.greatest_displacement.unwrap()).abs() < 1e-15, "{wrong:?}");
    assert!(plan.explanation.unwrap().bindings.is_empty());
}

fn to_rest(mut spec: PvtAxisSpec) -> PvtAxisSpec {
    spec.start.velocity = 0.0;
    if let Some(last) = spec.velocities.last_mut() {
        *last = 0.0;
    }
    spec
}

/// The digest of what a simulated axis has played is that of the samples, whatever joins the points and however they end.
#[tokio::test]
async fn plans_through_points_are_followed_as_they_are_sampled() {
    let (server, simulator) = (Loopback::start().await, LoopbackAxis::start().await);
    let client = server.client().await;
    let remote = RemoteAxis::connect(&simulator.endpoint()).await.unwrap();
    for interpolation in [PvtInterpolation::SShaped, PvtInterpolation::Cubic, PvtInterpolation::Quintic] {
        let axes = vec![to_rest(axis("x", 0.0, 30)), to_rest(axis("y", 1.1, 30))];
        let spec =
            PvtRequestSpec { interpolation: Ok(interpolation), finish_unreached: true, ..request(axes) };
        let plan = client.plan_pvt(spec).await.unwrap().judged().clone().accepted().unwrap();
        let digest = client.digest(plan.judged()).await.unwrap();
        let cycles = plan.plan().cycle_count();
        let proved = interpolation == PvtInterpolation::SShaped;
        let request = TrackRequest {
            models: vec![AxisModel::flexible("x"), AxisModel::ideal("y")],
            clock: Clock::Virtual,
            accept_unproved: !proved,
            ..TrackRequest::new("cell-7/xy", server.endpoint(), plan)
        };
        if !proved {
            let bold = TrackRequest { accept_unproved: false, ..request.clone() };
            let refused = async { remote.track(bold).await?.next().await }.await;
            let Err(Error::Rejected(rejected)) = refused else { panic!("{refused:?}") };
            assert_eq!(rejected.reason, Reason::NotProved);
        }
        let mut run = remote.track(request).await.unwrap();
        let mut commanded = 0;
        while let Some(update) = run.next().await.unwrap() {
            if let Update::Samples(samples) = update {
                commanded += samples.commanded.cycles();
            }
        }
        let report = run.finish().unwrap();
        assert_eq!((report.stream.cycles_executed, report.stream.digest), (cycles, digest));
        assert!(commanded as u64 > cycles);
        assert_eq!((report.stream.counters.underruns, report.stream.counters.refused_batches), (0, 0));
        assert!(report.axes[0].max_following_error > 0.0);
    }
}

#[tokio::test]
async fn a_plan_that_ends_at_speed_is_stopped_after_its_last_point() {
    let server = Loopback::start().await;
    let client = server.client().await;
    for interpolation in [PvtInterpolation::SShaped, PvtInterpolation::Cubic, PvtInterpolation::Quintic] {
        let spec = PvtRequestSpec {
            interpolation: Ok(interpolation),
            ..request(vec![axis("x", 0.0, 10), axis("y", 1.0, 10)])
        };
        let judged = client.plan_pvt(spec).await.unwrap().judged().clone();
        let plan = judged.accepted().unwrap();
        let last = plan.plan().cycle_count();
        let open = proto::stream::Open { accept_unproved: true, ..open("cell-7/xy", plan) };
        let mut setpoints = client::Setpoints::open(&client, open).await.unwrap();
        let motion = setpoints.motion().clone();
        assert_eq!(motion.under_way.closing_from_cycle(), Some(last));
        let stops = motion.plan().axes().iter().all(|axis| {
            let said = |said: &planner::Adjustment| said.reason == AdjustmentReason::ClosingStop;
            axis.adjustments.iter().any(said)
        });
        assert!(stops && motion.plan().ends_at_rest());
        let mut cycles = 0;
        while setpoints.next().await.unwrap().is_some() {
            cycles += 1;
        }
        assert_eq!(cycles, motion.plan().cycle_count());
    }
}

/// A refusal changes nothing, and tells what would do.
#[tokio::test]
async fn a_point_that_cannot_be_met_is_refused_with_what_could() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let rejecting = |axes| PvtRequestSpec { policy: Ok(PvtPolicy::Reject), ..request(axes) };
    let refusal = planner.plan_pvt(pb::PlanPvtRequest::from(rejecting(six()))).await.unwrap_err();
    assert_eq!(refusal.code(), Code::FailedPrecondition);
    let rejected = Rejected::from_status(&refusal).unwrap();
    assert_eq!(rejected.reason, Reason::PvtUnreachable);
    let fields: Vec<_> = rejected.fields.iter().map(|violation| violation.field.as_str()).collect();
    let expected: Vec<_> = (0..6).map(|axis| format!("axes[{axis}].positions[16]")).collect();
    assert_eq!(fields, expected);
    let figure = |key: &str| rejected.metadata[key].parse::<f64>().unwrap();
    assert_eq!(rejected.metadata["quantity"], "POSITION");
    let (given, nearest) = (figure("given"), figure("nearest"));
    assert!(nearest < given && nearest == figure("greatest") && figure("least") < nearest);
    assert!(figure("needed_time") > figure("given_time"));
    // What it says would do, does.
    let mut mended = axis("x", 0.0, 17);
    mended.positions[16] = nearest;
    assert!(planner.plan_pvt(pb::PlanPvtRequest::from(rejecting(vec![mended]))).await.is_ok());

    // Too fast for the time.
    let mut hurried = axis("x", 0.0, 5);
    hurried.velocities[3] = -0.4;
    let refusal = planner.plan_pvt(pb::PlanPvtRequest::from(rejecting(vec![hurried.clone()]))).await;
    let rejected = Rejected::from_status(&refusal.unwrap_err()).unwrap();
    assert_eq!(rejected.fields[0].field, "axes[0].velocities[3]");
    assert_eq!(rejected.metadata["quantity"], "VELOCITY");
    let figure = |key: &str| rejected.metadata[key].parse::<f64>().unwrap();
    assert!((figure("given_time") - 0.05).abs() < 1e-12 && figure("needed_time") > 0.05);
    assert!(figure("given") == -0.4 && figure("nearest") > -0.4 && figure("nearest") < 0.2);
    let mut mended = hurried.clone();
    mended.velocities[3] = figure("nearest");
    mended.positions[3] = figure("nearest_position");
    for list in [&mut mended.times, &mut mended.positions, &mut mended.velocities] {
        list.truncate(4);
    }
    assert!(planner.plan_pvt(pb::PlanPvtRequest::from(rejecting(vec![mended]))).await.is_ok());
    let client = server.client().await;
    let adjusted = client.plan_pvt(request(vec![hurried])).await.unwrap();
    let said = &adjusted.points()[3].adjustments;
    assert!(said.iter().any(|said| said.quantity == Quantity::Velocity && said.planned == figure("nearest")));
}

type Row = (&'static str, fn(&mut pb::PlanPvtRequest), Code, Reason, &'static [&'static str]);

const ROWS: [Row; 19] = [
    ("no axis", |r| r.axes.clear(), Code::InvalidArgument, Reason::NoAxes, &["axes"]),
    ("no kind", |r| r.axes[1].kind = 0, Code::InvalidArgument, Reason::KindUnspecified, &["axes[1].kind"]),
    (
        "an interpolation of later",
        |r| r.interpolation = 9,
        Code::InvalidArgument,
        Reason::KindUnspecified,
        &["interpolation"],
    ),
    ("a policy of later", |r| r.policy = -1, Code::InvalidArgument, Reason::KindUnspecified, &["policy"]),
    (
        "no point",
        |r| {
            for axis in &mut r.axes {
                axis.times.clear();
                axis.positions.clear();
                axis.velocities.clear();
            }
        },
        Code::InvalidArgument,
        Reason::NoPoints,
        &["axes[0].times"],
    ),
    (
        "a position less",
        |r| {
            r.axes[1].positions.pop();
        },
        Code::InvalidArgument,
        Reason::LengthMismatch,
        &["axes[1].positions"],
    ),
    (
        "a velocity more",
        |r| r.axes[0].velocities.push(0.0),
        Code::InvalidArgument,
        Reason::LengthMismatch,
        &["axes[0].velocities"],
    ),
    (
        "other times",
        |r| r.axes[1].times[3] += 1e-3,
        Code::InvalidArgument,
        Reason::LengthMismatch,
        &["axes[1].times[3]"],
    ),
    (
        "times that fall",
        |r| {
            for axis in &mut r.axes {
                axis.times.swap(3, 4)
            }
        },
        Code::InvalidArgument,
        Reason::TimesNotIncreasing,
        &["axes[0].times[4]"],
    ),
    (
        "a time of zero",
        |r| {
            for axis in &mut r.axes {
                axis.times[0] = 0.0
            }
        },
        Code::InvalidArgument,
        Reason::TimesNotIncreasing,
        &["axes[0].times[0]"],
    ),
    (
        "less than a cycle",
        |r| {
            for axis in &mut r.axes {
                axis.times[1] = axis.times[0] + 5e-4
            }
        },
        Code::InvalidArgument,
        Reason::TimesNotIncreasing,
        &["axes[0].times[1]"],
    ),
    (
        "not a number",
        |r| r.axes[0].positions[7] = f64::NAN,
        Code::InvalidArgument,
        Reason::NotFinite,
        &["axes[0].positions[7]"],
    ),
    (
        "a limit of zero",
        |r| r.axes[1].limits.as_mut().unwrap().max_jerk = 0.0,
        Code::InvalidArgument,
        Reason::LimitNotPositive,
        &["axes[1].limits.max_jerk"],
    ),
    (
        "no limits",
        |r| r.axes[1].limits = None,
        Code::InvalidArgument,
        Reason::FieldMissing,
        &["axes[1].limits"],
    ),
    (
        "a start too fast",
        |r| r.axes[1].start.as_mut().unwrap().velocity = 0.6,
        Code::FailedPrecondition,
        Reason::StartOutsideLimits,
        &["axes[1].start.velocity"],
    ),
    (
        "a point too fast",
        |r| r.axes[1].velocities[5] = -0.6,
        Code::FailedPrecondition,
        Reason::GoalOutsideLimits,
        &["axes[1].velocities[5]"],
    ),
    (
        "a point out of range",
        |r| r.axes[0].limits.as_mut().unwrap().max_position = Some(0.09),
        Code::FailedPrecondition,
        Reason::GoalOutsideLimits,
        &["axes[0].positions[11]"],
    ),
    (
        "two of one name",
        |r| r.axes[1].axis = "x".into(),
        Code::InvalidArgument,
        Reason::DuplicateAxis,
        &["axes[1].axis"],
    ),
    // Mistakes in what was said come first.
    (
        "all at once",
        |r| {
            r.axes[0].velocities[2] = 7.0;
            r.axes[1].velocities[0] = f64::INFINITY;
            r.axes[1].times.truncate(4);
        },
        Code::InvalidArgument,
        Reason::LengthMismatch,
        &[
            "axes[0].velocities[2]",
            "axes[1].times",
            "axes[1].positions",
            "axes[1].velocities",
            "axes[1].velocities[0]",
        ],
    ),
];

#[tokio::test]
async fn bad_tables_are_refused_with_the_exact_place() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    for (name, spoil, code, reason, fields) in ROWS {
        let mut wire = pb::PlanPvtRequest::from(request(vec![axis("x", 0.0, 16), axis("y", 1.0, 16)]));
        spoil(&mut wire);
        let status = planner.plan_pvt(wire).await.expect_err(name);
        let rejected = Rejected::from_status(&status).unwrap();
        assert_eq!((status.code(), rejected.reason), (code, reason), "{name}: {rejected:?}");
        let said: Vec<_> = rejected.fields.iter().map(|violation| violation.field.as_str()).collect();
        let missing: Vec<_> = fields.iter().filter(|field| !said.contains(field)).collect();
        assert!(missing.is_empty(), "{name}: {missing:?} not in {said:?}");
    }
}

#[tokio::test]
async fn more_points_than_the_server_takes_are_refused_by_number() {
    let config = server::Config {
        limits: server::Limits { pvt_points: 31, ..server::Limits::default() },
        ..server::Config::loopback()
    };
    let server = Loopback::with(config).await;
    let client = server.client().await;
    let Err(Error::Rejected(rejected)) =
        client.plan_pvt(request(vec![axis("x", 0.0, 16), axis("y", 0.0, 16)])).await
    else {
        panic!("32 points")
    };
    assert_eq!(rejected.reason, Reason::TooManyPoints);
    assert_eq!((rejected.metadata["given"].as_str(), rejected.metadata["allowed"].as_str()), ("32", "31"));
    assert!(rejected.message.contains("takes 31 of all axes together"), "{rejected}");
    assert!(client.plan_pvt(request(vec![axis("x", 0.0, 31)])).await.is_ok());
}

/// Ten thousand points of six axes, and back again to be judged and sampled: within the limits that server and client begin with.
#[tokio::test]
async fn the_largest_table_fits() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let axes = (0..6).map(|index| axis(&format!("axis {index}"), f64::from(index), 10_000)).collect();
    let planned = client.plan_pvt(request(axes)).await.unwrap();
    assert_eq!(planned.points().len(), 60_000);
    let certificate = client.verify(planned.judged().plan(), vec![]).await.unwrap();
    assert!(certificate.passed());
    let mut samples = client.sample(planned.judged(), 499_990, 0).await.unwrap();
    let chunk = samples.next().await.unwrap().unwrap();
    assert_eq!((chunk.first_cycle, chunk.columns.cycles()), (499_990, 11));
}
