//! Several axes from any state to any state: each by itself, at one time, or on a straight line.
//!
//! At one time: the least duration that is no axis's blocked one (see [`Arrivals`](crate::Arrivals)). One axis is critical; it keeps its
//! fastest motion, and the others take as long. On a line: one motion of the leader, of which each axis has its share.

mod line;

use alloc::vec::Vec;

use crate::error::{Field, InvalidFields, Why};
use crate::grid;
use crate::limits::not_finite;
use crate::transfer::{check_duration, is_same_time};
use crate::{AxisTransfer, CycleTime, MAX_AXES, Synchronization, Transit};
use line::Line;

/// What a motion of several axes is to last, beyond what the limits make it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// The motion lasts this long at least \[s\], ≥ 0, and as little more as there can be; 0 asks nothing. Of axes that each move by
    /// themselves the slowest lasts so long.
    pub minimum_duration: f64,
    /// End on a whole number of these cycles, the first that there can be; of axes that each move by themselves each one.
    pub end_on: Option<CycleTime>,
}

/// How long a motion of several axes lasts, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Together {
    /// How long the motion lasts \[s\].
    pub duration: f64,
    /// The number of the axis that made it last so long: the slowest, or one that cannot take as little longer as the slowest would
    /// have it; none where that was [`Timing`]. On a line the one that leads.
    pub critical: Option<usize>,
}

