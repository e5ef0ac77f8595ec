//! What the judge says of a motion, quantity by quantity.

use alloc::boxed::Box;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::LIMIT_TOLERANCE;
use crate::{Quantity, Shortest};

/// What the judge found, for all axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Certificate {
    /// One for each axis and limited quantity: velocity, acceleration and jerk; position where there is a range; snap and
    /// above where a limit is stated or promised.
    pub limits: Vec<LimitCheck>,
    /// One for each axis and each of position, velocity, acceleration, and each higher derivative that may not jump.
    pub joins: Vec<JoinCheck>,
    /// One for each axis and each of position, velocity, acceleration.
    pub ends: Vec<EndCheck>,
    /// Where each axis turns back, axis by axis in order of time; of a plan that does not promise its velocity, as those whose points
    /// are joined by polynomials. Of others they are not looked for.
    pub reversals: Box<[Reversal]>,
}

/// The extreme of one quantity on one axis, against its limit.
#[derive(Clone, Debug, PartialEq)]
pub struct LimitCheck {
    /// The axis; one name for all that is said of it.
    pub axis: Arc<str>,
    /// The quantity.
    pub quantity: Quantity,
    /// The limit that is nearest to being broken [unit of the quantity]: a magnitude, but for positions.
    pub limit: f64,
    /// The extreme value, signed; infinite where the derivative below jumps.
    pub extremum: f64,
    /// When it is taken \[s\].
    pub at_time: f64,
    /// How far it is inside \[1\]: (limit − |extremum|) / limit; for positions, of the extent of the motion.
    pub margin: f64,
    /// Does the plan promise to keep it? If not, it is reported and not counted.
    pub guaranteed: bool,
    /// When what was beyond the limit at the start, or bound to come there, is back \[s\], led as fast as can be: the rest is of
    /// the motion but for that. `None`: of all of it.
    pub led_back_by: Option<f64>,
}

/// The worst jump of one quantity where pieces join.
#[derive(Clone, Debug, PartialEq)]
pub struct JoinCheck {
    /// The axis; one name for all that is said of it.
    pub axis: Arc<str>,
    /// The quantity.
    pub quantity: Quantity,
    /// The jump [unit of the quantity], a magnitude.
    pub worst_jump: f64,
    /// What it may be.
    pub allowed: f64,
    /// Where it is \[s\].
    pub at_time: f64,
    /// Does the plan promise that it joins?
    pub guaranteed: bool,
}

/// How far the last piece ends from the state that is to be reached.
#[derive(Clone, Debug, PartialEq)]
pub struct EndCheck {
    /// The axis; one name for all that is said of it.
    pub axis: Arc<str>,
    /// The quantity.
    pub quantity: Quantity,
    /// How far [unit of the quantity], a magnitude.
    pub residual: f64,
    /// What it may be.
    pub allowed: f64,
}

/// Where the velocity of one axis changes its sign.
#[derive(Clone, Debug, PartialEq)]
pub struct Reversal {
    /// The axis; one name for all that is said of it.
    pub axis: Arc<str>,
    /// When it does \[s\].
    pub at_time: f64,
    /// Where the axis is then [axis units].
    pub position: f64,
}

/// One thing that a motion promises and does not keep.
#[derive(Clone, Debug, PartialEq)]
pub enum Violation {
    /// A limit is broken.
    Limit(LimitCheck),
    /// Two pieces do not join.
    Join(JoinCheck),
    /// The end is not reached.
    End(EndCheck),
}

impl Certificate {
    /// Nothing that is promised is broken.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.limits.iter().all(LimitCheck::passed)
            && self.joins.iter().all(JoinCheck::passed)
            && self.ends.iter().all(EndCheck::passed)
    }

    /// Does the motion begin beyond a limit, and is it led back?
    #[must_use]
    pub fn is_led_back(&self) -> bool {
        self.limits.iter().any(|check| check.led_back_by.is_some())
    }

    /// Everything that is promised and broken.
    pub fn violations(&self) -> impl Iterator<Item = Violation> {
        let limits = self.limits.iter().filter(|check| !check.passed()).cloned().map(Violation::Limit);
        let joins = self.joins.iter().filter(|check| !check.passed()).cloned().map(Violation::Join);
        let ends = self.ends.iter().filter(|check| !check.passed()).cloned().map(Violation::End);
        joins.chain(limits).chain(ends)
    }
}

// Each comparison is false for NaN, so that what cannot be computed does not pass.
impl LimitCheck {
    /// Kept, or not promised.
    #[must_use]
    pub fn passed(&self) -> bool {
        !self.guaranteed || self.margin >= -LIMIT_TOLERANCE
    }
}

impl JoinCheck {
    /// Joined, or not promised.
    #[must_use]
    pub fn passed(&self) -> bool {
        !self.guaranteed || self.worst_jump <= self.allowed
    }
}

impl EndCheck {
    /// Reached.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.residual <= self.allowed
    }
}

impl core::fmt::Display for Violation {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Limit(LimitCheck { axis, quantity, limit, extremum, at_time, .. }) => {
                let [extremum, at_time, limit] = [*extremum, *at_time, *limit].map(Shortest);
                write!(f, "axis {axis}: {quantity} reaches {extremum} at {at_time} s, the limit is {limit}")
            }
            Self::Join(JoinCheck { axis, quantity, worst_jump, allowed, at_time, .. }) => {
                let [jump, at_time, allowed] = [*worst_jump, *at_time, *allowed].map(Shortest);
                write!(f, "axis {axis}: {quantity} jumps by {jump} at {at_time} s, allowed is {allowed}")
            }
            Self::End(EndCheck { axis, quantity, residual, allowed }) => {
                let [residual, allowed] = [*residual, *allowed].map(Shortest);
                write!(
                    f,
                    "axis {axis}: {quantity} ends {residual} from where it should, allowed is {allowed}"
                )
            }
        }
    }
}
