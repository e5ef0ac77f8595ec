//! The stepped form of a move, for a control loop: one setpoint per cycle, in `f32` or `f64`, and a new target at any of them.
//!
//! ```text
//!            set_target(0.05)                       set_target(0.0)
//!                  │                                      │
//! position         ▼        ╭───────────────────────      ▼
//!                         ╱                          ─────╮
//!             ──────────╯                                   ╲
//! cycle       0  0  0  0  1  2 …  313 314 314 314 314 314 0  1  2 …
//! step()      ·  ·  ·  ·  ↑  ↑      ↑  ↑   ·   ·   ·   ·     ↑  ↑       · stays where it is
//! is_done()   ────────────┐            ┌──────────────────┐
//!                         └────────────┘                  └─────────
//! ```
//!
//! A [`Generator`] knows its limits, its cycle and where it is. [`set_target`](Generator::set_target) solves the move: from rest in
//! closed form ([`Shape`], six cases), on the way as the fastest motion from the state of that cycle
//! ([`plan_transfer`]), which overshoots and turns back where that is faster. Either takes a few hundred
//! nanoseconds. Each [`step`](Generator::step) then evaluates one cubic. Nothing comes from the heap, and nothing is added up
//! from cycle to cycle: a setpoint depends on the move and the number of its cycle alone.
//!
//! ```
//! use planner::CycleTime;
//! use planner::generator::{AxisLimits, Generator};
//!
//! // 0.25 m/s, 3 m/s², 100 m/s³, a millisecond per cycle, in the width of the drive.
//! let limits = AxisLimits { velocity: 0.25_f32, acceleration: 3.0, jerk: 100.0 };
//! let mut generator = Generator::new(limits, CycleTime::MILLISECOND)?;
//! generator.set_target(0.05)?;
//! assert_eq!(generator.remaining_cycles(), 314); // 313.33 ms
//! assert_eq!(generator.case().map(|case| case.name()), Some("D.1"));
//!
//! while !generator.is_done() {
//!     let setpoint = generator.step();
//!     assert!(setpoint.velocity <= 0.25 && setpoint.acceleration.abs() <= 3.0);
//! }
//! assert_eq!(generator.position(), 0.05); // exactly
//!
//! // Somewhere else, and on the way there back again.
//! generator.set_target(1.0)?;
//! let before = (0..500).map(|_| generator.step()).last().unwrap_or_default();
//! generator.set_target(0.05)?;
//! assert_eq!(generator.setpoint().velocity, before.velocity); // as fast as before: it brakes from here
//! while !generator.is_done() {
//!     generator.step();
//! }
//! assert_eq!(generator.position(), 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Source, and what is different
//!
//! Blejan and Blejan: *Mathematics for real-time S-curve profile generator*, Hidraulica 4/2020, 7 to 25. The times t_j, t_a, t_v
//! and the names of the six cases are theirs. Their algorithm (their figure 7) then integrates: each cycle starts from the
//! state of the one before, under the jerk of that instant. So every switch comes up to a cycle late, and in `f32` a whole cycle
//! too late where 0.003/0.0001 is 30.000002: on 50 mm it ends 0.4 mm off in `f64` and 5.4 mm off in `f32`, still moving.
//! Here each piece is evaluated in closed form from its own start, the second half from the target backwards, and the switches lie
//! where they belong, between two cycles.
//!
//! Misprints that matter to a reader of both: in (53), `v·√(v/J)` is the distance of the whole ramp, the first jerk's is a
//! sixth of it; (86) and (87) have a factor of 2 too many, though (88) is right; the inequalities of section 3.2 leave out
//! equality, which the third example has; and the jerk vector of the fourth example ends at 50.0094 mm, not at the 50.41 mm
//! printed, which needs one cycle more.
//!
//! # Accuracy
//!
//! At every cycle, with ε that of the width (1.2e-7 or 2.2e-16):
//!
//! | what | within | measured in `f32`, 100 000 moves |
//! |---|---|---|
//! | position | 4 ε of the distance, and an ulp of the position | 0.9 |
//! | velocity | 8 ε of the peak velocity, and never beyond the limit | 1.7 |
//! | acceleration | 8 ε of the peak acceleration, and never beyond the limit | 4.1 |
//! | at the end | the target, without velocity and acceleration, to the last bit | |
//!
//! `f32` is measured against `f64` with the same limits, `f64` against 60 digits. It holds for motions of any length, an hour in
//! milliseconds too: the time of a piece is a whole number of cycles, and the instants are solved for in `f64` in either width.
//! Those have the roundings of a duration: the second half as a whole may be early or late by 2 ε (of `f64`) of the
//! duration, which is within the above for the position, and adds as much time's worth of jerk to the acceleration.
//!
//! From motion the same holds, with the farthest that the motion leads from its start or its target in place of the distance, and
//! four times as much for the position: on a piece that turns round, `v·t` and `a·t²/2` are larger than what is left of them.
//! It begins in the setpoint of its cycle as that was commanded, rounded to the width, so no rounding shows as a jump.

