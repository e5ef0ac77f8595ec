use planner::Plan;
use proto::Digest;
use proto::stream::{Motion, Phase};

use crate::JoinRule;

/// What an axis has to know of a motion to accept its setpoints.
///
/// Made where there is time for it: a cycle thread takes it over as it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Revision {
    pub(crate) number: u64,
    pub(crate) from_cycle: u64,
    pub(crate) digest_before: Digest,
    /// The cycle from which the motion is at rest.
    pub(crate) motion_end: u64,
    /// Is that the end of what was asked for, and not a hold?
    pub(crate) arrives: bool,
    pub(crate) rules: Vec<JoinRule>,
}

impl Revision {
    /// Of a motion that the server has announced.
    #[must_use]
    pub fn of(motion: &Motion) -> Self {
        Self {
            number: motion.revision(),
            from_cycle: motion.under_way.from_cycle(),
            digest_before: motion.digest_before,
            motion_end: motion.last_cycle(),
            arrives: match motion.under_way.phase_at(motion.last_cycle()) {
                Phase::Standstill | Phase::Finished => true,
                Phase::Moving | Phase::Holding | Phase::Stopping => false,
            },
            rules: JoinRule::of(motion.plan()),
        }
    }

    /// Of a plan that a stream opens with.
    pub(crate) fn opened(plan: &Plan) -> Self {
        let rules = JoinRule::of(plan);
        let (digest_before, motion_end) = (Digest::ZERO, u64::MAX);
        Self { number: 0, from_cycle: 0, digest_before, motion_end, arrives: true, rules }
    }

    /// May this revision begin with a batch at `first_cycle`, after `adopted`? At its own first cycle; or anywhere, where it
    /// has the setpoints of the one before it.
    pub(crate) fn begins_at(&self, first_cycle: u64, adopted: &Self) -> bool {
        first_cycle == self.from_cycle || self.from_cycle == adopted.from_cycle
    }
}
