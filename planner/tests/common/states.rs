//! Motions between two states, drawn to hurt.

use planner::{Bounds, BoundsSpec, State, Transfer};

use super::random::Random;

/// A question before it is checked.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Question {
    pub(crate) start: State,
    pub(crate) goal: State,
    pub(crate) bounds: BoundsSpec,
}

impl Question {
    pub(crate) fn bounds(&self) -> Bounds {
        Bounds::try_from(self.bounds).unwrap()
    }

    pub(crate) fn transfer(&self) -> Transfer {
        Transfer::new(self.start, self.goal, self.bounds()).unwrap()
    }

    /// Seen from the other side; none where the other side is forbidden.
    pub(crate) fn mirrored(&self) -> Option<Self> {
        let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
            self.bounds;
        let bounds = BoundsSpec {
            min_velocity: -max_velocity,
            max_velocity: -min_velocity,
            min_acceleration: -max_acceleration,
            max_acceleration: -min_acceleration,
            max_jerk,
        };
        (min_velocity < 0.0).then(|| Self {
            start: self.start.mirrored(),
            goal: self.goal.mirrored(),
            bounds,
        })
    }

    /// Run backwards, and seen from the other side, so that velocities keep their signs.
    pub(crate) fn reversed(&self) -> Self {
        let back =
            |state: State| State { position: -state.position, acceleration: -state.acceleration, ..state };
        let BoundsSpec { min_acceleration, max_acceleration, .. } = self.bounds;
        let bounds = BoundsSpec {
            min_acceleration: -max_acceleration,
            max_acceleration: -min_acceleration,
            ..self.bounds
        };
        Self { start: back(self.goal), goal: back(self.start), bounds }
    }

    /// In a unit of length that is smaller by `length`, and a unit of time that is smaller by `time`.
    pub(crate) fn scaled(&self, length: f64, time: f64) -> Self {
        let velocity = length / time;
        let acceleration = velocity / time;
        let state = |state: State| State {
            position: state.position * length,
            velocity: state.velocity * velocity,
            acceleration: state.acceleration * acceleration,
        };
        let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
            self.bounds;
        let bounds = BoundsSpec {
            min_velocity: min_velocity * velocity,
            max_velocity: max_velocity * velocity,
            min_acceleration: min_acceleration * acceleration,
            max_acceleration: max_acceleration * acceleration,
            max_jerk: max_jerk * (acceleration / time),
        };
        Self { start: state(self.start), goal: state(self.goal), bounds }
    }
}

/// What kind of questions to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// All of order one, inside the bounds.
    Ordinary,
    /// Limits over eight decades, and as far as they go.
    Decades,
    /// Small integers and round decimals.
    Round,
    /// At limits, at each other, at zero, or an ulp beside.
    Borders,
    /// Tiny changes of tiny parts.
    Tiny,
    /// The start beyond the bounds, in one part or more.
    Outside,
    /// The next state on the way of an earlier motion.
    Underway,
}

impl Kind {
    pub(crate) const ALL: [Self; 7] = [
        Self::Ordinary,
        Self::Decades,
        Self::Round,
        Self::Borders,
        Self::Tiny,
        Self::Outside,
        Self::Underway,
    ];
}

fn pick(random: &mut Random, from: &[f64]) -> f64 {
    from[random.bits() as usize % from.len()]
}

fn sign(random: &mut Random) -> f64 {
    if random.bits().is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// `value`, a few floats further.
pub(crate) fn nudged(value: f64, ulps: i32) -> f64 {
    (0..ulps.abs()).fold(value, |value, _| if ulps > 0 { value.next_up() } else { value.next_down() })
}

/// `value`, up to two floats to the side; zero is left alone.
fn beside(random: &mut Random, value: f64) -> f64 {
    let ulps = (random.bits() % 5) as i32 - 2;
    if value == 0.0 { value } else { nudged(value, ulps) }
}

fn limits(random: &mut Random, kind: Kind) -> BoundsSpec {
    let mut one = || match kind {
        Kind::Decades => random.decades(1e-4, 1e4),
        Kind::Round => {
            pick(random, &[0.1, 0.2, 0.25, 0.3, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 8.0, 10.0, 20.0, 100.0])
        }
        _ => random.decades(0.1, 10.0),
    };
    let (max_velocity, min_velocity, max_acceleration, min_acceleration, jerk) =
        (one(), -one(), one(), -one(), one());
    let alike = random.bits();
    let min_velocity = if alike.is_multiple_of(2) { -max_velocity } else { min_velocity };
    let min_acceleration = if (alike / 2).is_multiple_of(2) { -max_acceleration } else { min_acceleration };
    let max_jerk = if kind == Kind::Borders && (alike / 4).is_multiple_of(4) {
        // a²/j is the velocity, or half of it.
        beside(random, max_acceleration * max_acceleration / max_velocity)
    } else {
        jerk
    };
    BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk }
}

