//! Axes that keep to a path of theirs, which is no straight line: only how fast its time goes on can change.
//!
//! The motion is the base's path under a law of time, `q(τ(t))` ([`retime`]). Each operation changes the rate τ′ from
//! what it is to the one asked for: 0 holds, the override goes on. The base and the law travel with the motion, for a motion that was re-timed
//! is of higher degree than can be re-timed again. New goals make a new path, on which all axes arrive together.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::errand::{Errand, UnderWay, closing_begins};
use super::leg::Turning;
use super::prove::{Proved, method_of_splice};
use super::{Kind, Motion, Override, Phase, Refused, Spliced, aimed, each};
use crate::error::{InvalidFields, Why};
use crate::float::largest;
use crate::passage::{greatest_speed, named};
use crate::retime::can_be_retimed;
use crate::{
    Accepted, AxisPlan, AxisTransfer, Classification, Judged, Limits, Method, Plan, RetimeError, State,
    Synchronization, TimeLaw, Timing, retime, together,
};

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

    /// The path that it is on; none where it has been left, or goals were named that are gone to from rest.
    pub(super) fn running(&self) -> Option<Running> {
        match (&self.base, &self.law) {
            (Some(base), Some(law)) => Some(Running { base: Arc::clone(base), law: Arc::clone(law) }),
            (None, _) => {
                Some(Running { base: Arc::clone(&self.plan), law: Arc::new(TimeLaw::of(self.plan())) })
            }
            (Some(_), None) => None,
        }
    }

    /// Brings the rate of path time to `rate`. `motion` says what else becomes of this one.
    ///
    /// What comes to rest already, or has ended, is left to. What cannot be re-timed, since it is made of cosines or is of a high order,
    /// comes to rest beside its path, and goes on from there to its goals.
    pub(super) fn at_rate(&self, at_cycle: u64, rate: f64, motion: Self) -> Result<Spliced, Refused> {
        let running = self.running();
        if rate == 0.0 && self.rests_by(at_cycle) {
            return Ok(match running {
                Some(running) => running.goes_on(self, at_cycle, motion),
                None => self.noted(at_cycle, motion),
            });
        }
        match running.filter(|running| can_be_retimed(running.base.plan())) {
            Some(running) => {
                let at = self.time_of(at_cycle).min(running.law.profile().duration());
                let spliced = running.at_rate(self, at_cycle, at, rate, &motion)?;
                Ok(spliced.unwrap_or_else(|| running.goes_on(self, at_cycle, motion)))
            }
            None if rate == 0.0 => {
                let aims = self.aims(at_cycle);
                let base = Some(Arc::new(aimed(self.plan(), &aims)?));
                self.rest_beside(at_cycle, &aims, Self { base, law: None, ..motion })
            }
            None => self.anew(at_cycle, &self.aims(at_cycle), motion),
        }
    }

    /// Each axis stops fastest, and the path is left. `motion` has what is gone on with, if anything is.
    pub(super) fn rest_beside(
        &self,
        at_cycle: u64,
        aims: &[AxisPlan],
        motion: Self,
    ) -> Result<Spliced, Refused> {
        let under_way = self.under_way(at_cycle, aims, Errand::Rest);
        let Some(planned) = each::planned(&under_way)? else { return Ok(self.noted(at_cycle, motion)) };
        let Proved { plan, beyond } = planned.proved;
        let spliced = self.spliced(at_cycle, motion, plan, None, beyond)?;
        Ok(Spliced { on_path: false, ..spliced })
    }

    /// Goes to `aims` from wherever it is, all axes arriving together, at the rate of `motion`: the new path is planned at full feed rate,
    /// and slowed from its beginning.
    pub(super) fn anew(&self, at_cycle: u64, aims: &[AxisPlan], motion: Self) -> Result<Spliced, Refused> {
        let motion = Self { base: None, law: None, phase: Phase::Moving, ..motion };
        let factor = motion.factor;
        if aims.len() == 1 {
            // One axis by itself is planned for its rate.
            let errand = Errand::Goals { factor, turning: Turning::Allowed, kept: &[false] };
            let under_way = self.under_way(at_cycle, aims, errand);
            let Some(planned) = each::planned(&under_way)? else { return Ok(self.noted(at_cycle, motion)) };
            let Proved { plan, beyond } = planned.proved;
            let base = if beyond.is_empty() { None } else { Some(Arc::new(aimed(self.plan(), aims)?)) };
            return self.spliced(at_cycle, Self { base, ..motion }, plan, planned.closes, beyond);
        }
        let under_way = self.under_way(at_cycle, aims, Errand::Rest);
        let plan = arriving_together(&under_way)?;
        let (plan, closing) = match plan.with_closing_stop()? {
            Some((closed, count)) => (closed, Some(count)),
            None => (plan, None),
        };
        let base = Judged::new(plan).accepted().map_err(Refused::Rejected)?;
        if factor == Override::FULL {
            let closes = closing.map(|count| base.plan().cycle_time().start_of(count));
            return self.spliced(at_cycle, motion, base, closes, Vec::new());
        }
        let running = Running { law: Arc::new(TimeLaw::of(base.plan())), base: Arc::new(base) };
        if let Some(spliced) = running.at_rate(self, at_cycle, 0.0, factor.get(), &motion)? {
            return Ok(spliced);
        }
        // Too short a way to slow down on.
        let Running { base, law } = running;
        let closes = closes(base.plan(), &law);
        let motion = Self { base: Some(Arc::clone(&base)), law: Some(law), ..motion };
        self.spliced(at_cycle, motion, Accepted::clone(&base), closes, Vec::new())
    }
}

