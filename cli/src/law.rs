//! Families of profiles by name, and what each is for.

use clap::{Args, ValueEnum};
use planner::Family;

/// A family and its order, as `polynomial:4`; the S-curve by default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Law {
    pub(crate) family: Family,
    pub(crate) order: Option<u32>,
}

impl Law {
    /// Those that Nguyen, Ng and Chen (2008) compare.
    pub(crate) const OF_THE_PAPER: [Self; 4] = [
        Self { family: Family::SCurve, order: None },
        Self { family: Family::Polynomial, order: Some(4) },
        Self { family: Family::Polynomial, order: Some(5) },
        Self { family: Family::Trigonometric, order: None },
    ];

    /// Those, and the baseline: every family.
    pub(crate) const OF_EVERY_FAMILY: [Self; 5] = {
        let [s_curve, fourth, fifth, cosine] = Self::OF_THE_PAPER;
        [Self { family: Family::Trapezoidal, order: None }, s_curve, fourth, fifth, cosine]
    };

    /// The law called `name`.
    pub(crate) fn named(name: &str) -> Result<Self, String> {
        let choices = "s-curve, trapezoidal, polynomial:2 to polynomial:8, trigonometric";
        let (name, order) = match name.split_once(':') {
            Some((name, order)) => (name, Some(order)),
            None => (name, None),
        };
        let family = FamilyName::from_str(name, true).map_err(|_| format!("choose of {choices}"))?;
        match (Family::from(family), order) {
            (Family::Polynomial, None) => Err("say its order as well, as polynomial:4".to_owned()),
            (Family::Polynomial, Some(order)) => {
                // Which orders there are is for the planner to say.
                let order = order
                    .parse()
                    .map_err(|_| format!("{order:?} is no order: give polynomial:2 to polynomial:8"))?;
                Ok(Law { family: Family::Polynomial, order: Some(order) })
            }
            (_, Some(_)) => Err(format!("only a polynomial has an order: choose of {choices}")),
            (family, None) => Ok(Law { family, order: None }),
        }
    }
}

impl std::fmt::Display for Law {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.family, self.order) {
            (Family::SCurve, _) => f.write_str("s-curve"),
            (Family::Trapezoidal, _) => f.write_str("trapezoidal"),
            (Family::Trigonometric, _) => f.write_str("trigonometric"),
            (Family::Polynomial, Some(order)) => write!(f, "polynomial:{order}"),
            (Family::Polynomial, None) => f.write_str("polynomial"),
        }
    }
}

/// The shape of the profile.
#[derive(Debug, Default, Args)]
pub(crate) struct LawFlags {
    /// Shape of the profile; s-curve if not given.
    #[arg(long, value_enum, value_name = "FAMILY", help_heading = "Method")]
    family: Option<FamilyName>,
    /// Order of a polynomial, 2 to 8: its highest limited derivative.
    #[arg(long, value_name = "N", help_heading = "Method")]
    order: Option<u32>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum FamilyName {
    /// Fastest with limited jerk, the usual choice; any velocities at the ends, and a deceleration of its own.
    SCurve,
    /// The baseline: faster, and shakes the machine, as its jerk is not limited.
    Trapezoidal,
    /// Smoother as its --order grows, for what swings; from rest to rest, and needs limits up to the order. Keeps to the smaller of
    /// --max-acceleration and --max-deceleration both ways.
    Polynomial,
    /// Jerk in cosines: about as smooth as order 5 without further limits; from rest to rest. Keeps to the smaller of
    /// --max-acceleration and --max-deceleration both ways.
    Trigonometric,
}

impl From<FamilyName> for Family {
    fn from(name: FamilyName) -> Self {
        match name {
            FamilyName::SCurve => Self::SCurve,
            FamilyName::Trapezoidal => Self::Trapezoidal,
            FamilyName::Polynomial => Self::Polynomial,
            FamilyName::Trigonometric => Self::Trigonometric,
        }
    }
}

impl LawFlags {
    /// What was asked for.
    pub(crate) fn law(&self) -> Law {
        Law { family: self.family.map_or(Family::SCurve, Family::from), order: self.order }
    }
}
