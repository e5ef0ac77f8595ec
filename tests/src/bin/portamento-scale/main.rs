//! How cost grows with axes, points, pieces and streams: measured on this machine, fitted, drawn; and what a plant needs by that.
//!
//! `cargo build --release --workspace --bins && target/release/portamento-scale --into notes/0020-scale`, with nothing else on the machine, takes
//! six minutes. `--from notes/0020-scale/measured.jsonl` draws again what was measured.
//!
//! - `measured`: figures, and how they are kept
//! - `library`, `service`, `streams`, `calls`: what is measured in this process, and with servers of its own
//! - `fit`, `figure`, `table`: laws, drawings, and the tables of the note
//! - `sized`: plants, from the laws

#![allow(clippy::print_stdout, reason = "what becomes of it is what it is for")]
#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

mod calls;
mod figure;
mod fit;
mod library;
mod measured;
mod service;
mod sized;
mod streams;
mod table;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use measured::{Measured, Point};

/// Measures how cost grows on this machine, fits and draws it, and sizes plants.
#[derive(Clone, Debug, Parser)]
#[command(name = "portamento-scale", version)]
struct Args {
    /// Draw what was measured before, and measure nothing.
    #[arg(long, value_name = "FILE")]
    from: Option<PathBuf>,
    /// Where `measured.jsonl`, `tables.md` and the figures go.
    #[arg(long, default_value = "target/scale", value_name = "DIRECTORY")]
    into: PathBuf,
    /// How often everything is measured, in turn.
    #[arg(long, default_value_t = 3, value_name = "COUNT")]
    rounds: usize,
    /// How long streams are measured [s]; calls three times as long.
    #[arg(long, default_value_t = 1, value_name = "SECONDS")]
    seconds: u64,
    /// Measure these alone.
    #[arg(long, value_delimiter = ',', value_name = "PART")]
    only: Vec<Part>,
    /// What everything random is drawn from in simulated plants.
    #[arg(long, default_value_t = 1, value_name = "SEED")]
    seed: u64,
    /// Tell the memory of a plan through so many points, and do nothing else.
    #[arg(long, hide = true)]
    weigh: Option<usize>,
}

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Part {
    Library,
    Service,
    Streams,
    Calls,
}

type Failed = Box<dyn Error + Send + Sync>;

fn main() -> ExitCode {
    let args = Args::parse();
    match run(&args) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("portamento-scale: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(args: &Args) -> Result<(), Failed> {
    if let Some(points) = args.weigh {
        println!("{}", library::weigh(points)?);
        return Ok(());
    }
    std::fs::create_dir_all(&args.into)?;
    let points = match &args.from {
        Some(file) => measured::read(file)?,
        None => measure(args, &args.into.join("measured.jsonl"))?,
    };
    for (name, svg) in figure::all(&points)? {
        std::fs::write(args.into.join(name), svg)?;
    }
    let tables = table::all(&points, args.seed)?;
    std::fs::write(args.into.join("tables.md"), &tables)?;
    println!("{tables}");
    Ok(())
}

fn measure(args: &Args, file: &Path) -> Result<Vec<Point>, Failed> {
    let mut measured = Measured::default();
    let wanted = |part| args.only.is_empty() || args.only.contains(&part);
    for round in 1..=args.rounds {
        eprintln!("round {round} of {}", args.rounds);
        // Streams first: what measures library and service leaves much memory behind.
        if wanted(Part::Streams) {
            streams::measure(args, &mut measured)?;
        }
        if wanted(Part::Service) {
            service::measure(&mut measured)?;
        }
        if wanted(Part::Library) {
            library::measure(&mut measured)?;
        }
    }
    if wanted(Part::Calls) {
        calls::measure(args, &mut measured)?;
    }
    let points = measured.points();
    measured::write(file, &points)?;
    Ok(points)
}
