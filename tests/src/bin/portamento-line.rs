//! A line between axes and a server that is worse than the network: it delays what is said, unevenly, and now and then nothing comes
//! through for a while. For containers, where `tc … netem` takes a kernel that has it, and rights that no container needs.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

use std::error::Error;
use std::io::Write as _;
use std::net::SocketAddr;
use std::time::Duration;

use clap::Parser;
use e2e::{Line, carry_all};
use tokio::net::TcpListener;
use tokio::sync::watch;

/// Carries every connection to a server, later than it came.
#[derive(Debug, Parser)]
#[command(name = "portamento-line")]
struct Args {
    /// Where to listen.
    #[arg(long, value_name = "ADDRESS:PORT")]
    listen: SocketAddr,
    /// Where the server is.
    #[arg(long, value_name = "HOST:PORT")]
    before: String,
    /// What is said arrives after this long at least [ms].
    #[arg(long, default_value = "0", value_name = "MILLISECONDS")]
    least: u64,
    /// What is said arrives after this long at most [ms].
    #[arg(long, default_value = "0", value_name = "MILLISECONDS")]
    most: u64,
    /// How often nothing comes through [ms]; 0: never.
    #[arg(long, default_value = "0", value_name = "MILLISECONDS")]
    stall_every: u64,
    /// For how long nothing comes through then [ms].
    #[arg(long, default_value = "0", value_name = "MILLISECONDS")]
    stall: u64,
}

#[tokio::main(flavor = "current_thread")]
async fn main() -> Result<(), Box<dyn Error>> {
    let Args { listen, before, least, most, stall_every, stall } = Args::parse();
    let as_usual = Line::Delays(Duration::from_millis(least), Duration::from_millis(most.max(least)));
    let (line, lines) = watch::channel(as_usual);
    let listener = TcpListener::bind(listen).await?;
    writeln!(std::io::stderr(), "carrying what comes at {listen} to {before}")?;
    let carrying = carry_all(listener, before, lines);
    let stalling = async {
        if stall_every == 0 {
            return std::future::pending().await;
        }
        let mut due = tokio::time::interval(Duration::from_millis(stall_every));
        due.tick().await;
        loop {
            due.tick().await;
            line.send_replace(Line::Silent);
            let over = tokio::time::Instant::now() + Duration::from_millis(stall);
            tokio::time::sleep_until(over).await;
            line.send_replace(as_usual);
        }
    };
    tokio::select! {
        () = carrying => Ok(()),
        () = stalling => Ok(()),
    }
}
