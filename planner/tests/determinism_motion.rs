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

/// Through the first `count` of them: all end at rest, fewer at speed.
fn through_points(count: usize, interpolation: PvtInterpolation) -> Motion {
    let axes = [("x", 1.0), ("y", -0.5)].map(|(axis, scale)| PvtAxisSpec {
        axis: axis.into(),
        kind: Ok(AxisKind::Prismatic),
        limits: limits(2.0),
        start: State::at_rest(0.0),
        times: (1..=count).map(|point| 0.125 * point as f64).collect(),
        positions: POSITIONS.map(|position| scale * position)[..count].to_vec(),
        velocities: VELOCITIES.map(|velocity| scale * velocity)[..count].to_vec(),
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
        // What leaves the line of a motion on a straight line is refused, and that is pinned too.
        let Ok(spliced) = motion.splice(now, &operation) else {
            hashes.push(0);
            continue;
        };
        motion = spliced.motion;
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
        through_points(8, PvtInterpolation::SShaped),
        through_points(8, PvtInterpolation::Quintic),
    ];
    let found: Vec<Vec<u64>> = motions.into_iter().map(hashes).collect();
    let expected: [[u64; 8]; 7] = [
        [
            0xe88a_f83c_0e45_1520,
            0x6d5c_0eac_8759_5276,
            0x3fd6_3ffa_a748_f720,
            0x9b00_d144_65af_4fe8,
            0x2f28_cad6_e916_b93e,
            0xdad8_9b58_4372_3498,
            0xc5c4_c686_572d_9e8e,
            0x595e_5b74_01e6_dfa2,
        ],
        [
            0x4b73_12de_f4f7_1288,
            0x6138_9dad_f195_dc03,
            0x9173_740b_7ce6_533a,
            0x968d_b88c_b4d9_bafa,
            0x21c5_a259_5bc6_0e7d,
            0xec5b_ad73_d452_1937,
            0x0d0e_6f6b_0530_ecf9,
            0xd442_dc9f_aa8c_8eb8,
        ],
        [
            0xb3da_94d7_3ff0_170e,
            0xd8fb_e692_4542_45be,
            0x8534_fcfc_8d6b_68d1,
            0xb9c5_1f88_90dc_d789,
            0xab94_fdff_00b6_41af,
            0,
            0,
            0x70c4_a000_ebcf_08d3,
        ],
        [
            0xf4f5_9cde_0626_f937,
            0xd12b_631e_9f66_1a21,
            0xc489_325d_ffec_d063,
            0xad24_a78b_6d92_05fa,
            0x6e41_3e7d_6114_dc17,
            0xd7d1_af1f_d24f_d62b,
            0x56eb_ce67_a27d_67ac,
            0x20ce_760c_bc36_4e5a,
        ],
        [
            0x1dae_bd22_6556_a473,
            0x5ce0_b4b7_16ba_3b6f,
            0x0d77_de02_b99b_f8e0,
            0x7f3b_2ca2_8e9f_525c,
            0x122f_aa26_d223_f698,
            0x8337_eeb6_70f5_0b59,
            0xc34d_1c6e_0b9c_a334,
            0xd7e9_454c_f305_99ec,
        ],
        [
            0xbc64_2431_646a_80c2,
            0x3a97_64d4_f863_b22c,
            0x8ad4_2b78_f753_6910,
            0xafe1_7635_0cb5_38ad,
            0x554f_cc39_bbfd_4113,
            0x57f3_7bdd_0ddd_e953,
            0xf580_44dc_c3af_9cf9,
            0xe966_3028_0746_e0f5,
        ],
        [
            0xa814_3871_7b29_c44c,
            0x3a72_a198_d7db_c17d,
            0x9752_914a_fc5b_2f04,
            0xa6f0_8880_4477_3c71,
            0x7741_b6e9_d35e_f92e,
            0xf3d9_7805_5464_824a,
            0x757e_e22a_f773_a226,
            0x3d33_16e2_f100_55b9,
        ],
    ];
    assert_eq!(found, expected, "{found:#018x?}");
}

/// Points that come later are planned from where the motion is then.
#[test]
fn appended_points_sample_to_these_bits() {
    let motion = through_points(3, PvtInterpolation::SShaped);
    let closing = motion.closing_from_cycle().unwrap();
    let axes = [("x", 1.0), ("y", -0.5)].map(|(axis, scale)| AxisPoints {
        axis: axis.into(),
        times: vec![0.125, 0.25],
        positions: vec![scale * 0.1, scale * 0.115],
        velocities: vec![scale * 0.2, 0.0],
    });
    let points = Points { axes: axes.to_vec(), last: true };
    let motion = motion.splice(closing / 2, &Operation::Append(points)).unwrap().motion;
    assert_eq!(hash(&motion, 0), 0x9447_1eb9_cbdb_f8a1, "{:#018x}", hash(&motion, 0));
}
