//! Which piece is due at which cycle, ready to be evaluated in the width of the generator.

use arrayvec::ArrayVec;

use super::real::Real;
use super::shape::{Shape, seen_from_the_end};
use super::{AxisLimits, Setpoint};
use crate::{CycleTime, LAST_CYCLE, MAX_TRANSIT_PIECES, State, Transit};

/// Of a move from rest four pieces to the middle and four from it; of one from motion all its pieces.
const MAX_STRETCHES: usize = MAX_TRANSIT_PIECES;

/// Of t_j, in the width of the generator \[1\]: a joint this little after a cycle is on it. Limits that were rounded to that
/// width move the joints by about as much, and the acceleration is off by as little of its peak: 0.003 / 0.0001 is
/// 30.000002 in `f32`, where thirty is meant.
const LIMIT_SLACK: f64 = 2.0;
/// Of the time of the joint, in `f64` ε \[1\]: the roundings of a time that should be whole.
const TIME_SLACK: f64 = 4.0 * f64::EPSILON;

/// The cycles during which one piece lasts, and the piece.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Stretch<F> {
    /// The first cycle after it.
    until: u64,
    /// The cycle from which its time is counted: the first in the first half, the last in the second.
    anchor: u64,
    /// What its position is relative to [axis units]: the start or the target.
    origin: F,
    /// The state at the anchor.
    position: F,
    velocity: F,
    acceleration: F,
    jerk: F,
    /// Half of the acceleration, half and a sixth of the jerk.
    half_acceleration: F,
    half_jerk: F,
    sixth_jerk: F,
}

impl<F: Real> Stretch<F> {
    fn new(until: u64, anchor: u64, origin: F, at_anchor: State, jerk: f64) -> Self {
        Self {
            until,
            anchor,
            origin,
            position: F::round(at_anchor.position),
            velocity: F::round(at_anchor.velocity),
            acceleration: F::round(at_anchor.acceleration),
            jerk: F::round(jerk + 0.0),
            half_acceleration: F::round(at_anchor.acceleration * 0.5),
            half_jerk: F::round(jerk * 0.5),
            sixth_jerk: F::round(jerk / 6.0),
        }
    }

    /// The setpoint at `cycle`: the cubic of [`State::after`], in the width `F`.
    ///
    /// The time from the anchor is a whole number of cycles, negative in the second half, times the cycle: nothing is
    /// added up, so nothing drifts. Seen from the anchor's end, all the terms of the position have one sign, or are smaller
    /// than those that have: no digit cancels, and no rounding puts the position beyond the target.
    #[inline]
    fn at(&self, cycle: u64, cycle_time: F, limits: &AxisLimits<F>) -> Setpoint<F> {
        let t = F::count(cycle as i64 - self.anchor as i64) * cycle_time;
        let position =
            self.position + t * (self.velocity + t * (self.half_acceleration + t * self.sixth_jerk));
        let velocity = self.velocity + t * (self.acceleration + t * self.half_jerk);
        let acceleration = self.acceleration + t * self.jerk;
        Setpoint {
            position: self.origin + position,
            // Beyond a limit by a rounding is beyond it, for a drive that compares.
            velocity: velocity.within(limits.velocity),
            acceleration: acceleration.within(limits.acceleration),
            jerk: self.jerk,
        }
    }
}

/// A move, laid over cycles.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Schedule<F> {
    stretches: ArrayVec<Stretch<F>, MAX_STRETCHES>,
    /// The stretch that is due.
    due: usize,
}

impl<F: Real> Schedule<F> {
    /// Nothing to do.
    pub(super) fn empty() -> Self {
        Self { stretches: ArrayVec::new_const(), due: 0 }
    }

