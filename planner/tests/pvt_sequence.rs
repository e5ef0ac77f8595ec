//! Point after point: several axes, over one list of times.

#![allow(clippy::float_cmp, reason = "what is kept is kept to the last bit")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use planner::{
    AdjustmentReason, AxisKind, InvalidFields, Judged, LimitsSpec, PvtAxisSpec, PvtInterpolation, PvtPlan,
    PvtPlanner, PvtPolicy, PvtRegion, PvtRequest, PvtRequestSpec, PvtTarget, Quantity, State, certify,
    plan_pvt,
};

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 1.0, max_acceleration: 10.0, max_jerk: 500.0, ..LimitsSpec::default() }
}

fn axis(name: &str, points: &[(f64, f64, f64)]) -> PvtAxisSpec {
    PvtAxisSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        limits: limits(),
        start: State::at_rest(0.0),
        times: points.iter().map(|point| point.0).collect(),
        positions: points.iter().map(|point| point.1).collect(),
        velocities: points.iter().map(|point| point.2).collect(),
    }
}

fn request(axes: Vec<PvtAxisSpec>, policy: PvtPolicy) -> PvtRequestSpec {
    PvtRequestSpec {
        axes,
        cycle_time_ns: None,
        interpolation: Ok(PvtInterpolation::SShaped),
        policy: Ok(policy),
        finish_unreached: false,
    }
}

fn plan(spec: PvtRequestSpec) -> Result<PvtPlan, InvalidFields> {
    plan_pvt(&PvtRequest::try_from(spec)?)
}

/// Plans, and has the judge look at it.
#[track_caller]
fn judged(spec: PvtRequestSpec) -> PvtPlan {
    let planned = plan(spec).unwrap();
    let violations: Vec<_> = certify(planned.plan()).violations().collect();
    assert_eq!(violations, []);
    check_reports(&planned);
    planned
}

/// Each report says where the axis is at its time.
fn check_reports(planned: &PvtPlan) {
    for report in planned.points() {
        let profile = &planned.plan().axes()[report.axis].profile;
        let state = profile.at(report.time).state;
        let extent = 1e-9 * (1.0 + report.position.abs());
        assert!((state.position - report.position).abs() < extent, "{report:?}: {state:?}");
        assert!((state.velocity - report.velocity).abs() < 1e-9, "{report:?}: {state:?}");
    }
}

#[test]
fn what_can_be_met_is_met_as_asked() {
    let points = [(0.2, 0.05, 0.5), (0.4, 0.15, 0.5), (0.6, 0.19, 0.0)];
    let planned = judged(request(vec![axis("x", &points)], PvtPolicy::Reject));
    let ends: Vec<_> =
        planned.points().iter().map(|report| (report.time, report.position, report.velocity)).collect();
    assert_eq!(ends, points);
    assert!(planned.points().iter().all(|report| report.adjustments.is_empty()));
    let regions: Vec<_> = planned.points().iter().map(|report| report.region.unwrap()).collect();
    assert_eq!(regions, [PvtRegion::R2, PvtRegion::R1, PvtRegion::R2]);
    assert_eq!(planned.plan().duration(), 0.6);
    assert_eq!(planned.plan().cycle_count(), 600);
    assert_eq!(planned.plan().axes()[0].adjustments, []);
}

/// The second point is out of reach; the third is where it was asked to be, since positions are absolute.
#[test]
fn the_next_command_makes_up_what_one_leaves() {
    let points = [(0.2, 0.05, 0.5), (0.4, 1.0, 0.5), (1.0, 0.5, 0.0)];
    let planned = judged(request(vec![axis("x", &points)], PvtPolicy::PreferVelocity));
    let [_, missed, made_up] = planned.points() else { panic!("three points") };
    assert_eq!(missed.adjustments.len(), 1);
    let said = missed.adjustments[0];
    assert_eq!((said.quantity, said.asked, said.planned), (Quantity::Position, 1.0, missed.position));
    assert_eq!(said.reason, AdjustmentReason::PvtOutOfReach);
    assert!((missed.position - 0.05 - missed.reachable.unwrap().1).abs() < 1e-15);
    assert_eq!((made_up.position, made_up.velocity, made_up.adjustments.len()), (0.5, 0.0, 0));
}

