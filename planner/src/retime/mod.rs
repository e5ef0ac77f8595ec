//! A plan on its way, slowed, held or resumed on its path: the derivation is in `notes/0010-retiming.md`.
//!
//! The path of a plan under way is q(τ), τ the plan's own time. All axes get one common law τ(t) whose rate goes from what it is to
//! the factor that was asked for, and then
//!
//! ```text
//! v = q′·τ′        a = q″·τ′² + q′·τ″        j = q‴·τ′³ + 3·q″·τ′·τ″ + q′·τ‴
//! ```
//!
//! Where q is a polynomial and τ a cubic, q(τ(t)) is a polynomial too: the answer is an ordinary plan.

mod compose;
mod course;
mod extremes;
mod law;
mod search;
mod span;
mod strain;
mod walk;

use core::cell::Cell;

use crate::error::{Field, InvalidFields, Why};
use crate::{
    Accepted, Adjustment, AdjustmentReason, AxisPlan, Judged, Law, Plan, Quantity, Rejection, Segment, State,
};
use course::{Course, Lead};
pub use extremes::greatest_factor;
pub use law::TimeLaw;
use search::Search;
use strain::{AxisPath, Care};

/// The highest order of a path's pieces: a cubic of time in it is of the degree 15, the highest of a piece.
pub(crate) const GREATEST_ORDER: usize = crate::MAX_DEGREE / 3;

/// How near a candidate is looked at, in turn, until the judge, who looks everywhere, has nothing against it.
const CARES: [Care; 4] = [
    Care { looks: 4, reserve: 0.0 },
    Care { looks: 8, reserve: 0.003 },
    Care { looks: 16, reserve: 0.02 },
    Care { looks: 32, reserve: 0.1 },
];

/// A plan on another time law, from a splice on; the judge has nothing against it.
#[derive(Clone, Debug, PartialEq)]
pub struct Retiming {
    plan: Accepted,
    law: TimeLaw,
    reached: Option<f64>,
}

impl Retiming {
    /// The motion from the splice on, on its own clock from zero. It ends at rest: where the base does, or, for a factor of 0,
    /// where the base is held.
    #[must_use]
    pub fn plan(&self) -> &Accepted {
        &self.plan
    }

    /// Path time of the base on the same clock: what is to be given to [`retime`] for the next change.
    #[must_use]
    pub fn law(&self) -> &TimeLaw {
        &self.law
    }

    /// Plan and law, for who goes on with them.
    pub(crate) fn into_parts(self) -> (Accepted, TimeLaw) {
        (self.plan, self.law)
    }

    /// When path time has the rate that was asked for \[s\]; `None` where the path ends before.
    #[must_use]
    pub fn reached(&self) -> Option<f64> {
        self.reached
    }

    /// When every axis rests \[s\].
    #[must_use]
    pub fn rests(&self) -> f64 {
        self.plan.plan().duration()
    }
}

/// Why a plan is not re-timed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RetimeError {
    /// What was given, field by field.
    #[error(transparent)]
    Invalid(InvalidFields),
    /// The judge rejects the base even as it goes on without a change: it was not legal before, or not on this law; or less than a
    /// millionth of its time is left, beside which the roundings of all of it may weigh too much. Then leave the motion as it is.
    #[error("the rest of the plan is not legal as it is: {0}")]
    Rejected(Rejection),
}

/// Brings the rate of `base`'s path time to `factor`, from what it is `at` \[s\] after the start of `present`, its law so far.
///
/// Position, velocity and acceleration of every axis go on without a jump, on the path, within what the base keeps: limits that it
/// promises to keep, and of others no more than it takes anyway (but then the limit at least). A factor of 0 holds the motion;
/// one below 1 slows it; 1 resumes it. Above 1 the limits must have room on the rest of the path ([`greatest_factor`]).
///
/// With `q(τ)` the path of an axis over the plan's own time, and `τ′` the rate \[1\],
///
/// ```text
/// v = q′·τ′        a = q″·τ′² + q′·τ″        j = q‴·τ′³ + 3·q″·τ′·τ″ + q′·τ‴
/// ```
///
/// so the rate changes as fast as the tightest axis lets. Derived in `notes/0010-retiming.md`.
///
/// While an axis is on a limit the rate may not be able to change; then it stays for a while. Where the path ends before anything could be
/// gained, the motion runs to its end, and [`Retiming::reached`] is `None`.
///
/// *Fastest* means here: among one or two ramps of constant third derivative in pieces (up, hold, back), with a wait before each,
/// by a search of bounded length. Down, the one that reaches the factor first; up, the one that arrives first. Beside a dense
/// search over single ramps, 1500 random cases: within 1 % at the median, at most 11 % longer in nine of ten, 67 % at worst, and
/// often shorter, for the second ramp (`tests/retime_fastest.rs`). A motion that brakes at its limits already is not held sooner
/// than it ends.
///
/// ```
/// use planner::{
///     AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, Request, RequestSpec, ShortPathPolicy, State, Synchronization, TimeLaw,
///     retime,
/// };
///
/// let axis = |name: &str, length: f64| AxisMoveSpec {
///     axis: name.into(),
///     kind: Ok(AxisKind::Prismatic),
///     start: State::at_rest(0.0),
///     goal: State::at_rest(length),
///     limits: LimitsSpec { max_velocity: 0.5, max_acceleration: 2.0, max_jerk: 20.0, ..LimitsSpec::default() },
/// };
/// let spec = RequestSpec {
///     axes: vec![axis("x", 1.0), axis("y", 0.8)],
///     cycle_time_ns: None,
///     family: Ok(Family::SCurve),
///     order: None,
///     short_path: Ok(ShortPathPolicy::Reject),
///     synchronization: Ok(Synchronization::None),
///     minimum_duration: None,
///     end_on_cycle: false,
/// };
/// let base = planner::plan(&Request::try_from(spec)?)?;
///
/// // Held after a second, both axes cruising: as fast as one axis alone stops from 0.5 m/s.
/// let held = retime(&base, &TimeLaw::of(&base), 1.0, 0.0)?;
/// let rests = held.reached().expect("the path is long enough");
/// assert!((rests / (0.5 / 2.0 + 2.0 / 20.0) - 1.0).abs() < 0.03);
///
/// // And resumed: it ends where it would have ended.
/// let resumed = retime(&base, held.law(), rests, 1.0)?;
/// assert_eq!(resumed.plan().plan().axes()[0].profile.end(), State::at_rest(1.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`Why::FactorOutOfRange`]; [`Why::NotRetimed`] for a base with a cosine or an order above 5; [`Why::EndsAtSpeed`];
/// [`Why::TooManyCycles`] for a factor that no motion ends at; and [`RetimeError::Rejected`].
pub fn retime(base: &Plan, present: &TimeLaw, at: f64, factor: f64) -> Result<Retiming, RetimeError> {
    let spans = present.from(at);
    let present = Lead { spans: &spans, end: present.profile().end() };
    let start = present.start();
    check(base, &start, at, factor).map_err(RetimeError::Invalid)?;
    let axes = base.axes().iter();
    let mut search = Search {
        axes: axes
            .map(|axis| AxisPath::new(axis, |quantity| base.guarantees(quantity), start.position))
            .collect(),
        end: base.duration(),
        shortest: base.cycle_time().as_seconds(),
        care: CARES[0],
        strictest: Cell::new(0),
    };
    for care in CARES {
        search.care = care;
        if let Ok(retiming) = judged(base, search.course(present, factor)) {
            return Ok(retiming);
        }
    }
    judged(base, Course::unchanged(present))
}

