use crate::error::{InvalidFields, Why};
use crate::limits::{not_finite, not_positive};

/// Limits with signs, as somebody states them: not yet checked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BoundsSpec {
    /// Lowest velocity [axis units/s], ≤ 0; 0 forbids to go back.
    pub min_velocity: f64,
    /// Highest velocity [axis units/s], > 0.
    pub max_velocity: f64,
    /// Lowest acceleration [axis units/s²], < 0.
    pub min_acceleration: f64,
    /// Highest acceleration [axis units/s²], > 0.
    pub max_acceleration: f64,
    /// Greatest magnitude of the jerk [axis units/s³], > 0.
    pub max_jerk: f64,
}

/// Limits with signs: velocity and acceleration each between two numbers, whatever the axis does. Where speeding up and slowing
/// down have limits of their own, those are [`Limits`](crate::Limits).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    spec: BoundsSpec,
}

impl Bounds {
    /// The same in both directions [axis units/s, /s², /s³].
    ///
    /// # Errors
    /// Every number that is not finite and positive.
    pub fn symmetric(velocity: f64, acceleration: f64, jerk: f64) -> Result<Self, InvalidFields> {
        Self::try_from(BoundsSpec {
            min_velocity: -velocity,
            max_velocity: velocity,
            min_acceleration: -acceleration,
            max_acceleration: acceleration,
            max_jerk: jerk,
        })
    }

    /// The numbers.
    #[must_use]
    pub fn spec(&self) -> &BoundsSpec {
        &self.spec
    }

    /// Of numbers that have been checked.
    pub(super) fn of(spec: BoundsSpec) -> Self {
        Self { spec }
    }
}

impl TryFrom<BoundsSpec> for Bounds {
    type Error = InvalidFields;

    fn try_from(spec: BoundsSpec) -> Result<Self, InvalidFields> {
        let BoundsSpec { min_velocity, max_velocity, min_acceleration, max_acceleration, max_jerk } = spec;
        let mut invalid = InvalidFields::default();
        let not_negative = |given: f64| not_positive(-given).map(|_| not_below_zero(given));
        invalid.note("min_velocity", if min_velocity == 0.0 { None } else { not_negative(min_velocity) });
        invalid.note("max_velocity", not_positive(max_velocity));
        invalid.note("min_acceleration", not_negative(min_acceleration));
        invalid.note("max_acceleration", not_positive(max_acceleration));
        invalid.note("max_jerk", not_positive(max_jerk));
        invalid.into_result(Self { spec: BoundsSpec { min_velocity: min_velocity + 0.0, ..spec } })
    }
}

/// What is wrong with a lower bound that is not a number below zero.
fn not_below_zero(given: f64) -> Why {
    not_finite(given).unwrap_or(Why::NotNegative { given })
}
