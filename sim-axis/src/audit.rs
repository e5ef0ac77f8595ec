use crate::model::{AxisModelSpec, FrictionSpec, LoadSpec, MechanicsSpec, ServoSpec};
use std::fmt;

/// A model with fields that cannot be simulated: all of them, in the order of the schema.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the model of axis {axis:?} cannot be simulated: {}", Listed(fields))]
pub struct InvalidModel {
    /// The axis as it was named.
    pub axis: String,
    /// What is wrong; never empty.
    pub fields: Vec<InvalidField>,
}

/// One field that cannot be simulated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum InvalidField {
    /// NaN or infinite.
    #[error("{path} is {given}: give a finite number")]
    NotFinite {
        /// Where it stands in the schema.
        path: &'static str,
        /// What was given.
        given: f64,
    },
    /// 0 or less where only more than 0 has a meaning.
    #[error("{path} is {given} and must be above 0: {way_out}")]
    NotPositive {
        /// Where it stands in the schema.
        path: &'static str,
        /// What was given.
        given: f64,
        /// What would do.
        way_out: &'static str,
    },
    /// Beyond what makes sense, or what the substep can resolve.
    #[error("{path} is {given}, outside {least} to {most}: {way_out}")]
    OutOfRange {
        /// Where it stands in the schema.
        path: &'static str,
        /// What was given.
        given: f64,
        /// Least value allowed.
        least: f64,
        /// Greatest value allowed.
        most: f64,
        /// What would do.
        way_out: &'static str,
    },
}

impl InvalidField {
    /// Where the field stands in the schema, from the model down: `mechanics.two_mass.stiffness`.
    #[must_use]
    pub fn path(&self) -> &'static str {
        match self {
            Self::NotFinite { path, .. } | Self::NotPositive { path, .. } | Self::OutOfRange { path, .. } => {
                path
            }
        }
    }
}

struct Listed<'a>(&'a [InvalidField]);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (n, field) in self.0.iter().enumerate() {
            let separator = if n == 0 { "" } else { "; " };
            write!(f, "{separator}{field}")?;
        }
        Ok(())
    }
}

/// All that keeps `spec` from being simulated, in the order of the schema.
pub(crate) fn faults(spec: &AxisModelSpec) -> Vec<InvalidField> {
    let AxisModelSpec { axis: _, mechanics, servo, encoder, noise_seed: _, pulses_per_unit } = spec;
    let mut audit = Audit::default();
    audit.mechanics(mechanics);
    audit.servo(servo);
    let exact = "0 makes the encoder exact";
    audit.unless_unset("encoder.resolution", encoder.resolution, LEAST_RESOLUTION, MOST_RESOLUTION, exact);
    let way_out = "leave it at 0 for an axis that is not in pulses";
    audit.unless_unset(
        "pulses_per_unit",
        *pulses_per_unit,
        LEAST_PULSES_PER_UNIT,
        MOST_PULSES_PER_UNIT,
        way_out,
    );
    audit.faults
}

#[derive(Default)]
struct Audit {
    faults: Vec<InvalidField>,
}

impl Audit {
    fn mechanics(&mut self, mechanics: &MechanicsSpec) {
        let MechanicsSpec { load, friction, max_effort } = mechanics;
        let motor_inertia = self.load(load);
        self.friction(friction, motor_inertia);
        self.within("mechanics.max_effort", *max_effort, 0.0, MOST_EFFORT, "0 means unlimited");
    }

    /// Checks the load and says what the motor alone weighs, as far as that can be known [kg or kg m²].
    fn load(&mut self, load: &LoadSpec) -> f64 {
        match *load {
            LoadSpec::Ideal => MOST_INERTIA,
            LoadSpec::Rigid { inertia } => self.inertia("mechanics.rigid.inertia", inertia),
            LoadSpec::TwoMass { motor_inertia, load_inertia, stiffness, damping } => {
                let motor = self.inertia("mechanics.two_mass.motor_inertia", motor_inertia);
                let load = self.inertia("mechanics.two_mass.load_inertia", load_inertia);
                let swinging = motor * load / (motor + load);
                self.stiffness("mechanics.two_mass.stiffness", stiffness, swinging);
                self.damping("mechanics.two_mass.damping", damping, swinging);
                motor
            }
            LoadSpec::Prescribed { load_inertia, stiffness, damping } => {
                let load = self.inertia("mechanics.prescribed.load_inertia", load_inertia);
                self.stiffness("mechanics.prescribed.stiffness", stiffness, load);
                self.damping("mechanics.prescribed.damping", damping, load);
                MOST_INERTIA
            }
        }
    }

    /// The inertia itself, or where it is unusable the greatest one, so that one fault is not reported as two.
    fn inertia(&mut self, path: &'static str, given: f64) -> f64 {
        let way_out = "give what moves in kg, or in kg m^2 if it turns";
        let sound = self.positive(path, given, way_out)
            && self.within(path, given, LEAST_INERTIA, MOST_INERTIA, way_out);
        if sound { given } else { MOST_INERTIA }
    }

    fn stiffness(&mut self, path: &'static str, given: f64, swinging: f64) {
        let fastest = std::f64::consts::TAU * MOST_RESONANCE;
        let most = swinging * fastest * fastest;
        let way_out = "a resonance above 5 kHz is not resolved: model the axis as rigid";
        let _ = self.positive(path, given, "model an axis without a spring as rigid")
            && self.within(path, given, 0.0, most, way_out);
    }

