//! What the judge passes at a glance: motions of constant jerk, or of cosines, inside every limit from beginning to end.
//!
//! A bound from above of everything that the judge looks for, and from below of everything that it measures by: whatever passes here passes there
//! too, and whatever does not is looked at by the judge itself. Nothing is noted and nothing taken from the heap, so of many motions each costs
//! a fraction of its certificate.

use super::{JOIN_TOLERANCE, LIMIT_TOLERANCE, POSITION_ULPS, Promise};
use crate::{Limits, Profile, Setpoint, State};

/// Of what the judge lets a limit be exceeded by, and of what he lets joins be apart \[1\]: half, so that a rounding here does not count.
const SHARE: f64 = 0.5;
/// Of the greater of two accelerations \[1\]: what the smaller one is a rounded zero up to.
const ROUNDED: f64 = 64.0 * f64::EPSILON;

/// Is there no doubt that the motion keeps what it promises? `false` says nothing: the judge is to be asked.
pub(crate) fn is_plain(profile: &Profile, limits: &Limits, goal: State, promise: &Promise) -> bool {
    let mut seen = Seen::at(profile.start());
    let mut before: Option<Setpoint> = None;
    for index in 0..profile.begins().len() {
        let [begin, end] = profile.setpoints_at_ends(index);
        let constant = profile.constant_jerk(index);
        let hardest = match constant {
            Some((.., jerk)) => jerk,
            // A cosine is at its peak half-way, and its jerk keeps its sign.
            None => match profile.peak(index) {
                Some(peak) => peak,
                None => return false,
            },
        };
        let turn = match (constant, changes_sign(begin.state.acceleration, end.state.acceleration)) {
            (Some((.., jerk)), true) => {
                begin.state.velocity - 0.5 * begin.state.acceleration * (begin.state.acceleration / jerk)
            }
            (None, true) => return false,
            (_, false) => begin.state.velocity,
        };
        if !seen.piece(&begin.state, &end.state, turn, limits) {
            return false;
        }
        if promise.limited[3] && !within(hardest, limits.jerk()) {
            return false;
        }
        seen.jerk = larger(seen.jerk, hardest.abs());
        let still = Setpoint { state: begin.state, jerk: 0.0 };
        seen.join(&before.unwrap_or(still), &begin);
        before = Some(end);
    }
    // Nothing moves: the judge has little to do.
    let Some(last) = before else { return false };
    let end = profile.end();
    seen.jumps[3] = larger(seen.jumps[3], last.jerk.abs());
    seen.ends(&last.state, &end, &goal, promise) && seen.is_within_range(limits)
}

/// What was seen of a motion. Every comparison fails for NaN.
struct Seen {
    least_position: f64,
    greatest_position: f64,
    fastest: f64,
    hardest: f64,
    jerk: f64,
    /// Does the velocity keep its sign within each piece? Then positions are extreme where pieces end.
    turns_at_joins: bool,
    /// The worst of position, velocity, acceleration and jerk.
    jumps: [f64; 4],
}

impl Seen {
    fn at(start: State) -> Self {
        Self {
            least_position: start.position,
            greatest_position: start.position,
            fastest: 0.0,
            hardest: 0.0,
            jerk: 0.0,
            turns_at_joins: true,
            jumps: [0.0; 4],
        }
    }

    /// Takes a piece from `begin` to `end`, whose velocity is extreme at both and at `turn`; does it keep the limits of velocity and
    /// acceleration?
    #[inline]
    fn piece(&mut self, begin: &State, end: &State, turn: f64, limits: &Limits) -> bool {
        self.least_position = smaller(self.least_position, smaller(begin.position, end.position));
        self.greatest_position = larger(self.greatest_position, larger(begin.position, end.position));
        let (slowest, fastest) = (
            smaller(turn, smaller(begin.velocity, end.velocity)),
            larger(turn, larger(begin.velocity, end.velocity)),
        );
        self.fastest = larger(self.fastest, larger(slowest.abs(), fastest.abs()));
        let hardest = larger(begin.acceleration.abs(), end.acceleration.abs());
        self.hardest = larger(self.hardest, hardest);
        let (up, down) = (limits.acceleration(), limits.deceleration());
        let kept = if slowest >= 0.0 || fastest <= 0.0 {
            let direction = if slowest >= 0.0 { 1.0 } else { -1.0 };
            [begin.acceleration, end.acceleration].into_iter().all(|acceleration| {
                within(acceleration, if acceleration * direction >= 0.0 { up } else { down })
            })
        } else {
            self.turns_at_joins = false;
            within(hardest, smaller(up, down))
        };
        let forward = fastest <= 0.0 || within(fastest, limits.velocity_forward());
        let backward = slowest >= 0.0 || within(slowest, limits.velocity_reverse());
        kept && forward && backward
    }

    #[inline]
    fn join(&mut self, before: &Setpoint, after: &Setpoint) {
        let parts = before.words().into_iter().zip(after.words());
        for (worst, (one, other)) in self.jumps.iter_mut().zip(parts) {
            *worst = larger(*worst, (other - one).abs());
        }
    }

