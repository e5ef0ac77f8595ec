//! Several axes from any state to any state: 800 problems with the durations of Ruckig 0.19.4 (Berscheid and Kröger, 2021), and
//! rsruckig as a second opinion on problems that are drawn to hurt. More of them:
//!
//! ```text
//! cargo test --release -p portamento-planner --test together -- --ignored --nocapture
//! ```

#![allow(
    clippy::float_cmp,
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test may fail by panicking; this one also reports, and compares what is to be the same number"
)]

mod common;

use common::Random;
use common::axes::{Peer, SEVEN, questions};
use common::peer;
use common::states::{Kind, Question};
use planner::{
    AxisTransfer, BoundsSpec, CycleTime, Limits, LimitsSpec, NoSuchDuration, State, Synchronization, Timing,
    Together, Transfer, Transit, Why, together, transfer_violations, violations,
};
use serde::Deserialize;

/// Of a duration [1]: how much longer than the peer's ours may be.
const SLACK: f64 = 1e-9;
/// Of the scale of a motion [1]: how far its pieces may be apart, and how far it may end from its goal.
const END: f64 = 1e-12;
/// A time in which nothing moves [s], or as good as nothing.
const NOTHING: f64 = 1e-12;

#[derive(Deserialize)]
struct Record {
    dofs: usize,
    sync: String,
    collinear: bool,
    minimum_duration: Option<f64>,
    p0: Vec<f64>,
    v0: Vec<f64>,
    a0: Vec<f64>,
    pf: Vec<f64>,
    vf: Vec<f64>,
    af: Vec<f64>,
    vmax: Vec<f64>,
    amax: Vec<f64>,
    jmax: Vec<f64>,
    duration: f64,
}

impl Record {
    fn questions(&self) -> Vec<Question> {
        let one = |axis: usize| Question {
            start: State { position: self.p0[axis], velocity: self.v0[axis], acceleration: self.a0[axis] },
            goal: State { position: self.pf[axis], velocity: self.vf[axis], acceleration: self.af[axis] },
            bounds: BoundsSpec {
                min_velocity: -self.vmax[axis],
                max_velocity: self.vmax[axis],
                min_acceleration: -self.amax[axis],
                max_acceleration: self.amax[axis],
                max_jerk: self.jmax[axis],
            },
        };
        (0..self.dofs).map(one).collect()
    }
}

fn transfers(asked: &[Question]) -> Vec<AxisTransfer<'static>> {
    asked.iter().map(|asked| AxisTransfer::from(asked.transfer())).collect()
}

/// Plans, and holds the answer against the judge.
#[track_caller]
fn planned(asked: &[Question], how: Synchronization, timing: Timing) -> (Together, Vec<Transit>) {
    let mut transits = Vec::new();
    let agreed = together(&transfers(asked), how, timing, &mut transits)
        .unwrap_or_else(|refusal| panic!("{refusal}: {asked:?}"));
    assert_eq!(transits.len(), asked.len());
    let line = (how == Synchronization::Phase).then(|| line_of(asked));
    for (asked_of, transit) in asked.iter().zip(&transits) {
        // On a line an axis has no more jerk than its share of the line's, and is led back by that.
        let max_jerk = line.map_or(f64::INFINITY, |line| {
            line.bounds.max_jerk * (way(asked_of) / (line.goal.position - line.start.position)).abs()
        });
        let bounds = asked_of.bounds.max_jerk.min(max_jerk);
        let bounds = BoundsSpec { max_jerk: bounds, ..asked_of.bounds };
        let found = transfer_violations(&transit.to_profile(), &bounds.try_into().unwrap(), asked_of.goal);
        assert_eq!(found, [], "{asked:?}: {transit:?}");
        let off = common::transit::residual(transit, asked_of.bounds.max_jerk);
        assert!(off <= END, "{off:e} apart: {asked:?}: {transit:?}");
        assert_eq!((transit.start(), transit.end()), (asked_of.start, asked_of.goal));
        if how != Synchronization::None {
            let late = (transit.duration() - agreed.duration).abs();
            assert!(late <= 4.0 * f64::EPSILON * agreed.duration, "{late} late: {asked:?}");
        }
    }
    (agreed, transits)
}

fn at_least(minimum_duration: Option<f64>) -> Timing {
    Timing { minimum_duration: minimum_duration.unwrap_or_default(), end_on: None }
}

