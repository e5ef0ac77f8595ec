//! New targets for a generator on its way: laws over scripts of targets at any cycles, in both widths, and against the planner.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    clippy::print_stdout,
    reason = "a test may fail by panicking; exact is what an arrival is; measurements are printed"
)]

use planner::generator::{AxisLimits, Generator, Real, Setpoint};
use planner::{Bounds, CycleTime, State, Transfer, plan_transfer};
use proptest::prelude::*;

const MS: CycleTime = CycleTime::MILLISECOND;
const DT: f64 = 1e-3;

/// A target, and for how many cycles it is followed before the next one comes.
type Leg = (f64, usize);

/// What is asked of an axis: its limits, and targets that come before the one before is reached, or long after.
#[derive(Clone, Debug)]
struct Script {
    limits: AxisLimits<f64>,
    legs: Vec<Leg>,
}

/// Limits by the times they take, from below a cycle to 200 of them; targets over six decades, round ones and repeated ones among
/// them.
fn script() -> impl Strategy<Value = Script> {
    let time = || prop_oneof![0.3..200.0_f64, Just(1.0), Just(30.0)];
    let target = prop_oneof![
        4 => (-6.0..0.0_f64, any::<bool>()).prop_map(|(size, back)| 10_f64.powf(size) * if back { -1.0 } else { 1.0 }),
        1 => prop_oneof![Just(0.0), Just(0.05), Just(1.0)],
    ];
    let legs = prop::collection::vec((target, prop_oneof![0..3_usize, 1..400_usize]), 1..8);
    (time(), time(), prop_oneof![Just(100.0), 1e-2..1e4_f64], legs).prop_map(|(t_j, t_a, jerk, legs)| {
        let acceleration = jerk * t_j * DT;
        let limits = AxisLimits { velocity: acceleration * t_a * DT, acceleration, jerk };
        // Targets in the lengths of such an axis: what it goes while it speeds up and slows down, and a while more.
        let length = limits.velocity * (t_j + t_a) * DT * 4.0;
        Script { limits, legs: legs.into_iter().map(|(target, cycles)| (target * length, cycles)).collect() }
    })
}

fn narrow(limits: AxisLimits<f64>) -> AxisLimits<f32> {
    let AxisLimits { velocity, acceleration, jerk } = limits;
    AxisLimits { velocity: velocity as f32, acceleration: acceleration as f32, jerk: jerk as f32 }
}

/// Position, velocity, acceleration and jerk.
fn wide<F: Real + Into<f64>>(setpoint: Setpoint<F>) -> [f64; 4] {
    let Setpoint { position, velocity, acceleration, jerk } = setpoint;
    [position, velocity, acceleration, jerk].map(Into::into)
}

/// Follows a script, and holds every setpoint against what it comes from: limits to the last bit, and joins.
///
/// Between two setpoints one jerk may turn into another, so the state at the second is between those of full jerk either way.
fn lawful<F: Real + Into<f64>>(script: &Script, limits: AxisLimits<F>, width: fn(f64) -> F, epsilon: f64) {
    let [velocity, acceleration, jerk] =
        [limits.velocity, limits.acceleration, limits.jerk].map(Into::<f64>::into);
    let mut generator = Generator::new(limits, MS).unwrap();
    let farthest = script.legs.iter().fold(0.0_f64, |far, leg| far.max(leg.0.abs()));
    let stop = velocity * (velocity / acceleration + acceleration / jerk);
    let rounding =
        [16.0 * epsilon * (farthest + stop), 32.0 * epsilon * velocity, 32.0 * epsilon * acceleration];
    let mut before = wide(generator.setpoint());
    let mut follow = |generator: &mut Generator<F>| {
        let now = wide(generator.step());
        let [p, v, a, j] = now;
        assert!(v.abs() <= velocity && a.abs() <= acceleration && j.abs() <= jerk, "{v} {a} {j}");
        let [p_0, v_0, a_0, _] = before;
        let room = [jerk * DT * DT * DT / 6.0, jerk * DT * DT / 2.0, jerk * DT];
        let gaps = [p - p_0 - DT * (v_0 + DT * a_0 / 2.0), v - v_0 - DT * a_0, a - a_0];
        for ((gap, room), rounding) in gaps.into_iter().zip(room).zip(rounding) {
            assert!(gap.abs() <= room * (1.0 + 1e-6) + rounding, "{gap:e} beyond {room:e} and {rounding:e}");
        }
        before = now;
    };
    for &(target, cycles) in &script.legs {
        let target = width(target);
        let (old, [p, v, a, _]) = (generator.clone(), wide(generator.setpoint()));
        generator.set_target(target).unwrap();
        assert_eq!(wide(generator.setpoint())[..3], [p, v, a], "a new target moves nothing");
        if target == old.target() && !old.is_done() {
            assert_eq!(generator, old, "the same again changes nothing");
        }
        for _ in 0..cycles {
            follow(&mut generator);
        }
    }
    while !generator.is_done() {
        follow(&mut generator);
    }
    let last = width(script.legs.last().unwrap().0);
    for _ in 0..3 {
        assert_eq!(wide(generator.step()), [last.into(), 0.0, 0.0, 0.0]);
    }
}

