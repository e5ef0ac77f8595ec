//! Many plans over one stream: requests in messages, answers in the order of the requests.

use planner::{Judged, RequestSpec};
use prost::Message as _;
use proto::{Detail, MoveColumns, PlannedMoves, Rejected, outcome_from_wire, pb};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::Streaming;

use crate::{Client, Error};

/// Messages on their way to the server: it plans one while the next is on the wire.
const OUTBOX: usize = 2;

/// What [`Client::plan_all`] puts into a message: enough that a message costs little beside its plans.
const PER_MESSAGE: usize = 128;
/// Its size \[bytes\]: the answer is about ten times as large.
const BYTES_PER_MESSAGE: usize = 64 << 10;

/// Moves in a message of [`Client::plan_columns`]: as many as a server takes that nobody has told otherwise. More would cost no less each.
const MOVES_PER_MESSAGE: usize = 4096;

/// The asking side of a stream of plans. Dropping it says that this was all.
#[derive(Clone, Debug)]
pub struct Asking {
    endpoint: String,
    most_bytes: usize,
    detail: Detail,
    outgoing: mpsc::Sender<pb::PlanManyRequest>,
}

/// The answering side of a stream of plans.
#[derive(Debug)]
pub struct Answers {
    endpoint: String,
    incoming: Streaming<pb::PlanManyResponse>,
}

impl Client {
    /// Opens a stream of plans, of each of which `detail` is told. Ask and take answers at the same time: a server whose
    /// answers are not taken does not read on.
    ///
    /// # Errors
    /// [`Error::Rejected`] where the server does not take such a stream, [`Error::Unreachable`].
    pub async fn plan_many(&self, detail: Detail) -> Result<(Asking, Answers), Error> {
        let (outgoing, requests) = mpsc::channel(OUTBOX);
        let response = self.planner.clone().plan_many(ReceiverStream::new(requests)).await;
        let (endpoint, most_bytes) = (self.endpoint.clone(), self.most_bytes);
        let answers = Answers { endpoint: endpoint.clone(), incoming: self.answer(response)? };
        Ok((Asking { endpoint, most_bytes, detail, outgoing }, answers))
    }

    /// Plans all of `requests`, in messages of a usual size, and gives what became of each, in their order.
    ///
    /// # Errors
    /// Those of [`Answers::next`]: then nothing is known of any.
    pub async fn plan_all(&self, requests: Vec<RequestSpec>) -> Result<Vec<Result<Judged, Rejected>>, Error> {
        let count = requests.len();
        let (asking, mut answers) = self.plan_many(Detail::Full).await?;
        let ask = async move {
            for message in messages(requests) {
                // Where the stream is over, its answering side says why.
                if !asking.send(message).await? {
                    break;
                }
            }
            Ok::<(), Error>(())
        };
        let take = async {
            let mut all = Vec::with_capacity(count);
            while let Some(outcomes) = answers.next().await? {
                all.extend(outcomes);
            }
            Ok::<_, Error>(all)
        };
        let ((), all) = tokio::try_join!(ask, take)?;
        if all.len() == count {
            Ok(all)
        } else {
            Err(Error::Protocol(format!("{} answers to {count} requests", all.len())))
        }
    }
}

impl Client {
    /// Plans many moves of one axis that differ in a few numbers, in messages of a usual size, for a fraction of what
    /// [`plan_all`](Self::plan_all) takes; what became of them, one after the other in parts of [`PlannedMoves`]: as many moves in each as went into
    /// its message.
    ///
    /// # Errors
    /// [`Error::Rejected`] with what is wrong with all of them, or where the server ends the stream; those of [`Answers::next_columns`].
    pub async fn plan_columns(
        &self,
        columns: &MoveColumns,
        detail: Detail,
    ) -> Result<Vec<PlannedMoves>, Error> {
        let count = columns.len();
        let (asking, mut answers) = self.plan_many(detail).await?;
        let ask = async move {
            for first in (0..count).step_by(MOVES_PER_MESSAGE) {
                let part = columns.slice(first..count.min(first + MOVES_PER_MESSAGE));
                // Where the stream is over, its answering side says why.
                if !asking.ask_columns(part).await? {
                    break;
                }
            }
            Ok::<(), Error>(())
        };
        let take = async {
            let mut parts = Vec::with_capacity(count.div_ceil(MOVES_PER_MESSAGE));
            while let Some(part) = answers.next_columns().await? {
                parts.push(part);
            }
            Ok::<_, Error>(parts)
        };
        let ((), parts) = tokio::try_join!(ask, take)?;
        let answered: usize = parts.iter().map(PlannedMoves::len).sum();
        if answered == count {
            Ok(parts)
        } else {
            Err(Error::Protocol(format!("{answered} answers to {count} moves")))
        }
    }
}

