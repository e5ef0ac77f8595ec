//! The words of a setpoint stream, in domain types: what an axis and a server say to each other.
//!
//! Time on a stream is the cycle index. Cycle 0 is the state in which the axis stands: executed and accepted, never sent,
//! not in the digest.

mod motion;
mod watched;

use std::ops::RangeInclusive;
use std::sync::Arc;

pub use planner::motion::Phase;
use planner::{Accepted, Plan, Profile, Setpoint};

use crate::Digest;
pub use motion::{
    Ask, GoalSpec, Motion, Operation, OperationRefusal, OperationResult, RECENT_RESULTS, refused_operation,
};
pub use watched::{Watch, Watched};

/// What an axis says.
#[derive(Clone, Debug, PartialEq)]
pub enum FromAxis {
    /// First, exactly once.
    Open(Box<Open>),
    /// Where the axis is: the clock of the session.
    Report(Report),
    /// An operation on the motion, in band.
    Operation(Operation),
}

/// What a server says, under the epoch that it serves.
#[derive(Clone, Debug, PartialEq)]
pub enum ToAxis {
    /// The stream is open.
    Opened(Box<Opened>),
    /// The motion has changed; ahead of the setpoints that follow from it.
    Revised(Box<Revised>),
    /// Setpoints.
    Batch(Batch),
    /// Something happened.
    Event(StreamEvent),
    /// An operation was done, as the axis has confirmed.
    Result(OperationResult),
    /// An operation was refused; the stream goes on.
    Refusal(OperationRefusal),
}

/// Opens a stream.
#[derive(Clone, Debug, PartialEq)]
pub struct Open {
    /// The stream's name, chosen by the axis: `cell-7/x`.
    pub stream: String,
    /// Chosen by the axis, above 0 and larger at every open.
    pub epoch: u64,
    /// How far ahead the axis wants to hold setpoints \[cycles\], within [`LEAD_CYCLES`]; also the first grant.
    pub lead_cycles: u32,
    /// How many cycles go into a batch at most, within [`BATCH_CYCLES`].
    pub batch_cycles: u32,
    /// A replacing batch begins later than executed + this \[cycles\], which is less than the lead.
    pub axis_guard: u32,
    /// Finish when the plan ends, instead of standing still?
    pub close_at_rest: bool,
    /// Take a plan that does not guarantee velocity and acceleration?
    pub accept_unproved: bool,
    /// The last cycle given to the servo; 0 for a new stream.
    pub executed_cycle: u64,
    /// Does the axis evaluate the motion itself, so that batches come [bare](Columns::bare)?
    pub compact: bool,
    /// What is to be played.
    pub source: Source,
}

/// What a stream is opened with.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A new motion, from the state in which the axis stands.
    Plan(Accepted),
    /// A motion under way, as the axis has adopted it.
    Resume(Box<Resume>),
}

impl Source {
    /// What is to be played first.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        match self {
            Self::Plan(plan) => plan.plan(),
            Self::Resume(resume) => resume.motion.plan(),
        }
    }
}

/// All that a server needs to go on with a stream that another has served.
#[derive(Clone, Debug, PartialEq)]
pub struct Resume {
    /// The motion at the revision that the axis has adopted.
    pub motion: Motion,
    /// The first cycle that the axis does not hold, after the motion's first.
    pub next_cycle: u64,
    /// Of the cycle before it.
    pub digest: Digest,
    /// A cycle to recompute the digest from: at most [`FARTHEST_CHECKPOINT`] before `next_cycle`, not before the motion.
    pub checkpoint_cycle: u64,
    /// Of the cycle before it; zero for cycle 0.
    pub checkpoint_digest: Digest,
}

impl Resume {
    /// The digest of the last cycle that is held, computed again from the checkpoint.
    #[must_use]
    pub fn recomputed(&self) -> Digest {
        let known = self.checkpoint_cycle.saturating_sub(1);
        self.motion.digest_from((known, self.checkpoint_digest), self.next_cycle - 1)
    }
}

