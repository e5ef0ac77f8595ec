//! The fastest motion between any two states, one axis.
//!
//! ```text
//!  way │                 ╱ farthest in this time (the upper family)      All motions between two given velocities and
//!      │               ╱                                                 accelerations, within limits, that take as long,
//!      │            ╱                                                    go the ways of one interval: a motion between two
//!      │──────── ╱●─────────── the way to go                             of them is one too. So the fastest that goes a way
//!      │     ╱╱                                                          is a member of one of two families of one
//!      │   ●  fastest change of velocity                                 parameter, and is found by one equation, of which
//!      │     ╲╲__                                                        the bracket is known.
//!      │         ╲ nearest in this time (the lower family)
//!      └────────────────────── duration
//! ```
//!
//! `notes/0007-any-state.md` has the derivation.

mod arrivals;
mod axis;
mod blend;
mod bounds;
mod by_rest;
mod course;
mod ends;
mod fastest;
mod lead_in;
mod lens;
mod mapped;
mod span;
mod steady;
mod timed;
mod transit;
mod turning;
mod upper;

pub use arrivals::{Arrivals, Blocked, MAX_BLOCKED};
pub(crate) use axis::Within;
pub use axis::{AxisTransfer, NoSuchDuration};
pub use bounds::{Bounds, BoundsSpec};
pub use course::MAX_TRANSIT_PIECES;
pub use mapped::plan_between;
pub(crate) use mapped::stop;
pub use transit::Transit;

use crate::State;
use crate::error::{Field, InvalidFields, Why};
use crate::float::{largest, least};
use crate::problem::note_not_finite;
use course::Course;
use ends::{Ends, Moving};
use fastest::{Change, fastest};
use lead_in::{Confines, LeadIn};
use timed::Timed;
pub(crate) use timed::is_same_time;

/// Of the velocities that are compared \[1\]: a goal may be beyond a limit by this much, since it was computed.
const GOAL_SLACK: f64 = 16.0 * f64::EPSILON;

/// A question about one axis: from any state to any state within bounds, checked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transfer {
    start: State,
    goal: State,
    bounds: Bounds,
}

impl Transfer {
    /// Asks for the fastest motion from `start` to `goal`.
    ///
    /// The start may be anywhere, beyond the bounds too: it is led back first. The goal is inside them, and so are the velocities
    /// from which its acceleration can be reached.
    ///
    /// # Errors
    /// Every number that is not finite, and of the goal those that are not within `bounds`.
    pub fn new(start: State, goal: State, bounds: Bounds) -> Result<Self, InvalidFields> {
        let (start, goal) = (start.with_positive_zeros(), goal.with_positive_zeros());
        let mut invalid = InvalidFields::default();
        note_not_finite(&mut invalid, &start, &goal);
        if invalid.is_empty() {
            note_goal(&mut invalid, &goal, &bounds, &NAMES);
        }
        invalid.into_result(Self { start, goal, bounds })
    }

    /// Where the motion begins.
    #[must_use]
    pub fn start(&self) -> State {
        self.start
    }

    /// Where it ends.
    #[must_use]
    pub fn goal(&self) -> State {
        self.goal
    }

    /// What the axis may do on the way.
    #[must_use]
    pub fn bounds(&self) -> &Bounds {
        &self.bounds
    }
}

/// What bounds are called where they were given.
struct Names {
    min_velocity: &'static str,
    max_velocity: &'static str,
    min_acceleration: &'static str,
    max_acceleration: &'static str,
}

const NAMES: Names = Names {
    min_velocity: "bounds.min_velocity",
    max_velocity: "bounds.max_velocity",
    min_acceleration: "bounds.min_acceleration",
    max_acceleration: "bounds.max_acceleration",
};

