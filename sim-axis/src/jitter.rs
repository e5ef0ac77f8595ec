use std::time::Duration;

/// How late cycles began: a histogram of fixed size, for runs of any length.
///
/// Exact below 64 ns, above that in steps of a thirty-second of a power of two: a quantile is high by at most 3 %.
#[derive(Clone, Debug)]
pub struct Lateness {
    counts: Box<[u64; BUCKETS]>,
    total: u64,
    latest_ns: u64,
}

/// How late cycles began; all 0 in virtual time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jitter {
    /// Median [s].
    pub p50: f64,
    /// 99th percentile [s].
    pub p99: f64,
    /// Greatest [s].
    pub max: f64,
}

/// log₂ of the steps to a power of two.
const STEP_BITS: u32 = 5;
const STEPS: usize = 1 << STEP_BITS;
/// Up to 2⁴⁰ ns, eighteen minutes; what is later counts as that, and its greatest is kept.
const POWERS: usize = 40 - STEP_BITS as usize + 1;
const BUCKETS: usize = STEPS * POWERS;

impl Default for Lateness {
    fn default() -> Self {
        Self { counts: Box::new([0; BUCKETS]), total: 0, latest_ns: 0 }
    }
}

impl Lateness {
    /// Counts a cycle that began so late [ns].
    pub fn note(&mut self, ns: u64) {
        self.counts[bucket(ns)] += 1;
        self.total += 1;
        self.latest_ns = self.latest_ns.max(ns);
    }

    /// The quantiles that a report names.
    #[must_use]
    pub fn jitter(&self) -> Jitter {
        let seconds = |ns| Duration::from_nanos(ns).as_secs_f64();
        Jitter {
            p50: seconds(self.quantile(50)),
            p99: seconds(self.quantile(99)),
            max: seconds(self.latest_ns),
        }
    }

    /// So late or less began `percent` of the cycles [ns].
    fn quantile(&self, percent: u64) -> u64 {
        let rank = (self.total * percent).div_ceil(100).max(1);
        let mut below = 0;
        for (bucket, count) in self.counts.iter().enumerate() {
            below += count;
            if below >= rank {
                return highest_of(bucket).min(self.latest_ns);
            }
        }
        self.latest_ns
    }
}

fn bucket(ns: u64) -> usize {
    let power = ns.max(1).ilog2().saturating_sub(STEP_BITS);
    let step = (ns >> power) as usize;
    // From the second power of two on, the highest bit is implied by the power.
    (power as usize * STEPS + step).min(BUCKETS - 1)
}

/// The largest number that [`bucket`] puts there.
fn highest_of(bucket: usize) -> u64 {
    if bucket < 2 * STEPS {
        return bucket as u64;
    }
    let power = bucket / STEPS - 1;
    let step = (bucket - power * STEPS) as u64;
    ((step + 1) << power) - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_lies_in_the_bucket_that_ends_at_or_after_it() {
        for ns in (0..2000).chain((11..39).flat_map(|power| [(1 << power) - 1, 1 << power, 3 << (power - 1)]))
        {
            let high = highest_of(bucket(ns));
            assert!(high >= ns && high as f64 <= ns as f64 * (1.0 + 1.0 / 32.0), "{ns}: {high}");
        }
        assert_eq!(bucket(u64::MAX), BUCKETS - 1);
    }

    #[test]
    fn quantiles_are_those_of_the_numbers() {
        let mut lateness = Lateness::default();
        assert_eq!(lateness.jitter(), Jitter::default());
        for _ in 0..98 {
            lateness.note(20);
        }
        lateness.note(1000);
        lateness.note(5_000_000);
        let Jitter { p50, p99, max } = lateness.jitter();
        assert_eq!((p50, max), (20e-9, 5e-3));
        assert!((1000e-9..1032e-9).contains(&p99), "{p99}");
    }
}
