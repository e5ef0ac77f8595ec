//! Both directions of each message stand side by side, and every field is taken apart by name.

use std::time::Duration;

use client::failover::{Cause, Change};
use pb::mechanics::{self, Model};
use proto::stream::Columns;
use proto::{Digest, Rejected, pb};

use crate::jitter::Jitter;
use crate::model::{AxisModelSpec, EncoderSpec, FrictionSpec, LoadSpec, MechanicsSpec, ServoSpec};
use crate::monitor::ReportCard;
use crate::run::{StreamReport, TrackingReport};
use crate::samples::Samples;

impl From<pb::AxisModel> for AxisModelSpec {
    /// What is unset is ideal, exact, or to be tuned.
    fn from(wire: pb::AxisModel) -> Self {
        let pb::AxisModel { axis, mechanics, servo, encoder, noise_seed, pulses_per_unit } = wire;
        Self {
            axis,
            mechanics: mechanics.map_or_else(MechanicsSpec::default, Into::into),
            servo: servo.map_or(ServoSpec::UNSET, Into::into),
            encoder: encoder.map_or_else(EncoderSpec::default, Into::into),
            noise_seed,
            pulses_per_unit,
        }
    }
}

impl From<AxisModelSpec> for pb::AxisModel {
    fn from(spec: AxisModelSpec) -> Self {
        let AxisModelSpec { axis, mechanics, servo, encoder, noise_seed, pulses_per_unit } = spec;
        Self {
            axis,
            mechanics: Some(mechanics.into()),
            servo: Some(servo.into()),
            encoder: Some(encoder.into()),
            noise_seed,
            pulses_per_unit,
        }
    }
}

impl From<pb::Mechanics> for MechanicsSpec {
    fn from(wire: pb::Mechanics) -> Self {
        let pb::Mechanics { model, friction, max_effort } = wire;
        let load = match model {
            None | Some(Model::Ideal(mechanics::IdealFollower {})) => LoadSpec::Ideal,
            Some(Model::Rigid(mechanics::RigidLoad { inertia })) => LoadSpec::Rigid { inertia },
            Some(Model::TwoMass(mechanics::TwoMassLoad {
                motor_inertia,
                load_inertia,
                stiffness,
                damping,
            })) => LoadSpec::TwoMass { motor_inertia, load_inertia, stiffness, damping },
            Some(Model::Prescribed(mechanics::PrescribedMotor { load_inertia, stiffness, damping })) => {
                LoadSpec::Prescribed { load_inertia, stiffness, damping }
            }
        };
        Self { load, friction: friction.map_or_else(FrictionSpec::default, Into::into), max_effort }
    }
}

impl From<MechanicsSpec> for pb::Mechanics {
    fn from(spec: MechanicsSpec) -> Self {
        let MechanicsSpec { load, friction, max_effort } = spec;
        let model = match load {
            LoadSpec::Ideal => Model::Ideal(mechanics::IdealFollower {}),
            LoadSpec::Rigid { inertia } => Model::Rigid(mechanics::RigidLoad { inertia }),
            LoadSpec::TwoMass { motor_inertia, load_inertia, stiffness, damping } => {
                Model::TwoMass(mechanics::TwoMassLoad { motor_inertia, load_inertia, stiffness, damping })
            }
            LoadSpec::Prescribed { load_inertia, stiffness, damping } => {
                Model::Prescribed(mechanics::PrescribedMotor { load_inertia, stiffness, damping })
            }
        };
        Self { model: Some(model), friction: Some(friction.into()), max_effort }
    }
}

impl From<mechanics::Friction> for FrictionSpec {
    fn from(wire: mechanics::Friction) -> Self {
        let mechanics::Friction { coulomb, viscous, static_friction, stribeck_velocity } = wire;
        Self { coulomb, viscous, static_friction, stribeck_velocity }
    }
}

impl From<FrictionSpec> for mechanics::Friction {
    fn from(spec: FrictionSpec) -> Self {
        let FrictionSpec { coulomb, viscous, static_friction, stribeck_velocity } = spec;
        Self { coulomb, viscous, static_friction, stribeck_velocity }
    }
}

impl From<pb::Servo> for ServoSpec {
    fn from(wire: pb::Servo) -> Self {
        let pb::Servo {
            position_gain,
            velocity_gain,
            velocity_integral_time,
            current_loop_bandwidth,
            velocity_feedforward,
            acceleration_feedforward,
            substep,
            command_delay,
        } = wire;
        Self {
            position_gain,
            velocity_gain,
            velocity_integral_time,
            current_loop_bandwidth,
            velocity_feedforward,
            acceleration_feedforward,
            substep,
            command_delay,
        }
    }
}

