use std::ops::RangeInclusive;

use planner::{Field, InvalidField, InvalidFields, LAST_CYCLE, Profile, State, Why, wrong_name};

use super::choice::{event_from_wire, event_to_wire};
use super::field::missing;
use super::motion::{motion_from_wire, motion_in, motion_to_wire, motion_unexplained};
use super::plan::{segment_from_wire, segment_to_wire};
use super::{accepted_in, plan_to_wire, within};
use crate::stream::{
    BATCH_CYCLES, Batch, Columns, Counters, DEFAULT_AXIS_GUARD, DEFAULT_BATCH_CYCLES, DEFAULT_LEAD_CYCLES,
    FARTHEST_AHEAD, FARTHEST_CHECKPOINT, FromAxis, LEAD_CYCLES, Open, Opened, OperationRefusal,
    RefusalReason, Refused, Report, Resume, Revised, Source, StreamEvent, Tails, ToAxis, Tracking,
};
use crate::{Digest, FieldViolation, Reason, Rejected, pb};
use pb::stream_setpoints_request::Message as Request;
use pb::stream_setpoints_response::Message as Response;

/// What an axis said.
///
/// # Errors
/// An empty message, a plan that is not one or that the judge rejects, a reason that is not known.
pub fn request_from_wire(wire: pb::StreamSetpointsRequest) -> Result<FromAxis, Rejected> {
    let pb::StreamSetpointsRequest { message } = wire;
    match message {
        Some(Request::Open(open)) => open_from_wire(*open).map(|open| FromAxis::Open(Box::new(open))),
        Some(Request::Report(report)) => report_from_wire(report).map(FromAxis::Report),
        Some(Request::Operation(operation)) => Ok(FromAxis::Operation(operation.into())),
        None => Err(empty_message("open, report or operation")),
    }
}

/// What an axis says, on the wire.
#[must_use]
pub fn request_to_wire(request: &FromAxis) -> pb::StreamSetpointsRequest {
    let message = match request {
        FromAxis::Open(open) => Request::Open(Box::new(open_to_wire(open))),
        FromAxis::Report(report) => Request::Report(report_to_wire(report)),
        FromAxis::Operation(operation) => Request::Operation(operation.clone().into()),
    };
    pb::StreamSetpointsRequest { message: Some(message) }
}

/// What a server said, and its epoch.
///
/// # Errors
/// An empty message, a plan that is not one or that the judge rejects, columns of different lengths.
pub fn response_from_wire(wire: pb::StreamSetpointsResponse) -> Result<(u64, ToAxis), Rejected> {
    let pb::StreamSetpointsResponse { epoch, message } = wire;
    let message = match message {
        Some(Response::Opened(opened)) => ToAxis::Opened(Box::new(opened_from_wire(*opened)?)),
        Some(Response::Revised(revised)) => {
            let pb::MotionRevised { motion, certificate: _ } = *revised;
            ToAxis::Revised(Box::new(Revised { motion: motion_in(motion)? }))
        }
        Some(Response::Batch(batch)) => ToAxis::Batch(batch_from_wire(batch)?),
        Some(Response::Event(event)) => ToAxis::Event(event.try_into()?),
        Some(Response::Refusal(pb::OperationRefusal { request_id, status })) => {
            let unreadable = || Rejected::new(Reason::NotImplemented, "a refusal that cannot be read");
            let rejected = Rejected::from_bytes(&status).unwrap_or_else(unreadable);
            ToAxis::Refusal(OperationRefusal { request_id, rejected })
        }
        Some(Response::Operation(result)) => ToAxis::Result(result.into()),
        None => return Err(empty_message("opened, revised, batch, operation, event or refusal")),
    };
    Ok((epoch, message))
}

