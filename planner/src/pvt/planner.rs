use alloc::boxed::Box;

use arrayvec::ArrayVec;

use super::command::{Command, Reach};
use super::lane::Lanes;
use super::{PvtInterpolation, PvtPolicy, PvtRegion, pieces, polynomial};
use crate::classify::Classification;
use crate::error::{Field, InvalidFields, Why};
use crate::float::largest;
use crate::limits::{is_number, not_finite};
use crate::problem::within_limits;
use crate::{Adjustment, AdjustmentReason, Limits, Move, Quantity, Segment, Setpoint, State};

/// What the next command asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PvtTarget {
    /// Where the axis is to be [axis units], absolute.
    pub position: f64,
    /// How fast it is to be there [axis units/s], signed.
    pub velocity: f64,
    /// How long from where the command before it ended \[s\], > 0.
    pub duration: f64,
}

impl PvtTarget {
    /// The one piece by which a polynomial leads from `start` to the target, as [`plan_pvt`](crate::plan_pvt) has it: for comparison, since it keeps no
    /// limit. None for ramps, which are several.
    ///
    /// ```
    /// # use planner::{PvtInterpolation, PvtTarget, State};
    /// let target = PvtTarget { position: 1.0, velocity: 0.0, duration: 2.0 };
    /// let cubic = target.joined_from(State::default(), PvtInterpolation::Cubic).expect("one piece");
    /// assert_eq!(cubic.at(1.0).state.velocity, 0.75); // 3S/2T
    /// assert_eq!(target.joined_from(State::default(), PvtInterpolation::SShaped), None);
    /// ```
    #[must_use]
    pub fn joined_from(&self, start: State, interpolation: PvtInterpolation) -> Option<Segment> {
        polynomial::piece(interpolation, start, self)
    }
}

/// The motion of one command: pieces on the stack, what is not as asked, and what could have been asked.
#[derive(Clone, Debug, PartialEq)]
pub struct PvtMove {
    motion: Move,
    region: PvtRegion,
    reachable: (f64, f64),
}

impl PvtMove {
    /// A place for a motion.
    #[inline]
    pub(super) fn unplanned() -> Self {
        let motion = Move::of_rectangles(State::at_rest(0.0), ArrayVec::new());
        Self { motion, region: PvtRegion::R1, reachable: (0.0, 0.0) }
    }

    /// The motion; its adjustments are of position, velocity and time.
    #[must_use]
    pub fn motion(&self) -> &Move {
        &self.motion
    }

    /// As [`Move::at`].
    #[must_use]
    pub fn at(&self, t: f64) -> Setpoint {
        self.motion.at(t)
    }

    /// Where the displacement lies between the extremes.
    #[must_use]
    pub fn region(&self) -> PvtRegion {
        self.region
    }

    /// The least displacement that the limits allow, with the end velocity and in the time as planned [axis units].
    #[must_use]
    pub fn least_displacement(&self) -> f64 {
        self.reachable.0
    }

    /// The greatest displacement that the limits allow, with the end velocity and in the time as planned [axis units].
    #[must_use]
    pub fn greatest_displacement(&self) -> f64 {
        self.reachable.1
    }
}

/// Plans command by command, each from where the last one ended: for commands that arrive at a beat.
///
/// What a command does not reach is made up by the next, since its position is absolute. Taking a command allocates nothing.
///
/// ```
/// use planner::{Limits, PvtPlanner, PvtPolicy, PvtRegion, PvtTarget, State};
///
/// let limits = Limits::symmetric(0.5, 4.0, 80.0)?;
/// let mut axis = PvtPlanner::new(State::at_rest(0.0), limits, PvtPolicy::PreferVelocity)?;
/// // 12 mm in 0.15 s, and then 20 mm at a constant 0.2 m/s.
/// let away = axis.command(PvtTarget { position: 0.012, velocity: 0.2, duration: 0.15 })?;
/// assert_eq!(away.region(), PvtRegion::R3);
/// let on = axis.command(PvtTarget { position: 0.032, velocity: 0.2, duration: 0.1 })?;
/// assert_eq!((on.motion().segments().len(), on.motion().adjustments().len()), (1, 0));
/// // Too far for the time: velocity and time are kept, and what is missing is said.
/// let short = axis.command(PvtTarget { position: 0.5, velocity: 0.2, duration: 0.1 })?;
/// assert!(short.motion().adjustments()[0].planned < 0.07);
/// # Ok::<(), planner::InvalidFields>(())
/// ```
#[derive(Clone, Debug)]
pub struct PvtPlanner {
    state: State,
    axis: Axis,
    policy: PvtPolicy,
}

