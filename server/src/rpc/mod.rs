//! The services. A handler translates, calls one function of the core, and translates back.

mod plan_many;
mod plan_pvt;
mod planner;
mod sample;
mod setpoints;

pub(crate) use planner::Planner;
pub(crate) use setpoints::Setpoints;

use std::sync::Arc;
use std::time::Duration;

use proto::{Reason, Rejected};
use tokio::sync::Semaphore;
use tonic::Status;

/// Why a stream gives no further message: what the layers around it say, or that its bytes are none.
pub(crate) fn unreadable(status: &Status) -> Rejected {
    Rejected::from_status(status).unwrap_or_else(|| {
        let text = format!("the message cannot be read: {}; compare with the schema", status.message());
        Rejected::new(Reason::MessageInvalid, text)
    })
}

/// Where work is done that takes long, and nobody waits for it: the streams of this process go on.
#[derive(Clone, Debug)]
struct Aside {
    places: Arc<Semaphore>,
}

impl Aside {
    /// With a place for each core: more would take their time from the streams, and finish no sooner.
    fn new() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        Self { places: Arc::new(Semaphore::new(cores)) }
    }

    /// Does `work`, or says that too much of it waits.
    async fn run<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> Result<T, Rejected> + Send + 'static,
    ) -> Result<T, Status> {
        let place = tokio::time::timeout(PATIENCE, Arc::clone(&self.places).acquire_owned());
        let Ok(Ok(place)) = place.await else { return Err(overloaded().into()) };
        let work = move || {
            let done = work();
            drop(place);
            done
        };
        match tokio::task::spawn_blocking(work).await {
            Ok(done) => done.map_err(Status::from),
            Err(error) => Err(Status::internal(error.to_string())),
        }
    }
}

/// How long work may wait for a place: callers that wait longer are served sooner elsewhere.
const PATIENCE: Duration = Duration::from_secs(1);

fn overloaded() -> Rejected {
    let text = format!(
        "every core has worked on large requests for {} s: ask again after the time that is named, or ask another replica",
        PATIENCE.as_secs_f64()
    );
    Rejected::new(Reason::Overloaded, text).with("limit", "cores").retry_after(PATIENCE)
}
