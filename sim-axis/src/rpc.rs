//! `SimAxisService`: a thin face over [`Tracking`]. Below here, and nowhere else in this crate, is the wire known.

mod convert;
mod refusal;
mod remote;
mod request;
mod streams;

use std::sync::Arc;

use client::Connect;
use proto::pb::run_tracking_response::Message;
use proto::pb::sim_axis_service_server::{SimAxisService, SimAxisServiceServer};
use proto::{Reason, Rejected, pb};
use serving::{Caller, Leaving};
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Response, Status};

use crate::config::Config;
use crate::faults::Faults;
use crate::figures::Figures;
use crate::models::{InvalidModels, Models};
use crate::run::{Tracking, Update};

pub use remote::{RemoteAxis, RemoteRun};
pub use request::track_request;
use streams::Streams;

/// The service as it is served.
pub(crate) type Face = SimAxisServiceServer<Axes>;

type Outgoing = mpsc::Sender<Result<pb::RunTrackingResponse, Status>>;

/// Messages made ahead of a slow reader.
const AHEAD: usize = 2;

/// The axes of this process.
#[derive(Clone, Debug)]
pub(crate) struct Axes {
    models: Arc<Models>,
    runs: Arc<Semaphore>,
    max_runs: usize,
    streams: Streams,
    connect: Connect,
    /// Where callers may make things go wrong.
    faults: Option<Faults>,
    leaving: Leaving,
}

/// The service for `config`, which takes no new run once the process is leaving.
pub(crate) fn service(config: &Config, leaving: Leaving) -> Face {
    // Figures are there from the beginning, so that the first increase of each is seen.
    drop(Figures::resolve());
    let axes = Axes {
        models: Arc::new(config.models.clone()),
        runs: Arc::new(Semaphore::new(config.max_runs.min(Semaphore::MAX_PERMITS))),
        max_runs: config.max_runs,
        streams: Streams::default(),
        connect: config.connect.clone(),
        faults: config.fault_injection.then(Faults::default),
        leaving,
    };
    // The frame refuses larger ones, with a reason; below it nothing else is to.
    SimAxisServiceServer::new(axes).max_decoding_message_size(config.serving.max_message_bytes)
}

