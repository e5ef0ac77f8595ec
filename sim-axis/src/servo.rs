use crate::Measured;
use crate::model::{AxisModel, ServoSpec};
use planner::State;

/// The drive's loops, once per substep.
///
/// ```text
///              velocity feed-forward ─────────┐      acceleration feed-forward × inertia ─┐
///                                             ▼                                           ▼
///  setpoint ──►(−)──► Kv ───────────────────►(+)──►(−)──► Kp·(1 + 1/(Tn·s)) ─────────────►(+)──► limit ──► 1/(1 + τs) ──► effort
///               ▲                                   ▲         └ stands still while limited                current loop
///               └ measured position                 └ measured velocity
/// ```
///
/// Under a steady ramp of speed `v` the integral part has removed every velocity error, so that what is left
/// is the lag `v·(1 − Kff)/Kv`.
#[derive(Clone, Copy, Debug)]
pub struct Servo {
    position_gain: f64,
    velocity_gain: f64,
    /// Kp·h/Tn [N s/m or N m s/rad]: what a substep of velocity error adds to the integral part.
    integral_gain: f64,
    velocity_feedforward: f64,
    /// Share times inertia [kg or kg m²].
    acceleration_feedforward: f64,
    /// What is left of an effort error after a substep of the current loop [1].
    current_left: f64,
    /// The same, averaged over the substep [1].
    current_mean: f64,
    max_effort: f64,
}

/// What the drive carries from one substep to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Memory {
    /// Integral part of the velocity loop [N or N m].
    pub integral: f64,
    /// Effort at this instant [N or N m].
    pub effort: f64,
}

/// What the drive does for one substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decision {
    /// Mean effort over the substep [N or N m]: the motor gets the momentum that the current loop gives it.
    pub effort: f64,
    /// More effort was wanted than the limit allows.
    pub saturated: bool,
    /// For the next substep.
    pub memory: Memory,
}

impl Servo {
    /// The drive of `model`, deciding every `substep` seconds.
    #[must_use]
    pub fn new(model: &AxisModel, substep: f64) -> Self {
        let ServoSpec {
            position_gain,
            velocity_gain,
            velocity_integral_time,
            current_loop_bandwidth,
            velocity_feedforward,
            acceleration_feedforward,
            substep: _,
            command_delay: _,
        } = model.spec().servo;
        let mechanics = &model.spec().mechanics;
        let corners = std::f64::consts::TAU * current_loop_bandwidth * substep;
        Self {
            position_gain,
            velocity_gain,
            integral_gain: velocity_gain * substep / velocity_integral_time,
            velocity_feedforward,
            acceleration_feedforward: acceleration_feedforward * mechanics.load.driven_inertia(),
            current_left: libm::exp(-corners),
            current_mean: -libm::expm1(-corners) / corners,
            max_effort: if mechanics.max_effort == 0.0 { f64::INFINITY } else { mechanics.max_effort },
        }
    }

    /// The same drive with `scale` of its effort, 0 to 1: a weak supply, a hot motor.
    #[must_use]
    pub fn with_effort_scaled(self, scale: f64) -> Self {
        Self { max_effort: if scale == 0.0 { 0.0 } else { self.max_effort * scale }, ..self }
    }

    /// The same drive with all the effort that it wants.
    pub(crate) fn unlimited(self) -> Self {
        Self { max_effort: f64::INFINITY, ..self }
    }

    /// The effort for the coming substep, from where the motor should be and where it is.
    ///
    /// Anti-windup by clamping: while the effort is limited, the integral part takes only what leads back
    /// inside, and by itself it never asks for more than the limit. Source: Visioli (2006), ch. 3.
    #[must_use]
    pub fn decide(&self, memory: Memory, setpoint: &State, measured: Measured) -> Decision {
        let position_error = setpoint.position - measured.position;
        let velocity = self.velocity_feedforward * setpoint.velocity + self.position_gain * position_error;
        let velocity_error = velocity - measured.velocity;
        let wanted = self.velocity_gain * velocity_error
            + memory.integral
            + self.acceleration_feedforward * setpoint.acceleration;
        let limited = self.limited(wanted);
        let saturated = wanted.abs() > self.max_effort;
        let winds_up = saturated && velocity_error * wanted > 0.0;
        let gained = if winds_up { 0.0 } else { self.integral_gain * velocity_error };
        let behind = memory.effort - limited;
        Decision {
            effort: limited + behind * self.current_mean,
            saturated,
            memory: Memory {
                integral: self.limited(memory.integral + gained),
                effort: limited + behind * self.current_left,
            },
        }
    }

