//! `SimAxisService`: a thin face over [`Tracking`]. Below here, and nowhere else in this crate, is the wire known.

mod convert;
mod remote;
mod request;

use std::sync::Arc;

use proto::pb::run_tracking_response::Message;
use proto::pb::sim_axis_service_server::{SimAxisService, SimAxisServiceServer};
use proto::{Reason, Rejected, pb};
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};
use tokio_stream::wrappers::ReceiverStream;
use tokio_util::sync::CancellationToken;
use tonic::{Request, Response, Status};

use crate::config::Config;
use crate::models::{InvalidModels, Models};
use crate::run::{TrackError, Tracking, Update};

pub use remote::{RemoteAxis, RemoteRun};

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
    drain: CancellationToken,
}

/// The service for `config`, which takes no new run once `drain` is cancelled.
pub(crate) fn service(config: &Config, drain: CancellationToken) -> Face {
    let axes = Axes {
        models: Arc::new(config.models.clone()),
        runs: Arc::new(Semaphore::new(config.max_runs.min(Semaphore::MAX_PERMITS))),
        max_runs: config.max_runs,
        drain,
    };
    let size = config.max_message_bytes;
    SimAxisServiceServer::new(axes).max_decoding_message_size(size).max_encoding_message_size(size)
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
        if self.drain.is_cancelled() {
            return Err(Rejected::new(Reason::Draining, "this simulator is about to leave: run on another"));
        }
        Arc::clone(&self.runs).try_acquire_owned().map_err(|_| {
            let most = self.max_runs;
            let text = format!("{most} runs are going on, as many as this simulator takes: let one end");
            Rejected::new(Reason::TooManyStreams, text).with("allowed", most)
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
        let request = request::track_request(request.into_inner(), &self.models)?;
        let tracking = Tracking::begin(request).await.map_err(status)?;
        let (sender, receiver) = mpsc::channel(AHEAD);
        tokio::spawn(async move {
            tokio::select! {
                () = carry(tracking, &sender) => {}
                // The caller has gone, and with it the run.
                () = sender.closed() => {}
            }
            drop(permit);
        });
        Ok(Response::new(ReceiverStream::new(receiver)))
    }

    async fn command(&self, _: Request<pb::CommandRequest>) -> Result<Response<pb::CommandResponse>, Status> {
        Err(not_implemented("Command", "let the motion end, then run another plan"))
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
        _: Request<pb::InjectFaultRequest>,
    ) -> Result<Response<pb::InjectFaultResponse>, Status> {
        Err(not_implemented("InjectFault", "disturb the network or stop the server to see what an axis does"))
    }
}

/// Tells the caller everything about a run. Where the run ends badly and there is a report, that comes first.
async fn carry(mut tracking: Tracking, sender: &Outgoing) {
    while let Some(update) = tracking.next().await {
        let message = match update {
            Update::Samples(samples) => Message::Samples(samples.into()),
            Update::Event(event) => Message::Event(event.into()),
        };
        if sender.send(Ok(pb::RunTrackingResponse { message: Some(message) })).await.is_err() {
            return;
        }
    }
    let (report, failure) = match tracking.finish().await {
        Ok(report) => (Some(report), None),
        Err(TrackError::Broken { executed, motion_end, cause, report }) => {
            let error = TrackError::Broken { executed, motion_end, cause, report: report.clone() };
            (Some(*report), Some(status(error)))
        }
        Err(error) => (None, Some(status(error))),
    };
    let report = report.map(|report| Message::Report(report.into()));
    let report = report.map(|message| Ok(pb::RunTrackingResponse { message: Some(message) }));
    for last in report.into_iter().chain(failure.map(Err)) {
        // Nobody to tell is not a failure.
        let _ = sender.send(last).await;
    }
}

/// What a later version will answer.
fn not_implemented(what: &str, instead: &str) -> Status {
    Rejected::new(Reason::NotImplemented, format!("{what} is not implemented: {instead}")).into()
}

/// Why there is no run, or none that is whole, as a status.
fn status(error: TrackError) -> Status {
    let text = error.to_string();
    match error {
        TrackError::NoEndpoint => Rejected::new(Reason::ProtocolOrder, text).into(),
        TrackError::UnknownAxis { .. } => Rejected::new(Reason::UnknownAxis, text).into(),
        TrackError::Config { axis, cause } => request::unsuitable(&axis, &cause).into(),
        TrackError::NotOpened(client::Error::Rejected(rejected)) => (*rejected).into(),
        TrackError::Broken { cause: client::Error::Rejected(rejected), .. } => {
            Rejected { message: text, ..*rejected }.into()
        }
        TrackError::NotOpened(client::Error::Unreachable { .. })
        | TrackError::Broken { cause: client::Error::Unreachable { .. }, .. } => Status::unavailable(text),
        TrackError::NotOpened(client::Error::Protocol(_))
        | TrackError::Broken { cause: client::Error::Protocol(_), .. } => Status::internal(text),
        TrackError::Abandoned => Status::cancelled(text),
        TrackError::Thread(_) => Rejected::new(Reason::Overloaded, text).into(),
    }
}
