use planner::{AxisPlan, Plan, Quantity, Setpoint};

/// Relative slack on the bounds \[1\], for limits that are kept to 1e-9.
const SLACK: f64 = 1e-6;
/// Units in the last place of the larger of two values that their difference may be off by.
const ULPS: f64 = 4.0;

/// Does one setpoint follow from the one before it, one cycle T later, within what the plan guarantees?
///
/// With jerk at most J over one cycle, acceleration changes by at most JT, and velocity and position differ from their
/// trapezoidal rules by at most the integrals of that bound:
///
/// ```text
/// |Δa| ≤ J·T      |Δv − T·(a₀ + a₁)/2| ≤ J·T²/4      |Δp − T·(v₀ + v₁)/2| ≤ J·T³/12
/// ```
///
/// With no more than acceleration at most A guaranteed, |Δp − T·(v₀ + v₁)/2| ≤ A·T²/4; with nothing guaranteed, any finite
/// setpoint follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JoinRule {
    cycle: f64,
    bound: Bound,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Bound {
    Jerk(f64),
    Acceleration(f64),
    None,
}

impl JoinRule {
    /// One rule for each axis of `plan`, in its order.
    #[must_use]
    pub fn of(plan: &Plan) -> Vec<Self> {
        let cycle = plan.cycle_time().as_seconds();
        let bound = |axis: &AxisPlan| {
            if plan.guarantees(Quantity::Jerk) {
                Bound::Jerk(axis.limits.jerk())
            } else if plan.guarantees(Quantity::Acceleration) {
                Bound::Acceleration(axis.limits.acceleration().max(axis.limits.deceleration()))
            } else {
                Bound::None
            }
        };
        plan.axes().iter().map(|axis| Self { cycle, bound: bound(axis) }).collect()
    }

    /// Does `next` follow from `before`? Never where a number is not finite.
    #[must_use]
    pub fn joins(&self, before: &Setpoint, next: &Setpoint) -> bool {
        let (p, q, t) = (&before.state, &next.state, self.cycle);
        let velocity_off = q.velocity - p.velocity - 0.5 * t * (p.acceleration + q.acceleration);
        let position_off = q.position - p.position - 0.5 * t * (p.velocity + q.velocity);
        let positions = (p.position, q.position);
        match self.bound {
            Bound::Jerk(jerk) => {
                within(q.acceleration - p.acceleration, jerk * t, (p.acceleration, q.acceleration))
                    && within(velocity_off, jerk * t * t / 4.0, (p.velocity, q.velocity))
                    && within(position_off, jerk * t * t * t / 12.0, positions)
            }
            Bound::Acceleration(acceleration) => within(position_off, acceleration * t * t / 4.0, positions),
            Bound::None => next.is_finite(),
        }
    }
}

/// Is `off` within `bound`, where it is a difference of two `values`? Not if it is NaN.
fn within(off: f64, bound: f64, values: (f64, f64)) -> bool {
    let rounding = ULPS * f64::EPSILON * values.0.abs().max(values.1.abs());
    off.abs() <= bound * (1.0 + SLACK) + rounding
}
