use std::net::SocketAddr;
use std::time::Duration;

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::net::{TcpListener, TcpStream, ToSocketAddrs};
use tokio::sync::{mpsc, watch};
use tokio::time::Instant;

/// How a line between an axis and a server is: slow, uneven, or silent without being closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line {
    /// What is said arrives after this long at least, and at most.
    Delays(Duration, Duration),
    /// Nothing arrives, and nobody is told: a cable that is pulled out.
    Silent,
}

impl Line {
    /// As fast as can be.
    pub const THROUGH: Self = Self::Delays(Duration::ZERO, Duration::ZERO);
}

/// Carries what comes at `listener` to `server`, whose name is looked up for each connection, and back, as `lines` says, for as long as
/// it is polled.
pub async fn carry_all(
    listener: TcpListener,
    server: impl ToSocketAddrs + Clone + Send + 'static,
    lines: watch::Receiver<Line>,
) {
    while let Ok((axis, _)) = listener.accept().await {
        let Ok(server) = TcpStream::connect(server.clone()).await else { continue };
        // Without it the line would have a delay of its own.
        if axis.set_nodelay(true).and_then(|()| server.set_nodelay(true)).is_err() {
            continue;
        }
        let ((from_axis, to_axis), (from_server, to_server)) = (axis.into_split(), server.into_split());
        carry(from_axis, to_server, lines.clone(), 1);
        carry(from_server, to_axis, lines.clone(), 2);
    }
}

/// A proxy on a port of its own, for as long as the runtime lives.
#[derive(Debug)]
pub struct Proxy {
    address: SocketAddr,
    line: watch::Sender<Line>,
}

impl Proxy {
    /// In front of the server at `server`.
    pub async fn before(server: SocketAddr, line: Line) -> Self {
        let listener = TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], 0))).await.expect("a free port");
        let address = listener.local_addr().expect("an address");
        let (line, lines) = watch::channel(line);
        tokio::spawn(carry_all(listener, server, lines));
        Self { address, line }
    }

    /// Where it is, for a client.
    #[must_use]
    pub fn endpoint(&self) -> String {
        format!("http://{}", self.address)
    }

    /// From now on the line is like this.
    pub fn becomes(&self, line: Line) {
        self.line.send_replace(line);
    }
}
fn carry(mut from: OwnedReadHalf, mut to: OwnedWriteHalf, mut lines: watch::Receiver<Line>, seed: u64) {
    let (said, mut arriving) = mpsc::unbounded_channel::<(Instant, Vec<u8>)>();
    let reads = lines.clone();
    tokio::spawn(async move {
        let (mut drawn, mut last) = (seed, Instant::now());
        let mut bytes = vec![0; 64 << 10];
        while let Ok(read @ 1..) = from.read(&mut bytes).await {
            let due = match *reads.borrow() {
                Line::Delays(least, most) => {
                    Instant::now() + least + (most - least).mul_f64(unit(&mut drawn))
                }
                Line::Silent => Instant::now(),
            };
            // Nothing overtakes what was said before.
            last = last.max(due);
            if said.send((last, bytes[..read].to_vec())).is_err() {
                break;
            }
        }
    });
    tokio::spawn(async move {
        while let Some((due, bytes)) = arriving.recv().await {
            tokio::time::sleep_until(due).await;
            if lines.wait_for(|line| *line != Line::Silent).await.is_err()
                || to.write_all(&bytes).await.is_err()
            {
                break;
            }
        }
    });
}

/// From 0 to 1, the same for the same seed. Source: Steele, Lea and Flood (2014), splitmix64.
fn unit(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}
