use std::time::Duration;

use proto::TraceContext;
use tokio_util::sync::CancellationToken;
use tokio_util::task::TaskTracker;
use tracing::Instrument as _;

/// How a process leaves: it says so, and later it goes. Meanwhile it answers, so that whoever asks learns that it leaves.
///
/// ```text
///  SERVING ── told to stop ──► LEAVING ── the deadline ──► GOING ── a farewell ──► gone
///                                  └────── all work has ended ────────────────────►┘
/// ```
#[derive(Clone, Debug, Default)]
pub struct Leaving {
    soon: CancellationToken,
    now: CancellationToken,
    work: TaskTracker,
}

impl Leaving {
    /// Has the process been told to stop? Then no new work begins.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.soon.is_cancelled()
    }

    /// Completes when the process is told to stop: work that is going on is to come to its end, or to move over.
    pub async fn begun(&self) {
        self.soon.cancelled().await;
    }

    /// Completes when the deadline has passed: work that is still going on ends, and says why.
    pub async fn due(&self) {
        self.now.cancelled().await;
    }

    /// Does work that the process waits for before it goes. It belongs to the span and the trace of the call that it is
    /// for.
    pub fn spawn(&self, work: impl Future<Output = ()> + Send + 'static) {
        // Boxed first: on its way to where it stays it is moved a dozen times, and a stream's is some kilobytes.
        self.work.spawn(TraceContext::carried(Box::pin(work)).in_current_span());
    }

    /// Completes when all work has ended, or a while after the deadline.
    pub(crate) async fn leave(self, deadline: Duration) {
        self.soon.cancel();
        self.work.close();
        if tokio::time::timeout(deadline, self.work.wait()).await.is_ok() {
            return;
        }
        tracing::warn!(
            deadline_s = deadline.as_secs_f64(),
            open = self.work.len(),
            "work is still going on at the deadline, leaving"
        );
        self.now.cancel();
        // Long enough to say so; who does not listen is left.
        let _ = tokio::time::timeout(FAREWELL, self.work.wait()).await;
    }
}

/// How long it may take to tell whoever is still there that they are left, and connections that they are closed.
pub(crate) const FAREWELL: Duration = Duration::from_millis(500);
