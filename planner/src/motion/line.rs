//! Axes that keep to a straight line: planned anew as one motion along it.
//!
//! ```text
//! position of axis i = from_i + (u − u_from)·ratio_i        u: the position of one axis, seen so that the line
//!                                                              goes forward
//! ```
//!
//! Velocity, acceleration and jerk are the line's times the ratio, so the line's limits are the tightest of `limit_i / |ratio_i|`. Where
//! a ratio is negative, forward is the axis's way back.

use alloc::vec::Vec;

use super::Refused;
use super::each::{self, AS_FAST, Planned, axis_plan};
use super::errand::{Errand, UnderWay};
use super::leg::{Leg, Turning, adjustments};
use super::prove::{Objection, Proved, prove};
use crate::error::{Field, InvalidFields, Why};
use crate::float::{largest, least};
use crate::{Accepted, AxisPlan, Law, Limits, LimitsSpec, Plan, Profile, Quantity, Segment, State};

/// Of the line's length \[1\]: how far a goal may be beside the line, which is then as straight as the judge lets pieces join.
const GOAL_BESIDE: f64 = 1e-11;
/// Of the line's length, and of the limits \[1\]: how far a motion may be beside its line. This is for plans that are said to keep to a line
/// and do not, so it leaves room for all that is rounding.
const STATE_BESIDE: f64 = 1e-6;
/// Units in the last place of the positions: what they may be beside the line besides.
const POSITION_ULPS: f64 = 8.0;

/// What becomes of axes on a straight line; none where they go on as they do. `drawn` is a plan along the same line as the one that
/// is under way.
pub(super) fn planned(under_way: &UnderWay<'_>, drawn: &Plan) -> Result<Option<Planned>, Refused> {
    if let Errand::Goals { kept, .. } = under_way.errand
        && kept.iter().all(|&kept| kept)
    {
        return Ok(None);
    }
    let Some(line) = Line::under(under_way, drawn)? else {
        // Nothing is to move, and each by itself does not.
        return each::planned(under_way);
    };
    let aims = under_way.aims;
    let starts: Vec<State> = (0..aims.len()).map(|axis| under_way.state(axis)).collect();
    line.check(aims, &starts, STATE_BESIDE)?;
    let Some(course) = line.course(under_way, &starts)? else { return Ok(None) };
    let proved = course.proved(&line, under_way, &starts)?;
    let closes = course.leg.closing.map(|_| course.leg.arrives());
    Ok(Some(Planned { proved, closes }))
}

/// A plan from rest to the aims, by which the line that the motion keeps can be drawn again; none where the aims are not on it.
pub(super) fn drawn_to(under_way: &UnderWay<'_>, drawn: &Plan) -> Result<Accepted, Refused> {
    let Some(line) = Line::under(under_way, drawn)? else { return Err(nowhere()) };
    let aims = under_way.aims;
    let goal = line.along(aims[line.reference].goal);
    let now = line.along(under_way.state(line.reference)).position;
    // From as far as the line is known, so that it is known as well as it was; but not from out of range, if there is a choice.
    let mut from = [line.origin, line.origin + line.length, now];
    from.sort_unstable_by(|a, b| (b - goal.position).abs().total_cmp(&(a - goal.position).abs()));
    let errand = Errand::Goals { factor: super::Override::FULL, turning: Turning::Allowed, kept: &[] };
    let mut refused = nowhere();
    for from in from {
        let starts: Vec<State> =
            (0..aims.len()).map(|axis| State::at_rest(line.position(axis, from))).collect();
        let under_way = UnderWay { errand, ..*under_way };
        let Some(course) = line.course(&under_way, &starts)? else { continue };
        match course.proved(&line, &under_way, &starts) {
            Ok(proved) => return Ok(proved.plan),
            Err(objection) => refused = objection.into(),
        }
    }
    Err(refused)
}

