//! What a run is asked for.

use std::time::{Duration, SystemTime};

use client::failover::DEFAULT_PATIENCE;
use client::{Connect, Servers};
use planner::{Accepted, AxisKind, Setpoint};
use proto::stream::{DEFAULT_AXIS_GUARD, DEFAULT_BATCH_CYCLES, DEFAULT_LEAD_CYCLES, Open, Source};

use super::TrackError;
use crate::axis::{Axis, AxisConfig};
use crate::clock::Clock;
use crate::faults::Faults;
use crate::model::AxisModel;

/// What an axis is asked to follow, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackRequest {
    /// Name of the stream to open.
    pub stream: String,
    /// Where planners are; tried in order, unless they are to be [spread](Self::spread), until one opens the stream, and again where
    /// the one that serves it is lost.
    pub endpoints: Vec<String>,
    /// The motion.
    pub plan: Accepted,
    /// Models by axis name; an axis that is not named follows ideally.
    pub models: Vec<AxisModel>,
    /// What the run goes by.
    pub clock: Clock,
    /// How far ahead setpoints are held [cycles].
    pub lead_cycles: u32,
    /// How long the loads are watched after the last setpoint [s].
    pub settle_window: f64,
    /// How near to the goal is settled [axis units]; `None`: [`default_settle_tolerance`] of each axis's kind.
    pub settle_tolerance: Option<f64>,
    /// Keep the stream open at rest, until it is closed from outside? In virtual time nothing happens then.
    pub stay_open: bool,
    /// Take a plan that does not guarantee velocity and acceleration?
    pub accept_unproved: bool,
    /// Evaluate the motion here, with the same bits, so that the stream carries no setpoints?
    pub compact: bool,
    /// Try the planners in an [order of the stream's own](Servers::spread_for), so that the streams of a plant are spread over them?
    pub spread: bool,
    /// How long a planner that goes on is looked for, once there is none.
    pub patience: Duration,
    /// How planners are connected to.
    pub connect: Connect,
    /// What goes wrong on purpose.
    pub faults: Option<Faults>,
}

/// How long loads are watched after the last setpoint where nobody says [s]: two dozen swings of a soft machine.
pub const DEFAULT_SETTLE_WINDOW: f64 = 0.5;

/// How near to the goal is settled where nobody says [axis units]: 10 µm, 10 µrad, or one pulse.
#[must_use]
pub fn default_settle_tolerance(kind: AxisKind) -> f64 {
    match kind {
        AxisKind::Prismatic | AxisKind::Revolute => 1e-5,
        AxisKind::Pulses => 1.0,
    }
}

impl TrackRequest {
    pub(super) fn servers(&self) -> Servers {
        let (endpoints, connect) = (self.endpoints.clone(), self.connect.clone());
        let servers = Servers { endpoints, connect, patience: self.patience };
        if self.spread { servers.spread_for(&self.stream) } else { servers }
    }

    /// To follow `plan` from the planner at `endpoint`, with ideal axes, in wall-clock time.
    #[must_use]
    pub fn new(stream: impl Into<String>, endpoint: impl Into<String>, plan: Accepted) -> Self {
        Self {
            stream: stream.into(),
            endpoints: vec![endpoint.into()],
            plan,
            models: Vec::new(),
            clock: Clock::Wall,
            lead_cycles: DEFAULT_LEAD_CYCLES,
            settle_window: DEFAULT_SETTLE_WINDOW,
            settle_tolerance: None,
            stay_open: false,
            accept_unproved: false,
            compact: false,
            spread: false,
            patience: DEFAULT_PATIENCE,
            connect: Connect::new(),
            faults: None,
        }
    }
}

/// The axes of the plan, in its order, each with its model.
pub(super) fn axes(request: &TrackRequest) -> Result<Vec<Axis>, TrackError> {
    let plan = request.plan.plan();
    for model in &request.models {
        if plan.axes().iter().all(|axis| axis.axis != model.axis()) {
            let known = plan.axes().iter().map(|axis| axis.axis.as_str()).collect::<Vec<_>>().join(", ");
            return Err(TrackError::UnknownAxis { name: model.axis().into(), known });
        }
    }
    let starts = plan.sampler().at(0).collect::<Vec<Setpoint>>();
    plan.axes()
        .iter()
        .zip(&starts)
        .map(|(axis, start)| {
            let named = request.models.iter().find(|model| model.axis() == axis.axis);
            let model = named.cloned().unwrap_or_else(|| AxisModel::ideal(axis.axis.clone()));
            let config = AxisConfig {
                cycle: plan.cycle_time().as_seconds(),
                settle_window: request.settle_window,
                settle_tolerance: request.settle_tolerance.unwrap_or(default_settle_tolerance(axis.kind)),
            };
            Axis::new(&model, config, &start.state)
                .map_err(|cause| TrackError::Config { axis: axis.axis.clone(), cause })
        })
        .collect()
}

/// What the stream is opened with.
pub(super) fn open_of(request: &TrackRequest) -> Open {
    Open {
        stream: request.stream.clone(),
        epoch: fresh_epoch(),
        lead_cycles: request.lead_cycles.max(1),
        // Several reports a lead, or the credit would run out between them.
        batch_cycles: DEFAULT_BATCH_CYCLES.min(request.lead_cycles.div_ceil(2)).max(1),
        axis_guard: DEFAULT_AXIS_GUARD,
        close_at_rest: !request.stay_open,
        accept_unproved: request.accept_unproved,
        executed_cycle: 0,
        compact: request.compact,
        source: Source::Plan(request.plan.clone()),
    }
}

/// Larger than that of any run before, over restarts of the process too: the time [ns].
#[expect(clippy::disallowed_methods, reason = "only numbers a run; no setpoint depends on it")]
fn fresh_epoch() -> u64 {
    let since = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    u64::try_from(since.as_nanos()).unwrap_or(u64::MAX)
}