/// The largest differences from the planner's motion, in ε of the width: the position's of how far it leads, but for an ulp of its
/// own, the others' of the limit, but for what the roundings of the duration are worth.
#[derive(Clone, Copy, Debug, Default)]
struct Worst {
    position: f64,
    velocity: f64,
    acceleration: f64,
}

impl Worst {
    /// What the documentation says.
    #[track_caller]
    fn hold(&self) {
        assert!(self.position <= 16.0 && self.velocity <= 8.0 && self.acceleration <= 8.0, "{self:?}");
    }
}

/// Each move from motion takes the cycles of the planner's fastest motion from that very setpoint, and is it.
fn fastest<F: Real + Into<f64>>(
    script: &Script,
    limits: AxisLimits<F>,
    width: fn(f64) -> F,
    epsilon: f64,
    worst: &mut Worst,
) {
    let of = limits;
    let [v_max, a_max, j_max] = [of.velocity, of.acceleration, of.jerk].map(Into::<f64>::into);
    let bounds = Bounds::symmetric(v_max, a_max, j_max).unwrap();
    let mut generator = Generator::new(limits, MS).unwrap();
    for &(target, cycles) in &script.legs {
        let target = width(target);
        let [position, velocity, acceleration, _] = wide(generator.setpoint());
        let again = !generator.is_done() && target == generator.target();
        generator.set_target(target).unwrap();
        if !again && (velocity != 0.0 || acceleration != 0.0) {
            let target: f64 = target.into();
            let start = State { position: position - target, velocity, acceleration };
            let transit = plan_transfer(&Transfer::new(start, State::default(), bounds).unwrap()).unwrap();
            let exact = transit.duration() / DT;
            let counted = generator.remaining_cycles() as f64;
            assert!(
                (counted - exact.ceil()).abs() <= 1.0 && counted >= exact * (1.0 - 1e-15),
                "{counted} {exact}"
            );
            let times = (0..=counted as u32).map(|cycle| f64::from(cycle) * DT);
            let scale = times
                .map(|t| transit.at(t).state.position)
                .fold(0.0, |far: f64, p| far.max((p - start.position).abs().max(p.abs())));
            // The planner's own instants are rounded as the generator's are.
            let late = 4.0 * f64::EPSILON * transit.duration();
            let mut ahead = generator.clone();
            for cycle in 1..=generator.remaining_cycles() {
                let ([p, v, a, _], theirs) = (wide(ahead.step()), transit.at(cycle as f64 * DT).state);
                let own = epsilon * p.abs().max(target.abs());
                let off = ((p - target - theirs.position).abs() - own) / (epsilon * scale);
                worst.position = worst.position.max(off);
                let off = |ours: f64, theirs: f64, limit: f64, rate: f64| {
                    ((ours - theirs).abs() - rate * late) / (epsilon * limit)
                };
                worst.velocity = worst.velocity.max(off(v, theirs.velocity, v_max, a_max));
                worst.acceleration = worst.acceleration.max(off(a, theirs.acceleration, a_max, j_max));
            }
        }
        for _ in 0..cycles {
            generator.step();
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_script_is_lawful(script in script()) {
        lawful(&script, script.limits, |wide| wide, f64::EPSILON);
        lawful(&script, narrow(script.limits), |wide| wide as f32, f32::EPSILON.into());
    }

    #[test]
    fn a_move_from_motion_is_the_fastest(script in script()) {
        let mut worst = Worst::default();
        fastest(&script, script.limits, |wide| wide, f64::EPSILON, &mut worst);
        worst.hold();
        let mut worst = Worst::default();
        fastest(&script, narrow(script.limits), |wide| wide as f32, f32::EPSILON.into(), &mut worst);
        worst.hold();
    }

    #[test]
    fn mirrored_targets_mirror_the_motion(script in script()) {
        let mut there = Generator::new(script.limits, MS).unwrap();
        let mut back = there.clone();
        for (target, cycles) in script.legs {
            there.set_target(target).unwrap();
            back.set_target(-target).unwrap();
            for _ in 0..cycles {
                let ([p, v, a, j], back) = (wide(there.step()), wide(back.step()));
                prop_assert_eq!([-p, -v, -a, -j], back);
            }
        }
    }
}

/// 0.25 m/s, 3 m/s², 100 m/s³: called back in mid-cruise, and sent farther just before the end.
#[test]
fn back_and_farther() {
    let limits = AxisLimits { velocity: 0.25_f64, acceleration: 3.0, jerk: 100.0 };
    let mut generator = Generator::new(limits, MS).unwrap();
    generator.set_target(0.05).unwrap();
    for _ in 0..150 {
        generator.step();
    }
    assert!((generator.setpoint().velocity - 0.25).abs() < 1e-15);
    generator.set_target(0.0).unwrap();
    assert!(generator.case().is_none() && generator.shape().is_none());
    let mut farthest = 0.0_f64;
    while !generator.is_done() {
        farthest = farthest.max(generator.step().position);
    }
    // At 23.33 mm the jerk begins, for 30 ms: 7.05 mm, and 45 mm/s less. The other 205 mm/s go at full deceleration, in v²/2A, and
    // it turns with that.
    let turn = 0.07 / 3.0 + 0.00705 + 0.205 * 0.205 / 6.0;
    assert!(farthest <= turn && turn - farthest < 1e-5, "{farthest}");
    assert_eq!(generator.position(), 0.0);
}
