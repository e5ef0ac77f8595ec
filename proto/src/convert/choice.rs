//! Enums: a domain enum has only legal values, a wire enum is any 32-bit number.

use planner::{
    AxisKind, Family, PvtInterpolation, PvtPolicy, Quantity, ShortPathPolicy, Synchronization, Why,
};

use crate::stream::{Phase, StreamEventKind};
use crate::{Detail, pb};

/// Both directions of one enum. `unset` is what zero stands for, or nothing where a choice has to be made.
macro_rules! choice {
    ($from_wire:ident, $to_wire:ident, $domain:ty, $wire:ty, unset: $unset:expr,
     $choices:literal, { $($variant:ident = $name:ident),+ $(,)? }) => {
        pub(super) fn $from_wire(given: i32) -> Result<$domain, Why> {
            let unset: Option<$domain> = $unset;
            match <$wire>::try_from(given) {
                $(Ok(<$wire>::$name) => Ok(<$domain>::$variant),)+
                Ok(<$wire>::Unspecified) => unset.ok_or(Why::Unspecified { choices: $choices }),
                Err(_) => Err(Why::UnknownChoice { given, choices: $choices }),
            }
        }

        pub(super) fn $to_wire(domain: $domain) -> i32 {
            match domain {
                $(<$domain>::$variant => <$wire>::$name as i32,)+
            }
        }
    };
}

/// The number of a choice; of one that could not be read, the number that was given, so that whoever answers says so.
pub(super) fn choice_to_wire<T>(choice: Result<T, Why>, to_wire: impl FnOnce(T) -> i32) -> i32 {
    match choice {
        Ok(choice) => to_wire(choice),
        Err(Why::UnknownChoice { given, .. }) => given,
        Err(_) => 0,
    }
}

choice!(kind_from_wire, kind_to_wire, AxisKind, pb::AxisKind, unset: None,
    "PRISMATIC, REVOLUTE, PULSES", { Prismatic = Prismatic, Revolute = Revolute, Pulses = Pulses });

choice!(family_from_wire, family_to_wire, Family, pb::ProfileFamily, unset: Some(Family::SCurve),
    "S_CURVE, TRAPEZOIDAL, POLYNOMIAL, TRIGONOMETRIC",
    { SCurve = SCurve, Trapezoidal = Trapezoidal, Polynomial = Polynomial, Trigonometric = Trigonometric });

choice!(short_path_from_wire, short_path_to_wire, ShortPathPolicy, pb::ShortPathPolicy,
    unset: Some(ShortPathPolicy::Reject),
    "REVERSE, MATCH_START_VELOCITY, NEAREST_VELOCITY, REJECT",
    { Reverse = Reverse, MatchStartVelocity = MatchStartVelocity, NearestVelocity = NearestVelocity,
      Reject = Reject });

choice!(synchronization_from_wire, synchronization_to_wire, Synchronization, pb::Synchronization,
    unset: Some(Synchronization::Time), "NONE, TIME, PHASE", { None = None, Time = Time, Phase = Phase });

choice!(interpolation_from_wire, interpolation_to_wire, PvtInterpolation, pb::PvtInterpolation,
    unset: Some(PvtInterpolation::SShaped), "S_SHAPED, CUBIC, QUINTIC",
    { SShaped = SShaped, Cubic = Cubic, Quintic = Quintic });

choice!(policy_from_wire, policy_to_wire, PvtPolicy, pb::PvtPolicy, unset: Some(PvtPolicy::PreferVelocity),
    "PREFER_VELOCITY, PREFER_POSITION, EXTEND_TIME, REJECT",
    { PreferVelocity = PreferVelocity, PreferPosition = PreferPosition, ExtendTime = ExtendTime, Reject = Reject });

choice!(quantity_from_wire, quantity_to_wire, Quantity, pb::Quantity, unset: None,
    "POSITION, VELOCITY, ACCELERATION, JERK, SNAP, CRACKLE, POP, LOCK, DROP, TIME",
    { Position = Position, Velocity = Velocity, Acceleration = Acceleration, Jerk = Jerk, Snap = Snap,
      Crackle = Crackle, Pop = Pop, Lock = Lock, Drop = Drop, Time = Time });

choice!(detail_from_wire, detail_to_wire, Detail, pb::PlanDetail, unset: Some(Detail::Full),
    "FULL, MOTION", { Full = Full, Motion = Motion });

choice!(phase_from_wire, phase_to_wire, Phase, pb::Phase, unset: None,
    "MOVING, HOLDING, STOPPING, STANDSTILL, FINISHED",
    { Moving = Moving, Holding = Holding, Stopping = Stopping, Standstill = Standstill, Finished = Finished });

choice!(event_from_wire, event_to_wire, StreamEventKind, pb::StreamEventKind, unset: None,
    "DRAINING, STANDSTILL, FINISHED, SUPERSEDED, TRACKING_WANTED, TRACKING_UNWANTED",
    { Draining = Draining, Standstill = Standstill, Finished = Finished, Superseded = Superseded,
      TrackingWanted = TrackingWanted, TrackingUnwanted = TrackingUnwanted });
