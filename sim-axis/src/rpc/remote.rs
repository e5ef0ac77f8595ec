//! An axis simulator elsewhere, seen from whoever asks it to follow a plan.

use client::{Connect, Error, Traced};
use proto::pb::run_tracking_response::Message;
use proto::pb::sim_axis_service_client::SimAxisServiceClient;
use proto::stream::{Operation, OperationResult};
use proto::{MAX_MESSAGE_BYTES, Rejected, pb, plan_to_wire};
use tonic::service::interceptor::InterceptedService;
use tonic::transport::Channel;
use tonic::{Status, Streaming};

use super::convert::change_from_wire;
use crate::clock::Clock;
use crate::run::{TrackRequest, TrackingReport, Update};

/// A connection to a `SimAxisService`.
#[derive(Clone, Debug)]
pub struct RemoteAxis {
    endpoint: String,
    service: SimAxisServiceClient<InterceptedService<Channel, Traced>>,
}

/// A run on an axis simulator elsewhere. Dropping it ends the run.
#[derive(Debug)]
pub struct RemoteRun {
    endpoint: String,
    incoming: Streaming<pb::RunTrackingResponse>,
    report: Option<TrackingReport>,
}

impl RemoteAxis {
    /// Connects to the simulator at `endpoint`: `http://127.0.0.1:50052`, or without the scheme.
    ///
    /// # Errors
    /// [`Error::Address`] where the address is none, [`Error::Unreachable`] where nobody answers.
    pub async fn connect(endpoint: &str) -> Result<Self, Error> {
        Self::connect_by(&Connect::new(), endpoint).await
    }

    /// The same, with encryption.
    ///
    /// # Errors
    /// Those of [`Connect::to`].
    pub async fn connect_by(connect: &Connect, endpoint: &str) -> Result<Self, Error> {
        let channel = connect.channel(endpoint).await?;
        let service = SimAxisServiceClient::with_interceptor(channel, Traced);
        let service = service.max_decoding_message_size(MAX_MESSAGE_BYTES);
        Ok(Self { endpoint: endpoint.into(), service })
    }

    /// Has the simulator follow a plan.
    ///
    /// # Errors
    /// [`Error::Rejected`] with every field that is invalid, or with what the planner says that does not open the stream.
    pub async fn track(&self, request: TrackRequest) -> Result<RemoteRun, Error> {
        let request = Error::unless_fits(&self.endpoint, to_wire(request), MAX_MESSAGE_BYTES)?;
        let response = self.service.clone().run_tracking(request).await;
        let incoming = response.map_err(|status| self.error(&status))?.into_inner();
        Ok(RemoteRun { endpoint: self.endpoint.clone(), incoming, report: None })
    }

    /// Does an operation on a stream that the simulator follows; where `stream` is empty, the only one.
    ///
    /// # Errors
    /// [`Error::Rejected`] with what the planner refuses it for, or where no such stream is followed.
    pub async fn command(&self, stream: &str, operation: Operation) -> Result<OperationResult, Error> {
        let operation = Some(operation.into());
        let request = pb::CommandRequest { stream: stream.into(), operation };
        let request = Error::unless_fits(&self.endpoint, request, MAX_MESSAGE_BYTES)?;
        let response = self.service.clone().command(request).await;
        let result = response.map_err(|status| self.error(&status))?.into_inner().result;
        result.map(Into::into).ok_or_else(|| Error::Protocol("an answer without a result".into()))
    }

    fn error(&self, status: &Status) -> Error {
        Error::from_status(&self.endpoint, status)
    }
}

impl RemoteRun {
    /// What happens next; `None` when the run is over.
    ///
    /// # Errors
    /// [`Error::Rejected`] where the stream broke off, [`Error::Unreachable`] where the simulator is gone.
    pub async fn next(&mut self) -> Result<Option<Update>, Error> {
        loop {
            let message = self.incoming.message().await;
            let message = message.map_err(|status| Error::from_status(&self.endpoint, &status))?;
            let Some(pb::RunTrackingResponse { message }) = message else { return Ok(None) };
            match message {
                Some(Message::Samples(samples)) => {
                    let samples = samples.try_into().map_err(rejected)?;
                    return Ok(Some(Update::Samples(samples)));
                }
                Some(Message::Event(event)) => {
                    let event = event.try_into().map_err(rejected)?;
                    return Ok(Some(Update::Event(event)));
                }
                Some(Message::FailOver(change)) => {
                    if let Some(change) = change_from_wire(change) {
                        return Ok(Some(Update::FailedOver(change)));
                    }
                }
                Some(Message::Operated(pb::Operated {
                    operation: Some(operation),
                    result: Some(result),
                })) => {
                    return Ok(Some(Update::Operated(Box::new((operation.into(), result.into())))));
                }
                // An operation of which nothing is said is none.
                Some(Message::Operated(_)) => {}
                Some(Message::Report(report)) => self.report = Some(report.into()),
                // Something that a newer simulator says beside the rest.
                None => {}
            }
        }
    }

    /// The report of a run that is over.
    ///
    /// # Errors
    /// [`Error::Protocol`] where there was none.
    pub fn finish(self) -> Result<TrackingReport, Error> {
        self.report.ok_or_else(|| Error::Protocol("the run ended without a report".into()))
    }
}

fn rejected(rejected: Rejected) -> Error {
    Error::Protocol(rejected.to_string())
}

fn to_wire(request: TrackRequest) -> pb::RunTrackingRequest {
    let TrackRequest {
        stream,
        endpoints,
        plan,
        models,
        clock,
        lead_cycles,
        settle_window,
        settle_tolerance,
        stay_open,
        accept_unproved,
        compact,
        spread,
        patience,
        // How this side is connected to is no matter of the other's.
        connect: _,
        // Those of the other process are made by InjectFault.
        faults: _,
    } = request;
    let duration =
        |ns: i64| prost_types::Duration { seconds: ns / 1_000_000_000, nanos: (ns % 1_000_000_000) as i32 };
    pb::RunTrackingRequest {
        stream,
        endpoints,
        plan: Some(plan_to_wire(plan.judged())),
        models: models.iter().map(|model| model.spec().clone().into()).collect(),
        lead_cycles,
        virtual_time: clock == Clock::Virtual,
        settle_window: Some(duration((settle_window * 1e9) as i64)),
        settle_tolerance: settle_tolerance.unwrap_or_default(),
        stay_open,
        accept_unproved,
        compact,
        spread,
        patience: Some(duration(i64::try_from(patience.as_nanos()).unwrap_or(i64::MAX))),
    }
}
