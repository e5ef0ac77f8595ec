use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use proto::stream::{Open, Operation, OperationResult, Source};
use proto::{Reason, Rejected};
use serving::{Caller, Ended};
use tokio::sync::{mpsc, oneshot};

use crate::figures::Figures;
use crate::limits::Limits;

/// Which streams are open here, each under its newest epoch.
#[derive(Clone, Debug)]
pub(crate) struct Streams {
    known: Arc<Mutex<Known>>,
    limits: Limits,
    figures: Figures,
    caller: Caller,
}

#[derive(Debug, Default)]
struct Known {
    open: HashMap<String, Holder>,
    /// Those whose motion came to its end here.
    finished: Ended,
}

/// The session that holds a stream.
#[derive(Debug)]
struct Holder {
    epoch: u64,
    caller: Caller,
    superseded: oneshot::Sender<u64>,
    commands: mpsc::Sender<Command>,
}

/// An operation from somebody who is not the axis.
#[derive(Debug)]
pub(crate) struct Command {
    pub(crate) operation: Operation,
    /// Dropped without an answer where the session ends.
    pub(crate) answer: oneshot::Sender<Result<OperationResult, Rejected>>,
}

/// Completes with the newer epoch when a stream is opened again.
pub(crate) type Superseded = oneshot::Receiver<u64>;

/// Commands on their way to a session.
const COMMANDS: usize = 16;

/// The right to serve a stream under an epoch; given up when it is dropped.
#[derive(Debug)]
pub(crate) struct Claim {
    streams: Streams,
    stream: String,
    epoch: u64,
    /// What others ask for.
    pub(crate) commands: mpsc::Receiver<Command>,
    /// Has its motion come to its end?
    pub(crate) finished: bool,
}

impl Streams {
    pub(crate) fn new(limits: Limits, figures: Figures) -> Self {
        Self { known: Arc::default(), limits, figures, caller: Caller::default() }
    }

    /// The same streams, as far as `caller` may use them.
    pub(crate) fn as_used_by(&self, caller: Caller) -> Self {
        Self { caller, ..self.clone() }
    }

    /// Where is counted what happens to them.
    pub(crate) fn figures(&self) -> &Figures {
        &self.figures
    }

    /// May the caller open this stream, and with such a motion?
    pub(crate) fn admit(&self, open: &Open) -> Result<(), Rejected> {
        self.caller.may_use(&open.stream)?;
        match &open.source {
            Source::Plan(plan) => self.limits.admit_motion("open.plan", plan.plan()),
            Source::Resume(resume) => {
                self.limits.admit_motion("open.resume.motion.plan", resume.motion.plan())
            }
        }
    }

    /// Takes `stream` for `epoch`, away from any older epoch.
    pub(crate) fn claim(&self, stream: String, epoch: u64) -> Result<(Claim, Superseded), Rejected> {
        self.caller.may_use(&stream)?;
        let (sender, superseded) = oneshot::channel();
        let (commander, commands) = mpsc::channel(COMMANDS);
        let holder = Holder { epoch, caller: self.caller.clone(), superseded: sender, commands: commander };
        let mut known = self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let Known { open, finished } = &mut *known;
        let count = open.len();
        let of_caller =
            || open.values().filter(|held| held.caller.identity() == self.caller.identity()).count();
        let Limits { streams: most, streams_per_identity, .. } = self.limits;
        // Counted only where it can matter.
        let is_greedy = count >= streams_per_identity && of_caller() >= streams_per_identity;
        match open.entry(stream.clone()) {
            Entry::Occupied(held) if held.get().epoch >= epoch => {
                return Err(older(&stream, epoch, held.get().epoch));
            }
            Entry::Occupied(mut held) => {
                let older = held.insert(holder);
                // It may have ended in the meantime.
                let _ = older.superseded.send(epoch);
            }
            Entry::Vacant(_) if count >= most => return Err(too_many(most)),
            Entry::Vacant(_) if is_greedy => return Err(too_many_of_one(streams_per_identity)),
            Entry::Vacant(free) => {
                free.insert(holder);
            }
        }
        finished.forget(&stream);
        self.figures.opened(open.len());
        drop(known);
        let claim = Claim { streams: self.clone(), stream, epoch, commands, finished: false };
        Ok((claim, superseded))
    }

    /// Asks for an operation on `stream`, and waits for what becomes of it.
    pub(crate) async fn command(
        &self,
        stream: &str,
        operation: Operation,
    ) -> Result<OperationResult, Rejected> {
        self.caller.may_use(stream)?;
        let commands = {
            let Known { open, finished } = &*self.known.lock().unwrap_or_else(PoisonError::into_inner);
            let nobody = || if finished.has(stream) { over(stream) } else { not_here(stream) };
            open.get(stream).map(|holder| holder.commands.clone()).ok_or_else(nobody)?
        };
        let (answer, answered) = oneshot::channel();
        match commands.try_send(Command { operation, answer }) {
            Ok(()) => {}
            Err(mpsc::error::TrySendError::Full(_)) => return Err(overloaded(stream)),
            Err(mpsc::error::TrySendError::Closed(_)) => return Err(not_here(stream)),
        }
        answered.await.unwrap_or_else(|_| Err(Rejected::left_undone()))
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        let known = &mut *self.streams.known.lock().unwrap_or_else(PoisonError::into_inner);
        let Known { open, finished } = known;
        if open.get(&self.stream).is_some_and(|holder| holder.epoch == self.epoch) {
            open.remove(&self.stream);
            if self.finished {
                finished.note(std::mem::take(&mut self.stream));
            }
            self.streams.figures.open(open.len());
        }
    }
}

fn older(stream: &str, given: u64, current: u64) -> Rejected {
    let text = format!(
        "stream {stream:?} is open under epoch {current}, and {given} is not newer: open it with a larger one"
    );
    Rejected::new(Reason::EpochSuperseded, text).with("current_epoch", current).with("given", given)
}

fn too_many(most: usize) -> Rejected {
    let text = format!("{most} streams are open, as many as this server takes: close one, or open elsewhere");
    Rejected::new(Reason::TooManyStreams, text).with("given", most + 1).with("allowed", most)
}

fn too_many_of_one(most: usize) -> Rejected {
    let text = format!(
        "{most} streams of this caller are open, as many as this server takes of each: close one, or raise \
         max_streams_per_identity"
    );
    let rejected = Rejected::new(Reason::TooManyStreams, text);
    rejected.with("given", most + 1).with("allowed", most).with("limit", "max_streams_per_identity")
}

fn not_here(stream: &str) -> Rejected {
    let text = format!(
        "stream {stream:?} is not served here: ask the other replicas in turn, or command the axis that plays it"
    );
    Rejected::new(Reason::StreamNotHere, text)
}

fn over(stream: &str) -> Rejected {
    let text = format!("stream {stream:?} has come to its end: open a stream with a new plan");
    Rejected::new(Reason::StreamFinished, text)
}

fn overloaded(stream: &str) -> Rejected {
    let text =
        format!("{COMMANDS} commands wait for stream {stream:?}, as many as may: ask again in a moment");
    Rejected::new(Reason::Overloaded, text).with("allowed", COMMANDS).retry_after(Duration::from_millis(100))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_many_streams_are_counted() {
        let rejected = too_many(10);
        let figures = ["given", "allowed"].map(|key| rejected.metadata[key].as_str());
        assert_eq!((rejected.reason, figures), (Reason::TooManyStreams, ["11", "10"]));
    }
}
