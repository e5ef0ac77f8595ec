use alloc::vec::Vec;

use crate::error::{Field, InvalidField, InvalidFields, Why};
use crate::float::{largest, least};

/// The highest order of a profile, and the highest derivative that can be limited: of 2⁸ − 1 pieces.
pub const MAX_ORDER: usize = 8;

/// Orders above snap (the fourth): 5, 6, … [`MAX_ORDER`].
const MAX_HIGHER: usize = MAX_ORDER - 4;

/// The least positive limit that the planner takes, and the largest magnitude of any number [axis units and their
/// derivatives]. Products of four such numbers neither overflow nor vanish, which is all that the formulas need.
pub const LEAST_LIMIT: f64 = 1e-60;
/// See [`LEAST_LIMIT`].
pub const GREATEST_MAGNITUDE: f64 = 1e60;

/// Limits as somebody states them: magnitudes, not yet checked.
///
/// `None` means: equal to its counterpart, or (position, snap, feed rate) no limit of its own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LimitsSpec {
    /// Greatest speed in the positive direction [axis units/s], > 0.
    pub max_velocity: f64,
    /// Greatest acceleration while speed grows [axis units/s²], > 0.
    pub max_acceleration: f64,
    /// Greatest jerk [axis units/s³], > 0.
    pub max_jerk: f64,
    /// Greatest deceleration, while speed shrinks [axis units/s²], > 0. `None`: as `max_acceleration`.
    pub max_deceleration: Option<f64>,
    /// Greatest speed in the negative direction [axis units/s], ≥ 0; 0 forbids it. `None`: as `max_velocity`.
    pub max_velocity_reverse: Option<f64>,
    /// Lowest position [axis units].
    pub min_position: Option<f64>,
    /// Highest position [axis units].
    pub max_position: Option<f64>,
    /// Greatest snap, the fourth derivative [axis units/s⁴], > 0.
    pub max_snap: Option<f64>,
    /// Greatest fifth, sixth … derivative in turn [axis units/s⁵ …], each > 0.
    pub max_higher_derivatives: Vec<f64>,
    /// The speed asked for along the move [axis units/s], > 0: what an override scales. `None`: the velocity limit.
    pub feed_rate: Option<f64>,
}

/// What an axis may do: magnitudes that are known to be finite and positive.
///
/// *Speeding up and slowing down* are told apart by the sign of acceleration times velocity: |a| ≤ acceleration
/// where the speed grows, |a| ≤ deceleration where it shrinks. Made from a [`LimitsSpec`], which it checks once.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    spec: LimitsSpec,
}

impl Limits {
    /// Equal limits in both directions, for speeding up and slowing down [axis units/s, /s², /s³].
    ///
    /// # Errors
    /// Every number that is not finite and positive.
    pub fn symmetric(velocity: f64, acceleration: f64, jerk: f64) -> Result<Self, InvalidFields> {
        LimitsSpec {
            max_velocity: velocity,
            max_acceleration: acceleration,
            max_jerk: jerk,
            ..LimitsSpec::default()
        }
        .try_into()
    }

    /// The limits as they were stated.
    #[must_use]
    pub fn spec(&self) -> &LimitsSpec {
        &self.spec
    }

    /// Greatest speed in the positive direction [axis units/s].
    #[must_use]
    pub fn velocity_forward(&self) -> f64 {
        self.spec.max_velocity
    }

    /// Greatest speed in the negative direction [axis units/s], a magnitude; 0 forbids it.
    #[must_use]
    pub fn velocity_reverse(&self) -> f64 {
        self.spec.max_velocity_reverse.unwrap_or(self.spec.max_velocity)
    }

    /// Greatest speed in the direction of `sign` [axis units/s].
    #[must_use]
    pub fn velocity_towards(&self, sign: f64) -> f64 {
        if sign < 0.0 { self.velocity_reverse() } else { self.velocity_forward() }
    }

    /// The speed to cruise at in the direction of `sign` [axis units/s]: the feed rate, or the limit where that is less.
    #[must_use]
    pub fn cruise_towards(&self, sign: f64) -> f64 {
        let limit = self.velocity_towards(sign);
        self.spec.feed_rate.map_or(limit, |feed_rate| least(feed_rate, limit))
    }

