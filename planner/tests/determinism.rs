//! The bits that moves are planned and sampled to, pinned: replicas on every platform give these, with and without `std`. Where the
//! pieces are as before and their setpoints are not, that is a new [`planner::EVALUATION_VERSION`]; other pieces are another plan,
//! which travels as its pieces.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod common;

use common::polynomial_problem;
use planner::{
    LimitsSpec, Profile, PvtPlanner, PvtPolicy, PvtTarget, State, plan_move, plan_polynomial,
    plan_trigonometric,
};

/// The hash of Fowler, Noll and Vo over the words of a thousand setpoints and of every piece.
fn hash(profile: &Profile) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    let mut see = |words: [f64; 4]| {
        for byte in words.into_iter().flat_map(|word| word.to_bits().to_le_bytes()) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    for segment in profile.segments() {
        let start = segment.start;
        see([segment.duration, start.position, start.velocity, start.acceleration]);
    }
    for number in 0..=1000 {
        see(profile.at(profile.duration() * f64::from(number) / 1000.0).words());
    }
    hash
}

const LIMITS: [f64; 8] = [0.5, 2.0, 20.0, 400.0, 9e3, 3e5, 1e7, 4e8];

#[test]
fn plans_sample_to_these_bits() {
    let mut found = Vec::new();
    for distance in [0.425, -0.01] {
        let problem = polynomial_problem(0.1, 0.1 + distance, &LIMITS);
        found.push(hash(&plan_move(&problem).unwrap().to_profile()));
        found.push(hash(&plan_trigonometric(&problem).unwrap().to_profile()));
        found.extend((2..=8).map(|order| hash(&plan_polynomial(&problem, order).unwrap().to_profile())));
    }
    let expected: [u64; 18] = [
        0x5220_d0a2_0818_e2e2,
        0xff12_ad42_6b40_db5e,
        0x1631_4537_6043_59b1,
        0x7f88_7509_3af5_88e4,
        0x94c3_ed7b_063a_8490,
        0xc2b7_9e47_717e_72d5,
        0xba58_304b_31c2_e0f0,
        0x70e9_9cde_5eab_5de3,
        0x4164_dc9f_0534_2a24,
        0xdbe8_59fc_0b7c_d2c4,
        0xec02_11ea_6d50_c069,
        0xdced_c9fd_fcdf_b265,
        0xdbe8_59fc_0b7c_d2c4,
        0x109d_e644_c7ed_d954,
        0xc5bd_d601_5d37_a113,
        0x2c7b_fd89_4edd_099c,
        0xf0e2_b2c7_8eb3_b5ba,
        0xd5f5_272f_4a6d_d4b4,
    ];
    assert_eq!(found, expected, "{found:#018x?}");
}

/// Commands in every region, met and not met, under every policy that adjusts, with one limit of acceleration and with two.
#[test]
fn commands_sample_to_these_bits() {
    let targets =
        [(0.002, 0.1), (0.1, 0.1), (-0.1, -0.4), (-0.09, -0.3), (0.0, 0.0), (0.01, 0.5), (0.03, 0.45)];
    let mut found = Vec::new();
    for policy in [PvtPolicy::PreferVelocity, PvtPolicy::PreferPosition, PvtPolicy::ExtendTime] {
        for max_deceleration in [None, Some(1.0)] {
            let [max_velocity, max_acceleration, ..] = LIMITS;
            let max_jerk = 300.0;
            let spec = LimitsSpec {
                max_velocity,
                max_acceleration,
                max_jerk,
                max_deceleration,
                ..LimitsSpec::default()
            };
            let mut axis = PvtPlanner::new(State::at_rest(0.0), spec.try_into().unwrap(), policy).unwrap();
            found.push(targets.iter().fold(0, |hashes: u64, &(position, velocity)| {
                let planned = axis.command(PvtTarget { position, velocity, duration: 0.07 }).unwrap();
                hashes.rotate_left(1) ^ hash(&planned.motion().to_profile())
            }));
        }
    }
    let expected: [u64; 6] = [
        0xa71a_6880_c1d3_75c7,
        0x06b4_0abd_a48a_18fe,
        0x6c99_b8df_5078_86f3,
        0xea70_aa25_7740_3be4,
        0x2e50_bc41_cd03_b579,
        0x899a_d1f0_3e1b_ff80,
    ];
    assert_eq!(found, expected, "{found:#018x?}");
}
