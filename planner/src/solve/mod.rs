//! From a problem to a motion. Reads like the outline of the papers: which lane is it, is it too short, solve it, lay the
//! pieces end to end.

mod lane;
mod nearest;
mod on_cycles;
mod pieces;
mod planned;
pub(crate) mod ramp;
mod rest;
mod s_curve;
mod trapezoid;

pub(crate) use on_cycles::note_speeds;
pub use on_cycles::plan_move_on_cycles;
pub(crate) use planned::Piece;
pub use planned::{Adjustment, AdjustmentReason, MAX_PIECES, Move};

use arrayvec::ArrayVec;

use crate::classify::{AsymmetricType, Classification, EightType, SixCase};
use crate::error::{Field, InvalidFields, Why};
use crate::{Limits, Problem, Quantity, ShortPathPolicy, State, transfer};
use lane::Lane;
use ramp::Ramp;
use s_curve::Shape;
use trapezoid::Trapezoid;

/// The time-optimal jerk-limited move of one axis in the direction of travel.
///
/// Of two speeds `d` apart, with `A` the limit of acceleration where the speed grows and of deceleration where it shrinks, the ramp
/// between them takes `T(d)` \[s\] and covers `D` \[axis units\]:
///
/// ```text
/// v │    peak                 T(d) = d/A + A/J      d ≥ A²/J: full acceleration is reached
///   │   ╭────╮                     = 2·√(d/J)       else
///   │  ╱      ╲ end           D(v₀, v₁) = (v₀ + v₁)/2 · T(|v₁ − v₀|)
///   │_╱ start  ╲__
///   └────────────── t         cruises where s > D(start, V) + D(V, end); else the peak is the root of
///                             D(start, peak) + D(peak, end) = s
/// ```
///
/// Optimal among all motions within the limits that keep the end conditions and do not turn back, but for one corner:
/// where one end is nearly at rest (below 0.16 of the other, or (√2 − 1)²·a²/j, equal limits), stopping on the way needs
/// up to 1.3 % less length than the direct ramp; those far slower motions are not sought (`notes/0003-eight-types.md`).
///
/// ```
/// # use planner::{plan_move, Limits, Problem, ShortPathPolicy, State};
/// let limits = Limits::symmetric(0.25, 3.0, 100.0)?;
/// let problem = Problem::new(State::at_rest(0.0), State::at_rest(0.05), limits, ShortPathPolicy::Reject)?;
/// assert!((plan_move(&problem)?.duration() - 0.94 / 3.0).abs() < 1e-15); // s/v + v/a + a/j
/// # Ok::<(), planner::InvalidFields>(())
/// ```
///
/// Source: Bui, Le and Doan (2021) for the eight types, Li and Chen for a deceleration of its own, Blejan and Blejan (2020) for the six
/// cases from rest to rest; restored and collapsed in `notes/0003-eight-types.md` and `notes/0005-asymmetric.md`.
///
/// # Errors
/// [`Why::PathTooShort`] under [`ShortPathPolicy::Reject`]; [`Why::NotImplemented`] for [`ShortPathPolicy::Reverse`]
/// where the path is too short.
pub fn plan_move(problem: &Problem) -> Result<Move, InvalidFields> {
    if problem.start().is_at_rest() && problem.goal().is_at_rest() {
        return Ok(rest::plan(problem));
    }
    plan_with_speeds(problem)
}

/// The general way: also right from rest to rest, and slower there.
fn plan_with_speeds(problem: &Problem) -> Result<Move, InvalidFields> {
    let direction = problem.direction();
    let lane = Lane::of(problem, direction);
    let (shape, reason) =
        shape(&lane, problem.short_path()).map_err(|refusal| refusal.of(&lane, direction))?;
    let (reached, adjustments) = adjusted(problem, direction, shape.end, reason);
    let mut planned = Move::of_rectangles(reached, adjustments);
    pieces::lay(&mut planned.pieces, &shape, problem.start(), reached, direction, [lane.jerk; 2]);
    planned.classification = if planned.pieces.is_empty() {
        Classification::of_speed(lane.start)
    } else {
        classify(&lane, &shape)
    };
    Ok(planned)
}

/// Would the move have to turn back, where nothing else is to be given up?
pub(crate) fn has_to_turn_back(problem: &Problem) -> bool {
    problem.short_path() == ShortPathPolicy::Reverse && Lane::of(problem, problem.direction()).is_too_short()
}

