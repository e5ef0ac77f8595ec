//! Moves that end on a cycle: whole, exact, within every limit, and little longer than the fastest. More of them:
//! `PROPTEST_CASES=1000000 cargo test --release --test on_cycles`.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and whole cycles are exact"
)]

mod common;

use common::higher_limits;
use planner::{
    AxisKind, AxisMoveSpec, CycleTime, EightType, Family, InvalidFields, Law, Limits, LimitsSpec, Plan,
    Problem, Request, RequestSpec, ShortPathPolicy, SixCase, State, Synchronization, certify, grid, plan,
    plan_move,
};
use proptest::prelude::*;

/// A move from rest to rest, of any family.
#[derive(Clone, Debug)]
struct Case {
    family: Family,
    order: Option<u32>,
    from: f64,
    distance: f64,
    limits: LimitsSpec,
    cycle_ns: i128,
}

impl Case {
    fn spec(&self, end_on_cycle: bool) -> RequestSpec {
        let axis = AxisMoveSpec {
            axis: "x".into(),
            kind: Ok(AxisKind::Prismatic),
            start: State::at_rest(self.from),
            goal: State::at_rest(self.from + self.distance),
            limits: self.limits.clone(),
        };
        RequestSpec {
            axes: vec![axis],
            cycle_time_ns: Some(self.cycle_ns),
            family: Ok(self.family),
            order: self.order,
            short_path: Ok(ShortPathPolicy::Reject),
            synchronization: Ok(Synchronization::None),
            minimum_duration: None,
            end_on_cycle,
        }
    }

    fn plan(&self, end_on_cycle: bool) -> Result<Plan, InvalidFields> {
        plan(&Request::try_from(self.spec(end_on_cycle))?)
    }
}

/// Times are drawn in cycles, from a hundredth of one to some thousand, and now and then whole, so that every rounding has its
/// turn; the distance follows from them, or is one more draw.
fn any_case() -> impl Strategy<Value = Case> {
    let cycles = || {
        prop_oneof![
            3 => (-2.0..3.3f64).prop_map(|exponent| 10f64.powf(exponent)),
            1 => (1..60u32).prop_map(f64::from),
            1 => Just(0.0),
        ]
    };
    let times = prop::array::uniform8(cycles());
    let cycle = prop::sample::select(vec![10_000, 250_000, 1_000_000, 2_000_000, 1_000_000_000]);
    let scale = (-6.0..6.0f64).prop_map(|exponent| 10f64.powf(exponent));
    (0..11u32, times, cycle, scale, 0.2..5.0f64, any::<bool>(), -1e3..1e3f64, any::<bool>()).prop_map(
        |(family, times, cycle_ns, scale, ratio, backward, from, related)| {
            let (family, order) = match family {
                0..=2 => (Family::SCurve, None),
                3 => (Family::Trapezoidal, None),
                4 => (Family::Trigonometric, None),
                order => (Family::Polynomial, Some(order.clamp(2, 8))),
            };
            let n = order.unwrap_or(3) as usize;
            let second = cycle_ns as f64 / 1e9;
            // Each derivative reaches its limit a time after the one above it, which is no shorter than all times before.
            let mut limits = vec![scale];
            let mut sum = 0.0;
            for &time in &times[..n] {
                let length = if related { sum + time } else { time };
                let length = if length > 0.0 { length } else { 1.0 };
                sum += length;
                limits.push(limits[limits.len() - 1] * length * second);
            }
            limits.reverse();
            let distance = limits.remove(0);
            let (max_snap, max_higher_derivatives) = higher_limits(&limits);
            let limit = |order: usize| limits.get(order - 1).copied().unwrap_or(1e50);
            let limits = LimitsSpec {
                max_velocity: limit(1),
                max_acceleration: limit(2),
                max_jerk: limit(3),
                max_deceleration: (related && family == Family::SCurve).then(|| ratio * limit(2)),
                max_snap,
                max_higher_derivatives,
                ..LimitsSpec::default()
            };
            let distance = if backward { -distance } else { distance };
            Case { family, order, from: from * distance, distance, limits, cycle_ns }
        },
    )
}