fn note_goal(invalid: &mut InvalidFields, goal: &State, bounds: &Bounds, names: &Names) {
    let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
        *bounds.spec();
    let State { velocity, acceleration, .. } = *goal;
    let refuse = |given, allowed, limit| Some(Why::GoalOutsideLimits { given, allowed, limit });
    let mut inner = InvalidFields::default();
    if velocity > max_velocity {
        inner.note("velocity", refuse(velocity, max_velocity, names.max_velocity));
    } else if velocity < min_velocity {
        inner.note("velocity", refuse(velocity, min_velocity, names.min_velocity));
    }
    if acceleration > max_acceleration {
        inner.note("acceleration", refuse(acceleration, max_acceleration, names.max_acceleration));
    } else if acceleration < min_acceleration {
        inner.note("acceleration", refuse(acceleration, min_acceleration, names.min_acceleration));
    }
    if inner.is_empty() {
        // The velocity from which full jerk alone leads to the goal: whatever comes before, it was passed.
        let square = 0.5 * acceleration * acceleration / max_jerk;
        let slack = GOAL_SLACK * (velocity.abs() + square);
        let nearest = |room: f64| crate::float::sqrt(2.0 * max_jerk * room);
        if acceleration < 0.0 && velocity + square > max_velocity + slack {
            let allowed = -nearest(max_velocity - velocity) + 0.0;
            inner.note("acceleration", refuse(acceleration, allowed, names.max_velocity));
        } else if acceleration > 0.0 && velocity - square < min_velocity - slack {
            let allowed = nearest(velocity - min_velocity);
            inner.note("acceleration", refuse(acceleration, allowed, names.min_velocity));
        }
    }
    // A path is spelt only where there is something to say of it.
    if !inner.is_empty() {
        // A path is spelt only where there is something to say of it.
        if !inner.is_empty() {
            invalid.extend_within(&Field::named("goal"), inner);
        }
    }
}

/// The fastest motion of one axis from any state to any state.
///
/// Fastest among all motions whose velocity, acceleration and jerk stay within the bounds, wherever that takes the axis: it
/// overshoots and turns back where that is faster. A start beyond the bounds, or one whose acceleration leads beyond them whatever
/// is done, is led back as fast as can be without coming out on the other side of the limit: the acceleration first, at full
/// jerk; then the velocity, from above without undershoot. Going on slower than the limit is the fastest motion's own choice.
///
/// ```text
/// v │ start   ╭────────╮ cruise      two fastest changes of velocity, and a cruise between them or a touch:
///   │    ╲   ╱          ╲            where the motion ends is a function of the velocity between them alone,
///   │     ╰─╯            ╲ goal      walked piece by piece, so that no solution is missed
///   └──────────────────────── t
/// ```
///
/// Source: derived in `notes/0007-any-state.md`; held against Berscheid and Kröger, *Jerk-limited real-time trajectory generation with
/// arbitrary target states* (2021).
///
/// ```
/// # use planner::{plan_transfer, Bounds, State, Transfer};
/// let bounds = Bounds::symmetric(5.0, 1.0, 10.0)?;
/// let (start, goal) = (State::at_rest(0.3), State::at_rest(0.32));
/// let transit = plan_transfer(&Transfer::new(start, goal, bounds)?)?;
/// assert!((transit.duration() - 0.4).abs() < 1e-15); // d = 2a³/j²: between two shapes
/// # Ok::<(), planner::InvalidFields>(())
/// ```
///
/// # Errors
/// [`Why::GoalOutsideLimits`] where the goal lies behind and the bounds forbid to go back; [`Why::TooManyCycles`] of a motion that
/// lasts longer than [`LONGEST`](crate::LONGEST); [`Why::PositionLimit`] of one that leaves the numbers; [`Why::NotImplemented`] where
/// numbers do not have the digits to lay it.
pub fn plan_transfer(transfer: &Transfer) -> Result<Transit, InvalidFields> {
    let planned = transit_of(transfer, &NAMES);
    if let Ok(transit) = &planned {
        transit.check_numbers()?;
    }
    planned
}

