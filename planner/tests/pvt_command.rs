//! One command of position, velocity and time: four hundred of them solved at sixty digits.

#![allow(clippy::float_cmp, reason = "what is kept is kept to the last bit")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use planner::{
    AdjustmentReason, InvalidFields, Limits, LimitsSpec, PvtMove, PvtPlanner, PvtPolicy, PvtTarget, Quantity,
    State, Why, violations,
};
use serde::Deserialize;

#[derive(Deserialize)]
struct Record {
    input: Input,
    expected: Expected,
}

#[derive(Deserialize)]
struct Input {
    v_start: f64,
    v_end: f64,
    displacement: f64,
    duration: f64,
    a_max: f64,
    j_max: f64,
    v_min: f64,
    v_max: f64,
}

#[derive(Deserialize)]
struct Expected {
    feasible: bool,
    reason: Option<String>,
    s_min: Option<f64>,
    s_max: Option<f64>,
    region: Option<String>,
    v_cruise: Option<f64>,
    #[serde(default)]
    phases: Vec<[f64; 3]>,
    peak_jerk: Option<f64>,
    peak_acceleration: Option<f64>,
    closest_v_end: Option<f64>,
    extended_duration: Option<f64>,
    reachable_v_end: Option<f64>,
}

/// Of the scale of each quantity.
const TOLERANCE: f64 = 1e-12;

/// Where the displacement is just beyond an extreme, and the record's duration is of a second window: the axis goes on and comes
/// back. The first window begins a little after the duration asked for, with motions that are legal, as the judge says. Each with the
/// least time at which the displacement lies between the extremes of note 0008, computed at sixty digits.
const LATE: [(&str, f64); 4] = [
    ("record 114", 0.196_240_059_949_644_57),
    ("record 177", 0.079_753_855_230_977_8),
    ("record 200", 0.002_384_630_140_837_383),
    ("record 281", 0.026_128_166_349_611_995),
];

impl Input {
    fn limits(&self) -> Limits {
        let spec = LimitsSpec {
            max_velocity: self.v_max,
            max_velocity_reverse: Some(-self.v_min),
            max_acceleration: self.a_max,
            max_jerk: self.j_max,
            ..LimitsSpec::default()
        };
        spec.try_into().unwrap()
    }

    fn start(&self) -> State {
        State { velocity: self.v_start, ..State::default() }
    }

    fn plan(&self, policy: PvtPolicy) -> Result<PvtMove, InvalidFields> {
        let target = PvtTarget { position: self.displacement, velocity: self.v_end, duration: self.duration };
        PvtPlanner::new(self.start(), self.limits(), policy)?.command(target)
    }

    fn fastest(&self) -> f64 {
        self.v_max.max(-self.v_min)
    }
}

#[track_caller]
fn close(name: &str, given: f64, expected: f64, scale: f64) {
    assert!((given - expected).abs() <= TOLERANCE * scale, "{name}: {given}, expected {expected}");
}

/// A ramp, a cruise, a ramp, as [duration, from, to]; a part that does not change the velocity is part of the cruise.
fn phases(planned: &PvtMove) -> Vec<[f64; 3]> {
    let mut phases: Vec<[f64; 3]> = Vec::new();
    let mut open = false;
    for segment in planned.motion().segments() {
        let end = segment.end();
        let setpoint = segment.at(0.0);
        let begins = setpoint.state.acceleration == 0.0 || !open;
        if begins {
            phases.push([0.0, segment.start.velocity, 0.0]);
        }
        let last = phases.last_mut().unwrap();
        last[0] += segment.duration;
        last[2] = end.velocity;
        open = setpoint.jerk != 0.0 || setpoint.state.acceleration != 0.0;
    }
    phases
}

