//! How well the pieces of a motion meet.

use super::Promise;
use crate::{MAX_ORDER, Profile};

/// The largest difference at a join, signed, and when; by the order of the derivative.
pub(super) struct Jumps {
    pub(super) worst: [(f64, f64); MAX_ORDER + 1],
}

impl Jumps {
    /// Before the first piece and after the last nothing is joined, but for the derivatives from jerk on, up to `highest`, which
    /// join standstill there or constant speed, and for an acceleration that may jump, which may jump to its end.
    pub(super) fn of(profile: &Profile, highest: usize, promise: &Promise) -> Self {
        let mut jumps = Self { worst: [(0.0, 0.0); MAX_ORDER + 1] };
        let mut still = [0.0; MAX_ORDER + 1];
        let mut end = None;
        for (index, &time) in profile.begins().iter().enumerate() {
            let [start, last] = ends(profile, index, highest);
            let lowest = if end.is_none() { 3 } else { 0 };
            jumps.see(lowest, highest, end.as_ref().unwrap_or(&still), &start, time);
            end = Some(last);
        }
        if let Some(end) = end {
            still[2] = profile.end().acceleration;
            let lowest = if promise.joined[2] { 3 } else { 2 };
            jumps.see(lowest, highest, &end, &still, profile.duration());
        }
        jumps
    }

    fn see(
        &mut self,
        lowest: usize,
        highest: usize,
        before: &[f64; MAX_ORDER + 1],
        after: &[f64; MAX_ORDER + 1],
        time: f64,
    ) {
        for order in lowest..=highest {
            let (worst, jump) = (&mut self.worst[order], after[order] - before[order]);
            // NaN counts as worst.
            let smaller = jump.abs() <= worst.0.abs();
            if !smaller {
                *worst = (jump, time);
            }
        }
    }
}

/// The fastest at the start, at the end and where pieces meet: what tells a speed from a rounded zero.
pub(super) fn fastest_join(profile: &Profile) -> f64 {
    profile.joins().map(|state| state.velocity.abs()).fold(0.0, f64::max)
}

/// The derivatives where a piece begins and where it ends, those above jerk only where they are asked for.
#[inline]
fn ends(profile: &Profile, index: usize, highest: usize) -> [[f64; MAX_ORDER + 1]; 2] {
    if highest > 3 {
        let segment = profile.segment(index);
        return [0.0, segment.duration].map(|t| segment.derivatives(t));
    }
    profile.setpoints_at_ends(index).map(|setpoint| {
        let mut all = [0.0; MAX_ORDER + 1];
        all[..4].copy_from_slice(&setpoint.words());
        all
    })
}
