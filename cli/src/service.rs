//! Who answers: the planner in this process, or one behind an endpoint.

use std::sync::Arc;

use client::{Client, Connect};
use planner::{
    Accepted, Certificate, Judged, JudgedPvt, Plan, PvtRequest, PvtRequestSpec, Request, RequestSpec,
};
use proto::{Against, Chunk, Rejected, Sampling};
use tokio::runtime::Runtime;
use tokio::sync::Semaphore;

use crate::failure::Failure;

/// Where a server listens unless it is told otherwise.
pub(crate) const USUAL_SERVER: &str = "http://127.0.0.1:50051";
/// How many requests wait for a server's answer at once.
const IN_FLIGHT: usize = 256;

/// Where a server is, and how it is connected to; without an endpoint, this process does it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Server<'a> {
    pub(crate) endpoint: Option<&'a str>,
    pub(crate) connect: &'a Connect,
}

/// A planner to ask.
pub(crate) enum Service {
    /// Here.
    InProcess,
    /// Behind an endpoint.
    Remote(Box<Remote>),
}

/// A connection to a server, and what its waiting runs on.
pub(crate) struct Remote {
    runtime: Runtime,
    client: Client,
}

/// What a planner can be asked.
pub(crate) trait Question: Clone + Send + 'static {
    /// What it answers.
    type Answer: Send + 'static;

    /// Asks the planner in this process.
    fn here(self) -> Result<Self::Answer, Rejected>;

    /// Asks a server.
    fn there(self, client: &Client) -> impl Future<Output = Result<Self::Answer, client::Error>> + Send;

    /// Asks a server for all at once, where there is such a call; `None` where there is none, or where it says nothing of each.
    fn all_there(
        _all: Vec<Self>,
        _client: &Client,
    ) -> impl Future<Output = Option<Vec<Result<Self::Answer, Rejected>>>> + Send {
        std::future::ready(None)
    }
}

impl Question for RequestSpec {
    type Answer = Judged;

    fn here(self) -> Result<Judged, Rejected> {
        Ok(Judged::answer(&Request::try_from(self)?)?)
    }

    fn there(self, client: &Client) -> impl Future<Output = Result<Judged, client::Error>> + Send {
        client.plan(self)
    }

    async fn all_there(all: Vec<Self>, client: &Client) -> Option<Vec<Result<Judged, Rejected>>> {
        client.plan_all(all).await.ok()
    }
}

impl Question for PvtRequestSpec {
    type Answer = JudgedPvt;

    fn here(self) -> Result<JudgedPvt, Rejected> {
        Ok(JudgedPvt::answer(&PvtRequest::try_from(self)?)?)
    }

    fn there(self, client: &Client) -> impl Future<Output = Result<JudgedPvt, client::Error>> + Send {
        client.plan_pvt(self)
    }
}

/// What takes answers, one after the other.
type Put<'a, T> = &'a mut dyn FnMut(T) -> Result<(), Failure>;

impl Service {
    pub(crate) fn open(server: Server<'_>) -> Result<Self, Failure> {
        let Some(endpoint) = server.endpoint else { return Ok(Self::InProcess) };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|error| Failure::Internal(error.to_string()))?;
        let client = runtime.block_on(server.connect.to(endpoint))?;
        Ok(Self::Remote(Box::new(Remote { runtime, client })))
    }

    pub(crate) fn plan<Q: Question>(&self, question: Q) -> Result<Q::Answer, Failure> {
        match self {
            Self::InProcess => question.here().map_err(Failure::refused),
            Self::Remote(remote) => Ok(remote.runtime.block_on(question.there(&remote.client))?),
        }
    }

    /// Answers every request, in order. One that is none, or that cannot be met, has its refusal for an answer.
    pub(crate) fn plan_all<T: Send + Sync, Q: Question>(
        &self,
        requests: Vec<T>,
        read: fn(&T) -> Result<Q, Rejected>,
        write: impl Fn(Result<Q::Answer, Rejected>) -> String + Copy + Send + Sync + 'static,
        put: Put<'_, String>,
    ) -> Result<(), Failure> {
        match self {
            Self::InProcess => {
                let answers = shared(&requests, &|request| write(read(request).and_then(Q::here)));
                answers.into_iter().try_for_each(put)
            }
            Self::Remote(remote) => {
                let questions = requests.iter().map(read).collect();
                remote.runtime.block_on(ask_all(&remote.client, questions, write, put))
            }
        }
    }

    /// Judges `plan` by its own limits and goals, or by those of `against`.
    pub(crate) fn verify(&self, plan: &Plan, against: Vec<Against>) -> Result<Certificate, Failure> {
        match self {
            Self::InProcess => {
                let pairs = proto::against(plan, against).map_err(Failure::refused)?;
                Ok(planner::certify_against(plan, pairs.iter().map(|(limits, goal)| (limits, *goal))))
            }
            Self::Remote(remote) => Ok(remote.runtime.block_on(remote.client.verify(plan, against))?),
        }
    }

    /// Samples `cycles` cycles from `first_cycle` on, or to the end of the plan for 0.
    pub(crate) fn sample(
        &self,
        plan: Plan,
        first_cycle: u64,
        cycles: u64,
        put: Put<'_, Chunk>,
    ) -> Result<(), Failure> {
        match self {
            Self::InProcess => sample(plan, first_cycle, cycles, put),
            Self::Remote(remote) => remote.runtime.block_on(async {
                let mut samples = remote.client.sample(&Judged::new(plan), first_cycle, cycles).await?;
                while let Some(chunk) = samples.next().await? {
                    put(chunk)?;
                }
                Ok(())
            }),
        }
    }
}