/// How far ahead an axis holds setpoints where it does not say \[cycles\].
pub const DEFAULT_LEAD_CYCLES: u32 = 40;
/// How many cycles go into a batch where the axis does not say.
pub const DEFAULT_BATCH_CYCLES: u32 = 10;
/// How far beyond the executed cycle a replacing batch begins where the axis does not say \[cycles\].
pub const DEFAULT_AXIS_GUARD: u32 = 2;
/// How far ahead an axis may hold setpoints \[cycles\]: less is used up by one late packet, more reacts too late.
pub const LEAD_CYCLES: RangeInclusive<u32> = 10..=250;
/// How many cycles may go into a batch: it bounds the size of a message.
pub const BATCH_CYCLES: RangeInclusive<u32> = 1..=1000;
/// The farthest that a checkpoint lies before the cycle to go on from \[cycles\]: to check so many takes less than a millisecond.
pub const FARTHEST_CHECKPOINT: u64 = 1000;
/// The farthest that a server sends past the reported executed cycle \[cycles\], whatever is granted.
pub const FARTHEST_AHEAD: u64 = 4096;

/// The stream is open.
#[derive(Clone, Debug, PartialEq)]
pub struct Opened {
    /// What will be played; `None` after a resume, of which it is the motion that was given: it need not be judged, written and read
    /// twice in the hundredth of a second in which many axes may come at once.
    pub motion: Option<Motion>,
    /// The first cycle that will be sent.
    pub first_cycle: u64,
    /// Who serves.
    pub served_by: String,
    /// The epoch that is served.
    pub current_epoch: u64,
}

/// The motion has changed.
#[derive(Clone, Debug, PartialEq)]
pub struct Revised {
    /// What is played from now on, with the judge's certificate in its plan.
    pub motion: Motion,
}

/// Consecutive cycles of setpoints.
#[derive(Clone, Debug, PartialEq)]
pub struct Batch {
    /// The first of them.
    pub first_cycle: u64,
    /// The revision of the motion that they follow from.
    pub revision: u64,
    /// Cycles from the first one on that are held already are superseded, all at once.
    pub replaces: bool,
    /// At rest after this, nothing follows.
    pub last: bool,
    /// The setpoints.
    pub columns: Columns,
    /// The digest of the last cycle.
    pub digest: Digest,
    /// The way to rest from the last cycle.
    pub tails: Tails,
}

/// The way to rest of each axis, in plan order, from the last cycle of a batch: what an axis plays that hears no more. Its time
/// is zero at that cycle. Of no axes where all rest.
///
/// Whoever holds it shares it: a clone costs no memory.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tails(Option<Arc<[Profile]>>);

impl Tails {
    /// One for each axis; each ends at rest.
    #[must_use]
    pub fn new(profiles: impl IntoIterator<Item = Profile>) -> Self {
        let profiles: Arc<[Profile]> = profiles.into_iter().collect();
        Self((!profiles.is_empty()).then_some(profiles))
    }

    /// The way of each axis.
    #[must_use]
    pub fn profiles(&self) -> &[Profile] {
        self.0.as_deref().unwrap_or_default()
    }

    /// How long the slowest axis takes to rest \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.profiles().iter().map(Profile::duration).fold(0.0, f64::max)
    }
}

impl Batch {
    /// The last of the cycles.
    #[must_use]
    pub fn last_cycle(&self) -> u64 {
        self.first_cycle.saturating_add(self.columns.cycles() as u64).saturating_sub(1)
    }
}

/// Setpoints of several cycles and axes: axis a at cycle c stands at `a · cycles + c` of each column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    cycles: usize,
    position: Vec<f64>,
    velocity: Vec<f64>,
    acceleration: Vec<f64>,
    jerk: Vec<f64>,
}

impl Columns {
    /// Room for `cycles` cycles of `axes` axes.
    #[must_use]
    pub fn with_capacity(cycles: usize, axes: usize) -> Self {
        let column = || Vec::with_capacity(cycles * axes);
        Self { cycles, position: column(), velocity: column(), acceleration: column(), jerk: column() }
    }

    /// No setpoints, but how many cycles there would be: those of a compact stream, for the axis to evaluate.
    #[must_use]
    pub fn bare(cycles: usize) -> Self {
        Self { cycles, ..Self::default() }
    }

