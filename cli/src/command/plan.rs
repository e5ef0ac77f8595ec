use std::path::Path;

use planner::Judged;
use proto::Rejected;

use crate::args::{self, PlanArgs};
use crate::failure::Failure;
use crate::service::Service;
use crate::show::paint::Screen;
use crate::show::{json, plot, table};
use crate::source::{self, Line, Lines};

/// How many lines of a batch are worked on together: what is in memory at once.
const LINES_AT_ONCE: usize = 1024;

/// `portamento plan`
pub(crate) fn run(args: &PlanArgs, endpoint: Option<&str>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let service = Service::open(endpoint)?;
    if let Some(path) = &args.batch {
        return batch(path, &service, screen);
    }
    let judged = match &args.request {
        Some(path) => service.plan(source::request(path)?)?,
        None => service
            .plan(args.one.to_spec(args.law.law()))
            .map_err(|failure| in_flags(failure, screen.json))?,
    };
    if let Some(path) = &args.output {
        let text = json::plan_file(&judged)? + "\n";
        std::fs::write(path, text).map_err(Failure::unwritable(path))?;
    }
    if let Some(path) = &args.plot {
        let svg = plot::svg(&plot::of_plan(judged.plan()))?;
        std::fs::write(path, svg).map_err(Failure::unwritable(path))?;
    }
    if screen.json {
        writeln!(screen.out, "{}", json::plan_response(&judged)?)?;
        return Ok(());
    }
    table::plan(screen, &judged)?;
    Ok(())
}

/// An answer a line, in the order of the lines.
fn batch(path: &Path, service: &Service, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let mut lines = Lines::open(path)?;
    loop {
        let next = lines.next(LINES_AT_ONCE).map_err(Failure::unreadable(path))?;
        if next.is_empty() {
            return Ok(());
        }
        service.plan_all(next, Line::request, answer_line, &mut |answer| {
            Ok(writeln!(screen.out, "{answer}")?)
        })?;
        // Whoever sends a line and waits for its answer gets it.
        screen.out.flush()?;
    }
}

fn answer_line(answer: Result<Judged, Rejected>) -> String {
    let written = answer.and_then(|judged| {
        // A plan of ours has nothing that JSON cannot carry.
        json::plan_response(&judged)
            .map_err(|error| Rejected::new(proto::Reason::PlanRejected, error.to_string()))
    });
    written.unwrap_or_else(|rejected| json::error(&rejected))
}

/// A refusal in the words of the command line. Programs get the fields of the schema.
pub(super) fn in_flags(failure: Failure, json: bool) -> Failure {
    match failure {
        Failure::Refused(mut rejected) if !json => {
            for violation in &mut rejected.fields {
                if let Some(flag) = args::flag_of(&violation.field) {
                    violation.field = flag.to_owned();
                }
                violation.description = args::in_flags(&violation.description);
            }
            Failure::Refused(rejected)
        }
        other => other,
    }
}
