//! Clients that know nothing of ours but the address, or the schema: tools by reflection, and Python.

use std::process::{Command, Stdio};

use client::address;
use e2e::{Reflected, VERSIONS, fifty_millimetres, planned};

use crate::engine::{self, Container, Network};

/// As grpcurl does it, in both versions of reflection.
#[tokio::test(flavor = "multi_thread")]
async fn tools_plan_stream_and_hold_by_reflection() {
    if !engine::is_there() {
        return;
    }
    engine::images();
    let network = Network::new("reflected");
    let server = Container::start(&network, "server", "server", 50051);
    for version in VERSIONS {
        let channel = address(&server.endpoint()).unwrap().connect().await.unwrap();
        let reflected = Reflected::by(version, channel).await.unwrap();
        let cycles = reflected.plan_stream_and_hold(&format!("reflected/{version}")).await.unwrap();
        assert!(cycles > planned(fifty_millimetres()).plan().cycle_count(), "{version}: {cycles}");
    }
}

/// With what grpcio makes of the `.proto` files alone, and with our client in Python.
#[tokio::test(flavor = "multi_thread")]
async fn python_plans_streams_and_holds() {
    if !engine::is_there() {
        return;
    }
    engine::images();
    let network = Network::new("python");
    let server = Container::start(&network, "server", "server", 50051);
    let axis = Container::start(&network, "sim-axis", "axis", 50052);
    let without_scheme = |container: &Container| container.endpoint().replace("http://", "");
    let mut tests = Command::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../client/python/test"));
    tests.args(["-k", "test_plan_stream_and_hold or test_a_stream_is_tracked_held_and_watched"]);
    tests.envs([
        ("PORTAMENTO_BUILT", "1".to_owned()),
        ("PORTAMENTO_SERVER", without_scheme(&server)),
        ("PORTAMENTO_SIM_AXIS", without_scheme(&axis)),
        ("PORTAMENTO_PLANNER", "http://server:50051".to_owned()),
    ]);
    let ended =
        tokio::task::spawn_blocking(move || tests.stdin(Stdio::null()).output()).await.unwrap().unwrap();
    let said = String::from_utf8_lossy(&ended.stdout);
    assert!(ended.status.success(), "{said}\n{}", String::from_utf8_lossy(&ended.stderr));
    assert!(said.contains("2 passed"), "{said}");
    // It was these that answered.
    assert_eq!(server.figure("motion_streams_opened_total").await, 2.0);
}
