//! A refusal, and its way over the wire and back.

use std::collections::BTreeMap;
use std::error::Error;
use std::fmt::{self, Write as _};
use std::time::Duration;

use prost::Message;
use prost_types::Any;
use serde_json::{Value, json};
use tonic::{Code, Status};
use tonic_types::pb::{BadRequest, RetryInfo, Status as RpcStatus, bad_request};

use crate::Reason;

/// The `domain` of the `google.rpc.ErrorInfo` in every refusal.
pub const DOMAIN: &str = "portamento.motion";

/// A request that was refused, with everything that its sender needs to do better. A refusal changes nothing.
///
/// On the wire it is a status with the details `google.rpc.ErrorInfo` (reason, [`DOMAIN`], metadata) and, if there
/// are fields, `google.rpc.BadRequest`. [`from_status`](Self::from_status) rebuilds it exactly.
///
/// ```
/// # use proto::{Reason, Rejected};
/// let refusal = Rejected::new(Reason::PathTooShort, "the path is 0.01 long, and 0.02 is needed")
///     .with("given", 0.01)
///     .with("needed", 0.02);
/// let status = tonic::Status::from(refusal.clone());
/// assert_eq!(status.code(), tonic::Code::FailedPrecondition);
/// assert_eq!(Rejected::from_status(&status), Some(refusal));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Rejected {
    /// Why; the status code follows from it.
    pub reason: Reason,
    /// What was given, what is allowed, and the way out.
    pub message: String,
    /// The fields that are at fault, all of them at once.
    pub fields: Vec<FieldViolation>,
    /// Facts for programs: `needed`, `given` and `nearest`, a cycle, an epoch, a limit.
    pub metadata: BTreeMap<String, String>,
}

/// One field at fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldViolation {
    /// Path of the field in the request: `axes[2].limits.max_jerk`.
    pub field: String,
    /// Why.
    pub reason: Reason,
    /// What was given, what is allowed, and the way out.
    pub description: String,
}

impl Rejected {
    /// A refusal without fields or metadata.
    pub fn new(reason: Reason, message: impl Into<String>) -> Self {
        Self { reason, message: message.into(), fields: Vec::new(), metadata: BTreeMap::new() }
    }

    /// The refusal of a request for one invalid field.
    pub fn for_field(field: impl Into<String>, reason: Reason, description: impl Into<String>) -> Self {
        let violation = FieldViolation::new(field, reason, description);
        let message = format!("{}: {}", violation.field, violation.description);
        Self { fields: vec![violation], ..Self::new(reason, message) }
    }

    /// The same, said of a message that stands in the field called `outer`.
    #[must_use]
    pub fn inside(mut self, outer: &str) -> Self {
        let told = self.fields.first().is_some_and(|first| self.message.starts_with(&first.field));
        if told {
            self.message.insert_str(0, &format!("{outer}."));
        }
        for violation in &mut self.fields {
            violation.field.insert_str(0, &format!("{outer}."));
        }
        self
    }

    /// The refusal of a request for its invalid fields, or `None` if there are none. The reason is that of the
    /// first field.
    pub fn for_fields(fields: Vec<FieldViolation>) -> Option<Self> {
        let FieldViolation { field, reason, description } = fields.first()?;
        let message = match fields.len() - 1 {
            0 => format!("{field}: {description}"),
            1 => format!("{field}: {description} (and 1 more invalid field)"),
            more => format!("{field}: {description} (and {more} more invalid fields)"),
        };
        let reason = *reason;
        Some(Self { fields, ..Self::new(reason, message) })
    }

    /// An operation that the axis had not adopted when the session ended: nothing is wrong with it, and whoever goes on with the stream may be
    /// asked again.
    #[must_use]
    pub fn left_undone() -> Self {
        let text = "the session ended before the axis had adopted the operation: send it again with the same request_id";
        Self::new(Reason::NotConfirmed, text).with(SESSION_ENDED, true)
    }

    /// Is it such an operation?
    #[must_use]
    pub fn is_left_undone(&self) -> bool {
        self.reason == Reason::NotConfirmed && self.metadata.contains_key(SESSION_ENDED)
    }

    /// The same with one more fact. Numbers are written so that they read back to the same value.
    #[must_use]
    pub fn with(mut self, key: impl Into<String>, value: impl ToString) -> Self {
        self.metadata.insert(key.into(), value.to_string());
        self
    }

    /// The same, to be asked again after `wait`: also as the detail `google.rpc.RetryInfo`, which clients of gRPC know.
    #[must_use]
    pub fn retry_after(self, wait: Duration) -> Self {
        self.with(RETRY_AFTER, wait.as_secs_f64())
    }

    /// How long to wait before asking again, where the refusal says it.
    #[must_use]
    pub fn retry_delay(&self) -> Option<Duration> {
        Duration::try_from_secs_f64(self.metadata.get(RETRY_AFTER)?.parse().ok()?).ok()
    }

    /// The refusal that a status carries, if it carries one that this version knows.
    pub fn from_status(status: &Status) -> Option<Self> {
        Self::from_bytes(status.details())
    }

