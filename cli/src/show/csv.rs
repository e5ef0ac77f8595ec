//! Setpoints as comma-separated values, at full precision.

use std::borrow::Cow;
use std::io::{self, Write};

use planner::CycleTime;
use proto::stream::Columns;

/// `cycle,time_s,<axis>.position,<axis>.velocity,…`
pub(crate) fn header<'a>(out: &mut dyn Write, axes: impl Iterator<Item = &'a str>) -> io::Result<()> {
    write!(out, "cycle,time_s")?;
    for axis in axes {
        for quantity in ["position", "velocity", "acceleration", "jerk"] {
            write!(out, ",{}", quoted(&format!("{axis}.{quantity}")))?;
        }
    }
    writeln!(out)
}

/// A line for each cycle. Every number is the shortest one that reads back to the same bits.
pub(crate) fn rows(
    out: &mut dyn Write,
    cycle_time: CycleTime,
    first_cycle: u64,
    columns: &Columns,
) -> io::Result<()> {
    for (index, cycle) in (0..columns.cycles()).zip(first_cycle..) {
        write!(out, "{cycle},{:?}", cycle_time.start_of(cycle))?;
        for setpoint in columns.cycle(index) {
            for word in setpoint.words() {
                write!(out, ",{word:?}")?;
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

/// A field as RFC 4180 wants it.
fn quoted(field: &str) -> Cow<'_, str> {
    if field.contains([',', '"', '\n', '\r']) {
        Cow::Owned(format!("\"{}\"", field.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(field)
    }
}
