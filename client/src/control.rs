use proto::Reason;
use proto::stream::{Operation, OperationResult};

use crate::{Client, Error};

/// Does an operation on a stream that one of `endpoints` serves: asks them in turn.
///
/// # Errors
/// That of the endpoint which serves the stream; where none does, that of the last one that was asked.
pub async fn control(
    endpoints: &[String],
    stream: &str,
    operation: &Operation,
) -> Result<OperationResult, Error> {
    let mut last = Error::Protocol("no endpoint is given: name at least one".into());
    for endpoint in endpoints {
        let asked = async { Client::connect(endpoint).await?.control(stream, operation.clone()).await };
        match asked.await {
            Err(error) if asks_elsewhere(&error) => last = error,
            answered => return answered,
        }
    }
    Err(last)
}

fn asks_elsewhere(error: &Error) -> bool {
    match error {
        Error::Unreachable { .. } | Error::Unanswered { .. } => true,
        Error::Rejected(rejected) => {
            matches!(rejected.reason, Reason::StreamNotHere | Reason::Draining)
        }
        Error::Address { .. } | Error::TooLarge { .. } | Error::NotServed { .. } | Error::Protocol(_) => {
            false
        }
    }
}
