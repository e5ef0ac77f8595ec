use super::Refused;
use crate::float::{largest, least};
use crate::{Limits, State};

/// An override: a factor on the feed rate \[1\], finite and not negative; 0 rests.
///
/// ```
/// # use planner::motion::Override;
/// assert_eq!(Override::new(0.5)?.get(), 0.5);
/// assert!(Override::new(-0.5).is_err());
/// # Ok::<(), planner::motion::Refused>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
pub struct Override(f64);

impl Override {
    /// The feed rate as it was asked for.
    pub const FULL: Self = Self(1.0);
    /// Rest.
    pub const REST: Self = Self(0.0);

    /// A factor. How large it may be depends on the limits of what moves, and is asked when it is applied.
    ///
    /// # Errors
    /// [`Refused::NotAFactor`] for a number that is negative or not finite.
    pub fn new(given: f64) -> Result<Self, Refused> {
        // The sign of a zero is not carried.
        if given.is_finite() && given >= 0.0 {
            Ok(Self(given + 0.0))
        } else {
            Err(Refused::NotAFactor { given })
        }
    }

    /// The number \[1\].
    #[must_use]
    pub fn get(self) -> f64 {
        self.0
    }

    /// Does it rest?
    #[must_use]
    pub fn rests(self) -> bool {
        self.0 == 0.0
    }

    /// The greatest factor \[1\] for axes with these limits: velocity limit over feed rate, the least of all axes; 1 at least.
    #[must_use]
    pub fn greatest<'a>(limits: impl IntoIterator<Item = &'a Limits>) -> f64 {
        let ratio = |limits: &Limits| limits.velocity_forward() / limits.cruise_towards(1.0);
        let greatest = limits.into_iter().map(ratio).fold(f64::INFINITY, least);
        if greatest.is_finite() { greatest } else { 1.0 }
    }

    /// The goal under the override: passed as fast as a motion at this rate passes it, `(v·f, a·f²)`, within `limits`, which are
    /// scaled already. A goal with an acceleration is passed no faster than was asked: its velocity limits leave room for that.
    pub(super) fn at_goal(self, goal: State, limits: &Limits) -> State {
        if goal.is_at_rest() || self == Self::FULL {
            return goal;
        }
        let rate = if goal.acceleration == 0.0 { self.0 } else { least(self.0, 1.0) };
        let (slowest, fastest) = (0.0 - limits.velocity_reverse(), limits.velocity_forward());
        let velocity = largest(slowest, least(fastest, rate * goal.velocity));
        State { velocity, acceleration: rate * rate * goal.acceleration, ..goal }
    }
}
