//! How many plans a second one server process gives on this machine, the asking side included: empty calls of the sizes of `Plan`
//! through the same layers, `Plan` itself, `PlanMany`, and `PlanMany` in columns.
//!
//! `Plan` is asked twice: by somebody who takes the plan as bytes, as those take them who make the empty calls, which shows what the
//! planner costs its server; and by somebody who reads it.
//!
//! `cargo build --release --workspace --bins && target/release/portamento-plans`

#![allow(clippy::print_stdout, reason = "the table is what it is for")]
#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

use std::convert::Infallible;
use std::error::Error;
use std::process::{Command, ExitCode};
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use clap::Parser;
use client::Client;
use e2e::{Process, cpu, fifty_millimetres};
use prost::Message;
use proto::pb::planner_service_client::PlannerServiceClient;
use proto::{Detail, MoveColumns, outgoing, pb, plan_to_wire};
use serde_json::{Value, json};
use tonic::body::Body;
use tonic::codegen::{Service, http};
use tonic::server::{NamedService, UnaryService};
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

/// The hidden argument again, for a process that has the settings of every other.
#[derive(Debug, Parser)]
struct Empty {
    #[arg(long)]
    #[allow(dead_code, reason = "read before")]
    serve_empty: usize,
    #[command(flatten)]
    flags: serving::Flags,
}

impl serving::Arguments for Empty {
    fn flags(&self) -> &serving::Flags {
        &self.flags
    }
}

/// As many bytes as a message has in all.
#[derive(Clone, PartialEq, Message)]
struct Filling {
    #[prost(bytes = "bytes", tag = "1")]
    bytes: prost::bytes::Bytes,
}

impl Filling {
    fn of(bytes: usize) -> Self {
        // A key, and a length of two bytes.
        Self { bytes: vec![0x55; bytes.saturating_sub(3)].into() }
    }
}

/// Answers with as many bytes as an answer has, and does nothing.
#[derive(Clone)]
struct Answering(Filling);

impl UnaryService<Filling> for Answering {
    type Response = Filling;
    type Future = std::future::Ready<Result<tonic::Response<Filling>, tonic::Status>>;

    fn call(&mut self, _: tonic::Request<Filling>) -> Self::Future {
        std::future::ready(Ok(tonic::Response::new(self.0.clone())))
    }
}

impl NamedService for Answering {
    const NAME: &'static str = "load.Empty";
}

impl Service<http::Request<Body>> for Answering {
    type Response = http::Response<Body>;
    type Error = Infallible;
    type Future = std::pin::Pin<Box<dyn Future<Output = Result<http::Response<Body>, Infallible>> + Send>>;

    fn poll_ready(&mut self, _: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        Poll::Ready(Ok(()))
    }

    fn call(&mut self, request: http::Request<Body>) -> Self::Future {
        let this = self.clone();
        Box::pin(async move {
            let mut grpc = tonic::server::Grpc::new(ProstCodec::<Filling, Filling>::default());
            Ok(grpc.unary(this, request).await)
        })
    }
}

/// In the same frame as a planner, so that every layer is passed.
async fn serve_empty(bytes: usize) -> Result<(), serving::Exit> {
    let settings = serving::Settings { reflection: false, ..serving::Settings::on_port(0) };
    let bound = serving::Bound::to(settings).await?;
    let services =
        serving::Services::of_schema(proto::FILE_DESCRIPTOR_SET).with(Answering(Filling::of(bytes)));
    Ok(bound.serve(services, serving::Leaving::default(), std::future::pending()).await?)
}

/// What came of measuring one kind of call.
#[derive(Default)]
struct Measured {
    plans: u64,
    seconds: f64,
    server: f64,
    asking: f64,
    /// From a call to its answer [ns]; of `PlanMany` none.
    times: Vec<u32>,
}

