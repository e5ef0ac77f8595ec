//! What a call costs a server process, without what it costs whoever asks.

use std::time::{Duration, Instant};

use client::{Client, Error};
use e2e::{Process, cpu_with_ended, fifty_millimetres, swing, together};

use crate::Failed;
use crate::library::{AXES, BEAT};
use crate::measured::Measured;

/// A server counts its time by hundredths of a second.
const TIME: Duration = Duration::from_millis(600);
/// Points of a table: what a server answers in a while, so that there are some of each.
const POINTS: [usize; 4] = [10, 100, 1000, 10_000];

pub(crate) fn measure(into: &mut Measured) -> Result<(), Failed> {
    let server = Process::server(&[])?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    runtime.block_on(async {
        let client = Client::connect(&server.endpoint).await?;
        for axes in AXES {
            let spec = together(axes, &fifty_millimetres());
            let each = each(&server, async || client.plan(spec.clone()).await.map(drop)).await?;
            into.add("plan", "call, server", axes as f64, 1e6 * each);
        }
        for points in POINTS {
            for (axes, name) in [(1, "call, server, 1 axis"), (6, "call, server, 6 axes")] {
                let spec = swing(axes, points, BEAT * points as f64);
                let each = each(&server, async || client.plan_pvt(spec.clone()).await.map(drop)).await?;
                into.add("points", name, points as f64, 1e3 * each);
            }
        }
        Ok(())
    })
}

/// CPU time of the server for a call \[s\].
async fn each(server: &Process, call: impl AsyncFn() -> Result<(), Error>) -> Result<f64, Failed> {
    call().await?;
    let (before, begun) = (cpu_with_ended(server.child.id())?, Instant::now());
    let mut calls = 0;
    while begun.elapsed() < TIME {
        call().await?;
        calls += 1;
    }
    Ok((cpu_with_ended(server.child.id())? - before) / f64::from(calls))
}