/// Are the axes on their line where `rests` ends?
pub(super) fn is_kept(under_way: &UnderWay<'_>, drawn: &Plan, rests: &Plan) -> bool {
    let ends: Vec<State> = rests.axes().iter().map(|axis| axis.profile.end()).collect();
    match Line::under(under_way, drawn) {
        Ok(Some(line)) => line.check(under_way.aims, &ends, STATE_BESIDE).is_ok(),
        // Nothing is to move.
        Ok(None) => true,
        Err(_) => false,
    }
}

/// As [`Plan::with_closing_stop`], with all axes on their line until they rest.
pub(super) fn with_closing_stop(plan: &Plan) -> Result<Option<(Plan, u64)>, Refused> {
    if plan.ends_at_rest() {
        return Ok(None);
    }
    let axes = plan.axes();
    let ends: Vec<State> = axes.iter().map(|axis| axis.profile.end()).collect();
    let magnitudes: Vec<f64> = ends.iter().map(|end| end.position.abs()).collect();
    let Some(line) = Line::through(plan, &magnitudes) else { return Ok(plan.with_closing_stop()?) };
    line.check(axes, &ends, STATE_BESIDE)?;
    let limits: Vec<Limits> = axes.iter().map(|axis| axis.limits.scaled(1.0)).collect();
    let limits = line.limits(&limits)?;
    let leg = Leg::to_rest(line.along(ends[line.reference]), &limits)?;
    let course = Course { leg, limits, goals: None };
    let closed = axes.iter().zip(&ends).enumerate().map(|(index, (axis, &end))| {
        let stop = course.along(&line, index, end, None);
        axis.stopped_by(&stop)
    });
    let closed = Plan::new(plan.method(), plan.guaranteed().to_vec(), plan.cycle_time(), closed.collect())?;
    Ok(Some((closed.made_by(plan.maker().clone())?, plan.cycle_count())))
}

fn nowhere() -> Refused {
    let what = "an operation in the middle of a straight line that ends where it begins";
    Refused::not_implemented(what, "stop, and begin anew at rest")
}

/// A straight line through the space of the axes.
#[derive(Clone, Debug)]
struct Line {
    /// The axis by which the way is counted: the one whose way has most digits.
    reference: usize,
    /// −1 where that goes back.
    sign: f64,
    /// The way at the point from which the axes count.
    origin: f64,
    /// From there to the other point that the line was drawn through.
    length: f64,
    axes: Vec<OnLine>,
}

/// One axis on the line.
#[derive(Clone, Copy, Debug)]
struct OnLine {
    from: f64,
    ratio: f64,
}

/// One motion along a line.
#[derive(Debug)]
struct Course {
    leg: Leg,
    /// Of the line.
    limits: Limits,
    /// The goal along the line as it was asked for, and as an override scales it; none on the way to rest.
    goals: Option<(State, State)>,
}

impl Line {
    /// The line that is kept: from rest straight to the goals; under way the one that was drawn. None where there is nowhere to go.
    fn under(under_way: &UnderWay<'_>, drawn: &Plan) -> Result<Option<Self>, Refused> {
        let aims = under_way.aims;
        let magnitudes = |(axis, aim): (usize, &AxisPlan)| {
            let here = under_way.state(axis).position.abs();
            match under_way.errand {
                Errand::Rest => here,
                Errand::Goals { .. } => largest(here, aim.goal.position.abs()),
            }
        };
        let magnitudes: Vec<f64> = aims.iter().enumerate().map(magnitudes).collect();
        if under_way.is_at_rest() {
            if matches!(under_way.errand, Errand::Rest) {
                return Ok(None);
            }
            let from = |axis: usize| under_way.state(axis).position;
            let towards = |axis: usize| aims[axis].goal.position - from(axis);
            // A goal at speed where the axes are is passed in its own direction.
            let passing = |axis: usize| aims[axis].goal.velocity;
            let line = Self::drawn(&magnitudes, from, towards);
            return Ok(line.or_else(|| Self::drawn(&magnitudes, from, passing)));
        }
        let lines =
            [drawn, under_way.plan].map(|plan| Self::through(plan, &magnitudes)).into_iter().flatten();
        let longest = lines.reduce(|one, other| {
            let length = other.length * other.axes[one.reference].ratio.abs();
            if length > one.length { other } else { one }
        });
        longest.map(Some).ok_or_else(nowhere)
    }

