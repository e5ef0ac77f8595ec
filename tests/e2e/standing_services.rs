//! Health and reflection, as any tool finds them.

use e2e::{Loopback, LoopbackAxis};
use tonic::transport::Channel;
use tonic_health::pb::HealthCheckRequest;
use tonic_health::pb::health_check_response::ServingStatus;
use tonic_health::pb::health_client::HealthClient;
use tonic_reflection::pb::v1::server_reflection_client::ServerReflectionClient;
use tonic_reflection::pb::v1::server_reflection_request::MessageRequest;
use tonic_reflection::pb::v1::server_reflection_response::MessageResponse;
use tonic_reflection::pb::v1::{ServerReflectionRequest, ServiceResponse};

#[tokio::test]
async fn each_service_has_its_health() {
    let server = Loopback::start().await;
    let mut health = HealthClient::new(server.channel().await);
    for service in ["", "motion.v1.PlannerService", "motion.v1.SetpointService"] {
        let answer = health.check(HealthCheckRequest { service: service.into() }).await.unwrap().into_inner();
        assert_eq!(answer.status(), ServingStatus::Serving, "{service}");
    }
}

/// Whoever routes by health learns that a server leaves while its streams are still open.
#[tokio::test]
async fn a_server_that_leaves_says_so_until_it_has_left() {
    let mut server = Loopback::start().await;
    let client = server.client().await;
    let plan = e2e::planned(e2e::fifty_millimetres());
    let mut stream = client::Setpoints::open(&client, e2e::open("x", plan.clone())).await.unwrap();
    let mut health = HealthClient::new(server.channel().await);
    server.tell_to_stop();
    // The server says that it drains at the same time as it tells its streams.
    while stream.take_events().is_empty() {
        assert!(stream.next().await.unwrap().is_some(), "the stream ended without being told");
    }
    let service = "motion.v1.SetpointService".to_owned();
    let answer = health.check(HealthCheckRequest { service }).await.unwrap().into_inner();
    assert_eq!(answer.status(), ServingStatus::NotServing);
    let refused = client::Setpoints::open(&client, e2e::open("y", plan)).await.map(|_| ());
    let Err(client::Error::Rejected(rejected)) = refused else { panic!("{refused:?}") };
    assert_eq!(rejected.reason, proto::Reason::Draining);
    while stream.next().await.unwrap().is_some() {}
    drop((stream, client, health));
    server.stopped().await;
}

#[tokio::test]
async fn reflection_lists_what_is_served_and_nothing_else() {
    let (server, axis) = (Loopback::start().await, LoopbackAxis::start().await);
    let reflection = "grpc.reflection.v1.ServerReflection";
    let of_server =
        ["grpc.health.v1.Health", reflection, "motion.v1.PlannerService", "motion.v1.SetpointService"];
    assert_eq!(listed(server.channel().await).await, of_server);
    let of_axis = ["grpc.health.v1.Health", reflection, "motion.v1.SimAxisService"];
    assert_eq!(listed(axis.channel().await).await, of_axis);
}

/// The services that reflection lists, in alphabetical order.
async fn listed(channel: Channel) -> Vec<String> {
    let mut reflection = ServerReflectionClient::new(channel);
    let request = ServerReflectionRequest {
        host: String::new(),
        message_request: Some(MessageRequest::ListServices(String::new())),
    };
    let mut answers =
        reflection.server_reflection_info(tokio_stream::iter([request])).await.unwrap().into_inner();
    let answer = answers.message().await.unwrap().unwrap().message_response;
    let Some(MessageResponse::ListServicesResponse(list)) = answer else { panic!("{answer:?}") };
    let mut names: Vec<String> = list.service.into_iter().map(|ServiceResponse { name }| name).collect();
    names.sort();
    names
}
