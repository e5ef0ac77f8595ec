//! Streams as server-sent events: `data` is a WatchStreamResponse in proto3 JSON, and an event `refused` says why a stream is
//! not shown. One connection carries as many streams as it names, since a browser has six for a server.

use std::convert::Infallible;
use std::time::Duration;

use proto::stream::{Watch, Watched};
use proto::{Reason, Rejected, pb};
use serving::axum::body::{Body, Bytes};
use serving::axum::extract::{RawQuery, State};
use serving::axum::http::header;
use serving::axum::response::{IntoResponse as _, Response};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tokio_stream::{Stream, StreamExt as _};
use tonic::Status;

use super::{Console, api};
use crate::watch::{Visitor, watch_all, watch_stream};

/// Streams that one connection shows.
const MOST_STREAMS: usize = 64;
/// Messages that wait for a slow browser, of each stream.
const AHEAD: usize = 4;
/// How long a connection is silent before it is asked whether it is still there.
const SILENCE: Duration = Duration::from_secs(5);

/// `?stream=NAME&stream=…&periodMs=50&maxPoints=200`; without a name, summaries of all.
pub(super) async fn watch(State(console): State<Console>, RawQuery(query): RawQuery) -> Response {
    let (names, watch) = match asked(query.as_deref().unwrap_or_default()) {
        Ok(asked) => asked,
        Err(rejected) => return events(tokio_stream::once(refused(rejected))),
    };
    if let Err(rejected) = console.caller.may_call("motion.v1.SetpointService/WatchStream") {
        return events(tokio_stream::once(refused(rejected)));
    }
    let Console { board, leaving, caller, .. } = console;
    let (sender, receiver) = mpsc::channel(AHEAD * names.len().max(4));
    if names.is_empty() {
        tokio::spawn(watch_all(board, watch, Visitor { caller, outgoing: sender, leaving }));
    } else {
        let visitor = Visitor { caller, outgoing: sender, leaving };
        for name in names {
            let watch = Watch { stream: Some(name), ..watch.clone() };
            tokio::spawn(watch_stream(board.clone(), watch, visitor.clone()));
        }
    }
    let told = ReceiverStream::new(receiver).map(|shown| match shown {
        Ok(watched) => message(watched),
        Err(rejected) => refused(rejected),
    });
    // A comment, which also finds out that nobody reads any more.
    events(
        told.timeout_repeating(tokio::time::interval(SILENCE))
            .map(|told| told.unwrap_or_else(|_| ":\n\n".to_owned())),
    )
}

/// What the query says, by the rules of the message.
fn asked(query: &str) -> Result<(Vec<String>, Watch), Rejected> {
    let mut names = Vec::new();
    let mut wire = pb::WatchStreamRequest::default();
    for (key, value) in form_urlencoded::parse(query.as_bytes()) {
        let number = || {
            value.parse::<u32>().map_err(|_| {
                Rejected::for_field(
                    key.to_string(),
                    Reason::ValueOutOfRange,
                    format!("is {value:?}: give a whole number"),
                )
            })
        };
        match key.as_ref() {
            "stream" => names.push(value.into_owned()),
            "periodMs" => {
                let ms = number()?;
                let (seconds, nanos) = (i64::from(ms / 1000), (ms % 1000 * 1_000_000) as i32);
                wire.period = Some(proto::Duration { seconds, nanos });
            }
            "maxPoints" => wire.max_points = number()?,
            _ => {
                let text = "is not known: give stream, periodMs and maxPoints";
                return Err(Rejected::for_field(key.to_string(), Reason::MessageInvalid, text));
            }
        }
    }
    if names.len() > MOST_STREAMS {
        let text = format!("{} streams: one connection shows {MOST_STREAMS}", names.len());
        return Err(Rejected::new(Reason::TooManyStreams, text));
    }
    Ok((names, Watch::try_from(wire)?))
}

fn message(watched: Watched) -> String {
    match proto::to_json(&pb::WatchStreamResponse::from(watched)) {
        Ok(json) => format!("data: {json}\n\n"),
        Err(error) => format!(": {error}\n\n"),
    }
}

fn refused(rejected: Rejected) -> String {
    format!("event: refused\ndata: {}\n\n", api::refusal(&Status::from(rejected)))
}

fn events(told: impl Stream<Item = String> + Send + 'static) -> Response {
    let headers = [(header::CONTENT_TYPE, "text/event-stream"), (header::CACHE_CONTROL, "no-store")];
    let body = Body::from_stream(told.map(|event| Ok::<_, Infallible>(Bytes::from(event))));
    (headers, body).into_response()
}
