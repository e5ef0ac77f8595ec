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
mod passing;
mod path;
mod prove;
mod refused;
mod retarget;

use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::error::{Field, InvalidFields, Why};
use crate::{
    Accepted, AxisPlan, Judged, LAST_CYCLE, Limits, Plan, Profile, Setpoint, State, Synchronization, TimeLaw,
};
pub use append::{AxisPoints, Points};
use errand::{Errand, UnderWay, binds, has_passed};
pub use factor::Override;
use leg::Turning;
pub use prove::Beyond;
use prove::Proved;
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

/// The parts of a motion, as a peer sends them.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionParts {
    /// 0 when it was opened; one more with every operation that changed it.
    pub revision: u64,
    /// The cycle at which the plan's time is zero.
    pub from_cycle: u64,
    /// What is being played.
    pub plan: Accepted,
    /// Of the feed rate.
    pub factor: Override,
    /// What it was doing when it was last changed.
    pub phase: Phase,
    /// What is to be gone on with, where that is not the plan itself: see [`Motion::base`].
    pub base: Option<Accepted>,
    /// How time goes on in the base, from `from_cycle` on, where that is a path that is re-timed: see [`Motion::base_time`].
    pub base_time: Option<TimeLaw>,
    /// The cycle at which the closing stop begins.
    pub closing_from_cycle: Option<u64>,
}

impl Motion {
    /// Begins a motion at cycle 0. A plan that ends at speed gets a closing stop.
    ///
    /// # Errors
    /// [`Why::PositionLimit`] where the closing stop leaves the position range; [`Refused::OffLine`] for a plan that is said to keep
    /// to a straight line and does not.
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

    /// What becomes of the motion when `operation` takes effect at `at_cycle`. Which bits come of it depends on the motion, the cycle and
    /// the operation alone.
    ///
    /// # Errors
    /// See [`Refused`]: each says what would do. Nothing has changed then.
    pub fn splice(&self, at_cycle: u64, operation: &Operation) -> Result<Spliced, Refused> {
        if at_cycle < self.from_cycle {
            return Err(Refused::BeforeMotion { given: at_cycle, first: self.from_cycle });
        }
        let phase = self.phase_at(at_cycle);
        match (phase, operation) {
            (Phase::Stopping | Phase::Finished, Operation::Stop)
            | (Phase::Holding, Operation::Hold)
            | (Phase::Moving | Phase::Standstill, Operation::Resume) => Ok(self.untouched(at_cycle)),
            (Phase::Finished, _) => Err(Refused::StreamFinished),
            (Phase::Stopping, _) => Err(Refused::Stopped { rest_cycle: self.last_cycle() }),
            (Phase::Standstill, Operation::Stop) => {
                Ok(self
                    .noted(at_cycle, Self { phase: Phase::Finished, base: None, law: None, ..self.clone() }))
            }
            (Phase::Moving | Phase::Holding, Operation::Stop) => self.stop(at_cycle),
            (Phase::Moving | Phase::Standstill, Operation::Hold) => {
                self.rest(at_cycle, Phase::Holding, self.factor)
            }
            (Phase::Holding, Operation::Resume) if self.factor.rests() => {
                Ok(self.noted(at_cycle, Self { phase: Phase::Moving, ..self.clone() }))
            }
            (Phase::Holding, Operation::Resume) => self.go_on(at_cycle, self.factor),
            (_, Operation::Override(factor)) => self.override_by(at_cycle, phase, *factor),
            (_, Operation::Append(points)) => self.append(at_cycle, phase, points),
            (_, Operation::Retarget(goals)) => self.retarget(at_cycle, phase, goals),
        }
    }

    fn override_by(&self, at_cycle: u64, phase: Phase, factor: Override) -> Result<Spliced, Refused> {
        let greatest = Override::greatest(self.asked().axes().iter().map(|axis| &axis.limits));
        if factor.get() > greatest {
            return Err(Refused::OverrideOutOfRange { given: factor.get(), greatest });
        }
        if factor == self.factor {
            return Ok(self.untouched(at_cycle));
        }
        match phase {
            Phase::Moving if factor.rests() => self.rest(at_cycle, phase, factor),
            Phase::Moving if self.is_paused() => self.go_on(at_cycle, factor),
            Phase::Moving if self.keeps_a_path() => {
                self.at_rate(at_cycle, factor.get(), Self { factor, ..self.clone() })
            }
            Phase::Moving => {
                let (at, aims) = (self.time_of(at_cycle), self.aims(at_cycle));
                let axes = self.plan().axes().iter().zip(&aims);
                let kept: Vec<bool> = axes
                    .map(|(axis, aim)| {
                        has_passed(axis, at) || !binds(axis, &aim.limits, at, [self.factor, factor])
                    })
                    .collect();
                self.go(at_cycle, &aims, factor, Turning::Never, &kept)
            }
            Phase::Holding | Phase::Standstill | Phase::Stopping | Phase::Finished => {
                Ok(self.noted(at_cycle, Self { phase, factor, ..self.clone() }))
            }
        }
    }

