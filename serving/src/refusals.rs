//! Refusals of what no service gets to see. A message that is too large is refused here, in both directions, before it is
//! buffered or sent, and one that does not come is not waited for; and a status that the transport makes by itself gets the reason that goes with it. So no caller ever
//! has to read a text to know what to do.

use std::pin::Pin;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use http_body::Frame;
use proto::{Reason, Rejected};
use tonic::body::Body;
use tonic::codegen::{Bytes, http};
use tonic::{Code, Status};

use crate::connections::Patience;
use crate::told::Refusals;

/// What a message may be, and how long it may take to come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Measure {
    /// Its size \[bytes\].
    pub(crate) most_bytes: usize,
    /// From the call to its first message.
    pub(crate) first: Option<Duration>,
    /// From one message of a stream to the next.
    pub(crate) idle: Option<Duration>,
}

/// The request, whose messages are neither too large nor too late.
pub(crate) fn of_request(request: http::Request<Body>, measure: Measure) -> http::Request<Body> {
    request.map(|body| Body::new(Metered::new(body, measure, Direction::Request, None)))
}

/// The response, whose messages are not too large, and which is no refusal without a reason; refusals are counted.
pub(crate) fn of_response(
    mut response: http::Response<Body>,
    measure: Measure,
    refusals: &Refusals,
) -> http::Response<Body> {
    let status = Status::from_header_map(response.headers());
    if let Some(rejected) = status.as_ref().and_then(reasoned) {
        // Only a message that cannot be written in a header fails, and then the answer stays as it was.
        let _ = Status::from(rejected).add_header(response.headers_mut());
    }
    count(refusals, response.headers());
    let refusals = refusals.clone();
    response.map(|body| Body::new(Metered::new(body, measure, Direction::Response, Some(refusals))))
}

/// Counts the refusal that headers or trailers carry.
fn count(refusals: &Refusals, headers: &http::HeaderMap) {
    if !headers.contains_key("grpc-status-details-bin") {
        return;
    }
    let rejected = Status::from_header_map(headers).and_then(|status| Rejected::from_status(&status));
    if let Some(rejected) = rejected {
        refusals.count(rejected.reason);
    }
}

/// What a status says that the transport has made of bytes that it cannot decode: no service answers so. A method that is
/// not served stays what gRPC says of it.
fn reasoned(status: &Status) -> Option<Rejected> {
    let is_bare = status.code() == Code::Internal && status.details().is_empty();
    is_bare.then(|| {
        let text = format!("the message cannot be read: {}; compare with the schema", status.message());
        Rejected::new(Reason::MessageInvalid, text)
    })
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    Request,
    Response,
}

/// A body whose messages are measured as they pass. One that is too large, or does not come, ends a request with an error,
/// which its reader answers with, and a response with the trailers that say why.
struct Metered {
    inner: Body,
    meter: Meter,
    measure: Measure,
    patience: Patience,
    has_begun: bool,
    direction: Direction,
    /// Where refusals are counted that end a response.
    refusals: Option<Refusals>,
    /// Ends the body, once what came before it has passed.
    refusal: Option<Status>,
    is_over: bool,
}

impl Metered {
    fn new(inner: Body, measure: Measure, direction: Direction, refusals: Option<Refusals>) -> Self {
        Self {
            inner,
            meter: Meter::new(measure.most_bytes),
            measure,
            patience: Patience::default(),
            has_begun: false,
            direction,
            refusals,
            refusal: None,
            is_over: false,
        }
    }

    /// Nothing has come of a request: is that for too long?
    fn poll_late(&mut self, cx: &mut Context<'_>) -> Poll<Status> {
        if self.direction == Direction::Response {
            return Poll::Pending;
        }
        let (has_begun, Measure { first, idle, .. }) = (self.has_begun, self.measure);
        let after = if has_begun { idle } else { first };
        self.patience.poll_over(cx, after).map(|()| too_late(has_begun, after.unwrap_or_default()))
    }

    fn end(&mut self, refusal: Status) -> Option<Result<Frame<Bytes>, Status>> {
        self.is_over = true;
        self.inner = Body::empty();
        if self.direction == Direction::Request {
            return Some(Err(refusal));
        }
        let mut trailers = http::HeaderMap::new();
        if let (Some(refusals), Some(rejected)) = (&self.refusals, Rejected::from_status(&refusal)) {
            refusals.count(rejected.reason);
        }
        Some(refusal.add_header(&mut trailers).map(|()| Frame::trailers(trailers)))
    }
}

impl http_body::Body for Metered {
    type Data = Bytes;
    type Error = Status;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Status>>> {
        if self.is_over {
            return Poll::Ready(None);
        }
        if let Some(refusal) = self.refusal.take() {
            return Poll::Ready(self.end(refusal));
        }
        let frame = match Pin::new(&mut self.inner).poll_frame(cx) {
            Poll::Ready(Some(Ok(frame))) => frame,
            Poll::Pending => {
                let late = ready!(self.poll_late(cx));
                return Poll::Ready(self.end(late));
            }
            over @ Poll::Ready(_) => return over,
        };
        self.patience.again();
        self.has_begun = true;
        if let (Some(refusals), Some(trailers)) = (&self.refusals, frame.trailers_ref()) {
            count(refusals, trailers);
        }
        let Some(TooLarge { at, bytes }) = frame.data_ref().and_then(|data| self.meter.pass(data)) else {
            return Poll::Ready(Some(Ok(frame)));
        };
        let refusal = too_large(self.direction, bytes, self.meter.most);
        match frame.into_data() {
            Ok(data) if at > 0 => {
                self.refusal = Some(refusal);
                Poll::Ready(Some(Ok(Frame::data(data.slice(..at)))))
            }
            _ => Poll::Ready(self.end(refusal)),
        }
    }

