use client::Client;
use e2e::fifty_millimetres;
use proto::pb;
use proto::pb::run_tracking_response::Message;
use proto::pb::sim_axis_service_client::SimAxisServiceClient;

use crate::engine::{self, Container, Network};

/// Plans on the server, has the axis play it, and holds its report against the plan.
#[tokio::test(flavor = "multi_thread")]
async fn a_controller_plans_and_an_axis_tracks() {
    if !engine::is_there() {
        return;
    }
    engine::images();
    let network = Network::new("track");
    let server = Container::start(&network, "server", "server", 50051);
    let axis = Container::start(&network, "sim-axis", "axis", 50052);

    let controller = Client::connect(&server.endpoint()).await.unwrap();
    let judged = controller.plan(fifty_millimetres()).await.unwrap();
    let digest = controller.digest(&judged).await.unwrap();

    for virtual_time in [true, false] {
        let report = track(&axis, proto::plan_to_wire(&judged), virtual_time).await;
        let stream = report.stream.unwrap();
        assert_eq!(stream.cycles_executed, judged.plan().cycle_count());
        assert_eq!(stream.digest, u64::from(digest));
        let counters = stream.counters.unwrap();
        assert_eq!((counters.underruns, counters.refused_batches), (0, 0), "virtual_time {virtual_time}");
        assert_eq!(report.axes.len(), 1);
        assert!(report.axes[0].max_following_error.is_finite());
    }
    assert_eq!(server.stop(), "0", "{}", server.logs());
    assert_eq!(axis.stop(), "0", "{}", axis.logs());
}

async fn track(axis: &Container, plan: pb::Plan, virtual_time: bool) -> pb::TrackingReport {
    let mut tracking = SimAxisServiceClient::connect(axis.endpoint()).await.unwrap();
    let request = pb::RunTrackingRequest {
        stream: format!("cell-7/x-{virtual_time}"),
        endpoints: vec!["http://server:50051".into()],
        plan: Some(plan),
        // A machine that is shared stalls for longer than forty cycles now and then.
        lead_cycles: 250,
        virtual_time,
        ..Default::default()
    };
    let mut answers = tracking.run_tracking(request).await.unwrap().into_inner();
    while let Some(answer) = answers.message().await.unwrap() {
        if let Some(Message::Report(report)) = answer.message {
            return report;
        }
    }
    panic!("the run ended without a report");
}
