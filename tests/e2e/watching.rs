//! Looking on at streams: what is shown is what the axis played, and nobody is delayed by it.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use client::{Error, Setpoints};
use e2e::{Loopback, fifty_millimetres, move_of, open, planned};
use planner::AxisKind;
use proto::Reason;
use proto::stream::{Ask, Open, Operation, Phase, StreamEventKind, Watch, Watched};
use sim_axis::{AxisModel, Clock, TrackRequest, Tracking, Update};

const MOMENT: Duration = Duration::from_secs(20);

async fn next(watching: &mut client::Watching) -> Option<Watched> {
    tokio::time::timeout(MOMENT, watching.next()).await.expect("in time").unwrap()
}

/// Commanded position, following error by cycle, as somebody has seen them.
type Rows = BTreeMap<u64, (f64, Option<f64>)>;

/// An axis with a spring in it is slowed, held and resumed on its way, and watched meanwhile: whatever the watcher sees of a
/// cycle is what the axis says of it, over every splice.
///
/// Operations are asked for once the watcher sees the axis move, and each once what came of the one before is in sight: a machine
/// that is busy may show the first cycles to nobody.
#[tokio::test]
async fn what_is_shown_is_what_was_played() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let request = TrackRequest {
        models: vec![AxisModel::flexible("x")],
        clock: Clock::Wall,
        // So that a machine that stands still for a while makes no other story of it.
        lead_cycles: 250,
        settle_window: 0.05,
        ..TrackRequest::new("cell-7/x", server.endpoint(), planned(move_of(1.0, 0.25)))
    };
    let mut tracking = Tracking::begin(request).await.unwrap();
    let commander = tracking.commander();
    let watch = Watch { max_points: 10_000, ..Watch::stream("cell-7/x").every(Duration::from_millis(20)) };
    let mut watching = client.watch(watch).await.unwrap();
    let seen = tokio::spawn(async move {
        let (mut rows, mut phases, mut events) = (Rows::new(), Vec::new(), Vec::new());
        let mut asks = VecDeque::from([Ask::Override(0.5), Ask::Hold, Ask::Resume]);
        let mut ask_at = 0;
        while let Some(watched) = next(&mut watching).await {
            assert_eq!(
                (watched.axes.as_slice(), watched.kinds.as_slice()),
                (&["x".to_owned()][..], &[AxisKind::Prismatic][..])
            );
            assert_eq!(watched.messages_dropped, 0);
            assert!(watched.cycles.is_sorted());
            for (index, cycle) in watched.cycles.iter().enumerate() {
                let position = watched.commanded.at(0, index).unwrap().state.position;
                let error = watched.tracking.as_ref().map(|tracking| tracking.following_error[index]);
                assert_eq!(rows.insert(*cycle, (position, error)), None, "cycle {cycle} is shown once");
            }
            if phases.last() != Some(&watched.phase) {
                phases.push(watched.phase);
            }
            events.extend(watched.events);
            let shown = watched.cycles.last().copied().unwrap_or_default();
            if shown > ask_at
                && let Some(ask) = asks.pop_front()
            {
                let operation = Operation::now(format!("after {shown}"), ask);
                let result = commander.operate(operation).await.unwrap();
                // By then it stands, or has its new speed, and has been seen so.
                ask_at = result.effective_cycle + 300;
            }
        }
        // Where it sees nothing more too early, the axis is not left holding.
        for (left, ask) in asks.into_iter().enumerate() {
            let _ = commander.operate(Operation::now(format!("left {left}"), ask)).await;
        }
        (rows, phases, events)
    });
    let mut played = Rows::new();
    while let Some(update) = tracking.next().await {
        if let Update::Samples(samples) = update {
            for (index, cycle) in (0..samples.commanded.cycles()).zip(samples.first_cycle..) {
                let position = samples.commanded.at(0, index).unwrap().state.position;
                played.insert(cycle, (position, Some(samples.tracking.following_error[index])));
            }
        }
    }
    let report = tracking.finish().await.unwrap();
    let (rows, phases, events) = tokio::time::timeout(MOMENT, seen).await.unwrap().unwrap();
    // Of a run by the wall clock, who reads too slowly loses the oldest samples.
    let both: Vec<_> =
        rows.iter().filter_map(|(cycle, shown)| Some((cycle, shown, played.get(cycle)?))).collect();
    for (cycle, (position, error), (at, off)) in &both {
        assert_eq!(position, at, "cycle {cycle}");
        assert!(error.is_none() || error == off, "cycle {cycle}");
    }
    // An axis that was kept from the processor for a second has opened its stream again, and the watcher saw the end of the first.
    if report.stream.failovers > 0 {
        return;
    }
    assert!(both.len() > 300, "{} of {} and {}", both.len(), rows.len(), played.len());
    let errors: Vec<_> = rows.values().filter_map(|(_, error)| *error).collect();
    assert!(errors.len() > 200, "{}", errors.len());
    assert!(errors.iter().any(|error| error.abs() > 1e-6));
    assert_eq!(phases, [Phase::Moving, Phase::Holding, Phase::Moving, Phase::Finished]);
    assert_eq!(events.last().map(|event| event.kind), Some(StreamEventKind::Finished));
}

