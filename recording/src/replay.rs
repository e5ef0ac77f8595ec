use planner::motion::Motion;
use planner::{Judged, Plan, Quantity, Setpoint};
use proto::{Reason, Rejected, plan_request_from_wire, plan_to_wire};

use crate::{Beginning, Recording};

/// What came of playing a recording again.
#[derive(Clone, Debug, PartialEq)]
pub struct Replayed {
    /// How many setpoints were compared: one for each axis and cycle.
    pub compared: usize,
    /// How many setpoints could not be: of cycles before the motion begins that the recording begins with.
    pub before: usize,
    /// Was the request planned again?
    pub planned: bool,
    /// Where it first differs; `None`: nowhere.
    pub difference: Option<Difference>,
}

/// Where what is played again first differs from what was recorded.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// The request gives another plan now.
    Plan {
        /// The fingerprints, as recorded and now, in hexadecimal.
        fingerprints: [String; 2],
    },
    /// A setpoint has other bits.
    Setpoint {
        /// Of the stream.
        cycle: u64,
        /// Name of the axis.
        axis: String,
        /// Which of its numbers.
        quantity: Quantity,
        /// As recorded, and now.
        values: [f64; 2],
    },
}

/// Plans again what was asked, does again what was done to it at the cycles at which it took effect, and compares every
/// setpoint, bit for bit. What was taken over from another server is played from the motion that it went on with. Needs neither server nor axis: a setpoint depends on plan, operations and cycle alone.
///
/// # Errors
/// A plan that the judge rejects, and an operation that is refused now.
pub fn replay(recording: &Recording) -> Result<Replayed, Rejected> {
    let Recording { request, beginning, operations, cycles, .. } = recording;
    let mut replayed = Replayed { compared: 0, before: 0, planned: false, difference: None };
    if let (Some(request), Beginning::Plan(plan)) = (request, beginning) {
        replayed.planned = true;
        let again = Judged::answer(&plan_request_from_wire(request.clone())?)?;
        let prints = [fingerprint(plan), fingerprint(again.plan())];
        if prints[0] != prints[1] {
            let fingerprints = prints.map(|print| print.iter().map(|byte| format!("{byte:02x}")).collect());
            replayed.difference = Some(Difference::Plan { fingerprints });
            return Ok(replayed);
        }
    }
    let mut motion = match beginning {
        Beginning::Plan(plan) => Motion::open(proto::accepted("plan", plan.clone())?).map_err(refused)?,
        Beginning::Motion(motion) => motion.under_way.clone(),
    };
    let from = motion.from_cycle();
    let mut done = operations.iter().peekable();
    for (&cycle, recorded) in cycles {
        if cycle < from {
            replayed.before += recorded.len();
            continue;
        }
        while let Some((operation, result)) = done.next_if(|(_, result)| result.effective_cycle <= cycle) {
            motion = motion.splice(result.effective_cycle, &operation.planned()?).map_err(refused)?.motion;
        }
        for ((axis, &recorded), now) in motion.plan().axes().iter().zip(recorded).zip(motion.setpoints(cycle))
        {
            replayed.compared += 1;
            if let Some((quantity, values)) = first_difference(recorded, now) {
                let axis = axis.axis.clone();
                replayed.difference = Some(Difference::Setpoint { cycle, axis, quantity, values });
                return Ok(replayed);
            }
        }
    }
    Ok(replayed)
}

fn first_difference(recorded: Setpoint, now: Setpoint) -> Option<(Quantity, [f64; 2])> {
    let pairs = recorded.words().into_iter().zip(now.words());
    // The wire does not carry the sign of a zero.
    let same = |(a, b): &(f64, f64)| a.to_bits() == b.to_bits() || (*a == 0.0 && *b == 0.0);
    let differs = pairs.enumerate().find(|(_, pair)| !same(pair));
    differs.map(|(word, (a, b))| (Quantity::BY_ORDER[word], [a, b]))
}

fn fingerprint(plan: &Plan) -> Vec<u8> {
    plan_to_wire(&Judged::new(plan.clone())).fingerprint
}

fn refused(cause: planner::motion::Refused) -> Rejected {
    Rejected::new(Reason::PlanRejected, format!("what was done then is refused now: {cause}"))
}
