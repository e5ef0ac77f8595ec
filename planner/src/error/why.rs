//! What can be wrong with a request, in words: one variant for each thing that a caller can act on.

use alloc::boxed::Box;
use alloc::string::String;
use core::fmt;

use crate::limits::{GREATEST_MAGNITUDE, LEAST_LIMIT};
use crate::{PvtOffers, PvtTarget, Shortest};

/// What is wrong with a field, with the numbers that a caller needs to put it right.
///
/// Exhaustive: whoever gives each of them a name of its own, as a wire does, is to be told of a new one by the compiler.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Why {
    /// NaN, infinite, or too large to compute with.
    #[error(
        "is {}: give a finite number of at most {max:e} in magnitude",
        Shortest(*.given),
        max = GREATEST_MAGNITUDE
    )]
    NotFinite {
        /// The value.
        given: f64,
    },
    /// A limit that is zero, negative, or too small to compute with.
    #[error(
        "is {}: a limit is a magnitude, at least {min:e}; its sign is not needed",
        Shortest(*.given),
        min = LEAST_LIMIT
    )]
    NotPositive {
        /// The value.
        given: f64,
    },
    /// A time that does not last.
    #[error("is {} s: give a time above 0", Shortest(*.given))]
    DurationNotPositive {
        /// The value \[s\].
        given: f64,
    },
    /// A least duration that would end before it begins.
    #[error("is {} s: give the least duration, above 0, or 0 to ask nothing", Shortest(*.given))]
    NegativeDuration {
        /// The value \[s\].
        given: f64,
    },
    /// A duration whose parts contradict each other.
    #[error(
        "is {seconds} s and {nanos} ns: give both parts one sign, and less than 1000000000 ns beside the seconds"
    )]
    DurationParts {
        /// The whole seconds \[s\].
        seconds: i64,
        /// The rest \[ns\].
        nanos: i32,
    },
    /// A speed backward with a sign.
    #[error("is {}: a limit is a magnitude, so leave the sign out; 0 forbids to go back", Shortest(*.given))]
    NegativeReverse {
        /// The value.
        given: f64,
    },
    /// What a plan says of itself and is not.
    #[error("says {given}, and should say {correct}: correct it, or plan again")]
    Misstated {
        /// What it says.
        given: String,
        /// What it is.
        correct: String,
    },
    /// The fingerprint of another plan.
    #[error(
        "is {given}, that of another plan; this one has {correct}: plan again, or leave it out where the change is meant"
    )]
    FingerprintMismatch {
        /// The fingerprint \[hexadecimal\].
        given: String,
        /// The one that the plan has \[hexadecimal\].
        correct: String,
    },
    /// A lower bound that is zero, positive, or too small to compute with.
    #[error("is {given}: a lower bound is below zero, by at least {min:e}", min = LEAST_LIMIT)]
    NotNegative {
        /// The value.
        given: f64,
    },
    /// A position range without inside.
    #[error(
        "the range from {} to {} is empty: exchange min_position and max_position",
        Shortest(*.min),
        Shortest(*.max)
    )]
    EmptyRange {
        /// The lower end [axis units].
        min: f64,
        /// The upper end [axis units].
        max: f64,
    },
    /// A part without a default that was left out.
    #[error("is not set: give {what}")]
    Missing {
        /// What belongs there.
        what: &'static str,
    },
    /// A choice that was not made.
    #[error("is not set: choose one of {choices}")]
    Unspecified {
        /// What there is to choose from.
        choices: &'static str,
    },
    /// A choice that this version does not know.
    #[error("is {given}, which this version does not know: choose one of {choices}")]
    UnknownChoice {
        /// The number on the wire.
        given: i32,
        /// What there is to choose from.
        choices: &'static str,
    },
    /// A name that this version does not know.
    #[error("is {given:?}, which this version does not know: use one of {choices}")]
    UnknownName {
        /// The name.
        given: String,
        /// What there is to choose from.
        choices: &'static str,
    },
    /// An order that no polynomial has.
    #[error("asks for order {given}: a polynomial has an order of 2 to {max}", max = crate::MAX_ORDER)]
    OrderUnsupported {
        /// The order.
        given: usize,
    },
    /// A polynomial of no order.
    #[error("is not set: say the order of the polynomial, 2 to {max}", max = crate::MAX_ORDER)]
    OrderMissing,
    /// An order that the family does not have.
    #[error(
        "asks for order {given}: the family {family} has order {order}, so leave it out or choose POLYNOMIAL"
    )]
    OrderOfFamily {
        /// The order that was asked for.
        given: u32,
        /// The family.
        family: &'static str,
        /// The order that it has.
        order: u32,
    },
    /// A limit that the order needs.
    #[error("is not set, and order {order} needs it: state the limit, or ask for order {lower}")]
    LimitMissing {
        /// The order that was asked for.
        order: usize,
        /// The highest order whose limits are all there.
        lower: usize,
    },
    /// Limits of the fifth derivative and above, of which the order needs more.
    #[error(
        "has {}, and order {order} needs {needed}, of the fifth derivative up to its own: add what is missing, or ask for order {lower}",
        HowMany(*.given)
    )]
    LimitsTooFew {
        /// The order that was asked for.
        order: usize,
        /// How many limits of the fifth derivative and above it needs.
        needed: usize,
        /// How many were given.
        given: usize,
        /// The highest order whose limits are all there.
        lower: usize,
    },
    /// An end in motion, for a family that goes from rest to rest.
    #[error(
        "is {}: the family {family} goes from rest to rest, so give 0 or choose S_CURVE",
        Shortest(*.given)
    )]
    NotAtRest {
        /// The value.
        given: f64,
        /// The family.
        family: &'static str,
    },
    /// A last point that is passed.
    #[error("is {}, and the last point is one at rest: give 0, or leave out last", Shortest(*.given))]
    LastNotAtRest {
        /// The value.
        given: f64,
    },
    /// Two axes with one name.
    #[error("the name {name:?} is taken by an axis before it: give every axis a name of its own")]
    DuplicateAxis {
        /// The name.
        name: String,
    },
    /// No name.
    #[error("is empty: give a name of 1 to {max} bytes", max = crate::MAX_NAME_BYTES)]
    NameEmpty,
    /// A name that does not fit on a line, or steers a terminal.
    #[error("has the control character {given:?}: use characters that can be printed")]
    NameControl {
        /// The first of them.
        given: char,
    },
    /// A name that nobody would read.
    #[error("has {given} bytes: a name has at most {allowed}, so shorten it")]
    NameTooLong {
        /// Its length \[bytes\].
        given: usize,
        /// What a name has at most \[bytes\].
        allowed: usize,
    },
    /// A name that no axis of the plan has.
    #[error("no axis is called {name:?}: the plan has {known}")]
    UnknownAxis {
        /// The name.
        name: String,
        /// Those that there are.
        known: String,
    },
    /// Nothing to move.
    #[error("is empty: give at least one axis")]
    NoAxes,
    /// More than one axis for moves that are told in columns.
    #[error(
        "has {given} axes: the moves of columns are of one axis, so send columns for each, or requests where they go together"
    )]
    NotOneAxis {
        /// How many were given.
        given: usize,
    },
    /// More axes than a plan holds.
    #[error("has {given} axes: a plan takes at most {allowed}, so split the request")]
    TooManyAxes {
        /// How many were given.
        given: usize,
        /// How many a plan holds.
        allowed: usize,
    },
    /// More segments than a plan holds.
    #[error("has {given} segments: an axis takes at most {allowed}, so split the plan")]
    TooManySegments {
        /// How many were given.
        given: usize,
        /// How many an axis of a plan holds.
        allowed: usize,
    },
    /// A motion that lasts longer than cycles can be counted.
    #[error(
        "lasts {} s, more cycles than can be counted: raise the limits or lengthen cycle_time",
        Shortest(*.seconds)
    )]
    TooManyCycles {
        /// The duration \[s\].
        seconds: f64,
    },
    /// A cycle time out of range.
    #[error("is {given_ns} ns: a cycle lasts from {min_ns} to {max_ns} ns")]
    CycleTime {
        /// The value \[ns\].
        given_ns: i128,
        /// The shortest cycle \[ns\].
        min_ns: u64,
        /// The longest cycle \[ns\].
        max_ns: u64,
    },
    /// Bits that this planner cannot give.
    #[error("is {given}, and this planner evaluates version {}: plan again here", crate::EVALUATION_VERSION)]
    EvaluationVersion {
        /// The value.
        given: u32,
    },
    /// Something that a later version will do.
    #[error("{what} is not implemented: {instead}")]
    NotImplemented {
        /// What was asked.
        what: &'static str,
        /// What works today.
        instead: &'static str,
    },
    /// A start state that limits do not allow.
    #[error(
        "is {}, beyond {}: begin inside the limit or raise {limit}",
        Shortest(*.given),
        Shortest(*.allowed)
    )]
    StartOutsideLimits {
        /// The value.
        given: f64,
        /// The nearest value that would do.
        allowed: f64,
        /// The limit's field.
        limit: &'static str,
    },
    /// A goal state that limits do not allow.
    #[error(
        "is {}, beyond {}: end inside the limit or raise {limit}",
        Shortest(*.given),
        Shortest(*.allowed)
    )]
    GoalOutsideLimits {
        /// The value.
        given: f64,
        /// The nearest value that would do.
        allowed: f64,
        /// The limit's field.
        limit: &'static str,
    },
    /// A motion that would leave the position range.
    #[error(
        "the motion reaches {} at {} s, beyond {}: stay inside or move {limit}",
        Shortest(*.reached),
        Shortest(*.time),
        Shortest(*.allowed)
    )]
    PositionLimit {
        /// The farthest position [axis units].
        reached: f64,
        /// When \[s\].
        time: f64,
        /// The end of the range [axis units].
        allowed: f64,
        /// The limit's field.
        limit: &'static str,
    },
    /// The way is shorter than the change of velocity needs.
    #[error(
        "the path of {} is too short to change from the start to the end velocity, which needs {}: \
         lengthen it, end at a velocity of {}, or name a short_path_policy",
        Shortest(*.given),
        Shortest(*.needed),
        Shortest(*.nearest_velocity)
    )]
    PathTooShort {
        /// The least length [axis units], with the sign of the travel.
        needed: f64,
        /// The length that was given [axis units], signed.
        given: f64,
        /// The reachable end velocity nearest to the one asked for [axis units/s].
        nearest_velocity: f64,
    },
    /// No point to go to.
    #[error("is empty: give at least one point")]
    NoPoints,
    /// Lists that belong together and do not have the same length.
    #[error(
        "has {given} elements, and {list} has {expected}: give every point a time, a position and a velocity"
    )]
    LengthMismatch {
        /// The length of this list.
        given: usize,
        /// The length of the other.
        expected: usize,
        /// The other list.
        list: &'static str,
    },
    /// A time that is not after the one before it.
    #[error(
        "is {given} s, not after {before} s: times count from the start and increase from point to point"
    )]
    TimesNotIncreasing {
        /// The time \[s\].
        given: f64,
        /// The one before it \[s\], 0 for the first.
        before: f64,
    },
    /// A time that another axis does not have.
    #[error("is {given} s, and axes[0] has {expected} s: axes share their times, so give the same to all")]
    TimesDiffer {
        /// The time \[s\].
        given: f64,
        /// That of the first axis \[s\].
        expected: f64,
    },
    /// A time that is less than a cycle after the one before it.
    #[error(
        "is {given} s after the point before it, less than a cycle of {cycle} s: leave the point out or shorten \
         cycle_time"
    )]
    IntervalTooShort {
        /// The interval \[s\].
        given: f64,
        /// The cycle \[s\].
        cycle: f64,
    },
    /// A point whose velocity cannot be reached in its time.
    #[error("is {}, and {} s do not suffice for that: {}", Shortest(*.given), Shortest(*.duration), WaysOut::of(*.given, .offers))]
    PvtTimeTooShort {
        /// The velocity [axis units/s].
        given: f64,
        /// The time from the point before it \[s\].
        duration: f64,
        /// What would be taken instead.
        offers: Box<PvtOffers>,
    },
    /// A point whose position cannot be reached with its velocity in its time.
    #[error(
        "is {}, and {} s lead to between {} and {}: {}",
        Shortest(*.given),
        Shortest(*.duration),
        Shortest(*.least),
        Shortest(*.greatest),
        WaysOut::of(*.velocity, .offers)
    )]
    PvtOutOfReach {
        /// The position [axis units].
        given: f64,
        /// The velocity to have there [axis units/s].
        velocity: f64,
        /// The time from the point before it \[s\].
        duration: f64,
        /// The least position that can be reached [axis units].
        least: f64,
        /// The greatest position that can be reached [axis units].
        greatest: f64,
        /// What would be taken instead.
        offers: Box<PvtOffers>,
    },
    /// A point on the way to which the axis would leave its position range.
    #[error(
        "the motion to {} reaches {} at {} s, beyond {}: {}, or move {limit}",
        Shortest(*.given),
        Shortest(*.reached),
        Shortest(*.time),
        Shortest(*.allowed),
        WaysOut::on_the_way(*.velocity, .offers)
    )]
    PvtLeavesRange {
        /// The position [axis units].
        given: f64,
        /// The velocity to have there [axis units/s].
        velocity: f64,
        /// The first position outside where the way turns or ends [axis units].
        reached: f64,
        /// When that is \[s\].
        time: f64,
        /// The end of the range [axis units].
        allowed: f64,
        /// The limit's field.
        limit: &'static str,
        /// What would be taken instead.
        offers: Box<PvtOffers>,
    },
    /// A rate of path time that no limit allows.
    #[error(
        "is {given}: a factor is from 0 (rest) to {greatest}, which the limits allow on the rest of the path"
    )]
    FactorOutOfRange {
        /// The value.
        given: f64,
        /// The greatest that works.
        greatest: f64,
    },
    /// A law that cannot be re-timed.
    #[error(
        "is not a polynomial of order {max} or less, so its time cannot be stretched: plan the motion anew",
        max = crate::retime::GREATEST_ORDER
    )]
    NotRetimed,
    /// A plan whose end is not rest, where rest is needed.
    #[error("moves on at {velocity} after the end of the plan: put a closing stop after it")]
    EndsAtSpeed {
        /// Its velocity [axis units/s].
        velocity: f64,
    },
    /// A part of a state that leaves the straight line on which all axes are to stay.
    #[error(
        "is {}, and the straight line needs {}: give it that, or let the axes arrive together without a line",
        Shortest(*.given),
        Shortest(*.needed)
    )]
    OffTheLine {
        /// The value.
        given: f64,
        /// The one that is proportional to the distance of the axis.
        needed: f64,
    },
    /// An acceleration that would take an axis beyond its velocity on a straight line, though not by itself: another axis has too little jerk
    /// to end it as soon.
    #[error(
        "is {}, and on a straight line the jerk of axes[{slowest}] ends it only beyond {limit}: begin with {}, raise limits.max_jerk of \
         axes[{slowest}], or let the axes arrive together without a line",
        Shortest(*.given),
        Shortest(*.allowed)
    )]
    SweptOffLimits {
        /// The acceleration [axis units/s²].
        given: f64,
        /// As much as can be ended in time.
        allowed: f64,
        /// The field of the limit of velocity.
        limit: &'static str,
        /// The index of the axis whose jerk is the line's.
        slowest: usize,
    },
    /// An axis that may not go back and cannot wait either, so that it arrives early or never.
    #[error(
        "takes at most {} s, and the motion lasts {} s: allow it to go back, or plan it by itself",
        Shortest(*.greatest),
        Shortest(*.given)
    )]
    ArrivesEarly {
        /// How long the motion lasts \[s\].
        given: f64,
        /// The longest that the axis can take \[s\].
        greatest: f64,
    },
    /// No piece of a time law.
    #[error("is empty: give the pieces of the time law, or that of the plan itself")]
    NoTimeLaw,
    /// Path time that would go back.
    #[error("is {given}: a duration, path time and its rate are 0 or above where a piece begins")]
    BackInTime {
        /// The value.
        given: f64,
    },
}

