use proto::{Chunk, Reason, Rejected, Sampling, accepted_in, pb};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::Status;

/// Messages made ahead of a slow reader.
const AHEAD: usize = 2;

type Outgoing = mpsc::Sender<Result<pb::SamplePlanResponse, Status>>;

/// The plan of a request, ready to be read out; its last cycle is at most `most`.
pub(super) fn sampling(wire: pb::SamplePlanRequest, most: u64) -> Result<Sampling, Rejected> {
    let pb::SamplePlanRequest { plan, first_cycle, cycles } = wire;
    let sampling = Sampling::new(accepted_in("plan", plan)?, first_cycle, cycles)?;
    let last = sampling.last_cycle();
    if last > most {
        let text = format!(
            "cycle {last} is past {most}, the farthest that is sampled: ask for fewer cycles, or evaluate the plan's \
             segments where you are"
        );
        let rejected = Rejected::new(Reason::TooManyCycles, text);
        return Err(rejected.with("given", last).with("allowed", most));
    }
    Ok(sampling)
}

/// Sends chunk after chunk, as they are read.
pub(super) fn stream(sampling: Sampling) -> ReceiverStream<Result<pb::SamplePlanResponse, Status>> {
    let (sender, receiver) = mpsc::channel(AHEAD);
    tokio::spawn(async move { send(sampling, &sender).await });
    ReceiverStream::new(receiver)
}

async fn send(mut sampling: Sampling, sender: &Outgoing) {
    while !sampling.is_over() && !sender.is_closed() {
        match sampling.read() {
            Some(Chunk { first_cycle, columns, digest }) => {
                let (columns, digest) = (Some(columns.into()), u64::from(digest));
                let response = pb::SamplePlanResponse { first_cycle, columns, digest };
                if sender.send(Ok(response)).await.is_err() {
                    return;
                }
            }
            // A long way to the first cycle is not to hold up the streams of this process.
            None => tokio::task::yield_now().await,
        }
    }
}
