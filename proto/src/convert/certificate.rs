use planner::{Certificate, EndCheck, Field, InvalidFields, JoinCheck, LimitCheck, Reversal};

use super::choice::quantity_from_wire;
use crate::pb;

impl TryFrom<pb::PlanCertificate> for Certificate {
    type Error = InvalidFields;

    fn try_from(wire: pb::PlanCertificate) -> Result<Self, InvalidFields> {
        use pb::plan_certificate as wire;
        // Whether it passed follows from the checks.
        let pb::PlanCertificate { limit_checks, continuity_checks, end_checks, passed: _, reversals } = wire;
        let quantity = |list: &str, index: usize, given: i32| {
            let field = Field::named("quantity").within(&Field::element(list, index));
            quantity_from_wire(given).map_err(|why| InvalidFields::one(field, why))
        };
        let mut certificate = Self::default();
        for (index, check) in limit_checks.into_iter().enumerate() {
            let wire::LimitCheck {
                axis,
                quantity: given,
                limit,
                extremum,
                at_time,
                margin,
                guaranteed,
                led_back_by,
            } = check;
            let quantity = quantity("limit_checks", index, given)?;
            let check = LimitCheck {
                axis: axis.into(),
                quantity,
                limit,
                extremum,
                at_time,
                margin,
                guaranteed,
                led_back_by,
            };
            certificate.limits.push(check);
        }
        for (index, check) in continuity_checks.into_iter().enumerate() {
            let wire::ContinuityCheck { axis, quantity: given, worst_jump, at_time, allowed, guaranteed } =
                check;
            let quantity = quantity("continuity_checks", index, given)?;
            certificate.joins.push(JoinCheck {
                axis: axis.into(),
                quantity,
                worst_jump,
                allowed,
                at_time,
                guaranteed,
            });
        }
        for (index, check) in end_checks.into_iter().enumerate() {
            let wire::EndCheck { axis, quantity: given, residual, allowed } = check;
            let quantity = quantity("end_checks", index, given)?;
            certificate.ends.push(EndCheck { axis: axis.into(), quantity, residual, allowed });
        }
        let reversal =
            |wire::Reversal { axis, at_time, position }| Reversal { axis: axis.into(), at_time, position };
        certificate.reversals = reversals.into_iter().map(reversal).collect();
        Ok(certificate)
    }
}
