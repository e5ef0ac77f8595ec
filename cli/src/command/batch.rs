use std::path::Path;

use proto::{JsonError, Reason, Rejected};

use crate::failure::Failure;
use crate::service::{Question, Service};
use crate::show::json;
use crate::show::paint::Screen;
use crate::source::{Line, Lines};

/// How many lines of a batch are worked on together: what is in memory at once.
const LINES_AT_ONCE: usize = 1024;

/// An answer a line, in the order of the lines.
pub(super) fn run<Q: Question>(
    path: &Path,
    service: &Service,
    read: fn(&Line) -> Result<Q, Rejected>,
    write: fn(&Q::Answer) -> Result<String, JsonError>,
    screen: &mut Screen<'_>,
) -> Result<(), Failure> {
    let line = move |answer: Result<Q::Answer, Rejected>| {
        let written = answer.and_then(|answer| {
            // A plan of ours has nothing that JSON cannot carry.
            write(&answer).map_err(|error| Rejected::new(Reason::PlanRejected, error.to_string()))
        });
        written.unwrap_or_else(|rejected| json::error(&rejected))
    };
    let mut lines = Lines::open(path)?;
    loop {
        let next = lines.next(LINES_AT_ONCE).map_err(Failure::unreadable(path))?;
        if next.is_empty() {
            return Ok(());
        }
        service.plan_all(next, read, line, &mut |answer| Ok(writeln!(screen.out, "{answer}")?))?;
        // Whoever sends a line and waits for its answer gets it.
        screen.out.flush()?;
    }
}