/// An axis that needs more time takes the other with it; intervals after it keep their lengths.
#[test]
fn more_time_for_one_axis_is_more_time_for_all() {
    let hurried = [(0.2, 0.2, 0.0), (0.5, 0.2, 0.0)];
    let calm = [(0.2, 0.01, 0.0), (0.5, 0.1, 0.0)];
    let planned = judged(request(vec![axis("x", &hurried), axis("y", &calm)], PvtPolicy::ExtendTime));
    let [x1, x2, y1, y2] = planned.points() else { panic!("four reports") };
    assert!(x1.time > 0.2 && x1.time == y1.time && x2.time == y2.time);
    assert!((x2.time - x1.time - 0.3).abs() < 1e-15);
    let reasons: Vec<_> = planned.points().iter().map(|report| report.adjustments[0].reason).collect();
    let (extended, shifted) = (AdjustmentReason::PvtTimeExtended, AdjustmentReason::PvtTimeShifted);
    assert_eq!(reasons, [extended, shifted, shifted, shifted]);
    assert!(planned.points().iter().all(|report| report.adjustments.len() == 1));
    assert_eq!((x2.position, y2.position), (0.2, 0.1));
    for axis in planned.plan().axes() {
        assert!((axis.profile.duration() - x2.time).abs() <= 2.0 * f64::EPSILON * x2.time);
        assert_eq!(axis.adjustments[0].quantity, Quantity::Time);
    }
}

/// Two axes at speed, of which one needs more time: the other would then be past its point, and has to wait for it in a window
/// of its own.
#[test]
fn axes_agree_on_a_time_that_suits_all() {
    let fast = [(0.1, 0.09, 0.9)];
    let far = [(0.1, 0.12, 0.9)];
    let start = State { velocity: 0.9, ..State::default() };
    let both = [("x", fast), ("y", far)].map(|(name, points)| PvtAxisSpec { start, ..axis(name, &points) });
    let planned = judged(request(both.to_vec(), PvtPolicy::ExtendTime));
    let [x, y] = planned.points() else { panic!("two reports") };
    assert_eq!((x.position, y.position), (0.09, 0.12));
    assert!(x.time == y.time && x.time > 0.12, "{}", x.time);
}

#[test]
fn after_the_last_point_the_axis_goes_on_to_it() {
    let points = [(0.2, 0.5, 0.0)];
    let spec = PvtRequestSpec {
        finish_unreached: true,
        ..request(vec![axis("x", &points)], PvtPolicy::PreferVelocity)
    };
    let planned = judged(spec.clone());
    let axis_plan = &planned.plan().axes()[0];
    assert_eq!(axis_plan.profile.end(), State::at_rest(0.5));
    assert!(planned.plan().duration() > 0.2);
    assert!(planned.points()[0].position < 0.5);
    let [said] = axis_plan.adjustments[..] else { panic!("{:?}", axis_plan.adjustments) };
    assert_eq!((said.quantity, said.reason), (Quantity::Time, AdjustmentReason::PvtFinishedLate));
    assert_eq!((said.asked, said.planned), (0.2, planned.plan().duration()));

    // Past its point at speed, an axis goes back and passes it again.
    let passed =
        PvtAxisSpec { start: State { velocity: 0.5, ..State::default() }, ..axis("x", &[(0.05, 0.01, 0.5)]) };
    let planned = judged(PvtRequestSpec { axes: vec![passed], ..spec.clone() });
    let [x] = planned.plan().axes() else { panic!("one axis") };
    assert_eq!(x.profile.end(), State { position: 0.01, velocity: 0.5, acceleration: 0.0 });
    assert_eq!(x.profile.reversals().count(), 2);

    // Of two axes each finishes by itself, and one that was in time stays.
    let two = PvtRequestSpec { axes: vec![axis("x", &points), axis("y", &[(0.2, 0.01, 0.0)])], ..spec };
    let planned = judged(two);
    assert_eq!(planned.plan().axes()[1].profile.duration(), 0.2);
    assert_eq!(planned.plan().axes()[1].adjustments, []);
}

