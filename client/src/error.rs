use std::fmt::Display;

use prost::Message;
use proto::stream::Refused;
use proto::{Reason, Rejected};
use tonic::{Code, Status};

/// Why an answer is none, by who has to act.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// Yours to mend: the request was understood and refused.
    #[error("{0}")]
    Rejected(Box<Rejected>),
    /// Yours to mend: nobody can be asked at such an address.
    #[error("{endpoint:?} is not an address: {cause}; write it as http://host:port or unix:/path")]
    Address {
        /// As it was given.
        endpoint: String,
        /// What is wrong with it.
        cause: String,
    },
    /// Yours to mend: a message, asked or answered, that this client is not to take.
    #[error(
        "a message to or from {endpoint} is too large for this client: {cause}; ask for less at a time, or raise the limit"
    )]
    TooLarge {
        /// Where.
        endpoint: String,
        /// Its size and the limit.
        cause: String,
    },
    /// Try again, or elsewhere.
    #[error("{endpoint} is not reachable: {cause}")]
    Unreachable {
        /// Where.
        endpoint: String,
        /// What the network says.
        cause: String,
    },
    /// Try again, or elsewhere.
    #[error("the server does not go on: {cause}")]
    Unanswered {
        /// What it did instead.
        cause: String,
    },
    /// Yours to mend: somebody answers at the address, and does not know the call.
    #[error(
        "{endpoint} answers, and does not serve what was asked: name a planner for plans and streams, an axis to track or \
         command one, and compare versions"
    )]
    NotServed {
        /// Where.
        endpoint: String,
    },
    /// Ours to mend: an answer that is not of the protocol.
    #[error("the server broke the protocol: {0}")]
    Protocol(String),
}

impl Error {
    /// What a failed call to `endpoint` means.
    #[must_use]
    pub fn from_status(endpoint: &str, status: &Status) -> Self {
        if let Some(rejected) = Rejected::from_status(status) {
            return Self::Rejected(Box::new(rejected));
        }
        match status.code() {
            Code::Unavailable | Code::DeadlineExceeded | Code::Cancelled | Code::Unknown => {
                Self::Unreachable { endpoint: endpoint.into(), cause: status.message().into() }
            }
            // A service that knows the call and cannot do it yet says so with a reason.
            Code::Unimplemented => Self::NotServed { endpoint: endpoint.into() },
            // A server says so with a reason; without one it is this side that has measured.
            Code::OutOfRange if status.message().contains("message length too large") => {
                Self::TooLarge { endpoint: endpoint.into(), cause: status.message().into() }
            }
            code => Self::Protocol(format!("{}: {}", proto::code_name(code), status.message())),
        }
    }

    /// As [`from_status`](Self::from_status), of a call that every planner serves: who does not is none.
    pub(crate) fn of_planner(endpoint: &str, status: &Status) -> Self {
        match Self::from_status(endpoint, status) {
            error @ Self::NotServed { .. } => {
                let rejected = Rejected::new(Reason::NotAPlanner, error.to_string());
                let cause = "no service here knows the call";
                Self::Rejected(Box::new(rejected.with("endpoint", endpoint).with("cause", cause)))
            }
            error => error,
        }
    }

    /// Nobody answers at `endpoint`.
    #[must_use]
    pub fn unreachable(endpoint: &str, error: &(dyn std::error::Error + 'static)) -> Self {
        let cause = proto::unreachable(error).message().to_owned();
        Self::Unreachable { endpoint: endpoint.into(), cause }
    }

    /// A request to `endpoint` that is known to fit: one that does not would break the connection's stream without a word.
    ///
    /// # Errors
    /// [`Error::TooLarge`] where it has more than `most` bytes.
    pub fn unless_fits<M: Message>(endpoint: &str, request: M, most: usize) -> Result<M, Self> {
        let bytes = request.encoded_len();
        let cause = || format!("the request has {bytes} bytes, the limit is {most}");
        if bytes <= most {
            Ok(request)
        } else {
            Err(Self::TooLarge { endpoint: endpoint.into(), cause: cause() })
        }
    }

    /// An answer that cannot be read.
    pub(crate) fn unreadable(error: impl Display) -> Self {
        Self::Protocol(error.to_string())
    }

    /// A batch that cannot be accepted.
    pub(crate) fn refused(refused: &Refused) -> Self {
        let Refused { first_cycle, reason, .. } = refused;
        Self::Protocol(format!("the batch from cycle {first_cycle} is refused: {}", reason.name()))
    }
}
