//! JSON as programs see it.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests may panic as tests do")]

use proptest::prelude::*;
use prost::{Message, Name};
use prost_reflect::{DescriptorPool, DynamicMessage, Kind, MessageDescriptor, Value};
use proto::{JsonError, JsonStyle, from_json, pb, to_json, to_json_pretty, to_json_value, to_json_with};

#[test]
fn request_is_read_as_people_write_it() {
    let request: pb::PlanRequest = from_json(
        r#"{
            "axes": [{
                "axis": "x",
                "kind": "AXIS_KIND_PRISMATIC",
                "goal": {"position": 0.5},
                "limits": {"maxVelocity": 1, "max_acceleration": 2e0, "maxJerk": "10", "feedRate": null}
            }],
            "cycleTime": "0.001s",
            "order": 3,
            "endOnCycle": true
        }"#,
    )
    .unwrap();
    let expected = pb::PlanRequest {
        axes: vec![pb::AxisMove {
            axis: "x".into(),
            kind: pb::AxisKind::Prismatic.into(),
            start: None,
            goal: Some(pb::AxisState { position: 0.5, ..Default::default() }),
            limits: Some(pb::AxisLimits {
                max_velocity: 1.0,
                max_acceleration: 2.0,
                max_jerk: 10.0,
                ..Default::default()
            }),
        }],
        cycle_time: Some(prost_types::Duration { seconds: 0, nanos: 1_000_000 }),
        order: Some(3),
        end_on_cycle: true,
        ..Default::default()
    };
    assert_eq!(request, expected);
}

