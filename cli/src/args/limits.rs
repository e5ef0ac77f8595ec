use clap::Args;
use planner::LimitsSpec;

use crate::failure::Failure;
use crate::law::Law;

/// What an axis may do.
#[derive(Debug, Default, Args)]
pub(crate) struct LimitFlags {
    /// Greatest speed [u/s].
    #[arg(long, value_name = "U/S", help_heading = "Limits")]
    #[arg(required_unless_present = "files")]
    max_velocity: Option<f64>,
    /// Greatest acceleration while speed grows [u/s²].
    #[arg(long, value_name = "U/S²", help_heading = "Limits")]
    #[arg(required_unless_present = "files")]
    max_acceleration: Option<f64>,
    /// Greatest jerk [u/s³]; a family of order 2 keeps none and can do without, any other needs it.
    #[arg(long, value_name = "U/S³", help_heading = "Limits")]
    max_jerk: Option<f64>,
    /// Greatest acceleration while speed shrinks [u/s²]; as --max-acceleration if not given.
    #[arg(long, value_name = "U/S²", help_heading = "Limits")]
    max_deceleration: Option<f64>,
    /// Speed to cruise at [u/s], at most --max-velocity, which it is if not given.
    #[arg(long, value_name = "U/S", help_heading = "Limits")]
    feed_rate: Option<f64>,
    /// Greatest speed towards falling positions [u/s], 0 forbids it; as --max-velocity if not given.
    #[arg(long, value_name = "U/S", help_heading = "Limits")]
    max_velocity_reverse: Option<f64>,
    /// Least position [u]; none if not given.
    #[arg(long, value_name = "U", help_heading = "Limits")]
    min_position: Option<f64>,
    /// Greatest position [u]; none if not given.
    #[arg(long, value_name = "U", help_heading = "Limits")]
    max_position: Option<f64>,
}

impl LimitFlags {
    /// Refuses flags without a jerk, where `law` keeps one.
    pub(crate) fn check_jerk(&self, law: Law) -> Result<(), Failure> {
        let keeps_none = law.family.order().or(law.order) == Some(2);
        if keeps_none || self.max_jerk.is_some() {
            return Ok(());
        }
        let text = format!("--max-jerk is missing: {law} keeps a limit of jerk, so give the greatest [u/s³]");
        Err(Failure::Usage(text))
    }

    /// The limits that the flags stand for; nothing but clap has checked them.
    pub(crate) fn to_spec(&self) -> LimitsSpec {
        LimitsSpec {
            max_velocity: self.max_velocity.unwrap_or_default(),
            max_acceleration: self.max_acceleration.unwrap_or_default(),
            max_jerk: self.max_jerk.unwrap_or_default(),
            max_deceleration: self.max_deceleration,
            max_velocity_reverse: self.max_velocity_reverse,
            min_position: self.min_position,
            max_position: self.max_position,
            feed_rate: self.feed_rate,
            ..LimitsSpec::default()
        }
    }
}

/// What polynomials need of an axis as well.
#[derive(Debug, Default, Args)]
pub(crate) struct HigherLimitFlags {
    /// Greatest snap, the fourth derivative [u/s⁴]; needed by polynomials of order 4 and up.
    #[arg(long, value_name = "U/S⁴", help_heading = "Limits")]
    max_snap: Option<f64>,
    /// Greatest fifth, sixth ... derivative in turn [u/s⁵ ...]; needed by polynomials of order 5 and up.
    #[arg(long, value_name = "U/S⁵", num_args = 1.., help_heading = "Limits")]
    max_higher_derivatives: Vec<f64>,
}

impl HigherLimitFlags {
    /// `limits` with those of higher orders.
    pub(crate) fn beside(&self, limits: &LimitFlags) -> LimitsSpec {
        LimitsSpec {
            max_snap: self.max_snap,
            max_higher_derivatives: self.max_higher_derivatives.clone(),
            ..limits.to_spec()
        }
    }
}