/// How far axes are from the line between start and goal at worst, of the longest way [1].
fn off_line(asked: &[Question], transits: &[Transit]) -> f64 {
    let ways: Vec<f64> = asked.iter().map(|asked| asked.goal.position - asked.start.position).collect();
    let longest = (0..ways.len()).max_by(|&a, &b| ways[a].abs().total_cmp(&ways[b].abs())).unwrap();
    let mut worst: f64 = 0.0;
    for step in 0..=64 {
        let t = transits[0].duration() * f64::from(step) / 64.0;
        let gone = |axis: usize| transits[axis].at(t).state.position - asked[axis].start.position;
        for axis in 0..asked.len() {
            let off = gone(axis) - gone(longest) * ways[axis] / ways[longest];
            let far = |axis: usize| asked[axis].start.position.abs() + asked[axis].goal.position.abs();
            let rounding = 16.0 * f64::EPSILON * (far(axis) + far(longest));
            worst = worst.max((off.abs() - rounding) / ways[longest].abs());
        }
    }
    worst
}

fn way(asked: &Question) -> f64 {
    asked.goal.position - asked.start.position
}

/// The line as a question of its own: the axis that goes farthest, with what all of them allow it.
fn line_of(asked: &[Question]) -> Question {
    let leader = asked.iter().max_by(|a, b| way(a).abs().total_cmp(&way(b).abs())).unwrap();
    let allowed = |limit: fn(&BoundsSpec) -> f64| {
        asked
            .iter()
            .filter(|asked| way(asked) != 0.0)
            .map(|asked| limit(&asked.bounds) / (way(asked) / way(leader)).abs())
            .fold(f64::INFINITY, f64::min)
    };
    let (velocity, acceleration) =
        (allowed(|bounds| bounds.max_velocity), allowed(|bounds| bounds.max_acceleration));
    let bounds = BoundsSpec {
        min_velocity: -velocity,
        max_velocity: velocity,
        min_acceleration: -acceleration,
        max_acceleration: acceleration,
        max_jerk: allowed(|bounds| bounds.max_jerk),
    };
    let start = State { position: 0.0, ..leader.start };
    let goal = State { position: way(leader), ..leader.goal };
    Question { start, goal, bounds }
}

#[test]
fn never_longer_than_the_records() {
    let records: Vec<Record> = serde_json::from_str(include_str!("vectors/states_axes.json")).unwrap();
    assert_eq!(records.len(), 800);
    let (mut faster, mut on_line, mut left_by_the_peer, mut swept_off) = (0, 0, 0, Vec::new());
    let mut line_peer = peer::Peer::new();
    for (index, record) in records.iter().enumerate() {
        let asked = record.questions();
        let timing = at_least(record.minimum_duration);
        let (agreed, _) = planned(&asked, Synchronization::Time, timing);
        if record.collinear {
            // Where one axis alone does not bind all the way, the peer leaves the line; so it is asked for the line itself.
            if let Err(refusal) =
                together(&transfers(&asked), Synchronization::Phase, timing, &mut Vec::new())
            {
                let swept =
                    refusal.as_slice().iter().all(|one| matches!(one.why, Why::SweptOffLimits { .. }));
                assert!(swept, "{index}: {refusal}");
                swept_off.push(index);
                continue;
            }
            let (agreed, transits) = planned(&asked, Synchronization::Phase, timing);
            let theirs =
                line_peer.duration(&peer::question(&line_of(&asked))).unwrap().max(timing.minimum_duration);
            assert!(agreed.duration <= theirs * (1.0 + SLACK), "{index}: {agreed:?}, theirs {theirs}");
            assert!(
                agreed.duration >= record.duration * (1.0 - SLACK),
                "{index}: {agreed:?}, theirs {}",
                record.duration
            );
            left_by_the_peer += u32::from(agreed.duration > record.duration * (1.0 + SLACK));
            let off = off_line(&asked, &transits);
            assert!(off <= END, "{index}: {off:e} off the line");
            on_line += 1;
        } else {
            // Where there is no line the peer synchronizes in time.
            assert!(
                agreed.duration <= record.duration * (1.0 + SLACK),
                "{index}: {agreed:?}, theirs {}",
                record.duration
            );
            if record.sync == "phase" {
                let refusal = together(&transfers(&asked), Synchronization::Phase, timing, &mut Vec::new())
                    .unwrap_err();
                assert!(
                    refusal.as_slice().iter().all(|one| matches!(one.why, Why::OffTheLine { .. })),
                    "{refusal}"
                );
            }
        }
        if agreed.duration < record.duration * (1.0 - SLACK) {
            faster += 1;
        }
    }
    // One begins inside its limits, and the line alone would take it beyond them: there the peer leaves the line, as where ours takes longer.
    assert_eq!((on_line, swept_off.as_slice()), (98, &[791][..]));
    assert_eq!(left_by_the_peer, 50);
    println!(
        "of {}, ours is shorter in {faster}; of {on_line} lines the peer leaves {left_by_the_peer}",
        records.len()
    );
}