/// What a server says under `epoch`, on the wire.
#[must_use]
pub fn response_to_wire(epoch: u64, response: ToAxis) -> pb::StreamSetpointsResponse {
    let message = match response {
        ToAxis::Opened(opened) => {
            let Opened { motion, first_cycle, served_by, current_epoch } = *opened;
            let motion = motion.as_ref().map(motion_to_wire);
            Response::Opened(Box::new(pb::Opened { motion, first_cycle, served_by, current_epoch }))
        }
        ToAxis::Revised(revised) => {
            let Revised { motion } = *revised;
            let certificate = Some(motion.accepted().judged().certificate().into());
            let motion = Some(motion_to_wire(&motion));
            Response::Revised(Box::new(pb::MotionRevised { motion, certificate }))
        }
        ToAxis::Batch(batch) => Response::Batch(batch_to_wire(batch)),
        ToAxis::Event(event) => Response::Event(event.into()),
        ToAxis::Result(result) => Response::Operation(result.into()),
        ToAxis::Refusal(OperationRefusal { request_id, rejected }) => {
            Response::Refusal(pb::OperationRefusal { request_id, status: rejected.to_bytes() })
        }
    };
    pb::StreamSetpointsResponse { epoch, message: Some(message) }
}

fn empty_message(choices: &str) -> Rejected {
    Rejected::new(Reason::ProtocolOrder, format!("the message is empty: send one of {choices}"))
}

fn of_field(field: &str, why: Why) -> Rejected {
    InvalidFields::one(Field::named(field), why).into()
}

fn open_from_wire(wire: pb::Open) -> Result<Open, Rejected> {
    let pb::Open {
        stream,
        epoch,
        lead_cycles,
        batch_cycles,
        axis_guard,
        close_at_rest,
        accept_unproved,
        executed_cycle,
        compact,
        source,
    } = wire;
    let or = |given, default| if given == 0 { default } else { given };
    let lead_cycles = or(lead_cycles, DEFAULT_LEAD_CYCLES);
    let batch_cycles = or(batch_cycles, DEFAULT_BATCH_CYCLES);
    let axis_guard = or(axis_guard, DEFAULT_AXIS_GUARD);
    let mut faults = Vec::new();
    if let Some(why) = wrong_name(&stream) {
        faults.extend(of_field("open.stream", why).fields);
    }
    if epoch == 0 {
        let text = "is 0: choose one above 0, and a larger one at every open";
        faults.push(FieldViolation::new("open.epoch", Reason::ValueOutOfRange, text));
    }
    faults.extend(outside("open.lead_cycles", lead_cycles, LEAD_CYCLES));
    faults.extend(outside("open.batch_cycles", batch_cycles, BATCH_CYCLES));
    faults.extend(outside("open.axis_guard", axis_guard, 1..=lead_cycles.saturating_sub(1).max(1)));
    let source = match source {
        Some(pb::open::Source::Plan(plan)) => accepted_in("open.plan", Some(plan)).map(Source::Plan),
        Some(pb::open::Source::Resume(resume)) => resume_from_wire(resume)
            .map(|resume| Source::Resume(Box::new(resume)))
            .map_err(|rejected| rejected.inside("open.resume")),
        None => Err(missing("open.source", "a plan")),
    };
    // What is no opening whatever the motion is comes before what is wrong with the motion.
    if let Err(of_source) = &source
        && !faults.is_empty()
    {
        faults.extend(of_source.fields.iter().cloned());
    }
    if let Some(rejected) = Rejected::for_fields(faults) {
        return Err(rejected);
    }
    let source = source?;
    Ok(Open {
        stream,
        epoch,
        lead_cycles,
        batch_cycles,
        axis_guard,
        close_at_rest,
        accept_unproved,
        executed_cycle,
        compact,
        source,
    })
}

