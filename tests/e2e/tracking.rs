//! A simulated axis follows a plan: over gRPC to the axis, and from there to the planner.

use client::Error;
use e2e::{Loopback, LoopbackAxis, fifty_millimetres, move_of, open, planned};
use proto::stream::{Ask, Operation, StreamEventKind};
use proto::{Reason, Rejected};
use sim_axis::{
    AxisModel, AxisModelSpec, Clock, LoadSpec, MechanicsSpec, RemoteAxis, ServoSpec, TrackRequest,
    TrackingReport, Update,
};
use tokio::io::AsyncWriteExt as _;
use tonic::Code;
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_check_response::ServingStatus;
use tonic_health::pb::health_client::HealthClient;

/// The fifty millimetres on a flexible axis, in virtual time.
fn request(planner: &str) -> TrackRequest {
    TrackRequest {
        models: vec![AxisModel::flexible("x")],
        clock: Clock::Virtual,
        ..TrackRequest::new("cell-7/x", planner, planned(fifty_millimetres()))
    }
}

async fn track(axis: &LoopbackAxis, request: TrackRequest) -> Result<(TrackingReport, usize), Error> {
    let remote = RemoteAxis::connect(&axis.endpoint()).await?;
    let mut run = remote.track(request).await?;
    let mut cycles = 0;
    while let Some(update) = run.next().await? {
        if let Update::Samples(samples) = update {
            cycles += samples.commanded.cycles();
        }
    }
    Ok((run.finish()?, cycles))
}

#[tokio::test]
async fn an_axis_follows_a_plan_and_reports() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let digest = server.client().await.digest(planned(fifty_millimetres()).judged()).await.unwrap();
    let (report, cycles) = track(&axis, request(&server.endpoint())).await.unwrap();
    assert_eq!((report.stream.cycles_executed, report.stream.digest), (314, digest));
    // Half a second of watching the axis settle follows the motion.
    assert_eq!(cycles, 314 + 500);
    let card = &report.axes[0];
    assert!(card.max_following_error > 1e-7 && card.max_following_error < 1e-4, "{card:?}");
    assert!(card.residual_vibration_amplitude > 0.0);
    let (again, _) = track(&axis, request(&server.endpoint())).await.unwrap();
    assert_eq!(again.axes, report.axes);
}

/// The drive's clock does not change what the axis does.
#[tokio::test]
async fn wall_clock_and_virtual_time_have_the_same_numbers() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let (hurried, _) = track(&axis, request(&server.endpoint())).await.unwrap();
    // A machine that is shared stalls for longer than forty cycles now and then.
    let wall = TrackRequest { clock: Clock::Wall, lead_cycles: 250, ..request(&server.endpoint()) };
    let (timed, _) = track(&axis, wall).await.unwrap();
    assert_eq!(timed.stream.counters.underruns, 0, "the machine stalled for a quarter of a second");
    assert_eq!(timed.axes, hurried.axes);
    assert_eq!(timed.stream.digest, hurried.stream.digest);
}

#[tokio::test]
async fn an_ideal_axis_has_no_following_error() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let ideal = TrackRequest { models: vec![], ..request(&server.endpoint()) };
    let (report, _) = track(&axis, ideal).await.unwrap();
    assert_eq!(report.axes[0].max_following_error, 0.0);
    assert_eq!(report.axes[0].settling_time, Some(0.0));
}

#[tokio::test]
async fn what_cannot_be_tracked_is_refused_with_the_reason() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let rows = [
        (TrackRequest { endpoints: vec![], ..request("") }, Reason::FieldMissing),
        (TrackRequest { stream: String::new(), ..request(&server.endpoint()) }, Reason::NameInvalid),
        (TrackRequest { lead_cycles: 251, ..request(&server.endpoint()) }, Reason::ValueOutOfRange),
        (TrackRequest { models: vec![wild("x")], ..request(&server.endpoint()) }, Reason::ServoUnstable),
        (TrackRequest { endpoints: vec!["foo bar".into()], ..request("") }, Reason::EndpointInvalid),
        (
            TrackRequest { models: vec![AxisModel::ideal("z")], ..request(&server.endpoint()) },
            Reason::UnknownAxis,
        ),
        (TrackRequest { settle_window: 1e6, ..request(&server.endpoint()) }, Reason::ValueOutOfRange),
    ];
    for (request, reason) in rows {
        let Err(Error::Rejected(rejected)) = track(&axis, request).await else { panic!("{reason}") };
        assert_eq!(rejected.reason, reason, "{rejected}");
        assert!(!rejected.fields.is_empty(), "{rejected}");
    }
}

