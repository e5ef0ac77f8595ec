//! Jerk-limited motion: from *where is it, where shall it go, what may it do* to a setpoint for every cycle.
//!
//! An axis that changes its acceleration at once shakes the machine that it moves. So acceleration may only grow as fast
//! as the jerk limit lets it, and the fastest motion is then made of pieces of constant jerk, at most seven of them:
//!
//! ```text
//! velocity      │            ╭────────╮             ← limit of velocity
//!               │          ╱            ╲
//!               │       ╱                  ╲
//!               ├───╯──────────────────────────╰──── t
//! acceleration  │    ╭────╮                         ← limit of acceleration
//!               │  ╱        ╲
//!               ├╱────────────╲────────╲────────╱─── t
//!               │                        ╲    ╱
//!               │                         ╰──╯      ← limit of deceleration
//! jerk            +     0    −     0    −   0   +
//! piece           1     2    3     4    5   6   7
//! ```
//!
//! A short path leaves pieces out, and so do speeds at the ends; which ones, and how long the others last, is what
//! [`plan_move`] solves. [`certify`] then says whether it did: it recomputes from the pieces alone what the motion
//! reaches, and knows nothing of how they were found.
//!
//! # One axis
//!
//! ```
//! use planner::{CycleTime, Limits, Problem, ShortPathPolicy, State, plan_move, violations};
//!
//! // 0.4 m from rest to rest, at 0.5 m/s, 2 m/s², 20 m/s³.
//! let limits = Limits::symmetric(0.5, 2.0, 20.0)?;
//! let problem = Problem::new(State::at_rest(0.1), State::at_rest(0.5), limits, ShortPathPolicy::Reject)?;
//! let planned = plan_move(&problem)?;
//! assert_eq!(planned.segments().len(), 7);
//! assert!((planned.duration() - 1.15).abs() < 1e-15); // s/v + v/a + a/j
//!
//! // What a drive is sent every millisecond.
//! let cycle = CycleTime::MILLISECOND;
//! for number in 0..=cycle.count(planned.duration()).unwrap_or_default() {
//!     let setpoint = planned.at(cycle.start_of(number));
//!     assert!(setpoint.state.velocity <= 0.5 * (1.0 + 1e-12));
//! }
//!
//! // And a second opinion.
//! assert_eq!(violations(&planned.to_profile(), problem.limits(), problem.goal()), []);
//! # Ok::<(), planner::InvalidFields>(())
//! ```
//!
//! # What cannot be done is refused
//!
//! With everything that is wrong, where it is, and the way out; in a text for people, and in numbers for programs:
//!
//! ```
//! use planner::{Limits, Problem, ShortPathPolicy, State, Why, plan_move};
//!
//! let limits = Limits::symmetric(0.5, 2.0, 20.0)?;
//! let at_speed = State { velocity: 0.5, ..State::at_rest(0.01) };
//! let problem = Problem::new(State::at_rest(0.0), at_speed, limits, ShortPathPolicy::Reject)?;
//! let refusal = plan_move(&problem).unwrap_err();
//! assert_eq!(
//!     refusal.to_string(),
//!     "goal.velocity: the path of 0.01 is too short to change from the start to the end velocity, which needs 0.0875: \
//!      lengthen it, end at a velocity of 0.12599210498948732, or name a short_path_policy"
//! );
//! assert!(matches!(refusal.as_slice()[0].why, Why::PathTooShort { .. }));
//! # Ok::<(), planner::InvalidFields>(())
//! ```
//!
//! # Notation, units, signs
//!
//! - Lengths are in *axis units*: metres, radians or pulses, whatever the caller moves in. All else follows: velocity in
//!   axis units/s, acceleration in /s², jerk in /s³; time in seconds, [`CycleTime`] in nanoseconds. No tolerance is
//!   absolute, so every unit is as good as another.
//! - In formulas `p v a j t` are position, velocity, acceleration, jerk and time, `s` a length, `d` a change of speed.
//!   `A` and `J` are the limits.
//! - A [`State`] is signed. [`Limits`] are magnitudes: *acceleration* limits the growth of the speed and *deceleration*
//!   its shrinking, in either direction.
//! - A *setpoint* is the command for one cycle: a state, and the jerk that leads on from it. *Feed rate* is the speed that
//!   is asked for along the way. A motion is *legal* if it keeps the limits, its pieces join and it arrives.
//! - Numbers reach from [`LEAST_LIMIT`] to [`GREATEST_MAGNITUDE`]. What is given is checked once, where it comes in
//!   ([`Limits`], [`Problem`], [`Request`]); everything that is wrong with it is said at once, field by field
//!   ([`InvalidFields`]).
//!
//! # The map, in the order in which to read it
//!
//! 1. [`State`], [`Segment`], [`Profile`]: where an axis is; one piece; pieces laid end to end. [`State::after`] is the
//!    one place where the cubic is written.
//! 2. [`Limits`], [`Problem`]: what may be asked. [`ShortPathPolicy`]: what to give up on a path too short.
//! 3. [`plan_move`], [`Move`]: from a problem to its pieces, on the stack. Inside: the ramp between two speeds, the peak
//!    above both, the nearest speed that a short path can reach. [`Classification`] names the shape as the papers do.
//! 4. The same question for other shapes: [`plan_trapezoid`] is the baseline, constant acceleration and no limit on the
//!    jerk; [`plan_polynomial`] and [`plan_trigonometric`] are smoother, from rest to rest.
//!    [`plan_transfer`], [`Transit`]: the fastest motion between any two states, with accelerations at the ends and from
//!    beyond the limits, which may overshoot and turn back. [`plan_between`]: the same within [`Limits`].
//!    [`AxisTransfer`], [`Arrivals`]: in a given time, and in which there is no motion. [`together()`]: several axes so, at one time
//!    or on a straight line.
//! 5. [`Request`], [`plan()`], [`Plan`], [`Sampler`]: several axes over one time base, read cycle by cycle.
//! 6. [`PvtPlanner`], [`PvtRequest`], [`plan_pvt`]: position, velocity and time together, a command at a time or point
//!    after point; [`PvtPolicy`]: what to give up where they cannot all be met.
//! 7. [`certify`], [`violations`], [`Certificate`]: the judge. [`explain`]: which limit held the motion back, when.
//!    [`Judged`], [`Accepted`]: a plan with both, and one that may be executed. [`MoveSeries`]: many moves of one axis, each for a fraction of that.
//! 8. [`generator`], [`grid`]: without a plan. The stepped form for a control loop, and moves of whole cycles.
//! 9. [`motion`]: a plan under way, and what may be done to it: hold, resume, override, retarget, stop.
//! 10. [`retime`], [`TimeLaw`], [`Retiming`]: a plan on its way held, slowed or resumed, all axes together and on their
//!     path.
//!
//! The derivations and the decisions are in the repository's `notes/`, the laws that hold for every problem in
//! `tests/laws.rs`.
//!
//! # Features
//!
//! - `std` (default): takes square roots in hardware. Without it the crate needs `alloc` alone, and gives the same bits.
//!
//! There is no I/O, no clock, no thread ([`Workers`] may lend some) and no randomness here, and [`plan_move`], [`plan_transfer`], [`together()`] (into a list with room), [`PvtPlanner::command`],
//! [`Move::at`], [`Cursor::at`] and [`Sampler::columns`] take nothing from the heap.
#![cfg_attr(not(feature = "std"), no_std)]

