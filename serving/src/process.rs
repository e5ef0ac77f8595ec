use std::io::{IsTerminal as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr};
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use tokio::signal::unix::{SignalKind, signal};
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_check_response::ServingStatus;
use tonic_health::pb::health_client::HealthClient;
use tracing_subscriber::EnvFilter;

use crate::{Misfits, ServeError};

/// Why a process ends badly.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exit {
    code: u8,
    text: String,
}

/// A setting is wrong.
const USAGE: u8 = 64;
/// Anything else went wrong.
const FAILURE: u8 = 1;

impl Exit {
    /// Through no setting's fault.
    pub fn failure(text: impl Into<String>) -> Self {
        Self { code: FAILURE, text: text.into() }
    }
}

impl From<Misfits> for Exit {
    fn from(misfits: Misfits) -> Self {
        Self { code: USAGE, text: misfits.to_string() }
    }
}

impl From<ServeError> for Exit {
    fn from(error: ServeError) -> Self {
        match error {
            ServeError::Settings(misfits) => misfits.into(),
            ServeError::Bind { .. } | ServeError::Serve(_) | ServeError::Reflection(_) => {
                Self::failure(error.to_string())
            }
        }
    }
}

/// The whole of a process called `name`: reads its arguments, runs `main` with them, and says on standard error why it
/// ended badly. Exits with 0, with 64 where a setting is wrong, else with 1.
pub fn process<A: Parser, F: Future<Output = Result<(), Exit>>>(
    name: &str,
    main: impl FnOnce(A) -> F,
) -> ExitCode {
    let args = match A::try_parse() {
        Ok(args) => args,
        Err(said) => {
            // Where nobody reads it, the exit code has to do.
            let _ = said.print();
            return if said.use_stderr() { ExitCode::from(USAGE) } else { ExitCode::SUCCESS };
        }
    };
    log_to_stderr();
    let ended = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|error| Exit::failure(format!("cannot start: {error}")))
        .and_then(|runtime| runtime.block_on(main(args)));
    let Err(Exit { code, text }) = ended else { return ExitCode::SUCCESS };
    for line in text.lines() {
        // Where standard error is closed, the exit code has to do.
        let _ = writeln!(std::io::stderr(), "{name}: {line}");
    }
    ExitCode::from(code)
}

/// In colour where somebody looks on, and plain in files.
fn log_to_stderr() {
    let wants_plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    tracing_subscriber::fmt()
        .with_env_filter(EnvFilter::try_from_default_env().unwrap_or_else(|_| "info".into()))
        .with_ansi(std::io::stderr().is_terminal() && !wants_plain)
        .with_writer(std::io::stderr)
        .init();
}

/// Completes on SIGTERM or SIGINT.
///
/// # Errors
/// A system that has no signals to give.
pub fn told_to_stop() -> Result<impl Future<Output = ()> + Send, Exit> {
    // As the first process of a container there is no default action for SIGTERM: it has to be taken.
    let take = |kind| signal(kind).map_err(|error| Exit::failure(format!("cannot take signals: {error}")));
    let (mut terminate, mut interrupt) = (take(SignalKind::terminate())?, take(SignalKind::interrupt())?);
    Ok(async move {
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
        }
    })
}

/// A number of seconds that is a duration.
///
/// # Errors
/// What is wrong with any other.
pub fn seconds(given: f64) -> Result<Duration, String> {
    Duration::try_from_secs_f64(given).map_err(|_| format!("is {given}: give seconds, 0 or more"))
}

/// Asks the process at `listen` whether it serves `service`.
///
/// # Errors
/// Where it does not, or does not answer.
pub async fn healthcheck(listen: SocketAddr, service: &str) -> Result<(), Exit> {
    let here = SocketAddr::from((Ipv4Addr::LOCALHOST, listen.port()));
    let address = if listen.ip().is_unspecified() { here } else { listen };
    let asked = async {
        let endpoint = tonic::transport::Endpoint::from_shared(format!("http://{address}"));
        let channel = endpoint.map_err(|e| e.to_string())?.connect().await.map_err(|e| e.to_string())?;
        let request = HealthCheckRequest { service: service.to_owned() };
        let answer = HealthClient::new(channel).check(request).await.map_err(|e| e.to_string())?;
        Ok::<_, String>(answer.into_inner().status())
    };
    let text = match tokio::time::timeout(HEALTHCHECK, asked).await {
        Ok(Ok(ServingStatus::Serving)) => return Ok(()),
        Ok(Ok(status)) => format!("{service} at {address} is {}", status.as_str_name()),
        Ok(Err(error)) => format!("no answer from {address}: {error}"),
        Err(_) => format!("no answer from {address} within {} s", HEALTHCHECK.as_secs()),
    };
    Err(Exit::failure(text))
}

/// How long an answer about health may take.
const HEALTHCHECK: Duration = Duration::from_secs(2);
