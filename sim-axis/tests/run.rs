//! Whole runs over loopback, against a small server that does as it is told.
#![expect(clippy::unwrap_used, reason = "helpers of tests are tests")]

use std::net::SocketAddr;
use std::time::{Duration, Instant};

use planner::{Accepted, AxisKind, AxisMoveSpec, Judged, LimitsSpec, Request, RequestSpec, State};
use proto::pb;
use proto::pb::setpoint_service_server::{SetpointService, SetpointServiceServer};
use proto::stream::{
    Batch, Columns, FromAxis, Motion, Open, Opened, Source, StreamEvent, StreamEventKind, ToAxis,
};
use proto::{Digest, Reason, Rejected};
use sim_axis::{AxisModel, Clock, Samples, TrackError, TrackRequest, Tracking, Update, track};
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tonic::{Response, Status, Streaming};

fn plan(distance: f64) -> Accepted {
    let limits =
        LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..LimitsSpec::default() };
    let axis = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(distance),
        limits,
    };
    let spec = RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(planner::Family::SCurve),
        order: None,
        short_path: Ok(planner::ShortPathPolicy::Reject),
        synchronization: Ok(planner::Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    };
    Judged::answer(&Request::try_from(spec).unwrap()).unwrap().accepted().unwrap()
}

fn digest_of(plan: &Accepted, cycles: u64) -> Digest {
    let mut sampler = plan.plan().sampler();
    (1..=cycles).fold(Digest::ZERO, |digest, cycle| {
        digest.then(cycle, sampler.at(cycle).map(|setpoint| setpoint.words()))
    })
}

/// What the server does to an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Script {
    /// Serves the plan.
    Serves,
    /// Ends the stream, for a reason, when this cycle has been sent.
    BreaksAfter(u64),
    /// Says good-bye, without a reason, when this cycle has been sent.
    LeavesAfter(u64),
    /// Leaves out the batch that begins here, the first time.
    LosesBatchAt(u64),
    /// Does not open the stream.
    Refuses,
}

#[derive(Clone, Copy, Debug)]
struct Server(Script);

/// A server on a port of its own, for as long as the runtime lives.
async fn serve(script: Script) -> String {
    let listener = tokio::net::TcpListener::bind(SocketAddr::from(([127, 0, 0, 1], 0))).await.unwrap();
    let address = listener.local_addr().unwrap();
    let router = tonic::transport::Server::builder().add_service(SetpointServiceServer::new(Server(script)));
    tokio::spawn(
        router.serve_with_incoming(
            tonic::transport::server::TcpIncoming::from(listener).with_nodelay(Some(true)),
        ),
    );
    format!("http://{address}")
}

type Answers = mpsc::Sender<Result<pb::StreamSetpointsResponse, Status>>;

async fn session(
    script: Script,
    mut incoming: Streaming<pb::StreamSetpointsRequest>,
    answers: Answers,
) -> Option<()> {
    let first = incoming.message().await.ok()??;
    let Ok(FromAxis::Open(open)) = proto::request_from_wire(first) else { return None };
    let Open { epoch, lead_cycles, batch_cycles, close_at_rest, source, .. } = *open;
    let Source::Plan(plan) = source else {
        // It serves from the beginning or not at all.
        answers.send(Err(Rejected::new(Reason::Overloaded, "enough").into())).await.ok()?;
        return None;
    };
    if script == Script::Refuses {
        answers.send(Err(Rejected::new(Reason::PlanRejected, "not this one").into())).await.ok()?;
        return None;
    }
    let motion = Motion::opened(planner::motion::Motion::open(plan.clone()).ok()?);
    let say = async |message| answers.send(Ok(proto::response_to_wire(epoch, message))).await.ok();
    let opened = Opened {
        motion: Some(motion.clone()),
        first_cycle: 1,
        served_by: "test".into(),
        current_epoch: epoch,
    };
    say(ToAxis::Opened(Box::new(opened))).await?;
    let plan = plan.plan();
    let end = if close_at_rest { plan.cycle_count() } else { u64::MAX };
    let (mut sent, mut digest, mut grant) = (0, Digest::ZERO, u64::from(lead_cycles));
    let (mut loses, mut digests) = (true, vec![Digest::ZERO]);
    loop {
        while sent < grant.min(end) {
            match script {
                Script::BreaksAfter(cycle) if sent >= cycle => {
                    answers.send(Err(Rejected::new(Reason::Overloaded, "enough").into())).await.ok()?;
                    return None;
                }
                Script::LeavesAfter(cycle) if sent >= cycle => return None,
                _ => {}
            }
            let stops = match script {
                Script::BreaksAfter(cycle) | Script::LeavesAfter(cycle) => cycle,
                _ => u64::MAX,
            };
            let (from, to) = (sent + 1, (sent + u64::from(batch_cycles)).min(grant).min(end).min(stops));
            let columns = Columns::of_plan(plan, from..to + 1);
            digests.truncate(from as usize);
            digests.extend(columns.digests(from, digest));
            digest = *digests.last()?;
            sent = to;
            if matches!(script, Script::LosesBatchAt(cycle) if cycle == from) && std::mem::take(&mut loses) {
                continue;
            }
            let (first_cycle, last) = (from, to == end);
            let tails = motion.tails(to).ok()?;
            let batch = Batch { first_cycle, revision: 0, replaces: false, last, columns, digest, tails };
            say(ToAxis::Batch(batch)).await?;
            if last {
                let kind = StreamEventKind::Finished;
                say(ToAxis::Event(StreamEvent { kind, at_cycle: to })).await?;
            }
        }
        if matches!(script, Script::LeavesAfter(cycle) if sent >= cycle) {
            return None;
        }
        let message = incoming.message().await.ok()??;
        let Ok(FromAxis::Report(report)) = proto::request_from_wire(message) else { return None };
        assert_eq!(report.digest, digests[report.accepted_cycle as usize]);
        if report.accepted_cycle == end {
            return None;
        }
        grant = report.grant_cycle;
        if report.refused.is_some() {
            sent = report.accepted_cycle;
            digest = report.digest;
        }
    }
}

