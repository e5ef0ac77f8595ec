//! Whether the loops of a drive are stable on its axis.

use nalgebra::{SMatrix, Vector4};
use planner::State;

use crate::encoder::{Encoder, Measured};
use crate::model::MechanicsSpec;
use crate::plant::Plant;
use crate::servo::{Memory, Servo};

/// What the closed loop carries from one substep to the next: the plant's four states, the drive's two, and the positions
/// from which an encoder with counts estimates velocity.
const STATES: usize = 4 + 2 + Encoder::WINDOW;

/// By how much the closed loop of `servo` around `mechanics` multiplies what is left of a disturbance, at most, per substep
/// of `substep` seconds [1]: beyond 1 it grows without bound. `None` where no motor is driven.
///
/// The drive and the plant without dry friction, limits and quantisation are one linear step `x ← M·x`, exact as
/// [`Plant`] is, so that its growth is the spectral radius of `M`. The columns of
/// `M` are what [`Servo::decide`] and the plant make of unit vectors. Viscous friction and the delay of an encoder that
/// estimates velocity are in it; a delay of commands is outside the loop.
pub(crate) fn growth(mechanics: &MechanicsSpec, servo: &Servo, counts: bool, substep: f64) -> Option<f64> {
    let (coast, push) = Plant::new(mechanics, &State::default(), substep).free_motion()?;
    let servo = servo.unlimited();
    let step = |x: [f64; STATES]| -> [f64; STATES] {
        let [position, velocity, deflection, rate, integral, effort, past @ ..] = x;
        let estimated = (position - past[0]) / (Encoder::WINDOW as f64 * substep);
        let measured = Measured { position, velocity: if counts { estimated } else { velocity } };
        let decision = servo.decide(Memory { integral, effort }, &State::default(), measured);
        let plant = coast * Vector4::new(position, velocity, deflection, rate) + push * decision.effort;
        let [_, later @ ..] = past;
        let mut next = [0.0; STATES];
        next[..4].copy_from_slice(plant.as_slice());
        (next[4], next[5]) = (decision.memory.integral, decision.memory.effort);
        next[6..STATES - 1].copy_from_slice(&later);
        next[STATES - 1] = position;
        next
    };
    // Counted in substeps all states are of one size, and the eigenvalues keep their digits.
    let inertia = mechanics.load.driven_inertia();
    let mut size = [1.0; STATES];
    (size[1], size[3]) = (1.0 / substep, 1.0 / substep);
    (size[4], size[5]) = (inertia / substep / substep, inertia / substep / substep);
    let mut matrix = Step::zeros();
    for column in 0..STATES {
        let mut unit = [0.0; STATES];
        unit[column] = size[column];
        for (row, value) in step(unit).into_iter().enumerate() {
            matrix[(row, column)] = value / size[row];
        }
    }
    Some(spectral_radius(matrix))
}

type Step = SMatrix<f64, STATES, STATES>;

/// The n-th root of the norm of `Mⁿ` for n = 2²⁰ substeps, the better part of two minutes. Source: Gelfand's formula, Horn &
/// Johnson (2013), Cor. 5.6.14. Unlike an iteration for the eigenvalues it has no case in which it does not converge; where k
/// of them coincide at 1 the norm grows as n^(k−1), and the root is 1 + 1.4e-5·(k − 1).
fn spectral_radius(matrix: Step) -> f64 {
    let (mut power, mut log_norm) = (matrix, 0.0);
    for _ in 0..DOUBLINGS {
        power *= power;
        let norm = power.norm();
        if norm == 0.0 {
            return 0.0;
        }
        power /= norm;
        log_norm = 2.0 * log_norm + libm::log(norm);
    }
    libm::exp(log_norm / f64::from(1 << DOUBLINGS))
}

const DOUBLINGS: u32 = 20;

