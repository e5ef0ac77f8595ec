//! How many plans a second one server process gives on this machine, the asking side included: empty calls of the sizes of `Plan`
//! through the same layers, `Plan` itself, `PlanMany`, and `PlanMany` in columns. And how long an answer of `Plan` takes, with and without
//! streams that the same server serves beside.
//!
//! `Plan` is asked twice beside empty calls: by somebody who takes the plan as bytes, as those take them who make the empty calls, which
//! shows what the planner costs its server; and by somebody who reads it.
//!
//! `cargo build --release --workspace --bins && target/release/portamento-plans`, or
//! `target/release/portamento-plans --single --streams-beside 200`

#![allow(clippy::print_stdout, reason = "the table is what it is for")]
#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

mod asking;
mod beside;
mod empty;

use std::error::Error;
use std::process::{Command, ExitCode};

use asking::{Measured, calling, in_columns, moves, pacing, streaming};
use beside::Beside;
use clap::Parser;
use client::Client;
use e2e::{Process, fifty_millimetres};
use empty::{Empty, Filling, ask_empty, serve_empty};
use prost::Message;
use proto::pb::planner_service_client::PlannerServiceClient;
use proto::{Detail, outgoing, pb, plan_to_wire};
use serde_json::{Value, json};
use tonic::codegen::http;
use tonic::transport::Channel;
use tonic_prost::ProstCodec;

/// Measures how many plans a second this machine gives, and how many empty calls.
#[derive(Clone, Debug, Parser)]
#[command(name = "portamento-plans", version)]
struct Args {
    /// How long each is measured, in each round [s].
    #[arg(long, default_value_t = 3, value_name = "SECONDS")]
    seconds: u64,
    /// How often all are measured, in turn.
    #[arg(long, default_value_t = 3, value_name = "COUNT")]
    rounds: usize,
    /// Calls that wait at a time.
    #[arg(long, default_value_t = 64, value_name = "COUNT")]
    concurrency: usize,
    /// Streams of PlanMany at a time.
    #[arg(long, default_value_t = 2, value_name = "COUNT")]
    streams: usize,
    /// Requests in a message of PlanMany.
    #[arg(long, default_value_t = 256, value_name = "COUNT")]
    per_message: usize,
    /// Moves in a message of columns.
    #[arg(long, default_value_t = 4096, value_name = "COUNT")]
    per_columns: usize,
    /// Measure columns alone.
    #[arg(long)]
    columns: bool,
    /// Measure single calls of Plan alone.
    #[arg(long, conflicts_with = "columns")]
    single: bool,
    /// Measure empty calls and Plan beside them alone: many short rounds tell most.
    #[arg(long, conflicts_with_all = ["columns", "single"])]
    against_empty: bool,
    /// Calls a second of Plan where they are made by the clock, whether the one before is answered or not.
    #[arg(long, default_value_t = 2000, value_name = "PER_SECOND")]
    paced: u32,
    /// Measure single calls once more while so many axes stream from the same server.
    #[arg(long, default_value_t = 0, value_name = "COUNT")]
    streams_beside: usize,
    /// Streams that share a connection and a beat of reports.
    #[arg(long, default_value_t = 50, value_name = "COUNT")]
    sharing: usize,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
    /// Serve empty calls with answers of so many bytes, and do nothing else.
    #[arg(long, hide = true)]
    serve_empty: Option<usize>,
}

type Failed = Box<dyn Error + Send + Sync>;

fn main() -> ExitCode {
    let args = Args::parse();
    if let Some(bytes) = args.serve_empty {
        return serving::process("portamento-plans", async |_: Empty, _| serve_empty(bytes).await);
    }
    match run(&args) {
        Ok(rows) if args.json => println!("{}", Value::Array(rows)),
        Ok(rows) => rows.iter().for_each(print_row),
        Err(error) => {
            eprintln!("portamento-plans: {error}");
            return ExitCode::FAILURE;
        }
    }
    ExitCode::SUCCESS
}

