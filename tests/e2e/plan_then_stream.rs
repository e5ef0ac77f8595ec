//! A controller plans, an axis plays: the same setpoints, to the bit, as whoever evaluates the plan.

use client::Setpoints;
use e2e::{Loopback, fifty_millimetres, move_of, open, planned};
use planner::{AxisMoveSpec, Judged, Setpoint, ShortPathPolicy, State};
use proto::Digest;
use proto::stream::{Open, StreamEventKind};

/// Plays a stream to its end; gives the digest and the last setpoint of the first axis.
async fn play(stream: &mut Setpoints) -> (u64, Digest, Setpoint) {
    let mut last = (0, Digest::ZERO, Setpoint::default());
    while let Some(playing) = stream.next().await.unwrap() {
        assert_eq!(playing.cycle, last.0 + 1);
        last = (playing.cycle, playing.digest, playing.setpoints[0]);
    }
    last
}

#[tokio::test]
async fn a_move_is_planned_and_played() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let judged = client.plan(fifty_millimetres()).await.unwrap();
    assert!(judged.certificate().passed());
    assert_eq!(judged.plan().cycle_count(), 314);
    assert_eq!(judged.plan(), planned(fifty_millimetres()).plan());
    let digest = client.digest(&judged).await.unwrap();

    let mut stream = Setpoints::open(&client, open("cell-7/x", judged.accepted().unwrap())).await.unwrap();
    assert_eq!(stream.served_by(), server.endpoint().trim_start_matches("http://"));
    let (cycles, played, end) = play(&mut stream).await;
    assert_eq!((cycles, played), (314, digest));
    assert_eq!(end.words(), [0.05, 0.0, 0.0, 0.0]);
    let events: Vec<_> = stream.take_events().iter().map(|event| event.kind).collect();
    assert_eq!(events, [StreamEventKind::Finished]);
    assert_eq!(stream.buffer().counters().refused_batches, 0);
}

/// Ten minutes of motion take as long as they take to compute, and twice the same.
#[tokio::test]
async fn ten_minutes_in_virtual_time_have_the_digest_of_the_plan() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let judged = client.plan(move_of(60.0, 0.1)).await.unwrap();
    assert!(judged.plan().cycle_count() > 600_000);
    let digest = client.digest(&judged).await.unwrap();
    for run in ["first", "second"] {
        let opening =
            Open { lead_cycles: 250, batch_cycles: 100, ..open(run, judged.clone().accepted().unwrap()) };
        let mut stream = Setpoints::open(&client, opening).await.unwrap();
        let (cycles, played, _) = play(&mut stream).await;
        assert_eq!((cycles, played), (judged.plan().cycle_count(), digest), "{run}");
    }
}

#[tokio::test]
async fn several_axes_end_each_by_itself() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let mut spec = fifty_millimetres();
    let second = AxisMoveSpec { axis: "y".into(), goal: State::at_rest(-0.2), ..spec.axes[0].clone() };
    spec.axes.push(second);
    let judged = client.plan(spec).await.unwrap();
    assert_eq!(judged.explanation().critical_axis, "y");
    let digest = client.digest(&judged).await.unwrap();
    let last = judged.plan().cycle_count();
    let mut stream = Setpoints::open(&client, open("cell-7/xy", judged.accepted().unwrap())).await.unwrap();
    let mut ends = Vec::new();
    let mut played = Digest::ZERO;
    while let Some(playing) = stream.next().await.unwrap() {
        if playing.cycle == 314 || playing.cycle == last {
            ends.push(playing.setpoints[0].words());
        }
        played = playing.digest;
    }
    assert_eq!(ends, [[0.05, 0.0, 0.0, 0.0]; 2]);
    assert_eq!(played, digest);
}

#[tokio::test]
async fn a_plan_that_ends_at_speed_closes_with_a_stop() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let mut spec = fifty_millimetres();
    spec.axes[0].goal.velocity = 0.1;
    let judged = client.plan(spec).await.unwrap();
    assert_eq!(judged.plan().axes()[0].profile.end().velocity, 0.1);
    let mut stream = Setpoints::open(&client, open("x", judged.clone().accepted().unwrap())).await.unwrap();
    let motion = stream.motion().clone();
    assert_eq!(motion.under_way.closing_from_cycle(), Some(judged.plan().cycle_count()));
    let (_, _, end) = play(&mut stream).await;
    assert_eq!((end.state.velocity, end.state.acceleration), (0.0, 0.0));
    assert!(end.state.position > 0.05);
}

