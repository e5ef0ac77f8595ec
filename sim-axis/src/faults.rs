//! Faults that are made on purpose, to see what an axis does.

use std::time::Duration;

use tokio::sync::broadcast;
use tokio::time::Instant;

/// What goes wrong, in every run that goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Nothing is read from the stream for so long: batches wait where they are.
    StallReads(Duration),
    /// So many batches are lost, the next ones that come.
    DropBatches(u32),
    /// No report is sent for so long; the axis plays on.
    PauseReports(Duration),
    /// Drives have this share of their greatest effort, 0 to 1; 1 is as configured.
    EffortLimitScale(f64),
}

/// Tells the runs of a process what goes wrong. Clones tell the same runs.
#[derive(Clone, Debug)]
pub struct Faults {
    teller: broadcast::Sender<Fault>,
}

/// Faults that a run has not taken up; more than anybody makes at once.
const WAITING: usize = 64;

impl Default for Faults {
    fn default() -> Self {
        Self { teller: broadcast::Sender::new(WAITING) }
    }
}

impl PartialEq for Faults {
    /// Do they tell the same runs?
    fn eq(&self, other: &Self) -> bool {
        self.teller.same_channel(&other.teller)
    }
}

impl Faults {
    /// Lets `fault` happen; gives how many runs it happens to.
    pub fn make(&self, fault: Fault) -> usize {
        // Nobody to tell is no run.
        self.teller.send(fault).unwrap_or(0)
    }

    pub(crate) fn of_a_run(&self) -> Ailing {
        Ailing { told: Some(self.teller.subscribe()), ..Ailing::default() }
    }
}

/// What is wrong with a run just now.
#[derive(Debug, Default)]
pub(crate) struct Ailing {
    /// `None`: nothing ever goes wrong.
    told: Option<broadcast::Receiver<Fault>>,
    stalled_until: Option<Instant>,
    silent_until: Option<Instant>,
    to_drop: u32,
}

impl Ailing {
    /// Is nothing to be read?
    pub(crate) fn is_stalled(&self) -> bool {
        self.stalled_until.is_some()
    }

    /// Is nothing to be said?
    pub(crate) fn is_silent(&self) -> bool {
        self.silent_until.is_some()
    }

    /// Is the batch that has come to be lost?
    pub(crate) fn drops(&mut self) -> bool {
        let drops = self.to_drop > 0;
        self.to_drop = self.to_drop.saturating_sub(1);
        drops
    }

    /// Waits until something changes; gives the share of its effort that a drive has from now on, where that does.
    pub(crate) async fn changes(&mut self) -> Option<f64> {
        let Self { told, stalled_until, silent_until, .. } = self;
        let heals = [*stalled_until, *silent_until].into_iter().flatten().min();
        let healed = async {
            match heals {
                Some(at) => tokio::time::sleep_until(at).await,
                None => std::future::pending().await,
            }
        };
        let told = async {
            loop {
                match told {
                    Some(told) => match told.recv().await {
                        Ok(fault) => return fault,
                        // The oldest are lost, as those are that come before the run.
                        Err(broadcast::error::RecvError::Lagged(_)) => {}
                        Err(broadcast::error::RecvError::Closed) => std::future::pending().await,
                    },
                    None => std::future::pending().await,
                }
            }
        };
        let fault = tokio::select! {
            fault = told => fault,
            () = healed => {
                let now = Instant::now();
                stalled_until.take_if(|until| *until <= now);
                silent_until.take_if(|until| *until <= now);
                return None;
            }
        };
        match fault {
            Fault::StallReads(time) => self.stalled_until = Some(Instant::now() + time),
            Fault::PauseReports(time) => self.silent_until = Some(Instant::now() + time),
            Fault::DropBatches(count) => self.to_drop = self.to_drop.saturating_add(count),
            Fault::EffortLimitScale(scale) => return Some(scale),
        }
        None
    }
}