/// Growth per substep beyond 1 that is let pass [1]: three eigenvalues that nearly coincide at 1, as those of a very soft drive
/// do, are known to the cube root of a rounding, 6e-6, and the root above adds as much again. What grows so slowly takes a
/// second to be e times as large, which a report shows.
pub(crate) const SLACK: f64 = 1e-4;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{AxisModel, AxisModelSpec, EncoderSpec, LoadSpec, ServoSpec};
    use nalgebra::Matrix2;

    const SUBSTEP: f64 = 1e-4;

    fn model(load: LoadSpec, position_gain: f64, velocity_gain: f64) -> AxisModel {
        let ideal = AxisModelSpec::ideal("x");
        let mechanics = MechanicsSpec { load, ..ideal.mechanics };
        let servo = ServoSpec { position_gain, velocity_gain, ..ServoSpec::default() };
        AxisModel::try_from(AxisModelSpec { mechanics, servo, ..ideal }).unwrap()
    }

    fn growth_of(model: &AxisModel) -> f64 {
        let spec = model.spec();
        let servo = Servo::new(model, SUBSTEP);
        growth(&spec.mechanics, &servo, spec.encoder.resolution > 0.0, SUBSTEP).unwrap()
    }

    #[test]
    fn the_radius_is_that_of_known_eigenvalues() {
        let rows = [(0.5, 0.5), (0.999, 0.999), (1.0, 1.0), (1.1, 1.1), (-1.3, 1.3), (0.0, 0.0)];
        for (eigenvalue, radius) in rows {
            // A chain: as bad as coinciding eigenvalues can be.
            let chain = Step::from_diagonal_element(eigenvalue)
                + Step::from_fn(|row, column| if column == row + 1 { 1.0 } else { 0.0 });
            let found = spectral_radius(chain);
            assert!((found - radius).abs() <= 2e-4, "{eigenvalue}: {found}");
        }
        let turn = Matrix2::new(0.6, -0.8, 0.8, 0.6) * 1.001;
        let mut spiral = Step::zeros();
        spiral.fixed_view_mut::<2, 2>(3, 3).copy_from(&turn);
        assert!((spectral_radius(spiral) - 1.001).abs() < 1e-5);
    }

    #[test]
    fn a_drive_that_is_too_soft_for_its_integral_part_is_unstable() {
        // s³ + (Kp/J)·s² … : by Routh's criterion stable where Kp·(Kv + 1/Tn) > J·Kv/Tn, with Tn = 1/Kv where 2·Kp > J·Kv.
        // Source: Ogata (2010), §5.6.
        let inertia = 10.0;
        for (velocity_gain, stable) in [(0.7, true), (0.3, false)] {
            let model = model(LoadSpec::Rigid { inertia }, 100.0, velocity_gain * inertia * 100.0);
            assert_eq!(growth_of(&model) <= 1.0 + SLACK, stable, "{velocity_gain}");
        }
    }

    #[test]
    fn the_limit_of_a_sampled_velocity_loop_is_found() {
        // v ← v − (Kp·h/J)·v with a current loop that is done within the substep: stable below Kp·h/J = 2.
        for (kp_h_over_j, stable) in [(1.9, true), (2.1, false)] {
            let spec = AxisModelSpec {
                servo: ServoSpec {
                    position_gain: 1e-6,
                    velocity_gain: kp_h_over_j * 10.0 / SUBSTEP,
                    velocity_integral_time: 1e6,
                    current_loop_bandwidth: 1e6,
                    ..ServoSpec::default()
                },
                mechanics: MechanicsSpec {
                    load: LoadSpec::Rigid { inertia: 10.0 },
                    ..AxisModelSpec::ideal("x").mechanics
                },
                ..AxisModelSpec::ideal("x")
            };
            let found = growth_of(&AxisModel::try_from(spec).unwrap());
            assert_eq!(found <= 1.0 + SLACK, stable, "{kp_h_over_j}: {found}");
            if !stable {
                // The current loop settles at 63 per substep, so its mean is late by 1/63 of one.
                assert!((found - 1.1).abs() < 0.05, "{found}");
            }
        }
    }

    #[test]
    fn an_encoder_that_estimates_velocity_makes_the_loop_less_stable() {
        let exact = model(LoadSpec::Rigid { inertia: 10.0 }, 50.0, 70_000.0);
        let counting = AxisModelSpec { encoder: EncoderSpec { resolution: 1e-6 }, ..exact.spec().clone() };
        assert!(growth_of(&exact) <= 1.0 + SLACK);
        assert!(growth_of(&AxisModel::try_from(counting).unwrap()) > 1.01);
    }

    #[test]
    fn what_is_tuned_by_the_rules_is_stable() {
        for inertia in [1e-6, 1.0, 1e6] {
            assert!(growth_of(&model(LoadSpec::Rigid { inertia }, 0.0, 0.0)) <= 1.0 + SLACK);
        }
        assert!(growth_of(&AxisModel::flexible("x")) <= 1.0 + SLACK);
    }
}
