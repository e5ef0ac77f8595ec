use super::arrivals::Arrivals;
use super::timed::{Timed, is_same_time};
use super::transit::Transit;
use super::{BoundsSpec, NAMES, Transfer, check_duration, lay_fastest, lay_lasting, mapped, transit_of};
use crate::error::InvalidFields;
use crate::limits::not_finite;
use crate::{Limits, Shortest, State};

/// A question about one axis from any state to any state, within bounds or within limits, checked: how fast can it arrive, when else,
/// and how, so that it arrives with others.
///
/// ```
/// # use planner::{AxisTransfer, Bounds, State, Transfer};
/// let bounds = Bounds::symmetric(5.0, 1.0, 10.0)?;
/// let axis = AxisTransfer::from(Transfer::new(State::at_rest(0.3), State::at_rest(0.32), bounds)?);
/// assert!((axis.arrivals()?.least() - 0.4).abs() < 1e-15);
/// assert_eq!(axis.lasting(1.0)?.duration(), 1.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct AxisTransfer<'a> {
    within: Within<'a>,
}

/// What an axis may do, with where it goes.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Within<'a> {
    Bounds(Transfer),
    Limits { start: State, goal: State, limits: &'a Limits },
}

/// Why no motion lasts as long as was asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoSuchDuration {
    /// The duration is not a number.
    #[error("the duration is {given}: give a finite number of seconds")]
    NotFinite {
        /// What was asked \[s\].
        given: f64,
    },
    /// It is less than the least.
    #[error("nothing arrives in {} s: it takes {} s at least", Shortest(*.given), Shortest(*.least))]
    TooShort {
        /// What was asked \[s\].
        given: f64,
        /// The least duration \[s\].
        least: f64,
    },
    /// The axis can take less and, unless `before` is infinite, more.
    #[error(
        "nothing arrives in {} s, nor in any time between {} s and {} s: ask for one of these",
        Shortest(*.given),
        Shortest(*.after),
        Shortest(*.before)
    )]
    Blocked {
        /// What was asked \[s\].
        given: f64,
        /// The last duration before the blocked ones \[s\].
        after: f64,
        /// The first beyond them \[s\].
        before: f64,
    },
    /// There is no motion at all, or it leaves the position range.
    #[error(transparent)]
    Invalid(#[from] InvalidFields),
}

impl From<Transfer> for AxisTransfer<'_> {
    fn from(transfer: Transfer) -> Self {
        Self { within: Within::Bounds(transfer) }
    }
}

impl<'a> AxisTransfer<'a> {
    /// Asks within limits of speeding up and slowing down, cruising at most at the feed rate.
    ///
    /// # Errors
    /// What is wrong with `start` and `goal`, as [`Transfer::new`] says.
    pub fn within_limits(start: State, goal: State, limits: &'a Limits) -> Result<Self, InvalidFields> {
        let (start, goal) = (start.with_positive_zeros(), goal.with_positive_zeros());
        mapped::check(&start, &goal, limits)?;
        Ok(Self { within: Within::Limits { start, goal, limits } })
    }

    /// Where the motion begins.
    #[must_use]
    pub fn start(&self) -> State {
        match self.within {
            Within::Bounds(transfer) => transfer.start(),
            Within::Limits { start, .. } => start,
        }
    }

    /// Where it ends.
    #[must_use]
    pub fn goal(&self) -> State {
        match self.within {
            Within::Bounds(transfer) => transfer.goal(),
            Within::Limits { goal, .. } => goal,
        }
    }

    /// The fastest motion: [`plan_transfer`](crate::plan_transfer), or [`plan_between`](crate::plan_between).
    ///
    /// # Errors
    /// As those two.
    pub fn fastest(&self) -> Result<Transit, InvalidFields> {
        self.in_range(self.quickest()?)
    }

    /// The durations that there are.
    ///
    /// Where speeding up and slowing down have limits of their own, those above the least are the durations of motions that keep the
    /// lower of both throughout: a motion that takes its time needs no more, and of the others which keep the rule
    /// depends on where each of them turns. [`Self::lasting`] may find one more.
    ///
    /// # Errors
    /// As [`Self::fastest`], but for the position range.
    pub fn arrivals(&self) -> Result<Arrivals, InvalidFields> {
        let least = self.quickest()?.duration();
        self.arrivals_from(least)
    }