/// From motion past the goal and back, and from beyond the limits: planned, judged again elsewhere, and played.
#[tokio::test]
async fn a_move_between_any_states_is_planned_and_played() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let moving = |velocity, acceleration| State { position: 0.01, velocity, acceleration };
    for (name, start, leads_back) in
        [("turns back", moving(0.2, 2.0), false), ("led back", moving(-0.4, -4.0), true)]
    {
        let mut spec = fifty_millimetres();
        spec.short_path = Ok(ShortPathPolicy::Reverse);
        spec.axes[0].start = start;
        spec.axes[0].goal = State { acceleration: 1.5, velocity: 0.1, position: 0.0105 };
        let judged = client.plan(spec.clone()).await.unwrap();
        assert_eq!(judged.plan(), planned(spec).plan(), "{name}");
        assert!(judged.certificate().passed(), "{name}");
        assert_eq!(judged.certificate().is_led_back(), leads_back, "{name}");
        let elsewhere = Loopback::start().await;
        let again = elsewhere.client().await.verify(judged.plan(), Vec::new()).await.unwrap();
        assert_eq!(&again, judged.certificate(), "{name}");

        let mut stream =
            Setpoints::open(&client, open(name, judged.clone().accepted().unwrap())).await.unwrap();
        let (_, _, end) = play(&mut stream).await;
        assert_eq!((end.state.velocity, end.state.acceleration), (0.0, 0.0), "{name}");
        assert_eq!(stream.buffer().counters().refused_batches, 0, "{name}");
    }
}

#[tokio::test]
async fn a_plan_of_nothing_is_over_at_once() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let judged = client.plan(move_of(0.0, 0.25)).await.unwrap();
    assert!(judged.plan().axes()[0].profile.segments().is_empty());
    let mut stream = Setpoints::open(&client, open("x", judged.accepted().unwrap())).await.unwrap();
    assert!(stream.next().await.unwrap().is_none());
}

#[tokio::test]
async fn a_stream_that_stays_open_stands_still_until_it_is_closed() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let opening = Open { close_at_rest: false, ..open("x", planned(fifty_millimetres())) };
    let mut stream = Setpoints::open(&client, opening).await.unwrap();
    for cycle in 1..=1000 {
        let playing = stream.next().await.unwrap().unwrap();
        assert_eq!(playing.cycle, cycle);
        if cycle >= 314 {
            assert_eq!(playing.setpoints[0].words(), [0.05, 0.0, 0.0, 0.0]);
        }
    }
    assert!(stream.take_events().iter().any(|event| event.kind == StreamEventKind::Standstill));
    stream.close();
    while stream.next().await.unwrap().is_some() {}
}

#[tokio::test]
async fn what_is_sampled_is_what_the_plan_says() {
    let server = Loopback::start().await;
    let client = server.client().await;
    let judged = Judged::new(planned(fifty_millimetres()).plan().clone());
    let whole = client.digest(&judged).await.unwrap();
    let mut samples = client.sample(&judged, 100, 50).await.unwrap();
    let chunk = samples.next().await.unwrap().unwrap();
    assert_eq!((chunk.first_cycle, chunk.columns.cycles()), (100, 50));
    let expected: Vec<_> = judged.plan().sampler().at(120).collect();
    assert_eq!(chunk.columns.at(0, 20), Some(expected[0]));
    assert!(samples.next().await.unwrap().is_none());
    // The digest runs from cycle 1, whatever is read.
    let mut samples = client.sample(&judged, 314, 0).await.unwrap();
    assert_eq!(samples.next().await.unwrap().unwrap().digest, whole);
}

#[tokio::test]
async fn a_drained_server_lets_streams_end_and_takes_no_new_ones() {
    let mut server = Loopback::start().await;
    let client = server.client().await;
    let mut stream = Setpoints::open(&client, open("x", planned(fifty_millimetres()))).await.unwrap();
    server.tell_to_stop();
    let (cycles, _, _) = play(&mut stream).await;
    assert_eq!(cycles, 314);
    let events: Vec<_> = stream.take_events().iter().map(|event| event.kind).collect();
    assert_eq!(events, [StreamEventKind::Draining, StreamEventKind::Finished]);
    drop((stream, client));
    server.stopped().await;
}
