//! What a model may say, and how it is refused.

use planner::State;
use proptest::prelude::*;
use sim_axis::{
    Axis, AxisConfig, AxisModel, AxisModelSpec, EncoderSpec, FrictionSpec, InvalidConfig, InvalidField,
    LoadSpec, MechanicsSpec, ReportCard, ServoSpec,
};

fn rigid(inertia: f64) -> AxisModelSpec {
    let ideal = AxisModelSpec::ideal("x");
    AxisModelSpec {
        mechanics: MechanicsSpec { load: LoadSpec::Rigid { inertia }, ..ideal.mechanics },
        ..ideal
    }
}

#[test]
fn every_invalid_field_is_reported_at_once() {
    let refused = AxisModel::try_from(AxisModelSpec {
        axis: "gantry".into(),
        mechanics: MechanicsSpec {
            load: LoadSpec::TwoMass {
                motor_inertia: 8.0,
                load_inertia: -3.0,
                stiffness: 0.0,
                damping: f64::NAN,
            },
            friction: FrictionSpec {
                coulomb: 3.0,
                viscous: -1.0,
                static_friction: 2.0,
                stribeck_velocity: 0.0,
            },
            max_effort: f64::INFINITY,
        },
        servo: ServoSpec { velocity_feedforward: 1.5, substep: 1e-3, ..ServoSpec::default() },
        encoder: EncoderSpec { resolution: -1e-7 },
        noise_seed: 0,
        pulses_per_unit: -1.0,
    })
    .unwrap_err();
    let paths: Vec<&str> = refused.fields.iter().map(InvalidField::path).collect();
    assert_eq!(
        paths,
        [
            "mechanics.two_mass.load_inertia",
            "mechanics.two_mass.stiffness",
            "mechanics.two_mass.damping",
            "mechanics.friction.viscous",
            "mechanics.friction.static_friction",
            "mechanics.max_effort",
            "servo.velocity_feedforward",
            "servo.substep",
            "encoder.resolution",
            "pulses_per_unit",
        ]
    );
}

#[test]
fn a_refusal_says_what_was_given_what_is_allowed_and_the_way_out() {
    let texts = |spec: AxisModelSpec| AxisModel::try_from(spec).unwrap_err().to_string();
    assert_eq!(
        texts(rigid(-1.0)),
        "the model of axis \"x\" cannot be simulated: mechanics.rigid.inertia is -1 and must be above 0: \
         give what moves in kg, or in kg m^2 if it turns"
    );
    assert_eq!(
        texts(AxisModelSpec {
            servo: ServoSpec { command_delay: 2.0, ..ServoSpec::default() },
            noise_seed: 1,
            pulses_per_unit: f64::NAN,
            ..rigid(4.0)
        }),
        "the model of axis \"x\" cannot be simulated: servo.command_delay is 2, outside 0 to 0.1: a delay beyond \
         that is no drive's: shift the setpoints instead; pulses_per_unit is NaN: give a finite number"
    );
}

#[test]
fn the_built_in_models_are_sound() {
    for spec in [AxisModelSpec::ideal("x"), AxisModelSpec::flexible("x")] {
        assert!(AxisModel::try_from(spec).is_ok());
    }
    assert_eq!(AxisModel::try_from(AxisModelSpec::flexible("x")).as_ref(), Ok(&AxisModel::flexible("x")));
}

#[test]
fn a_servo_that_was_never_set_is_the_default_one() {
    let unset = AxisModelSpec { servo: ServoSpec::UNSET, ..rigid(4.0) };
    let unset = AxisModel::try_from(unset).unwrap();
    assert_eq!(unset, AxisModel::try_from(rigid(4.0)).unwrap());
    let tuned = ServoSpec {
        position_gain: 50.0,
        velocity_gain: 4.0 * 50.0 * 4.0,
        velocity_integral_time: 0.02,
        current_loop_bandwidth: 1000.0,
        ..ServoSpec::default()
    };
    assert_eq!(unset.spec().servo, tuned);
}

#[test]
fn a_model_that_was_made_is_a_model_again() {
    let flexible = AxisModel::flexible("x");
    assert_eq!(AxisModel::try_from(flexible.spec().clone()), Ok(flexible));
}

