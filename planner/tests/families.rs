//! What holds for every move of order n and of cosine jerk. More of them:
//! `PROPTEST_CASES=1000000 cargo test --release --test families`.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp,
    reason = "a test may fail by panicking, and bits are compared as bits"
)]

mod common;

use common::polynomial_problem;
use planner::{
    AxisKind, AxisMoveSpec, Derivatives, Family, Law, Plan, Profile, Quantity, Request, RequestSpec, Segment,
    ShortPathPolicy, State, Synchronization, certify, plan, plan_move, plan_polynomial, plan_trigonometric,
};
use proptest::prelude::*;

/// Of the motion's extent [1]: the end as integrated against the end as asked.
const END: f64 = 1e-12;
/// Of a duration [1]: what two ways to the same duration may differ by.
const DURATION: f64 = 1e-12;

/// A move from rest to rest.
#[derive(Clone, Debug)]
struct Case {
    family: Family,
    order: u32,
    from: f64,
    distance: f64,
    /// Of velocity, acceleration … to the order eight.
    limits: [f64; 8],
}

impl Case {
    /// The derivatives that are kept within limits.
    fn limited(&self) -> &[f64] {
        &self.limits[..(self.order as usize).max(3)]
    }

    fn plan(&self) -> Plan {
        let problem = polynomial_problem(self.from, self.from + self.distance, self.limited());
        let axis = AxisMoveSpec {
            axis: "x".into(),
            kind: Ok(AxisKind::Prismatic),
            start: problem.start(),
            goal: problem.goal(),
            limits: problem.limits().spec().clone(),
        };
        let spec = RequestSpec {
            axes: vec![axis],
            cycle_time_ns: Some(1_000_000_000),
            family: Ok(self.family),
            order: (self.family == Family::Polynomial).then_some(self.order),
            short_path: Ok(ShortPathPolicy::Reject),
            synchronization: Ok(Synchronization::None),
            minimum_duration: None,
            end_on_cycle: false,
        };
        plan(&Request::try_from(spec).unwrap()).unwrap()
    }

    fn profile(&self) -> Profile {
        self.plan().axes()[0].profile.clone()
    }

    fn scaled(&self, length: f64, time: f64) -> Self {
        let mut limits = self.limits;
        let mut unit = length;
        for limit in &mut limits {
            unit /= time;
            *limit *= unit;
        }
        Self { from: self.from * length, distance: self.distance * length, limits, ..self.clone() }
    }
}

fn magnitude() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => (-6.0..6.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        2 => (-1.0..1.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        2 => prop::sample::select(vec![0.1, 0.25, 0.3, 0.5, 1.0, 2.0, 3.0, 10.0, 1000.0]),
    ]
}

/// Either family, every order; limits over twelve decades, or one after the other so that each is reached, or just so.
fn any_case() -> impl Strategy<Value = Case> {
    let lengths = prop_oneof![
        4 => (-12.0..6.0f64).prop_map(|exponent| 10f64.powf(exponent)),
        1 => prop::sample::select(vec![1e-12, 0.05, 1.0, 4.0, 1e6]),
    ];
    let boxes = prop::array::uniform8(prop_oneof![1 => Just(0.0), 1 => 0.0..1.0f64, 1 => 0.0..1e-3f64]);
    (2..10u32, prop::array::uniform8(magnitude()), lengths, boxes, 0..4u32, any::<bool>(), magnitude())
        .prop_map(|(order, mut limits, mut distance, boxes, how, backward, top)| {
            let (family, order) =
                if order == 9 { (Family::Trigonometric, 3) } else { (Family::Polynomial, order) };
            if how < 2 {
                // Each length is the sum of those before it, and more: every limit is reached, or just so.
                let n = order as usize;
                limits[n - 1] = top;
                let (mut sum, mut peak) = (0.0, top);
                for level in 0..n {
                    let length = if level == 0 { 0.1 + boxes[0] } else { sum + boxes[level] };
                    sum += length;
                    peak *= length;
                    if level + 1 < n {
                        limits[n - 2 - level] = peak;
                    } else {
                        distance = peak;
                    }
                }
            }
            let distance = if backward { -distance } else { distance };
            Case { family, order, from: 0.0, distance, limits }
        })
}

fn passes(plan: &Plan) -> Result<(), TestCaseError> {
    let certificate = certify(plan);
    prop_assert!(certificate.passed(), "{:?}", certificate.violations().collect::<Vec<_>>());
    Ok(())
}

fn settings(cases: u32) -> ProptestConfig {
    let given = ProptestConfig::default();
    ProptestConfig { cases: given.cases.max(cases), failure_persistence: None, ..given }
}

