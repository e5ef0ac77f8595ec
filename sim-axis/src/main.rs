//! `portamento-sim-axis`: settings, then the simulator, then an exit code.

#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{CommandFactory as _, Parser, Subcommand};
use client::Connect;
use serving::{Address, Arguments, Flags, Given, Misfits, told_to_stop};
use sim_axis::{Config, Models, SimAxis};

/// Simulates servo axes that follow streams of setpoints, and tells how well they did, over gRPC.
#[derive(Debug, Parser)]
#[command(
    name = "portamento-sim-axis",
    version,
    allow_negative_numbers = true,
    after_help = "Examples:\n  portamento-sim-axis --listen 127.0.0.1:50052 --model gantry.json\n  \
                  portamento-sim-axis --config deploy/config/sim-axis.toml"
)]
struct Args {
    /// Where to listen: a port, of which 0 takes any free one, or unix:/PATH, a socket that processes of this user and
    /// group reach (mode 0660), without --insecure; one that nobody listens at is replaced, and it is removed at the end.
    #[arg(
        long,
        env = "PORTAMENTO_SIM_AXIS_LISTEN",
        default_value = "127.0.0.1:50052",
        value_name = "ADDRESS"
    )]
    listen: Given<Address>,
    /// Where to serve HTTP beside gRPC: /healthz, /readyz, /metrics, and pages for people; nowhere by default.
    #[arg(long, env = "PORTAMENTO_SIM_AXIS_HTTP", value_name = "ADDRESS:PORT")]
    http: Option<Given<SocketAddr>>,
    /// The models of the axes, as JSON: a list of motion.v1.AxisModel, or an answer of GetAxisModel. One with an empty
    /// name is that of every other axis; without one, such axes follow ideally.
    #[arg(long, env = "PORTAMENTO_SIM_AXIS_MODEL", value_name = "FILE.json")]
    model: Option<PathBuf>,
    /// The most runs at a time.
    #[arg(long, env = "PORTAMENTO_SIM_AXIS_MAX_RUNS", default_value = "64", value_name = "COUNT")]
    max_runs: Given<usize>,
    /// Let callers make things go wrong, by InjectFault: for rehearsals, never with a machine behind it.
    #[arg(long, env = "PORTAMENTO_SIM_AXIS_FAULT_INJECTION", default_value = "false", default_missing_value = "true", num_args = 0..=1, require_equals = true, value_name = "BOOL")]
    fault_injection: Given<bool>,
    #[command(flatten)]
    planners: PlannerFlags,
    #[command(flatten)]
    flags: Flags,
    #[command(subcommand)]
    command: Option<Command>,
}

const PLANNERS: &str = "How planners are connected to";

#[derive(Debug, clap::Args)]
struct PlannerFlags {
    /// Who vouches for planners: needed where endpoints begin with https://.
    #[arg(long, env = "PORTAMENTO_TLS_CA", value_name = "FILE.pem", help_heading = PLANNERS)]
    tls_ca: Option<PathBuf>,
    /// The certificate that planners know the axis by.
    #[arg(long, env = "PORTAMENTO_TLS_IDENTITY_CERT", value_name = "FILE.pem", help_heading = PLANNERS)]
    tls_identity_cert: Option<PathBuf>,
    /// The key of that certificate.
    #[arg(long, env = "PORTAMENTO_TLS_IDENTITY_KEY", value_name = "FILE.pem", help_heading = PLANNERS)]
    tls_identity_key: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, Subcommand)]
enum Command {
    /// Ask the simulator with these settings whether it serves; exit 0 if it does.
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
    serving::process("portamento-sim-axis", async |args: Args, misfits| {
        let command = args.command;
        if let Some(Command::Settings) = command {
            return serving::print(&serving::settings_file(&Args::command()));
        }
        let (config, misfits) = config(args, misfits);
        if let Some(Command::Healthcheck) = command {
            // Whoever asks need not be told all that the process was.
            return serving::healthcheck(&config.serving, "motion.v1.SimAxisService").await;
        }
        let axis = SimAxis::bind(misfits.into_result(config)?).await?;
        Ok(axis.run(told_to_stop()?).await?)
    })
}

/// The settings, and everything that is wrong with them.
fn config(args: Args, mut misfits: Misfits) -> (Config, Misfits) {
    let Args { listen, http, model, max_runs, fault_injection, planners, flags, command: _ } = args;
    let serving = flags.settings(listen, http, &mut misfits);
    let usual = Config::default();
    let max_runs = max_runs.or_note("max-runs", usual.max_runs, &mut misfits);
    let models = model.as_deref().map_or(Ok(Models::default()), read_models).unwrap_or_else(|problem| {
        misfits.note("model", problem);
        Models::default()
    });
    let fault_injection = fault_injection.or_note("fault-injection", false, &mut misfits);
    let connect = connect(planners, &mut misfits);
    let config = Config { serving, models, max_runs, connect, fault_injection };
    misfits.extend(config.misfits());
    (config, misfits)
}

fn connect(flags: PlannerFlags, misfits: &mut Misfits) -> Connect {
    let PlannerFlags { tls_ca, tls_identity_cert, tls_identity_key } = flags;
    let mut read = |setting, path: Option<PathBuf>| {
        let path = path?;
        let problem = |error| format!("{} cannot be read: {error}: name a PEM file", path.display());
        std::fs::read(&path).map_err(|error| misfits.note(setting, problem(error))).ok()
    };
    let names_both = tls_identity_cert.is_some() == tls_identity_key.is_some();
    let authority = read("tls-ca", tls_ca);
    let certificate = read("tls-identity-cert", tls_identity_cert);
    let key = read("tls-identity-key", tls_identity_key);
    if !names_both {
        misfits.note("tls-identity-cert", "and tls-identity-key go together: give both, or neither");
    }
    let connect = Connect::new();
    let connect = authority.into_iter().fold(connect, Connect::with_authority);
    match (certificate, key) {
        (Some(certificate), Some(key)) => connect.with_identity(certificate, key),
        _ => connect,
    }
}

fn read_models(path: &Path) -> Result<Models, String> {
    let said = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
    let text = std::fs::read_to_string(path).map_err(|error| said(&error))?;
    sim_axis::models_from_json(&text).map_err(|error| said(&error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_of_flags_and_library_are_the_same() {
        let args = Args::try_parse_from(["portamento-sim-axis"]).unwrap();
        assert_eq!(config(args, Misfits::default()), (Config::default(), Misfits::default()));
    }
}