/// Gains of 1e4 on 10 kg.
fn wild(axis: &str) -> AxisModel {
    let ideal = AxisModelSpec::ideal(axis);
    let mechanics = MechanicsSpec { load: LoadSpec::Rigid { inertia: 10.0 }, ..ideal.mechanics };
    let servo = ServoSpec { position_gain: 1e4, velocity_gain: 1e4, ..ServoSpec::default() };
    AxisModel::try_from(AxisModelSpec { mechanics, servo, ..ideal }).unwrap()
}

#[tokio::test]
async fn an_unstable_servo_is_refused_with_gains_that_would_do() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let run = TrackRequest { models: vec![wild("x")], ..request(&server.endpoint()) };
    let rejected = refused(track(&axis, run).await);
    assert_eq!(rejected.fields[0].field, "models[0].servo");
    let figure = |key: &str| rejected.metadata[key].parse::<f64>().unwrap();
    assert!(figure("growth") > 1.0);
    let spec = wild("x").spec().clone();
    let servo = ServoSpec {
        position_gain: figure("nearest_position_gain"),
        velocity_gain: 0.0,
        velocity_integral_time: 0.0,
        ..spec.servo
    };
    let tame = AxisModel::try_from(AxisModelSpec { servo, ..spec }).unwrap();
    let (report, _) =
        track(&axis, TrackRequest { models: vec![tame], ..request(&server.endpoint()) }).await.unwrap();
    assert!(report.axes[0].max_following_error < 0.05, "{report:?}");
}

#[track_caller]
fn refused<T: std::fmt::Debug>(outcome: Result<T, Error>) -> Box<Rejected> {
    let Err(Error::Rejected(rejected)) = outcome else { panic!("{outcome:?}") };
    rejected
}

/// Takes connections, and answers whatever is said with `answer`.
async fn stranger(answer: &'static [u8]) -> String {
    let listener = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(async move {
        while let Ok((mut connection, _)) = listener.accept().await {
            let _ = connection.write_all(answer).await;
        }
    });
    format!("http://{address}")
}

#[tokio::test]
async fn a_planner_that_is_none_or_not_there_is_told_with_its_endpoint() {
    let axis = LoopbackAxis::start().await;
    let rows = [
        ("http://127.0.0.1:1".to_owned(), Reason::PlannerUnreachable, Code::Unavailable),
        (stranger(b"").await, Reason::PlannerUnreachable, Code::Unavailable),
        (stranger(b"HTTP/1.1 400 Bad Request\r\n\r\n").await, Reason::PlannerUnreachable, Code::Unavailable),
        // An axis speaks gRPC, and does not plan.
        (axis.endpoint(), Reason::NotAPlanner, Code::FailedPrecondition),
    ];
    for (endpoint, reason, code) in rows {
        let rejected = refused(track(&axis, request(&endpoint)).await);
        assert_eq!((rejected.reason, rejected.reason.code()), (reason, code), "{rejected}");
        assert_eq!(rejected.metadata["endpoint"], endpoint);
        assert!(!rejected.metadata["cause"].is_empty());
        assert!(rejected.message.contains(&endpoint), "{rejected}");
    }
    let run = TrackRequest {
        endpoints: vec!["http://127.0.0.1:1".into(), "foo bar".into()],
        ..request("http://127.0.0.1:1")
    };
    let rejected = refused(track(&axis, run).await);
    assert_eq!(
        (rejected.reason, rejected.fields[0].field.as_str()),
        (Reason::EndpointInvalid, "endpoints[1]")
    );
}

/// What a planner objects to is told of the field that the caller filled in.
#[tokio::test]
async fn what_the_planner_refuses_is_told_of_the_callers_own_fields() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let mut at_speed = fifty_millimetres();
    at_speed.axes[0].goal.velocity = 0.25;
    at_speed.axes[0].limits.max_position = Some(0.05);
    let run = TrackRequest { plan: planned(at_speed), ..request(&server.endpoint()) };
    let rejected = refused(track(&axis, run).await);
    assert_eq!(rejected.reason, Reason::PositionLimit, "{rejected}");
    assert!(rejected.fields[0].field.starts_with("plan.axes[0]"), "{rejected:?}");
}

