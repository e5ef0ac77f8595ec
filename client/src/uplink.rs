use std::collections::{HashMap, VecDeque};
use std::pin::Pin;
use std::time::Duration;

use planner::CycleTime;
use proto::stream::{FromAxis, Open, Operation, Report, ToAxis};
use proto::{TraceContext, pb};
use tokio::sync::mpsc;
use tokio::task::{AbortHandle, JoinSet};
use tokio::time::{Instant, Sleep};

use crate::failover::{Action, Failover, Feed, News};
use crate::{Client, Error, Link, Servers, link};

/// What comes next on a stream, whoever serves it.
#[derive(Debug)]
pub enum Next {
    /// For the buffer.
    Feed(Feed),
    /// For whoever runs the axis.
    News(News),
}

/// A stream over gRPC that outlives its servers: [`Failover`], and the connections that it asks for.
///
/// Whoever owns the buffer takes what comes [next](Self::next) to it, and [reports](Self::report) how far the axis is.
#[derive(Debug)]
pub struct Uplink {
    core: Failover,
    begun: Instant,
    servers: Servers,
    /// Connections that are open and wait to be needed.
    warm: HashMap<usize, Client>,
    warming: JoinSet<(usize, Option<Client>)>,
    lines: HashMap<u64, Line>,
    opening: JoinSet<(u64, Result<FirstHeard, Error>)>,
    serving: Option<(u64, Link)>,
    /// What is to be handed out, in order.
    ready: VecDeque<Next>,
    /// What is to be said to servers that do not take it up just now, in order, with the epochs of their streams.
    unsent: VecDeque<(u64, FromAxis)>,
    /// Set to when something is due, or to an earlier time: what comes puts it off nearly always, and a timer is dearer than to be
    /// woken for nothing now and then.
    alarm: Option<Pin<Box<Sleep>>>,
    /// Has a server been asked?
    has_tried: bool,
}

/// The axis's side of a stream, or of one that is being opened.
#[derive(Debug)]
struct Line {
    outgoing: mpsc::Sender<pb::StreamSetpointsRequest>,
    opening: AbortHandle,
    endpoint: usize,
}

/// A stream, and the first that its server has said.
type FirstHeard = (Link, ToAxis);

async fn first_heard(
    client: &Client,
    requests: mpsc::Receiver<pb::StreamSetpointsRequest>,
) -> Result<FirstHeard, Error> {
    let mut link = client.open_with(requests).await?;
    match link.next().await? {
        Some((_, message)) => Ok((link, message)),
        None => Err(Error::Protocol("the stream ended before it was opened".into())),
    }
}

/// What has happened.
enum Happened {
    Heard(u64, Result<Option<(u64, ToAxis)>, Error>),
    Opened(u64, Result<FirstHeard, Error>),
    Warmed(usize, Option<Client>),
    /// There is room for what is unsent.
    Room,
    Woken,
}

impl Uplink {
    /// Begins to open a stream at one of `servers`, in their order. What comes of it is told [next](Self::next).
    #[must_use]
    pub fn new(servers: Servers, open: Open, cycle: CycleTime) -> Self {
        let Servers { endpoints, patience, .. } = &servers;
        Self {
            core: Failover::new(Duration::ZERO, open, cycle, endpoints.len(), *patience),
            begun: Instant::now(),
            servers,
            warm: HashMap::new(),
            warming: JoinSet::new(),
            lines: HashMap::new(),
            opening: JoinSet::new(),
            serving: None,
            ready: VecDeque::new(),
            unsent: VecDeque::new(),
            alarm: None,
            has_tried: false,
        }
    }

    /// What was decided so far.
    #[must_use]
    pub fn failover(&self) -> &Failover {
        &self.core
    }

    /// The endpoint of that number, as it was given.
    #[must_use]
    pub fn endpoint(&self, number: usize) -> &str {
        self.servers.endpoints.get(number).map_or("", String::as_str)
    }

