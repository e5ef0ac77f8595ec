use std::ops::Range;
use std::panic::resume_unwind;
use std::thread;

use planner::Workers;

/// Some threads that share a large piece of work, the caller's one of them.
///
/// They are made for the work and end with it: that costs some tens of microseconds each, so small work is
/// for [`planner::Alone`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Threads {
    count: usize,
}

impl Threads {
    /// So many, at least one.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { count: count.max(1) }
    }

    /// As many as run at the same time on this machine, and at most `most`.
    #[must_use]
    pub fn of_machine(most: usize) -> Self {
        Self::new(thread::available_parallelism().map_or(1, |count| count.get().min(most)))
    }
}

impl Workers for Threads {
    fn each_range<R: Send>(&self, count: usize, work: impl Fn(Range<usize>) -> R + Sync) -> Vec<R> {
        let parts = self.count.min(count).max(1);
        let range = |part: usize| part * count / parts..(part + 1) * count / parts;
        let work = &work;
        thread::scope(|scope| {
            let others: Vec<_> = (1..parts)
                .map(|part| thread::Builder::new().spawn_scoped(scope, move || work(range(part))))
                .collect();
            let mut done = Vec::with_capacity(parts);
            done.push(work(range(0)));
            for (other, part) in others.into_iter().zip(1..) {
                done.push(match other {
                    Ok(other) => other.join().unwrap_or_else(|panic| resume_unwind(panic)),
                    // The system gives no more threads: it takes longer.
                    Err(_) => work(range(part)),
                });
            }
            done
        })
    }
}
