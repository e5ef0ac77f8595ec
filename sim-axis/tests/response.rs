//! The axis against closed forms: each test states its own.
#![expect(clippy::unwrap_used, reason = "helpers of tests are tests")]
#![expect(clippy::float_cmp, reason = "where a number is compared exactly, it has to be exact")]

use planner::State;
use proptest::prelude::*;
use sim_axis::{
    Axis, AxisConfig, AxisModel, AxisModelSpec, FrictionSpec, LoadSpec, MechanicsSpec, Observation,
    ReportCard, ServoSpec,
};
use std::f64::consts::{PI, TAU};

const CYCLE: f64 = 1e-3;
const SUBSTEP: f64 = 1e-4;

/// Slack on what exact steps reach after some ten thousand of them, relative [1].
const ROUNDING: f64 = 1e-9;

fn config(settle_window: f64) -> AxisConfig {
    AxisConfig { cycle: CYCLE, settle_window, settle_tolerance: 1e-5 }
}

fn model(load: LoadSpec, change: impl FnOnce(&mut AxisModelSpec)) -> AxisModel {
    let mut spec = AxisModelSpec::ideal("x");
    spec.mechanics.load = load;
    change(&mut spec);
    AxisModel::try_from(spec).unwrap()
}

fn at_rest(model: &AxisModel, settle_window: f64) -> Axis {
    Axis::new(model, config(settle_window), &State::at_rest(0.0)).unwrap()
}

/// Constant-jerk pieces, each a jerk and its duration in cycles, sampled at the cycles.
fn sampled(start: State, pieces: &[(f64, u32)]) -> Vec<State> {
    let mut setpoints = Vec::new();
    let mut from = start;
    for &(jerk, cycles) in pieces {
        setpoints.extend((1..=cycles).map(|n| from.after(jerk, f64::from(n) * CYCLE)));
        from = from.after(jerk, f64::from(cycles) * CYCLE);
    }
    setpoints
}

/// Rest to rest by seven pieces: jerk up and down, cruise, and the same mirrored.
fn s_curve(jerk: f64, jerk_cycles: u32, acceleration_cycles: u32, cruise_cycles: u32) -> Vec<State> {
    let (j, n, m) = (jerk, jerk_cycles, acceleration_cycles);
    let up = [(j, n), (0.0, m), (-j, n)];
    let down = [(-j, n), (0.0, m), (j, n)];
    let pieces = [&up[..], &[(0.0, cruise_cycles)], &down].concat();
    let mut setpoints = sampled(State::at_rest(0.0), &pieces);
    // A planner's profile ends at rest to the last bit.
    if let Some(last) = setpoints.last_mut() {
        *last = State::at_rest(last.position);
    }
    setpoints
}

fn run(model: &AxisModel, setpoints: &[State], settle_window: f64) -> (Vec<Observation>, ReportCard) {
    let mut axis = at_rest(model, settle_window);
    let observed = setpoints.iter().map(|setpoint| axis.step(setpoint)).collect();
    axis.begin_settling();
    while !axis.settle_window_is_over() {
        axis.rest();
    }
    (observed, axis.report())
}

#[track_caller]
fn check(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance * expected.abs(), "{found} instead of {expected}");
}

mod following {
    use super::*;

    #[test]
    fn an_ideal_axis_is_where_its_setpoint_is() {
        let setpoints = s_curve(100.0, 30, 0, 53);
        let (observed, report) = run(&AxisModel::ideal("x"), &setpoints, 0.1);
        for (seen, setpoint) in observed.iter().zip(&setpoints) {
            assert_eq!(seen.measured_position.to_bits(), setpoint.position.to_bits());
            assert_eq!([seen.following_error, seen.effort], [0.0, 0.0]);
        }
        assert_eq!(
            report,
            ReportCard {
                axis: "x".into(),
                max_following_error: 0.0,
                max_following_error_time: 0.0,
                rms_following_error: 0.0,
                overshoot: 0.0,
                settling_time: Some(0.0),
                residual_vibration_amplitude: 0.0,
                residual_vibration_frequency: None,
                max_effort: 0.0,
                effort_saturated_time: 0.0,
            }
        );
    }