proptest! {
    #![proptest_config(settings(4096))]

    #[test]
    fn every_plan_is_legal_and_arrives(case in any_case(), from in -1e3..1e3f64) {
        let case = Case { from: from * case.distance, ..case };
        let plan = case.plan();
        passes(&plan)?;
        let profile = &plan.axes()[0].profile;
        let (first, last) = (profile.segments().first().unwrap(), profile.segments().last().unwrap());
        // At order 2 the acceleration jumps to its start.
        let jump = if case.order == 2 { first.start.acceleration } else { 0.0 };
        prop_assert_eq!(first.start, State { acceleration: jump, ..State::at_rest(case.from) });
        let off = (last.end().position - profile.end().position).abs();
        let rounding = 4.0 * f64::EPSILON * (case.from.abs() + case.distance.abs());
        prop_assert!(off <= END * case.distance.abs() + rounding, "ends {off:e} from the goal");
        prop_assert!(profile.segments().len() < 1 << case.order);
        prop_assert_eq!(plan.method().order, case.order);
        prop_assert_eq!(plan.guaranteed(), &Quantity::BY_ORDER[1..=case.order as usize]);
    }

    #[test]
    fn a_mirrored_problem_has_the_mirrored_plan(case in any_case()) {
        let (ours, mirrored) = (case.profile(), Case { distance: -case.distance, ..case }.profile());
        let turned: Vec<Segment> = mirrored
            .segments()
            .iter()
            .map(|Segment { duration, start, law }| Segment {
                duration, start: start.mirrored(), law: law.mirrored(),
            })
            .collect();
        prop_assert_eq!(ours.segments().to_vec(), turned);
    }

    #[test]
    fn a_plan_run_backwards_is_itself(case in any_case(), parts in prop::collection::vec(0.0..1.0f64, 8)) {
        let profile = case.profile();
        let durations: Vec<f64> = profile.segments().iter().map(|piece| piece.duration).collect();
        let mut backward = durations.clone();
        backward.reverse();
        prop_assert_eq!(durations, backward);
        let total = profile.duration();
        for part in parts {
            let (there, back) = (profile.at(part * total), profile.at(total - part * total));
            let apart = (there.state.position + back.state.position - case.distance).abs();
            prop_assert!(apart <= 1e-13 * case.distance.abs(), "{apart:e} apart at {part}");
        }
    }

    #[test]
    fn units_that_are_powers_of_two_leave_every_bit(case in any_case(), length in -30..30i32, time in -5..5i32) {
        let (length, time) = (2f64.powi(length), 2f64.powi(time));
        let (ours, scaled) = (case.profile(), case.scaled(length, time).profile());
        let expected: Vec<f64> = ours.segments().iter().map(|piece| piece.duration * time).collect();
        let durations: Vec<f64> = scaled.segments().iter().map(|piece| piece.duration).collect();
        prop_assert_eq!(durations, expected);
    }

    #[test]
    fn units_leave_the_duration(case in any_case(), length in -6.0..6.0f64, time in -2.0..2.0f64) {
        let (length, time) = (10f64.powf(length), 10f64.powf(time));
        let (expected, total) = (case.profile().duration() * time, case.scaled(length, time).profile().duration());
        prop_assert!((total - expected).abs() <= DURATION * expected, "{total} instead of {expected}");
    }

    #[test]
    fn an_order_more_takes_no_less(case in any_case()) {
        let problem = polynomial_problem(0.0, case.distance, &case.limits);
        let durations: Vec<f64> =
            (2..=8).map(|order| plan_polynomial(&problem, order).unwrap().duration()).collect();
        for pair in durations.windows(2) {
            prop_assert!(pair[1] >= pair[0] * (1.0 - DURATION), "{durations:?}");
        }
        // The third order is the S-curve, and the cosine that of half the jerk.
        let s_curve = plan_move(&problem).unwrap().duration();
        prop_assert!((durations[1] - s_curve).abs() <= DURATION * s_curve, "{} {s_curve}", durations[1]);
        let mut halved = case.limits;
        halved[2] *= 0.5;
        let halved = plan_move(&polynomial_problem(0.0, case.distance, &halved)).unwrap().duration();
        let cosine = plan_trigonometric(&problem).unwrap().duration();
        prop_assert!((cosine - halved).abs() <= DURATION * halved, "{cosine} {halved}");
    }

    /// What is solved is evaluated to the bits of what is laid: at any time, where each piece begins, beside it, and outside.
    #[test]
    fn a_solved_polynomial_has_the_bits_of_a_laid_one(case in any_case(), parts in [-0.1..1.1f64, 0.0..1.0, 0.0..1.0]) {
        if case.family == Family::Polynomial {
            let problem = polynomial_problem(0.25, 0.25 + case.distance, case.limited());
            let planned = plan_polynomial(&problem, case.order).unwrap();
            let profile = planned.to_profile();
            let begins = profile.timed_segments().flat_map(|(begin, _)| [begin, begin.next_down(), begin.next_up()]);
            let within = parts.map(|part| part * profile.duration());
            for t in begins.chain(within).chain([profile.duration(), f64::INFINITY, f64::NAN, -1.0]) {
                let (solved, laid) = (planned.at(t).words(), profile.at(t).words());
                prop_assert_eq!(solved.map(f64::to_bits), laid.map(f64::to_bits), "{:?} {:?} at {}", solved, laid, t);
            }
        }
    }

    /// Cycles that are read in a row have the bits of each by itself, wherever the row begins, and beyond the end.
    #[test]
    fn columns_have_the_bits_of_single_cycles(case in any_case(), part in 0.0..1.0f64) {
        let plan = case.plan();
        let first = (part * plan.cycle_count() as f64) as u64;
        let cycles = first..(first + 300).min(plan.cycle_count() + 5);
        let each: Vec<_> = cycles
            .map(|cycle| plan.sampler().at(cycle).next().unwrap().words().map(f64::to_bits))
            .collect();
        let mut filled = [(); 4].map(|()| vec![f64::NAN; each.len()]);
        plan.sampler().fill(0, first, filled.each_mut().map(Vec::as_mut_slice));
        let filled: Vec<_> =
            (0..each.len()).map(|index| filled.each_ref().map(|column| column[index].to_bits())).collect();
        prop_assert_eq!(filled, each);
        let mut last = [(); 4].map(|()| [f64::NAN; 3]);
        plan.sampler().fill(0, u64::MAX - 1, last.each_mut().map(|column| &mut column[..]));
        let end = plan.sampler().at(plan.cycle_count()).next().unwrap().words();
        prop_assert!((0..3).all(|index| last.map(|column| column[index].to_bits()) == end.map(f64::to_bits)));
    }

    /// No length of time can be taken from one hold and given to none: each is at the distance or at a limit.
    #[test]
    fn a_limit_or_the_distance_binds_every_length(case in any_case()) {
        if case.family == Family::Polynomial {
            let problem = polynomial_problem(0.0, case.distance, case.limited());
            let planned = plan_polynomial(&problem, case.order).unwrap();
            let given: Vec<f64> =
                std::iter::once(case.distance.abs()).chain(case.limits).take(case.order as usize + 1).collect();
            let near = |k: usize| planned.peaks()[k] >= given[k] * (1.0 - 1e-12);
            for (k, peak) in planned.peaks().iter().enumerate() {
                prop_assert!(*peak <= given[k] * (1.0 + 1e-14 * f64::from(case.order)), "{k}: {peak}");
            }
            prop_assert!(near(0), "{:?}", planned.peaks());
            for (p, hold) in planned.holds().iter().enumerate().map(|(index, hold)| (index + 1, *hold)) {
                if hold > 0.0 && p < case.order as usize {
                    prop_assert!(near(p), "order {p} is held below its limit: {:?}", planned.peaks());
                }
            }
        }
    }
}