    /// The axis says how far it is; `heeded` counts the times that it took up [`Feed::Resuming`].
    pub fn report(&mut self, report: Report, heeded: u64) {
        self.core.reported(self.begun.elapsed(), report, heeded);
        self.act();
    }

    /// Asks for an operation. What becomes of it is told, also where another server goes on in the meantime.
    pub fn operate(&mut self, operation: Operation) {
        self.core.operate(operation);
        self.act();
    }

    /// The axis has no more use for the stream.
    pub fn close(&mut self) {
        self.core.close();
        self.act();
    }

    /// What comes next; forever nothing after [`News::Over`]. Nothing is lost where it is not waited for to the end.
    pub async fn next(&mut self) -> Next {
        loop {
            self.act();
            if let Some(next) = self.ready.pop_front() {
                return next;
            }
            let happened = self.happens().await;
            let now = self.begun.elapsed();
            match happened {
                Happened::Heard(epoch, Ok(Some((said, message)))) => match message {
                    // The buffer drops it, and counts.
                    ToAxis::Batch(batch) if said != epoch => return Next::Feed(Feed::Batch(said, batch)),
                    _ if said != epoch => {}
                    message => self.core.heard(now, epoch, message),
                },
                Happened::Heard(epoch, Ok(None)) => self.over(now, epoch, Ok(())),
                Happened::Heard(epoch, Err(error)) => self.over(now, epoch, Err(error)),
                Happened::Opened(epoch, Ok((link, message))) => {
                    // The link first: what is decided next may need it.
                    let before = self.serving.replace((epoch, link));
                    self.core.heard(now, epoch, message);
                    if !self.is_served_by(epoch) {
                        self.serving = before;
                    }
                }
                Happened::Opened(epoch, Err(error)) => {
                    if let Some(line) = self.lines.remove(&epoch) {
                        // It may have been the connection that is broken.
                        self.warm.remove(&line.endpoint);
                    }
                    self.core.ended(now, epoch, Err(error));
                }
                Happened::Warmed(endpoint, client) => {
                    self.warm.extend(client.map(|client| (endpoint, client)));
                }
                Happened::Room | Happened::Woken => {}
            }
            self.core.woken(self.begun.elapsed());
        }
    }

    fn is_served_by(&self, epoch: u64) -> bool {
        self.core.serving_epoch() == Some(epoch)
    }

    fn over(&mut self, now: Duration, epoch: u64, how: Result<(), Error>) {
        self.serving = None;
        self.core.ended(now, epoch, how);
    }

    /// Does what is to be done here, and keeps the rest to be handed out.
    fn act(&mut self) {
        while let Some(action) = self.core.poll() {
            match action {
                Action::Feed(feed) => self.ready.push_back(Next::Feed(feed)),
                Action::Tell(news) => {
                    if matches!(news, News::Opened(_) | News::FailedOver(_)) {
                        self.warm_up();
                    }
                    self.ready.push_back(Next::News(news));
                }
                Action::Send(epoch, message) => self.send(epoch, message),
                Action::Drop(epoch) => {
                    if let Some(line) = self.lines.remove(&epoch) {
                        if !line.opening.is_finished() {
                            // It may be the connection that does not answer: the next attempt makes another.
                            self.warm.remove(&line.endpoint);
                        }
                        line.opening.abort();
                    }
                    self.serving.take_if(|serving| serving.0 == epoch);
                }
                Action::Try { endpoint, open } => self.open(endpoint, *open),
            }
        }
        self.flush();
    }

    /// A newer report says all that an older one did, but for what was refused: of those that wait, the newest is enough.
    fn send(&mut self, epoch: u64, message: FromAxis) {
        if let FromAxis::Report(report) = &message
            && let Some((waits_for, FromAxis::Report(older))) = self.unsent.back_mut()
            && *waits_for == epoch
        {
            let refused = report.refused.clone().or(older.refused.take());
            *older = Report { refused, ..report.clone() };
        } else {
            self.unsent.push_back((epoch, message));
        }
    }

