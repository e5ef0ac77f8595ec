//! The bits of motions under way, pinned: of every kind of motion and after every operation, as a replica plans and samples them. See
//! `determinism.rs` for what a change of them means.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use planner::motion::{AxisGoal, AxisPoints, Motion, Operation, Override, Points};
use planner::{
    AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, PvtAxisSpec, PvtInterpolation, PvtPolicy, PvtRequest,
    PvtRequestSpec, Request, RequestSpec, ShortPathPolicy, State, Synchronization, plan_pvt,
};

/// The hash of Fowler, Noll and Vo over the words of every setpoint of every axis, cycle by cycle, from `from` to the end.
fn hash(motion: &Motion, from: u64) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    for cycle in from..=motion.last_cycle() {
        for byte in motion.setpoints(cycle).flat_map(|setpoint| setpoint.words()).flat_map(bytes) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
    hash
}

fn bytes(word: f64) -> [u8; 8] {
    word.to_bits().to_le_bytes()
}

fn limits(size: f64) -> LimitsSpec {
    LimitsSpec {
        max_velocity: 0.5 * size,
        max_acceleration: 4.0 * size,
        max_jerk: 120.0 * size,
        max_snap: Some(5e3 * size),
        max_higher_derivatives: vec![3e5 * size],
        ..LimitsSpec::default()
    }
}

/// Three axes, of which one goes back.
fn moved(family: Family, order: Option<u32>, synchronization: Synchronization) -> Motion {
    let axes = [("x", 0.4, 1.0), ("y", -0.15, 0.7), ("z", 0.02, 0.3)];
    let axes = axes.map(|(axis, way, size)| AxisMoveSpec {
        axis: axis.into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.1),
        goal: State::at_rest(0.1 + way),
        limits: limits(size),
    });
    let spec = RequestSpec {
        axes: axes.to_vec(),
        cycle_time_ns: None,
        family: Ok(family),
        order,
        short_path: Ok(ShortPathPolicy::Reverse),
        synchronization: Ok(synchronization),
        minimum_duration: None,
        end_on_cycle: false,
    };
    let judged = Judged::answer(&Request::try_from(spec).unwrap()).unwrap();
    Motion::open(judged.accepted().unwrap()).unwrap()
}

const POSITIONS: [f64; 8] = [0.01, 0.04, 0.08, 0.1, 0.09, 0.07, 0.06, 0.06];
const VELOCITIES: [f64; 8] = [0.2, 0.3, 0.25, 0.0, -0.15, -0.1, 0.0, 0.0];

fn through_points(interpolation: PvtInterpolation) -> Motion {
    let axes = [("x", 1.0), ("y", -0.5)].map(|(axis, scale)| PvtAxisSpec {
        axis: axis.into(),
        kind: Ok(AxisKind::Prismatic),
        limits: limits(2.0),
        start: State::at_rest(0.0),
        times: (1..=8).map(|point| 0.125 * f64::from(point)).collect(),
        positions: POSITIONS.map(|position| scale * position).to_vec(),
        velocities: VELOCITIES.map(|velocity| scale * velocity).to_vec(),
    });
    let spec = PvtRequestSpec {
        axes: axes.to_vec(),
        cycle_time_ns: None,
        interpolation: Ok(interpolation),
        policy: Ok(PvtPolicy::PreferVelocity),
        finish_unreached: true,
    };
    let plan = plan_pvt(&PvtRequest::try_from(spec).unwrap()).unwrap().plan().clone();
    Motion::open(Judged::new(plan).accepted().unwrap()).unwrap()
}

/// What is done, at which part of what is left, in 64ths; resumed and retargeted at rest too.
fn script() -> [(u64, Operation); 7] {
    let goal =
        |axis: &str, position| AxisGoal { axis: axis.into(), goal: State::at_rest(position), limits: None };
    let slower = AxisGoal { limits: Some(limits(0.5).try_into().unwrap()), ..goal("y", 0.2) };
    [
        (12, Operation::Override(Override::new(0.375).unwrap())),
        (20, Operation::Hold),
        (64, Operation::Resume),
        (8, Operation::Override(Override::FULL)),
        (16, Operation::Retarget(vec![goal("x", -0.2), slower])),
        (24, Operation::Retarget(vec![goal("x", 0.05)])),
        (30, Operation::Stop),
    ]
}

/// The hashes of a motion before and after each operation, and of its ways to rest.
fn hashes(mut motion: Motion) -> Vec<u64> {
    let mut hashes = vec![hash(&motion, 0)];
    let mut now = 0;
    for (part, operation) in script() {
        now += (motion.last_cycle() - now) * part / 64;
        let tail = motion.tail(now).unwrap();
        motion = motion.splice(now, &operation).unwrap().motion;
        let rests = tail.map_or(0, |tail| hash(&tail.motion, now));
        hashes.push(hash(&motion, now) ^ rests.rotate_left(1));
    }
    hashes
}

#[test]
fn motions_and_operations_sample_to_these_bits() {
    let motions = [
        moved(Family::SCurve, None, Synchronization::None),
        moved(Family::SCurve, None, Synchronization::Time),
        moved(Family::SCurve, None, Synchronization::Phase),
        moved(Family::Polynomial, Some(5), Synchronization::None),
        moved(Family::Trigonometric, None, Synchronization::None),
        through_points(PvtInterpolation::SShaped),
        through_points(PvtInterpolation::Quintic),
    ];
    let found: Vec<Vec<u64>> = motions.into_iter().map(hashes).collect();
    let expected: [[u64; 8]; 7] = [[0; 8]; 7];
    assert_eq!(found, expected, "{found:#018x?}");
}

/// Points that come later are planned from where the motion is then.
#[test]
fn appended_points_sample_to_these_bits() {
    let motion = through_points(PvtInterpolation::SShaped);
    let closing = motion.closing_from_cycle().unwrap();
    let axes = [("x", 1.0), ("y", -0.5)].map(|(axis, scale)| AxisPoints {
        axis: axis.into(),
        times: vec![0.125, 0.25],
        positions: vec![scale * 0.08, scale * 0.11],
        velocities: vec![scale * 0.2, 0.0],
    });
    let points = Points { axes: axes.to_vec(), last: true };
    let motion = motion.splice(closing / 2, &Operation::Append(points)).unwrap().motion;
    assert_eq!(hash(&motion, 0), 0, "{:#018x}", hash(&motion, 0));
}
