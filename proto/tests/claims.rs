//! What a plan says of itself, and is not.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "a test may fail by panicking")]

use planner::{Judged, JudgedPvt, PvtRequest, PvtRequestSpec, Request, RequestSpec};
use proto::{Reason, Rejected, pb, plan_as_it_is, plan_from_wire, plan_to_wire, pvt_from_wire, pvt_to_wire};

fn plan_by(family: pb::ProfileFamily, order: Option<u32>) -> pb::Plan {
    let axis = pb::AxisMove {
        axis: "x".into(),
        kind: pb::AxisKind::Prismatic as i32,
        goal: Some(pb::AxisState { position: 0.05, ..Default::default() }),
        limits: Some(pb::AxisLimits {
            max_velocity: 0.25,
            max_acceleration: 3.0,
            max_jerk: 100.0,
            max_snap: Some(1e4),
            max_higher_derivatives: vec![1e6, 1e8, 1e10, 1e12],
            ..Default::default()
        }),
        ..Default::default()
    };
    let wire = pb::PlanRequest { axes: vec![axis], family: family as i32, order, ..Default::default() };
    plan_to_wire(&Judged::answer(&Request::try_from(RequestSpec::from(wire)).unwrap()).unwrap())
}

fn s_curve() -> pb::Plan {
    plan_by(pb::ProfileFamily::SCurve, None)
}

fn method(plan: &mut pb::Plan) -> &mut pb::PlanMethod {
    plan.method.as_mut().unwrap()
}

/// What is refused of `plan`, as `field: description`, but for the fingerprint, which every change makes wrong.
#[track_caller]
fn refused(plan: pb::Plan) -> (Rejected, Vec<String>) {
    let bare = pb::Plan { fingerprint: vec![], ..plan };
    let rejected = Rejected::from(plan_from_wire(bare).unwrap_err());
    let fields = rejected.fields.iter().map(|f| format!("{}: {}", f.field, f.description)).collect();
    (rejected, fields)
}

