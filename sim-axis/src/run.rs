//! One tracking run: one stream, its axes, and whoever looks on.

mod carry;
mod report;
mod request;

use client::failover::{Begun, Failure, News};
use client::{Buffer, Next, Standing, Uplink};
use planner::Setpoint;
use proto::TraceContext;
use proto::stream::{Motion, Open, Operation};
use tokio::sync::{mpsc, oneshot};
use tracing::Instrument as _;

use crate::axis::Axis;
use crate::commands::{Answered, Commander, Waiting, commander};
use crate::cycle_thread::spawn;
use crate::faults::Faults;
use crate::player::Player;
use carry::carry;
pub use report::{StreamReport, TrackError, TrackingReport, Update};
pub use request::{DEFAULT_SETTLE_WINDOW, TrackRequest, default_settle_tolerance};
use request::{axes, open_of};

/// A run that has begun. Dropping it ends the run.
#[derive(Debug)]
pub struct Tracking {
    motion: Motion,
    served_by: String,
    commander: Commander,
    updates: mpsc::Receiver<Update>,
    result: oneshot::Receiver<Result<TrackingReport, TrackError>>,
}

/// Runs to the end, and gives every update to `on_update`.
///
/// # Errors
/// Those of [`Tracking::begin`] and [`Tracking::finish`].
pub async fn track(
    request: TrackRequest,
    mut on_update: impl FnMut(Update),
) -> Result<TrackingReport, TrackError> {
    let mut tracking = Tracking::begin(request).await?;
    while let Some(update) = tracking.next().await {
        on_update(update);
    }
    tracking.finish().await
}

impl Tracking {
    /// Opens the stream and lets the axes follow it.
    ///
    /// # Errors
    /// A request that cannot be run, before anything is opened; a stream that no planner opens.
    pub async fn begin(request: TrackRequest) -> Result<Self, TrackError> {
        Self::begin_with(request, Vec::new()).await.map(|(tracking, _)| tracking)
    }

    /// The same, with operations that the server knows before the first cycle is played; what becomes of each is told in turn.
    ///
    /// # Errors
    /// Those of [`Tracking::begin`].
    pub async fn begin_with(
        request: TrackRequest,
        operations: Vec<Operation>,
    ) -> Result<(Self, Vec<Answered>), TrackError> {
        let axes = axes(&request)?;
        let open = open_of(&request);
        let cycle = request.plan.plan().cycle_time();
        let mut uplink = Uplink::new(request.servers(), open.clone(), cycle);
        let Begun { motion, served_by } = opened(&mut uplink).await?;
        let player = player(&open, axes, &motion, &uplink);
        let (commander, commands) = commander();
        let outside = spawn(player, cycle, request.clock).map_err(|e| TrackError::Thread(e.to_string()))?;
        let (teller, updates) = mpsc::channel(UPDATES);
        let (done, result) = oneshot::channel();
        let waiting = Waiting::default();
        let ailing = request.faults.as_ref().map(Faults::of_a_run).unwrap_or_default();
        let mut answers = Vec::with_capacity(operations.len());
        let asked = operations.iter().cloned().collect();
        for operation in operations {
            answers.push(waiting.answered(&operation.request_id));
            uplink.operate(operation);
        }
        // For the trace of whoever asked for the run, also where another server goes on.
        let carried = TraceContext::carried(async move {
            let result =
                carry(uplink, outside, teller, (request.clock, ailing), (commands, waiting, asked)).await;
            // Nobody to tell is not a failure.
            let _ = done.send(result);
        });
        tokio::spawn(carried.in_current_span());
        Ok((Self { motion, served_by, commander, updates, result }, answers))
    }

    /// The motion as it was opened, with the closing stop of a plan that ends at speed.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Who serves the stream.
    #[must_use]
    pub fn served_by(&self) -> &str {
        &self.served_by
    }

    /// Asks for operations on the motion.
    #[must_use]
    pub fn commander(&self) -> Commander {
        self.commander.clone()
    }

    /// What happens next; `None` when there is no more than the report.
    ///
    /// A run by the wall clock waits for nobody: who reads too slowly loses the oldest samples. In virtual time the run
    /// waits for its reader, so that all of them arrive.
    pub async fn next(&mut self) -> Option<Update> {
        self.updates.recv().await
    }

    /// How the run went. Reads what is left to read.
    ///
    /// # Errors
    /// [`TrackError::Broken`] for a stream that ended too early and [`TrackError::Diverged`] for an axis that did not follow,
    /// with the report until there.
    pub async fn finish(mut self) -> Result<TrackingReport, TrackError> {
        while self.next().await.is_some() {}
        let gone = || Err(TrackError::Thread("its task has ended without a word".into()));
        self.result.await.unwrap_or_else(|_| gone())
    }
}

/// Updates that were handed over and not read.
const UPDATES: usize = 4;

/// Waits until one planner has opened the stream, or all have been asked.
async fn opened(uplink: &mut Uplink) -> Result<Begun, TrackError> {
    loop {
        match uplink.next().await {
            Next::News(News::Opened(opened)) => return Ok(*opened),
            Next::News(News::Over(Err(Failure { endpoint, cause }))) => {
                let endpoint = uplink.endpoint(endpoint).to_owned();
                return Err(TrackError::NotOpened { endpoint, cause });
            }
            Next::News(News::Over(Ok(()))) => return Err(TrackError::NoEndpoint),
            Next::News(_) | Next::Feed(_) => {}
        }
    }
}

fn player(open: &Open, axes: Vec<Axis>, motion: &Motion, uplink: &Uplink) -> Player {
    let plan = motion.plan();
    // A closing stop changes nothing at the beginning.
    let setpoints: Vec<Setpoint> = plan.sampler().at(0).collect();
    let buffer = Buffer::new(&Standing {
        epoch: uplink.failover().serving_epoch().unwrap_or(open.epoch),
        lead_cycles: open.lead_cycles,
        axis_guard: open.axis_guard,
        plan,
        setpoints: &setpoints,
    });
    Player::new(buffer, axes, motion.last_cycle(), u64::from(open.batch_cycles))
}
