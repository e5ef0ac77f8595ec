//! The axes that a comparison is made on.

use std::borrow::Cow;

use planner::AxisKind;
use sim_axis::{AxisModel, AxisModelSpec, EncoderSpec, FrictionSpec, LoadSpec, MechanicsSpec, ServoSpec};

use crate::show::number::plain;

/// What follows a move: an axis that fits its kind, or the one that somebody describes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Machine<'a> {
    /// A linear motor for metres and for pulses, a torque motor for radians.
    Usual {
        /// On an axis in pulses [1/m].
        pulses_per_metre: f64,
    },
    Given(&'a AxisModel),
}

/// Pulses of the usual axis that is counted in them \[1/m\]: a pulse is a micrometre.
pub(crate) const PULSES_PER_METRE: f64 = 1e6;

impl Machine<'_> {
    /// What the axis of a move of `kind` is made of.
    pub(super) fn model(&self, kind: AxisKind) -> Cow<'_, AxisModel> {
        match (self, kind) {
            (Self::Given(model), _) => Cow::Borrowed(*model),
            (Self::Usual { .. }, AxisKind::Prismatic) => Cow::Owned(checked(linear_motor())),
            (Self::Usual { .. }, AxisKind::Revolute) => Cow::Owned(checked(torque_motor())),
            (&Self::Usual { pulses_per_metre }, AxisKind::Pulses) => {
                Cow::Owned(checked(AxisModelSpec { pulses_per_unit: pulses_per_metre, ..linear_motor() }))
            }
        }
    }

    /// The most effort that its motor has, with its unit.
    pub(super) fn effort_limit(&self, kind: AxisKind) -> String {
        let unit = match (self, kind) {
            (_, AxisKind::Prismatic) | (Self::Usual { .. }, AxisKind::Pulses) => "N",
            (_, AxisKind::Revolute) => "N m",
            (Self::Given(_), AxisKind::Pulses) => "N (or N m)",
        };
        format!("{}\u{a0}{unit}", plain(self.model(kind).spec().mechanics.max_effort))
    }

    /// What that is, in a sentence.
    pub(super) fn words(&self, kind: AxisKind) -> String {
        let model = self.model(kind);
        let what = match (self, kind) {
            (Self::Given(_), _) => "The axis that the model describes",
            (Self::Usual { .. }, AxisKind::Prismatic | AxisKind::Pulses) => {
                "A linear motor of 6 kg with 1.5 kg on a mount that swings at 30 Hz"
            }
            (Self::Usual { .. }, AxisKind::Revolute) => {
                "A torque motor of 0.12 kg m² with 0.03 kg m² on a mount that swings at 30 Hz"
            }
        };
        if kind != AxisKind::Pulses {
            return format!("{what}.");
        }
        let unit = match self {
            Self::Usual { .. } => "m",
            // What it is made of does not say which.
            Self::Given(_) => "m (or rad)",
        };
        format!("{what}; one pulse is {}\u{a0}{unit}.", plain(1.0 / model.spec().pulses_per_unit))
    }
}

/// A linear motor on an air bearing, so without friction worth mentioning, with a load on a flexible mount; fed back by a laser encoder
/// on the motor. It is the kind of machine that Nguyen, Ng and Chen (2008) measured; of theirs no figures are known.
///
/// The load swings at 30 Hz behind a motor that is held and at 33.5 Hz freely, with half a percent of critical damping: in the
/// 50 ms in which the acceleration of their move comes to 0.6 m/s² it swings 1.5 times while the drive holds the motor, so that the third
/// order does not cancel most of its own swing, as it would where that number is whole.
fn linear_motor() -> AxisModelSpec {
    AxisModelSpec {
        mechanics: MechanicsSpec {
            load: LoadSpec::TwoMass {
                motor_inertia: 6.0,
                load_inertia: 1.5,
                stiffness: 5.33e4,
                damping: 2.83,
            },
            friction: FrictionSpec { viscous: 2.0, ..FrictionSpec::default() },
            // 20 m/s² of both bodies.
            max_effort: 150.0,
        },
        servo: ServoSpec { position_gain: 60.0, ..ServoSpec::default() },
        encoder: EncoderSpec { resolution: 1e-8 },
        ..AxisModelSpec::ideal("")
    }
}

/// The same in the round: a rotary table on its motor without a gear, which carries a load on a flexible mount. Every mass is a moment of
/// inertia of a fiftieth, and so are stiffness, damping and friction: the same swing at the same numbers, in radians.
fn torque_motor() -> AxisModelSpec {
    AxisModelSpec {
        mechanics: MechanicsSpec {
            load: LoadSpec::TwoMass {
                motor_inertia: 0.12,
                load_inertia: 0.03,
                stiffness: 1066.0,
                damping: 0.0566,
            },
            friction: FrictionSpec { viscous: 0.04, ..FrictionSpec::default() },
            // 200 rad/s² of both bodies: a table turns further than a slide runs.
            max_effort: 30.0,
        },
        // 2²⁶ lines in a turn, as ring encoders interpolate them.
        encoder: EncoderSpec { resolution: std::f64::consts::TAU / 67_108_864.0 },
        ..linear_motor()
    }
}

fn checked(spec: AxisModelSpec) -> AxisModel {
    // Its numbers are constants that a test makes an axis of, and a number of pulses that the flag has looked at.
    AxisModel::try_from(spec).unwrap_or_else(|_| AxisModel::flexible(""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_an_axis_that_swings_as_it_is_described() {
        let machine = Machine::Usual { pulses_per_metre: PULSES_PER_METRE };
        for kind in [AxisKind::Prismatic, AxisKind::Revolute, AxisKind::Pulses] {
            let model = machine.model(kind);
            assert_ne!(*model, AxisModel::flexible(""));
            let LoadSpec::TwoMass { motor_inertia, load_inertia, stiffness, damping } =
                model.spec().mechanics.load
            else {
                panic!("{model:?}")
            };
            let held = (stiffness / load_inertia).sqrt() / std::f64::consts::TAU;
            let free = held * (1.0 + load_inertia / motor_inertia).sqrt();
            assert!((held - 30.0).abs() < 0.01 && (free - 33.54).abs() < 0.01, "{held} {free}");
            let share = damping / (2.0 * (stiffness * load_inertia).sqrt());
            assert!((share - 0.005).abs() < 1e-4, "{share}");
        }
    }
}
