//! A line between an axis and a server, that is slow, uneven, or goes silent without being closed.

use std::net::SocketAddr;
use std::time::Duration;

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{mpsc, watch};
use tokio::time::Instant;

/// How a line is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Line {
    /// What is said arrives after this long at least, and at most.
    Delays(Duration, Duration),
    /// Nothing arrives, and nobody is told: a cable that is pulled out.
    Silent,
}

/// As fast as can be.
pub(crate) const THROUGH: Line = Line::Delays(Duration::ZERO, Duration::ZERO);

/// A proxy on a port of its own, for as long as the runtime lives.
pub(crate) struct Proxy {
    address: SocketAddr,
    line: watch::Sender<Line>,
}

impl Proxy {
    /// In front of the server at `server`.
    pub(crate) async fn before(server: SocketAddr, line: Line) -> Self {
        let listener = TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], 0))).await.unwrap();
        let address = listener.local_addr().unwrap();
        let (line, lines) = watch::channel(line);
        tokio::spawn(async move {
            while let Ok((axis, _)) = listener.accept().await {
                let Ok(server) = TcpStream::connect(server).await else { continue };
                axis.set_nodelay(true).unwrap();
                server.set_nodelay(true).unwrap();
                let ((from_axis, to_axis), (from_server, to_server)) =
                    (axis.into_split(), server.into_split());
                carry(from_axis, to_server, lines.clone(), 1);
                carry(from_server, to_axis, lines.clone(), 2);
            }
        });
        Self { address, line }
    }

    pub(crate) fn endpoint(&self) -> String {
        format!("http://{}", self.address)
    }

    /// From now on the line is like this.
    pub(crate) fn becomes(&self, line: Line) {
        self.line.send_replace(line);
    }
}

/// A server that takes connections and says nothing on them, for as long as the runtime lives. Gives where it is.
pub(crate) async fn mute() -> String {
    let listener = TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], 0))).await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(async move {
        let mut held = Vec::new();
        while let Ok((axis, _)) = listener.accept().await {
            held.push(axis);
        }
    });
    format!("http://{address}")
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
