use super::ends::{Ends, Moving, Phases};
use super::lead_in::Confines;
use crate::float::{largest, least, sqrt};
use crate::roots::convex_root;

/// Of the square of a fall over its limit \[1\]: what the time is off by where the fall is off by an ulp or two.
const TIME_ULPS: f64 = 4.0;

/// One of the two families between which all motions lie: of all that take as long, its members go farthest. `notes/0007-any-state.md`
/// derives it. The lower family is its mirror image.
#[derive(Clone, Copy, Debug)]
pub(super) struct Upper {
    pub(super) ends: Ends,
    /// The limits of acceleration, up and down, as magnitudes.
    pub(super) up: f64,
    pub(super) down: f64,
    /// The limit of velocity.
    pub(super) top: f64,
    /// How far the motion is to go.
    pub(super) way: f64,
    /// What that is rounded to.
    pub(super) slack: f64,
    /// Of the ends: every summit is above them.
    feet: Feet,
}

/// From an end to a velocity at which acceleration is zero, or back: full jerk for `rise`, the limit for `hold`, and full jerk
/// against it for `peak`, which is also the acceleration from which it falls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flank {
    pub(super) rise: f64,
    pub(super) hold: f64,
    pub(super) peak: f64,
    pub(super) way: f64,
}

impl Flank {
    /// Up from `end` to the velocity `above` the least that is reached so.
    ///
    /// With `E` the square of the peak as it would be without a limit, `v = v₀ − a₀²/2 + E`, in either case.
    pub(super) fn of(end: Moving, above: f64, limit: f64) -> Self {
        let Moving { acceleration, .. } = end;
        let least_peak = largest(0.0, acceleration);
        let square = least_peak * least_peak + above;
        let (rise, hold, peak) = if square > limit * limit {
            (limit - acceleration, (square - limit * limit) / limit, limit)
        } else {
            let peak = sqrt(square);
            let rise = if acceleration > 0.0 { above / (peak + acceleration) } else { peak - acceleration };
            (rise, 0.0, peak)
        };
        let mut state = end;
        let mut way = state.advance(1.0, rise);
        way += hold * (state.velocity + 0.5 * hold * peak);
        let velocity = state.velocity + hold * peak;
        Self { rise, hold, peak, way: way + peak * (velocity + peak * peak / 3.0) }
    }

    pub(super) fn time(&self) -> f64 {
        self.rise + self.hold + self.peak
    }

    /// How far above its least velocity the flank begins to reach its limit.
    pub(super) fn reach(end: Moving, limit: f64) -> f64 {
        let least_peak = largest(0.0, end.acceleration);
        limit * limit - least_peak * least_peak
    }
}

/// The lowest velocity at which both flanks can meet: the higher of those that they come to when nothing but full jerk takes
/// their acceleration to zero.
#[derive(Clone, Copy, Debug)]
pub(super) struct Feet {
    pub(super) lowest: f64,
    /// How far the flank from the start, and the one from the goal, must rise to it.
    pub(super) first: f64,
    pub(super) last: f64,
}

impl Feet {
    fn of(ends: &Ends) -> Self {
        let Ends { start, goal, change } = *ends;
        let (from_start, from_goal) = (start.coasting(), goal.reversed().coasting());
        let square = |moving: Moving| moving.acceleration * moving.acceleration.abs();
        let apart = change.velocity - 0.5 * (square(start) + square(goal));
        let (first, last) = (ends.beyond_rounding(apart), ends.beyond_rounding(-apart));
        Self { first, last, lowest: largest(from_start, from_goal) }
    }
}

/// Two flanks that meet.
#[derive(Clone, Copy, Debug)]
pub(super) struct Summit {
    pub(super) first: Flank,
    pub(super) last: Flank,
}

impl Summit {
    pub(super) fn way(&self) -> f64 {
        self.first.way + self.last.way
    }

    /// The whole fall from peak to valley.
    fn fall(&self) -> f64 {
        self.first.peak + self.last.peak
    }

    pub(super) fn time(&self) -> f64 {
        self.first.time() + self.last.time()
    }

    pub(super) fn phases(&self, cruise: f64) -> Phases {
        let Self { first, last } = self;
        [first.rise, first.hold, first.peak, cruise, last.peak, last.hold, last.rise]
    }
}

impl Upper {
    /// The family between two ends, with the way to go, and what that is rounded to; the lower one, seen from the other side, where `sign`
    /// is negative.
    pub(super) fn of(sign: f64, ends: Ends, confines: Confines, way: f64, slack: f64) -> Self {
        let (ends, Confines { top, up, down, .. }, way) =
            if sign < 0.0 { (ends.mirrored(), confines.mirrored(), -way) } else { (ends, confines, way) };
        Self { ends, up, down, top, way, slack, feet: Feet::of(&ends) }
    }

