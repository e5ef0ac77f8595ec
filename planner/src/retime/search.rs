//! The fastest change of the rate: ramps of closed form, each asked what it leaves of the limits, and stretched until they all
//! are kept.

use alloc::vec::Vec;
use core::cell::Cell;

use arrayvec::ArrayVec;

use super::course::{Course, Lead};
use super::span::{Ramp, Span};
use super::strain::{AxisPath, Care};
use crate::float::{largest, least, sqrt};
use crate::{MAX_AXES, State};

/// What part of a ramp its slope is held for \[1\]; the likeliest first.
const HELD: [f64; 3] = [0.4, 0.1, 0.75];
/// A ramp that breaks a limit is stretched by what that limit asks for, within these \[1\].
const STRETCH: (f64, f64) = (1.06, 1.5);
/// Stretches of one ramp: enough for four decades.
const STRETCHES: usize = 32;
/// Halvings of the last stretch, once a ramp keeps the limits.
const HALVINGS: usize = 4;
/// A ramp that is known to be at most so much longer than it could be \[1\] is left as it is.
const NEAR: f64 = 1.02;
/// Of the change that is asked for \[1\]: where to stay on the way, until the limits let the rest through.
const STAGES: [f64; 3] = [0.08, 0.35, 0.7];
/// The last resort on the way up \[1\].
const LEAST_STAGE: f64 = 1e-6;
/// So many ramps in a row.
const DEPTH: usize = 2;
/// Beginnings between two joins of the path.
const BEGINNINGS: f64 = 3.0;
/// Stages are tried where a single ramp takes more than this times what it would where the path is straight and steady \[1\].
const SLOW: f64 = 2.0;

#[derive(Debug)]
pub(super) struct Search<'a> {
    pub(super) axes: ArrayVec<AxisPath<'a>, MAX_AXES>,
    /// When the path ends \[s of path time\].
    pub(super) end: f64,
    /// No ramp is shorter \[s\]: one cycle.
    pub(super) shortest: f64,
    pub(super) care: Care,
    /// The axis that broke a limit last: likely to be the next to.
    pub(super) strictest: Cell<usize>,
}

/// A wait at a rate that stays, but for the first, which follows the present law; and a ramp.
#[derive(Clone, Debug)]
struct Stage {
    wait: f64,
    ramp: Ramp,
}

type Stages = ArrayVec<Stage, DEPTH>;

/// A ramp whose length is open.
#[derive(Clone, Copy, Debug)]
struct Shape {
    from: State,
    rate: f64,
    /// Of the rate, and not nothing \[1\].
    change: f64,
    /// What part of it the slope is held for \[1\].
    held: f64,
}

impl Shape {
    /// In `time` seconds, of which the slope is held for a part h at b and changed by c for the rest: b·(1 + h)·T/2 is the change of
    /// rate, and c·(1 − h)·T/2 is b.
    fn ramp(&self, time: f64) -> Option<Ramp> {
        let slope = 2.0 * self.change / ((1.0 + self.held) * time);
        Ramp::of(self.from, self.rate, slope, 2.0 * slope / ((1.0 - self.held) * time))
    }

    /// That which keeps both bounds \[s\].
    fn least_time(&self, slope: f64, third: f64) -> f64 {
        let at_one = 2.0 * self.change / (1.0 + self.held);
        (at_one / slope).max(sqrt(2.0 * at_one / ((1.0 - self.held) * third)))
    }
}

