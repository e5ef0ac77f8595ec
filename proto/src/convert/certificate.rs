use planner::{
    Binding, Certificate, EndCheck, Explanation, Field, InvalidFields, JoinCheck, LimitCheck, Reversal,
};

use super::choice::{quantity_from_wire, quantity_to_wire};
use crate::pb;

impl From<&Certificate> for pb::PlanCertificate {
    fn from(certificate: &Certificate) -> Self {
        use pb::plan_certificate as wire;
        let Certificate { limits, joins, ends, reversals } = certificate;
        Self {
            limit_checks: limits
                .iter()
                .map(|check| {
                    let LimitCheck {
                        axis,
                        quantity,
                        limit,
                        extremum,
                        at_time,
                        margin,
                        guaranteed,
                        led_back_by,
                    } = check;
                    wire::LimitCheck {
                        axis: axis.to_string(),
                        quantity: quantity_to_wire(*quantity),
                        limit: *limit,
                        extremum: *extremum,
                        at_time: *at_time,
                        margin: *margin,
                        guaranteed: *guaranteed,
                        led_back_by: *led_back_by,
                    }
                })
                .collect(),
            continuity_checks: joins
                .iter()
                .map(|JoinCheck { axis, quantity, worst_jump, allowed, at_time, guaranteed }| {
                    wire::ContinuityCheck {
                        axis: axis.to_string(),
                        quantity: quantity_to_wire(*quantity),
                        worst_jump: *worst_jump,
                        at_time: *at_time,
                        allowed: *allowed,
                        guaranteed: *guaranteed,
                    }
                })
                .collect(),
            end_checks: ends
                .iter()
                .map(|EndCheck { axis, quantity, residual, allowed }| wire::EndCheck {
                    axis: axis.to_string(),
                    quantity: quantity_to_wire(*quantity),
                    residual: *residual,
                    allowed: *allowed,
                })
                .collect(),
            passed: certificate.passed(),
            reversals: reversals
                .iter()
                .map(|Reversal { axis, at_time, position }| wire::Reversal {
                    axis: axis.to_string(),
                    at_time: *at_time,
                    position: *position,
                })
                .collect(),
        }
    }
}

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

impl From<&Explanation> for pb::PlanExplanation {
    fn from(explanation: &Explanation) -> Self {
        let Explanation { critical_axis, bindings } = explanation;
        Self {
            critical_axis: critical_axis.clone(),
            bindings: bindings
                .iter()
                .map(|Binding { axis, quantity, from_time, to_time }| pb::plan_explanation::Binding {
                    axis: axis.clone(),
                    quantity: quantity_to_wire(*quantity),
                    from_time: *from_time,
                    to_time: *to_time,
                })
                .collect(),
        }
    }
}