    /// Run backwards, which leaves the family as it is.
    pub(super) fn reversed(self) -> Self {
        let ends = self.ends.reversed();
        Self { ends, up: self.down, down: self.up, feet: Feet::of(&ends), ..self }
    }

    /// The member that goes the way, among those that pass zero acceleration on the way down; none where velocities up to the
    /// limit, which is then zero, do not lead there. What they go at least is less than the way.
    pub(super) fn summit(&self) -> Option<Phases> {
        let Ends { start, goal, .. } = self.ends;
        let Feet { lowest, first, last } = self.feet;
        let at = |above: f64| self.summit_at(above);
        let room = self.ends.beyond_rounding(self.top - lowest);
        let highest = at(room);
        let spare = self.way - highest.way();
        if spare >= 0.0 {
            return (spare == 0.0 || self.top > 0.0)
                .then(|| highest.phases(if spare > 0.0 { spare / self.top } else { 0.0 }));
        }
        let first_reach = Flank::reach(start, self.up) - first;
        let last_reach = Flank::reach(goal.reversed(), self.down) - last;
        let (one, both) = (least(first_reach, last_reach), largest(first_reach, last_reach));
        if one >= room {
            return Some(self.free(highest.fall()));
        }
        let mut low = at(largest(0.0, one));
        if one > 0.0 && low.way() >= self.way {
            return Some(self.free(low.fall()));
        }
        let mut high = highest;
        if both < room {
            let reached = at(largest(0.0, both));
            if both <= 0.0 || reached.way() < self.way {
                return Some(self.held(lowest + largest(0.0, both), &reached));
            }
            high = reached;
        }
        if first_reach <= last_reach {
            return Some(self.half_held(low.last.peak, high.last.peak));
        }
        core::mem::swap(&mut low.first, &mut low.last);
        let mut phases = self.reversed().half_held(low.last.peak, high.first.peak);
        phases.reverse();
        Some(phases)
    }

    /// The two flanks up to a velocity `above` the lowest at which they meet.
    pub(super) fn summit_at(&self, above: f64) -> Summit {
        let Ends { start, goal, .. } = self.ends;
        let Feet { first, last, .. } = self.feet;
        Summit {
            first: Flank::of(start, above + first, self.up),
            last: Flank::of(goal.reversed(), above + last, self.down),
        }
    }

    /// How far the limit of velocity is above the lowest summit.
    pub(super) fn room(&self) -> f64 {
        self.ends.beyond_rounding(self.top - self.feet.lowest)
    }

    pub(super) fn feet(&self) -> Feet {
        self.feet
    }

    /// The member with the lowest summit, and what it goes.
    pub(super) fn lowest(&self) -> (Phases, f64) {
        let summit = self.summit_at(0.0);
        (summit.phases(0.0), summit.way())
    }

    /// Neither acceleration is held, so that all hangs on the fall `y` from peak to valley; it is at most `highest`.
    ///
    /// With `δ = a₁ − a₀`, `ā` their mean, `T = 2y + δ` and `κ = Δv − ā·T`
    ///
    /// ```text
    /// way(y) = T·(v₀ + v₁)/2 + (y³ − δ²·y − κ²/y)/4 − δ³/12      rises = (y + δ ± κ/y)/2
    /// ```
    ///
    /// No term is larger than the motion itself, however hard it accelerates at its ends. From the least `y` on the function is
    /// convex, with a third derivative of 3/2 or more, which bounds the root.
    fn free(&self, highest: f64) -> Phases {
        let Ends { start, goal, .. } = self.ends;
        let (change, step, mean) =
            (self.ends.change.velocity, self.ends.change.acceleration, self.ends.mean_acceleration());
        let sum = start.velocity + goal.velocity;
        let offset = -self.way - step * step * step / 12.0;
        // On a last flank the velocity changes as under constant jerk and `y` is next to nothing: what the sum rounds away over `y` would
        // be more than `κ/y` itself.
        let level = self.ends.peak_excess() == 0.0;
        let skew = |y: f64| if level { -2.0 * mean } else { (change - mean * (2.0 * y + step)) / y };
        let value_and_slope = |y: f64| {
            let k = skew(y);
            let (squares, level) = (y * y, step * step + k * k);
            let value = (y + 0.5 * step) * sum + 0.25 * y * (squares - level) + offset;
            (value, sum + 0.75 * squares + 0.25 * (k * k - step * step) + mean * k)
        };
        let lowest = self.least_fall();
        let (value, slope) = if lowest > 0.0 { value_and_slope(lowest) } else { self.at_no_fall(offset) };
        let rest = largest(0.0, -value);
        let cubic = libm::cbrt(4.0 * rest);
        let bound = if slope > 0.0 { least(cubic, rest / slope) } else { cubic + 2.0 * sqrt(-slope) };
        let begin = least(highest, lowest + bound);
        let y = convex_root(begin, lowest, highest, value_and_slope);
        let k = if y > 0.0 { skew(y) } else { 0.0 };
        [largest(0.0, 0.5 * (y + step + k)), 0.0, y, 0.0, 0.0, 0.0, largest(0.0, 0.5 * (y + step - k))]
    }