impl Asking {
    /// Asks for the moves of one message, and waits for room where the server is behind. `false` if the stream is over: its
    /// answering side says why.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub async fn ask_columns(&self, columns: MoveColumns) -> Result<bool, Error> {
        let columns = Some(columns.into());
        self.send_message(pb::PlanManyRequest {
            requests: Vec::new(),
            detail: self.detail.to_wire(),
            columns,
        })
        .await
    }

    /// Asks for the plans of one message, and waits for room where the server is behind. `false` if the stream is over: its
    /// answering side says why.
    ///
    /// # Errors
    /// [`Error::TooLarge`].
    pub async fn ask(&self, requests: Vec<RequestSpec>) -> Result<bool, Error> {
        self.send(requests.into_iter().map(Into::into).collect()).await
    }

    async fn send(&self, requests: Vec<pb::PlanRequest>) -> Result<bool, Error> {
        self.send_message(pb::PlanManyRequest { requests, detail: self.detail.to_wire(), columns: None })
            .await
    }

    async fn send_message(&self, message: pb::PlanManyRequest) -> Result<bool, Error> {
        let message = Error::unless_fits(&self.endpoint, message, self.most_bytes)?;
        Ok(self.outgoing.send(message).await.is_ok())
    }
}

impl Answers {
    /// What became of the requests of the next message, in their order; `None` when all is answered. Certificates are computed here
    /// again, from the segments that came.
    ///
    /// # Errors
    /// [`Error::Rejected`] where the server ends the stream for a reason, [`Error::Unreachable`] where it is gone. What came before
    /// holds.
    pub async fn next(&mut self) -> Result<Option<Vec<Result<Judged, Rejected>>>, Error> {
        let message = self.incoming.message().await;
        let message = message.map_err(|status| Error::of_planner(&self.endpoint, &status))?;
        let Some(pb::PlanManyResponse { outcomes, columns }) = message else { return Ok(None) };
        if columns.is_some() {
            return Err(Error::Protocol("columns in the place of outcomes: take them as columns".into()));
        }
        let outcomes = outcomes.into_iter().map(outcome_from_wire).collect::<Result<_, _>>();
        outcomes.map(Some).map_err(Error::unreadable)
    }

    /// What became of the moves of the next message, which was one of columns; `None` when all is answered. The numbers stay where they
    /// came in; [`PlannedMoves::plan`] makes a plan of those that are wanted, and judges it again.
    ///
    /// # Errors
    /// [`Error::Rejected`] where the server ends the stream for a reason, [`Error::Unreachable`] where it is gone. What came before
    /// holds.
    pub async fn next_columns(&mut self) -> Result<Option<PlannedMoves>, Error> {
        let message = self.incoming.message().await;
        let message = message.map_err(|status| Error::of_planner(&self.endpoint, &status))?;
        let Some(pb::PlanManyResponse { columns, .. }) = message else { return Ok(None) };
        let columns = columns.ok_or_else(|| {
            Error::Protocol(
                "outcomes in the place of columns: take them as outcomes, or compare versions".into(),
            )
        })?;
        PlannedMoves::from_wire(columns).map(Some).map_err(Error::unreadable)
    }
}

/// In pieces, each as large as it may be for its count and its bytes; what is larger by itself goes by itself.
fn messages(requests: Vec<RequestSpec>) -> impl Iterator<Item = Vec<pb::PlanRequest>> {
    let mut requests = requests.into_iter().map(pb::PlanRequest::from).peekable();
    std::iter::from_fn(move || {
        let mut message: Vec<pb::PlanRequest> = requests.next().into_iter().collect();
        let mut bytes = message.first()?.encoded_len();
        while message.len() < PER_MESSAGE {
            let fits = |next: &pb::PlanRequest| bytes + next.encoded_len() <= BYTES_PER_MESSAGE;
            let Some(next) = requests.next_if(fits) else { break };
            bytes += next.encoded_len();
            message.push(next);
        }
        Some(message)
    })
}
