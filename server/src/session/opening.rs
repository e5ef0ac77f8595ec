//! What a stream begins with: a new plan, or a motion under way that another server has served until now.

use planner::Quantity;
use proto::stream::{Motion, Open, Phase, Resume, Source};
use proto::{Digest, Reason, Rejected};

use super::branch::Branch;
use super::credit::Credit;

/// A stream as it is opened, checked.
#[derive(Debug)]
pub(super) struct Opening {
    pub(super) branch: Branch,
    pub(super) credit: Credit,
    /// The first cycle that will be sent.
    pub(super) first_cycle: u64,
}

impl Opening {
    pub(super) fn of(open: Open) -> Result<Self, Rejected> {
        let Open { lead_cycles, close_at_rest, accept_unproved, executed_cycle, source, .. } = open;
        let lead = u64::from(lead_cycles);
        match source {
            Source::Plan(plan) => {
                if executed_cycle != 0 {
                    let text =
                        format!("is {executed_cycle}: a stream that opens with a plan begins at cycle 0");
                    return Err(Rejected::for_field("open.executed_cycle", Reason::ValueOutOfRange, text));
                }
                proved("open.plan", plan.plan(), accept_unproved)?;
                let motion =
                    planner::motion::Motion::open(plan).map(Motion::opened).map_err(
                        |refused| match refused {
                            planner::motion::Refused::Invalid(invalid) => proto::within("open.plan", invalid),
                            other => other.into(),
                        },
                    )?;
                Ok(Self { branch: Branch::opened(motion), credit: Credit::first(lead), first_cycle: 1 })
            }
            Source::Resume(resume) => {
                proved("open.resume.motion.plan", resume.motion.plan(), accept_unproved)?;
                check_cycles(&resume, executed_cycle, lead, close_at_rest)?;
                check_digest(&resume)?;
                let Resume { motion, next_cycle, digest, checkpoint_cycle, checkpoint_digest } = *resume;
                let (known, held) = (checkpoint_cycle.saturating_sub(1), next_cycle - 1);
                Ok(Self {
                    branch: Branch::resumed(motion, (known, checkpoint_digest), (held, digest)),
                    credit: Credit::resumed(executed_cycle, held, lead),
                    first_cycle: next_cycle,
                })
            }
        }
    }
}

fn proved(field: &str, plan: &planner::Plan, accept_unproved: bool) -> Result<(), Rejected> {
    if accept_unproved || (plan.guarantees(Quantity::Velocity) && plan.guarantees(Quantity::Acceleration)) {
        return Ok(());
    }
    let text = "the plan does not guarantee velocity and acceleration: plan with a family that does, or set \
                accept_unproved";
    Err(Rejected::for_field(field, Reason::NotProved, text))
}

/// Can an axis hold the motion so far?
fn check_cycles(resume: &Resume, executed: u64, lead: u64, close_at_rest: bool) -> Result<(), Rejected> {
    let Resume { motion, next_cycle, .. } = resume;
    let (held, last) = (next_cycle - 1, motion.last_cycle());
    if executed > held {
        let text = format!("is {executed}: an axis executes what it holds, up to cycle {held}");
        let rejected = Rejected::for_field("open.executed_cycle", Reason::ValueOutOfRange, text);
        return Err(rejected.with("given", executed).with("nearest", held));
    }
    // What closes at rest ends there, and an axis that holds the end needs nobody to go on.
    let ends = close_at_rest && motion.under_way.phase_at(last) == Phase::Standstill;
    if ends && held > last {
        let text = format!(
            "open.resume.next_cycle: is {next_cycle}, and the motion closes at rest at cycle {last}: open a stream with a new \
             plan"
        );
        let rejected = Rejected::new(Reason::ResumePastEnd, text);
        return Err(rejected.with("given", next_cycle).with("nearest", last + 1));
    }
    // A way to rest counts as held as soon as it is begun, however long it is.
    let comes_to_rest = matches!(motion.under_way.phase(), Phase::Holding | Phase::Stopping);
    let granted = executed.saturating_add(lead);
    let farthest = if comes_to_rest { granted.max(last) } else { granted };
    if held > farthest {
        let nearest = farthest + 1;
        let text = format!(
            "is {next_cycle}: an axis that has executed {executed} holds {lead} cycles at most, so give {nearest} or less"
        );
        let rejected = Rejected::for_field("open.resume.next_cycle", Reason::ValueOutOfRange, text);
        return Err(rejected.with("given", next_cycle).with("nearest", nearest));
    }
    Ok(())
}

fn check_digest(resume: &Resume) -> Result<(), Rejected> {
    let (ours, cycle): (Digest, u64) = (resume.recomputed(), resume.next_cycle - 1);
    if ours == resume.digest {
        return Ok(());
    }
    let text = format!(
        "the setpoints through cycle {cycle} have digest {} at the axis and {ours} here: let it come to rest, and open with \
         what it has played then",
        resume.digest
    );
    Err(Rejected::new(Reason::DigestMismatch, text).with("cycle", cycle))
}
