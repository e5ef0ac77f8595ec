use alloc::vec::Vec;

use super::span::Span;
use crate::State;

/// A time law that leads to another rate.
#[derive(Clone, Debug)]
pub(super) struct Course {
    /// From the splice on; the last span may go on beyond the end of the path.
    pub(super) law: Vec<Span>,
    /// Where that leads, if the path does not end before: path time, the rate exactly as asked, no slope.
    pub(super) end: State,
    /// When the rate is reached \[s\]; `None` where the path ends before.
    pub(super) reached: Option<f64>,
}

impl Course {
    /// The present law goes on.
    pub(super) fn unchanged(present: Lead<'_>) -> Self {
        Self { law: present.spans.to_vec(), end: present.end, reached: None }
    }
}

/// A law to follow until a ramp begins.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lead<'a> {
    pub(super) spans: &'a [Span],
    /// Where they lead, exactly.
    pub(super) end: State,
}

impl Lead<'_> {
    /// Path time now.
    pub(super) fn start(&self) -> State {
        self.spans.first().map_or(self.end, |first| first.start)
    }

    /// How long it lasts \[s\].
    pub(super) fn duration(&self) -> f64 {
        self.spans.iter().map(|span| span.duration).fold(0.0, |sum, duration| sum + duration)
    }

    /// The state after `wait` seconds.
    pub(super) fn after(&self, wait: f64) -> State {
        let mut begin = 0.0;
        for span in self.spans {
            if wait < begin + span.duration {
                return span.at(wait - begin);
            }
            begin += span.duration;
        }
        self.end
    }

    /// Its first `wait` seconds.
    pub(super) fn until(&self, wait: f64) -> impl Iterator<Item = Span> {
        let mut left = wait;
        self.spans.iter().map_while(move |span| {
            let duration = span.duration.min(left);
            left -= span.duration;
            (duration > 0.0).then_some(Span { duration, ..*span })
        })
    }
}
