//! What watchers ask for and see.

use std::time::Duration;

use planner::{CycleTime, Field, InvalidFields, Why};

use super::choice::{kind_from_wire, kind_to_wire, phase_from_wire, phase_to_wire};
use super::duration::{cycle_time_to_wire, duration_to_ns, malformed_duration, ns_to_duration};
use crate::stream::{Columns, Watch, Watched};
use crate::{Reason, Rejected, pb};

impl TryFrom<pb::WatchStreamRequest> for Watch {
    type Error = Rejected;

    fn try_from(wire: pb::WatchStreamRequest) -> Result<Self, Rejected> {
        let pb::WatchStreamRequest { stream, period, max_points } = wire;
        let period = match period {
            None => Self::DEFAULT_PERIOD,
            Some(period) => {
                if let Some(why) = malformed_duration(&period) {
                    return Err(InvalidFields::one(Field::named("period"), why).into());
                }
                let ns = u64::try_from(duration_to_ns(&period)).unwrap_or_default();
                let given = Duration::from_nanos(ns);
                if given.is_zero() || given > Self::LONGEST_PERIOD {
                    let most = Self::LONGEST_PERIOD.as_secs();
                    let text = format!(
                        "is {} s: give a time above 0 and up to {most} s, or leave it out for 0.05 s",
                        duration_to_ns(&period) as f64 / 1e9
                    );
                    return Err(Rejected::for_field("period", Reason::ValueOutOfRange, text));
                }
                given
            }
        };
        let max_points = match max_points as usize {
            0 => Self::DEFAULT_POINTS,
            most if most <= Self::MOST_POINTS => most,
            given => {
                let text = format!("is {given}: give up to {}, or 0 for the default", Self::MOST_POINTS);
                return Err(Rejected::for_field("max_points", Reason::ValueOutOfRange, text));
            }
        };
        Ok(Self { stream: (!stream.is_empty()).then_some(stream), period, max_points })
    }
}

impl From<Watch> for pb::WatchStreamRequest {
    fn from(watch: Watch) -> Self {
        let Watch { stream, period, max_points } = watch;
        Self {
            stream: stream.unwrap_or_default(),
            period: Some(ns_to_duration(period.as_nanos() as i128)),
            max_points: u32::try_from(max_points).unwrap_or(u32::MAX),
        }
    }
}

impl From<Watched> for pb::WatchStreamResponse {
    fn from(watched: Watched) -> Self {
        let Watched {
            stream,
            axes,
            executed_cycle,
            lead_cycles,
            phase,
            override_factor,
            cycles,
            commanded,
            tracking,
            counters,
            messages_dropped,
            events,
            cycle_time,
            kinds,
        } = watched;
        let has_columns = !cycles.is_empty();
        Self {
            stream,
            executed_cycle,
            lead_cycles,
            phase: phase_to_wire(phase),
            override_factor,
            cycles,
            commanded: has_columns.then(|| commanded.into()),
            tracking: tracking.map(Into::into),
            counters: Some(counters.into()),
            messages_dropped,
            axes,
            events: events.into_iter().map(Into::into).collect(),
            cycle_time: cycle_time.map(cycle_time_to_wire),
            kinds: kinds.into_iter().map(kind_to_wire).collect(),
        }
    }
}

impl TryFrom<pb::WatchStreamResponse> for Watched {
    type Error = Rejected;

    fn try_from(wire: pb::WatchStreamResponse) -> Result<Self, Rejected> {
        let pb::WatchStreamResponse {
            stream,
            executed_cycle,
            lead_cycles,
            phase,
            override_factor,
            cycles,
            commanded,
            tracking,
            counters,
            messages_dropped,
            axes,
            events,
            cycle_time,
            kinds,
        } = wire;
        let of_field =
            |field: &str, why: Why| -> Rejected { InvalidFields::one(Field::named(field), why).into() };
        let commanded = commanded.map(Columns::try_from).transpose()?.unwrap_or_default();
        if commanded.cycles() != cycles.len() {
            let text = format!("columns of {} cycles for {} cycles", commanded.cycles(), cycles.len());
            return Err(Rejected::for_field("commanded", Reason::LengthMismatch, text));
        }
        Ok(Self {
            stream,
            axes,
            executed_cycle,
            lead_cycles,
            phase: phase_from_wire(phase).map_err(|why| of_field("phase", why))?,
            override_factor,
            cycles,
            commanded,
            tracking: tracking.map(Into::into),
            counters: counters.unwrap_or_default().into(),
            messages_dropped,
            events: events.into_iter().map(TryInto::try_into).collect::<Result<_, _>>()?,
            cycle_time: cycle_time
                .map(|cycle| CycleTime::from_ns(Some(duration_to_ns(&cycle))))
                .transpose()?,
            kinds: kinds
                .into_iter()
                .map(|kind| kind_from_wire(kind).map_err(|why| of_field("kinds", why)))
                .collect::<Result<_, _>>()?,
        })
    }
}
