//! `portamento-server`: settings, then the server, then an exit code.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory as _, Parser, Subcommand};
use server::{Config, Limits, Server};
use serving::{Address, Arguments, Flags, Given, Misfits, told_to_stop};

/// Plans jerk-limited motion and streams it to axes, over gRPC.
#[derive(Debug, Parser)]
#[command(
    name = "portamento-server",
    version,
    allow_negative_numbers = true,
    after_help = "Examples:\n  portamento-server --listen 127.0.0.1:50051 --http 127.0.0.1:9090\n  \
                  portamento-server --config deploy/config/server.toml"
)]
struct Args {
    /// Where to listen: a port, of which 0 takes any free one, or unix:/PATH, a socket that processes of this user and
    /// group reach (mode 0660), without --insecure; one that nobody listens at is replaced, and it is removed at the end.
    #[arg(long, env = "PORTAMENTO_LISTEN", default_value = "127.0.0.1:50051", value_name = "ADDRESS")]
    listen: Given<Address>,
    /// Where to serve HTTP beside gRPC: /healthz, /readyz, /metrics, and pages for people; nowhere by default.
    #[arg(long, env = "PORTAMENTO_HTTP", value_name = "ADDRESS:PORT")]
    http: Option<Given<SocketAddr>>,
    /// The name by which axes know this replica [default: its address].
    #[arg(long, env = "PORTAMENTO_SERVED_BY", value_name = "NAME")]
    served_by: Option<String>,
    /// Write every stream down in this folder, a file of MCAP for each, for `portamento replay`, Foxglove and PlotJuggler.
    #[arg(long, env = "PORTAMENTO_RECORD", value_name = "FOLDER")]
    record: Option<PathBuf>,
    /// A name under which people reach the console, beside addresses and localhost; may be given several times.
    #[arg(long, env = "PORTAMENTO_CONSOLE_HOST", value_delimiter = ',', value_name = "NAME")]
    console_host: Vec<String>,
    #[command(flatten)]
    flags: Flags,
    #[command(flatten)]
    motion: MotionFlags,
    #[command(subcommand)]
    command: Option<Command>,
}

const MOTION: &str = "How large a motion may be";

#[derive(Debug, clap::Args)]
struct MotionFlags {
    /// The most streams at a time.
    #[arg(long, env = "PORTAMENTO_MAX_STREAMS", default_value = "10000", value_name = "COUNT", help_heading = MOTION)]
    max_streams: Given<usize>,
    /// The most streams of one identity at a time.
    #[arg(long, env = "PORTAMENTO_MAX_STREAMS_PER_IDENTITY", default_value = "10000", value_name = "COUNT", help_heading = MOTION)]
    max_streams_per_identity: Given<usize>,
    /// The most axes of one plan or stream, up to 64.
    #[arg(long, env = "PORTAMENTO_MAX_AXES", default_value = "64", value_name = "COUNT", help_heading = MOTION)]
    max_axes: Given<usize>,
    /// The most requests in a message of PlanMany.
    #[arg(long, env = "PORTAMENTO_MAX_PLANS_PER_MESSAGE", default_value = "4096", value_name = "COUNT", help_heading = MOTION)]
    max_plans_per_message: Given<usize>,
    /// The most segments of a plan that is sent in, of all its axes together.
    #[arg(long, env = "PORTAMENTO_MAX_SEGMENTS", default_value = "1000000", value_name = "COUNT", help_heading = MOTION)]
    max_segments: Given<usize>,
    /// The most cycles of a motion that is streamed: a thousand hours at 1 ms.
    #[arg(long, env = "PORTAMENTO_MAX_CYCLES", default_value = "3600000000", value_name = "COUNT", help_heading = MOTION)]
    max_cycles: Given<u64>,
    /// The most points of a PlanPvt request, of all its axes together.
    #[arg(long, env = "PORTAMENTO_MAX_PVT_POINTS", default_value = "60000", value_name = "COUNT", help_heading = MOTION)]
    max_pvt_points: Given<usize>,
    /// The farthest cycle that SamplePlan gives: ten hours at 1 ms.
    #[arg(long, env = "PORTAMENTO_MAX_SAMPLE_CYCLES", default_value = "36000000", value_name = "COUNT", help_heading = MOTION)]
    max_sample_cycles: Given<u64>,
}

#[derive(Clone, Copy, Debug, Subcommand)]
enum Command {
    /// Ask the server with these settings whether it serves; exit 0 if it does.
    Healthcheck,
    /// Print every setting with its unit and default, as a file for --config.
    Settings,
}

impl Arguments for Args {
    fn flags(&self) -> &Flags {
        &self.flags
    }
}

fn main() -> ExitCode {
    serving::process("portamento-server", async |args: Args, misfits| {
        let command = args.command;
        if let Some(Command::Settings) = command {
            return serving::print(&serving::settings_file(&Args::command()));
        }
        let (config, misfits) = config(args, misfits);
        if let Some(Command::Healthcheck) = command {
            // Whoever asks need not be told all that the process was.
            return serving::healthcheck(&config.serving, "motion.v1.PlannerService").await;
        }
        let server = Server::bind(misfits.into_result(config)?).await?;
        Ok(server.run(told_to_stop()?).await?)
    })
}

/// The settings, and everything that is wrong with them.
fn config(args: Args, mut misfits: Misfits) -> (Config, Misfits) {
    let Args { listen, http, served_by, record, console_host: console_hosts, flags, motion, command: _ } =
        args;
    let serving = flags.settings(listen, http, &mut misfits);
    let MotionFlags {
        max_streams,
        max_streams_per_identity,
        max_axes,
        max_plans_per_message,
        max_segments,
        max_cycles,
        max_pvt_points,
        max_sample_cycles,
    } = motion;
    let usual = Limits::default();
    let limits = Limits {
        streams: max_streams.or_note("max-streams", usual.streams, &mut misfits),
        streams_per_identity: max_streams_per_identity.or_note(
            "max-streams-per-identity",
            usual.streams_per_identity,
            &mut misfits,
        ),
        axes: max_axes.or_note("max-axes", usual.axes, &mut misfits),
        plans_per_message: max_plans_per_message.or_note(
            "max-plans-per-message",
            usual.plans_per_message,
            &mut misfits,
        ),
        segments: max_segments.or_note("max-segments", usual.segments, &mut misfits),
        cycles: max_cycles.or_note("max-cycles", usual.cycles, &mut misfits),
        pvt_points: max_pvt_points.or_note("max-pvt-points", usual.pvt_points, &mut misfits),
        sample_cycles: max_sample_cycles.or_note("max-sample-cycles", usual.sample_cycles, &mut misfits),
    };
    let config = Config { serving, served_by, limits, record, console_hosts };
    misfits.extend(config.misfits());
    (config, misfits)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_of_flags_and_library_are_the_same() {
        let args = Args::try_parse_from(["portamento-server"]).unwrap();
        assert_eq!(config(args, Misfits::default()), (Config::default(), Misfits::default()));
    }
}
