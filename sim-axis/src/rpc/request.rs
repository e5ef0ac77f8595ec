//! From a request on the wire to one that can be run, or to everything that is wrong with it.

use std::time::Duration;

use client::Connect;
use client::failover::DEFAULT_PATIENCE;
use planner::{AxisKind, Plan, wrong_name};
use proto::stream::{DEFAULT_LEAD_CYCLES, LEAD_CYCLES};
use proto::{FieldViolation, Reason, Rejected, pb};

use crate::audit::InvalidField;
use crate::axis::{InvalidConfig, MOST_SETTLE_WINDOW};
use crate::clock::Clock;
use crate::faults::Fault;
use crate::model::{AxisModel, AxisModelSpec};
use crate::models::Models;
use crate::run::{DEFAULT_SETTLE_WINDOW, TrackRequest};

/// The longest that a fault may last.
const LONGEST_FAULT: Duration = Duration::from_secs(60);

/// What is to go wrong.
pub(super) fn fault(wire: pb::InjectFaultRequest) -> Result<Fault, Rejected> {
    use pb::inject_fault_request::Fault as Wire;
    let out_of_range = |field: &str, text: String| Rejected::for_field(field, Reason::ValueOutOfRange, text);
    let lasting = |field: &str, wire: &prost_types::Duration| {
        let seconds = seconds(*wire);
        if proto::malformed_duration(wire).is_none()
            && seconds > 0.0
            && seconds <= LONGEST_FAULT.as_secs_f64()
        {
            return Ok(Duration::from_secs_f64(seconds));
        }
        Err(out_of_range(field, format!("is {seconds} s: a fault lasts more than 0 s and at most 60 s")))
    };
    match wire.fault {
        Some(Wire::StallReads(time)) => Ok(Fault::StallReads(lasting("stall_reads", &time)?)),
        Some(Wire::PauseReports(time)) => Ok(Fault::PauseReports(lasting("pause_reports", &time)?)),
        Some(Wire::DropBatches(0)) => Err(out_of_range("drop_batches", "is 0: lose 1 or more".into())),
        Some(Wire::DropBatches(count)) => Ok(Fault::DropBatches(count)),
        Some(Wire::EffortLimitScale(scale)) if (0.0..=1.0).contains(&scale) => {
            Ok(Fault::EffortLimitScale(scale))
        }
        Some(Wire::EffortLimitScale(scale)) => {
            Err(out_of_range("effort_limit_scale", format!("is {scale}: give a share, 0 to 1")))
        }
        None => {
            let text = "is not set: say what is to go wrong, as stall_reads or drop_batches";
            Err(Rejected::for_field("fault", Reason::FieldMissing, text))
        }
    }
}

