//! What a cell controller or an axis gateway links: plans, and streams of setpoints.
//!
//! - [`address`]: what can be connected to; [`Connect`]: how, with encryption
//! - [`Client`]: asks a server for plans, and opens streams
//! - [`Client::plan_many`], [`Client::plan_all`]: many plans over one stream
//! - [`Setpoints`]: the cycles of a stream in order; a gap is an error, not a shrug
//! - [`Servers`]: who may serve a stream, and in which order they are asked
//! - [`Buffer`]: the rule by which an axis accepts setpoints, for those who own the clock: no allocation, no waiting
//! - [`Client::control`], [`control`]: operations on a stream that an axis has opened
//! - [`Client::watch`]: streams as they run, for those who only look on
//! - [`Link`]: the messages of a stream as they come, for those who own a buffer
//!
//! Domain types go in and come out; the wire stays inside.

mod address;
mod buffer;
mod connect;
mod control;
mod error;
pub mod failover;
pub mod grade;
mod join;
mod link;
mod many;
mod record;
mod revision;
mod servers;
mod setpoints;
mod shared;
mod starved;
mod uplink;
mod watch;

use planner::{Certificate, Judged, JudgedPvt, Plan, PvtRequestSpec, RequestSpec};
use prost::Message;
use proto::pb::planner_service_client::PlannerServiceClient;
use proto::pb::setpoint_service_client::SetpointServiceClient;
use proto::stream::{Columns, FromAxis, Open, Operation, OperationResult};
use proto::{Against, Chunk, Digest, MAX_MESSAGE_BYTES, pb};
use tokio::sync::mpsc;
use tonic::Streaming;
use tonic::service::interceptor::InterceptedService;
use tonic::transport::Channel;

pub use address::address;
pub use buffer::{Buffer, Playing, Standing};
pub use connect::{Connect, Traced};
pub use control::control;
pub use error::Error;
pub use join::JoinRule;
pub use link::{Link, Reports};
pub use many::{Answers, Asking};
pub use record::Record;
pub use revision::Revision;
pub use servers::Servers;
pub use setpoints::Setpoints;
use shared::{Place, Trial};
pub use uplink::{Next, Uplink};
pub use watch::Watching;

/// A connection to one server.
#[derive(Clone, Debug)]
pub struct Client {
    endpoint: String,
    connect: Connect,
    most_bytes: usize,
    planner: PlannerServiceClient<Traffic>,
    setpoints: SetpointServiceClient<Traffic>,
    /// Kept on a connection that is shared.
    place: Option<Place>,
}

/// A connection whose calls carry the trace that they belong to.
pub(crate) type Traffic = InterceptedService<Channel, Traced>;

impl Client {
    /// Connects to the server at `endpoint`, `http://127.0.0.1:50051`, or without the scheme. With encryption, and to
    /// other limits: [`Connect::to`].
    ///
    /// # Errors
    /// [`Error::Address`] where the address is none, [`Error::Unreachable`] where nobody answers.
    pub async fn connect(endpoint: &str) -> Result<Self, Error> {
        Connect::new().to(endpoint).await
    }

    /// Over a connection that is there.
    pub(crate) fn over(connect: &Connect, endpoint: &str, channel: Channel, place: Option<Place>) -> Self {
        let connected = Self {
            endpoint: endpoint.into(),
            connect: connect.clone(),
            most_bytes: MAX_MESSAGE_BYTES,
            planner: PlannerServiceClient::with_interceptor(channel.clone(), Traced),
            setpoints: SetpointServiceClient::with_interceptor(channel, Traced),
            place,
        };
        connected.with_message_limit(MAX_MESSAGE_BYTES)
    }

    /// The same with another limit on messages, in either direction \[bytes\]: 64 MiB where nothing is said. Beyond it calls
    /// end with [`Error::TooLarge`].
    #[must_use]
    pub fn with_message_limit(self, bytes: usize) -> Self {
        let Self { planner, setpoints, .. } = self.clone();
        Self {
            most_bytes: bytes,
            planner: planner.max_decoding_message_size(bytes),
            setpoints: setpoints.max_decoding_message_size(bytes),
            ..self
        }
    }

    /// Where the server is, as it was given.
    #[must_use]
    pub fn endpoint(&self) -> &str {
        &self.endpoint
    }

    /// How the server was connected to.
    #[must_use]
    pub fn connected_by(&self) -> &Connect {
        &self.connect
    }

    /// Plans a move. The certificate is computed here again, from the segments that came.
    ///
    /// # Errors
    /// [`Error::Rejected`] with every invalid field, or with what cannot be met.
    pub async fn plan(&self, request: RequestSpec) -> Result<Judged, Error> {
        let request = self.fits(pb::PlanRequest::from(request))?;
        let response = self.planner.clone().plan(request).await;
        let plan = self.answer(response)?.plan.unwrap_or_default();
        Ok(Judged::new(proto::plan_from_wire(plan).map_err(Error::unreadable)?))
    }