    /// Do the pieces join, and end where they are to?
    fn ends(&self, last: &State, end: &State, goal: &State, promise: &Promise) -> bool {
        let farthest = larger(self.least_position.abs(), self.greatest_position.abs());
        let rounding = POSITION_ULPS * f64::EPSILON * farthest;
        let of = |scale: f64| SHARE * JOIN_TOLERANCE * scale + f64::MIN_POSITIVE;
        let allowed = [
            of(self.greatest_position - self.least_position) + SHARE * rounding,
            of(self.fastest),
            of(self.hardest),
            of(self.jerk),
        ];
        let words = |state: &State| [state.position, state.velocity, state.acceleration];
        let joined = (0..4).all(|order| !promise.joined[order] || self.jumps[order] <= allowed[order]);
        let reached = words(last).into_iter().zip(words(end)).zip(words(goal)).zip(allowed).enumerate();
        joined
            && reached.into_iter().all(|(order, (((last, end), goal), allowed))| {
                let arrives = !promise.joined[order] || (last - end).abs() <= allowed;
                arrives && (end - goal).abs() <= allowed
            })
    }

    fn is_within_range(&self, limits: &Limits) -> bool {
        let inside =
            self.least_position >= limits.min_position() && self.greatest_position <= limits.max_position();
        let has_no_range = limits.spec().min_position.is_none() && limits.spec().max_position.is_none();
        has_no_range || (inside && self.turns_at_joins)
    }
}

/// Is there a zero between two accelerations that counts? Beside the other a rounded zero is one already: from there on the velocity changes by less
/// than its own rounding.
#[inline]
fn changes_sign(from: f64, to: f64) -> bool {
    from * to < 0.0 && smaller(from.abs(), to.abs()) > ROUNDED * larger(from.abs(), to.abs())
}

/// A magnitude within a limit, but for a share of what the judge lets pass.
#[inline]
fn within(value: f64, limit: f64) -> bool {
    value.abs() <= limit * (1.0 + SHARE * LIMIT_TOLERANCE)
}

/// The larger of two numbers; NaN where the first or the second is.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if a.is_nan() || a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verify::violations_of;
    use crate::{
        Family, Method, Problem, Segment, ShortPathPolicy, plan_move, plan_trapezoid, plan_trigonometric,
    };

    /// Numbers in 0..1.
    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    /// A move of a family, and a little wrong at one place: by 10⁻¹⁶ to 1 of it.
    fn spoiled(random: &mut Random, problem: &Problem, family: Family) -> Profile {
        let planned = match family {
            Family::Trapezoidal => plan_trapezoid(problem),
            Family::Trigonometric => plan_trigonometric(problem),
            Family::SCurve | Family::Polynomial => plan_move(problem),
        };
        let planned = planned.unwrap();
        let mut pieces: alloc::vec::Vec<Segment> = planned.segments().into_iter().collect();
        let mut end = planned.reached();
        let index = (random.unit() * pieces.len() as f64) as usize;
        let by = 1.0 + libm::pow(10.0, -16.0 * random.unit()) * (random.unit() - 0.5);
        let piece = &mut pieces[index];
        match (random.unit() * 8.0) as u8 {
            0 => piece.duration *= by,
            1 => piece.start.position *= by,
            2 => piece.start.velocity *= by,
            3 => piece.start.acceleration *= by,
            4 => piece.law = piece.slowed(by).law,
            5 => end.position *= by,
            6 => end.velocity += by - 1.0,
            _ => {}
        }
        Profile::new(pieces, end)
    }

    /// The bound is one: of motions spoiled by a little or by much the judge passes all that pass here, and of those that he passes most do.
    #[test]
    fn whatever_is_plain_passes_the_judge() {
        let mut random = Random(7);
        let (mut plain, mut passed, mut failed) = (0, 0, 0);
        for number in 0..60_000 {
            let family = [Family::SCurve, Family::Trapezoidal, Family::Trigonometric][number % 3];
            let limits =
                Limits::symmetric(0.1 + random.unit(), 0.5 + random.unit(), 1.0 + 20.0 * random.unit());
            let spec = crate::LimitsSpec {
                max_deceleration: (number % 2 == 0).then_some(0.5 + random.unit()),
                max_position: (number % 5 == 0).then_some(3.0),
                ..limits.unwrap().spec().clone()
            };
            let limits = Limits::try_from(spec).unwrap();
            let speed = if number % 4 == 0 && family != Family::Trigonometric { 0.1 } else { 0.0 };
            let start = State { position: random.unit(), velocity: speed, acceleration: 0.0 };
            let goal = State { position: 1.5 + 1.5 * random.unit(), velocity: speed, acceleration: 0.0 };
            let problem = Problem::new(start, goal, limits, ShortPathPolicy::Reject).unwrap();
            let profile = spoiled(&mut random, &problem, family);
            let method = Method { family, order: family.order().unwrap_or_default(), ..Method::default() };
            let (limits, promise) = (problem.limits(), Promise::alone(method, problem.limits()));
            let judged = violations_of("", &profile, limits, goal, &promise);
            if is_plain(&profile, limits, goal, &promise) {
                assert_eq!(judged, [], "{profile:?}");
                plain += 1;
            }
            if judged.is_empty() { passed += 1 } else { failed += 1 }
        }
        assert!(failed > 10_000 && passed > 20_000, "{passed} {failed}");
        assert!(plain > passed * 4 / 5, "{plain} of {passed}");
    }
}
