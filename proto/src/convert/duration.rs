//! Durations: a wire one has two parts, which must not contradict each other.

use planner::{CycleTime, Field, InvalidFields, Why};
use prost_types::Duration;

const NS_PER_SECOND: i32 = 1_000_000_000;

/// Nanoseconds of a wire duration, whatever its parts are: [`note_malformed`] says what is wrong with them.
pub(super) fn duration_to_ns(wire: &Duration) -> i128 {
    let Duration { seconds, nanos } = *wire;
    i128::from(seconds) * i128::from(NS_PER_SECOND) + i128::from(nanos)
}

/// A wire duration of so many nanoseconds; at the end of its range where they do not fit.
pub(super) fn ns_to_duration(ns: i128) -> Duration {
    let per_second = i128::from(NS_PER_SECOND);
    let seconds = i64::try_from(ns / per_second).unwrap_or(if ns < 0 { i64::MIN } else { i64::MAX });
    Duration { seconds, nanos: (ns % per_second) as i32 }
}

/// A wire duration of a cycle.
pub(super) fn cycle_time_to_wire(cycle: CycleTime) -> Duration {
    ns_to_duration(i128::from(cycle.as_ns()))
}

/// What is wrong with the parts of a wire duration; nothing if they go together: the same sign, and less than a second of
/// nanoseconds. The sum of others has a meaning in some languages and none in others.
#[must_use]
pub fn malformed_duration(wire: &Duration) -> Option<Why> {
    let Duration { seconds, nanos } = *wire;
    let whole = nanos > -NS_PER_SECOND && nanos < NS_PER_SECOND;
    let agree = nanos == 0 || seconds == 0 || (nanos > 0) == (seconds > 0);
    (!(whole && agree)).then_some(Why::DurationParts { seconds, nanos })
}

/// Adds what is wrong with the duration in the field `name`.
pub(super) fn note_malformed(invalid: &mut InvalidFields, name: &str, wire: Option<&Duration>) {
    invalid.note(name, wire.and_then(malformed_duration));
}

/// `checked`, with what was wrong with durations first.
pub(super) fn after<T>(
    mut malformed: InvalidFields,
    checked: Result<T, InvalidFields>,
) -> Result<T, InvalidFields> {
    if malformed.is_empty() {
        return checked;
    }
    malformed.take(&Field::default(), checked);
    Err(malformed)
}
