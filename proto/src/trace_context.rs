use std::fmt;
use std::str::FromStr;

use tonic::metadata::{Ascii, MetadataValue};

/// To what a call belongs, over all processes that have to do with it: the header `traceparent`.
///
/// Source: W3C Trace Context, Level 1, §3.2: version 00, an id of the trace, one of the caller's span, and whether it is
/// recorded, all in lower-case hexadecimal.
///
/// ```
/// # use proto::TraceContext;
/// let header = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";
/// let caller: TraceContext = header.parse()?;
/// assert_eq!(caller.to_string(), header);
/// assert_eq!(caller.child().trace_id(), "4bf92f3577b34da6a3ce929d0e0e4736");
/// # Ok::<(), proto::InvalidTraceContext>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceContext {
    trace: u128,
    span: u64,
    flags: u8,
}

/// A header that is no `traceparent` of version 00.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{given:?} is no traceparent: write it as 00-<32 digits>-<16 digits>-<2 digits>, in lower-case hexadecimal"
)]
pub struct InvalidTraceContext {
    /// As it was given.
    pub given: String,
}

tokio::task_local! {
    static CURRENT: Option<TraceContext>;
}

impl TraceContext {
    /// The name of the header.
    pub const HEADER: &str = "traceparent";

    /// The beginning of a trace.
    #[must_use]
    pub fn begin() -> Self {
        // An id of zeros is none.
        Self { trace: fastrand::u128(1..), span: fastrand::u64(1..), flags: RECORDED }
    }

    /// From the ids of spans that somebody else makes.
    #[must_use]
    pub fn from_ids(trace: u128, span: u64, is_recorded: bool) -> Option<Self> {
        let flags = if is_recorded { RECORDED } else { 0 };
        (trace != 0 && span != 0).then_some(Self { trace, span, flags })
    }

    /// The ids of trace and span, and whether they are recorded.
    #[must_use]
    pub fn ids(self) -> (u128, u64, bool) {
        (self.trace, self.span, self.flags & RECORDED != 0)
    }

    /// The next step of the same trace.
    #[must_use]
    pub fn child(self) -> Self {
        Self { span: fastrand::u64(1..), ..self }
    }

    /// The trace that this task works for, where there is one.
    #[must_use]
    pub fn current() -> Option<Self> {
        CURRENT.try_with(|current| *current).ok().flatten()
    }

    /// What is to be sent with a call that this task makes: the step of the trace that the task works for, below which whoever is
    /// called hangs his own, or the beginning of one.
    #[must_use]
    pub fn for_call() -> Self {
        // An id of its own for the call would be that of a span that nobody tells of: whoever reads the trace would miss it.
        Self::current().unwrap_or_else(Self::begin)
    }

    /// Does `work` for this trace. Tasks that the work spawns are told by [`carried`](Self::carried).
    pub async fn scope<T>(self, work: impl Future<Output = T>) -> T {
        CURRENT.scope(Some(self), work).await
    }

    /// `work`, to be spawned, for the trace that the spawning task works for.
    pub fn carried<T>(work: impl Future<Output = T>) -> impl Future<Output = T> {
        // No `async` block: it would hold the work a second time, and a stream's is some kilobytes.
        CURRENT.scope(Self::current(), work)
    }

    /// The id of the trace, as logs show it.
    #[must_use]
    pub fn trace_id(self) -> String {
        format!("{:032x}", self.trace)
    }

    /// As a header.
    #[must_use]
    pub fn to_header(self) -> Option<MetadataValue<Ascii>> {
        self.to_string().parse().ok()
    }
}

impl fmt::Display for TraceContext {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { trace, span, flags } = self;
        write!(f, "00-{trace:032x}-{span:016x}-{flags:02x}")
    }
}

impl FromStr for TraceContext {
    type Err = InvalidTraceContext;

    fn from_str(given: &str) -> Result<Self, InvalidTraceContext> {
        let invalid = || InvalidTraceContext { given: given.chars().take(MOST_SHOWN).collect() };
        let mut parts = given.split('-');
        let mut part = |digits: usize| {
            let text = parts.next().filter(|text| text.len() == digits)?;
            let is_hex = text.bytes().all(|byte| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte));
            is_hex.then(|| u128::from_str_radix(text, 16).ok()).flatten()
        };
        let (version, trace, span, flags) = (part(2), part(32), part(16), part(2));
        let this = match (version, trace, span, flags, parts.next()) {
            (Some(0), Some(trace), Some(span), Some(flags), None) if trace != 0 && span != 0 => {
                Self { trace, span: span as u64, flags: flags as u8 }
            }
            _ => return Err(invalid()),
        };
        Ok(this)
    }
}

/// The only flag of version 00.
const RECORDED: u8 = 1;
/// How much of a header that is none is shown.
const MOST_SHOWN: usize = 80;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_traceparent_is_none() {
        let trace = "4bf92f3577b34da6a3ce929d0e0e4736";
        for bad in [
            String::new(),
            format!("01-{trace}-00f067aa0ba902b7-01"),
            format!("00-{trace}-00f067aa0ba902b7"),
            format!("00-{trace}-00f067aa0ba902b7-01-x"),
            format!("00-{trace}-0000000000000000-01"),
            format!("00-{}-00f067aa0ba902b7-01", "0".repeat(32)),
            format!("00-{}-00f067aa0ba902b7-01", trace.to_uppercase()),
            format!("00-+{}-00f067aa0ba902b7-01", &trace[1..]),
        ] {
            assert!(bad.parse::<TraceContext>().is_err(), "{bad}");
        }
    }

    #[tokio::test]
    async fn a_call_belongs_to_the_trace_of_its_task() {
        assert_eq!(TraceContext::current(), None);
        let trace = TraceContext::begin();
        let (called, spawned) = trace
            .scope(async {
                let spawned = tokio::spawn(TraceContext::carried(async { TraceContext::current() }));
                (TraceContext::for_call(), spawned.await.unwrap())
            })
            .await;
        assert_eq!((called, spawned), (trace, Some(trace)));
        let step = trace.child();
        assert_eq!(step.trace_id(), trace.trace_id());
        assert_ne!(step, trace);
    }
}
