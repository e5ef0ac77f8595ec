use proto::{Reason, code_name};

use crate::args::ExplainArgs;
use crate::failure::Failure;
use crate::show::paint::{Screen, wrapped};

/// `portamento explain`
pub(crate) fn run(args: &ExplainArgs, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let reasons = match &args.reason {
        Some(reason) => std::slice::from_ref(reason),
        None => Reason::ALL,
    };
    for (index, reason) in reasons.iter().enumerate() {
        let (code, name, explanation) = (code_name(reason.code()), reason.name(), reason.explanation());
        if screen.json {
            let object = serde_json::json!({ "reason": name, "code": code, "explanation": explanation });
            writeln!(screen.out, "{object}")?;
            continue;
        }
        if index > 0 {
            writeln!(screen.out)?;
        }
        let (name, code) = (screen.paint.heading(name), screen.paint.quiet(&format!("({code})")));
        writeln!(screen.out, "{name} {code}\n{}", wrapped(explanation, "  "))?;
    }
    Ok(())
}
