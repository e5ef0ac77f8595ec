//! From the encoding of a message to its JSON on one line, in one pass over tables that are made once.
//!
//! Reflection builds a tree of values before it writes any of them, which costs several times what planning and encoding
//! do. Here the encoding is written out as it is read: prost encodes fields in the order of their numbers, which is the
//! order in which reflection writes them. What comes otherwise is left to reflection, so that both agree byte for byte or
//! only one of them speaks; `tests/json.rs` compares them.

use std::collections::HashMap;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use prost::Message;
use prost::bytes::Buf as _;
use prost::encoding::{WireType, decode_key, decode_varint};
use prost_reflect::{DescriptorPool, FieldDescriptor, Kind, MessageDescriptor};
use prost_types::Duration;

/// How many seconds the JSON of a duration may have.
const LONGEST_DURATION: u64 = 315_576_000_000;

/// Writes messages of one schema.
pub(crate) struct Transcript {
    /// Every message by its full name.
    index: HashMap<String, usize>,
    tables: Vec<Table>,
}

/// The fields of one message, in the order of their numbers.
type Table = Vec<Form>;

/// What has to be known of a field in order to write it.
struct Form {
    number: u32,
    /// `"name":`
    key: String,
    of: Of,
    list: bool,
    /// Its default is not written: it tells that the field was set.
    presence: bool,
}

/// What a field holds.
enum Of {
    Double,
    Bool,
    Int32,
    Sint32,
    Uint32,
    Int64,
    Uint64,
    Fixed64,
    Text,
    Bytes,
    Choice(HashMap<i32, String>),
    Duration,
    /// By the number of its table.
    Message(usize),
    /// In no message of ours today.
    Unknown,
}

impl Transcript {
    /// For the messages of `package` in `pool`.
    pub(crate) fn of(pool: &DescriptorPool, package: &str) -> Self {
        let messages: Vec<_> =
            pool.all_messages().filter(|message| message.package_name() == package).collect();
        let names = messages.iter().map(|message| message.full_name().to_owned());
        let index: HashMap<_, _> = names.zip(0..).collect();
        // By number, as reflection does.
        let table =
            |message: &MessageDescriptor| message.fields().map(|field| Form::of(&field, &index)).collect();
        let tables = messages.iter().map(table).collect();
        Self { index, tables }
    }

    /// The message called `name` with this encoding as JSON; nothing where only reflection can tell.
    pub(crate) fn write(&self, name: &str, encoded: &[u8], defaults: bool) -> Option<String> {
        // An encoded double has nine bytes, and about three times that with its name as a text.
        let mut out = Vec::with_capacity(4 * encoded.len() + 256);
        self.message(*self.index.get(name)?, encoded, defaults, &mut out)?;
        String::from_utf8(out).ok()
    }

    fn message(&self, table: usize, mut encoded: &[u8], defaults: bool, out: &mut Vec<u8>) -> Option<()> {
        out.push(b'{');
        let mut forms = self.tables[table].iter();
        while encoded.has_remaining() {
            let (number, wire) = decode_key(&mut encoded).ok()?;
            let form = loop {
                // None are left: the field is not known, or comes late.
                let form = forms.next()?;
                if form.number == number {
                    break form;
                }
                self.absent(form, defaults, out)?;
            };
            out.extend_from_slice(form.key.as_bytes());
            if form.list {
                self.list(form, wire, &mut encoded, defaults, out)?;
            } else {
                self.value(&form.of, &mut encoded, defaults, out)?;
            }
            out.push(b',');
        }
        for form in forms {
            self.absent(form, defaults, out)?;
        }
        end(out, b'}');
        Some(())
    }

    fn list(
        &self,
        form: &Form,
        wire: WireType,
        encoded: &mut &[u8],
        defaults: bool,
        out: &mut Vec<u8>,
    ) -> Option<()> {
        out.push(b'[');
        if wire == WireType::LengthDelimited && form.of.is_packed() {
            let mut packed = delimited(encoded)?;
            while packed.has_remaining() {
                self.value(&form.of, &mut packed, defaults, out)?;
                out.push(b',');
            }
        } else {
            loop {
                self.value(&form.of, encoded, defaults, out)?;
                out.push(b',');
                let mut ahead = *encoded;
                match decode_key(&mut ahead) {
                    Ok((number, _)) if number == form.number => *encoded = ahead,
                    _ => break,
                }
            }
        }
        end(out, b']');
        Some(())
    }

