//! What is written down of a run while it lasts.

use std::path::{Path, PathBuf};

use planner::{Judged, RequestSpec};
use proto::pb;
use recording::{Head, Recorder};
use sim_axis::{TrackingReport, Update};

use crate::failure::Failure;

/// A recording of a run, or none where nobody asked for one.
pub(crate) struct Record {
    to: Option<(PathBuf, Recorder)>,
    last_cycle: u64,
}

impl Record {
    /// Of the stream called `stream`, which is opened with a plan.
    pub(crate) fn begin(path: Option<&Path>, stream: &str, judged: &Judged) -> Result<Self, Failure> {
        let Some(path) = path else { return Ok(Self { to: None, last_cycle: 0 }) };
        let plan = judged.plan();
        let head = Head {
            stream: stream.to_owned(),
            recorded_by: concat!("portamento ", env!("CARGO_PKG_VERSION")).to_owned(),
            cycle_time: plan.cycle_time(),
            axes: plan.axes().iter().map(|axis| axis.axis.clone()).collect(),
        };
        let recorder = Recorder::create(path, &head).map_err(Failure::unwritable(path))?;
        let mut record = Self { to: Some((path.to_owned(), recorder)), last_cycle: 0 };
        record.with(|recorder| recorder.plan(judged))?;
        Ok(record)
    }

    /// What was asked of the planner.
    pub(crate) fn request(&mut self, request: RequestSpec) -> Result<(), Failure> {
        self.with(|recorder| recorder.request(&pb::PlanRequest::from(request)))
    }

    /// What a run tells while it goes on.
    pub(crate) fn update(&mut self, update: &Update) -> Result<(), Failure> {
        if let Update::Samples(samples) = update {
            self.last_cycle = samples.first_cycle + samples.commanded.cycles().saturating_sub(1) as u64;
        }
        self.with(|recorder| match update {
            Update::Samples(samples) => recorder.cycles(
                samples.first_cycle,
                &samples.commanded,
                Some(&samples.tracking),
                &samples.load_position,
            ),
            Update::Event(event) => recorder.event(*event),
            Update::Operated(done) => recorder.operation(done.0.clone(), Ok(done.1.clone())),
            Update::FailedOver(change) => recorder.fail_over(
                change.executed_cycle,
                &pb::FailOver {
                    cause: change.cause.name().into(),
                    from: change.from.clone(),
                    to: change.to.clone(),
                    executed_cycle: change.executed_cycle,
                    took: change.took.as_secs_f64(),
                },
            ),
        })
    }

    /// How it went; ends the recording.
    pub(crate) fn finish(mut self, report: &TrackingReport) -> Result<(), Failure> {
        let last = self.last_cycle;
        self.with(|recorder| recorder.report(last, &pb::TrackingReport::from(report.clone())))?;
        let Some((path, recorder)) = self.to else { return Ok(()) };
        recorder.finish().map_err(Failure::unwritable(&path))
    }

    fn with(&mut self, write: impl FnOnce(&mut Recorder) -> std::io::Result<()>) -> Result<(), Failure> {
        match &mut self.to {
            Some((path, recorder)) => write(recorder).map_err(Failure::unwritable(path)),
            None => Ok(()),
        }
    }
}