#[derive(Default)]
struct Tally {
    asked: u32,
    refused: u32,
    astray: u32,
    slower: u32,
    slowest: f64,
    longer: f64,
    /// Where another than the slowest axis was critical.
    blocked: u32,
}

/// `most_astray`: in how many of each kind the peer may be faster, as it does not arrive.
fn compare(count: u32, seed: u64, most_astray: [u32; Kind::ALL.len()]) {
    let mut peer = Peer::new();
    let mut counted = [0; Kind::ALL.len()];
    for (kind, counted) in Kind::ALL.into_iter().zip(&mut counted) {
        let (mut random, mut tally) = (Random(seed), Tally::default());
        for _ in 0..count / Kind::ALL.len() as u32 {
            let axes = 2 + random.bits() as usize % (SEVEN - 1);
            let asked = questions(&mut random, kind, axes);
            let (ours, _) = planned(&asked, Synchronization::Time, Timing::default());
            tally.asked += 1;
            let least =
                transfers(&asked).iter().map(|axis| axis.fastest().unwrap().duration()).fold(0.0, f64::max);
            tally.blocked += u32::from(ours.duration > least * (1.0 + SLACK));
            if ours.duration < NOTHING {
                continue;
            }
            let Some(theirs) = peer.duration(&asked).filter(|&theirs| theirs > 0.0) else {
                tally.refused += 1;
                continue;
            };
            let longer = ours.duration / theirs - 1.0;
            if longer > SLACK {
                assert!(!peer.arrives(&asked, END), "ours {ours:?}, theirs {theirs}: {asked:?}");
                tally.astray += 1;
                continue;
            }
            tally.longer = tally.longer.max(longer);
            if theirs > ours.duration * (1.0 + SLACK) {
                tally.slower += 1;
                tally.slowest = tally.slowest.max(theirs / ours.duration);
            }
        }
        let Tally { asked, refused, astray, slower, slowest, longer, blocked } = tally;
        println!(
            "{kind:?}: of {asked}, {blocked} with a blocked interval; the peer refuses {refused}, goes astray in {astray} and is slower in \
             {slower}, at most {slowest:.3} times; ours is longer by at most {longer:.1e}"
        );
        *counted = astray;
    }
    let known = counted.iter().zip(&most_astray).all(|(counted, most)| counted <= most);
    assert!(known, "the peer is faster and does not arrive in {counted:?}, known are {most_astray:?}");
}

#[test]
fn never_longer_than_the_peer() {
    compare(10_500, 1, [0, 0, 0, 0, 12, 0, 0]);
}

#[test]
#[ignore = "a minute in release"]
fn never_longer_than_the_peer_in_many() {
    compare(350_000, 2, [0, 0, 0, 1, 198, 0, 0]);
}

/// A whole number of cycles, the first that there can be.
#[test]
fn ends_on_a_cycle() {
    let cycle = CycleTime::MILLISECOND;
    for kind in Kind::ALL {
        let mut random = Random(3);
        for _ in 0..200 {
            let asked = questions(&mut random, kind, 3);
            let (free, _) = planned(&asked, Synchronization::Time, Timing::default());
            if free.duration > 1e6 {
                continue;
            }
            let timing = Timing { minimum_duration: 0.0, end_on: Some(cycle) };
            let (agreed, _) = planned(&asked, Synchronization::Time, timing);
            let cycles = cycle.count(agreed.duration).unwrap();
            assert!(
                (agreed.duration - cycle.start_of(cycles)).abs() <= 1e-11 * agreed.duration,
                "{agreed:?}: {asked:?}"
            );
            assert!(agreed.duration >= free.duration * (1.0 - 1e-11));
            // Nothing less: each whole number of cycles before it is blocked for one of them.
            let before = cycle.start_of(cycles - cycles.min(1));
            let each_can = transfers(&asked).iter().all(|axis| axis.lasting(before).is_ok());
            assert!(cycles == 0 || !each_can, "{before} would do: {asked:?}");
        }
    }
}