    /// Goes on from rest, or from the way to it, to what is held.
    fn go_on(&self, at_cycle: u64, factor: Override) -> Result<Spliced, Refused> {
        if self.keeps_a_path() {
            let motion = Self { factor, phase: Phase::Moving, ..self.clone() };
            return self.at_rate(at_cycle, factor.get(), motion);
        }
        let aims = self.aims(at_cycle);
        let kept = alloc::vec![false; aims.len()];
        self.go(at_cycle, &aims, factor, Turning::Avoided, &kept)
    }

    /// Goes to `aims`; axes that are `kept` may go on as they do.
    fn go(
        &self,
        at_cycle: u64,
        aims: &[AxisPlan],
        factor: Override,
        turning: Turning,
        kept: &[bool],
    ) -> Result<Spliced, Refused> {
        let under_way = self.under_way(at_cycle, aims, Errand::Goals { factor, turning, kept });
        let motion = Self { factor, phase: Phase::Moving, ..self.clone() };
        let Some(planned) = self.planned(&under_way)? else { return Ok(self.noted(at_cycle, motion)) };
        let Proved { plan, beyond } = planned.proved;
        let base = match Kind::of(self.plan()) {
            Kind::Line if !under_way.is_at_rest() => Some(self.line_to(&under_way)?),
            Kind::Each | Kind::Line | Kind::Path if beyond.is_empty() => None,
            Kind::Each | Kind::Line | Kind::Path => Some(Arc::new(aimed(self.plan(), aims)?)),
        };
        self.spliced(at_cycle, Self { base, ..motion }, plan, planned.closes, beyond)
    }

    /// Comes to rest with something to go on with.
    fn rest(&self, at_cycle: u64, phase: Phase, factor: Override) -> Result<Spliced, Refused> {
        if self.keeps_a_path() {
            return self.at_rate(at_cycle, 0.0, Self { factor, phase, ..self.clone() });
        }
        let aims = self.aims(at_cycle);
        let base = match &self.base {
            _ if self.has_passed_any(at_cycle) => Arc::new(aimed(self.plan(), &aims)?),
            Some(base) => Arc::clone(base),
            None => Arc::clone(&self.plan),
        };
        let motion = Self { factor, phase, base: Some(base), ..self.clone() };
        if self.rests_by(at_cycle) {
            return Ok(self.noted(at_cycle, motion));
        }
        self.to_rest(at_cycle, &aims, motion)
    }

    fn stop(&self, at_cycle: u64) -> Result<Spliced, Refused> {
        let motion = Self { phase: Phase::Stopping, base: None, law: None, ..self.clone() };
        if self.rests_by(at_cycle) {
            return Ok(self.noted(at_cycle, motion));
        }
        let aims = self.aims(at_cycle);
        match Kind::of(self.plan()) {
            Kind::Each | Kind::Line => self.to_rest(at_cycle, &aims, motion),
            Kind::Path => {
                let under_way = self.under_way(at_cycle, &aims, Errand::Rest);
                let Some(planned) = each::planned(&under_way)? else {
                    return Ok(self.noted(at_cycle, motion));
                };
                let Proved { plan, beyond } = planned.proved;
                let spliced = self.spliced(at_cycle, motion, plan, None, beyond)?;
                Ok(Spliced { on_path: false, ..spliced })
            }
        }
    }

    fn to_rest(&self, at_cycle: u64, aims: &[AxisPlan], motion: Self) -> Result<Spliced, Refused> {
        let under_way = self.under_way(at_cycle, aims, Errand::Rest);
        let Some(planned) = self.planned(&under_way)? else { return Ok(self.noted(at_cycle, motion)) };
        let Proved { plan, beyond } = planned.proved;
        self.spliced(at_cycle, motion, plan, None, beyond)
    }

    /// The one place where the kinds of motion part.
    fn planned(&self, under_way: &UnderWay<'_>) -> Result<Option<each::Planned>, Refused> {
        match Kind::of(under_way.plan) {
            Kind::Each => each::planned(under_way),
            Kind::Line => line::planned(under_way, self.asked()),
            Kind::Path => Err(Refused::not_implemented(
                "new goals for axes that arrive together, or go through points",
                "stop and open a stream with a new plan, or plan with SYNCHRONIZATION_NONE or SYNCHRONIZATION_PHASE",
            )),
        }
    }

