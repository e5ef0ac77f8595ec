use crate::args::VerifyArgs;
use crate::failure::Failure;
use crate::service::Service;
use crate::show::paint::Screen;
use crate::show::{json, table};
use crate::source;

/// `portamento verify`
pub(crate) fn run(args: &VerifyArgs, endpoint: Option<&str>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let (plan, changed) = source::plan(&args.source.plan)?;
    if changed {
        writeln!(screen.notes, "note: the plan is not as it was made: its fingerprint is that of another")?;
    }
    let against = args.against.as_deref().map(source::against).transpose()?;
    let certificate = Service::open(endpoint)?.verify(&plan, against.unwrap_or_default())?;
    if screen.json {
        writeln!(screen.out, "{}", json::verify_response(&certificate)?)?;
    } else {
        table::certificate(screen, &plan, &certificate)?;
    }
    if certificate.passed() { Ok(()) } else { Err(Failure::NotPassed) }
}
