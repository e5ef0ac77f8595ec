use arrayvec::ArrayVec;

use crate::{Classification, Law, Profile, Quantity, Segment, Setpoint, State};

/// The most pieces of a planned move: three to speed up, one to cruise, three to slow down.
pub const MAX_PIECES: usize = 7;

/// The answer to a [`Problem`](crate::Problem): pieces on the stack, and everything that is not as it was asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    pub(super) pieces: ArrayVec<Piece, MAX_PIECES>,
    pulses: Pulses,
    pub(super) reached: State,
    pub(super) adjustments: ArrayVec<Adjustment, 2>,
    pub(super) classification: Classification,
}

/// A segment whose law is one number, since the pulses of a move are all of one kind: copying seven that could be of any
/// law costs more than planning them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    pub(crate) duration: f64,
    pub(crate) start: State,
    /// The jerk of a rectangle, or the greatest of a cosine.
    pub(crate) jerk: f64,
}

/// What the jerk of a whole move is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pulses {
    Rectangles,
    Cosines,
}

impl Pulses {
    fn segment(self, Piece { duration, start, jerk }: Piece) -> Segment {
        let law = match self {
            Self::Cosines if jerk != 0.0 => Law::CosineJerk { peak: jerk },
            Self::Cosines | Self::Rectangles => Law::ConstantJerk(jerk),
        };
        Segment { duration, start, law }
    }
}

/// One condition that the plan does not meet as asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adjustment {
    /// What was changed.
    pub quantity: Quantity,
    /// The value that was asked for, in the unit of the quantity.
    pub asked: f64,
    /// The value in the plan.
    pub planned: f64,
    /// Why.
    pub reason: AdjustmentReason,
}

/// Why an [`Adjustment`] was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AdjustmentReason {
    /// The path is too short for the end velocity; by policy it became the start velocity, or ± a²/j from it.
    PathTooShortStartVelocity,
    /// The path is too short for the end velocity; by policy it became the nearest reachable one.
    PathTooShortNearestVelocity,
    /// The feed rate is above the velocity limit, which holds.
    FeedRateAboveLimit,
    /// The plan ends at speed, and a stop was put after it.
    ClosingStop,
    /// The time to a point is too short for its velocity, which became the nearest that can be reached.
    PvtTimeTooShort,
    /// No motion within the limits reaches a point with its velocity and at its time; by policy it is met otherwise.
    PvtOutOfReach,
    /// A point is met later, at the first time at which it can be.
    PvtTimeExtended,
    /// A point is met later, since another axis or a point before it took more time.
    PvtTimeShifted,
    /// The last point was not reached in time, and a move to it was put after the others.
    PvtFinishedLate,
    /// An override scales the velocity at the goal as it scales every other.
    Override,
}

impl AdjustmentReason {
    /// Every reason.
    pub const ALL: [Self; 10] = [
        Self::PathTooShortStartVelocity,
        Self::PathTooShortNearestVelocity,
        Self::FeedRateAboveLimit,
        Self::ClosingStop,
        Self::PvtTimeTooShort,
        Self::PvtOutOfReach,
        Self::PvtTimeExtended,
        Self::PvtTimeShifted,
        Self::PvtFinishedLate,
        Self::Override,
    ];

    /// The name on the wire.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::PathTooShortStartVelocity => "PATH_TOO_SHORT_START_VELOCITY",
            Self::PathTooShortNearestVelocity => "PATH_TOO_SHORT_NEAREST_VELOCITY",
            Self::FeedRateAboveLimit => "FEED_RATE_ABOVE_LIMIT",
            Self::ClosingStop => "CLOSING_STOP",
            Self::PvtTimeTooShort => "PVT_TIME_TOO_SHORT",
            Self::PvtOutOfReach => "PVT_OUT_OF_REACH",
            Self::PvtTimeExtended => "PVT_TIME_EXTENDED",
            Self::PvtTimeShifted => "PVT_TIME_SHIFTED",
            Self::PvtFinishedLate => "PVT_FINISHED_LATE",
            Self::Override => "OVERRIDE",
        }
    }
}