/// The run that is asked for, on axes of `own` where the request has no model.
///
/// # Errors
/// Every field that is invalid, with its path and the way out.
pub fn track_request(wire: pb::RunTrackingRequest, own: &Models) -> Result<TrackRequest, Rejected> {
    let pb::RunTrackingRequest {
        stream,
        endpoints,
        plan,
        models,
        lead_cycles,
        virtual_time,
        settle_window,
        settle_tolerance,
        stay_open,
        accept_unproved,
        patience,
        compact,
        spread,
    } = wire;
    let mut faults = Faults::default();
    if let Some(why) = wrong_name(&stream) {
        faults.note("stream", Reason::NameInvalid, why);
    }
    if endpoints.is_empty() {
        let text = "is empty: name at least one planner, as http://127.0.0.1:50051";
        faults.note("endpoints", Reason::FieldMissing, text);
    }
    for (index, endpoint) in endpoints.iter().enumerate() {
        if let Err(error) = client::address(endpoint) {
            faults.note(format!("endpoints[{index}]"), Reason::EndpointInvalid, error);
        }
    }
    let plan = faults.plan(plan);
    let models = faults.models(models, plan.as_ref(), own);
    if lead_cycles != 0 && !LEAD_CYCLES.contains(&lead_cycles) {
        let (least, most) = LEAD_CYCLES.into_inner();
        let text = format!("is {lead_cycles}: hold {least} to {most} cycles, or 0 for {DEFAULT_LEAD_CYCLES}");
        faults.note("lead_cycles", Reason::ValueOutOfRange, text);
    }
    let malformed = settle_window.as_ref().and_then(proto::malformed_duration);
    let settle_window = settle_window.map_or(DEFAULT_SETTLE_WINDOW, seconds);
    if let Some(why) = malformed {
        faults.note("settle_window", Reason::ValueOutOfRange, why);
    } else if !(0.0..=MOST_SETTLE_WINDOW).contains(&settle_window) {
        let text = InvalidConfig::SettleWindow { window: settle_window, most: MOST_SETTLE_WINDOW };
        faults.note("settle_window", Reason::ValueOutOfRange, text);
    }
    if !(settle_tolerance >= 0.0 && settle_tolerance.is_finite()) {
        let reason = if settle_tolerance.is_finite() { Reason::ValueOutOfRange } else { Reason::NotFinite };
        let text = InvalidConfig::SettleTolerance { tolerance: settle_tolerance };
        faults.note("settle_tolerance", reason, text);
    }
    let malformed = patience.as_ref().and_then(proto::malformed_duration);
    let patience = patience.map_or(DEFAULT_PATIENCE.as_secs_f64(), seconds);
    if let Some(why) = malformed {
        faults.note("patience", Reason::ValueOutOfRange, why);
    } else if !(0.0..=MOST_PATIENCE).contains(&patience) {
        let text =
            format!("is {patience} s: give 0 to {MOST_PATIENCE} s, or leave it out for {DEFAULT_PATIENCE:?}");
        faults.note("patience", Reason::ValueOutOfRange, text);
    }
    let plan = faults.none_in(plan)?;
    let plan = proto::accepted("plan", plan)?;
    Ok(TrackRequest {
        stream,
        endpoints,
        plan,
        models,
        clock: if virtual_time { Clock::Virtual } else { Clock::Wall },
        lead_cycles: if lead_cycles == 0 { DEFAULT_LEAD_CYCLES } else { lead_cycles },
        settle_window,
        settle_tolerance: (settle_tolerance > 0.0).then_some(settle_tolerance),
        stay_open,
        accept_unproved,
        compact,
        spread,
        patience: Duration::from_secs_f64(patience),
        connect: Connect::new(),
        faults: None,
    })
}

/// The longest that a planner is looked for \[s\].
const MOST_PATIENCE: f64 = 3600.0;

fn seconds(wire: prost_types::Duration) -> f64 {
    let prost_types::Duration { seconds, nanos } = wire;
    (seconds as f64 * 1e9 + f64::from(nanos)) / 1e9
}

/// Everything that is wrong with a request.
#[derive(Default)]
struct Faults(Vec<FieldViolation>);

impl Faults {
    fn note(&mut self, field: impl Into<String>, reason: Reason, text: impl ToString) {
        self.0.push(FieldViolation::new(field, reason, text.to_string()));
    }

    fn plan(&mut self, wire: Option<pb::Plan>) -> Option<Plan> {
        proto::plan_in("plan", wire).map_err(|rejected| self.0.extend(rejected.fields)).ok()
    }