mod real;
mod schedule;
mod shape;

pub use real::Real;
pub use shape::Shape;

use crate::grid::WholeCycles;
use crate::{Bounds, CycleTime, SixCase, State, Transfer, Transit, plan_transfer};
use schedule::Schedule;
pub(crate) use shape::seen_from_the_end;

/// What an axis may do, alike in both directions, for speeding up and slowing down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisLimits<F> {
    /// Greatest speed [axis units/s], > 0.
    pub velocity: F,
    /// Greatest acceleration [axis units/s²], > 0.
    pub acceleration: F,
    /// Greatest jerk [axis units/s³], > 0.
    pub jerk: F,
}

/// The command for one cycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint<F> {
    /// Position [axis units].
    pub position: F,
    /// Velocity [axis units/s], signed.
    pub velocity: F,
    /// Acceleration [axis units/s²], signed.
    pub acceleration: F,
    /// Jerk from this instant on [axis units/s³].
    pub jerk: F,
}

impl<F: Real> Setpoint<F> {
    /// At rest at `position`.
    fn at_rest(position: F) -> Self {
        Self { position, velocity: F::ZERO, acceleration: F::ZERO, jerk: F::ZERO }
    }
}

/// A limit that a generator cannot work with.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{limit} is {given}: a limit is a magnitude from {least:e} to {greatest:e}; its sign is not needed")]
pub struct InvalidLimit {
    /// Which.
    pub limit: &'static str,
    /// The value.
    pub given: f64,
    /// The least that would do.
    pub least: f64,
    /// The greatest that would do.
    pub greatest: f64,
}

/// Why a position was not taken. The generator is as it was.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// The axis is on its way, and every switch of its moves is to be on a whole cycle: those are known from rest alone.
    #[error(
        "the axis is in motion, and a move that switches on whole cycles begins at rest: set the target \
         {remaining_cycles} cycles from now, or use a generator without that"
    )]
    InMotion {
        /// Steps until it is at rest.
        remaining_cycles: u64,
    },
    /// NaN, infinite, or too large to compute with.
    #[error("the position is {given}: give a finite number of at most {greatest:e} in magnitude")]
    NotFinite {
        /// The value.
        given: f64,
        /// The greatest magnitude that would do.
        greatest: f64,
    },
    /// The move lasts longer than cycles can be counted.
    #[error(
        "the move lasts {seconds:e} s, more cycles than can be counted: raise the limits or lengthen the cycle"
    )]
    TooManyCycles {
        /// The duration \[s\].
        seconds: f64,
    },
}

/// When a move may end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
enum Ending {
    /// As soon as it can: the last cycle is the first at or after the end.
    #[default]
    Soonest,
    /// On a cycle, as is every switch.
    OnWholeCycles,
}