fn rest(position: f64) -> State {
    State::at_rest(position)
}

fn limits(max_acceleration: f64, max_deceleration: f64) -> LimitsSpec {
    LimitsSpec {
        max_velocity: 1.0,
        max_acceleration,
        max_deceleration: Some(max_deceleration),
        max_jerk: 20.0,
        ..LimitsSpec::default()
    }
}

/// An axis that comes in fast arrives at once, or passes its goal and comes back. It is critical where the slowest axis is not slow enough.
#[test]
fn a_blocked_axis_is_critical() {
    let bounds = planner::Bounds::symmetric(1.0, 1.0, 10.0).unwrap();
    let fast = State { position: 0.0, velocity: 1.0, acceleration: 0.0 };
    let fast = AxisTransfer::from(Transfer::new(fast, State { position: 1.0, ..fast }, bounds).unwrap());
    let slow = |way: f64| AxisTransfer::from(Transfer::new(rest(0.0), rest(way), bounds).unwrap());
    let arrivals = fast.arrivals().unwrap();
    let [blocked] = arrivals.blocked() else { panic!("{arrivals:?}") };
    assert_eq!(arrivals.least(), 1.0);
    assert!(blocked.after < 2.0 && 2.0 < blocked.before, "{blocked:?}");
    let way = (1..400)
        .map(|step| 0.01 * f64::from(step))
        .find(|&way| slow(way).fastest().unwrap().duration() > 2.0);
    let mut transits = Vec::new();
    let axes = [slow(way.unwrap()), fast];
    let agreed = together(&axes, Synchronization::Time, Timing::default(), &mut transits).unwrap();
    assert_eq!((agreed.duration, agreed.critical), (blocked.before, Some(1)));
    assert_eq!(arrivals.first_from(2.0), blocked.before);
    let refusal = fast.lasting(2.0).unwrap_err();
    assert!(matches!(refusal, NoSuchDuration::Blocked { .. }), "{refusal}");
    let short = fast.lasting(0.5).unwrap_err();
    assert_eq!(short.to_string(), "nothing arrives in 0.5 s: it takes 1 s at least");
}

/// An axis that may not go back, and whose goal is passed at speed, arrives early or never.
#[test]
fn an_axis_that_cannot_wait() {
    let bounds =
        BoundsSpec { min_velocity: 0.0, ..*planner::Bounds::symmetric(1.0, 1.0, 10.0).unwrap().spec() };
    let bounds = bounds.try_into().unwrap();
    let at_speed = State { position: 0.0, velocity: 1.0, acceleration: 0.0 };
    let hasty =
        AxisTransfer::from(Transfer::new(at_speed, State { position: 0.5, ..at_speed }, bounds).unwrap());
    let slow = AxisTransfer::from(Transfer::new(rest(0.0), rest(9.0), bounds).unwrap());
    let refusal =
        together(&[slow, hasty], Synchronization::Time, Timing::default(), &mut Vec::new()).unwrap_err();
    assert_eq!(refusal.as_slice()[0].field.as_str(), "axes[1]");
    assert!(matches!(refusal.as_slice()[0].why, Why::ArrivesEarly { .. }), "{refusal}");
}

/// Speeding up unlike slowing down: legal, at one time, and on a line.
#[test]
fn speeding_up_and_slowing_down() {
    let mut random = Random(9);
    let (mut planned, mut blocked) = (0, 0);
    for _ in 0..3000 {
        let axes = 2 + random.bits() as usize % 5;
        let limits: Vec<Limits> = (0..axes)
            .map(|_| Limits::try_from(limits(random.decades(0.3, 10.0), random.decades(0.3, 10.0))).unwrap())
            .collect();
        let asked: Vec<(State, State)> = limits
            .iter()
            .map(|limits| {
                let gentle = 0.9 * limits.acceleration().min(limits.deceleration());
                let mut any = |most: f64| {
                    if random.bits().is_multiple_of(3) { 0.0 } else { random.between(-most, most) }
                };
                let mut state =
                    || State { position: any(3.0), velocity: any(0.8), acceleration: any(gentle.min(1.5)) };
                let mut ends = (state(), state());
                for end in [&mut ends.0, &mut ends.1] {
                    end.velocity *= 1.0 - 0.5 * end.acceleration * end.acceleration / 20.0;
                }
                ends
            })
            .collect();
        let questions: Vec<AxisTransfer<'_>> = asked
            .iter()
            .zip(&limits)
            .map(|(&(start, goal), limits)| AxisTransfer::within_limits(start, goal, limits).unwrap())
            .collect();
        let mut transits = Vec::new();
        let agreed = together(&questions, Synchronization::Time, Timing::default(), &mut transits).unwrap();
        let slowest = questions.iter().map(|axis| axis.fastest().unwrap().duration()).fold(0.0, f64::max);
        assert!(agreed.duration >= slowest);
        blocked += u32::from(agreed.duration > slowest);
        for ((transit, limits), (_, goal)) in transits.iter().zip(&limits).zip(&asked) {
            assert_eq!(
                violations(&transit.to_profile(), limits, *goal),
                [],
                "{asked:?} {limits:?}: {transit:?}"
            );
            assert!((transit.duration() - agreed.duration).abs() <= 4.0 * f64::EPSILON * agreed.duration);
        }
        planned += 1;
    }
    println!("of {planned}, {blocked} with a blocked interval");
    assert!(blocked > 10);
}