/// The planner's process dies in the middle of a motion.
#[test]
fn a_planner_that_dies_breaks_the_stream_and_the_axis_says_where_it_holds() {
    let planning = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
    let server = planning.block_on(Loopback::start());
    let here = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
    here.block_on(async {
        let axis = LoopbackAxis::start().await;
        let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
        let long = TrackRequest {
            clock: Clock::Wall,
            plan: planned(move_of(60.0, 0.1)),
            patience: std::time::Duration::from_millis(300),
            ..request(&server.endpoint())
        };
        let mut run = remote.track(long).await.unwrap();
        assert!(run.next().await.unwrap().is_some());
        planning.shutdown_background();
        let rejected = loop {
            match run.next().await {
                Ok(update) => assert!(update.is_some(), "the run ended well"),
                error => break refused(error),
            }
        };
        assert_eq!((rejected.reason, rejected.reason.code()), (Reason::StreamBroken, Code::Unavailable));
        let report = run.finish().unwrap();
        assert_eq!(rejected.metadata["executed_cycle"], report.stream.cycles_executed.to_string());
        assert_eq!(
            rejected.metadata["motion_end"],
            planned(move_of(60.0, 0.1)).plan().cycle_count().to_string()
        );
        // It came to rest on its way, as was planned.
        assert!(report.stream.stop_tail_used && report.stream.counters.underruns == 1);
        assert!(report.axes[0].settling_time.is_none());
    });
}

/// The simulator leaves while an axis of it moves.
#[tokio::test]
async fn a_simulator_that_leaves_ends_its_runs_at_the_deadline_and_takes_no_new_ones() {
    let server = Loopback::start().await;
    let mut config = sim_axis::Config::loopback();
    config.serving.drain_deadline = std::time::Duration::from_secs(1);
    let mut axis = LoopbackAxis::with(config).await;
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let long = || TrackRequest {
        clock: Clock::Wall,
        plan: planned(move_of(60.0, 0.1)),
        ..request(&server.endpoint())
    };
    let mut run = remote.track(long()).await.unwrap();
    assert!(run.next().await.unwrap().is_some());
    let mut health = HealthClient::new(axis.channel().await);
    axis.tell_to_stop();
    let service = || HealthCheckRequest { service: "motion.v1.SimAxisService".into() };
    while health.check(service()).await.unwrap().into_inner().status() == ServingStatus::Serving {}
    let whole = health.check(HealthCheckRequest::default()).await.unwrap().into_inner().status();
    assert_eq!(whole, ServingStatus::NotServing);
    assert_eq!(refused(remote.track(long()).await).reason, Reason::Draining);
    let rejected = loop {
        match run.next().await {
            Ok(update) => assert!(update.is_some(), "the run ended well"),
            error => break refused(error),
        }
    };
    assert_eq!(rejected.reason, Reason::Draining);
    drop((run, remote, health));
    axis.stopped().await;
}

#[tokio::test]
async fn an_ideal_axis_ends_where_it_was_sent() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let ideal = TrackRequest { models: vec![], ..request(&server.endpoint()) };
    let (report, _) = track(&axis, ideal).await.unwrap();
    assert_eq!(report.axes[0].overshoot, 0.0);
    // Virtual time waits for data at half the lead.
    assert_eq!(report.stream.counters.least_lead_cycles, 20);
}

/// What stands still is not told for ever.
#[tokio::test]
async fn virtual_time_stands_still_with_the_axis() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let open = TrackRequest { stay_open: true, settle_window: 0.1, ..request(&server.endpoint()) };
    let mut run = remote.track(open).await.unwrap();
    let mut cycles = 0;
    let told = async {
        loop {
            let update = run.next().await.unwrap().unwrap();
            match &update {
                Update::Samples(samples) => cycles += samples.commanded.cycles(),
                Update::Event(event) => assert_eq!(event.kind, StreamEventKind::Standstill),
                Update::FailedOver(_) | Update::Operated(_) => panic!("{update:?}"),
            }
        }
    };
    assert!(tokio::time::timeout(std::time::Duration::from_millis(500), told).await.is_err());
    assert_eq!(cycles, 314 + 100);
}

