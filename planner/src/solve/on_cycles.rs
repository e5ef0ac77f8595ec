//! The S-curve from rest to rest on whole cycles: its two ramps rounded up, as [`grid`](crate::grid) derives.

use arrayvec::ArrayVec;

use super::lane::Lane;
use super::planned::{MAX_PIECES, Move};
use super::ramp::Ramp;
use super::s_curve::Shape;
use super::{adjusted, classify, pieces};
use crate::error::{Field, InvalidFields, Why};
use crate::float::least;
use crate::grid::RampCycles;
use crate::profile::add_up;
use crate::{Classification, CycleTime, LAST_CYCLE, Problem};

/// The S-curve from rest to rest each piece of which lasts whole cycles, and so does the whole.
///
/// Less than four cycles longer than [`plan_move`](crate::plan_move), whose names of the shape it keeps: a hold or a cruise of
/// less than a cycle may be gone. The jerk is a little less than its limit, and differs from one ramp to the other where their limits do.
///
/// ```
/// # use planner::{grid, CycleTime, Limits, Problem, ShortPathPolicy, State};
/// let limits = Limits::symmetric(0.25, 3.0, 100.0)?;
/// let problem = Problem::new(State::at_rest(0.0), State::at_rest(0.05), limits, ShortPathPolicy::Reject)?;
/// let planned = grid::plan_move(&problem, CycleTime::MILLISECOND)?;
/// assert!((planned.duration() - 0.314).abs() < 1e-15); // the fastest takes 313.33 ms
/// # Ok::<(), planner::InvalidFields>(())
/// ```
///
/// # Errors
/// [`Why::NotImplemented`] for a start or a goal at speed; [`Why::TooManyCycles`] where they cannot be counted.
pub fn plan_move_on_cycles(problem: &Problem, cycle_time: CycleTime) -> Result<Move, InvalidFields> {
    note_speeds(problem)?;
    let direction = problem.direction();
    let lane = Lane::of(problem, direction);
    let (reached, adjustments) = adjusted(problem, direction, 0.0, None);
    let mut planned = Move::of_rectangles(reached, adjustments);
    if lane.length == 0.0 {
        return Ok(planned);
    }
    let fastest = lane.solve();
    let seconds = fastest.up.time() + fastest.cruise + fastest.down.time();
    let too_many = || InvalidFields::one(Field::default(), Why::TooManyCycles { seconds });
    let whole = Whole::of(&fastest, cycle_time).ok_or_else(too_many)?;
    let (shape, jerks) = whole.shape(&lane, &fastest, cycle_time);
    pieces::lay(&mut planned.pieces, &shape, problem.start(), reached, direction, jerks);
    let mut durations: ArrayVec<f64, MAX_PIECES> =
        planned.pieces.iter().map(|piece| piece.duration).collect();
    add_up(&mut durations, cycle_time.start_of(whole.total()));
    for (piece, duration) in planned.pieces.iter_mut().zip(durations) {
        piece.duration = duration;
    }
    planned.classification = Classification { feed_rate: shape.peak, ..classify(&lane, &fastest) };
    Ok(planned)
}

/// Reports every end that is not at rest.
pub(crate) fn note_speeds(problem: &Problem) -> Result<(), InvalidFields> {
    let mut invalid = InvalidFields::default();
    let gap = |velocity: f64| {
        let instead =
            "rest at both ends, or leave end_on_cycle out: the plan's last cycle is then its end state";
        (velocity != 0.0)
            .then_some(Why::NotImplemented { what: "ending on a cycle from or to a speed", instead })
    };
    invalid.note("start.velocity", gap(problem.start().velocity));
    invalid.note("goal.velocity", gap(problem.goal().velocity));
    invalid.into_result(())
}

/// Both ramps and the cruise in cycles.
struct Whole {
    up: RampCycles,
    cruise: u64,
    down: RampCycles,
}

impl Whole {
    /// `None` beyond [`LAST_CYCLE`].
    fn of(fastest: &Shape, cycle_time: CycleTime) -> Option<Self> {
        let ramp = |ramp: &Ramp| RampCycles::of(ramp.jerk_time, ramp.jerk_time + ramp.hold_time, cycle_time);
        let (up, down) = (ramp(&fastest.up)?, ramp(&fastest.down)?);
        let ramps = up.total().checked_add(down.total())?;
        // Half a cycle is added on both sides of the difference where the ramps take an odd number.
        let mean = 0.5 * (fastest.up.time() + fastest.down.time()) + fastest.cruise;
        let odd = ramps % 2;
        let mean = cycle_time.count(mean + 0.5 * cycle_time.start_of(odd))?;
        let whole = Self { up, cruise: mean.saturating_sub((ramps + odd) / 2), down };
        (whole.total() <= LAST_CYCLE).then_some(whole)
    }

    fn total(&self) -> u64 {
        self.up.total() + self.cruise + self.down.total()
    }

    /// The same in seconds, and the jerks of both ramps, none of which is above its limit.
    fn shape(&self, lane: &Lane, fastest: &Shape, cycle_time: CycleTime) -> (Shape, [f64; 2]) {
        let halves = self.up.total() + 2 * self.cruise + self.down.total();
        let peak = least(lane.length / (0.5 * cycle_time.start_of(halves)), lane.cruise);
        let ramp = |ramp: RampCycles, acceleration: f64| {
            let jerk_time = cycle_time.start_of(ramp.jerk);
            let acceleration = least(peak / cycle_time.start_of(ramp.acceleration), acceleration);
            let hold_time = cycle_time.start_of(ramp.acceleration - ramp.jerk);
            (Ramp { jerk_time, hold_time }, least(acceleration / jerk_time, lane.jerk))
        };
        let (up, up_jerk) = ramp(self.up, lane.acceleration);
        let (down, down_jerk) = ramp(self.down, lane.deceleration);
        let cruise = cycle_time.start_of(self.cruise);
        (Shape { up, cruise, down, peak, ..*fastest }, [up_jerk, down_jerk])
    }
}