/// One axis, one setpoint per cycle. See the [module](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Generator<F: Real> {
    limits: AxisLimits<F>,
    cycle_time: CycleTime,
    /// The same \[s\], to the nearest in this width.
    cycle_seconds: F,
    ending: Ending,
    shape: Option<Shape>,
    schedule: Schedule<F>,
    /// Where the move goes; where the axis is, if it is done.
    target: F,
    /// The present cycle, and that at which the move has ended.
    cycle: u64,
    end: u64,
}

impl<F: Real> Generator<F> {
    /// An axis that stands at zero.
    ///
    /// # Errors
    /// The first limit that is not positive, or beyond the width's range: 1e-60 to 1e60 for `f64`, 1e-30 to 1e30 for `f32`.
    pub fn new(limits: AxisLimits<F>, cycle_time: CycleTime) -> Result<Self, InvalidLimit> {
        let AxisLimits { velocity, acceleration, jerk } = limits;
        for (limit, given) in [("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)] {
            let (given, least, greatest) = (given.widen(), F::LEAST, F::GREATEST);
            if !(least..=greatest).contains(&given) {
                return Err(InvalidLimit { limit, given, least, greatest });
            }
        }
        Ok(Self {
            limits,
            cycle_time,
            cycle_seconds: F::round(cycle_time.as_seconds()),
            ending: Ending::default(),
            shape: None,
            schedule: Schedule::empty(),
            target: F::ZERO,
            cycle: 0,
            end: 0,
        })
    }

    /// The same, but every move switches and ends on a whole cycle, at a jerk that is a little lower: see [`grid`](crate::grid).
    ///
    /// A drive that integrates the jerk itself then ends where it should.
    #[must_use]
    pub fn on_whole_cycles(self) -> Self {
        Self { ending: Ending::OnWholeCycles, ..self }
    }

    /// The same, standing at `position` [axis units], with nothing to do.
    ///
    /// # Errors
    /// [`Refused::NotFinite`].
    pub fn standing_at(self, position: F) -> Result<Self, Refused> {
        let position = checked(position)?;
        Ok(Self { shape: None, schedule: Schedule::empty(), target: position, cycle: 0, end: 0, ..self })
    }

    /// Where to go next [axis units], at rest or on the way. The move begins now: the next [`step`](Self::step) is one cycle into
    /// it, and [`setpoint`](Self::setpoint) has the jerk with which it begins; position, velocity and acceleration stay what they
    /// are. On the way the same target again changes nothing.
    ///
    /// # Errors
    /// [`Refused`] for a target that is no position, for a move of more than 2⁵³ cycles, and in motion
    /// [`on_whole_cycles`](Self::on_whole_cycles).
    pub fn set_target(&mut self, target: F) -> Result<(), Refused> {
        let target = checked(target)?;
        if !self.is_done() && target == self.target {
            return Ok(());
        }
        let present = self.setpoint();
        if present == (Setpoint { jerk: present.jerk, ..Setpoint::at_rest(present.position) }) {
            self.depart(present.position, target)
        } else if self.ending == Ending::OnWholeCycles {
            Err(Refused::InMotion { remaining_cycles: self.remaining_cycles() })
        } else {
            self.divert(&present, target)
        }
    }

    /// From rest.
    fn depart(&mut self, start: F, target: F) -> Result<(), Refused> {
        let Some(shape) = self.shape_over(target.widen() - start.widen())? else {
            self.go(None, Schedule::empty(), target, 0);
            return Ok(());
        };
        let laid = Schedule::of(&shape, self.cycle_time, start, target);
        let (schedule, end) = laid.ok_or_else(|| Refused::TooManyCycles { seconds: shape.duration() })?;
        self.go(Some(shape), schedule, target, end);
        Ok(())
    }

    /// From motion.
    fn divert(&mut self, present: &Setpoint<F>, target: F) -> Result<(), Refused> {
        let transit =
            self.transit(present, target).ok_or(Refused::TooManyCycles { seconds: f64::INFINITY })?;
        let laid = Schedule::along(&transit, self.cycle_time, present.position, target);
        let (schedule, end) = laid.ok_or_else(|| Refused::TooManyCycles { seconds: transit.duration() })?;
        self.go(None, schedule, target, end);
        Ok(())
    }

    fn go(&mut self, shape: Option<Shape>, schedule: Schedule<F>, target: F, end: u64) {
        self.shape = shape;
        self.schedule = schedule;
        self.target = target;
        self.cycle = 0;
        self.end = end;
    }

    /// One cycle on: the setpoint for it. At the target it is the target, at rest, for ever.
    #[inline]
    pub fn step(&mut self) -> Setpoint<F> {
        if self.cycle < self.end {
            self.cycle += 1;
            self.schedule.advance(self.cycle);
        }
        self.setpoint()
    }

    /// The setpoint of the present cycle, once more.
    #[must_use]
    #[inline]
    pub fn setpoint(&self) -> Setpoint<F> {
        let due = self.schedule.at(self.cycle, self.cycle_seconds, &self.limits);
        due.unwrap_or_else(|| Setpoint::at_rest(self.target))
    }

    /// Where the axis is commanded to be [axis units].
    #[must_use]
    pub fn position(&self) -> F {
        self.setpoint().position
    }

    /// Where the axis goes, or stands [axis units].
    #[must_use]
    pub fn target(&self) -> F {
        self.target
    }

    /// At the target, and at rest?
    #[must_use]
    #[inline]
    pub fn is_done(&self) -> bool {
        self.cycle == self.end
    }

    /// How many steps until it is done.
    #[must_use]
    pub fn remaining_cycles(&self) -> u64 {
        self.end - self.cycle
    }

    /// Which of the six cases the move is, or was; `None` where there was nothing to go, and for a move from motion.
    #[must_use]
    pub fn case(&self) -> Option<SixCase> {
        self.shape.map(|shape| shape.case)
    }

    /// The move from rest in closed form; `None` where there was nothing to go, and for a move from motion.
    #[must_use]
    pub fn shape(&self) -> Option<&Shape> {
        self.shape.as_ref()
    }

    /// The fastest motion from `present` to rest at `target`, in `f64` in either width, seen from the target.
    ///
    /// `None` where the velocity limit vanishes against the distance, so that it would take for ever.
    fn transit(&self, present: &Setpoint<F>, target: F) -> Option<Transit> {
        let AxisLimits { velocity, acceleration, jerk } = self.wide_limits();
        let start = State {
            position: present.position.widen() - target.widen(),
            velocity: present.velocity.widen(),
            acceleration: present.acceleration.widen(),
        };
        let bounds = Bounds::symmetric(velocity, acceleration, jerk).ok()?;
        let transfer = Transfer::new(start, State::default(), bounds).ok()?;
        plan_transfer(&transfer).ok()
    }

    fn wide_limits(&self) -> AxisLimits<f64> {
        let AxisLimits { velocity, acceleration, jerk } = self.limits;
        AxisLimits { velocity: velocity.widen(), acceleration: acceleration.widen(), jerk: jerk.widen() }
    }

    /// The shape of a move, in `f64` in either width: it is solved once, and its times decide when a long move ends.
    fn shape_over(&self, distance: f64) -> Result<Option<Shape>, Refused> {
        let wide = self.wide_limits();
        let Some(fastest) = Shape::rest_to_rest(distance, &wide) else { return Ok(None) };
        match self.ending {
            Ending::Soonest => Ok(Some(fastest)),
            Ending::OnWholeCycles => {
                let whole = WholeCycles::over(distance, &fastest, &wide, self.cycle_time);
                let seconds = fastest.duration();
                whole.map(|whole| Some(*whole.shape())).ok_or(Refused::TooManyCycles { seconds })
            }
        }
    }
}

/// `position`, if it is one.
fn checked<F: Real>(position: F) -> Result<F, Refused> {
    let (given, greatest) = (position.widen(), F::GREATEST);
    let fits = given.abs() <= greatest;
    if fits { Ok(position) } else { Err(Refused::NotFinite { given, greatest }) }
}