/// Changes one number of one piece, and expects the judge to see it.
fn mutated(case: &Case) {
    const CHANGE: f64 = 1e-6;
    let plan = case.plan();
    let axis = &plan.axes()[0];
    let segments = axis.profile.segments();
    let mut peaks = [0.0f64; 9];
    for segment in segments {
        for t in segment.turning_points() {
            for (peak, value) in peaks.iter_mut().zip(segment.derivatives(t)) {
                *peak = peak.max(value.abs());
            }
        }
    }
    // The first, the last, one in the middle and one beside it.
    let middle = segments.len() / 2;
    for index in [0, middle, middle + 1, segments.len() - 1].into_iter().filter(|&at| at < segments.len()) {
        for field in 0..5 {
            for sign in [-1.0, 1.0] {
                let change = sign * CHANGE;
                let mut pieces = segments.to_vec();
                let piece = &mut pieces[index];
                match field {
                    0 => piece.start.position += change * case.distance.abs(),
                    1 => piece.start.velocity += change * peaks[1],
                    // At order 2 the acceleration jumps.
                    2 if case.order == 2 => continue,
                    2 => piece.start.acceleration += change * peaks[2],
                    3 => {
                        // As much as changes the derivative below by a part of its peak; that of order 1 always joins.
                        piece.law = match piece.law {
                            Law::ConstantJerk(jerk) => {
                                let peak = if case.order == 2 { peaks[1] / piece.duration } else { peaks[2] };
                                Law::ConstantJerk(jerk + change * peak / piece.duration)
                            }
                            Law::CosineJerk { peak } => {
                                Law::CosineJerk { peak: peak + change * peaks[2] / piece.duration }
                            }
                            Law::Polynomial(law) => {
                                let mut values = law.as_slice().to_vec();
                                let below = peaks[law.order() - 1];
                                *values.last_mut().unwrap() += change * below / piece.duration;
                                Law::Polynomial(Derivatives::new(&values).unwrap())
                            }
                        };
                    }
                    _ => piece.duration += change * axis.profile.duration(),
                }
                let mut axis = axis.clone();
                axis.profile = Profile::new(pieces, axis.profile.end());
                let changed =
                    Plan::new(plan.method(), plan.guaranteed().to_vec(), plan.cycle_time(), vec![axis])
                        .unwrap();
                let certificate = certify(&changed);
                assert!(!certificate.passed(), "field {field} of piece {index}, {change:e}: {case:?}");
            }
        }
    }
}

