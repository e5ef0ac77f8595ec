//! What is read: files and standard input, and the messages in them. Beside `show/json` the only place of this tool
//! that names wire types.

mod comments;
mod points;

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead as _, BufReader, Read};
use std::path::Path;

use planner::{InvalidFields, Plan, PvtRequestSpec, RequestSpec};
use proto::stream::Ask;
use proto::{Against, JsonError, Reason, Rejected, pb};
use sim_axis::AxisModel;

use crate::failure::Failure;
pub(crate) use points::{PointTable, cells, number};

/// The longest line that is taken [bytes]: a request of 64 axes has about 20 kB, one of 10 000 points of six axes 4 MB.
const LONGEST_LINE: usize = 8 << 20;

/// What some editors begin a file of UTF-8 with.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// The request in a file.
pub(crate) fn request(path: &Path) -> Result<RequestSpec, Failure> {
    let request = proto::from_json::<pb::PlanRequest>(&text(path)?).map_err(not_a("PlanRequest", path))?;
    Ok(request.into())
}

/// The request for points in a file.
pub(crate) fn pvt_request(path: &Path) -> Result<PvtRequestSpec, Failure> {
    let request =
        proto::from_json::<pb::PlanPvtRequest>(&text(path)?).map_err(not_a("PlanPvtRequest", path))?;
    Ok(request.into())
}

/// The goals in a file.
pub(crate) fn retarget(path: &Path) -> Result<Ask, Failure> {
    let retarget = proto::from_json::<pb::Retarget>(&text(path)?).map_err(not_a("Retarget", path))?;
    Ok(pb::operation::Operation::Retarget(retarget).into())
}

/// The plan in a file, from a Plan, a PlanResponse or a PlanPvtResponse.
pub(crate) fn plan(path: &Path) -> Result<Plan, Failure> {
    proto::plan_from_wire(wire_plan(path)?).map_err(Failure::refused)
}

/// As [`plan`], with what the plan says of itself and is not beside it.
pub(crate) fn plan_as_it_is(path: &Path) -> Result<(Plan, InvalidFields), Failure> {
    proto::plan_as_it_is(wire_plan(path)?).map_err(Failure::refused)
}

fn wire_plan(path: &Path) -> Result<pb::Plan, Failure> {
    let text = text(path)?;
    let keys: serde_json::Value = serde_json::from_str(&text).unwrap_or_default();
    let plan = if keys.get("plan").is_none() {
        return proto::from_json::<pb::Plan>(&text).map_err(not_a("Plan", path));
    } else if keys.get("points").is_some() {
        let response = proto::from_json::<pb::PlanPvtResponse>(&text);
        response.map_err(not_a("PlanPvtResponse", path))?.plan
    } else {
        proto::from_json::<pb::PlanResponse>(&text).map_err(not_a("PlanResponse", path))?.plan
    };
    Ok(plan.unwrap_or_default())
}

/// The axis that a file describes: the first, where there are several.
pub(crate) fn axis_model(path: &Path) -> Result<AxisModel, Failure> {
    let not_a_model = |cause| Failure::NotAModel { path: path.to_owned(), cause };
    let models = sim_axis::models_from_json(&text(path)?).map_err(not_a_model)?;
    // Where none is there, the one of all axes without a name.
    Ok(models.iter().next().cloned().unwrap_or_else(|| models.of("")))
}

/// What a plan is to be held against, from the axes of a request.
pub(crate) fn against(path: &Path) -> Result<Vec<Against>, Failure> {
    let request = proto::from_json::<pb::PlanRequest>(&text(path)?).map_err(not_a("PlanRequest", path))?;
    Ok(request.axes.into_iter().map(Into::into).collect())
}

/// The requests of a file, line by line.
pub(crate) struct Lines {
    reader: BufReader<Box<dyn Read>>,
    /// Of the line that was read last, from 1.
    number: u64,
}

/// One line that is not empty.
pub(crate) struct Line {
    number: u64,
    text: Text,
}

enum Text {
    Bytes(Vec<u8>),
    TooLong,
}

impl Lines {
    pub(crate) fn open(path: &Path) -> Result<Self, Failure> {
        let reader: Box<dyn Read> = if path.as_os_str() == "-" {
            Box::new(io::stdin().lock())
        } else {
            Box::new(File::open(path).map_err(Failure::unreadable(path))?)
        };
        Ok(Self { reader: BufReader::with_capacity(1 << 18, reader), number: 0 })
    }

    /// The next lines: at least one unless the input has ended, and at most `most`; does not wait for the second.
    pub(crate) fn next(&mut self, most: usize) -> io::Result<Vec<Line>> {
        let mut lines = Vec::new();
        while lines.len() < most {
            let Some(line) = self.line()? else { break };
            let is_blank = |bytes: &[u8]| bytes.is_empty() || bytes.starts_with(b"//");
            let blank = matches!(&line.text, Text::Bytes(bytes) if is_blank(bytes.trim_ascii()));
            if !blank {
                lines.push(line);
            }
            let another_is_here = self.reader.buffer().contains(&b'\n');
            if !lines.is_empty() && !another_is_here {
                break;
            }
        }
        Ok(lines)
    }

