//! The judge of motions within [`Bounds`], from any start: as [`violations`](crate::violations), from the pieces alone, and with
//! what it lets pass where a motion begins beyond its bounds.

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::{
    Bounds, BoundsSpec, EndCheck, JOIN_TOLERANCE, JoinCheck, LIMIT_TOLERANCE, LimitCheck, Profile, Quantity,
    State, Violation,
};

/// Units in the last place of the largest position: what positions far from zero may be apart besides.
const POSITION_ULPS: f64 = 8.0;

/// Units in the last place of the greatest velocity or acceleration: what one may be beyond its bound besides, since an end of a
/// piece is no better known than its beginning.
const VALUE_ULPS: f64 = 64.0;

/// Everything that a motion within `bounds` promises and does not keep: velocity, acceleration and jerk, joins, and the end at
/// `goal`. Empty: no objection.
///
/// A motion may begin beyond the bounds, or begin with an acceleration that takes its velocity beyond them whatever is done. Then
/// it is led back: what is beyond a bound may come no farther than full jerk against it makes inevitable, only comes back from
/// there, and once it is back it stays. How soon that must be is not asked.
#[must_use]
pub fn transfer_violations(profile: &Profile, bounds: &Bounds, goal: State) -> Vec<Violation> {
    let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
        *bounds.spec();
    let start = profile.start();
    let inevitable = |acceleration: f64| {
        let acceleration = acceleration.max(0.0);
        0.5 * acceleration * acceleration / max_jerk
    };
    let up = start.velocity + inevitable(start.acceleration);
    let down = start.velocity - inevitable(-start.acceleration);
    let mut found = Vec::new();
    let mut scale = Scale::default();
    scale.see(&start);
    scale.see(&goal);
    for (_, segment) in profile.timed_segments() {
        for t in segment.turning_points() {
            scale.see(&segment.at(t).state);
        }
    }
    // Below the normal numbers nothing is known to more than their least.
    let rounded = |hardest: f64| VALUE_ULPS * f64::EPSILON * hardest + f64::MIN_POSITIVE;
    let (fastest, hardest) = (rounded(scale.fastest), rounded(scale.hardest));
    let mut watches = [
        Watch::new(Quantity::Velocity, 1.0, max_velocity, up, fastest),
        Watch::new(Quantity::Velocity, -1.0, -min_velocity, -down, fastest),
        Watch::new(Quantity::Acceleration, 1.0, max_acceleration, start.acceleration, hardest),
        Watch::new(Quantity::Acceleration, -1.0, -min_acceleration, -start.acceleration, hardest),
        Watch::new(Quantity::Jerk, 1.0, max_jerk, 0.0, 0.0),
        Watch::new(Quantity::Jerk, -1.0, max_jerk, 0.0, 0.0),
    ];
    let mut before: Option<State> = None;
    let mut jumps = [(0.0, 0.0); 3];
    for (begin, segment) in profile.timed_segments() {
        for t in segment.turning_points() {
            let setpoint = segment.at(t);
            let State { velocity, acceleration, .. } = setpoint.state;
            let values = [velocity, velocity, acceleration, acceleration, setpoint.jerk, setpoint.jerk];
            for (watch, value) in watches.iter_mut().zip(values) {
                watch.see(value, begin + t);
            }
        }
        if let Some(before) = before {
            for (worst, (one, other)) in
                jumps.iter_mut().zip(parts(&before).into_iter().zip(parts(&segment.start)))
            {
                let jump = (one - other).abs();
                // NaN counts as worst.
                let smaller = jump <= worst.0;
                if !smaller {
                    *worst = (jump, begin);
                }
            }
        }
        before = Some(segment.end());
    }
    let allowed = scale.allowed(max_jerk);
    const QUANTITIES: [Quantity; 3] = [Quantity::Position, Quantity::Velocity, Quantity::Acceleration];
    let axis = Arc::<str>::default;
    for ((quantity, allowed), (worst_jump, at_time)) in QUANTITIES.into_iter().zip(allowed).zip(jumps) {
        let check = JoinCheck { axis: axis(), quantity, worst_jump, allowed, at_time, guaranteed: true };
        if !check.passed() {
            found.push(Violation::Join(check));
        }
    }
    found.extend(watches.iter().filter_map(Watch::violation));
    let (last, end, goal) = (parts(&before.unwrap_or(profile.end())), parts(&profile.end()), parts(&goal));
    for (order, (quantity, allowed)) in QUANTITIES.into_iter().zip(allowed).enumerate() {
        let residual = (last[order] - end[order]).abs() + (end[order] - goal[order]).abs();
        let check = EndCheck { axis: axis(), quantity, residual, allowed };
        if !check.passed() {
            found.push(Violation::End(check));
        }
    }
    found
}

