//! The services. A handler translates, calls one function of the core, and translates back.

mod plan_pvt;
mod planner;
mod sample;
mod setpoints;

pub(crate) use planner::Planner;
pub(crate) use setpoints::Setpoints;

use proto::Rejected;
use tonic::Status;

/// Does work that takes long where nobody waits for it: the streams of this process go on.
async fn aside<T: Send + 'static>(
    work: impl FnOnce() -> Result<T, Rejected> + Send + 'static,
) -> Result<T, Status> {
    match tokio::task::spawn_blocking(work).await {
        Ok(done) => done.map_err(Status::from),
        Err(error) => Err(Status::internal(error.to_string())),
    }
}
