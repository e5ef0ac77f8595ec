//! `portamento-server`: settings, then the server, then an exit code.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

use std::net::SocketAddr;
use std::process::ExitCode;
use std::time::Duration;

use clap::{Parser, Subcommand};
use server::{Config, Server, ServerError};
use tokio::signal::unix::{SignalKind, signal};
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_check_response::ServingStatus;
use tonic_health::pb::health_client::HealthClient;

/// Plans jerk-limited motion and streams it to axes, over gRPC.
#[derive(Debug, Parser)]
#[command(
    name = "portamento-server",
    version,
    after_help = "Example:\n  portamento-server --listen 127.0.0.1:50051"
)]
struct Args {
    /// Where to listen; port 0 takes any free one.
    #[arg(long, env = "PORTAMENTO_LISTEN", default_value = "127.0.0.1:50051", value_name = "ADDRESS:PORT")]
    listen: SocketAddr,
    /// The name by which axes know this replica [default: its address].
    #[arg(long, env = "PORTAMENTO_SERVED_BY", value_name = "NAME")]
    served_by: Option<String>,
    /// Serve addresses that other machines reach, without encryption.
    #[arg(long, env = "PORTAMENTO_INSECURE")]
    insecure: bool,
    /// How long streams may take to end after SIGTERM [s].
    #[arg(long, env = "PORTAMENTO_DRAIN_DEADLINE", default_value_t = 10.0, value_name = "SECONDS")]
    drain_deadline: f64,
    /// The most streams at a time.
    #[arg(long, env = "PORTAMENTO_MAX_STREAMS", default_value_t = 10_000, value_name = "COUNT")]
    max_streams: usize,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Ask the server at the listen address whether it serves; exit 0 if it does.
    Healthcheck,
}

/// A setting is wrong.
const EXIT_USAGE: u8 = 64;

fn main() -> ExitCode {
    let args = Args::parse();
    tracing_subscriber::fmt()
        .with_env_filter(
            tracing_subscriber::EnvFilter::try_from_default_env().unwrap_or_else(|_| "info".into()),
        )
        .with_writer(std::io::stderr)
        .init();
    let runtime = match tokio::runtime::Builder::new_multi_thread().enable_all().build() {
        Ok(runtime) => runtime,
        Err(error) => return failed(&format!("cannot start: {error}"), 1),
    };
    runtime.block_on(async {
        match args.command {
            Some(Command::Healthcheck) => healthcheck(args.listen).await,
            None => serve(args).await,
        }
    })
}

async fn serve(args: Args) -> ExitCode {
    let Args { listen, served_by, insecure, drain_deadline, max_streams, command: _ } = args;
    let Ok(drain_deadline) = Duration::try_from_secs_f64(drain_deadline) else {
        return failed(&format!("drain-deadline is {drain_deadline}: give seconds, 0 or more"), EXIT_USAGE);
    };
    let config = Config { listen, served_by, insecure, drain_deadline, max_streams, ..Config::default() };
    let server = match Server::bind(config).await {
        Ok(server) => server,
        Err(error @ ServerError::Config(_)) => return failed(&error.to_string(), EXIT_USAGE),
        Err(error) => return failed(&error.to_string(), 1),
    };
    // As the first process of a container there is no default action for SIGTERM: it has to be taken.
    let (mut terminate, mut interrupt) =
        match (signal(SignalKind::terminate()), signal(SignalKind::interrupt())) {
            (Ok(terminate), Ok(interrupt)) => (terminate, interrupt),
            (Err(error), _) | (_, Err(error)) => return failed(&format!("cannot take signals: {error}"), 1),
        };
    let stop = async move {
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
    };
    match server.run(stop).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failed(&error.to_string(), 1),
    }
}

async fn healthcheck(listen: SocketAddr) -> ExitCode {
    let address =
        if listen.ip().is_unspecified() { SocketAddr::from(([127, 0, 0, 1], listen.port())) } else { listen };
    let asked = async {
        let endpoint = tonic::transport::Endpoint::from_shared(format!("http://{address}"));
        let channel = endpoint.map_err(|e| e.to_string())?.connect().await.map_err(|e| e.to_string())?;
        let mut client = HealthClient::new(channel);
        let service = "motion.v1.PlannerService".to_owned();
        let answer = client.check(HealthCheckRequest { service }).await.map_err(|e| e.to_string())?;
        Ok::<_, String>(answer.into_inner().status())
    };
    match tokio::time::timeout(Duration::from_secs(2), asked).await {
        Ok(Ok(ServingStatus::Serving)) => ExitCode::SUCCESS,
        Ok(Ok(status)) => failed(&format!("the server at {address} is {}", status.as_str_name()), 1),
        Ok(Err(error)) => failed(&format!("no answer from {address}: {error}"), 1),
        Err(_) => failed(&format!("no answer from {address} within 2 s"), 1),
    }
}

fn failed(text: &str, code: u8) -> ExitCode {
    use std::io::Write as _;
    // Where standard error is closed, the exit code has to do.
    let _ = writeln!(std::io::stderr(), "portamento-server: {text}");
    ExitCode::from(code)
}
