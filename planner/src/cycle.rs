use crate::error::{Field, InvalidFields, Why};

/// The time between two setpoints: a whole number of nanoseconds from 10 µs to 1 s.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CycleTime {
    ns: u64,
}

/// The last cycle that can be counted: every number up to it is a double of its own.
pub const LAST_CYCLE: u64 = 1 << 53;

/// Of a duration \[1\]: a motion that ends this much after a cycle ends on it. The roundings of a duration are worth as
/// much. It stays below a quarter of a cycle up to 2⁴⁸ cycles, 8900 years of milliseconds.
const END_SLACK: f64 = 4.0 * f64::EPSILON;

impl CycleTime {
    /// One millisecond.
    pub const MILLISECOND: Self = Self { ns: 1_000_000 };
    const MIN_NS: u64 = 10_000;
    const MAX_NS: u64 = 1_000_000_000;

    /// A cycle of `ns` nanoseconds; `None` is one millisecond.
    ///
    /// # Errors
    /// [`Why::CycleTime`] outside 10 µs to 1 s.
    pub fn from_ns(ns: Option<i128>) -> Result<Self, InvalidFields> {
        let Some(given_ns) = ns else { return Ok(Self::MILLISECOND) };
        let fits = u64::try_from(given_ns).ok().filter(|ns| (Self::MIN_NS..=Self::MAX_NS).contains(ns));
        fits.map(|ns| Self { ns }).ok_or_else(|| {
            let why = Why::CycleTime { given_ns, min_ns: Self::MIN_NS, max_ns: Self::MAX_NS };
            InvalidFields::one(Field::named("cycle_time"), why)
        })
    }

    /// The length of a cycle \[ns\].
    #[must_use]
    pub fn as_ns(self) -> u64 {
        self.ns
    }

    /// The length of a cycle \[s\].
    #[must_use]
    pub fn as_seconds(self) -> f64 {
        self.start_of(1)
    }

    /// When cycle `cycle` is due, counted from cycle 0 \[s\]: one rounding for the product, one for the quotient, so that it
    /// depends on nothing but the two integers.
    #[must_use]
    #[inline]
    pub fn start_of(self, cycle: u64) -> f64 {
        self.after(cycle as f64)
    }

    /// When so many cycles are over \[s\], a whole number.
    #[inline]
    pub(crate) fn after(self, cycles: f64) -> f64 {
        cycles * self.ns as f64 / 1e9
    }

    /// When `cycle` of a motion that ends with cycle `cycle_count` is due \[s\]: from that on it has ended, though the cycle may be due
    /// a rounding before that, and the time is ∞.
    #[must_use]
    #[inline]
    pub fn time_of(self, cycle: u64, cycle_count: u64) -> f64 {
        if cycle < cycle_count { self.start_of(cycle) } else { f64::INFINITY }
    }

    /// How many cycles from `first` on, at most so many, are due before `time` \[s\], which is after that first one.
    pub(crate) fn cycles_before(self, time: f64, first: u64, most: u64) -> u64 {
        // What comes after the last of them, to within the roundings of a quotient.
        let next = (time * 1e9 / self.ns as f64) as u64 + 1;
        let mut count = next.saturating_sub(first).clamp(1, most);
        while count > 1 && self.start_of(first + count - 1) >= time {
            count -= 1;
        }
        count
    }

    /// The first cycle at or after `duration` \[s\]: the one at which a motion of that length has ended. `None` beyond
    /// [`LAST_CYCLE`].
    #[must_use]
    pub fn count(self, duration: f64) -> Option<u64> {
        let cycles = libm::ceil(duration * 1e9 / self.ns as f64 * (1.0 - END_SLACK));
        (cycles >= 0.0 && cycles <= LAST_CYCLE as f64).then_some(cycles as u64)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

    use super::*;

    #[test]
    fn cycles_before_a_time_are_those_that_are_due_before_it() {
        for ns in [10_000, 333_333, 1_000_000, 1_200_000, 999_999_999] {
            let cycle_time = CycleTime::from_ns(Some(ns)).unwrap();
            for last in [1, 2, 3, 7, 1000, 123_456_789, LAST_CYCLE - 1] {
                let (due, first) = (cycle_time.start_of(last), last.saturating_sub(5));
                for time in [due.next_down(), due, due.next_up(), due + 0.5 * cycle_time.as_seconds()] {
                    if time <= cycle_time.start_of(first) {
                        continue;
                    }
                    let expected =
                        (first..first + 100).take_while(|&cycle| cycle_time.start_of(cycle) < time);
                    let expected = expected.count() as u64;
                    let counted = cycle_time.cycles_before(time, first, 100);
                    // One of them may be left for the next count.
                    assert!(
                        counted == expected || counted + 1 == expected,
                        "{counted} of {expected}, {ns} ns"
                    );
                    assert_eq!(cycle_time.cycles_before(time, first, 2), expected.min(2).min(counted));
                }
            }
        }
    }
}
