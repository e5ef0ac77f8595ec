//! The figures that `/metrics` shows. They are those of the whole process: whatever serves in it adds to them.

use std::sync::OnceLock;
use std::time::Duration;

use metrics_exporter_prometheus::{Matcher, PrometheusBuilder, PrometheusHandle};

/// Where figures are kept; `None` where somebody else has taken their place, and then they are his to show.
static KEPT: OnceLock<Option<PrometheusHandle>> = OnceLock::new();

/// Durations from a microsecond to a minute [s], for what is named `…_seconds`: a plan takes microseconds, an operation
/// some cycles, a drain some seconds.
const SECONDS: [f64; 16] =
    [1e-6, 2.5e-6, 5e-6, 1e-5, 2.5e-5, 5e-5, 1e-4, 2.5e-4, 5e-4, 1e-3, 2.5e-3, 1e-2, 5e-2, 0.25, 1.0, 10.0];
/// Counts of cycles, for what is named `…_cycles`: leads, and how long operations take.
const CYCLES: [f64; 12] = [1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 40.0, 60.0, 100.0, 250.0, 4096.0];

/// Begins to keep figures. What resolved a counter before has one that nobody reads, so this comes first.
pub(crate) fn keep() {
    KEPT.get_or_init(|| {
        let builder = PrometheusBuilder::new()
            .set_buckets_for_metric(Matcher::Suffix("_seconds".into()), &SECONDS)
            .and_then(|builder| builder.set_buckets_for_metric(Matcher::Suffix("_cycles".into()), &CYCLES));
        match builder.map_err(|e| e.to_string()).and_then(|b| b.install_recorder().map_err(|e| e.to_string()))
        {
            Ok(handle) => Some(handle),
            Err(error) => {
                tracing::warn!(%error, "no figures are kept");
                None
            }
        }
    });
}

/// All figures, as text.
pub(crate) fn figures() -> String {
    KEPT.get().and_then(Option::as_ref).map(PrometheusHandle::render).unwrap_or_default()
}

/// Takes up what was recorded, so that it does not pile up where nobody asks; until it is dropped.
pub(crate) async fn take_up() {
    let Some(handle) = KEPT.get().and_then(Option::as_ref) else { return std::future::pending().await };
    let mut due = tokio::time::interval(UPKEEP);
    due.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
    loop {
        due.tick().await;
        handle.run_upkeep();
    }
}

/// How long records may pile up.
const UPKEEP: Duration = Duration::from_secs(5);