    /// The refusal as an encoded `google.rpc.Status`: what stands in the trailer `grpc-status-details-bin`, and in
    /// `OperationRefusal.status`. Nothing is shortened.
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let Self { reason, message, fields, metadata } = self;
        let info = ErrorInfo {
            reason: reason.name().to_owned(),
            domain: DOMAIN.to_owned(),
            metadata: metadata.clone(),
        };
        let mut details = vec![info.into_any()];
        if !fields.is_empty() {
            let field_violations = fields.iter().map(FieldViolation::to_wire).collect();
            details.push(any(BAD_REQUEST, &BadRequest { field_violations }));
        }
        let delay = self.retry_delay().and_then(|delay| prost_types::Duration::try_from(delay).ok());
        if let Some(retry_delay) = delay {
            details.push(any(RETRY_INFO, &RetryInfo { retry_delay: Some(retry_delay) }));
        }
        RpcStatus { code: reason.code().into(), message: message.clone(), details }.encode_to_vec()
    }

    /// The refusal that an encoded `google.rpc.Status` carries, if it carries one that this version knows.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let details = Details::decode(bytes)?;
        let info = details.info.filter(|info| info.domain == DOMAIN)?;
        let reason: Reason = info.reason.parse().ok()?;
        let fields = details
            .fields
            .into_iter()
            .map(|wire| FieldViolation {
                // A newer version's reason is told as the one of the whole: better than losing the field.
                reason: wire.reason.parse().unwrap_or(reason),
                field: wire.field,
                description: wire.description,
            })
            .collect();
        Some(Self { reason, message: details.message, fields, metadata: info.metadata })
    }

    /// The refusal as programs read it:
    /// `{"error": {"code", "reason", "message", "fields": [{"field", "reason", "description"}], "metadata": {...}}}`,
    /// every value a string and every key always there.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let fields = self.fields.iter().map(|FieldViolation { field, reason, description }| {
            field_json(field, reason.name(), description)
        });
        error_json(self.reason.code(), self.reason.name(), &self.message, fields.collect(), &self.metadata)
    }

    /// The same within what every peer accepts as trailers.
    fn shortened(&self) -> Self {
        let mut room: usize = DETAILS_ROOM;
        let mut fits = |texts: [&str; 3]| {
            let needed = texts.iter().map(|text| text.len() + TEXT_OVERHEAD).sum();
            let left = room.checked_sub(needed);
            room = left.unwrap_or(0);
            left.is_some()
        };
        let message = clipped(&self.message, MESSAGE_ROOM);
        fits([&message, "", ""]);
        let mut metadata: BTreeMap<String, String> = self
            .metadata
            .iter()
            .map(|(key, value)| (clipped(key, KEY_ROOM), clipped(value, VALUE_ROOM)))
            .take_while(|(key, value)| fits([key, value, ""]))
            .collect();
        let fields: Vec<FieldViolation> = self
            .fields
            .iter()
            .map(|violation| FieldViolation {
                field: clipped(&violation.field, FIELD_ROOM),
                reason: violation.reason,
                description: clipped(&violation.description, VALUE_ROOM),
            })
            .take_while(|violation| fits([&violation.field, violation.reason.name(), &violation.description]))
            .collect();
        if fields.len() < self.fields.len() {
            metadata.insert(FIELDS_OMITTED.to_owned(), (self.fields.len() - fields.len()).to_string());
        }
        Self { reason: self.reason, message, fields, metadata }
    }
}

// A status travels in trailers, and common peers take 8 KiB of them (gRPC's soft limit; hyper's is 16 KiB); past
// that the caller sees a broken stream instead of the reason. In bytes: the message stands there twice, once
// percent-encoded (at most 3 for 1), and the details in base64 (4 for 3): 3 * 768 + 4 / 3 * 4096 < 8 KiB.
const MESSAGE_ROOM: usize = 768;
/// Of 4096, what is left beside reason, domain, type names and [`FIELDS_OMITTED`].
const DETAILS_ROOM: usize = 4096 - 320;
const KEY_ROOM: usize = 64;
const VALUE_ROOM: usize = 384;
const FIELD_ROOM: usize = 192;
/// Tags and lengths around a text, and its share of those of the message that it stands in.
const TEXT_OVERHEAD: usize = 4;
/// Metadata key under which a status says how many fields did not fit.
const FIELDS_OMITTED: &str = "fields_omitted";
/// Metadata key under which a refusal says how long to wait before asking again \[s\].
const RETRY_AFTER: &str = "retry_after_s";

/// The metadata key of [`Rejected::left_undone`].
const SESSION_ENDED: &str = "session_ended";

/// At most `room` bytes of `text`, ending in an ellipsis if it had to be cut.
fn clipped(text: &str, room: usize) -> String {
    if text.len() <= room {
        return text.to_owned();
    }
    let end = text.floor_char_boundary(room - '…'.len_utf8());
    format!("{}…", &text[..end])
}

impl From<Rejected> for Status {
    /// As a status, which travels in trailers: what does not fit 4 KiB is left out, and long texts are cut. The
    /// metadata then say under `fields_omitted` how many fields are missing.
    fn from(refusal: Rejected) -> Self {
        let refusal = refusal.shortened();
        let details = refusal.to_bytes();
        Status::with_details(refusal.reason.code(), refusal.message, details.into())
    }
}

