//! How many axes two server processes serve on this machine: light axes, which accept, count, digest and report as real ones do, and
//! have no plant. Half-way the server that serves all of them is killed.
//!
//! `cargo build --release -p portamento-server -p e2e && target/release/portamento-load --axes 250,500,1000`

#![allow(clippy::print_stdout, reason = "the table is what it is for")]
#![allow(rustdoc::broken_intra_doc_links, reason = "units stand in square brackets in help texts")]

use std::error::Error;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

use clap::Parser;
use client::failover::{Change, Feed, News};
use client::{Buffer, Connect, Next, Revision, Servers, Standing, Uplink};
use e2e::{Process, cpu, move_of, open, planned};
use planner::{Accepted, Setpoint};
use proto::stream::{Ask, Motion, Open, Operation, Refused};
use serde_json::{Value, json};
use tokio::sync::mpsc;

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
    /// Kill no server.
    #[arg(long)]
    no_kill: bool,
    /// Print the results as JSON.
    #[arg(long)]
    json: bool,
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
        match run(&args, axes) {
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

/// What axes have seen, all together.
#[derive(Debug, Default)]
struct Tally {
    opened: AtomicU64,
    played: AtomicU64,
    underruns: AtomicU64,
    refused: AtomicU64,
    operations_refused: AtomicU64,
    over: AtomicBool,
}

/// What is told of an axis's stream.
enum Told {
    FailedOver(Change),
    /// An operation, and how long it took to its answer.
    Confirmed(Duration),
}

fn run(args: &Args, axes: usize) -> Result<Value, Failed> {
    let (mut first, second) = (served_by("first")?, served_by("second")?);
    let endpoints = vec![first.endpoint.clone(), second.endpoint.clone()];
    let empty = resident_kib(first.child.id())?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let tally = Arc::new(Tally::default());
    let plan = planned(move_of(0.25 * (args.seconds + 60) as f64, 0.25));
    let (told, mut heard) = mpsc::unbounded_channel();
    let every = (args.operations > 0.0).then(|| Duration::from_secs_f64(axes as f64 / args.operations));
    let (ends, mut least_leads) = mpsc::unbounded_channel();
    let connect = if args.sharing > 1 { Connect::new().shared_by(args.sharing) } else { Connect::new() };
    let servers = Servers { connect, ..Servers::at(endpoints) };
    runtime.block_on(async {
        let zero = tokio::time::Instant::now();
        for axis_number in 0..axes {
            let open = Open {
                batch_cycles: args.batch,
                lead_cycles: args.lead,
                compact: args.compact,
                ..open(&format!("load/{axis_number}"), plan.clone())
            };
            let axis = Axis {
                uplink: Uplink::new(servers.clone(), open.clone(), plan.plan().cycle_time()),
                // Gateways are out of step with each other.
                beat_from: zero
                    + batch(&open)
                        .mul_f64((gateway(args, axis_number) / (gateway(args, axes - 1) + 1.0)).fract()),
                tally: Arc::clone(&tally),
                told: told.clone(),
                operations: Operations::new(axis_number, every),
            };
            let ends = ends.clone();
            let plan = plan.clone();
            tokio::spawn(async move {
                let least = axis.play(&open, &plan).await;
                // Nobody to tell is not a failure.
                let _ = ends.send(least);
            });
            // One after the other: a thousand that begin at once are another question.
            wait(Duration::from_millis(5)).await;
        }
        drop((told, ends));
        let mut look = tokio::time::interval(Duration::from_millis(10));
        while (tally.opened.load(Ordering::Relaxed) as usize) < axes {
            look.tick().await;
        }
        wait(Duration::from_millis(500)).await;
        let loaded = resident_kib(first.child.id())?;
        let began = Instant::now();
        let before = (
            tally.played.load(Ordering::Relaxed),
            cpu(first.child.id())?,
            cpu(second.child.id())?,
            cpu(std::process::id())?,
        );
        let bytes = loopback_bytes()?;
        wait(Duration::from_secs(args.seconds) / 2).await;
        let half = (began.elapsed().as_secs_f64(), cpu(first.child.id())? - before.1);
        let sent = (loopback_bytes()? - bytes) as f64;
        let bytes_per_setpoint = sent / (tally.played.load(Ordering::Relaxed) - before.0) as f64;
        if !args.no_kill {
            first.child.kill()?;
        }
        wait(Duration::from_secs(args.seconds) / 2).await;
        let took = began.elapsed().as_secs_f64();
        let played = tally.played.load(Ordering::Relaxed) - before.0;
        let axes_cpu = (cpu(std::process::id())? - before.3) / took;
        tally.over.store(true, Ordering::Relaxed);
        let mut least = u64::MAX;
        while let Some(lead) = least_leads.recv().await {
            least = least.min(lead);
        }
        let (mut times, mut operations): (Vec<f64>, Vec<f64>) = Default::default();
        while let Ok(told) = heard.try_recv() {
            match told {
                Told::FailedOver(change) => times.push(change.took.as_secs_f64() * 1e3),
                Told::Confirmed(took) => operations.push(took.as_secs_f64() * 1e3),
            }
        }
        for times in [&mut times, &mut operations] {
            times.sort_by(f64::total_cmp);
        }
        Ok(json!({
            "axes": axes,
            "seconds": took,
            "batchCycles": args.batch,
            "compact": args.compact,
            "bytesPerSetpoint": bytes_per_setpoint,
            "leadCycles": args.lead,
            "setpointsPerSecond": played as f64 / took,
            "underruns": tally.underruns.load(Ordering::Relaxed),
            "refusedBatches": tally.refused.load(Ordering::Relaxed),
            "leastLeadCycles": least,
            "failovers": times.len(),
            "failoverP50Ms": at(&times, 0.5),
            "failoverMaxMs": at(&times, 1.0),
            "operations": operations.len(),
            "operationsRefused": tally.operations_refused.load(Ordering::Relaxed),
            "operationP50Ms": at(&operations, 0.5),
            "operationP99Ms": at(&operations, 0.99),
            "operationMaxMs": at(&operations, 1.0),
            "serverCpu": half.1 / half.0,
            "axesCpu": axes_cpu,
            "kibPerStream": loaded.saturating_sub(empty) as f64 / axes as f64,
        }))
    })
}

/// Of times in order, the one that a share is not above; none of none.
fn at(times: &[f64], share: f64) -> Option<f64> {
    times.get((times.len().saturating_sub(1) as f64 * share) as usize).copied()
}

/// Nothing happens for so long.
async fn wait(time: Duration) {
    let _ = tokio::time::timeout(time, std::future::pending::<()>()).await;
}

/// An axis without a plant.
struct Axis {
    uplink: Uplink,
    tally: Arc<Tally>,
    told: mpsc::UnboundedSender<Told>,
    operations: Operations,
    /// Reports go out at whole batches from here on.
    beat_from: tokio::time::Instant,
}

/// The overrides that an axis asks for, one after the other.
struct Operations {
    axis: usize,
    every: Option<Duration>,
    asked: u32,
    /// Since when an answer is waited for.
    waits: Option<Instant>,
}

impl Operations {
    fn new(axis: usize, every: Option<Duration>) -> Self {
        Self { axis, every, asked: 0, waits: None }
    }

    /// When to ask; at another phase of the batches for each axis.
    fn clock(&self) -> tokio::time::Interval {
        let every = self.every.unwrap_or(Duration::MAX / 4);
        let first = tokio::time::Instant::now() + every.mul_f64((self.axis as f64 * 0.618).fract());
        let mut clock = tokio::time::interval_at(first, every);
        clock.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        clock
    }

    /// The next one; none while one is not answered.
    fn next(&mut self) -> Option<Operation> {
        if self.waits.is_some() {
            return None;
        }
        self.asked += 1;
        self.waits = Some(Instant::now());
        let factor = if self.asked.is_multiple_of(2) { 1.0 } else { 0.7 };
        Some(Operation::now(format!("{}", self.asked), Ask::Override(factor)))
    }
}

impl Axis {
    /// Plays until all are told to end; gives the least lead that it has had.
    async fn play(mut self, open: &Open, plan: &Accepted) -> u64 {
        let Some(motion) = self.opened().await else { return 0 };
        let setpoints: Vec<Setpoint> = plan.plan().sampler().at(0).collect();
        let mut buffer = Buffer::new(&Standing {
            epoch: self.uplink.failover().serving_epoch().unwrap_or(open.epoch),
            lead_cycles: open.lead_cycles,
            axis_guard: open.axis_guard,
            plan: motion.plan(),
            setpoints: &setpoints,
        });
        buffer.motion_ends_at(motion.last_cycle());
        self.tally.opened.fetch_add(1, Ordering::Relaxed);
        let (mut began, mut heeded) = (None, 0);
        let mut reports = beat(self.beat_from, batch(open));
        let (asks_at_all, mut asks) = (self.operations.every.is_some(), self.operations.clock());
        while !self.tally.over.load(Ordering::Relaxed) {
            let next = tokio::select! {
                next = self.uplink.next() => Some(next),
                _ = reports.tick() => None,
                _ = asks.tick(), if asks_at_all && began.is_some() => {
                    if let Some(operation) = self.operations.next() {
                        self.uplink.operate(operation);
                    }
                    continue;
                }
            };
            if began.is_none() && buffer.is_ready() {
                began = Some(Instant::now());
            }
            // Every cycle that was due before this came: played now, it is played in time.
            if let Some(began) = began
                && !self.play_due(&mut buffer, began)
            {
                break;
            }
            let mut refused = None;
            let is_due = match next {
                Some(Next::Feed(Feed::Batch(epoch, mut batch))) => {
                    let adopted = buffer.revision();
                    refused = buffer.accept(epoch, &mut batch).err();
                    // Who waits for an operation is answered when its revision is adopted.
                    refused.is_some() || buffer.revision() != adopted
                }
                Some(Next::Feed(Feed::Revised(epoch, revision))) => {
                    buffer.announce(epoch, revision);
                    false
                }
                Some(Next::Feed(Feed::Resuming)) => {
                    heeded += 1;
                    buffer.resuming(true);
                    true
                }
                Some(Next::Feed(Feed::Stays)) => {
                    buffer.resuming(false);
                    false
                }
                Some(Next::Feed(Feed::GoesOn(epoch, rested))) => {
                    drop::<Option<Revision>>(buffer.goes_on(epoch, rested));
                    true
                }
                Some(Next::News(News::FailedOver(change))) => {
                    // Nobody to tell is not a failure.
                    let _ = self.told.send(Told::FailedOver(change));
                    false
                }
                Some(Next::News(News::Answer(_, answer))) => {
                    if let Some(asked) = self.operations.waits.take() {
                        match answer {
                            Ok(_) => drop(self.told.send(Told::Confirmed(asked.elapsed()))),
                            Err(_) => drop(self.tally.operations_refused.fetch_add(1, Ordering::Relaxed)),
                        }
                    }
                    false
                }
                Some(Next::News(News::Over(_))) => break,
                Some(Next::News(_)) => false,
                None => began.is_some(),
            };
            if is_due {
                self.report(&buffer, refused, heeded);
            }
        }
        buffer.counters().least_lead_cycles
    }

    fn report(&mut self, buffer: &Buffer, refused: Option<Refused>, heeded: u64) {
        self.tally.refused.fetch_add(u64::from(refused.is_some()), Ordering::Relaxed);
        self.uplink.report(buffer.report(refused), heeded);
    }

    /// `false` where a cycle was due and not held: then it is over for this axis.
    fn play_due(&self, buffer: &mut Buffer, began: Instant) -> bool {
        let due = began.elapsed().as_millis() as u64;
        let from = buffer.executed();
        while buffer.executed() < due {
            if buffer.play().is_none() {
                self.tally.underruns.fetch_add(1, Ordering::Relaxed);
                return false;
            }
        }
        self.tally.played.fetch_add(buffer.executed() - from, Ordering::Relaxed);
        true
    }

    async fn opened(&mut self) -> Option<Motion> {
        loop {
            match self.uplink.next().await {
                Next::News(News::Opened(opened)) => return Some(opened.motion),
                Next::News(News::Over(how)) => {
                    eprintln!("portamento-load: a stream does not open: {how:?}");
                    return None;
                }
                Next::News(_) | Next::Feed(_) => {}
            }
        }
    }
}

/// The time that a batch lasts.
fn batch(open: &Open) -> Duration {
    Duration::from_millis(u64::from(open.batch_cycles))
}

/// The gateway of an axis.
fn gateway(args: &Args, axis: usize) -> f64 {
    (axis / args.sharing.max(1)) as f64
}

/// Whole periods from `zero` on, beginning with the next.
fn beat(zero: tokio::time::Instant, period: Duration) -> tokio::time::Interval {
    let past = zero.elapsed().div_duration_f64(period).ceil();
    tokio::time::interval_at(zero + period.mul_f64(past), period)
}

fn served_by(name: &str) -> Result<Process, Failed> {
    Process::server(&["--served-by", name])
}

/// What has gone over the loopback interface, both ways and with all headers [bytes].
fn loopback_bytes() -> Result<u64, Failed> {
    let table = std::fs::read_to_string("/proc/net/dev")?;
    let line =
        table.lines().find_map(|line| line.trim_start().strip_prefix("lo:")).ok_or("there is no lo")?;
    Ok(line.split_whitespace().next().unwrap_or_default().parse()?)
}

/// Memory that a process has in use [KiB].
fn resident_kib(process: u32) -> Result<u64, Failed> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status"))?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).ok_or("status has no VmRSS")?;
    Ok(line.split_whitespace().next().unwrap_or_default().parse()?)
}
