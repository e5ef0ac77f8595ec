//! A motion as it travels.

use alloc::sync::Arc;
use alloc::vec::Vec;

use super::{InvalidMotion, Motion, Override, Phase, path};
use crate::{Accepted, LAST_CYCLE, Plan, TimeLaw};

/// The parts of a motion, as a peer sends them.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionParts {
    /// 0 when it was opened; one more with every operation that changed it.
    pub revision: u64,
    /// The cycle at which the plan's time is zero.
    pub from_cycle: u64,
    /// What is being played.
    pub plan: Accepted,
    /// Of the feed rate.
    pub factor: Override,
    /// What it was doing when it was last changed.
    pub phase: Phase,
    /// What is to be gone on with, where that is not the plan itself: see [`Motion::base`].
    pub base: Option<Accepted>,
    /// How time goes on in the base, from `from_cycle` on, where that is a path that is re-timed: see [`Motion::base_time`].
    pub base_time: Option<TimeLaw>,
    /// The cycle at which the closing stop begins.
    pub closing_from_cycle: Option<u64>,
}

impl TryFrom<MotionParts> for Motion {
    type Error = InvalidMotion;

    fn try_from(parts: MotionParts) -> Result<Self, InvalidMotion> {
        let MotionParts { revision, from_cycle, plan, factor, phase, base, base_time, closing_from_cycle } =
            parts;
        let at_speed = plan.plan().axes().iter().find(|axis| !axis.profile.end().is_at_rest());
        if let Some(axis) = at_speed {
            let velocity = axis.profile.end().velocity;
            return Err(InvalidMotion::EndsAtSpeed { axis: axis.axis.clone(), velocity });
        }
        let cycle_count = plan.plan().cycle_count();
        let last = from_cycle.checked_add(cycle_count).filter(|&last| last <= LAST_CYCLE);
        let last = last.ok_or(InvalidMotion::TooManyCycles { from_cycle, cycle_count })?;
        if phase == Phase::Holding && base.is_none() {
            return Err(InvalidMotion::BaseMissing);
        }
        if base.as_ref().is_some_and(|base| !same_axes(base.plan(), plan.plan())) {
            return Err(InvalidMotion::BaseDiffers);
        }
        if let Some(law) = &base_time {
            let base = base.as_ref().ok_or(InvalidMotion::BaseTimeAlone)?;
            if !path::follows(plan.plan(), base.plan(), law) {
                return Err(InvalidMotion::OffBase);
            }
        }
        if let Some(given) = closing_from_cycle.filter(|given| !(from_cycle..=last).contains(given)) {
            return Err(InvalidMotion::ClosingOutside { given, first: from_cycle, last });
        }
        let (plan, base, law) = (Arc::new(plan), base.map(Arc::new), base_time.map(Arc::new));
        Ok(Self { revision, from_cycle, plan, factor, phase, base, law, closing_from_cycle })
    }
}

fn same_axes(one: &Plan, other: &Plan) -> bool {
    let names =
        |plan: &Plan| plan.axes().iter().map(|axis| (axis.axis.clone(), axis.kind)).collect::<Vec<_>>();
    one.cycle_time() == other.cycle_time() && names(one) == names(other)
}
