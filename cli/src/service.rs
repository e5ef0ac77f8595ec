//! Who answers: the planner in this process, or one behind an endpoint.

use planner::{Accepted, Certificate, Judged, Limits, Plan, Request, RequestSpec, State};
use proto::stream::Columns;
use proto::{Digest, Reason, Rejected};

use crate::failure::Failure;

/// How many cycles are sampled at once.
const CHUNK_CYCLES: u64 = 1000;

/// A planner to ask.
pub(crate) enum Service {
    /// Here.
    InProcess,
}

/// Consecutive cycles of setpoints.
pub(crate) struct Chunk {
    pub(crate) first_cycle: u64,
    pub(crate) columns: Columns,
    /// Through the last of the cycles, from cycle 1 of the plan.
    pub(crate) digest: Digest,
}

impl Service {
    pub(crate) fn open(endpoint: Option<&str>) -> Result<Self, Failure> {
        match endpoint {
            None => Ok(Self::InProcess),
            Some(endpoint) => Err(Failure::Unreachable {
                endpoint: endpoint.to_owned(),
                cause: "this version plans in process only".to_owned(),
            }),
        }
    }

    pub(crate) fn plan(&mut self, spec: RequestSpec) -> Result<Judged, Failure> {
        match self {
            Self::InProcess => answer(spec).map_err(Failure::refused),
        }
    }

    /// Answers `each` request, in order. A request that is none, or that cannot be met, has its refusal for an answer.
    pub(crate) fn plan_all<T: Send>(
        &mut self,
        requests: &[T],
        read: impl Fn(&T) -> Result<RequestSpec, Rejected> + Sync,
        write: impl Fn(Result<Judged, Rejected>) -> String + Sync,
    ) -> Vec<String>
    where
        T: Sync,
    {
        match self {
            Self::InProcess => {
                let one = |request: &T| write(read(request).and_then(answer));
                let threads = std::thread::available_parallelism().map_or(1, usize::from);
                let share = requests.len().div_ceil(threads).max(LEAST_SHARE);
                let shares = requests.chunks(share);
                let (one, mut answers) = (&one, Vec::with_capacity(requests.len()));
                std::thread::scope(|scope| {
                    let mut shares = shares.into_iter();
                    let mine = shares.next().unwrap_or_default();
                    let others: Vec<_> = shares
                        .map(|share| scope.spawn(move || share.iter().map(one).collect::<Vec<_>>()))
                        .collect();
                    answers.extend(mine.iter().map(one));
                    for other in others {
                        match other.join() {
                            Ok(theirs) => answers.extend(theirs),
                            Err(panic) => std::panic::resume_unwind(panic),
                        }
                    }
                });
                answers
            }
        }
    }

    pub(crate) fn verify(
        &mut self,
        plan: &Plan,
        against: Option<&[(Limits, State)]>,
    ) -> Result<Certificate, Failure> {
        match self {
            Self::InProcess => Ok(match against {
                None => planner::certify(plan),
                Some(pairs) => {
                    planner::certify_against(plan, pairs.iter().map(|(limits, goal)| (limits, *goal)))
                }
            }),
        }
    }

    /// Samples `cycles` cycles from `first_cycle` on, or to the end of the plan for 0, and hands them to `put`.
    pub(crate) fn sample(
        &mut self,
        plan: Plan,
        first_cycle: u64,
        cycles: u64,
        put: &mut dyn FnMut(Chunk) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        match self {
            Self::InProcess => sample(plan, first_cycle, cycles, put),
        }
    }
}

/// The fewest requests that are worth a thread.
const LEAST_SHARE: usize = 32;

fn answer(spec: RequestSpec) -> Result<Judged, Rejected> {
    let request = Request::try_from(spec)?;
    Ok(Judged::answer(&request)?)
}

fn sample(
    plan: Plan,
    first_cycle: u64,
    cycles: u64,
    put: &mut dyn FnMut(Chunk) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let accepted: Accepted = Judged::new(plan).accepted().map_err(Failure::refused)?;
    let plan = accepted.plan();
    let last_cycle = plan.cycle_count();
    if first_cycle > last_cycle {
        let message = format!("cycle {first_cycle} is past the end: the plan has cycles 0 to {last_cycle}");
        let rejected = Rejected::new(Reason::ResumePastEnd, message);
        return Err(Failure::refused(rejected.with("given", first_cycle).with("nearest", last_cycle)));
    }
    let end = match cycles {
        0 => last_cycle + 1,
        cycles => first_cycle.saturating_add(cycles).min(last_cycle + 1),
    };
    let mut sampler = plan.sampler();
    // The digest is of every cycle from 1 on, wherever printing begins.
    let mut digest = Digest::ZERO;
    for cycle in 1..first_cycle {
        digest = digest.then(cycle, sampler.at(cycle).map(|setpoint| setpoint.words()));
    }
    let mut next = first_cycle;
    while next < end {
        let chunk = next..end.min(next + CHUNK_CYCLES);
        let mut columns = Columns::with_capacity((chunk.end - chunk.start) as usize, plan.axes().len());
        for axis in 0..plan.axes().len() {
            sampler.columns(axis, chunk.clone(), |setpoint| columns.push(setpoint));
        }
        for (index, cycle) in (0..columns.cycles()).zip(chunk.clone()).filter(|(_, cycle)| *cycle > 0) {
            digest = digest.then(cycle, columns.cycle(index).map(|setpoint| setpoint.words()));
        }
        put(Chunk { first_cycle: next, columns, digest })?;
        next = chunk.end;
    }
    Ok(())
}