fn parts(state: &State) -> [f64; 3] {
    [state.position, state.velocity, state.acceleration]
}

/// One bound, as an upper one, and what a motion has done about it.
struct Watch {
    quantity: Quantity,
    sign: f64,
    bound: f64,
    /// How far beyond the bound it may come, once.
    inevitable: f64,
    slack: f64,
    /// The lowest value since the highest: from there it may not rise while it is beyond.
    lowest: f64,
    highest: f64,
    /// The worst that was seen, and when.
    worst: Option<(f64, f64)>,
}

impl Watch {
    fn new(quantity: Quantity, sign: f64, bound: f64, inevitable: f64, rounded: f64) -> Self {
        let inevitable = inevitable.max(bound);
        let slack = LIMIT_TOLERANCE * inevitable + rounded;
        let highest = f64::NEG_INFINITY;
        Self { quantity, sign, bound, inevitable, slack, lowest: highest, highest, worst: None }
    }

    /// The next value; between two of them it is monotone.
    fn see(&mut self, value: f64, time: f64) {
        let value = self.sign * value;
        // Before its highest value it may rise as far as is inevitable; after it, not above where it has come back to.
        let rises_to_highest = self.lowest >= self.highest;
        let allowed = if rises_to_highest { self.inevitable } else { self.lowest.max(self.bound) };
        // Also true for NaN.
        let kept = value <= allowed + self.slack;
        if !kept && self.worst.is_none_or(|(worst, _)| value - worst > 0.0 || value.is_nan()) {
            self.worst = Some((value, time));
        }
        if value > self.highest {
            (self.highest, self.lowest) = (value, value);
        }
        self.lowest = self.lowest.min(value);
    }

    fn violation(&self) -> Option<Violation> {
        let Self { quantity, sign, bound, .. } = *self;
        let (worst, at_time) = self.worst?;
        let margin = (bound - worst) / bound;
        let (axis, limit, extremum) = (Arc::default(), sign * bound, sign * worst);
        Some(Violation::Limit(LimitCheck {
            axis,
            quantity,
            limit,
            extremum,
            at_time,
            margin,
            guaranteed: true,
            led_back_by: None,
        }))
    }
}

/// How far, fast and hard a motion goes.
#[derive(Default)]
struct Scale {
    range: Option<(f64, f64)>,
    fastest: f64,
    hardest: f64,
}

impl Scale {
    fn see(&mut self, state: &State) {
        let State { position, velocity, acceleration } = *state;
        let (least, greatest) = self.range.unwrap_or((position, position));
        self.range = Some((least.min(position), greatest.max(position)));
        self.fastest = self.fastest.max(velocity.abs());
        self.hardest = self.hardest.max(acceleration.abs());
    }

    /// An acceleration that is known to an ulp leaves a velocity that is known to what full jerk makes of that.
    fn allowed(&self, jerk: f64) -> [f64; 3] {
        let (least, greatest) = self.range.unwrap_or_default();
        let rounding = POSITION_ULPS * f64::EPSILON * least.abs().max(greatest.abs());
        [
            JOIN_TOLERANCE * (greatest - least) + rounding + f64::MIN_POSITIVE,
            JOIN_TOLERANCE * self.fastest
                + VALUE_ULPS * f64::EPSILON * (self.hardest * self.hardest / jerk)
                + f64::MIN_POSITIVE,
            JOIN_TOLERANCE * self.hardest + f64::MIN_POSITIVE,
        ]
    }
}
