use planner::{Accepted, Field, InvalidFields, Judged};
use proto::stream::Columns;
use proto::{Digest, Reason, Rejected, pb, plan_from_wire};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::Status;

/// Cycles in one message.
const CHUNK: u64 = 1000;
/// Messages made ahead of a slow reader.
const AHEAD: usize = 2;

/// A plan that is being read out.
pub(super) struct Sampling {
    plan: Accepted,
    first: u64,
    last: u64,
}

/// Says that what is wrong is wrong with the plan of the request.
pub(super) fn within_plan(inner: InvalidFields) -> InvalidFields {
    let mut invalid = InvalidFields::default();
    invalid.extend_within(&Field::named("plan"), inner);
    invalid
}

impl Sampling {
    pub(super) fn new(wire: pb::SamplePlanRequest, most: u64) -> Result<Self, Rejected> {
        let pb::SamplePlanRequest { plan, first_cycle: first, cycles } = wire;
        let plan = plan_from_wire(plan.unwrap_or_default()).map_err(within_plan)?;
        let plan = Judged::new(plan).accepted()?;
        let end = plan.plan().cycle_count();
        if first > end {
            let text = format!("first_cycle {first} is past {end}, the last cycle of the plan");
            let rejected = Rejected::new(Reason::ResumePastEnd, text);
            return Err(rejected.with("given", first).with("nearest", end));
        }
        let last = if cycles == 0 { end } else { end.min(first.saturating_add(cycles - 1)) };
        if last > most {
            let text = format!(
                "cycle {last} is past {most}, the farthest that is sampled: ask for fewer cycles, or evaluate the \
                 plan's segments where you are"
            );
            let rejected = Rejected::new(Reason::TooManyCycles, text);
            return Err(rejected.with("given", last).with("nearest", most));
        }
        Ok(Self { plan, first, last })
    }

    /// Sends chunk after chunk, as they are read.
    pub(super) fn stream(self) -> ReceiverStream<Result<pb::SamplePlanResponse, Status>> {
        let (sender, receiver) = mpsc::channel(AHEAD);
        tokio::spawn(async move { self.send_to(&sender).await });
        ReceiverStream::new(receiver)
    }

    async fn send_to(self, sender: &mpsc::Sender<Result<pb::SamplePlanResponse, Status>>) {
        let mut digest = Digest::ZERO;
        let mut from = 0;
        while from <= self.last {
            // The digest runs from cycle 1, whatever is asked for: chunks before the first are rolled and not sent.
            let bound = if from < self.first { self.first - 1 } else { self.last };
            let to = bound.min(from + CHUNK - 1);
            let columns = self.columns(from, to);
            digest = roll(digest, from, &columns);
            if from >= self.first {
                let response = pb::SamplePlanResponse {
                    first_cycle: from,
                    columns: Some(columns.into()),
                    digest: u64::from(digest),
                };
                if sender.send(Ok(response)).await.is_err() {
                    return;
                }
            } else if sender.is_closed() {
                return;
            } else {
                tokio::task::yield_now().await;
            }
            from = to + 1;
        }
    }

    fn columns(&self, from: u64, to: u64) -> Columns {
        let plan = self.plan.plan();
        let axes = plan.axes().len();
        let mut columns = Columns::with_capacity((to - from + 1) as usize, axes);
        let mut sampler = plan.sampler();
        for axis in 0..axes {
            sampler.columns(axis, from..to + 1, |setpoint| columns.push(setpoint));
        }
        columns
    }
}

/// The digest through the last of `columns`; cycle 0 is where the axis stands, and not in it.
fn roll(before: Digest, from: u64, columns: &Columns) -> Digest {
    let mut digest = before;
    for (index, cycle) in (0..columns.cycles()).zip(from..) {
        if cycle > 0 {
            digest = digest.then(cycle, columns.cycle(index).map(|setpoint| setpoint.words()));
        }
    }
    digest
}