fn run(args: &Args) -> Result<Vec<Value>, Failed> {
    let request = pb::PlanRequest::from(fifty_millimetres());
    let answer = pb::PlanResponse { plan: Some(plan_to_wire(e2e::planned(fifty_millimetres()).judged())) };
    let planner = Process::server(&[])?;
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["--serve-empty", &answer.encoded_len().to_string()]);
    let empty = Process::start(command)?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let mut all: [Measured; NAMES.len()] = Default::default();
    runtime.block_on(async {
        let client = Client::connect(&planner.endpoint).await?;
        let calls = client::Connect::new().channel(&planner.endpoint).await?;
        let empties = client::Connect::new().channel(&empty.endpoint).await?;
        let filling = Filling::of(request.encoded_len());
        let moves = moves(args.per_columns);
        let asked = request.clone();
        let channel = calls.clone();
        let ask = move || ask_plan(channel.clone(), asked.clone());
        for round in 0..args.rounds {
            let server = planner.child.id();
            if !args.single && !args.against_empty {
                in_columns(args, server, &mut all[5], &client, &moves, Detail::Full).await?;
                in_columns(args, server, &mut all[6], &client, &moves, Detail::Motion).await?;
            }
            if args.columns {
                continue;
            }
            // There and back again: whatever drifts has as much of each.
            for turn in 0..3 {
                match if round % 2 == 0 { turn } else { 2 - turn } {
                    0 if !args.single => {
                        let ask = || ask_empty(empties.clone(), filling.clone());
                        calling(args, empty.child.id(), &mut all[0], ask).await?;
                    }
                    1 if !args.single => {
                        let ask = || ask_bytes(calls.clone(), request.clone());
                        calling(args, server, &mut all[1], ask).await?;
                    }
                    2 => calling(args, server, &mut all[2], &ask).await?,
                    _ => {}
                }
            }
            if args.against_empty {
                continue;
            }
            pacing(args, server, &mut all[7], ask.clone()).await?;
            if args.streams_beside > 0 {
                let beside = Beside::start(args, &planner.endpoint)?;
                calling(args, server, &mut all[8], &ask).await?;
                beside.end(&mut all[8])?;
                let beside = Beside::start(args, &planner.endpoint)?;
                pacing(args, server, &mut all[9], ask.clone()).await?;
                beside.end(&mut all[9])?;
            }
            if !args.single {
                streaming(args, server, &mut all[3], &client, Detail::Full).await?;
                streaming(args, server, &mut all[4], &client, Detail::Motion).await?;
            }
        }
        Ok::<_, Failed>(())
    })?;
    let empties = all[0].rates.clone();
    let measured = all.iter_mut().zip(NAMES).filter(|(measured, _)| measured.plans > 0);
    let rows = measured.map(|(measured, name)| {
        let rate = measured.plans as f64 / measured.seconds;
        // Round by round: a machine that is slow for a while is so for both.
        let mut of_empty: Vec<f64> =
            measured.rates.iter().zip(&empties).map(|(rate, empty)| rate / empty).collect();
        of_empty.sort_unstable_by(f64::total_cmp);
        let quarter = |share: usize| of_empty.get(of_empty.len() * share / 4).copied();
        measured.times.sort_unstable();
        measured.late.sort_unstable();
        let at = |times: &[u32], share: f64| {
            Some(f64::from(*times.get(((times.len().max(1) - 1) as f64 * share) as usize)?) / 1e3)
        };
        let (answered, late) = (|share| at(&measured.times, share), |share| at(&measured.late, share));
        json!({
            "name": name, "perSecond": rate, "ofEmpty": quarter(2),
            "ofEmptyQuarters": [quarter(1), quarter(3)],
            "perCoreSecond": measured.plans as f64 / (measured.server + measured.asking),
            "serverCpuNsEach": 1e9 * measured.server / measured.plans as f64,
            "askingCpuNsEach": 1e9 * measured.asking / measured.plans as f64,
            "serverCpu": measured.server / measured.seconds, "askingCpu": measured.asking / measured.seconds,
            "calls": measured.plans,
            "p50Us": answered(0.5), "p99Us": answered(0.99), "p999Us": answered(0.999), "maxUs": answered(1.0),
            "lateP50Us": late(0.5), "lateP99Us": late(0.99), "lateP999Us": late(0.999),
            "streams": measured.beside.streams, "underruns": measured.beside.underruns,
            "leastLeadCycles": measured.beside.least_lead,
            "requestBytes": request.encoded_len(), "answerBytes": answer.encoded_len(),
        })
    });
    Ok(rows.collect())
}

/// What is measured, in the order in which it is told.
const NAMES: [&str; 10] = [
    "empty",
    "Plan, as bytes",
    "Plan",
    "PlanMany",
    "PlanMany, MOTION",
    "columns",
    "columns, MOTION",
    "Plan, by the clock",
    "Plan, streams beside",
    "Plan, by the clock, streams beside",
];

async fn ask_bytes(channel: Channel, request: pb::PlanRequest) -> Result<(), tonic::Status> {
    let mut grpc = tonic::client::Grpc::new(channel);
    grpc.ready().await.map_err(|error| tonic::Status::unavailable(error.to_string()))?;
    let path = http::uri::PathAndQuery::from_static("/motion.v1.PlannerService/Plan");
    let codec = ProstCodec::<pb::PlanRequest, outgoing::PlanResponse>::default();
    grpc.unary(tonic::Request::new(request), path, codec).await.map(drop)
}

async fn ask_plan(channel: Channel, request: pb::PlanRequest) -> Result<(), tonic::Status> {
    PlannerServiceClient::new(channel).plan(request).await.map(drop)
}

fn print_row(row: &Value) {
    let number = |key: &str| row[key].as_f64().unwrap_or(f64::NAN);
    // Of streams nothing is timed.
    let time = |key: &str| row[key].as_f64().map_or_else(|| "-".to_owned(), |time| format!("{time:.0}"));
    let ratio = |of: &Value| of.as_f64().map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.2}"));
    println!(
        "{:<34} {:>10.0}/s {:>8} of empty {:>9.0} per core-second  p50 {:>7} p99 {:>7} p99.9 {:>7} us  CPU {:>5.2} server {:>5.2} asking",
        row["name"].as_str().unwrap_or_default(),
        number("perSecond"),
        ratio(&row["ofEmpty"]),
        number("perCoreSecond"),
        time("p50Us"),
        time("p99Us"),
        time("p999Us"),
        number("serverCpu"),
        number("askingCpu")
    );
    if row["ofEmpty"].is_number() {
        let [least, most] = [0, 1].map(|end| ratio(&row["ofEmptyQuarters"][end]));
        println!("{:<34} of empty, round by round: half of them from {least} to {most}", "");
    }
    if row["lateP99Us"].is_number() {
        println!(
            "{:<34} of that, until the call was sent: p50 {} p99 {} p99.9 {} us",
            "",
            time("lateP50Us"),
            time("lateP99Us"),
            time("lateP999Us")
        );
    }
    if row["streams"] != 0 {
        println!(
            "{:<34} {} streams beside: {} underruns, least lead {} cycles",
            "", row["streams"], row["underruns"], row["leastLeadCycles"]
        );
    }
}