/// At speed nobody can wait for the others: who had met its point goes on, comes back and passes it again as they arrive.
#[test]
fn axes_that_end_at_speed_finish_together() {
    let start = State { velocity: 0.5, ..State::default() };
    let met = PvtAxisSpec { start, ..axis("met", &[(0.2, 0.1, 0.5)]) };
    let axes = vec![
        axis("far", &[(0.2, 0.5, 0.3)]),
        met,
        axis("to rest", &[(0.2, 0.4, 0.0)]),
        axis("at rest", &[(0.2, 0.01, 0.0)]),
    ];
    let spec = PvtRequestSpec { finish_unreached: true, ..request(axes, PvtPolicy::PreferVelocity) };
    let planned = judged(spec);
    let lasts = planned.plan().duration();
    assert!(lasts > 0.5, "{lasts}");
    let ends = [(0.5, 0.3), (0.1, 0.5), (0.4, 0.0), (0.01, 0.0)];
    for (axis, (position, velocity)) in planned.plan().axes().iter().zip(ends) {
        let name = &axis.axis;
        assert_eq!(axis.profile.end(), State { position, velocity, acceleration: 0.0 }, "{name}");
        if name == "at rest" {
            assert_eq!((axis.profile.duration(), axis.adjustments.len()), (0.2, 0));
            continue;
        }
        let duration = axis.profile.duration();
        assert!((duration - lasts).abs() <= 2.0 * f64::EPSILON * lasts, "{name}: {duration} of {lasts}");
        let [said] = axis.adjustments[..] else { panic!("{name}: {:?}", axis.adjustments) };
        assert_eq!((said.quantity, said.reason), (Quantity::Time, AdjustmentReason::PvtFinishedLate));
        assert_eq!((said.asked, said.planned), (0.2, duration), "{name}");
    }
    // The reports are of the points in their time, whatever comes after.
    let [far, met, _, _] = planned.points() else { panic!("four reports") };
    assert!(far.position < 0.5 && far.time == 0.2);
    assert_eq!((met.position, met.velocity, met.adjustments.len()), (0.1, 0.5, 0));
}

/// Two reversals where none was asked for, and limits broken, which the certificate shows and does not count.
#[test]
fn polynomials_meet_every_point_and_keep_no_limit() {
    let points = [(0.05, 0.02, 0.5), (0.1, 0.021, 0.5), (0.15, 0.06, 0.0)];
    for (interpolation, joins, order) in
        [(PvtInterpolation::Cubic, false, 3), (PvtInterpolation::Quintic, true, 5)]
    {
        let spec = PvtRequestSpec {
            interpolation: Ok(interpolation),
            ..request(vec![axis("x", &points)], PvtPolicy::PreferVelocity)
        };
        let planned = judged(spec);
        let ends: Vec<_> =
            planned.points().iter().map(|report| (report.time, report.position, report.velocity)).collect();
        assert_eq!(ends, points);
        assert!(planned.points().iter().all(|report| report.region.is_none()));
        assert!(planned.points().iter().all(|report| report.reachable.is_some()));
        let plan = planned.into_parts().0;
        assert_eq!((plan.guaranteed(), plan.method().order), (&[][..], order));
        assert_eq!(plan.method().pvt.unwrap().interpolation, interpolation);
        assert!(plan.axes()[0].profile.reversals().count() >= 2);
        let judged = Judged::new(plan);
        let certificate = judged.certificate();
        assert!(certificate.limits.iter().all(|check| !check.guaranteed));
        let worst = |quantity| certificate.limits.iter().find(|check| check.quantity == quantity).unwrap();
        assert!(worst(Quantity::Acceleration).margin < -1.0);
        assert_eq!(worst(Quantity::Jerk).extremum.is_infinite(), !joins);
    }
}

/// Also of a point whose velocity there is no time for it is told what the limits would let be reached: what ramps that keep the
/// nearest velocity can.
#[test]
fn the_range_is_told_where_there_is_no_time_for_the_velocity() {
    let points = [(0.01, 0.02, 0.5), (0.02, 0.021, -0.5)];
    let asked = |interpolation| PvtRequestSpec {
        interpolation: Ok(interpolation),
        ..request(vec![axis("x", &points[..1])], PvtPolicy::PreferVelocity)
    };
    let ramps = judged(asked(PvtInterpolation::SShaped));
    let by_ramps = ramps.points()[0].reachable.unwrap();
    assert!(by_ramps.1 > 0.0 && by_ramps.1 < 1e-3);
    for interpolation in [PvtInterpolation::Cubic, PvtInterpolation::Quintic] {
        let planned = judged(asked(interpolation));
        assert_eq!(planned.points()[0].reachable, Some(by_ramps));
        let both = PvtRequestSpec {
            interpolation: Ok(interpolation),
            ..request(vec![axis("x", &points)], PvtPolicy::PreferVelocity)
        };
        let planned = judged(both);
        let (low, high) = planned.points()[1].reachable.unwrap();
        // In 10 ms of 0.5 m/s less what a jerk of 500 m/s³ takes off.
        assert!(low <= high && high < 0.005 && low > 0.004, "{low} {high}");
    }
}

