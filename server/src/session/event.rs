use proto::Rejected;
use proto::stream::{FromAxis, Operation, OperationResult, ToAxis};

/// Everything that can happen to a session.
#[derive(Debug)]
pub enum Event {
    /// The axis said something.
    FromAxis(FromAxis),
    /// What the axis said cannot be read.
    Unreadable(Rejected),
    /// Somebody who is not the axis asks for an operation.
    Command {
        /// Under which the answer is given.
        ticket: u64,
        /// What is asked.
        operation: Operation,
    },
    /// The axis has closed its side, or is gone.
    AxisClosed,
    /// The same stream was opened under a newer epoch.
    Superseded {
        /// The newer one.
        by: u64,
    },
    /// Somebody has come to watch, or nobody watches any more: tracking is wanted of the axis, or not.
    Watched(bool),
    /// This server is about to leave.
    Drain,
    /// This server leaves now.
    Leave,
}

/// Everything that a session does towards its axis.
#[derive(Debug, PartialEq)]
pub enum Output {
    /// Says this to the axis.
    Send(ToAxis),
    /// The session is over: well, or for a reason.
    End(Result<(), Rejected>),
}

/// What became of a [`Event::Command`].
#[derive(Debug, PartialEq)]
pub struct Answer {
    /// Of the command.
    pub ticket: u64,
    /// What became of it.
    pub result: Result<OperationResult, Rejected>,
}