    fn limited(&self, effort: f64) -> f64 {
        effort.max(-self.max_effort).min(self.max_effort)
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these numbers come through untouched")]
mod tests {
    use super::*;
    use crate::model::{AxisModelSpec, LoadSpec, MechanicsSpec};

    const SUBSTEP: f64 = 1e-4;

    fn servo(max_effort: f64) -> Servo {
        let ideal = AxisModelSpec::ideal("x");
        let load = LoadSpec::Rigid { inertia: 2.0 };
        let model = AxisModelSpec {
            mechanics: MechanicsSpec { load, max_effort, ..ideal.mechanics },
            servo: ServoSpec { position_gain: 10.0, velocity_gain: 30.0, ..ServoSpec::default() },
            ..ideal
        };
        Servo::new(&AxisModel::try_from(model).unwrap(), SUBSTEP)
    }

    #[test]
    fn the_current_loop_reaches_63_percent_after_its_time_constant() {
        let asked = State { acceleration: 1.0, ..State::default() };
        let mut memory = Memory::default();
        let mut momentum = 0.0;
        let substeps = 20;
        for _ in 0..substeps {
            let decision = servo(0.0).decide(memory, &asked, Measured::default());
            momentum += decision.effort * SUBSTEP;
            memory = decision.memory;
        }
        // First order from 0 to 2 N: u = 2·(1 − exp(−t/τ)), its integral 2·(t − τ·(1 − exp(−t/τ))).
        let (tau, t) = (1.0 / (std::f64::consts::TAU * 1000.0), f64::from(substeps) * SUBSTEP);
        let rise = -f64::exp_m1(-t / tau);
        let rounding = 1e-12;
        assert!((memory.effort - 2.0 * rise).abs() < rounding);
        assert!((momentum - 2.0 * (t - tau * rise)).abs() < rounding * t);
    }

    #[test]
    fn feed_forward_is_the_inertia_times_the_share() {
        let asked = State { acceleration: 3.0, velocity: 0.5, position: 0.0 };
        let on_speed = Measured { position: 0.0, velocity: 0.5 };
        let steady = Memory { integral: 0.0, effort: 6.0 };
        let decision = servo(0.0).decide(steady, &asked, on_speed);
        assert_eq!(decision, Decision { effort: 6.0, saturated: false, memory: steady });
    }

    #[test]
    fn the_integral_stands_still_while_the_effort_is_limited() {
        let far = State::at_rest(100.0);
        let mut memory = Memory { integral: 1.0, effort: 0.0 };
        for _ in 0..1000 {
            let decision = servo(5.0).decide(memory, &far, Measured::default());
            assert!(decision.saturated);
            memory = decision.memory;
        }
        assert_eq!(memory.integral, 1.0);
        let other_way = servo(5.0).decide(memory, &State::at_rest(-100.0), Measured::default());
        assert!(other_way.saturated && other_way.memory.integral == 1.0);
    }

    #[test]
    fn a_scaled_drive_gives_no_more_than_its_share() {
        let far = State::at_rest(100.0);
        let settled = |scale: f64| {
            let servo = servo(5.0).with_effort_scaled(scale);
            (0..1000)
                .fold(Memory::default(), |memory, _| servo.decide(memory, &far, Measured::default()).memory)
                .effort
        };
        let rounding = 1e-12;
        for scale in [1.0, 0.5, 0.0] {
            assert!((settled(scale) - 5.0 * scale).abs() < rounding, "{scale}");
        }
    }
}
