use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use proto::{Reason, Rejected};

use crate::commands::Commander;

/// The streams that axes of this process follow, by name: the newest run of each.
#[derive(Clone, Debug, Default)]
pub(super) struct Streams {
    open: Arc<Mutex<BTreeMap<String, Commander>>>,
}

/// A stream that is followed, until this is dropped.
#[derive(Debug)]
pub(super) struct Entry {
    streams: Streams,
    stream: String,
    commander: Commander,
}

impl Streams {
    pub(super) fn enter(&self, stream: String, commander: Commander) -> Entry {
        self.lock().insert(stream.clone(), commander.clone());
        Entry { streams: self.clone(), stream, commander }
    }

    /// Whoever commands `stream`; where that is empty, the only one there is.
    pub(super) fn commander_of(&self, stream: &str) -> Result<Commander, Rejected> {
        let open = self.lock();
        match open.get(stream) {
            Some(commander) => Ok(commander.clone()),
            None if stream.is_empty() && open.len() == 1 => {
                open.values().next().cloned().ok_or_else(|| not_here(stream, &open))
            }
            None => Err(not_here(stream, &open)),
        }
    }

    fn lock(&self) -> MutexGuard<'_, BTreeMap<String, Commander>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Entry {
    fn drop(&mut self) {
        let mut open = self.streams.lock();
        if open.get(&self.stream).is_some_and(|newest| newest.is_of(&self.commander)) {
            open.remove(&self.stream);
        }
    }
}

fn not_here(stream: &str, open: &BTreeMap<String, Commander>) -> Rejected {
    let known = open.keys().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
    let text = match (open.len(), stream) {
        (0, _) => "no axis of this process follows a stream: start one, as portamento track does".to_owned(),
        (_, "") => format!("several streams are followed here: say which, {known}"),
        _ => format!("no axis of this process follows stream {stream:?}: it is one of {known}"),
    };
    Rejected::new(Reason::StreamNotHere, text)
}