type Row<'a> = (&'a str, &'a dyn Fn(&mut pb::Plan), &'a [&'a str]);

#[test]
fn every_statement_is_held_against_the_motion() {
    use pb::{ProfileFamily as Family, Quantity};
    let rows: &[Row<'_>] = &[
        ("a cycle less", &|p| p.cycle_count = 313, &["cycle_count: says 313, and should say 314"]),
        (
            "cycles without end",
            &|p| p.cycle_count = u64::MAX,
            &["cycle_count: says 18446744073709551615, and should say 314"],
        ),
        ("longer", &|p| p.duration = 0.5, &["duration: says 0.5, and should say 0.31333333333333335"]),
        ("negative", &|p| p.duration = -1e9, &["duration: says -1e9, and should say 0.31333333333333335"]),
        ("NaN", &|p| p.duration = f64::NAN, &["duration: says NaN, and should say 0.31333333333333335"]),
        (
            "no jerk",
            &|p| p.guaranteed.truncate(2),
            &["guaranteed: says VELOCITY, ACCELERATION, and should say VELOCITY, ACCELERATION, JERK"],
        ),
        (
            "nothing guaranteed",
            &|p| p.guaranteed.clear(),
            &["guaranteed: says nothing, and should say VELOCITY, ACCELERATION, JERK"],
        ),
        (
            "another instead",
            &|p| p.guaranteed[0] = Quantity::Snap as i32,
            &["guaranteed: says SNAP, ACCELERATION, JERK, and should say VELOCITY, ACCELERATION, JERK"],
        ),
        (
            "a trapezoid",
            &|p| method(p).family = Family::Trapezoidal as i32,
            &["method.family: says TRAPEZOIDAL, and should say S_CURVE or POLYNOMIAL"],
        ),
        (
            "cosines",
            &|p| method(p).family = Family::Trigonometric as i32,
            &["method.family: says TRIGONOMETRIC, and should say S_CURVE or POLYNOMIAL"],
        ),
        ("an order", &|p| method(p).order = 4, &["method.order: says 4, and should say 3"]),
        (
            "an order of many",
            &|p| {
                method(p).family = Family::Polynomial as i32;
                method(p).order = u32::MAX;
            },
            &["method.order: says 4294967295, and should say 3"],
        ),
        (
            "all at once",
            &|p| {
                p.cycle_count = 1;
                p.duration = 1.0;
                method(p).order = 2;
                p.guaranteed.truncate(2);
            },
            &[
                "method.order: says 2, and should say 3",
                "guaranteed: says VELOCITY, ACCELERATION, and should say VELOCITY, ACCELERATION, JERK",
                "cycle_count: says 1, and should say 314",
                "duration: says 1, and should say 0.31333333333333335",
            ],
        ),
    ];
    for (name, change, expected) in rows {
        let mut plan = s_curve();
        change(&mut plan);
        let (rejected, fields) = refused(plan);
        let expected: Vec<_> =
            expected.iter().map(|text| format!("{text}: correct it, or plan again")).collect();
        assert_eq!(fields, expected, "{name}");
        assert_eq!(rejected.reason, Reason::PlanRejected, "{name}");
    }
    let (rejected, _) = refused(pb::Plan { cycle_count: 5, ..s_curve() });
    assert_eq!((rejected.metadata["given"].as_str(), rejected.metadata["needed"].as_str()), ("5", "314"));
}

#[test]
fn every_family_is_told_from_the_others() {
    use pb::ProfileFamily::{Polynomial, SCurve, Trapezoidal, Trigonometric};
    let polynomial = |order| plan_by(Polynomial, Some(order));
    let rows = [
        (plan_by(Trapezoidal, None), Trigonometric, 3, "guaranteed"),
        (plan_by(Trapezoidal, None), SCurve, 3, "guaranteed"),
        (plan_by(Trigonometric, None), SCurve, 3, "method.family"),
        (plan_by(Trigonometric, None), Polynomial, 3, "method.family"),
        (polynomial(4), SCurve, 3, "method.family"),
        (polynomial(4), Polynomial, 3, "method.order"),
        (polynomial(8), Polynomial, 4, "method.order"),
        (polynomial(3), Trapezoidal, 2, "method.family"),
    ];
    for (mut plan, family, order, field) in rows {
        let was = plan.method.unwrap();
        method(&mut plan).family = family as i32;
        method(&mut plan).order = order;
        let (_, fields) = refused(plan);
        assert!(fields[0].starts_with(field), "{was:?} as {family:?} of order {order}: {fields:?}");
    }
    for order in 2..=8 {
        plan_from_wire(polynomial(order)).unwrap();
    }
}

/// A plan through two points, that ends at speed.
fn joined_by(interpolation: pb::PvtInterpolation) -> JudgedPvt {
    let axis = pb::PvtAxis {
        axis: "x".into(),
        kind: pb::AxisKind::Prismatic as i32,
        limits: Some(pb::AxisLimits {
            max_velocity: 0.25,
            max_acceleration: 3.0,
            max_jerk: 100.0,
            ..Default::default()
        }),
        start: None,
        times: vec![0.1, 0.2],
        positions: vec![0.004, 0.02],
        velocities: vec![0.1, 0.2],
    };
    let wire =
        pb::PlanPvtRequest { axes: vec![axis], interpolation: interpolation as i32, ..Default::default() };
    JudgedPvt::answer(&PvtRequest::try_from(PvtRequestSpec::from(wire)).unwrap()).unwrap()
}

#[test]
fn plans_through_points_are_told_from_each_other_and_from_moves() {
    use pb::PvtInterpolation::{Cubic, Quintic, SShaped, Unspecified};
    let rows: [(pb::PvtInterpolation, pb::PvtInterpolation, &str); 6] = [
        (SShaped, Quintic, "method.interpolation: says QUINTIC, and should say S_SHAPED or CUBIC"),
        (SShaped, Cubic, "method.family: says S_CURVE, and should say POLYNOMIAL"),
        (Cubic, SShaped, "method.family: says POLYNOMIAL, and should say S_CURVE"),
        (Quintic, SShaped, "method.interpolation: says S_SHAPED, and should say QUINTIC"),
        (Quintic, Cubic, "method.interpolation: says CUBIC, and should say QUINTIC"),
        (Cubic, Unspecified, "method.interpolation: is not set: choose one of S_SHAPED, CUBIC, QUINTIC"),
    ];
    for (made, said, expected) in rows {
        let mut plan = plan_to_wire(joined_by(made).judged());
        method(&mut plan).interpolation = said as i32;
        let (_, fields) = refused(plan);
        assert!(fields[0].starts_with(expected), "{made:?} as {said:?}: {fields:?}");
    }
    // What keeps no limit promises none; a cubic that says it does is for the judge.
    let mut cubic = plan_to_wire(joined_by(Cubic).judged());
    assert_eq!(cubic.guaranteed, [0; 0]);
    cubic.guaranteed = plan_to_wire(joined_by(SShaped).judged()).guaranteed;
    let plan = plan_from_wire(pb::Plan { fingerprint: vec![], ..cubic }).unwrap();
    assert!(!Judged::new(plan).certificate().passed());
    let mut ramps = plan_to_wire(joined_by(SShaped).judged());
    ramps.guaranteed.pop();
    assert!(refused(ramps).1[0].starts_with("guaranteed: says VELOCITY, ACCELERATION, and should say"));
    let mut orderly = plan_to_wire(joined_by(Quintic).judged());
    method(&mut orderly).order = 3;
    assert!(refused(orderly).1[0].starts_with("method.order: says 3, and should say 5"));
}

#[test]
fn a_plan_through_points_comes_back_also_when_it_is_stopped() {
    for interpolation in [1, 2, 3].map(|number| pb::PvtInterpolation::try_from(number).unwrap()) {
        let judged = joined_by(interpolation);
        assert_eq!(pvt_from_wire(pvt_to_wire(&judged)).unwrap(), judged);
        let (stopped, _) = judged.judged().plan().with_closing_stop().unwrap().unwrap();
        assert_eq!(plan_from_wire(plan_to_wire(&Judged::new(stopped.clone()))).unwrap(), stopped);
    }
}

/// One axis is late, the other goes on with it: both say so, and what is made of it on the wire is the same.
#[test]
fn a_plan_that_is_finished_together_at_speed_comes_back() {
    let axis = |name: &str, velocity: f64, position: f64| pb::PvtAxis {
        axis: name.into(),
        kind: pb::AxisKind::Prismatic as i32,
        limits: Some(pb::AxisLimits {
            max_velocity: 0.25,
            max_acceleration: 3.0,
            max_jerk: 100.0,
            ..Default::default()
        }),
        start: Some(pb::AxisState { position: 0.0, velocity, acceleration: 0.0 }),
        times: vec![0.2],
        positions: vec![position],
        velocities: vec![0.1],
    };
    let axes = vec![axis("far", 0.0, 0.1), axis("met", 0.1, 0.02)];
    let wire = pb::PlanPvtRequest { axes, finish_unreached: true, ..Default::default() };
    let judged = JudgedPvt::answer(&proto::pvt_request_from_wire(wire).unwrap()).unwrap();
    assert!(judged.judged().certificate().passed());
    let wire = pvt_to_wire(&judged);
    for axis in &wire.plan.as_ref().unwrap().axes {
        let reasons: Vec<_> = axis.adjustments.iter().map(|adjustment| adjustment.reason.as_str()).collect();
        assert_eq!(reasons, ["PVT_FINISHED_LATE"], "{}", axis.axis);
    }
    assert_eq!(pvt_from_wire(wire).unwrap(), judged);
    let (stopped, _) = judged.judged().plan().with_closing_stop().unwrap().unwrap();
    assert_eq!(plan_from_wire(plan_to_wire(&Judged::new(stopped.clone()))).unwrap(), stopped);
}

#[test]
fn a_report_on_no_point_is_refused() {
    let mut wire = pvt_to_wire(&joined_by(pb::PvtInterpolation::SShaped));
    wire.points[1].axis = "y".into();
    wire.points[0].region = "R5".into();
    let said: Vec<_> = pvt_from_wire(wire).unwrap_err().as_slice().iter().map(ToString::to_string).collect();
    assert_eq!(
        said,
        [
            "points[0].region: is \"R5\", which this version does not know: use one of R1, R2, R3, R4",
            "points[1].axis: no axis is called \"y\": the plan has x",
        ]
    );
}

#[test]
fn a_fingerprint_is_that_of_the_plan() {
    let good = s_curve();
    let hex = |bytes: &[u8]| bytes.iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    // Also where the change says nothing of itself.
    let changes: [&dyn Fn(&mut pb::Plan); 5] = [
        &|p| p.fingerprint = vec![0xab],
        &|p| p.axes[0].axis = "y".into(),
        &|p| p.certificate.as_mut().unwrap().passed = false,
        &|p| p.cycle_count = 0,
        &|p| p.planner_version.clear(),
    ];
    for change in changes {
        let mut plan = good.clone();
        change(&mut plan);
        let (given, correct) = (hex(&plan.fingerprint), hex(&proto::fingerprint(&plan)));
        let rejected = Rejected::from(plan_from_wire(plan.clone()).unwrap_err());
        let [field] = rejected.fields.as_slice() else { panic!("{rejected:?}") };
        assert_eq!((field.field.as_str(), field.reason), ("fingerprint", Reason::PlanRejected));
        let text =
            format!("is {given}, that of another plan; this one has {correct}: plan again, or leave it out");
        assert!(field.description.starts_with(&text), "{}", field.description);
        // Whoever wants the motion judged gets it.
        let (read, misstated) = plan_as_it_is(plan.clone()).unwrap();
        assert_eq!(read.axes().len(), 1);
        assert_eq!(misstated.as_slice().len(), 1);
        // The way out.
        plan_from_wire(pb::Plan { fingerprint: vec![], ..plan.clone() }).unwrap();
        plan_from_wire(pb::Plan { fingerprint: proto::fingerprint(&plan).to_vec(), ..plan }).unwrap();
    }
    // A later version counts fields that this one does not see.
    plan_from_wire(pb::Plan { planner_version: "99.0.0".into(), ..good }).unwrap();
}

#[test]
fn a_plan_written_by_hand_says_only_what_its_author_knows() {
    let bare = pb::Plan {
        fingerprint: vec![],
        planner_version: String::new(),
        evaluation_version: 0,
        method: None,
        guaranteed: vec![],
        cycle_count: 0,
        duration: 0.0,
        certificate: None,
        explanation: None,
        ..s_curve()
    };
    let plan = plan_from_wire(bare).unwrap();
    assert_eq!((plan.cycle_count(), plan.guaranteed().len()), (314, 0));
    // Rounded by whoever wrote it.
    plan_from_wire(pb::Plan { fingerprint: vec![], duration: 0.3133333333, ..s_curve() }).unwrap();
}

#[test]
fn a_trapezoid_that_is_stopped_is_a_trapezoid_still() {
    let spec = RequestSpec::from(pb::PlanRequest {
        family: pb::ProfileFamily::Trapezoidal as i32,
        axes: vec![pb::AxisMove {
            axis: "x".into(),
            kind: pb::AxisKind::Prismatic as i32,
            goal: Some(pb::AxisState { position: 0.05, velocity: 0.1, acceleration: 0.0 }),
            limits: Some(pb::AxisLimits {
                max_velocity: 0.25,
                max_acceleration: 3.0,
                max_jerk: 100.0,
                ..Default::default()
            }),
            ..Default::default()
        }],
        ..Default::default()
    });
    let plan = planner::plan(&Request::try_from(spec).unwrap()).unwrap();
    let (stopped, _) = plan.with_closing_stop().unwrap().unwrap();
    plan_from_wire(plan_to_wire(&Judged::new(stopped))).unwrap();
}

#[test]
fn a_piece_that_does_not_last_is_refused_in_its_own_words() {
    for duration in [0.0, -0.25] {
        let mut plan = s_curve();
        plan.axes[0].segments[2].duration = duration;
        let (rejected, fields) = refused(plan);
        let said = format!("axes[0].segments[2].duration: is {duration} s: give a time above 0");
        assert_eq!((rejected.reason, fields), (Reason::TimesNotIncreasing, vec![said]));
    }
}
