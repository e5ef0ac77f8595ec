//! The proto3 JSON mapping of the messages: one schema for programs that read a file and those that call.
//!
//! Field names are in lowerCamelCase, and the names of the schema are read as well. Enums are written by name,
//! 64-bit integers as decimal strings, bytes in base64, durations as `"0.001s"`, and numbers that are not finite
//! as `"NaN"`, `"Infinity"` and `"-Infinity"`. Every other double is written with as many digits as it takes to
//! read the same bits back.
//!
//! A message goes through its encoding, so what that does not carry JSON does not either: the sign of a zero in
//! a singular field without presence, and fields unknown to this version.

use std::sync::LazyLock;

use prost::{Message, Name};
use prost_reflect::{
    self as reflect, DescriptorPool, DeserializeOptions, DynamicMessage, MessageDescriptor,
    ReflectMessage as _, SerializeOptions,
};
use serde_json::Value;

use crate::FILE_DESCRIPTOR_SET;
use crate::transcript::Transcript;

/// How JSON is written.
///
/// ```
/// # use proto::{JsonStyle, pb, to_json_with};
/// let request = pb::SamplePlanRequest { first_cycle: 7, ..Default::default() };
/// assert_eq!(to_json_with(&request, JsonStyle::COMPACT)?, r#"{"firstCycle":"7","cycles":"0"}"#);
/// let terse = JsonStyle { emit_defaults: false, ..JsonStyle::COMPACT };
/// assert_eq!(to_json_with(&request, terse)?, r#"{"firstCycle":"7"}"#);
/// # Ok::<(), proto::JsonError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JsonStyle {
    /// Write fields without presence (plain numbers, flags, texts, enums, lists) even at their default, so that
    /// a key is always there: `"passed": false` says more than its absence. Fields with presence (`optional`, in a
    /// `oneof`, messages) are written when they are set, in either style.
    ///
    /// Both styles are the standard mapping, in which this is a printer's option.
    pub emit_defaults: bool,
    /// Over several indented lines, instead of one.
    pub indent: bool,
}

impl JsonStyle {
    /// One line, defaults written.
    pub const COMPACT: Self = Self { emit_defaults: true, indent: false };
    /// Indented, defaults written.
    pub const PRETTY: Self = Self { emit_defaults: true, indent: true };
}

/// Text that is not a message, or a message that has no text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum JsonError {
    /// The text is not JSON, or not the JSON of this message.
    #[error("line {line}, column {column}: {cause}")]
    Read {
        /// Line of the text, from 1.
        line: usize,
        /// Column of the line, from 1.
        column: usize,
        /// What is wrong there; an unknown field is named.
        cause: String,
    },
    /// The message holds what the mapping cannot express: a duration beyond 10 000 years, or one whose parts
    /// have different signs. Only a peer makes such messages.
    #[error("the message cannot be written as JSON: {cause}")]
    Write {
        /// What cannot be expressed.
        cause: String,
    },
}

/// The message on one line, defaults written ([`JsonStyle::COMPACT`]).
///
/// # Errors
/// [`JsonError::Write`].
pub fn to_json<T: Message + Name>(message: &T) -> Result<String, JsonError> {
    to_json_with(message, JsonStyle::COMPACT)
}

/// The message on indented lines, defaults written ([`JsonStyle::PRETTY`]).
///
/// # Errors
/// [`JsonError::Write`].
pub fn to_json_pretty<T: Message + Name>(message: &T) -> Result<String, JsonError> {
    to_json_with(message, JsonStyle::PRETTY)
}

/// The message in the given style.
///
/// # Errors
/// [`JsonError::Write`].
pub fn to_json_with<T: Message + Name>(message: &T, style: JsonStyle) -> Result<String, JsonError> {
    static TRANSCRIPT: LazyLock<Transcript> = LazyLock::new(|| Transcript::of(pool(), "motion.v1"));
    if !style.indent
        && let Some(text) = TRANSCRIPT.write(&T::full_name(), &message.encode_to_vec(), style.emit_defaults)
    {
        return Ok(text);
    }
    let message = dynamic(message)?;
    let options = SerializeOptions::new().skip_default_fields(!style.emit_defaults);
    let mut text = Vec::new();
    if style.indent {
        message.serialize_with_options(&mut serde_json::Serializer::pretty(&mut text), &options)
    } else {
        message.serialize_with_options(&mut serde_json::Serializer::new(&mut text), &options)
    }
    .map_err(unwritable)?;
    String::from_utf8(text).map_err(unwritable)
}

