//! Plans held, slowed and resumed on their paths: laws over random plans, beginnings and factors.
//!
//! How near the rates change to the fastest way of doing it, by a search that tries all beginnings, lengths and shapes:
//!
//! ```text
//! cargo test --release -p portamento-planner --test retime -- --ignored --nocapture
//! ```

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may fail by panicking, and print what it measured"
)]

mod common;

use common::Random;
use common::paths::{self, KINDS, Kind};
use planner::{
    AxisPlan, CycleTime, Derivatives, Law, Limits, Method, Plan, Profile, Quantity, RetimeError, Retiming,
    Segment, Setpoint, State, TimeLaw, certify, greatest_factor, retime,
};

/// Of the duration of a base [1]: so near to its end its own roundings may be more than what the judge allows of what is left.
const LAST: f64 = 1e-6;

/// Of the scale of the base [1].
const CONTINUITY: f64 = 1e-12;

/// What an axis reaches: the scales of position, velocity and acceleration; and of the jerk, what it may.
fn scales(axis: &AxisPlan) -> [f64; 4] {
    let mut scales = [0.0, 0.0, 0.0, axis.limits.jerk()];
    for segment in axis.profile.segments() {
        for t in segment.turning_points() {
            for (scale, part) in scales.iter_mut().zip(segment.at(t).words()) {
                *scale = scale.max(part.abs());
            }
        }
    }
    scales
}

/// The chain rule: a setpoint of the path at a state of the time law.
fn chained(path: &Profile, time: &State) -> [f64; 3] {
    let State { position: tau, velocity: rate, acceleration: slope } = *time;
    let q = path.at(tau).state;
    [q.position, q.velocity * rate, q.acceleration * rate * rate + q.velocity * slope]
}

/// A motion that is under way: as the base at first, then re-timed.
struct Underway {
    plan: Plan,
    law: TimeLaw,
}

impl Underway {
    fn of(base: &Plan) -> Self {
        Self { plan: base.clone(), law: TimeLaw::of(base) }
    }

    /// Goes on at another rate from `at` on, and checks everything that holds of any change of the rate.
    fn to(&mut self, base: &Plan, at: f64, factor: f64) -> Retiming {
        self.try_to(base, at, factor).unwrap()
    }

    /// As `to`; nothing where the path ends before there is anything to change.
    fn try_to(&mut self, base: &Plan, at: f64, factor: f64) -> Option<Retiming> {
        let before = self.law.at(at);
        let retiming = match retime(base, &self.law, at, factor) {
            Ok(retiming) => retiming,
            Err(RetimeError::Rejected(_)) if base.duration() - before.position < LAST * base.duration() => {
                return None;
            }
            Err(error) => panic!("to {factor} at {at} ({before:?}): {error}"),
        };
        let plan = retiming.plan().plan();
        assert!(certify(plan).passed());
        for (index, axis) in plan.axes().iter().enumerate() {
            let scales = scales(&base.axes()[index]);
            // The acceleration may jump where the base's does, and the splice lie on such a jump.
            let joined = if base.guarantees(Quantity::Jerk) { 3 } else { 2 };
            let old = self.plan.axes()[index].profile.at(at).state;
            let new = axis.profile.at(0.0).state;
            let jumps = [
                new.position - old.position,
                new.velocity - old.velocity,
                new.acceleration - old.acceleration,
            ];
            for (part, (jump, scale)) in jumps.into_iter().zip(scales).enumerate().take(joined) {
                assert!(
                    jump.abs() <= CONTINUITY * scale,
                    "axis {index}, part {part}, jumps by {jump:e} of {scale} at {at}"
                );
            }
            on_path(&base.axes()[index].profile, &axis.profile, retiming.law(), scales, joined);
        }
        assert!(plan.ends_at_rest());
        let end = retiming.law().profile().end();
        match retiming.reached() {
            Some(reached) => {
                let then = retiming.law().at(reached * (1.0 + 1e-15));
                assert!((then.velocity - factor).abs() <= 1e-12, "{then:?} at {reached}, not {factor}");
                assert!(then.acceleration.abs() <= 1e-9 / base.duration(), "{then:?} at {reached}");
            }
            None => assert!(end.position >= base.duration() * (1.0 - 1e-12) || end.velocity == 0.0),
        }
        if factor == 0.0 && retiming.reached().is_some() {
            assert_eq!((end.velocity, end.acceleration), (0.0, 0.0));
        }
        let spans = retiming.law().profile().segments();
        assert_eq!(TimeLaw::new(spans.to_vec()).as_ref(), Ok(retiming.law()), "the law is in its pieces");
        assert!(spans.iter().all(|span| span.start.velocity >= -1e-15 && span.end().velocity >= -1e-15));
        *self = Self { plan: plan.clone(), law: retiming.law().clone() };
        Some(retiming)
    }
}

