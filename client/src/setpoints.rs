use std::time::Duration;

use planner::Setpoint;
use proto::Rejected;
use proto::stream::{Motion, Open, Operation, OperationResult, Refused, Source, StreamEvent};

use crate::failover::{Change, Feed, News};
use crate::{Buffer, Client, Error, Next, Playing, Servers, Standing, Uplink};

/// The cycles of a stream, in order, one after the other. Whoever asks for the next one is the clock.
///
/// The stream outlives its server where there is another: see [`failover`](crate::failover).
#[derive(Debug)]
pub struct Setpoints {
    uplink: Uplink,
    buffer: Buffer,
    heeded: u64,
    batch_cycles: u64,
    reported: u64,
    /// Nothing more comes: why.
    over: Option<Result<(), Error>>,
    events: Vec<StreamEvent>,
    changes: Vec<Change>,
    answers: Vec<(String, Result<OperationResult, Rejected>)>,
}

impl Setpoints {
    /// Opens a stream for axes that stand in the first state of the plan, at the server of `client`; if that is lost, the stream is opened
    /// there again.
    ///
    /// # Errors
    /// [`Error::Rejected`] if the server does not take the plan, or has the stream under a newer epoch. [`Error::Protocol`] for a
    /// motion that is under way already.
    pub async fn open(client: &Client, open: Open) -> Result<Self, Error> {
        let endpoints = vec![client.endpoint().to_owned()];
        let servers = Servers { endpoints, connect: client.connected_by().clone(), patience: Duration::ZERO };
        Self::open_at(servers, open).await
    }

    /// The same at one of `servers`, which are tried in order; where the one that serves is lost, another goes on.
    ///
    /// # Errors
    /// That of the last server that was tried.
    pub async fn open_at(servers: Servers, open: Open) -> Result<Self, Error> {
        let Open { epoch, lead_cycles, axis_guard, .. } = open;
        let Source::Plan(plan) = &open.source else {
            return Err(Error::Protocol("a stream is begun with a plan".into()));
        };
        let setpoints: Vec<Setpoint> = plan.plan().sampler().at(0).collect();
        let cycle = plan.plan().cycle_time();
        // At least one report a lead, or the credit would run out unseen.
        let batch_cycles = u64::from(open.batch_cycles.min(open.lead_cycles).max(1));
        let mut uplink = Uplink::new(servers, open, cycle);
        let opened = loop {
            match uplink.next().await {
                Next::News(News::Opened(opened)) => break opened,
                Next::News(News::Over(how)) => {
                    let nobody = || Error::Protocol("no endpoint is given: name at least one".into());
                    return Err(how.err().map_or_else(nobody, |failure| failure.cause));
                }
                Next::News(_) | Next::Feed(_) => {}
            }
        };
        let epoch = uplink.failover().serving_epoch().unwrap_or(epoch);
        let plan = opened.motion.plan();
        let standing = Standing { epoch, lead_cycles, axis_guard, plan, setpoints: &setpoints };
        let mut buffer = Buffer::new(&standing);
        buffer.motion_ends_at(opened.motion.last_cycle());
        Ok(Self {
            uplink,
            buffer,
            heeded: 0,
            batch_cycles,
            reported: 0,
            over: None,
            events: Vec::new(),
            changes: Vec::new(),
            answers: Vec::new(),
        })
    }

    /// The motion that is adopted, with the closing stop of a plan that ends at speed.
    ///
    /// # Panics
    /// Never: a stream that is open has one.
    #[must_use]
    #[expect(clippy::expect_used, reason = "it is there since the stream was opened")]
    pub fn motion(&self) -> &Motion {
        self.uplink.failover().record().expect("a stream that is open").motion()
    }

    /// Asks for an operation on the motion. What becomes of it is among the [answers](Self::take_answers) of one of the cycles
    /// that follow. `false` if the stream is over.
    pub fn operate(&mut self, operation: Operation) -> bool {
        if self.over.is_none() {
            self.uplink.operate(operation);
        }
        self.over.is_none()
    }

