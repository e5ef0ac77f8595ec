use planner::PvtRequestSpec;
use proto::FieldViolation;

use crate::args::PvtArgs;
use crate::command::plan::in_flags;
use crate::command::{batch, follow};
use crate::failure::Failure;
use crate::law::Law;
use crate::service::{Server, Service};
use crate::show::paint::Screen;
use crate::show::{json, plot, points};
use crate::source::{self, Line, PointTable};

/// `portamento pvt`
pub(crate) fn run(args: &PvtArgs, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    if args.follow {
        return follow::run(args, screen);
    }
    let service = Service::open(server)?;
    if let Some(path) = &args.batch {
        return batch::run(path, &service, Line::pvt_request, json::pvt_response, screen);
    }
    let judged = match (&args.request, &args.points) {
        (Some(path), _) => service.plan(source::pvt_request(path)?)?,
        (None, Some(path)) => {
            args.limits.check_jerk(Law::default())?;
            let table = PointTable::read(path)?;
            let refused = |failure| in_table(failure, &table, screen.json);
            service.plan(to_spec(args, &table)).map_err(refused)?
        }
        // Clap wants one of them.
        (None, None) => return Err(Failure::Internal("name the points".to_owned())),
    };
    if let Some(path) = &args.output {
        let text = json::plan_file(judged.judged())? + "\n";
        std::fs::write(path, text).map_err(Failure::unwritable(path))?;
    }
    if let Some(path) = &args.plot {
        plot::write(path, &plot::of_points(&judged))?;
    }
    if screen.json {
        writeln!(screen.out, "{}", json::pvt_response(&judged)?)?;
    } else {
        points::plan(screen, &judged)?;
    }
    if judged.judged().certificate().passed() { Ok(()) } else { Err(Failure::NotPassed) }
}

fn to_spec(args: &PvtArgs, table: &PointTable) -> PvtRequestSpec {
    let method = &args.method;
    PvtRequestSpec {
        axes: table.axes(&args.limits.to_spec(), method.kind()),
        cycle_time_ns: method.cycle_time,
        interpolation: Ok(method.interpolation()),
        policy: Ok(method.policy()),
        finish_unreached: method.finish_unreached,
    }
}

/// A refusal in the words of the table and the command line. Programs get the fields of the schema.
fn in_table(mut failure: Failure, table: &PointTable, json: bool) -> Failure {
    if let (Failure::Refused(rejected), false) = (&mut failure, json) {
        for violation in &mut rejected.fields {
            if let Some(place) = table.place(&violation.field) {
                violation.field = place;
            }
        }
    }
    match in_flags(failure, json) {
        Failure::Refused(mut rejected) => {
            // What all axes have from one flag is wrong once.
            let mut fields: Vec<FieldViolation> = Vec::with_capacity(rejected.fields.len());
            for violation in rejected.fields {
                if json || !fields.contains(&violation) {
                    fields.push(violation);
                }
            }
            rejected.fields = fields;
            Failure::Refused(rejected)
        }
        other => other,
    }
}
