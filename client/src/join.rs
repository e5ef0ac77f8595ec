use planner::{AxisPlan, Law, Plan, Profile, Quantity, Setpoint, State};

/// Relative slack on the bounds \[1\], for limits that are kept to 1e-9.
const SLACK: f64 = 1e-6;
/// Units in the last place of the largest value of a whole motion that the difference of two of its values may be off by.
/// A piece begins where the one before it ended, rounded there; so a value near zero carries the roundings of the largest.
const ULPS: f64 = 4.0;

/// Of the roundings of a motion \[1\]: what the pieces of a way to rest may be apart where they join. Ten times what the judge lets
/// pass, 1e-10 of the scale, of which the roundings are four units in the last place.
const MEET: f64 = 10.0 * planner::JOIN_TOLERANCE / (ULPS * f64::EPSILON);

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
///
/// Each is allowed 4 units in the last place of the largest value that its quantity has in the whole motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JoinRule {
    cycle: f64,
    bound: Bound,
    /// What roundings may be worth: of position, velocity and acceleration.
    roundings: State,
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
        let rule = |axis: &AxisPlan| Self { cycle, bound: bound(axis), roundings: roundings(&axis.profile) };
        plan.axes().iter().map(rule).collect()
    }

    /// Does `way` lead from `last` to rest, in pieces that join and with no more jerk than the plan guarantees?
    ///
    /// Where a plan guarantees no jerk its acceleration jumps, and may on the way to rest.
    #[must_use]
    pub(crate) fn rests(&self, last: &Setpoint, way: &Profile) -> bool {
        let mut before = last.state;
        for (index, segment) in way.segments().iter().enumerate() {
            let Law::ConstantJerk(jerk) = segment.law else { return false };
            let within_limit = match self.bound {
                Bound::Jerk(limit) => jerk.abs() <= limit * (1.0 + SLACK),
                Bound::Acceleration(_) | Bound::None => jerk.is_finite(),
            };
            let may_jump = index == 0 && !matches!(self.bound, Bound::Jerk(_));
            if !within_limit || !self.meet(before, segment.start, may_jump) {
                return false;
            }
            before = segment.at(segment.duration).state;
        }
        way.end().is_at_rest() && self.meet(before, way.end(), false)
    }

    /// Are two states one, but for what the judge lets pieces be apart?
    fn meet(&self, one: State, other: State, may_jump: bool) -> bool {
        let near = |one: f64, other: f64, rounding: f64| (one - other).abs() <= MEET * rounding;
        near(one.position, other.position, self.roundings.position)
            && near(one.velocity, other.velocity, self.roundings.velocity)
            && (may_jump || near(one.acceleration, other.acceleration, self.roundings.acceleration))
    }

    /// Does `next` follow from `before`? Never where a number is not finite.
    #[must_use]
    pub fn joins(&self, before: &Setpoint, next: &Setpoint) -> bool {
        let (p, q, t) = (&before.state, &next.state, self.cycle);
        let velocity_off = q.velocity - p.velocity - 0.5 * t * (p.acceleration + q.acceleration);
        let position_off = q.position - p.position - 0.5 * t * (p.velocity + q.velocity);
        match self.bound {
            Bound::Jerk(jerk) => {
                within(q.acceleration - p.acceleration, jerk * t, self.roundings.acceleration)
                    && within(velocity_off, jerk * t * t / 4.0, self.roundings.velocity)
                    && within(position_off, jerk * t * t * t / 12.0, self.roundings.position)
            }
            Bound::Acceleration(acceleration) => {
                within(position_off, acceleration * t * t / 4.0, self.roundings.position)
            }
            Bound::None => next.is_finite(),
        }
    }
}

/// Is `off` within `bound`, but for `rounding`? Not if it is NaN.
fn within(off: f64, bound: f64, rounding: f64) -> bool {
    off.abs() <= bound * (1.0 + SLACK) + rounding
}

fn roundings(profile: &Profile) -> State {
    let mut largest = State::default();
    let mut see = |state: State| {
        largest.position = largest.position.max(state.position.abs());
        largest.velocity = largest.velocity.max(state.velocity.abs());
        largest.acceleration = largest.acceleration.max(state.acceleration.abs());
    };
    see(profile.end());
    for segment in profile.segments() {
        see(segment.start);
        segment.turning_points().into_iter().for_each(|t| see(segment.at(t).state));
    }
    let worth = |value: f64| ULPS * f64::EPSILON * value;
    State {
        position: worth(largest.position),
        velocity: worth(largest.velocity),
        acceleration: worth(largest.acceleration),
    }
}
