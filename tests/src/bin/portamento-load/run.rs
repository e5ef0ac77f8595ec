//! A number of axes from their opening to their end, and what that takes.

use std::io::Read as _;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use client::{Connect, Servers, Uplink};
use e2e::{
    Process, Traffic, cpu, loopback, move_of, open, planned, planned_pvt, resident_kib, swing, together,
};
use planner::Accepted;
use proto::stream::Open;
use serde_json::{Value, json};
use tokio::sync::{mpsc, oneshot};

use crate::axis::{Axis, Operations, Tally, Told, batch};
use crate::{Args, Failed};

pub(crate) fn run(args: &Args, axes: usize) -> Result<Value, Failed> {
    let mut replicas = Replicas::of(args)?;
    let plan = motion(args);
    let empty = Memory::now(&replicas)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let (told, heard) = mpsc::unbounded_channel();
    let tally = Arc::<Tally>::default();
    let mut heard = Heard::by(heard);
    runtime.block_on(async {
        let begun = Reading::now(&tally, &replicas)?;
        begin(args, axes, &plan, &replicas, &tally, told).await;
        heard.until(|heard| heard.opened.len() == axes, None).await?;
        let opened = Reading::now(&tally, &replicas)?;
        let ages: f64 = heard.opened.iter().map(|at| (opened.at - *at).as_secs_f64()).sum();
        wait(Duration::from_millis(500)).await;
        let loaded = Memory::now(&replicas)?;

        let kills = args.kills();
        let time = Duration::from_secs(args.seconds) / if kills { 2 } else { 1 };
        let first = Reading::now(&tally, &replicas)?;
        if args.until_input_ends {
            eprintln!("{}", Args::PLAYING);
            input_ends().await;
        } else {
            wait(time).await;
        }
        let second = Reading::now(&tally, &replicas)?;
        let steady = second.since(&first);
        let mut change = None;
        if kills {
            replicas.kill_first()?;
            let until = tokio::time::Instant::now() + time;
            heard.until(|heard| heard.failovers.len() == axes, Some(until)).await?;
            change = Some(Reading::now(&tally, &replicas)?.since(&second));
            tokio::time::timeout_at(until, std::future::pending::<()>()).await.unwrap_or_default();
        }
        let all = Reading::now(&tally, &replicas)?.since(&first);
        tally.over.store(true, Ordering::Relaxed);
        heard.until(|heard| heard.ended == axes, None).await?;

        for times in [&mut heard.failovers, &mut heard.operations] {
            times.sort_by(f64::total_cmp);
        }
        let each = |total: f64| total / axes as f64;
        // What streams that are open already take is not a matter of opening.
        let opening = opened.since(&begun);
        let served = |used: &Used, number: usize| used.servers.get(number).copied();
        let open_server = served(&opening, 0)
            .zip(served(&steady, 0))
            .map(|(all, steadily)| 1e6 * each(all - each(steadily / steady.seconds) * ages));
        let open_axes = 1e6 * each(opening.axes - each(steady.axes / steady.seconds) * ages);
        // Streams change one after the other, so that the second server streams for half of the time; axes play for all of it.
        let taken_over = change.as_ref().filter(|_| heard.failovers.len() == axes).and_then(|change| {
            let [streaming, playing] = [served(&steady, 0)?, steady.axes].map(|used| used / steady.seconds);
            let server = served(change, 1)? - 0.5 * streaming * change.seconds;
            Some([server, change.axes - playing * change.seconds].map(|total| 1e6 * each(total)))
        });
        let played = steady.played as f64;
        Ok(json!({
            "axes": axes,
            "axesEach": args.axes_each,
            "points": args.points,
            "segments": plan.plan().axes()[0].profile.segments().len(),
            "sharing": args.sharing,
            "seconds": all.seconds,
            "batchCycles": args.batch,
            "compact": args.compact,
            "bytesPerSetpoint": steady.traffic.bytes as f64 / played,
            "packetsPerSetpoint": steady.traffic.packets as f64 / played,
            "leadCycles": args.lead,
            "setpointsPerSecond": all.played as f64 / all.seconds,
            "underruns": tally.underruns.load(Ordering::Relaxed),
            "refusedBatches": tally.refused.load(Ordering::Relaxed),
            "leastLeadCycles": heard.least_lead,
            "failovers": heard.failovers.len(),
            "failoverP50Ms": at(&heard.failovers, 0.5),
            "failoverMaxMs": at(&heard.failovers, 1.0),
            "takeOverServerCpuUs": taken_over.map(|[server, _]| server),
            "takeOverAxesCpuUs": taken_over.map(|[_, axes]| axes),
            "openServerCpuUs": open_server,
            "openAxesCpuUs": open_axes,
            "operations": heard.operations.len(),
            "operationsRefused": tally.operations_refused.load(Ordering::Relaxed),
            "operationP50Ms": at(&heard.operations, 0.5),
            "operationP99Ms": at(&heard.operations, 0.99),
            "operationMaxMs": at(&heard.operations, 1.0),
            "serverCpu": served(&steady, 0).map(|used| used / steady.seconds),
            "axesCpu": steady.axes / steady.seconds,
            "kibPerStream": loaded.server.zip(empty.server).map(|(now, then)| each(now - then)),
            "idleKib": empty.server,
            "axesKibPerStream": each(loaded.axes - empty.axes),
        }))
    })
}

