//! New goals, checked against the axes that there are.

use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::errand::Errand;
use super::leg::Turning;
use super::{AxisGoal, Kind, Motion, Phase, Refused, Spliced, aim, aimed};
use crate::error::{Field, InvalidFields, Why};
use crate::problem::note_not_finite;
use crate::{Accepted, AxisPlan, Limits, State, plan_between};

impl Motion {
    pub(super) fn retarget(
        &self,
        at_cycle: u64,
        phase: Phase,
        goals: &[AxisGoal],
    ) -> Result<Spliced, Refused> {
        let mut aims = self.aims(at_cycle);
        let mut kept = alloc::vec![true; aims.len()];
        let mut invalid = InvalidFields::default();
        for (index, asked) in goals.iter().enumerate() {
            let named_before = goals[..index].iter().any(|other| other.axis == asked.axis);
            let checked = place(&aims, asked, named_before).and_then(|place| {
                let limits = asked.limits.as_ref().unwrap_or(&aims[place].limits);
                reachable(asked.goal, limits).map(|()| (place, limits.clone()))
            });
            let (place, limits) = match checked {
                Ok(checked) => checked,
                Err(inner) => {
                    invalid.extend_within(&Field::element("goals", index), inner);
                    continue;
                }
            };
            let goal = asked.goal.with_positive_zeros();
            if goal != aims[place].goal || limits != aims[place].limits {
                kept[place] = false;
                aims[place] = aim(&aims[place], goal, limits);
            }
        }
        invalid.into_result(())?;
        if kept.iter().all(|&kept| kept) {
            return Ok(self.untouched(at_cycle));
        }
        if phase != Phase::Holding && !self.factor.rests() {
            if self.keeps_a_path() {
                return self.anew(at_cycle, &aims, self.clone());
            }
            return self.go(at_cycle, &aims, self.factor, Turning::Allowed, &kept);
        }
        self.reachable_from_rest(&aims, &kept)?;
        let base = Some(self.base_to(at_cycle, &aims)?);
        let phase = if phase == Phase::Holding { phase } else { Phase::Moving };
        Ok(self.noted(at_cycle, Self { phase, base, law: None, ..self.clone() }))
    }

    /// Aims to go on to from where the motion comes to rest; on its line, if it has one and is to be gone on with before that.
    fn base_to(&self, at_cycle: u64, aims: &[AxisPlan]) -> Result<Arc<Accepted>, Refused> {
        let errand = Errand::Goals { factor: self.factor, turning: Turning::Avoided, kept: &[] };
        let under_way = self.under_way(at_cycle, aims, errand);
        if Kind::of(self.plan()) == Kind::Line && !under_way.is_at_rest() {
            match self.line_to(&under_way) {
                // Those are gone to from rest, by a line of their own.
                Err(Refused::OffLine { .. }) => {}
                other => return other,
            }
        }
        Ok(Arc::new(aimed(self.plan(), aims)?))
    }

    /// Nothing moves yet, but what cannot be gone to is refused now and not when it is resumed.
    fn reachable_from_rest(&self, aims: &[AxisPlan], kept: &[bool]) -> Result<(), InvalidFields> {
        let mut invalid = InvalidFields::default();
        let axes = self.plan().axes().iter().zip(aims).zip(kept).enumerate();
        for (index, ((now, aim), _)) in axes.filter(|(_, (_, kept))| !**kept) {
            let planned = plan_between(now.profile.end(), aim.goal, &aim.limits.scaled(1.0));
            invalid.take(&Field::element("axes", index), planned);
        }
        invalid.into_result(())
    }
}

/// Which axis a goal is for.
fn place(aims: &[AxisPlan], asked: &AxisGoal, named_before: bool) -> Result<usize, InvalidFields> {
    let refuse = |why| InvalidFields::one(Field::named("axis"), why);
    let name = &asked.axis;
    if named_before {
        return Err(refuse(Why::DuplicateAxis { name: name.clone() }));
    }
    aims.iter().position(|aim| aim.axis == *name).ok_or_else(|| {
        let known: Vec<&str> = aims.iter().map(|aim| aim.axis.as_str()).collect();
        let known: String = known.join(", ");
        refuse(Why::UnknownAxis { name: name.clone(), known })
    })
}

/// Is a goal within limits?
fn reachable(goal: State, limits: &Limits) -> Result<(), InvalidFields> {
    let mut invalid = InvalidFields::default();
    note_not_finite(&mut invalid, &State::default(), &goal);
    let given = goal.position;
    let allowed = given.max(limits.min_position()).min(limits.max_position());
    if given > allowed {
        let why = Why::GoalOutsideLimits { given, allowed, limit: "limits.max_position" };
        invalid.note("goal.position", Some(why));
    } else if given < allowed {
        let why = Why::GoalOutsideLimits { given, allowed, limit: "limits.min_position" };
        invalid.note("goal.position", Some(why));
    }
    invalid.into_result(())?;
    if goal.is_at_rest() {
        return Ok(());
    }
    // The way from a goal to itself is refused for what is wrong with the goal alone.
    plan_between(goal, goal, &limits.scaled(1.0)).map(|_| ())
}