/// Once each, however often it was asked, and what is refused not at all.
#[tokio::test]
async fn what_others_ask_of_the_axis_is_told() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let long = TrackRequest { plan: planned(move_of(60.0, 0.1)), ..request(&server.endpoint()) };
    let mut run = remote.track(TrackRequest { clock: Clock::Wall, ..long }).await.unwrap();
    assert!(run.next().await.unwrap().is_some());
    let hold = Operation::now("h1", Ask::Hold);
    let result = remote.command("", hold.clone()).await.unwrap();
    assert_eq!(remote.command("", hold.clone()).await.unwrap(), result);
    assert!(remote.command("", Operation::now("o1", Ask::Override(1e9))).await.is_err());
    let stop = Operation::now("s1", Ask::Stop);
    remote.command("", stop.clone()).await.unwrap();
    let mut told = Vec::new();
    while let Some(update) = run.next().await.unwrap() {
        if let Update::Operated(done) = update {
            told.push(*done);
        }
    }
    let (operations, results): (Vec<_>, Vec<_>) = told.into_iter().unzip();
    assert_eq!((operations, &results[0]), (vec![hold, stop], &result));
}

#[tokio::test]
async fn a_caller_that_goes_away_takes_its_run_along() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let endless =
        TrackRequest { clock: Clock::Wall, plan: planned(move_of(60.0, 0.1)), ..request(&server.endpoint()) };
    let mut run = remote.track(endless).await.unwrap();
    assert!(run.next().await.unwrap().is_some());
    drop((run, remote));
    // The stream is free again, for any epoch, when the axis has closed it.
    let client = server.client().await;
    let free = async {
        while client::Setpoints::open(&client, open("cell-7/x", planned(fifty_millimetres()))).await.is_err()
        {
        }
    };
    tokio::time::timeout(std::time::Duration::from_secs(10), free).await.expect("the stream is free");
}

#[tokio::test]
async fn a_server_that_stops_in_the_middle_ends_the_run_with_what_there_is() {
    let mut config = server::Config::loopback();
    config.serving.drain_deadline = std::time::Duration::from_millis(100);
    let mut server = Loopback::with(config).await;
    let axis = LoopbackAxis::start().await;
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let long = TrackRequest {
        clock: Clock::Wall,
        plan: planned(move_of(60.0, 0.1)),
        patience: std::time::Duration::from_millis(300),
        ..request(&server.endpoint())
    };
    let mut run = remote.track(long).await.unwrap();
    assert!(run.next().await.unwrap().is_some());
    server.tell_to_stop();
    let ended = loop {
        match run.next().await {
            Ok(Some(_)) => {}
            Ok(None) => break None,
            Err(error) => break Some(error),
        }
    };
    let Some(Error::Rejected(rejected)) = ended else { panic!("{ended:?}") };
    assert_eq!(rejected.reason, Reason::Draining);
    // Where it stands is known all the same.
    let report = run.finish().unwrap();
    assert_eq!(rejected.metadata["executed_cycle"], report.stream.cycles_executed.to_string());
    assert!(report.stream.cycles_executed > 0);
}

/// Whoever commands a motion that has come to its end is told so: while the axis settles, and when its run is over.
#[tokio::test]
async fn a_command_after_the_end_is_told_of_the_end() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let wall = TrackRequest {
        clock: Clock::Wall,
        lead_cycles: 250,
        settle_window: 20.0,
        ..request(&server.endpoint())
    };
    let mut run = remote.track(wall).await.unwrap();
    loop {
        let update = run.next().await.unwrap().expect("it settles for long");
        if matches!(update, Update::Event(event) if event.kind == StreamEventKind::Finished) {
            break;
        }
    }
    let hold = || remote.command("cell-7/x", Operation::now("hold", Ask::Hold));
    let told = hold().await.unwrap_err();
    assert!(
        matches!(&told, Error::Rejected(rejected) if rejected.reason == Reason::StreamFinished),
        "{told}"
    );
    drop(run);
    // The axis learns a moment later that its caller has gone.
    let over = async {
        loop {
            let Err(Error::Rejected(rejected)) = hold().await else { panic!("it is over") };
            assert_eq!(rejected.reason, Reason::StreamFinished);
            if rejected.message.contains("any more") {
                break;
            }
        }
    };
    tokio::time::timeout(std::time::Duration::from_secs(10), over).await.expect("the run is over");
}