impl PvtPlanner {
    /// An axis in `start`, without acceleration.
    ///
    /// # Errors
    /// A start that is not finite or outside the limits.
    pub fn new(start: State, limits: Limits, policy: PvtPolicy) -> Result<Self, InvalidFields> {
        let start = start.with_positive_zeros();
        let mut invalid = InvalidFields::default();
        note_start(&mut invalid, &start, &limits);
        invalid.into_result(Self { state: start, axis: Axis::new(limits), policy })
    }

    /// Where the last command ended.
    #[must_use]
    pub fn state(&self) -> State {
        self.state
    }

    /// Plans the motion to `target`; the next command begins where it ends.
    ///
    /// # Errors
    /// A target that is not finite or outside the limits; [`Why::PvtTimeTooShort`] or [`Why::PvtOutOfReach`] for one that
    /// cannot be met and that the policy does not adjust; [`Why::PvtLeavesRange`] where the motion would leave the position
    /// range on its way, at a time that counts from its beginning. The axis then stays where it was: its next command begins there.
    pub fn command(&mut self, target: PvtTarget) -> Result<PvtMove, InvalidFields> {
        let PvtTarget { position, velocity, duration } = target;
        // What fits, as most does, is told without the words for what does not.
        let fits = duration > 0.0 && is_number(duration) && fits(position, velocity, self.axis.limits());
        if !fits {
            return Err(wrong_target(&target, self.axis.limits()));
        }
        let mut planned = PvtMove::unplanned();
        self.axis
            .plan(&mut planned, self.state, &target, self.policy, 0.0)
            .map_err(|(quantity, why)| InvalidFields::one(Field::named(field_of(quantity)), why))?;
        self.state = planned.motion.reached();
        Ok(planned)
    }
}

fn field_of(quantity: Quantity) -> &'static str {
    if quantity == Quantity::Velocity { "velocity" } else { "position" }
}

#[cold]
fn wrong_target(target: &PvtTarget, limits: &Limits) -> InvalidFields {
    let mut invalid = InvalidFields::default();
    for (quantity, why) in wrong_point(target.position, target.velocity, limits) {
        invalid.note(field_of(quantity), Some(why));
    }
    let given = target.duration;
    let not_positive = (given.is_nan() || given <= 0.0).then_some(Why::DurationNotPositive { given });
    invalid.note("duration", not_finite(given).or(not_positive));
    invalid
}

/// Reports what is wrong with the state in which the first command begins.
pub(super) fn note_start(invalid: &mut InvalidFields, start: &State, limits: &Limits) {
    let State { position, velocity, acceleration } = *start;
    let wrong = [("position", position), ("velocity", velocity), ("acceleration", acceleration)];
    if wrong.iter().all(|&(_, value)| not_finite(value).is_none()) {
        within_limits(invalid, "start", start, limits);
        return;
    }
    let mut inner = InvalidFields::default();
    for (name, value) in wrong {
        inner.note(name, not_finite(value));
    }
    invalid.extend_within(&Field::named("start"), inner);
}

/// Has [`wrong_point`] nothing to say?
pub(super) fn fits(position: f64, velocity: f64, limits: &Limits) -> bool {
    is_number(position)
        && position >= limits.min_position()
        && position <= limits.max_position()
        && velocity.abs() <= limits.cruise_towards(velocity)
        && is_number(velocity)
}

/// What is wrong with a position and a velocity to be at.
pub(super) fn wrong_point(
    position: f64,
    velocity: f64,
    limits: &Limits,
) -> impl Iterator<Item = (Quantity, Why)> {
    let out_of_range = || {
        let allowed = position.max(limits.min_position()).min(limits.max_position());
        let limit = if position < allowed { "limits.min_position" } else { "limits.max_position" };
        let outside = (position - allowed).abs() > 0.0;
        outside.then_some(Why::GoalOutsideLimits { given: position, allowed, limit })
    };
    let too_fast = || {
        crate::problem::too_fast(velocity, limits).map(|(allowed, limit)| Why::GoalOutsideLimits {
            given: velocity,
            allowed,
            limit,
        })
    };
    let position = not_finite(position).or_else(out_of_range).map(|why| (Quantity::Position, why));
    let velocity = not_finite(velocity).or_else(too_fast).map(|why| (Quantity::Velocity, why));
    position.into_iter().chain(velocity)
}