    /// What became of operations since the last call, by their ids.
    pub fn take_answers(&mut self) -> Vec<(String, Result<OperationResult, Rejected>)> {
        std::mem::take(&mut self.answers)
    }

    /// Who serves the stream.
    #[must_use]
    pub fn served_by(&self) -> &str {
        self.uplink.failover().served_by()
    }

    /// What has happened since the last call.
    pub fn take_events(&mut self) -> Vec<StreamEvent> {
        std::mem::take(&mut self.events)
    }

    /// Which servers went on since the last call.
    pub fn take_changes(&mut self) -> Vec<Change> {
        std::mem::take(&mut self.changes)
    }

    /// What is held and what was accepted.
    #[must_use]
    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// The next cycle; `None` after the last one of a stream that was opened to close at rest.
    ///
    /// Where nobody serves any more and the motion has not ended, the cycles of the way to rest come, and then the error.
    ///
    /// # Errors
    /// Batches that cannot be taken ([`Error::Protocol`]); a stream that the server ends ([`Error::Rejected`]); a server
    /// that is gone ([`Error::Unreachable`]), with no other that goes on. What was handed out before stays true.
    pub async fn next(&mut self) -> Result<Option<Playing<'_>>, Error> {
        // What replaces cycles that are held is of use only before those are played.
        while self.buffer.held() > 0 && self.over.is_none() {
            let next = tokio::select! {
                biased;
                next = self.uplink.next() => next,
                () = std::future::ready(()) => break,
            };
            self.take(next);
        }
        while self.buffer.held() == 0 {
            if let Some(how) = &self.over {
                match how {
                    Ok(()) => return Ok(None),
                    Err(_) if self.buffer.is_finished() => return Ok(None),
                    Err(_) if self.buffer.starve() => break,
                    Err(error) => return Err(error.clone()),
                }
            }
            let next = self.uplink.next().await;
            self.take(next);
        }
        let due = self.buffer.executed() + 1 >= self.reported + self.batch_cycles;
        self.buffer.play();
        if due || self.buffer.is_finished() {
            self.report(None);
        }
        Ok(self.buffer.playing())
    }

    /// Closes the axis's side: the server finishes.
    pub fn close(&mut self) {
        self.uplink.close();
    }

    fn take(&mut self, next: Next) {
        match next {
            Next::Feed(feed) => self.feed(feed),
            Next::News(News::Opened(_)) => {}
            Next::News(News::Event(event)) => self.events.push(event),
            Next::News(News::Answer(id, answer)) => self.answers.push((id, answer)),
            Next::News(News::FailedOver(change)) => self.changes.push(change),
            Next::News(News::Over(how)) => self.over = Some(how.map_err(|failure| failure.cause)),
        }
    }

    fn feed(&mut self, feed: Feed) {
        match feed {
            Feed::Revised(epoch, revision) => {
                self.buffer.announce(epoch, revision);
            }
            Feed::Batch(epoch, mut batch) => {
                let adopted = self.buffer.revision();
                match self.buffer.accept(epoch, &mut batch) {
                    Err(refused) => self.report(Some(refused)),
                    Ok(()) if self.buffer.revision() != adopted => self.report(None),
                    Ok(()) => {}
                }
            }
            Feed::Resuming => {
                self.buffer.resuming(true);
                self.heeded += 1;
                self.report(None);
            }
            Feed::Stays => self.buffer.resuming(false),
            Feed::GoesOn(epoch, rested) => {
                self.buffer.goes_on(epoch, rested);
                self.report(None);
            }
        }
    }

    fn report(&mut self, refused: Option<Refused>) {
        self.reported = self.buffer.executed();
        self.uplink.report(self.buffer.report(refused), self.heeded);
    }
}
