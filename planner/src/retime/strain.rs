//! What a ramp of the rate asks of the axes, at a few instants: cheap enough to ask for every candidate. The judge has the last
//! word.

use core::cell::Cell;

use super::extremes::Extremes;
use super::span::{Ramp, Span};
use super::walk::{Stretch, Walk, place_of};
use crate::float::{largest, least, sqrt};
use crate::{AxisPlan, Profile, Quantity, Setpoint, State};

/// How near a ramp is looked at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Care {
    /// Instants per stretch, beside its start: both ends see every jump of the jerk.
    pub(super) looks: u32,
    /// What the ramp must leave of what the path leaves for it of a limit \[1\].
    pub(super) reserve: f64,
}

/// Of a limit \[1\]: a path that is on its limit but for a rounding is on it. A tenth of what the judge allows.
const SLACK: f64 = 0.1 * crate::LIMIT_TOLERANCE;

/// Of a piece of higher order \[1\]: how far to go on where nothing is left of a limit.
const PART: f64 = 0.125;

/// Many times too much: there is hardly anything left of the limit.
const TOO_MUCH: f64 = 1e6;

/// What an axis has left at a place, and how fast it is there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// For the slope of the rate \[1/s\], infinite where the path stands still; likewise for its third derivative \[1/s²\].
    pub(super) slope: f64,
    pub(super) third: f64,
    /// At the rate of path time [axis units/s], a magnitude.
    pub(super) speed: f64,
}

impl Room {
    const FREE: Self = Self { slope: f64::INFINITY, third: f64::INFINITY, speed: 0.0 };
}

/// One axis's path and what it may do there.
#[derive(Clone, Debug)]
pub(super) struct AxisPath<'a> {
    pub(super) path: &'a Profile,
    /// Where the last ramp began, as path time and as a place: most candidates begin where the one before did.
    began: Cell<(f64, (usize, f64))>,
    /// Acceleration, deceleration and jerk [axis units/s², /s², /s³]: the limits, or where the plan does not promise to keep them
    /// and does not, what it takes.
    acceleration: f64,
    deceleration: f64,
    jerk: f64,
}

impl<'a> AxisPath<'a> {
    /// `promised`: which of acceleration and jerk the plan keeps within limits.
    pub(super) fn new(axis: &'a AxisPlan, promised: impl Fn(Quantity) -> bool, from: f64) -> Self {
        let limits = &axis.limits;
        let (keeps_acceleration, keeps_jerk) = (promised(Quantity::Acceleration), promised(Quantity::Jerk));
        let taken = if keeps_acceleration && keeps_jerk {
            Extremes::default()
        } else {
            Extremes::of(&axis.profile, from)
        };
        let wide = |limit: f64, kept: bool, taken: f64| if kept { limit } else { limit.max(taken) };
        Self {
            path: &axis.profile,
            began: Cell::new((from, place_of(&axis.profile, from))),
            acceleration: wide(limits.acceleration(), keeps_acceleration, taken.acceleration),
            deceleration: wide(limits.deceleration(), keeps_acceleration, taken.deceleration),
            jerk: wide(limits.jerk(), keeps_jerk, taken.jerk),
        }
    }

    /// What the axis has left for a slope and a third derivative in `direction` at a place and rate: the bounds that just use it
    /// up, infinite where the path stands still. Where nothing is left, how far it is on the path to where that may change
    /// \[s of path time\].
    pub(super) fn beginning(&self, now: State, direction: f64) -> Result<Room, f64> {
        let (piece, from) = self.path.place_of(now.position);
        let Some(duration) = self.path.piece_duration(piece) else { return Ok(Room::FREE) };
        let along = Along::of(self.path.piece_at(piece, from), now.velocity);
        if along.speed == 0.0 {
            return Ok(Room::FREE);
        }
        let limit = if direction > 0.0 { self.acceleration } else { self.deceleration };
        let mut acceleration = limit - direction * along.acceleration;
        let jerk = self.jerk - direction * along.jerk;
        // Led away from its limit the room grows with the ramp.
        if direction * along.jerk < 0.0 {
            acceleration = acceleration.max(limit);
        }
        if acceleration <= SLACK * limit || jerk <= SLACK * self.jerk {
            let rest = duration - from;
            // A constant jerk stays what it is to the end of the piece, and so does an acceleration without.
            let changes = self.path.constant_jerk(piece).is_none();
            return Err(if changes { least(rest, duration * PART) } else { rest });
        }
        let Along { speed, .. } = along;
        Ok(Room { slope: acceleration / speed, third: jerk / speed, speed: speed * now.velocity })
    }

