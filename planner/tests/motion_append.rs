//! Points appended to a motion that is under way.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use planner::motion::{AxisPoints, Motion, Operation, Override, Phase, Points, Refused};
use planner::{
    AxisKind, Judged, LimitsSpec, PvtAxisSpec, PvtInterpolation, PvtPolicy, PvtRequest, PvtRequestSpec,
    State, certify, plan_pvt,
};
use proptest::prelude::*;

const NAMES: [&str; 3] = ["x", "y", "z"];
/// Of the limits [1]: a command next to a border between regions turns an ulp of its start into as much.
const NEAR: f64 = 1e-8;

/// The points of one axis: when, where, how fast.
#[derive(Clone, Debug, Default)]
struct Track {
    times: Vec<f64>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
}

/// A target as a camera might see it, on a beat of 50 ms: smooth, with noise and now and then a jump.
fn tracks(random: &mut Random, axes: usize, count: usize) -> Vec<Track> {
    let beat = 0.05;
    let draw = |random: &mut Random| {
        let (phase, size) = (random.between(0.0, 6.0), random.between(0.05, 0.4));
        let mut track = Track::default();
        for point in 1..=count {
            let t = point as f64 * beat;
            let jump = if random.unit() < 0.05 { random.between(-0.1, 0.1) } else { 0.0 };
            track.times.push(t);
            track
                .positions
                .push(size * ((2.0 * t + phase).sin() - phase.sin()) + random.between(-1e-3, 1e-3) + jump);
            track.velocities.push(2.0 * size * (2.0 * t + phase).cos());
        }
        track
    };
    (0..axes).map(|_| draw(random)).collect()
}

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 2.0, max_acceleration: 20.0, max_jerk: 800.0, ..LimitsSpec::default() }
}

fn opened(tracks: &[Track], count: usize, interpolation: PvtInterpolation, policy: PvtPolicy) -> Motion {
    let axes = tracks.iter().zip(NAMES).map(|(track, name)| PvtAxisSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        limits: limits(),
        start: State::at_rest(0.0),
        times: track.times[..count].to_vec(),
        positions: track.positions[..count].to_vec(),
        velocities: track.velocities[..count].to_vec(),
    });
    let spec = PvtRequestSpec {
        axes: axes.collect(),
        cycle_time_ns: None,
        interpolation: Ok(interpolation),
        policy: Ok(policy),
        finish_unreached: false,
    };
    let plan = plan_pvt(&PvtRequest::try_from(spec).unwrap()).unwrap().plan().clone();
    Motion::open(Judged::new(plan).accepted().unwrap()).unwrap()
}

/// Points `from..to`, their times counted from the one before, on the same beat.
fn points(tracks: &[Track], from: usize, to: usize) -> Points {
    let axes = tracks.iter().zip(NAMES).map(|(track, name)| AxisPoints {
        axis: name.into(),
        times: track.times[..to - from].to_vec(),
        positions: track.positions[from..to].to_vec(),
        velocities: track.velocities[from..to].to_vec(),
    });
    Points { axes: axes.collect(), last: false }
}

fn words(state: State) -> [f64; 3] {
    [state.position, state.velocity, state.acceleration]
}

/// Commands do not know what comes after them: played in parts it is the motion through all points at once.
fn in_parts(seed: u64) {
    let mut random = Random(seed);
    let interpolation = [PvtInterpolation::SShaped, PvtInterpolation::SShaped, PvtInterpolation::Quintic]
        [random.bits() as usize % 3];
    let policy = [PvtPolicy::PreferVelocity, PvtPolicy::PreferPosition][random.bits() as usize % 2];
    let count = 4 + random.bits() as usize % 20;
    let tracks = tracks(&mut random, 1 + seed as usize % 3, count);
    let whole = opened(&tracks, count, interpolation, policy);
    let mut known = 1 + random.bits() as usize % 3;
    let mut motion = opened(&tracks, known, interpolation, policy);
    let mut cycle = 0;
    loop {
        let closing = motion.closing_from_cycle().unwrap_or(motion.last_cycle());
        let next = cycle + random.bits() % (closing - cycle);
        let check = |motion: &Motion, cycle| {
            for index in 0..tracks.len() {
                let (ours, theirs) = (motion.state(index, cycle), whole.state(index, cycle));
                for ((ours, theirs), limit) in
                    words(ours).into_iter().zip(words(theirs)).zip([1.0, 2.0, 20.0])
                {
                    let scale = theirs.abs().max(limit);
                    assert!(
                        (ours - theirs).abs() <= NEAR * scale,
                        "{ours} for {theirs} at {cycle} of {closing}"
                    );
                }
            }
        };
        (cycle..=next).for_each(|cycle| check(&motion, cycle));
        cycle = next;
        if known == count {
            break;
        }
        let until = (known + 1 + random.bits() as usize % 4).min(count);
        let spliced = motion.splice(cycle, &Operation::Append(points(&tracks, known, until))).unwrap();
        known = until;
        assert!(spliced.on_path && certify(spliced.motion.plan()).passed());
        for index in 0..tracks.len() {
            assert_eq!(spliced.motion.state(index, cycle), motion.state(index, cycle));
        }
        assert!(spliced.motion.base().is_none(), "what is behind is forgotten");
        motion = spliced.motion;
    }
    // A rounding may be what is passed at speed, or not.
    let closes = motion.closing_from_cycle().zip(whole.closing_from_cycle());
    assert!(closes.is_none_or(|(ours, theirs)| ours == theirs), "{closes:?}");
    assert!(motion.last_cycle().abs_diff(whole.last_cycle()) <= 1);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn in_parts_it_is_the_whole(seed in any::<u64>()) {
        in_parts(seed);
    }
}

