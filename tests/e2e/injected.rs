//! Faults that an axis makes on purpose, over gRPC.

use std::time::Duration;

use e2e::{Loopback, LoopbackAxis, move_of, planned};
use proto::pb::inject_fault_request::Fault;
use proto::pb::sim_axis_service_client::SimAxisServiceClient;
use proto::{Reason, Rejected, pb};
use sim_axis::{AxisModel, Config, RemoteAxis, TrackRequest, TrackingReport, Update};
use tonic::transport::Channel;

type Client = SimAxisServiceClient<Channel>;

async fn axis() -> (LoopbackAxis, Client) {
    let axis = LoopbackAxis::with(Config { fault_injection: true, ..Config::loopback() }).await;
    let client = SimAxisServiceClient::new(axis.channel().await);
    (axis, client)
}

async fn make(client: &mut Client, fault: Option<Fault>) -> Result<u32, Rejected> {
    let made = client.inject_fault(pb::InjectFaultRequest { fault }).await;
    made.map(|made| made.into_inner().runs)
        .map_err(|status| Rejected::from_status(&status).expect("a reason"))
}

fn lasting(milliseconds: i32) -> prost_types::Duration {
    prost_types::Duration { seconds: 0, nanos: milliseconds * 1_000_000 }
}

/// A run of some two seconds by the wall clock, with the longest lead, to which `fault` happens when the first samples come.
async fn run_with(fault: Fault) -> (TrackingReport, TrackingReport) {
    let (server, (axis, mut client)) = (Loopback::start().await, axis().await);
    let request = || TrackRequest {
        models: vec![AxisModel::flexible("x")],
        lead_cycles: 250,
        ..TrackRequest::new("cell-7/x", server.endpoint(), planned(move_of(0.4, 0.25)))
    };
    let mut reports = Vec::new();
    for mut fault in [None, Some(fault)] {
        let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
        let mut run = remote.track(request()).await.unwrap();
        while let Some(update) = run.next().await.unwrap() {
            if let (Update::Samples(_), Some(fault)) = (update, fault.take()) {
                assert_eq!(make(&mut client, Some(fault)).await.unwrap(), 1);
            }
        }
        reports.push(run.finish().unwrap());
    }
    let faulty = reports.pop().expect("two runs");
    (reports.pop().expect("two runs"), faulty)
}

#[tokio::test(flavor = "multi_thread")]
async fn batches_that_are_lost_are_sent_again() {
    let (whole, faulty) = run_with(Fault::DropBatches(3)).await;
    let counters = faulty.stream.counters;
    assert!(counters.refused_batches > whole.stream.counters.refused_batches, "{counters:?}");
    assert_eq!(counters.underruns, 0, "{counters:?}");
    assert_eq!(faulty.stream.digest, whole.stream.digest, "not a bit is other");
}

#[tokio::test(flavor = "multi_thread")]
async fn what_is_not_read_and_not_said_for_a_while_is_covered_by_the_lead() {
    for fault in [Fault::StallReads(lasting(100)), Fault::PauseReports(lasting(100))] {
        let (whole, faulty) = run_with(fault).await;
        let counters = faulty.stream.counters;
        assert!(
            counters.least_lead_cycles <= 250 - 80,
            "{fault:?}: a hundred cycles are missing: {counters:?}"
        );
        assert_eq!(counters.underruns, 0, "{fault:?}: {counters:?}");
        assert_eq!(faulty.stream.digest, whole.stream.digest);
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_drive_that_is_weak_is_at_its_limit() {
    let (whole, faulty) = run_with(Fault::EffortLimitScale(0.05)).await;
    let saturated = |report: &TrackingReport| report.axes[0].effort_saturated_time;
    assert_eq!(saturated(&whole), 0.0);
    assert!(saturated(&faulty) > 0.0, "{:?}", faulty.axes[0]);
    assert!(faulty.axes[0].max_following_error > 2.0 * whole.axes[0].max_following_error);
}

#[tokio::test]
async fn faults_are_made_only_where_that_is_allowed_and_as_they_are_described() {
    let plain = LoopbackAxis::start().await;
    let mut client = SimAxisServiceClient::new(plain.channel().await);
    let refused = make(&mut client, Some(Fault::DropBatches(1))).await.unwrap_err();
    assert_eq!(refused.reason, Reason::NotImplemented);
    assert!(refused.message.contains("--fault-injection"), "{refused}");

    let (_axis, mut client) = axis().await;
    assert_eq!(make(&mut client, Some(Fault::DropBatches(1))).await.unwrap(), 0, "nobody runs");
    let minute = prost_types::Duration::try_from(Duration::from_millis(60_001)).unwrap();
    let bad = [
        (None, "fault", Reason::FieldMissing),
        (Some(Fault::DropBatches(0)), "drop_batches", Reason::ValueOutOfRange),
        (Some(Fault::StallReads(lasting(0))), "stall_reads", Reason::ValueOutOfRange),
        (Some(Fault::StallReads(lasting(-5))), "stall_reads", Reason::ValueOutOfRange),
        (Some(Fault::PauseReports(minute)), "pause_reports", Reason::ValueOutOfRange),
        (Some(Fault::EffortLimitScale(1.5)), "effort_limit_scale", Reason::ValueOutOfRange),
        (Some(Fault::EffortLimitScale(f64::NAN)), "effort_limit_scale", Reason::ValueOutOfRange),
    ];
    for (fault, field, reason) in bad {
        let refused = make(&mut client, fault).await.unwrap_err();
        assert_eq!(
            (refused.fields[0].field.as_str(), refused.reason),
            (field, reason),
            "{fault:?}: {refused}"
        );
    }
}
