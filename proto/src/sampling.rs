use planner::Accepted;

use crate::stream::Columns;
use crate::{Digest, Reason, Rejected};

/// Cycles in one chunk.
const CHUNK_CYCLES: u64 = 1000;

/// Consecutive cycles of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Chunk {
    /// The first of them.
    pub first_cycle: u64,
    /// The setpoints.
    pub columns: Columns,
    /// Of the plan's setpoints from cycle 1 through the last of the columns.
    pub digest: Digest,
}

/// A plan that is being read out, chunk by chunk.
///
/// The digest runs from cycle 1, whatever is asked for, so what comes before the first cycle is read too, and not given.
#[derive(Clone, Debug)]
pub struct Sampling {
    plan: Accepted,
    first: u64,
    last: u64,
    next: u64,
    digest: Digest,
}

impl Sampling {
    /// Reads `cycles` cycles from `first` on, or to the end of the plan for 0, or where they are more than there are.
    ///
    /// # Errors
    /// [`Reason::ValueOutOfRange`] where the plan has no cycle `first`.
    pub fn new(plan: Accepted, first: u64, cycles: u64) -> Result<Self, Rejected> {
        let end = plan.plan().cycle_count();
        if first > end {
            let description = format!("is {first}, past the last cycle of the plan: give 0 to {end}");
            let rejected = Rejected::for_field("first_cycle", Reason::ValueOutOfRange, description);
            return Err(rejected.with("given", first).with("nearest", end));
        }
        let last = if cycles == 0 { end } else { end.min(first.saturating_add(cycles - 1)) };
        Ok(Self { plan, first, last, next: 0, digest: Digest::ZERO })
    }

    /// The last cycle that will be read.
    #[must_use]
    pub fn last_cycle(&self) -> u64 {
        self.last
    }

    /// Is everything read?
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.next > self.last
    }

    /// Reads on by a chunk; `None` if that was before the first cycle, or if everything is read.
    pub fn read(&mut self) -> Option<Chunk> {
        if self.is_over() {
            return None;
        }
        let from = self.next;
        let asked_for = from >= self.first;
        let bound = if asked_for { self.last } else { self.first - 1 };
        let to = bound.min(from + CHUNK_CYCLES - 1);
        let columns = Columns::of_plan(self.plan.plan(), from..to + 1);
        for (index, cycle) in (0..columns.cycles()).zip(from..) {
            // Cycle 0 is where the axis stands: nobody is sent there.
            if cycle > 0 {
                self.digest = self.digest.then(cycle, columns.cycle(index).map(|setpoint| setpoint.words()));
            }
        }
        self.next = to + 1;
        asked_for.then_some(Chunk { first_cycle: from, columns, digest: self.digest })
    }
}

impl Iterator for Sampling {
    type Item = Chunk;

    /// The next chunk, however much has to be read before it.
    fn next(&mut self) -> Option<Chunk> {
        while !self.is_over() {
            if let Some(chunk) = self.read() {
                return Some(chunk);
            }
        }
        None
    }
}
