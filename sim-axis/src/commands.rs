//! Operations that others ask of an axis: forwarded in band, and answered as the server answers.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use proto::stream::{Operation, OperationResult};
use proto::{Reason, Rejected};
use tokio::sync::{mpsc, oneshot};

/// Asks for operations on the stream of a run, from anywhere.
#[derive(Clone, Debug)]
pub struct Commander {
    inbox: mpsc::Sender<Command>,
    finished: Arc<AtomicBool>,
}

/// Where the commands of a [`Commander`] come out.
#[derive(Debug)]
pub(crate) struct Commands {
    pub(crate) inbox: mpsc::Receiver<Command>,
    /// The stream has come to its end, and takes no more of them.
    pub(crate) finished: Arc<AtomicBool>,
}

/// What will become of an operation.
#[derive(Debug)]
pub struct Answered(oneshot::Receiver<Result<OperationResult, Rejected>>);

/// One operation, and whoever waits for what becomes of it.
#[derive(Debug)]
pub(crate) struct Command {
    pub(crate) operation: Operation,
    pub(crate) answer: Answer,
}

pub(crate) type Answer = oneshot::Sender<Result<OperationResult, Rejected>>;

/// Commands that wait to be forwarded.
const COMMANDS: usize = 16;

/// A commander, and where its commands come out.
pub(crate) fn commander() -> (Commander, Commands) {
    let ((sender, inbox), finished) = (mpsc::channel(COMMANDS), Arc::default());
    (Commander { inbox: sender, finished: Arc::clone(&finished) }, Commands { inbox, finished })
}

impl Commander {
    /// Asks for an operation, and waits until the server says what became of it.
    ///
    /// # Errors
    /// What the server refuses it for; [`Reason::StreamFinished`] where the motion has come to its end; [`Reason::NotConfirmed`] where the run
    /// is over otherwise before it is answered.
    pub async fn operate(&self, operation: Operation) -> Result<OperationResult, Rejected> {
        let (answer, answered) = oneshot::channel();
        let sent = self.inbox.send(Command { operation, answer }).await;
        sent.map_err(|_| self.gone())?;
        answered.await.unwrap_or_else(|_| Err(self.gone()))
    }

    fn gone(&self) -> Rejected {
        if !self.finished.load(Ordering::Acquire) {
            return not_confirmed();
        }
        let text = "the motion has come to its end, and the axis settles: begin a new run";
        Rejected::new(Reason::StreamFinished, text)
    }

    /// Is it the commander of the same run?
    pub(crate) fn is_of(&self, other: &Self) -> bool {
        self.inbox.same_channel(&other.inbox)
    }
}

impl Answered {
    /// Waits until the server says what became of it.
    ///
    /// # Errors
    /// Those of [`Commander::operate`].
    pub async fn get(self) -> Result<OperationResult, Rejected> {
        self.0.await.unwrap_or_else(|_| Err(not_confirmed()))
    }
}

/// Those who wait, by request.
#[derive(Debug, Default)]
pub(crate) struct Waiting {
    answers: Mutex<HashMap<String, Vec<Answer>>>,
}

impl Waiting {
    /// Tells those who wait for it what became of a request.
    pub(crate) fn tell(&self, request_id: &str, result: &Result<OperationResult, Rejected>) {
        let answers = self.answers.lock().unwrap_or_else(PoisonError::into_inner).remove(request_id);
        for answer in answers.into_iter().flatten() {
            // Who does not wait any more may ask again.
            let _ = answer.send(result.clone());
        }
    }

    /// Nothing more will be answered.
    pub(crate) fn give_up(&self) {
        self.answers.lock().unwrap_or_else(PoisonError::into_inner).clear();
    }

    /// Waits for what becomes of a request.
    pub(crate) fn answered(&self, request_id: &str) -> Answered {
        let (answer, answered) = oneshot::channel();
        self.expect(request_id, answer);
        Answered(answered)
    }

    pub(crate) fn expect(&self, request_id: &str, answer: Answer) {
        let mut answers = self.answers.lock().unwrap_or_else(PoisonError::into_inner);
        answers.entry(request_id.to_owned()).or_default().push(answer);
    }
}

fn not_confirmed() -> Rejected {
    let text = "the run ended before the operation was answered: send it again with the same request_id, if the motion \
                goes on";
    Rejected::new(Reason::NotConfirmed, text)
}