/// The time-optimal move of constant acceleration in pieces, in the direction of travel: the jerk is not limited, and the
/// limit on it is not read.
///
/// The acceleration jumps where pieces meet, at the start and at the end, so the first piece begins with an acceleration
/// though the problem's start has none.
///
/// ```text
/// v │   ╭──────╮        from rest to rest   T = s/V + V/A      s ≥ V²/A: the velocity limit is reached
///   │  ╱        ╲                             = 2·√(s/A)       else
///   └─╱──────────╲── t
/// ```
///
/// Source: Biagiotti and Melchiorri, *Trajectory Planning for Automatic Machines and Robots* (2008), section 3.2.
///
/// ```
/// # use planner::{plan_trapezoid, Limits, Problem, ShortPathPolicy, State};
/// let limits = Limits::symmetric(0.25, 3.0, 100.0)?;
/// let problem = Problem::new(State::at_rest(0.0), State::at_rest(0.05), limits, ShortPathPolicy::Reject)?;
/// assert!((plan_trapezoid(&problem)?.duration() - 0.85 / 3.0).abs() < 1e-15); // s/v + v/a
/// # Ok::<(), planner::InvalidFields>(())
/// ```
///
/// # Errors
/// Those of [`plan_move`].
pub fn plan_trapezoid(problem: &Problem) -> Result<Move, InvalidFields> {
    let direction = problem.direction();
    let lane = Lane::of(problem, direction);
    let (shape, reason) =
        trapezoid(&lane, problem.short_path()).map_err(|refusal| refusal.of(&lane, direction))?;
    let (reached, adjustments) = adjusted(problem, direction, shape.end, reason);
    let mut planned = Move::of_rectangles(reached, adjustments);
    pieces::lay_trapezoid(&mut planned.pieces, &shape, problem.start(), reached, direction, &lane);
    let still = planned.pieces.is_empty();
    planned.classification = Classification::of_speed(if still { lane.start } else { shape.peak });
    Ok(planned)
}

/// What is said of a feed rate above the velocity limit, which holds.
pub(crate) fn feed_rate_above_limit(limits: &Limits, direction: f64) -> Option<Adjustment> {
    let planned = limits.velocity_towards(direction);
    let asked = limits.spec().feed_rate.filter(|&feed_rate| feed_rate > planned)?;
    let reason = AdjustmentReason::FeedRateAboveLimit;
    Some(Adjustment { quantity: Quantity::Velocity, asked, planned, reason })
}

/// The fastest stop, within `limits`: from a constant speed one ramp; from any other state at most five pieces, the first of which lead an
/// acceleration or a velocity beyond the limits back.
///
/// # Errors
/// [`Why::PositionLimit`] where it leaves the position range; a number of `from` that is not finite.
pub fn plan_stop(from: State, limits: &Limits) -> Result<Move, InvalidFields> {
    if from.acceleration != 0.0 {
        return stop_from_any_state(from, limits);
    }
    let direction = if from.velocity < 0.0 { -1.0 } else { 1.0 };
    let speed = from.velocity.abs();
    let (deceleration, jerk) = (limits.deceleration(), limits.jerk());
    let down = Ramp::over(speed, deceleration, jerk);
    let length = ramp::length(speed, 0.0, deceleration, jerk);
    let reached = State::at_rest(from.position + direction * length);
    within_range(reached.position, down.time(), limits)?;
    let mut stop = Move::of_rectangles(reached, ArrayVec::new());
    stop.classification = Classification::of_speed(speed);
    let shape = Shape::one_ramp(EightType::Type8C, Ramp::default(), down, speed, 0.0);
    pieces::lay(&mut stop.pieces, &shape, from, reached, direction, [jerk; 2]);
    Ok(stop)
}

fn stop_from_any_state(from: State, limits: &Limits) -> Result<Move, InvalidFields> {
    let transit = transfer::stop(from, limits)?;
    let mut stop = Move::of_rectangles(transit.end(), ArrayVec::new());
    stop.classification = Classification::of_speed(from.velocity.abs());
    stop.pieces.extend(transit.pieces().iter().copied());
    Ok(stop)
}

/// Where a move ends, and what is not as asked.
fn adjusted(
    problem: &Problem,
    direction: f64,
    end: f64,
    reason: Option<AdjustmentReason>,
) -> (State, ArrayVec<Adjustment, 2>) {
    let mut adjustments = ArrayVec::new();
    adjustments.extend(feed_rate_above_limit(problem.limits(), direction));
    let mut reached = problem.goal();
    if let Some(reason) = reason {
        reached.velocity = signed(direction, end);
        let (asked, planned) = (problem.goal().velocity, reached.velocity);
        adjustments.push(Adjustment { quantity: Quantity::Velocity, asked, planned, reason });
    }
    (reached, adjustments)
}

