//! How many axes two server processes serve on this machine: light axes, which accept, count, digest and report as real ones do, and
//! have no plant. Half-way the server that serves all of them is killed.
//!
//! `cargo build --release -p portamento-server -p e2e && target/release/portamento-load --axes 250,500,1000`

#![allow(clippy::print_stdout, reason = "the table is what it is for")]
#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

mod axis;
mod run;

use std::error::Error;
use std::process::ExitCode;

use clap::Parser;
use serde_json::Value;

/// Measures how many 1 kHz axes this machine serves without an underrun.
#[derive(Clone, Debug, Parser)]
#[command(name = "portamento-load", version)]
struct Args {
    /// How many axes, run after run, until one has an underrun.
    #[arg(long, value_delimiter = ',', default_value = "250,500,1000", value_name = "COUNT")]
    axes: Vec<usize>,
    /// How long they play [s].
    #[arg(long, default_value_t = 20, value_name = "SECONDS")]
    seconds: u64,
    /// Cycles per batch.
    #[arg(long, default_value_t = 20, value_name = "CYCLES")]
    batch: u32,
    /// How far ahead an axis holds its setpoints [cycles].
    #[arg(long, default_value_t = 100, value_name = "CYCLES")]
    lead: u32,
    /// Operations a second, of all axes together: overrides, timed from asking to the answer that says that the axis plays by it.
    #[arg(long, default_value_t = 0.0, value_name = "PER_SECOND")]
    operations: f64,
    /// Axes that share a connection to a server and a beat of reports, as those of one gateway may.
    #[arg(long, default_value_t = 1, value_name = "COUNT")]
    sharing: usize,
    /// Have the axes evaluate their motion themselves: streams carry no setpoints.
    #[arg(long)]
    compact: bool,
    /// Axes of a stream, which arrive together.
    #[arg(long, default_value_t = 1, value_name = "COUNT")]
    axes_each: usize,
    /// Have a stream's motion go through so many points, some three pieces for each, and not by a move of seven pieces.
    #[arg(long, value_name = "COUNT")]
    points: Option<usize>,
    /// How long after one stream the next is opened [ms].
    #[arg(long, default_value_t = 5, value_name = "MILLISECONDS")]
    apart: u64,
    /// Kill no server.
    #[arg(long)]
    no_kill: bool,
    /// Stream from servers that are there already, and kill none.
    #[arg(long, value_delimiter = ',', value_name = "ENDPOINT")]
    at: Vec<String>,
    /// Play until standard input ends, and at most a minute more than --seconds. A line on standard error says that all play.
    #[arg(long)]
    until_input_ends: bool,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
}

impl Args {
    /// What is said once all play.
    const PLAYING: &str = "portamento-load: all play";

    fn kills(&self) -> bool {
        !self.no_kill && self.at.is_empty() && !self.until_input_ends
    }
}

type Failed = Box<dyn Error + Send + Sync>;

fn main() -> ExitCode {
    let args = Args::parse();
    if !args.json {
        println!(
            "{:>6} {:>12} {:>10} {:>10} {:>9} {:>9} {:>9} {:>12} {:>10} {:>10} {:>11}",
            "axes",
            "setpoints/s",
            "underruns",
            "least lead",
            "failovers",
            "p50 [ms]",
            "max [ms]",
            "server [CPU]",
            "axes [CPU]",
            "KiB/stream",
            "B/setpoint"
        );
    }
    let mut rows = Vec::new();
    for axes in args.axes.clone() {
        match run::run(&args, axes) {
            Ok(row) => {
                if !args.json {
                    print_row(&row);
                }
                let missed = row["underruns"] != 0;
                rows.push(row);
                if missed {
                    break;
                }
            }
            Err(error) => {
                eprintln!("portamento-load: {axes} axes: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    if args.json {
        println!("{}", Value::Array(rows));
    }
    ExitCode::SUCCESS
}

fn print_row(row: &Value) {
    let number = |key: &str| row[key].as_f64().unwrap_or(f64::NAN);
    println!(
        "{:>6} {:>12.0} {:>10} {:>10} {:>9} {:>9.2} {:>9.2} {:>12.2} {:>10.2} {:>10.1} {:>11.1}",
        number("axes"),
        number("setpointsPerSecond"),
        number("underruns"),
        number("leastLeadCycles"),
        number("failovers"),
        number("failoverP50Ms"),
        number("failoverMaxMs"),
        number("serverCpu"),
        number("axesCpu"),
        number("kibPerStream"),
        number("bytesPerSetpoint")
    );
    if row["operations"] != 0 {
        println!(
            "       {} operations confirmed after: p50 {:.1}, p99 {:.1}, max {:.1} ms; refused {}",
            row["operations"],
            number("operationP50Ms"),
            number("operationP99Ms"),
            number("operationMaxMs"),
            row["operationsRefused"]
        );
    }
}