    /// No motion within the limits rests sooner from `speed` \[axis units/s\] than this \[s\], on the path or off it, whatever acceleration it
    /// has already: the last of it sheds its deceleration, D, at J, and what is faster than that sheds, D²/2J, was slowed at D.
    pub(super) fn least_stop(&self, speed: f64) -> f64 {
        let (hardest, jerk) = (self.deceleration, self.jerk);
        let shed = hardest / jerk;
        if 2.0 * speed <= hardest * shed { sqrt(2.0 * speed / jerk) } else { speed / hardest + 0.5 * shed }
    }

    /// The bounds of slope and third derivative at the faster of two places, were the path straight and steady there.
    pub(super) fn easy(&self, one: f64, other: f64) -> (f64, f64) {
        let speed = |at: f64| self.path.at(at).state.velocity.abs();
        let speed = speed(one).max(speed(other));
        (self.acceleration.min(self.deceleration) / speed, self.jerk / speed)
    }

    /// What a ramp is to be stretched by to keep this axis's limits, as far as the first stretch of its path tells that breaks one;
    /// `None` where it keeps them all.
    pub(super) fn objection(&self, ramp: &Ramp, care: &Care) -> Option<f64> {
        let Care { looks, reserve } = *care;
        for Stretch { piece, from, span } in self.walk(ramp)? {
            if self.path.constant_jerk(piece).is_some_and(|jerk| self.surely_keeps(&jerk, from, &span, care))
            {
                continue;
            }
            let step = span.duration / f64::from(looks);
            let mut worst = 1.0;
            for look in 0..=looks {
                let now = span.at(f64::from(look) * step);
                let setpoint = self.path.piece_at(piece, from + now.position);
                worst =
                    largest(worst, self.asks(&Along::of(setpoint, now.velocity), &now, span.third, reserve));
            }
            if worst > 1.0 {
                return Some(worst);
            }
        }
        None
    }

    /// The stretches of a ramp; none where it has no span.
    fn walk<'b>(&'b self, ramp: &'b Ramp) -> Option<Walk<'b>> {
        let begin = ramp.spans.first()?.start.position;
        let (before, mut place) = self.began.get();
        if before.to_bits() != begin.to_bits() {
            place = place_of(self.path, begin);
            self.began.set((begin, place));
        }
        Some(Walk::from_place(self.path, &ramp.spans, place, false))
    }

    /// Has [`Self::objection`] none? Without saying by how much.
    pub(super) fn accepts(&self, ramp: &Ramp, care: &Care) -> bool {
        let Care { looks, reserve } = *care;
        let Some(mut walk) = self.walk(ramp) else { return true };
        walk.all(|Stretch { piece, from, span }| {
            if let Some(jerk) = self.path.constant_jerk(piece) {
                return self.surely_keeps(&jerk, from, &span, care);
            }
            let step = span.duration / f64::from(looks);
            (0..=looks).all(|look| {
                let now = span.at(f64::from(look) * step);
                let along = Along::of(self.path.piece_at(piece, from + now.position), now.velocity);
                self.asks(&along, &now, span.third, reserve) <= 1.0
            })
        })
    }

    /// Are the limits kept at all looks on a stretch whose jerk is constant? Given duration, start and jerk of its piece.
    #[inline]
    fn surely_keeps(
        &self,
        &(_, start, jerk): &(f64, State, f64),
        from: f64,
        span: &Span,
        care: &Care,
    ) -> bool {
        let Care { looks, reserve } = *care;
        let step = span.duration / f64::from(looks);
        let stretch = Steady { start: &start, jerk, from, span, step };
        if jerk == 0.0 && start.acceleration == 0.0 {
            // What a slope that goes one way asks for goes one way too, rounded as it is, so that both ends tell of all in between.
            let ends = Steady { step: f64::from(looks) * step, ..stretch };
            return self.keeps::<2>(&ends, 1.0, reserve);
        }
        match looks {
            ..=4 => self.keeps::<6>(&stretch, f64::from(looks), reserve),
            5..=8 => self.keeps::<10>(&stretch, f64::from(looks), reserve),
            9..=16 => self.keeps::<18>(&stretch, f64::from(looks), reserve),
            _ => self.keeps::<34>(&stretch, f64::from(looks), reserve),
        }
    }