fn transit_of(transfer: &Transfer, names: &Names) -> Result<Transit, InvalidFields> {
    let mut transit = Transit::unlaid();
    lay_fastest(transfer, names, &mut transit)?;
    Ok(transit)
}

/// As [`transit_of`], into `transit`, which is of no use where nothing is laid.
fn lay_fastest(transfer: &Transfer, names: &Names, transit: &mut Transit) -> Result<(), InvalidFields> {
    let scaled = Scaled::of(transfer);
    let Scaled { confines, way, slack, unit, .. } = scaled;
    let lead = LeadIn::of(scaled.start, confines);
    match fastest(scaled.ends_after(&lead), confines, way - lead.way, slack) {
        Some(shape) => {
            let course = Course::of(&lead, &shape, transfer, unit);
            transit.lay(transfer.start, transfer.goal, &course, None)?;
            check_duration(transit.duration())
        }
        None => Err(behind(transfer, names)),
    }
}

/// The longest motion \[s\]: as many of the longest cycles as can be counted.
pub const LONGEST: f64 = crate::LAST_CYCLE as f64;

/// Can a motion last `duration` \[s\]?
pub(crate) fn check_duration(duration: f64) -> Result<(), InvalidFields> {
    // Also false for NaN: of a time beyond the numbers not even the size is known.
    if duration <= LONGEST {
        return Ok(());
    }
    let seconds = if duration.is_nan() { f64::INFINITY } else { duration };
    Err(InvalidFields::one(Field::default(), Why::TooManyCycles { seconds }))
}

/// Lays the motion that takes `duration` \[s\]; `transit` is of no use where there is none.
fn lay_lasting(transfer: &Transfer, duration: f64, transit: &mut Transit) -> bool {
    let timed = Timed::of(transfer);
    let mut course = Course::default();
    course.lead(&timed.lead, &transfer.bounds, timed.unit);
    timed.go_on(&mut course, transfer, duration)
        && transit.lay(transfer.start, transfer.goal, &course, Some(duration)).is_ok()
}

/// The goal lies behind: what can be reached is where the axis can come to a stop.
#[cold]
fn behind(transfer: &Transfer, names: &Names) -> InvalidFields {
    let Transfer { start, goal, bounds } = *transfer;
    let allowed = plan_velocity(start, 0.0, bounds).map_or(start.position, |stop| stop.end().position);
    let why = Why::GoalOutsideLimits { given: goal.position, allowed, limit: names.min_velocity };
    InvalidFields::one(Field::named("goal.position"), why)
}

/// The fastest way to a velocity without acceleration, wherever it leads: the end of the motion says. A start beyond the bounds is
/// led back as by [`plan_transfer`].
///
/// ```
/// # use planner::{plan_velocity, Bounds, State};
/// let bounds = Bounds::symmetric(5.0, 1.0, 1.0)?;
/// let braking = State { position: 0.0, velocity: 2.0, acceleration: -1.0 };
/// let stop = plan_velocity(braking, 0.0, bounds)?;
/// assert_eq!(stop.duration(), 2.5); // −1 for 1.5 s, and back to zero in 1 s
/// # Ok::<(), planner::InvalidFields>(())
/// ```
///
/// # Errors
/// Every number that is not finite, and a velocity that is not within `bounds`; as [`plan_transfer`] of a motion that lasts too long,
/// or leaves the numbers.
pub fn plan_velocity(start: State, velocity: f64, bounds: Bounds) -> Result<Transit, InvalidFields> {
    let goal = State { velocity, ..State::at_rest(start.position) };
    let mut transfer = Transfer::new(start, goal, bounds)?;
    let scaled = Scaled::of(&transfer);
    let Scaled { confines, unit, .. } = scaled;
    let lead = LeadIn::of(scaled.start, confines);
    let change = Change::of(scaled.ends_after(&lead), confines);
    let length = bounds.spec().max_jerk * unit * unit * unit;
    transfer.goal.position += (lead.way + change.goes) * length;
    let course = Course::of(&lead, &change.shape, &transfer, unit);
    let mut planned = Transit::unlaid();
    planned.lay(start, transfer.goal, &course, None)?;
    check_duration(planned.duration())?;
    planned.check_numbers()?;
    Ok(planned)
}

