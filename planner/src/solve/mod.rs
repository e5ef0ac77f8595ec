//! From a problem to a motion. Reads like the outline of the papers: which lane is it, is it too short, solve it, lay the
//! pieces end to end.

mod nearest;
mod pieces;
mod ramp;
mod s_curve;

use arrayvec::ArrayVec;

use crate::classify::{Classification, EightType};
use crate::error::{Field, InvalidFields, Why};
use crate::{Limits, Problem, Profile, Quantity, Segment, Setpoint, ShortPathPolicy, State};
use ramp::Ramp;
use s_curve::{Lane, Shape};

/// The most pieces of a planned move: three to speed up, one to cruise, three to slow down.
pub const MAX_PIECES: usize = 7;

/// The answer to a [`Problem`]: pieces on the stack, and everything that is not as it was asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    segments: ArrayVec<Segment, MAX_PIECES>,
    reached: State,
    adjustments: ArrayVec<Adjustment, 2>,
    classification: Classification,
}

/// One condition that the plan does not meet as asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adjustment {
    /// What was changed.
    pub quantity: Quantity,
    /// The value that was asked for, in the unit of the quantity.
    pub asked: f64,
    /// The value in the plan.
    pub planned: f64,
    /// Why.
    pub reason: AdjustmentReason,
}

/// Why an [`Adjustment`] was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AdjustmentReason {
    /// The path is too short for the end velocity; by policy it became the start velocity, or ± a²/j from it.
    PathTooShortStartVelocity,
    /// The path is too short for the end velocity; by policy it became the nearest reachable one.
    PathTooShortNearestVelocity,
    /// The feed rate is above the velocity limit, which holds.
    FeedRateAboveLimit,
    /// The plan ends at speed, and a stop was put after it.
    ClosingStop,
}

impl AdjustmentReason {
    /// Every reason.
    pub const ALL: [Self; 4] = [
        Self::PathTooShortStartVelocity,
        Self::PathTooShortNearestVelocity,
        Self::FeedRateAboveLimit,
        Self::ClosingStop,
    ];

    /// The name on the wire.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::PathTooShortStartVelocity => "PATH_TOO_SHORT_START_VELOCITY",
            Self::PathTooShortNearestVelocity => "PATH_TOO_SHORT_NEAREST_VELOCITY",
            Self::FeedRateAboveLimit => "FEED_RATE_ABOVE_LIMIT",
            Self::ClosingStop => "CLOSING_STOP",
        }
    }
}

impl Move {
    /// A motion of no pieces, to which another family adds its own.
    pub(crate) fn nothing(reached: State, adjustment: Option<Adjustment>) -> Self {
        let mut adjustments = ArrayVec::new();
        adjustments.extend(adjustment);
        let classification = Classification::default();
        Self { segments: ArrayVec::new(), reached, adjustments, classification }
    }

    /// The pieces, to be laid.
    pub(crate) fn pieces(&mut self) -> &mut ArrayVec<Segment, MAX_PIECES> {
        &mut self.segments
    }

    /// Names the shape.
    pub(crate) fn classify(&mut self, classification: Classification) {
        self.classification = classification;
    }

    /// The pieces, in order; none where nothing moves.
    #[must_use]
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// How long the motion lasts \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        // Not `sum`, which is −0 where there is nothing to add.
        self.segments.iter().fold(0.0, |total, segment| total + segment.duration)
    }

    /// The state at the end: the goal, but for what the adjustments say.
    #[must_use]
    pub fn reached(&self) -> State {
        self.reached
    }

    /// What is not as asked; empty where everything is.
    #[must_use]
    pub fn adjustments(&self) -> &[Adjustment] {
        &self.adjustments
    }

    /// The shape's names in the papers.
    #[must_use]
    pub fn classification(&self) -> Classification {
        self.classification
    }

    /// The setpoint at time `t` \[s\], with the bits of [`Profile::at`] and without its allocation.
    #[must_use]
    pub fn at(&self, t: f64) -> Setpoint {
        let mut begin = 0.0;
        for segment in &self.segments {
            let next = begin + segment.duration;
            if t < next {
                return if t < 0.0 { Setpoint::held(segment.start) } else { segment.at(t - begin) };
            }
            begin = next;
        }
        Setpoint::held(self.reached)
    }

    /// The motion as a profile of its own.
    #[must_use]
    pub fn to_profile(&self) -> Profile {
        Profile::new(self.segments.to_vec(), self.reached)
    }
}