fn settings() -> ProptestConfig {
    let given = ProptestConfig::default();
    ProptestConfig { cases: given.cases.max(4096), failure_persistence: None, ..given }
}

proptest! {
    #![proptest_config(settings())]

    #[test]
    fn a_plan_that_ends_on_a_cycle_does_so_within_its_limits(case in any_case()) {
        let (whole, fastest) = (case.plan(true).unwrap(), case.plan(false).unwrap());
        let certificate = certify(&whole);
        prop_assert!(certificate.passed(), "{:?}", certificate.violations().collect::<Vec<_>>());
        prop_assert!(whole.method().end_on_cycle && !fastest.method().end_on_cycle);
        let exact = whole.cycle_time().start_of(whole.cycle_count());
        prop_assert!((whole.duration() - exact).abs() <= f64::EPSILON * exact, "{} {exact}", whole.duration());
        prop_assert_eq!(whole.axes()[0].profile.end(), whole.axes()[0].goal);
        let more = whole.cycle_count() - fastest.cycle_count();
        let most = if case.family == Family::SCurve { 4 } else { 0 };
        prop_assert!(more <= most, "{} instead of {}", whole.cycle_count(), fastest.cycle_count());
        // Never above the fastest, by whose names it goes.
        let (names, of_fastest) = (whole.axes()[0].classification, fastest.axes()[0].classification);
        prop_assert_eq!((names.eight_type, names.asymmetric_type, names.six_case),
            (of_fastest.eight_type, of_fastest.asymmetric_type, of_fastest.six_case));
        prop_assert!(names.feed_rate <= of_fastest.feed_rate * (1.0 + 1e-15));
        for piece in whole.axes()[0].profile.segments() {
            if let Law::ConstantJerk(jerk) = piece.law && case.family == Family::SCurve {
                prop_assert!(jerk.abs() <= case.limits.max_jerk);
                let cycles = (piece.duration / whole.cycle_time().as_seconds()).round() as u64;
                prop_assert!(cycles > 0);
                let off = (piece.duration - whole.cycle_time().start_of(cycles)).abs();
                prop_assert!(off <= 4.0 * f64::EPSILON * whole.duration(), "{piece:?} is not whole");
            }
        }
    }

    /// The two ways to a move with equal ramps.
    #[test]
    fn equal_ramps_are_those_of_the_grid(case in any_case()) {
        let limits = Limits::symmetric(
            case.limits.max_velocity, case.limits.max_acceleration, case.limits.max_jerk).unwrap();
        let cycle = CycleTime::from_ns(Some(case.cycle_ns)).unwrap();
        let goal = State::at_rest(case.distance);
        let problem = Problem::new(State::default(), goal, limits.clone(), ShortPathPolicy::Reject).unwrap();
        let ours = grid::plan_move(&problem, cycle).unwrap();
        let whole = grid::rest_to_rest(case.distance, &limits, cycle).unwrap();
        prop_assert_eq!(cycle.count(ours.duration()), Some(whole.total_cycles()));
        let pieces = whole.segments(State::default(), goal);
        let ours = ours.segments();
        prop_assert_eq!(ours.len(), pieces.len());
        for (ours, other) in ours.iter().zip(&pieces) {
            let (Law::ConstantJerk(a), Law::ConstantJerk(b)) = (ours.law, other.law) else { unreachable!() };
            prop_assert!((a - b).abs() <= 1e-14 * b.abs(), "{a} {b}");
            let far = 1e-14 * case.distance.abs();
            prop_assert!((ours.start.position - other.start.position).abs() <= far, "{ours:?} {other:?}");
        }
    }
}

