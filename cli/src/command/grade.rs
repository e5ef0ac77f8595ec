use std::time::{Duration, Instant};

use client::failover::{Feed, News};
use client::grade::{Advice, Grade, Measured};
use client::{Buffer, Next, Servers, Standing, Uplink};
use planner::{
    Accepted, AxisKind, AxisMoveSpec, CycleTime, Family, Judged, LimitsSpec, Request, RequestSpec, Setpoint,
    ShortPathPolicy, State, Synchronization,
};
use proto::stream::{DEFAULT_AXIS_GUARD, LEAD_CYCLES, Open, Refused, Source};

use crate::args::GradeArgs;
use crate::failure::Failure;
use crate::service::{Server, USUAL_SERVER};
use crate::show::grade as show;
use crate::show::paint::Screen;
use crate::show::watch::waiting;

/// How often a stream is opened to see how long that takes.
const OPENINGS: usize = 10;
/// For how long at least, and at most [s].
const TIMES: (u64, u64) = (1, 3600);

/// `portamento grade`
pub(crate) fn run(args: &GradeArgs, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let time = u64::try_from(args.time).map(Duration::from_nanos).unwrap_or_default();
    if time < Duration::from_secs(TIMES.0) || time > Duration::from_secs(TIMES.1) {
        return Err(Failure::Usage("--time is to be 1s to 1h".to_owned()));
    }
    let endpoint = server.endpoint.unwrap_or(USUAL_SERVER);
    let servers = Servers {
        connect: server.connect.clone(),
        patience: Duration::ZERO,
        ..Servers::at(vec![endpoint.to_owned()])
    };
    let plan = slow_move(time)?;
    let cycle = plan.plan().cycle_time();
    let cycles = u64::try_from(time.as_nanos() / u128::from(cycle.as_ns())).unwrap_or(u64::MAX);
    let lateness = std::thread::spawn(move || sim_axis::lateness_of(cycle, cycles));
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|error| Failure::Internal(error.to_string()))?;
    let bar = waiting(time);
    let (openings, link) = runtime.block_on(async {
        let mut openings = Vec::with_capacity(OPENINGS);
        for number in 0..OPENINGS {
            openings.push(Axis::open(&servers, &plan, args.batch, number).await?.opening);
        }
        let axis = Axis::open(&servers, &plan, args.batch, OPENINGS).await?;
        Ok::<_, Failure>((openings, axis.play(time, &bar).await?))
    })?;
    bar.finish_and_clear();
    let lateness = lateness.join().map_err(|_| Failure::Internal("the clock cannot be measured".into()))?;
    let grade = Grade {
        round_trips: Measured::of(link.round_trips),
        arrival_gaps: Measured::of(link.gaps),
        lateness: Measured::of(lateness),
        openings: Measured::of(openings),
    };
    let advice: Advice = grade.advice(cycle, args.batch, (*LEAD_CYCLES.start(), *LEAD_CYCLES.end()));
    if screen.json {
        let answer = show::json(endpoint, &link.served_by, &grade, &advice, link.underruns);
        writeln!(screen.out, "{answer}")?;
        return Ok(());
    }
    show::table(screen, endpoint, &link.served_by, &grade)?;
    show::advice(screen, &advice, cycle, link.underruns)
}

/// One axis that moves for longer than `time`, slowly.
fn slow_move(time: Duration) -> Result<Accepted, Failure> {
    let limits =
        LimitsSpec { max_velocity: 0.01, max_acceleration: 1.0, max_jerk: 10.0, ..LimitsSpec::default() };
    let axis = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(0.01 * (time.as_secs_f64() + 10.0)),
        limits,
    };
    let spec = RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    };
    let judged =
        Judged::answer(&Request::try_from(spec).map_err(Failure::refused)?).map_err(Failure::refused)?;
    judged.accepted().map_err(Failure::refused)
}

/// An axis with nothing behind it, whose stream is open.
struct Axis {
    uplink: Uplink,
    buffer: Buffer,
    cycle: CycleTime,
    batch: u32,
    heeded: u64,
    /// How long it took to open the stream.
    opening: Duration,
}

/// What was seen on the way.
struct Seen {
    round_trips: Vec<Duration>,
    gaps: Vec<Duration>,
    underruns: u64,
    served_by: String,
}

