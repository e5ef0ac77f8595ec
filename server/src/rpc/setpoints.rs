use std::pin::Pin;
use std::task::{Context, Poll, ready};
use std::time::Instant;

use proto::pb;
use proto::pb::setpoint_service_server::SetpointService;
use proto::stream::Watch;
use proto::{Reason, Rejected};
use serving::{Caller, Leaving};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tokio_stream::{Stream, StreamExt as _};
use tonic::{Request, Response, Status, Streaming};

use crate::drive;
use crate::figures::Figures;
use crate::streams::Streams;
use crate::watch::{Board, Visitor, watch_all, watch_stream};

/// Messages made ahead of a slow reader.
const AHEAD: usize = 4;

/// `SetpointService`: one session a stream.
#[derive(Clone, Debug)]
pub(crate) struct Setpoints {
    streams: Streams,
    board: Board,
    served_by: String,
    leaving: Leaving,
}

impl Setpoints {
    pub(crate) fn new(streams: Streams, board: Board, served_by: String, leaving: Leaving) -> Self {
        Self { streams, board, served_by, leaving }
    }
}

/// What goes out to an axis, counted as it goes.
#[derive(Debug)]
pub(crate) struct Told {
    receiver: ReceiverStream<Result<pb::StreamSetpointsResponse, Status>>,
    figures: Figures,
}

impl Stream for Told {
    type Item = Result<pb::StreamSetpointsResponse, Status>;

    fn poll_next(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        let message = ready!(Pin::new(&mut self.receiver).poll_next(cx));
        if let Some(Ok(message)) = &message {
            self.figures.sent(message);
        }
        Poll::Ready(message)
    }
}

#[tonic::async_trait]
impl SetpointService for Setpoints {
    type StreamSetpointsStream = Told;

    async fn stream_setpoints(
        &self,
        request: Request<Streaming<pb::StreamSetpointsRequest>>,
    ) -> Result<Response<Self::StreamSetpointsStream>, Status> {
        if self.leaving.has_begun() {
            let text = "this server is about to leave: open the stream on another";
            return Err(Rejected::new(Reason::Draining, text).into());
        }
        let (sender, receiver) = mpsc::channel(AHEAD);
        let Self { streams, board, served_by, leaving } = self.clone();
        let streams = streams.as_used_by(Caller::of(&request));
        let figures = streams.figures().clone();
        let session = drive::drive(request.into_inner(), sender, (streams, board), served_by, leaving);
        self.leaving.spawn(session);
        let receiver = ReceiverStream::new(receiver);
        Ok(Response::new(Told { receiver, figures }))
    }

    async fn control_stream(
        &self,
        request: Request<pb::ControlStreamRequest>,
    ) -> Result<Response<pb::ControlStreamResponse>, Status> {
        let streams = self.streams.as_used_by(Caller::of(&request));
        let pb::ControlStreamRequest { stream, operation } = request.into_inner();
        let operation = operation.ok_or_else(|| {
            let text = "is not set: say what to do, as hold or resume";
            Rejected::for_field("operation", Reason::FieldMissing, text)
        })?;
        serving::about(&stream, &operation.request_id);
        let asked = Instant::now();
        let result = streams.command(&stream, operation.into()).await?;
        streams.figures().operated(asked);
        Ok(Response::new(pb::ControlStreamResponse { result: Some(result.into()) }))
    }

    type WatchStreamStream = Pin<Box<dyn Stream<Item = Result<pb::WatchStreamResponse, Status>> + Send>>;

    async fn watch_stream(
        &self,
        request: Request<pb::WatchStreamRequest>,
    ) -> Result<Response<Self::WatchStreamStream>, Status> {
        let caller = Caller::of(&request);
        let watch = Watch::try_from(request.into_inner())?;
        let (sender, receiver) = mpsc::channel(AHEAD);
        let Self { board, leaving, .. } = self.clone();
        let visitor = Visitor { caller, outgoing: sender, leaving };
        // Who only looks on is nobody that the process waits for.
        if watch.stream.is_some() {
            tokio::spawn(watch_stream(board, watch, visitor));
        } else {
            tokio::spawn(watch_all(board, watch, visitor));
        }
        let messages = ReceiverStream::new(receiver).map(|shown| Ok(shown?.into()));
        Ok(Response::new(Box::pin(messages)))
    }
}
