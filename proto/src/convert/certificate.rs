use planner::{Binding, Certificate, EndCheck, Explanation, JoinCheck, LimitCheck};

use super::choice::quantity_to_wire;
use crate::pb;

// One way only: whoever gets a certificate has the plan, and judges for itself.
impl From<&Certificate> for pb::PlanCertificate {
    fn from(certificate: &Certificate) -> Self {
        use pb::plan_certificate as wire;
        let Certificate { limits, joins, ends } = certificate;
        Self {
            limit_checks: limits
                .iter()
                .map(|LimitCheck { axis, quantity, limit, extremum, at_time, margin, guaranteed }| {
                    wire::LimitCheck {
                        axis: axis.clone(),
                        quantity: quantity_to_wire(*quantity),
                        limit: *limit,
                        extremum: *extremum,
                        at_time: *at_time,
                        margin: *margin,
                        guaranteed: *guaranteed,
                    }
                })
                .collect(),
            continuity_checks: joins
                .iter()
                .map(|JoinCheck { axis, quantity, worst_jump, allowed: _, at_time, guaranteed: _ }| {
                    wire::ContinuityCheck {
                        axis: axis.clone(),
                        quantity: quantity_to_wire(*quantity),
                        worst_jump: *worst_jump,
                        at_time: *at_time,
                    }
                })
                .collect(),
            end_checks: ends
                .iter()
                .map(|EndCheck { axis, quantity, residual, allowed: _ }| wire::EndCheck {
                    axis: axis.clone(),
                    quantity: quantity_to_wire(*quantity),
                    residual: *residual,
                })
                .collect(),
            passed: certificate.passed(),
        }
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
