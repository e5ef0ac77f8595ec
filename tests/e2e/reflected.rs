//! What tools do that have an address and nothing else, as grpcurl: ask for the schema, and call by it.

use e2e::{Loopback, LoopbackAxis, Reflected, VERSIONS, fifty_millimetres, planned};
use proto::Reason;
use serde_json::{Value, json};
use tonic::Code;

#[tokio::test]
async fn plan_stream_and_hold_by_reflection_alone() {
    let server = Loopback::start().await;
    for version in VERSIONS {
        let reflected = Reflected::by(version, server.channel().await).await.unwrap();
        let cycles = reflected.plan_stream_and_hold(&format!("reflected/{version}")).await.unwrap();
        // Not before the plan ends: it was held on the way.
        assert!(cycles > planned(fifty_millimetres()).plan().cycle_count(), "{version}: {cycles}");
    }
}

/// A refusal comes with its reason as any tool shows it: in the details of the status.
#[tokio::test]
async fn a_refusal_by_reflection_teaches_as_well() {
    let axis = LoopbackAxis::start().await;
    let reflected = Reflected::by("v1", axis.channel().await).await.unwrap();
    let model = reflected.call("motion.v1.SimAxisService/GetAxisModel", json!({})).await.unwrap();
    assert!(model["models"].is_array(), "{model}");
    let hold =
        json!({"stream": "none", "operation": {"requestId": "1", "hold": Value::Object(Default::default())}});
    let status = reflected.call("motion.v1.SimAxisService/Command", hold).await.unwrap_err();
    assert_eq!(proto::Rejected::from_status(&status).unwrap().reason, Reason::StreamNotHere);
}

/// Where it is switched off, nobody is told: neither version is there.
#[tokio::test]
async fn reflection_can_be_switched_off() {
    let mut config = server::Config::loopback();
    config.serving.reflection = false;
    let server = Loopback::with(config).await;
    for version in VERSIONS {
        let status = Reflected::by(version, server.channel().await).await.map(drop).unwrap_err();
        assert_eq!(status.code(), Code::Unimplemented, "{version}");
    }
    // What it serves is served all the same.
    assert!(server.client().await.plan(fifty_millimetres()).await.is_ok());
}