/// Noise, jumps, waits and beats of any length: every plan passes the judge, under every policy, from far away too, and its times
/// do not drift.
#[test]
fn every_sequence_is_legal() {
    let mut random = Random(29);
    for round in 0..240 {
        let (axes, count) = (1 + round % 3, 40);
        let beat = random.decades(0.005, 0.5);
        let mut times = Vec::new();
        let mut time = 0.0;
        for _ in 0..count {
            time += if round % 2 == 0 { beat } else { beat * random.between(0.2, 2.0) };
            times.push(time);
        }
        let policy = [PvtPolicy::PreferVelocity, PvtPolicy::PreferPosition, PvtPolicy::ExtendTime][round % 3];
        let axes = (0..axes).map(|index| wandering(&mut random, index, &times)).collect();
        let spec = PvtRequestSpec { cycle_time_ns: Some(500_000), ..request(axes, policy) };
        let planned = match plan(spec.clone()) {
            Ok(planned) => planned,
            // One way and too far: no time helps.
            Err(refusal) if policy == PvtPolicy::ExtendTime => {
                assert!(refusal.to_string().contains("no longer time helps"), "{refusal}");
                continue;
            }
            Err(refusal) => panic!("{refusal}"),
        };
        let violations: Vec<_> = certify(planned.plan()).violations().collect();
        assert_eq!(violations, [], "round {round}: {spec:?}");
        if policy != PvtPolicy::ExtendTime {
            let drift = (planned.plan().duration() - time).abs();
            assert!(drift <= 2.0 * f64::EPSILON * time, "round {round}: {drift}");
        }
        // Where nothing shifts, an axis by itself does the same, command by command.
        if policy != PvtPolicy::ExtendTime && round % 2 == 0 {
            alone(&spec, &planned, policy);
        }
    }
}

fn wandering(random: &mut Random, index: usize, times: &[f64]) -> PvtAxisSpec {
    let fastest = random.decades(0.1, 10.0);
    let beat = times[0];
    let acceleration = fastest / beat * random.decades(0.1, 10.0);
    let far = if index == 1 { 1e3 * fastest } else { 0.0 };
    let one_way = index == 2;
    let low = if one_way { 0.0 } else { -fastest };
    let limits = LimitsSpec {
        max_velocity: fastest,
        max_acceleration: acceleration,
        max_deceleration: (index > 0).then(|| acceleration * random.decades(0.5, 2.0)),
        max_jerk: acceleration / beat * random.decades(0.3, 30.0),
        max_velocity_reverse: one_way.then_some(0.0),
        ..LimitsSpec::default()
    };
    let (mut position, mut velocity, mut before) = (far, 0.0f64, 0.0);
    let (mut positions, mut velocities) = (Vec::new(), Vec::new());
    for &time in times {
        let next = (velocity + fastest * random.between(-0.3, 0.3)).clamp(low, fastest);
        let next = if random.bits().is_multiple_of(8) { random.between(low, fastest) } else { next };
        let kept = random.bits().is_multiple_of(4);
        position +=
            0.5 * (velocity + next) * (time - before) * if kept { 1.0 } else { random.between(0.8, 1.2) };
        (velocity, before) = (next, time);
        positions.push(position);
        velocities.push(velocity);
    }
    let (kind, start) = (Ok(AxisKind::Prismatic), State::at_rest(far));
    PvtAxisSpec { axis: index.to_string(), kind, limits, start, times: times.to_vec(), positions, velocities }
}

fn alone(spec: &PvtRequestSpec, planned: &PvtPlan, policy: PvtPolicy) {
    for (index, axis) in spec.axes.iter().enumerate() {
        let mut planner =
            PvtPlanner::new(axis.start, axis.limits.clone().try_into().unwrap(), policy).unwrap();
        let mut before = 0.0;
        for report in planned.points().iter().filter(|report| report.axis == index) {
            let (position, velocity) = (axis.positions[report.point], axis.velocities[report.point]);
            let duration = axis.times[report.point] - before;
            before = axis.times[report.point];
            let one =
                planner.command(PvtTarget { position, velocity, duration }).expect("it was planned before");
            assert_eq!(one.motion().reached().position, report.position);
            assert_eq!(Some(one.region()), report.region);
        }
    }
}

#[test]
fn a_beat_of_a_day_ends_on_its_cycle() {
    let points: Vec<_> = (1..=20_000).map(|n| (f64::from(n) * 0.05, 0.0, 0.0)).collect();
    let planned = plan(request(vec![axis("x", &points)], PvtPolicy::Reject)).unwrap();
    assert_eq!((planned.plan().duration(), planned.plan().cycle_count()), (1000.0, 1_000_000));
}