/// A plan of a motion's axes to their aims, which all are reached at one time.
fn arriving_together(under_way: &UnderWay<'_>) -> Result<Plan, Refused> {
    let aims = under_way.aims;
    let limits: Vec<Limits> = aims.iter().map(|aim| aim.limits.scaled(1.0)).collect();
    let mut invalid = InvalidFields::default();
    let mut questions = Vec::with_capacity(aims.len());
    for (index, (aim, limits)) in aims.iter().zip(&limits).enumerate() {
        let question = AxisTransfer::within_limits(under_way.state(index), aim.goal, limits);
        let question = question.map_err(|refusal| named(&refusal, limits));
        questions.extend(invalid.take_element("axes", index, question));
    }
    invalid.into_result(())?;
    let mut transits = Vec::with_capacity(aims.len());
    together(&questions, Synchronization::Time, Timing::default(), &mut transits)?;
    let axes = aims.iter().zip(&transits).map(|(aim, transit)| AxisPlan {
        profile: transit.to_profile(),
        classification: Classification::of_speed(greatest_speed(transit)),
        ..aim.clone()
    });
    let method =
        Method { synchronization: Synchronization::Time, ..method_of_splice(under_way.plan.method()) };
    let promises = method.promises().to_vec();
    Ok(Plan::new(method, promises, under_way.plan.cycle_time(), axes.collect())?)
}

impl Running {
    /// Brings the rate to `rate` from `at` \[s\] on; `before` becomes `motion` otherwise.
    ///
    /// None where the path ends before the rate could change, or so little of it is left that its roundings are too large for the judge:
    /// then it runs to its end.
    pub(super) fn at_rate(
        &self,
        before: &Motion,
        at_cycle: u64,
        at: f64,
        rate: f64,
        motion: &Motion,
    ) -> Result<Option<Spliced>, Refused> {
        let (now, end) = (self.law.at(at), self.base.plan().duration());
        if now.position >= end {
            return Ok(None);
        }
        let retiming = match retime(self.base.plan(), &self.law, at, rate) {
            Ok(retiming) => retiming,
            Err(RetimeError::Rejected(_)) if now.velocity > 0.0 && end - now.position <= LEFT * end => {
                return Ok(None);
            }
            Err(RetimeError::Rejected(rejection)) => return Err(Refused::Rejected(rejection)),
            Err(RetimeError::Invalid(invalid)) => return Err(refusal(rate, invalid)),
        };
        if retiming.reached().is_none() && rate < now.velocity {
            return Ok(None);
        }
        let (plan, law) = retiming.into_parts();
        let closes = closes(self.base.plan(), &law);
        let (base, law) = (Some(Arc::clone(&self.base)), Some(Arc::new(law)));
        let motion = Motion { base, law, ..motion.clone() };
        before.spliced(at_cycle, motion, plan, closes, Vec::new()).map(Some)
    }

    /// No setpoint changes.
    pub(super) fn goes_on(self, before: &Motion, at_cycle: u64, motion: Motion) -> Spliced {
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