/// So many limits.
struct HowMany(usize);

impl fmt::Display for HowMany {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            1 => f.write_str("1 limit"),
            count => write!(f, "{count} limits"),
        }
    }
}

/// What to ask for in place of a point that is refused.
struct WaysOut<'a> {
    /// The velocity of the point.
    velocity: f64,
    offers: &'a PvtOffers,
    /// Would another policy take it?
    policies: bool,
}

impl<'a> WaysOut<'a> {
    fn of(velocity: f64, offers: &'a PvtOffers) -> Self {
        Self { velocity, offers, policies: true }
    }

    fn on_the_way(velocity: f64, offers: &'a PvtOffers) -> Self {
        Self { velocity, offers, policies: false }
    }
}

impl fmt::Display for WaysOut<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let PvtOffers { nearest, same_position, later, time_helps } = self.offers;
        if let Some(PvtTarget { position, velocity, .. }) = nearest {
            let moved = (velocity - self.velocity).abs() > 0.0;
            let (position, velocity) = (Shortest(*position), Shortest(*velocity));
            if moved {
                write!(f, "ask for a velocity of {velocity} at the position {position}, ")?;
            } else {
                write!(f, "move the point to {position}, ")?;
            }
        }
        if let Some(PvtTarget { velocity, .. }) = same_position {
            write!(f, "keep the position with a velocity of {}, ", Shortest(*velocity))?;
        }
        match later {
            Some(PvtTarget { duration, .. }) => write!(f, "allow {} s", Shortest(*duration))?,
            None if !time_helps => f.write_str("allow the axis to go back, since no longer time helps")?,
            None => f.write_str("ask for less on the way to it")?,
        }
        if self.policies { f.write_str(", or name a policy that adjusts") } else { Ok(()) }
    }
}
