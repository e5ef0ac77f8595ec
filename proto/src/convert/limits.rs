use planner::LimitsSpec;

use crate::pb;

impl From<pb::AxisLimits> for LimitsSpec {
    fn from(wire: pb::AxisLimits) -> Self {
        let pb::AxisLimits {
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
        } = wire;
        Self {
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
        }
    }
}

impl From<LimitsSpec> for pb::AxisLimits {
    fn from(spec: LimitsSpec) -> Self {
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
        } = spec;
        Self {
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
        }
    }
}