    /// Lays `shape` over cycles. Returns the cycle at which it has ended, too; `None` where that cannot be counted.
    ///
    /// The first half is timed from the start and the second from the end, by times that are all short or all exact:
    /// neither loses the digits that the other's distance takes.
    ///
    /// ```text
    /// cycle      0    1    2    3    4    5    6    7    8    9
    ///            ├────┼────┼────┼────┼────┼────┼────┼────┼────┤
    /// first half ├─ + ──┼─ 0 ─┼─ − ──┤                     ├──┤ gap
    /// anchor     0         2    3    ┊
    ///            ┊         second half ├─ − ──┼─ 0 ─┼─ + ──┤
    /// anchor     ┊                   ┊        5    6       8
    ///            ┊                   T/2                   T
    /// ```
    pub(super) fn of(shape: &Shape, cycle: CycleTime, start: F, target: F) -> Option<(Self, u64)> {
        let seconds_to_cycles = |seconds| seconds_to_cycles(seconds, cycle);
        let cycles_to_seconds = |cycles| cycles_to_seconds(cycles, cycle);
        let jerk_cycles = seconds_to_cycles(shape.jerk_time);
        let slack = |cycles: f64| LIMIT_SLACK * F::EPSILON * jerk_cycles + TIME_SLACK * cycles;

        let total = seconds_to_cycles(shape.duration());
        let end = libm::ceil(total - slack(total));
        if end > LAST_CYCLE as f64 {
            return None;
        }
        // A move that is shorter than its own slack would still have to arrive.
        let end = end.max(1.0);
        // A duration that is whole but for its roundings is whole; the joints are counted from it.
        let gap = if (end - total).abs() <= TIME_SLACK * total { 0.0 } else { end - total };
        // A cycle in the very middle is in the second half: there the jerk leads on, where there is no cruise.
        let middle = libm::ceil(0.5 * total - slack(0.5 * total));

        let rising = shape.rising();
        let begin =
            |piece: usize| rising.get(piece).map_or(f64::INFINITY, |(begin, _)| seconds_to_cycles(*begin));
        let mut stretches = ArrayVec::new();

        let mut from = 0.0;
        for (index, (_, piece)) in rising.iter().enumerate() {
            let next = begin(index + 1);
            let until = libm::ceil(next - slack(next)).min(middle).min(end);
            if from < until {
                let into = cycles_to_seconds(from - begin(index));
                let at_anchor = piece.start.after(piece.jerk, into);
                stretches.push(Stretch::new(until as u64, from as u64, start, at_anchor, piece.jerk));
                from = until;
            }
        }
        for (index, (_, piece)) in rising.iter().enumerate().rev() {
            let left = begin(index);
            let until = (end - libm::floor(left + gap + slack(left))).min(end);
            if from < until {
                let anchor = until - 1.0;
                let into = cycles_to_seconds((end - anchor) - gap - left);
                let at_anchor = seen_from_the_end(piece.start.after(piece.jerk, into));
                stretches.push(Stretch::new(until as u64, anchor as u64, target, at_anchor, piece.jerk));
                from = until;
            }
        }
        Some((Self { stretches, due: 0 }, end as u64))
    }

    /// Lays a motion that leads from any state at `start` to rest at `target` over cycles; `transit` has its positions relative to
    /// the target. Returns the cycle at which it has ended, too; `None` where that cannot be counted.
    ///
    /// There are no halves that mirror each other here, but the same holds: what is nearer to the start is told from there, the rest
    /// from the target, from the last cycle of its piece backwards, so that the approach has the digits of what is left to go.
    pub(super) fn along(transit: &Transit, cycle: CycleTime, start: F, target: F) -> Option<(Self, u64)> {
        let slack = |cycles: f64| TIME_SLACK * cycles;
        let total = seconds_to_cycles(transit.duration(), cycle);
        let end = libm::ceil(total - slack(total));
        if end > LAST_CYCLE as f64 {
            return None;
        }
        let end = end.max(1.0);
        let behind = transit.start().position;

        let mut stretches = ArrayVec::new();
        let (mut begin, mut from) = (0.0, 0.0);
        for piece in transit.pieces() {
            let next = begin + piece.duration;
            let joint = seconds_to_cycles(next, cycle);
            let until = libm::ceil(joint - slack(joint)).min(end);
            if from < until {
                let at =
                    |anchor: f64| piece.start.after(piece.jerk, cycles_to_seconds(anchor, cycle) - begin);
                let (first, last) = (at(from), at(until - 1.0));
                stretches.push(if (first.position - behind).abs() < first.position.abs() {
                    let first = State { position: first.position - behind, ..first };
                    Stretch::new(until as u64, from as u64, start, first, piece.jerk)
                } else {
                    Stretch::new(until as u64, until as u64 - 1, target, last, piece.jerk)
                });
                from = until;
            }
            begin = next;
        }
        Some((Self { stretches, due: 0 }, end as u64))
    }

    /// Goes on to `cycle`, the one after the present one.
    #[inline]
    pub(super) fn advance(&mut self, cycle: u64) {
        // Every stretch has at least one cycle, so the one after it is due.
        if self.stretches.get(self.due).is_some_and(|stretch| cycle >= stretch.until) {
            self.due += 1;
        }
    }

    /// The setpoint at the present cycle; `None` after the end.
    #[inline]
    pub(super) fn at(&self, cycle: u64, cycle_time: F, limits: &AxisLimits<F>) -> Option<Setpoint<F>> {
        self.stretches.get(self.due).map(|stretch| stretch.at(cycle, cycle_time, limits))
    }
}

fn seconds_to_cycles(seconds: f64, cycle: CycleTime) -> f64 {
    seconds * 1e9 / cycle.as_ns() as f64
}

fn cycles_to_seconds(cycles: f64, cycle: CycleTime) -> f64 {
    cycles * cycle.as_ns() as f64 / 1e9
}