    /// From where a plan begins to where it ends; none where that is one point.
    fn through(plan: &Plan, magnitudes: &[f64]) -> Option<Self> {
        let from = |axis: usize| plan.axes()[axis].profile.start().position;
        let towards = |axis: usize| plan.axes()[axis].profile.end().position - from(axis);
        Self::drawn(magnitudes, from, towards)
    }

    /// Through `from` in the direction `towards`; none where that has no direction.
    ///
    /// `magnitudes` are those of the positions that are gone through: what the reference's position is rounded to is rounding to the
    /// others too, in proportion.
    fn drawn(
        magnitudes: &[f64],
        from: impl Fn(usize) -> f64,
        towards: impl Fn(usize) -> f64,
    ) -> Option<Self> {
        let digits = |axis: usize| towards(axis).abs() / magnitudes[axis];
        let moving = (0..magnitudes.len()).filter(|&axis| towards(axis) != 0.0);
        let reference = moving.max_by(|&one, &other| digits(one).total_cmp(&digits(other)))?;
        let length = towards(reference).abs();
        let sign = if towards(reference) < 0.0 { -1.0 } else { 1.0 };
        let on_line = |axis| OnLine { from: from(axis), ratio: towards(axis) / length };
        Some(Self {
            reference,
            sign,
            origin: sign * from(reference),
            length,
            axes: (0..magnitudes.len()).map(on_line).collect(),
        })
    }

    /// The state of the reference axis as one along the line.
    fn along(&self, reference: State) -> State {
        if self.sign < 0.0 { reference.mirrored().with_positive_zeros() } else { reference }
    }

    fn position(&self, axis: usize, along: f64) -> f64 {
        let OnLine { from, ratio } = self.axes[axis];
        if axis == self.reference { self.sign * along } else { from + (along - self.origin) * ratio }
    }

    fn state(&self, axis: usize, along: State) -> State {
        let OnLine { ratio, .. } = self.axes[axis];
        State {
            position: self.position(axis, along.position),
            velocity: ratio * along.velocity,
            acceleration: ratio * along.acceleration,
        }
        .with_positive_zeros()
    }

    /// Are all of `states`, one of each axis, the same state along the line?
    fn check(&self, aims: &[AxisPlan], states: &[State], beside: f64) -> Result<(), Refused> {
        let along = self.along(states[self.reference]);
        for (axis, (aim, state)) in aims.iter().zip(states).enumerate() {
            let on_line = self.state(axis, along);
            let OnLine { from, ratio } = self.axes[axis];
            let length = self.length * ratio.abs();
            let farthest = largest(length, (state.position - from).abs());
            // Farther than the line was drawn, its roundings are farther apart.
            let beyond = if length > 0.0 { farthest / length } else { 1.0 };
            let rounded = largest(state.position.abs(), from.abs()) + (ratio * along.position).abs();
            let rounding = POSITION_ULPS * f64::EPSILON * rounded * beyond;
            let parts = [
                (Quantity::Position, state.position, on_line.position, beside * farthest + rounding),
                (
                    Quantity::Velocity,
                    state.velocity,
                    on_line.velocity,
                    beside * largest(aim.limits.velocity_forward(), state.velocity.abs()),
                ),
                (
                    Quantity::Acceleration,
                    state.acceleration,
                    on_line.acceleration,
                    beside * largest(aim.limits.acceleration(), state.acceleration.abs()),
                ),
            ];
            for (quantity, given, nearest, allowed) in parts {
                if (given - nearest).abs() > allowed {
                    return Err(Refused::OffLine { axis: aim.axis.clone(), quantity, given, nearest });
                }
            }
        }
        Ok(())
    }