fn run(args: &Args) -> Result<Vec<Value>, Failed> {
    let request = pb::PlanRequest::from(fifty_millimetres());
    let answer = pb::PlanResponse { plan: Some(plan_to_wire(e2e::planned(fifty_millimetres()).judged())) };
    let planner = Process::server(&[])?;
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["--serve-empty", &answer.encoded_len().to_string()]);
    let empty = Process::start(command)?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(2).enable_all().build()?;
    let mut all: [Measured; 7] = Default::default();
    runtime.block_on(async {
        let client = Client::connect(&planner.endpoint).await?;
        let calls = client::Connect::new().channel(&planner.endpoint).await?;
        let empties = client::Connect::new().channel(&empty.endpoint).await?;
        let filling = Filling::of(request.encoded_len());
        let moves = moves(args.per_columns);
        for _ in 0..args.rounds {
            let server = planner.child.id();
            in_columns(args, server, &mut all[5], &client, &moves, Detail::Full).await?;
            in_columns(args, server, &mut all[6], &client, &moves, Detail::Motion).await?;
            if args.columns {
                continue;
            }
            let ask = || ask_empty(empties.clone(), filling.clone());
            calling(args, empty.child.id(), &mut all[0], ask).await?;
            let ask = || ask_plan(calls.clone(), request.clone());
            calling(args, server, &mut all[2], ask).await?;
            let ask = || ask_bytes(calls.clone(), request.clone());
            calling(args, server, &mut all[1], ask).await?;
            streaming(args, server, &mut all[3], &client, Detail::Full).await?;
            streaming(args, server, &mut all[4], &client, Detail::Motion).await?;
        }
        Ok::<_, Failed>(())
    })?;
    let names =
        ["empty", "Plan, as bytes", "Plan", "PlanMany", "PlanMany, MOTION", "columns", "columns, MOTION"];
    let rate = |measured: &Measured| measured.plans as f64 / measured.seconds;
    let of_empty = rate(&all[0]);
    let measured = all.iter_mut().zip(names).filter(|(measured, _)| measured.plans > 0);
    let rows = measured.map(|(measured, name)| {
        let (rate, times) = (rate(measured), &mut measured.times);
        times.sort_unstable();
        let at = |share: f64| {
            Some(f64::from(*times.get(((times.len().max(1) - 1) as f64 * share) as usize)?) / 1e3)
        };
        json!({
            "name": name, "perSecond": rate, "ofEmpty": Some(rate / of_empty).filter(|ratio| ratio.is_finite()),
            "perCoreSecond": measured.plans as f64 / (measured.server + measured.asking),
            "serverCpuNsEach": 1e9 * measured.server / measured.plans as f64,
            "askingCpuNsEach": 1e9 * measured.asking / measured.plans as f64,
            "serverCpu": measured.server / measured.seconds, "askingCpu": measured.asking / measured.seconds,
            "p50Us": at(0.5), "p99Us": at(0.99), "p999Us": at(0.999),
            "requestBytes": request.encoded_len(), "answerBytes": answer.encoded_len(),
        })
    });
    Ok(rows.collect())
}

async fn ask_empty(channel: Channel, filling: Filling) -> Result<(), tonic::Status> {
    let mut grpc = tonic::client::Grpc::new(channel);
    grpc.ready().await.map_err(|error| tonic::Status::unavailable(error.to_string()))?;
    let path = http::uri::PathAndQuery::from_static("/load.Empty/Call");
    grpc.unary(tonic::Request::new(filling), path, ProstCodec::<Filling, Filling>::default()).await.map(drop)
}

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

/// Calls from so many tasks at once, each after its answer again.
async fn calling<F: Future<Output = Result<(), tonic::Status>> + Send + 'static>(
    args: &Args,
    server: u32,
    into: &mut Measured,
    ask: impl Fn() -> F,
) -> Result<(), Failed> {
    let until = Instant::now() + Duration::from_secs(args.seconds);
    let (begun, used) = (Instant::now(), [cpu(server)?, cpu(std::process::id())?]);
    let mut waiting = tokio::task::JoinSet::new();
    let timed = |call: F| async move {
        let asked = Instant::now();
        call.await.map(|()| asked.elapsed())
    };
    for _ in 0..args.concurrency {
        waiting.spawn(timed(ask()));
    }
    while let Some(took) = waiting.join_next().await {
        into.times.push(u32::try_from(took??.as_nanos()).unwrap_or(u32::MAX));
        into.plans += 1;
        if Instant::now() < until {
            waiting.spawn(timed(ask()));
        }
    }
    count(into, server, begun, used)
}