    #[test]
    fn the_steady_lag_is_the_speed_not_fed_forward_over_the_position_gain() {
        for (speed, gain, share) in
            [(0.25, 50.0, 0.0), (0.25, 50.0, 0.7), (-0.1, 30.0, 0.25), (0.25, 50.0, 1.0)]
        {
            let rigid = model(LoadSpec::Rigid { inertia: 4.0 }, |spec| {
                spec.servo =
                    ServoSpec { position_gain: gain, velocity_feedforward: share, ..ServoSpec::default() };
                spec.mechanics.friction =
                    FrictionSpec { coulomb: 3.0, viscous: 7.0, ..FrictionSpec::default() };
            });
            let ramp = sampled(State { velocity: speed, ..State::default() }, &[(0.0, 2000)]);
            let (observed, _) = run(&rigid, &ramp, 0.0);
            let lag = speed * (1.0 - share) / gain;
            let left = observed.last().unwrap().following_error - lag;
            assert!(left.abs() <= ROUNDING * speed.abs() / gain, "{left} of {lag}");
        }
    }

    #[test]
    fn a_command_delay_costs_the_speed_times_the_delay() {
        let delay = 0.7e-3;
        let delayed = model(LoadSpec::Rigid { inertia: 4.0 }, |spec| spec.servo.command_delay = delay);
        let ramp = sampled(State { velocity: 0.25, ..State::default() }, &[(0.0, 2000)]);
        let (observed, _) = run(&delayed, &ramp, 0.0);
        check(observed.last().unwrap().following_error, 0.25 * delay, 1e-6);
    }

    #[test]
    fn the_report_keeps_the_largest_error_its_time_and_the_mean_square() {
        // With one substep a cycle, the caller sees all that the report is made of.
        let rigid = model(LoadSpec::Rigid { inertia: 4.0 }, |spec| {
            spec.servo = ServoSpec { acceleration_feedforward: 0.0, ..ServoSpec::default() };
        });
        let one_substep = AxisConfig { cycle: SUBSTEP, settle_window: 0.0, settle_tolerance: 0.0 };
        let mut axis = Axis::new(&rigid, one_substep, &State::at_rest(0.0)).unwrap();
        let errors: Vec<f64> = (1..=500)
            .map(|n| axis.step(&State::at_rest(0.0).after(10.0, f64::from(n) * SUBSTEP)).following_error)
            .collect();
        let largest = errors.iter().fold(0.0, |largest: f64, error| largest.max(error.abs()));
        let at = errors.iter().position(|error| error.abs() == largest).unwrap() + 1;
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let report = axis.report();
        assert_eq!(report.max_following_error, largest);
        check(report.max_following_error_time, at as f64 * SUBSTEP, ROUNDING);
        check(report.rms_following_error, rms, ROUNDING);
    }
}

mod resonance {
    use super::*;

    const MOTOR: f64 = 8.0;
    const LOAD: f64 = 3.0;
    const STIFFNESS: f64 = 1.9e5;

    fn two_mass(damping: f64) -> LoadSpec {
        LoadSpec::TwoMass { motor_inertia: MOTOR, load_inertia: LOAD, stiffness: STIFFNESS, damping }
    }

    /// A loose drive, next to nothing, so that the masses are free.
    fn loose() -> ServoSpec {
        ServoSpec {
            position_gain: 1e-6,
            velocity_gain: 1e-9,
            velocity_integral_time: 1e6,
            ..ServoSpec::default()
        }
    }

    fn frequency(model: &AxisModel) -> f64 {
        let (_, report) = run(model, &s_curve(100.0, 13, 0, 0), 0.5);
        report.residual_vibration_frequency.unwrap()
    }

