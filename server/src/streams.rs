use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::{Arc, Mutex, PoisonError};

use proto::{Reason, Rejected};
use tokio::sync::oneshot;

/// Which streams are open here, each under its newest epoch.
#[derive(Clone, Debug)]
pub(crate) struct Streams {
    open: Arc<Mutex<HashMap<String, Holder>>>,
    most: usize,
}

/// The session that holds a stream.
#[derive(Debug)]
struct Holder {
    epoch: u64,
    superseded: oneshot::Sender<u64>,
}

/// The right to serve a stream under an epoch; given up when it is dropped.
#[derive(Debug)]
pub(crate) struct Claim {
    streams: Streams,
    stream: String,
    epoch: u64,
    /// Completes with the newer epoch when the stream is opened again.
    pub(crate) superseded: oneshot::Receiver<u64>,
}

impl Streams {
    pub(crate) fn new(most: usize) -> Self {
        Self { open: Arc::default(), most }
    }

    /// Takes `stream` for `epoch`, away from any older epoch.
    pub(crate) fn claim(&self, stream: String, epoch: u64) -> Result<Claim, Rejected> {
        let (sender, superseded) = oneshot::channel();
        let holder = Holder { epoch, superseded: sender };
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let count = open.len();
        match open.entry(stream.clone()) {
            Entry::Occupied(held) if held.get().epoch >= epoch => {
                return Err(older(&stream, epoch, held.get().epoch));
            }
            Entry::Occupied(mut held) => {
                let older = held.insert(holder);
                // It may have ended in the meantime.
                let _ = older.superseded.send(epoch);
            }
            Entry::Vacant(_) if count >= self.most => return Err(too_many(self.most)),
            Entry::Vacant(free) => {
                free.insert(holder);
            }
        }
        drop(open);
        Ok(Claim { streams: self.clone(), stream, epoch, superseded })
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        let mut open = self.streams.open.lock().unwrap_or_else(PoisonError::into_inner);
        if open.get(&self.stream).is_some_and(|holder| holder.epoch == self.epoch) {
            open.remove(&self.stream);
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
    Rejected::new(Reason::TooManyStreams, text).with("allowed", most)
}
