//! Ten minutes of random deaths, and what they cost in memory.

use std::time::{Duration, Instant};

use e2e::{move_of, planned};
use tokio::task::JoinSet;

use crate::replica::Replica;
use crate::run::{LEAD, Run, alone, request};

/// Every server of three dies now and then under four axes, and comes back; nobody's memory grows. `PORTAMENTO_SOAK_SECONDS` says for
/// how long, 600 where it is not set:
/// `cargo test --release -p e2e --test faults -- --ignored --nocapture soak`.
#[tokio::test(flavor = "multi_thread")]
#[ignore = "takes ten minutes"]
async fn soak() {
    let _alone = alone().await;
    let seconds =
        std::env::var("PORTAMENTO_SOAK_SECONDS").ok().map_or(600, |given| given.parse::<u64>().unwrap());
    let names = ["first", "second", "third"];
    let mut replicas = Vec::new();
    for name in names {
        replicas.push(Replica::start(name).await);
    }
    let endpoints: Vec<String> = replicas.iter().map(Replica::endpoint).collect();
    let until = Instant::now() + Duration::from_secs(seconds);
    let mut axes = JoinSet::new();
    for axis in 0..4_usize {
        let endpoints = endpoints.clone();
        axes.spawn(async move {
            let (mut moves, mut failovers) = (0, 0);
            while Instant::now() < until {
                // One after the other, each of some three seconds: what a run keeps goes with it.
                let plan = planned(move_of(0.7, 0.25));
                let name = format!("soak-{axis}/x");
                let played = Run::begin(request(&name, &endpoints, &plan, LEAD)).await.finish().await;
                played.is_undisturbed(&plan, &[]);
                moves += 1;
                failovers += played.failovers();
            }
            (moves, failovers)
        });
    }
    println!(
        "{:>6} {:>6} {:>12} {:>12} {:>12} {:>12}",
        "t [s]", "kills", "axes [KiB]", "1st [KiB]", "2nd [KiB]", "3rd [KiB]"
    );
    let began = Instant::now();
    let (mut kills, mut drawn, mut here) = (0_u64, 1_u64, Vec::new());
    while Instant::now() < until {
        // Steele, Lea and Flood (2014), splitmix64.
        drawn = drawn.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (drawn ^ (drawn >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let pause = Duration::from_millis(1000 + (mixed >> 32) % 2000);
        let _ = tokio::time::timeout(pause, std::future::pending::<()>()).await;
        let index = (mixed % 3) as usize;
        let address = replicas[index].address();
        replicas[index].kill();
        replicas[index] = Replica::with(names[index], address, &[]).await;
        kills += 1;
        if kills % 10 == 0 {
            let mine = resident_kib(std::process::id());
            let theirs: Vec<u64> = replicas.iter().map(|replica| resident_kib(replica.pid())).collect();
            println!(
                "{:>6} {kills:>6} {mine:>12} {:>12} {:>12} {:>12}",
                began.elapsed().as_secs(),
                theirs[0],
                theirs[1],
                theirs[2]
            );
            here.push(mine);
        }
    }
    let (mut moves, mut failovers) = (0, 0);
    while let Some(axis) = axes.join_next().await {
        let of_axis = axis.unwrap();
        (moves, failovers) = (moves + of_axis.0, failovers + of_axis.1);
    }
    println!("{kills} kills, {moves} moves, {failovers} fail-overs");
    assert!(failovers > 0);
    // The first rows are of a process that still finds its size.
    let (early, late) = here.split_at(here.len() / 2);
    if let (Some(early), Some(late)) = (early.iter().max(), late.iter().max()) {
        assert!(*late <= early + early / 5, "{late} KiB after {early} KiB");
    }
}

/// Memory that a process has in use [KiB].
fn resident_kib(process: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.split_whitespace().next().unwrap().parse().unwrap()
}
