use std::collections::VecDeque;

/// Names of what has lately come to an end, so that whoever comes too late for it is told so, and not that nobody knows it.
#[derive(Clone, Debug, Default)]
pub struct Ended {
    names: VecDeque<String>,
}

/// As many names are kept; with the longest that is a quarter of a megabyte.
const MOST: usize = 1024;

impl Ended {
    /// Notes that `name` has ended.
    pub fn note(&mut self, name: String) {
        self.forget(&name);
        if self.names.len() >= MOST {
            self.names.pop_front();
        }
        self.names.push_back(name);
    }

    /// `name` has begun again.
    pub fn forget(&mut self, name: &str) {
        self.names.retain(|ended| ended != name);
    }

    /// Has `name` ended, and not begun again?
    #[must_use]
    pub fn has(&self, name: &str) -> bool {
        self.names.iter().any(|ended| ended == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_are_known() {
        let mut ended = Ended::default();
        for number in 0..=MOST {
            ended.note(format!("stream {number}"));
        }
        assert!(!ended.has("stream 0") && ended.has("stream 1") && ended.has(&format!("stream {MOST}")));
        ended.note("stream 1".into());
        ended.note("another".into());
        assert!(ended.has("stream 1") && !ended.has("stream 2"));
        ended.forget("stream 1");
        assert!(!ended.has("stream 1"));
    }
}
