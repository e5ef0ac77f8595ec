//! Streams that share connections, as those of one gateway may.

use client::{Connect, Error, Servers, Setpoints};
use e2e::{Loopback, fifty_millimetres, move_of, open, planned};
use server::Config;

/// A server that takes so many connections.
async fn with_connections(most: usize) -> Loopback {
    let mut config = Config::loopback();
    config.serving.max_connections = most;
    Loopback::with(config).await
}

#[tokio::test]
async fn four_streams_go_over_one_connection() {
    let server = with_connections(1).await;
    let connect = Connect::new().shared_by(4);
    let servers = Servers { connect: connect.clone(), ..Servers::at(vec![server.endpoint()]) };
    let plan = planned(fifty_millimetres());
    let mut streams = Vec::new();
    for axis in ["a", "b", "c", "d"] {
        streams.push(Setpoints::open_at(servers.clone(), open(axis, plan.clone())).await.unwrap());
    }
    let fifth = connect.to(&server.endpoint()).await;
    let answered = match fifth {
        Ok(client) => client.plan(fifty_millimetres()).await.map(|_| ()),
        Err(error) => Err(error),
    };
    assert!(matches!(answered, Err(Error::Unreachable { .. })), "a connection of its own: {answered:?}");
    for stream in &mut streams {
        let mut cycles = 0;
        while stream.next().await.unwrap().is_some() {
            cycles += 1;
        }
        assert_eq!(cycles, 314);
    }
}

#[tokio::test]
async fn streams_that_share_a_connection_move_over_together() {
    let (mut first, second) = (with_connections(1).await, with_connections(1).await);
    let endpoints = vec![first.endpoint(), second.endpoint()];
    let servers = Servers { connect: Connect::new().shared_by(8), ..Servers::at(endpoints) };
    let plan = planned(move_of(5.0, 0.25));
    let mut streams = Vec::new();
    for axis in ["a", "b", "c"] {
        streams.push(Setpoints::open_at(servers.clone(), open(axis, plan.clone())).await.unwrap());
    }
    first.tell_to_stop();
    // All at a time, as axes play: one that is not read would come to its server's drain deadline.
    let playing: Vec<_> = streams
        .into_iter()
        .map(|mut stream| {
            tokio::spawn(async move {
                let mut cycles = 0;
                while stream.next().await.unwrap().is_some() {
                    cycles += 1;
                }
                let changes = stream.take_changes();
                assert!(
                    !changes.is_empty() && stream.served_by() == changes.last().unwrap().to,
                    "{changes:?}"
                );
                cycles
            })
        })
        .collect();
    for cycles in playing {
        assert_eq!(cycles.await.unwrap(), plan.plan().cycle_count());
    }
}