impl Record {
    fn check(&self, name: &str) {
        let Self { input, expected } = self;
        let scale = input.fastest() * input.duration;
        if let Some(reachable) = expected.reachable_v_end {
            assert_eq!(expected.reason.as_deref(), Some("time_too_short_for_velocity_change"));
            let planned = input.plan(PvtPolicy::PreferVelocity).unwrap();
            close(name, planned.motion().reached().velocity, reachable, input.fastest());
            let said = planned.motion().adjustments();
            assert!(said.iter().any(|said| said.quantity == Quantity::Velocity
                && said.reason == AdjustmentReason::PvtTimeTooShort));
            self.legal(name, &planned);
            let refusal = input.plan(PvtPolicy::Reject).unwrap_err();
            let Why::PvtTimeTooShort { given, duration, offers } = &refusal.as_slice()[0].why else {
                panic!("{name}: {refusal}")
            };
            assert_eq!((*given, *duration), (input.v_end, input.duration), "{name}");
            close(name, offers.nearest.unwrap().velocity, reachable, input.fastest());
            return;
        }
        let (low, high) = (expected.s_min.unwrap(), expected.s_max.unwrap());
        let planned = input.plan(PvtPolicy::PreferVelocity).unwrap();
        close(name, planned.least_displacement(), low, scale);
        close(name, planned.greatest_displacement(), high, scale);
        self.legal(name, &planned);
        if expected.feasible {
            assert_eq!(planned.motion().adjustments(), [], "{name}");
            self.check_shape(name, &planned);
            for policy in [PvtPolicy::PreferPosition, PvtPolicy::ExtendTime, PvtPolicy::Reject] {
                assert_eq!(input.plan(policy).unwrap(), planned, "{name}");
            }
            return;
        }
        assert_eq!(expected.reason.as_deref(), Some("displacement_out_of_range"), "{name}");
        let nearest = if input.displacement > high { high } else { low };
        close(name, planned.motion().reached().position, nearest, scale);
        assert_eq!(planned.motion().adjustments()[0].quantity, Quantity::Position, "{name}");
        close(name, planned.motion().duration(), input.duration, input.duration);

        let kept = input.plan(PvtPolicy::PreferPosition).unwrap();
        self.legal(name, &kept);
        match expected.closest_v_end {
            Some(velocity) => {
                close(name, kept.motion().reached().velocity, velocity, input.fastest());
                close(name, kept.motion().reached().position, input.displacement, scale);
            }
            None => {
                assert!((kept.motion().reached().position - input.displacement).abs() > TOLERANCE * scale);
            }
        }
        let later = input.plan(PvtPolicy::ExtendTime);
        match expected.extended_duration {
            Some(duration) => {
                let later = later.unwrap();
                let first = LATE.iter().find(|(late, _)| *late == name).map_or(duration, |(_, first)| *first);
                assert!(first <= duration, "{name}");
                close(name, later.motion().duration(), first, first);
                let end = State { position: input.displacement, velocity: input.v_end, acceleration: 0.0 };
                assert_eq!(later.motion().reached(), end, "{name}");
                assert_eq!(later.motion().adjustments()[0].quantity, Quantity::Time, "{name}");
                self.legal(name, &later);
            }
            None => assert!(later.is_err(), "{name}"),
        }
        let refusal = input.plan(PvtPolicy::Reject).unwrap_err();
        assert!(
            matches!(refusal.as_slice()[0].why, Why::PvtOutOfReach { least, greatest, .. }
                if (least - low).abs() <= TOLERANCE * scale && (greatest - high).abs() <= TOLERANCE * scale),
            "{name}: {refusal}"
        );
    }

    fn check_shape(&self, name: &str, planned: &PvtMove) {
        let Self { input, expected } = self;
        assert_eq!(planned.region().name(), expected.region.as_deref().unwrap(), "{name}");
        // At a border a part may last for a rounding, or not be there.
        let lasting = |phase: &[f64; 3]| phase[0] > TOLERANCE * input.duration;
        let phases: Vec<_> = phases(planned).into_iter().filter(lasting).collect();
        let expected_phases: Vec<_> = expected.phases.iter().copied().filter(lasting).collect();
        assert_eq!(phases.len(), expected_phases.len(), "{name}: {phases:?}");
        for (phase, expected) in phases.iter().zip(expected_phases) {
            close(name, phase[0], expected[0], input.duration);
            close(name, phase[1], expected[1], input.fastest());
            close(name, phase[2], expected[2], input.fastest());
        }
        let cruise = expected.v_cruise.unwrap();
        assert!(phases.iter().any(|phase| (phase[2] - cruise).abs() <= TOLERANCE * input.fastest()
            || (phase[1] - cruise).abs() <= TOLERANCE * input.fastest()));
        let (mut jerk, mut acceleration) = (0.0f64, 0.0f64);
        for segment in planned.motion().segments() {
            jerk = jerk.max(segment.at(0.0).jerk.abs());
            acceleration = acceleration.max(segment.start.acceleration.abs());
        }
        close(name, jerk, expected.peak_jerk.unwrap(), input.j_max);
        close(name, acceleration, expected.peak_acceleration.unwrap(), input.a_max);
    }

    fn legal(&self, name: &str, planned: &PvtMove) {
        let motion = planned.motion();
        assert_eq!(violations(&motion.to_profile(), &self.input.limits(), motion.reached()), [], "{name}");
    }
}

#[test]
fn commands_solved_at_sixty_digits() {
    let records: Vec<Record> = serde_json::from_str(include_str!("vectors/pvt.json")).unwrap();
    for (index, record) in records.iter().enumerate() {
        record.check(&format!("record {index}"));
    }
    assert_eq!(records.len(), 400);
}