/// What is kept of an axis from command to command.
#[derive(Clone, Debug)]
pub(super) struct Axis {
    limits: Limits,
    lanes: Lanes,
}

/// What cannot be met, and why.
pub(super) type Refusal = (Quantity, Why);

impl Axis {
    pub(super) fn new(limits: Limits) -> Self {
        let lanes = Lanes::of(&limits);
        Self { limits, lanes }
    }

    pub(super) fn limits(&self) -> &Limits {
        &self.limits
    }

    pub(super) fn lanes(&self) -> &Lanes {
        &self.lanes
    }

    /// What a target asks from `start` on; `time_rounding` as in [`Command`].
    pub(super) fn command(start: State, target: &PvtTarget, time_rounding: f64) -> Command {
        Command {
            start: start.velocity,
            end: target.velocity + 0.0,
            displacement: target.position - start.position,
            duration: target.duration,
            rounding: POSITION_ROUNDING * (target.position.abs() + start.position.abs()),
            time_rounding,
        }
    }

    /// The first duration from the target's on in which it can be met \[s\].
    pub(super) fn extended(
        &self,
        start: State,
        target: &PvtTarget,
        time_rounding: f64,
    ) -> Result<f64, Refusal> {
        let command = Self::command(start, target, time_rounding);
        if command.nearest(&self.lanes).is_some_and(|reach| reach.short_of(command.displacement) == 0.0) {
            return Ok(target.duration);
        }
        command.extended(&self.lanes).ok_or_else(|| self.refusal(&command, start, target))
    }

    /// The displacements that can be reached; where there is no time for the velocity, with the nearest that there is time for.
    pub(super) fn reachable(
        &self,
        start: State,
        target: &PvtTarget,
        time_rounding: f64,
    ) -> Option<(f64, f64)> {
        let asked = Self::command(start, target, time_rounding);
        let ending_at = |end: f64| Command { end, ..asked }.range(&self.lanes);
        let nearest = || ending_at(asked.nearest_velocity(&self.lanes));
        // A velocity that the time suffices for but for a rounding; to stay at the same one no time is too short.
        asked.range(&self.lanes).or_else(nearest).or_else(|| ending_at(asked.start))
    }

    #[inline]
    /// The motion from `start` to `target`, or as near as `policy` says.
    pub(super) fn plan(
        &self,
        planned: &mut PvtMove,
        start: State,
        target: &PvtTarget,
        policy: PvtPolicy,
        time_rounding: f64,
    ) -> Result<(), Refusal> {
        let asked = Self::command(start, target, time_rounding);
        match asked.nearest(&self.lanes) {
            Some(reach)
                if policy == PvtPolicy::PreferVelocity || reach.short_of(asked.displacement) == 0.0 =>
            {
                self.lay(planned, &asked, &asked, &reach, start, target);
            }
            nearest => self.adjust(planned, &asked, nearest, start, target, policy)?,
        }
        self.within_range(planned, &asked, start, target)
    }

    /// The motion for a command that cannot be met, with time enough for the velocity, in which `nearest` is reached, or without.
    fn adjust(
        &self,
        planned: &mut PvtMove,
        asked: &Command,
        nearest: Option<Reach<'_>>,
        start: State,
        target: &PvtTarget,
        policy: PvtPolicy,
    ) -> Result<(), Refusal> {
        let Self { lanes, .. } = self;
        let command = match policy {
            PvtPolicy::PreferVelocity => Command { end: asked.nearest_velocity(lanes), ..*asked },
            PvtPolicy::PreferPosition => {
                let best = asked.velocity_for_position(lanes, nearest);
                let end = best.as_ref().map_or(asked.start, |(velocity, _)| *velocity);
                let command = Command { end, ..*asked };
                // Of several lanes another may reach it too, and comes first.
                if let Some((_, reach)) = best.filter(|_| lanes.are_one()) {
                    self.lay(planned, asked, &command, &reach, start, target);
                    return Ok(());
                }
                command
            }
            PvtPolicy::ExtendTime => {
                let duration = asked.extended(lanes).ok_or_else(|| self.refusal(asked, start, target))?;
                Command { duration, ..*asked }
            }
            PvtPolicy::Reject => return Err(self.refusal(asked, start, target)),
        };
        if let Some(reach) = command.nearest(lanes) {
            self.lay(planned, asked, &command, &reach, start, target);
            return Ok(());
        }
        // A velocity that the time suffices for but for a rounding; to stay at the same one no time is too short.
        let level = Command { end: asked.start, ..command };
        let reach = level.nearest(lanes).ok_or_else(|| self.refusal(asked, start, target))?;
        self.lay(planned, asked, &level, &reach, start, target);
        Ok(())
    }