    /// The motion that takes `duration` \[s\]: in between at a steady velocity, as fast as can be to it and from it; where there is no such
    /// motion, a blend of the one that goes farthest in that time and the one that goes least far.
    ///
    /// Accelerations are not chosen for being small, the steady velocity is: it is what the duration leaves. The pieces last `duration`
    /// together, but for a unit in the last place or two.
    ///
    /// # Errors
    /// [`NoSuchDuration`], with the nearest that there are.
    pub fn lasting(&self, duration: f64) -> Result<Transit, NoSuchDuration> {
        if not_finite(duration).is_some() {
            return Err(NoSuchDuration::NotFinite { given: duration });
        }
        check_duration(duration)?;
        let fastest = self.quickest()?;
        let least = fastest.duration();
        if is_same_time(duration, least) {
            let mut planned = fastest;
            planned.last(duration);
            return Ok(self.in_range(planned)?);
        }
        if duration < least {
            return Err(NoSuchDuration::TooShort { given: duration, least });
        }
        if let Some(planned) = self.planned_in(duration) {
            return Ok(self.in_range(planned)?);
        }
        let blocked = self.arrivals_from(least)?;
        let around = blocked.blocked().iter().find(|blocked| duration < blocked.before);
        let (after, before) = around.map_or((least, duration), |blocked| (blocked.after, blocked.before));
        Err(NoSuchDuration::Blocked { given: duration, after, before })
    }

    /// The fastest, wherever it leads.
    pub(crate) fn quickest(&self) -> Result<Transit, InvalidFields> {
        match self.within {
            Within::Bounds(transfer) => transit_of(&transfer, &NAMES),
            Within::Limits { start, goal, limits } => mapped::fastest(start, goal, limits),
        }
    }

    /// The fastest, wherever it leads, into `transit`, which is of no use where there is none.
    pub(crate) fn lay_quickest(&self, transit: &mut Transit) -> Result<(), InvalidFields> {
        match self.within {
            Within::Bounds(transfer) => lay_fastest(&transfer, &NAMES, transit),
            Within::Limits { start, goal, limits } => {
                mapped::fastest(start, goal, limits).map(|planned| *transit = planned)
            }
        }
    }

    /// A motion that takes `duration` \[s\], more than the least, wherever it leads, into `transit`, which is of no use where there is
    /// none.
    pub(crate) fn lay_in(&self, duration: f64, transit: &mut Transit) -> bool {
        match self.within {
            Within::Bounds(transfer) => lay_lasting(&transfer, duration, transit),
            Within::Limits { start, goal, limits } => {
                mapped::lay_lasting(start, goal, limits, duration, transit)
            }
        }
    }

    /// A motion that takes `duration` \[s\], more than the least, wherever it leads.
    pub(crate) fn planned_in(&self, duration: f64) -> Option<Transit> {
        let mut transit = Transit::unlaid();
        self.lay_in(duration, &mut transit).then_some(transit)
    }

    pub(crate) fn arrivals_from(&self, least: f64) -> Result<Arrivals, InvalidFields> {
        let transfer = match self.within {
            Within::Bounds(transfer) => transfer,
            Within::Limits { start, goal, limits } => {
                if let Some(by_rest) = mapped::by_way_of_rest(start, goal, limits) {
                    return Ok(Arrivals::from_both(least, by_rest.duration()));
                }
                mapped::lower(start, goal, limits)?
            }
        };
        Ok(Timed::of(&transfer).arrivals(least))
    }

    /// The motion, if it stays inside the position range.
    pub(crate) fn in_range(&self, planned: Transit) -> Result<Transit, InvalidFields> {
        self.check_range(&planned)?;
        Ok(planned)
    }

    pub(crate) fn check_range(&self, planned: &Transit) -> Result<(), InvalidFields> {
        planned.check_numbers()?;
        match self.within {
            Within::Bounds(_) => Ok(()),
            Within::Limits { limits, .. } => mapped::within_range(planned, limits),
        }
    }

    /// What the axis may do, with signs; where speeding up and slowing down differ, the lower of both.
    pub(crate) fn signed(&self) -> BoundsSpec {
        match self.within {
            Within::Bounds(transfer) => *transfer.bounds().spec(),
            Within::Limits { limits, .. } => *mapped::lower_bounds(limits).spec(),
        }
    }

    /// What the axis may do.
    pub(crate) fn within(&self) -> Within<'a> {
        self.within
    }
}
