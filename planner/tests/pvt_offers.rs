//! What is refused is refused with what would be taken; what is said there is asked for again, and taken.

#![allow(clippy::float_cmp, reason = "what is kept is kept to the last bit")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "a test may fail by panicking")]

mod common;

use common::Random;
use planner::{
    AxisKind, InvalidFields, Limits, LimitsSpec, PvtAxisSpec, PvtInterpolation, PvtMove, PvtOffers,
    PvtPlanner, PvtPolicy, PvtRequest, PvtRequestSpec, PvtTarget, Quantity, State, Why, plan_pvt,
};

/// A command, drawn to hurt: velocities at limits, equal, opposed and nearly equal; times around the very least; axes that must not
/// turn back, with decelerations of their own, far from zero, in a range of positions that leaves room for some of it.
#[derive(Clone, Debug)]
struct Question {
    start: State,
    target: PvtTarget,
    limits: LimitsSpec,
}

impl Question {
    fn drawn(random: &mut Random) -> Self {
        let pick = |random: &mut Random, from: u64| random.bits() % from;
        let (fastest, hardest) = (random.decades(1e-3, 1e3), random.decades(1e-3, 1e3));
        let jerk = hardest * hardest / fastest * random.decades(1e-2, 1e2);
        let reverse = match pick(random, 4) {
            0 => Some(0.0),
            1 => Some(fastest * random.between(0.1, 2.0)),
            _ => None,
        };
        let back = reverse.unwrap_or(fastest);
        let mut velocity = |other: f64| {
            let velocity = match pick(random, 8) {
                0 => 0.0,
                1 => fastest,
                2 => -back,
                3 => other,
                4 => other * (1.0 + 1e-9 * random.between(-1.0, 1.0)),
                5 => -other,
                6 => other + hardest * hardest / jerk * random.between(-1.0, 1.0),
                _ => fastest * random.between(-1.0, 1.0),
            };
            velocity.clamp(-back, fastest)
        };
        let first = velocity(0.0);
        let last = velocity(first);
        let deceleration = (pick(random, 3) == 0).then(|| hardest * random.decades(0.1, 10.0));
        let least =
            common::ramp_time((last - first).abs(), hardest.min(deceleration.unwrap_or(hardest)), jerk);
        let natural = fastest / hardest + hardest / jerk;
        let duration = match pick(random, 5) {
            0 if least > 0.0 => common::nudged(least, (pick(random, 7) as i32) - 3),
            1 if least > 0.0 => least * (1.0 + random.decades(1e-12, 1.0)),
            2 if least > 0.0 => least * random.decades(0.1, 1.0),
            3 => 2.0 * hardest / jerk,
            _ => natural * random.decades(0.03, 30.0),
        };
        let way = fastest * duration;
        let from = if pick(random, 3) == 0 { 1e4 * way * random.between(-1.0, 1.0) } else { 0.0 };
        let mut position = from
            + match pick(random, 4) {
                // Near the ends of what can be reached.
                0 => 0.5 * (first + last) * duration + way * random.decades(1e-12, 1e-3),
                1 => 0.5 * (first + last) * duration - way * random.decades(1e-12, 1e-3),
                _ => way * random.between(-2.0, 2.0),
            };
        let (mut min_position, mut max_position) = (None, None);
        if pick(random, 2) == 0 {
            let room = way * random.decades(1e-4, 3.0);
            min_position = (pick(random, 3) > 0).then(|| from - room * random.unit());
            max_position = (pick(random, 3) > 0).then_some(from + room);
        }
        // Also where its rounding is beyond the end of the range.
        position = position.min(max_position.unwrap_or(f64::MAX)).max(min_position.unwrap_or(f64::MIN));
        let limits = LimitsSpec {
            max_velocity: fastest,
            max_velocity_reverse: reverse,
            max_acceleration: hardest,
            max_deceleration: deceleration,
            max_jerk: jerk,
            min_position,
            max_position,
            ..LimitsSpec::default()
        };
        let start = State { position: from, velocity: first, acceleration: 0.0 };
        Self { start, target: PvtTarget { position, velocity: last, duration }, limits }
    }

    fn limits(&self) -> Limits {
        self.limits.clone().try_into().unwrap()
    }

    fn ask(&self, target: PvtTarget, policy: PvtPolicy) -> Result<PvtMove, InvalidFields> {
        PvtPlanner::new(self.start, self.limits(), policy).unwrap().command(target)
    }

    /// Asks for what was offered, and has the judge look at it.
    #[track_caller]
    fn check(&self, offered: PvtTarget) {
        let planned = self.ask(offered, PvtPolicy::Reject);
        let planned = planned.unwrap_or_else(|refused| panic!("{offered:?}: {refused}: {self:?}"));
        let motion = planned.motion();
        let end = State { position: offered.position, velocity: offered.velocity, acceleration: 0.0 };
        assert_eq!(motion.reached(), end.with_positive_zeros(), "{self:?}");
        assert!(motion.adjustments().is_empty(), "{self:?}");
        let violations = planner::violations(&motion.to_profile(), &self.limits(), motion.reached());
        assert_eq!(violations, [], "{self:?}");
    }
}

#[track_caller]
fn offers(refused: &InvalidFields) -> (Quantity, PvtOffers) {
    match &refused.as_slice()[0].why {
        Why::PvtTimeTooShort { offers, .. } => (Quantity::Velocity, **offers),
        Why::PvtOutOfReach { offers, .. } => (Quantity::Position, **offers),
        Why::PvtLeavesRange { offers, .. } => (Quantity::Time, **offers),
        _ => panic!("{refused}"),
    }
}

