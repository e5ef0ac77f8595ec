//! A motion under way, and what may be done to it: hold, resume, override, retarget, stop.
//!
//! Each operation takes effect at a cycle `n` of the stream and is a **splice**: a new plan whose time is zero at `n` and which begins in
//! the setpoint that the motion has there, bit for bit (but for the sign of a zero). So position, velocity and acceleration are continuous
//! over it. The new plan is made of constant jerk in pieces, keeps velocity, acceleration and jerk within the limits, and has been before
//! the judge, whatever the motion was made of before.
//!
//! ```text
//!                        the plan ends
//!   open ──► MOVING ───────────────────────► STANDSTILL ── stop ──► FINISHED
//!        ⟲ override,  │  ▲   ▲  retarget         │                     ▲
//!          retarget   │  │   └───────────────────┘                     │ at rest
//!                hold │  │ resume                                       │
//!                     ▼  │                       stop                   │
//!                    HOLDING ──────────────────────────────────► STOPPING
//! ```
//!
//! - **Hold** comes to rest and can be resumed, from wherever it has got to. What is done meanwhile changes what will be resumed.
//! - **Override** scales the feed rate, up to the velocity limit. It is approached as fast as acceleration and jerk allow, from above
//!   without undershoot. 0 rests: a motion moves with a factor above 0 and no hold. Goals at speed are passed at the scaled speed.
//! - **Retarget** goes to new goals from the present motion; axes that are not named keep theirs, and limits given with a goal replace the axis's.
//! - **Append** goes on through further points, for a motion through points, until its closing stop begins.
//! - **Stop** comes to rest and forgets the rest.
//!
//! An axis by itself, and axes that were planned without synchronization, are planned anew one by one; axes on a straight line as one motion
//! along it, so that they stay on it. On any other path, of axes that arrive together or go through points, the path's time is slowed, held
//! and resumed ([`retime`](crate::retime)); a stop lets each axis stop fastest there, and says so. A goal that is passed at speed is followed by a closing stop.
//!
//! What a motion begins beyond, since limits were lowered, it is led back from as fast as can be. It cannot be held to those limits until it
//! is; so its plan states them as wide as is inevitable, [`Spliced::beyond`] says so, and [`Motion::base`] keeps what was asked for. So
//! does a stop that leaves the position range: it is the fastest there is, and is not refused.
//!
//! ```
//! use planner::motion::{Motion, Operation, Phase};
//! # use planner::{AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, Request, RequestSpec, ShortPathPolicy, State, Synchronization};
//! # let limits = LimitsSpec { max_velocity: 0.5, max_acceleration: 2.0, max_jerk: 20.0, ..LimitsSpec::default() };
//! # let x = AxisMoveSpec { axis: "x".into(), kind: Ok(AxisKind::Prismatic), start: State::at_rest(0.0), goal: State::at_rest(0.4), limits };
//! # let request = Request::try_from(RequestSpec {
//! #     axes: vec![x], cycle_time_ns: None, family: Ok(Family::SCurve), order: None, short_path: Ok(ShortPathPolicy::Reject),
//! #     synchronization: Ok(Synchronization::None), minimum_duration: None, end_on_cycle: false,
//! # })?;
//! let plan = Judged::answer(&request)?.accepted()?;
//! let motion = Motion::open(plan)?;
//! let held = motion.splice(300, &Operation::Hold)?;
//! assert_eq!(held.motion.state(0, 300), motion.state(0, 300));
//! let resumed = held.motion.splice(held.rest_cycle + 1000, &Operation::Resume)?.motion;
//! assert_eq!(resumed.state(0, resumed.last_cycle()), State::at_rest(0.4));
//! assert_eq!(resumed.phase_at(resumed.last_cycle()), Phase::Standstill);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! `notes/0009-operations.md` has the decisions.

mod append;
mod each;
mod errand;
mod factor;
mod leg;
mod line;
mod operate;
mod parts;
mod passing;
mod path;
mod prove;
mod refused;
mod retarget;
mod tail;

use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::{Accepted, AxisPlan, Judged, Limits, Plan, Profile, Setpoint, State, Synchronization, TimeLaw};
pub use append::{AxisPoints, Points};
use errand::{Errand, UnderWay, has_passed};
pub use factor::Override;
pub use parts::MotionParts;
pub use prove::Beyond;
pub use refused::{InvalidMotion, Refused};

/// A motion under way: all that an operation on it needs, as data.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    revision: u64,
    from_cycle: u64,
    plan: Arc<Accepted>,
    factor: Override,
    phase: Phase,
    base: Option<Arc<Accepted>>,
    /// How time goes on in the base, where that is a path that is re-timed.
    law: Option<Arc<TimeLaw>>,
    closing_from_cycle: Option<u64>,
}

