//! Who is let in, before a service sees anything of him: by policy, by how much he asks, by how much there is to do.

use std::convert::Infallible;
use std::num::NonZeroU32;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll, ready};
use std::time::Duration;

use governor::clock::{Clock as _, DefaultClock};
use governor::{DefaultKeyedRateLimiter, Quota, RateLimiter};
use pin_project_lite::pin_project;
use proto::{Reason, Rejected};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};
use tonic::Status;
use tonic::body::Body;
use tonic::codegen::{Service, http};
use tower::Layer;

use crate::caller::Caller;
use crate::policy::Policy;

/// Something that a request has to pass.
pub(crate) trait Check: Clone {
    /// What the request holds until it is answered.
    type Held;

    /// Lets the request pass, or says why not.
    fn check(&self, request: &mut http::Request<Body>) -> Result<Self::Held, Rejected>;
}

/// Finds out who calls, and whether he may.
#[derive(Clone, Debug)]
pub(crate) struct Permission {
    policy: Option<Arc<Policy>>,
}

impl Permission {
    pub(crate) fn by(policy: Option<Policy>) -> Self {
        Self { policy: policy.map(Arc::new) }
    }
}

impl Check for Permission {
    type Held = ();

    fn check(&self, request: &mut http::Request<Body>) -> Result<(), Rejected> {
        let caller = Caller::of_connection(request.extensions(), self.policy.as_ref());
        caller.may_call(request.uri().path().trim_start_matches('/'))?;
        request.extensions_mut().insert(caller);
        Ok(())
    }
}

/// How many calls each identity may begin a second.
#[derive(Clone)]
pub(crate) struct Rate {
    limiter: Option<Arc<DefaultKeyedRateLimiter<String>>>,
    most: u32,
}

impl Rate {
    /// At most `most` calls a second, as many of them at once; 0: as many as they like.
    pub(crate) fn of(most: u32) -> Self {
        let quota = NonZeroU32::new(most).map(Quota::per_second);
        Self { limiter: quota.map(|quota| Arc::new(RateLimiter::keyed(quota))), most }
    }
}

impl Check for Rate {
    type Held = ();

    fn check(&self, request: &mut http::Request<Body>) -> Result<(), Rejected> {
        let Some(limiter) = &self.limiter else { return Ok(()) };
        let identity = request.extensions().get::<Caller>().and_then(Caller::identity).unwrap_or_default();
        let Err(until) = limiter.check_key(&identity.to_owned()) else { return Ok(()) };
        let wait = until.wait_time_from(DefaultClock::default().now());
        let text = format!(
            "this caller begins more than {most} calls a second, as many as this server takes of each: ask again after the \
             time that is named, ask for more at a time, or raise the server's max_request_rate",
            most = self.most
        );
        let rejected = Rejected::new(Reason::Overloaded, text).with("allowed", self.most);
        Err(rejected.with("limit", "max_request_rate").retry_after(wait))
    }
}

/// How many calls may wait for their answers at once. Streams that are open do not count: what they need is theirs.
#[derive(Clone, Debug)]
pub(crate) struct Room {
    room: Arc<Semaphore>,
    most: usize,
}

impl Room {
    pub(crate) fn of(most: usize) -> Self {
        Self { room: Arc::new(Semaphore::new(most.min(Semaphore::MAX_PERMITS))), most }
    }
}

impl Check for Room {
    type Held = OwnedSemaphorePermit;

    fn check(&self, _: &mut http::Request<Body>) -> Result<OwnedSemaphorePermit, Rejected> {
        Arc::clone(&self.room).try_acquire_owned().map_err(|_| {
            let most = self.most;
            let text = format!(
                "{most} calls wait for their answers, as many as this server takes at once: ask again after the time that \
                 is named, ask another replica, or raise the server's max_concurrent_requests"
            );
            let rejected = Rejected::new(Reason::Overloaded, text).with("allowed", most);
            rejected.with("limit", "max_concurrent_requests").retry_after(SOON)
        })
    }
}

/// How long what is being done takes to become less.
const SOON: Duration = Duration::from_millis(100);

/// A [`Check`] as a layer.
#[derive(Clone, Debug)]
pub(crate) struct CheckLayer<C>(pub(crate) C);

/// A service behind a [`Check`].
#[derive(Clone, Debug)]
pub(crate) struct Checked<C, S> {
    check: C,
    inner: S,
}

impl<C: Check, S> Layer<S> for CheckLayer<C> {
    type Service = Checked<C, S>;

    fn layer(&self, inner: S) -> Self::Service {
        Checked { check: self.0.clone(), inner }
    }
}

pin_project! {
    /// An answer of the service, or the refusal that stands for it.
    #[project = Projected]
    pub(crate) enum Answer<F, H> {
        Passed { #[pin] answer: F, held: Option<H> },
        Refused { refusal: Option<Rejected> },
    }
}

impl<C, S> Service<http::Request<Body>> for Checked<C, S>
where
    C: Check,
    S: Service<http::Request<Body>, Response = http::Response<Body>, Error = Infallible>,
{
    type Response = http::Response<Body>;
    type Error = Infallible;
    type Future = Answer<S::Future, C::Held>;

    fn poll_ready(&mut self, cx: &mut Context<'_>) -> Poll<Result<(), Infallible>> {
        self.inner.poll_ready(cx)
    }

    fn call(&mut self, mut request: http::Request<Body>) -> Self::Future {
        match self.check.check(&mut request) {
            Ok(held) => Answer::Passed { answer: self.inner.call(request), held: Some(held) },
            Err(rejected) => Answer::Refused { refusal: Some(rejected) },
        }
    }
}

impl<F, H> Future for Answer<F, H>
where
    F: Future<Output = Result<http::Response<Body>, Infallible>>,
{
    type Output = F::Output;

    fn poll(self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<Self::Output> {
        match self.project() {
            Projected::Passed { answer, held } => {
                let answer = ready!(answer.poll(cx));
                *held = None;
                Poll::Ready(answer)
            }
            Projected::Refused { refusal } => match refusal.take() {
                Some(rejected) => Poll::Ready(Ok(Status::from(rejected).into_http())),
                None => Poll::Pending,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn request() -> http::Request<Body> {
        http::Request::new(Body::empty())
    }

    #[test]
    fn what_is_too_much_is_said_with_the_time_to_wait() {
        let rate = Rate::of(2);
        assert!(rate.check(&mut request()).is_ok() && rate.check(&mut request()).is_ok());
        let rejected = rate.check(&mut request()).unwrap_err();
        assert_eq!(rejected.reason, Reason::Overloaded);
        let wait = rejected.retry_delay().unwrap();
        assert!(wait > Duration::ZERO && wait <= Duration::from_millis(500), "{wait:?}");
        assert!(Rate::of(0).check(&mut request()).is_ok());
        let room = Room::of(1);
        let held = room.check(&mut request()).unwrap();
        let rejected = room.check(&mut request()).unwrap_err();
        assert_eq!((rejected.reason, rejected.retry_delay()), (Reason::Overloaded, Some(SOON)));
        drop(held);
        assert!(room.check(&mut request()).is_ok());
    }
}