    fn line(&mut self) -> io::Result<Option<Line>> {
        let mut bytes = Vec::new();
        if self.reader.by_ref().take(LONGEST_LINE as u64).read_until(b'\n', &mut bytes)? == 0 {
            return Ok(None);
        }
        self.number += 1;
        let number = self.number;
        if number == 1 && bytes.starts_with(BYTE_ORDER_MARK) {
            bytes.drain(..BYTE_ORDER_MARK.len());
        }
        if bytes.len() < LONGEST_LINE || bytes.ends_with(b"\n") {
            return Ok(Some(Line { number, text: Text::Bytes(bytes) }));
        }
        self.reader.skip_until(b'\n')?;
        Ok(Some(Line { number, text: Text::TooLong }))
    }
}

impl Line {
    /// The move that the line asks for, or why it asks for none.
    pub(crate) fn request(&self) -> Result<RequestSpec, Rejected> {
        self.message("PlanRequest", proto::from_json::<pb::PlanRequest>).map(Into::into)
    }

    /// The motion through points that the line asks for, or why it asks for none.
    pub(crate) fn pvt_request(&self) -> Result<PvtRequestSpec, Rejected> {
        self.message("PlanPvtRequest", proto::from_json::<pb::PlanPvtRequest>).map(Into::into)
    }

    fn message<T>(&self, name: &str, read: fn(&str) -> Result<T, JsonError>) -> Result<T, Rejected> {
        let bytes = match &self.text {
            Text::Bytes(bytes) => bytes,
            Text::TooLong => {
                let message =
                    format!("line {} is longer than {LONGEST_LINE} bytes: split the request", self.number);
                return Err(self.refusal(Reason::MessageTooLarge, message));
            }
        };
        let text = str::from_utf8(bytes).map_err(|error| {
            let message = format!(
                "line {}, byte {} is not UTF-8: write JSON in UTF-8",
                self.number,
                error.valid_up_to() + 1
            );
            self.refusal(Reason::MessageInvalid, message)
        })?;
        let text = without_comments(text);
        read(&text).map_err(|error| self.unreadable(&text, &error, name))
    }

    /// A number that JSON cannot carry has a reason of its own.
    fn unreadable(&self, text: &str, error: &JsonError, expected: &str) -> Rejected {
        let (column, cause) = match error {
            JsonError::Read { column, cause, .. } => (*column, cause.as_str()),
            JsonError::Write { cause } => (1, cause.as_str()),
        };
        let number = self.number;
        let from = text.floor_char_boundary(column.saturating_sub(1));
        let word = text[from..].trim_start();
        let not_finite = ["NaN", "-NaN", "Infinity", "-Infinity", "nan", "inf"];
        let beyond = cause.contains("number out of range")
            || text[..from].ends_with('-') && word.starts_with("Infinity");
        let (reason, way_out) = if beyond || not_finite.iter().any(|name| word.starts_with(name)) {
            (Reason::NotFinite, "give finite numbers".to_owned())
        } else {
            (Reason::MessageInvalid, format!("give one {expected} in proto3 JSON a line"))
        };
        self.refusal(reason, format!("line {number}, column {column}: {cause}: {way_out}"))
    }

    fn refusal(&self, reason: Reason, message: String) -> Rejected {
        Rejected::new(reason, message).with("line", self.number)
    }
}

fn text(path: &Path) -> Result<String, Failure> {
    let read =
        if path.as_os_str() == "-" { io::read_to_string(io::stdin()) } else { std::fs::read_to_string(path) };
    let text = read.map_err(Failure::unreadable(path))?;
    // Some editors begin a file with a mark of its encoding, which is no part of the text.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    Ok(without_comments(text).into_owned())
}

/// The JSON in a text, with blanks for comments.
pub(crate) fn without_comments(text: &str) -> Cow<'_, str> {
    comments::without_comments(text)
}

fn not_a(expected: &'static str, path: &Path) -> impl FnOnce(JsonError) -> Failure {
    move |cause| Failure::NotAMessage { path: path.to_owned(), expected, cause: in_words(cause) }
}

/// What the reader of JSON says of a text that is none, for whoever does not know its terms.
fn in_words(error: JsonError) -> JsonError {
    let JsonError::Read { line, column, cause } = error else { return error };
    let cause = match cause.as_str() {
        "EOF while parsing a value" if (line, column) == (1, 0) => "there is nothing in it".to_owned(),
        cause if cause.starts_with("EOF") => format!("it ends before the JSON does ({cause})"),
        "expected ident" | "expected value" | "key must be a string" => {
            format!("this is not how JSON goes on ({cause})")
        }
        "trailing characters" => "the JSON has ended before this: give one message".to_owned(),
        _ => cause,
    };
    JsonError::Read { line, column, cause }
}
