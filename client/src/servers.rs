use std::time::Duration;

use xxhash_rust::xxh3::xxh3_128;

use crate::Connect;
use crate::failover::DEFAULT_PATIENCE;

/// The servers that may serve a stream.
#[derive(Clone, Debug)]
pub struct Servers {
    /// Where they are, in the order in which they are asked.
    pub endpoints: Vec<String>,
    /// How they are connected to.
    pub connect: Connect,
    /// How long one that goes on is looked for, once there is none.
    pub patience: Duration,
}

impl Servers {
    /// Connected to without encryption, with the [patience](DEFAULT_PATIENCE) that does for a process that is started again.
    #[must_use]
    pub fn at(endpoints: Vec<String>) -> Self {
        Self { endpoints, connect: Connect::new(), patience: DEFAULT_PATIENCE }
    }

    /// The same servers in an order of `stream`'s own, in the place of the order in which they were given.
    ///
    /// Where all streams of a plant have one order, all are at the first server, and when it dies they fall on the second together. So
    /// they are at all servers alike, and the streams of a server that dies fall on all others alike. The order follows from the
    /// name of the stream and the endpoints alone, by rendezvous hashing: it is the same in every process and at every start, and a server
    /// that is added or taken away moves no stream but its own.
    ///
    /// ```
    /// # use client::Servers;
    /// let all = ["http://planner-0:50051", "http://planner-1:50051", "http://planner-2:50051"];
    /// let servers = Servers::at(all.map(String::from).to_vec()).spread_for("cell-7/x");
    /// assert_eq!(servers.endpoints.len(), 3);
    /// ```
    #[must_use]
    pub fn spread_for(mut self, stream: &str) -> Self {
        let place = |endpoint: &String| {
            // A name has no zero, so no two pairs are the same bytes.
            let pair = [stream.as_bytes(), &[0], endpoint.as_bytes()].concat();
            xxh3_128(&pair)
        };
        self.endpoints.sort_by_cached_key(place);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVERS: usize = 8;
    const STREAMS: usize = 8000;

    fn endpoints(count: usize) -> Vec<String> {
        (0..count).map(|number| format!("http://10.0.0.{number}:50051")).collect()
    }

    fn order(endpoints: Vec<String>, stream: usize) -> Vec<String> {
        Servers::at(endpoints).spread_for(&format!("cell-{}/axis-{}", stream / 6, stream % 6)).endpoints
    }

    /// How many streams have each server as the one that `pick` takes of their order.
    fn shares(pick: impl Fn(&[String]) -> Option<&String>) -> Vec<usize> {
        let mut shares = vec![0; SERVERS];
        for stream in 0..STREAMS {
            let order = order(endpoints(SERVERS), stream);
            if let Some(picked) = pick(&order) {
                shares[endpoints(SERVERS).iter().position(|one| one == picked).unwrap()] += 1;
            }
        }
        shares
    }

    /// Four and a half deviations of a share that is drawn.
    fn even(shares: &[usize]) -> bool {
        let mean = shares.iter().sum::<usize>() as f64 / shares.len() as f64;
        shares.iter().all(|share| (*share as f64 - mean).abs() < 4.5 * mean.sqrt())
    }

    #[test]
    fn streams_are_at_all_servers_alike_and_fall_on_all_others_alike() {
        let first = shares(|order| order.first());
        assert!(even(&first), "{first:?}");
        for dead in endpoints(SERVERS) {
            let mut heirs = shares(|order| order.get(1).filter(|_| order.first() == Some(&dead)));
            heirs.retain(|share| *share > 0);
            assert_eq!(heirs.len(), SERVERS - 1, "{dead}: {heirs:?}");
            assert!(even(&heirs), "{dead}: {heirs:?}");
        }
    }

    #[test]
    fn the_order_is_that_of_the_names_however_they_are_given() {
        for stream in 0..100 {
            let mut backwards = endpoints(SERVERS);
            backwards.reverse();
            assert_eq!(order(backwards, stream), order(endpoints(SERVERS), stream));
        }
    }

    #[test]
    fn another_server_moves_no_stream_but_its_own() {
        for stream in 0..1000 {
            let mut with = order(endpoints(SERVERS + 1), stream);
            let added = endpoints(SERVERS + 1).pop().unwrap();
            with.retain(|one| *one != added);
            assert_eq!(with, order(endpoints(SERVERS), stream));
        }
    }
}
