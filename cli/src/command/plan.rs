use crate::args::{self, PlanArgs};
use crate::command::batch;
use crate::failure::Failure;
use crate::service::{Server, Service};
use crate::show::paint::Screen;
use crate::show::{json, plot, table};
use crate::source::{self, Line};

/// `portamento plan`
pub(crate) fn run(args: &PlanArgs, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let service = Service::open(server)?;
    if let Some(path) = &args.batch {
        return batch::run(path, &service, Line::request, json::plan_response, screen);
    }
    let judged = match &args.request {
        Some(path) => service.plan(source::request(path)?)?,
        None if args.one.distance_is_lost() => return Err(Failure::Usage(args::LOST_DISTANCE.to_owned())),
        None => {
            args.limits.check_jerk(args.law.law())?;
            service
                .plan(args.one.to_spec(args.higher.beside(&args.limits), args.law.law()))
                .map_err(|failure| in_flags(failure, screen.json))?
        }
    };
    if let Some(path) = &args.output {
        let text = json::plan_file(&judged)? + "\n";
        std::fs::write(path, text).map_err(Failure::unwritable(path))?;
    }
    if let Some(path) = &args.plot {
        plot::write(path, &plot::of_plan(judged.plan()))?;
    }
    if screen.json {
        writeln!(screen.out, "{}", json::plan_response(&judged)?)?;
    } else {
        table::plan(screen, &judged)?;
    }
    if judged.certificate().passed() { Ok(()) } else { Err(Failure::NotPassed) }
}

/// A refusal in the words of the command line. Programs get the fields of the schema.
pub(super) fn in_flags(failure: Failure, json: bool) -> Failure {
    match failure {
        Failure::Refused(mut rejected) if !json => {
            for violation in &mut rejected.fields {
                if let Some(flag) = args::flag_of(&violation.field) {
                    violation.field = flag;
                }
                violation.description = args::in_flags(&violation.description);
            }
            Failure::Refused(rejected)
        }
        other => other,
    }
}
