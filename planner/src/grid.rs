//! Moves from rest to rest that end on a cycle.
//!
//! # Every switch on a cycle
//!
//! The three times of an S-curve rounded up, the jerk lowered to fit.
//!
//! ```text
//!          cycle  0     1     2     3     4     5     6     7     8
//! jerk     J  ┌───┼──┐  ┆     ┆     ┆     ┆     ┆     ┆     ┆ ┌───┼──┐
//!             │   ┆  │  ┆     ┆     the fastest  ┆     ┆     ┆
//!          J′ ┌─────────┐     ┆     ┆     ┆     ┆     ┆     ┆
//!             │   ┆     │     ┆     on whole cycles
//!             └───┴─────┴──
//! ```
//!
//! A shape of three times is three boxes in turn, `s = J·t_j·t_a·t_v` ([`Shape`]). With each time rounded up to whole
//! cycles, `J′ = s/(n_j·n_a·n_v·Ts³)` covers the same distance exactly:
//!
//! ```text
//! n_j = ⌈t_j/Ts⌉      n_a = max(n_j, ⌈t_a/Ts⌉)      n_v = max(n_j + n_a, ⌈t_v/Ts⌉)
//! ```
//!
//! *All limits are kept.* With `N_j = n_j·Ts ≥ t_j` and so on, and `s = J·t_j·t_a·t_v` for both:
//!
//! ```text
//! jerk          J′          = J·(t_j/N_j)·(t_a/N_a)·(t_v/N_v)  ≤ J
//! acceleration  J′·N_j      = J·t_j·(t_a/N_a)·(t_v/N_v)        ≤ J·t_j      ≤ A
//! velocity      J′·N_j·N_a  = s/N_v  ≤  s/t_v                  = J·t_j·t_a  ≤ V
//! ```
//!
//! The price is less than four cycles: `n_j` and `n_a` grow by less than one each, `n_v` by less than one or by what both do.
//!
//! *Two ramps that differ* ([`plan_move`]), since speeding up and slowing down have limits of their own: with `u = n_j + n_a` cycles for
//! the one, `d` for the other and `n_c` for the cruise the distance is `v′·(u/2 + n_c + d/2)·Ts`, for a ramp takes its
//! half of the peak on the mean. With both ramps rounded up,
//!
//! ```text
//! n_c = max(0, ⌈(t_u/2 + t_c + t_d/2)/Ts − (u + d)/2⌉)      v′ = s/((u/2 + n_c + d/2)·Ts) ≤ v      J′ = v′/(n_j·n_a·Ts²)
//! ```
//!
//! and each ramp keeps its limits: `J′ ≤ v/(t_j·t_a) ≤ J`, and its acceleration `v′/(n_a·Ts) ≤ v/t_a`. Equal ramps have
//! `n_v = n_j + n_a + n_c`, and the formulas above. The price is again less than four cycles.
//!
//! # The end alone
//!
//! A motion of any family is slowed as a whole ([`slowed`]): `λ = n·Ts/T` times the time divides derivative k by `λᵏ`. That costs
//! less than one cycle.
//!
//! Source: the idea that a jerk is a vector with a time resolution of one cycle is from Blejan and Blejan (2020), section 5, who round
//! the times and keep the jerk, and so end 0.2 and 0.27 mm short of 50 mm.
//!
//! ```
//! use planner::{CycleTime, Limits, grid};
//!
//! // 50 mm at 0.25 m/s, 3 m/s², 100 m/s³.
//! let limits = Limits::symmetric(0.25, 3.0, 100.0)?;
//! let whole = grid::rest_to_rest(0.05, &limits, CycleTime::MILLISECOND).ok_or("too long")?;
//! assert_eq!(whole.total_cycles(), 314); // the fastest takes 313.33 ms
//! assert!((whole.jerk() - 99.206_349_206_349_2).abs() < 1e-12);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use arrayvec::ArrayVec;

