use arrayvec::ArrayVec;

use super::ends::Phases;
use super::fastest::Shape;
use super::lead_in::LeadIn;
use super::{BoundsSpec, Transfer};
use crate::solve::Piece;
use crate::{Law, Profile, Segment, Setpoint, State};

/// The most pieces of a [`Transit`]: two to lead a start back into its limits, and seven.
pub const MAX_TRANSIT_PIECES: usize = 9;

/// The jerk of each phase, of the limit.
const SIGNS: Phases = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0];

/// The motion from one state to another: pieces of constant jerk, on the stack.
#[derive(Clone, Debug, PartialEq)]
pub struct Transit {
    pieces: ArrayVec<Piece, MAX_TRANSIT_PIECES>,
    start: State,
    goal: State,
}

impl Transit {
    /// Lays the pieces end to end: up to the cruise forward from the start, after it backward from the goal, each relative to its
    /// own end, so that both are met to the last bit, and what rounding there is meets in the middle. An acceleration that is held
    /// is the limit itself: what little it were off by would add up.
    ///
    /// `unit` is the time unit \[s\] of the shape.
    pub(super) fn lay(transfer: &Transfer, lead: &LeadIn, shape: &Shape, unit: f64) -> Self {
        let Transfer { start, goal, bounds } = *transfer;
        let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
            *bounds.spec();
        let Shape { sign, mut phases } = *shape;
        if phases[3] == 0.0 {
            phases[2] += phases[4];
            phases[4] = 0.0;
        }
        let jerks = SIGNS.map(|of_limit| of_limit * sign * max_jerk + 0.0);
        let held = |near: f64| if near < 0.0 { min_acceleration } else { max_acceleration };

        let mut transit = Self { pieces: ArrayVec::new(), start, goal };
        let mut at = State { position: 0.0, ..start };
        let lead = lead.pieces.iter().map(|&(sign, time)| (sign * max_jerk, time * unit));
        for (jerk, time) in lead.chain((0..3).map(|index| (jerks[index], phases[index] * unit))) {
            if jerk == 0.0 && time > 0.0 {
                at.acceleration = held(at.acceleration);
            }
            transit.push(jerk, time, start.position, at);
            at = at.after(jerk, time);
        }
        let cruise = if sign < 0.0 { min_velocity } else { max_velocity };
        transit.push(
            0.0,
            phases[3] * unit,
            start.position,
            State { velocity: cruise, acceleration: 0.0, ..at },
        );

        let [.., fall, hold, climb] = phases.map(|phase| phase * unit);
        let [.., falling, _, climbing] = jerks;
        let seventh = State { position: 0.0, ..goal }.after(climbing, -climb);
        let sixth = if hold > 0.0 {
            State { acceleration: held(falling), ..seventh }.after(0.0, -hold)
        } else {
            seventh
        };
        let fifth = State { acceleration: 0.0, ..sixth.after(falling, -fall) };
        transit.push(falling, fall, goal.position, fifth);
        transit.push(0.0, hold, goal.position, sixth);
        transit.push(climbing, climb, goal.position, seventh);
        if let Some(first) = transit.pieces.first_mut() {
            first.start = start;
        }
        transit
    }

    /// Goes on with the piece before where the jerk stays the same.
    fn push(&mut self, jerk: f64, duration: f64, origin: f64, at: State) {
        if duration > 0.0 {
            match self.pieces.last_mut() {
                #[expect(clippy::float_cmp, reason = "one of three numbers")]
                Some(last) if last.jerk == jerk => last.duration += duration,
                _ => self.pieces.push(Piece {
                    duration,
                    start: State { position: origin + at.position, ..at }.with_positive_zeros(),
                    jerk,
                }),
            }
        }
    }

    pub(crate) fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The pieces, in order; none where nothing moves.
    #[must_use]
    pub fn segments(&self) -> ArrayVec<Segment, MAX_TRANSIT_PIECES> {
        self.pieces.iter().map(segment).collect()
    }

    /// How long the motion lasts \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.pieces.iter().fold(0.0, |total, piece| total + piece.duration)
    }

    /// The state before the motion.
    #[must_use]
    pub fn start(&self) -> State {
        self.start
    }

    /// The state at the end: the goal.
    #[must_use]
    pub fn end(&self) -> State {
        self.goal
    }

    /// The setpoint at time `t` \[s\], with the bits of [`Profile::at`] and without its allocation.
    #[must_use]
    pub fn at(&self, t: f64) -> Setpoint {
        if t < 0.0 {
            return Setpoint::held(self.start);
        }
        let mut begin = 0.0;
        for piece in &self.pieces {
            let next = begin + piece.duration;
            if t < next {
                return segment(piece).at(t - begin);
            }
            begin = next;
        }
        Setpoint::held(self.goal)
    }

    /// The motion as a profile of its own.
    #[must_use]
    pub fn to_profile(&self) -> Profile {
        Profile::new(self.pieces.iter().map(segment), self.goal)
    }
}

fn segment(&Piece { duration, start, jerk }: &Piece) -> Segment {
    Segment { duration, start, law: Law::ConstantJerk(jerk) }
}