impl fmt::Display for Rejected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.reason, self.message)
    }
}

impl Error for Rejected {}

impl FieldViolation {
    /// A field at fault.
    pub fn new(field: impl Into<String>, reason: Reason, description: impl Into<String>) -> Self {
        Self { field: field.into(), reason, description: description.into() }
    }

    fn to_wire(&self) -> bad_request::FieldViolation {
        bad_request::FieldViolation {
            field: self.field.clone(),
            description: self.description.clone(),
            reason: self.reason.name().to_owned(),
            localized_message: None,
        }
    }
}

/// Any status in the form of [`Rejected::to_json`]. Where it carries no reason, as when the network failed or
/// another program answered, `reason` is empty.
pub fn status_json(status: &Status) -> Value {
    let details = Details::decode(status.details()).unwrap_or_default();
    let info = details.info.unwrap_or_default();
    let fields =
        details.fields.iter().map(|wire| field_json(&wire.field, &wire.reason, &wire.description)).collect();
    error_json(status.code(), &info.reason, status.message(), fields, &info.metadata)
}

/// The status of a call that never reached its server: UNAVAILABLE, with every cause in the message.
///
/// For errors of connecting, which are no status yet.
pub fn unreachable(error: &(dyn Error + 'static)) -> Status {
    let mut message = error.to_string();
    let mut source = error.source();
    while let Some(cause) = source {
        // Writing to a string does not fail.
        let _ = write!(message, ": {cause}");
        source = cause.source();
    }
    Status::unavailable(message)
}

/// The name of a status code in UPPER_SNAKE, as the gRPC specification writes it.
#[must_use]
pub const fn code_name(code: Code) -> &'static str {
    match code {
        Code::Ok => "OK",
        Code::Cancelled => "CANCELLED",
        Code::Unknown => "UNKNOWN",
        Code::InvalidArgument => "INVALID_ARGUMENT",
        Code::DeadlineExceeded => "DEADLINE_EXCEEDED",
        Code::NotFound => "NOT_FOUND",
        Code::AlreadyExists => "ALREADY_EXISTS",
        Code::PermissionDenied => "PERMISSION_DENIED",
        Code::ResourceExhausted => "RESOURCE_EXHAUSTED",
        Code::FailedPrecondition => "FAILED_PRECONDITION",
        Code::Aborted => "ABORTED",
        Code::OutOfRange => "OUT_OF_RANGE",
        Code::Unimplemented => "UNIMPLEMENTED",
        Code::Internal => "INTERNAL",
        Code::Unavailable => "UNAVAILABLE",
        Code::DataLoss => "DATA_LOSS",
        Code::Unauthenticated => "UNAUTHENTICATED",
    }
}

fn field_json(field: &str, reason: &str, description: &str) -> Value {
    json!({ "field": field, "reason": reason, "description": description })
}

fn error_json(
    code: Code,
    reason: &str,
    message: &str,
    fields: Vec<Value>,
    metadata: &BTreeMap<String, String>,
) -> Value {
    json!({
        "error": {
            "code": code_name(code),
            "reason": reason,
            "message": message,
            "fields": fields,
            "metadata": metadata,
        }
    })
}

const ERROR_INFO: &str = "type.googleapis.com/google.rpc.ErrorInfo";
const RETRY_INFO: &str = "type.googleapis.com/google.rpc.RetryInfo";
const BAD_REQUEST: &str = "type.googleapis.com/google.rpc.BadRequest";

/// `google.rpc.ErrorInfo`, with metadata in the order of their keys: the same refusal has the same bytes.
#[derive(Clone, PartialEq, Message)]
struct ErrorInfo {
    #[prost(string, tag = "1")]
    reason: String,
    #[prost(string, tag = "2")]
    domain: String,
    #[prost(btree_map = "string, string", tag = "3")]
    metadata: BTreeMap<String, String>,
}

impl ErrorInfo {
    fn into_any(self) -> Any {
        any(ERROR_INFO, &self)
    }
}

fn any(type_url: &str, message: &impl Message) -> Any {
    Any { type_url: type_url.to_owned(), value: message.encode_to_vec() }
}

/// What a `google.rpc.Status` says, of the details that are ours to read.
#[derive(Default)]
struct Details {
    message: String,
    info: Option<ErrorInfo>,
    fields: Vec<bad_request::FieldViolation>,
}

impl Details {
    fn decode(bytes: &[u8]) -> Option<Self> {
        let RpcStatus { code: _, message, details } = RpcStatus::decode(bytes).ok()?;
        let mut this = Self { message, ..Self::default() };
        for detail in details {
            let bytes = detail.value.as_slice();
            match detail.type_url.as_str() {
                ERROR_INFO => this.info = Some(ErrorInfo::decode(bytes).ok()?),
                BAD_REQUEST => this.fields.extend(BadRequest::decode(bytes).ok()?.field_violations),
                // What other programs on the way add is theirs.
                _ => {}
            }
        }
        Some(this)
    }
}
