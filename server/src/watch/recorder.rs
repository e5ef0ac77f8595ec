//! Streams written down as they run: a watcher that writes a file instead of sending messages.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;

use proto::stream::Motion;
use recording::{Head, Recorder};

use super::board::{Seen, Watching};
use super::rows::Rows;

/// Where streams are written down.
#[derive(Clone, Debug)]
pub(super) struct Shelf(PathBuf);

/// What is written of one stream before it runs.
pub(super) struct Title {
    pub(super) stream: String,
    pub(super) epoch: u64,
    pub(super) motion: Motion,
}

impl Shelf {
    pub(super) fn at(folder: &Path) -> Self {
        Self(folder.to_owned())
    }

    /// Writes down what `watching` is told, in a file of its own, until the stream ends. A disk that is slow or full costs the
    /// recording, and never the stream.
    pub(super) fn write_down(&self, title: Title, mut watching: Watching) {
        let path = self.0.join(file_name(&title.stream, title.epoch));
        tokio::task::spawn_blocking(move || {
            let written = begin(&path, &title).and_then(|mut recorder| {
                let mut rows = Rows::of_axes(title.motion.plan().axes().len());
                while let Some(seen) = watching.seen.blocking_recv() {
                    write(&mut recorder, &mut rows, seen)?;
                }
                write_rows(&mut recorder, &mut rows, true)?;
                recorder.finish()
            });
            let lost = watching.lost.load(Ordering::Relaxed);
            let (stream, path) = (&title.stream, path.display());
            match written {
                Ok(()) if lost == 0 => tracing::info!(stream, %path, "stream written down"),
                Ok(()) => {
                    tracing::warn!(stream, %path, lost, "stream written down with gaps: the disk was too slow")
                }
                Err(error) => tracing::warn!(stream, %path, %error, "stream not written down"),
            }
        });
    }
}

fn begin(path: &Path, title: &Title) -> std::io::Result<Recorder> {
    let plan = title.motion.plan();
    let head = Head {
        stream: title.stream.clone(),
        recorded_by: concat!("portamento-server ", env!("CARGO_PKG_VERSION")).to_owned(),
        cycle_time: plan.cycle_time(),
        axes: plan.axes().iter().map(|axis| axis.axis.clone()).collect(),
    };
    let mut recorder = Recorder::create(path, &head)?;
    // Until something is done to it a motion is the plan that the stream was opened with, wherever that was; but for one with
    // a closing stop, which is no plan that anybody asked for.
    let is_a_plan = title.motion.revision() == 0 && title.motion.under_way.closing_from_cycle().is_none();
    if is_a_plan {
        recorder.plan(title.motion.accepted().judged())?;
    } else {
        recorder.motion(&title.motion)?;
    }
    Ok(recorder)
}

fn write(recorder: &mut Recorder, rows: &mut Rows, seen: Seen) -> std::io::Result<()> {
    match seen {
        Seen::Event(event) => recorder.event(event),
        Seen::Done(done) => {
            let (operation, result) = done.as_ref();
            recorder.operation(operation.clone(), Ok(result.clone()))
        }
        Seen::Report(reported) => {
            rows.command(reported.first_cycle, &reported.commanded);
            if let Some(tracking) = &reported.tracking {
                rows.measure(tracking);
            }
            write_rows(recorder, rows, false)
        }
    }
}

fn write_rows(recorder: &mut Recorder, rows: &mut Rows, end: bool) -> std::io::Result<()> {
    rows.take(end)
        .into_iter()
        .try_for_each(|row| recorder.cycle(row.cycle, &row.setpoints, row.measured.as_ref()))
}

/// A name that every file system takes, and that no stream can lead out of the folder with.
fn file_name(stream: &str, epoch: u64) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    let name: String = stream.chars().take(100).map(plain).collect();
    format!("{}-{epoch}.mcap", name.trim_start_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_stream_leads_out_of_the_folder() {
        assert_eq!(file_name("cell-7/x", 3), "cell-7_x-3.mcap");
        assert_eq!(file_name("../../etc/passwd", 1), "_.._etc_passwd-1.mcap");
        assert_eq!(file_name(&"µ".repeat(300), 1).len(), "-1.mcap".len() + 100);
    }
}