/// Velocity and acceleration within bounds, also before and after it.
fn moving(random: &mut Random, kind: Kind, bounds: &BoundsSpec) -> (f64, f64) {
    let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } = *bounds;
    let part = |random: &mut Random, low: f64, high: f64| match kind {
        Kind::Round => {
            let tenths = (random.bits() % 21) as f64 / 10.0 - 1.0;
            if tenths < 0.0 { -tenths * low } else { tenths * high }
        }
        Kind::Borders => match random.bits() % 6 {
            0 => 0.0,
            1 => low,
            2 => high,
            3 => beside(random, 0.5 * high),
            _ => random.between(low, high),
        },
        Kind::Tiny => 1e-9 * random.between(low, high),
        _ => match random.bits() % 4 {
            0 => 0.0,
            _ => random.between(low, high),
        },
    };
    let mut velocity = part(random, min_velocity, max_velocity);
    let mut acceleration = part(random, min_acceleration, max_acceleration);
    // What full jerk takes the acceleration to zero over, in either direction of time.
    let room = (max_velocity - velocity).min(velocity - min_velocity).max(0.0);
    let most = (2.0 * max_jerk * room).sqrt();
    if acceleration.abs() > most {
        if kind == Kind::Borders && random.bits().is_multiple_of(2) {
            acceleration = most.copysign(acceleration) * (1.0 - 1e-15);
        } else if random.bits().is_multiple_of(2) {
            acceleration = most.copysign(acceleration) * random.unit();
        } else {
            let square = 0.5 * acceleration * acceleration / max_jerk;
            let (low, high) = (min_velocity + square, max_velocity - square);
            if low < high { velocity = random.between(low, high) } else { acceleration = 0.0 }
        }
    }
    (velocity, acceleration)
}

/// Refused, since no cycles can count it.
fn lasts_too_long(asked: &Question) -> bool {
    let refused = planner::plan_transfer(&asked.transfer()).err();
    refused.is_some_and(|refused| {
        refused.as_slice().iter().any(|one| matches!(one.why, planner::Why::TooManyCycles { .. }))
    })
}

/// One question of a kind.
pub(crate) fn question(random: &mut Random, kind: Kind) -> Question {
    let bounds = limits(random, kind);
    let BoundsSpec { max_velocity, max_acceleration, max_jerk, .. } = bounds;
    let (mut v0, mut a0) = moving(random, kind, &bounds);
    let (mut vf, mut af) = moving(random, kind, &bounds);
    if kind == Kind::Borders {
        match random.bits() % 8 {
            0 => (vf, af) = (v0, a0),
            1 => (vf, af) = (v0, -a0),
            2 => vf = beside(random, v0).clamp(bounds.min_velocity, bounds.max_velocity),
            _ => {}
        }
        let square = 0.5 * af * af / max_jerk;
        let inside = bounds.min_acceleration <= af && af <= bounds.max_acceleration;
        if !inside || vf + square > bounds.max_velocity || vf - square < bounds.min_velocity {
            af = 0.0;
        }
    }
    if kind == Kind::Outside {
        let times = |random: &mut Random| sign(random) * random.decades(1.0, 4.0);
        match random.bits() % 4 {
            0 => v0 = max_velocity * times(random),
            1 => a0 = max_acceleration * times(random),
            2 => (v0, a0) = (max_velocity * times(random), max_acceleration * times(random)),
            _ => a0 = sign(random) * max_acceleration,
        }
    }
    // A length that this much velocity, acceleration and jerk take about as long for.
    let time = (max_velocity / max_acceleration)
        .max(max_acceleration / max_jerk)
        .max(v0.abs().max(vf.abs()) / max_acceleration);
    let natural = max_velocity * time;
    let distance = match kind {
        Kind::Round => (random.between(-50.0, 50.0)).round() * pick(random, &[0.01, 0.1, 1.0]),
        Kind::Tiny => natural * sign(random) * random.decades(1e-12, 1e-6),
        Kind::Borders if random.bits().is_multiple_of(3) => {
            pick(random, &[0.0, 1e-12, 1e-15, 1e6, -1e6, 1.0])
        }
        _ => sign(random) * natural * random.decades(1e-3, 30.0),
    };
    let from = match random.bits() % 4 {
        0 => random.between(-10.0, 10.0),
        _ => 0.0,
    };
    let start = State { position: from, velocity: v0, acceleration: a0 };
    let goal = State { position: from + distance, velocity: vf, acceleration: af };
    let asked = Question { start, goal, bounds };
    if kind == Kind::Decades && lasts_too_long(&asked) {
        return question(random, kind);
    }
    if kind != Kind::Underway {
        return asked;
    }
    let on_the_way = planner::plan_transfer(&asked.transfer()).unwrap();
    let at = on_the_way.at(on_the_way.duration() * random.unit()).state;
    let (vf, af) = if random.bits().is_multiple_of(2) { (0.0, 0.0) } else { (vf, af) };
    let goal = match random.bits() % 3 {
        0 => asked.goal,
        1 => State {
            position: asked.goal.position * random.between(-1.0, 2.0),
            velocity: vf,
            acceleration: af,
        },
        _ => State {
            position: at.position + natural * random.between(-0.1, 0.1),
            velocity: vf,
            acceleration: af,
        },
    };
    Question { start: at, goal, bounds }
}
