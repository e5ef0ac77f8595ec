use planner::Setpoint;
use proto::stream::{Motion, Open, StreamEvent, StreamEventKind, ToAxis};

use crate::{Buffer, Client, Error, Link, Playing, Reports, Standing};

/// The cycles of a stream, in order, one after the other. Whoever asks for the next one is the clock.
#[derive(Debug)]
pub struct Setpoints {
    reports: Option<Reports>,
    link: Link,
    buffer: Buffer,
    motion: Option<Motion>,
    served_by: String,
    batch_cycles: u64,
    reported: u64,
    events: Vec<StreamEvent>,
}

impl Setpoints {
    /// Opens a stream for axes that stand in the first state of the plan.
    ///
    /// # Errors
    /// [`Error::Rejected`] if the server does not take the plan, or has the stream under a newer epoch.
    pub async fn open(client: &Client, open: Open) -> Result<Self, Error> {
        let plan = open.plan.plan();
        let setpoints: Vec<Setpoint> = plan.sampler().at(0).collect();
        let buffer = Buffer::new(&Standing {
            epoch: open.epoch,
            lead_cycles: open.lead_cycles,
            axis_guard: open.axis_guard,
            plan,
            setpoints: &setpoints,
        });
        // At least one report a lead, or the credit would run out unseen.
        let batch_cycles = u64::from(open.batch_cycles.min(open.lead_cycles).max(1));
        let (reports, link) = client.open(open).await?;
        let mut stream = Self {
            reports: Some(reports),
            link,
            buffer,
            motion: None,
            served_by: String::new(),
            batch_cycles,
            reported: 0,
            events: Vec::new(),
        };
        while stream.motion.is_none() {
            stream.receive().await?;
        }
        Ok(stream)
    }

    /// The motion that is played, with the closing stop of a plan that ends at speed.
    #[must_use]
    pub fn motion(&self) -> Option<&Motion> {
        self.motion.as_ref()
    }

    /// Who serves the stream.
    #[must_use]
    pub fn served_by(&self) -> &str {
        &self.served_by
    }

    /// What has happened since the last call.
    pub fn take_events(&mut self) -> Vec<StreamEvent> {
        std::mem::take(&mut self.events)
    }

    /// What is held and what was accepted.
    #[must_use]
    pub fn buffer(&self) -> &Buffer {
        &self.buffer
    }

    /// The next cycle; `None` after the last one of a stream that was opened to close at rest.
    ///
    /// # Errors
    /// A gap, a jump, a wrong digest ([`Error::Protocol`]); a stream that the server ends ([`Error::Rejected`]); a server
    /// that is gone ([`Error::Unreachable`]). What was handed out before stays true.
    pub async fn next(&mut self) -> Result<Option<Playing<'_>>, Error> {
        while self.buffer.held() == 0 {
            match self.receive().await {
                Ok(true) => {}
                Ok(false) => return Ok(None),
                // Everything is played: how the farewell goes does not matter any more.
                Err(_) if self.buffer.is_finished() => return Ok(None),
                Err(error) => return Err(error),
            }
        }
        let due = self.buffer.executed() + 1 >= self.reported + self.batch_cycles;
        self.buffer.play();
        if due || self.buffer.is_finished() {
            self.reported = self.buffer.executed();
            let report = self.buffer.report(None);
            if let Some(reports) = &self.reports {
                // A stream that is over says so when it is read.
                reports.send(&report).await;
            }
        }
        Ok(self.buffer.playing())
    }

    /// Closes the axis's side: the server finishes.
    pub fn close(&mut self) {
        self.reports = None;
    }

    /// Takes one message; `false` when there is none any more.
    async fn receive(&mut self) -> Result<bool, Error> {
        let Some((epoch, message)) = self.link.next().await? else {
            let finished = self.buffer.is_finished() || self.reports.is_none();
            let nothing_moves = self.events.iter().any(|event| event.kind == StreamEventKind::Finished);
            if finished || nothing_moves {
                return Ok(false);
            }
            return Err(Error::Protocol("the stream ended before the motion did".into()));
        };
        match message {
            ToAxis::Opened(opened) => {
                self.served_by = opened.served_by;
                self.motion = Some(opened.motion);
            }
            ToAxis::Revised(revised) => self.motion = Some(revised.motion),
            ToAxis::Batch(batch) => {
                self.buffer.accept(epoch, &batch).map_err(|refused| Error::refused(&refused))?;
            }
            ToAxis::Event(event) => self.events.push(event),
            ToAxis::Refusal(refusal) => return Err(Error::Rejected(Box::new(refusal.rejected))),
        }
        Ok(true)
    }
}