    #[test]
    fn a_load_behind_a_held_motor_swings_at_the_antiresonance() {
        // Friction far above what the load can pull: the motor stands, whatever the load does.
        let stuck = model(two_mass(0.0), |spec| {
            spec.servo = loose();
            spec.mechanics.friction =
                FrictionSpec { coulomb: 1e3, static_friction: 1e6, ..FrictionSpec::default() };
        });
        let mut axis = Axis::new(&stuck, config(0.5), &State { velocity: 0.01, ..State::default() }).unwrap();
        // Friction stops the motor at once, the load swings on.
        for _ in 0..20 {
            axis.step(&State::at_rest(0.0));
        }
        axis.begin_settling();
        let stood_at = axis.rest().measured_position;
        while !axis.settle_window_is_over() {
            assert_eq!(axis.rest().measured_position.to_bits(), stood_at.to_bits());
        }
        check(axis.report().residual_vibration_frequency.unwrap(), (STIFFNESS / LOAD).sqrt() / TAU, 1e-6);
    }

    #[test]
    fn two_free_masses_swing_against_each_other_at_the_resonance() {
        let free = model(two_mass(0.0), |spec| spec.servo = loose());
        let expected = (STIFFNESS * (1.0 / MOTOR + 1.0 / LOAD)).sqrt() / TAU;
        check(frequency(&free), expected, 1e-6);
    }

    #[test]
    fn damping_lowers_the_frequency_by_its_closed_form() {
        let damping = 60.0;
        let damped = model(two_mass(damping), |spec| spec.servo = loose());
        let swinging = 1.0 / (1.0 / MOTOR + 1.0 / LOAD);
        let omega = (STIFFNESS / swinging).sqrt();
        let zeta = damping / (2.0 * (STIFFNESS * swinging).sqrt());
        check(frequency(&damped), omega * (1.0 - zeta * zeta).sqrt() / TAU, 1e-6);
    }
}

mod residual_vibration {
    use super::*;

    const LOAD: f64 = 3.0;

    fn prescribed(omega: f64) -> AxisModel {
        let load = LoadSpec::Prescribed { load_inertia: LOAD, stiffness: LOAD * omega * omega, damping: 0.0 };
        model(load, |_| ())
    }

    /// |∫ a(t)·exp(−iωt) dt| / ω for seven pieces of jerk ±j: a product of three combs, for the ramps of the
    /// acceleration, for its rise and fall, and for speeding up and slowing down.
    ///
    /// ```text
    /// 8·j/ω³ · |sin(ω·tj/2) · sin(ω·ta/2) · sin(ω·tv/2)|
    /// ```
    ///
    /// with tj one piece, ta from the first to the third, tv from the first to the fifth. Source: each pair of
    /// equal and opposite pieces a time s apart is a factor 1 − exp(−iωs), of size 2·|sin(ωs/2)|.
    fn left_swinging(
        omega: f64,
        jerk: f64,
        jerk_cycles: u32,
        acceleration_cycles: u32,
        cruise_cycles: u32,
    ) -> f64 {
        let comb = |cycles: u32| (omega * f64::from(cycles) * CYCLE / 2.0).sin().abs();
        let rise = jerk_cycles + acceleration_cycles;
        8.0 * jerk / omega.powi(3) * comb(jerk_cycles) * comb(rise) * comb(rise + jerk_cycles + cruise_cycles)
    }

    #[test]
    fn it_is_the_spectrum_of_the_acceleration_at_the_resonance() {
        let rows = [(251.0, 30, 0, 53), (251.0, 30, 53, 116), (80.0, 25, 10, 0), (600.0, 7, 3, 40)];
        for (omega, n, m, cruise) in rows {
            let (_, report) = run(&prescribed(omega), &s_curve(100.0, n, m, cruise), 0.5);
            let missed_between_substeps = (omega * SUBSTEP).powi(2) / 8.0;
            let expected = left_swinging(omega, 100.0, n, m, cruise);
            check(report.residual_vibration_amplitude, expected, missed_between_substeps + 1e-6);
            check(report.residual_vibration_frequency.unwrap(), omega / TAU, 1e-6);
        }
    }