impl Search<'_> {
    /// From the state at the start of `present` to `factor`; follows `present` where nothing else is possible or better.
    ///
    /// Down: reaches `factor` first. Up, from where it is or from where `present` leads: arrives first.
    pub(super) fn course(&self, present: Lead<'_>, factor: f64) -> Course {
        let lowest = least(present.start().velocity, present.end.velocity);
        let found = if factor > lowest {
            self.rise(present, factor, lowest)
        } else {
            let mut best = None;
            self.fall(present, 0.0, factor, &Stages::new(), &mut best, present.duration());
            best.map(|(_, stages)| stages)
        };
        match found {
            Some(stages) => laid(present, &stages, self.end, factor),
            None => Course::unchanged(present),
        }
    }

    /// Down to `factor`, directly or by stages, after those before, which took `spent` seconds; before `latest`.
    fn fall(
        &self,
        lead: Lead<'_>,
        spent: f64,
        factor: f64,
        before: &Stages,
        best: &mut Option<(f64, Stages)>,
        latest: f64,
    ) {
        let limit = |best: &Option<(f64, Stages)>| best.as_ref().map_or(latest, |(key, _)| *key) - spent;
        let direct = self.first_ramp(lead, factor, limit(best), factor == 0.0);
        let mut quick = false;
        if let Some((key, stage)) = direct {
            quick = stage.wait == 0.0 && key <= SLOW * self.easy_time(&stage.ramp);
            let mut stages = before.clone();
            stages.push(stage);
            *best = Some((spent + key, stages));
        }
        if quick || before.len() + 1 >= DEPTH {
            return;
        }
        let rate = lead.start().velocity;
        for part in STAGES {
            let Some((key, stage)) =
                self.first_ramp(lead, rate + part * (factor - rate), limit(best), factor == 0.0)
            else {
                continue;
            };
            let mut stages = before.clone();
            let end = stage.ramp.end;
            let steady = Span::steady(end, (self.end - end.position) / end.velocity);
            stages.push(stage);
            let lead = Lead { spans: &[steady], end: steady.end() };
            self.fall(lead, spent + key, factor, &stages, best, latest);
        }
    }

    /// How long a ramp over the same change takes where the path goes on as fast as where this one begins or ends, without
    /// acceleration \[s\].
    fn easy_time(&self, ramp: &Ramp) -> f64 {
        let Some(first) = ramp.spans.first() else { return 0.0 };
        let (start, end) = (first.start, ramp.end);
        let (mut slope, mut third) = (f64::INFINITY, f64::INFINITY);
        for axis in &self.axes {
            let (by_slope, by_third) = axis.easy(start.position, end.position);
            slope = slope.min(by_slope);
            third = third.min(by_third);
        }
        let change = (end.velocity - start.velocity).abs();
        if change * third >= slope * slope {
            change / slope + slope / third
        } else {
            2.0 * sqrt(change / third)
        }
    }

    /// Up to `factor` from `lowest`, so that the path ends soonest.
    fn rise(&self, present: Lead<'_>, factor: f64, lowest: f64) -> Option<Stages> {
        let mut best: Option<(f64, Stages)> = None;
        // When the path ends, were it gone at a rate from `state` on.
        let arrival = |now: f64, state: &State, rate: f64| now + (self.end - state.position).max(0.0) / rate;
        let see = |best: &mut Option<(f64, Stages)>, key: f64, stages: &[&Stage]| {
            if best.as_ref().is_none_or(|(least, _)| key < *least) {
                *best = Some((key, stages.iter().map(|&stage| stage.clone()).collect()));
            }
        };
        if let Some((now, stage)) = self.first_ramp(present, factor, f64::INFINITY, false) {
            see(&mut best, arrival(now, &stage.ramp.end, factor), &[&stage]);
            if stage.wait == 0.0 && now <= SLOW * self.easy_time(&stage.ramp) {
                return best.map(|(_, stages)| stages);
            }
        }
        for part in STAGES.into_iter().rev() {
            let rate = lowest + part * (factor - lowest);
            let Some((now, first)) = self.first_ramp(present, rate, f64::INFINITY, false) else { continue };
            see(&mut best, arrival(now, &first.ramp.end, rate), &[&first]);
            let end = first.ramp.end;
            let steady = Span::steady(end, (self.end - end.position).max(0.0) / end.velocity);
            let lead = Lead { spans: &[steady], end: steady.end() };
            if let Some((more, second)) = self.first_ramp(lead, factor, f64::INFINITY, false) {
                see(&mut best, arrival(now + more, &second.ramp.end, factor), &[&first, &second]);
            }
        }
        // However little the limits leave beside the path, they leave all of it for a rate that is small enough.
        let mut part = STAGES[0];
        while best.is_none() && part > LEAST_STAGE {
            part *= 0.25;
            let rate = lowest + part * (factor - lowest);
            if let Some((now, stage)) = self.first_ramp(present, rate, f64::INFINITY, false) {
                best = Some((now, [stage].into_iter().collect()));
            }
        }
        best.map(|(_, stages)| stages)
    }

    /// The ramp that ends soonest, `limit` seconds after the start of `lead` at the latest, and when it does. `rests`: nothing is
    /// gained unless all axes rest by then.
    fn first_ramp(&self, lead: Lead<'_>, rate: f64, limit: f64, rests: bool) -> Option<(f64, Stage)> {
        let (mut best, mut limit) = (None, limit);
        let mut wait = 0.0;
        while wait < limit {
            let state = lead.after(wait);
            if state.position >= self.end {
                break;
            }
            let next = match self.bounds(&state, rate) {
                // It could hardly rest before `limit` if it began here.
                Ok((_, stop)) if rests && NEAR * (wait + stop) >= limit => {
                    self.next_beginning(lead, wait, 0.0)
                }
                Ok((bounds, _)) => {
                    if let Some((duration, ramp)) =
                        self.ramp(state, rate, bounds, limit - wait, best.is_some())
                    {
                        limit = wait + duration;
                        best = Some((limit, Stage { wait, ramp }));
                    }
                    self.next_beginning(lead, wait, 0.0)
                }
                Err(stuck) => self.next_beginning(lead, wait, stuck),
            };
            let Some(next) = next else { break };
            wait = next;
        }
        best
    }

    /// What all axes have left at the beginning of a ramp from `state` to `rate`, for its slope and its third derivative, and before when
    /// no axis at speed rests, whatever the path \[s\]; or how far it is on the path to where one may have something left.
    fn bounds(&self, state: &State, rate: f64) -> Result<((f64, f64), f64), f64> {
        let direction = if rate < state.velocity { -1.0 } else { 1.0 };
        let (mut slope, mut third, mut stop, mut stuck) = (f64::INFINITY, f64::INFINITY, 0.0, 0.0);
        for axis in &self.axes {
            match axis.beginning(*state, direction) {
                Ok(room) => {
                    (slope, third) = (least(slope, room.slope), least(third, room.third));
                    stop = largest(stop, axis.least_stop(room.speed));
                }
                Err(rest) => stuck = largest(stuck, rest),
            }
        }
        if stuck > 0.0 { Err(stuck) } else { Ok(((slope, third), stop)) }
    }

    /// The shortest ramp that was found from `from` to `rate`, shorter than `limit` seconds, and how long it takes. Where one of
    /// about `limit` seconds is known, none is sought but where one a little shorter works.
    fn ramp(
        &self,
        from: State,
        rate: f64,
        (slope, third): (f64, f64),
        limit: f64,
        known: bool,
    ) -> Option<(f64, Ramp)> {
        let change = (rate - from.velocity).abs();
        if change == 0.0 && from.acceleration == 0.0 {
            return Some((0.0, Ramp::of(from, rate, 1.0, 1.0)?));
        }
        let (mut best, mut limit, mut known) = (None, limit, known);
        // A ramp that is mostly slope to be got rid of has a length of its own.
        let change = change.max(from.acceleration.abs() * self.shortest);
        for held in HELD {
            let shape = Shape { from, rate, change, held };
            let least = shape.least_time(slope, third).max(self.shortest);
            let mut too_short = least;
            let mut found = if known {
                let time = limit / NEAR;
                if time <= least { None } else { self.accepted(&shape, time).map(|ramp| (time, ramp)) }
            } else {
                self.stretched(&shape, least, limit, &mut too_short)
            };
            if let Some((time, _)) = found {
                let mut time = time;
                for _ in 0..HALVINGS {
                    if time <= NEAR * too_short {
                        break;
                    }
                    let middle = 0.5 * (too_short + time);
                    match self.accepted(&shape, middle) {
                        Some(ramp) => {
                            time = middle;
                            found = Some((time, ramp));
                        }
                        None => too_short = middle,
                    }
                }
            }
            if let Some((_, ramp)) = found {
                let duration = ramp.duration();
                if duration < limit {
                    (limit, known) = (duration, true);
                    best = Some((duration, ramp));
                }
            }
        }
        best
    }

    /// The first ramp of a shape that keeps the limits, from a time on that is too short or just enough, and that time.
    fn stretched(&self, shape: &Shape, least: f64, limit: f64, too_short: &mut f64) -> Option<(f64, Ramp)> {
        let mut time = least;
        for _ in 0..STRETCHES {
            if time >= limit {
                break;
            }
            match self.fitting(shape, time) {
                Ok(ramp) => return Some((time, ramp)),
                Err(stretch) => {
                    *too_short = time;
                    time *= stretch.clamp(STRETCH.0, STRETCH.1);
                }
            }
        }
        None
    }

    /// The ramp of a shape in `time` seconds, or by how much a limit asks it to be stretched.
    fn fitting(&self, shape: &Shape, time: f64) -> Result<Ramp, f64> {
        let ramp = shape.ramp(time).ok_or(STRETCH.1)?;
        match self.objection(&ramp) {
            Some(stretch) => Err(stretch),
            None => Ok(ramp),
        }
    }

    /// The ramp of a shape in `time` seconds, if it keeps the limits.
    fn accepted(&self, shape: &Shape, time: f64) -> Option<Ramp> {
        let ramp = shape.ramp(time)?;
        let refuses = |index: &usize| !self.axes[*index].accepts(&ramp, &self.care);
        match self.strictest_first().find(refuses) {
            Some(index) => {
                self.strictest.set(index);
                None
            }
            None => Some(ramp),
        }
    }

    /// The one that broke a limit last, and then the others.
    fn strictest_first(&self) -> impl Iterator<Item = usize> + use<> {
        let strictest = self.strictest.get();
        core::iter::once(strictest).chain((0..self.axes.len()).filter(move |&index| index != strictest))
    }

    /// That of the first axis that has one; the one that had the last is asked first.
    fn objection(&self, ramp: &Ramp) -> Option<f64> {
        for index in self.strictest_first() {
            let objection = self.axes[index].objection(ramp, &self.care);
            if objection.is_some() {
                self.strictest.set(index);
                return objection;
            }
        }
        None
    }

    /// The next instant, after `wait` seconds of a lead, at which another ramp may begin better: the end of a ramp, or,
    /// at a rate that stays, a part of the way to where a piece of a path ends; no ramp begins for `stuck` on the path.
    fn next_beginning(&self, lead: Lead<'_>, wait: f64, stuck: f64) -> Option<f64> {
        let mut begin = 0.0;
        for span in lead.spans {
            let end = begin + span.duration;
            if wait < end {
                let rate = span.start.velocity;
                if !span.is_steady() || rate <= 0.0 {
                    return Some(end);
                }
                let stride = if stuck > 0.0 { stuck } else { self.stride(span.at(wait - begin).position)? };
                // However little that is, time goes on.
                return Some(least(end, largest(wait + stride / rate, wait * (1.0 + 4.0 * f64::EPSILON))));
            }
            begin = end;
        }
        None
    }

    /// How far to go on along the path from `position` to where a ramp may begin better.
    fn stride(&self, position: f64) -> Option<f64> {
        let slack = 4.0 * f64::EPSILON * self.end;
        let pieces = self.axes.iter().filter_map(|axis| axis.path.piece_around(position + slack));
        pieces
            .map(|(begin, end)| ((end - begin) / BEGINNINGS).max(slack).min(end - position))
            .reduce(f64::min)
    }
}

fn laid(present: Lead<'_>, stages: &Stages, path_end: f64, factor: f64) -> Course {
    let mut law = Vec::with_capacity(present.spans.len() + 4 * stages.len() + 1);
    let (mut now, mut end) = (0.0, present.start());
    for (index, Stage { wait, ramp }) in stages.iter().enumerate() {
        if index == 0 {
            law.extend(present.until(*wait));
        } else if *wait > 0.0 {
            law.push(Span::steady(end, *wait));
        }
        law.extend(ramp.spans.iter().copied());
        end = ramp.end;
        now += wait + ramp.duration();
    }
    #[expect(clippy::float_cmp, reason = "a ramp ends in exactly the rate that was asked for")]
    let reached = (end.velocity == factor && end.position <= path_end).then_some(now);
    if end.velocity > 0.0 {
        let steady = Span::steady(end, (path_end - end.position).max(0.0) / end.velocity);
        end = steady.end();
        law.push(steady);
    }
    Course { law, end, reached }
}
