//! Logs on standard error, and spans for a collector where there is one.

use std::io::IsTerminal as _;

use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt;
use tracing_subscriber::{EnvFilter, Layer as _, Registry};

use crate::collector::Collector;
use crate::flags::{Flags, LogFormat};
use crate::settings::Misfits;

#[cfg(feature = "otlp")]
use crate::export::{Export, export};

/// What has to be handed over before the process goes.
#[cfg(not(feature = "otlp"))]
#[derive(Debug)]
pub(crate) struct Export;

#[cfg(not(feature = "otlp"))]
impl Export {
    pub(crate) fn none() -> Self {
        Self
    }

    pub(crate) fn end(self) {}
}

/// Begins to log. What is wrong with the settings is noted, and then logs are as by default.
pub(crate) fn begin(name: &str, flags: &Flags, misfits: &mut Misfits) -> Export {
    let filter = EnvFilter::try_new(&flags.log).unwrap_or_else(|error| {
        misfits.note("log", format!("is {:?}: {error}: write it as info or info,server=debug", flags.log));
        "info".into()
    });
    let format = flags.log_format.clone().or_note("log-format", LogFormat::Text, misfits);
    let written = tracing_subscriber::fmt::layer().with_writer(std::io::stderr);
    let written = match format {
        // In colour where somebody looks on, and plain in files.
        LogFormat::Text => {
            let wants_plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
            written.with_ansi(std::io::stderr().is_terminal() && !wants_plain).boxed()
        }
        LogFormat::Json => written.json().flatten_event(true).boxed(),
    };
    let written = Registry::default().with(written.with_filter(filter));
    match flags.collector(misfits) {
        None => {
            written.init();
            Export::none()
        }
        Some(collector) => exporting(name, &collector, written, misfits),
    }
}

#[cfg(feature = "otlp")]
fn exporting<S>(name: &str, collector: &Collector, written: S, misfits: &mut Misfits) -> Export
where
    S: tracing::Subscriber + for<'a> tracing_subscriber::registry::LookupSpan<'a> + Send + Sync,
{
    match export(name, collector) {
        Ok((layer, export)) => {
            written.with(layer).init();
            export
        }
        Err(problem) => {
            misfits.note("otlp-endpoint", format!("cannot be sent to: {problem}"));
            written.init();
            Export::none()
        }
    }
}

#[cfg(not(feature = "otlp"))]
fn exporting(_: &str, _: &Collector, written: impl SubscriberInitExt, misfits: &mut Misfits) -> Export {
    let problem = "is given, and this binary exports nothing: build it with the feature otlp, as by default";
    misfits.note("otlp-endpoint", problem);
    written.init();
    Export::none()
}