/// The base on a course, if the judge has nothing against it.
fn judged(base: &Plan, course: Course) -> Result<Retiming, RetimeError> {
    let plan = composed(base, &course).map_err(RetimeError::Invalid)?;
    let plan = Judged::new(plan).accepted().map_err(RetimeError::Rejected)?;
    let law = TimeLaw::cut(&course, base.duration(), base.cycle_time().as_seconds());
    Ok(Retiming { plan, law, reached: course.reached })
}

/// Is every piece of a degree that leaves room for a cubic of time in it?
pub(crate) fn can_be_retimed(base: &Plan) -> bool {
    base.axes().iter().all(|axis| axis.profile.segments().iter().all(|segment| fits(&segment)))
}

fn fits(segment: &Segment) -> bool {
    match segment.law {
        Law::ConstantJerk(_) => true,
        Law::Polynomial(derivatives) => derivatives.order() <= GREATEST_ORDER,
        Law::CosineJerk { .. } => false,
    }
}

/// Everything that speaks against a change of the rate.
fn check(base: &Plan, start: &State, at: f64, factor: f64) -> Result<(), InvalidFields> {
    let mut invalid = InvalidFields::default();
    invalid.note("at", (!at.is_finite()).then_some(Why::NotFinite { given: at }));
    for (index, axis) in base.axes().iter().enumerate() {
        let field = Field::element("base.axes", index);
        let mut inner = InvalidFields::default();
        if let Some(piece) = axis.profile.segments().iter().position(|segment| !fits(&segment)) {
            let field = Field::element("segments", piece);
            inner.note(field.as_str(), Some(Why::NotRetimed));
        }
        let velocity = axis.profile.end().velocity;
        if !axis.profile.end().is_at_rest() {
            inner.note("end", Some(Why::EndsAtSpeed { velocity }));
        }
        invalid.extend_within(&field, inner);
    }
    let greatest = if factor > 1.0 { greatest_factor(base, start.position) } else { 1.0 };
    let fits = factor >= 0.0 && factor <= greatest && factor.is_finite();
    invalid.note("factor", (!fits).then_some(Why::FactorOutOfRange { given: factor, greatest }));
    invalid.into_result(())
}

/// The base under a time law: an ordinary plan.
fn composed(base: &Plan, course: &Course) -> Result<Plan, InvalidFields> {
    let joined = base.guarantees(Quantity::Jerk);
    let axes = base.axes().iter().map(|axis| {
        let AxisPlan {
            axis: name,
            kind,
            limits,
            profile: path,
            goal,
            adjustments,
            classification,
            pvt_regions,
        } = axis;
        let (profile, arrives) = compose::compose(path, course, joined);
        // On the way to rest nothing of the goal is promised.
        let holds = |it: &&Adjustment| arrives || it.reason == AdjustmentReason::FeedRateAboveLimit;
        AxisPlan {
            axis: name.clone(),
            kind: *kind,
            limits: limits.clone(),
            goal: if arrives { *goal } else { profile.end() },
            adjustments: adjustments.iter().filter(holds).cloned().collect(),
            classification: *classification,
            pvt_regions: pvt_regions.clone(),
            profile,
        }
    });
    // The third derivative of path time jumps.
    let kept = [Quantity::Velocity, Quantity::Acceleration, Quantity::Jerk];
    let guaranteed = kept.into_iter().filter(|&quantity| base.guarantees(quantity)).collect();
    Plan::new(base.method(), guaranteed, base.cycle_time(), axes.collect())?.made_by(base.maker().clone())
}
