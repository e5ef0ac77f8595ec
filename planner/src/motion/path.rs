//! Axes that keep to a path of theirs, which is no straight line: only how fast its time goes on can change.
//!
//! The motion is the base's path under a law of time, `q(τ(t))` ([`retime`]). Each operation changes the rate τ′ from
//! what it is to the one asked for: 0 holds, the override goes on. The base and the law travel with the motion, for a motion that was re-timed
//! is of higher degree than can be re-timed again.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::errand::closing_begins;
use super::{Kind, Motion, Refused, Spliced};
use crate::error::{InvalidFields, Why};
use crate::float::largest;
use crate::{Accepted, AxisPlan, Plan, RetimeError, State, TimeLaw, retime};

/// Of a velocity or a position \[1\], its limit or its largest: how near a plan is to its base under its law of time, where both come from
/// elsewhere. Roundings are far less, and a lie that is worth telling is more.
const ON_THE_PATH: f64 = 1e-9;

/// Of the duration of a path \[1\]: what is left of it when its roundings may be too large for the judge.
const LEFT: f64 = 1e-6;

/// A path, and how its time goes on from the motion's first cycle.
pub(super) struct Running {
    pub(super) base: Arc<Accepted>,
    pub(super) law: Arc<TimeLaw>,
}

impl Motion {
    /// Is its plan on a path that is no straight line?
    pub(super) fn keeps_a_path(&self) -> bool {
        Kind::of(self.plan()) == Kind::Path
    }

    /// The path that it is on.
    pub(super) fn running(&self) -> Result<Running, Refused> {
        match (&self.base, &self.law) {
            (Some(base), Some(law)) => Ok(Running { base: Arc::clone(base), law: Arc::clone(law) }),
            (None, _) => {
                Ok(Running { base: Arc::clone(&self.plan), law: Arc::new(TimeLaw::of(self.plan())) })
            }
            (Some(_), None) => Err(Refused::not_implemented(
                "to go on to new goals with axes that arrive together",
                "stop, and open a stream with a new plan",
            )),
        }
    }

    /// Brings the rate of path time to `rate`. `motion` says what else becomes of this one.
    ///
    /// What comes to rest already, or has ended, is left to.
    pub(super) fn at_rate(&self, at_cycle: u64, rate: f64, motion: Self) -> Result<Spliced, Refused> {
        let running = self.running()?;
        let at = self.time_of(at_cycle).min(running.law.profile().duration());
        if rate == 0.0 && self.rests_by(at_cycle) {
            return Ok(running.goes_on(self, at_cycle, motion));
        }
        running.at_rate(self, at_cycle, at, rate, motion)
    }
}

impl Running {
    /// Brings the rate to `rate` from `at` \[s\] on; `before` becomes `motion` otherwise.
    ///
    /// Where the path ends before the rate could change, or so little of it is left that its roundings are too large for the judge, the motion
    /// runs to its end.
    pub(super) fn at_rate(
        self,
        before: &Motion,
        at_cycle: u64,
        at: f64,
        rate: f64,
        motion: Motion,
    ) -> Result<Spliced, Refused> {
        let (now, end) = (self.law.at(at), self.base.plan().duration());
        if now.position >= end {
            return Ok(self.goes_on(before, at_cycle, motion));
        }
        let retiming = match retime(self.base.plan(), &self.law, at, rate) {
            Ok(retiming) => retiming,
            Err(RetimeError::Rejected(_)) if now.velocity > 0.0 && end - now.position <= LEFT * end => {
                return Ok(self.goes_on(before, at_cycle, motion));
            }
            Err(RetimeError::Rejected(rejection)) => return Err(Refused::Rejected(rejection)),
            Err(RetimeError::Invalid(invalid)) => return Err(refusal(rate, invalid)),
        };
        if retiming.reached().is_none() && rate < now.velocity {
            return Ok(self.goes_on(before, at_cycle, motion));
        }
        let (plan, law) = (retiming.plan().clone(), retiming.law().clone());
        let closes = closes(self.base.plan(), &law);
        let motion = Motion { base: Some(self.base), law: Some(Arc::new(law)), ..motion };
        before.spliced(at_cycle, motion, plan, closes, Vec::new())
    }

    /// No setpoint changes.
    fn goes_on(self, before: &Motion, at_cycle: u64, motion: Motion) -> Spliced {
        before.noted(at_cycle, Motion { base: Some(self.base), law: Some(self.law), ..motion })
    }
}

/// What is wrong with a rate.
fn refusal(given: f64, invalid: InvalidFields) -> Refused {
    let greatest = invalid.as_slice().iter().find_map(|item| match item.why {
        Why::FactorOutOfRange { greatest, .. } => Some(greatest),
        _ => None,
    });
    greatest.map_or_else(|| invalid.into(), |greatest| Refused::OverrideOutOfRange { given, greatest })
}

/// When the last goal that the base passes at speed is passed under `law` \[s\]; none where it is not, or is rested at.
fn closes(base: &Plan, law: &TimeLaw) -> Option<f64> {
    let passed = base.axes().iter().filter_map(closing_begins).reduce(largest)?;
    law.reaches(passed)
}

/// Does `plan` begin and end where `base` is under `law`, as fast as that?
pub(super) fn follows(plan: &Plan, base: &Plan, law: &TimeLaw) -> bool {
    let pairs = || plan.axes().iter().zip(base.axes());
    [0.0, plan.duration()].into_iter().all(|t| {
        let time = law.at(t);
        pairs().all(|(axis, path)| {
            let (ours, on_path) = (axis.profile.at(t).state, path.profile.at(time.position).state);
            let State { position, velocity, .. } = on_path;
            near(ours.position, position, farthest(path))
                && near(ours.velocity, velocity * time.velocity, fastest(path, velocity))
        })
    })
}

fn near(one: f64, other: f64, scale: f64) -> bool {
    (one - other).abs() <= ON_THE_PATH * scale
}

fn farthest(path: &AxisPlan) -> f64 {
    let begins = path.profile.segments().iter().map(|segment| segment.start.position.abs());
    begins.fold(path.profile.end().position.abs(), largest)
}

fn fastest(path: &AxisPlan, velocity: f64) -> f64 {
    largest(path.limits.velocity_towards(velocity), velocity.abs())
}
