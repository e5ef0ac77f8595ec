//! Every family of profiles over the wire: planned, streamed, followed; and refused where it cannot be.

use e2e::{Loopback, fifty_millimetres, planned};
use planner::{Family, RequestSpec};
use proto::{Reason, Rejected, pb};
use sim_axis::{AxisModel, Clock, TrackRequest, track};
use tonic::Code;

/// Fifty millimetres by `family`, within limits that every order reaches.
fn spec(family: Family, order: Option<u32>) -> RequestSpec {
    let mut spec = RequestSpec { family: Ok(family), order, ..fifty_millimetres() };
    let limits = &mut spec.axes[0].limits;
    let (mut lower, mut upper) = (limits.max_acceleration, limits.max_jerk);
    let mut higher = (4..=8).map(|_| {
        (lower, upper) = (upper, 2.0 * upper * upper / lower);
        upper
    });
    limits.max_snap = higher.next();
    limits.max_higher_derivatives = higher.collect();
    spec
}

fn families() -> Vec<(&'static str, RequestSpec)> {
    let mut asymmetric = spec(Family::SCurve, None);
    asymmetric.axes[0].limits.max_deceleration = Some(1.5);
    let mut backward = spec(Family::Trigonometric, None);
    backward.axes[0].goal.position = -0.05;
    let whole = |spec| RequestSpec { end_on_cycle: true, ..spec };
    vec![
        ("S-curve", spec(Family::SCurve, None)),
        ("asymmetric", asymmetric.clone()),
        ("trapezoid", spec(Family::Trapezoidal, None)),
        ("order 2", spec(Family::Polynomial, Some(2))),
        ("order 4", spec(Family::Polynomial, Some(4))),
        ("order 5", spec(Family::Polynomial, Some(5))),
        ("order 8", spec(Family::Polynomial, Some(8))),
        ("cosine", spec(Family::Trigonometric, None)),
        ("cosine backward", backward),
        ("asymmetric on cycles", whole(asymmetric)),
        ("order 5 on cycles", whole(spec(Family::Polynomial, Some(5)))),
        ("cosine on cycles", whole(spec(Family::Trigonometric, None))),
    ]
}

#[tokio::test]
async fn every_family_is_streamed_as_it_is_sampled() {
    let server = Loopback::start().await;
    let client = server.client().await;
    for (name, spec) in families() {
        // Planned there, not here: over the wire and back.
        let plan = client.plan(spec).await.unwrap().accepted().unwrap();
        let digest = client.digest(plan.judged()).await.unwrap();
        let cycles = plan.plan().cycle_count();
        let request = TrackRequest {
            models: vec![AxisModel::flexible("x")],
            clock: Clock::Virtual,
            ..TrackRequest::new(format!("cell-7/{name}"), server.endpoint(), plan)
        };
        let report = track(request, |_| {}).await.unwrap();
        let stream = &report.stream;
        assert_eq!((stream.cycles_executed, stream.digest), (cycles, digest), "{name}");
        assert_eq!((stream.counters.underruns, stream.counters.refused_batches), (0, 0), "{name}");
        let error = report.axes[0].max_following_error;
        assert!(error > 1e-7 && error < 1e-4, "{name}: {error}");
    }
}

#[tokio::test]
async fn a_move_that_ends_on_a_cycle_lasts_whole_cycles() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    for (name, spec) in families().into_iter().filter(|(_, spec)| spec.end_on_cycle) {
        let plan = planner.plan(pb::PlanRequest::from(spec)).await.unwrap().into_inner().plan.unwrap();
        assert!(plan.method.unwrap().end_on_cycle && plan.certificate.unwrap().passed, "{name}");
        let (duration, exact) = (plan.duration, plan.cycle_count as f64 * 1e-3);
        assert!((duration - exact).abs() <= f64::EPSILON * exact, "{name}: {duration} {exact}");
    }
    let moving = pb::PlanRequest::from(RequestSpec { end_on_cycle: true, ..moving() });
    let plan = planner.plan(moving).await.unwrap().into_inner().plan.unwrap();
    let exact = plan.cycle_count as f64 * 1e-3;
    assert!(plan.certificate.unwrap().passed && (plan.duration - exact).abs() <= f64::EPSILON * exact);
}

fn moving() -> RequestSpec {
    let mut spec = fifty_millimetres();
    spec.axes[0].goal.velocity = 0.1;
    spec
}

type Row = (&'static str, RequestSpec, Code, Reason, &'static str);