    /// One model for each axis of the plan, as far as that is known.
    fn models(&mut self, wire: Vec<pb::AxisModel>, plan: Option<&Plan>, own: &Models) -> Vec<AxisModel> {
        let axes = plan.map_or(&[][..], Plan::axes);
        let known = || axes.iter().map(|axis| axis.axis.as_str()).collect::<Vec<_>>().join(", ");
        let mut models: Vec<AxisModel> = Vec::new();
        let mut names: Vec<String> = Vec::new();
        for (index, wire) in wire.into_iter().enumerate() {
            let path = |field: &str| format!("models[{index}].{field}");
            let name = wire.axis.clone();
            let axis = axes.iter().find(|axis| axis.axis == name);
            if plan.is_some() && axis.is_none() {
                let text = format!("no axis is called {name:?}: the plan has {}", known());
                self.note(path("axis"), Reason::UnknownAxis, text);
            } else if names.contains(&name) {
                let text = format!("a model before it is of {name:?} too: send one for each axis");
                self.note(path("axis"), Reason::DuplicateAxis, text);
            }
            let has_pulses = wire.pulses_per_unit != 0.0 && (wire.pulses_per_unit - 1.0).abs() > 0.0;
            if has_pulses && axis.is_some_and(|axis| axis.kind != AxisKind::Pulses) {
                let text =
                    format!("is {}, and the axis is not in pulses: leave it at 0", wire.pulses_per_unit);
                self.note(path("pulses_per_unit"), Reason::ValueOutOfRange, text);
            }
            match AxisModel::try_from(spec(wire, own)) {
                Ok(model) => models.push(model),
                Err(invalid) => {
                    for field in invalid.fields {
                        self.note(path(field.path()), reason(&field), field);
                    }
                }
            }
            names.push(name);
        }
        for (index, axis) in axes.iter().enumerate().filter(|(_, axis)| !names.contains(&axis.axis)) {
            let model = own.of(&axis.axis);
            let pulses = model.spec().pulses_per_unit;
            if (pulses - 1.0).abs() > 0.0 && axis.kind != AxisKind::Pulses {
                let text = format!(
                    "is not in pulses, and the simulator's own model of the axis has {pulses} of them per unit: plan in \
                     pulses, or send a model"
                );
                self.note(format!("plan.axes[{index}].kind"), Reason::ValueOutOfRange, text);
            }
            models.push(model);
        }
        models
    }

    /// `value`, if nothing is wrong.
    fn none_in<T>(self, value: Option<T>) -> Result<T, Rejected> {
        match (Rejected::for_fields(self.0), value) {
            (None, Some(value)) => Ok(value),
            (Some(rejected), _) => Err(rejected),
            (None, None) => Err(Rejected::for_field("plan", Reason::FieldMissing, "is not set: plan again")),
        }
    }
}

/// A model of a request: without a servo, with the one that this process has for the axis.
fn spec(wire: pb::AxisModel, own: &Models) -> AxisModelSpec {
    let has_servo = wire.servo.is_some();
    let spec = AxisModelSpec::from(wire);
    if has_servo {
        return spec;
    }
    let servo = own.servo_of(&spec.axis);
    AxisModelSpec { servo, ..spec }
}