/// Of each kind of refusal, each kind of offer is met often enough to tell.
#[test]
fn what_is_offered_is_taken() {
    let mut random = Random(41);
    // By what gives way first: refusals, and how many offers of each kind.
    let mut met = [[0usize; 4]; 3];
    for _ in 0..60_000 {
        let question = Question::drawn(&mut random);
        let Question { start, target, .. } = question.clone();
        let Err(refused) = question.ask(target, PvtPolicy::Reject) else { continue };
        let (quantity, PvtOffers { nearest, same_position, later, time_helps }) = offers(&refused);
        let row = &mut met[match quantity {
            Quantity::Velocity => 0,
            Quantity::Position => 1,
            _ => 2,
        }];
        row[0] += 1;
        for (index, offer) in [nearest, same_position, later].into_iter().enumerate() {
            row[index + 1] += usize::from(offer.is_some());
            offer.into_iter().for_each(|offer| question.check(offer));
        }
        // Each changes what it says, and nothing else.
        assert!(nearest.is_none_or(|offer| offer.duration == target.duration));
        let kept = |offer: PvtTarget| (offer.position, offer.duration) == (target.position, target.duration);
        assert!(same_position.is_none_or(kept));
        let kept = |offer: PvtTarget| (offer.position, offer.velocity) == (target.position, target.velocity);
        assert!(later.is_none_or(
            |offer| kept(offer) && offer.duration > target.duration || quantity == Quantity::Time
        ));
        if quantity == Quantity::Position {
            assert!(nearest.is_none_or(|offer| offer.velocity == target.velocity));
        }
        // The policies that adjust do no better.
        let unranged = question.limits.min_position.is_none() && question.limits.max_position.is_none();
        if !unranged {
            continue;
        }
        let offered = nearest.unwrap_or_else(|| panic!("nothing near: {question:?}"));
        let adjusted = question.ask(target, PvtPolicy::PreferVelocity).unwrap().motion().reached();
        let fastest = question.limits.max_velocity.max(question.limits.max_velocity_reverse.unwrap_or(0.0));
        let slack = 1e-8 * fastest;
        assert!((offered.velocity - adjusted.velocity).abs() <= slack, "{question:?}");
        let slack = slack * target.duration + 1e-12 * start.position.abs();
        assert!((offered.position - adjusted.position).abs() <= slack, "{question:?}");
        let adjusted = question.ask(target, PvtPolicy::PreferPosition).unwrap().motion().reached();
        if adjusted.position == target.position {
            let offered = same_position.unwrap_or_else(|| panic!("another velocity: {question:?}"));
            assert!((offered.velocity - adjusted.velocity).abs() <= 1e-8 * fastest, "{question:?}");
        }
        let extended = question.ask(target, PvtPolicy::ExtendTime);
        assert_eq!(extended.is_ok(), time_helps);
        if let Ok(extended) = extended {
            let offered = later.unwrap_or_else(|| panic!("a longer time: {question:?}"));
            let duration = extended.motion().duration();
            assert!((offered.duration - duration).abs() <= 1e-8 * duration, "{question:?}");
        }
    }
    // Where only the range is in the way no other velocity and no other time is looked for.
    let [too_short, out_of_reach, out_of_range] = met;
    let often = [&too_short[..], &out_of_reach[..], &out_of_range[..2]].concat();
    assert!(often.iter().all(|count| *count >= 200), "{met:?}");
}

/// In a sequence too, far from its beginning, where an interval is known no better than its times are.
#[test]
fn what_is_offered_in_a_sequence_is_taken() {
    let mut random = Random(43);
    let mut met = [0; 3];
    for round in 0..3000 {
        let question = Question::drawn(&mut random);
        let Question { start, target, limits } = question.clone();
        if !(1e-5..1e5).contains(&target.duration) {
            continue;
        }
        // It waits, at rest, for as long as a time may be known by.
        let before = target.duration * random.decades(1.0, 1e4);
        let axis = |target: &PvtTarget| PvtAxisSpec {
            axis: "x".into(),
            kind: Ok(AxisKind::Prismatic),
            limits: limits.clone(),
            start: State { velocity: 0.0, ..start },
            times: vec![before, before + target.duration],
            positions: vec![start.position, target.position],
            velocities: vec![0.0, target.velocity],
        };
        let plan = |target: &PvtTarget| {
            let spec = PvtRequestSpec {
                axes: vec![axis(target)],
                cycle_time_ns: Some(10_000),
                interpolation: Ok(PvtInterpolation::SShaped),
                policy: Ok(PvtPolicy::Reject),
                finish_unreached: false,
            };
            plan_pvt(&PvtRequest::try_from(spec)?)
        };
        let Err(refused) = plan(&target) else { continue };
        let (_, PvtOffers { nearest, same_position, later, .. }) = offers(&refused);
        for (index, offer) in [nearest, same_position, later].into_iter().enumerate() {
            let Some(offer) = offer else { continue };
            met[index] += 1;
            let planned = plan(&offer);
            let planned =
                planned.unwrap_or_else(|refused| panic!("{round}, {offer:?}: {refused}: {question:?}"));
            let certificate = planner::certify(planned.plan());
            assert!(certificate.passed(), "{:?}", certificate.violations().collect::<Vec<_>>());
        }
    }
    assert!(met.iter().all(|count| *count > 100), "{met:?}");
}