/// What all axes play.
fn motion(args: &Args) -> Accepted {
    let seconds = (args.seconds + 60) as f64;
    match args.points {
        Some(points) => planned_pvt(swing(args.axes_each, points, seconds)),
        None if args.axes_each > 1 => planned(together(args.axes_each, &move_of(0.25 * seconds, 0.25))),
        None => planned(move_of(0.25 * seconds, 0.25)),
    }
}

/// Begins all axes, one after the other: a thousand that begin at once are another question.
async fn begin(
    args: &Args,
    axes: usize,
    plan: &Accepted,
    replicas: &Replicas,
    tally: &Arc<Tally>,
    told: mpsc::UnboundedSender<Told>,
) {
    let every = (args.operations > 0.0).then(|| Duration::from_secs_f64(axes as f64 / args.operations));
    let connect = if args.sharing > 1 { Connect::new().shared_by(args.sharing) } else { Connect::new() };
    let servers = Servers { connect, ..Servers::at(replicas.endpoints.clone()) };
    let zero = tokio::time::Instant::now();
    for number in 0..axes {
        let open = Open {
            batch_cycles: args.batch,
            lead_cycles: args.lead,
            compact: args.compact,
            ..open(&format!("load/{number}"), plan.clone())
        };
        let axis = Axis {
            uplink: Uplink::new(servers.clone(), open.clone(), plan.plan().cycle_time()),
            // Gateways are out of step with each other.
            beat_from: zero
                + batch(&open).mul_f64((gateway(args, number) / (gateway(args, axes - 1) + 1.0)).fract()),
            tally: Arc::clone(tally),
            told: told.clone(),
            operations: Operations::new(number, every),
        };
        let (plan, told) = (plan.clone(), told.clone());
        tokio::spawn(async move {
            let least = axis.play(&open, &plan).await;
            // Nobody to tell is not a failure.
            let _ = told.send(Told::Ended(least));
        });
        wait(Duration::from_millis(args.apart)).await;
    }
}

/// The gateway of an axis.
fn gateway(args: &Args, axis: usize) -> f64 {
    (axis / args.sharing.max(1)) as f64
}

/// What axes have told so far; times in ms.
struct Heard {
    from: mpsc::UnboundedReceiver<Told>,
    opened: Vec<Instant>,
    failovers: Vec<f64>,
    operations: Vec<f64>,
    ended: usize,
    least_lead: u64,
}

impl Heard {
    fn by(from: mpsc::UnboundedReceiver<Told>) -> Self {
        let (opened, failovers, operations) = Default::default();
        Self { from, opened, failovers, operations, ended: 0, least_lead: u64::MAX }
    }

    /// Listens until `is_all` that is waited for, or until then.
    async fn until(
        &mut self,
        is_all: impl Fn(&Self) -> bool,
        then: Option<tokio::time::Instant>,
    ) -> Result<(), Failed> {
        let listening = async {
            while !is_all(self) {
                let told = self.from.recv().await.ok_or("the axes are gone")?;
                if let ControlFlow::Break(failed) = self.hear(told) {
                    return Err(failed.into());
                }
            }
            Ok(())
        };
        match then {
            Some(then) => tokio::time::timeout_at(then, listening).await.unwrap_or(Ok(())),
            None => listening.await,
        }
    }