/// `each` of all, in order, on every core there is.
fn shared<T: Sync>(all: &[T], each: &(impl Fn(&T) -> String + Sync)) -> Vec<String> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut shares = all.chunks(all.len().div_ceil(threads).max(LEAST_SHARE));
    let mine = shares.next().unwrap_or_default();
    std::thread::scope(|scope| {
        let others: Vec<_> =
            shares.map(|share| scope.spawn(move || share.iter().map(each).collect::<Vec<_>>())).collect();
        let mut done: Vec<String> = mine.iter().map(each).collect();
        for other in others {
            match other.join() {
                Ok(theirs) => done.extend(theirs),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        done
    })
}

/// Asks a server and hands on the answers in order: all over one stream, and where that ends early, each by itself, which says
/// what is wrong with whom.
async fn ask_all<Q: Question>(
    client: &Client,
    questions: Vec<Result<Q, Rejected>>,
    write: impl Fn(Result<Q::Answer, Rejected>) -> String + Copy + Send + 'static,
    put: Put<'_, String>,
) -> Result<(), Failure> {
    let readable = questions.iter().flatten().cloned().collect();
    let Some(answers) = Q::all_there(readable, client).await else {
        return ask_each(client, questions, write, put).await;
    };
    let mut answers = answers.into_iter();
    for question in questions {
        let answer = match question {
            Ok(_) => answers.next(),
            Err(rejected) => Some(Err(rejected)),
        };
        answer.map_or(Ok(()), |answer| put(write(answer)))?;
    }
    Ok(())
}

/// Asks a server, with many requests under way, and hands on the answers in order.
async fn ask_each<Q: Question>(
    client: &Client,
    questions: Vec<Result<Q, Rejected>>,
    write: impl Fn(Result<Q::Answer, Rejected>) -> String + Copy + Send + 'static,
    put: Put<'_, String>,
) -> Result<(), Failure> {
    let room = Arc::new(Semaphore::new(IN_FLIGHT));
    let asked: Vec<_> = questions
        .into_iter()
        .map(|question| {
            let (client, room) = (client.clone(), room.clone());
            tokio::spawn(async move {
                let question = match question {
                    Ok(question) => question,
                    Err(rejected) => return Ok(write(Err(rejected))),
                };
                // The semaphore is never closed.
                let _place = room.acquire().await;
                match question.there(&client).await {
                    Ok(answer) => Ok(write(Ok(answer))),
                    Err(client::Error::Rejected(rejected)) => Ok(write(Err(*rejected))),
                    Err(error) => Err(error),
                }
            })
        })
        .collect();
    for answer in asked {
        let answer = answer.await.map_err(|error| Failure::Internal(error.to_string()))?;
        put(answer?)?;
    }
    Ok(())
}

/// The fewest requests that are worth a thread.
const LEAST_SHARE: usize = 32;

fn sample(plan: Plan, first_cycle: u64, cycles: u64, put: Put<'_, Chunk>) -> Result<(), Failure> {
    let accepted: Accepted = proto::accepted("plan", plan).map_err(Failure::refused)?;
    Sampling::new(accepted, first_cycle, cycles).map_err(Failure::refused)?.try_for_each(put)
}
