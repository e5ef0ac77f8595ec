//! An axis process that gets no processor for a while.

use e2e::{move_of, planned, replay};
use sim_axis::{RemoteAxis, Update};

use crate::replica::Replica;
use crate::run::{LEAD, alone, request};

/// It is stopped for thirty cycles: they run late, one after the other, and none is missed or other than planned.
#[tokio::test(flavor = "multi_thread")]
async fn an_axis_that_stalls_makes_up_for_it() {
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let (server, axis) = (Replica::start("server").await, Replica::axis(&[]).await);
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let mut run = remote.track(request("cell-7/x", &[server.endpoint()], &plan, LEAD)).await.unwrap();
    let (mut cycles, mut stalls) = (0, 0);
    while let Some(update) = run.next().await.unwrap() {
        let Update::Samples(samples) = update else { continue };
        cycles += samples.commanded.cycles();
        if cycles > 300 * (stalls + 1) && stalls < 3 {
            stalls += 1;
            axis.stalls(30);
        }
    }
    let report = run.finish().unwrap().stream;
    let (_, digest, motion) = replay(&plan, &[], plan.plan().cycle_count());
    assert_eq!((report.digest, report.cycles_executed), (digest, motion.last_cycle()));
    assert_eq!((report.counters.underruns, report.failovers), (0, 0), "{report:?}");
    assert!(report.counters.late_cycles >= 20, "thirty cycles began late, three times: {report:?}");
    assert!(report.jitter.max >= 0.02, "{report:?}");
}