    /// The same with the cruise speed scaled by `factor` > 0, which the velocity limit is then, and anywhere: what a motion
    /// under an override is planned within. Not above the velocity limit, and not so slow that it could not be computed with.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let cruise = |sign: f64| {
            let (cruise, limit) = (self.cruise_towards(sign), self.velocity_towards(sign));
            if cruise > 0.0 { least(limit, largest(LEAST_LIMIT, factor * cruise)) } else { 0.0 }
        };
        Self {
            spec: LimitsSpec {
                max_velocity: cruise(1.0),
                max_velocity_reverse: Some(cruise(-1.0)),
                max_acceleration: self.acceleration(),
                max_deceleration: Some(self.deceleration()),
                max_jerk: self.jerk(),
                ..LimitsSpec::default()
            },
        }
    }

    /// Greatest acceleration while speed grows [axis units/s²].
    #[must_use]
    pub fn acceleration(&self) -> f64 {
        self.spec.max_acceleration
    }

    /// Greatest acceleration while speed shrinks [axis units/s²], a magnitude.
    #[must_use]
    pub fn deceleration(&self) -> f64 {
        self.spec.max_deceleration.unwrap_or(self.spec.max_acceleration)
    }

    /// Greatest jerk [axis units/s³].
    #[must_use]
    pub fn jerk(&self) -> f64 {
        self.spec.max_jerk
    }

    /// Greatest magnitude of the derivative of `order` from 4 on [axis units/s⁴ …]; `None` where none was stated.
    #[must_use]
    pub fn higher(&self, order: usize) -> Option<f64> {
        match order.checked_sub(4)? {
            0 => self.spec.max_snap,
            above => self.spec.max_higher_derivatives.get(above - 1).copied(),
        }
    }

    /// Lowest position [axis units], −∞ where there is no limit.
    #[must_use]
    pub fn min_position(&self) -> f64 {
        self.spec.min_position.unwrap_or(f64::NEG_INFINITY)
    }

    /// Highest position [axis units], ∞ where there is no limit.
    #[must_use]
    pub fn max_position(&self) -> f64 {
        self.spec.max_position.unwrap_or(f64::INFINITY)
    }
}

impl TryFrom<LimitsSpec> for Limits {
    type Error = InvalidFields;

    fn try_from(spec: LimitsSpec) -> Result<Self, InvalidFields> {
        let LimitsSpec {
            max_velocity,
            max_acceleration,
            max_jerk,
            max_deceleration,
            max_velocity_reverse,
            min_position,
            max_position,
            max_snap,
            max_higher_derivatives,
            feed_rate,
        } = &spec;
        if spec == LimitsSpec::default() {
            let what = "max_velocity, max_acceleration and max_jerk";
            return Err(InvalidFields::one(Field::default(), Why::Missing { what }));
        }
        let mut invalid = InvalidFields::default();
        let mut positive = |name, value: Option<f64>| invalid.note(name, value.and_then(not_positive));
        positive("max_velocity", Some(*max_velocity));
        positive("max_acceleration", Some(*max_acceleration));
        positive("max_jerk", Some(*max_jerk));
        positive("max_deceleration", *max_deceleration);
        positive("max_snap", *max_snap);
        positive("feed_rate", *feed_rate);
        for (index, &limit) in max_higher_derivatives.iter().enumerate() {
            if let Some(why) = not_positive(limit) {
                invalid.push(InvalidField::new(Field::element("max_higher_derivatives", index), why));
            }
        }
        let given = max_higher_derivatives.len();
        if given > MAX_HIGHER {
            invalid.note("max_higher_derivatives", Some(Why::OrderUnsupported { given: given + 4 }));
        }
        invalid.note("max_velocity_reverse", max_velocity_reverse.and_then(negative));
        invalid.note("min_position", min_position.and_then(not_finite));
        invalid.note("max_position", max_position.and_then(not_finite));
        if let (Some(min), Some(max)) = (*min_position, *max_position)
            && min > max
        {
            invalid.push(InvalidField::new(Field::named("max_position"), Why::EmptyRange { min, max }));
        }
        invalid.into_result(Self { spec })
    }
}

/// What is wrong with a number that must be finite; nothing if it is.
pub(crate) fn not_finite(given: f64) -> Option<Why> {
    (!is_number(given)).then_some(Why::NotFinite { given })
}

/// Is it finite, and no larger than the planner takes?
#[inline]
pub(crate) fn is_number(given: f64) -> bool {
    // False for NaN.
    given.abs() <= GREATEST_MAGNITUDE
}

/// What is wrong with a number that must be finite and positive; nothing if it is.
pub(crate) fn not_positive(given: f64) -> Option<Why> {
    not_finite(given).or((given < LEAST_LIMIT).then_some(Why::NotPositive { given }))
}

/// What is wrong with a number that must be zero or a positive limit; nothing if it is.
fn negative(given: f64) -> Option<Why> {
    match given {
        0.0 => None,
        below if below < 0.0 => not_finite(given).or(Some(Why::NegativeReverse { given })),
        _ => not_positive(given),
    }
}