/// The time-optimal jerk-limited move of one axis in the direction of travel.
///
/// Optimal among all motions within the limits that keep the end conditions and do not turn back, but for one corner:
/// where one end is nearly at rest (below 0.16 of the other, or (√2 − 1)²·a²/j), stopping on the way needs up to 1.3 %
/// less length than the direct ramp; those far slower motions are not sought (`notes/0003-eight-types.md`).
///
/// ```
/// # use planner::{plan_move, Limits, Problem, ShortPathPolicy, State};
/// let limits = Limits::symmetric(0.25, 3.0, 100.0)?;
/// let problem = Problem::new(State::at_rest(0.0), State::at_rest(0.05), limits, ShortPathPolicy::Reject)?;
/// assert!((plan_move(&problem)?.duration() - 0.94 / 3.0).abs() < 1e-15); // s/v + v/a + a/j
/// # Ok::<(), planner::InvalidFields>(())
/// ```
///
/// # Errors
/// [`Why::PathTooShort`] under [`ShortPathPolicy::Reject`]; [`Why::NotImplemented`] for [`ShortPathPolicy::Reverse`]
/// where the path is too short.
pub fn plan_move(problem: &Problem) -> Result<Move, InvalidFields> {
    let direction = problem.direction();
    let limits = problem.limits();
    let lane = Lane {
        start: problem.start().velocity.abs(),
        end: problem.goal().velocity.abs(),
        length: problem.distance().abs(),
        cruise: limits.cruise_towards(direction),
        acceleration: limits.acceleration(),
        jerk: limits.jerk(),
    };
    let mut adjustments = ArrayVec::new();
    adjustments.extend(feed_rate_above_limit(limits, direction));
    let (shape, reason) =
        shape(&lane, problem.short_path()).map_err(|refusal| refusal.of(&lane, direction))?;
    let mut reached = problem.goal();
    if let Some(reason) = reason {
        reached.velocity = signed(direction, shape.end);
        let (asked, planned) = (problem.goal().velocity, reached.velocity);
        adjustments.push(Adjustment { quantity: Quantity::Velocity, asked, planned, reason });
    }
    let classification = Classification { eight_type: Some(shape.kind), feed_rate: shape.peak };
    let mut planned = Move { segments: ArrayVec::new(), reached, adjustments, classification };
    pieces::lay(&mut planned.segments, &shape, problem.start(), reached, direction, lane.jerk);
    if planned.segments.is_empty() {
        planned.classification = Classification { eight_type: None, feed_rate: lane.start };
    }
    Ok(planned)
}

/// What is said of a feed rate above the velocity limit, which holds.
pub(crate) fn feed_rate_above_limit(limits: &Limits, direction: f64) -> Option<Adjustment> {
    let planned = limits.velocity_towards(direction);
    let asked = limits.spec().feed_rate.filter(|&feed_rate| feed_rate > planned)?;
    let reason = AdjustmentReason::FeedRateAboveLimit;
    Some(Adjustment { quantity: Quantity::Velocity, asked, planned, reason })
}

/// The fastest stop from a constant speed, within `limits`.
///
/// # Errors
/// [`Why::PositionLimit`] where it leaves the position range; [`Why::NotImplemented`] from an acceleration.
pub fn plan_stop(from: State, limits: &Limits) -> Result<Move, InvalidFields> {
    if from.acceleration != 0.0 {
        let what = "a stop while accelerating";
        let instead = "stop from a constant speed";
        return Err(InvalidFields::one(Field::default(), Why::NotImplemented { what, instead }));
    }
    let direction = if from.velocity < 0.0 { -1.0 } else { 1.0 };
    let speed = from.velocity.abs();
    let (deceleration, jerk) = (limits.deceleration(), limits.jerk());
    let down = Ramp::over(speed, deceleration, jerk);
    let length = ramp::length(speed, 0.0, deceleration, jerk);
    let reached = State::at_rest(from.position + direction * length);
    within_range(reached.position, down.time(), limits)?;
    let kind = EightType::of(false, false, ramp::reaches(speed, deceleration, jerk));
    let shape = Shape { up: Ramp::default(), cruise: 0.0, down, peak: speed, end: 0.0, kind };
    let classification = Classification { eight_type: None, feed_rate: speed };
    let mut stop = Move { segments: ArrayVec::new(), reached, adjustments: ArrayVec::new(), classification };
    pieces::lay(&mut stop.segments, &shape, from, reached, direction, jerk);
    Ok(stop)
}