use crate::error::{Field, InvalidFields, Why};
use crate::float::{largest, least};
use crate::generator::{AxisLimits, Shape, seen_from_the_end};
use crate::{CycleTime, LAST_CYCLE, Law, Limits, MAX_PIECES, Profile, Segment, State};

pub use crate::solve::plan_move_on_cycles as plan_move;

/// A move that switches and ends on whole cycles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WholeCycles {
    /// n_j, n_a and n_v.
    jerk_cycles: u64,
    acceleration_cycles: u64,
    velocity_cycles: u64,
    cycle_time: CycleTime,
    /// The same in seconds, and J′.
    shape: Shape,
}

/// A ramp that was rounded up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RampCycles {
    /// n_j and n_a.
    pub(crate) jerk: u64,
    pub(crate) acceleration: u64,
}

impl RampCycles {
    /// The ramp whose jerk lasts `jerk_time`, and goes on the other way `acceleration_time` after its beginning \[s\].
    pub(crate) fn of(jerk_time: f64, acceleration_time: f64, cycle_time: CycleTime) -> Option<Self> {
        let jerk = cycles(jerk_time, cycle_time)?;
        let acceleration = cycles(acceleration_time, cycle_time)?.max(jerk);
        Some(Self { jerk, acceleration })
    }

    /// How long the ramp lasts.
    pub(crate) fn total(self) -> u64 {
        self.jerk + self.acceleration
    }
}

/// A time in whole cycles, at least one: a move without any length still takes its cycles. A time that is whole but for its
/// roundings is whole.
fn cycles(seconds: f64, cycle_time: CycleTime) -> Option<u64> {
    cycle_time.count(seconds).map(|count| count.max(1))
}

/// The end of the last cycle of a motion that lasts `seconds` \[s\].
pub(crate) fn whole(seconds: f64, cycle_time: CycleTime) -> Result<f64, InvalidFields> {
    let too_many = || InvalidFields::one(Field::default(), Why::TooManyCycles { seconds });
    cycle_time.count(seconds).map(|count| cycle_time.start_of(count)).ok_or_else(too_many)
}

/// `profile`, a motion from rest to rest, slowed so that it lasts a whole number of cycles; and by what factor.
///
/// # Errors
/// [`Why::TooManyCycles`] where they cannot be counted.
pub fn slowed(profile: &Profile, cycle_time: CycleTime) -> Result<(Profile, f64), InvalidFields> {
    let seconds = profile.duration();
    let whole = whole(seconds, cycle_time)?;
    if whole == 0.0 {
        return Ok((profile.clone(), 1.0));
    }
    // One that is whole but for its roundings may be long by them.
    let factor = largest(1.0, whole / seconds);
    Ok((profile.slowed(factor).lasting(whole), factor))
}

/// The fastest move of its kind over `distance` [axis units], signed. `None` where there is nothing to go, where `limits`
/// forbid the direction, and beyond [`LAST_CYCLE`].
///
/// Cruises at the feed rate, and takes the lesser of acceleration and deceleration for both ramps.
#[must_use]
pub fn rest_to_rest(distance: f64, limits: &Limits, cycle_time: CycleTime) -> Option<WholeCycles> {
    let limits = AxisLimits {
        velocity: limits.cruise_towards(distance),
        acceleration: least(limits.acceleration(), limits.deceleration()),
        jerk: limits.jerk(),
    };
    if limits.velocity == 0.0 {
        return None;
    }
    let fastest = Shape::rest_to_rest(distance, &limits)?;
    WholeCycles::over(distance, &fastest, &limits, cycle_time)
}