    /// The tightest limits along the line, of `limits` that are an override's already.
    fn limits(&self, limits: &[Limits]) -> Result<Limits, InvalidFields> {
        let mut spec = LimitsSpec {
            max_velocity: f64::INFINITY,
            max_velocity_reverse: Some(f64::INFINITY),
            max_acceleration: f64::INFINITY,
            max_deceleration: Some(f64::INFINITY),
            max_jerk: f64::INFINITY,
            ..LimitsSpec::default()
        };
        for (index, (limits, &OnLine { from, ratio })) in limits.iter().zip(&self.axes).enumerate() {
            if ratio == 0.0 {
                continue;
            }
            let size = ratio.abs();
            let lower = |limit: f64, other: f64| least(limit, other / size);
            spec.max_velocity = lower(spec.max_velocity, limits.velocity_towards(ratio));
            spec.max_velocity_reverse =
                spec.max_velocity_reverse.map(|limit| lower(limit, limits.velocity_towards(-ratio)));
            spec.max_acceleration = lower(spec.max_acceleration, limits.acceleration());
            spec.max_deceleration = spec.max_deceleration.map(|limit| lower(limit, limits.deceleration()));
            spec.max_jerk = lower(spec.max_jerk, limits.jerk());
            if spec.max_velocity == 0.0 {
                let (given, allowed) = (from + ratio * self.length, from);
                let why = Why::GoalOutsideLimits { given, allowed, limit: "limits.max_velocity_reverse" };
                let field = Field::named("goal.position").within(&Field::element("axes", index));
                return Err(InvalidFields::one(field, why));
            }
        }
        Limits::try_from(spec)
    }

    /// An axis's share of the line's limits.
    fn share(&self, axis: usize, limits: &Limits) -> Result<Limits, InvalidFields> {
        let OnLine { ratio, .. } = self.axes[axis];
        let share = |limit: f64| limit * ratio.abs();
        LimitsSpec {
            max_velocity: share(limits.velocity_towards(ratio)),
            max_velocity_reverse: Some(share(limits.velocity_towards(-ratio))),
            max_acceleration: share(limits.acceleration()),
            max_deceleration: Some(share(limits.deceleration())),
            max_jerk: share(limits.jerk()),
            ..LimitsSpec::default()
        }
        .try_into()
    }

    /// The motion along the line from `starts`; none where it already does what it is asked for.
    fn course(&self, under_way: &UnderWay<'_>, starts: &[State]) -> Result<Option<Course>, Refused> {
        let UnderWay { aims, errand, plan, at } = *under_way;
        let start = self.along(starts[self.reference]);
        let limits_at = |factor: f64| {
            let limits: Vec<Limits> = aims.iter().map(|aim| aim.limits.scaled(factor)).collect();
            self.limits(&limits)
        };
        match errand {
            Errand::Rest => {
                let limits = limits_at(1.0)?;
                let leg = Leg::to_rest(start, &limits)?;
                let stops_already = plan.duration() - at <= leg.profile.duration() * (1.0 + AS_FAST);
                Ok((!stops_already).then_some(Course { leg, limits, goals: None }))
            }
            Errand::Goals { factor, turning, .. } => {
                let goals: Vec<State> = aims.iter().map(|aim| aim.goal).collect();
                self.check(aims, &goals, GOAL_BESIDE)?;
                let limits = limits_at(factor.get())?;
                let asked = self.along(goals[self.reference]);
                let scaled = factor.at_goal(asked, &limits);
                let leg = Leg::to_goal(start, scaled, &limits, turning)?;
                Ok(leg.map(|leg| Course { leg, limits, goals: Some((asked, scaled)) }))
            }
        }
    }
}

/// How the axes go the motion along the line.
///
/// What is left of a motion may be so little that the roundings of the whole are too large for the judge. Then each axis goes it by itself,
/// within its share of the line's limits, which is the same motion but for roundings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Manner {
    Line,
    Shares,
    SharesThroughRest,
}