extern crate alloc;

mod answer;
mod certified;
mod classify;
mod cosine;
mod cycle;
mod derivatives;
mod error;
mod explain;
mod float;
pub mod generator;
pub mod grid;
mod limits;
pub mod motion;
mod passage;
mod plan;
mod polynomial;
mod problem;
mod profile;
mod pvt;
mod quantity;
mod request;
mod retime;
mod roots;
mod segment;
mod segments;
mod series;
mod short_path;
mod shortest;
mod solve;
mod state;
mod together;
mod transfer;
mod trigonometric;
mod twofold;
mod verify;
mod workers;

pub use answer::{classified_again, plan};
pub use certified::{Accepted, Judged, JudgedPvt, Rejection};
pub use classify::{AsymmetricType, Classification, EightType, SixCase};
pub use cycle::{CycleTime, LAST_CYCLE};
pub use derivatives::{Derivatives, MAX_DEGREE};
pub use error::{Field, InvalidField, InvalidFields, Why};
pub use explain::{Binding, Explanation, explain};
pub use limits::{GREATEST_MAGNITUDE, LEAST_LIMIT, Limits, LimitsSpec, MAX_ORDER};
pub use passage::Passage;
pub use plan::{AxisPlan, Maker, Method, Plan, Sampler};
pub use polynomial::{PolynomialMove, plan_polynomial};
pub use problem::Problem;
pub use profile::{Cursor, Profile};
pub use pvt::{
    PvtAxis, PvtAxisSpec, PvtInterpolation, PvtMethod, PvtMove, PvtOffers, PvtPlan, PvtPlanner,
    PvtPointReport, PvtPolicy, PvtRegion, PvtRequest, PvtRequestSpec, PvtTarget, plan_pvt, plan_pvt_by,
};
pub use quantity::Quantity;
pub use request::{
    AxisKind, AxisMove, AxisMoveSpec, AxisProblem, Family, MAX_AXES, MAX_NAME_BYTES, Request, RequestSpec,
    Synchronization, wrong_name,
};
pub use retime::{RetimeError, Retiming, TimeLaw, greatest_factor, retime};
pub use segment::{Law, MAX_TURNING_POINTS, Segment, Setpoint};
pub use segments::{Segments, SegmentsIter};
pub use series::{MoveSeries, SeriesError, SeriesMove};
pub use short_path::ShortPathPolicy;
pub use shortest::Shortest;
pub use solve::{Adjustment, AdjustmentReason, MAX_PIECES, Move, plan_move, plan_stop, plan_trapezoid};
pub use state::State;
pub use together::{Timing, Together, together};
pub use transfer::{
    Arrivals, AxisTransfer, Blocked, Bounds, BoundsSpec, LONGEST, MAX_BLOCKED, MAX_TRANSIT_PIECES,
    NoSuchDuration, Transfer, Transit, plan_between, plan_transfer, plan_velocity,
};
pub use trigonometric::plan_trigonometric;
pub use verify::{
    Certificate, EndCheck, JOIN_TOLERANCE, JoinCheck, LIMIT_TOLERANCE, LimitCheck, Reversal, Violation,
    certify, certify_against, certify_by, transfer_violations, violations,
};
pub use workers::{Alone, Workers};

/// Names the bits that a plan samples to: replicas with the same number give the same setpoints for the same plan.
///
/// It changes only when they do; a replica evaluates this version and the one before.
pub const EVALUATION_VERSION: u32 = 1;

/// The versions whose bits this planner gives.
pub const EVALUATION_VERSIONS: core::ops::RangeInclusive<u32> = 1..=EVALUATION_VERSION;
