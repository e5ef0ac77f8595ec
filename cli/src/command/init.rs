use std::fs::OpenOptions;
use std::io::{self, Write as _};

use proto::pb;

use crate::args::{InitArgs, What};
use crate::failure::Failure;
use crate::show::paint::Screen;
use crate::source;

const PLAN: &str = include_str!("templates/plan.jsonc");
const PVT: &str = include_str!("templates/pvt.jsonc");

/// `portamento init`
pub(crate) fn run(args: &InitArgs, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let InitArgs { force, bare, .. } = args;
    let (what, file) = args.what_and_where()?;
    let (command, text) = match what {
        What::Plan => ("plan", PLAN),
        What::Pvt => ("pvt", PVT),
    };
    let text = if *bare { without_comments(what, text)? } else { text.to_owned() };
    if file.as_os_str() == "-" {
        write!(screen.out, "{text}")?;
        return Ok(());
    }
    let mut options = OpenOptions::new();
    // A request that somebody has edited is not lost by a second thought.
    options.write(true).create(true).truncate(true).create_new(!force);
    let written = options.open(&file).and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|cause| match cause.kind() {
        io::ErrorKind::AlreadyExists => {
            Failure::Usage(format!("{} is there already: name another file, or give --force", file.display()))
        }
        _ => Failure::Unwritable { path: file.clone(), cause },
    })?;
    let name = file.display();
    if screen.json {
        writeln!(screen.out, "{}", serde_json::json!({ "written": name.to_string() }))?;
    } else {
        writeln!(
            screen.out,
            "{name} is written: edit it, then\n  portamento {command} --request {name} --plot plot.svg"
        )?;
    }
    Ok(())
}

/// The template as programs want it: read as every command reads it, and written again.
fn without_comments(what: What, text: &str) -> Result<String, Failure> {
    let text = source::without_comments(text);
    let json = match what {
        What::Plan => proto::to_json_pretty(&proto::from_json::<pb::PlanRequest>(&text)?),
        What::Pvt => proto::to_json_pretty(&proto::from_json::<pb::PlanPvtRequest>(&text)?),
    };
    Ok(json? + "\n")
}