    #[test]
    fn it_is_zero_when_a_ramp_of_the_acceleration_lasts_one_period() {
        let setpoints = s_curve(100.0, 30, 17, 41);
        let swung = left_swinging(TAU / 0.030 * 0.9, 100.0, 30, 17, 41);
        let (_, report) = run(&prescribed(TAU / 0.030), &setpoints, 0.5);
        assert!(report.residual_vibration_amplitude <= ROUNDING * swung, "{report:?}");
        assert!(report.overshoot <= ROUNDING * swung);
        assert_eq!(report.settling_time, Some(0.0));
    }

    #[test]
    fn the_motor_is_asked_for_what_the_load_takes() {
        // A rigid enough load under a steady acceleration asks for its inertia times that.
        let damped =
            model(LoadSpec::Prescribed { load_inertia: LOAD, stiffness: 1e6, damping: 2000.0 }, |_| ());
        let steady = sampled(State::at_rest(0.0), &[(100.0, 30), (0.0, 300)]);
        let (observed, _) = run(&damped, &steady, 0.0);
        check(observed.last().unwrap().effort, LOAD * 3.0, 1e-6);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]
        #[test]
        fn it_follows_the_closed_form_for_any_profile(
            omega in 60.0..600.0, n in 1_u32..40, m in 0_u32..40, cruise in 0_u32..80, jerk in 1.0..1000.0,
        ) {
            let (_, report) = run(&prescribed(omega), &s_curve(jerk, n, m, cruise), 0.5);
            // Of the bound, since the combs have zeros.
            let bound = 8.0 * jerk / omega.powi(3);
            let slack = ((omega * SUBSTEP).powi(2) / 8.0 + 1e-6) * bound;
            let expected = left_swinging(omega, jerk, n, m, cruise);
            prop_assert!((report.residual_vibration_amplitude - expected).abs() <= slack, "{:?}", report);
        }
    }
}

mod friction {
    use super::*;

    /// A body thrown at `speed`, its drive without effort.
    fn thrown(speed: f64, load: LoadSpec, friction: FrictionSpec) -> Axis {
        let free = model(load, |spec| {
            spec.mechanics.friction = friction;
            spec.mechanics.max_effort = 1.0;
        });
        let mut axis = Axis::new(&free, config(0.0), &State { velocity: speed, ..State::default() }).unwrap();
        axis.scale_effort_limit(0.0).unwrap();
        axis
    }

    fn comes_to_rest_after(axis: &mut Axis, cycles: u32) -> f64 {
        for _ in 0..cycles {
            axis.step(&State::default());
        }
        let stood_at = axis.rest();
        for _ in 0..1000 {
            let seen = axis.rest();
            assert_eq!(seen.measured_position.to_bits(), stood_at.measured_position.to_bits());
            assert_eq!(seen.measured_velocity, 0.0);
        }
        stood_at.measured_position
    }

    #[test]
    fn coulomb_friction_stops_a_free_mass_at_the_closed_form_distance() {
        // d = J·v²/(2·F), and at most F·h²/(2·J) more for the last substep.
        for (speed, inertia, coulomb) in [(0.25, 4.0, 3.0), (-1.3, 0.7, 11.0)] {
            let friction = FrictionSpec { coulomb, ..FrictionSpec::default() };
            let mut axis = thrown(speed, LoadSpec::Rigid { inertia }, friction);
            let distance = inertia * speed * speed / (2.0 * coulomb) * speed.signum();
            let last_substep = coulomb * SUBSTEP * SUBSTEP / (2.0 * inertia);
            let over = (comes_to_rest_after(&mut axis, 400) - distance) * speed.signum();
            assert!((-ROUNDING * distance.abs()..=last_substep).contains(&over), "{over}");
        }
    }

