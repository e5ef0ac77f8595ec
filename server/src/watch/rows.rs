use std::collections::VecDeque;

use planner::Setpoint;
use proto::stream::{Columns, Tracking};
use recording::Measured;

use super::decimate::kept;

/// What a watcher has been told and has not been shown, cycle by cycle: commanded, and measured beside it once it is known.
#[derive(Debug)]
pub(super) struct Rows {
    axes: usize,
    rows: VecDeque<Row>,
}

/// One cycle of all axes.
#[derive(Debug)]
pub(super) struct Row {
    pub(super) cycle: u64,
    pub(super) setpoints: Vec<Setpoint>,
    pub(super) measured: Option<Measured>,
}

/// Columns of a message.
#[derive(Debug, Default)]
pub(super) struct Shown {
    pub(super) cycles: Vec<u64>,
    pub(super) commanded: Columns,
    pub(super) tracking: Option<Tracking>,
}

/// How many cycles are held back for what the axis says of them: it reports every twenty or so, in chunks of fifty.
const PATIENCE: usize = 250;
/// The most cycles that are kept; older ones are lost.
const MOST: usize = 1 << 16;

impl Rows {
    pub(super) fn of_axes(axes: usize) -> Self {
        Self { axes, rows: VecDeque::new() }
    }

    /// Takes what was commanded from `first_cycle` on. Says how many cycles are lost for want of room.
    pub(super) fn command(&mut self, first_cycle: u64, commanded: &Columns) -> usize {
        for (index, cycle) in (0..commanded.cycles()).zip(first_cycle..) {
            self.rows.push_back(Row { cycle, setpoints: commanded.cycle(index).collect(), measured: None });
        }
        let lost = self.rows.len().saturating_sub(MOST);
        self.rows.drain(..lost);
        lost
    }

    /// Takes how the axis followed. What is not as many numbers as it says, or of cycles that are not here, is left out.
    pub(super) fn measure(&mut self, tracking: &Tracking) {
        let cycles = tracking.cycles as usize;
        let Tracking { measured_position, following_error, .. } = tracking;
        let wanted = cycles.checked_mul(self.axes);
        if cycles == 0 || [measured_position.len(), following_error.len()].map(Some) != [wanted; 2] {
            return;
        }
        let Some(first) = self.rows.front().map(|row| row.cycle) else { return };
        for index in 0..cycles {
            // A peer says which cycles these are: any number may come.
            let Some(cycle) = tracking.first_cycle.checked_add(index as u64) else { return };
            let place = cycle.checked_sub(first).and_then(|place| usize::try_from(place).ok());
            let Some(row) = place.and_then(|place| self.rows.get_mut(place)) else { continue };
            let of_axes = |column: &[f64]| (0..self.axes).map(|axis| column[axis * cycles + index]).collect();
            row.measured = Some(Measured {
                positions: of_axes(measured_position),
                following_errors: of_axes(following_error),
                cycle_jitter_ns: tracking.cycle_jitter_ns.get(index).copied().unwrap_or_default(),
            });
        }
    }

    /// Takes out what is complete: what the axis has not said anything about yet stays for a while, and at the `end` nothing does.
    pub(super) fn take(&mut self, end: bool) -> Vec<Row> {
        let ready = match self.rows.iter().rposition(|row| row.measured.is_some()) {
            Some(last) if !end => last + 1,
            None if self.rows.len() < PATIENCE && !end => 0,
            // The end; or it has ceased to say, or never has.
            Some(_) | None => self.rows.len(),
        };
        self.rows.drain(..ready).collect()
    }

    /// Takes out what can be shown: at most `most` cycles of what is complete.
    pub(super) fn show(&mut self, most: usize, end: bool) -> Shown {
        let mut rows = self.take(end);
        let measured = rows.iter().any(|row| row.measured.is_some());
        if measured {
            // Those that it had executed before it was asked to say.
            rows.retain(|row| row.measured.is_some());
        }
        let places = kept(&self.columns(&rows), rows.len(), most);
        let rows: Vec<&Row> = places.into_iter().filter_map(|place| rows.get(place)).collect();
        let mut commanded = Columns::with_capacity(rows.len(), self.axes);
        for axis in 0..self.axes {
            rows.iter().for_each(|row| commanded.push(row.setpoints.get(axis).copied().unwrap_or_default()));
        }
        Shown {
            cycles: rows.iter().map(|row| row.cycle).collect(),
            commanded,
            tracking: measured.then(|| self.tracking(&rows)),
        }
    }