/// Is `reached` inside the position range?
fn within_range(reached: f64, time: f64, limits: &Limits) -> Result<(), InvalidFields> {
    let refuse = |allowed, limit| {
        let why = Why::PositionLimit { reached, time, allowed, limit };
        Err(InvalidFields::one(Field::default(), why))
    };
    if reached > limits.max_position() {
        refuse(limits.max_position(), "limits.max_position")
    } else if reached < limits.min_position() {
        refuse(limits.min_position(), "limits.min_position")
    } else {
        Ok(())
    }
}

/// Why there is no shape.
enum Refusal {
    TooShort,
    NeedsReversal,
}

impl Refusal {
    fn of(&self, lane: &Lane, direction: f64) -> InvalidFields {
        let why = match self {
            Self::TooShort => Why::PathTooShort {
                needed: direction * lane.least_length(),
                given: signed(direction, lane.length),
                nearest_velocity: signed(direction, nearest::solve(lane).end),
            },
            Self::NeedsReversal => Why::NotImplemented {
                what: "short_path_policy REVERSE on a path that is too short",
                instead: "choose REJECT, NEAREST_VELOCITY or MATCH_START_VELOCITY",
            },
        };
        InvalidFields::one(Field::named("goal.velocity"), why)
    }
}

/// The shape of a lane, and why its end speed is not the one asked for, if it is not.
fn shape(lane: &Lane, policy: ShortPathPolicy) -> Result<(Shape, Option<AdjustmentReason>), Refusal> {
    if policy == ShortPathPolicy::MatchStartVelocity {
        return Ok(as_the_paper_does(lane));
    }
    if !lane.is_too_short() {
        return Ok((lane.solve(), None));
    }
    match policy {
        ShortPathPolicy::NearestVelocity => {
            Ok((nearest::solve(lane), Some(AdjustmentReason::PathTooShortNearestVelocity)))
        }
        ShortPathPolicy::Reverse => Err(Refusal::NeedsReversal),
        ShortPathPolicy::Reject | ShortPathPolicy::MatchStartVelocity => Err(Refusal::TooShort),
    }
}

/// The modification of the end velocity in Bui, Le and Doan (2021), with its contradictions resolved: where the speeds
/// differ by more than a²/j and the type is not 1 to 5, the end speed first moves to a²/j from the start speed, once; if
/// the path is still too short it becomes the start speed, and the cruise speed goes on to hold.
fn as_the_paper_does(lane: &Lane) -> (Shape, Option<AdjustmentReason>) {
    let reason = Some(AdjustmentReason::PathTooShortStartVelocity);
    let mut lane = *lane;
    let mut adjusted = None;
    let corner = lane.acceleration * lane.acceleration / lane.jerk;
    if (lane.start - lane.end).abs() > corner {
        let kept = (!lane.is_too_short()).then(|| lane.solve());
        if let Some(shape) = kept.filter(|shape| !matches!(shape.kind, EightType::Type6 | EightType::Type7)) {
            return (shape, None);
        }
        lane.end = if lane.end > lane.start { lane.start + corner } else { lane.start - corner };
        adjusted = reason;
    }
    if lane.is_too_short() {
        lane.end = lane.start;
        return (Shape { kind: EightType::Type8B, ..lane.solve() }, reason);
    }
    (lane.solve(), adjusted)
}

/// `magnitude` in the direction of travel, without a negative zero.
fn signed(direction: f64, magnitude: f64) -> f64 {
    direction * magnitude + 0.0
}