    #[test]
    fn viscous_friction_stops_a_free_mass_at_the_closed_form_distance() {
        // d = J·v/b, reached exponentially: after 0.8 s of 1/20 s all but 1e-7 of it.
        let friction = FrictionSpec { viscous: 80.0, ..FrictionSpec::default() };
        let mut axis = thrown(0.25, LoadSpec::Rigid { inertia: 4.0 }, friction);
        let moved = (0..1200).map(|_| axis.step(&State::default()).measured_position).last().unwrap();
        check(moved, 4.0 * 0.25 / 80.0, 1e-9);
    }

    #[test]
    fn coulomb_and_viscous_friction_together_stop_it_at_the_closed_form_distance() {
        // d = (J/b)·(v − (F/b)·ln(1 + b·v/F)).
        let (inertia, coulomb, viscous, speed) = (4.0, 3.0, 20.0, 0.25);
        let friction = FrictionSpec { coulomb, viscous, ..FrictionSpec::default() };
        let mut axis = thrown(speed, LoadSpec::Rigid { inertia }, friction);
        let distance =
            inertia / viscous * (speed - coulomb / viscous * (1.0 + viscous * speed / coulomb).ln());
        check(comes_to_rest_after(&mut axis, 400), distance, 1e-6);
    }

    #[test]
    fn a_motor_at_rest_is_held_until_the_effort_passes_static_friction() {
        let sticky = model(LoadSpec::Rigid { inertia: 4.0 }, |spec| {
            spec.mechanics.friction = FrictionSpec {
                coulomb: 3.0,
                static_friction: 5.0,
                stribeck_velocity: 0.01,
                ..FrictionSpec::default()
            };
            // Without feed-forward and integral part the effort is Kp·Kv times the distance: 800·50 N/m.
            spec.servo = ServoSpec { position_gain: 50.0, velocity_integral_time: 1e6, ..ServoSpec::UNSET };
        });
        let holding = |effort: f64| {
            let mut axis = at_rest(&sticky, 0.0);
            let target = State::at_rest(effort / (800.0 * 50.0));
            (0..500).map(|_| axis.step(&target).measured_position).last().unwrap()
        };
        assert_eq!(holding(4.99), 0.0);
        assert!(holding(5.1) > 0.0);
    }

    #[test]
    fn a_swinging_load_does_not_make_a_held_motor_creep() {
        let load =
            LoadSpec::TwoMass { motor_inertia: 8.0, load_inertia: 3.0, stiffness: 1.9e5, damping: 0.0 };
        let friction = FrictionSpec { coulomb: 30.0, static_friction: 40.0, ..FrictionSpec::default() };
        comes_to_rest_after(&mut thrown(0.02, load, friction), 200);
    }
}

mod effort {
    use super::*;

    fn limited(max_effort: f64) -> AxisModel {
        model(LoadSpec::Rigid { inertia: 4.0 }, |spec| {
            spec.mechanics = MechanicsSpec { max_effort, ..spec.mechanics };
        })
    }

    #[test]
    fn a_move_within_the_limit_takes_the_inertia_times_the_acceleration() {
        let (_, report) = run(&limited(200.0), &s_curve(100.0, 30, 53, 30), 0.2);
        check(report.max_effort, 4.0 * 3.0, 0.02);
        assert_eq!(report.effort_saturated_time, 0.0);
    }

    #[test]
    fn saturated_time_is_counted_and_the_limit_kept() {
        let setpoints = s_curve(100.0, 30, 53, 30);
        let (observed, report) = run(&limited(8.0), &setpoints, 0.5);
        assert!(report.max_effort <= 8.0 * (1.0 + ROUNDING));
        let cycles = observed.iter().filter(|seen| seen.saturated).count() as f64;
        assert!(report.effort_saturated_time > 0.02, "{report:?}");
        // A cycle counts as saturated by one substep, the time by each.
        assert!(report.effort_saturated_time <= (cycles + 500.0) * CYCLE);
    }

    #[test]
    fn hopeless_saturation_is_saturation_all_the_time() {
        let mut axis = at_rest(&limited(1e-3), 0.0);
        for _ in 0..200 {
            axis.step(&State::at_rest(1.0));
        }
        // The first substep still acts on the setpoint of cycle 0.
        check(axis.report().effort_saturated_time, 0.2, 0.05);
        // A constant force: x = F·t²/(2·J) once the current loop has followed, τ = 1/(2π·1000 Hz) later.
        let moved = axis.rest().measured_position;
        check(moved, 1e-3 / 4.0 * 0.201 * 0.201 / 2.0, 0.02);
    }

