use planner::{CycleTime, Setpoint};
use proto::Digest;
use proto::stream::Tails;

/// The way to rest of an axis that has heard no more, played cycle by cycle.
///
/// ```text
///  ──●────●────●                 the last cycle that was held: the way begins in its setpoint
///         from  ╲
///                ○────○────○     cycles of the way, one after the other, at rest in the last
///                     last_cycle
/// ```
///
/// Its bits are those of the motion that [`planner::motion::Motion::starved`] makes of it.
#[derive(Clone, Debug)]
pub(crate) struct Starved {
    tails: Tails,
    cycle: CycleTime,
    from: u64,
    cycles: u64,
    digest_before: Digest,
    revision: u64,
    /// Where the motion that is left was to end.
    was_to_end: u64,
    /// Of its last cycle, once a server goes on from there.
    end: Option<Digest>,
}

impl Starved {
    /// After cycle `from`, whose digest is `digest_before`, of a motion of revision `revision` that was to end at `was_to_end`.
    pub(crate) fn new(
        tails: Tails,
        cycle: CycleTime,
        (from, digest_before): (u64, Digest),
        (revision, was_to_end): (u64, u64),
    ) -> Self {
        // A way that the judge has accepted can be counted.
        let cycles = cycle.count(tails.duration()).unwrap_or(0);
        Self { tails, cycle, from, cycles, digest_before, revision, was_to_end, end: None }
    }

    /// What is not needed any more.
    pub(crate) fn into_tails(self) -> Tails {
        self.tails
    }

    /// The last cycle before it.
    pub(crate) fn left_after(&self) -> u64 {
        self.from
    }

    /// Its last cycle, at rest.
    pub(crate) fn last_cycle(&self) -> u64 {
        self.from + self.cycles
    }

    /// Of the last cycle before it.
    pub(crate) fn digest_before(&self) -> Digest {
        self.digest_before
    }

    /// Of the motion that was left.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// The last cycle of the motion that was left.
    pub(crate) fn was_to_end(&self) -> u64 {
        self.was_to_end
    }

    /// Does no server know of it?
    pub(crate) fn is_alone(&self) -> bool {
        self.end.is_none()
    }

    /// A server goes on after its last cycle, whose digest is known now.
    pub(crate) fn goes_on(&mut self, digest: Digest) {
        self.end = Some(digest);
    }

    /// The digest of `cycle` if that is its last, and known.
    pub(crate) fn digest_of_end(&self, cycle: u64) -> Option<Digest> {
        self.end.filter(|_| cycle == self.last_cycle())
    }

    /// Where an axis rests at last.
    pub(crate) fn rests(&self, axis: usize) -> Option<Setpoint> {
        self.tails.profiles().get(axis).map(|way| Setpoint::held(way.end()))
    }

    /// The setpoints of all axes at `cycle`, in plan order.
    pub(crate) fn setpoints(&self, cycle: u64) -> impl Iterator<Item = Setpoint> {
        let time = self.cycle.time_of(cycle - self.from, self.cycles);
        self.tails.profiles().iter().map(move |way| way.at(time))
    }
}