    fn value(&self, of: &Of, encoded: &mut &[u8], defaults: bool, out: &mut Vec<u8>) -> Option<()> {
        match of {
            Of::Double => double(encoded.try_get_f64_le().ok()?, out),
            Of::Bool => put(&(decode_varint(encoded).ok()? != 0), out),
            Of::Int32 => put(&(decode_varint(encoded).ok()? as i32), out),
            Of::Sint32 => put(&zigzag(decode_varint(encoded).ok()? as u32), out),
            Of::Uint32 => put(&(decode_varint(encoded).ok()? as u32), out),
            Of::Int64 => put(&(decode_varint(encoded).ok()? as i64).to_string(), out),
            Of::Uint64 => put(&decode_varint(encoded).ok()?.to_string(), out),
            Of::Fixed64 => put(&encoded.try_get_u64_le().ok()?.to_string(), out),
            Of::Text => put(std::str::from_utf8(delimited(encoded)?).ok()?, out),
            Of::Bytes => put(&BASE64_STANDARD.encode(delimited(encoded)?), out),
            Of::Choice(names) => choice(decode_varint(encoded).ok()? as i32, names, out),
            Of::Duration => duration(delimited(encoded)?, out),
            Of::Message(table) => self.message(*table, delimited(encoded)?, defaults, out),
            Of::Unknown => None,
        }
    }

    /// A field that is not in the encoding.
    fn absent(&self, form: &Form, defaults: bool, out: &mut Vec<u8>) -> Option<()> {
        if form.presence || !defaults {
            return Some(());
        }
        out.extend_from_slice(form.key.as_bytes());
        if form.list {
            out.extend_from_slice(b"[]");
        } else {
            // Eight zeros are the encoding of every default that a field without presence may have.
            self.value(&form.of, &mut [0; 8].as_slice(), defaults, out)?;
        }
        out.push(b',');
        Some(())
    }
}

impl Form {
    fn of(field: &FieldDescriptor, index: &HashMap<String, usize>) -> Self {
        let of = match field.kind() {
            _ if field.is_map() => Of::Unknown,
            Kind::Double => Of::Double,
            Kind::Bool => Of::Bool,
            Kind::Int32 => Of::Int32,
            Kind::Sint32 => Of::Sint32,
            Kind::Uint32 => Of::Uint32,
            Kind::Int64 => Of::Int64,
            Kind::Uint64 => Of::Uint64,
            Kind::Fixed64 => Of::Fixed64,
            Kind::String => Of::Text,
            Kind::Bytes => Of::Bytes,
            Kind::Enum(names) => {
                Of::Choice(names.values().map(|value| (value.number(), value.name().to_owned())).collect())
            }
            Kind::Message(message) if message.full_name() == "google.protobuf.Duration" => Of::Duration,
            Kind::Message(message) => {
                index.get(message.full_name()).copied().map_or(Of::Unknown, Of::Message)
            }
            Kind::Float | Kind::Sint64 | Kind::Fixed32 | Kind::Sfixed32 | Kind::Sfixed64 => Of::Unknown,
        };
        let (list, presence) = (field.is_list(), field.supports_presence());
        Self { number: field.number(), key: format!("{:?}:", field.json_name()), of, list, presence }
    }
}

impl Of {
    /// Are lists of it one length-delimited run?
    fn is_packed(&self) -> bool {
        !matches!(self, Self::Text | Self::Bytes | Self::Duration | Self::Message(_) | Self::Unknown)
    }
}

/// Closes what every part has left a comma after.
fn end(out: &mut Vec<u8>, bracket: u8) {
    if out.last() == Some(&b',') {
        out.pop();
    }
    out.push(bracket);
}

fn delimited<'a>(encoded: &mut &'a [u8]) -> Option<&'a [u8]> {
    let length = usize::try_from(decode_varint(encoded).ok()?).ok()?;
    let (part, rest) = encoded.split_at_checked(length)?;
    *encoded = rest;
    Some(part)
}

/// Small magnitudes of either sign as small numbers, read back.
fn zigzag(number: u32) -> i32 {
    (number >> 1) as i32 ^ -((number & 1) as i32)
}

fn put<T: serde::Serialize + ?Sized>(value: &T, out: &mut Vec<u8>) -> Option<()> {
    serde_json::to_writer(out, value).ok()
}

fn double(value: f64, out: &mut Vec<u8>) -> Option<()> {
    match value {
        f64::INFINITY => put("Infinity", out),
        f64::NEG_INFINITY => put("-Infinity", out),
        value if value.is_nan() => put("NaN", out),
        value => put(&value, out),
    }
}

fn choice(number: i32, names: &HashMap<i32, String>, out: &mut Vec<u8>) -> Option<()> {
    match names.get(&number) {
        Some(name) => put(name, out),
        None => put(&number, out),
    }
}

/// What cannot be written, reflection has the words for.
fn duration(encoded: &[u8], out: &mut Vec<u8>) -> Option<()> {
    let duration = Duration::decode(encoded).ok()?;
    let Duration { seconds, nanos } = duration;
    let agree = seconds.signum() * i64::from(nanos.signum()) >= 0;
    let fits = seconds.unsigned_abs() <= LONGEST_DURATION && nanos.unsigned_abs() < 1_000_000_000;
    if agree && fits { put(&duration.to_string(), out) } else { None }
}