    #[test]
    fn a_long_saturation_does_not_wind_up() {
        // Speeding up saturates for most of the way, slowing down (Kv·v ≤ 5 m/s² of 6.25) does not. An integral
        // part that had grown meanwhile, by Kp·v/Tn·t ≈ 80 N, would carry the axis past by centimetres.
        let step = |max_effort: f64| {
            let mut slow = limited(max_effort).spec().clone();
            slow.servo = ServoSpec { position_gain: 10.0, ..ServoSpec::default() };
            let mut axis = at_rest(&AxisModel::try_from(slow).unwrap(), 2.0);
            axis.step(&State { position: 0.05, velocity: 1e-3, acceleration: 0.0 });
            axis.begin_settling();
            while !axis.settle_window_is_over() {
                axis.rest();
            }
            axis.report()
        };
        let (free, limited) = (step(0.0), step(25.0));
        assert!(limited.effort_saturated_time > 0.05, "{limited:?}");
        assert!(limited.overshoot <= 1.2 * free.overshoot, "{limited:?} {free:?}");
    }

    #[test]
    fn less_of_the_limit_is_less_effort() {
        let mut axis = at_rest(&limited(8.0), 0.0);
        axis.scale_effort_limit(0.25).unwrap();
        for setpoint in s_curve(100.0, 30, 53, 30) {
            axis.step(&setpoint);
        }
        check(axis.report().max_effort, 2.0, 1e-6);
        let refused = axis.scale_effort_limit(1.5).unwrap_err().to_string();
        assert_eq!(refused, "an effort scale of 1.5 is outside 0 to 1: 1 is the whole effort of the model");
    }
}

mod settling {
    use super::*;

    /// Position loop over a velocity loop without integral part: s² + (Kp/J)·s + (Kp/J)·Kv, so that
    /// ω² = Kv·Kp/J and 2ζω = Kp/J; the current loop is out of the way at 1 MHz.
    fn second_order(omega: f64, zeta: f64) -> AxisModel {
        let inertia = 4.0;
        let velocity_loop = 2.0 * zeta * omega;
        model(LoadSpec::Rigid { inertia }, |spec| {
            spec.servo = ServoSpec {
                position_gain: omega * omega / velocity_loop,
                velocity_gain: velocity_loop * inertia,
                velocity_integral_time: 1e6,
                current_loop_bandwidth: 1e6,
                velocity_feedforward: 0.0,
                acceleration_feedforward: 0.0,
                substep: 50e-6,
                command_delay: 0.0,
            };
        })
    }

    /// A step to 1, taken as the last setpoint, watched for a second.
    fn step_response(model: &AxisModel, settle_tolerance: f64) -> ReportCard {
        let config = AxisConfig { cycle: 50e-6, settle_window: 1.0, settle_tolerance };
        let mut axis = Axis::new(model, config, &State::at_rest(0.0)).unwrap();
        axis.step(&State { position: 1.0, velocity: 1e-9, acceleration: 0.0 });
        axis.begin_settling();
        while !axis.settle_window_is_over() {
            axis.rest();
        }
        axis.report()
    }

    /// The loop is sampled: held over a substep, half a substep late at these frequencies [1].
    const SAMPLING: f64 = 0.01;

    #[test]
    fn a_step_overshoots_by_its_closed_form() {
        // exp(−πζ/√(1 − ζ²)): Ogata (2010), §5.3.
        for zeta in [0.2, 0.4, 0.6] {
            let report = step_response(&second_order(60.0, zeta), 0.01);
            check(report.overshoot, (-PI * zeta / f64::sqrt(1.0 - zeta * zeta)).exp(), 3.0 * SAMPLING);
        }
    }

