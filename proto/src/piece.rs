//! A piece of a motion on the wire, written by hand: the one message of which there are hundreds of thousands.
//!
//! Generated code asks each field of each piece for its length once for every message that the piece stands in, and hands it on byte
//! by byte. Nearly all pieces are a duration, a state and a jerk: their length is a count of what is not zero, and their bytes are
//! put together in one place. The bytes are those of generated code (`tests/axis_segment.rs`); the rest is left to it.

use prost::DecodeError;
use prost::bytes::{Buf, BufMut};
use prost::encoding::{DecodeContext, WireType, double, message, skip_field};

use crate::pb::AxisState;
use axis_segment::Law;

/// One piece of an axis's motion, with its own clock that starts at zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisSegment {
    /// Length in time \[s\], > 0.
    pub duration: f64,
    /// State at the segment's time 0; the end of the segment before it.
    pub start: Option<AxisState>,
    /// How the state goes on from there; exactly one of them, and jerk 0 for constant acceleration.
    pub law: Option<Law>,
}

/// Nested message and enum types in `AxisSegment`.
pub mod axis_segment {
    /// A polynomial given by its derivatives.
    #[derive(Clone, PartialEq, prost::Message)]
    pub struct Polynomial {
        /// Jerk, snap, ... at the start of the segment \[u/s^3, u/s^4, ...\]: one to thirteen of them; the last one is constant.
        #[prost(double, repeated, tag = "1")]
        pub derivatives: Vec<f64>,
    }

    /// A raised cosine of jerk that begins and ends at zero.
    #[derive(Clone, Copy, PartialEq, prost::Message)]
    pub struct CosineJerk {
        /// Jerk in the middle of the segment \[u/s^3\], either sign.
        #[prost(double, tag = "1")]
        pub peak_jerk: f64,
    }

    /// How the state goes on from there; exactly one of them, and jerk 0 for constant acceleration.
    #[derive(Clone, PartialEq, prost::Oneof)]
    pub enum Law {
        /// Constant jerk \[u/s^3\].
        #[prost(double, tag = "3")]
        Jerk(f64),
        /// A polynomial of higher order.
        #[prost(message, tag = "4")]
        Polynomial(Polynomial),
        /// A raised cosine: j(t) = peak_jerk / 2 * (1 - cos(2 pi t / duration)).
        #[prost(message, tag = "5")]
        CosineJerk(CosineJerk),
    }
}

/// A key of one byte and eight of a double.
const DOUBLE: usize = 9;

impl AxisSegment {
    /// What is written of a state: a double that is not zero.
    #[inline]
    fn state_len(state: &AxisState) -> usize {
        let AxisState { position, velocity, acceleration } = state;
        let counts = [position, velocity, acceleration].map(|value| usize::from(*value != 0.0));
        DOUBLE * (counts[0] + counts[1] + counts[2])
    }

    /// The bytes of a piece of constant jerk from a state.
    #[inline]
    fn line(duration: f64, start: &AxisState, jerk: f64) -> Line {
        let AxisState { position, velocity, acceleration } = *start;
        let mut line = Line { bytes: [0; MOST], len: 0 };
        line.double_unless_zero(1, duration);
        line.byte(2 << 3 | WireType::LengthDelimited as u8);
        // At most 27, so a byte of its own.
        line.byte(Self::state_len(start) as u8);
        line.double_unless_zero(1, position);
        line.double_unless_zero(2, velocity);
        line.double_unless_zero(3, acceleration);
        // One of several, so that it is written though it be zero.
        line.double(3, jerk);
        line
    }
}

/// The most bytes of a piece of constant jerk.
const MOST: usize = 5 * DOUBLE + 2;

struct Line {
    bytes: [u8; MOST],
    len: usize,
}

impl Line {
    #[inline]
    fn byte(&mut self, byte: u8) {
        self.bytes[self.len] = byte;
        self.len += 1;
    }

    #[inline]
    fn double(&mut self, number: u8, value: f64) {
        self.byte(number << 3 | WireType::SixtyFourBit as u8);
        self.bytes[self.len..self.len + 8].copy_from_slice(&value.to_le_bytes());
        self.len += 8;
    }

    #[inline]
    fn double_unless_zero(&mut self, number: u8, value: f64) {
        if value != 0.0 {
            self.double(number, value);
        }
    }
}

impl prost::Message for AxisSegment {
    #[inline]
    fn encode_raw(&self, buf: &mut impl BufMut) {
        let Self { duration, start, law } = self;
        if let (Some(start), Some(Law::Jerk(jerk))) = (start, law) {
            let Line { bytes, len } = Self::line(*duration, start, *jerk);
            buf.put_slice(&bytes[..len]);
            return;
        }
        if *duration != 0.0 {
            double::encode(1, duration, buf);
        }
        if let Some(start) = start {
            message::encode(2, start, buf);
        }
        if let Some(law) = law {
            law.encode(buf);
        }
    }

    #[inline]
    fn encoded_len(&self) -> usize {
        let Self { duration, start, law } = self;
        let duration = if *duration == 0.0 { 0 } else { DOUBLE };
        let start = start.as_ref().map_or(0, |start| 2 + Self::state_len(start));
        let law = match law {
            Some(Law::Jerk(_)) => DOUBLE,
            Some(law @ (Law::Polynomial(_) | Law::CosineJerk(_))) => law.encoded_len(),
            None => 0,
        };
        duration + start + law
    }

    fn merge_field(
        &mut self,
        tag: u32,
        wire_type: WireType,
        buf: &mut impl Buf,
        ctx: DecodeContext,
    ) -> Result<(), DecodeError> {
        let within = |field: &'static str| {
            move |mut error: DecodeError| {
                error.push("AxisSegment", field);
                error
            }
        };
        match tag {
            1 => double::merge(wire_type, &mut self.duration, buf, ctx).map_err(within("duration")),
            2 => {
                let start = self.start.get_or_insert_default();
                message::merge(wire_type, start, buf, ctx).map_err(within("start"))
            }
            3..=5 => Law::merge(&mut self.law, tag, wire_type, buf, ctx).map_err(within("law")),
            _ => skip_field(wire_type, tag, buf, ctx),
        }
    }

    fn clear(&mut self) {
        *self = Self::default();
    }
}

impl prost::Name for AxisSegment {
    const NAME: &'static str = "AxisSegment";
    const PACKAGE: &'static str = "motion.v1";
}
