//! Reasons are a promise to programs: this table is the one that is documented.

use std::collections::HashSet;

use proto::{Reason, code_name};

const TABLE: &[(&str, &str)] = &[
    (
        "INVALID_ARGUMENT",
        "NOT_FINITE LIMIT_NOT_POSITIVE LENGTH_MISMATCH TIMES_NOT_INCREASING KIND_UNSPECIFIED DUPLICATE_AXIS \
         UNKNOWN_AXIS NO_AXES NO_POINTS ORDER_UNSUPPORTED CYCLE_TIME_INVALID STATE_NOT_AT_REST \
         OVERRIDE_OUT_OF_RANGE FIELD_MISSING VALUE_OUT_OF_RANGE NAME_INVALID ENDPOINT_INVALID REQUEST_ID_REUSED \
         MESSAGE_INVALID SERVO_UNSTABLE PROTOCOL_ORDER",
    ),
    (
        "FAILED_PRECONDITION",
        "START_OUTSIDE_LIMITS GOAL_OUTSIDE_LIMITS POSITION_LIMIT PATH_TOO_SHORT PVT_UNREACHABLE \
         PHASE_SYNCHRONIZATION_IMPOSSIBLE STREAM_FINISHED STOPPED PLAN_REJECTED NOT_PROVED JOIN_MISMATCH \
         NOT_A_PLANNER AXIS_DIVERGED",
    ),
    ("OUT_OF_RANGE", "APPEND_TOO_LATE RESUME_PAST_END"),
    ("ABORTED", "EPOCH_SUPERSEDED NOT_CONFIRMED SUPERSEDED"),
    ("PERMISSION_DENIED", "STREAM_NOT_ALLOWED METHOD_NOT_ALLOWED"),
    ("NOT_FOUND", "STREAM_NOT_HERE"),
    (
        "RESOURCE_EXHAUSTED",
        "TOO_MANY_AXES TOO_MANY_POINTS TOO_MANY_PLANS TOO_MANY_SEGMENTS TOO_MANY_CYCLES TOO_MANY_STREAMS MESSAGE_TOO_LARGE \
         OVERLOADED",
    ),
    ("DEADLINE_EXCEEDED", "FIRST_MESSAGE_LATE STREAM_IDLE"),
    ("UNAVAILABLE", "DRAINING PLANNER_UNREACHABLE STREAM_BROKEN"),
    ("UNIMPLEMENTED", "NOT_IMPLEMENTED"),
    ("DATA_LOSS", "DIGEST_MISMATCH"),
];

#[test]
fn reasons_are_those_of_the_table() {
    let expected: Vec<(&str, &str)> = TABLE
        .iter()
        .flat_map(|(code, names)| names.split_whitespace().map(move |name| (*code, name)))
        .collect();
    let actual: Vec<(&str, &str)> =
        Reason::ALL.iter().map(|reason| (code_name(reason.code()), reason.name())).collect();
    assert_eq!(actual, expected);
}

#[test]
fn names_are_read_back() {
    for reason in Reason::ALL {
        assert_eq!(reason.name().parse(), Ok(*reason));
        assert_eq!(reason.to_string(), reason.name());
    }
    let error = "path_too_short".parse::<Reason>().unwrap_err();
    assert_eq!(
        error.to_string(),
        r#""path_too_short" is not a reason of this version: reasons are written as in PATH_TOO_SHORT"#
    );
}

#[test]
fn every_explanation_is_sentences_of_its_own() {
    let mut seen = HashSet::new();
    for reason in Reason::ALL {
        let text = reason.explanation();
        assert!(seen.insert(text), "{reason} is explained like another");
        assert!(
            text.starts_with(|c: char| c.is_ascii_uppercase()) && text.ends_with('.'),
            "{reason}: {text}"
        );
        assert!(text.matches(['.', ':']).count() >= 2, "{reason} lacks the way out: {text}");
        assert!(text.len() < 300 && !text.contains("  ") && !text.contains('\n'), "{reason}: {text}");
    }
}
