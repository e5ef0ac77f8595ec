use std::fs::File;
use std::io::{self, BufWriter, Write as _};

use planner::CycleTime;

use crate::record::{Head, Moment};

/// Cycles as comma-separated values, at full precision; what is not known is left empty.
#[derive(Debug)]
pub(crate) struct Table {
    file: BufWriter<File>,
    cycle_time: CycleTime,
}

/// Of each axis.
const COLUMNS: [&str; 7] =
    ["position", "velocity", "acceleration", "jerk", "measured_position", "following_error", "load_position"];

impl Table {
    pub(crate) fn begin(mut file: BufWriter<File>, head: &Head) -> io::Result<Self> {
        write!(file, "cycle,time_s,cycle_jitter_ns")?;
        for axis in &head.axes {
            for column in COLUMNS {
                write!(file, ",{}", quoted(&format!("{axis}.{column}")))?;
            }
        }
        writeln!(file)?;
        Ok(Self { file, cycle_time: head.cycle_time })
    }

    pub(crate) fn cycle(&mut self, cycle: u64, moments: impl Iterator<Item = Moment>) -> io::Result<()> {
        let mut moments = moments.peekable();
        write!(self.file, "{cycle},{:?},", self.cycle_time.start_of(cycle))?;
        if let Some(jitter) = moments.peek().and_then(|moment| moment.cycle_jitter_ns) {
            write!(self.file, "{jitter}")?;
        }
        for Moment { setpoint, measured_position, following_error, load_position, .. } in moments {
            for word in setpoint.words() {
                write!(self.file, ",{word:?}")?;
            }
            for known in [measured_position, following_error, load_position] {
                match known {
                    Some(value) => write!(self.file, ",{value:?}")?,
                    None => write!(self.file, ",")?,
                }
            }
        }
        writeln!(self.file)
    }

    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// A field as RFC 4180 wants it.
fn quoted(field: &str) -> String {
    if field.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", field.replace('"', "\"\""))
    } else {
        field.to_owned()
    }
}