/// Streams that are asked and answered at the same time.
async fn streaming(
    args: &Args,
    server: u32,
    into: &mut Measured,
    client: &Client,
    detail: Detail,
) -> Result<(), Failed> {
    let until = Instant::now() + Duration::from_secs(args.seconds);
    let (begun, used) = (Instant::now(), [cpu(server)?, cpu(std::process::id())?]);
    let requests = Arc::new(vec![fifty_millimetres(); args.per_message]);
    let mut streams = tokio::task::JoinSet::new();
    for _ in 0..args.streams {
        let (asking, mut answers) = client.plan_many(detail).await?;
        let requests = Arc::clone(&requests);
        tokio::spawn(async move {
            while Instant::now() < until && asking.ask(requests.to_vec()).await.is_ok_and(|goes_on| goes_on) {
            }
        });
        streams.spawn(async move {
            let mut plans = 0;
            while let Some(outcomes) = answers.next().await? {
                plans += outcomes.iter().filter(|outcome| outcome.is_ok()).count() as u64;
            }
            Ok::<u64, client::Error>(plans)
        });
    }
    while let Some(plans) = streams.join_next().await {
        into.plans += plans??;
    }
    count(into, server, begun, used)
}

/// One axis from wherever to wherever: each move another one.
fn moves(count: usize) -> MoveColumns {
    let places = |factor: f64| (0..count).map(|index| (index as f64 * factor).sin()).collect();
    MoveColumns {
        start_position: places(0.7),
        goal_position: places(1.1),
        ..MoveColumns::like(fifty_millimetres())
    }
}

/// As [`streaming`], in columns: every duration is read, and every number of every piece decoded.
async fn in_columns(
    args: &Args,
    server: u32,
    into: &mut Measured,
    client: &Client,
    moves: &MoveColumns,
    detail: Detail,
) -> Result<(), Failed> {
    let until = Instant::now() + Duration::from_secs(args.seconds);
    let (begun, used) = (Instant::now(), [cpu(server)?, cpu(std::process::id())?]);
    let mut streams = tokio::task::JoinSet::new();
    for _ in 0..args.streams {
        let (asking, mut answers) = client.plan_many(detail).await?;
        let moves = moves.clone();
        tokio::spawn(async move {
            while Instant::now() < until
                && asking.ask_columns(moves.clone()).await.is_ok_and(|goes_on| goes_on)
            {}
        });
        streams.spawn(async move {
            let mut plans = 0;
            while let Some(planned) = answers.next_columns().await? {
                plans += planned.durations().iter().filter(|duration| **duration > 0.0).count() as u64;
            }
            Ok::<u64, client::Error>(plans)
        });
    }
    while let Some(plans) = streams.join_next().await {
        into.plans += plans??;
    }
    count(into, server, begun, used)
}

fn count(into: &mut Measured, server: u32, begun: Instant, used: [f64; 2]) -> Result<(), Failed> {
    into.seconds += begun.elapsed().as_secs_f64();
    into.server += cpu(server)? - used[0];
    into.asking += cpu(std::process::id())? - used[1];
    Ok(())
}

fn print_row(row: &Value) {
    let number = |key: &str| row[key].as_f64().unwrap_or(f64::NAN);
    // Of streams nothing is timed.
    let time = |key: &str| row[key].as_f64().map_or_else(|| "-".to_owned(), |time| format!("{time:.0}"));
    println!(
        "{:<18} {:>10.0}/s {:>8} of empty {:>9.0} per core-second  p50 {:>7} p99 {:>7} p99.9 {:>7} us  CPU {:>5.2} server {:>5.2} asking",
        row["name"].as_str().unwrap_or_default(),
        number("perSecond"),
        row["ofEmpty"].as_f64().map_or_else(|| "-".to_owned(), |ratio| format!("{ratio:.2}")),
        number("perCoreSecond"),
        time("p50Us"),
        time("p99Us"),
        time("p999Us"),
        number("serverCpu"),
        number("askingCpu")
    );
}
