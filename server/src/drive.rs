//! The loop between the world and a session: turns messages into events and outputs into sends, and decides nothing.

use std::collections::HashMap;
use std::pin::Pin;

use futures_util::StreamExt as _;
use futures_util::stream::FuturesUnordered;
use proto::stream::{FromAxis, Open, OperationResult, Phase, ToAxis};
use proto::{Reason, Rejected, pb, request_from_wire, response_to_wire};
use serving::Leaving;
use tokio::sync::{mpsc, oneshot};
use tonic::{Status, Streaming};

use crate::rpc;
use crate::session::{Answer, Event, Output, Session};
use crate::streams::{Claim, Command, Streams, Superseded};
use crate::watch::{Board, Tap};

type Incoming = Streaming<pb::StreamSetpointsRequest>;
type Told = Result<pb::StreamSetpointsResponse, Status>;
type Outgoing = mpsc::Sender<Told>;
type Permit<'a> = mpsc::Permit<'a, Told>;

/// Serves one stream from its first message to its end.
#[tracing::instrument(name = "session", skip_all, fields(stream = tracing::field::Empty, epoch = tracing::field::Empty))]
pub(crate) async fn drive(
    mut incoming: Incoming,
    outgoing: Outgoing,
    (streams, board): (Streams, Board),
    served_by: String,
    leaving: Leaving,
) {
    let opened = match first_message(&mut incoming).await {
        Ok(open) => begin(open, &streams, &board, &served_by),
        Err(rejected) => Err(rejected),
    };
    match opened {
        Ok((session, (claim, superseded), tap, epoch)) => {
            let turns = turns(superseded, &leaving);
            serve(session, claim, tap, epoch, (incoming, turns), outgoing).await
        }
        // Nobody to tell is not a failure.
        Err(rejected) => {
            tracing::info!(reason = %rejected.reason, "stream refused");
            let _ = outgoing.send(Err(rejected.into())).await;
        }
    }
}

async fn first_message(incoming: &mut Incoming) -> Result<Open, Rejected> {
    match next_event(incoming).await {
        Event::FromAxis(FromAxis::Open(open)) => Ok(*open),
        Event::Unreadable(rejected) => Err(rejected),
        _ => {
            let text = "the first message is not open: open the stream before anything else";
            Err(Rejected::new(Reason::ProtocolOrder, text))
        }
    }
}

fn begin(
    open: Open,
    streams: &Streams,
    board: &Board,
    served_by: &str,
) -> Result<(Session, (Claim, Superseded), Tap, u64), Rejected> {
    let (stream, epoch, executed) = (open.stream.clone(), open.epoch, open.executed_cycle);
    tracing::Span::current().record("stream", stream.as_str()).record("epoch", epoch);
    streams.admit(&open)?;
    // The session first: an open that is refused takes the stream from nobody.
    let session = Session::open(open, served_by)?;
    let claim = streams.claim(stream.clone(), epoch)?;
    let tap = board.open(stream, epoch, executed, session.motion());
    tracing::info!("stream opened");
    Ok((session, claim, tap, epoch))
}

async fn serve(
    mut session: Session,
    mut claim: Claim,
    mut tap: Tap,
    epoch: u64,
    (mut incoming, mut turns): (Incoming, Turns),
    outgoing: Outgoing,
) {
    let mut commanders = Commanders::default();
    while !session.is_over() {
        tokio::select! {
            // Reports first: what an axis has just said decides what it is sent.
            biased;
            Some(turn) = turns.next() => turn.into_iter().for_each(|event| session.handle(event)),
            mut event = next_event(&mut incoming), if !session.is_ending() && !session.is_full() => {
                let glance = tap.before(&session, &mut event);
                session.handle(event);
                tap.after(&session, glance);
            }
            wanted = tap.wanted() => session.handle(Event::Watched(wanted)),
            Some(command) = claim.commands.recv() => {
                let mut event = commanders.admit(command);
                tap.before(&session, &mut event);
                session.handle(event);
            }
            permit = outgoing.reserve(), if session.has_output() => {
                let Ok(permit) = permit else { return };
                send(&mut session, &tap, epoch, permit);
            }
        }
        while let Some(answer) = session.poll_answer() {
            commanders.tell(answer);
        }
    }
    claim.finished = session.phase() == Phase::Finished;
    tracing::info!(phase = ?session.phase(), "stream closed");
}

/// What happens to a stream once, if at all. It is looked at when it happens, and not with every message.
type Turns = FuturesUnordered<Pin<Box<dyn Future<Output = Option<Event>> + Send>>>;

fn turns(superseded: Superseded, leaving: &Leaving) -> Turns {
    let (soon, now) = (leaving.clone(), leaving.clone());
    let superseded = async { superseded.await.ok().map(|by| Event::Superseded { by }) };
    let drained = async move {
        soon.begun().await;
        Some(Event::Drain)
    };
    let left = async move {
        now.due().await;
        Some(Event::Leave)
    };
    let turns = Turns::new();
    turns.push(Box::pin(superseded));
    turns.push(Box::pin(drained));
    turns.push(Box::pin(left));
    turns
}

/// Sends what the session has to say next.
fn send(session: &mut Session, tap: &Tap, epoch: u64, permit: Permit<'_>) {
    match session.poll_output() {
        Some(Output::Send(message)) => {
            tap.said(&message);
            if let ToAxis::Result(result) = &message {
                tell_done(result);
            }
            permit.send(Ok(response_to_wire(epoch, message)));
        }
        Some(Output::End(Err(rejected))) => {
            tracing::info!(reason = %rejected.reason, "stream ended");
            permit.send(Err(rejected.into()));
        }
        Some(Output::End(Ok(()))) | None => {}
    }
}

/// Says which operation the axis plays by now, for whoever asks later why it moved as it did.
fn tell_done(result: &OperationResult) {
    let OperationResult { request_id, effective_cycle, revision, .. } = result;
    tracing::info!(request = request_id.as_str(), effective_cycle, revision, "operation done");
}

/// Those who wait to hear what became of their operation.
#[derive(Debug, Default)]
struct Commanders {
    waiting: HashMap<u64, oneshot::Sender<Result<OperationResult, Rejected>>>,
    tickets: u64,
}

impl Commanders {
    fn admit(&mut self, command: Command) -> Event {
        let Command { operation, answer } = command;
        self.tickets += 1;
        self.waiting.insert(self.tickets, answer);
        Event::Command { ticket: self.tickets, operation }
    }

    fn tell(&mut self, answer: Answer) {
        let Answer { ticket, result } = answer;
        if let Ok(result) = &result {
            tell_done(result);
        }
        if let Some(commander) = self.waiting.remove(&ticket) {
            // Who does not wait any more may ask again.
            let _ = commander.send(result);
        }
    }
}

/// What the axis says next. An axis that is gone, and one that cannot be read, both end the session.
async fn next_event(incoming: &mut Incoming) -> Event {
    match incoming.message().await {
        Ok(Some(wire)) => match request_from_wire(wire) {
            Ok(message) => Event::FromAxis(message),
            Err(rejected) => Event::Unreadable(rejected),
        },
        Ok(None) => Event::AxisClosed,
        Err(status) => Event::Unreadable(rpc::unreadable(&status)),
    }
}