/// Six points, 300 ms, and the motion through the first three of them.
fn first_three() -> (Vec<Track>, Motion) {
    let tracks = tracks(&mut Random(7), 2, 6);
    let motion = opened(&tracks, 3, PvtInterpolation::SShaped, PvtPolicy::PreferVelocity);
    (tracks, motion)
}

#[test]
fn a_hold_is_resumed_to_what_was_appended() {
    let (tracks, motion) = first_three();
    let held = motion.splice(60, &Operation::Hold).unwrap();
    let more = Operation::Append(points(&tracks, 3, 6));
    for (cycle, held) in [(70, &held.motion), (held.rest_cycle + 5, &held.motion)] {
        let appended = held.splice(cycle, &more).unwrap();
        assert!(!appended.changes && appended.motion.phase() == Phase::Holding);
        assert_eq!(appended.motion.plan(), held.plan());
        let resumed = appended.motion.splice(held.last_cycle() + 100, &Operation::Resume).unwrap().motion;
        let whole = opened(&tracks, 6, PvtInterpolation::SShaped, PvtPolicy::PreferVelocity);
        for index in 0..2 {
            let (ours, theirs) =
                (resumed.state(index, resumed.last_cycle()), whole.state(index, whole.last_cycle()));
            assert!((ours.position - theirs.position).abs() <= NEAR && ours.is_at_rest());
        }
    }
}

#[test]
fn what_is_slowed_stays_slow_on_the_new_points() {
    let (tracks, motion) = first_three();
    let slowed = motion.splice(40, &Operation::Override(Override::new(0.5).unwrap())).unwrap().motion;
    let appended = slowed.splice(80, &Operation::Append(points(&tracks, 3, 6))).unwrap().motion;
    for cycle in 80..slowed.closing_from_cycle().unwrap() {
        for index in 0..2 {
            for (ours, theirs) in
                words(appended.state(index, cycle)).into_iter().zip(words(slowed.state(index, cycle)))
            {
                assert!((ours - theirs).abs() <= 1e-9, "{ours} for {theirs} at {cycle}");
            }
        }
    }
    let law = appended.base_time().unwrap();
    assert!((law.at(law.profile().duration()).velocity - 0.5).abs() <= 1e-12);
    let whole = opened(&tracks, 6, PvtInterpolation::SShaped, PvtPolicy::PreferVelocity);
    for index in 0..2 {
        let (ours, theirs) =
            (appended.state(index, appended.last_cycle()), whole.state(index, whole.last_cycle()));
        assert!((ours.position - theirs.position).abs() <= 1e-9 && ours.is_at_rest());
    }
}

#[test]
fn what_cannot_be_appended_says_why() {
    let (tracks, motion) = first_three();
    let says = |motion: &Motion, cycle, points| motion.splice(cycle, &Operation::Append(points)).unwrap_err();
    let closing = motion.closing_from_cycle().unwrap();
    assert_eq!(closing, 150);
    for cycle in [closing, closing + 1, motion.last_cycle() + 10] {
        let refused = says(&motion, cycle, points(&tracks, 3, 6));
        assert_eq!(refused, Refused::AppendTooLate { closing_from_cycle: closing });
    }
    assert!(motion.splice(closing - 1, &Operation::Append(points(&tracks, 3, 6))).is_ok());
    let mut missing = points(&tracks, 3, 6);
    missing.axes.pop();
    assert_eq!(
        says(&motion, 10, missing).to_string(),
        "axes: is not set: give the points of every axis of the motion"
    );
    let mut unknown = points(&tracks, 3, 6);
    unknown.axes[1].axis = "w".into();
    assert!(
        says(&motion, 10, unknown)
            .to_string()
            .starts_with("axes[1].axis: no axis is called \"w\": the plan has x, y")
    );
    let last = Points { last: true, ..points(&tracks, 3, 6) };
    assert!(says(&motion, 10, last).to_string().contains("axes[0].velocities[2]: is "));
    let mut late = points(&tracks, 3, 6);
    late.axes[0].times[1] = 0.0;
    late.axes[1].times[1] = 0.0;
    assert!(says(&motion, 10, late).to_string().contains("axes[0].times[1]"));
    let stopped = motion.splice(60, &Operation::Stop).unwrap().motion;
    assert!(matches!(says(&stopped, 61, points(&tracks, 3, 6)), Refused::Stopped { .. }));
}

#[test]
fn the_last_point_is_gone_on_to() {
    let (tracks, motion) = first_three();
    let mut points = Points { last: true, ..points(&tracks, 3, 6) };
    for axis in &mut points.axes {
        *axis.velocities.last_mut().unwrap() = 0.0;
        *axis.positions.last_mut().unwrap() = 0.5;
    }
    let appended = motion.splice(60, &Operation::Append(points)).unwrap().motion;
    assert_eq!(appended.closing_from_cycle(), None);
    assert_eq!(appended.state(1, appended.last_cycle()), State::at_rest(0.5));
}