/// The message as a value, defaults written: to be put into a larger document.
///
/// # Errors
/// [`JsonError::Write`].
pub fn to_json_value<T: Message + Name>(message: &T) -> Result<Value, JsonError> {
    let options = SerializeOptions::new().skip_default_fields(false);
    dynamic(message)?.serialize_with_options(serde_json::value::Serializer, &options).map_err(unwritable)
}

/// The message that a text stands for. Fields may be left out or `null`; fields that do not exist are an error.
///
/// ```
/// # use proto::{from_json, pb};
/// let error = from_json::<pb::AxisLimits>(r#"{"maxVelocity": 1, "maxJrek": 5}"#).unwrap_err();
/// assert_eq!(error.to_string(), "line 1, column 28: unrecognized field name 'maxJrek'");
/// ```
///
/// # Errors
/// [`JsonError::Read`].
pub fn from_json<T: Message + Name + Default>(text: &str) -> Result<T, JsonError> {
    let mut json = serde_json::Deserializer::from_str(text);
    let options = DeserializeOptions::new().deny_unknown_fields(true);
    let message = DynamicMessage::deserialize_with_options(descriptor::<T>(), &mut json, &options)
        .map_err(unreadable)?;
    json.end().map_err(unreadable)?;
    message.transcode_to().map_err(|cause| JsonError::Read { line: 1, column: 1, cause: cause.to_string() })
}

fn dynamic<T: Message + Name>(message: &T) -> Result<DynamicMessage, JsonError> {
    let mut dynamic = DynamicMessage::new(descriptor::<T>());
    dynamic.transcode_from(message).map_err(unwritable)?;
    check_durations(&dynamic)?;
    Ok(dynamic)
}

/// prost-types writes a duration whose parts have different signs with the wrong sign, instead of refusing it.
fn check_durations(message: &DynamicMessage) -> Result<(), JsonError> {
    if message.descriptor().full_name() == prost_types::Duration::full_name() {
        let prost_types::Duration { seconds, nanos } = message.transcode_to().map_err(unwritable)?;
        if seconds.signum() * i64::from(nanos.signum()) < 0 {
            return Err(unwritable(format!(
                "a duration of {seconds} s and {nanos} ns has parts of different signs"
            )));
        }
        return Ok(());
    }
    message.fields().try_for_each(|(_, value)| match value {
        reflect::Value::Message(inner) => check_durations(inner),
        // A list holds values of one type: where the first is no message, none is.
        reflect::Value::List(values) => {
            values.iter().map_while(reflect::Value::as_message).try_for_each(check_durations)
        }
        _ => Ok(()),
    })
}

fn unwritable(cause: impl ToString) -> JsonError {
    JsonError::Write { cause: cause.to_string() }
}

fn unreadable(error: serde_json::Error) -> JsonError {
    let (line, column) = (error.line(), error.column());
    let text = error.to_string();
    // The position is said once, and first.
    let cause = text.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&text);
    JsonError::Read { line, column, cause: cause.to_owned() }
}

#[expect(clippy::expect_used, reason = "depends on what was compiled in, never on what a peer sent; tested")]
fn pool() -> &'static DescriptorPool {
    static POOL: LazyLock<DescriptorPool> = LazyLock::new(|| {
        DescriptorPool::decode(FILE_DESCRIPTOR_SET).expect("the checked-in descriptor set is valid")
    });
    &POOL
}

#[expect(clippy::expect_used, reason = "depends on what was compiled in, never on what a peer sent; tested")]
fn descriptor<T: Name>() -> MessageDescriptor {
    const {
        assert!(
            matches!(T::PACKAGE.as_bytes(), b"motion.v1"),
            "only messages of motion.v1 have a JSON form here"
        );
    }
    pool()
        .get_message_by_name(&T::full_name())
        .expect("code and descriptor set are generated from one schema")
}
