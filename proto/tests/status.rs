//! Refusals over the wire and back, and as JSON.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may panic as tests do")]

use std::collections::BTreeMap;

use proptest::prelude::*;
use proto::{FieldViolation, Reason, Rejected, code_name, status_json, unreachable};
use serde_json::json;
use tonic::{Code, Status};
use tonic_types::StatusExt as _;

fn example() -> Rejected {
    Rejected::for_fields(vec![
        FieldViolation::new(
            "axes[2].limits.max_jerk",
            Reason::LimitNotPositive,
            "is -1, and must be above 0",
        ),
        FieldViolation::new("axes[0].goal.position", Reason::NotFinite, "is NaN, and must be finite"),
    ])
    .unwrap()
    .with("given", -1.0)
    .with("needed", 1e-300)
}

#[test]
fn details_are_what_other_clients_read() {
    let status = Status::from(example());
    assert_eq!(status.code(), Code::InvalidArgument);
    assert_eq!(
        status.message(),
        "axes[2].limits.max_jerk: is -1, and must be above 0 (and 1 more invalid field)"
    );
    let info = status.get_details_error_info().unwrap();
    assert_eq!((info.reason.as_str(), info.domain.as_str()), ("LIMIT_NOT_POSITIVE", "portamento.motion"));
    assert_eq!(info.metadata["given"], "-1");
    let fields = status.get_details_bad_request().unwrap().field_violations;
    assert_eq!(fields[1].field, "axes[0].goal.position");
    assert_eq!(fields[1].description, "is NaN, and must be finite");
    assert_eq!(fields[1].reason, "NOT_FINITE");
    assert_eq!(Rejected::from_status(&status), Some(example()));
}

#[test]
fn json_of_a_refusal() {
    let expected = json!({"error": {
        "code": "INVALID_ARGUMENT",
        "reason": "LIMIT_NOT_POSITIVE",
        "message": "axes[2].limits.max_jerk: is -1, and must be above 0 (and 1 more invalid field)",
        "fields": [
            {"field": "axes[2].limits.max_jerk", "reason": "LIMIT_NOT_POSITIVE",
             "description": "is -1, and must be above 0"},
            {"field": "axes[0].goal.position", "reason": "NOT_FINITE", "description": "is NaN, and must be finite"},
        ],
        "metadata": {"given": "-1", "needed": "0.000…"},
    }});
    let actual = example().to_json();
    // Written out it has 300 zeros; what matters is that it reads back.
    let needed = actual["error"]["metadata"]["needed"].as_str().unwrap();
    assert_eq!(needed.parse::<f64>().unwrap().to_bits(), 1e-300_f64.to_bits());
    let mut shown = actual.clone();
    shown["error"]["metadata"]["needed"] = "0.000…".into();
    assert_eq!(shown.to_string(), expected.to_string(), "keys in this order");
    assert_eq!(status_json(&example().into()), actual);
}

#[test]
fn json_of_any_other_status() {
    let none = json!({"error": {
        "code": "UNIMPLEMENTED", "reason": "", "message": "no such method", "fields": [], "metadata": {},
    }});
    assert_eq!(status_json(&Status::unimplemented("no such method")), none);

    // A newer version's reason, or another program's, is told as it is.
    let details =
        tonic_types::ErrorDetails::with_error_info("QUOTA", "example.com", [("k".into(), "v".into())]);
    let status = Status::with_error_details(Code::ResourceExhausted, "enough", details);
    assert_eq!(Rejected::from_status(&status), None);
    assert_eq!(
        status_json(&status),
        json!({"error": {
            "code": "RESOURCE_EXHAUSTED", "reason": "QUOTA", "message": "enough", "fields": [], "metadata": {"k": "v"},
        }})
    );
}

#[test]
fn an_unreachable_server_is_unavailable() {
    let cause = std::io::Error::new(std::io::ErrorKind::ConnectionRefused, "connection refused");
    let status = unreachable(&Outer(cause));
    assert_eq!(status.code(), Code::Unavailable);
    assert_eq!(status.message(), "tcp connect error: connection refused");
}