/// What a motion is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Phase {
    /// Going to its goals, or resting under an override of 0 until it may.
    Moving,
    /// Slowing to rest, or at rest, ready to resume.
    Holding,
    /// Slowing to rest; the rest of the motion is forgotten.
    Stopping,
    /// At its goals; the next may come.
    Standstill,
    /// At rest, and nothing follows.
    Finished,
}

/// What may be done to a motion.
#[derive(Clone, Debug, PartialEq)]
pub enum Operation {
    /// Comes to rest, ready to resume.
    Hold,
    /// Goes on with what was held.
    Resume,
    /// Scales the feed rate.
    Override(Override),
    /// Goes to new goals; axes that are not named keep theirs.
    Retarget(Vec<AxisGoal>),
    /// Goes on through further points, for a motion through points.
    Append(Points),
    /// Comes to rest and forgets the rest.
    Stop,
}

/// A new goal of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisGoal {
    /// The axis.
    pub axis: String,
    /// Where it is to end, or what to pass before it stops.
    pub goal: State,
    /// What it may do from now on; `None`: as before.
    pub limits: Option<Limits>,
}

/// What becomes of a motion by an operation.
#[derive(Clone, Debug, PartialEq)]
pub struct Spliced {
    /// The motion from now on. Its revision is one more where anything has changed.
    pub motion: Motion,
    /// When the operation takes effect.
    pub effective_cycle: u64,
    /// The first cycle at rest.
    pub rest_cycle: u64,
    /// Does the motion stay on its path? A stop leaves one that is not straight.
    pub on_path: bool,
    /// Does any setpoint change?
    pub changes: bool,
    /// The limits that the motion begins beyond, or cannot keep from where it is: empty where it keeps all.
    pub beyond: Vec<Beyond>,
}

impl Motion {
    /// Begins a motion at cycle 0. A plan that ends at speed gets a closing stop.
    ///
    /// # Errors
    /// [`Why::PositionLimit`](crate::Why::PositionLimit) where the closing stop leaves the position range; [`Refused::OffLine`]
    /// for a plan that is said to keep to a straight line and does not.
    pub fn open(plan: Accepted) -> Result<Self, Refused> {
        let opened = |plan: Accepted, closing_from_cycle| Self {
            revision: 0,
            from_cycle: 0,
            plan: Arc::new(plan),
            factor: Override::FULL,
            phase: Phase::Moving,
            base: None,
            law: None,
            closing_from_cycle,
        };
        let closed = match Kind::of(plan.plan()) {
            Kind::Line => line::with_closing_stop(plan.plan())?,
            Kind::Each | Kind::Path => plan.plan().with_closing_stop()?,
        };
        let Some((closed, closing)) = closed else { return Ok(opened(plan, None)) };
        let accepted = Judged::new(closed).accepted().map_err(Refused::Rejected)?;
        Ok(opened(accepted, Some(closing)))
    }

    /// 0 when it was opened; one more with every operation that changed it.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The cycle at which the plan's time is zero.
    #[must_use]
    pub fn from_cycle(&self) -> u64 {
        self.from_cycle
    }

    /// The first cycle at which the plan has ended, at rest.
    #[must_use]
    pub fn last_cycle(&self) -> u64 {
        self.from_cycle + self.plan().cycle_count()
    }

    /// What is being played, with its certificate.
    #[must_use]
    pub fn accepted(&self) -> &Accepted {
        &self.plan
    }