    #[inline]
    pub(super) fn lay(
        &self,
        planned: &mut PvtMove,
        asked: &Command,
        command: &Command,
        reach: &Reach<'_>,
        start: State,
        target: &PvtTarget,
    ) {
        let shape = reach.shape(command);
        let position = if shape.arrives { target.position } else { start.position + shape.displacement };
        let reached = State { position, velocity: command.end, acceleration: 0.0 }.with_positive_zeros();
        let motion = &mut planned.motion;
        pieces::lay(motion, &shape, start, reached);
        let speed = largest(command.start.abs(), command.end.abs());
        motion.classify(Classification::of_speed(largest(speed, shape.cruise_velocity.abs())));
        let alone = self.lanes.are_one();
        planned.region = shape.region;
        planned.reachable =
            if alone { reach.range() } else { command.range(&self.lanes).unwrap_or(reach.range()) };
        let mut adjust = |quantity, asked: f64, planned: f64, reason| {
            if (planned - asked).abs() > 0.0 {
                motion.adjust(Adjustment { quantity, asked, planned, reason });
            }
        };
        if !shape.arrives {
            adjust(Quantity::Position, target.position, position, AdjustmentReason::PvtOutOfReach);
        }
        let hurried = || asked.duration < asked.least_time(&self.lanes);
        if (command.end - asked.end).abs() > 0.0 {
            let reason =
                if hurried() { AdjustmentReason::PvtTimeTooShort } else { AdjustmentReason::PvtOutOfReach };
            adjust(Quantity::Velocity, asked.end, command.end, reason);
        }
        adjust(Quantity::Time, asked.duration, command.duration, AdjustmentReason::PvtTimeExtended);
    }

    /// Why a command cannot be met, and what would be taken instead.
    #[cold]
    fn refusal(&self, command: &Command, start: State, target: &PvtTarget) -> Refusal {
        let offers = Box::new(self.offers(command, start, target));
        let PvtTarget { position: given, velocity, duration } = *target;
        let Some((low, high)) = command.range(&self.lanes) else {
            return (Quantity::Velocity, Why::PvtTimeTooShort { given: velocity, duration, offers });
        };
        let (least, greatest) = (start.position + low, start.position + high);
        (Quantity::Position, Why::PvtOutOfReach { given, velocity, duration, least, greatest, offers })
    }

    /// Refuses a motion that leaves the position range on its way.
    fn within_range(
        &self,
        planned: &PvtMove,
        command: &Command,
        start: State,
        target: &PvtTarget,
    ) -> Result<(), Refusal> {
        let (low, high) = (self.limits.min_position(), self.limits.max_position());
        // Farther than this no command goes, and few axes have a range.
        let motion = &planned.motion;
        let way = motion.classification().feed_rate * motion.duration();
        if start.position - way >= low && start.position + way <= high {
            return Ok(());
        }
        let Some((reached, time)) = self.outside(motion, start, command.time_rounding) else { return Ok(()) };
        let (allowed, limit) =
            if reached > high { (high, "limits.max_position") } else { (low, "limits.min_position") };
        let PvtTarget { position: given, velocity, .. } = *target;
        let offers = Box::new(self.offers(command, start, target));
        let why = Why::PvtLeavesRange { given, velocity, reached, time, allowed, limit, offers };
        Err((Quantity::Position, why))
    }

    /// Where a motion from `start` is first seen outside the position range, at a turn or at an end, and when that is \[s\].
    pub(super) fn outside(&self, motion: &Move, start: State, time_rounding: f64) -> Option<(f64, f64)> {
        let slack = POSITION_ROUNDING * (start.position.abs() + motion.reached().position.abs())
            + time_rounding * motion.classification().feed_rate;
        let (low, high) = (self.limits.min_position() - slack, self.limits.max_position() + slack);
        let mut time = 0.0;
        for segment in motion.segments() {
            for t in segment.turning_points() {
                let reached = segment.at(t).state.position;
                if reached > high || reached < low {
                    return Some((reached, time + t));
                }
            }
            time += segment.duration;
        }
        None
    }
}

/// Of a position \[1\]: what a difference of two positions may be off, since each is rounded.
const POSITION_ROUNDING: f64 = 2.0 * f64::EPSILON;
