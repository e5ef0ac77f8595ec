//! Two sides by turns, so that what else the machine does slows down both.

use std::hint::black_box;
use std::time::{Duration, Instant};

use rustix::time::{ClockId, clock_gettime};

/// However little time there is, a median is one of so many rounds at least.
const LEAST_ROUNDS: usize = 5;
/// How often each input is timed by itself: what interrupts one call does not interrupt the same in all of them.
const PASSES: usize = 20;
/// Fewer inputs than this have no tail worth a figure.
const TAIL_INPUTS: usize = 1000;

/// One side of a question.
pub(crate) trait Side {
    /// How many operations a round has, at least one.
    fn operations(&self) -> usize;

    /// What is timed.
    fn round(&mut self);

    /// What each input takes by itself [ns], the least of several calls; none where there are too few inputs.
    fn each(&mut self) -> Option<Vec<f64>>;
}

/// One operation for each of many inputs, in their order, with something that goes on from one to the next.
pub(crate) struct Each<T, B, W> {
    inputs: Vec<T>,
    begin: B,
    work: W,
}

impl<T, S, B: Fn() -> S, W: FnMut(&mut S, &T)> Each<T, B, W> {
    pub(crate) fn new(inputs: Vec<T>, begin: B, work: W) -> Self {
        Self { inputs, begin, work }
    }
}

impl<T, S, B: Fn() -> S, W: FnMut(&mut S, &T)> Side for Each<T, B, W> {
    fn operations(&self) -> usize {
        self.inputs.len()
    }

    fn round(&mut self) {
        let mut state = (self.begin)();
        for input in &self.inputs {
            (self.work)(&mut state, black_box(input));
        }
    }

    fn each(&mut self) -> Option<Vec<f64>> {
        if self.inputs.len() < TAIL_INPUTS {
            return None;
        }
        let clock = clock();
        let mut least = vec![f64::INFINITY; self.inputs.len()];
        for _ in 0..PASSES {
            let mut state = (self.begin)();
            for (least, input) in least.iter_mut().zip(&self.inputs) {
                let begin = Instant::now();
                (self.work)(&mut state, black_box(input));
                *least = least.min(nanoseconds(begin.elapsed()) - clock);
            }
        }
        Some(least)
    }
}

/// What reading the clock takes by itself, at the least [ns].
fn clock() -> f64 {
    (0..1000).map(|_| nanoseconds(Instant::now().elapsed())).fold(f64::INFINITY, f64::min)
}

/// What was measured of a question.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Timed {
    /// What an operation takes of a processor, the median of all rounds [ns].
    pub(crate) ns: f64,
    /// What one input in a thousand takes longer than [ns].
    pub(crate) p999_ns: Option<f64>,
    /// As `ns`, of the peer.
    pub(crate) peer_ns: Option<f64>,
}

impl Timed {
    /// What part of the peer's time ours is [1].
    pub(crate) fn ratio(&self) -> Option<f64> {
        self.peer_ns.map(|peer| self.ns / peer)
    }
}

/// Rounds of `ours` and of `peer` by turns for as long as `budget`, and the tail of `ours`.
pub(crate) fn time(
    ours: &mut dyn Side,
    mut peer: Option<&mut (dyn Side + 'static)>,
    budget: Duration,
) -> Timed {
    ours.round();
    if let Some(peer) = peer.as_mut() {
        peer.round();
    }
    let (mut mine, mut theirs) = (Vec::new(), Vec::new());
    let begin = Instant::now();
    while mine.len() < LEAST_ROUNDS || begin.elapsed() < budget {
        mine.push(round(ours));
        if let Some(peer) = peer.as_mut() {
            theirs.push(round(*peer));
        }
    }
    let p999_ns = ours.each().map(|each| quantile(each, 0.999));
    Timed { ns: quantile(mine, 0.5), p999_ns, peer_ns: (!theirs.is_empty()).then(|| quantile(theirs, 0.5)) }
}

/// What an operation of one round takes of a processor [ns].
fn round(side: &mut dyn Side) -> f64 {
    let begin = processor_time();
    side.round();
    (processor_time() - begin) / side.operations() as f64
}

/// What this thread has taken of a processor so far [ns]: while others are given it, it stands still.
fn processor_time() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 * 1e9 + time.tv_nsec as f64
}

fn nanoseconds(duration: Duration) -> f64 {
    duration.as_secs_f64() * 1e9
}

/// The least value that is not below `part` of them; there is at least one.
fn quantile(mut values: Vec<f64>, part: f64) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let rank = (values.len() as f64 * part).ceil() as usize;
    values[rank.clamp(1, values.len()) - 1]
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;
    use std::rc::Rc;

    use super::*;

    /// Writes down whose turn it was.
    struct Turn(char, Rc<RefCell<String>>);

    impl Side for Turn {
        fn operations(&self) -> usize {
            1
        }

        fn round(&mut self) {
            self.1.borrow_mut().push(self.0);
        }

        fn each(&mut self) -> Option<Vec<f64>> {
            Some((1..=1000).map(f64::from).collect())
        }
    }

    #[test]
    fn both_sides_go_by_turns_and_only_ours_has_a_tail() {
        let turns = Rc::new(RefCell::new(String::new()));
        let (mut ours, mut peer) = (Turn('o', turns.clone()), Turn('p', turns.clone()));
        let timed = time(&mut ours, Some(&mut peer), Duration::ZERO);
        assert_eq!(*turns.borrow(), "op".repeat(1 + LEAST_ROUNDS));
        assert_eq!(timed.p999_ns, Some(999.0));
        assert!(timed.ratio().is_some());
        let alone = time(&mut ours, None, Duration::ZERO);
        assert_eq!((alone.peer_ns, alone.ratio()), (None, None));
    }

    #[test]
    fn every_round_begins_anew_and_every_input_has_its_time() {
        let seen = Rc::new(RefCell::new(Vec::new()));
        let inputs: Vec<usize> = (0..TAIL_INPUTS).collect();
        let put = seen.clone();
        let mut side = Each::new(
            inputs.clone(),
            || 0,
            move |state: &mut usize, input: &usize| {
                put.borrow_mut().push((*state, *input));
                *state += 1;
            },
        );
        side.round();
        side.round();
        let expected: Vec<_> = inputs.iter().chain(&inputs).map(|&input| (input, input)).collect();
        assert_eq!(*seen.borrow(), expected);
        assert_eq!(side.each().unwrap().len(), TAIL_INPUTS);
        assert!(Each::new(vec![1, 2], || (), |_: &mut (), _: &i32| {}).each().is_none());
    }

    #[test]
    #[allow(clippy::float_cmp, reason = "they are those very values")]
    fn quantiles_are_values_that_were_seen() {
        assert_eq!(quantile(vec![3.0, 1.0, 2.0], 0.5), 2.0);
        assert_eq!(quantile(vec![4.0, 1.0, 2.0, 3.0], 0.5), 2.0);
        assert_eq!(quantile(vec![7.0], 0.999), 7.0);
    }
}