/// Position, velocity and, where it joins, acceleration are those of the path at path time, by the chain rule.
fn on_path(path: &Profile, motion: &Profile, law: &TimeLaw, scales: [f64; 4], joined: usize) {
    let duration = motion.duration();
    for step in 0..=60 {
        let t = duration * f64::from(step) / 60.0;
        let time = law.at(t);
        let State { position, velocity, acceleration } = motion.at(t).state;
        let ours = [position, velocity, acceleration];
        // A rounding of path time is worth as much as the next derivative; far along the path, of more digits.
        let late = 1e-12 * (1.0 + time.position);
        for (part, (ours, expected)) in ours.into_iter().zip(chained(path, &time)).enumerate().take(joined) {
            let allowed = CONTINUITY * scales[part] + late * scales[part + 1];
            let off = (ours - expected).abs();
            assert!(
                off <= allowed,
                "part {part} is {off:e} off the path at {t} of {duration}, allowed {allowed:e}"
            );
        }
    }
}

fn base(random: &mut Random, kind: Kind) -> Plan {
    let count = 1 + (random.bits() % 6) as usize;
    let base = paths::path(random, kind, count);
    assert!(certify(&base).passed());
    base
}

/// At a join, an ulp beside one, at either end, or anywhere.
fn beginning(random: &mut Random, base: &Plan) -> f64 {
    let axis = &base.axes()[random.bits() as usize % base.axes().len()].profile;
    let joins: Vec<f64> = axis.timed_segments().map(|(begin, _)| begin).collect();
    let join = joins[random.bits() as usize % joins.len()];
    match random.bits() % 10 {
        0 => join,
        1 => join.next_up(),
        2 => join.next_down().max(0.0),
        3 => base.duration() * (1.0 - random.decades(1e-12, 1e-2)),
        4 => base.duration() * random.decades(1e-12, 1e-2),
        _ => base.duration() * random.unit(),
    }
}

/// A factor at or beside a border, or between.
fn factor(random: &mut Random) -> f64 {
    match random.bits() % 8 {
        0 | 1 => 0.0,
        2 => 1.0,
        3 => random.decades(1e-6, 1e-2),
        4 => 1.0 - random.decades(1e-12, 1e-3),
        _ => random.unit(),
    }
}

#[test]
fn hold_comes_to_rest_and_resume_arrives() {
    let mut random = Random(11);
    for kind in KINDS {
        for _ in 0..60 {
            let base = base(&mut random, kind);
            let mut motion = Underway::of(&base);
            let at = beginning(&mut random, &base);
            let held = motion.to(&base, at, 0.0);
            let unheld = (base.duration() - at).max(0.0);
            assert!(
                held.rests() <= unheld + 1e-12 * base.duration(),
                "rests at {}, not by {unheld}",
                held.rests()
            );
            for axis in held.plan().plan().axes() {
                assert!(axis.profile.end().is_at_rest());
            }
            // At rest, or long after it.
            let wait = held.law().profile().duration() * if random.unit() < 0.5 { 1.0 } else { 7.0 };
            motion.to(&base, wait, 1.0);
            for (ours, axis) in motion.plan.axes().iter().zip(base.axes()) {
                assert_eq!(ours.profile.end(), axis.profile.end(), "it ends where the base ends");
                assert_eq!(ours.goal, axis.goal);
            }
        }
    }
}

#[test]
fn a_ramp_is_interrupted_again_and_again() {
    let mut random = Random(12);
    for kind in KINDS {
        'bases: for _ in 0..25 {
            let base = base(&mut random, kind);
            let mut motion = Underway::of(&base);
            let mut at = 0.4 * beginning(&mut random, &base);
            for _ in 0..10 {
                let factor = factor(&mut random);
                let Some(retimed) = motion.try_to(&base, at, factor) else { continue 'bases };
                // Mostly in the middle of the ramp.
                let ramp = retimed.reached().unwrap_or(retimed.rests());
                at = ramp * if random.unit() < 0.3 { 1.0 } else { random.unit() };
            }
            if motion.try_to(&base, at, 1.0).is_none() {
                continue;
            }
            for (ours, axis) in motion.plan.axes().iter().zip(base.axes()) {
                assert_eq!(ours.profile.end(), axis.profile.end());
            }
        }
    }
}

