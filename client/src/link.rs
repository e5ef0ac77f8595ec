use proto::pb;
use proto::pb::setpoint_service_client::SetpointServiceClient;
use proto::stream::{FromAxis, Report, ToAxis};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::Streaming;

use crate::shared::Place;
use crate::{Error, Traffic};

/// Messages on their way to the server: reports are small, and a newer one says all that an older one did.
pub(crate) const OUTBOX: usize = 16;

/// The axis's side of a stream. Dropping it closes the stream.
#[derive(Clone, Debug)]
pub struct Reports {
    outgoing: mpsc::Sender<pb::StreamSetpointsRequest>,
}

/// The server's side of a stream.
#[derive(Debug)]
pub struct Link {
    endpoint: String,
    incoming: Streaming<pb::StreamSetpointsResponse>,
    /// Kept on a connection that is shared, as long as the stream goes over it.
    _place: Option<Place>,
}

pub(crate) async fn open(
    setpoints: SetpointServiceClient<Traffic>,
    endpoint: &str,
    first: pb::StreamSetpointsRequest,
) -> Result<(Reports, Link), Error> {
    let (outgoing, requests) = mpsc::channel(OUTBOX);
    let gone = || Error::Protocol("the stream ended before it began".into());
    outgoing.send(first).await.map_err(|_| gone())?;
    let link = open_with(setpoints, endpoint, requests).await?;
    Ok((Reports { outgoing }, link))
}

/// Says what comes out of `requests`, of which the first opens the stream.
pub(crate) async fn open_with(
    mut setpoints: SetpointServiceClient<Traffic>,
    endpoint: &str,
    requests: mpsc::Receiver<pb::StreamSetpointsRequest>,
) -> Result<Link, Error> {
    let response = setpoints.stream_setpoints(ReceiverStream::new(requests)).await;
    let incoming = response.map_err(|status| Error::of_planner(endpoint, &status))?.into_inner();
    Ok(Link { endpoint: endpoint.into(), incoming, _place: None })
}

impl Reports {
    /// Tells the server where the axis is. `false` if the stream is over.
    pub async fn send(&self, report: &Report) -> bool {
        self.say(&FromAxis::Report(report.clone())).await
    }

    /// Says anything to the server. `false` if the stream is over.
    pub async fn say(&self, message: &FromAxis) -> bool {
        self.outgoing.send(proto::request_to_wire(message)).await.is_ok()
    }
}

impl Link {
    /// Over a connection on which it has that place.
    pub(crate) fn on(self, place: Option<Place>) -> Self {
        Self { _place: place, ..self }
    }

    /// What the server says next, and under which epoch; `None` when it has nothing more to say.
    ///
    /// # Errors
    /// [`Error::Rejected`] where the server ends the stream for a reason, [`Error::Unreachable`] where it is gone.
    pub async fn next(&mut self) -> Result<Option<(u64, ToAxis)>, Error> {
        let message = self.incoming.message().await;
        let message = message.map_err(|status| Error::of_planner(&self.endpoint, &status))?;
        message.map(proto::response_from_wire).transpose().map_err(Error::unreadable)
    }
}