    /// Are there cycles without setpoints?
    #[must_use]
    pub fn is_bare(&self) -> bool {
        self.cycles > 0 && self.position.is_empty()
    }

    /// The setpoints of `plan` at its cycles `cycles`.
    #[must_use]
    pub fn of_plan(plan: &Plan, cycles: std::ops::Range<u64>) -> Self {
        let (axes, count) = (plan.axes().len(), cycles.end.saturating_sub(cycles.start) as usize);
        let mut columns = [(); 4].map(|()| vec![0.0; count * axes]);
        let mut sampler = plan.sampler();
        for axis in 0..axes {
            let filled = axis * count..(axis + 1) * count;
            sampler.fill(axis, cycles.start, columns.each_mut().map(|column| &mut column[filled.clone()]));
        }
        let [position, velocity, acceleration, jerk] = columns;
        Self { cycles: count, position, velocity, acceleration, jerk }
    }

    /// Takes columns as they are. `None` where their lengths are not the same whole number of cycles.
    #[must_use]
    pub fn from_parts(
        cycles: usize,
        [position, velocity, acceleration, jerk]: [Vec<f64>; 4],
    ) -> Option<Self> {
        let length = position.len();
        let same = [&velocity, &acceleration, &jerk].iter().all(|column| column.len() == length);
        // Bare ones are made on purpose alone.
        let whole = if cycles == 0 { length == 0 } else { length > 0 && length.is_multiple_of(cycles) };
        (same && whole).then_some(Self { cycles, position, velocity, acceleration, jerk })
    }

    /// The columns, position to jerk.
    #[must_use]
    pub fn into_parts(self) -> [Vec<f64>; 4] {
        [self.position, self.velocity, self.acceleration, self.jerk]
    }

    /// Adds one setpoint: all cycles of the first axis, then all of the second …
    pub fn push(&mut self, setpoint: Setpoint) {
        let [position, velocity, acceleration, jerk] = setpoint.words();
        self.position.push(position);
        self.velocity.push(velocity);
        self.acceleration.push(acceleration);
        self.jerk.push(jerk);
    }

    /// How many cycles there are.
    #[must_use]
    pub fn cycles(&self) -> usize {
        self.cycles
    }

    /// How many axes there are; 0 where there is no cycle.
    #[must_use]
    pub fn axes(&self) -> usize {
        self.position.len().checked_div(self.cycles).unwrap_or(0)
    }

    /// The setpoint of `axis` at the `index`th cycle.
    #[must_use]
    pub fn at(&self, axis: usize, index: usize) -> Option<Setpoint> {
        if index >= self.cycles {
            return None;
        }
        let place = axis * self.cycles + index;
        let state = planner::State {
            position: *self.position.get(place)?,
            velocity: *self.velocity.get(place)?,
            acceleration: *self.acceleration.get(place)?,
        };
        Some(Setpoint { state, jerk: *self.jerk.get(place)? })
    }

    /// The setpoints of all axes at the `index`th cycle, in plan order.
    pub fn cycle(&self, index: usize) -> impl Iterator<Item = Setpoint> {
        (0..self.axes()).map_while(move |axis| self.at(axis, index))
    }

    /// The digest of each cycle in turn, where `before` is that of the cycle before the first.
    pub fn digests(&self, first_cycle: u64, before: Digest) -> impl Iterator<Item = Digest> {
        let mut digest = before;
        (0..self.cycles).zip(first_cycle..).map(move |(index, cycle)| {
            digest = digest.then(cycle, self.cycle(index).map(|setpoint| setpoint.words()));
            digest
        })
    }
}

/// Where an axis is, and how far it may be sent ahead.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// The last cycle given to the servo.
    pub executed_cycle: u64,
    /// The last contiguous cycle held.
    pub accepted_cycle: u64,
    /// The last cycle that may be sent.
    pub grant_cycle: u64,
    /// The revision that is adopted.
    pub revision: u64,
    /// The digest of the accepted cycle.
    pub digest: Digest,
    /// A batch that was not taken.
    pub refused: Option<Refused>,
    /// The stop tail is being played from here on: the epoch is over.
    pub tail_from_cycle: Option<u64>,
    /// Where the axis really was; only while somebody watches.
    pub tracking: Option<Tracking>,
    /// How the stream has gone so far.
    pub counters: Counters,
}

