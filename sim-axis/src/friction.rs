use crate::model::FrictionSpec;

/// Dry friction: what opposes a motion, and what holds a motor that stands. The viscous part is linear and
/// belongs to the plant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DryFriction {
    coulomb: f64,
    breakaway: f64,
    stribeck_velocity: f64,
}

impl DryFriction {
    pub(crate) fn new(spec: &FrictionSpec) -> Self {
        let FrictionSpec { coulomb, viscous: _, static_friction, stribeck_velocity } = *spec;
        Self { coulomb, breakaway: static_friction, stribeck_velocity }
    }

    /// Whether friction can balance `effort` [N or N m] on a motor that stands.
    pub(crate) fn holds(&self, effort: f64) -> bool {
        self.breakaway > 0.0 && effort.abs() <= self.breakaway
    }

    /// Most that friction opposes at this speed [N or N m].
    ///
    /// ```text
    /// F(v) = Fc + (Fs − Fc)·exp(−(v/vs)²)
    /// ```
    pub(crate) fn level(&self, speed: f64) -> f64 {
        let above = self.breakaway - self.coulomb;
        if above == 0.0 || speed == 0.0 {
            return self.breakaway;
        }
        if self.stribeck_velocity == 0.0 {
            return self.coulomb;
        }
        let ratio = speed / self.stribeck_velocity;
        self.coulomb + above * libm::exp(-ratio * ratio)
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "these numbers come through untouched")]
mod tests {
    use super::*;

    fn friction(stribeck_velocity: f64) -> DryFriction {
        DryFriction::new(&FrictionSpec {
            coulomb: 2.0,
            viscous: 9.0,
            static_friction: 5.0,
            stribeck_velocity,
        })
    }

    #[test]
    fn friction_falls_from_breakaway_to_coulomb() {
        let falling = friction(0.01);
        assert_eq!(falling.level(0.0), 5.0);
        assert_eq!(falling.level(-0.01), 2.0 + 3.0 * libm::exp(-1.0));
        assert_eq!(falling.level(1.0), 2.0);
        assert_eq!([friction(0.0).level(0.0), friction(0.0).level(1e-9)], [5.0, 2.0]);
    }

    #[test]
    fn a_motor_is_held_up_to_breakaway() {
        let held: Vec<bool> =
            [0.0, 5.0, -5.0, 5.001, f64::NAN].map(|effort| friction(0.01).holds(effort)).into();
        assert_eq!(held, [true, true, true, false, false]);
    }
}
