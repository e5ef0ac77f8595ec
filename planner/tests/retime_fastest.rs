//! How near is a change of the rate to the fastest? Beside a search that tries beginnings, lengths and shapes of one ramp one by one.
//!
//! ```text
//! cargo test --release -p portamento-planner --test retime_fastest -- --ignored --nocapture
//! ```

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may fail by panicking, and print"
)]

mod common;

use common::Random;
use common::paths::{self, KINDS};
use planner::{Cursor, Plan, Quantity, State, TimeLaw, retime};

/// Instants at which the dense search looks at a ramp.
const LOOKS: u32 = 300;
/// Beginnings and lengths that it tries, beside the joins of the path.
const BEGINNINGS: u32 = 80;
const LENGTHS: i32 = 160;
/// Parts of a ramp for which its slope is held.
const HELD: [f64; 7] = [0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9];
/// Where nothing better is found by it, the path's own end must be as near [1].
const WORTH_IT: f64 = 0.97;

/// What an axis may do: acceleration, deceleration, jerk; where nothing is promised, what it does.
fn bounds(base: &Plan, from: f64) -> Vec<[f64; 3]> {
    let of = |axis: &planner::AxisPlan| {
        let limits = &axis.limits;
        let mut bounds = [limits.acceleration(), limits.deceleration(), limits.jerk()];
        for look in 0..=4000 {
            let t = from + (base.duration() - from) * f64::from(look) / 4000.0;
            let setpoint = axis.profile.at(t);
            let State { velocity, acceleration, .. } = setpoint.state;
            if !base.guarantees(Quantity::Acceleration) {
                let side = usize::from(acceleration * velocity < 0.0);
                bounds[side] = bounds[side].max(acceleration.abs());
            }
            if !base.guarantees(Quantity::Jerk) {
                bounds[2] = bounds[2].max(setpoint.jerk.abs());
            }
        }
        bounds
    };
    base.axes().iter().map(of).collect()
}

/// A ramp from a rate without slope to another: its length and how long the slope is held.
#[derive(Clone, Copy, Debug)]
struct Ramp {
    from: State,
    rate: f64,
    length: f64,
    held: f64,
}

impl Ramp {
    /// Path time and its third derivative, `t` seconds after the beginning.
    fn at(&self, t: f64) -> (State, f64) {
        let flank = self.length * (1.0 - self.held) / 2.0;
        let third = (self.rate - self.from.velocity) / (self.length - flank) / flank;
        let after_flank = self.from.after(third, flank);
        let held = after_flank.after(0.0, self.length - 2.0 * flank);
        match t {
            t if t < flank => (self.from.after(third, t), third),
            t if t < self.length - flank => (after_flank.after(0.0, t - flank), 0.0),
            t => (held.after(-third, t - (self.length - flank)), -third),
        }
    }

    fn is_legal(&self, base: &Plan, bounds: &[[f64; 3]]) -> bool {
        let mut cursors: Vec<Cursor> = base.axes().iter().map(|axis| Cursor::new(&axis.profile)).collect();
        for look in 0..=LOOKS {
            let (time, third) = self.at(self.length * f64::from(look) / f64::from(LOOKS));
            let State { position: tau, velocity: rate, acceleration: slope } = time;
            if rate < -1e-9 {
                return false;
            }
            if tau > base.duration() {
                return self.rate > self.from.velocity;
            }
            for (cursor, bounds) in cursors.iter_mut().zip(bounds) {
                let q = cursor.at(tau);
                let (first, second) = (q.state.velocity, q.state.acceleration);
                let acceleration = second * rate * rate + first * slope;
                let jerk = q.jerk * rate * rate * rate + 3.0 * second * rate * slope + first * third;
                let hardest = bounds[usize::from(acceleration * first < 0.0)];
                if acceleration.abs() > hardest * (1.0 + 1e-6) || jerk.abs() > bounds[2] * (1.0 + 1e-6) {
                    return false;
                }
            }
        }
        true
    }
}

