//! The identity of a plan.

use prost::encoding::{double, int32, message, string, uint32, uint64};
use xxhash_rust::xxh3::Xxh3;

use crate::pb::Plan;

/// Identity of `plan`, not protection: XXH3-128, seed 0, of its encoding without the field `fingerprint`, in
/// the algorithm's canonical byte order (big-endian).
///
/// The encoding has every field once, in the order of the field numbers, numbers packed, and fields without
/// presence left out at their default, as the common implementations write it when asked for a deterministic form.
/// A negative zero counts as the default here; some write it, so send none. Fields that this version does not
/// know are not counted.
#[must_use]
pub fn fingerprint(plan: &Plan) -> [u8; 16] {
    let Plan {
        // Its own.
        fingerprint: _,
        planner_version,
        evaluation_version,
        method,
        guaranteed,
        cycle_time,
        cycle_count,
        duration,
        axes,
        certificate,
        explanation,
    } = plan;
    let mut hasher = Xxh3::new();
    let mut bytes = Vec::new();
    if !planner_version.is_empty() {
        string::encode(2, planner_version, &mut bytes);
    }
    if let Some(cycle_time) = cycle_time {
        message::encode(3, cycle_time, &mut bytes);
    }
    if *cycle_count != 0 {
        uint64::encode(4, cycle_count, &mut bytes);
    }
    if *duration != 0.0 {
        double::encode(5, duration, &mut bytes);
    }
    // One axis at a time into the same place, since all of them may be many megabytes.
    for axis in axes {
        message::encode(6, axis, &mut bytes);
        hasher.update(&bytes);
        bytes.clear();
    }
    if let Some(certificate) = certificate {
        message::encode(7, certificate, &mut bytes);
    }
    if let Some(explanation) = explanation {
        message::encode(8, explanation, &mut bytes);
    }
    if *evaluation_version != 0 {
        uint32::encode(9, evaluation_version, &mut bytes);
    }
    if let Some(method) = method {
        message::encode(10, method, &mut bytes);
    }
    int32::encode_packed(11, guaranteed, &mut bytes);
    hasher.update(&bytes);
    hasher.digest128().to_be_bytes()
}

#[cfg(test)]
mod tests {
    use prost::Message as _;
    use xxhash_rust::xxh3::xxh3_128;

    use super::*;
    use crate::pb;

    fn plan() -> Plan {
        Plan {
            planner_version: "0.1.0".into(),
            evaluation_version: 1,
            guaranteed: vec![pb::Quantity::Velocity.into(), pb::Quantity::Jerk.into()],
            cycle_time: Some(prost_types::Duration { seconds: 0, nanos: 1_000_000 }),
            cycle_count: 5000,
            duration: 5.0,
            axes: vec![pb::AxisPlan {
                axis: "x".into(),
                kind: pb::AxisKind::Prismatic.into(),
                segments: vec![pb::AxisSegment {
                    duration: 1.0,
                    start: Some(pb::AxisState { position: 0.1, velocity: 0.0, acceleration: -2.5 }),
                    law: Some(pb::axis_segment::Law::Jerk(0.0)),
                }],
                ..Default::default()
            }],
            ..Default::default()
        }
    }

    #[test]
    fn fingerprint_is_of_the_plan_without_itself() {
        let bare = plan();
        let mut cleared = plan();
        cleared.fingerprint = fingerprint(&bare).to_vec();
        assert_eq!(fingerprint(&cleared), fingerprint(&bare));
        cleared.fingerprint = vec![1; 300];
        assert_eq!(fingerprint(&cleared), fingerprint(&bare));
    }

    #[test]
    fn fingerprint_is_of_the_whole_encoding() {
        let axis = pb::AxisPlan { axis: "y".into(), ..plan().axes.remove(0) };
        let every = Plan {
            method: Some(pb::PlanMethod { order: 3, ..Default::default() }),
            certificate: Some(pb::PlanCertificate { passed: true, ..Default::default() }),
            explanation: Some(pb::PlanExplanation { critical_axis: "y".into(), ..Default::default() }),
            axes: [plan().axes, vec![axis]].concat(),
            ..plan()
        };
        for plan in [every, plan(), Plan::default(), Plan { duration: -0.0, ..Plan::default() }] {
            assert_eq!(fingerprint(&plan), xxh3_128(&plan.encode_to_vec()).to_be_bytes());
        }
    }

    #[test]
    fn other_plans_have_other_fingerprints() {
        let mut other = plan();
        other.axes[0].segments[0].law = None;
        assert_ne!(fingerprint(&other), fingerprint(&plan()));
    }

    #[test]
    fn fingerprint_is_that_of_other_implementations() {
        // Google's Python runtime encoded the plan of `vectors/fingerprint.json`, and PyPI's xxhash hashed it.
        let vector: serde_json::Value =
            serde_json::from_str(include_str!("../vectors/fingerprint.json")).unwrap();
        let plan: Plan = crate::from_json(&vector["plan"].to_string()).unwrap();
        let hex: String = fingerprint(&plan).iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(plan, self::plan());
        assert_eq!(vector["fingerprint"], hex);
    }
}
