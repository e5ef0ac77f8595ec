//! Axes that stream from the same server while something else is measured: `portamento-load`, which was built beside this program.

use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Child, Command, Stdio};

use serde_json::Value;

use crate::asking::Measured;
use crate::{Args, Failed};

/// Streams that run; gone with their value.
pub(crate) struct Beside(Child);

impl Beside {
    /// Starts them, and waits until all play.
    pub(crate) fn start(args: &Args, endpoint: &str) -> Result<Self, Failed> {
        let mut command = Command::new(std::env::current_exe()?.with_file_name("portamento-load"));
        command.args(["--axes", &args.streams_beside.to_string(), "--sharing", &args.sharing.to_string()]);
        command.args([
            "--at",
            endpoint,
            "--until-input-ends",
            "--json",
            "--seconds",
            &args.seconds.to_string(),
        ]);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut this = Self(command.spawn().map_err(|error| format!("portamento-load: {error}: build it"))?);
        let lines = this.0.stderr.take().map(BufReader::new).map(BufReader::lines);
        let mut lines = lines.into_iter().flatten().map_while(Result::ok);
        lines.find(|line| line.ends_with("all play")).ok_or("the streams beside do not open")?;
        // Read on, or a full pipe would hold them up.
        std::thread::spawn(move || lines.for_each(drop));
        Ok(this)
    }

    /// Ends them, and adds what became of them.
    pub(crate) fn end(mut self, into: &mut Measured) -> Result<(), Failed> {
        drop(self.0.stdin.take());
        let mut text = String::new();
        self.0.stdout.take().ok_or("the streams beside say nothing")?.read_to_string(&mut text)?;
        let status = self.0.wait()?;
        if !status.success() {
            return Err(
                format!("the streams beside ended with {status}: run portamento-load by itself").into()
            );
        }
        let rows: Value = serde_json::from_str(&text)?;
        let count =
            |key: &str| rows[0][key].as_u64().ok_or_else(|| format!("the streams beside do not tell {key}"));
        into.beside.streams = count("axes")?;
        into.beside.underruns += count("underruns")?;
        let least = count("leastLeadCycles")?;
        into.beside.least_lead = Some(into.beside.least_lead.map_or(least, |before| before.min(least)));
        Ok(())
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
