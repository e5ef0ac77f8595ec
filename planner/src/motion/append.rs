//! Further points of a motion through points.
//!
//! ```text
//! v │      ╭──╮   last point            The motion through the old points stays as it is. Where its closing stop would begin, or where
//!   │   ╭──╯  ╰──●╌╌╌╮ closing stop     it would rest, it goes on through the new ones, and stops after those, if they end at speed.
//!   │  ╱         ╲   ╲                  What the last command left unreached the next one makes up, for positions are absolute.
//!   │ ╱           ╲__●___ new point
//!   └──────────────────── t
//! ```

use alloc::string::String;
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::errand::{closing_begins, state_at};
use super::path::Running;
use super::{Motion, Phase, Refused, Spliced};
use crate::error::{Field, InvalidFields, Why};
use crate::float::largest;
use crate::pvt::{PvtAxisSpec, PvtRequest, PvtRequestSpec, plan_pvt};
use crate::{AxisPlan, Classification, CycleTime, Judged, Law, Plan, Profile, PvtMethod, Segment, State};

/// Points to go on through.
#[derive(Clone, Debug, PartialEq)]
pub struct Points {
    /// Those of every axis of the motion, in any order.
    pub axes: Vec<AxisPoints>,
    /// Does the motion end at the last of them? Then that is at rest, and is gone on to where it was not reached in time.
    pub last: bool,
}

/// Points of one axis.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisPoints {
    /// The axis.
    pub axis: String,
    /// When each is to be met \[s\] after the last point that the motion has so far, > 0 and increasing; the same for all axes.
    pub times: Vec<f64>,
    /// Where it is to be at each of these times [axis units].
    pub positions: Vec<f64>,
    /// How fast it is to be there [axis units/s].
    pub velocities: Vec<f64>,
}

/// Of a time \[1\]: what sums of durations are rounded to.
const ROUNDED: f64 = 1e-12;

impl Motion {
    pub(super) fn append(&self, at_cycle: u64, phase: Phase, points: &Points) -> Result<Spliced, Refused> {
        let Some(Running { base, law }) = self.running() else { return Err(Refused::NotThroughPoints) };
        let Some(pvt) = base.plan().method().pvt else { return Err(Refused::NotThroughPoints) };
        let old = base.plan();
        let until = ends_at(old);
        let kept = self.is_kept_at_rest();
        let at = self.time_of(at_cycle).min(law.profile().duration());
        let closing_from_cycle = self.closing_from_cycle.unwrap_or(self.last_cycle());
        let closes = !kept && at_cycle >= closing_from_cycle;
        if phase == Phase::Standstill || closes || law.at(at).position >= until {
            return Err(Refused::AppendTooLate { closing_from_cycle });
        }
        let more = through(points, old, until, pvt)?;
        // What is behind is not needed any more; the law of a motion that stays as it is begins where the motion does.
        let from = law.at(if kept { 0.0 } else { at }).position;
        let plan = appended(old, [from, until], &more)?;
        let (plan, closing) = match plan.with_closing_stop()? {
            Some((closed, count)) => (closed, Some(count)),
            None => (plan, None),
        };
        let base = Judged::new(plan).accepted().map_err(Refused::Rejected)?;
        let motion = Self { base: None, law: None, ..self.clone() };
        if kept {
            let law = Some(Arc::new(law.since(0.0, 0.0)));
            return Ok(self.noted(at_cycle, Self { base: Some(Arc::new(base)), law, ..motion }));
        }
        let law = law.since(at, base.plan().duration());
        if law.is_unchanged() {
            let closes = closing.map(|count| base.plan().cycle_time().start_of(count));
            return self.spliced(at_cycle, motion, base, closes, Vec::new());
        }
        let running = Running { base: Arc::new(base), law: Arc::new(law) };
        let spliced = running.at_rate(self, at_cycle, 0.0, self.factor.get(), &motion)?;
        // What is left of the path is as good as nothing: then there is nothing to go on through.
        spliced.ok_or(Refused::AppendTooLate { closing_from_cycle })
    }
}

/// The path time of the last point \[s\].
fn ends_at(plan: &Plan) -> f64 {
    let closes = plan.axes().iter().filter_map(closing_begins).reduce(largest);
    closes.unwrap_or(plan.duration())
}

