use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, Sleep};
use tokio_stream::Stream;
use tonic::transport::server::{Connected, TcpConnectInfo};

use crate::listener::{Listener, Socket};

/// Connections as they come, up to a number: more are closed at once, so that those that are there keep what they have.
#[derive(Debug)]
pub(crate) struct Connections {
    listener: Listener,
    room: Arc<Semaphore>,
    patience: Duration,
    refused: metrics::Counter,
}

impl Connections {
    /// At most `most` at a time. Who says nothing for `patience` after it has connected is left.
    pub(crate) fn of(listener: Listener, most: usize, patience: Duration) -> Self {
        let room = Arc::new(Semaphore::new(most.min(Semaphore::MAX_PERMITS)));
        let refused = metrics::counter!("motion_connections_refused_total");
        Self { listener, room, patience, refused }
    }
}

impl Stream for Connections {
    type Item = io::Result<Connection>;

    fn poll_next(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Option<Self::Item>> {
        loop {
            let socket = match ready!(self.listener.poll_accept(cx)) {
                Ok(socket) => socket,
                Err(error) => return Poll::Ready(Some(Err(error))),
            };
            let Ok(place) = Arc::clone(&self.room).try_acquire_owned() else {
                self.refused.increment(1);
                continue;
            };
            if let Err(error) = socket.set_nodelay() {
                tracing::debug!(%error, "a connection keeps its delay");
            }
            #[expect(
                clippy::disallowed_methods,
                reason = "the deadline of a connection is one of wall-clock time"
            )]
            let left = Box::pin(tokio::time::sleep(self.patience));
            return Poll::Ready(Some(Ok(Connection { socket, left: Some(left), seen: 0, _place: place })));
        }
    }
}

/// A connection that has to say something soon, and keeps its place as long as it is there.
#[derive(Debug)]
pub(crate) struct Connection {
    socket: Socket,
    /// When it is left; `None` once it has said enough.
    left: Option<Pin<Box<Sleep>>>,
    /// How much it has said \[bytes\].
    seen: usize,
    _place: OwnedSemaphorePermit,
}

/// What every peer says first: HTTP/2's preface has as many bytes, the hello of TLS and any head of HTTP/1.1 more.
/// Source: RFC 9113, §3.4. After it, what asks whether a peer is still there sees to it.
const PREFACE: usize = 24;

impl AsyncRead for Connection {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = buffer.filled().len();
        let read = Pin::new(&mut self.socket).poll_read(cx, buffer);
        if let Some(left) = &mut self.left {
            if read.is_pending() {
                ready!(left.as_mut().poll(cx));
                let text = "the peer has connected and says nothing";
                return Poll::Ready(Err(io::Error::new(io::ErrorKind::TimedOut, text)));
            }
            self.seen += buffer.filled().len() - before;
            if self.seen >= PREFACE {
                self.left = None;
            }
        }
        read
    }
}

impl AsyncWrite for Connection {
    fn poll_write(mut self: Pin<&mut Self>, cx: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.socket).poll_write(cx, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.socket).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.socket).poll_shutdown(cx)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        pieces: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        Pin::new(&mut self.socket).poll_write_vectored(cx, pieces)
    }

    fn is_write_vectored(&self) -> bool {
        self.socket.is_write_vectored()
    }
}

impl Connected for Connection {
    type ConnectInfo = TcpConnectInfo;

    fn connect_info(&self) -> TcpConnectInfo {
        self.socket.connect_info()
    }
}

/// A wait that begins when there is something to wait for, and begins again with each piece that comes.
///
/// The timer is set once a wait and not once a piece: where something has come in the meantime it is set again when it is up.
#[derive(Debug, Default)]
pub(crate) struct Patience {
    timer: Option<Pin<Box<Sleep>>>,
    /// Since when nothing has come; `None` where nobody waits.
    since: Option<Instant>,
}

impl Patience {
    /// Nothing has come: is it time to go? `None` waits for ever.
    pub(crate) fn poll_over(&mut self, cx: &mut Context<'_>, after: Option<Duration>) -> Poll<()> {
        let Some(after) = after else { return Poll::Pending };
        let over = *self.since.get_or_insert_with(Instant::now) + after;
        let timer = self.timer.get_or_insert_with(|| Box::pin(tokio::time::sleep_until(over)));
        if timer.deadline() > over {
            // A shorter patience than before.
            timer.as_mut().reset(over);
        }
        loop {
            ready!(timer.as_mut().poll(cx));
            if timer.deadline() >= over {
                return Poll::Ready(());
            }
            timer.as_mut().reset(over);
        }
    }

    /// Something has come.
    pub(crate) fn again(&mut self) {
        self.since = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test(start_paused = true)]
    async fn patience_lasts_from_the_last_piece() {
        let (second, zero) = (Duration::from_secs(1), Instant::now());
        let mut patience = Patience::default();
        let wait = async |patience: &mut Patience, after| {
            std::future::poll_fn(|cx| patience.poll_over(cx, Some(after))).await;
            zero.elapsed()
        };
        assert!(tokio::time::timeout(second / 2, wait(&mut patience, second)).await.is_err());
        let lasts = |from: Duration, of: Duration, until: Duration| {
            // A timer is up within the next millisecond.
            let late = until.checked_sub(from + of).expect("not before its time");
            assert!(late <= Duration::from_millis(1), "{late:?} late");
            until
        };
        let heard = zero.elapsed();
        patience.again();
        let over = lasts(heard, second, wait(&mut patience, second).await);
        patience.again();
        // A shorter one is up earlier, a longer one later.
        let over = lasts(over, second / 4, wait(&mut patience, second / 4).await);
        patience.again();
        lasts(over, second, wait(&mut patience, second).await);
    }
}
