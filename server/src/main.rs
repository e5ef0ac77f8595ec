//! `portamento-server`: settings, then the server, then an exit code.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use server::{Config, Server, Settings};
use serving::{Exit, seconds, told_to_stop};

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
    /// Where to serve HTTP beside gRPC: /healthz, /readyz, /metrics, and pages for people; nowhere by default.
    #[arg(long, env = "PORTAMENTO_HTTP", value_name = "ADDRESS:PORT")]
    http: Option<SocketAddr>,
    /// Write every stream down in this folder, a file of MCAP for each, for `portamento replay`, Foxglove and PlotJuggler.
    #[arg(long, env = "PORTAMENTO_RECORD", value_name = "FOLDER")]
    record: Option<PathBuf>,
    /// A name under which people reach the console, beside addresses and localhost; may be given several times.
    #[arg(long, env = "PORTAMENTO_CONSOLE_HOST", value_delimiter = ',', value_name = "NAME")]
    console_host: Vec<String>,
    /// Serve addresses that other machines reach, without encryption.
    #[arg(long, env = "PORTAMENTO_INSECURE")]
    insecure: bool,
    /// How long streams may take to end after SIGTERM [s].
    #[arg(
        long,
        env = "PORTAMENTO_DRAIN_DEADLINE",
        default_value_t = 10.0,
        value_name = "SECONDS",
        allow_negative_numbers = true
    )]
    drain_deadline: f64,
    /// The most streams at a time.
    #[arg(long, env = "PORTAMENTO_MAX_STREAMS", default_value_t = 10_000, value_name = "COUNT")]
    max_streams: usize,
    /// The most points of a PlanPvt request, of all its axes together.
    #[arg(long, env = "PORTAMENTO_MAX_PVT_POINTS", default_value_t = 60_000, value_name = "COUNT")]
    max_pvt_points: usize,
    /// The largest message that is read or sent [bytes].
    #[arg(long, env = "PORTAMENTO_MAX_MESSAGE_BYTES", default_value_t = proto::MAX_MESSAGE_BYTES, value_name = "COUNT")]
    max_message_bytes: usize,
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Ask the server at the listen address whether it serves; exit 0 if it does.
    Healthcheck,
}

fn main() -> ExitCode {
    serving::process("portamento-server", async |args: Args| match args.command {
        Some(Command::Healthcheck) => serving::healthcheck(args.listen, "motion.v1.PlannerService").await,
        None => {
            let server = Server::bind(config(args)?).await?;
            Ok(server.run(told_to_stop()?).await?)
        }
    })
}

/// The settings, or everything that is wrong with them.
fn config(args: Args) -> Result<Config, Exit> {
    let Args {
        listen,
        served_by,
        http,
        record,
        console_host: console_hosts,
        insecure,
        drain_deadline,
        max_streams,
        max_pvt_points,
        max_message_bytes,
        command: _,
    } = args;
    let settings = Settings { listen, http, insecure, max_message_bytes, ..Settings::on_port(0) };
    let mut config = Config {
        serving: settings,
        served_by,
        max_streams,
        max_pvt_points,
        record,
        console_hosts,
        ..Config::default()
    };
    let mut misfits = config.misfits();
    match seconds(drain_deadline) {
        Ok(deadline) => config.serving.drain_deadline = deadline,
        Err(problem) => misfits.note("drain-deadline", problem),
    }
    Ok(misfits.into_result(config)?)
}
