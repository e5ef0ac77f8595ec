use planner::Field;

use crate::args::VerifyArgs;
use crate::failure::Failure;
use crate::service::{Server, Service};
use crate::show::paint::Screen;
use crate::show::{json, table};
use crate::source;

/// `portamento verify`
pub(crate) fn run(args: &VerifyArgs, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let (plan, mut misstated) = source::plan_as_it_is(args.source.path())?;
    misstated.extend_within(&Field::default(), proto::misclassified(&plan));
    let against = args.against.as_deref().map(source::against).transpose()?;
    let certificate = Service::open(server)?.verify(&plan, against.unwrap_or_default())?;
    let honest = misstated.is_empty();
    if screen.json && (honest || !certificate.passed()) {
        writeln!(screen.out, "{}", json::verify_response(&certificate)?)?;
    } else if screen.json {
        // As the service refuses it.
        writeln!(screen.out, "{}", json::error(&misstated.into()))?;
    } else {
        table::certificate(screen, &plan, &certificate)?;
        if !honest {
            writeln!(screen.out)?;
            table::misstated(screen, &misstated)?;
        }
    }
    if certificate.passed() && honest { Ok(()) } else { Err(Failure::NotPassed) }
}
