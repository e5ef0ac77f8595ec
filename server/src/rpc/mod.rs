//! The services. A handler translates, calls one function of the core, and translates back.

mod plan_pvt;
mod planner;
mod sample;
mod setpoints;

pub(crate) use planner::Planner;
pub(crate) use setpoints::Setpoints;

use proto::{Reason, Rejected};
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

/// What a later version will answer.
fn not_implemented(what: &str, instead: &str) -> Status {
    Rejected::new(Reason::NotImplemented, format!("{what} is not implemented: {instead}")).into()
}
