//! Empty calls: messages of given sizes through every layer that a planner's go through, with nothing done for them.

use std::convert::Infallible;
use std::task::{Context, Poll};

use clap::Parser;
use prost::Message;
use tonic::body::Body;
use tonic::codegen::{Service, http};
use tonic::server::{NamedService, UnaryService};
use tonic::transport::Channel;
use tonic_prost::ProstCodec;

/// The hidden argument again, for a process that has the settings of every other.
#[derive(Debug, Parser)]
pub(crate) struct Empty {
    #[arg(long)]
    #[allow(dead_code, reason = "read before")]
    serve_empty: usize,
    #[command(flatten)]
    flags: serving::Flags,
}

impl serving::Arguments for Empty {
    fn flags(&self) -> &serving::Flags {
        &self.flags
    }
}

/// As many bytes as a message has in all.
#[derive(Clone, PartialEq, Message)]
pub(crate) struct Filling {
    #[prost(bytes = "bytes", tag = "1")]
    bytes: prost::bytes::Bytes,
}

impl Filling {
    pub(crate) fn of(bytes: usize) -> Self {
        // A key, and a length of two bytes.
        Self { bytes: vec![0x55; bytes.saturating_sub(3)].into() }
    }
}

/// Answers with as many bytes as an answer has, and does nothing.
#[derive(Clone)]
pub(crate) struct Answering(Filling);

impl UnaryService<Filling> for Answering {
    type Response = Filling;
    type Future = std::future::Ready<Result<tonic::Response<Filling>, tonic::Status>>;

    fn call(&mut self, _: tonic::Request<Filling>) -> Self::Future {
        std::future::ready(Ok(tonic::Response::new(self.0.clone())))
    }
}

impl NamedService for Answering {
    const NAME: &'static str = "load.Empty";
}

impl Service<http::Request<Body>> for Answering {
    type Response = http::Response<Body>;
    type Error = Infallible;
    type Future = std::pin::Pin<Box<dyn Future<Output = Result<http::Response<Body>, Infallible>> + Send>>;

    fn poll_ready(&mut self, _: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        Poll::Ready(Ok(()))
    }

    fn call(&mut self, request: http::Request<Body>) -> Self::Future {
        let this = self.clone();
        Box::pin(async move {
            let mut grpc = tonic::server::Grpc::new(ProstCodec::<Filling, Filling>::default());
            Ok(grpc.unary(this, request).await)
        })
    }
}

/// In the same frame as a planner, so that every layer is passed.
pub(crate) async fn serve_empty(bytes: usize) -> Result<(), serving::Exit> {
    let settings = serving::Settings { reflection: false, ..serving::Settings::on_port(0) };
    let bound = serving::Bound::to(settings).await?;
    let services =
        serving::Services::of_schema(proto::FILE_DESCRIPTOR_SET).with(Answering(Filling::of(bytes)));
    Ok(bound.serve(services, serving::Leaving::default(), std::future::pending()).await?)
}

pub(crate) async fn ask_empty(channel: Channel, filling: Filling) -> Result<(), tonic::Status> {
    let mut grpc = tonic::client::Grpc::new(channel);
    grpc.ready().await.map_err(|error| tonic::Status::unavailable(error.to_string()))?;
    let path = http::uri::PathAndQuery::from_static("/load.Empty/Call");
    grpc.unary(tonic::Request::new(filling), path, ProstCodec::<Filling, Filling>::default()).await.map(drop)
}
