//! What each operation does in each phase.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::errand::{Errand, UnderWay, binds, has_passed};
use super::leg::Turning;
use super::prove::{Beyond, Proved};
use super::{Kind, Motion, Operation, Override, Phase, Refused, Spliced, aimed, each, line};
use crate::error::{Field, InvalidFields, Why};
use crate::{Accepted, AxisPlan, LAST_CYCLE};

impl Motion {
    /// What becomes of the motion when `operation` takes effect at `at_cycle`. Which bits come of it depends on the motion, the cycle and
    /// the operation alone.
    ///
    /// # Errors
    /// See [`Refused`]: each says what would do. Nothing has changed then.
    pub fn splice(&self, at_cycle: u64, operation: &Operation) -> Result<Spliced, Refused> {
        if at_cycle < self.from_cycle {
            return Err(Refused::BeforeMotion { given: at_cycle, first: self.from_cycle });
        }
        let phase = self.phase_at(at_cycle);
        match (phase, operation) {
            (Phase::Stopping | Phase::Finished, Operation::Stop)
            | (Phase::Holding, Operation::Hold)
            | (Phase::Moving | Phase::Standstill, Operation::Resume) => Ok(self.untouched(at_cycle)),
            (Phase::Finished, _) => Err(Refused::StreamFinished),
            (Phase::Stopping, _) => Err(Refused::Stopped { rest_cycle: self.last_cycle() }),
            (Phase::Standstill, Operation::Stop) => {
                Ok(self
                    .noted(at_cycle, Self { phase: Phase::Finished, base: None, law: None, ..self.clone() }))
            }
            (Phase::Moving | Phase::Holding, Operation::Stop) => self.stop(at_cycle),
            (Phase::Moving | Phase::Standstill, Operation::Hold) => {
                self.rest(at_cycle, Phase::Holding, self.factor)
            }
            (Phase::Holding, Operation::Resume) if self.factor.rests() => {
                Ok(self.noted(at_cycle, Self { phase: Phase::Moving, ..self.clone() }))
            }
            (Phase::Holding, Operation::Resume) => self.go_on(at_cycle, self.factor),
            (_, Operation::Override(factor)) => self.override_by(at_cycle, phase, *factor),
            (_, Operation::Append(points)) => self.append(at_cycle, phase, points),
            (_, Operation::Retarget(goals)) => self.retarget(at_cycle, phase, goals),
        }
    }

    fn override_by(&self, at_cycle: u64, phase: Phase, factor: Override) -> Result<Spliced, Refused> {
        let greatest = Override::greatest(self.asked().axes().iter().map(|axis| &axis.limits));
        if factor.get() > greatest {
            return Err(Refused::OverrideOutOfRange { given: factor.get(), greatest });
        }
        if factor == self.factor {
            return Ok(self.untouched(at_cycle));
        }
        match phase {
            Phase::Moving if factor.rests() => self.rest(at_cycle, phase, factor),
            Phase::Moving if self.is_paused() => self.go_on(at_cycle, factor),
            Phase::Moving if self.keeps_a_path() => {
                self.at_rate(at_cycle, factor.get(), Self { factor, ..self.clone() })
            }
            Phase::Moving => {
                let (at, aims) = (self.time_of(at_cycle), self.aims(at_cycle));
                let axes = self.plan().axes().iter().zip(&aims);
                let kept: Vec<bool> = axes
                    .map(|(axis, aim)| {
                        has_passed(axis, at) || !binds(axis, &aim.limits, at, [self.factor, factor])
                    })
                    .collect();
                self.go(at_cycle, &aims, factor, Turning::Never, &kept)
            }
            Phase::Holding | Phase::Standstill | Phase::Stopping | Phase::Finished => {
                Ok(self.noted(at_cycle, Self { phase, factor, ..self.clone() }))
            }
        }
    }

    /// Goes on from rest, or from the way to it, to what is held.
    fn go_on(&self, at_cycle: u64, factor: Override) -> Result<Spliced, Refused> {
        if self.keeps_a_path() {
            let motion = Self { factor, phase: Phase::Moving, ..self.clone() };
            return self.at_rate(at_cycle, factor.get(), motion);
        }
        let aims = self.aims(at_cycle);
        let kept = alloc::vec![false; aims.len()];
        self.go(at_cycle, &aims, factor, Turning::Avoided, &kept)
    }

    /// Goes to `aims`; axes that are `kept` may go on as they do.
    pub(super) fn go(
        &self,
        at_cycle: u64,
        aims: &[AxisPlan],
        factor: Override,
        turning: Turning,
        kept: &[bool],
    ) -> Result<Spliced, Refused> {
        let under_way = self.under_way(at_cycle, aims, Errand::Goals { factor, turning, kept });
        let motion = Self { factor, phase: Phase::Moving, ..self.clone() };
        let Some(planned) = self.planned(&under_way)? else { return Ok(self.noted(at_cycle, motion)) };
        let Proved { plan, beyond } = planned.proved;
        let base = match Kind::of(self.plan()) {
            Kind::Line if !under_way.is_at_rest() => Some(self.line_to(&under_way)?),
            Kind::Each | Kind::Line | Kind::Path if beyond.is_empty() => None,
            Kind::Each | Kind::Line | Kind::Path => Some(Arc::new(aimed(self.plan(), aims)?)),
        };
        self.spliced(at_cycle, Self { base, ..motion }, plan, planned.closes, beyond)
    }

