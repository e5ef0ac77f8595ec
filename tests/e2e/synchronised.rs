//! Three axes in motion that arrive together, or on a line: planned, judged elsewhere, sampled, played, held on their path and resumed.

use client::{Client, Error, Setpoints};
use e2e::{Loopback, LoopbackAxis, fifty_millimetres, open, replay};
use planner::motion::Operation as Planned;
use planner::{AxisKind, AxisMoveSpec, Judged, LimitsSpec, RequestSpec, State, Synchronization};
use proto::stream::{Ask, Operation};
use proto::{Digest, Reason};

use super::operations::{answered, play_to};

/// Of how far each goes, its velocity and its acceleration at the start \[1\]: on one line, so that both kinds can be asked.
const SHARES: [(&str, AxisKind, f64); 3] =
    [("x", AxisKind::Prismatic, 1.0), ("y", AxisKind::Prismatic, -0.5), ("c", AxisKind::Revolute, 15.0)];

fn three_axes(synchronization: Synchronization) -> RequestSpec {
    let axis = |(name, kind, share): (&str, AxisKind, f64)| AxisMoveSpec {
        axis: name.into(),
        kind: Ok(kind),
        start: State { position: 0.0, velocity: 0.1 * share, acceleration: 0.5 * share },
        goal: State::at_rest(0.3 * share),
        limits: match kind {
            AxisKind::Revolute => LimitsSpec {
                max_velocity: 6.0,
                max_acceleration: 40.0,
                max_jerk: 900.0,
                ..LimitsSpec::default()
            },
            AxisKind::Prismatic | AxisKind::Pulses => fifty_millimetres().axes[0].limits.clone(),
        },
    };
    let axes = SHARES.into_iter().map(axis).collect();
    RequestSpec { axes, synchronization: Ok(synchronization), ..fifty_millimetres() }
}

/// Plans on one server; another one passes the plan, and samples it to the same digest.
async fn planned_and_judged_elsewhere(client: &Client, spec: RequestSpec) -> (Judged, Digest) {
    let judged = client.plan(spec.clone()).await.unwrap();
    assert_eq!(judged.plan(), e2e::planned(spec).plan());
    let elsewhere = Loopback::start().await;
    let other = elsewhere.client().await;
    let certificate = other.verify(judged.plan(), Vec::new()).await.unwrap();
    assert!(certificate.passed());
    assert_eq!(&certificate, judged.certificate());
    let digest = client.digest(&judged).await.unwrap();
    assert_eq!(other.digest(&judged).await.unwrap(), digest);
    (judged, digest)
}

#[tokio::test]
async fn axes_in_motion_arrive_together_or_on_a_line() {
    let server = Loopback::start().await;
    let client = server.client().await;
    for synchronization in [Synchronization::Time, Synchronization::Phase] {
        let (judged, digest) = planned_and_judged_elsewhere(&client, three_axes(synchronization)).await;
        let critical = &judged.explanation().critical_axis;
        assert!(SHARES.iter().any(|(name, ..)| name == critical), "{synchronization:?}: {critical:?}");
        let plan = judged.clone().accepted().unwrap();
        let mut stream = Setpoints::open(&client, open("undisturbed", plan)).await.unwrap();
        let mut played = Digest::ZERO;
        let line = synchronization == Synchronization::Phase;
        while let Some(playing) = stream.next().await.unwrap() {
            played = playing.digest;
            for (setpoint, (name, _, share)) in playing.setpoints.iter().zip(SHARES) {
                let off = setpoint.state.position - share * playing.setpoints[0].state.position;
                assert!(!line || off.abs() <= 1e-12 * share.abs(), "{name}: {off} off the line");
            }
        }
        assert_eq!(played, digest, "{synchronization:?}");
    }
}

#[tokio::test]
async fn axes_that_go_together_are_held_on_their_path_and_resumed() {
    let server = Loopback::start().await;
    let client = server.client().await;
    for synchronization in [Synchronization::Time, Synchronization::Phase] {
        let (judged, _) = planned_and_judged_elsewhere(&client, three_axes(synchronization)).await;
        let plan = judged.accepted().unwrap();
        let mut stream = Setpoints::open(&client, open("held", plan.clone())).await.unwrap();
        let mut done = Vec::new();
        for (cycle, id, ask, operation) in
            [(200, "hold", Ask::Hold, Planned::Hold), (900, "resume", Ask::Resume, Planned::Resume)]
        {
            play_to(&mut stream, cycle).await;
            assert!(stream.operate(Operation::now(id, ask)));
            let result = answered(&mut stream, id).await.unwrap();
            assert!(result.on_path, "{synchronization:?}: {id}");
            done.push((result.effective_cycle, operation));
        }
        let mut last = (Digest::ZERO, Vec::new());
        while let Some(playing) = stream.next().await.unwrap() {
            last = (playing.digest, playing.setpoints.iter().map(|setpoint| setpoint.words()).collect());
        }
        let ends: Vec<[f64; 4]> = SHARES.iter().map(|(.., share)| [0.3 * share, 0.0, 0.0, 0.0]).collect();
        assert_eq!(last.1, ends, "{synchronization:?}");
        let cycles = stream.buffer().executed();
        assert!(cycles > plan.judged().plan().cycle_count(), "it has waited");
        assert_eq!(last.0, replay(&plan, &done, cycles).1, "{synchronization:?}");
    }
}

#[tokio::test]
async fn an_axis_is_no_planner() {
    let axis = LoopbackAxis::start().await;
    let client = Client::connect(&axis.endpoint()).await.unwrap();
    let refused = client.plan(fifty_millimetres()).await;
    let Err(Error::Rejected(rejected)) = refused else { panic!("{refused:?}") };
    assert_eq!(rejected.reason, Reason::NotAPlanner);
    assert_eq!(rejected.metadata["endpoint"], axis.endpoint());
    assert!(rejected.message.contains("name a planner for plans and streams"), "{rejected}");
    let plan = e2e::planned(fifty_millimetres());
    let refused = Setpoints::open(&client, open("x", plan)).await.map(|_| ());
    let Err(Error::Rejected(rejected)) = refused else { panic!("{refused:?}") };
    assert_eq!(rejected.reason, Reason::NotAPlanner);

    // Nor the other way round.
    let server = Loopback::start().await;
    let remote = sim_axis::RemoteAxis::connect(&server.endpoint()).await.unwrap();
    let refused = remote.command("x", Operation::now("h", Ask::Hold)).await;
    assert_eq!(refused.map(|_| ()), Err(Error::NotServed { endpoint: server.endpoint() }));
}
