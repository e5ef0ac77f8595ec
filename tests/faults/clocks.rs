//! Wall clocks that are set: nothing on a stream reads one.
//!
//! The clock of one process is set by `libfaketime`, which stands between it and the system, and leaves the monotonic clock alone. It is
//! Debian's package of that name; without it these stories say so and pass, unless `PORTAMENTO_REQUIRE_FAKETIME` is set.

use std::path::Path;

use e2e::{move_of, planned, replay};
use sim_axis::{RemoteAxis, TrackingReport, Update};

use crate::replica::Replica;
use crate::run::{LEAD, alone, request};

const LIBRARY: &str = "/usr/lib/x86_64-linux-gnu/faketime/libfaketime.so.1";

/// The environment of a process whose wall clock is set by what stands in the file `set_by`.
fn environment(set_by: &Path) -> [(&'static str, String); 4] {
    [
        ("LD_PRELOAD", LIBRARY.into()),
        ("FAKETIME_TIMESTAMP_FILE", set_by.display().to_string()),
        ("FAKETIME_NO_CACHE", "1".into()),
        ("FAKETIME_DONT_FAKE_MONOTONIC", "1".into()),
    ]
}

#[tokio::test(flavor = "multi_thread")]
async fn a_clock_that_is_set_by_an_hour_changes_nothing() {
    if !Path::new(LIBRARY).is_file() {
        assert!(
            std::env::var_os("PORTAMENTO_REQUIRE_FAKETIME").is_none(),
            "{LIBRARY} is not there: apt-get install libfaketime"
        );
        eprintln!("skipped: {LIBRARY} is not there: apt-get install libfaketime");
        return;
    }
    let _alone = alone().await;
    let plan = planned(move_of(0.3, 0.25));
    let (_, digest, motion) = replay(&plan, &[], plan.plan().cycle_count());
    for (of_server, step) in [(true, "+1h"), (true, "-1h"), (false, "+1h"), (false, "-1h")] {
        let report = with_a_step(&plan, of_server, step).await.stream;
        assert_eq!((report.digest, report.cycles_executed), (digest, motion.last_cycle()), "{step}");
        assert_eq!((report.counters.underruns, report.failovers), (0, 0), "{step}: {report:?}");
        assert_eq!(report.counters.refused_batches, 0, "{step}: {report:?}");
    }
}

async fn with_a_step(plan: &planner::Accepted, of_server: bool, step: &str) -> TrackingReport {
    let set_by =
        std::env::temp_dir().join(format!("portamento-clock-{}-{of_server}{step}", std::process::id()));
    std::fs::write(&set_by, "+0").unwrap();
    let set = environment(&set_by);
    let (server, axis) = if of_server {
        (Replica::within("server", &set).await, Replica::axis(&[]).await)
    } else {
        (Replica::start("server").await, Replica::axis(&set).await)
    };
    let remote = RemoteAxis::connect(&axis.endpoint()).await.unwrap();
    let mut run = remote.track(request("cell-7/x", &[server.endpoint()], plan, LEAD)).await.unwrap();
    let mut cycles = 0;
    while let Some(update) = run.next().await.unwrap() {
        if let Update::Samples(samples) = update {
            let before = cycles;
            cycles += samples.commanded.cycles();
            if before < 300 && cycles >= 300 {
                std::fs::write(&set_by, step).unwrap();
            }
        }
    }
    std::fs::remove_file(&set_by).unwrap();
    run.finish().unwrap()
}
