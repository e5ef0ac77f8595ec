use planner::Setpoint;
use proto::Rejected;
use proto::stream::{
    Batch, FromAxis, Motion, Open, Operation, OperationRefusal, OperationResult, Refused, StreamEvent,
    StreamEventKind, ToAxis,
};

use crate::{Buffer, Client, Error, Link, Playing, Reports, Revision, Standing};

/// The cycles of a stream, in order, one after the other. Whoever asks for the next one is the clock.
#[derive(Debug)]
pub struct Setpoints {
    reports: Option<Reports>,
    link: Link,
    buffer: Buffer,
    motion: Motion,
    /// What the server will play next.
    announced: Option<Motion>,
    /// How the server's side ended, where that was seen before it was asked for.
    ended: Option<Result<(), Error>>,
    served_by: String,
    batch_cycles: u64,
    reported: u64,
    events: Vec<StreamEvent>,
    answers: Vec<(String, Result<OperationResult, Rejected>)>,
}

impl Setpoints {
    /// Opens a stream for axes that stand in the first state of the plan.
    ///
    /// # Errors
    /// [`Error::Rejected`] if the server does not take the plan, or has the stream under a newer epoch.
    pub async fn open(client: &Client, open: Open) -> Result<Self, Error> {
        let Open { epoch, lead_cycles, axis_guard, .. } = open;
        let setpoints: Vec<Setpoint> = open.plan.plan().sampler().at(0).collect();
        // At least one report a lead, or the credit would run out unseen.
        let batch_cycles = u64::from(open.batch_cycles.min(open.lead_cycles).max(1));
        let (reports, mut link) = client.open(open).await?;
        let Some((_, ToAxis::Opened(opened))) = link.next().await? else {
            return Err(Error::Protocol("the first message does not open the stream".into()));
        };
        let motion = opened.motion;
        let plan = motion.plan();
        let standing = Standing { epoch, lead_cycles, axis_guard, plan, setpoints: &setpoints };
        Ok(Self {
            reports: Some(reports),
            link,
            buffer: Buffer::new(&standing),
            motion,
            announced: None,
            ended: None,
            served_by: opened.served_by,
            batch_cycles,
            reported: 0,
            events: Vec::new(),
            answers: Vec::new(),
        })
    }

    /// The motion that is adopted, with the closing stop of a plan that ends at speed.
    #[must_use]
    pub fn motion(&self) -> &Motion {
        &self.motion
    }

    /// Asks for an operation on the motion. What becomes of it is among the [answers](Self::take_answers) of one of the cycles
    /// that follow. `false` if the stream is over.
    pub async fn operate(&self, operation: Operation) -> bool {
        match &self.reports {
            Some(reports) => reports.say(&FromAxis::Operation(operation)).await,
            None => false,
        }
    }

    /// What became of operations since the last call, by their ids.
    pub fn take_answers(&mut self) -> Vec<(String, Result<OperationResult, Rejected>)> {
        std::mem::take(&mut self.answers)
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
        // What replaces cycles that are held is of use only before those are played.
        while self.buffer.held() > 0 && self.receive_if_there().await? {}
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
            self.report(None).await;
        }
        Ok(self.buffer.playing())
    }

    /// Closes the axis's side: the server finishes.
    pub fn close(&mut self) {
        self.reports = None;
    }

    /// Takes one message if it has come; `false` if not.
    async fn receive_if_there(&mut self) -> Result<bool, Error> {
        if self.ended.is_some() {
            return Ok(false);
        }
        let message = tokio::select! {
            biased;
            message = self.link.next() => message,
            () = std::future::ready(()) => return Ok(false),
        };
        match message {
            Ok(Some((epoch, message))) => return self.take(epoch, message).await.map(|()| true),
            Ok(None) => self.ended = Some(Ok(())),
            Err(error) => self.ended = Some(Err(error)),
        }
        Ok(false)
    }

    /// Takes one message; `false` when there is none any more.
    async fn receive(&mut self) -> Result<bool, Error> {
        let message = match self.ended.take() {
            Some(how) => how.map(|()| None)?,
            None => self.link.next().await?,
        };
        let Some((epoch, message)) = message else {
            let finished = self.buffer.is_finished() || self.reports.is_none();
            let nothing_moves = self.events.iter().any(|event| event.kind == StreamEventKind::Finished);
            if finished || nothing_moves {
                return Ok(false);
            }
            return Err(Error::Protocol("the stream ended before the motion did".into()));
        };
        self.take(epoch, message).await.map(|()| true)
    }

    async fn take(&mut self, epoch: u64, message: ToAxis) -> Result<(), Error> {
        match message {
            ToAxis::Opened(_) => return Err(Error::Protocol("the stream was opened twice".into())),
            ToAxis::Revised(revised) => {
                self.buffer.announce(epoch, Revision::of(&revised.motion));
                self.announced = Some(revised.motion);
            }
            ToAxis::Batch(batch) => self.accept(epoch, &batch).await?,
            ToAxis::Event(event) => self.events.push(event),
            ToAxis::Result(result) => self.answers.push((result.request_id.clone(), Ok(result))),
            ToAxis::Refusal(OperationRefusal { request_id, rejected }) => {
                self.answers.push((request_id, Err(rejected)));
            }
        }
        Ok(())
    }

    async fn accept(&mut self, epoch: u64, batch: &Batch) -> Result<(), Error> {
        let adopted = self.buffer.revision();
        if let Err(refused) = self.buffer.accept(epoch, batch) {
            // A splice that came too late is planned again, with what followed on it; the motion goes on as it was.
            return match &self.reports {
                Some(_) if self.buffer.awaits_revision() => {
                    self.report(Some(refused)).await;
                    Ok(())
                }
                _ => Err(Error::refused(&refused)),
            };
        }
        if self.buffer.revision() != adopted {
            if let Some(announced) = self.announced.take() {
                self.motion = announced;
            }
            self.report(None).await;
        }
        Ok(())
    }

    async fn report(&mut self, refused: Option<Refused>) {
        self.reported = self.buffer.executed();
        let report = self.buffer.report(refused);
        if let Some(reports) = &self.reports {
            // A stream that is over says so when it is read.
            reports.send(&report).await;
        }
    }
}
