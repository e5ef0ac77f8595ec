//! An axis that plays a stream by the wall clock, and everything that its servo was given.

use std::time::Duration;

use e2e::{difference, replay};
use planner::motion::Operation as Planned;
use planner::{Accepted, Setpoint};
use proto::stream::{Operation, OperationResult, StreamEvent};
use proto::{Digest, Rejected};
use sim_axis::{Answered, Commander, Samples, TrackError, TrackRequest, Tracking, TrackingReport, Update};

use client::failover::{Cause, Change};

/// How long anything may take that a story waits for.
pub(crate) const PATIENCE: Duration = Duration::from_secs(20);

/// How far ahead an axis of these stories holds its setpoints \[cycles\], where a story is not about that: as far as can be, since
/// the machine may have other things to do for longer than a usual lead.
pub(crate) const LEAD: u32 = 250;

/// Waits until no other story goes on: each is about time, and there are two cores.
pub(crate) async fn alone() -> impl Sized {
    static ALONE: tokio::sync::Mutex<()> = tokio::sync::Mutex::const_new(());
    ALONE.lock().await
}

/// A run that goes on.
pub(crate) struct Run {
    tracking: Tracking,
    seen: Seen,
}

/// What an axis has done so far.
#[derive(Debug, Default)]
pub(crate) struct Seen {
    /// What the servo was given, from cycle 1 on; those at the end are at rest, of the settle window.
    pub(crate) setpoints: Vec<Vec<Setpoint>>,
    /// Who went on where another had served.
    pub(crate) changes: Vec<Change>,
    /// What happened to the stream.
    pub(crate) events: Vec<StreamEvent>,
}

/// A run that is over.
#[derive(Debug)]
pub(crate) struct Played {
    pub(crate) report: TrackingReport,
    pub(crate) seen: Seen,
}

/// An ideal axis on `plan` that holds `lead` cycles ahead.
pub(crate) fn request(name: &str, endpoints: &[String], plan: &Accepted, lead: u32) -> TrackRequest {
    TrackRequest {
        endpoints: endpoints.to_vec(),
        lead_cycles: lead,
        settle_window: 0.02,
        ..TrackRequest::new(name, "", plan.clone())
    }
}

impl Run {
    pub(crate) async fn begin(request: TrackRequest) -> Self {
        Self::with(request, Vec::new()).await.0
    }

    /// The same, with operations that are asked for at once.
    pub(crate) async fn with(request: TrackRequest, operations: Vec<Operation>) -> (Self, Vec<Answered>) {
        let begun = Tracking::begin_with(request, operations);
        let (tracking, answers) = tokio::time::timeout(PATIENCE, begun).await.expect("it opens").unwrap();
        (Self { tracking, seen: Seen::default() }, answers)
    }

    pub(crate) fn served_by(&self) -> &str {
        self.tracking.served_by()
    }

    pub(crate) fn seen(&self) -> &Seen {
        &self.seen
    }

    pub(crate) fn commander(&self) -> Commander {
        self.tracking.commander()
    }

    /// Looks on until `cycle` is played.
    pub(crate) async fn until(&mut self, cycle: u64) {
        self.until_seen(|seen| seen.setpoints.len() as u64 >= cycle).await;
    }

    /// Looks on until `cycles` more are played than are seen now.
    pub(crate) async fn until_cycles_more(&mut self, cycles: u64) {
        let seen = self.seen.setpoints.len() as u64;
        self.until(seen + cycles).await;
    }

    /// Looks on until `count` servers have gone on.
    pub(crate) async fn until_changes(&mut self, count: usize) {
        self.until_seen(|seen| seen.changes.len() >= count).await;
    }

    async fn until_seen(&mut self, enough: impl Fn(&Seen) -> bool) {
        let looking = async {
            while !enough(&self.seen) {
                let update = self.tracking.next().await.expect("the run goes on");
                self.seen.take(update);
            }
        };
        tokio::time::timeout(PATIENCE, looking).await.expect("it comes to pass");
    }

    /// Looks on to the end. An axis that has come to rest by itself would wait for ever to be told to go on.
    pub(crate) async fn finish(self) -> Played {
        let (seen, how) = self.end().await;
        let report = how.unwrap_or_else(|error| panic!("{error}, after {:?}", seen.changes));
        Played { report, seen }
    }

