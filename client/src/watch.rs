use proto::pb;
use proto::stream::{Watch, Watched};
use tonic::Streaming;

use crate::{Client, Error};

/// Streams as they run, message by message.
#[derive(Debug)]
pub struct Watching {
    endpoint: String,
    incoming: Streaming<pb::WatchStreamResponse>,
}

impl Client {
    /// Looks on: at one stream, with how its axes follow, or at how all streams of this server stand. Delays none of them.
    ///
    /// # Errors
    /// [`Error::Rejected`] with [`Reason::StreamNotHere`](proto::Reason::StreamNotHere), here or as the first message, where
    /// this server does not serve the stream.
    pub async fn watch(&self, watch: Watch) -> Result<Watching, Error> {
        let request = self.fits(pb::WatchStreamRequest::from(watch))?;
        let response = self.setpoints.clone().watch_stream(request).await;
        Ok(Watching { endpoint: self.endpoint.clone(), incoming: self.answer(response)? })
    }
}

impl Watching {
    /// What is seen next; `None` when the stream has ended.
    ///
    /// # Errors
    /// A stream that is not served here, a server that leaves or is gone.
    pub async fn next(&mut self) -> Result<Option<Watched>, Error> {
        let message = self.incoming.message().await;
        let message = message.map_err(|status| Error::from_status(&self.endpoint, &status))?;
        message.map(|wire| wire.try_into().map_err(Error::unreadable)).transpose()
    }
}
