//! How a server is asked for a while: call by call in a closed loop, by the clock, and over streams of many plans.

use std::sync::Arc;
use std::time::{Duration, Instant};

use client::Client;
use e2e::{cpu_with_ended, fifty_millimetres};
use proto::{Detail, MoveColumns};
use tokio::sync::mpsc;

use crate::{Args, Failed};

/// What came of measuring one kind of call.
#[derive(Default)]
pub(crate) struct Measured {
    pub(crate) plans: u64,
    /// Of each round [1/s].
    pub(crate) rates: Vec<f64>,
    pub(crate) seconds: f64,
    pub(crate) server: f64,
    pub(crate) asking: f64,
    /// From when a call was made, or by the clock was due, to its answer [ns]; of `PlanMany` none.
    pub(crate) times: Vec<u32>,
    /// From when a call was due by the clock until it was made [ns].
    pub(crate) late: Vec<u32>,
    pub(crate) beside: Streams,
}

/// What became of the streams that ran beside.
#[derive(Default)]
pub(crate) struct Streams {
    pub(crate) streams: u64,
    pub(crate) underruns: u64,
    pub(crate) least_lead: Option<u64>,
}

/// Calls from so many tasks at once, each after its answer again.
pub(crate) async fn calling<F: Future<Output = Result<(), tonic::Status>> + Send + 'static>(
    args: &Args,
    server: u32,
    into: &mut Measured,
    ask: impl Fn() -> F,
) -> Result<(), Failed> {
    let until = Instant::now() + Duration::from_secs(args.seconds);
    let before = Before::of(into, server)?;
    let mut waiting = tokio::task::JoinSet::new();
    let timed = |call: F| async move {
        let asked = Instant::now();
        call.await.map(|()| asked.elapsed())
    };
    for _ in 0..args.concurrency {
        waiting.spawn(timed(ask()));
    }
    while let Some(took) = waiting.join_next().await {
        into.times.push(nanoseconds(took??));
        into.plans += 1;
        if Instant::now() < until {
            waiting.spawn(timed(ask()));
        }
    }
    before.count(into)
}

/// Calls by the clock, one caller after the other in turn. A call whose caller still waits for the answer before is made when that has
/// come, and its time runs from when it was due: a server that is slow is not asked less often, and nothing of its slowness is left out.
pub(crate) async fn pacing<F: Future<Output = Result<(), tonic::Status>> + Send + 'static>(
    args: &Args,
    server: u32,
    into: &mut Measured,
    ask: impl Fn() -> F + Clone + Send + 'static,
) -> Result<(), Failed> {
    let before = Before::of(into, server)?;
    let (begun, calls, rate) = (before.begun, u64::from(args.paced) * args.seconds, f64::from(args.paced));
    let mut callers = tokio::task::JoinSet::new();
    let turns: Vec<_> = (0..args.concurrency)
        .map(|_| {
            let (turn, mut turns) = mpsc::unbounded_channel::<Instant>();
            let ask = ask.clone();
            callers.spawn(async move {
                let mut times = Vec::new();
                while let Some(due) = turns.recv().await {
                    let late = due.elapsed();
                    ask().await?;
                    times.push((nanoseconds(late), nanoseconds(due.elapsed())));
                }
                Ok::<_, tonic::Status>(times)
            });
            turn
        })
        .collect();
    // A thread, as the runtime's timers go by milliseconds, and wait for their turn behind what else is to be done.
    let clock = std::thread::spawn(move || {
        for (call, turn) in (0..calls).zip(turns.iter().cycle()) {
            let due = begun + Duration::from_secs_f64(call as f64 / rate);
            while let Some(left) = due.checked_duration_since(Instant::now()).filter(|left| !left.is_zero()) {
                std::thread::park_timeout(left);
            }
            // A caller whose call has failed takes none any more, and says so itself.
            let _ = turn.send(due);
        }
    });
    while let Some(times) = callers.join_next().await {
        for (late, answered) in times?? {
            into.late.push(late);
            into.times.push(answered);
            into.plans += 1;
        }
    }
    clock.join().map_err(|_| "the clock has stopped")?;
    before.count(into)
}

fn nanoseconds(time: Duration) -> u32 {
    u32::try_from(time.as_nanos()).unwrap_or(u32::MAX)
}

/// Streams that are asked and answered at the same time.
pub(crate) async fn streaming(
    args: &Args,
    server: u32,
    into: &mut Measured,
    client: &Client,
    detail: Detail,
) -> Result<(), Failed> {
    let until = Instant::now() + Duration::from_secs(args.seconds);
    let before = Before::of(into, server)?;
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
    before.count(into)
}

/// One axis from wherever to wherever: each move another one.
pub(crate) fn moves(count: usize) -> MoveColumns {
    let places = |factor: f64| (0..count).map(|index| (index as f64 * factor).sin()).collect();
    MoveColumns {
        start_position: places(0.7),
        goal_position: places(1.1),
        ..MoveColumns::like(fifty_millimetres())
    }
}

/// As [`streaming`], in columns: every duration is read, and every number of every piece decoded.
pub(crate) async fn in_columns(
    args: &Args,
    server: u32,
    into: &mut Measured,
    client: &Client,
    moves: &MoveColumns,
    detail: Detail,
) -> Result<(), Failed> {
    let until = Instant::now() + Duration::from_secs(args.seconds);
    let before = Before::of(into, server)?;
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
    before.count(into)
}

/// How things stood when a round began.
struct Before {
    begun: Instant,
    server: u32,
    used: [f64; 2],
    plans: u64,
}

impl Before {
    fn of(measured: &Measured, server: u32) -> Result<Self, Failed> {
        let used = [cpu_with_ended(server)?, cpu_with_ended(std::process::id())?];
        Ok(Self { begun: Instant::now(), server, used, plans: measured.plans })
    }

    /// What the round took.
    fn count(self, into: &mut Measured) -> Result<(), Failed> {
        let seconds = self.begun.elapsed().as_secs_f64();
        into.rates.push((into.plans - self.plans) as f64 / seconds);
        into.seconds += seconds;
        into.server += cpu_with_ended(self.server)? - self.used[0];
        into.asking += cpu_with_ended(std::process::id())? - self.used[1];
        Ok(())
    }
}
