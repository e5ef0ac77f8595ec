//! What a run tells, on its way and at its end.

use client::failover::Change;
use proto::Digest;
use proto::stream::{Counters, Operation, OperationResult, StreamEvent};

use crate::axis::InvalidConfig;
use crate::jitter::Jitter;
use crate::monitor::ReportCard;
use crate::samples::Samples;

/// How well the axes followed.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackingReport {
    /// One card for each axis, in plan order.
    pub axes: Vec<ReportCard>,
    /// How the stream did.
    pub stream: StreamReport,
}

/// How the stream of a run did.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StreamReport {
    /// Cycles given to the servo; those of the settle window are not counted.
    pub cycles_executed: u64,
    /// As in the reports to the server. In virtual time the axis waits for data at half the lead, which is the least that it
    /// then reports.
    pub counters: Counters,
    /// Times that the stream went on with another replica.
    pub failovers: u64,
    /// Revisions of the motion that were adopted: one for each operation that changed it.
    pub revisions: u64,
    /// How late cycles began; 0 in virtual time.
    pub jitter: Jitter,
    /// Of the last cycle of the motion that was played; cycles at rest after it are not in it.
    pub digest: Digest,
    /// Was a stop tail played?
    pub stop_tail_used: bool,
}

/// What a run tells while it goes on.
#[derive(Clone, Debug, PartialEq)]
pub enum Update {
    /// How the axes follow.
    Samples(Samples),
    /// Something happened to the stream.
    Event(StreamEvent),
    /// Another planner goes on with it.
    FailedOver(Change),
    /// An operation that was asked for here has taken effect.
    Operated(Box<(Operation, OperationResult)>),
}

/// Why a run has no report, or none that is whole.
#[derive(Debug, thiserror::Error)]
pub enum TrackError {
    /// Nowhere to go.
    #[error("no endpoint is given: name at least one planner, as http://127.0.0.1:50051")]
    NoEndpoint,
    /// A model for an axis that does not move.
    #[error("no axis is called {name:?}: the plan has {known}")]
    UnknownAxis {
        /// The name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// An axis that cannot be simulated like this.
    #[error("axis {axis:?}: {cause}")]
    Config {
        /// Its name.
        axis: String,
        /// Why not.
        cause: InvalidConfig,
    },
    /// No planner opened the stream.
    #[error("the stream cannot be opened: {cause}")]
    NotOpened {
        /// The last one that was tried.
        endpoint: String,
        /// What it said.
        cause: client::Error,
    },
    /// The stream broke off before the motion had ended, and no planner went on. The axis has played what it held, and its way to rest.
    #[error(
        "the stream ended at cycle {executed} of {motion_end}: {cause}; the axis rests there: plan from where it stands \
         and run again"
    )]
    Broken {
        /// The last cycle that was played.
        executed: u64,
        /// The last cycle of the motion.
        motion_end: u64,
        /// What happened.
        cause: client::Error,
        /// How well the axis followed until there.
        report: Box<TrackingReport>,
    },
    /// An axis left its setpoints beyond any sense.
    #[error(
        "axis {axis:?} diverged in cycle {cycle}: it was more than a thousand times its travel away from its setpoint; lower \
         the gains of its servo, raise its max_effort, or ask for less acceleration"
    )]
    Diverged {
        /// Its name.
        axis: String,
        /// When.
        cycle: u64,
        /// How well the axes followed until there.
        report: Box<TrackingReport>,
    },
    /// Whoever looked on has gone, and the run with them.
    #[error("nobody looks on any more, so the run was ended")]
    Abandoned,
    /// The process cannot run one more axis.
    #[error("the cycle thread cannot run: {0}")]
    Thread(String),
}

impl TrackError {
    /// How well the axes followed until the run broke off, where it had begun.
    #[must_use]
    pub fn report(&self) -> Option<&TrackingReport> {
        match self {
            Self::Broken { report, .. } | Self::Diverged { report, .. } => Some(report),
            Self::NoEndpoint
            | Self::UnknownAxis { .. }
            | Self::Config { .. }
            | Self::NotOpened { .. }
            | Self::Abandoned
            | Self::Thread(_) => None,
        }
    }
}