    fn is_end_stream(&self) -> bool {
        self.is_over || (self.refusal.is_none() && self.inner.is_end_stream())
    }
}

fn too_late(has_begun: bool, after: Duration) -> Status {
    let seconds = after.as_secs_f64();
    let rejected = if has_begun {
        let text = format!(
            "nothing was said on this stream for {seconds} s: report at least every batch, or raise the server's \
             idle_deadline, and open again"
        );
        Rejected::new(Reason::StreamIdle, text)
    } else {
        let text = format!(
            "the first message did not come within {seconds} s: send it with the call, or raise the server's \
             first_message_deadline"
        );
        Rejected::new(Reason::FirstMessageLate, text)
    };
    rejected.with("allowed", seconds).into()
}

fn too_large(direction: Direction, given: usize, allowed: usize) -> Status {
    let text = match direction {
        Direction::Request => format!(
            "the message has {given} bytes, and this server reads at most {allowed}: split the request, or raise the \
             server's max_message_bytes"
        ),
        Direction::Response => format!(
            "the answer has {given} bytes, and this server sends at most {allowed}: ask for less at a time, or raise \
             the server's max_message_bytes"
        ),
    };
    Rejected::new(Reason::MessageTooLarge, text).with("given", given).with("allowed", allowed).into()
}

/// Reads the lengths in a stream of gRPC messages, however it is cut into pieces. Source: "gRPC over HTTP2",
/// Length-Prefixed-Message: a flag of one byte, the length as four, big-endian, and the message.
#[derive(Debug)]
struct Meter {
    most: usize,
    prefix: [u8; PREFIX],
    /// Bytes of the prefix that have passed.
    seen: usize,
    /// Bytes of the message that have yet to pass.
    left: usize,
}

/// A message that is not to pass.
#[derive(Debug, PartialEq, Eq)]
struct TooLarge {
    /// Where in the piece its prefix begins, or 0 where that has begun before.
    at: usize,
    /// Its length.
    bytes: usize,
}

const PREFIX: usize = 5;

impl Meter {
    fn new(most: usize) -> Self {
        Self { most, prefix: [0; PREFIX], seen: 0, left: 0 }
    }

    /// Lets a piece pass, up to a message that is too large.
    fn pass(&mut self, piece: &[u8]) -> Option<TooLarge> {
        let mut rest = piece;
        loop {
            let passes = self.left.min(rest.len());
            self.left -= passes;
            rest = &rest[passes..];
            if rest.is_empty() {
                return None;
            }
            let at = piece.len() - rest.len();
            let taken = (PREFIX - self.seen).min(rest.len());
            self.prefix[self.seen..self.seen + taken].copy_from_slice(&rest[..taken]);
            self.seen += taken;
            rest = &rest[taken..];
            if self.seen < PREFIX {
                return None;
            }
            self.seen = 0;
            let [_, length @ ..] = self.prefix;
            let bytes = u32::from_be_bytes(length) as usize;
            if bytes > self.most {
                return Some(TooLarge { at, bytes });
            }
            self.left = bytes;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn message(bytes: usize) -> Vec<u8> {
        let mut message = vec![0; PREFIX + bytes];
        message[1..PREFIX].copy_from_slice(&(bytes as u32).to_be_bytes());
        // What stands in a message is not a length.
        message[PREFIX..].fill(0xff);
        message
    }

    proptest! {
        #[test]
        fn the_first_message_that_is_too_large_is_found_however_the_stream_is_cut(
            sizes in proptest::collection::vec(0_usize..40, 0..12),
            cuts in proptest::collection::vec(1_usize..50, 1..40),
            most in 0_usize..40,
        ) {
            let stream: Vec<u8> = sizes.iter().flat_map(|size| message(*size)).collect();
            let expected = sizes.iter().position(|size| *size > most);
            let mut meter = Meter::new(most);
            let (mut rest, mut passed, mut found) = (stream.as_slice(), 0, None);
            for cut in cuts.iter().cycle() {
                let (piece, after) = rest.split_at((*cut).min(rest.len()));
                rest = after;
                match meter.pass(piece) {
                    None => passed += piece.len(),
                    Some(TooLarge { at, bytes }) => {
                        found = Some(bytes);
                        passed += at;
                        break;
                    }
                }
                if rest.is_empty() {
                    break;
                }
            }
            prop_assert_eq!(found, expected.map(|index| sizes[index]));
            let before: usize = sizes[..expected.unwrap_or(sizes.len())].iter().map(|size| PREFIX + size).sum();
            // A prefix that is cut has begun to pass before its length is known.
            prop_assert!(passed >= before && passed < before + PREFIX, "{passed} of {before}");
        }
    }

    #[test]
    fn a_status_without_a_reason_gets_the_one_that_goes_with_it() {
        let rows = [
            (Status::internal("failed to decode Protobuf message"), Some(Reason::MessageInvalid)),
            (Status::unimplemented(""), None),
            (Status::with_details(Code::Internal, "", tonic::codegen::Bytes::from_static(b"x")), None),
            (Status::ok(""), None),
            (Status::not_found("no such service"), None),
            (Rejected::new(Reason::NotImplemented, "later").into(), None),
        ];
        for (status, reason) in rows {
            assert_eq!(reasoned(&status).map(|rejected| rejected.reason), reason, "{status:?}");
        }
    }
}
