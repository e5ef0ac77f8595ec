//! A recording that begins with a motion under way is played again from there.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    missing_docs,
    reason = "a test may fail by panicking"
)]

use std::path::{Path, PathBuf};

use planner::motion::{Motion, Operation as Planned, Override};
use planner::{
    AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, Request, RequestSpec, Setpoint, ShortPathPolicy,
    State, Synchronization,
};
use proto::stream::{Ask, Motion as OnStream, Operation, OperationResult};
use recording::{Beginning, Difference, Head, Recorder, Recording, replay};

/// 0.4 m, slowed to half from cycle 300 on, before anything was recorded.
fn slowed() -> Motion {
    let limits =
        LimitsSpec { max_velocity: 0.5, max_acceleration: 2.0, max_jerk: 20.0, ..LimitsSpec::default() };
    let x = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(0.4),
        limits,
    };
    let request = Request::try_from(RequestSpec {
        axes: vec![x],
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    });
    let plan = Judged::answer(&request.unwrap()).unwrap().accepted().unwrap();
    let half = Planned::Override(Override::new(0.5).unwrap());
    Motion::open(plan).unwrap().splice(300, &half).unwrap().motion
}

/// What a server writes that goes on with `motion`: a hold at cycle 500, and each cycle from `first` through 700.
fn recorded(name: &str, motion: &Motion, first: u64, spoil: impl Fn(u64, &mut Setpoint)) -> Recording {
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let plan = motion.plan();
    let head = Head {
        stream: "cell-7/x".into(),
        recorded_by: "a server".into(),
        cycle_time: plan.cycle_time(),
        axes: vec!["x".into()],
    };
    let mut recorder = Recorder::create(Path::new(&file), &head).unwrap();
    recorder.motion(&OnStream::opened(motion.clone())).unwrap();
    let held = motion.splice(500, &Planned::Hold).unwrap();
    for cycle in first..=700 {
        let now = if cycle < 500 { motion } else { &held.motion };
        let mut setpoints: Vec<Setpoint> = now.setpoints(cycle).collect();
        setpoints.iter_mut().for_each(|setpoint| spoil(cycle, setpoint));
        recorder.cycle(cycle, &setpoints, None).unwrap();
    }
    let result = OperationResult {
        request_id: "held".into(),
        effective_cycle: held.effective_cycle,
        rest_cycle: held.rest_cycle,
        revision: held.motion.revision(),
        on_path: held.on_path,
        operation_digest: 0,
    };
    recorder.operation(Operation::now("held", Ask::Hold), Ok(result)).unwrap();
    recorder.finish().unwrap();
    Recording::read(&file).unwrap()
}

#[test]
fn it_is_the_same_to_the_last_bit() {
    let motion = slowed();
    let recording = recorded("same.mcap", &motion, 310, |_, _| {});
    let Beginning::Motion(read) = &recording.beginning else { panic!("{:?}", recording.beginning) };
    assert_eq!((&read.under_way, read.revision()), (&motion, 1));
    let replayed = replay(&recording).unwrap();
    assert_eq!((replayed.compared, replayed.before, replayed.planned), (391, 0, false));
    assert_eq!(replayed.difference, None);
}

#[test]
fn one_bit_that_differs_is_found() {
    let bit = |cycle: u64, setpoint: &mut Setpoint| {
        let position = &mut setpoint.state.position;
        *position = if cycle == 650 { position.next_up() } else { *position };
    };
    let replayed = replay(&recorded("differs.mcap", &slowed(), 310, bit)).unwrap();
    let Some(Difference::Setpoint { cycle: 650, .. }) = replayed.difference else {
        panic!("{:?}", replayed.difference)
    };
}

/// What was played before the motion began follows from another one, which only the server before knew.
#[test]
fn what_came_before_is_counted_and_not_compared() {
    let replayed = replay(&recorded("before.mcap", &slowed(), 290, |_, _| {})).unwrap();
    assert_eq!((replayed.before, replayed.compared, replayed.difference), (10, 401, None));
}
