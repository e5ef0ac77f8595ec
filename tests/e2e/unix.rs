//! A Unix socket for an address: everything goes through it as through a port.

use client::{Client, Setpoints};
use e2e::{Loopback, fifty_millimetres, open, planned};
use server::{Address, Config};

#[tokio::test]
async fn plans_and_streams_go_through_a_socket() {
    let path = std::env::temp_dir().join(format!("portamento-e2e-{}.sock", std::process::id()));
    let mut config = Config::loopback();
    config.serving.listen = Address::Unix(path.clone());
    let mut server = Loopback::with(config).await;
    assert_eq!(server.endpoint(), format!("unix:{}", path.display()));
    let client = Client::connect(&server.endpoint()).await.unwrap();
    let judged = client.plan(fifty_millimetres()).await.unwrap();
    assert_eq!(judged, *planned(fifty_millimetres()).judged());
    assert_eq!(client.plan_all(vec![fifty_millimetres()]).await.unwrap(), [Ok(judged.clone())]);
    let plan = judged.accepted().unwrap();
    let mut stream = Setpoints::open(&client, open("x", plan)).await.unwrap();
    let mut cycles = 0;
    while stream.next().await.unwrap().is_some() {
        cycles += 1;
    }
    assert_eq!(cycles, 314);
    drop((stream, client));
    server.tell_to_stop();
    server.stopped().await;
    assert!(!path.exists());
}