fn reason(field: &InvalidField) -> Reason {
    match field {
        InvalidField::NotFinite { .. } => Reason::NotFinite,
        InvalidField::NotPositive { .. } | InvalidField::OutOfRange { .. } => Reason::ValueOutOfRange,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use pb::mechanics::{Model, TwoMassLoad};

    fn plan() -> pb::Plan {
        let axis = |name: &str| pb::AxisMove {
            axis: name.into(),
            kind: pb::AxisKind::Prismatic.into(),
            start: Some(pb::AxisState::default()),
            goal: Some(pb::AxisState { position: 0.05, ..pb::AxisState::default() }),
            limits: Some(pb::AxisLimits {
                max_velocity: 0.25,
                max_acceleration: 3.0,
                max_jerk: 100.0,
                ..pb::AxisLimits::default()
            }),
        };
        let request = pb::PlanRequest {
            axes: vec![axis("x"), axis("y")],
            synchronization: pb::Synchronization::None.into(),
            ..pb::PlanRequest::default()
        };
        let request = planner::Request::try_from(planner::RequestSpec::from(request)).unwrap();
        proto::plan_to_wire(&planner::Judged::answer(&request).unwrap())
    }

    fn sound() -> pb::RunTrackingRequest {
        pb::RunTrackingRequest {
            stream: "cell-7/xy".into(),
            endpoints: vec!["http://127.0.0.1:50051".into()],
            plan: Some(plan()),
            ..pb::RunTrackingRequest::default()
        }
    }

    fn two_mass(axis: &str, stiffness: f64) -> pb::AxisModel {
        let load = TwoMassLoad { motor_inertia: 12.0, load_inertia: 2.0, stiffness, damping: 5.0 };
        let mechanics = pb::Mechanics { model: Some(Model::TwoMass(load)), friction: None, max_effort: 0.0 };
        pb::AxisModel { axis: axis.into(), mechanics: Some(mechanics), ..pb::AxisModel::default() }
    }

    #[test]
    fn what_is_left_open_is_filled_in() {
        let request = track_request(sound(), &Models::default()).unwrap();
        assert_eq!((request.lead_cycles, request.settle_tolerance), (40, None));
        assert_eq!((request.clock, request.stay_open), (Clock::Wall, false));
        assert_eq!(request.models, [AxisModel::ideal("x"), AxisModel::ideal("y")]);
        assert!((request.settle_window - 0.5).abs() < 1e-15);
        let own = Models::new(vec![AxisModelSpec::flexible(""), AxisModelSpec::ideal("y")]).unwrap();
        let request = track_request(sound(), &own).unwrap();
        assert_eq!(request.models, [AxisModel::flexible("x"), AxisModel::ideal("y")]);
    }

    #[test]
    fn everything_that_is_wrong_is_said_at_once_and_where() {
        let window = prost_types::Duration { seconds: -1, nanos: 0 };
        let request = pb::RunTrackingRequest {
            stream: String::new(),
            endpoints: vec!["http://127.0.0.1:50051".into(), "foo".into()],
            models: vec![
                two_mass("x", 1e5),
                two_mass("y", -1.0),
                two_mass("z", 1e5),
                two_mass("x", 1e5),
                pb::AxisModel { axis: "y".into(), pulses_per_unit: 1000.0, ..pb::AxisModel::default() },
            ],
            lead_cycles: 251,
            settle_window: Some(window),
            settle_tolerance: f64::NAN,
            ..sound()
        };
        let rejected = track_request(request, &Models::default()).unwrap_err();
        let found: Vec<(&str, Reason)> =
            rejected.fields.iter().map(|field| (field.field.as_str(), field.reason)).collect();
        let expected = [
            ("stream", Reason::NameInvalid),
            ("endpoints[1]", Reason::EndpointInvalid),
            ("models[1].mechanics.two_mass.stiffness", Reason::ValueOutOfRange),
            ("models[2].axis", Reason::UnknownAxis),
            ("models[3].axis", Reason::DuplicateAxis),
            ("models[4].axis", Reason::DuplicateAxis),
            ("models[4].pulses_per_unit", Reason::ValueOutOfRange),
            ("lead_cycles", Reason::ValueOutOfRange),
            ("settle_window", Reason::ValueOutOfRange),
            ("settle_tolerance", Reason::NotFinite),
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn a_plan_is_needed_and_has_to_be_one() {
        let without = pb::RunTrackingRequest { plan: None, ..sound() };
        let rejected = track_request(without, &Models::default()).unwrap_err();
        assert_eq!((rejected.fields[0].field.as_str(), rejected.reason), ("plan", Reason::FieldMissing));
        let mut wire = sound();
        wire.plan.as_mut().unwrap().axes[0].kind = 99;
        let rejected = track_request(wire, &Models::default()).unwrap_err();
        assert_eq!(rejected.fields[0].field, "plan.axes[0].kind");
        let mut wire = sound();
        let plan = wire.plan.as_mut().unwrap();
        *plan = pb::Plan { fingerprint: vec![], cycle_count: 0, duration: 0.0, ..plan.clone() };
        plan.axes[1].segments[2].duration += 1.0;
        let rejected = track_request(wire, &Models::default()).unwrap_err();
        assert_eq!((rejected.reason, rejected.metadata["axis"].as_str()), (Reason::PlanRejected, "y"));
        assert_eq!(rejected.fields[0].field, "plan.axes[1].segments");
    }

    #[test]
    fn a_model_in_pulses_of_the_simulators_own_is_not_for_a_plan_in_metres() {
        let own = AxisModelSpec { pulses_per_unit: 1000.0, ..AxisModelSpec::ideal("y") };
        let rejected = track_request(sound(), &Models::new(vec![own]).unwrap()).unwrap_err();
        let field = &rejected.fields[0];
        assert_eq!((field.field.as_str(), field.reason), ("plan.axes[1].kind", Reason::ValueOutOfRange));
    }
}