impl WholeCycles {
    /// `fastest`, the shape over `distance` within `limits`, rounded up to whole cycles. `None` beyond [`LAST_CYCLE`].
    pub(crate) fn over(
        distance: f64,
        fastest: &Shape,
        limits: &AxisLimits<f64>,
        cycle_time: CycleTime,
    ) -> Option<Self> {
        let ramp = RampCycles::of(fastest.jerk_time, fastest.acceleration_time, cycle_time)?;
        let RampCycles { jerk: jerk_cycles, acceleration: acceleration_cycles } = ramp;
        let velocity_cycles = cycles(fastest.velocity_time, cycle_time)?.max(ramp.total());
        if jerk_cycles + acceleration_cycles + velocity_cycles > LAST_CYCLE {
            return None;
        }
        let seconds = |cycles| cycle_time.start_of(cycles);
        let (n_j, n_a, n_v) = (seconds(jerk_cycles), seconds(acceleration_cycles), seconds(velocity_cycles));
        let exact = distance.abs() / n_v / n_a / n_j;
        // Where a time was whole but for its roundings, J′ is J but for its own. The limits come first: both ends are met
        // anyway, and the middle takes up a few ε of the distance.
        let allowed = least(limits.jerk, least(limits.acceleration / n_j, limits.velocity / n_j / n_a));
        let jerk = least(exact, allowed);
        let shape = Shape {
            jerk_time: n_j,
            acceleration_time: n_a,
            velocity_time: n_v,
            jerk: if distance < 0.0 { -jerk } else { jerk },
            case: fastest.case,
        };
        Some(Self { jerk_cycles, acceleration_cycles, velocity_cycles, cycle_time, shape })
    }

    /// n_j: for how many cycles the first jerk lasts.
    #[must_use]
    pub fn jerk_cycles(&self) -> u64 {
        self.jerk_cycles
    }

    /// n_a: from the first jerk to the second, in cycles.
    #[must_use]
    pub fn acceleration_cycles(&self) -> u64 {
        self.acceleration_cycles
    }

    /// n_v: from one ramp to the other, in cycles.
    #[must_use]
    pub fn velocity_cycles(&self) -> u64 {
        self.velocity_cycles
    }

    /// How many cycles the move lasts.
    #[must_use]
    pub fn total_cycles(&self) -> u64 {
        self.jerk_cycles + self.acceleration_cycles + self.velocity_cycles
    }

    /// J′ [axis units/s³], with the sign of the distance; never larger than the limit.
    #[must_use]
    pub fn jerk(&self) -> f64 {
        self.shape.jerk
    }

    /// The move in closed form; its case is that of the fastest.
    #[must_use]
    pub fn shape(&self) -> &Shape {
        &self.shape
    }

    /// For how many cycles each of the seven pieces lasts; zero where a piece is left out.
    #[must_use]
    pub fn cycles(&self) -> [u64; MAX_PIECES] {
        let jerk = self.jerk_cycles;
        let hold = self.acceleration_cycles - jerk;
        let cruise = self.velocity_cycles - self.acceleration_cycles - jerk;
        [jerk, hold, jerk, cruise, jerk, hold, jerk]
    }

    /// How long each of the seven pieces lasts \[s\].
    #[must_use]
    pub fn durations(&self) -> [f64; MAX_PIECES] {
        self.cycles().map(|cycles| self.cycle_time.start_of(cycles))
    }

    /// The pieces, from `start` to `reached`, which lie as far apart as the move goes.
    ///
    /// Laid forward from the start up to the cruise and backward from the end after it, so that both ends are met to the
    /// last bit.
    #[must_use]
    pub fn segments(&self, start: State, reached: State) -> ArrayVec<Segment, MAX_PIECES> {
        let rising = self.shape.rising().map(|(_, piece)| piece);
        let [first, second, third, top] = rising;
        let forward = rising.map(|piece| (start.position, piece.start, piece.jerk));
        let backward = [(top, third.jerk), (third, second.jerk), (second, first.jerk)]
            .map(|(piece, jerk)| (reached.position, seen_from_the_end(piece.start), jerk));
        let pieces = forward.into_iter().chain(backward).zip(self.durations());
        let laid = pieces.filter(|(_, duration)| *duration > 0.0).map(|((origin, from, jerk), duration)| {
            let start = State { position: origin + from.position, ..from };
            Segment { duration, start, law: Law::ConstantJerk(jerk) }
        });
        laid.collect()
    }
}