#[test]
fn defaults_are_written_where_the_absence_would_mean_the_same() {
    // `passed` is there although false; unset messages, options and choices are not.
    let certificate = pb::PlanCertificate::default();
    assert_eq!(
        to_json(&certificate).unwrap(),
        r#"{"limitChecks":[],"continuityChecks":[],"endChecks":[],"passed":false,"reversals":[]}"#
    );
    assert_eq!(to_json(&pb::AxisSegment::default()).unwrap(), r#"{"duration":0.0}"#);
    assert_eq!(
        to_json(&pb::Classification::default()).unwrap(),
        r#"{"pvtRegions":[],"feedRate":0.0}"#,
        "optional fields stay out"
    );
    let standard = JsonStyle { emit_defaults: false, ..JsonStyle::COMPACT };
    assert_eq!(to_json_with(&certificate, standard).unwrap(), "{}");
    // What has presence is written when set, even at its default.
    let segment =
        pb::AxisSegment { law: Some(pb::axis_segment::Law::Jerk(0.0)), ..pb::AxisSegment::default() };
    assert_eq!(to_json_with(&segment, standard).unwrap(), r#"{"jerk":0.0}"#);
}

#[test]
fn every_kind_of_value_has_its_form() {
    let report = pb::AxisReport { executed_cycle: u64::MAX, digest: 1 << 63, ..Default::default() };
    let value = to_json_value(&report).unwrap();
    assert_eq!(value["executedCycle"], "18446744073709551615");
    assert_eq!(value["digest"], "9223372036854775808");

    let plan = pb::Plan {
        fingerprint: vec![0xfb, 0xff],
        guaranteed: vec![pb::Quantity::Jerk.into(), 99],
        cycle_time: Some(prost_types::Duration { seconds: 0, nanos: 250_000 }),
        ..Default::default()
    };
    let value = to_json_value(&plan).unwrap();
    assert_eq!(value["fingerprint"], "+/8=");
    assert_eq!(value["guaranteed"], serde_json::json!(["QUANTITY_JERK", 99]));
    assert_eq!(value["cycleTime"], "0.000250s");

    let columns = pb::SetpointColumns {
        position: vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0, 5e-324, 0.1, 1e300],
        ..Default::default()
    };
    assert_eq!(
        to_json_with(&columns, JsonStyle { emit_defaults: false, ..JsonStyle::COMPACT }).unwrap(),
        r#"{"position":["NaN","Infinity","-Infinity",-0.0,5e-324,0.1,1e+300]}"#
    );
    let back: pb::SetpointColumns = from_json(&to_json(&columns).unwrap()).unwrap();
    assert!(back.position[0].is_nan());
    assert_eq!(back.position[1..], columns.position[1..]);

    assert_eq!(
        to_json_pretty(&pb::StopTail::default()).unwrap(),
        "{\n  \"segments\": [],\n  \"restPosition\": 0.0\n}",
        "indented by two"
    );
}

#[test]
fn errors_name_place_and_cause() {
    fn check(text: &str, expected: &str) {
        let error = from_json::<pb::PlanRequest>(text).unwrap_err();
        assert_eq!(error.to_string(), expected, "{text}");
    }
    check("", "line 1, column 0: EOF while parsing a value");
    check("{\n  \"axes\": [}", "line 2, column 12: expected value");
    check("{\n  \"axis\": []\n}", "line 2, column 8: unrecognized field name 'axis'");
    check(
        r#"{"axes": [{"limits": {"maxJrek": 1}}]}"#,
        "line 1, column 31: unrecognized field name 'maxJrek'",
    );
    check(r#"{"family": "S_CURVE"}"#, "line 1, column 20: unrecognized enum value 'S_CURVE'");
    check(r#"{"order": -1}"#, "line 1, column 12: out of range integral type conversion attempted");
    check(r#"{"axes": 3}"#, "line 1, column 10: invalid type: integer `3`, expected a list");
    check("{} {}", "line 1, column 4: trailing characters");
    check(r#"{"axes": [{"goal": {"position": 1e400}}]}"#, "line 1, column 37: number out of range");
}

#[test]
fn deep_nesting_is_an_error_and_no_overflow() {
    let error = from_json::<pb::PlanRequest>(&"[".repeat(1_000_000)).unwrap_err();
    assert!(matches!(error, JsonError::Read { .. }));
    let nested = format!(r#"{{"unknown": {}}}"#, "[".repeat(1_000_000));
    assert!(from_json::<pb::PlanRequest>(&nested).is_err());
}

#[test]
fn durations_come_back_or_are_an_error() {
    fn written(seconds: i64, nanos: i32) -> Result<String, JsonError> {
        let plan =
            pb::Plan { cycle_time: Some(prost_types::Duration { seconds, nanos }), ..Default::default() };
        // Inside of other messages, and in a choice.
        let source = Some(pb::open::Source::Plan(plan));
        let open = pb::Open { source, ..Default::default() };
        let text = to_json(&open)?;
        assert_eq!(from_json::<pb::Open>(&text).unwrap(), open, "{seconds} {nanos}");
        Ok(text)
    }
    for (seconds, nanos) in
        [(0, 1), (0, -1), (-1, -500_000_000), (3, 0), (0, 0), (-7, 0), (315_576_000_000, 0)]
    {
        assert!(written(seconds, nanos).is_ok(), "{seconds} {nanos}");
    }
    assert!(written(0, -1).unwrap().contains(r#""cycleTime":"-0.000000001s""#));

    for (seconds, nanos) in [(1, -1), (-1, 1), (0, i32::MAX), (i64::MAX, 0), (i64::MIN, i32::MIN)] {
        let error = written(seconds, nanos).unwrap_err();
        assert!(matches!(error, JsonError::Write { .. }), "{seconds} {nanos}: {error}");
    }
    assert_eq!(
        written(1, -1).unwrap_err().to_string(),
        "the message cannot be written as JSON: a duration of 1 s and -1 ns has parts of different signs"
    );
}

#[test]
fn every_message_has_a_form() {
    fn check<T: Message + Name + Default + PartialEq + std::fmt::Debug>() {
        let text = to_json(&T::default()).unwrap();
        assert_eq!(from_json::<T>(&text).unwrap(), T::default(), "{}", T::full_name());
    }
    check::<pb::PlanResponse>();
    check::<pb::PlanPvtRequest>();
    check::<pb::PlanPvtResponse>();
    check::<pb::VerifyPlanRequest>();
    check::<pb::VerifyPlanResponse>();
    check::<pb::SamplePlanRequest>();
    check::<pb::SamplePlanResponse>();
    check::<pb::StreamSetpointsRequest>();
    check::<pb::StreamSetpointsResponse>();
    check::<pb::ControlStreamRequest>();
    check::<pb::ControlStreamResponse>();
    check::<pb::WatchStreamRequest>();
    check::<pb::WatchStreamResponse>();
    check::<pb::RunTrackingRequest>();
    check::<pb::RunTrackingResponse>();
    check::<pb::CommandRequest>();
    check::<pb::CommandResponse>();
    check::<pb::GetAxisModelResponse>();
    check::<pb::InjectFaultRequest>();
    check::<pb::plan_certificate::LimitCheck>();
    check::<pb::mechanics::TwoMassLoad>();
}

/// What is written on one line, by tables, is what reflection writes over several, byte for byte.
#[track_caller]
fn agrees<T: Message + Name>(message: &T) {
    for emit_defaults in [true, false] {
        let [line, lines] =
            [false, true].map(|indent| to_json_with(message, JsonStyle { emit_defaults, indent }).unwrap());
        let tree: serde_json::Value = serde_json::from_str(&lines).unwrap();
        assert_eq!(line, tree.to_string(), "{}", T::full_name());
    }
}

/// Numbers that are always the same: the multiplier and increment of Knuth's MMIX.
struct Draw(u64);

impl Draw {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }

    fn of<T: Clone>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())].clone()
    }

    /// Every field set, unset or at its default, every list empty, of one or of several.
    fn message(&mut self, of: MessageDescriptor, depth: u32) -> DynamicMessage {
        let mut message = DynamicMessage::new(of.clone());
        if of.full_name() == "google.protobuf.Duration" {
            message.set_field_by_name("seconds", Value::I64(self.of(&[0, 1, -1, 315_576_000_000])));
            message.set_field_by_name("nanos", Value::I32(self.of(&[0, 1, -1, 999_999_999, -250_000])));
            return message;
        }
        for field in of.fields() {
            let inner = depth > 0 || field.kind().as_message().is_none();
            if self.below(4) > 0 && inner {
                let value = if field.is_list() {
                    let count = self.below(4);
                    Value::List((0..count).map(|_| self.value(&field.kind(), depth)).collect())
                } else {
                    self.value(&field.kind(), depth)
                };
                message.set_field(&field, value);
            }
        }
        message
    }

    fn value(&mut self, kind: &Kind, depth: u32) -> Value {
        match kind {
            Kind::Double => Value::F64(self.of(&[
                0.0,
                -0.0,
                0.1,
                1e300,
                5e-324,
                3.0,
                1e16,
                f64::NAN,
                f64::INFINITY,
                f64::NEG_INFINITY,
            ])),
            Kind::Bool => Value::Bool(self.of(&[false, true])),
            Kind::Int32 | Kind::Sint32 => Value::I32(self.of(&[0, 1, -1, i32::MIN])),
            Kind::Uint32 => Value::U32(self.of(&[0, 7, u32::MAX])),
            Kind::Int64 => Value::I64(self.of(&[0, -1, i64::MIN])),
            Kind::Uint64 | Kind::Fixed64 => Value::U64(self.of(&[0, 300, u64::MAX])),
            Kind::String => Value::String(self.of(&["", "x", "\"\\\n\u{1}\u{7f}é😀"]).to_owned()),
            Kind::Bytes => Value::Bytes(self.of(&[&b""[..], b"a", b"\xfb\xff\x00z"]).to_vec().into()),
            Kind::Enum(_) => Value::EnumNumber(self.of(&[0, 1, 2, 3, 99, -1])),
            Kind::Message(message) => Value::Message(self.message(message.clone(), depth - 1)),
            other => panic!("a field of {other:?}: teach it to src/transcript.rs, and to this test"),
        }
    }
}

#[test]
fn every_message_is_written_as_reflection_writes_it() {
    fn check<T: Message + Name + Default>(draw: &mut Draw, pool: &DescriptorPool) {
        agrees(&T::default());
        let descriptor = pool.get_message_by_name(&T::full_name()).unwrap();
        let mut written = 0;
        for _ in 0..200 {
            let message = draw.message(descriptor.clone(), 5).transcode_to::<T>().unwrap();
            // Durations of two signs have no form, in either way of writing.
            match to_json_pretty(&message) {
                Ok(_) => agrees(&message),
                Err(error) => assert_eq!(to_json(&message).unwrap_err(), error),
            }
            written += usize::from(to_json(&message).is_ok());
        }
        assert!(written > 50, "{}: {written}", T::full_name());
    }
    let pool = DescriptorPool::decode(proto::FILE_DESCRIPTOR_SET).unwrap();
    let draw = &mut Draw(2026);
    check::<pb::PlanRequest>(draw, &pool);
    check::<pb::PlanResponse>(draw, &pool);
    check::<pb::VerifyPlanResponse>(draw, &pool);
    check::<pb::SamplePlanResponse>(draw, &pool);
    check::<pb::PlanPvtRequest>(draw, &pool);
    check::<pb::PlanPvtResponse>(draw, &pool);
    check::<pb::StreamSetpointsRequest>(draw, &pool);
    check::<pb::StreamSetpointsResponse>(draw, &pool);
    check::<pb::ControlStreamRequest>(draw, &pool);
    check::<pb::ControlStreamResponse>(draw, &pool);
    check::<pb::WatchStreamResponse>(draw, &pool);
    check::<pb::RunTrackingRequest>(draw, &pool);
    check::<pb::RunTrackingResponse>(draw, &pool);
    check::<pb::CommandRequest>(draw, &pool);
    check::<pb::GetAxisModelResponse>(draw, &pool);
    check::<pb::InjectFaultRequest>(draw, &pool);
}

/// Doubles drawn to hurt: any bits, few digits, many digits, the edges.
fn any_double() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => any::<u64>().prop_map(f64::from_bits),
        2 => (0..1_u64 << 52, any::<bool>()).prop_map(|(bits, negative)| f64::from_bits(bits | u64::from(negative) << 63)),
        2 => (-1_000_000..1_000_000_i32, -30..30_i32).prop_map(|(n, e)| f64::from(n) * 10_f64.powi(e)),
        2 => (10_000_000_000_000_000_u64..100_000_000_000_000_000, -40..10_i32)
            .prop_map(|(digits, exponent)| format!("{digits}e{exponent}").parse().unwrap()),
        1 => prop::sample::select(vec![
            0.0, -0.0, 1e-308, -1e-308, 5e-324, f64::MIN_POSITIVE, f64::MAX, f64::MIN, f64::EPSILON,
            9_007_199_254_740_993.0, 1e15, 1e16, 1e17, 1e21, 1e22, 1e23, 0.1, 1.0 / 3.0,
        ]),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn doubles_come_back_to_the_same_bits(position in prop::collection::vec(any_double(), 1..20), jerk in any_double()) {
        let columns = pb::SetpointColumns { position, ..Default::default() };
        agrees(&columns);
        let back: pb::SetpointColumns = from_json(&to_json_pretty(&columns).unwrap()).unwrap();
        for (before, after) in columns.position.iter().zip(&back.position) {
            prop_assert!(before.to_bits() == after.to_bits() || before.is_nan() && after.is_nan(), "{before:e} {after:e}");
        }
        // With presence, a negative zero is kept too.
        let segment = pb::AxisSegment { law: Some(pb::axis_segment::Law::Jerk(jerk)), ..Default::default() };
        let back: pb::AxisSegment = from_json(&to_json(&segment).unwrap()).unwrap();
        let Some(pb::axis_segment::Law::Jerk(after)) = back.law else { panic!("{back:?}") };
        prop_assert!(jerk.to_bits() == after.to_bits() || jerk.is_nan() && after.is_nan());
        // Without, it comes back as zero.
        let state = pb::AxisState { velocity: jerk, ..Default::default() };
        let after = from_json::<pb::AxisState>(&to_json(&state).unwrap()).unwrap().velocity;
        prop_assert!((jerk + 0.0).to_bits() == after.to_bits() || jerk.is_nan() && after.is_nan());
    }

    #[test]
    fn any_text_is_read_or_refused(text in "\\PC{0,60}", json in r#"[\[\]{}":,a-z0-9.e\-]{0,40}"#) {
        let _ = from_json::<pb::StreamSetpointsRequest>(&text);
        let _ = from_json::<pb::StreamSetpointsRequest>(&json);
    }
}
