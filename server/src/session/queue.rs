use planner::motion::Operation as Planned;
use proto::stream::Operation;

/// Who wants to know what became of an operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Asker {
    /// The axis, in band.
    Axis,
    /// Somebody else, under this ticket.
    Commander(u64),
}

/// An operation that waits for its cycle, or for those before it.
#[derive(Clone, Debug)]
pub(super) struct Waiting {
    pub(super) request_id: String,
    pub(super) not_before: u64,
    pub(super) planned: Planned,
    /// Of what is asked for.
    pub(super) digest: u64,
    pub(super) askers: Vec<Asker>,
    /// How often the axis has refused its splice.
    pub(super) refusals: u32,
    /// Of arrival.
    order: u64,
}

/// Operations that wait, as they came.
#[derive(Clone, Debug, Default)]
pub(super) struct Queue {
    waiting: Vec<Waiting>,
    arrived: u64,
}

impl Waiting {
    /// One more wants to know. An asker is answered once, however often he asks.
    pub(super) fn also_for(&mut self, asker: Asker) {
        if !self.askers.contains(&asker) {
            self.askers.push(asker);
        }
    }
}

impl Queue {
    pub(super) fn len(&self) -> usize {
        self.waiting.len()
    }

    pub(super) fn push(&mut self, asker: Asker, operation: Operation, planned: Planned) {
        let digest = operation.digest();
        let Operation { request_id, not_before_cycle, ask: _ } = operation;
        let (not_before, order) = (not_before_cycle.unwrap_or(0), self.arrived);
        self.arrived += 1;
        let askers = vec![asker];
        self.waiting.push(Waiting { request_id, not_before, planned, digest, askers, refusals: 0, order });
    }

    /// Puts back what could not be done yet: it keeps its place.
    pub(super) fn put_back(&mut self, waiting: Waiting) {
        self.waiting.push(waiting);
    }

    pub(super) fn find(&mut self, request_id: &str) -> Option<&mut Waiting> {
        self.waiting.iter_mut().find(|waiting| waiting.request_id == request_id)
    }

    /// The place of the one that takes effect first among those that are due, and its cycle; `begins` tells where an operation
    /// would begin, if it is due.
    pub(super) fn find_due(&self, begins: impl Fn(&Waiting) -> Option<u64>) -> Option<(usize, u64)> {
        let due = self
            .waiting
            .iter()
            .enumerate()
            .filter_map(|(place, waiting)| begins(waiting).map(|cycle| ((cycle, waiting.order), place)));
        due.min().map(|((cycle, _), place)| (place, cycle))
    }

    pub(super) fn take(&mut self, place: usize) -> Waiting {
        self.waiting.remove(place)
    }

    /// Takes those that came before `by` and were to take effect after the cycle at which that did.
    pub(super) fn take_overtaken(&mut self, by: &Waiting, effective: u64) -> Vec<Waiting> {
        let is_overtaken = |waiting: &mut Waiting| waiting.order < by.order && waiting.not_before > effective;
        self.waiting.extract_if(.., is_overtaken).collect()
    }

    pub(super) fn take_all(&mut self) -> Vec<Waiting> {
        std::mem::take(&mut self.waiting)
    }
}
