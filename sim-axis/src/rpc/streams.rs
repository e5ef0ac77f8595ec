use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use proto::{Reason, Rejected};
use serving::{Caller, Ended};

use crate::commands::Commander;

/// The streams that axes of this process follow, by name: the newest run of each.
#[derive(Clone, Debug, Default)]
pub(super) struct Streams {
    known: Arc<Mutex<Known>>,
}

#[derive(Debug, Default)]
struct Known {
    open: BTreeMap<String, Commander>,
    ended: Ended,
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
        let mut known = self.lock();
        known.ended.forget(&stream);
        known.open.insert(stream.clone(), commander.clone());
        drop(known);
        Entry { streams: self.clone(), stream, commander }
    }

    /// Whoever commands `stream`; where that is empty, the only one there is. Of streams that the caller may not use he
    /// learns nothing.
    pub(super) fn commander_of(&self, stream: &str, caller: &Caller) -> Result<Commander, Rejected> {
        if !stream.is_empty() {
            caller.may_use(stream)?;
        }
        let Known { open, ended } = &*self.lock();
        if let Some(commander) = open.get(stream) {
            return Ok(commander.clone());
        }
        if ended.has(stream) {
            return Err(over(stream));
        }
        let mut known = open.iter().filter(|(name, _)| caller.sees(name));
        match (known.next(), known.next()) {
            (Some((_, commander)), None) if stream.is_empty() => Ok(commander.clone()),
            (first, second) => {
                let names = first.into_iter().chain(second).chain(known).map(|(name, _)| name.as_str());
                Err(not_here(stream, &names.collect::<Vec<_>>()))
            }
        }
    }

    fn lock(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Entry {
    fn drop(&mut self) {
        let Known { open, ended } = &mut *self.streams.lock();
        if open.get(&self.stream).is_some_and(|newest| newest.is_of(&self.commander)) {
            open.remove(&self.stream);
            ended.note(std::mem::take(&mut self.stream));
        }
    }
}

fn over(stream: &str) -> Rejected {
    let text = format!(
        "no axis of this process follows stream {stream:?} any more, as it has ended: begin a new run"
    );
    Rejected::new(Reason::StreamFinished, text)
}

fn not_here(stream: &str, open: &[&str]) -> Rejected {
    let known = open.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
    let text = match (open.len(), stream) {
        (0, _) => "no axis of this process follows a stream: start one, as portamento track does".to_owned(),
        (_, "") => format!("several streams are followed here: say which, {known}"),
        _ => format!("no axis of this process follows stream {stream:?}: it is one of {known}"),
    };
    Rejected::new(Reason::StreamNotHere, text)
}
