use std::io::Write as _;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use tokio::signal::unix::{SignalKind, signal};
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_check_response::ServingStatus;
use tonic_health::pb::health_client::HealthClient;

use crate::address::Address;
use crate::flags::Flags;
use crate::{Misfits, ServeError, Settings, file, logs};

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

/// What a process is told when it is started.
pub trait Arguments: Parser {
    /// Those that every process has.
    fn flags(&self) -> &Flags;
}

/// The whole of a process called `name`: reads its settings from file, environment and arguments, runs `main` with them and
/// with what is wrong so far, and says on standard error why it ended badly. Exits with 0, with 64 where a setting is wrong,
/// else with 1.
pub fn process<A: Arguments, F: Future<Output = Result<(), Exit>>>(
    name: &str,
    main: impl FnOnce(A, Misfits) -> F,
) -> ExitCode {
    let mut misfits = Misfits::default();
    let args = match arguments::<A>(&mut misfits) {
        Ok(args) => args,
        Err(said) => {
            // Where nobody reads it, the exit code has to do.
            let _ = said.print();
            return if said.use_stderr() { ExitCode::from(USAGE) } else { ExitCode::SUCCESS };
        }
    };
    let ended = tokio::runtime::Builder::new_multi_thread()
        .enable_all()
        .build()
        .map_err(|error| Exit::failure(format!("cannot start: {error}")))
        .and_then(|runtime| {
            runtime.block_on(async {
                let export = logs::begin(name, args.flags(), &mut misfits);
                let ended = main(args, misfits).await;
                export.end();
                ended
            })
        });
    let Err(Exit { code, text }) = ended else { return ExitCode::SUCCESS };
    for line in text.lines() {
        // Where standard error is closed, the exit code has to do.
        let _ = writeln!(std::io::stderr(), "{name}: {line}");
    }
    ExitCode::from(code)
}

/// From the file that arguments or environment name, the environment, and the arguments; each before the one that it follows.
fn arguments<A: Arguments>(misfits: &mut Misfits) -> Result<A, clap::Error> {
    let command = A::command();
    let path = command
        .clone()
        .ignore_errors(true)
        .try_get_matches()
        .ok()
        .and_then(|matches| matches.get_one::<PathBuf>("config").cloned());
    let command = match path {
        Some(path) => file::with_defaults(command, &path, misfits),
        None => command,
    };
    A::from_arg_matches(&command.try_get_matches()?)
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

/// Prints what a subcommand was asked for.
///
/// # Errors
/// Where nobody can read it.
pub fn print(text: &str) -> Result<(), Exit> {
    std::io::stdout()
        .write_all(text.as_bytes())
        .map_err(|error| Exit::failure(format!("cannot print: {error}")))
}

/// A number of seconds that is a duration.
///
/// # Errors
/// What is wrong with any other.
pub fn seconds(given: f64) -> Result<Duration, String> {
    Duration::try_from_secs_f64(given).map_err(|_| format!("is {given}: give seconds, 0 or more"))
}

/// Asks the process with these settings whether it serves `service`: at its side port where it has one, which takes no
/// certificate.
///
/// # Errors
/// Where it does not, or does not answer.
pub async fn healthcheck(settings: &Settings, service: &str) -> Result<(), Exit> {
    let listen = settings.http.map_or_else(|| settings.listen.clone(), Address::from);
    if settings.http.is_none() && settings.tls.is_some() {
        let text = "health is asked without a certificate: give --http, and it is asked there";
        return Err(Exit::failure(text));
    }
    let address = match listen {
        Address::Tcp(listen) if listen.ip().is_unspecified() => {
            SocketAddr::from((Ipv4Addr::LOCALHOST, listen.port())).into()
        }
        listen => listen,
    };
    let asked = async {
        let endpoint = tonic::transport::Endpoint::from_shared(address.endpoint());
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