    /// The limit of the function in [`Self::free`] and of its slope for no fall at all, which there is where the velocity changes
    /// under constant jerk, up: `κ = −2·ā·y`.
    fn at_no_fall(&self, offset: f64) -> (f64, f64) {
        let Ends { start, goal, .. } = self.ends;
        let (step, mean) = (self.ends.change.acceleration, self.ends.mean_acceleration());
        let sum = start.velocity + goal.velocity;
        (0.5 * step * sum + offset, sum - 0.25 * step * step - mean * mean)
    }

    /// The fall from peak to valley at the lowest summit, where one of both rises is no longer than it must be.
    fn least_fall(&self) -> f64 {
        let Ends { start, goal, .. } = self.ends;
        let (peak, valley) = (largest(0.0, start.acceleration), largest(0.0, -goal.acceleration));
        let excess = self.ends.peak_excess() + valley * valley - peak * peak;
        if excess >= 0.0 {
            valley + sqrt(peak * peak + excess)
        } else {
            peak + sqrt(valley * valley - excess)
        }
    }

    /// The upper limit is held and the valley is free, between `low` and `high`; `z` is the fall from the limit to it.
    ///
    /// ```text
    /// T(z) = (Δv + (r² − f²)/2 + z²)/A,   r = A − a₀,   f = A − a₁
    /// way(z) = v₀·T + A·T²/2 − r³/3 − r²·(T − r)/2 − z³/6 − z·c·(z + c)/2 + c³/6,   c = z − f
    /// way′(z) = (v + A·(z − A)/2)·T′(z),   v = v₁ − a₁²/2 + (z − A)² the velocity without acceleration
    /// ```
    fn half_held(&self, low: f64, high: f64) -> Phases {
        let Ends { start, goal, .. } = self.ends;
        let limit = self.up;
        let (rise, gap) = (limit - start.acceleration, limit - goal.acceleration);
        let inverse = 1.0 / limit;
        let square = self.ends.change.velocity + 0.5 * (rise * rise - gap * gap);
        let time = |z: f64| (square + z * z) * inverse;
        let vertex = goal.velocity - 0.5 * goal.acceleration * goal.acceleration;
        let offset = rise * rise * rise / 6.0 - self.way;
        let off = |t: f64, z: f64| {
            let climb = z - gap;
            let way = t * (start.velocity + 0.5 * (limit * t - rise * rise))
                - z * (z * z / 6.0 + 0.5 * climb * (z + climb))
                + climb * climb * climb / 6.0;
            way + offset
        };
        let pace = |z: f64| vertex + (z - limit) * (z - 0.5 * limit);
        let value_and_slope = |z: f64| (off(time(z), z), 2.0 * z * inverse * pace(z));
        // way⁗ = 24/A and way‴ ≥ 6 in the depth of the valley: where nothing falls, each term alone bounds the root.
        let (value, slope) = value_and_slope(limit + low);
        let bend = 0.5 * limit + vertex * inverse + 3.0 * low * (1.0 + low * inverse);
        let mut begin = limit + high;
        if slope >= 0.0 && bend >= 0.0 {
            let rest = largest(0.0, -value);
            let bound = least(libm::cbrt(rest), sqrt(sqrt(2.0 * limit * rest)));
            let bound = if slope > 0.0 { least(bound, rest / slope) } else { bound };
            begin = least(begin, limit + low + bound);
        }
        let z = convex_root(begin, limit + low, limit + high, value_and_slope);
        // Where the limit is little, an ulp of `z` is many of the time, so the time has the last word: within what that ulp is worth.
        // Where the way hardly changes, its rounding over its pace is any time, and the velocity would go with it.
        let (t, faster) = (time(z), pace(z));
        let ulps = TIME_ULPS * f64::EPSILON * z * z * inverse;
        let late = if faster > 0.0 { least(ulps, largest(-ulps, off(t, z) / faster)) } else { 0.0 };
        let t = t - late;
        let climb = largest(0.0, z - gap);
        let hold = largest(0.0, t - rise - z - climb);
        [rise, hold, z, 0.0, 0.0, 0.0, climb]
    }

    /// Both limits are held, from `reached` at the velocity `velocity` on: the way is a parabola over the velocity.
    fn held(&self, velocity: f64, reached: &Summit) -> Phases {
        let Self { up, down, .. } = *self;
        let rest = largest(0.0, self.way - reached.way()) * up * down / (up + down);
        let slope = velocity + 0.5 * up * down;
        let root = sqrt(slope * slope + 2.0 * rest);
        let above = if slope > 0.0 { 2.0 * rest / (slope + root) } else { root - slope };
        let mut higher = *reached;
        higher.first.hold += above / up;
        higher.last.hold += above / down;
        higher.phases(0.0)
    }
}