    /// Says what is unsent, as far as there is room for it.
    fn flush(&mut self) {
        while let Some((epoch, message)) = self.unsent.front() {
            if let Some(line) = self.lines.get(epoch) {
                match line.outgoing.try_reserve() {
                    Ok(permit) => permit.send(proto::request_to_wire(message)),
                    Err(mpsc::error::TrySendError::Full(())) => return,
                    // What came of the stream is told elsewhere.
                    Err(mpsc::error::TrySendError::Closed(())) => {}
                }
            }
            self.unsent.pop_front();
        }
    }

    fn open(&mut self, endpoint: usize, open: Open) {
        let epoch = open.epoch;
        let (outgoing, requests) = mpsc::channel(link::OUTBOX);
        // There is room for it.
        let _ = outgoing.try_send(proto::request_to_wire(&FromAxis::Open(Box::new(open))));
        let address = self.endpoint(endpoint).to_owned();
        let connect = &self.servers.connect;
        let (warm, connect) = if self.servers.endpoints.len() > 1 {
            (self.warm.get(&endpoint).cloned(), connect.clone())
        } else if std::mem::replace(&mut self.has_tried, true) {
            // Behind a single address there may be several servers: a connection of its own may find another.
            (None, connect.alone())
        } else {
            (None, connect.clone())
        };
        // Boxed first: on its way to where it stays it is moved a dozen times.
        let opening = self.opening.spawn(TraceContext::carried(Box::pin(async move {
            let opened = async {
                let client = match warm {
                    Some(client) => client,
                    None => connect.to(&address).await?,
                };
                // Dropped where it takes too long: others are not to wait for the same connection.
                let trial = client.on_trial();
                let opened = first_heard(&client, requests).await;
                if !matches!(opened, Err(Error::Unreachable { .. })) {
                    trial.proved();
                }
                opened
            };
            (epoch, opened.await)
        })));
        self.lines.insert(epoch, Line { outgoing, opening, endpoint });
    }

    /// Connects to the endpoint that will be asked next.
    fn warm_up(&mut self) {
        let Some(serving) = self.core.endpoint().filter(|_| self.servers.endpoints.len() > 1) else { return };
        let next = (serving + 1) % self.servers.endpoints.len();
        if self.warm.contains_key(&next) {
            return;
        }
        let address = self.endpoint(next).to_owned();
        let connect = self.servers.connect.clone();
        self.warming.spawn(async move { (next, connect.to(&address).await.ok()) });
    }

    async fn happens(&mut self) -> Happened {
        let Self { core, begun, warming, opening, serving, lines, unsent, alarm, .. } = self;
        let heard = async {
            match serving {
                Some((epoch, link)) => Happened::Heard(*epoch, link.next().await),
                None => std::future::pending().await,
            }
        };
        let opened = async {
            loop {
                match opening.join_next().await {
                    Some(Ok((epoch, opened))) => return Happened::Opened(epoch, opened),
                    // It was not wanted any more.
                    Some(Err(_)) => {}
                    None => std::future::pending().await,
                }
            }
        };
        let warmed = async {
            loop {
                match warming.join_next().await {
                    Some(Ok((endpoint, client))) => return Happened::Warmed(endpoint, client),
                    Some(Err(_)) => {}
                    None => std::future::pending().await,
                }
            }
        };
        let room = async {
            match unsent.front().and_then(|(epoch, _)| lines.get(epoch)) {
                // Closed or not: there is something to be done about it.
                Some(line) => drop(line.outgoing.reserve().await),
                None => std::future::pending().await,
            }
        };
        let woken = async {
            let Some(at) = core.wake_at() else { return std::future::pending().await };
            let at = *begun + at;
            let alarm = alarm.get_or_insert_with(|| Box::pin(tokio::time::sleep_until(at)));
            if alarm.deadline() > at || alarm.is_elapsed() {
                alarm.as_mut().reset(at);
            }
            alarm.await;
        };
        tokio::select! {
            biased;
            heard = heard => heard,
            opened = opened => opened,
            () = room => Happened::Room,
            () = woken => Happened::Woken,
            warmed = warmed => warmed,
        }
    }
}