impl From<ServoSpec> for pb::Servo {
    fn from(spec: ServoSpec) -> Self {
        let ServoSpec {
            position_gain,
            velocity_gain,
            velocity_integral_time,
            current_loop_bandwidth,
            velocity_feedforward,
            acceleration_feedforward,
            substep,
            command_delay,
        } = spec;
        Self {
            position_gain,
            velocity_gain,
            velocity_integral_time,
            current_loop_bandwidth,
            velocity_feedforward,
            acceleration_feedforward,
            substep,
            command_delay,
        }
    }
}

impl From<pb::Encoder> for EncoderSpec {
    fn from(wire: pb::Encoder) -> Self {
        let pb::Encoder { resolution } = wire;
        Self { resolution }
    }
}

impl From<EncoderSpec> for pb::Encoder {
    fn from(spec: EncoderSpec) -> Self {
        let EncoderSpec { resolution } = spec;
        Self { resolution }
    }
}

impl TryFrom<pb::TrackingSamples> for Samples {
    type Error = Rejected;

    fn try_from(wire: pb::TrackingSamples) -> Result<Self, Rejected> {
        let pb::TrackingSamples { first_cycle, commanded, tracking, load_position } = wire;
        Ok(Self {
            first_cycle,
            commanded: Columns::try_from(commanded.unwrap_or_default())?,
            tracking: tracking.unwrap_or_default().into(),
            load_position,
        })
    }
}

impl From<Samples> for pb::TrackingSamples {
    fn from(samples: Samples) -> Self {
        let Samples { first_cycle, commanded, tracking, load_position } = samples;
        Self {
            first_cycle,
            commanded: Some(commanded.into()),
            tracking: Some(tracking.into()),
            load_position,
        }
    }
}

impl From<pb::TrackingReport> for TrackingReport {
    fn from(wire: pb::TrackingReport) -> Self {
        let pb::TrackingReport { axes, stream } = wire;
        Self { axes: axes.into_iter().map(Into::into).collect(), stream: stream.unwrap_or_default().into() }
    }
}

impl From<TrackingReport> for pb::TrackingReport {
    fn from(report: TrackingReport) -> Self {
        let TrackingReport { axes, stream } = report;
        Self { axes: axes.into_iter().map(Into::into).collect(), stream: Some(stream.into()) }
    }
}

impl From<pb::AxisReportCard> for ReportCard {
    fn from(wire: pb::AxisReportCard) -> Self {
        let pb::AxisReportCard {
            axis,
            max_following_error,
            max_following_error_time,
            rms_following_error,
            overshoot,
            settling_time,
            residual_vibration_amplitude,
            residual_vibration_frequency,
            max_effort,
            effort_saturated_time,
        } = wire;
        Self {
            axis,
            max_following_error,
            max_following_error_time,
            rms_following_error,
            overshoot,
            settling_time,
            residual_vibration_amplitude,
            // No vibration has frequency 0.
            residual_vibration_frequency: (residual_vibration_frequency != 0.0)
                .then_some(residual_vibration_frequency),
            max_effort,
            effort_saturated_time,
        }
    }
}

impl From<ReportCard> for pb::AxisReportCard {
    fn from(card: ReportCard) -> Self {
        let ReportCard {
            axis,
            max_following_error,
            max_following_error_time,
            rms_following_error,
            overshoot,
            settling_time,
            residual_vibration_amplitude,
            residual_vibration_frequency,
            max_effort,
            effort_saturated_time,
        } = card;
        Self {
            axis,
            max_following_error,
            max_following_error_time,
            rms_following_error,
            overshoot,
            settling_time,
            residual_vibration_amplitude,
            residual_vibration_frequency: residual_vibration_frequency.unwrap_or(0.0),
            max_effort,
            effort_saturated_time,
        }
    }
}

impl From<pb::StreamReportCard> for StreamReport {
    fn from(wire: pb::StreamReportCard) -> Self {
        let pb::StreamReportCard {
            cycles_executed,
            counters,
            failovers,
            p50_cycle_jitter,
            p99_cycle_jitter,
            max_cycle_jitter,
            digest,
            stop_tail_used,
            revisions,
        } = wire;
        Self {
            cycles_executed,
            counters: counters.unwrap_or_default().into(),
            failovers,
            revisions,
            jitter: Jitter { p50: p50_cycle_jitter, p99: p99_cycle_jitter, max: max_cycle_jitter },
            digest: Digest::from(digest),
            stop_tail_used,
        }
    }
}

impl From<StreamReport> for pb::StreamReportCard {
    fn from(report: StreamReport) -> Self {
        let StreamReport { cycles_executed, counters, failovers, revisions, jitter, digest, stop_tail_used } =
            report;
        let Jitter { p50, p99, max } = jitter;
        Self {
            cycles_executed,
            counters: Some(counters.into()),
            failovers,
            p50_cycle_jitter: p50,
            p99_cycle_jitter: p99,
            max_cycle_jitter: max,
            digest: u64::from(digest),
            stop_tail_used,
            revisions,
        }
    }
}

