//! The way to rest of an axis that hears no more: planned ahead with every batch of setpoints, and played where nothing else comes.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::errand::{Errand, UnderWay};
use super::prove::{Proved, prove};
use super::{Kind, Motion, Phase, Refused, Spliced, aim, aimed, each, line};
use crate::{Accepted, AxisPlan, Profile};

impl Motion {
    /// The fastest way to rest from the setpoint at `at_cycle`, as a motion that begins there; none where the motion rests from
    /// there on.
    ///
    /// Like a hold it can be resumed, unless the motion was stopping: then there is nothing to go on with. Unlike a hold it is not
    /// asked for, so it waits for nothing: axes on a straight line stay on it, and on any other path each stops by itself, which
    /// [`Spliced::on_path`] says. Its bits depend on the motion and the cycle alone.
    ///
    /// # Errors
    /// [`Refused::BeforeMotion`]; [`Refused::Rejected`] where the judge does not accept what was planned.
    pub fn tail(&self, at_cycle: u64) -> Result<Option<Spliced>, Refused> {
        if at_cycle < self.from_cycle {
            return Err(Refused::BeforeMotion { given: at_cycle, first: self.from_cycle });
        }
        if at_cycle >= self.last_cycle() {
            return Ok(None);
        }
        let aims = self.keeps();
        let under_way = self.under_way(at_cycle, &aims, Errand::Rest);
        let along = match Kind::of(self.plan()) {
            // Where roundings have grown beyond a line, or there is hardly any, each stops by itself.
            Kind::Line => line::planned(&under_way, self.asked()).unwrap_or(None),
            Kind::Each | Kind::Path => None,
        };
        let proved = match along {
            // As it is seen by whoever holds its pieces alone.
            Some(planned) => {
                let pieces = planned.proved.plan.plan().axes().iter().map(|axis| axis.profile.clone());
                prove(&under_way, each::resting(&aims, pieces.collect()))?
            }
            None => each::to_rest(&under_way)?,
        };
        self.tailed(&under_way, at_cycle, proved).map(Some)
    }

    /// The motion of axes that play `profiles`, one for each, from the setpoint at `at_cycle` on, as [`Motion::tail`] gave them to
    /// somebody else.
    ///
    /// # Errors
    /// [`Refused::BeforeMotion`]; [`Refused::TailDiffers`] for other axes, a way that does not begin in the setpoint of that cycle,
    /// or one that does not end at rest; [`Refused::Rejected`] for one that the judge does not accept.
    pub fn starved(&self, at_cycle: u64, profiles: Vec<Profile>) -> Result<Spliced, Refused> {
        if at_cycle < self.from_cycle {
            return Err(Refused::BeforeMotion { given: at_cycle, first: self.from_cycle });
        }
        let aims = self.keeps();
        let under_way = self.under_way(at_cycle, &aims, Errand::Rest);
        let begins = |(index, profile): (usize, &Profile)| {
            profile.start() == under_way.state(index) && profile.end().is_at_rest()
        };
        if profiles.len() != aims.len() || !profiles.iter().enumerate().all(begins) {
            return Err(Refused::TailDiffers { at_cycle });
        }
        let proved = prove(&under_way, each::resting(&aims, profiles))?;
        self.tailed(&under_way, at_cycle, proved)
    }

    fn tailed(&self, under_way: &UnderWay<'_>, at_cycle: u64, proved: Proved) -> Result<Spliced, Refused> {
        let Proved { plan, beyond } = proved;
        let on_path = match Kind::of(self.plan()) {
            Kind::Each => true,
            Kind::Line => line::is_kept(under_way, self.asked(), plan.plan()),
            Kind::Path => false,
        };
        let (phase, base) = match self.phase {
            Phase::Stopping | Phase::Finished => (Phase::Stopping, None),
            Phase::Moving | Phase::Holding | Phase::Standstill => {
                (Phase::Holding, Some(self.goes_on_with(at_cycle, on_path)?))
            }
        };
        let motion = Self { phase, base, law: None, ..self.clone() };
        let spliced = self.spliced(at_cycle, motion, plan, None, beyond)?;
        Ok(Spliced { on_path, ..spliced })
    }

    /// What the plan keeps to until it rests, whatever is asked for after that.
    fn keeps(&self) -> Vec<AxisPlan> {
        self.plan().axes().iter().map(|axis| aim(axis, axis.goal, axis.limits.clone())).collect()
    }

    /// What a hold at `at_cycle` keeps to go on with; of a path that is left, the goals.
    pub(super) fn goes_on_with(&self, at_cycle: u64, on_path: bool) -> Result<Arc<Accepted>, Refused> {
        match &self.base {
            _ if !on_path || self.has_passed_any(at_cycle) => {
                aimed(self.plan(), &self.aims(at_cycle)).map(Arc::new)
            }
            Some(base) => Ok(Arc::clone(base)),
            None => Ok(Arc::clone(&self.plan)),
        }
    }
}