/// Plans up to [`MAX_AXES`] axes, into `transits`, one for each and in the same order. Nothing is taken from the heap where `transits` has
/// room for them.
///
/// - [`Synchronization::None`]: each axis as fast as it can.
/// - [`Synchronization::Time`]: all arrive at once, as early as they can: in the least duration in which each of them can arrive, which may be
///   more than that of the slowest alone. The critical axis moves as fast as it can, the others as
///   [`AxisTransfer::lasting`] says.
/// - [`Synchronization::Phase`]: all on a straight line, as fast as the line allows: the limits of each, over its share of it.
///   Velocities and accelerations must be proportional to the distances.
///
/// ```
/// # use planner::{AxisTransfer, Bounds, State, Synchronization, Timing, Transfer, together};
/// let bounds = Bounds::symmetric(1.0, 2.0, 10.0)?;
/// let to = |goal: f64| Transfer::new(State::at_rest(0.0), State::at_rest(goal), bounds).map(AxisTransfer::from);
/// let mut transits = Vec::new();
/// let planned = together(&[to(1.0)?, to(3.0)?], Synchronization::Time, Timing::default(), &mut transits)?;
/// assert_eq!(planned.critical, Some(1));
/// assert_eq!(transits[0].duration(), transits[1].duration());
/// # Ok::<(), planner::InvalidFields>(())
/// ```
///
/// # Errors
/// All with the axis in the path. Those of [`AxisTransfer::fastest`]; [`Why::NoAxes`] and [`Why::TooManyAxes`]; a minimum duration that is none;
/// [`Why::TooManyCycles`], also of a duration beyond [`LONGEST`](crate::LONGEST); [`Why::ArrivesEarly`] where an axis that may not go back cannot take as long as
/// the others; on a line [`Why::OffTheLine`], with the value that would be on it,
/// and [`Why::SweptOffLimits`] of an acceleration that would take the axis beyond its velocity, as the line has less jerk to end it.
/// `transits` is then of no use.
pub fn together(
    axes: &[AxisTransfer<'_>],
    synchronization: Synchronization,
    timing: Timing,
    transits: &mut Vec<Transit>,
) -> Result<Together, InvalidFields> {
    check(axes, timing)?;
    match synchronization {
        Synchronization::None => apart(axes, timing, transits),
        Synchronization::Time => {
            plan_fastest(axes, transits)?;
            let least = slowest(transits);
            settle(axes, 0, least, timing, transits)
        }
        Synchronization::Phase => return in_line(axes, timing, transits),
    }
    .and_then(|planned| {
        check_ranges(axes, transits)?;
        Ok(planned)
    })
}

fn check(axes: &[AxisTransfer<'_>], timing: Timing) -> Result<(), InvalidFields> {
    let mut invalid = InvalidFields::default();
    let given = axes.len();
    if given == 0 {
        invalid.note("axes", Some(Why::NoAxes));
    } else if given > MAX_AXES {
        invalid.note("axes", Some(Why::TooManyAxes { given, allowed: MAX_AXES }));
    }
    let given = timing.minimum_duration;
    let wrong = not_finite(given).or((given < 0.0).then_some(Why::DurationNotPositive { given }));
    invalid.note("minimum_duration", wrong);
    invalid.into_result(())
}

/// Says of which axis a refusal is.
fn of_axis(index: usize) -> impl Fn(InvalidFields) -> InvalidFields {
    move |inner| {
        let mut invalid = InvalidFields::default();
        invalid.extend_within(&Field::element("axes", index), inner);
        invalid
    }
}

/// Into the places that there are already.
fn plan_fastest(axes: &[AxisTransfer<'_>], transits: &mut Vec<Transit>) -> Result<(), InvalidFields> {
    let mut invalid = InvalidFields::default();
    transits.resize_with(axes.len(), Transit::unlaid);
    for (index, (axis, transit)) in axes.iter().zip(transits).enumerate() {
        if let Err(inner) = axis.lay_quickest(transit) {
            invalid.extend_within(&Field::element("axes", index), inner);
        }
    }
    invalid.into_result(())
}

fn check_ranges(axes: &[AxisTransfer<'_>], transits: &[Transit]) -> Result<(), InvalidFields> {
    let mut invalid = InvalidFields::default();
    for (index, (axis, transit)) in axes.iter().zip(transits).enumerate() {
        if let Err(inner) = axis.check_range(transit) {
            invalid.extend_within(&Field::element("axes", index), inner);
        }
    }
    invalid.into_result(())
}

/// The longest of all, and whose it is.
fn slowest(transits: &[Transit]) -> Together {
    let mut slowest = Together { duration: 0.0, critical: None };
    for (index, transit) in transits.iter().enumerate() {
        let duration = transit.duration();
        if slowest.critical.is_none() || duration > slowest.duration {
            slowest = Together { duration, critical: Some(index) };
        }
    }
    slowest
}

/// Each axis by itself.
fn apart(
    axes: &[AxisTransfer<'_>],
    timing: Timing,
    transits: &mut Vec<Transit>,
) -> Result<Together, InvalidFields> {
    plan_fastest(axes, transits)?;
    let critical = slowest(transits).critical;
    let mut stretched = false;
    for index in 0..axes.len() {
        let is_slowest = critical == Some(index);
        let minimum_duration = if is_slowest { timing.minimum_duration } else { 0.0 };
        let least = Together { duration: transits[index].duration(), critical: Some(index) };
        let own = Timing { minimum_duration, ..timing };
        let range = index..=index;
        let settled = settle(&axes[range.clone()], index, least, own, &mut transits[range])?;
        stretched |= is_slowest && settled.critical.is_none();
    }
    let Together { duration, critical } = slowest(transits);
    Ok(Together { duration, critical: critical.filter(|_| !stretched) })
}

/// Makes all axes last equally long: the first duration from `least` on that is none's blocked one, and that `timing` allows. The
/// transits are the fastest, of which those that last so long already are kept. The first axis has the number `first_number`.
fn settle(
    axes: &[AxisTransfer<'_>],
    first_number: usize,
    least: Together,
    timing: Timing,
    transits: &mut [Transit],
) -> Result<Together, InvalidFields> {
    let mut agreed = least;
    if timing.minimum_duration > agreed.duration {
        agreed = Together { duration: timing.minimum_duration, critical: None };
    }
    let mut nudge = FIRST_NUDGE;
    // Each round but the last passes an interval, of which an axis has no more than MAX_BLOCKED, or doubles the nudge.
    'agreeing: loop {
        check_duration(agreed.duration)?;
        if let Some(cycle) = timing.end_on {
            let on_cycle = grid::whole(agreed.duration, cycle)?;
            if on_cycle > agreed.duration {
                agreed = Together { duration: on_cycle, critical: None };
            }
        }
        for (index, (axis, transit)) in (first_number..).zip(axes.iter().zip(transits.iter_mut())) {
            let given = agreed.duration;
            if is_same_time(given, transit.duration()) {
                transit.last(given);
            } else if !axis.lay_in(given, transit) {
                // It lasts no time until it is laid again.
                *transit = Transit::unlaid();
                let arrivals = axis.arrivals().map_err(of_axis(index))?;
                let first = arrivals.first_from(given);
                // At a border, which is as exact as its roundings, it may be a little more.
                let passes = first > given;
                if !passes {
                    nudge *= 2.0;
                }
                // Also true for NaN.
                let ends = first < f64::INFINITY && nudge < MOST_NUDGED;
                if !ends {
                    let greatest = arrivals.blocked().last().map_or(given, |blocked| blocked.after);
                    let why = Why::ArrivesEarly { given, greatest };
                    return Err(InvalidFields::one(Field::element("axes", index), why));
                }
                let duration = if passes { first } else { given * (1.0 + nudge) };
                agreed = Together { duration, critical: Some(index) };
                continue 'agreeing;
            }
        }
        return Ok(agreed);
    }
}

/// Of a duration \[1\]: what it is raised by where a border of a blocked interval turns out to be inside it by a rounding; then by twice
/// as much.
const FIRST_NUDGE: f64 = f64::EPSILON;

/// Of a duration \[1\]: a border is known better than that.
const MOST_NUDGED: f64 = 1e-6;

/// All axes on a straight line.
fn in_line(
    axes: &[AxisTransfer<'_>],
    timing: Timing,
    transits: &mut Vec<Transit>,
) -> Result<Together, InvalidFields> {
    let line = Line::of(axes)?;
    let of_leader = of_axis(line.leader());
    let question = line.question().map_err(&of_leader)?;
    let mut path = [question.quickest().map_err(&of_leader)?];
    let least = Together { duration: path[0].duration(), critical: Some(line.leader()) };
    let settled = settle(&[question], line.leader(), least, timing, &mut path)?;
    transits.clear();
    transits.extend(axes.iter().enumerate().map(|(index, axis)| line.share_of(index, axis, &path[0])));
    check_ranges(axes, transits)?;
    Ok(settled)
}