    fn hear(&mut self, told: Told) -> ControlFlow<&'static str> {
        let milliseconds = |time: Duration| time.as_secs_f64() * 1e3;
        match told {
            Told::Opened(at) => self.opened.push(at),
            Told::FailedOver(change) => self.failovers.push(milliseconds(change.took)),
            Told::Confirmed(took) => self.operations.push(milliseconds(took)),
            Told::Ended(None) => return ControlFlow::Break("a stream did not open"),
            Told::Ended(Some(least)) => {
                self.ended += 1;
                self.least_lead = self.least_lead.min(least);
            }
        }
        ControlFlow::Continue(())
    }
}

/// Of times in order, the one that a share is not above; none of none.
fn at(times: &[f64], share: f64) -> Option<f64> {
    times.get((times.len().saturating_sub(1) as f64 * share) as usize).copied()
}

/// Nothing happens for so long.
async fn wait(time: Duration) {
    let _ = tokio::time::timeout(time, std::future::pending::<()>()).await;
}

/// Standard input is closed by whoever wants no more.
async fn input_ends() {
    let (ended, ends) = oneshot::channel();
    std::thread::spawn(move || {
        // Whether it ends well or not, it has ended.
        let _ = std::io::stdin().read_to_end(&mut Vec::new());
        let _ = ended.send(());
    });
    let _ = ends.await;
}

/// Who serves: two processes of this one, or whoever is there already.
struct Replicas {
    processes: Vec<Process>,
    endpoints: Vec<String>,
}

impl Replicas {
    fn of(args: &Args) -> Result<Self, Failed> {
        if !args.at.is_empty() {
            return Ok(Self { processes: Vec::new(), endpoints: args.at.clone() });
        }
        let named = |name: &&str| Process::server(&["--served-by", name]);
        let processes = ["first", "second"].iter().map(named).collect::<Result<Vec<_>, _>>()?;
        let endpoints = processes.iter().map(|process| process.endpoint.clone()).collect();
        Ok(Self { processes, endpoints })
    }

    fn kill_first(&mut self) -> Result<(), Failed> {
        match self.processes.first_mut() {
            Some(first) => Ok(first.child.kill()?),
            None => Ok(()),
        }
    }
}

/// Memory in use [KiB].
struct Memory {
    server: Option<f64>,
    axes: f64,
}

impl Memory {
    fn now(replicas: &Replicas) -> Result<Self, Failed> {
        let server = replicas.processes.first().map(|first| resident_kib(first.child.id())).transpose()?;
        let axes = resident_kib(std::process::id())? as f64;
        Ok(Self { server: server.map(|kib| kib as f64), axes })
    }
}

/// What has been used and done up to a moment.
struct Reading {
    at: Instant,
    /// CPU time of each server, and of the axes \[s\].
    servers: Vec<f64>,
    axes: f64,
    traffic: Traffic,
    played: u64,
}

/// What was used and done between two moments.
struct Used {
    seconds: f64,
    servers: Vec<f64>,
    axes: f64,
    traffic: Traffic,
    played: u64,
}

impl Reading {
    fn now(tally: &Tally, replicas: &Replicas) -> Result<Self, Failed> {
        // Of one that was killed there is nothing to be read any more.
        let used = |server: &Process| cpu(server.child.id()).unwrap_or_default();
        Ok(Self {
            at: Instant::now(),
            servers: replicas.processes.iter().map(used).collect(),
            axes: cpu(std::process::id())?,
            traffic: loopback()?,
            played: tally.played.load(Ordering::Relaxed),
        })
    }

    fn since(&self, before: &Self) -> Used {
        Used {
            seconds: (self.at - before.at).as_secs_f64(),
            servers: self.servers.iter().zip(&before.servers).map(|(now, then)| now - then).collect(),
            axes: self.axes - before.axes,
            traffic: Traffic {
                bytes: self.traffic.bytes - before.traffic.bytes,
                packets: self.traffic.packets - before.traffic.packets,
            },
            played: self.played - before.played,
        }
    }
}