#[test]
fn a_line_within_limits() {
    let mut random = Random(11);
    for _ in 0..3000 {
        let axes = 2 + random.bits() as usize % 5;
        let far = random.bits().is_multiple_of(2);
        let limits: Vec<Limits> = (0..axes)
            .map(|_| Limits::try_from(limits(random.decades(0.3, 10.0), random.decades(0.3, 10.0))).unwrap())
            .collect();
        let ways: Vec<f64> = (0..axes).map(|_| random.between(-3.0, 3.0)).collect();
        // Towards the goal: a ramp through zero has the lower of both limits, whose part of the motion hangs on the jerk.
        let speed = if far { 0.0 } else { random.between(0.0, 0.1) };
        let asked: Vec<(State, State)> = ways
            .iter()
            .map(|way| {
                let from = if far { random.between(-1e6, 1e6) } else { 0.0 };
                (State { velocity: speed * way, ..rest(from) }, rest(from + way))
            })
            .collect();
        let questions: Vec<AxisTransfer<'_>> = asked
            .iter()
            .zip(&limits)
            .map(|(&(start, goal), limits)| AxisTransfer::within_limits(start, goal, limits).unwrap())
            .collect();
        let mut transits = Vec::new();
        let agreed = together(&questions, Synchronization::Phase, Timing::default(), &mut transits).unwrap();
        for ((transit, limits), (_, goal)) in transits.iter().zip(&limits).zip(&asked) {
            assert_eq!(
                violations(&transit.to_profile(), limits, *goal),
                [],
                "{asked:?} {limits:?}: {transit:?}"
            );
            assert_eq!(transit.duration(), agreed.duration);
        }
        let slowest = questions.iter().map(|axis| axis.fastest().unwrap().duration()).fold(0.0, f64::max);
        // Far from zero each axis rounds its way by itself.
        let rounding = if far { 1e-5 } else { SLACK };
        assert!(agreed.duration >= slowest * (1.0 - rounding), "{agreed:?}, {slowest}: {asked:?} {limits:?}");
        let bare: Vec<Question> = asked
            .iter()
            .map(|&(start, goal)| Question { start, goal, bounds: BoundsSpec::default() })
            .collect();
        let off = off_line(&bare, &transits);
        assert!(off <= END, "{off:e} off the line: {asked:?}");
    }
}

/// Where positions round a short way to few digits, the speeds say what the line is.
#[test]
fn a_short_way_far_from_zero_at_speed_is_a_line() {
    let mut random = Random(12);
    for _ in 0..3000 {
        let axes = 2 + random.bits() as usize % 5;
        let within = Limits::try_from(limits(1.0, random.decades(0.3, 3.0))).unwrap();
        let (way, speed) = (random.decades(1e-4, 1e-1), random.between(0.0, 0.2));
        let acceleration = random.between(-0.2, 0.2);
        let asked: Vec<(State, State)> = (0..axes)
            .map(|_| {
                let (from, part) = (random.between(-100.0, 100.0), random.between(-1.0, 1.0));
                let start =
                    State { position: from, velocity: part * speed, acceleration: part * acceleration };
                (start, rest(from + part * way))
            })
            .collect();
        let questions: Vec<AxisTransfer<'_>> = asked
            .iter()
            .map(|&(start, goal)| AxisTransfer::within_limits(start, goal, &within).unwrap())
            .collect();
        let mut transits = Vec::new();
        let agreed = together(&questions, Synchronization::Phase, Timing::default(), &mut transits);
        let agreed = agreed.unwrap_or_else(|refused| panic!("{asked:?}: {refused}"));
        for (transit, (start, goal)) in transits.iter().zip(&asked) {
            assert_eq!(violations(&transit.to_profile(), &within, *goal), [], "{asked:?}: {transit:?}");
            assert_eq!((transit.start(), transit.duration()), (*start, agreed.duration));
        }
    }
}