fn resume_from_wire(wire: pb::Resume) -> Result<Resume, Rejected> {
    let pb::Resume { motion, next_cycle, digest, checkpoint_cycle, checkpoint_digest } = wire;
    let motion = motion_in(motion)?;
    let first = motion.under_way.from_cycle();
    let mut faults = Vec::new();
    let mut fault = |field: &str, text: String| {
        faults.push(FieldViolation::new(field, Reason::ValueOutOfRange, text));
    };
    if next_cycle <= first || next_cycle > LAST_CYCLE {
        let least = first + 1;
        fault(
            "next_cycle",
            format!("is {next_cycle}: it follows on a cycle of the motion, {least} to {LAST_CYCLE}"),
        );
    } else {
        let earliest = first.max(next_cycle.saturating_sub(FARTHEST_CHECKPOINT));
        if !(earliest..=next_cycle).contains(&checkpoint_cycle) {
            fault(
                "checkpoint_cycle",
                format!(
                    "is {checkpoint_cycle}: give {earliest} to {next_cycle}, in the motion and at most {FARTHEST_CHECKPOINT} \
                     cycles back"
                ),
            );
        }
    }
    if checkpoint_cycle == 0 && checkpoint_digest != 0 {
        fault("checkpoint_digest", "is not 0, the digest before cycle 0: send 0".into());
    }
    match Rejected::for_fields(faults) {
        Some(rejected) => Err(rejected),
        None => Ok(Resume {
            motion,
            next_cycle,
            digest: Digest::from(digest),
            checkpoint_cycle,
            checkpoint_digest: Digest::from(checkpoint_digest),
        }),
    }
}

fn resume_to_wire(resume: &Resume) -> pb::Resume {
    let Resume { motion, next_cycle, digest, checkpoint_cycle, checkpoint_digest } = resume;
    pb::Resume {
        motion: Some(motion_unexplained(motion)),
        next_cycle: *next_cycle,
        digest: u64::from(*digest),
        checkpoint_cycle: *checkpoint_cycle,
        checkpoint_digest: u64::from(*checkpoint_digest),
    }
}

/// What is wrong with a number of cycles; nothing within `allowed`.
fn outside(field: &str, given: u32, allowed: RangeInclusive<u32>) -> Option<FieldViolation> {
    let (least, most) = (allowed.start(), allowed.end());
    let text = || format!("is {given}: give {least} to {most} cycles, or 0 for the default");
    (!allowed.contains(&given)).then(|| FieldViolation::new(field, Reason::ValueOutOfRange, text()))
}

fn open_to_wire(open: &Open) -> pb::Open {
    let Open {
        stream,
        epoch,
        lead_cycles,
        batch_cycles,
        axis_guard,
        close_at_rest,
        accept_unproved,
        executed_cycle,
        compact,
        source,
    } = open;
    pb::Open {
        stream: stream.clone(),
        epoch: *epoch,
        lead_cycles: *lead_cycles,
        batch_cycles: *batch_cycles,
        axis_guard: *axis_guard,
        close_at_rest: *close_at_rest,
        accept_unproved: *accept_unproved,
        executed_cycle: *executed_cycle,
        compact: *compact,
        source: Some(match source {
            Source::Plan(plan) => pb::open::Source::Plan(plan_to_wire(plan.judged())),
            Source::Resume(resume) => pb::open::Source::Resume(resume_to_wire(resume)),
        }),
    }
}

fn opened_from_wire(wire: pb::Opened) -> Result<Opened, Rejected> {
    let pb::Opened { motion, first_cycle, served_by, current_epoch } = wire;
    let motion = motion.map(motion_from_wire).transpose()?;
    Ok(Opened { motion, first_cycle, served_by, current_epoch })
}

impl From<Columns> for pb::SetpointColumns {
    fn from(columns: Columns) -> Self {
        let cycles = columns.cycles() as u32;
        let [position, velocity, acceleration, jerk] = columns.into_parts();
        Self { cycles, position, velocity, acceleration, jerk }
    }
}

impl TryFrom<pb::SetpointColumns> for Columns {
    type Error = Rejected;