fn rows() -> Vec<Row> {
    use Code::InvalidArgument;
    let polynomial = |order| spec(Family::Polynomial, order);
    let without = |order, forget: fn(&mut planner::LimitsSpec)| {
        let mut spec = polynomial(Some(order));
        forget(&mut spec.axes[0].limits);
        spec
    };
    let at_speed = |family, order| {
        let mut spec = spec(family, order);
        spec.axes[0].goal.velocity = 0.1;
        spec
    };
    let from_speed = |family, order| {
        let mut spec = spec(family, order);
        spec.axes[0].start.velocity = 0.1;
        spec
    };
    let (order, unsupported) = ("order", Reason::OrderUnsupported);
    let (snap, higher) = ("axes[0].limits.max_snap", "axes[0].limits.max_higher_derivatives");
    vec![
        ("no order", polynomial(None), InvalidArgument, unsupported, order),
        ("order 0", polynomial(Some(0)), InvalidArgument, unsupported, order),
        ("order 1", polynomial(Some(1)), InvalidArgument, unsupported, order),
        ("order 9", polynomial(Some(9)), InvalidArgument, unsupported, order),
        ("order 40", polynomial(Some(40)), InvalidArgument, unsupported, order),
        (
            "an order that the family has not",
            spec(Family::Trigonometric, Some(5)),
            InvalidArgument,
            unsupported,
            order,
        ),
        ("no snap", without(4, |limits| limits.max_snap = None), InvalidArgument, Reason::FieldMissing, snap),
        (
            "no crackle",
            without(5, |limits| limits.max_higher_derivatives.clear()),
            InvalidArgument,
            Reason::FieldMissing,
            higher,
        ),
        (
            "too few",
            without(8, |limits| limits.max_higher_derivatives.truncate(3)),
            InvalidArgument,
            Reason::FieldMissing,
            higher,
        ),
        (
            "a polynomial to a speed",
            at_speed(Family::Polynomial, Some(4)),
            InvalidArgument,
            Reason::StateNotAtRest,
            "axes[0].goal.velocity",
        ),
        (
            "a cosine from a speed",
            from_speed(Family::Trigonometric, None),
            InvalidArgument,
            Reason::StateNotAtRest,
            "axes[0].start.velocity",
        ),
    ]
}

#[tokio::test]
async fn what_a_family_cannot_do_is_refused_with_what_can() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    for (name, spec, code, reason, field) in rows() {
        let status = planner.plan(pb::PlanRequest::from(spec)).await.expect_err(name);
        assert_eq!(status.code(), code, "{name}: {status:?}");
        let rejected = Rejected::from_status(&status).unwrap();
        assert_eq!(rejected.reason, reason, "{name}: {rejected:?}");
        assert!(rejected.fields.iter().any(|violation| violation.field == field), "{name}: {rejected:?}");
        if reason == Reason::StateNotAtRest {
            assert!(rejected.message.contains("S_CURVE"), "{name}: {}", rejected.message);
        }
    }
}

/// Tiny and huge ways, limits that are twelve decades apart: exact, of the family that was asked for, and legal.
#[tokio::test]
async fn extreme_moves_are_exact_in_every_family() {
    let server = Loopback::start().await;
    let mut planner = server.planner().await;
    let mut limits = Vec::new();
    for scales in [[1.0, 1.0], [1e-6, 1e6], [1e6, 1e-6], [1e12, 1.0], [1.0, 1e12]] {
        for distance in [1e-12, 0.05, 1e6] {
            limits.push((distance, scales));
        }
    }
    for (name, spec) in families() {
        for &(distance, [low, high]) in &limits {
            let mut spec = spec.clone();
            // A move of a million metres at a micrometre a second lasts longer than cycles of a millisecond are counted in tests.
            spec.cycle_time_ns = Some(1_000_000_000);
            spec.axes[0].goal.position = distance;
            spec.axes[0].limits.max_velocity *= low;
            spec.axes[0].limits.max_jerk *= high;
            let family = *spec.family.as_ref().unwrap();
            let plan = planner.plan(pb::PlanRequest::from(spec)).await;
            let plan = plan.unwrap_or_else(|status| panic!("{name}, {distance}: {status}"));
            let plan = plan.into_inner().plan.unwrap();
            assert!(plan.certificate.unwrap().passed, "{name}, {distance} {low} {high}");
            assert_eq!(plan.axes[0].reached.unwrap().position, distance, "{name}");
            let method = plan.method.unwrap();
            assert!(method.family().as_str_name().ends_with(family.name()), "{name}: {method:?}");
        }
    }
    // What was planned in this process is the same.
    let here = planned(spec(Family::Polynomial, Some(5)));
    let there = planner.plan(pb::PlanRequest::from(spec(Family::Polynomial, Some(5)))).await.unwrap();
    assert_eq!(Some(proto::plan_to_wire(here.judged())), there.into_inner().plan);
}