/// Why a file has no models.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModelFileError {
    /// It is not the JSON of models.
    #[error("{0}")]
    Json(#[from] proto::JsonError),
    /// The models are none.
    #[error("{0}")]
    Models(#[from] InvalidModels),
}

/// The models that a text lists: a JSON list of `motion.v1.AxisModel`, or an object of which that is the field `models`.
///
/// # Errors
/// Where the text is not such JSON, and every field of every model that is invalid.
pub fn models_from_json(text: &str) -> Result<Models, ModelFileError> {
    let list;
    let text = if text.trim_start().starts_with('[') {
        list = format!("{{\"models\":{text}}}");
        &list
    } else {
        text
    };
    let pb::GetAxisModelResponse { models } = proto::from_json(text)?;
    Ok(Models::new(models.into_iter().map(Into::into).collect())?)
}

impl Axes {
    fn begin_run(&self) -> Result<OwnedSemaphorePermit, Rejected> {
        if self.leaving.has_begun() {
            return Err(draining());
        }
        Arc::clone(&self.runs).try_acquire_owned().map_err(|_| {
            let most = self.max_runs;
            let text = format!("{most} runs are going on, as many as this simulator takes: let one end");
            Rejected::new(Reason::TooManyStreams, text).with("given", most + 1).with("allowed", most)
        })
    }
}

#[tonic::async_trait]
impl SimAxisService for Axes {
    type RunTrackingStream = ReceiverStream<Result<pb::RunTrackingResponse, Status>>;

    async fn run_tracking(
        &self,
        request: Request<pb::RunTrackingRequest>,
    ) -> Result<Response<Self::RunTrackingStream>, Status> {
        let permit = self.begin_run()?;
        let caller = Caller::of(&request);
        let request = request.into_inner();
        caller.may_use(&request.stream)?;
        serving::about(&request.stream, "");
        let named: Vec<String> = request.models.iter().map(|model| model.axis.clone()).collect();
        let mut request = request::track_request(request, &self.models)?;
        request.connect = self.connect.clone();
        request.faults.clone_from(&self.faults);
        let stream = request.stream.clone();
        let tracking = Tracking::begin(request).await.map_err(|error| refusal::of(error, &named))?;
        let (sender, receiver) = mpsc::channel(AHEAD);
        let leaving = self.leaving.clone();
        let entry = self.streams.enter(stream, tracking.commander());
        self.leaving.spawn(async move {
            tokio::select! {
                () = carry(tracking, &sender) => {}
                // The caller has gone, and with it the run.
                () = sender.closed() => {}
                () = leaving.due() => {
                    // A reader that is too slow for it hears no reason.
                    let _ = sender.try_send(Err(draining().into()));
                }
            }
            drop((entry, permit));
        });
        Ok(Response::new(ReceiverStream::new(receiver)))
    }

    async fn command(
        &self,
        request: Request<pb::CommandRequest>,
    ) -> Result<Response<pb::CommandResponse>, Status> {
        let caller = Caller::of(&request);
        let pb::CommandRequest { stream, operation } = request.into_inner();
        let operation = operation.ok_or_else(|| {
            let text = "is not set: say what to do, as hold or resume";
            Rejected::for_field("operation", Reason::FieldMissing, text)
        })?;
        serving::about(&stream, &operation.request_id);
        let result = self.streams.commander_of(&stream, &caller)?.operate(operation.into()).await?;
        Ok(Response::new(pb::CommandResponse { result: Some(result.into()) }))
    }

    async fn get_axis_model(
        &self,
        _: Request<pb::GetAxisModelRequest>,
    ) -> Result<Response<pb::GetAxisModelResponse>, Status> {
        let models = self.models.iter().map(|model| model.spec().clone().into()).collect();
        Ok(Response::new(pb::GetAxisModelResponse { models }))
    }

    async fn inject_fault(
        &self,
        request: Request<pb::InjectFaultRequest>,
    ) -> Result<Response<pb::InjectFaultResponse>, Status> {
        let Some(faults) = &self.faults else {
            let text = "this simulator makes no faults: start it with --fault-injection";
            return Err(Rejected::new(Reason::NotImplemented, text).into());
        };
        let fault = request::fault(request.into_inner())?;
        let runs = faults.make(fault);
        tracing::warn!(?fault, runs, "a fault was asked for");
        Ok(Response::new(pb::InjectFaultResponse { runs: u32::try_from(runs).unwrap_or(u32::MAX) }))
    }
}

/// Tells the caller everything about a run. Where the run ends badly and there is a report, that comes first.
async fn carry(mut tracking: Tracking, sender: &Outgoing) {
    while let Some(update) = tracking.next().await {
        let message = match update {
            Update::Samples(samples) => Message::Samples(samples.into()),
            Update::Event(event) => Message::Event(event.into()),
            Update::FailedOver(change) => Message::FailOver(convert::change_to_wire(change)),
            Update::Operated(done) => {
                let (operation, result) = *done;
                Message::Operated(pb::Operated {
                    operation: Some(operation.into()),
                    result: Some(result.into()),
                })
            }
        };
        if sender.send(Ok(pb::RunTrackingResponse { message: Some(message) })).await.is_err() {
            return;
        }
    }
    let (report, failure) = match tracking.finish().await {
        Ok(report) => (Some(report), None),
        Err(error) => (error.report().cloned(), Some(refusal::of(error, &[]))),
    };
    let report = report.map(|report| Message::Report(report.into()));
    let report = report.map(|message| Ok(pb::RunTrackingResponse { message: Some(message) }));
    for last in report.into_iter().chain(failure.map(|rejected| Err(rejected.into()))) {
        // Nobody to tell is not a failure.
        let _ = sender.send(last).await;
    }
}

fn draining() -> Rejected {
    Rejected::new(Reason::Draining, "this simulator is about to leave: run on another")
}
