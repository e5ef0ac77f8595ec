//! What leads an axis back that begins beyond its limits: what it has of jerk and acceleration by itself, or on a straight line what all
//! axes have in common there.
//!
//! ```text
//! jerk of axis i on the line     shareᵢ · min over k of jerkₖ/shareₖ         share: the greatest jerk of an axis's own pieces,
//! and so its accelerations                                                   of which only the proportions count
//! ```

use crate::float::{largest, least};
use crate::{Family, Limits, Plan, Profile, Synchronization};

/// Of the velocities and accelerations at the start, and of their limits \[1\]: how far from the proportion of the shares they may be. It tells
/// axes that are on no line, so it leaves room for all that is rounding.
const BESIDE: f64 = 1e-6;

/// What an axis can be led back by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recovery {
    pub(crate) acceleration: f64,
    pub(crate) deceleration: f64,
    pub(crate) jerk: f64,
}

impl Recovery {
    /// What the axis has by itself.
    pub(crate) fn alone(limits: &Limits) -> Self {
        let (acceleration, deceleration) = (limits.acceleration(), limits.deceleration());
        Self { acceleration, deceleration, jerk: limits.jerk() }
    }

    /// The limit of a ramp that goes on through zero.
    pub(crate) fn lower(&self) -> f64 {
        least(self.acceleration, self.deceleration)
    }

    fn times(self, factor: f64) -> Self {
        Self {
            acceleration: factor * self.acceleration,
            deceleration: factor * self.deceleration,
            jerk: factor * self.jerk,
        }
    }

    /// The least of both, part by part.
    fn and(self, other: Self) -> Self {
        Self {
            acceleration: least(self.acceleration, other.acceleration),
            deceleration: least(self.deceleration, other.deceleration),
            jerk: least(self.jerk, other.jerk),
        }
    }
}

/// What the axes of a plan can be led back by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Recoveries {
    /// Along a line, for a share of one.
    common: Option<Recovery>,
}

impl Recoveries {
    /// Of the axes of `plan`, within the limits that they have there.
    pub(crate) fn of(plan: &Plan) -> Self {
        Self::within(plan, plan.axes().iter().map(|axis| &axis.limits))
    }

    /// Of the axes of `plan`, within other limits.
    pub(crate) fn within<'a>(plan: &'a Plan, limits: impl Iterator<Item = &'a Limits> + Clone) -> Self {
        let (method, axes) = (plan.method(), plan.axes());
        let in_line = method.synchronization == Synchronization::Phase
            && method.family == Family::SCurve
            && method.pvt.is_none()
            && axes.len() > 1;
        let moving = || {
            let axes = axes.iter().zip(limits.clone());
            axes.map(|(axis, limits)| (&axis.profile, limits, share(&axis.profile)))
                .filter(|axis| axis.2 > 0.0)
        };
        if !in_line || !is_in_proportion(moving()) {
            return Self { common: None };
        }
        let common = moving().map(|(_, limits, share)| Recovery::alone(limits).times(1.0 / share));
        Self { common: common.reduce(Recovery::and) }
    }

    /// Of one axis.
    pub(crate) fn of_axis(&self, profile: &Profile, limits: &Limits) -> Recovery {
        let alone = Recovery::alone(limits);
        let Some(common) = self.common else { return alone };
        match share(profile) {
            share if share > 0.0 => alone.and(common.times(share)),
            // What does not move is on every line.
            _ => alone,
        }
    }
}

/// The greatest jerk of a profile, a magnitude.
fn share(profile: &Profile) -> f64 {
    let pieces = (0..profile.begins().len()).filter_map(|index| profile.constant_jerk(index));
    pieces.map(|(_, _, jerk)| jerk.abs()).fold(0.0, largest)
}

/// Do the axes begin with velocities and accelerations in proportion to their shares?
fn is_in_proportion<'a>(moving: impl Iterator<Item = (&'a Profile, &'a Limits, f64)>) -> bool {
    let mut first = None;
    for (profile, limits, share) in moving {
        let start = profile.start();
        let each = [
            (
                start.velocity.abs() / share,
                largest(limits.velocity_forward(), limits.velocity_reverse()) / share,
            ),
            (start.acceleration.abs() / share, largest(limits.acceleration(), limits.deceleration()) / share),
        ];
        let first = first.get_or_insert(each);
        let apart = |((value, limit), (other, other_limit)): ((f64, f64), (f64, f64))| {
            let scale = largest(largest(value, other), largest(limit, other_limit));
            // Also true for NaN.
            let near = (value - other).abs() <= BESIDE * scale;
            !near
        };
        if each.into_iter().zip(*first).any(apart) {
            return false;
        }
    }
    true
}