#[tonic::async_trait]
impl SetpointService for Server {
    type StreamSetpointsStream = ReceiverStream<Result<pb::StreamSetpointsResponse, Status>>;

    async fn stream_setpoints(
        &self,
        request: tonic::Request<Streaming<pb::StreamSetpointsRequest>>,
    ) -> Result<Response<Self::StreamSetpointsStream>, Status> {
        let (answers, receiver) = mpsc::channel(4);
        tokio::spawn(session(self.0, request.into_inner(), answers));
        Ok(Response::new(ReceiverStream::new(receiver)))
    }

    async fn control_stream(
        &self,
        _: tonic::Request<pb::ControlStreamRequest>,
    ) -> Result<Response<pb::ControlStreamResponse>, Status> {
        Err(Status::unimplemented("not here"))
    }

    type WatchStreamStream = ReceiverStream<Result<pb::WatchStreamResponse, Status>>;

    async fn watch_stream(
        &self,
        _: tonic::Request<pb::WatchStreamRequest>,
    ) -> Result<Response<Self::WatchStreamStream>, Status> {
        Err(Status::unimplemented("not here"))
    }
}

fn request(endpoint: &str, plan: &Accepted, clock: Clock) -> TrackRequest {
    TrackRequest {
        models: vec![AxisModel::flexible("x")],
        clock,
        settle_window: 0.1,
        patience: Duration::from_millis(50),
        ..TrackRequest::new("cell-7/x", endpoint, plan.clone())
    }
}

/// The samples one after the other, without what depends on the clock.
#[derive(Debug, Default, PartialEq)]
struct Curves {
    cycles: u64,
    measured: Vec<u64>,
    load: Vec<u64>,
    commanded: Vec<[u64; 4]>,
}

