#![allow(rustdoc::bare_urls, reason = "help texts show addresses as they are typed")]

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use std::net::SocketAddr;

use crate::address::Address;
use crate::collector::Collector;
use crate::given::{Given, List, Seconds};
use crate::policy::Policy;
use crate::settings::{Misfits, Settings};
use crate::tls::Tls;

const WHO: &str = "Who is let in";
const LIMITS: &str = "How much is taken";
const LOGS: &str = "What is told";

/// The settings that every serving process has, beside its ports.
#[derive(Clone, Debug, Args)]
pub struct Flags {
    /// Settings in TOML, under the names of the flags with _ for -; flags and the environment go before it.
    #[arg(long, env = "PORTAMENTO_CONFIG", value_name = "FILE.toml")]
    pub(crate) config: Option<PathBuf>,
    /// How long work may take to end after SIGTERM [s].
    #[arg(long, env = "PORTAMENTO_DRAIN_DEADLINE", default_value = "10", value_name = "SECONDS")]
    drain_deadline: Given<Seconds>,

    /// Serve addresses that other machines reach without encryption; with --tls-cert, the HTTP side port alone.
    #[arg(long, env = "PORTAMENTO_INSECURE", value_name = "BOOL", default_value = "false",
        num_args = 0..=1, require_equals = true, default_missing_value = "true", help_heading = WHO)]
    insecure: Given<bool>,
    /// The certificate, with those between it and its authority: gRPC is then encrypted.
    #[arg(long, env = "PORTAMENTO_TLS_CERT", value_name = "FILE.pem", help_heading = WHO)]
    tls_cert: Option<PathBuf>,
    /// The key of the certificate.
    #[arg(long, env = "PORTAMENTO_TLS_KEY", value_name = "FILE.pem", help_heading = WHO)]
    tls_key: Option<PathBuf>,
    /// Who vouches for callers: whoever has no certificate of theirs is not let in.
    #[arg(long, env = "PORTAMENTO_TLS_CLIENT_CA", value_name = "FILE.pem", help_heading = WHO)]
    tls_client_ca: Option<PathBuf>,
    /// Who may do what: grants of methods and streams to the names in callers' certificates.
    #[arg(long, env = "PORTAMENTO_POLICY", value_name = "FILE.toml", help_heading = WHO)]
    policy: Option<PathBuf>,
    /// Tell tools what is served, by gRPC's reflection.
    #[arg(long, env = "PORTAMENTO_REFLECTION", value_name = "BOOL", default_value = "true",
        num_args = 0..=1, require_equals = true, default_missing_value = "true", help_heading = WHO)]
    reflection: Given<bool>,
    /// Answer browsers, which speak gRPC-Web over HTTP/1.1.
    #[arg(long, env = "PORTAMENTO_GRPC_WEB", value_name = "BOOL", default_value = "false",
        num_args = 0..=1, require_equals = true, default_missing_value = "true", help_heading = WHO)]
    grpc_web: Given<bool>,
    /// Pages of these origins may call, as https://console.plant; * for any.
    #[arg(long, env = "PORTAMENTO_CORS_ORIGINS", value_name = "ORIGIN,…", help_heading = WHO)]
    cors_origins: Option<Given<List>>,

    /// The largest message that is read or sent [bytes].
    #[arg(long, env = "PORTAMENTO_MAX_MESSAGE_BYTES", value_name = "COUNT", default_value = "67108864", help_heading = LIMITS)]
    max_message_bytes: Given<usize>,
    /// What a stream may hold unread [bytes].
    #[arg(long, env = "PORTAMENTO_STREAM_WINDOW_BYTES", value_name = "COUNT", default_value = "4194304", help_heading = LIMITS)]
    stream_window_bytes: Given<u32>,
    /// What a connection may hold unread [bytes].
    #[arg(long, env = "PORTAMENTO_CONNECTION_WINDOW_BYTES", value_name = "COUNT", default_value = "16777216", help_heading = LIMITS)]
    connection_window_bytes: Given<u32>,
    /// The most connections at a time; more are closed as they come.
    #[arg(long, env = "PORTAMENTO_MAX_CONNECTIONS", value_name = "COUNT", default_value = "10000", help_heading = LIMITS)]
    max_connections: Given<usize>,
    /// The most calls that wait for their answers at a time; open streams are not counted.
    #[arg(long, env = "PORTAMENTO_MAX_CONCURRENT_REQUESTS", value_name = "COUNT", default_value = "1024", help_heading = LIMITS)]
    max_concurrent_requests: Given<usize>,
    /// The most calls that each identity may begin [1/s]; 0: as many as it likes.
    #[arg(long, env = "PORTAMENTO_MAX_REQUEST_RATE", value_name = "RATE", default_value = "0", help_heading = LIMITS)]
    max_request_rate: Given<u32>,
    /// How long the first message of a call may take to come [s]; 0: for ever.
    #[arg(long, env = "PORTAMENTO_FIRST_MESSAGE_DEADLINE", value_name = "SECONDS", default_value = "10", help_heading = LIMITS)]
    first_message_deadline: Given<Seconds>,
    /// How long nothing may be said on a stream [s]; 0: for ever.
    #[arg(long, env = "PORTAMENTO_IDLE_DEADLINE", value_name = "SECONDS", default_value = "600", help_heading = LIMITS)]
    idle_deadline: Given<Seconds>,
    /// How often a silent connection is asked whether it is still there [s].
    #[arg(long, env = "PORTAMENTO_KEEPALIVE_INTERVAL", value_name = "SECONDS", default_value = "10", help_heading = LIMITS)]
    keepalive_interval: Given<Seconds>,
    /// How long it may take to answer that, and to say something after it has connected [s].
    #[arg(long, env = "PORTAMENTO_KEEPALIVE_TIMEOUT", value_name = "SECONDS", default_value = "5", help_heading = LIMITS)]
    keepalive_timeout: Given<Seconds>,

    /// What is logged, as in info,server=debug.
    #[arg(long, env = "RUST_LOG", value_name = "FILTER", default_value = "info", help_heading = LOGS)]
    pub(crate) log: String,
    /// How logs are written.
    #[arg(long, env = "PORTAMENTO_LOG_FORMAT", value_name = "FORMAT", default_value = "text", help_heading = LOGS)]
    pub(crate) log_format: Given<LogFormat>,
    /// An OpenTelemetry collector that takes spans by OTLP over gRPC, as http://127.0.0.1:4317; none by default. Spans that
    /// it does not take within 5 s are lost, and streams do not wait for it.
    #[arg(long, env = "PORTAMENTO_OTLP_ENDPOINT", value_name = "URL", help_heading = LOGS)]
    otlp_endpoint: Option<Given<Collector>>,
    /// Who vouches for the collector: needed where its address begins with https://.
    #[arg(long, env = "PORTAMENTO_OTLP_CA", value_name = "FILE.pem", help_heading = LOGS)]
    otlp_ca: Option<PathBuf>,
}