    /// What is being played.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        self.plan.plan()
    }

    /// The factor on the feed rate.
    #[must_use]
    pub fn factor(&self) -> Override {
        self.factor
    }

    /// What it was doing when it was last changed; [`Motion::phase_at`] tells what it is doing.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// What is to be gone on with, where that is not the plan itself: the plan that was held, the goals and limits that were asked for, or
    /// the line that the axes keep. Axes without pieces have their goal and their limits alone.
    #[must_use]
    pub fn base(&self) -> Option<&Accepted> {
        self.base.as_deref()
    }

    /// Of a motion that keeps to a path that is no straight line, and was held or slowed: path time of the base as a function of time,
    /// which is zero at [`from_cycle`](Self::from_cycle).
    #[must_use]
    pub fn base_time(&self) -> Option<&TimeLaw> {
        self.law.as_deref()
    }

    /// The cycle at which the closing stop of a motion that passes its goal at speed begins.
    #[must_use]
    pub fn closing_from_cycle(&self) -> Option<u64> {
        self.closing_from_cycle
    }

    /// What the motion is doing at `cycle`, if nothing is done to it.
    #[must_use]
    pub fn phase_at(&self, cycle: u64) -> Phase {
        let ended = cycle >= self.last_cycle();
        match self.phase {
            Phase::Moving if ended && !self.is_paused() => Phase::Standstill,
            Phase::Stopping if ended => Phase::Finished,
            phase => phase,
        }
    }

    /// The setpoints of all axes at `cycle`, in plan order: the start before the motion, and its end after it.
    pub fn setpoints(&self, cycle: u64) -> impl Iterator<Item = Setpoint> {
        let time = self.time_of(cycle);
        self.plan().axes().iter().map(move |axis| axis.profile.at(time))
    }

    /// Where axis number `axis` is commanded to be at `cycle`.
    ///
    /// # Panics
    /// Where the plan has no such axis.
    #[must_use]
    pub fn state(&self, axis: usize, cycle: u64) -> State {
        self.plan().axes()[axis].profile.at(self.time_of(cycle)).state
    }

    fn under_way<'a>(&'a self, at_cycle: u64, aims: &'a [AxisPlan], errand: Errand<'a>) -> UnderWay<'a> {
        UnderWay { plan: self.plan(), at: self.time_of(at_cycle), aims, errand }
    }

    /// What is gone to, within which limits.
    fn asked(&self) -> &Plan {
        self.base.as_ref().unwrap_or(&self.plan).plan()
    }

    /// Goals and limits as they were asked for; of an axis whose goal is behind it, where its closing stop ends.
    fn aims(&self, at_cycle: u64) -> Vec<AxisPlan> {
        let at = self.time_of(at_cycle);
        let axes = self.asked().axes().iter().zip(self.plan().axes());
        axes.map(|(asked, now)| {
            // A goal that was re-timed is passed where the stop begins.
            let closes = || self.closing_from_cycle.is_some_and(|closing| at_cycle >= closing);
            let passed =
                !self.is_kept_at_rest() && if self.law.is_some() { closes() } else { has_passed(now, at) };
            let goal = if passed { now.profile.end() } else { asked.goal };
            aim(asked, goal, asked.limits.clone())
        })
        .collect()
    }

    fn has_passed_any(&self, at_cycle: u64) -> bool {
        let at = self.time_of(at_cycle);
        !self.is_kept_at_rest() && self.plan().axes().iter().any(|axis| has_passed(axis, at))
    }

    /// On its way to rest by an override of 0, or at rest by it, with a goal to go to.
    fn is_paused(&self) -> bool {
        self.phase == Phase::Moving && self.factor.rests() && self.base.is_some()
    }

    /// Is the plan a way to rest, with more to go to after it?
    fn is_kept_at_rest(&self) -> bool {
        self.phase == Phase::Holding || self.is_paused()
    }

    /// Does it already come to rest, or rest?
    fn rests_by(&self, at_cycle: u64) -> bool {
        self.is_kept_at_rest() || at_cycle >= self.last_cycle()
    }

    fn time_of(&self, cycle: u64) -> f64 {
        self.plan().time_of(cycle.saturating_sub(self.from_cycle))
    }
}

/// How axes go together under operations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Each by itself.
    Each,
    /// On a straight line.
    Line,
    /// On a path that is theirs together.
    Path,
}

impl Kind {
    fn of(plan: &Plan) -> Self {
        let method = plan.method();
        match method.synchronization {
            // Points on the way are a path, for one axis too.
            _ if method.pvt.is_some() => Self::Path,
            _ if plan.axes().len() == 1 => Self::Each,
            Synchronization::None => Self::Each,
            Synchronization::Phase => Self::Line,
            Synchronization::Time => Self::Path,
        }
    }
}

/// An axis with nothing but a goal and limits.
fn aim(axis: &AxisPlan, goal: State, limits: Limits) -> AxisPlan {
    AxisPlan {
        axis: axis.axis.clone(),
        kind: axis.kind,
        limits,
        profile: Profile::new(Vec::new(), goal),
        goal,
        adjustments: Vec::new(),
        classification: crate::Classification::default(),
        pvt_regions: Vec::new(),
    }
}

/// Aims as a plan, which the judge holds against their limits.
fn aimed(plan: &Plan, aims: &[AxisPlan]) -> Result<Accepted, Refused> {
    let under_way = UnderWay { plan, at: f64::INFINITY, aims, errand: Errand::Rest };
    Ok(prove::prove(&under_way, aims.to_vec())?.plan)
}