    fn tracking(&self, rows: &[&Row]) -> Tracking {
        let measured: Vec<&Measured> = rows.iter().filter_map(|row| row.measured.as_ref()).collect();
        let by_axis = |of: fn(&Measured) -> &Vec<f64>| {
            (0..self.axes).flat_map(|axis| measured.iter().map(move |row| of(row)[axis])).collect()
        };
        Tracking {
            first_cycle: rows.first().map_or(0, |row| row.cycle),
            cycles: rows.len() as u32,
            measured_position: by_axis(|row| &row.positions),
            following_error: by_axis(|row| &row.following_errors),
            cycle_jitter_ns: measured.iter().map(|row| row.cycle_jitter_ns).collect(),
        }
    }

    /// What the extremes are of, what matters most first.
    fn columns(&self, rows: &[Row]) -> Vec<Vec<f64>> {
        let measured = |axis: usize, of: fn(&Measured) -> &Vec<f64>| -> Vec<f64> {
            rows.iter().map(|row| row.measured.as_ref().map_or(f64::NAN, |row| of(row)[axis])).collect()
        };
        let commanded = |axis: usize, word: usize| -> Vec<f64> {
            rows.iter().map(|row| row.setpoints.get(axis).map_or(f64::NAN, |at| at.words()[word])).collect()
        };
        let axes = || 0..self.axes;
        let errors = axes().map(|axis| measured(axis, |row| &row.following_errors));
        let velocities = axes().map(|axis| commanded(axis, 1));
        let positions = axes().flat_map(|axis| [commanded(axis, 0), measured(axis, |row| &row.positions)]);
        let others = axes().flat_map(|axis| [commanded(axis, 2), commanded(axis, 3)]);
        errors.chain(velocities).chain(positions).chain(others).collect()
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "numbers that are exact")]
mod tests {
    use super::*;
    use planner::State;

    fn commanded(cycles: std::ops::Range<u64>, axes: usize) -> Columns {
        let mut columns = Columns::with_capacity(cycles.clone().count(), axes);
        for axis in 0..axes {
            for cycle in cycles.clone() {
                let state = State::at_rest(cycle as f64 + 1000.0 * axis as f64);
                columns.push(Setpoint { state, jerk: 0.0 });
            }
        }
        columns
    }

    fn tracking(cycles: std::ops::Range<u64>, axes: usize) -> Tracking {
        let count = cycles.clone().count();
        let column: Vec<f64> = (0..axes)
            .flat_map(|axis| cycles.clone().map(move |c| c as f64 + 1000.0 * axis as f64 - 0.5))
            .collect();
        Tracking {
            first_cycle: cycles.start,
            cycles: count as u32,
            measured_position: column,
            following_error: vec![0.5; axes * count],
            cycle_jitter_ns: vec![7; count],
        }
    }

    #[test]
    fn measured_stands_beside_commanded() {
        let mut rows = Rows::of_axes(2);
        assert_eq!(rows.command(1, &commanded(1..31, 2)), 0);
        assert!(rows.show(100, false).cycles.is_empty(), "the axis has not said yet");
        // It was asked while it was in cycle 10.
        rows.measure(&tracking(10..21, 2));
        let shown = rows.show(100, false);
        assert_eq!(shown.cycles, (10..21).collect::<Vec<_>>());
        let tracking = shown.tracking.unwrap();
        for (index, cycle) in (10..21).enumerate() {
            for axis in 0..2 {
                let at = shown.commanded.at(axis, index).unwrap().state.position;
                assert_eq!(at - tracking.measured_position[axis * 11 + index], 0.5, "{cycle}");
            }
        }
        // The rest is shown when there is no more to come.
        assert_eq!(rows.show(100, true).cycles, (21..31).collect::<Vec<_>>());
    }

    #[test]
    fn who_does_not_say_is_shown_all_the_same_and_what_makes_no_sense_is_not() {
        let mut rows = Rows::of_axes(1);
        rows.command(1, &commanded(1..400, 1));
        rows.measure(&Tracking { first_cycle: 5, cycles: u32::MAX, ..Tracking::default() });
        rows.measure(&Tracking { first_cycle: u64::MAX, ..tracking(0..3, 1) });
        let shown = rows.show(100, false);
        assert!((2..=100).contains(&shown.cycles.len()) && shown.tracking.is_none(), "{:?}", shown.cycles);
    }

    #[test]
    fn there_is_room_for_so_many() {
        let mut rows = Rows::of_axes(1);
        let most = MOST as u64;
        assert_eq!(rows.command(1, &commanded(1..most + 3, 1)), 2);
    }
}
