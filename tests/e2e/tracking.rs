//! A simulated axis follows a plan: over gRPC to the axis, and from there to the planner.

use client::Error;
use e2e::{Loopback, LoopbackAxis, fifty_millimetres, move_of, open, planned};
use proto::Reason;
use sim_axis::{AxisModel, Clock, RemoteAxis, TrackRequest, TrackingReport, Update};

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
        (TrackRequest { endpoints: vec![], ..request("") }, Reason::ProtocolOrder),
        (TrackRequest { stream: String::new(), ..request(&server.endpoint()) }, Reason::ProtocolOrder),
        (
            TrackRequest { models: vec![AxisModel::ideal("z")], ..request(&server.endpoint()) },
            Reason::UnknownAxis,
        ),
        (TrackRequest { settle_window: 1e6, ..request(&server.endpoint()) }, Reason::LimitNotPositive),
    ];
    for (request, reason) in rows {
        let Err(Error::Rejected(rejected)) = track(&axis, request).await else { panic!("{reason}") };
        assert_eq!(rejected.reason, reason, "{rejected}");
    }
    let nobody = track(&axis, request("http://127.0.0.1:1")).await;
    assert!(matches!(nobody, Err(Error::Unreachable { .. })), "{nobody:?}");
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
    let mut server = Loopback::with(server::Config {
        drain_deadline: std::time::Duration::from_millis(100),
        ..server::Config::loopback()
    })
    .await;
    let axis = LoopbackAxis::start().await;
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let long =
        TrackRequest { clock: Clock::Wall, plan: planned(move_of(60.0, 0.1)), ..request(&server.endpoint()) };
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
    assert!(run.finish().unwrap().stream.cycles_executed > 0);
}