    fn try_from(wire: pb::SetpointColumns) -> Result<Self, Rejected> {
        let pb::SetpointColumns { cycles, position, velocity, acceleration, jerk } = wire;
        let lengths = [position.len(), velocity.len(), acceleration.len(), jerk.len()];
        Columns::from_parts(cycles as usize, [position, velocity, acceleration, jerk]).ok_or_else(|| {
            let text = format!(
                "columns of {lengths:?} numbers for {cycles} cycles: position, velocity, acceleration and jerk \
                 need one number for each axis and cycle"
            );
            Rejected::new(Reason::LengthMismatch, text)
        })
    }
}

fn batch_from_wire(wire: pb::SetpointBatch) -> Result<Batch, Rejected> {
    let pb::SetpointBatch { first_cycle, revision, replaces, last, columns, stop_tails, digest, cycles } =
        wire;
    let columns = match columns {
        Some(columns) if cycles == 0 || cycles == columns.cycles => columns.try_into()?,
        Some(columns) => {
            let text =
                format!("is {cycles}, and there are columns of {} cycles: leave it out", columns.cycles);
            return Err(Rejected::for_field("batch.cycles", Reason::LengthMismatch, text));
        }
        None if u64::from(cycles) <= FARTHEST_AHEAD => Columns::bare(cycles as usize),
        None => {
            let text = format!("is {cycles}: a batch has {FARTHEST_AHEAD} cycles at most");
            return Err(Rejected::for_field("batch.cycles", Reason::ValueOutOfRange, text));
        }
    };
    Ok(Batch {
        first_cycle,
        revision,
        replaces,
        last,
        columns,
        digest: Digest::from(digest),
        tails: tails_from_wire(stop_tails)?,
    })
}

/// Whether a way to rest follows from a setpoint is for whoever plays it to say.
fn tails_from_wire(wire: Vec<pb::StopTail>) -> Result<Tails, Rejected> {
    let mut invalid = InvalidFields::default();
    let mut profiles = Vec::with_capacity(wire.len());
    for (axis, pb::StopTail { segments, rest_position }) in wire.into_iter().enumerate() {
        let field = Field::element("stop_tails", axis);
        let mut pieces = Vec::with_capacity(segments.len());
        for (index, segment) in segments.into_iter().enumerate() {
            let field = Field::element("segments", index).within(&field);
            pieces.extend(invalid.take(&field, segment_from_wire(segment)));
        }
        if !rest_position.is_finite() {
            let field = Field::named("rest_position").within(&field);
            invalid.push(InvalidField::new(field, Why::NotFinite { given: rest_position }));
        }
        profiles.push(Profile::new(pieces, State::at_rest(rest_position)));
    }
    invalid.into_result(()).map_err(|inner| within("batch", inner))?;
    Ok(Tails::new(profiles))
}

fn tails_to_wire(tails: &Tails) -> Vec<pb::StopTail> {
    let tail = |profile: &Profile| pb::StopTail {
        segments: profile.segments().iter().map(|segment| segment_to_wire(&segment)).collect(),
        rest_position: profile.end().position,
    };
    tails.profiles().iter().map(tail).collect()
}

fn batch_to_wire(batch: Batch) -> pb::SetpointBatch {
    let Batch { first_cycle, revision, replaces, last, columns, digest, tails } = batch;
    let is_bare = columns.is_bare();
    pb::SetpointBatch {
        first_cycle,
        revision,
        replaces,
        last,
        cycles: if is_bare { columns.cycles() as u32 } else { 0 },
        columns: (!is_bare).then(|| columns.into()),
        stop_tails: tails_to_wire(&tails),
        digest: u64::from(digest),
    }
}

fn report_from_wire(wire: pb::AxisReport) -> Result<Report, Rejected> {
    let pb::AxisReport {
        executed_cycle,
        accepted_cycle,
        grant_cycle,
        revision,
        digest,
        refused,
        tail_from_cycle,
        tracking,
        counters,
    } = wire;
    Ok(Report {
        executed_cycle,
        accepted_cycle,
        grant_cycle,
        revision,
        digest: Digest::from(digest),
        refused: refused.map(refused_from_wire).transpose()?,
        tail_from_cycle,
        tracking: tracking.map(Into::into),
        counters: counters.unwrap_or_default().into(),
    })
}