/// How logs are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    /// For people.
    Text,
    /// For programs: a document a line.
    Json,
}

impl std::str::FromStr for LogFormat {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        ValueEnum::from_str(text, false).map_err(|_| "give text or json")
    }
}

impl Flags {
    /// Where spans go; what is wrong is noted.
    pub(crate) fn collector(&self, misfits: &mut Misfits) -> Option<Collector> {
        let authority = self.otlp_ca.as_deref().map(|path| {
            std::fs::read(path).map_err(|error| {
                let problem = format!("{} cannot be read: {error}: name a PEM file", path.display());
                misfits.note("otlp-ca", problem);
            })
        });
        let Some(given) = self.otlp_endpoint.clone() else {
            if authority.is_some_and(|read| read.is_ok()) {
                misfits.note("otlp-ca", "is given without a collector: give --otlp-endpoint as well");
            }
            return None;
        };
        let collector = given.noted("otlp-endpoint", misfits)?;
        let vouched_for = collector.vouched_for_by(authority.transpose().ok()?);
        vouched_for.map_err(|(setting, problem)| misfits.note(setting, problem)).ok()
    }

    /// The settings of a process that listens at `listen`, and for HTTP at `http`; what is wrong is noted, except what
    /// [`Settings::misfits`] will say.
    pub fn settings(
        self,
        listen: Given<Address>,
        http: Option<Given<SocketAddr>>,
        misfits: &mut Misfits,
    ) -> Settings {
        let usual = Settings::on_port(0);
        let tls =
            tls(self.tls_cert.as_deref(), self.tls_key.as_deref(), self.tls_client_ca.as_deref(), misfits);
        let mut seconds =
            |given: Given<Seconds>, setting, instead| given.or_note(setting, Seconds(instead), misfits).0;
        let drain_deadline = seconds(self.drain_deadline, "drain-deadline", usual.drain_deadline);
        let first_message_deadline =
            seconds(self.first_message_deadline, "first-message-deadline", usual.first_message_deadline);
        let idle_deadline = seconds(self.idle_deadline, "idle-deadline", usual.idle_deadline);
        let keepalive_interval =
            seconds(self.keepalive_interval, "keepalive-interval", usual.keepalive_interval);
        let keepalive_timeout = seconds(self.keepalive_timeout, "keepalive-timeout", usual.keepalive_timeout);
        let policy = self.policy.as_deref().and_then(|path| {
            Policy::read(path).map_err(|error| misfits.note("policy", format!("is none: {error}"))).ok()
        });
        let insecure = self.insecure.or_note("insecure", false, misfits);
        let listen = listen.or_note("listen", usual.listen.clone(), misfits);
        let nowhere = SocketAddr::from(([127, 0, 0, 1], 0));
        let http = http.map(|http| http.or_note("http", nowhere, misfits));
        Settings {
            listen,
            http,
            insecure,
            tls,
            policy,
            reflection: self.reflection.or_note("reflection", true, misfits),
            grpc_web: self.grpc_web.or_note("grpc-web", false, misfits),
            cors_origins: self
                .cors_origins
                .map(|given| given.or_note("cors-origins", List::default(), misfits).0)
                .unwrap_or_default(),
            drain_deadline,
            max_message_bytes: self.max_message_bytes.or_note(
                "max-message-bytes",
                usual.max_message_bytes,
                misfits,
            ),
            stream_window_bytes: self.stream_window_bytes.or_note(
                "stream-window-bytes",
                usual.stream_window_bytes,
                misfits,
            ),
            connection_window_bytes: self.connection_window_bytes.or_note(
                "connection-window-bytes",
                usual.connection_window_bytes,
                misfits,
            ),
            max_connections: self.max_connections.or_note("max-connections", usual.max_connections, misfits),
            max_concurrent_requests: self.max_concurrent_requests.or_note(
                "max-concurrent-requests",
                usual.max_concurrent_requests,
                misfits,
            ),
            max_request_rate: self.max_request_rate.or_note(
                "max-request-rate",
                usual.max_request_rate,
                misfits,
            ),
            first_message_deadline,
            idle_deadline,
            keepalive_interval,
            keepalive_timeout,
        }
    }
}

fn tls(
    certificate: Option<&std::path::Path>,
    key: Option<&std::path::Path>,
    client_ca: Option<&std::path::Path>,
    misfits: &mut Misfits,
) -> Option<Tls> {
    match (certificate, key) {
        (Some(certificate), Some(key)) => Tls::read(certificate, key, client_ca)
            .map_err(|problems| problems.into_iter().for_each(|(setting, said)| misfits.note(setting, said)))
            .ok(),
        (None, None) => {
            if client_ca.is_some() {
                misfits.note(
                    "tls-client-ca",
                    "is given without a certificate: give --tls-cert and --tls-key as well",
                );
            }
            None
        }
        (Some(_), None) => {
            misfits.note("tls-key", "is missing: a certificate serves with its key alone");
            None
        }
        (None, Some(_)) => {
            misfits.note("tls-cert", "is missing: a key serves with its certificate alone");
            None
        }
    }
}
