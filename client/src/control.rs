use proto::Reason;
use proto::stream::{Operation, OperationResult};

use crate::{Connect, Error};

/// Does an operation on a stream that one of `endpoints` serves: asks them in turn. With encryption: [`Connect::control`].
///
/// # Errors
/// That of the endpoint which serves the stream; where none does, that of one where it has come to its end, or of the last one that was
/// asked.
pub async fn control(
    endpoints: &[String],
    stream: &str,
    operation: &Operation,
) -> Result<OperationResult, Error> {
    Connect::new().control(endpoints, stream, operation).await
}

impl Connect {
    /// Does an operation on a stream that one of `endpoints` serves: asks them in turn.
    ///
    /// # Errors
    /// Those of [`control`].
    pub async fn control(
        &self,
        endpoints: &[String],
        stream: &str,
        operation: &Operation,
    ) -> Result<OperationResult, Error> {
        let mut last = Error::Protocol("no endpoint is given: name at least one".into());
        for endpoint in endpoints {
            let asked = async { self.to(endpoint).await?.control(stream, operation.clone()).await };
            match asked.await {
                // Elsewhere another of the same name may have begun; but no other endpoint knows more of its end.
                Err(error) if asks_elsewhere(&error) => {
                    if !is_finished(&last) {
                        last = error;
                    }
                }
                answered => return answered,
            }
        }
        Err(last)
    }
}

fn is_finished(error: &Error) -> bool {
    matches!(error, Error::Rejected(rejected) if rejected.reason == Reason::StreamFinished)
}

fn asks_elsewhere(error: &Error) -> bool {
    match error {
        Error::Unreachable { .. } | Error::Unanswered { .. } => true,
        Error::Rejected(rejected) => {
            matches!(rejected.reason, Reason::StreamNotHere | Reason::StreamFinished | Reason::Draining)
        }
        Error::Address { .. } | Error::TooLarge { .. } | Error::NotServed { .. } | Error::Protocol(_) => {
            false
        }
    }
}
