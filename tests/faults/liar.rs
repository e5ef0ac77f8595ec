//! A server that serves as ours does, up to a point: from there on it lies, or dies.

use std::net::SocketAddr;

use proto::pb;
use proto::pb::setpoint_service_server::{SetpointService, SetpointServiceServer};
use proto::stream::{Batch, Columns, FromAxis, Tails, ToAxis};
use server::session::{Event, Output, Session};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Request, Response, Status, Streaming};

/// What is wrong with a server.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Lie {
    /// It leaves out the batch with [`FROM`], each time.
    Gap,
    /// It sends all that it has, however little was granted.
    BeyondGrant,
    /// It adds a millimetre from there on.
    Jump,
    /// Its digests are others.
    WrongDigest,
    /// It sends a velocity that is no number.
    NotFinite,
    /// It sends no way to rest while the axis moves.
    NoTail,
    /// It sends a way to rest that begins elsewhere.
    OtherTail,
    /// It sends no setpoints, as if the axis had asked to evaluate them.
    Bare,
    /// It ends the stream as soon as it has announced a revision.
    DiesOnceRevised,
}

/// The cycle from which batches are wrong.
pub(crate) const FROM: u64 = 200;

/// A server with that fault on a port of its own, for as long as the runtime lives. Gives where it is.
pub(crate) async fn lie(lie: Lie) -> String {
    let listener = tokio::net::TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], 0))).await.unwrap();
    let address = listener.local_addr().unwrap();
    let router = tonic::transport::Server::builder().add_service(SetpointServiceServer::new(Liar(lie)));
    let incoming = tonic::transport::server::TcpIncoming::from(listener).with_nodelay(Some(true));
    tokio::spawn(router.serve_with_incoming(incoming));
    format!("http://{address}")
}

#[derive(Clone, Copy, Debug)]
struct Liar(Lie);

type Answers = mpsc::Sender<Result<pb::StreamSetpointsResponse, Status>>;

async fn serve(
    lie: Lie,
    mut incoming: Streaming<pb::StreamSetpointsRequest>,
    answers: Answers,
) -> Option<()> {
    let Ok(FromAxis::Open(open)) = proto::request_from_wire(incoming.message().await.ok()??) else {
        return None;
    };
    let epoch = open.epoch;
    let mut session = match Session::open(*open, "liar") {
        Ok(session) => session,
        Err(rejected) => {
            answers.send(Err(rejected.into())).await.ok()?;
            return None;
        }
    };
    loop {
        while let Some(output) = session.poll_output() {
            let message = match output {
                Output::Send(ToAxis::Batch(batch)) => match falsified(lie, batch) {
                    Some(batch) => ToAxis::Batch(batch),
                    None => continue,
                },
                Output::Send(message) => message,
                Output::End(Ok(())) => return None,
                Output::End(Err(rejected)) => {
                    answers.send(Err(rejected.into())).await.ok()?;
                    return None;
                }
            };
            let dies = lie == Lie::DiesOnceRevised && matches!(message, ToAxis::Revised(_));
            answers.send(Ok(proto::response_to_wire(epoch, message))).await.ok()?;
            if dies {
                return None;
            }
        }
        let mut message = proto::request_from_wire(incoming.message().await.ok()??).ok()?;
        if let (Lie::BeyondGrant, FromAxis::Report(report)) = (lie, &mut message) {
            report.grant_cycle += FROM;
        }
        session.handle(Event::FromAxis(message));
    }
}

fn falsified(lie: Lie, batch: Batch) -> Option<Batch> {
    let with = |columns: Columns| {
        // What is wrong is in the setpoints alone: the digest is right for them.
        let known = batch.digest;
        let digest = columns.digests(batch.first_cycle, known).last().unwrap_or(known);
        Batch { columns, digest, ..batch.clone() }
    };
    let changed = |change: fn(&mut [Vec<f64>; 4])| {
        let cycles = batch.columns.cycles();
        let mut columns = batch.columns.clone().into_parts();
        change(&mut columns);
        with(Columns::from_parts(cycles, columns).unwrap())
    };
    match lie {
        _ if batch.last_cycle() < FROM => Some(batch),
        Lie::Gap => (batch.first_cycle > FROM).then_some(batch),
        Lie::Jump => Some(changed(|[position, ..]| position.iter_mut().for_each(|p| *p += 1e-3))),
        Lie::WrongDigest => Some(Batch { digest: proto::Digest::from(u64::from(batch.digest) ^ 1), ..batch }),
        Lie::NotFinite => Some(changed(|[_, velocity, ..]| velocity[0] = f64::NAN)),
        Lie::NoTail => Some(Batch { tails: Tails::default(), ..batch }),
        Lie::Bare => Some(Batch { columns: Columns::bare(batch.columns.cycles()), ..batch }),
        Lie::OtherTail => {
            let ways = batch.tails.profiles().iter().map(|way| {
                planner::Profile::new(way.timed_segments().map(|(_, piece)| piece).skip(1), way.end())
            });
            Some(Batch { tails: Tails::new(ways.collect::<Vec<_>>()), ..batch })
        }
        // What it sends is right, and too much; the other is no lie.
        Lie::BeyondGrant | Lie::DiesOnceRevised => Some(batch),
    }
}

#[tonic::async_trait]
impl SetpointService for Liar {
    type StreamSetpointsStream = ReceiverStream<Result<pb::StreamSetpointsResponse, Status>>;

    async fn stream_setpoints(
        &self,
        request: Request<Streaming<pb::StreamSetpointsRequest>>,
    ) -> Result<Response<Self::StreamSetpointsStream>, Status> {
        let (answers, receiver) = mpsc::channel(4);
        tokio::spawn(serve(self.0, request.into_inner(), answers));
        Ok(Response::new(ReceiverStream::new(receiver)))
    }

    async fn control_stream(
        &self,
        _: Request<pb::ControlStreamRequest>,
    ) -> Result<Response<pb::ControlStreamResponse>, Status> {
        Err(Status::unimplemented("not here"))
    }

    type WatchStreamStream = ReceiverStream<Result<pb::WatchStreamResponse, Status>>;

    async fn watch_stream(
        &self,
        _: Request<pb::WatchStreamRequest>,
    ) -> Result<Response<Self::WatchStreamStream>, Status> {
        Err(Status::unimplemented("not here"))
    }
}