    #[test]
    fn a_critically_damped_step_settles_by_its_closed_form() {
        // 1 − (1 + ωt)·exp(−ωt) reaches 0.99 at ωt = 6.638352…
        let report = step_response(&second_order(60.0, 1.0), 0.01);
        check(report.settling_time.unwrap(), 6.638_352 / 60.0, SAMPLING);
        assert!(report.overshoot < 1e-6);
    }

    #[test]
    fn a_ringing_step_rings_at_the_damped_frequency() {
        let (omega, zeta) = (60.0, 0.1);
        let report = step_response(&second_order(omega, zeta), 0.01);
        let damped: f64 = omega * f64::sqrt(1.0 - zeta * zeta);
        // The record of the fit begins with the step itself, which is no part of the swing.
        check(report.residual_vibration_frequency.unwrap(), damped / TAU, 2.0 * SAMPLING);
    }

    #[test]
    fn an_axis_that_is_still_out_at_the_end_has_not_settled() {
        let slow = second_order(2.0, 1.0);
        assert_eq!(step_response(&slow, 0.01).settling_time, None);
    }

    #[test]
    fn overshoot_is_counted_in_the_direction_of_travel() {
        // Out past the goal and back to it: what was travelled on purpose is no overshoot.
        let there = s_curve(100.0, 30, 53, 0);
        let back: Vec<State> = there
            .iter()
            .map(|setpoint| {
                let from = there[there.len() - 1].position;
                State {
                    position: from - setpoint.position / 2.0,
                    velocity: -setpoint.velocity / 2.0,
                    acceleration: -setpoint.acceleration / 2.0,
                }
            })
            .collect();
        let load = LoadSpec::Prescribed { load_inertia: 3.0, stiffness: 3.0 * 200.0 * 200.0, damping: 0.0 };
        let (_, report) = run(&model(load, |_| ()), &[there, back].concat(), 0.5);
        assert!(report.residual_vibration_amplitude > 1e-6);
        // Undamped and prescribed: the load swings symmetrically about the goal.
        check(report.overshoot, report.residual_vibration_amplitude, 0.05);
    }
}

mod pulses {
    use super::*;

    fn in_pulses(pulses_per_unit: f64) -> AxisModel {
        let mut spec = AxisModelSpec::flexible("x");
        spec.pulses_per_unit = pulses_per_unit;
        AxisModel::try_from(spec).unwrap()
    }

    fn run_scaled(pulses_per_unit: f64) -> (Vec<Observation>, ReportCard) {
        let setpoints = s_curve(100.0, 30, 53, 30).into_iter().map(|setpoint| State {
            position: setpoint.position * pulses_per_unit,
            velocity: setpoint.velocity * pulses_per_unit,
            acceleration: setpoint.acceleration * pulses_per_unit,
        });
        let config = AxisConfig { settle_tolerance: 1e-5 * pulses_per_unit, ..config(0.3) };
        let mut axis = Axis::new(&in_pulses(pulses_per_unit), config, &State::at_rest(0.0)).unwrap();
        let observed = setpoints.map(|setpoint| axis.step(&setpoint)).collect();
        axis.begin_settling();
        while !axis.settle_window_is_over() {
            axis.rest();
        }
        (observed, axis.report())
    }

    #[test]
    fn an_axis_in_pulses_moves_the_same_and_says_so_in_pulses() {
        // A power of two scales without rounding, so every number must be the same to the last bit.
        let pulses = 1_048_576.0;
        let ((metres, in_metres), (scaled, in_pulses)) = (run_scaled(1.0), run_scaled(pulses));
        for (one, other) in metres.iter().zip(&scaled) {
            let expected = Observation {
                measured_position: one.measured_position * pulses,
                measured_velocity: one.measured_velocity * pulses,
                load_position: one.load_position * pulses,
                following_error: one.following_error * pulses,
                ..*one
            };
            assert_eq!(*other, expected);
        }
        let expected = ReportCard {
            max_following_error: in_metres.max_following_error * pulses,
            rms_following_error: in_metres.rms_following_error * pulses,
            overshoot: in_metres.overshoot * pulses,
            residual_vibration_amplitude: in_metres.residual_vibration_amplitude * pulses,
            ..in_metres
        };
        assert_eq!(in_pulses, expected);
    }
}

