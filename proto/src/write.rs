//! Messages put down as bytes, field by field, by whoever has what they say and no message of it.
//!
//! A plan is a tree of some thirty messages, with names of its own in most of them. To make the tree, to measure it at each
//! level and to write it takes three times as long as to write what it would say. What comes out is what the generated code
//! would write: fields in the order of their numbers, numbers packed, and what is at its default left out.

use prost::Message;
use prost::encoding::{WireType, encode_varint, encoded_len_varint, message};

/// The bytes of a message, as far as it is written.
///
/// Numbers of fields are below 16, so that a key is one byte.
#[derive(Debug, Default)]
pub(crate) struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// With room for so many bytes.
    pub(crate) fn with_room(bytes: usize) -> Self {
        Self { bytes: Vec::with_capacity(bytes) }
    }

    /// How many bytes are written.
    pub(crate) fn len(&self) -> usize {
        self.bytes.len()
    }

    /// What is written.
    pub(crate) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }

    /// What is written, from there on.
    pub(crate) fn since(&self, at: usize) -> &[u8] {
        &self.bytes[at..]
    }

    /// As above, to be put in later.
    pub(crate) fn since_mut(&mut self, at: usize) -> &mut [u8] {
        &mut self.bytes[at..]
    }

    /// What another has written, after what is here.
    pub(crate) fn append(&mut self, other: &Self) {
        self.bytes.extend_from_slice(&other.bytes);
    }

    fn varint(&mut self, value: u64) {
        if value < 0x80 {
            self.bytes.push(value as u8);
        } else {
            encode_varint(value, &mut self.bytes);
        }
    }

    fn key(&mut self, field: u8, wire_type: WireType) {
        debug_assert!(field < 16, "a key of one byte");
        self.bytes.push(field << 3 | wire_type as u8);
    }

    /// A number, though it be zero: one that may be missing, and is not.
    pub(crate) fn given_double(&mut self, field: u8, value: f64) {
        let mut bytes = [field << 3 | WireType::SixtyFourBit as u8; 9];
        bytes[1..].copy_from_slice(&value.to_le_bytes());
        self.bytes.extend_from_slice(&bytes);
    }

    /// A number.
    pub(crate) fn double(&mut self, field: u8, value: f64) {
        if value != 0.0 {
            self.given_double(field, value);
        }
    }

    /// A number that is not negative, or the number of a choice, of which there is no negative one.
    pub(crate) fn whole(&mut self, field: u8, value: u64) {
        if value != 0 {
            self.key(field, WireType::Varint);
            self.varint(value);
        }
    }

    /// One of several.
    pub(crate) fn choice(&mut self, field: u8, value: i32) {
        // As an enumeration goes: with its sign extended.
        self.whole(field, i64::from(value) as u64);
    }

    /// Yes or no.
    pub(crate) fn flag(&mut self, field: u8, value: bool) {
        self.whole(field, u64::from(value));
    }

    /// Several of several, packed.
    pub(crate) fn choices(&mut self, field: u8, values: impl ExactSizeIterator<Item = i32>) {
        if values.len() > 0 {
            self.nested(field, |writer| values.for_each(|value| writer.varint(i64::from(value) as u64)));
        }
    }

    /// Numbers, packed.
    pub(crate) fn doubles(&mut self, field: u8, values: &[f64]) {
        if !values.is_empty() {
            self.nested(field, |writer| {
                values.iter().for_each(|value| writer.bytes.extend_from_slice(&value.to_le_bytes()));
            });
        }
    }

    /// Bytes, or a text, though there be none of it.
    pub(crate) fn given_bytes(&mut self, field: u8, value: &[u8]) {
        self.key(field, WireType::LengthDelimited);
        self.varint(value.len() as u64);
        self.bytes.extend_from_slice(value);
    }

    /// A text, though it be empty: one of several, or one that may be missing, and is not.
    pub(crate) fn given_text(&mut self, field: u8, value: &str) {
        self.given_bytes(field, value.as_bytes());
    }

    /// A text.
    pub(crate) fn text(&mut self, field: u8, value: &str) {
        if !value.is_empty() {
            self.given_text(field, value);
        }
    }

    /// A message that there is already.
    pub(crate) fn message(&mut self, field: u8, value: &impl Message) {
        message::encode(u32::from(field), value, &mut self.bytes);
    }

    /// A message of what `write` puts down.
    pub(crate) fn nested(&mut self, field: u8, write: impl FnOnce(&mut Self)) {
        self.key(field, WireType::LengthDelimited);
        // Most are short, and have a length of one byte; others make room for theirs.
        self.bytes.push(0);
        let begin = self.len();
        write(self);
        let length = self.len() - begin;
        if length < 0x80 {
            self.bytes[begin - 1] = length as u8;
        } else {
            self.lengthen(begin, length as u64);
        }
    }

    /// Makes room for the length of a message that begins there, and puts it down.
    #[cold]
    fn lengthen(&mut self, begin: usize, length: u64) {
        let (end, more) = (self.len(), encoded_len_varint(length) - 1);
        self.bytes.resize(end + more, 0);
        self.bytes.copy_within(begin..end, begin + more);
        encode_varint(length, &mut &mut self.bytes[begin - 1..]);
    }
}

/// The message of bytes that were written as one of its kind.
pub(crate) fn read<M: Message + Default>(writer: Writer) -> M {
    // What is written here can be read: every field is written in the form that it has.
    M::decode(writer.into_bytes().as_slice()).unwrap_or_else(|error| {
        debug_assert!(false, "{error}");
        M::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pb;

    #[test]
    fn a_message_in_a_message_has_the_length_that_it_has() {
        for length in [0, 1, 125, 126, 127, 128, 16_381, 16_382, 16_383, 16_384, 3_000_000] {
            let error = pb::Adjustment { reason: "x".repeat(length), ..Default::default() };
            let mut writer = Writer::default();
            writer.nested(7, |inner| inner.text(4, &error.reason));
            let plan = pb::AxisPlan { adjustments: vec![error], ..Default::default() };
            assert_eq!(writer.into_bytes(), plan.encode_to_vec(), "{length}");
        }
    }

    #[test]
    fn fields_are_written_as_generated_code_writes_them() {
        for value in [0.0, -0.0, 1.5, f64::MIN_POSITIVE, f64::NAN, f64::INFINITY] {
            let mut writer = Writer::default();
            writer.text(1, "");
            writer.choice(2, -1);
            writer.double(3, value);
            writer.flag(7, true);
            writer.given_double(8, value);
            let check = pb::plan_certificate::LimitCheck {
                quantity: -1,
                limit: value,
                guaranteed: true,
                led_back_by: Some(value),
                ..Default::default()
            };
            assert_eq!(writer.into_bytes(), check.encode_to_vec(), "{value}");
        }
        let guaranteed = [0, 1, 300, -7];
        for given in [&guaranteed[..], &[]] {
            let mut writer = Writer::default();
            writer.whole(4, 0);
            writer.whole(4, u64::MAX);
            writer.choices(11, given.iter().copied());
            let plan = pb::Plan { cycle_count: u64::MAX, guaranteed: given.to_vec(), ..Default::default() };
            assert_eq!(writer.into_bytes(), plan.encode_to_vec());
        }
    }
}