    fn damping(&mut self, path: &'static str, given: f64, swinging: f64) {
        self.within(
            path,
            given,
            0.0,
            swinging * MOST_DECAY,
            "0 means undamped; more damping acts as a rigid axis",
        );
    }

    fn friction(&mut self, friction: &FrictionSpec, motor_inertia: f64) {
        let FrictionSpec { coulomb, viscous, static_friction, stribeck_velocity } = *friction;
        self.within("mechanics.friction.coulomb", coulomb, 0.0, MOST_EFFORT, "0 means none");
        self.within("mechanics.friction.viscous", viscous, 0.0, motor_inertia * MOST_DECAY, "0 means none");
        let way_out = "breaking away takes at least what moving takes; 0 means as much as coulomb";
        let least = if coulomb.is_finite() { coulomb.max(0.0) } else { 0.0 };
        self.unless_unset("mechanics.friction.static_friction", static_friction, least, MOST_EFFORT, way_out);
        let way_out = "0 means that static friction is gone as soon as the motor moves";
        self.within("mechanics.friction.stribeck_velocity", stribeck_velocity, 0.0, MOST_VELOCITY, way_out);
    }

    fn servo(&mut self, servo: &ServoSpec) {
        let ServoSpec {
            position_gain,
            velocity_gain,
            velocity_integral_time,
            current_loop_bandwidth,
            velocity_feedforward,
            acceleration_feedforward,
            substep,
            command_delay,
        } = *servo;
        let tune = "0 leaves it to be tuned";
        self.unless_unset("servo.position_gain", position_gain, LEAST_GAIN, MOST_GAIN, tune);
        self.within("servo.velocity_gain", velocity_gain, 0.0, MOST_INERTIA * MOST_GAIN, tune);
        let (least, most) = (LEAST_INTEGRAL_TIME, MOST_INTEGRAL_TIME);
        self.unless_unset("servo.velocity_integral_time", velocity_integral_time, least, most, tune);
        let (least, most) = (LEAST_BANDWIDTH, MOST_BANDWIDTH);
        self.unless_unset("servo.current_loop_bandwidth", current_loop_bandwidth, least, most, tune);
        let share = "it is a share: 0 feeds nothing forward, 1 all";
        self.within("servo.velocity_feedforward", velocity_feedforward, 0.0, 1.0, share);
        self.within("servo.acceleration_feedforward", acceleration_feedforward, 0.0, 1.0, share);
        let way_out = "0 takes the longest that divides the cycle";
        self.unless_unset("servo.substep", substep, LEAST_SUBSTEP, MOST_SUBSTEP, way_out);
        let way_out = "a delay beyond that is no drive's: shift the setpoints instead";
        self.within("servo.command_delay", command_delay, 0.0, MOST_COMMAND_DELAY, way_out);
    }

    /// As [`within`](Self::within), for a field whose 0 has a meaning of its own.
    fn unless_unset(&mut self, path: &'static str, given: f64, least: f64, most: f64, way_out: &'static str) {
        if given != 0.0 {
            self.within(path, given, least, most, way_out);
        }
    }

    fn positive(&mut self, path: &'static str, given: f64, way_out: &'static str) -> bool {
        let fault = if !given.is_finite() {
            InvalidField::NotFinite { path, given }
        } else if given <= 0.0 {
            InvalidField::NotPositive { path, given, way_out }
        } else {
            return true;
        };
        self.faults.push(fault);
        false
    }

    fn within(
        &mut self,
        path: &'static str,
        given: f64,
        least: f64,
        most: f64,
        way_out: &'static str,
    ) -> bool {
        let fault = if !given.is_finite() {
            InvalidField::NotFinite { path, given }
        } else if given < least || given > most {
            InvalidField::OutOfRange { path, given, least, most, way_out }
        } else {
            return true;
        };
        self.faults.push(fault);
        false
    }
}

/// The drive's period [s]. Slower, and the current loop is not seen; faster, and nothing new is.
pub(crate) const LEAST_SUBSTEP: f64 = 50e-6;
/// See [`LEAST_SUBSTEP`].
pub(crate) const MOST_SUBSTEP: f64 = 100e-6;

/// What half the slowest substep rate can show [Hz].
const MOST_RESONANCE: f64 = 0.5 / MOST_SUBSTEP;
/// Fastest decay [1/s]: ten times per substep, and it is over within one.
const MOST_DECAY: f64 = 10.0 / MOST_SUBSTEP;

// Bounds that no machine reaches: they keep products and quotients of model numbers far from overflow.
const LEAST_INERTIA: f64 = 1e-12;
const MOST_INERTIA: f64 = 1e9;
const MOST_EFFORT: f64 = 1e12;
const MOST_VELOCITY: f64 = 1e6;
pub(crate) const LEAST_GAIN: f64 = 1e-6;
const MOST_GAIN: f64 = 1e5;
const LEAST_INTEGRAL_TIME: f64 = 1e-5;
const MOST_INTEGRAL_TIME: f64 = 1e6;
const LEAST_BANDWIDTH: f64 = 1.0;
const MOST_BANDWIDTH: f64 = 1e6;
const MOST_COMMAND_DELAY: f64 = 0.1;
const LEAST_RESOLUTION: f64 = 1e-15;
const MOST_RESOLUTION: f64 = 1.0;
const LEAST_PULSES_PER_UNIT: f64 = 1e-6;
const MOST_PULSES_PER_UNIT: f64 = 1e15;