impl Curves {
    fn add(&mut self, samples: &Samples) {
        assert_eq!(samples.first_cycle, self.cycles + 1, "no samples are missing");
        let cycles = samples.commanded.cycles();
        self.cycles += cycles as u64;
        self.measured.extend(samples.tracking.measured_position.iter().map(|value| value.to_bits()));
        self.load.extend(samples.load_position.iter().map(|value| value.to_bits()));
        let setpoints = (0..cycles).filter_map(|index| samples.commanded.at(0, index));
        self.commanded.extend(setpoints.map(|setpoint| setpoint.words().map(f64::to_bits)));
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn wall_clock_and_virtual_time_give_the_same_numbers() {
    let endpoint = serve(Script::Serves).await;
    let plan = plan(0.02);
    let mut runs = Vec::new();
    for clock in [Clock::Wall, Clock::Virtual] {
        let mut curves = Curves::default();
        let began = Instant::now();
        let report = track(request(&endpoint, &plan, clock), |update| {
            if let Update::Samples(samples) = update {
                curves.add(&samples);
            }
        });
        let report = report.await.unwrap();
        let took = began.elapsed();
        assert_eq!(report.stream.cycles_executed, plan.plan().cycle_count());
        assert_eq!(report.stream.digest, digest_of(&plan, plan.plan().cycle_count()));
        assert_eq!(curves.cycles, plan.plan().cycle_count() + 100);
        match clock {
            Clock::Wall => {
                assert!(took >= Duration::from_millis(curves.cycles), "{took:?}");
                assert!(report.stream.jitter.max > 0.0);
            }
            Clock::Virtual => assert_eq!(report.stream.jitter, sim_axis::Jitter::default()),
        }
        if report.stream.counters.underruns == 0 {
            runs.push((curves, report.axes));
        }
    }
    // A machine too busy to keep the lead filled has played the same setpoints, some of them late.
    assert!(runs.iter().all(|run| *run == runs[0]));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_long_move_in_virtual_time_is_short_and_gives_its_digest() {
    let endpoint = serve(Script::Serves).await;
    let plan = plan(7.4);
    let mut reports = Vec::new();
    for _ in 0..2 {
        let report = track(request(&endpoint, &plan, Clock::Virtual), |_| {}).await.unwrap();
        assert_eq!(report.stream.digest, digest_of(&plan, plan.plan().cycle_count()));
        reports.push(report.axes);
    }
    assert_eq!(reports[0], reports[1]);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stream_that_breaks_off_ends_the_run_with_what_there_is() {
    let plan = plan(0.05);
    for (script, said) in
        [(Script::BreaksAfter(120), "OVERLOADED: enough"), (Script::LeavesAfter(120), "ended before")]
    {
        let endpoint = serve(script).await;
        for clock in [Clock::Wall, Clock::Virtual] {
            let error = track(request(&endpoint, &plan, clock), |_| {}).await.unwrap_err();
            let text = error.to_string();
            let TrackError::Broken { executed, motion_end, report, .. } = error else { panic!("{text}") };
            // What was held is played, and after it the way to rest.
            let motion = Motion::opened(planner::motion::Motion::open(plan.clone()).unwrap());
            let rests = motion.starved(120, &motion.tails(120).unwrap(), Digest::ZERO).unwrap();
            let end = rests.last_cycle();
            assert!(text.contains(said) && text.contains(&format!("at cycle {end} of 314")), "{text}");
            assert_eq!((executed, motion_end), (end, 314));
            assert!(report.stream.stop_tail_used);
            let digest = rests.digest_from((120, digest_of(&plan, 120)), end);
            assert_eq!(report.stream.digest, digest);
        }
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_lost_batch_is_sent_again() {
    let endpoint = serve(Script::LosesBatchAt(101)).await;
    let plan = plan(0.05);
    for clock in [Clock::Wall, Clock::Virtual] {
        let report = track(request(&endpoint, &plan, clock), |_| {}).await.unwrap();
        assert!(report.stream.counters.refused_batches >= 1);
        assert_eq!(report.stream.digest, digest_of(&plan, 314));
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_slow_reader_of_a_run_in_virtual_time_misses_nothing() {
    let endpoint = serve(Script::Serves).await;
    let plan = plan(2.0);
    let mut tracking = Tracking::begin(request(&endpoint, &plan, Clock::Virtual)).await.unwrap();
    let mut curves = Curves::default();
    while let Some(update) = tracking.next().await {
        if let Update::Samples(samples) = update {
            curves.add(&samples);
            // Slower than the cycle thread by far.
            let pause = tokio::time::timeout(Duration::from_millis(1), std::future::pending::<()>());
            let _ = pause.await;
        }
    }
    assert_eq!(curves.cycles, plan.plan().cycle_count() + 100);
    assert!(tracking.finish().await.is_ok());
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn planners_are_tried_in_order() {
    let plan = plan(0.05);
    let nobody = "http://127.0.0.1:1".to_owned();
    let somebody = serve(Script::Serves).await;
    let both = TrackRequest {
        endpoints: vec![nobody.clone(), somebody.clone()],
        ..request(&somebody, &plan, Clock::Virtual)
    };
    assert!(track(both, |_| {}).await.is_ok());
    let rows = [
        (vec![], "no endpoint is given"),
        (vec![nobody.clone()], "127.0.0.1:1 is not reachable"),
        (vec![serve(Script::Refuses).await, somebody.clone()], "PLAN_REJECTED: not this one"),
    ];
    for (endpoints, said) in rows {
        let request = TrackRequest { endpoints, ..request(&somebody, &plan, Clock::Virtual) };
        let text = track(request, |_| {}).await.unwrap_err().to_string();
        assert!(text.contains(said), "{text}");
    }
    let stranger =
        TrackRequest { models: vec![AxisModel::ideal("y")], ..request(&somebody, &plan, Clock::Virtual) };
    let text = track(stranger, |_| {}).await.unwrap_err().to_string();
    assert_eq!(text, "no axis is called \"y\": the plan has x");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stream_that_stays_open_runs_until_it_is_left() {
    // Virtual time stands still after 314 cycles of motion and 100 of watching, with 40 ahead of it.
    let endpoint = serve(Script::LeavesAfter(450)).await;
    let plan = plan(0.05);
    let request = TrackRequest { stay_open: true, ..request(&endpoint, &plan, Clock::Virtual) };
    let report = track(request, |_| {}).await.unwrap();
    assert!((450..=454).contains(&report.stream.cycles_executed), "{:?}", report.stream);
    assert_eq!(report.stream.counters.least_lead_cycles, 20);
    assert_eq!(report.stream.digest, digest_of(&plan, 314));
}
