use std::collections::VecDeque;

/// How far ahead of what the axis has reported a splice begins, measured in the axis's own cycles.
///
/// ```text
///  reported        the report arrives,      the replacing batch         first cycle that
///  executed        an operation comes       arrives                     is replaced
///  ───●────────────────●─────────────────────────●──────────────────────────●────►
///     │◄── one way ───►│◄ plan ►│◄── one way ───►│◄──────── guard ─────────►│
///     │◄ up to one report later ►│
/// ```
///
/// What a batch takes until a report shows it is the two ways and a wait for the report; the longest of the last few stands
/// for the two ways. A splice that comes too late all the same is refused, changes nothing, and is planned again farther ahead.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    guard: u64,
    report_interval: u64,
    /// Batches that no report has shown: last cycle, and the executed cycle when it was sent.
    outstanding: VecDeque<(u64, u64)>,
    /// The last round trips [cycles].
    round_trips: [u64; MEASURED],
    next: usize,
}

/// How many round trips are remembered: a stall of the network is forgotten after as many batches.
const MEASURED: usize = 8;
/// What planning a splice takes [cycles]: microseconds, which may fall across the end of one cycle.
const PLANNING: u64 = 1;

impl Pace {
    /// An axis reports every batch.
    pub(super) fn new(guard: u64, report_interval: u64) -> Self {
        let round_trips = [report_interval; MEASURED];
        Self { guard, report_interval, outstanding: VecDeque::new(), round_trips, next: 0 }
    }

    /// A batch is sent.
    pub(super) fn sent(&mut self, last_cycle: u64, executed: u64) {
        self.outstanding.push_back((last_cycle, executed));
    }

    /// A report has come.
    pub(super) fn reported(&mut self, accepted: u64, executed: u64) {
        while let Some(&(_, since)) = self.outstanding.front().filter(|batch| batch.0 <= accepted) {
            self.outstanding.pop_front();
            self.measured(executed.saturating_sub(since));
        }
    }

    /// Something took so long from here to the axis and back.
    pub(super) fn measured(&mut self, cycles: u64) {
        self.round_trips[self.next] = cycles;
        self.next = (self.next + 1) % MEASURED;
    }

    /// What was sent after `accepted` will be sent again.
    pub(super) fn forget_after(&mut self, accepted: u64) {
        self.outstanding.retain(|batch| batch.0 <= accepted);
    }

    /// How far beyond the reported executed cycle a splice begins [cycles], after so many `refusals` of it.
    pub(super) fn margin(&self, refusals: u32) -> u64 {
        let longest = self.round_trips.iter().copied().max().unwrap_or(0);
        let again = u64::from(refusals) * self.report_interval;
        self.guard + self.report_interval + PLANNING + longest.max(self.report_interval) + again
    }

    /// How far beyond the executed cycle a splice is taken up that is to begin at a certain one: before the next report it
    /// would be too late [cycles].
    pub(super) fn horizon(&self, refusals: u32) -> u64 {
        self.margin(refusals) + self.report_interval
    }

    /// The first cycle that may be replaced at all, as far as is known.
    pub(super) fn first_replaceable(&self, executed: u64) -> u64 {
        executed + self.guard + 1
    }
}
