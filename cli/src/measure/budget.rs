//! What a row is wanted to take.

use std::fmt;

use super::Timed;

/// Whatever is set is to hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Budget {
    /// At most one in so many parts of the peer's median [1].
    pub(crate) share: Option<f64>,
    /// The median at most [ns].
    pub(crate) ns: Option<f64>,
    /// What one input in a thousand takes longer than, at most [ns].
    pub(crate) p999_ns: Option<f64>,
}

impl Budget {
    /// At most one in `parts` parts of the peer's median.
    pub(crate) const fn share(parts: f64) -> Self {
        Self { share: Some(parts), ns: None, p999_ns: None }
    }

    /// Is it kept? Nothing where there is no budget, or no figure to hold against it.
    pub(crate) fn met(&self, timed: &Timed) -> Option<bool> {
        let Self { share, ns, p999_ns } = *self;
        let of_peer = share.map(|parts| timed.peer_ns.map(|peer| timed.ns * parts <= peer));
        let median = ns.map(|most| Some(timed.ns <= most));
        let tail = p999_ns.map(|most| timed.p999_ns.map(|tail| tail <= most));
        let all: Vec<Option<bool>> = [of_peer, median, tail].into_iter().flatten().collect();
        // What is broken is broken, whatever else is not known.
        if all.contains(&Some(false)) {
            return Some(false);
        }
        (!all.is_empty() && !all.contains(&None)).then_some(true)
    }
}

impl fmt::Display for Budget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { share, ns, p999_ns } = self;
        let median = share.map(|parts| format!("1/{parts}")).or(ns.map(|most| format!("{most} ns")));
        let tail = p999_ns.map(|most| format!("{most} ns"));
        f.write_str(&median.into_iter().chain(tail).collect::<Vec<_>>().join("; "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_is_met_where_all_of_it_is_known_to_hold() {
        let timed = |ns, p999_ns, peer_ns| Timed { ns, p999_ns, peer_ns };
        let half = Budget { share: Some(2.0), ns: None, p999_ns: Some(1500.0) };
        assert_eq!(half.to_string(), "1/2; 1500 ns");
        assert_eq!(half.met(&timed(100.0, Some(1500.0), Some(200.0))), Some(true));
        assert_eq!(half.met(&timed(100.0, Some(1501.0), Some(200.0))), Some(false));
        assert_eq!(half.met(&timed(101.0, Some(1500.0), Some(200.0))), Some(false));
        assert_eq!(half.met(&timed(100.0, Some(1500.0), None)), None);
        assert_eq!(half.met(&timed(100.0, Some(1501.0), None)), Some(false));
        let time = Budget { share: None, ns: Some(2.0), p999_ns: None };
        assert_eq!(time.to_string(), "2 ns");
        assert_eq!(time.met(&timed(2.0, None, None)), Some(true));
        assert_eq!(time.met(&timed(2.1, None, None)), Some(false));
        assert_eq!(Budget::default().met(&timed(1.0, None, Some(2.0))), None);
        assert_eq!(Budget::default().to_string(), "");
    }
}