    /// Comes to rest with something to go on with.
    fn rest(&self, at_cycle: u64, phase: Phase, factor: Override) -> Result<Spliced, Refused> {
        if self.keeps_a_path() {
            return self.at_rate(at_cycle, 0.0, Self { factor, phase, ..self.clone() });
        }
        let aims = self.aims(at_cycle);
        let base = Some(self.goes_on_with(at_cycle, true)?);
        let motion = Self { factor, phase, base, ..self.clone() };
        if self.rests_by(at_cycle) {
            return Ok(self.noted(at_cycle, motion));
        }
        self.to_rest(at_cycle, &aims, motion)
    }

    fn stop(&self, at_cycle: u64) -> Result<Spliced, Refused> {
        let motion = Self { phase: Phase::Stopping, base: None, law: None, ..self.clone() };
        if self.rests_by(at_cycle) {
            return Ok(self.noted(at_cycle, motion));
        }
        let aims = self.aims(at_cycle);
        match Kind::of(self.plan()) {
            Kind::Each | Kind::Line => self.to_rest(at_cycle, &aims, motion),
            Kind::Path => self.rest_beside(at_cycle, &aims, motion),
        }
    }

    fn to_rest(&self, at_cycle: u64, aims: &[AxisPlan], motion: Self) -> Result<Spliced, Refused> {
        let under_way = self.under_way(at_cycle, aims, Errand::Rest);
        let Some(planned) = self.planned(&under_way)? else { return Ok(self.noted(at_cycle, motion)) };
        let Proved { plan, beyond } = planned.proved;
        self.spliced(at_cycle, motion, plan, None, beyond)
    }

    /// The one place where the kinds of motion part. A path that is no straight line is re-timed before it comes here; where it is left,
    /// its axes go each their own way.
    fn planned(&self, under_way: &UnderWay<'_>) -> Result<Option<each::Planned>, Refused> {
        match Kind::of(under_way.plan) {
            Kind::Each | Kind::Path => each::planned(under_way),
            Kind::Line => line::planned(under_way, self.asked()),
        }
    }

    /// A plan along the line that the axes keep, to the goals of `under_way`.
    pub(super) fn line_to(&self, under_way: &UnderWay<'_>) -> Result<Arc<Accepted>, Refused> {
        let known = self.base.as_ref().unwrap_or(&self.plan);
        let mut axes = known.plan().axes().iter().zip(under_way.aims);
        let same = axes.all(|(axis, aim)| axis.goal == aim.goal && axis.limits == aim.limits);
        let drawn = known.plan().axes().iter().any(|axis| !axis.profile.segments().is_empty());
        if same && drawn {
            return Ok(Arc::clone(known));
        }
        line::drawn_to(under_way, known.plan()).map(Arc::new)
    }

    /// Nothing has changed.
    pub(super) fn untouched(&self, at_cycle: u64) -> Spliced {
        Spliced {
            motion: self.clone(),
            effective_cycle: at_cycle,
            rest_cycle: self.last_cycle(),
            on_path: true,
            changes: false,
            beyond: Vec::new(),
        }
    }

    /// The motion has changed, and no setpoint has.
    pub(super) fn noted(&self, at_cycle: u64, motion: Self) -> Spliced {
        Spliced { motion: Self { revision: self.revision + 1, ..motion }, ..self.untouched(at_cycle) }
    }

    /// `plan` from `at_cycle` on; its last goal that is passed at speed is after `closes` seconds.
    pub(super) fn spliced(
        &self,
        at_cycle: u64,
        motion: Self,
        plan: Accepted,
        closes: Option<f64>,
        beyond: Vec<Beyond>,
    ) -> Result<Spliced, Refused> {
        let seconds = plan.plan().duration();
        let cycle_time = plan.plan().cycle_time();
        let rest_cycle = at_cycle.saturating_add(plan.plan().cycle_count());
        if rest_cycle > LAST_CYCLE {
            return Err(InvalidFields::one(Field::default(), Why::TooManyCycles { seconds }).into());
        }
        let closing_from_cycle =
            closes.and_then(|seconds| cycle_time.count(seconds)).map(|count| at_cycle + count);
        let changes = at_cycle < self.last_cycle() || plan.plan().cycle_count() > 0;
        let motion = Self {
            revision: self.revision + 1,
            from_cycle: at_cycle,
            plan: Arc::new(plan),
            closing_from_cycle,
            ..motion
        };
        Ok(Spliced { motion, effective_cycle: at_cycle, rest_cycle, on_path: true, changes, beyond })
    }
}
