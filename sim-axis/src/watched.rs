use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use proto::stream::{StreamEvent, StreamEventKind, Tracking};

/// How the axes follow, on its way into the reports while somebody watches the stream.
///
/// The task that reads the cycle thread's samples puts it in, the task that speaks to the server takes it out. What is not
/// taken in time is forgotten, oldest first: a report is not there to carry history.
#[derive(Debug, Default)]
pub(crate) struct WatchedBy {
    /// `None`: nobody watches.
    waiting: Mutex<Option<VecDeque<Tracking>>>,
}

/// How many chunks of samples wait for a report.
const MOST: usize = 16;

impl WatchedBy {
    /// Takes what the server says of watchers.
    pub(crate) fn hear(&self, event: StreamEvent) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        match event.kind {
            StreamEventKind::TrackingWanted => drop(waiting.get_or_insert_default()),
            StreamEventKind::TrackingUnwanted => *waiting = None,
            StreamEventKind::Draining
            | StreamEventKind::Standstill
            | StreamEventKind::Finished
            | StreamEventKind::Superseded => {}
        }
    }

    /// Puts in how the axes followed, if somebody watches.
    pub(crate) fn put(&self, tracking: &Tracking) {
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(waiting) = waiting.as_mut() else { return };
        if waiting.len() >= MOST {
            waiting.pop_front();
        }
        waiting.push_back(tracking.clone());
    }

    /// Takes out what goes into the next report.
    pub(crate) fn take(&self) -> Option<Tracking> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner).as_mut()?.pop_front()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reports_carry_tracking_only_while_somebody_watches() {
        let watched = WatchedBy::default();
        let chunk = |first_cycle| Tracking { first_cycle, ..Tracking::default() };
        let tell = |kind| watched.hear(StreamEvent { kind, at_cycle: 0 });
        watched.put(&chunk(1));
        assert_eq!(watched.take(), None);
        tell(StreamEventKind::TrackingWanted);
        (1..=20).for_each(|cycle| watched.put(&chunk(cycle)));
        tell(StreamEventKind::TrackingWanted);
        assert_eq!(
            watched.take(),
            Some(chunk(5)),
            "the oldest are forgotten, a second watcher changes nothing"
        );
        tell(StreamEventKind::TrackingUnwanted);
        assert_eq!(watched.take(), None);
    }
}