#[derive(Debug, thiserror::Error)]
#[error("tcp connect error")]
struct Outer(#[source] std::io::Error);

#[test]
fn display_names_the_reason() {
    assert_eq!(Rejected::new(Reason::NoAxes, "name an axis").to_string(), "NO_AXES: name an axis");
    assert_eq!(Rejected::for_fields(Vec::new()), None);
}

#[test]
fn code_names_are_those_of_the_specification() {
    let names: Vec<&str> = (0..17).map(|code| code_name(Code::from(code))).collect();
    assert_eq!(
        names.join(" "),
        "OK CANCELLED UNKNOWN INVALID_ARGUMENT DEADLINE_EXCEEDED NOT_FOUND ALREADY_EXISTS PERMISSION_DENIED \
         RESOURCE_EXHAUSTED FAILED_PRECONDITION ABORTED OUT_OF_RANGE UNIMPLEMENTED INTERNAL UNAVAILABLE DATA_LOSS \
         UNAUTHENTICATED"
    );
}

#[test]
fn a_status_fits_the_trailers_whatever_was_wrong() {
    let fields: Vec<FieldViolation> = (0..60_000)
        .map(|n| FieldViolation::new(format!("axes[0].times[{n}]"), Reason::NotFinite, "is NaN"))
        .collect();
    let refusal = Rejected::for_fields(fields).unwrap();
    assert_eq!(Rejected::from_bytes(&refusal.to_bytes()), Some(refusal.clone()), "bytes keep everything");

    let back = Rejected::from_status(&Status::from(refusal.clone())).unwrap();
    assert!(back.fields.len() > 50, "{}", back.fields.len());
    assert_eq!(back.fields, refusal.fields[..back.fields.len()]);
    assert_eq!(back.metadata["fields_omitted"], (60_000 - back.fields.len()).to_string());

    // A name that the peer chose, in a script of three bytes a letter.
    let name = "轴".repeat(100_000);
    let huge = Rejected::for_fields(vec![FieldViolation::new(&name, Reason::UnknownAxis, &name)])
        .unwrap()
        .with(&name, &name);
    for refusal in [refusal, huge] {
        let status = Status::from(refusal);
        assert!(trailer_bytes(&status) < 8 * 1024, "{}", trailer_bytes(&status));
        assert!(Rejected::from_status(&status).is_some());
    }
}

fn trailer_bytes(status: &Status) -> usize {
    let mut headers = tonic::codegen::http::HeaderMap::new();
    status.add_header(&mut headers).unwrap();
    // As HTTP/2 counts a header list.
    headers.iter().map(|(name, value)| name.as_str().len() + value.len() + 32).sum()
}

#[test]
fn what_a_peer_sends_is_read_or_not() {
    let mut bytes = example().to_bytes();
    assert!(Rejected::from_bytes(&bytes).is_some());
    bytes.truncate(bytes.len() - 1);
    assert_eq!(Rejected::from_bytes(&bytes), None);
    assert_eq!(Rejected::from_bytes(&[]), None);
    assert_eq!(Rejected::from_bytes(b"\xff\xff\xff"), None);
}

fn any_reason() -> impl Strategy<Value = Reason> {
    prop::sample::select(Reason::ALL)
}

prop_compose! {
    fn any_refusal()(
        reason in any_reason(),
        message in "\\PC{0,100}",
        fields in prop::collection::vec(("\\PC{0,20}", any_reason(), "\\PC{0,30}"), 0..8),
        metadata in prop::collection::btree_map("[a-z_]{1,12}", "\\PC{0,20}", 0..6),
    ) -> Rejected {
        let fields = fields.into_iter().map(|(field, reason, text)| FieldViolation::new(field, reason, text));
        Rejected { reason, message, fields: fields.collect(), metadata }
    }
}

proptest! {
    #[test]
    fn refusals_come_back_exactly(refusal in any_refusal()) {
        let status = Status::from(refusal.clone());
        prop_assert_eq!(status.code(), refusal.reason.code());
        prop_assert_eq!(status.message(), &refusal.message);
        prop_assert_eq!(Rejected::from_status(&status), Some(refusal.clone()));
        prop_assert_eq!(Rejected::from_bytes(&refusal.to_bytes()), Some(refusal.clone()));
        prop_assert_eq!(status_json(&status), refusal.to_json());

        // Through the headers, as a client gets it.
        let mut headers = tonic::codegen::http::HeaderMap::new();
        status.add_header(&mut headers).unwrap();
        let received = Status::from_header_map(&headers).unwrap();
        prop_assert_eq!(Rejected::from_status(&received), Some(refusal));
    }

    #[test]
    fn the_same_refusal_has_the_same_bytes(metadata in prop::collection::btree_map("[a-z]{1,6}", "[a-z]{0,6}", 0..20)) {
        let refusal = |pairs: Vec<(String, String)>| Rejected {
            metadata: BTreeMap::from_iter(pairs),
            ..Rejected::new(Reason::Overloaded, "later")
        };
        let forward = refusal(metadata.clone().into_iter().collect());
        let backward = refusal(metadata.into_iter().rev().collect());
        prop_assert_eq!(forward.to_bytes(), backward.to_bytes());
    }

    #[test]
    fn any_bytes_are_read_or_not(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = Rejected::from_bytes(&bytes);
        let _ = status_json(&Status::with_details(Code::Unknown, "", bytes.into()));
    }
}