    /// Plans a motion through points of position, velocity and time. The certificate is computed here again, from the segments
    /// that came.
    ///
    /// # Errors
    /// [`Error::Rejected`] with every invalid field, or with the first point of each axis that cannot be met.
    pub async fn plan_pvt(&self, request: PvtRequestSpec) -> Result<JudgedPvt, Error> {
        let request = self.fits(pb::PlanPvtRequest::from(request))?;
        let response = self.planner.clone().plan_pvt(request).await;
        proto::pvt_from_wire(self.answer(response)?).map_err(Error::unreadable)
    }

    /// Asks the server's judge about a plan, held against its own limits and goals, or against others.
    ///
    /// # Errors
    /// [`Error::Rejected`] for what is not a plan, or for an axis that it does not have.
    pub async fn verify(&self, plan: &Plan, against: Vec<Against>) -> Result<Certificate, Error> {
        let request = pb::VerifyPlanRequest {
            plan: Some(proto::plan_to_wire(&Judged::new(plan.clone()))),
            against: against.into_iter().map(Into::into).collect(),
        };
        let response = self.planner.clone().verify_plan(self.fits(request)?).await;
        let certificate = self.answer(response)?.certificate.unwrap_or_default();
        certificate.try_into().map_err(Error::unreadable)
    }

    /// Reads out a plan from `first_cycle` on; `cycles` 0 is to the end.
    ///
    /// # Errors
    /// [`Error::Rejected`] for a plan that the judge rejects, or cycles that it does not have.
    pub async fn sample(&self, plan: &Judged, first_cycle: u64, cycles: u64) -> Result<Samples, Error> {
        let plan = Some(proto::plan_to_wire(plan));
        let request = pb::SamplePlanRequest { plan, first_cycle, cycles };
        let response = self.planner.clone().sample_plan(self.fits(request)?).await;
        Ok(Samples { endpoint: self.endpoint.clone(), incoming: self.answer(response)? })
    }

    /// The digest of a plan's setpoints, from cycle 1 to its last.
    ///
    /// # Errors
    /// Those of [`sample`](Self::sample).
    pub async fn digest(&self, plan: &Judged) -> Result<Digest, Error> {
        let mut samples = self.sample(plan, 0, 0).await?;
        let mut digest = Digest::ZERO;
        while let Some(chunk) = samples.next().await? {
            digest = chunk.digest;
        }
        Ok(digest)
    }

    /// Opens a stream of setpoints, as messages.
    ///
    /// # Errors
    /// [`Error::Unreachable`], [`Error::TooLarge`]; refusals come as the first message.
    pub async fn open(&self, open: Open) -> Result<(Reports, Link), Error> {
        let first = self.fits(proto::request_to_wire(&FromAxis::Open(Box::new(open))))?;
        let (reports, link) = link::open(self.setpoints.clone(), &self.endpoint, first).await?;
        Ok((reports, link.on(self.place.clone())))
    }

    /// The same of what comes out of `requests`.
    pub(crate) async fn open_with(
        &self,
        requests: mpsc::Receiver<pb::StreamSetpointsRequest>,
    ) -> Result<Link, Error> {
        let link = link::open_with(self.setpoints.clone(), &self.endpoint, requests).await?;
        Ok(link.on(self.place.clone()))
    }

    /// The connection, which takes nobody new where this is dropped and nothing has proved it.
    pub(crate) fn on_trial(&self) -> Trial {
        Trial::of(self.place.clone())
    }

    /// Does an operation on a stream that this server serves, and tells what became of it.
    ///
    /// # Errors
    /// [`Error::Rejected`] with [`Reason::StreamNotHere`](proto::Reason::StreamNotHere) where another server serves it, and
    /// for operations that are refused.
    pub async fn control(&self, stream: &str, operation: Operation) -> Result<OperationResult, Error> {
        let operation = Some(operation.into());
        let request = pb::ControlStreamRequest { stream: stream.into(), operation };
        let response = self.setpoints.clone().control_stream(self.fits(request)?).await;
        let result = self.answer(response)?.result;
        result.map(Into::into).ok_or_else(|| Error::Protocol("an answer without a result".into()))
    }

    fn fits<M: Message>(&self, request: M) -> Result<M, Error> {
        Error::unless_fits(&self.endpoint, request, self.most_bytes)
    }

    fn answer<T>(&self, response: Result<tonic::Response<T>, tonic::Status>) -> Result<T, Error> {
        response.map(tonic::Response::into_inner).map_err(|status| Error::of_planner(&self.endpoint, &status))
    }
}

/// The setpoints of a plan, chunk by chunk.
#[derive(Debug)]
pub struct Samples {
    endpoint: String,
    incoming: Streaming<pb::SamplePlanResponse>,
}

impl Samples {
    /// The next chunk; `None` at the end.
    ///
    /// # Errors
    /// A server that is gone, or that sends columns of different lengths.
    pub async fn next(&mut self) -> Result<Option<Chunk>, Error> {
        let message = self.incoming.message().await;
        let message = message.map_err(|status| Error::of_planner(&self.endpoint, &status))?;
        let Some(pb::SamplePlanResponse { first_cycle, columns, digest }) = message else { return Ok(None) };
        let columns = Columns::try_from(columns.unwrap_or_default()).map_err(Error::unreadable)?;
        Ok(Some(Chunk { first_cycle, columns, digest: Digest::from(digest) }))
    }
}