/// A batch that an axis did not take.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// Of the batch.
    pub revision: u64,
    /// Of the batch.
    pub first_cycle: u64,
    /// Why.
    pub reason: RefusalReason,
}

/// Why an axis does not take a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum RefusalReason {
    /// Cycles are missing before it.
    Gap,
    /// It replaces cycles that are executed, or about to be.
    TooLate,
    /// Its first setpoint does not follow from the one before.
    JoinMismatch,
    /// Its digest, or a cycle that is held, is another.
    DigestMismatch,
    /// A number is not finite, or the columns are not of the plan's axes.
    NotFinite,
    /// Its epoch is over.
    StaleEpoch,
    /// Its revision is neither adopted nor announced.
    Revision,
    /// The axis is opening elsewhere.
    Resuming,
    /// It goes beyond what was granted.
    BeyondGrant,
    /// Its way to rest does not follow from its last setpoint, or does not end at rest.
    StopTail,
}

impl RefusalReason {
    /// Every reason.
    pub const ALL: [Self; 10] = [
        Self::Gap,
        Self::TooLate,
        Self::JoinMismatch,
        Self::DigestMismatch,
        Self::NotFinite,
        Self::StaleEpoch,
        Self::Revision,
        Self::Resuming,
        Self::BeyondGrant,
        Self::StopTail,
    ];

    /// Does it say that the server sends what no axis may take, rather than that it came too late, or at a time when it must not?
    #[must_use]
    pub fn is_of_its_server(self) -> bool {
        match self {
            Self::Gap
            | Self::JoinMismatch
            | Self::DigestMismatch
            | Self::NotFinite
            | Self::BeyondGrant
            | Self::StopTail => true,
            Self::TooLate | Self::StaleEpoch | Self::Revision | Self::Resuming => false,
        }
    }

    /// The name on the wire.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Gap => "GAP",
            Self::TooLate => "TOO_LATE",
            Self::JoinMismatch => "JOIN_MISMATCH",
            Self::DigestMismatch => "DIGEST_MISMATCH",
            Self::NotFinite => "NOT_FINITE",
            Self::StaleEpoch => "STALE_EPOCH",
            Self::Revision => "REVISION",
            Self::Resuming => "RESUMING",
            Self::BeyondGrant => "BEYOND_GRANT",
            Self::StopTail => "STOP_TAIL",
        }
    }
}

/// Where an axis really was, cycle by cycle; axis-major as the setpoints.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracking {
    /// The first cycle.
    pub first_cycle: u64,
    /// How many cycles.
    pub cycles: u32,
    /// [axis units]
    pub measured_position: Vec<f64>,
    /// Setpoint minus measured [axis units].
    pub following_error: Vec<f64>,
    /// How late each cycle began \[ns\].
    pub cycle_jitter_ns: Vec<i32>,
}

/// How a stream has gone so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Cycles that were due and not held.
    pub underruns: u64,
    /// Cycles that came twice, the same, and were dropped.
    pub duplicate_cycles: u64,
    /// Batches that were not taken.
    pub refused_batches: u64,
    /// Messages of an epoch that is over.
    pub stale_epochs: u64,
    /// The fewest cycles held and not executed, while more of the motion was to come.
    pub least_lead_cycles: u64,
    /// Cycles that began late and were made up for.
    pub late_cycles: u64,
}

/// Something that happened on a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StreamEvent {
    /// What.
    pub kind: StreamEventKind,
    /// When.
    pub at_cycle: u64,
}

/// What happened on a stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StreamEventKind {
    /// This replica leaves: open elsewhere.
    Draining,
    /// The plan has ended, the axis rests and the stream stays open.
    Standstill,
    /// Nothing follows.
    Finished,
    /// A newer epoch was opened.
    Superseded,
    /// Somebody watches: put tracking into the reports.
    TrackingWanted,
    /// Nobody watches any more.
    TrackingUnwanted,
}
