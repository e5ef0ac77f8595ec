use crate::audit::{InvalidModel, faults};

/// What one axis is made of, as somebody wrote it: any number is possible until [`AxisModel`] has looked at it.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisModelSpec {
    /// Name of the axis in the plan.
    pub axis: String,
    /// Motor, transmission and load.
    pub mechanics: MechanicsSpec,
    /// The drive.
    pub servo: ServoSpec,
    /// The encoder on the motor.
    pub encoder: EncoderSpec,
    /// Seed of the encoder's noise; 0: no noise.
    pub noise_seed: u64,
    /// Pulses in one mechanical unit [1/m or 1/rad], for axes whose setpoints are in pulses; 0 is read as 1.
    pub pulses_per_unit: f64,
}

/// Motor, transmission and load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MechanicsSpec {
    /// What moves.
    pub load: LoadSpec,
    /// What holds it back, on the motor side of any spring.
    pub friction: FrictionSpec,
    /// Largest effort of the motor in either direction [N or N m]; 0: unlimited.
    pub max_effort: f64,
}

/// What moves, and what the drive can do about it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum LoadSpec {
    /// The axis is where its setpoint is. No drive, no effort.
    #[default]
    Ideal,
    /// One body.
    Rigid {
        /// Motor and load together [kg or kg m²], above 0.
        inertia: f64,
    },
    /// A motor that drives a load through a spring and a damper.
    TwoMass {
        /// [kg or kg m²], above 0.
        motor_inertia: f64,
        /// [kg or kg m²], above 0.
        load_inertia: f64,
        /// [N/m or N m/rad], above 0.
        stiffness: f64,
        /// [N s/m or N m s/rad], 0 or more.
        damping: f64,
    },
    /// A motor that follows the setpoint exactly, whatever the load pulls: no drive, no friction, no limit.
    /// What a motion leaves swinging is then a matter of the motion alone and has a closed form.
    Prescribed {
        /// [kg or kg m²], above 0.
        load_inertia: f64,
        /// [N/m or N m/rad], above 0.
        stiffness: f64,
        /// [N s/m or N m s/rad], 0 or more.
        damping: f64,
    },
}

/// Friction on the motor side.
///
/// ```text
/// F(v) = sign(v)·(Fc + (Fs − Fc)·exp(−(v/vs)²)) + b·v        at rest: anything up to Fs
/// ```
///
/// Source: Olsson et al. (1998), "Friction models and friction compensation".
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrictionSpec {
    /// Fc: opposes any motion [N or N m], 0 or more.
    pub coulomb: f64,
    /// b: grows with speed [N s/m or N m s/rad], 0 or more.
    pub viscous: f64,
    /// Fs: what it takes to break away from rest [N or N m], `coulomb` or more; 0: as `coulomb`.
    pub static_friction: f64,
    /// vs: speed at which most of Fs − Fc has gone [m/s or rad/s]; 0: it is gone as soon as the motor moves.
    pub stribeck_velocity: f64,
}

/// The drive: position P, velocity PI, a first-order current loop, feed-forward of velocity and acceleration.
///
/// 0 in a gain means "tune it": see each field. A spec that is 0 everywhere, which is how a message that was
/// never set arrives, means [`ServoSpec::default`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoSpec {
    /// Kv [1/s]; 0: 50.
    pub position_gain: f64,
    /// Kp: effort per velocity error [N s/m or N m s/rad]; 0: 4·Kv times the whole inertia, so that the velocity
    /// loop crosses over two octaves above the position loop.
    pub velocity_gain: f64,
    /// Tn: the integral part is worth as much as the proportional part after this time [s]; 0: 1/Kv.
    pub velocity_integral_time: f64,
    /// Corner of the current loop, first order [Hz]; 0: 1000.
    pub current_loop_bandwidth: f64,
    /// Share of the commanded velocity that is fed forward [1], 0 to 1.
    pub velocity_feedforward: f64,
    /// Share of the commanded acceleration, times the whole inertia, that is fed forward [1], 0 to 1.
    pub acceleration_feedforward: f64,
    /// The drive's period [s], 50 to 100 µs, a whole fraction of the cycle; 0: the longest such.
    pub substep: f64,
    /// From a setpoint's instant to the drive's acting on it [s], 0 to 0.1, rounded to whole substeps.
    pub command_delay: f64,
}

/// The encoder on the motor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EncoderSpec {
    /// Motor travel per count [m or rad]; 0: exact, position and velocity alike.
    pub resolution: f64,
}

/// An axis that can be simulated: every number is finite and in range, every "choose for me" is chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisModel(AxisModelSpec);

impl AxisModelSpec {
    /// An axis that is always where its setpoint is, measured exactly.
    #[must_use]
    pub fn ideal(axis: impl Into<String>) -> Self {
        Self {
            axis: axis.into(),
            mechanics: MechanicsSpec::default(),
            servo: ServoSpec::default(),
            encoder: EncoderSpec::default(),
            noise_seed: 0,
            pulses_per_unit: 1.0,
        }
    }