impl Move {
    /// A motion of constant jerk in pieces, which are to be laid into it: to copy them costs as much as to lay them.
    #[inline]
    pub(crate) fn of_rectangles(reached: State, adjustments: ArrayVec<Adjustment, 2>) -> Self {
        let (pieces, classification) = (ArrayVec::new(), Classification::default());
        Self { pieces, pulses: Pulses::Rectangles, reached, adjustments, classification }
    }

    /// The same where all is as asked.
    #[inline]
    pub(crate) fn of_rectangles_to(reached: State) -> Self {
        Self::of_rectangles(reached, ArrayVec::new())
    }

    /// A motion of cosine pulses that has no pieces yet.
    pub(crate) fn of_cosines(reached: State, adjustment: Option<Adjustment>) -> Self {
        let mut adjustments = ArrayVec::new();
        adjustments.extend(adjustment);
        let (pieces, classification) = (ArrayVec::new(), Classification::default());
        Self { pieces, pulses: Pulses::Cosines, reached, adjustments, classification }
    }

    /// Makes it another motion, to `reached`, that has no pieces yet.
    #[inline]
    pub(crate) fn begin(&mut self, reached: State) {
        self.pieces.clear();
        self.adjustments.clear();
        self.reached = reached;
    }

    /// Says what is not as asked.
    pub(crate) fn adjust(&mut self, adjustment: Adjustment) {
        self.adjustments.push(adjustment);
    }

    /// The pieces, to be laid.
    pub(crate) fn pieces(&mut self) -> &mut ArrayVec<Piece, MAX_PIECES> {
        &mut self.pieces
    }

    /// The pieces as laid.
    pub(crate) fn laid(&self) -> &[Piece] {
        &self.pieces
    }

    /// Names the shape.
    pub(crate) fn classify(&mut self, classification: Classification) {
        self.classification = classification;
    }

    /// The pieces, in order; none where nothing moves.
    #[must_use]
    pub fn segments(&self) -> ArrayVec<Segment, MAX_PIECES> {
        self.pieces.iter().map(|&piece| self.pulses.segment(piece)).collect()
    }

    /// How long the motion lasts \[s\].
    #[must_use]
    pub fn duration(&self) -> f64 {
        // Not `sum`, which is −0 where there is nothing to add.
        self.pieces.iter().fold(0.0, |total, piece| total + piece.duration)
    }

    /// The state at the end: the goal, but for what the adjustments say.
    #[must_use]
    pub fn reached(&self) -> State {
        self.reached
    }

    /// What is not as asked; empty where everything is.
    #[must_use]
    pub fn adjustments(&self) -> &[Adjustment] {
        &self.adjustments
    }

    /// The shape's names in the papers.
    #[must_use]
    pub fn classification(&self) -> Classification {
        self.classification
    }

    /// The setpoint at time `t` \[s\], with the bits of [`Profile::at`] and without its allocation.
    #[must_use]
    pub fn at(&self, t: f64) -> Setpoint {
        let mut begin = 0.0;
        for &piece in &self.pieces {
            let next = begin + piece.duration;
            if t < next {
                return if t < 0.0 {
                    Setpoint::held(piece.start)
                } else {
                    self.pulses.segment(piece).at(t - begin)
                };
            }
            begin = next;
        }
        Setpoint::held(self.reached)
    }

    /// Makes `profile` this motion, in the room that it has.
    pub(crate) fn lay_into(&self, profile: &mut Profile) {
        profile.begin_again(self.reached);
        for &piece in &self.pieces {
            match self.pulses {
                Pulses::Rectangles => profile.push_jerk(piece.duration, piece.start, piece.jerk),
                Pulses::Cosines => profile.push(&self.pulses.segment(piece)),
            }
        }
    }

    /// The motion as a profile of its own.
    #[must_use]
    pub fn to_profile(&self) -> Profile {
        Profile::new(self.pieces.iter().map(|&piece| self.pulses.segment(piece)), self.reached)
    }
}