/// When the rate is reached, going down, or the path ends, going up, at the soonest [s].
fn densely(base: &Plan, from: State, rate: f64) -> Option<f64> {
    let bounds = bounds(base, from.position);
    let left = base.duration() - from.position;
    let up = rate > from.velocity;
    let mut waits = vec![0.0];
    if !up {
        waits.extend((1..BEGINNINGS).map(|part| left * f64::from(part) / f64::from(BEGINNINGS)));
        let joins = base.axes().iter().flat_map(|axis| axis.profile.timed_segments().map(|(begin, _)| begin));
        let joins = joins.filter(|&begin| begin > from.position).map(|begin| begin - from.position);
        waits.extend(joins.flat_map(|wait| [wait, wait * (1.0 + 1e-9)]));
    }
    waits.sort_by(f64::total_cmp);
    let mut best = None;
    for wait in waits {
        for held in HELD {
            for number in 0..LENGTHS {
                let length = 1e-3 * (4e3 * left.max(1e-3)).powf(f64::from(number) / f64::from(LENGTHS));
                let start = State { position: from.position + wait * from.velocity, ..from };
                let ramp = Ramp { from: start, rate, length, held };
                let way = (base.duration() - ramp.at(length).0.position).max(0.0);
                let key = wait + length + if up { way / rate } else { 0.0 };
                if best.is_none_or(|best| key < best) && ramp.is_legal(base, &bounds) {
                    best = Some(key);
                    break;
                }
            }
        }
    }
    best
}

fn quantile(sorted: &[f64], part: f64) -> f64 {
    sorted.get(((sorted.len().max(1) - 1) as f64 * part) as usize).copied().unwrap_or(f64::NAN)
}

#[test]
#[ignore = "takes a minute"]
fn beside_a_dense_search() {
    for (name, factor) in [("hold", 0.0), ("to 0.6", 0.6), ("resume", 1.0)] {
        let mut random = Random(1);
        for kind in KINDS {
            let (mut ratios, mut neither, mut ours_alone, mut dense_alone) = (Vec::new(), 0, 0, 0);
            for _ in 0..150 {
                let count = 1 + (random.bits() % 6) as usize;
                let base = paths::path(&mut random, kind, count);
                let at = base.duration() * random.unit();
                let mut law = TimeLaw::of(&base);
                let mut from = law.at(at);
                let mut splice = at;
                if factor > from.velocity - 1e-9 {
                    // From rest: a path that stands still where it is held.
                    let held = retime(&base, &law, at, 0.0).unwrap();
                    if held.reached().is_none() {
                        continue;
                    }
                    law = held.law().clone();
                    splice = law.profile().duration();
                    from = law.at(splice);
                }
                let ours = retime(&base, &law, splice, factor).unwrap();
                let up = factor > from.velocity;
                let left = base.duration() - at;
                let dense = densely(&base, from, factor).filter(|&dense| up || dense < WORTH_IT * left);
                match (if up { Some(ours.rests()) } else { ours.reached() }, dense) {
                    (Some(ours), Some(dense)) => ratios.push(ours / dense),
                    (None, None) => neither += 1,
                    (Some(_), None) => ours_alone += 1,
                    (None, Some(_)) => dense_alone += 1,
                }
            }
            ratios.sort_by(f64::total_cmp);
            let [least, median, p90, most] = [0.0, 0.5, 0.9, 1.0].map(|part| quantile(&ratios, part));
            println!(
                "{name}, {kind:?}: {} with both, ours over the dense: least {least:.3}, median {median:.3}, p90 \
                 {p90:.3}, most {most:.3}; nothing better than the path's end: {neither}; ours alone {ours_alone}, the \
                 dense alone {dense_alone}",
                ratios.len()
            );
            assert!(median <= 1.02 && p90 <= 1.15, "{name}, {kind:?}");
            assert!(dense_alone <= 3, "{name}, {kind:?}");
        }
    }
}
