use arrayvec::ArrayVec;

use crate::error::{Field, InvalidFields, Why};
use crate::float::{largest, least, sqrt};
use crate::transfer::Within;
use crate::{
    AxisTransfer, Bounds, BoundsSpec, LIMIT_TOLERANCE, Limits, LimitsSpec, MAX_AXES, State, Transfer, Transit,
};

/// Of a part of a state \[1\]: how far from the line it may be, since it was computed. The pieces of the axis are apart by as much.
const ON_THE_LINE: f64 = 1e-12;

/// Of the positions \[1\]: what their distance is rounded to.
const POSITION_ROUNDED: f64 = 4.0 * f64::EPSILON;

/// The line on which all axes stay: a coordinate that is the leader's, from zero at the start, and each axis's share of it. From zero,
/// so that nothing is rounded to what positions are rounded to.
#[derive(Clone, Debug)]
pub(super) struct Line {
    leader: usize,
    shares: ArrayVec<f64, MAX_AXES>,
    start: State,
    goal: State,
    may: May,
}

/// What the line may do: limits where all axes have some, so that speeding up and slowing down are told apart.
#[derive(Clone, Debug)]
enum May {
    Bounds(Bounds),
    Limits(Limits),
}

impl May {
    fn of(axes: &[AxisTransfer<'_>], shares: &[f64]) -> Result<Self, InvalidFields> {
        let shares =
            if shares.iter().all(|share| *share == 0.0) { &[1.0; MAX_AXES][..axes.len()] } else { shares };
        let common = bounds(axes, shares);
        let mut ramps = (f64::INFINITY, f64::INFINITY);
        for (axis, share) in axes.iter().zip(shares).filter(|(_, share)| **share != 0.0) {
            let Within::Limits { limits, .. } = axis.within() else {
                return Bounds::try_from(common).map(Self::Bounds);
            };
            let size = share.abs();
            ramps =
                (least(ramps.0, limits.acceleration() / size), least(ramps.1, limits.deceleration() / size));
        }
        let limits = LimitsSpec {
            max_velocity: common.max_velocity,
            max_velocity_reverse: Some(0.0 - common.min_velocity),
            max_acceleration: ramps.0,
            max_deceleration: Some(ramps.1),
            max_jerk: common.max_jerk,
            ..LimitsSpec::default()
        };
        Limits::try_from(limits).map(Self::Limits)
    }

    fn jerk(&self) -> f64 {
        match self {
            Self::Bounds(bounds) => bounds.spec().max_jerk,
            Self::Limits(limits) => limits.jerk(),
        }
    }
}

/// A part of the states of an axis: its name, its value, and what it is rounded to.
type Part = (&'static str, f64, f64);

/// The distance first: it is the direction, if there is one.
fn parts(axis: &AxisTransfer<'_>) -> [Part; 5] {
    let (start, goal) = (axis.start(), axis.goal());
    let rounding = POSITION_ROUNDED * largest(start.position.abs(), goal.position.abs());
    [
        ("goal.position", goal.position - start.position, rounding),
        ("start.velocity", start.velocity, 0.0),
        ("goal.velocity", goal.velocity, 0.0),
        ("start.acceleration", start.acceleration, 0.0),
        ("goal.acceleration", goal.acceleration, 0.0),
    ]
}

impl Line {
    /// # Errors
    /// [`Why::OffTheLine`] for each part of a state that is not proportional to the distances; [`Why::SweptOffLimits`] of an
    /// acceleration that the line cannot end in time, though the axis could.
    pub(super) fn of(axes: &[AxisTransfer<'_>]) -> Result<Self, InvalidFields> {
        let (leader, which) = direction(axes);
        let leading = axes.get(leader).map(parts).unwrap_or_default();
        let shares: ArrayVec<f64, MAX_AXES> =
            axes.iter().map(|axis| share(parts(axis), leading, which)).collect();
        let mut invalid = InvalidFields::default();
        for (index, (axis, &share)) in axes.iter().zip(&shares).enumerate() {
            note_axis(&mut invalid, index, off_the_line(parts(axis), leading, share));
        }
        let [distance, from, to, begins, ends] = leading.map(|(_, value, _)| value);
        let start = State { position: 0.0, velocity: from, acceleration: begins };
        let goal = State { position: distance, velocity: to, acceleration: ends };
        if !invalid.is_empty() {
            return Err(invalid);
        }
        let may = May::of(axes, &shares)?;
        let slowest = slowest(axes, &shares);
        for (index, (axis, &share)) in axes.iter().zip(&shares).enumerate() {
            note_axis(&mut invalid, index, swept_off(axis, share.abs() * may.jerk(), slowest));
        }
        invalid.into_result(())?;
        Ok(Self { leader, shares, start, goal, may })
    }

    /// The axis whose coordinate the line's is.
    pub(super) fn leader(&self) -> usize {
        self.leader
    }

    /// From the start of the line to its goal.
    pub(super) fn question(&self) -> Result<AxisTransfer<'_>, InvalidFields> {
        match &self.may {
            May::Bounds(bounds) => Transfer::new(self.start, self.goal, *bounds).map(AxisTransfer::from),
            May::Limits(limits) => AxisTransfer::within_limits(self.start, self.goal, limits),
        }
    }

    /// An axis's share of a motion along the line.
    pub(super) fn share_of(&self, index: usize, axis: &AxisTransfer<'_>, path: &Transit) -> Transit {
        path.shared(self.shares[index], axis.start(), axis.goal())
    }
}

/// A path is spelt only where there is something to say of it.
fn note_axis(invalid: &mut InvalidFields, index: usize, inner: InvalidFields) {
    if !inner.is_empty() {
        invalid.extend_within(&Field::element("axes", index), inner);
    }
}

/// Does the acceleration at the start sweep an axis beyond its limit of velocity that by itself would stay inside, since the line has only
/// `jerk` to end it, that of the axis `slowest`? One that is beyond anyway is led back, as fast as the line can.
fn swept_off(axis: &AxisTransfer<'_>, jerk: f64, slowest: usize) -> InvalidFields {
    let BoundsSpec { min_velocity, max_velocity, max_jerk, .. } = axis.signed();
    let State { velocity, acceleration, .. } = axis.start();
    let backward = acceleration < 0.0;
    let (sign, limit) = if backward { (-1.0, -min_velocity) } else { (1.0, max_velocity) };
    let allowed = limit + 0.5 * LIMIT_TOLERANCE * limit.abs();
    let swept = |jerk: f64| sign * velocity + 0.5 * acceleration * acceleration / jerk;
    let mut invalid = InvalidFields::default();
    if jerk > 0.0 && acceleration != 0.0 && swept(max_jerk) <= allowed && swept(jerk) > allowed {
        let why = Why::SweptOffLimits {
            given: acceleration,
            allowed: sign * sqrt(2.0 * jerk * largest(0.0, limit - sign * velocity)) + 0.0,
            limit: limit_of_velocity(axis, backward),
            slowest,
        };
        invalid.note("start.acceleration", Some(why));
    }
    invalid
}

/// The name of the limit of velocity, as it was stated.
fn limit_of_velocity(axis: &AxisTransfer<'_>, backward: bool) -> &'static str {
    match axis.within() {
        Within::Bounds(_) if backward => "bounds.min_velocity",
        Within::Bounds(_) => "bounds.max_velocity",
        Within::Limits { limits, .. } if backward && limits.spec().max_velocity_reverse.is_some() => {
            "limits.max_velocity_reverse"
        }
        Within::Limits { .. } => "limits.max_velocity",
    }
}

/// The axis whose jerk is the line's.
fn slowest(axes: &[AxisTransfer<'_>], shares: &[f64]) -> usize {
    let jerk = |index: usize| axes[index].signed().max_jerk / shares[index].abs();
    (0..axes.len()).fold(0, |least, index| if jerk(index) < jerk(least) { index } else { least })
}

/// The axis that leads, and the number of the part that is the direction: the first that is not zero for all, and there the largest.
fn direction(axes: &[AxisTransfer<'_>]) -> (usize, usize) {
    for which in 0..5 {
        let size = |index: usize| parts(&axes[index])[which].1.abs();
        let leader =
            (0..axes.len()).fold(0, |most, index| if size(index) > size(most) { index } else { most });
        if !axes.is_empty() && size(leader) > 0.0 {
            return (leader, which);
        }
    }
    (0, 0)
}

/// How much of the leader's motion the axis makes, by the part that is the direction; but where far positions round a small distance to fewer
/// digits than the line asks for, by the first part that has them.
fn share(parts: [Part; 5], leading: [Part; 5], which: usize) -> f64 {
    let of = |part: usize| if leading[part].1 == 0.0 { 0.0 } else { parts[part].1 / leading[part].1 };
    let is_rounded = |(_, value, rounding): Part| rounding > 0.25 * ON_THE_LINE * value.abs();
    let is_known = |part: &usize| {
        let (own, leader) = (parts[*part], leading[*part]);
        own.1 != 0.0 && leader.1 != 0.0 && !is_rounded(own) && !is_rounded(leader)
    };
    let is_vague = parts[which].1 != 0.0 && !is_known(&which);
    let other = is_vague.then(|| (0..parts.len()).find(is_known)).flatten();
    of(other.unwrap_or(which))
}

/// Every part that is not the axis's share of the leader's.
fn off_the_line(parts: [Part; 5], leading: [Part; 5], share: f64) -> InvalidFields {
    let mut invalid = InvalidFields::default();
    for ((name, given, rounding), (_, of_leader, leader_rounding)) in parts.into_iter().zip(leading) {
        let needed = share * of_leader;
        let slack =
            ON_THE_LINE * largest(given.abs(), needed.abs()) + rounding + share.abs() * leader_rounding;
        let off = (given - needed).abs() > slack;
        invalid.note(name, off.then_some(Why::OffTheLine { given, needed }));
    }
    invalid
}

/// What an axis allows along the line, of which it moves its share: each limit divided by that.
fn along(axis: &AxisTransfer<'_>, share: f64) -> BoundsSpec {
    let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } =
        axis.signed();
    let (velocities, accelerations) = if share < 0.0 {
        ((max_velocity, min_velocity), (max_acceleration, min_acceleration))
    } else {
        ((min_velocity, max_velocity), (min_acceleration, max_acceleration))
    };
    BoundsSpec {
        min_velocity: velocities.0 / share,
        max_velocity: velocities.1 / share,
        min_acceleration: accelerations.0 / share,
        max_acceleration: accelerations.1 / share,
        max_jerk: max_jerk / share.abs(),
    }
}

/// What all axes allow. Those whose share is zero allow everything.
fn bounds(axes: &[AxisTransfer<'_>], shares: &[f64]) -> BoundsSpec {
    let free = f64::INFINITY;
    let everything = BoundsSpec {
        min_velocity: -free,
        max_velocity: free,
        min_acceleration: -free,
        max_acceleration: free,
        max_jerk: free,
    };
    let moving = axes.iter().zip(shares).filter(|(_, share)| **share != 0.0);
    moving.map(|(axis, &share)| along(axis, share)).fold(everything, |all, one| BoundsSpec {
        min_velocity: largest(all.min_velocity, one.min_velocity),
        max_velocity: least(all.max_velocity, one.max_velocity),
        min_acceleration: largest(all.min_acceleration, one.min_acceleration),
        max_acceleration: least(all.max_acceleration, one.max_acceleration),
        max_jerk: least(all.max_jerk, one.max_jerk),
    })
}