/// What the papers call a shape.
fn classify(lane: &Lane, shape: &Shape) -> Classification {
    let symmetric = lane.is_symmetric();
    let mut names = Classification::of_speed(shape.peak);
    names.eight_type = symmetric.then_some(shape.kind);
    if lane.is_from_rest_to_rest() {
        let Lane { length, cruise, acceleration, deceleration, jerk, .. } = *lane;
        // Strictly: at the limit for an instant is not constant.
        let holds = |limit: f64| shape.peak * jerk > limit * limit;
        let (up, down) = (holds(acceleration), holds(deceleration));
        names.asymmetric_type = Some(AsymmetricType::of(shape.cruise > 0.0, up, down));
        if symmetric {
            let limits = [cruise, acceleration, jerk];
            names.six_case = Some(SixCase::of_move(shape.reaches_cruise, length, limits));
        }
    }
    names
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
    TooShort {
        /// The least length that would do [axis units].
        needed: f64,
        /// The end speed that could be reached instead [axis units/s].
        nearest: f64,
    },
    NeedsReversal,
}

impl Refusal {
    fn of(&self, lane: &Lane, direction: f64) -> InvalidFields {
        let why = match *self {
            Self::TooShort { needed, nearest } => Why::PathTooShort {
                needed: direction * needed,
                given: signed(direction, lane.length),
                nearest_velocity: signed(direction, nearest),
            },
            Self::NeedsReversal => Why::NotImplemented {
                what: "short_path_policy REVERSE on a path that is too short",
                instead: "choose REJECT, NEAREST_VELOCITY or MATCH_START_VELOCITY",
            },
        };
        InvalidFields::one(Field::named("goal.velocity"), why)
    }
}

/// A solved lane, and why its end speed is not the one asked for, if it is not.
type Solved<T> = Result<(T, Option<AdjustmentReason>), Refusal>;

/// The S-curve of a lane.
fn shape(lane: &Lane, policy: ShortPathPolicy) -> Solved<Shape> {
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
        ShortPathPolicy::Reject | ShortPathPolicy::MatchStartVelocity => Err(Refusal::TooShort {
            needed: lane.least_length(),
            nearest: nearest::acceptable_end(lane, nearest::solve(lane).end, Lane::is_too_short),
        }),
    }
}

/// The trapezoid of a lane. It has no corner: under [`ShortPathPolicy::MatchStartVelocity`] the end speed becomes the
/// start speed.
fn trapezoid(lane: &Lane, policy: ShortPathPolicy) -> Solved<Trapezoid> {
    let needed = Trapezoid::least_length(lane);
    if !lane.is_shorter_than(needed) {
        return Ok((Trapezoid::solve(lane), None));
    }
    match policy {
        ShortPathPolicy::NearestVelocity => {
            Ok((Trapezoid::nearest(lane), Some(AdjustmentReason::PathTooShortNearestVelocity)))
        }
        ShortPathPolicy::MatchStartVelocity => {
            let level = Lane { end: lane.start, ..*lane };
            Ok((Trapezoid::solve(&level), Some(AdjustmentReason::PathTooShortStartVelocity)))
        }
        ShortPathPolicy::Reverse => Err(Refusal::NeedsReversal),
        ShortPathPolicy::Reject => {
            let too_short = |lane: &Lane| lane.is_shorter_than(Trapezoid::least_length(lane));
            let nearest = nearest::acceptable_end(lane, Trapezoid::nearest(lane).end, too_short);
            Err(Refusal::TooShort { needed, nearest })
        }
    }
}

/// The modification of the end velocity in Bui, Le and Doan (2021), with its contradictions resolved: where the speeds
/// differ by more than a²/j and the type is not 1 to 5, the end speed first moves to a²/j from the start speed, once; if
/// the path is still too short it becomes the start speed, and the cruise speed goes on to hold. `a` is the limit of the
/// ramp from one speed to the other.
fn as_the_paper_does(lane: &Lane) -> (Shape, Option<AdjustmentReason>) {
    let reason = Some(AdjustmentReason::PathTooShortStartVelocity);
    let mut lane = *lane;
    let mut adjusted = None;
    let limit = lane.limit(lane.start, lane.end);
    let corner = limit * limit / lane.jerk;
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
