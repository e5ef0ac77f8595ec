use planner::Setpoint;
use proto::stream::{Columns, Tracking};

use crate::player::Player;

/// Commanded and measured values of consecutive cycles; cycles past the last of the motion are those of the settle
/// window.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// The first of them.
    pub first_cycle: u64,
    /// The setpoints.
    pub commanded: Columns,
    /// How the axes followed them.
    pub tracking: Tracking,
    /// Where the loads were [axis units], axis by axis like the columns.
    pub load_position: Vec<f64>,
}

/// Samples on their way out of the cycle thread: written row by row into room that was made before, and used again.
#[derive(Debug)]
pub(crate) struct Chunk {
    first_cycle: u64,
    axes: usize,
    most_cycles: usize,
    rows: Vec<Row>,
    lateness_ns: Vec<i32>,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    setpoint: Setpoint,
    measured_position: f64,
    following_error: f64,
    load_position: f64,
}

impl Chunk {
    pub(crate) fn with_room_for(cycles: usize, axes: usize) -> Self {
        Self {
            first_cycle: 0,
            axes,
            most_cycles: cycles,
            rows: Vec::with_capacity(cycles * axes),
            lateness_ns: Vec::with_capacity(cycles),
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.lateness_ns.is_empty()
    }

    pub(crate) fn is_full(&self) -> bool {
        self.lateness_ns.len() == self.most_cycles
    }

    /// Adds the cycle that `player` has just done, if there is room.
    pub(crate) fn note(&mut self, player: &Player, lateness_ns: u64) {
        if self.is_full() {
            return;
        }
        if self.is_empty() {
            self.first_cycle = player.cycle_number();
        }
        self.rows.extend(player.setpoints().iter().zip(player.observations()).map(|(setpoint, seen)| Row {
            setpoint: *setpoint,
            measured_position: seen.measured_position,
            following_error: seen.following_error,
            load_position: seen.load_position,
        }));
        self.lateness_ns.push(i32::try_from(lateness_ns).unwrap_or(i32::MAX));
    }

    pub(crate) fn clear(&mut self) {
        self.rows.clear();
        self.lateness_ns.clear();
    }

    /// The samples, axis by axis.
    pub(crate) fn read(&self) -> Samples {
        let (cycles, axes) = (self.lateness_ns.len(), self.axes);
        let by_axis = || (0..axes).flat_map(|axis| self.rows.iter().skip(axis).step_by(axes));
        let mut commanded = Columns::with_capacity(cycles, axes);
        by_axis().for_each(|row| commanded.push(row.setpoint));
        Samples {
            first_cycle: self.first_cycle,
            commanded,
            tracking: Tracking {
                first_cycle: self.first_cycle,
                cycles: cycles as u32,
                measured_position: by_axis().map(|row| row.measured_position).collect(),
                following_error: by_axis().map(|row| row.following_error).collect(),
                cycle_jitter_ns: self.lateness_ns.clone(),
            },
            load_position: by_axis().map(|row| row.load_position).collect(),
        }
    }
}
