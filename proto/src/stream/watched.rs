//! A stream as it runs, as somebody who looks on sees it.

use std::time::Duration;

use planner::{AxisKind, CycleTime};

use super::{Columns, Counters, Phase, StreamEvent, Tracking};

/// What a watcher asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Watch {
    /// Name of the stream; `None`: summaries of all.
    pub stream: Option<String>,
    /// The least time between two messages of a stream.
    pub period: Duration,
    /// The most cycles a message.
    pub max_points: usize,
}

impl Watch {
    /// The least time between two messages where nobody says.
    pub const DEFAULT_PERIOD: Duration = Duration::from_millis(50);
    /// The longest time between two messages.
    pub const LONGEST_PERIOD: Duration = Duration::from_secs(60);
    /// The most cycles a message where nobody says: more than a period has at 1 ms.
    pub const DEFAULT_POINTS: usize = 500;
    /// The most that may be asked for.
    pub const MOST_POINTS: usize = 10_000;

    /// Summaries of all streams.
    #[must_use]
    pub fn all() -> Self {
        Self { stream: None, period: Self::DEFAULT_PERIOD, max_points: Self::DEFAULT_POINTS }
    }

    /// One stream, with how its axes follow.
    #[must_use]
    pub fn stream(name: impl Into<String>) -> Self {
        Self { stream: Some(name.into()), ..Self::all() }
    }

    /// The same, every so often at most.
    #[must_use]
    pub fn every(self, period: Duration) -> Self {
        Self { period, ..self }
    }
}

/// A stream as it runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Watched {
    /// Its name.
    pub stream: String,
    /// Names of its axes, in plan order.
    pub axes: Vec<String>,
    /// The last cycle given to the servo, as last reported.
    pub executed_cycle: u64,
    /// Cycles held ahead of it.
    pub lead_cycles: u64,
    /// What it is doing.
    pub phase: Phase,
    /// Factor on the feed rate \[1\].
    pub override_factor: f64,
    /// The cycle of each entry of the columns, ascending and uneven; empty in summaries.
    pub cycles: Vec<u64>,
    /// The setpoints of those cycles.
    pub commanded: Columns,
    /// How the axis followed them; `None` where it does not say.
    pub tracking: Option<Tracking>,
    /// How the stream has gone so far.
    pub counters: Counters,
    /// Messages that this watcher lost because it was too slow.
    pub messages_dropped: u64,
    /// What happened since the last message.
    pub events: Vec<StreamEvent>,
    /// The period of which cycles are counts; `None` where the server does not say.
    pub cycle_time: Option<CycleTime>,
    /// What each axis moves in, in plan order; empty where the server does not say.
    pub kinds: Vec<AxisKind>,
}