impl Course {
    /// In the first manner that the judge has nothing against.
    fn proved(&self, line: &Line, under_way: &UnderWay<'_>, starts: &[State]) -> Result<Proved, Objection> {
        for manner in [Manner::Line, Manner::Shares] {
            match prove(under_way, self.lay(line, under_way.aims, starts, manner)?) {
                Err(Objection::Rejected(_)) => {}
                other => return other,
            }
        }
        prove(under_way, self.lay(line, under_way.aims, starts, Manner::SharesThroughRest)?)
    }

    fn lay(
        &self,
        line: &Line,
        aims: &[AxisPlan],
        starts: &[State],
        manner: Manner,
    ) -> Result<Vec<AxisPlan>, InvalidFields> {
        let axes = aims.iter().zip(starts).enumerate();
        axes.map(|(axis, (aim, &start))| self.lay_axis(line, axis, aim, start, manner)).collect()
    }

    fn lay_axis(
        &self,
        line: &Line,
        axis: usize,
        aim: &AxisPlan,
        start: State,
        manner: Manner,
    ) -> Result<AxisPlan, InvalidFields> {
        // To the last bit what was asked for, where it is what is planned.
        let of_axis = |asked: State, planned: State| {
            if planned == asked {
                aim.goal
            } else {
                State { position: aim.goal.position, ..line.state(axis, planned) }
            }
        };
        let reached = self.goals.map(|(asked, _)| of_axis(asked, self.leg.reached));
        // Where the line is where it is to be, another axis may be beside that by a rounding.
        let manner = match manner {
            Manner::Line if self.leg.profile.segments().is_empty() => Manner::Shares,
            manner => manner,
        };
        let shares = || line.share(axis, &self.limits);
        let profile = match (manner, reached) {
            (_, _) if line.axes[axis].ratio == 0.0 => Profile::new(Vec::new(), start),
            (Manner::Line, _) => self.along(line, axis, start, reached),
            (Manner::Shares | Manner::SharesThroughRest, None) => Leg::to_rest(start, &shares()?)?.profile,
            (Manner::Shares, Some(goal)) => Leg::fastest(start, goal, &shares()?)?.profile,
            (Manner::SharesThroughRest, Some(goal)) => Leg::through_rest(start, goal, &shares()?)?.profile,
        };
        let end = profile.end();
        Ok(match (self.goals, reached) {
            (Some((asked, scaled)), Some(reached)) => {
                let said = adjustments(&aim.limits, start, [aim.goal, of_axis(asked, scaled), reached, end]);
                axis_plan(aim, profile, aim.goal, said)
            }
            _ => axis_plan(aim, profile, end, Vec::new()),
        })
    }

    /// The line's motion as that of one axis, from exactly `start`, by exactly `reached` where there is a goal, and through its closing stop.
    ///
    /// Positions count from the nearer of both, so that they are rounded as these are, wherever the line was drawn from.
    fn along(&self, line: &Line, axis: usize, start: State, reached: Option<State>) -> Profile {
        let OnLine { ratio, .. } = line.axes[axis];
        let Leg { profile, closing, reached: goes_to, .. } = &self.leg;
        let (begins, ends) = (profile.start().position, goes_to.position);
        let state = |along: State| {
            let from_start = along.position - begins;
            let from_end = along.position - ends;
            let position = match reached {
                Some(end) if from_end.abs() < from_start.abs() => end.position + from_end * ratio,
                _ => start.position + from_start * ratio,
            };
            State { position, ..line.state(axis, along) }
        };
        let passed = reached.unwrap_or_else(|| state(*goes_to));
        let segments = profile.segments().iter().enumerate();
        let segments = segments.map(|(index, segment)| {
            let start = match index {
                _ if Some(index) == *closing => passed,
                0 => start,
                _ => state(segment.start),
            };
            // A leg is of constant jerk throughout.
            let law = Law::ConstantJerk(ratio * segment.at(0.0).jerk + 0.0);
            Segment { duration: segment.duration, start, law }
        });
        let end = if closing.is_some() { state(profile.end()) } else { passed };
        Profile::new(segments, end)
    }
}
