//! How long an answer of `Plan` takes with and without streams beside: `portamento-plans`, which was built beside this program.

use std::process::Command;

use serde_json::Value;

use crate::measured::Measured;
use crate::{Args, Failed};

/// Streams that run beside.
const STREAMS: &str = "200";

/// What is kept of a row, and as what.
const KEPT: [(&str, &str); 12] = [
    ("perSecond", "calls a second"),
    ("p50Us", "p50"),
    ("p99Us", "p99"),
    ("p999Us", "p99.9"),
    ("maxUs", "longest"),
    ("lateP99Us", "late p99"),
    ("lateP999Us", "late p99.9"),
    ("serverCpu", "server"),
    ("serverCpuNsEach", "server ns each"),
    ("underruns", "underruns"),
    ("leastLeadCycles", "least lead"),
    ("calls", "calls"),
];

pub(crate) fn measure(args: &Args, into: &mut Measured) -> Result<(), Failed> {
    let mut command = Command::new(std::env::current_exe()?.with_file_name("portamento-plans"));
    command.args(["--single", "--json", "--streams-beside", STREAMS]);
    // A thousand times as many calls as are above p99.9 take a while.
    let seconds = 3 * args.seconds;
    command.args(["--rounds", &args.rounds.to_string(), "--seconds", &seconds.to_string()]);
    let output = command.output().map_err(|error| format!("portamento-plans: {error}: build it"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    let rows: Value = serde_json::from_slice(&output.stdout)?;
    for row in rows.as_array().into_iter().flatten() {
        let name = row["name"].as_str().unwrap_or_default();
        let streams = row["streams"].as_f64().unwrap_or_default();
        for (key, kept) in KEPT {
            if let Some(value) = row[key].as_f64() {
                into.add(name, kept, streams, value);
            }
        }
    }
    Ok(())
}
