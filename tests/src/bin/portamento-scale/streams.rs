//! What streams cost: `portamento-load`, which was built beside this program, in many forms.

use std::process::Command;

use serde_json::Value;

use crate::measured::Measured;
use crate::{Args, Failed};

/// Streams of one axis; of one gateway as many as `GATEWAY`.
const STREAMS: [usize; 6] = [10, 50, 100, 200, 400, 800];
const GATEWAY: usize = 50;
/// On a connection of their own each.
const ALONE: [usize; 4] = [10, 50, 100, 200];
/// Axes of a stream, of which there are a hundred.
const AXES: [usize; 4] = [1, 3, 6, 12];
const BATCHES: [u32; 4] = [5, 10, 20, 40];
/// Points of a motion, of streams of which there are 25.
const POINTS: [usize; 4] = [10, 100, 1000, 5000];
/// Streams whose server is killed.
const KILLED: [usize; 3] = [100, 200, 300];

pub(crate) fn measure(args: &Args, into: &mut Measured) -> Result<(), Failed> {
    for (form, flag) in [("plain", None), ("compact", Some("--compact"))] {
        for streams in STREAMS {
            let Some(row) = load(args, streams, GATEWAY, &[flag], into, form)? else { continue };
            let n = streams as f64;
            into.add("streams", &format!("server, {form}"), n, row.of("serverCpu")?);
            into.add("streams", &format!("axes, {form}"), n, row.of("axesCpu")?);
            into.add("bytes", form, n, row.of("bytesPerSetpoint")?);
            into.add("packets", form, n, row.of("packetsPerSetpoint")?);
            let server = row.of("idleKib")? + n * row.of("kibPerStream")?;
            into.add("memory", &format!("server, {form}"), n, server / 1024.0);
            into.add("memory", &format!("axes, {form}"), n, n * row.of("axesKibPerStream")? / 1024.0);
        }
        for axes in AXES {
            let each = axes.to_string();
            let row = load(args, 100, GATEWAY, &[flag, Some("--axes-each"), Some(&each)], into, form)?;
            let Some(row) = row else { continue };
            into.add("axes of a stream", &format!("server, {form}"), axes as f64, row.of("serverCpu")?);
            into.add("axes of a stream", &format!("axes, {form}"), axes as f64, row.of("axesCpu")?);
            into.add("bytes of a cycle", form, axes as f64, row.of("bytesPerSetpoint")?);
        }
        for streams in KILLED {
            // On one gateway: what is read beside it is that one's time as well.
            let Some(row) = load(args, streams, streams, &[flag, Some("--kill")], into, form)? else {
                continue;
            };
            let n = streams as f64;
            into.add("take-over", &format!("p50, {form}"), n, row.of("failoverP50Ms")?);
            into.add("take-over", &format!("longest, {form}"), n, row.of("failoverMaxMs")?);
            into.add("take-over cost", &format!("server, {form}"), n, row.of("takeOverServerCpuUs")?);
            into.add("take-over cost", &format!("axes, {form}"), n, row.of("takeOverAxesCpuUs")?);
        }
    }
    for streams in ALONE {
        let Some(row) = load(args, streams, 1, &[], into, "alone")? else { continue };
        into.add("streams", "server, alone", streams as f64, row.of("serverCpu")?);
        into.add("streams", "axes, alone", streams as f64, row.of("axesCpu")?);
        into.add("bytes", "alone", streams as f64, row.of("bytesPerSetpoint")?);
    }
    for cycles in BATCHES {
        let batch = cycles.to_string();
        let row = load(args, 100, GATEWAY, &[Some("--batch"), Some(&batch)], into, "batches")?;
        let Some(row) = row else { continue };
        into.add("batch", "server", f64::from(cycles), row.of("serverCpu")?);
        into.add("batch", "axes", f64::from(cycles), row.of("axesCpu")?);
        into.add("batch bytes", "both ways", f64::from(cycles), row.of("bytesPerSetpoint")?);
    }
    for points in POINTS {
        let through = points.to_string();
        // Each opens before the next begins: to open five thousand points takes milliseconds of both sides.
        let apart = [Some("--points"), Some(&through), Some("--apart"), Some("40")];
        let row = load(args, 25, 25, &apart, into, "points")?;
        let Some(row) = row else { continue };
        let n = row.of("segments")?;
        into.add("length", "to open, server", n, row.of("openServerCpuUs")? / 1e3);
        into.add("length", "to open, axis", n, row.of("openAxesCpuUs")? / 1e3);
        into.add("length cores", "server", n, row.of("serverCpu")?);
        into.add("length memory", "server", n, row.of("kibPerStream")?);
        into.add("length memory", "axis", n, row.of("axesKibPerStream")?);
    }
    Ok(())
}

struct Row(Value);

impl Row {
    fn of(&self, key: &str) -> Result<f64, Failed> {
        self.0[key].as_f64().ok_or_else(|| format!("portamento-load does not tell {key}").into())
    }
}

/// One run; none where an axis missed a cycle, which ends it, so that what is left is not what was asked for: that is counted instead.
fn load(
    args: &Args,
    streams: usize,
    sharing: usize,
    more: &[Option<&str>],
    into: &mut Measured,
    form: &str,
) -> Result<Option<Row>, Failed> {
    let mut command = Command::new(std::env::current_exe()?.with_file_name("portamento-load"));
    let kills = more.contains(&Some("--kill"));
    // Half of the time is before the death.
    let seconds = if kills { 2 } else { args.seconds };
    command.args(["--json", "--axes", &streams.to_string()]);
    if !more.contains(&Some("--apart")) {
        command.args(["--apart", "1"]);
    }
    command.args(["--sharing", &sharing.to_string(), "--seconds", &seconds.to_string()]);
    command.args(more.iter().flatten().filter(|flag| **flag != "--kill"));
    if !kills {
        command.arg("--no-kill");
    }
    let output = command.output().map_err(|error| format!("portamento-load: {error}: build it"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned().into());
    }
    let rows: Value = serde_json::from_slice(&output.stdout)?;
    let row = Row(rows[0].clone());
    let missed = row.of("underruns")?;
    into.add("underruns", form, streams as f64, missed);
    Ok((missed == 0.0).then_some(row))
}
