//! `portamento-sim-axis`: settings, then the simulator, then an exit code.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use serving::{Exit, Settings, seconds, told_to_stop};
use sim_axis::{Config, Models, SimAxis};

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
    /// Where to serve HTTP beside gRPC: /healthz, /readyz, /metrics, and pages for people; nowhere by default.
    #[arg(long, env = "PORTAMENTO_SIM_AXIS_HTTP", value_name = "ADDRESS:PORT")]
    http: Option<SocketAddr>,
    /// Serve addresses that other machines reach, without encryption.
    #[arg(long, env = "PORTAMENTO_INSECURE")]
    insecure: bool,
    /// The models of the axes, as JSON: a list of motion.v1.AxisModel, or an answer of GetAxisModel. One with an empty
    /// name is that of every other axis; without one, such axes follow ideally.
    #[arg(long, env = "PORTAMENTO_SIM_AXIS_MODEL", value_name = "FILE.json")]
    model: Option<PathBuf>,
    /// How long runs may take to end after SIGTERM [s].
    #[arg(
        long,
        env = "PORTAMENTO_DRAIN_DEADLINE",
        default_value_t = 10.0,
        value_name = "SECONDS",
        allow_negative_numbers = true
    )]
    drain_deadline: f64,
    /// The most runs at a time.
    #[arg(long, env = "PORTAMENTO_SIM_AXIS_MAX_RUNS", default_value_t = 64, value_name = "COUNT")]
    max_runs: usize,
    /// The largest message that is read or sent [bytes].
    #[arg(long, env = "PORTAMENTO_MAX_MESSAGE_BYTES", default_value_t = proto::MAX_MESSAGE_BYTES, value_name = "COUNT")]
    max_message_bytes: usize,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Ask the simulator at the listen address whether it serves; exit 0 if it does.
    Healthcheck,
}

fn main() -> ExitCode {
    serving::process("portamento-sim-axis", async |args: Args| match args.command {
        Some(Command::Healthcheck) => serving::healthcheck(args.listen, "motion.v1.SimAxisService").await,
        None => {
            let axis = SimAxis::bind(config(args)?).await?;
            Ok(axis.run(told_to_stop()?).await?)
        }
    })
}

/// The settings, or everything that is wrong with them.
fn config(args: Args) -> Result<Config, Exit> {
    let Args { listen, http, insecure, model, drain_deadline, max_runs, max_message_bytes, command: _ } =
        args;
    let settings = Settings { listen, http, insecure, max_message_bytes, ..Settings::on_port(0) };
    let mut config = Config { serving: settings, max_runs, ..Config::default() };
    let mut misfits = config.misfits();
    match seconds(drain_deadline) {
        Ok(deadline) => config.serving.drain_deadline = deadline,
        Err(problem) => misfits.note("drain-deadline", problem),
    }
    match model.as_deref().map_or(Ok(Models::default()), read_models) {
        Ok(models) => config.models = models,
        Err(problem) => misfits.note("model", problem),
    }
    Ok(misfits.into_result(config)?)
}

fn read_models(path: &Path) -> Result<Models, String> {
    let said = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = std::fs::read_to_string(path).map_err(|error| said(&error))?;
    sim_axis::models_from_json(&text).map_err(|error| said(&error))
}