/// A question in units in which the jerk limit is 1 and the motion about as large.
///
/// Lengths are divided by the jerk limit, once: then all are powers of a time. That of the motion is about the largest that its
/// ends call for; it is a power of two, which costs no bit, so that the answer does not depend on the unit of anything.
#[derive(Clone, Copy, Debug)]
struct Scaled {
    start: Moving,
    goal: Moving,
    /// From one to the other, before either was rounded to the new unit.
    change: Moving,
    confines: Confines,
    way: f64,
    /// What the way is rounded to.
    slack: f64,
    /// The time unit \[s\].
    unit: f64,
}

impl Scaled {
    fn of(transfer: &Transfer) -> Self {
        let Transfer { start, goal, bounds } = transfer;
        let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
            *bounds.spec();
        let of_length = 1.0 / max_jerk;
        let distance = goal.position - start.position;
        let exponent = exponent(distance * of_length)
            .div_euclid(3)
            .max(exponent(start.velocity * of_length).div_euclid(2))
            .max(exponent(goal.velocity * of_length).div_euclid(2))
            .max(exponent(start.acceleration * of_length))
            .max(exponent(goal.acceleration * of_length))
            .clamp(-GREATEST_EXPONENT, GREATEST_EXPONENT);
        let per_time = power_of_two(-exponent);
        let acceleration = of_length * per_time;
        let velocity = acceleration * per_time;
        let length = velocity * per_time;
        let moving = |state: &State| Moving {
            velocity: state.velocity * velocity,
            acceleration: state.acceleration * acceleration,
        };
        Self {
            start: moving(start),
            goal: moving(goal),
            change: Moving {
                velocity: (goal.velocity - start.velocity) * velocity,
                acceleration: (goal.acceleration - start.acceleration) * acceleration,
            },
            confines: Confines {
                bottom: largest(-OUT_OF_REACH * OUT_OF_REACH, min_velocity * velocity),
                top: least(OUT_OF_REACH * OUT_OF_REACH, max_velocity * velocity),
                up: least(OUT_OF_REACH, max_acceleration * acceleration),
                down: least(OUT_OF_REACH, -min_acceleration * acceleration),
            },
            way: distance * length,
            slack: POSITION_SLACK * start.position.abs().max(goal.position.abs()) * length,
            unit: power_of_two(exponent),
        }
    }

    fn ends_after(&self, lead: &LeadIn) -> Ends {
        let Self { goal, change, .. } = *self;
        let change = if lead.pieces.is_empty() { change } else { lead.reached.to(goal) };
        Ends::new(lead.reached, goal, change)
    }
}

/// Of the positions \[1\]: what their distance is rounded to; the same target again, but for a rounding, is the same target. Half of
/// what the judge allows, so that it has room for roundings of its own.
const POSITION_SLACK: f64 = 4.0 * f64::EPSILON;

/// Of the time unit: a length is divided by its cube and by the jerk limit, from [`LEAST_LIMIT`](crate::LEAST_LIMIT) on; both
/// are numbers in either direction, and so are their products with what is measured in them.
const GREATEST_EXPONENT: i32 = 200;

/// Of the time unit to the power of −[`GREATEST_EXPONENT`]: longer than any motion, so that an acceleration that takes so long to
/// be reached never is, nor a velocity that takes the square of it; and its fourth power is a number.
const OUT_OF_REACH: f64 = power_of_two(GREATEST_EXPONENT + 53);

/// The power of two of a number; that of zero is far below every other.
fn exponent(value: f64) -> i32 {
    ((value.to_bits() >> 52) & 0x7ff) as i32 - 1023
}

/// 2 to the power of `exponent`, of ±[`GREATEST_EXPONENT`] at most.
const fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}
