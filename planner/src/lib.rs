//! Jerk-limited motion: from *where is it, where shall it go, what may it do* to a setpoint for every cycle.
//!
//! This page is a chapter: what a motion is, how to ask for one, which family to choose, how to read it cycle by cycle, how it is
//! proved, and what may be done to it under way. Every example runs. [The map](#the-map-in-the-order-in-which-to-read-it) at its end leads on.
//!
//! # What a motion is
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
//! Within a piece of jerk `j`, `t` seconds after it began in the state `p₀ v₀ a₀`,
//!
//! ```text
//! a = a₀ + j·t        v = v₀ + a₀·t + j·t²/2        p = p₀ + v₀·t + a₀·t²/2 + j·t³/6
//! ```
//!
//! A [`State`] is `p v a` at an instant, a [`Segment`] is one piece, and a [`Profile`] is pieces laid end to end, which join in
//! all three. A short path leaves pieces out, and so do speeds at the ends; which ones, and how long the others last, is what
//! [`plan_move`] solves. Other [families](#which-family) have pieces of higher degree ([`Law`]).
//!
//! # One axis, planned, sampled and judged
//!
//! [`Limits`] say what the axis may do, a [`Problem`] where it is and where it is to go. With `V A J` its limits, all of them
//! reached, a move of length `s` from rest to rest takes `s/V + V/A + A/J`:
//!
//! ```
//! use planner::{CycleTime, Limits, Problem, ShortPathPolicy, State, plan_move, violations};
//!
//! // 0.4 m from rest to rest, at 0.5 m/s, 2 m/s², 20 m/s³.
//! let limits = Limits::symmetric(0.5, 2.0, 20.0)?;
//! let problem = Problem::new(State::at_rest(0.1), State::at_rest(0.5), limits, ShortPathPolicy::Reject)?;
//! let planned = plan_move(&problem)?;
//! assert_eq!(planned.segments().len(), 7);
//! assert!((planned.duration() - 1.15).abs() < 1e-15); // 0.4/0.5 + 0.5/2 + 2/20
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
//! The last line asks the *judge*. It recomputes from the pieces alone what the motion reaches, and knows nothing of how they
//! were found.
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
//! A [`ShortPathPolicy`] says what gives way instead; what was asked, what is planned and why then stands in the plan, as an
//! [`Adjustment`].
//!
//! # Which family
//!
//! `d` is a change of speed, `s` a length; all from rest to rest unless it says otherwise.
//!
//! | family | when | law, or how long it takes | source |
//! |---|---|---|---|
//! | [S-curve](plan_move) | nearly always; between any velocities | a ramp takes `d/A + A/J`, or `2√(d/J)` where `d < A²/J` | Bui, Le and Doan (2021); Blejan and Blejan (2020) |
//! | asymmetric: the same, with [a deceleration of its own](LimitsSpec::max_deceleration) | an axis that brakes harder than it speeds up, or a load that tips | up with `A`, down with `D` | Li and Chen |
//! | [any state to any state](plan_between) | on the way already, accelerating already, or beyond its limits | two ramps and a cruise; one unknown, its velocity | our own; held against Berscheid and Kröger (2021) |
//! | [n-th order](plan_polynomial) | something swings; orders 2 to 8 | the velocity is a box averaged over n − 1 boxes, `T = F₁ + … + Fₙ` | Nguyen, Ng and Chen (2008), section 3 |
//! | [trigonometric](plan_trigonometric) | as smooth as order 5, without its limits | `j = J/2·(1 − cos 2πt/t_j)`: `A/J` longer than an S-curve | the same, section 5 |
//! | [trapezoid](plan_trapezoid) | the baseline: its jerk has no limit | `s/V + V/A`, or `2√(s/A)` where `s < V²/A` | Biagiotti and Melchiorri (2008), 3.2 |
//! | [through points](plan_pvt) | somebody else says where and when | between two extreme motions, by four regions | doi:10.1177/17298814211072418 (2022) |
//!
//! The repository's `docs/families/` has a page for each with a figure, and its `notes/` the derivations and the papers' misprints.
//!
//! # From any state
//!
//! An axis on its way is not at rest. [`plan_between`] gives the fastest motion between any two states, which may go past its goal
//! and come back; a start beyond its limits is led back first, as fast as can be.
//!
//! ```
//! use planner::{Limits, State, plan_between};
//!
//! let limits = Limits::symmetric(0.25, 3.0, 100.0)?;
//! let now = State { position: 0.0, velocity: 0.2, acceleration: 2.0 };
//! let back = plan_between(now, State::at_rest(0.01), &limits)?;
//! assert!(back.at(0.09).state.position > 0.01); // it cannot stop in 10 mm
//! assert_eq!(back.at(back.duration()).state, State::at_rest(0.01)); // to the last bit
//! # Ok::<(), planner::InvalidFields>(())
//! ```
//!
//! [`AxisTransfer`] asks for it in a given time, of which [`Arrivals`] says which there are.
//!
//! # Several axes
//!
//! A [`Request`] has one or more axes over one time base: each as fast as it can, all arriving together, or on a straight line
//! ([`Synchronization`]). [`Judged::answer`] plans and judges it. An [`Accepted`] plan has passed, and only such a one can be
//! executed. A [`Sampler`] reads it cycle by cycle:
//!
//! ```
//! use planner::{
//!     AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, Request, RequestSpec,
//!     ShortPathPolicy, State, Synchronization,
//! };
//!
//! let axis = |name: &str, goal: f64| AxisMoveSpec {
//!     axis: name.into(),
//!     kind: Ok(AxisKind::Prismatic),
//!     start: State::at_rest(0.0),
//!     goal: State::at_rest(goal),
//!     limits: LimitsSpec {
//!         max_velocity: 0.5,
//!         max_acceleration: 2.0,
//!         max_jerk: 20.0,
//!         ..LimitsSpec::default()
//!     },
//! };
//! let request = Request::try_from(RequestSpec {
//!     axes: vec![axis("x", 0.4), axis("y", -0.1)],
//!     cycle_time_ns: None, // 1 ms
//!     family: Ok(Family::SCurve),
//!     order: None,
//!     short_path: Ok(ShortPathPolicy::Reject),
//!     synchronization: Ok(Synchronization::Phase), // on a straight line
//!     minimum_duration: None,
//!     end_on_cycle: false,
//! })?;
//! let judged = Judged::answer(&request)?;
//! assert!(judged.certificate().passed());
//! assert_eq!(judged.explanation().critical_axis, "x"); // which holds the other back
//!
//! let plan = judged.accepted()?;
//! let mut sampler = plan.plan().sampler();
//! for cycle in 0..=plan.plan().cycle_count() {
//!     let at: Vec<f64> = sampler.at(cycle).map(|setpoint| setpoint.state.position).collect();
//!     assert!((at[0] + 4.0 * at[1]).abs() < 1e-12); // on the line, in every cycle
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Through points
//!
//! Where a camera or a table says *there, so fast, then*, [`PvtPlanner`] takes command by command and [`plan_pvt`] a whole list. Of each
//! point it tells what could have been reached, and what was not met:
//!
//! ```
//! use planner::{Limits, PvtPlanner, PvtPolicy, PvtTarget, State};
//!
//! let limits = Limits::symmetric(0.5, 4.0, 160.0)?;
//! let mut axis = PvtPlanner::new(State::at_rest(0.0), limits, PvtPolicy::PreferVelocity)?;
//! let met = axis.command(PvtTarget { position: 0.015, velocity: 0.15, duration: 0.2 })?;
//! assert!(met.motion().adjustments().is_empty());
//! assert!(met.least_displacement() < 0.015 && 0.015 < met.greatest_displacement());
//! # Ok::<(), planner::InvalidFields>(())
//! ```
//!
//! # In a control loop
//!
//! [`generator`] is the stepped form: a target whenever there is one, a setpoint every cycle, in `f32` or `f64`, without a heap.
//! [`grid`] has moves of whole cycles.
//!
//! # Under way
//!
//! A [`motion::Motion`] is an accepted plan on its way. Hold, resume, override, retarget, append and stop are *splices*: each begins
//! in the state that the motion has at its cycle, keeps the limits, and has been before the judge.
//!
//! ```
//! use planner::motion::{Motion, Operation, Override};
//! # use planner::{AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, Request, RequestSpec, ShortPathPolicy, State, Synchronization};
//! # let limits = LimitsSpec { max_velocity: 0.5, max_acceleration: 2.0, max_jerk: 20.0, ..LimitsSpec::default() };
//! # let x = AxisMoveSpec { axis: "x".into(), kind: Ok(AxisKind::Prismatic), start: State::at_rest(0.0), goal: State::at_rest(0.4), limits };
//! # let request = Request::try_from(RequestSpec {
//! #     axes: vec![x], cycle_time_ns: None, family: Ok(Family::SCurve), order: None, short_path: Ok(ShortPathPolicy::Reject),
//! #     synchronization: Ok(Synchronization::None), minimum_duration: None, end_on_cycle: false,
//! # })?;
//! let motion = Motion::open(Judged::answer(&request)?.accepted()?)?;
//! let slower = motion.splice(300, &Operation::Override(Override::new(0.5)?))?.motion;
//! assert_eq!(slower.state(0, 300), motion.state(0, 300)); // no jump
//! assert!(slower.last_cycle() > motion.last_cycle());
//! let held = slower.splice(500, &Operation::Hold)?;
//! assert_eq!(held.motion.state(0, held.rest_cycle).velocity, 0.0);
//! let resumed = held.motion.splice(held.rest_cycle, &Operation::Resume)?.motion;
//! assert_eq!(resumed.state(0, resumed.last_cycle()), State::at_rest(0.4));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What is proved
//!
//! [`certify`] shares no code with the solvers. From the pieces alone it takes each quantity's extremes (at the ends of pieces and
//! the zeros of derivatives inside them, never at samples), how well pieces meet, and how far the end is from the goal. A
//! [`Certificate`] has every check with its margin. What a plan promises is for its family to say: the trapezoid promises no jerk, a
//! cubic through points nothing; what is not promised is reported, and fails nothing. A limit is kept to [`LIMIT_TOLERANCE`] of
//! itself, joins and ends to [`JOIN_TOLERANCE`] of the motion's scale. [`explain`] says which limit held the motion back, and when.
//!
//! # The same bits everywhere
//!
//! The planner uses `+ − × ÷ √` in a fixed order, and one portable library for every other function. So a problem has the
//! same answer, bit for bit, on every replica and platform, with `std` and without; a setpoint depends on the plan and the cycle alone,
//! never on what was asked before. [`EVALUATION_VERSION`] names these bits.
//!
//! There is no I/O, no clock, no thread ([`Workers`] may lend some) and no randomness here, and [`plan_move`], [`plan_transfer`],
//! [`together()`] (into a list with room), [`PvtPlanner::command`], [`Move::at`], [`Cursor::at`] and [`Sampler::fill`] take nothing from
//! the heap.
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
    wrong_time,
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