    /// Are the limits kept at all looks on a stretch? What [`Self::asks`] tells in the same numbers, but not by how much they are not; without
    /// a branch, so that instants are looked at two at a time: an even number of `LOOKS`, of which those after the `last` are its
    /// repetition.
    #[inline]
    fn keeps<const LOOKS: usize>(&self, stretch: &Steady<'_>, last: f64, reserve: f64) -> bool {
        let Steady { start, jerk, from, span, step } = *stretch;
        let more = 1.0 + reserve;
        let within = |limit: f64| (1.0 + SLACK) * limit;
        let (speeding, slowing, jerks) =
            (within(self.acceleration), within(self.deceleration), within(self.jerk));
        let standing = largest(speeding, slowing);
        let mut kept = [true; LOOKS];
        for (look, kept) in kept.iter_mut().enumerate() {
            let now = span.at(least(look as f64, last) * step);
            let state = start.after(jerk, from + now.position);
            let bend = state.acceleration * now.velocity;
            let taken = bend * now.velocity;
            let by_slope = state.velocity * now.acceleration;
            let by_third = 3.0 * bend * now.acceleration + state.velocity * span.third;
            let changes = (taken + by_slope) * if state.velocity < 0.0 { -1.0 } else { 1.0 };
            let limit = if changes > 0.0 { speeding } else { slowing };
            let limit = if state.velocity == 0.0 { standing } else { limit };
            let bent = jerk * now.velocity * now.velocity * now.velocity + more * by_third;
            // False for NaN.
            *kept = ((taken + more * by_slope).abs() <= limit) & (bent.abs() <= jerks);
        }
        kept.iter().fold(true, |all, kept| all & kept)
    }

    /// What a ramp is to be stretched by to keep the limits at one instant; 1 or less where it does. Its slope falls with its length,
    /// its third derivative with the square.
    #[inline]
    fn asks(&self, along: &Along, now: &State, third: f64, reserve: f64) -> f64 {
        let by_slope = along.speed * now.acceleration;
        let limit = match along.acceleration + by_slope {
            // Which of both an axis does that stands still cannot be told from here.
            _ if along.speed == 0.0 => largest(self.acceleration, self.deceleration),
            speeding if speeding > 0.0 => self.acceleration,
            _ => self.deceleration,
        };
        let slowed = excess(along.acceleration, by_slope, limit, reserve);
        let by_third = 3.0 * along.bend * now.acceleration + along.speed * third;
        let bent = excess(along.jerk, by_third, self.jerk, reserve);
        if slowed <= 1.0 && bent <= 1.0 {
            return 1.0;
        }
        largest(slowed, if third == 0.0 { bent } else { sqrt(bent) })
    }
}

/// How many times too much `more` is beside what is `taken` of a limit; 1 where it is not, and many times where nothing is left.
#[inline]
fn excess(taken: f64, more: f64, limit: f64, reserve: f64) -> f64 {
    let all = taken + (1.0 + reserve) * more;
    // NaN is too much.
    if all.abs() <= (1.0 + SLACK) * limit {
        return 1.0;
    }
    let left = if all > 0.0 { limit - taken } else { limit + taken };
    let excess = (1.0 + reserve) * more.abs() / left;
    if excess > 1.0 && excess < TOO_MUCH { excess } else { TOO_MUCH }
}

/// A stretch on which the jerk of the path is constant.
struct Steady<'a> {
    /// Of the piece.
    start: &'a State,
    jerk: f64,
    /// Where in the piece it begins \[s of path time\].
    from: f64,
    span: &'a Span,
    /// From one look to the next \[s\].
    step: f64,
}

/// A setpoint of the path at a rate, the travel counted positive.
struct Along {
    /// |q′|
    speed: f64,
    /// q″·τ′, signed by the travel: what a slope is multiplied by, but for the 3, in the jerk.
    bend: f64,
    /// q″·τ′²
    acceleration: f64,
    /// q‴·τ′³
    jerk: f64,
}

impl Along {
    #[inline]
    fn of(Setpoint { state, jerk }: Setpoint, rate: f64) -> Self {
        let signed = |value: f64| if state.velocity < 0.0 { -value } else { value };
        let bend = signed(state.acceleration) * rate;
        Self {
            speed: signed(state.velocity),
            bend,
            acceleration: bend * rate,
            jerk: signed(jerk) * rate * rate * rate,
        }
    }
}
