use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use planner::{CycleTime, Judged, Setpoint};
use proto::stream::{Columns, Motion, Operation, OperationResult, StreamEvent, Tracking};
use proto::{Rejected, pb};

use crate::mcap_file::McapFile;
use crate::table::Table;

/// What is recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    /// Name of the stream.
    pub stream: String,
    /// Name and version of the program that records.
    pub recorded_by: String,
    /// The period of which cycles are counts.
    pub cycle_time: CycleTime,
    /// Names of the axes, in plan order.
    pub axes: Vec<String>,
}

/// How the axes followed in one cycle, in plan order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// As the encoders tell them \[axis units\].
    pub positions: Vec<f64>,
    /// Setpoint minus measured \[axis units\].
    pub following_errors: Vec<f64>,
    /// How late the cycle began \[ns\].
    pub cycle_jitter_ns: i32,
}

/// Writes a recording, in the format that the name of its file says.
#[derive(Debug)]
pub struct Recorder {
    axes: usize,
    to: To,
}

#[derive(Debug)]
enum To {
    Mcap(Box<McapFile>),
    Csv(Box<Table>),
}

/// One axis in one cycle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    pub(crate) setpoint: Setpoint,
    pub(crate) measured_position: Option<f64>,
    pub(crate) following_error: Option<f64>,
    pub(crate) load_position: Option<f64>,
    pub(crate) cycle_jitter_ns: Option<i32>,
}

impl Recorder {
    /// Begins a recording in `path`: a table where it ends in `.csv`, MCAP where in anything else.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn create(path: &Path, head: &Head) -> io::Result<Self> {
        let file = BufWriter::new(File::create(path)?);
        let is_csv = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv"));
        let to = if is_csv {
            To::Csv(Box::new(Table::begin(file, head)?))
        } else {
            To::Mcap(Box::new(McapFile::begin(file, head)?))
        };
        Ok(Self { axes: head.axes.len(), to })
    }

    /// What was asked of the planner.
    ///
    /// # Errors
    /// A file that cannot be written; so for all of them.
    pub fn request(&mut self, request: &pb::PlanRequest) -> io::Result<()> {
        self.only_mcap(|file| file.write("/request", 0, request))
    }

    /// What the stream was opened with.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn plan(&mut self, judged: &Judged) -> io::Result<()> {
        self.only_mcap(|file| file.write("/plan", 0, &proto::plan_to_wire(judged)))
    }

    /// What the stream goes on with here, where it began elsewhere: in place of [`plan`](Self::plan).
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn motion(&mut self, motion: &Motion) -> io::Result<()> {
        let from = motion.under_way.from_cycle();
        self.only_mcap(|file| file.write("/motion", from, &proto::motion_to_wire(motion)))
    }

    /// Consecutive cycles, with how the axes followed and where the loads were, as far as that is known.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn cycles(
        &mut self,
        first_cycle: u64,
        commanded: &Columns,
        tracking: Option<&Tracking>,
        load_position: &[f64],
    ) -> io::Result<()> {
        let cycles = commanded.cycles();
        // Of the same cycles, or of none.
        let tracking = tracking
            .filter(|tracking| (tracking.first_cycle, tracking.cycles as usize) == (first_cycle, cycles));
        for (index, cycle) in (0..cycles).zip(first_cycle..) {
            let moments = (0..self.axes).map(|axis| {
                let place = axis * cycles + index;
                Moment {
                    setpoint: commanded.at(axis, index).unwrap_or_default(),
                    measured_position: tracking.and_then(|of| of.measured_position.get(place).copied()),
                    following_error: tracking.and_then(|of| of.following_error.get(place).copied()),
                    load_position: load_position.get(place).copied(),
                    cycle_jitter_ns: tracking.and_then(|of| of.cycle_jitter_ns.get(index).copied()),
                }
            });
            match &mut self.to {
                To::Mcap(file) => file.cycle(cycle, moments)?,
                To::Csv(table) => table.cycle(cycle, moments)?,
            }
        }
        Ok(())
    }

    /// One cycle of all axes, with how they followed where that is known.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn cycle(
        &mut self,
        cycle: u64,
        setpoints: &[Setpoint],
        measured: Option<&Measured>,
    ) -> io::Result<()> {
        let moments = setpoints.iter().enumerate().map(|(axis, setpoint)| Moment {
            setpoint: *setpoint,
            measured_position: measured.and_then(|of| of.positions.get(axis).copied()),
            following_error: measured.and_then(|of| of.following_errors.get(axis).copied()),
            load_position: None,
            cycle_jitter_ns: measured.map(|of| of.cycle_jitter_ns),
        });
        match &mut self.to {
            To::Mcap(file) => file.cycle(cycle, moments),
            To::Csv(table) => table.cycle(cycle, moments),
        }
    }

    /// Something that happened.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn event(&mut self, event: StreamEvent) -> io::Result<()> {
        self.only_mcap(|file| file.write("/events", event.at_cycle, &pb::StreamEvent::from(event)))
    }

    /// Another replica has taken over.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn fail_over(&mut self, executed_cycle: u64, change: &pb::FailOver) -> io::Result<()> {
        self.only_mcap(|file| file.write("/failovers", executed_cycle, change))
    }

    /// An operation, and what became of it.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn operation(
        &mut self,
        operation: Operation,
        result: Result<OperationResult, &Rejected>,
    ) -> io::Result<()> {
        let cycle =
            result.as_ref().map_or(operation.not_before_cycle.unwrap_or(0), |result| result.effective_cycle);
        let refused = result.as_ref().err().map(|rejected| rejected.reason.to_string()).unwrap_or_default();
        let result = result.ok().map(Into::into);
        let recorded = pb::RecordedOperation { operation: Some(operation.into()), result, refused };
        self.only_mcap(|file| file.write("/operations", cycle, &recorded))
    }

    /// How the run went, after its last cycle.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn report(&mut self, last_cycle: u64, report: &pb::TrackingReport) -> io::Result<()> {
        self.only_mcap(|file| file.write("/report", last_cycle, report))
    }

    /// Ends the file: what is not ended cannot be read everywhere.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn finish(self) -> io::Result<()> {
        match self.to {
            To::Mcap(file) => file.finish(),
            To::Csv(table) => table.finish(),
        }
    }

    fn only_mcap(&mut self, write: impl FnOnce(&mut McapFile) -> io::Result<()>) -> io::Result<()> {
        match &mut self.to {
            To::Mcap(file) => write(file),
            // A table has cycles, and nothing else.
            To::Csv(_) => Ok(()),
        }
    }
}
