use alloc::string::String;

use crate::{Field, InvalidFields, Rejection, Why};

/// Why an operation on a motion is not done: nothing has changed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Refused {
    /// A number that cannot be a factor.
    #[error("an override of {given}: give 0 to rest, or a finite factor above it")]
    NotAFactor {
        /// The value.
        given: f64,
    },
    /// A factor that the velocity limits do not allow.
    #[error(
        "an override of {given} is out of range: give 0 (rest) to {greatest}, where the feed rate meets the velocity limit"
    )]
    OverrideOutOfRange {
        /// The value.
        given: f64,
        /// The greatest that would do.
        greatest: f64,
    },
    /// The rest of the motion is forgotten.
    #[error("the motion is stopping and rests from cycle {rest_cycle}: open a new one from there")]
    Stopped {
        /// The first cycle at rest.
        rest_cycle: u64,
    },
    /// Nothing can follow.
    #[error("the motion is finished: open a new one")]
    StreamFinished,
    /// A cycle that an earlier motion had.
    #[error("cycle {given} is before the motion, which begins at {first}: take effect at {first} or later")]
    BeforeMotion {
        /// The cycle.
        given: u64,
        /// The first of the motion.
        first: u64,
    },
    /// A motion that would leave the position range.
    #[error(
        "axis {axis}: the motion reaches {reached} at {time} s, beyond {allowed}: choose a nearer goal, go slower, or move {limit}"
    )]
    PositionLimit {
        /// The axis.
        axis: String,
        /// The farthest position [axis units].
        reached: f64,
        /// When, from where the operation takes effect \[s\].
        time: f64,
        /// The end of the range [axis units].
        allowed: f64,
        /// The limit's field.
        limit: &'static str,
    },
    /// A goal, or a state, beside the straight line.
    #[error(
        "axis {axis}: {quantity} {given} is not on the straight line that the axes move along, which has {nearest} there: \
         name goals on the line, or hold, and go on from rest"
    )]
    OffLine {
        /// The axis.
        axis: String,
        /// Which part of the state.
        quantity: crate::Quantity,
        /// The value, in its unit.
        given: f64,
        /// The value on the line.
        nearest: f64,
    },
    /// Points for a motion that goes through none.
    #[error(
        "the motion goes to a goal, not through points: retarget it, or open a stream with a plan through points"
    )]
    NotThroughPoints,
    /// Points that come after the motion has begun to stop, or has ended.
    #[error(
        "the motion ends from cycle {closing_from_cycle} on: append before that, or open a stream with a new plan"
    )]
    AppendTooLate {
        /// The first cycle of the closing stop, or the first at rest.
        closing_from_cycle: u64,
    },
    /// A way to rest that is another motion's.
    #[error(
        "the way to rest from cycle {at_cycle} does not begin in its setpoint, end at rest, or have the motion's axes: take the one \
         that came with that setpoint"
    )]
    TailDiffers {
        /// The cycle.
        at_cycle: u64,
    },
    /// Something in the operation that is wrong, or that cannot be planned, with its path.
    #[error(transparent)]
    Invalid(#[from] InvalidFields),
    /// The judge has something against what was planned.
    #[error("what was planned is rejected, which should not be: {0}; hold, and go on from rest")]
    Rejected(Rejection),
}

impl Refused {
    /// What a later version will do.
    pub(super) fn not_implemented(what: &'static str, instead: &'static str) -> Self {
        Self::Invalid(InvalidFields::one(Field::default(), Why::NotImplemented { what, instead }))
    }
}

/// Why parts do not make a motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidMotion {
    /// It must come to rest by itself.
    #[error("plan: axis {axis} ends at a velocity of {velocity}: put a closing stop after it")]
    EndsAtSpeed {
        /// The axis.
        axis: String,
        /// Its velocity at the end [axis units/s].
        velocity: f64,
    },
    /// Cycles past the last that can be counted.
    #[error(
        "from_cycle {from_cycle} and {cycle_count} cycles are more than can be counted, {}",
        crate::LAST_CYCLE
    )]
    TooManyCycles {
        /// Where it begins.
        from_cycle: u64,
        /// How long it lasts \[cycles\].
        cycle_count: u64,
    },
    /// What is held must be known.
    #[error("base: is not set, and a motion that is held needs the plan that is to be resumed")]
    BaseMissing,
    /// Two plans of one motion.
    #[error(
        "base: is a plan of other axes or another cycle time than plan: give the plan that is to be gone on with"
    )]
    BaseDiffers,
    /// A law of time needs the path whose time it is.
    #[error("base_time: is set, and base is not: give the plan whose time it is, or leave it empty")]
    BaseTimeAlone,
    /// The parts contradict each other.
    #[error(
        "base_time: plan does not begin or end where base is under it: give the plan, base and base_time of one revision"
    )]
    OffBase,
    /// A stop that begins outside of its plan.
    #[error("closing_from_cycle is {given}: a closing stop begins in the plan, from cycle {first} to {last}")]
    ClosingOutside {
        /// The value.
        given: u64,
        /// The first cycle of the plan.
        first: u64,
        /// The last.
        last: u64,
    },
}