/// Li and Chen's first simulation, 600 000 pulses at 100 000 up and 160 000 down, with a cycle of 100 ms: the jerk times 0.625
/// and 1 s become 7 and 10 cycles, those from jerk to jerk, 2 and 1.25 s, 20 and 13. So the ramps take 27 and 23, 25 on the mean, and
/// the cruise what is left of (2.625 + 2.25)/2 + 0.5625 = 3 s.
#[test]
fn two_ramps_that_differ() {
    let limits = LimitsSpec {
        max_velocity: 200e3,
        max_acceleration: 100e3,
        max_deceleration: Some(160e3),
        max_jerk: 160e3,
        ..LimitsSpec::default()
    };
    let limits = Limits::try_from(limits).unwrap();
    let problem =
        Problem::new(State::default(), State::at_rest(600e3), limits, ShortPathPolicy::Reject).unwrap();
    let cycle = CycleTime::from_ns(Some(100_000_000)).unwrap();
    let whole = grid::plan_move(&problem, cycle).unwrap();
    let cycles: Vec<u64> =
        whole.segments().iter().map(|piece| cycle.count(piece.duration).unwrap()).collect();
    assert_eq!(cycles, [7, 13, 7, 5, 10, 3, 10]);
    assert_eq!(whole.classification().feed_rate, 600e3 / 3.0);
}

#[test]
fn a_move_that_is_whole_already_is_the_fastest() {
    // 0.05 m at 0.25 m/s, 5 m/s², 100 m/s³: 50, 0, 50, 100, 50, 0, 50 ms.
    let limits = Limits::symmetric(0.25, 5.0, 100.0).unwrap();
    let problem =
        Problem::new(State::default(), State::at_rest(0.05), limits, ShortPathPolicy::Reject).unwrap();
    let whole = grid::plan_move(&problem, CycleTime::MILLISECOND).unwrap();
    assert_eq!(whole.duration(), 0.3);
    assert!((plan_move(&problem).unwrap().duration() - 0.3).abs() < 1e-15);
    assert_eq!(whole.classification().eight_type, Some(EightType::Type1));
    assert_eq!(whole.classification().six_case, Some(SixCase::A));
}

#[test]
fn nothing_to_go_takes_no_cycle() {
    for family in [Family::SCurve, Family::Trapezoidal, Family::Trigonometric] {
        let limits =
            LimitsSpec { max_velocity: 1.0, max_acceleration: 1.0, max_jerk: 1.0, ..LimitsSpec::default() };
        let case = Case { family, order: None, from: 1.0, distance: 0.0, limits, cycle_ns: 1_000_000 };
        let plan = case.plan(true).unwrap();
        assert_eq!((plan.duration(), plan.cycle_count()), (0.0, 0));
        assert!(certify(&plan).passed());
    }
}

/// A trapezoid is slowed as a whole, which would slow its ends; an S-curve takes a little longer on its way.
#[test]
fn a_speed_at_an_end_is_kept_or_refused_with_what_works() {
    let limits =
        LimitsSpec { max_velocity: 1.0, max_acceleration: 1.0, max_jerk: 1.0, ..LimitsSpec::default() };
    let spec = |family| {
        let limits = limits.clone();
        let case = Case { family, order: None, from: 0.0, distance: 9.0, limits, cycle_ns: 1_000_000 };
        let mut spec = case.spec(true);
        spec.axes[0].start.velocity = 0.5;
        spec.axes[0].goal.velocity = 0.25;
        spec
    };
    let planned = |spec: RequestSpec| plan(&Request::try_from(spec).unwrap()).unwrap();
    let fastest = planned(RequestSpec { end_on_cycle: false, ..spec(Family::SCurve) });
    let on_cycle = planned(spec(Family::SCurve));
    assert_eq!(on_cycle.cycle_count(), fastest.cycle_count());
    assert_eq!(on_cycle.duration(), on_cycle.cycle_time().start_of(on_cycle.cycle_count()));
    assert!(
        certify(&on_cycle).passed() && on_cycle.axes()[0].profile.end() == fastest.axes()[0].profile.end()
    );

    let refused = Request::try_from(spec(Family::Trapezoidal)).unwrap_err();
    let texts: Vec<String> = refused.as_slice().iter().map(ToString::to_string).collect();
    let instead = "ending on a cycle from or to a speed is not implemented: rest at both ends, or leave end_on_cycle out: \
        the plan's last cycle is then its end state";
    assert_eq!(
        texts,
        [format!("axes[0].start.velocity: {instead}"), format!("axes[0].goal.velocity: {instead}")]
    );
}