/// Any double, and more of those that hurt.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        12 => 1e-3..1e5_f64,
        1 => (-300.0..300.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent)),
        4 => Just(0.0),
        1 => any::<f64>(),
        1 => prop_oneof![Just(f64::NAN), Just(f64::INFINITY), Just(-1.0), Just(1e-4)],
    ]
}

fn any_load() -> impl Strategy<Value = LoadSpec> {
    (0..4, any_number(), any_number(), any_number(), any_number()).prop_map(|(kind, a, b, c, d)| match kind {
        0 => LoadSpec::Ideal,
        1 => LoadSpec::Rigid { inertia: a },
        2 => LoadSpec::TwoMass { motor_inertia: a, load_inertia: b, stiffness: c, damping: d },
        _ => LoadSpec::Prescribed { load_inertia: b, stiffness: c, damping: d },
    })
}

prop_compose! {
    fn any_spec()(
        load in any_load(),
        friction in [any_number(), any_number(), any_number(), any_number()],
        max_effort in any_number(),
        gains in [any_number(), any_number(), any_number(), any_number()],
        shares in [0.0..=1.0, 0.0..=1.0],
        command_delay in 0.0..=0.1,
        resolution in any_number(),
        noise_seed in any::<u64>(),
        pulses_per_unit in any_number(),
    ) -> AxisModelSpec {
        let [coulomb, viscous, static_friction, stribeck_velocity] = friction;
        let [position_gain, velocity_gain, velocity_integral_time, current_loop_bandwidth] = gains;
        let [velocity_feedforward, acceleration_feedforward] = shares;
        AxisModelSpec {
            axis: "x".into(),
            mechanics: MechanicsSpec {
                load,
                friction: FrictionSpec { coulomb, viscous, static_friction, stribeck_velocity },
                max_effort,
            },
            servo: ServoSpec {
                position_gain,
                velocity_gain,
                velocity_integral_time,
                current_loop_bandwidth,
                velocity_feedforward,
                acceleration_feedforward,
                substep: 0.0,
                command_delay,
            },
            encoder: EncoderSpec { resolution },
            noise_seed,
            pulses_per_unit,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    #[test]
    fn a_model_is_refused_with_reasons_or_runs(spec in any_spec(), positions in prop::array::uniform4(any_number())) {
        let config = AxisConfig { cycle: 1e-3, settle_window: 0.02, settle_tolerance: 1e-5 };
        match AxisModel::try_from(spec) {
            Err(refused) => prop_assert!(!refused.fields.is_empty()),
            Ok(model) => {
                let mut axis = match Axis::new(&model, config, &State::at_rest(0.0)) {
                    Ok(axis) => axis,
                    Err(InvalidConfig::Unstable { growth, .. }) => {
                        prop_assert!(growth > 1.0);
                        return Ok(());
                    }
                    Err(other) => panic!("{other}"),
                };
                // Whatever the setpoints: numbers may be spoilt, the process and the report may not.
                for position in positions {
                    // As large as a planner gives them. A buffer takes none that is not a number.
                    let position = if position.is_nan() { 0.0 } else { position };
                    let position = position.clamp(-planner::GREATEST_MAGNITUDE, planner::GREATEST_MAGNITUDE);
                    axis.step(&State::at_rest(position));
                }
                axis.begin_settling();
                while !axis.settle_window_is_over() && !axis.has_diverged() {
                    axis.rest();
                }
                let ReportCard { max_following_error, rms_following_error, overshoot, max_effort, .. } = axis.report();
                for number in [max_following_error, rms_following_error, overshoot, max_effort] {
                    prop_assert!(number.is_finite(), "{:?}", axis.report());
                }
            }
        }
    }

    #[test]
    fn a_sound_model_at_rest_stays_at_rest(spec in any_spec(), start in -1e6..1e6_f64) {
        let exact = AxisModelSpec { encoder: EncoderSpec::default(), pulses_per_unit: 1.0, ..spec };
        let config = AxisConfig { cycle: 1e-3, settle_window: 0.0, settle_tolerance: 1e-5 };
        let axis = AxisModel::try_from(exact)
            .ok()
            .and_then(|model| Axis::new(&model, config, &State::at_rest(start)).ok());
        if let Some(mut axis) = axis {
            for _ in 0..20 {
                let seen = axis.rest();
                prop_assert_eq!(seen.load_position.to_bits(), start.to_bits());
                prop_assert_eq!(seen.effort.abs().to_bits(), 0);
            }
        }
    }
}