#[test]
fn what_is_refused() {
    let within = Limits::try_from(limits(1.0, 1.0)).unwrap();
    let ranged = Limits::try_from(LimitsSpec {
        min_position: Some(-0.01),
        max_position: Some(3.0),
        ..limits(1.0, 1.0)
    })
    .unwrap();
    let to = |goal: State| AxisTransfer::within_limits(rest(0.0), goal, &within).unwrap();
    let from = State { velocity: -0.5, ..rest(0.0) };
    let leaves = AxisTransfer::within_limits(from, rest(1.0), &ranged).unwrap();
    let refused = |axes: &[AxisTransfer<'_>], how: Synchronization, timing: Timing| {
        together(axes, how, timing, &mut Vec::new()).unwrap_err().to_string()
    };
    let (time, phase) = (Synchronization::Time, Synchronization::Phase);
    let rows = [
        (refused(&[], time, Timing::default()), "axes: is empty: give at least one axis"),
        (
            refused(&[to(rest(1.0))], time, at_least(Some(-1.0))),
            "minimum_duration: is -1 s: give a time above 0",
        ),
        (
            refused(&[to(rest(1.0)), leaves], time, Timing::default()),
            "axes[1]: the motion reaches -0.13739583333333333 at 0.525 s, beyond -0.01: stay inside or move \
             limits.min_position",
        ),
        (
            refused(&[to(rest(2.0)), to(State { velocity: 0.25, ..rest(1.0) })], phase, Timing::default()),
            "axes[1].goal.velocity: is 0.25, and the straight line needs 0: give it that, or let the axes arrive together \
             without a line",
        ),
    ];
    for (given, expected) in rows {
        assert_eq!(given, expected);
    }
}

/// All standing still: nothing, or as long as is asked.
#[test]
fn nothing_to_do() {
    let within = Limits::try_from(limits(1.0, 2.0)).unwrap();
    let there = AxisTransfer::within_limits(rest(5.0), rest(5.0), &within).unwrap();
    for how in [Synchronization::None, Synchronization::Time, Synchronization::Phase] {
        let mut transits = Vec::new();
        let agreed = together(&[there, there], how, Timing::default(), &mut transits).unwrap();
        assert_eq!(agreed.duration, 0.0);
        let agreed = together(&[there, there], how, at_least(Some(2.0)), &mut transits).unwrap();
        assert_eq!((agreed.duration, agreed.critical), (2.0, None));
        assert!(
            transits.iter().all(|transit| transit.at(1.0).state == rest(5.0) && transit.end() == rest(5.0))
        );
    }
}

/// What is told about several axes is told in any unit, seen from the other side and run backwards.
#[test]
fn in_any_unit_and_from_either_side() {
    let mut random = Random(13);
    for kind in [Kind::Ordinary, Kind::Decades, Kind::Borders, Kind::Outside] {
        for _ in 0..300 {
            let mut asked = questions(&mut random, kind, 3);
            for one in &mut asked {
                one.goal.position -= one.start.position;
                one.start.position = 0.0;
            }
            let (ours, _) = planned(&asked, Synchronization::Time, Timing::default());
            let same = |what: &str, other: &[Question], time: f64| {
                let (other, _) = planned(other, Synchronization::Time, Timing::default());
                let off = (ours.duration - other.duration / time).abs();
                assert!(off <= SLACK * ours.duration + NOTHING, "{what}: {ours:?} and {other:?}: {asked:?}");
            };
            let (length, time) = (random.decades(1e-6, 1e6), random.decades(1e-6, 1e6));
            same("scaled", &asked.iter().map(|one| one.scaled(length, time)).collect::<Vec<_>>(), time);
            same("mirrored", &asked.iter().map(|one| one.mirrored().unwrap()).collect::<Vec<_>>(), 1.0);
            if kind != Kind::Outside {
                same("reversed", &asked.iter().map(Question::reversed).collect::<Vec<_>>(), 1.0);
            }
        }
    }
}