/// Another planner goes on, on the wire.
pub(super) fn change_to_wire(change: Change) -> pb::FailOver {
    let Change { cause, from, to, executed_cycle, took } = change;
    pb::FailOver { cause: cause.name().into(), from, to, executed_cycle, took: took.as_secs_f64() }
}

/// `None` for a cause of a newer simulator.
pub(super) fn change_from_wire(wire: pb::FailOver) -> Option<Change> {
    let pb::FailOver { cause, from, to, executed_cycle, took } = wire;
    let cause = Cause::ALL.into_iter().find(|known| known.name() == cause)?;
    let took = Duration::try_from_secs_f64(took).unwrap_or_default();
    Some(Change { cause, from, to, executed_cycle, took })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proto::stream::{Counters, Tracking};

    fn any_load() -> impl Strategy<Value = LoadSpec> {
        let numbers = any::<[f64; 4]>();
        prop_oneof![
            Just(LoadSpec::Ideal),
            numbers.prop_map(|[inertia, ..]| LoadSpec::Rigid { inertia }),
            numbers.prop_map(|[motor_inertia, load_inertia, stiffness, damping]| LoadSpec::TwoMass {
                motor_inertia,
                load_inertia,
                stiffness,
                damping
            }),
            numbers.prop_map(|[load_inertia, stiffness, damping, _]| LoadSpec::Prescribed {
                load_inertia,
                stiffness,
                damping
            }),
        ]
    }

    proptest! {
        #[test]
        fn models_come_back_as_they_were(
            load in any_load(), n in any::<[f64; 14]>(), noise_seed: u64, pulses_per_unit: f64,
        ) {
            let [coulomb, viscous, static_friction, stribeck_velocity, max_effort, resolution, ..] = n;
            let [.., kp, kv, tn, bandwidth, kvff, kaff, substep, command_delay] = n;
            let spec = AxisModelSpec {
                axis: "x".into(),
                mechanics: MechanicsSpec {
                    load,
                    friction: FrictionSpec { coulomb, viscous, static_friction, stribeck_velocity },
                    max_effort,
                },
                servo: ServoSpec {
                    position_gain: kp,
                    velocity_gain: kv,
                    velocity_integral_time: tn,
                    current_loop_bandwidth: bandwidth,
                    velocity_feedforward: kvff,
                    acceleration_feedforward: kaff,
                    substep,
                    command_delay,
                },
                encoder: EncoderSpec { resolution },
                noise_seed,
                pulses_per_unit,
            };
            prop_assert_eq!(AxisModelSpec::from(pb::AxisModel::from(spec.clone())), spec);
        }

        #[test]
        fn reports_come_back_as_they_were(
            n in any::<[f64; 10]>(), settling_time: Option<f64>, c in any::<[u64; 10]>(), stop_tail_used: bool,
        ) {
            let card = ReportCard {
                axis: "x".into(),
                max_following_error: n[0],
                max_following_error_time: n[1],
                rms_following_error: n[2],
                overshoot: n[3],
                settling_time,
                residual_vibration_amplitude: n[4],
                residual_vibration_frequency: (n[5] != 0.0).then_some(n[5]),
                max_effort: n[6],
                effort_saturated_time: n[7],
            };
            let report = TrackingReport {
                axes: vec![card],
                stream: StreamReport {
                    cycles_executed: c[0],
                    counters: Counters {
                        underruns: c[1],
                        duplicate_cycles: c[2],
                        refused_batches: c[3],
                        stale_epochs: c[4],
                        least_lead_cycles: c[5],
                        late_cycles: c[6],
                    },
                    failovers: c[7],
                    revisions: c[9],
                    jitter: Jitter { p50: n[7], p99: n[8], max: n[9] },
                    digest: Digest::from(c[8]),
                    stop_tail_used,
                },
            };
            prop_assert_eq!(TrackingReport::from(pb::TrackingReport::from(report.clone())), report);
        }

        #[test]
        fn samples_come_back_as_they_were(first_cycle: u64, numbers in proptest::collection::vec(any::<f64>(), 0..6)) {
            let columns = std::array::from_fn(|_| numbers.clone());
            let Some(commanded) = Columns::from_parts(numbers.len(), columns) else { return Ok(()) };
            let samples = Samples {
                first_cycle,
                commanded,
                tracking: Tracking {
                    first_cycle,
                    cycles: numbers.len() as u32,
                    measured_position: numbers.clone(),
                    following_error: numbers.clone(),
                    cycle_jitter_ns: vec![7; numbers.len()],
                },
                load_position: numbers,
            };
            prop_assert_eq!(Samples::try_from(pb::TrackingSamples::from(samples.clone())), Ok(samples));
        }
    }
}
