use recording::{Beginning, Difference, Recording, UnreadableRecording};
use serde_json::json;

use crate::args::ReplayArgs;
use crate::failure::Failure;
use crate::show::number::counted;
use crate::show::paint::{Screen, clean, wrapped};

/// `portamento replay`
pub(crate) fn run(args: &ReplayArgs, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let recording = Recording::read(&args.recording).map_err(|error| match error {
        UnreadableRecording::Plan { cause, .. } => Failure::Refused(cause),
        UnreadableRecording::Io { .. }
        | UnreadableRecording::NotMcap { .. }
        | UnreadableRecording::NotARecording { .. } => Failure::Usage(error.to_string()),
    })?;
    let replayed = recording::replay(&recording).map_err(Failure::refused)?;
    let done = recording.operations.len() as u64;
    let missing = recording.revisions.unwrap_or(done).saturating_sub(done);
    let same = replayed.difference.is_none() && missing == 0;
    if screen.json {
        let difference = replayed.difference.as_ref().map(described);
        let taken_over = match &recording.beginning {
            Beginning::Motion(motion) => Some(motion.revision()),
            Beginning::Plan(_) => None,
        };
        let answer = json!({
            "same": same, "stream": recording.stream, "compared": replayed.compared, "notCompared": replayed.before,
            "planned": replayed.planned, "takenOverAtRevision": taken_over,
            "operations": done, "operationsMissing": missing, "difference": difference,
        });
        writeln!(screen.out, "{answer}")?;
    } else {
        let plan = match &recording.beginning {
            Beginning::Motion(motion) => format!(
                "Another server began this stream; from cycle {} on, from the motion of revision {} that it went on with, ",
                motion.under_way.from_cycle(),
                motion.revision()
            ),
            Beginning::Plan(_) if replayed.planned => "The request was planned again; ".to_owned(),
            Beginning::Plan(_) => String::new(),
        };
        let text = format!(
            "{plan}stream {} was played again with {}: {} compared.",
            clean(&recording.stream),
            counted(done, "operation"),
            counted(replayed.compared as u64, "setpoint")
        );
        writeln!(screen.out, "{}", wrapped(&text, ""))?;
        if replayed.before > 0 {
            let text = format!(
                "{} of cycles before that motion cannot be played again: only the server before knew what they follow from.",
                counted(replayed.before as u64, "setpoint")
            );
            writeln!(screen.out, "{}", wrapped(&text, ""))?;
        }
        if missing > 0 {
            let text = format!(
                "{} of this run took effect that the recording does not hold, since the server was asked and not the axis: from there \
                 on it differs. A recording of the server has all of them.",
                counted(missing, "operation")
            );
            writeln!(screen.out, "{}", wrapped(&text, ""))?;
        }
        let verdict = match &replayed.difference {
            None => screen.paint.good("Every bit is the same."),
            Some(difference) => screen.paint.bad(&wrapped(&said(difference, &recording), "")),
        };
        writeln!(screen.out, "{verdict}")?;
    }
    if same { Ok(()) } else { Err(Failure::Differ) }
}

fn described(difference: &Difference) -> serde_json::Value {
    match difference {
        Difference::Plan { fingerprints: [recorded, now] } => {
            json!({ "plan": { "recorded": recorded, "now": now } })
        }
        Difference::Setpoint { cycle, axis, quantity, values: [recorded, now] } => {
            json!({ "cycle": cycle, "axis": axis, "quantity": quantity.to_string(), "recorded": recorded, "now": now })
        }
    }
}

fn said(difference: &Difference, recording: &Recording) -> String {
    match difference {
        Difference::Plan { fingerprints: [recorded, now] } => format!(
            "The request gives another plan now: {now} instead of {recorded}. `portamento diff` shows in what they differ."
        ),
        Difference::Setpoint { cycle, axis, quantity, values: [recorded, now] } => format!(
            "It first differs at cycle {cycle}, {} s: of axis {} the {quantity} was {recorded:?} and is {now:?}.",
            *cycle as f64 * recording.beginning.plan().cycle_time().as_seconds(),
            clean(axis)
        ),
    }
}