fn report_to_wire(report: &Report) -> pb::AxisReport {
    let Report {
        executed_cycle,
        accepted_cycle,
        grant_cycle,
        revision,
        digest,
        refused,
        tail_from_cycle,
        tracking,
        counters,
    } = report;
    pb::AxisReport {
        executed_cycle: *executed_cycle,
        accepted_cycle: *accepted_cycle,
        grant_cycle: *grant_cycle,
        revision: *revision,
        digest: u64::from(*digest),
        refused: refused.as_ref().map(|Refused { revision, first_cycle, reason }| pb::Refused {
            revision: *revision,
            first_cycle: *first_cycle,
            reason: reason.name().into(),
        }),
        tail_from_cycle: *tail_from_cycle,
        tracking: tracking.clone().map(Into::into),
        counters: Some((*counters).into()),
    }
}

fn refused_from_wire(wire: pb::Refused) -> Result<Refused, Rejected> {
    let pb::Refused { revision, first_cycle, reason: given } = wire;
    let reason = RefusalReason::ALL.into_iter().find(|reason| reason.name() == given);
    let choices = "GAP, TOO_LATE, JOIN_MISMATCH, DIGEST_MISMATCH, NOT_FINITE, STALE_EPOCH, REVISION, RESUMING, \
                   BEYOND_GRANT, STOP_TAIL";
    let reason =
        reason.ok_or_else(|| of_field("report.refused.reason", Why::UnknownName { given, choices }))?;
    Ok(Refused { revision, first_cycle, reason })
}

impl TryFrom<pb::StreamEvent> for StreamEvent {
    type Error = Rejected;

    fn try_from(wire: pb::StreamEvent) -> Result<Self, Rejected> {
        let pb::StreamEvent { kind, at_cycle } = wire;
        let kind = event_from_wire(kind).map_err(|why| of_field("event.kind", why))?;
        Ok(Self { kind, at_cycle })
    }
}

impl From<StreamEvent> for pb::StreamEvent {
    fn from(event: StreamEvent) -> Self {
        let StreamEvent { kind, at_cycle } = event;
        Self { kind: event_to_wire(kind), at_cycle }
    }
}

impl From<pb::TrackingColumns> for Tracking {
    fn from(wire: pb::TrackingColumns) -> Self {
        let pb::TrackingColumns { first_cycle, cycles, measured_position, following_error, cycle_jitter_ns } =
            wire;
        Self { first_cycle, cycles, measured_position, following_error, cycle_jitter_ns }
    }
}

impl From<Tracking> for pb::TrackingColumns {
    fn from(tracking: Tracking) -> Self {
        let Tracking { first_cycle, cycles, measured_position, following_error, cycle_jitter_ns } = tracking;
        Self { first_cycle, cycles, measured_position, following_error, cycle_jitter_ns }
    }
}

impl From<pb::StreamCounters> for Counters {
    fn from(wire: pb::StreamCounters) -> Self {
        let pb::StreamCounters {
            underruns,
            duplicate_cycles,
            refused_batches,
            stale_epochs,
            least_lead_cycles,
            late_cycles,
        } = wire;
        Self { underruns, duplicate_cycles, refused_batches, stale_epochs, least_lead_cycles, late_cycles }
    }
}

impl From<Counters> for pb::StreamCounters {
    fn from(counters: Counters) -> Self {
        let Counters {
            underruns,
            duplicate_cycles,
            refused_batches,
            stale_epochs,
            least_lead_cycles,
            late_cycles,
        } = counters;
        Self { underruns, duplicate_cycles, refused_batches, stale_epochs, least_lead_cycles, late_cycles }
    }
}