proptest! {
    #![proptest_config(settings(512))]

    #[test]
    fn the_judge_sees_every_change(case in any_case()) {
        mutated(&case);
    }

    #[test]
    fn the_judges_extremes_bound_all_samples(case in any_case()) {
        let plan = case.plan();
        let certificate = certify(&plan);
        let profile = &plan.axes()[0].profile;
        for check in &certificate.limits {
            let order = check.quantity.order().unwrap();
            if check.extremum.is_infinite() {
                prop_assert!(!check.guaranteed);
                continue;
            }
            let mut greatest = 0.0f64;
            for segment in profile.segments() {
                for step in 0..=16 {
                    let t = segment.duration * f64::from(step) / 16.0;
                    greatest = greatest.max(segment.derivatives(t)[order].abs());
                }
            }
            prop_assert!(greatest <= check.extremum.abs() * (1.0 + 1e-13), "{check:?}: {greatest}");
        }
    }
}

#[test]
fn what_each_family_promises_and_what_it_reports() {
    let limits = [60.0, 600.0, 12e3, 4.8e5, 3.84e7, 1e10, 1e13, 1e16];
    let case = |family, order| Case { family, order, from: 0.0, distance: 50.0, limits };
    let reported = |family, order| {
        let certificate = certify(&case(family, order).plan());
        let limits: Vec<_> = certificate
            .limits
            .iter()
            .map(|check| (check.quantity, check.guaranteed, check.extremum.is_infinite()))
            .collect();
        let joins: Vec<_> =
            certificate.joins.iter().map(|check| (check.quantity, check.guaranteed)).collect();
        (limits, joins)
    };
    use Quantity::{Acceleration, Crackle, Jerk, Position, Snap, Velocity};
    let (checks, joins) = reported(Family::Polynomial, 2);
    assert_eq!(checks, [(Velocity, true, false), (Acceleration, true, false), (Jerk, false, true)]);
    assert_eq!(joins, [(Position, true), (Velocity, true), (Acceleration, false)]);
    let (checks, joins) = reported(Family::Polynomial, 3);
    assert_eq!(checks, [Velocity, Acceleration, Jerk].map(|quantity| (quantity, true, false)));
    assert_eq!(joins, [Position, Velocity, Acceleration].map(|quantity| (quantity, true)));
    let (checks, joins) = reported(Family::Polynomial, 5);
    assert_eq!(checks, [Velocity, Acceleration, Jerk, Snap, Crackle].map(|quantity| (quantity, true, false)));
    assert_eq!(joins, [Position, Velocity, Acceleration, Jerk, Snap].map(|quantity| (quantity, true)));
    let (checks, joins) = reported(Family::Trigonometric, 3);
    assert_eq!(checks, [Velocity, Acceleration, Jerk].map(|quantity| (quantity, true, false)));
    assert_eq!(joins, [Position, Velocity, Acceleration, Jerk].map(|quantity| (quantity, true)));
    // A limit that is stated and not promised: the snap of a cosine, π·J over the length of a pulse.
    let mut plan = case(Family::Trigonometric, 3).plan();
    let with_snap = polynomial_problem(0.0, 50.0, &limits[..5]).limits().clone();
    let mut axis = plan.axes()[0].clone();
    axis.limits = with_snap;
    plan = Plan::new(plan.method(), plan.guaranteed().to_vec(), plan.cycle_time(), vec![axis]).unwrap();
    let certificate = certify(&plan);
    let (snap, crackle) = (&certificate.limits[3], &certificate.limits[4]);
    let expected = std::f64::consts::PI * 12e3 / 0.1;
    assert!((snap.extremum.abs() - expected).abs() < 1e-9 * expected, "{snap:?}");
    assert!(!snap.guaranteed && snap.at_time > 0.0 && crackle.extremum.is_finite(), "{snap:?} {crackle:?}");
}
