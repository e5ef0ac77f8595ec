//! What a plan is, in words.

use planner::{
    AdjustmentReason, AsymmetricType, AxisKind, Classification, EightType, Family, Method, PvtInterpolation,
    PvtMethod, PvtPolicy, Quantity, SixCase,
};

use crate::show::number::{plain, unit};

pub(crate) fn kind(kind: AxisKind) -> &'static str {
    match kind {
        AxisKind::Prismatic => "prismatic",
        AxisKind::Revolute => "revolute",
        AxisKind::Pulses => "in pulses",
    }
}

/// How a plan was made.
pub(crate) fn family(method: Method) -> String {
    if let Some(PvtMethod { interpolation, policy }) = method.pvt {
        return match interpolation {
            // The others have no use for a policy.
            PvtInterpolation::SShaped => format!("S-shaped through points, {}", gives_way(policy)),
            PvtInterpolation::Cubic => "cubics through points".to_owned(),
            PvtInterpolation::Quintic => "quintics through points".to_owned(),
        };
    }
    let family = match method.family {
        Family::SCurve => "S-curve".to_owned(),
        Family::Trapezoidal => "trapezoid".to_owned(),
        Family::Polynomial => format!("polynomial of order {}", method.order),
        Family::Trigonometric => "trigonometric".to_owned(),
    };
    if method.end_on_cycle { format!("{family} that ends on a cycle,") } else { family }
}

/// The shape in words.
pub(crate) fn classification(classification: &Classification, kind: AxisKind) -> String {
    // Where there are eight types, the six cases tell less.
    let Classification { eight_type, asymmetric_type, six_case, feed_rate } = *classification;
    let peak = format!("{}\u{a0}{}", plain(feed_rate), unit(kind, Quantity::Velocity));
    let Some(eight_type) = eight_type else {
        return match asymmetric_type {
            Some(asymmetric) => format!(
                "asymmetric type {} ({}), peak {peak}",
                asymmetric.name(),
                asymmetric_words(asymmetric)
            ),
            None if feed_rate == 0.0 => "stands still".to_owned(),
            None => match six_case {
                Some(case) => format!("case {case} ({}), peak {peak}", case_words(case)),
                None => format!("peak {peak}"),
            },
        };
    };
    let words = match eight_type {
        EightType::Type1 => "cruises, full acceleration both ways",
        EightType::Type2 => "cruises, full acceleration only while speeding up",
        EightType::Type3 => "cruises, full acceleration only while slowing down",
        EightType::Type4 => "cruises, never at full acceleration",
        EightType::Type5 => "no cruise, full acceleration both ways",
        EightType::Type6 => "no cruise, full acceleration only while speeding up",
        EightType::Type7 => "no cruise, full acceleration only while slowing down",
        EightType::Type8A => "no cruise, never at full acceleration",
        EightType::Type8B => "path too short, ends at its start velocity",
        EightType::Type8C => "path too short, one ramp to the nearest velocity",
    };
    format!("type {} ({words}), peak {peak}", eight_type.name())
}

fn asymmetric_words(kind: AsymmetricType) -> &'static str {
    match kind {
        AsymmetricType::Type1 => "cruises, full acceleration both ways",
        AsymmetricType::Type2 => "no cruise, full acceleration both ways",
        AsymmetricType::Type3 => "no cruise, never at full acceleration",
        AsymmetricType::Type4 => "no cruise, full acceleration only while speeding up",
        AsymmetricType::Type5 => "no cruise, full acceleration only while slowing down",
        AsymmetricType::Type6 => "cruises, full acceleration only while speeding up",
        AsymmetricType::Type7 => "cruises, full acceleration only while slowing down",
        AsymmetricType::Type8 => "cruises, never at full acceleration",
    }
}

fn case_words(case: SixCase) -> &'static str {
    match case {
        SixCase::A | SixCase::C1 => "cruises, never at full acceleration",
        SixCase::B | SixCase::C2 => "no cruise, never at full acceleration",
        SixCase::D1 => "cruises, full acceleration both ways",
        SixCase::D2 => "no cruise, full acceleration both ways",
    }
}

/// What gives way where a point cannot be met.
fn gives_way(policy: PvtPolicy) -> &'static str {
    match policy {
        PvtPolicy::PreferVelocity => "velocity before position,",
        PvtPolicy::PreferPosition => "position before velocity,",
        PvtPolicy::ExtendTime => "later where need be,",
        PvtPolicy::Reject => "each as asked,",
    }
}

/// A clause that gives the reason.
pub(crate) fn why(reason: AdjustmentReason) -> &'static str {
    match reason {
        AdjustmentReason::PathTooShortStartVelocity => {
            "since the path is too short and policy takes the start velocity"
        }
        AdjustmentReason::PathTooShortNearestVelocity => "the nearest that so short a path can reach",
        AdjustmentReason::FeedRateAboveLimit => "since the feed rate is above the velocity limit",
        AdjustmentReason::ClosingStop => "since a stop was put after the end",
        AdjustmentReason::PvtTimeTooShort => "the nearest that can be reached in so short a time",
        AdjustmentReason::PvtOutOfReach => "since the limits do not let it be met",
        AdjustmentReason::PvtTimeExtended => "the first time at which it can be met",
        AdjustmentReason::PvtTimeShifted => "since another axis or a point before it took longer",
        AdjustmentReason::PvtFinishedLate => "since a move to the last point was put after the others",
        AdjustmentReason::Override => "since an override scales every velocity",
    }
}