#[tokio::test]
async fn all_streams_are_shown_with_how_they_stand() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let mut streams = Vec::new();
    for name in ["cell-7/x", "cell-7/y"] {
        let open = Open { close_at_rest: false, ..open(name, planned(fifty_millimetres())) };
        let mut stream = Setpoints::open(&client, open).await.unwrap();
        crate::operations::play_to(&mut stream, 100).await;
        streams.push(stream);
    }
    let mut watching = client.watch(Watch::all().every(Duration::from_millis(10))).await.unwrap();
    let mut seen = BTreeMap::new();
    while seen.len() < 2 {
        let watched = next(&mut watching).await.unwrap();
        assert!(watched.cycles.is_empty() && watched.tracking.is_none());
        seen.insert(watched.stream, watched.executed_cycle);
    }
    assert!(seen.values().all(|executed| *executed > 50), "{seen:?}");
    // One that has ended is shown no more.
    drop(streams.pop());
    let gone = async {
        loop {
            let (first, second) = (next(&mut watching).await.unwrap(), next(&mut watching).await.unwrap());
            if first.stream == second.stream {
                return first.stream;
            }
        }
    };
    assert_eq!(tokio::time::timeout(MOMENT, gone).await.unwrap(), "cell-7/x");
}

/// The axis plays on at the pace of its credit while nobody reads what a watcher is sent; once somebody does, the loss is
/// counted.
#[tokio::test]
async fn a_watcher_who_does_not_read_delays_nobody_and_is_told_what_it_lost() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let open = Open { close_at_rest: false, ..open("cell-7/x", planned(move_of(1.0, 0.25))) };
    let mut stream = Setpoints::open(&client, open).await.unwrap();
    crate::operations::play_to(&mut stream, 50).await;
    let watch = Watch { max_points: 10_000, ..Watch::stream("cell-7/x").every(Duration::from_millis(1)) };
    let mut watching = client.watch(watch.clone()).await.unwrap();
    // More than channel, transport and windows hold; how much that is depends on how often the watcher's turn comes meanwhile.
    let mut played = 50;
    for _ in 0..20 {
        played += 400_000;
        crate::operations::play_to(&mut stream, played).await;
        // The axis plays on while what waits is read: a stream of which nothing is heard ends.
        for _ in 0..2000 {
            let watched = next(&mut watching).await;
            if watched.as_ref().is_some_and(|watched| watched.messages_dropped > 0) {
                return;
            }
            played += 10;
            crate::operations::play_to(&mut stream, played).await;
            if watched.is_none() {
                // Kept from the processor for long, the axis has opened its stream again.
                watching = client.watch(watch.clone()).await.unwrap();
            }
        }
    }
    panic!("nothing was lost of {played} cycles that nobody read");
}

#[tokio::test]
async fn what_cannot_be_watched_is_refused_with_the_way_out() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let mut watching = client.watch(Watch::stream("nowhere")).await.unwrap();
    let refused = watching.next().await.unwrap_err();
    assert!(
        matches!(&refused, Error::Rejected(rejected) if rejected.reason == Reason::StreamNotHere),
        "{refused}"
    );
    for watch in [
        Watch::all().every(Duration::ZERO),
        Watch::all().every(Duration::from_secs(61)),
        Watch { max_points: 10_001, ..Watch::all() },
    ] {
        let refused = client.watch(watch).await.unwrap_err();
        let reason =
            matches!(&refused, Error::Rejected(rejected) if rejected.reason == Reason::ValueOutOfRange);
        assert!(reason, "{refused}");
    }
}
