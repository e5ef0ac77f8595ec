use arrayvec::ArrayVec;

use super::course::{Course, MAX_TRANSIT_PIECES, Stroke};
use crate::error::{Field, InvalidFields, Why};
use crate::float::largest;
use crate::limits::GREATEST_MAGNITUDE;
use crate::profile::add_up;
use crate::solve::Piece;
use crate::{JOIN_TOLERANCE, Law, Profile, Segment, Setpoint, State};

/// Of the extent of a motion \[1\]: what its two ends may be apart where they meet.
const GAP: f64 = 1e-12;

/// Of the extent of a motion \[1\]: a gap that is known to [`GAP`] of it.
const MOST_CLOSED: f64 = 1e3;

/// Of what the pieces of a motion go, each by its speed and by its acceleration \[1\]: a way that the solver takes for none.
const SOLVED: f64 = 2048.0 * f64::EPSILON;

/// Of the positions \[1\]: what their distance is rounded to.
const POSITION_ROUNDED: f64 = 8.0 * f64::EPSILON;

/// Of the fastest of a motion \[1\]: what the velocity of its longest piece is rounded to.
const CRAWL_ROUNDED: f64 = 64.0 * f64::EPSILON;

/// The motion from one state to another: pieces of constant jerk, on the stack.
#[derive(Clone, Debug, PartialEq)]
pub struct Transit {
    pieces: ArrayVec<Piece, MAX_TRANSIT_PIECES>,
    start: State,
    goal: State,
}

impl Transit {
    /// Of no piece yet: the place that one is laid into, since to copy it costs as much as to lay two of its pieces.
    pub(crate) fn unlaid() -> Self {
        Self { pieces: ArrayVec::new(), start: State::at_rest(0.0), goal: State::at_rest(0.0) }
    }

    /// Lays the pieces of a course end to end, those up to the anchor forward from the start, those after it backward from the
    /// goal, each relative to its own end, so that both are met to the last bit, and what rounding there is meets in the middle. It
    /// lasts `duration` \[s\], where that is given.
    ///
    /// # Errors
    /// Where that is more than a rounding: the parts of the motion are so many decades apart that numbers do not have the digits.
    /// What is laid is then of no use.
    pub(super) fn lay(
        &mut self,
        start: State,
        goal: State,
        course: &Course,
        duration: Option<f64>,
    ) -> Result<(), InvalidFields> {
        (self.start, self.goal) = (start, goal);
        self.pieces.clear();
        let (forward, backward) = course.strokes.split_at(course.anchor);
        let mut at = State { position: 0.0, ..start };
        for &Stroke { jerk, time, acceleration, velocity } in forward {
            at.acceleration = acceleration.unwrap_or(at.acceleration);
            at.velocity = velocity.unwrap_or(at.velocity);
            self.push(jerk, time, start.position, at);
            at = at.after(jerk, time);
        }
        let (seam, met) = (self.pieces.len(), at.position);
        let mut begins: ArrayVec<State, MAX_TRANSIT_PIECES> = ArrayVec::new();
        let mut at = State { position: 0.0, ..goal };
        for &Stroke { jerk, time, acceleration, .. } in backward.iter().rev() {
            if let Some(held) = acceleration.filter(|_| jerk == 0.0) {
                at.acceleration = held;
            }
            at = at.after(jerk, -time);
            at.acceleration = acceleration.unwrap_or(at.acceleration);
            begins.push(at);
        }
        for (&Stroke { jerk, time, .. }, &at) in backward.iter().zip(begins.iter().rev()) {
            self.push(jerk, time, goal.position, at);
        }
        let comes_from = begins.last().map_or(0.0, |begin| begin.position);
        let mut gap = (met - comes_from) - (goal.position - start.position);
        if let Some(Piece { duration, start: first, .. }) = self.pieces.first_mut() {
            let (velocity, acceleration) =
                (start.velocity - first.velocity, start.acceleration - first.acceleration);
            gap += *duration * (velocity + 0.5 * *duration * acceleration);
            *first = start;
        }
        if let Some(duration) = duration {
            self.last(duration);
        }
        let closed = self.close(seam.max(1), gap, duration.is_none());
        if closed { Ok(()) } else { Err(too_far_apart()) }
    }

    /// One motion, a wait at rest where it ends, and another from there; none where they have too many pieces.
    pub(super) fn joined(first: &Self, wait: f64, last: &Self) -> Option<Self> {
        let waits = Piece { duration: wait, start: first.goal, jerk: 0.0 };
        let waits = Some(waits).filter(|waits| waits.duration > 0.0);
        let mut joined = Self { pieces: ArrayVec::new(), start: first.start, goal: last.goal };
        for piece in first.pieces.iter().copied().chain(waits).chain(last.pieces.iter().copied()) {
            joined.pieces.try_push(piece).ok()?;
        }
        Some(joined)
    }