/// The same rate again changes nothing, whatever it is.
#[test]
fn the_present_rate_is_kept() {
    let mut random = Random(13);
    for kind in KINDS {
        for _ in 0..10 {
            let base = base(&mut random, kind);
            let mut motion = Underway::of(&base);
            let whole = motion.to(&base, 0.0, 1.0);
            assert_eq!(whole.reached(), Some(0.0));
            let pieces =
                |plan: &Plan| plan.axes().iter().map(|axis| axis.profile.clone()).collect::<Vec<_>>();
            assert_eq!(
                pieces(whole.plan().plan()),
                pieces(&base),
                "the whole base at its own rate, bit by bit"
            );
            // A constant rate keeps the kind of each piece.
            motion.to(&base, 0.0, 0.5);
            let then = motion.law.profile().duration() * 0.5;
            let again = motion.to(&base, then, 0.5);
            if again.reached() == Some(0.0) && kind != Kind::Quintic && kind != Kind::FifthOrder {
                let mut segments = again.plan().plan().axes().iter().flat_map(|axis| axis.profile.segments());
                assert!(segments.all(|segment| matches!(segment.law, Law::ConstantJerk(_))));
            }
        }
    }
}

fn mirrored(plan: &Plan) -> Plan {
    let axes = plan.axes().iter().map(|axis| {
        let limits = axis.limits.spec().clone();
        let (forward, reverse) = (limits.max_velocity, axis.limits.velocity_reverse());
        let limits =
            planner::LimitsSpec { max_velocity: reverse, max_velocity_reverse: Some(forward), ..limits };
        let segments = axis.profile.segments().iter().map(|segment| Segment {
            start: segment.start.mirrored(),
            law: segment.law.mirrored(),
            ..segment
        });
        let profile = Profile::new(segments, axis.profile.end().mirrored());
        AxisPlan { limits: limits.try_into().unwrap(), goal: profile.end(), profile, ..axis.clone() }
    });
    Plan::new(plan.method(), plan.guaranteed().to_vec(), plan.cycle_time(), axes.collect()).unwrap()
}

/// In another unit of length, by a power of two: no digit changes.
fn scaled(plan: &Plan, unit: f64) -> Plan {
    let axes = plan.axes().iter().map(|axis| {
        let spec = axis.limits.spec().clone();
        let limits = planner::LimitsSpec {
            max_velocity: spec.max_velocity * unit,
            max_acceleration: spec.max_acceleration * unit,
            max_deceleration: spec.max_deceleration.map(|limit| limit * unit),
            max_velocity_reverse: spec.max_velocity_reverse.map(|limit| limit * unit),
            max_jerk: spec.max_jerk * unit,
            max_snap: spec.max_snap.map(|limit| limit * unit),
            max_higher_derivatives: spec.max_higher_derivatives.iter().map(|limit| limit * unit).collect(),
            ..spec
        };
        let larger = |state: State| State {
            position: state.position * unit,
            velocity: state.velocity * unit,
            acceleration: state.acceleration * unit,
        };
        let segments = axis.profile.segments().iter().map(|segment| {
            let law = match segment.law {
                Law::ConstantJerk(jerk) => Law::ConstantJerk(jerk * unit),
                Law::Polynomial(derivatives) => {
                    let values: Vec<f64> = derivatives.as_slice().iter().map(|value| value * unit).collect();
                    Law::Polynomial(Derivatives::new(&values).unwrap())
                }
                law => law,
            };
            Segment { start: larger(segment.start), law, ..segment }
        });
        let profile = Profile::new(segments, larger(axis.profile.end()));
        AxisPlan { limits: limits.try_into().unwrap(), goal: profile.end(), profile, ..axis.clone() }
    });
    Plan::new(plan.method(), plan.guaranteed().to_vec(), plan.cycle_time(), axes.collect()).unwrap()
}

