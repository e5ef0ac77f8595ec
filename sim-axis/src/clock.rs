//! The one place where time is read and waited for.

use std::num::NonZeroU64;
use std::time::Duration;

use planner::CycleTime;
use rustix::io::Errno;
use rustix::thread::{clock_nanosleep_absolute, set_current_timer_slack};
use rustix::time::{ClockId, Timespec, clock_gettime};
use thread_priority::{
    RealtimeThreadSchedulePolicy, ThreadPriority, ThreadSchedulePolicy, set_thread_priority_and_policy,
    thread_native_id,
};

/// What a run goes by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// One cycle per period.
    #[default]
    Wall,
    /// As fast as setpoints arrive and samples are read; the same numbers.
    Virtual,
}

/// When cycles are due: one period after the other from the beginning, whenever they are run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deadlines {
    cycle_ns: u64,
    due_ns: u64,
}

impl Deadlines {
    /// Cycle 0 is now.
    pub(crate) fn from_now(cycle: CycleTime) -> Self {
        Self { cycle_ns: cycle.as_ns(), due_ns: now_ns() }
    }

    /// Waits until the next cycle is due, not at all where it was already, and says by how much it is late [ns].
    pub(crate) fn wait(&mut self) -> u64 {
        self.due_ns += self.cycle_ns;
        sleep_until(self.due_ns);
        now_ns().saturating_sub(self.due_ns)
    }

    /// Is a cycle that begins so late [ns] begun when the next one is due already?
    pub(crate) fn is_late(&self, lateness_ns: u64) -> bool {
        lateness_ns >= self.cycle_ns
    }
}

const NS_PER_SECOND: u64 = 1_000_000_000;

/// Since some instant before the process began [ns].
fn now_ns() -> u64 {
    let Timespec { tv_sec, tv_nsec } = clock_gettime(ClockId::Monotonic);
    tv_sec.unsigned_abs() * NS_PER_SECOND + tv_nsec.unsigned_abs()
}

/// How late a cycle thread of this machine begins each of `cycles` cycles, with nothing to do in them. Blocks until they are over.
#[must_use]
pub fn lateness_of(cycle: CycleTime, cycles: u64) -> Vec<Duration> {
    be_prompt();
    let mut deadlines = Deadlines::from_now(cycle);
    (0..cycles).map(|_| Duration::from_nanos(deadlines.wait())).collect()
}

fn sleep_until(ns: u64) {
    let due =
        Timespec { tv_sec: (ns / NS_PER_SECOND).cast_signed(), tv_nsec: (ns % NS_PER_SECOND).cast_signed() };
    while clock_nanosleep_absolute(ClockId::Monotonic, &due) == Err(Errno::INTR) {}
}

/// Asks for the scheduling that a cycle thread would like to have. Without the right to it the thread runs as any other,
/// and its jitter says so.
pub(crate) fn be_prompt() {
    let timer_slack_ns = NonZeroU64::MIN;
    let _ = set_current_timer_slack(Some(timer_slack_ns));
    let Ok(priority) = REALTIME_PRIORITY.try_into() else { return };
    let _ = set_thread_priority_and_policy(
        thread_native_id(),
        ThreadPriority::Crossplatform(priority),
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    );
}

/// Above whatever else asks for real time without a reason, below the kernel's own threads.
const REALTIME_PRIORITY: u8 = 49;