    /// Closes a gap where both ends meet, which goes so far beyond, by the longest piece; says whether it could.
    ///
    /// Where a motion is fast, and for long slow or all but steady, what its velocity is rounded to is a way that counts: it has the
    /// longest piece a little slower. Or, where the duration is free, that piece is a little shorter, over which its velocity does not
    /// change by more than roundings, and which still joins the next.
    fn close(&mut self, seam: usize, gap: f64, is_free: bool) -> bool {
        let Self { start, goal, .. } = *self;
        // Of this the positions know nothing.
        let unseen = POSITION_ROUNDED * largest(start.position.abs(), goal.position.abs());
        if gap.abs() <= GAP * (goal.position - start.position).abs() + unseen {
            return true;
        }
        let most = |part: &dyn Fn(&State) -> f64| {
            self.pieces.iter().fold(0.0, |most, piece| largest(most, part(&piece.start).abs()))
        };
        let distance = (goal.position - start.position).abs();
        // Also of a piece that turns on its way.
        let extent = self.pieces.iter().fold(distance, |most, piece| {
            let turns = piece.jerk != 0.0 || self.pieces.len() < 3;
            let goes = if turns { piece.start.velocity.abs() * piece.duration } else { 0.0 };
            largest(most, largest(goes, (piece.start.position - start.position).abs()))
        });
        let longest = (0..self.pieces.len())
            .max_by(|&one, &other| self.pieces[one].duration.total_cmp(&self.pieces[other].duration));
        let Some(longest) = longest.filter(|_| gap.abs() > GAP * extent + unseen) else { return true };
        // On a short last flank the gap is what the solver takes for none: little against what speeds and accelerations go.
        let goes = self.pieces.iter().fold(0.0, |sum, Piece { duration, start, .. }| {
            sum + duration * (start.velocity.abs() + duration * start.acceleration.abs())
        });
        let allowed = JOIN_TOLERANCE * extent + unseen + SOLVED * goes;
        if gap.abs() > MOST_CLOSED * extent {
            return gap.abs() <= allowed;
        }
        let (fastest, hardest) = (most(&|state| state.velocity), most(&|state| state.acceleration));
        let rounding = CRAWL_ROUNDED * fastest;
        let Piece { duration, start, jerk } = &mut self.pieces[longest];
        let after = |time: f64| State { position: 0.0, ..*start }.after(*jerk, time);
        let end = after(*duration);
        let (slower, shorter) = (gap / *duration, gap / end.velocity);
        let cut = after(*duration - shorter);
        // Also false for NaN.
        let still_joins = (cut.position - end.position + gap).abs() <= JOIN_TOLERANCE * extent
            && (cut.velocity - end.velocity).abs() <= JOIN_TOLERANCE * fastest
            && (cut.acceleration - end.acceleration).abs() <= JOIN_TOLERANCE * hardest;
        if longest > 0 && slower.abs() <= rounding {
            start.velocity -= slower;
        } else if is_free
            && shorter.abs() <= 0.5 * *duration
            && (start.acceleration * shorter).abs() <= rounding
            && still_joins
        {
            *duration -= shorter;
        } else {
            return gap.abs() <= allowed;
        }
        let (between, shift) =
            if longest < seam { (longest + 1..seam, -gap) } else { (seam..longest + 1, gap) };
        for piece in &mut self.pieces[between] {
            piece.start.position += shift;
        }
        true
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

    /// Makes it last `duration` \[s\], of which it is some roundings short or long.
    pub(crate) fn last(&mut self, duration: f64) {
        add_up(self.pieces.iter_mut().map(|piece| &mut piece.duration), duration);
    }

    /// Are all of its numbers such as the planner takes? A motion is planned on from any of its states, and read back from its pieces.
    pub(super) fn check_numbers(&self) -> Result<(), InvalidFields> {
        let size = |piece: &Piece| largest(piece.start.position.abs(), piece.start.velocity.abs());
        let fits = self.pieces.iter().all(|piece| size(piece) <= GREATEST_MAGNITUDE);
        if fits { Ok(()) } else { Err(self.beyond_numbers()) }
    }

    /// Where it leaves the numbers.
    #[cold]
    fn beyond_numbers(&self) -> InvalidFields {
        let mut farthest = (self.start.position, 0.0);
        let mut time = 0.0;
        for piece in &self.pieces {
            if piece.start.position.abs() > farthest.0.abs() {
                farthest = (piece.start.position, time);
            }
            time += piece.duration;
        }
        let (reached, time) = farthest;
        let (allowed, limit) = if reached < 0.0 {
            (-GREATEST_MAGNITUDE, "limits.min_position")
        } else {
            (GREATEST_MAGNITUDE, "limits.max_position")
        };
        InvalidFields::one(Field::default(), Why::PositionLimit { reached, time, allowed, limit })
    }

    /// The share of it that an axis moves that goes from `start` to `goal`. The motion begins at zero; each piece is placed from the end
    /// that is nearer.
    pub(crate) fn shared(&self, share: f64, start: State, goal: State) -> Self {
        let length = self.goal.position;
        let mut shared = Self { pieces: ArrayVec::new(), start, goal };
        for &Piece { duration, start: State { position, velocity, acceleration }, jerk } in &self.pieces {
            let rest = position - length;
            let position = if position.abs() <= rest.abs() {
                start.position + share * position
            } else {
                goal.position + share * rest
            };
            let start = State { position, velocity: share * velocity, acceleration: share * acceleration };
            shared.pieces.push(Piece {
                duration,
                start: start.with_positive_zeros(),
                jerk: share * jerk + 0.0,
            });
        }
        if let Some(first) = shared.pieces.first_mut() {
            first.start = start;
        }
        shared
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

    /// Makes `profile` this motion, in the room that it has.
    pub(crate) fn lay_into(&self, profile: &mut Profile) {
        profile.begin_again(self.goal);
        for &Piece { duration, start, jerk } in &self.pieces {
            profile.push_jerk(duration, start, jerk);
        }
    }

    /// The motion as a profile of its own.
    #[must_use]
    pub fn to_profile(&self) -> Profile {
        Profile::new(self.pieces.iter().map(segment), self.goal)
    }
}

#[cold]
fn too_far_apart() -> InvalidFields {
    let what = "a motion of which some parts are faster than others by more digits than numbers have";
    let instead = "bring the limits and the states closer together";
    InvalidFields::one(Field::default(), Why::NotImplemented { what, instead })
}

fn segment(&Piece { duration, start, jerk }: &Piece) -> Segment {
    Segment { duration, start, law: Law::ConstantJerk(jerk) }
}