    /// A plan along the line that the axes keep, to the goals of `under_way`.
    fn line_to(&self, under_way: &UnderWay<'_>) -> Result<Arc<Accepted>, Refused> {
        let known = self.base.as_ref().unwrap_or(&self.plan);
        let mut axes = known.plan().axes().iter().zip(under_way.aims);
        let same = axes.all(|(axis, aim)| axis.goal == aim.goal && axis.limits == aim.limits);
        let drawn = known.plan().axes().iter().any(|axis| !axis.profile.segments().is_empty());
        if same && drawn {
            return Ok(Arc::clone(known));
        }
        line::drawn_to(under_way, known.plan()).map(Arc::new)
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
            let passed = !self.is_kept_at_rest() && has_passed(now, at);
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

    /// Nothing has changed.
    fn untouched(&self, at_cycle: u64) -> Spliced {
        Spliced {
            motion: self.clone(),
            effective_cycle: at_cycle,
            rest_cycle: self.last_cycle(),
            on_path: true,
            changes: false,
            beyond: Vec::new(),
        }
    }

    /// The motion has changed, and no setpoint has.
    fn noted(&self, at_cycle: u64, motion: Self) -> Spliced {
        Spliced { motion: Self { revision: self.revision + 1, ..motion }, ..self.untouched(at_cycle) }
    }

    /// `plan` from `at_cycle` on; its last goal that is passed at speed is after `closes` seconds.
    fn spliced(
        &self,
        at_cycle: u64,
        motion: Self,
        plan: Accepted,
        closes: Option<f64>,
        beyond: Vec<Beyond>,
    ) -> Result<Spliced, Refused> {
        let seconds = plan.plan().duration();
        let cycle_time = plan.plan().cycle_time();
        let rest_cycle = at_cycle.saturating_add(plan.plan().cycle_count());
        if rest_cycle > LAST_CYCLE {
            return Err(InvalidFields::one(Field::default(), Why::TooManyCycles { seconds }).into());
        }
        let closing_from_cycle =
            closes.and_then(|seconds| cycle_time.count(seconds)).map(|count| at_cycle + count);
        let changes = at_cycle < self.last_cycle() || plan.plan().cycle_count() > 0;
        let motion = Self {
            revision: self.revision + 1,
            from_cycle: at_cycle,
            plan: Arc::new(plan),
            closing_from_cycle,
            ..motion
        };
        Ok(Spliced { motion, effective_cycle: at_cycle, rest_cycle, on_path: true, changes, beyond })
    }
}

impl TryFrom<MotionParts> for Motion {
    type Error = InvalidMotion;

    fn try_from(parts: MotionParts) -> Result<Self, InvalidMotion> {
        let MotionParts { revision, from_cycle, plan, factor, phase, base, base_time, closing_from_cycle } =
            parts;
        let at_speed = plan.plan().axes().iter().find(|axis| !axis.profile.end().is_at_rest());
        if let Some(axis) = at_speed {
            let velocity = axis.profile.end().velocity;
            return Err(InvalidMotion::EndsAtSpeed { axis: axis.axis.clone(), velocity });
        }
        let cycle_count = plan.plan().cycle_count();
        let last = from_cycle.checked_add(cycle_count).filter(|&last| last <= LAST_CYCLE);
        let last = last.ok_or(InvalidMotion::TooManyCycles { from_cycle, cycle_count })?;
        if phase == Phase::Holding && base.is_none() {
            return Err(InvalidMotion::BaseMissing);
        }
        if base.as_ref().is_some_and(|base| !same_axes(base.plan(), plan.plan())) {
            return Err(InvalidMotion::BaseDiffers);
        }
        if let Some(law) = &base_time {
            let base = base.as_ref().ok_or(InvalidMotion::BaseTimeAlone)?;
            if !path::follows(plan.plan(), base.plan(), law) {
                return Err(InvalidMotion::OffBase);
            }
        }
        if let Some(given) = closing_from_cycle.filter(|given| !(from_cycle..=last).contains(given)) {
            return Err(InvalidMotion::ClosingOutside { given, first: from_cycle, last });
        }
        let (plan, base, law) = (Arc::new(plan), base.map(Arc::new), base_time.map(Arc::new));
        Ok(Self { revision, from_cycle, plan, factor, phase, base, law, closing_from_cycle })
    }
}

fn same_axes(one: &Plan, other: &Plan) -> bool {
    let names =
        |plan: &Plan| plan.axes().iter().map(|axis| (axis.axis.clone(), axis.kind)).collect::<Vec<_>>();
    one.cycle_time() == other.cycle_time() && names(one) == names(other)
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