/// The motion through the new points, axis by axis as the plan has them.
fn through(points: &Points, plan: &Plan, until: f64, method: PvtMethod) -> Result<Vec<AxisPlan>, Refused> {
    let mut invalid = InvalidFields::default();
    let mut axes = Vec::with_capacity(points.axes.len());
    for (index, given) in points.axes.iter().enumerate() {
        let Some(axis) = plan.axes().iter().find(|axis| axis.axis == given.axis) else {
            let known: Vec<&str> = plan.axes().iter().map(|axis| axis.axis.as_str()).collect();
            let why = Why::UnknownAxis { name: given.axis.clone(), known: known.join(", ") };
            invalid.note(Field::named("axis").within(&Field::element("axes", index)).as_str(), Some(why));
            continue;
        };
        if points.last
            && let Some((last, &given)) = given.velocities.iter().enumerate().next_back()
            && given != 0.0
        {
            let field = Field::element("velocities", last).within(&Field::element("axes", index));
            invalid.note(field.as_str(), Some(Why::LastNotAtRest { given }));
        }
        axes.push(PvtAxisSpec {
            axis: given.axis.clone(),
            kind: Ok(axis.kind),
            limits: axis.limits.spec().clone(),
            start: State { acceleration: 0.0, ..axis.profile.at(until).state },
            times: given.times.clone(),
            positions: given.positions.clone(),
            velocities: given.velocities.clone(),
        });
    }
    if axes.len() < plan.axes().len() {
        invalid.note("axes", Some(Why::Missing { what: "the points of every axis of the motion" }));
    }
    invalid.into_result(())?;
    let request = PvtRequest::try_from(PvtRequestSpec {
        axes,
        cycle_time_ns: Some(plan.cycle_time().as_ns().into()),
        interpolation: Ok(method.interpolation),
        policy: Ok(method.policy),
        finish_unreached: points.last,
    })?;
    let (more, _) = plan_pvt(&request)?.into_parts();
    let place = |axis: &AxisPlan| more.axes().iter().find(|more| more.axis == axis.axis).cloned();
    Ok(plan.axes().iter().filter_map(place).collect())
}

/// The old motion between two path times, and the new one after it.
fn appended(plan: &Plan, [from, until]: [f64; 2], more: &[AxisPlan]) -> Result<Plan, Refused> {
    let axes = plan.axes().iter().zip(more).map(|(old, new)| {
        let mut segments = between(&old.profile, from, until)?;
        segments.extend(new.profile.segments());
        let lasts = on_cycle(until - from + new.profile.duration(), until, plan.cycle_time());
        Some(AxisPlan {
            profile: Profile::new(segments, new.profile.end()).lasting(lasts),
            classification: Classification::of_speed(largest(
                old.classification.feed_rate,
                new.classification.feed_rate,
            )),
            ..new.clone()
        })
    });
    let axes: Option<Vec<AxisPlan>> = axes.collect();
    let axes = axes.ok_or_else(|| {
        Refused::not_implemented("to append to pieces of so high an order", "open a stream with a new plan")
    })?;
    Ok(Plan::new(plan.method(), plan.guaranteed().to_vec(), plan.cycle_time(), axes)?)
}

/// A duration that is whole cycles but for the roundings of times up to `until` is whole cycles.
fn on_cycle(duration: f64, until: f64, cycle_time: CycleTime) -> f64 {
    let cycle = cycle_time.as_seconds();
    let whole = libm::round(duration / cycle) * cycle;
    if (duration - whole).abs() <= ROUNDED * until { whole } else { duration }
}

/// The pieces of a motion between two times from exactly where it is at the first; one that has come to rest before stays there. `None` for a piece that cannot be cut.
fn between(profile: &Profile, from: f64, until: f64) -> Option<Vec<Segment>> {
    let rounded = ROUNDED * until;
    let mut segments: Vec<Segment> = Vec::new();
    let mut lasts = 0.0;
    for (begin, segment) in profile.timed_segments() {
        let end = begin + segment.duration;
        if begin >= until - rounded {
            break;
        }
        if end > from + rounded {
            let piece = if begin >= from - rounded { segment } else { segment.rest(from - begin)? };
            lasts += piece.duration;
            segments.push(piece);
        }
    }
    let missing = until - from - lasts;
    if missing > rounded {
        segments.push(Segment { duration: missing, start: profile.end(), law: Law::ConstantJerk(0.0) });
    }
    if let Some(first) = segments.first_mut() {
        first.start = state_at(profile, from);
    }
    Some(segments)
}