impl Axis {
    async fn open(servers: &Servers, plan: &Accepted, batch: u32, number: usize) -> Result<Self, Failure> {
        let open = Open {
            stream: format!("portamento-grade/{}-{number}", std::process::id()),
            epoch: 1,
            lead_cycles: *LEAD_CYCLES.end(),
            batch_cycles: batch,
            axis_guard: DEFAULT_AXIS_GUARD,
            close_at_rest: true,
            accept_unproved: false,
            executed_cycle: 0,
            compact: false,
            source: Source::Plan(plan.clone()),
        };
        let (lead_cycles, axis_guard, cycle) = (open.lead_cycles, open.axis_guard, plan.plan().cycle_time());
        let began = Instant::now();
        let mut uplink = Uplink::new(servers.clone(), open, cycle);
        let opened = loop {
            match uplink.next().await {
                Next::News(News::Opened(opened)) => break opened,
                Next::News(News::Over(how)) => {
                    let nobody = || Failure::Internal("the stream ended before it was opened".into());
                    return Err(how.err().map_or_else(nobody, |failure| failure.cause.into()));
                }
                Next::News(_) | Next::Feed(_) => {}
            }
        };
        let opening = began.elapsed();
        let setpoints: Vec<Setpoint> = plan.plan().sampler().at(0).collect();
        let epoch = uplink.failover().serving_epoch().unwrap_or(1);
        let standing =
            Standing { epoch, lead_cycles, axis_guard, plan: opened.motion.plan(), setpoints: &setpoints };
        let mut buffer = Buffer::new(&standing);
        buffer.motion_ends_at(opened.motion.last_cycle());
        Ok(Self { uplink, buffer, cycle, batch, heeded: 0, opening })
    }

    /// Plays in real time for `time`, and closes.
    async fn play(mut self, time: Duration, bar: &indicatif::ProgressBar) -> Result<Seen, Failure> {
        let served_by = self.uplink.failover().served_by().to_owned();
        let mut seen = Seen { round_trips: Vec::new(), gaps: Vec::new(), underruns: 0, served_by };
        let period = Duration::from_nanos(self.cycle.as_ns() * u64::from(self.batch));
        let mut reports = tokio::time::interval(period);
        let (mut began, mut last_arrival): (Option<Instant>, Option<Instant>) = (None, None);
        // The report that is on its way, and the first cycle that it allows.
        let mut asked: Option<(Instant, u64)> = None;
        while began.is_none_or(|began| began.elapsed() < time) {
            let next = tokio::select! {
                next = self.uplink.next() => Some(next),
                _ = reports.tick() => None,
            };
            let now = Instant::now();
            if began.is_none() && self.buffer.is_ready() {
                began = Some(now);
            }
            let mut refused = None;
            match next {
                Some(Next::Feed(Feed::Batch(epoch, mut batch))) => {
                    let end = batch.last_cycle();
                    if let Some((since, _)) = asked.take_if(|(_, from)| end >= *from) {
                        seen.round_trips.push(now - since);
                    }
                    if began.is_some() {
                        seen.gaps.extend(last_arrival.replace(now).map(|last| now - last));
                    }
                    refused = self.buffer.accept(epoch, &mut batch).err();
                }
                Some(Next::Feed(Feed::Revised(epoch, revision))) => {
                    drop(self.buffer.announce(epoch, revision))
                }
                Some(Next::Feed(Feed::Resuming)) => {
                    self.heeded += 1;
                    self.buffer.resuming(true);
                }
                Some(Next::Feed(Feed::Stays)) => self.buffer.resuming(false),
                Some(Next::Feed(Feed::GoesOn(epoch, rested))) => drop(self.buffer.goes_on(epoch, rested)),
                Some(Next::News(News::Over(Err(failure)))) => return Err(failure.cause.into()),
                Some(Next::News(_)) => {}
                None => {
                    let Some(began) = began else { continue };
                    bar.set_position(u64::try_from(began.elapsed().as_millis()).unwrap_or(u64::MAX));
                    seen.underruns += self.play_due(now - began);
                    let grant = self.buffer.report(None).grant_cycle;
                    if grant > self.buffer.accepted() {
                        asked.get_or_insert((now, grant));
                    }
                    self.report(None);
                }
            }
            if refused.is_some() {
                self.report(refused);
            }
        }
        self.uplink.close();
        Ok(seen)
    }

    /// Plays every cycle that is due; gives how many of them were not held.
    fn play_due(&mut self, since: Duration) -> u64 {
        let due = u64::try_from(since.as_nanos() / u128::from(self.cycle.as_ns())).unwrap_or(u64::MAX);
        while self.buffer.executed() < due {
            if self.buffer.play().is_none() {
                return due - self.buffer.executed();
            }
        }
        0
    }

    fn report(&mut self, refused: Option<Refused>) {
        self.uplink.report(self.buffer.report(refused), self.heeded);
    }
}
