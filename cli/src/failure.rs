//! Why a command did not do what it was asked, and the exit code that says so.

use std::io;
use std::path::{Path, PathBuf};

use proto::{JsonError, Reason, Rejected};

/// Everything that ends a command early.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// The judge does not pass the plan, or it is not what it says of itself. The command has said why.
    #[error("the plan does not pass, as said above: plan it again")]
    NotPassed,
    /// Two plans differ. The command has said in what.
    #[error("the plans differ, as said above")]
    Differ,
    /// The answer could not be given.
    #[error("{path} cannot be written: {cause}: choose a place that can be, with room left", path = place(.path, "output"))]
    Unwritable { path: PathBuf, cause: io::Error },
    /// The answer could not be computed or drawn, through no fault of the caller's.
    #[error("{0}")]
    Internal(String),
    /// Something that was named on the command line cannot be read.
    #[error("{path} cannot be read: {cause}: name a file that can be, or - for standard input", path = place(.path, "input"))]
    Unreadable { path: PathBuf, cause: io::Error },
    /// It can be read, and is something else.
    #[error(
        "{path} is not a {expected} in proto3 JSON: {cause}: correct it there, or begin with an example of `portamento init`",
        path = place(.path, "input")
    )]
    NotAMessage { path: PathBuf, expected: &'static str, cause: JsonError },
    /// A table that is none.
    #[error("{path}, line {line}: {cause}", path = place(.path, "input"))]
    NotPoints { path: PathBuf, line: usize, cause: String },
    /// The planner, or the server, says no.
    #[error("{0}")]
    Refused(Box<Rejected>),
    /// What is to be compared is counted in different units.
    #[error("the axes are of different kinds, so their units cannot be compared: compare axes of one kind")]
    NotAlike,
    /// Flags that do not go together, which only their values or the command tell.
    #[error("{0}")]
    Usage(String),
    /// No axis can be simulated like this.
    #[error("axis {axis:?} cannot be simulated: {cause}")]
    Simulation { axis: String, cause: sim_axis::InvalidConfig },
    /// A file that does not say what an axis is made of.
    #[error("{path} is not an AxisModel in proto3 JSON: {cause}", path = place(.path, "input"))]
    NotAModel { path: PathBuf, cause: sim_axis::ModelFileError },
    /// Nobody answers.
    #[error(
        "{endpoint} does not answer, or what it needs does not: {cause}. Start it, or correct the address; plan, pvt, verify and sample also work without --endpoint"
    )]
    Unreachable { endpoint: String, cause: String },
    /// Whoever read the output has gone: a quiet end.
    #[error("the reader has gone")]
    ReaderGone,
}

impl Failure {
    /// What the process ends with.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::ReaderGone => 0,
            Self::NotPassed | Self::Differ | Self::Unwritable { .. } | Self::Internal(_) => 1,
            Self::Unreadable { .. }
            | Self::NotAMessage { .. }
            | Self::NotAModel { .. }
            | Self::NotPoints { .. }
            | Self::NotAlike
            | Self::Usage(_)
            | Self::Simulation { .. } => 2,
            // An axis that does not get through to its planner.
            Self::Refused(rejected) if rejected.reason == Reason::PlannerUnreachable => 4,
            Self::Refused(_) => 3,
            Self::Unreachable { .. } => 4,
        }
    }

    /// The refusal for `rejected`, or for what becomes one.
    pub(crate) fn refused(rejected: impl Into<Rejected>) -> Self {
        Self::Refused(Box::new(rejected.into()))
    }

    /// Why something could not be written to `path`.
    pub(crate) fn unwritable(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |cause| Self::Unwritable { path: path.to_owned(), cause }
    }

    /// Why something could not be read from `path`.
    pub(crate) fn unreadable(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |cause| Self::Unreadable { path: path.to_owned(), cause }
    }
}

/// Of standard output: files say their name.
impl From<io::Error> for Failure {
    fn from(cause: io::Error) -> Self {
        match cause.kind() {
            io::ErrorKind::BrokenPipe => Self::ReaderGone,
            _ => Self::Unwritable { path: PathBuf::from("-"), cause },
        }
    }
}

impl From<client::Error> for Failure {
    fn from(error: client::Error) -> Self {
        match error {
            client::Error::Rejected(rejected) => Self::Refused(rejected),
            client::Error::Address { endpoint, cause } | client::Error::Unreachable { endpoint, cause } => {
                Self::Unreachable { endpoint, cause }
            }
            client::Error::NotServed { .. } => Self::Usage(error.to_string()),
            client::Error::TooLarge { .. }
            | client::Error::Unanswered { .. }
            | client::Error::Protocol(_) => Self::Internal(error.to_string()),
        }
    }
}

impl From<sim_axis::TrackError> for Failure {
    fn from(error: sim_axis::TrackError) -> Self {
        match error {
            sim_axis::TrackError::NotOpened { cause, .. } => cause.into(),
            other => Self::Internal(other.to_string()),
        }
    }
}

impl From<JsonError> for Failure {
    fn from(error: JsonError) -> Self {
        Self::Internal(error.to_string())
    }
}

/// How a file is called in a sentence; `-` is the standard stream that it is used as.
fn place(path: &Path, used_as: &str) -> String {
    if path.as_os_str() == "-" { format!("standard {used_as}") } else { path.display().to_string() }
}
