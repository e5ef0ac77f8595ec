//! The streams of a plant over its servers: each asks in an order of its own, and goes on there.

use client::{Client, Error, Servers};
use e2e::{Loopback, LoopbackAxis, move_of, planned};
use proto::Reason;
use proto::stream::Watch;
use sim_axis::{RemoteAxis, TrackRequest};

/// Does the server have this stream?
async fn has(client: &Client, stream: &str) -> bool {
    let mut watching = client.watch(Watch::stream(stream)).await.unwrap();
    match watching.next().await {
        Ok(seen) => seen.is_some(),
        Err(Error::Rejected(rejected)) if rejected.reason == Reason::StreamNotHere => false,
        Err(error) => panic!("{error}"),
    }
}

#[tokio::test]
async fn streams_are_where_their_own_order_has_them_first() {
    let servers = [Loopback::start().await, Loopback::start().await, Loopback::start().await];
    let endpoints = servers.each_ref().map(Loopback::endpoint);
    let axis = LoopbackAxis::start().await;
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    // Ports are drawn, so names are sought that have each server first.
    let first = |name: &String| Servers::at(endpoints.to_vec()).spread_for(name).endpoints[0].clone();
    for endpoint in &endpoints {
        let name = (0..1000).map(|cell| format!("cell-{cell}/x")).find(|name| first(name) == *endpoint);
        let name = name.expect("a third of all names");
        let request = TrackRequest {
            endpoints: endpoints.to_vec(),
            spread: true,
            stay_open: true,
            ..TrackRequest::new(name.clone(), String::new(), planned(move_of(0.05, 0.25)))
        };
        let run = remote.track(request).await.unwrap();
        let mut at = Vec::new();
        for one in &servers {
            at.push(has(&one.client().await, &name).await);
        }
        assert_eq!(at, endpoints.each_ref().map(|one| one == endpoint), "{name} is at {endpoint} alone");
        drop(run);
    }
}
