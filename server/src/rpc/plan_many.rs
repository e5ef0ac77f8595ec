//! `PlanMany`: message after message of requests or of columns, each answered as a whole, in its turn.

use std::time::Instant;

use proto::{Detail, Moves, Outcomes, Reason, Rejected, outgoing, pb};
use serving::{Leaving, Refusals};
use tokio::sync::mpsc;
use tonic::{Status, Streaming};

use super::planner::judged;
use super::{Aside, unreadable};
use crate::figures::Figures;
use crate::limits::Limits;

/// Answers made ahead of a slow reader: one goes out while the next is made.
const AHEAD: usize = 2;

/// From this many axes on, a message takes longer to answer than the streams of this process may wait: about half a
/// millisecond.
const LONG: usize = 64;

/// The same of moves in columns, which are numbers: about half a microsecond each.
const LONG_COLUMNS: usize = 1024;

/// After so many moves it is asked again whether anybody still waits for them.
const ASKS_AFTER: usize = 256;

type Incoming = Streaming<pb::PlanManyRequest>;
type Outgoing = mpsc::Sender<Result<outgoing::PlanManyResponse, Status>>;
pub(super) type Answers = mpsc::Receiver<Result<outgoing::PlanManyResponse, Status>>;

/// What planning many needs.
#[derive(Clone, Debug)]
pub(super) struct Many {
    pub(super) limits: Limits,
    /// The largest answer \[bytes\].
    pub(super) most_bytes: usize,
    pub(super) figures: Figures,
    pub(super) refusals: Refusals,
    pub(super) aside: Aside,
    pub(super) leaving: Leaving,
}

impl Many {
    /// Answers what comes in until it ends, in a task that the process waits for.
    pub(super) fn begin(self, incoming: Incoming) -> Answers {
        let (outgoing, outcomes) = mpsc::channel(AHEAD);
        let leaving = self.leaving.clone();
        leaving.spawn(self.serve(incoming, outgoing));
        outcomes
    }

    async fn serve(self, mut incoming: Incoming, outgoing: Outgoing) {
        loop {
            let message = tokio::select! {
                biased;
                () = self.leaving.begun() => Err(draining()),
                () = outgoing.closed() => return,
                message = incoming.message() => message.map_err(|status| unreadable(&status)),
            };
            let answer = match message {
                Ok(Some(message)) => self.answer(message, &outgoing).await,
                Ok(None) => return,
                Err(rejected) => Err(rejected.into()),
            };
            let is_over = answer.is_err();
            if outgoing.send(answer).await.is_err() || is_over {
                return;
            }
        }
    }

    async fn answer(
        &self,
        message: pb::PlanManyRequest,
        outgoing: &Outgoing,
    ) -> Result<outgoing::PlanManyResponse, Status> {
        let pb::PlanManyRequest { requests, detail, columns } = message;
        self.limits.admit_plans("requests", requests.len())?;
        let detail = Detail::from_wire(detail).map_err(Rejected::from)?;
        if let Some(columns) = columns {
            return self.columns(&requests, columns, detail, outgoing).await;
        }
        if requests.iter().map(|request| request.axes.len()).sum::<usize>() < LONG {
            return Ok(self.outcomes(requests, detail, outgoing)?);
        }
        let (this, outgoing) = (self.clone(), outgoing.clone());
        self.aside.run(move || this.outcomes(requests, detail, &outgoing)).await
    }

    /// Plans one after the other, for as long as there is somebody who waits for it and the answer may still be sent.
    fn outcomes(
        &self,
        requests: Vec<pb::PlanRequest>,
        detail: Detail,
        outgoing: &Outgoing,
    ) -> Result<outgoing::PlanManyResponse, Rejected> {
        let mut outcomes = Outcomes::with_room(requests.len(), self.most_bytes, detail);
        for wire in requests {
            if outgoing.is_closed() {
                break;
            }
            let admitted = self.limits.admit_axes("axes", wire.axes.len());
            let answer = admitted.and_then(|()| judged(wire, &self.figures));
            if let Err(rejected) = &answer {
                self.refusals.count(rejected.reason);
            }
            outcomes.push(&answer);
            if outcomes.bytes() > self.most_bytes {
                return Err(too_large(outcomes.len() - 1, self.most_bytes));
            }
        }
        Ok(outcomes.into_wire())
    }

    async fn columns(
        &self,
        requests: &[pb::PlanRequest],
        columns: pb::MoveColumns,
        detail: Detail,
        outgoing: &Outgoing,
    ) -> Result<outgoing::PlanManyResponse, Status> {
        if !requests.is_empty() {
            return Err(both(requests.len()).into());
        }
        let moves = Moves::from_wire(columns, detail, |count| self.limits.admit_plans("columns", count))?;
        let long = if moves.are_long() { LONG } else { LONG_COLUMNS };
        if moves.len() < long {
            return Ok(self.moved(moves, outgoing)?);
        }
        let (this, outgoing) = (self.clone(), outgoing.clone());
        self.aside.run(move || this.moved(moves, &outgoing)).await
    }

    /// Plans the moves of columns, for as long as there is somebody who waits for them and the answer may still be sent.
    fn moved(&self, mut moves: Moves, outgoing: &Outgoing) -> Result<outgoing::PlanManyResponse, Rejected> {
        let (begun, family) = (Instant::now(), moves.family());
        let (mut done, mut planned) = (0, 0);
        while let Some(outcome) = moves.plan_next() {
            match outcome {
                Ok(()) => planned += 1,
                Err(reason) => self.refusals.count(reason),
            }
            done += 1;
            if moves.bytes() > self.most_bytes {
                return Err(too_large(done - 1, self.most_bytes));
            }
            if done % ASKS_AFTER == 0 && outgoing.is_closed() {
                break;
            }
        }
        self.figures.planned_many(family, planned, begun.elapsed());
        Ok(outgoing::PlanManyResponse { outcomes: Vec::new(), columns: Some(moves.into_wire()) })
    }
}

/// A message is one or the other: in which order would it be answered?
fn both(requests: usize) -> Rejected {
    let text =
        format!("stands beside {requests} requests: send them in messages of their own, on the same stream");
    Rejected::for_field("columns", Reason::ProtocolOrder, text)
}

/// Found out before all of it is planned: what may not be sent is not to be held in memory either.
fn too_large(fit: usize, allowed: usize) -> Rejected {
    let text = format!(
        "the answer has more than {allowed} bytes, the most that this server sends, after {fit} plans: ask for fewer in a \
         message or for less of each, or raise the server's max_message_bytes"
    );
    Rejected::new(Reason::MessageTooLarge, text).with("allowed", allowed).with("fit", fit)
}

fn draining() -> Rejected {
    let text = "this server is about to leave: ask another for what is not answered";
    Rejected::new(Reason::Draining, text)
}