    /// The same of a run that may end badly.
    pub(crate) async fn end(mut self) -> (Seen, Result<TrackingReport, TrackError>) {
        let looking = async {
            while let Some(update) = self.tracking.next().await {
                let starved = matches!(&update, Update::FailedOver(change) if change.cause == Cause::Starved);
                self.seen.take(update);
                assert!(!starved, "after cycle {}: {:?}", self.seen.setpoints.len(), self.seen.changes);
            }
            self.tracking.finish().await
        };
        let how = tokio::time::timeout(PATIENCE, looking).await;
        let how = how.unwrap_or_else(|_| {
            panic!(
                "it does not end after cycle {}: {:?}, {:?}",
                self.seen.setpoints.len(),
                self.seen.changes,
                self.seen.events
            )
        });
        (self.seen, how)
    }
}

impl Seen {
    fn take(&mut self, update: Update) {
        match update {
            Update::Samples(samples) => self.add(&samples),
            Update::Event(event) => self.events.push(event),
            Update::Operated(_) => {}
            Update::FailedOver(change) => self.changes.push(change),
        }
    }

    fn add(&mut self, samples: &Samples) {
        assert_eq!(
            samples.first_cycle,
            self.setpoints.len() as u64 + 1,
            "no samples are missing, and none come twice"
        );
        let cycles = 0..samples.commanded.cycles();
        self.setpoints.extend(cycles.map(|index| samples.commanded.cycle(index).collect::<Vec<_>>()));
    }
}

impl Played {
    pub(crate) fn digest(&self) -> Digest {
        self.report.stream.digest
    }

    pub(crate) fn failovers(&self) -> u64 {
        self.report.stream.failovers
    }

    /// No cycle was missed, and every setpoint is that of `plan` with `operations` done to it, each at its cycle, by nobody who fails.
    pub(crate) fn is_undisturbed(&self, plan: &Accepted, operations: &[(u64, Planned)]) {
        let changes = &self.seen.changes;
        assert_eq!(self.report.stream.counters.underruns, 0, "{:?}, {changes:?}", self.report.stream);
        assert_eq!(self.failovers(), changes.len() as u64);
        let last = replay(plan, operations, 0).2.last_cycle();
        let (setpoints, digest, _) = replay(plan, operations, last);
        let cycles = self.report.stream.cycles_executed;
        assert_eq!(cycles, last, "{changes:?}");
        let differs = difference(&self.seen.setpoints[..cycles as usize], &setpoints);
        assert_eq!(differs, None, "{changes:?}");
        assert_eq!(self.digest(), digest);
        self.seen.is_smooth(plan);
    }
}

impl Seen {
    /// Each setpoint follows from the one before it with no more jerk J than the plan allows, by integration over one cycle T:
    /// |Δa| ≤ JT, and Δv and Δp differ from their trapezoidal rules by at most JT²/4 and JT³/12.
    pub(crate) fn is_smooth(&self, plan: &Accepted) {
        let plan = plan.plan();
        let cycle = plan.cycle_time().as_seconds();
        let mut before: Vec<Setpoint> = plan.sampler().at(0).collect();
        for (index, setpoints) in self.setpoints.iter().enumerate() {
            for (axis, (one, next)) in before.iter().zip(setpoints).enumerate() {
                let jerk = plan.axes()[axis].limits.jerk();
                let (one, next) = (one.state, next.state);
                let leaps = [
                    (next.acceleration - one.acceleration, jerk * cycle),
                    (
                        next.velocity - one.velocity - cycle * (one.acceleration + next.acceleration) / 2.0,
                        jerk * cycle * cycle / 4.0,
                    ),
                    (
                        next.position - one.position - cycle * (one.velocity + next.velocity) / 2.0,
                        jerk * cycle * cycle * cycle / 12.0,
                    ),
                ];
                for (leap, most) in leaps {
                    // Roundings of numbers near 1.
                    assert!(
                        leap.abs() <= most * (1.0 + 1e-6) + 1e-14,
                        "cycle {}: {one:?} to {next:?}",
                        index + 1
                    );
                }
            }
            before.clone_from(setpoints);
        }
    }
}

/// What became of an operation.
pub(crate) async fn answer(answered: Answered) -> Result<OperationResult, Rejected> {
    tokio::time::timeout(PATIENCE, answered.get()).await.expect("it is answered")
}