mod flexible {
    use super::*;

    /// 50 mm within 0.25 m/s, 3 m/s² and 100 m/s³.
    fn demo_move() -> Vec<State> {
        let setpoints = s_curve(100.0, 30, 53, 87);
        let length = setpoints[setpoints.len() - 1].position;
        assert!((length - 0.05).abs() < 1e-3, "{length}");
        setpoints
    }

    #[test]
    fn the_flexible_axis_follows_well_and_is_left_swinging_visibly() {
        let (_, report) = run(&AxisModel::flexible("x"), &demo_move(), 0.5);
        assert!(report.max_following_error < 1e-5, "{report:?}");
        assert!((1e-5..2e-5).contains(&report.residual_vibration_amplitude), "{report:?}");
        assert!(report.overshoot > 1e-5, "{report:?}");
        assert!(report.settling_time.unwrap() > 0.1, "{report:?}");
        assert_eq!(report.effort_saturated_time, 0.0);
        // The motor is held well, so the load swings as if it were held altogether.
        check(report.residual_vibration_frequency.unwrap(), (1.43e5_f64 / 2.0).sqrt() / TAU, 1e-3);
    }

    #[test]
    fn a_jerk_phase_of_one_period_calms_the_flexible_axis() {
        let calm = |jerk: f64, jerk_cycles: u32| {
            let hold = (3.0 / jerk / CYCLE).round() as u32;
            assert_eq!(hold, jerk_cycles);
            let setpoints = s_curve(jerk, jerk_cycles, 83 - jerk_cycles, 87);
            let mut axis = at_rest(&AxisModel::flexible("x"), 0.5);
            for setpoint in &setpoints {
                axis.step(setpoint);
            }
            // The drive's own approach is over after a while; what is left then is the swing.
            for _ in 0..60 {
                axis.rest();
            }
            axis.begin_settling();
            while !axis.settle_window_is_over() {
                axis.rest();
            }
            axis.report().residual_vibration_amplitude
        };
        let (visible, calmed) = (calm(100.0, 30), calm(3.0 / 0.024, 24));
        assert!(calmed < 0.2 * visible, "{calmed} {visible}");
    }

    #[test]
    fn the_same_setpoints_give_the_same_bits() {
        let noisy = || {
            let mut spec = AxisModelSpec::flexible("x");
            spec.noise_seed = 11;
            AxisModel::try_from(spec).unwrap()
        };
        assert_eq!(run(&noisy(), &demo_move(), 0.3), run(&noisy(), &demo_move(), 0.3));
    }

    #[test]
    fn a_copy_made_under_way_ends_like_its_original() {
        let setpoints = demo_move();
        let (before, after) = setpoints.split_at(100);
        let mut axis = at_rest(&AxisModel::flexible("x"), 0.3);
        for setpoint in before {
            axis.step(setpoint);
        }
        let finished = |mut axis: Axis| {
            for setpoint in after {
                axis.step(setpoint);
            }
            axis.begin_settling();
            let mut cycles = 0;
            while !axis.settle_window_is_over() {
                axis.rest();
                cycles += 1;
            }
            (cycles, axis.report())
        };
        let copied = finished(axis.clone());
        assert_eq!(copied.0, 300);
        assert_eq!(copied, finished(axis));
    }

    #[test]
    fn an_axis_at_rest_stays_where_it_is() {
        for model in [AxisModel::flexible("x"), AxisModel::ideal("x")] {
            let far = State::at_rest(1_234.567_8);
            let mut axis = Axis::new(&model, config(0.0), &far).unwrap();
            let first = axis.rest();
            for _ in 0..10_000 {
                assert_eq!(axis.rest(), first);
            }
            assert_eq!(first.load_position, far.position);
        }
    }
}
