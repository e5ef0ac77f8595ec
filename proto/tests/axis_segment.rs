//! The piece of a motion that is written by hand has the bytes of generated code.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use prost::Message as _;
use proto::pb::axis_segment::{CosineJerk, Law, Polynomial};
use proto::pb::{AxisSegment, AxisState};

/// The same message as the generator would write it.
#[derive(Clone, PartialEq, prost::Message)]
struct Generated {
    #[prost(double, tag = "1")]
    duration: f64,
    #[prost(message, optional, tag = "2")]
    start: Option<AxisState>,
    #[prost(oneof = "Law", tags = "3, 4, 5")]
    law: Option<Law>,
}

fn check(piece: &AxisSegment) {
    let AxisSegment { duration, start, law } = piece.clone();
    let generated = Generated { duration, start, law };
    let bytes = piece.encode_to_vec();
    assert_eq!(bytes, generated.encode_to_vec(), "{piece:?}");
    assert_eq!(piece.encoded_len(), bytes.len(), "{piece:?}");
    // Compared as bytes, as NaN is not equal to itself and the sign of a zero is not carried.
    let back = AxisSegment::decode(bytes.as_slice()).unwrap();
    assert_eq!(back.encode_to_vec(), bytes, "{piece:?}");
    assert_eq!(format!("{back:?}"), format!("{:?}", AxisSegment::decode(bytes.as_slice()).unwrap()));
    // A field that a later version adds is passed over.
    let longer = [&bytes[..], &[0x78, 0x01]].concat();
    assert_eq!(AxisSegment::decode(longer.as_slice()).unwrap().encode_to_vec(), bytes, "{piece:?}");
}

#[test]
fn bytes_are_those_of_generated_code() {
    let numbers = [0.0, -0.0, 0.25, -1e-300, f64::MAX, f64::NAN, f64::NEG_INFINITY];
    let laws = numbers.iter().flat_map(|&number| {
        [
            Law::Jerk(number),
            Law::CosineJerk(CosineJerk { peak_jerk: number }),
            Law::Polynomial(Polynomial { derivatives: vec![number; 13] }),
        ]
    });
    let laws: Vec<_> = laws.map(Some).chain([None, Some(Law::Polynomial(Polynomial::default()))]).collect();
    for law in &laws {
        for &duration in &numbers {
            check(&AxisSegment { duration, start: None, law: law.clone() });
            for &position in &numbers {
                for (velocity, acceleration) in [(0.0, 0.0), (1.0, 0.0), (0.0, -2.0), (position, 3.0)] {
                    let start = Some(AxisState { position, velocity, acceleration });
                    check(&AxisSegment { duration, start, law: law.clone() });
                }
            }
        }
    }
}

#[test]
fn what_is_no_piece_is_an_error_that_names_the_field() {
    // A duration of one varint, a start that is cut short, a jerk of two bytes.
    for (bytes, field) in [(&[0x08, 1][..], "duration"), (&[0x12, 9, 1], "start"), (&[0x19, 1], "law")] {
        let error = AxisSegment::decode(bytes).unwrap_err().to_string();
        assert!(error.contains(&format!("AxisSegment.{field}")), "{error}");
    }
}

#[test]
fn fields_given_twice_are_merged_as_the_format_says() {
    let first = AxisSegment {
        duration: 1.0,
        start: Some(AxisState { position: 1.0, velocity: 2.0, acceleration: 0.0 }),
        law: Some(Law::Jerk(3.0)),
    };
    let second = AxisSegment {
        duration: 0.0,
        start: Some(AxisState { position: 5.0, ..Default::default() }),
        law: Some(Law::CosineJerk(CosineJerk { peak_jerk: 4.0 })),
    };
    let both = [first.encode_to_vec(), second.encode_to_vec()].concat();
    let merged = AxisSegment::decode(both.as_slice()).unwrap();
    let start = Some(AxisState { position: 5.0, velocity: 2.0, acceleration: 0.0 });
    assert_eq!(merged, AxisSegment { duration: 1.0, start, law: second.law });
}