#[test]
fn seen_from_the_other_side_or_in_another_unit_it_is_the_same() {
    let mut random = Random(14);
    for kind in KINDS {
        for _ in 0..15 {
            let base = base(&mut random, kind);
            let (at, factor) = (beginning(&mut random, &base), factor(&mut random));
            let ours = retime(&base, &TimeLaw::of(&base), at, factor).unwrap();
            for other in [mirrored(&base), scaled(&base, 2f64.powi(10)), scaled(&base, 2f64.powi(-7))] {
                let theirs = retime(&other, &TimeLaw::of(&other), at, factor).unwrap();
                assert_eq!(ours.law(), theirs.law(), "{kind:?} at {at} to {factor}");
            }
        }
    }
}

/// Each coefficient of the composition against the chain rule, at every piece's start, and the jerk inside.
#[test]
fn the_composition_is_the_chain_rule() {
    let mut random = Random(15);
    for kind in [Kind::Together, Kind::FifthOrder, Kind::Quintic] {
        for _ in 0..40 {
            let base = base(&mut random, kind);
            let at = base.duration() * random.unit();
            let retimed = retime(&base, &TimeLaw::of(&base), at, 0.3).unwrap();
            for (axis, path) in retimed.plan().plan().axes().iter().zip(base.axes()) {
                let jerk_scale = path.profile.segments().iter().map(|it| it.at(0.0).jerk.abs());
                let jerk_scale = jerk_scale.fold(path.limits.jerk(), f64::max);
                let lasting = |(_, segment): &(f64, Segment)| segment.duration > 1e-9 * base.duration();
                for (begin, segment) in axis.profile.timed_segments().filter(lasting) {
                    // Away from the joins of either, where the jerk has two values.
                    for part in [0.2, 0.5, 0.8] {
                        let t = part * segment.duration;
                        let law = retimed.law().profile().at(begin + t);
                        let State { position: tau, velocity: r, acceleration: s } = law.state;
                        let Setpoint { state: q, jerk } = path.profile.at(tau);
                        let expected =
                            jerk * r * r * r + 3.0 * q.acceleration * r * s + q.velocity * law.jerk;
                        let off = (segment.at(t).jerk - expected).abs();
                        let rough = segment.derivatives(t)[4].abs() * 1e-13 * (1.0 + tau);
                        assert!(
                            off <= 1e-10 * jerk_scale + rough,
                            "{kind:?}: the jerk is {off:e} off {expected}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn faster_than_planned_where_the_limits_have_room() {
    let limits = Limits::symmetric(1.0, 2.0, 20.0).unwrap();
    let slow = Limits::symmetric(0.5, 0.5, 2.5).unwrap();
    let problem =
        planner::Problem::new(State::at_rest(0.0), State::at_rest(1.0), slow, Default::default()).unwrap();
    let profile = planner::plan_move(&problem).unwrap().to_profile();
    let of = |limits: Limits, profile: Profile| {
        let promised = Quantity::BY_ORDER[1..=3].to_vec();
        let axes = vec![paths::axis(0, limits, profile)];
        Plan::new(Method::default(), promised, CycleTime::MILLISECOND, axes).unwrap()
    };
    // Velocity 2, acceleration 4 and jerk 8 times as large are allowed: a factor of 2, and it is the same for all.
    let base = of(limits, profile.clone());
    assert!((greatest_factor(&base, 0.0) - 2.0).abs() < 1e-12);
    let mut motion = Underway::of(&base);
    let faster = motion.to(&base, 0.2, 1.9);
    assert!(faster.reached().is_some());
    assert!(faster.rests() < (base.duration() - 0.2) / 1.5);
    let error = retime(&base, &TimeLaw::of(&base), 0.2, 2.5).unwrap_err().to_string();
    assert_eq!(
        error,
        "factor: is 2.5: a factor is from 0 (rest) to 2, which the limits allow on the rest of the path"
    );
    // On its limits: not at all.
    let tight = of(problem.limits().clone(), profile);
    let error = retime(&tight, &TimeLaw::of(&tight), 0.2, 1.000_001).unwrap_err().to_string();
    assert_eq!(
        error,
        "factor: is 1.000001: a factor is from 0 (rest) to 1, which the limits allow on the rest of the path"
    );
}

/// A law from elsewhere is refused, or leads to a plan that the judge has passed; whatever is in it.
#[test]
fn a_foreign_law_does_no_harm() {
    let mut random = Random(16);
    let mut passed = 0;
    for round in 0..400 {
        let mut base = base(&mut random, KINDS[round % KINDS.len()]);
        if round % 7 == 0 {
            let still = |axis: &AxisPlan| {
                let profile = Profile::new(vec![], State::at_rest(0.5));
                AxisPlan { goal: profile.end(), profile, ..axis.clone() }
            };
            let axes = base.axes().iter().map(still).collect();
            base = Plan::new(base.method(), base.guaranteed().to_vec(), base.cycle_time(), axes).unwrap();
        }
        let number = |random: &mut Random| match random.bits() % 8 {
            0 => 0.0,
            1 => f64::NAN,
            2 => f64::INFINITY,
            3 => random.decades(1e-300, 1e300),
            4 => -random.decades(1e-3, 1e3),
            _ => random.unit() * base.duration(),
        };
        let segments = (0..1 + random.bits() % 4).map(|_| {
            let [duration, position, velocity, acceleration, third] = [(); 5].map(|()| number(&mut random));
            let start = State { position, velocity: velocity.min(1.5), acceleration };
            Segment { duration, start, law: Law::ConstantJerk(third) }
        });
        let Ok(law) = TimeLaw::new(segments.collect()) else { continue };
        let at = number(&mut random);
        for factor in [0.0, 0.5, 1.0, number(&mut random)] {
            passed += usize::from(retime(&base, &law, at, factor).is_ok());
        }
    }
    assert!(passed > 0, "some lead somewhere");
}

#[test]
fn what_cannot_be_retimed_says_so() {
    let limits = Limits::symmetric(1.0, 2.0, 20.0).unwrap();
    let ends = (State::at_rest(0.0), State::at_rest(1.0));
    let problem = planner::Problem::new(ends.0, ends.1, limits.clone(), Default::default()).unwrap();
    let of = |profile| {
        let axes = vec![paths::axis(0, limits.clone(), profile)];
        Plan::new(Method::default(), vec![], CycleTime::MILLISECOND, axes).unwrap()
    };
    let check = |plan: &Plan, at: f64, factor: f64, text: &str| {
        let error = retime(plan, &TimeLaw::of(plan), at, factor).unwrap_err();
        assert_eq!(error.to_string(), text);
    };
    let whole = of(planner::plan_move(&problem).unwrap().to_profile());
    for factor in [-1e-9, f64::NAN, f64::INFINITY] {
        let greatest = if factor > 0.0 { greatest_factor(&whole, 0.1) } else { 1.0 };
        let text = format!(
            "factor: is {factor}: a factor is from 0 (rest) to {greatest}, which the limits allow on the rest of the path"
        );
        check(&whole, 0.1, factor, &text);
    }
    check(&whole, f64::NAN, 0.0, "at: is NaN: give a finite number of at most 1e60 in magnitude");
    let cosine = of(planner::plan_trigonometric(&problem).unwrap().to_profile());
    check(
        &cosine,
        0.1,
        0.0,
        "base.axes[0].segments[0]: is not a polynomial of order 5 or less, so its time cannot be stretched: plan the \
         motion anew",
    );
    let law = Law::Polynomial(Derivatives::new(&[0.0, 0.0, 0.0, 1.0]).unwrap());
    let sixth = Segment { duration: 1.0, start: ends.0, law };
    check(
        &of(Profile::new(vec![sixth], sixth.end())),
        0.1,
        0.0,
        "base.axes[0].segments[0]: is not a polynomial of order 5 or less, so its time cannot be stretched: plan the \
         motion anew; base.axes[0].end: moves on at 0.008333333333333333 after the end of the plan: put a closing stop \
         after it",
    );
    let piece = Segment {
        duration: 1.0,
        start: State { velocity: -1.0, ..ends.0 },
        law: Law::ConstantJerk(f64::NAN),
    };
    assert_eq!(
        TimeLaw::new(vec![piece, sixth]).unwrap_err().to_string(),
        "base_time[0]: is NaN: give a finite number of at most 1e60 in magnitude; base_time[1]: is not a polynomial of \
         order 5 or less, so its time cannot be stretched: plan the motion anew"
    );
    assert_eq!(
        TimeLaw::new(vec![Segment { law: Law::ConstantJerk(0.0), ..piece }]).unwrap_err().to_string(),
        "base_time[0]: is -1: a duration, path time and its rate are 0 or above where a piece begins"
    );
    assert_eq!(
        TimeLaw::new(vec![]).unwrap_err().to_string(),
        "base_time: is empty: give the pieces of the time law, or that of the plan itself"
    );
}
