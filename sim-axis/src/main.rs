//! `portamento-sim-axis`: settings, then the simulator, then an exit code.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

use clap::{Parser, Subcommand};
use sim_axis::{Config, Models, SimAxis, SimAxisError};
use tokio::signal::unix::{SignalKind, signal};
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_check_response::ServingStatus;
use tonic_health::pb::health_client::HealthClient;

/// Simulates servo axes that follow streams of setpoints, and tells how well they did, over gRPC.
#[derive(Debug, Parser)]
#[command(
    name = "portamento-sim-axis",
    version,
    after_help = "Example:\n  portamento-sim-axis --listen 127.0.0.1:50052 --model gantry.json"
)]
struct Args {
    /// Where to listen; port 0 takes any free one.
    #[arg(
        long,
        env = "PORTAMENTO_SIM_AXIS_LISTEN",
        default_value = "127.0.0.1:50052",
        value_name = "ADDRESS:PORT"
    )]
    listen: SocketAddr,
    /// Serve addresses that other machines reach, without encryption.
    #[arg(long, env = "PORTAMENTO_INSECURE")]
    insecure: bool,
    /// The models of the axes, as JSON: a list of motion.v1.AxisModel, or an answer of GetAxisModel. One with an empty
    /// name is that of every other axis; without one, such axes follow ideally.
    #[arg(long, env = "PORTAMENTO_SIM_AXIS_MODEL", value_name = "FILE.json")]
    model: Option<PathBuf>,
    /// How long runs may take to end after SIGTERM [s].
    #[arg(long, env = "PORTAMENTO_DRAIN_DEADLINE", default_value_t = 10.0, value_name = "SECONDS")]
    drain_deadline: f64,
    /// The most runs at a time.
    #[arg(long, env = "PORTAMENTO_SIM_AXIS_MAX_RUNS", default_value_t = 64, value_name = "COUNT")]
    max_runs: usize,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Ask the simulator at the listen address whether it serves; exit 0 if it does.
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
    let Args { listen, insecure, model, drain_deadline, max_runs, command: _ } = args;
    let models = match model.as_deref().map_or(Ok(Models::default()), read_models) {
        Ok(models) => models,
        Err(text) => return failed(&text, EXIT_USAGE),
    };
    let Ok(drain_deadline) = Duration::try_from_secs_f64(drain_deadline) else {
        return failed(&format!("drain-deadline is {drain_deadline}: give seconds, 0 or more"), EXIT_USAGE);
    };
    let config = Config { listen, insecure, models, drain_deadline, max_runs, ..Config::default() };
    let axis = match SimAxis::bind(config).await {
        Ok(axis) => axis,
        Err(error @ SimAxisError::Config(_)) => return failed(&error.to_string(), EXIT_USAGE),
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
    match axis.run(stop).await {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => failed(&error.to_string(), 1),
    }
}

fn read_models(path: &Path) -> Result<Models, String> {
    let said = |error: &dyn std::fmt::Display| format!("model {}: {error}", path.display());
    let text = std::fs::read_to_string(path).map_err(|error| said(&error))?;
    sim_axis::models_from_json(&text).map_err(|error| said(&error))
}

async fn healthcheck(listen: SocketAddr) -> ExitCode {
    let address =
        if listen.ip().is_unspecified() { SocketAddr::from(([127, 0, 0, 1], listen.port())) } else { listen };
    let asked = async {
        let endpoint = tonic::transport::Endpoint::from_shared(format!("http://{address}"));
        let channel = endpoint.map_err(|e| e.to_string())?.connect().await.map_err(|e| e.to_string())?;
        let mut client = HealthClient::new(channel);
        let service = "motion.v1.SimAxisService".to_owned();
        let answer = client.check(HealthCheckRequest { service }).await.map_err(|e| e.to_string())?;
        Ok::<_, String>(answer.into_inner().status())
    };
    match tokio::time::timeout(Duration::from_secs(2), asked).await {
        Ok(Ok(ServingStatus::Serving)) => ExitCode::SUCCESS,
        Ok(Ok(status)) => failed(&format!("the simulator at {address} is {}", status.as_str_name()), 1),
        Ok(Err(error)) => failed(&format!("no answer from {address}: {error}"), 1),
        Err(_) => failed(&format!("no answer from {address} within 2 s"), 1),
    }
}

fn failed(text: &str, code: u8) -> ExitCode {
    use std::io::Write as _;
    // Where standard error is closed, the exit code has to do.
    let _ = writeln!(std::io::stderr(), "portamento-sim-axis: {text}");
    ExitCode::from(code)
}
