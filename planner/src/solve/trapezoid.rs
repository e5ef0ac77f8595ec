//! The trapezoid between two speeds, in the direction of travel: constant acceleration in pieces, the baseline that the
//! papers on jerk-limited motion compare with. Its acceleration jumps, so its jerk has no bound, and the jerk limit
//! plays no part.
//!
//! ```text
//! v │   ╭──────╮        length of a ramp   D(v₀, v₁) = (v₀ + v₁)/2 · |v₁ − v₀|/a
//!   │  ╱        ╲       two that meet      S(v) = D(start, v) + D(v, end), a parabola
//!   └─╱──────────╲── t
//! ```

use super::lane::{Lane, Sides};
use crate::float::{largest, sqrt};

/// What a lane is solved to: how long it speeds up, cruises and slows down \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Trapezoid {
    pub(super) up: f64,
    pub(super) cruise: f64,
    pub(super) down: f64,
    /// The greatest speed [axis units/s].
    pub(super) peak: f64,
    pub(super) end: f64,
}

impl Trapezoid {
    /// The least length that changes from the start to the end speed [axis units].
    pub(super) fn least_length(lane: &Lane) -> f64 {
        let Lane { start, end, .. } = *lane;
        0.5 * (start + end) * (end - start).abs() / lane.limit(start, end)
    }

    /// The fastest way, for a lane that is not too short.
    pub(super) fn solve(lane: &Lane) -> Self {
        let sides = lane.sides();
        let Sides { faster, sum, gap, near, far, .. } = sides;
        let room = lane.cruise - faster;
        let spare =
            lane.length - 0.5 * ((2.0 * faster + room) * room / near + (sum + room) * (room + gap) / far);
        let rise = if spare > 0.0 {
            room
        } else {
            // u²·(1/n + 1/f)/2 + u·b = r.
            let rest = largest(0.0, lane.length - Self::least_length(lane));
            let b = faster / near + faster / far;
            let root = sqrt(b * b + 2.0 * rest / near + 2.0 * rest / far);
            let rise = if rest > 0.0 { 2.0 * rest / (b + root) } else { 0.0 };
            if rise > room { room } else { rise }
        };
        let (up, down) = sides.up_and_down(rise / near, (rise + gap) / far);
        let cruise = if spare > 0.0 { spare / lane.cruise } else { 0.0 };
        Self { up, cruise, down, peak: faster + rise, end: lane.end }
    }

    /// The nearest end speed and the ramp to it, for a lane that is too short: `v² = start² ± 2·a·length`, so that it
    /// lies between the start and the end speed.
    pub(super) fn nearest(lane: &Lane) -> Self {
        let Lane { start, length, .. } = *lane;
        let limit = lane.limit(start, lane.end);
        if lane.end >= start {
            let way = 2.0 * limit * length;
            let change = if way > 0.0 { way / (start + sqrt(start * start + way)) } else { 0.0 };
            let end = start + change;
            return Self { up: change / limit, cruise: 0.0, down: 0.0, peak: end, end };
        }
        let way = 2.0 * limit * length;
        let change = way / (start + sqrt(largest(0.0, start * start - way)));
        Self { up: 0.0, cruise: 0.0, down: change / limit, peak: start, end: largest(0.0, start - change) }
    }
}