    /// A linear motor, stiffly tuned, that carries a light load on a flexible mount.
    ///
    /// Made for moves of about 50 mm at 0.25 m/s, 3 m/s² and 100 m/s³: the motor follows within 10 µm, and the
    /// load is left swinging by some 13 µm for longer than the move took. It swings at 42.6 Hz behind a motor
    /// that is held, the two against each other at 46.0 Hz, with half a percent of critical damping; a jerk
    /// phase of 23.5 ms, one period, leaves next to nothing.
    #[must_use]
    pub fn flexible(axis: impl Into<String>) -> Self {
        Self {
            mechanics: MechanicsSpec {
                load: LoadSpec::TwoMass {
                    motor_inertia: 12.0,
                    load_inertia: 2.0,
                    stiffness: 1.43e5,
                    damping: 5.3,
                },
                friction: FrictionSpec {
                    coulomb: 3.0,
                    viscous: 5.0,
                    static_friction: 4.0,
                    stribeck_velocity: 0.005,
                },
                max_effort: 200.0,
            },
            servo: ServoSpec { position_gain: 80.0, velocity_gain: 14_000.0, ..ServoSpec::default() },
            encoder: EncoderSpec { resolution: 1e-7 },
            ..Self::ideal(axis)
        }
    }
}

impl Default for MechanicsSpec {
    /// Ideal, without friction, without limit.
    fn default() -> Self {
        Self { load: LoadSpec::Ideal, friction: FrictionSpec::default(), max_effort: 0.0 }
    }
}

impl Default for ServoSpec {
    /// Everything tuned by the rules of the fields, full feed-forward, no delay.
    fn default() -> Self {
        Self { velocity_feedforward: 1.0, acceleration_feedforward: 1.0, ..Self::UNSET }
    }
}

impl ServoSpec {
    /// 0 everywhere: means [`ServoSpec::default`] when a model is made.
    pub const UNSET: Self = Self {
        position_gain: 0.0,
        velocity_gain: 0.0,
        velocity_integral_time: 0.0,
        current_loop_bandwidth: 0.0,
        velocity_feedforward: 0.0,
        acceleration_feedforward: 0.0,
        substep: 0.0,
        command_delay: 0.0,
    };

    /// This servo with every gain that was left at 0 tuned to `inertia` [kg or kg m²].
    fn tuned(self, inertia: f64) -> Self {
        let given = if self == Self::UNSET { Self::default() } else { self };
        let position_gain = or_chosen(given.position_gain, DEFAULT_POSITION_GAIN);
        Self {
            position_gain,
            velocity_gain: or_chosen(given.velocity_gain, VELOCITY_TO_POSITION * position_gain * inertia),
            velocity_integral_time: or_chosen(given.velocity_integral_time, 1.0 / position_gain),
            current_loop_bandwidth: or_chosen(given.current_loop_bandwidth, DEFAULT_CURRENT_LOOP_BANDWIDTH),
            ..given
        }
    }
}

impl LoadSpec {
    /// All that the motor has to accelerate [kg or kg m²]; 0 where no motor is simulated.
    #[must_use]
    pub fn driven_inertia(&self) -> f64 {
        match *self {
            Self::Ideal | Self::Prescribed { .. } => 0.0,
            Self::Rigid { inertia } => inertia,
            Self::TwoMass { motor_inertia, load_inertia, .. } => motor_inertia + load_inertia,
        }
    }
}

impl AxisModel {
    /// [`AxisModelSpec::ideal`], checked.
    #[must_use]
    pub fn ideal(axis: impl Into<String>) -> Self {
        Self(AxisModelSpec::ideal(axis).resolved())
    }

    /// [`AxisModelSpec::flexible`], checked.
    #[must_use]
    pub fn flexible(axis: impl Into<String>) -> Self {
        Self(AxisModelSpec::flexible(axis).resolved())
    }

    /// Name of the axis in the plan.
    #[must_use]
    pub fn axis(&self) -> &str {
        &self.0.axis
    }

    /// The same axis under another name.
    #[must_use]
    pub fn renamed(&self, axis: impl Into<String>) -> Self {
        Self(AxisModelSpec { axis: axis.into(), ..self.0.clone() })
    }

    /// The same axis with its loops tuned to a position gain of `position_gain` [1/s].
    pub(crate) fn tuned_to(&self, position_gain: f64) -> Self {
        let mut spec = self.0.clone();
        let servo =
            ServoSpec { position_gain, velocity_gain: 0.0, velocity_integral_time: 0.0, ..spec.servo };
        spec.servo = servo.tuned(spec.mechanics.load.driven_inertia());
        Self(spec)
    }

    /// The model in numbers, with every default filled in (the substep apart: 0 waits for the cycle).
    #[must_use]
    pub fn spec(&self) -> &AxisModelSpec {
        &self.0
    }
}

impl TryFrom<AxisModelSpec> for AxisModel {
    type Error = InvalidModel;

    fn try_from(spec: AxisModelSpec) -> Result<Self, InvalidModel> {
        let fields = faults(&spec);
        if fields.is_empty() {
            Ok(Self(spec.resolved()))
        } else {
            Err(InvalidModel { axis: spec.axis, fields })
        }
    }
}

impl AxisModelSpec {
    fn resolved(mut self) -> Self {
        let friction = &mut self.mechanics.friction;
        friction.static_friction = or_chosen(friction.static_friction, friction.coulomb);
        self.servo = self.servo.tuned(self.mechanics.load.driven_inertia());
        self.pulses_per_unit = or_chosen(self.pulses_per_unit, 1.0);
        self
    }
}

/// 0 on the wire is "not set": then `chosen`.
fn or_chosen(given: f64, chosen: f64) -> f64 {
    if given == 0.0 { chosen } else { given }
}

/// Kv where none is given [1/s]: a machine-tool axis of the middle kind (3 m/min per mm of lag).
const DEFAULT_POSITION_GAIN: f64 = 50.0;
/// Crossover of the velocity loop over that of the position loop [1]: 4 damps the pair aperiodically
/// (a double pole at half the velocity loop's crossover).
const VELOCITY_TO_POSITION: f64 = 4.0;
/// Current loop where none is given [Hz].
const DEFAULT_CURRENT_LOOP_BANDWIDTH: f64 = 1000.0;
