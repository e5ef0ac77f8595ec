//! Operations on motions of several axes between a session and a buffer, in simulated time: axes that arrive together, that keep to a
//! straight line, and that go through points which are appended to.

use e2e::{Delays, Rig, difference, open, replay};
use planner::motion::{AxisPoints, Operation as Planned, Points};
use planner::{
    Accepted, AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, PvtAxisSpec, PvtInterpolation, PvtPolicy,
    PvtRequest, PvtRequestSpec, Request, RequestSpec, ShortPathPolicy, State, Synchronization, plan_pvt,
};
use proptest::prelude::*;
use proto::Reason;
use proto::stream::{Ask, GoalSpec, Open, Operation};

const BEAT: f64 = 0.05;

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..LimitsSpec::default() }
}

/// How the two axes go together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Time,
    Line,
    Points,
}

pub(crate) fn opened(kind: Kind) -> Accepted {
    let plan = match kind {
        Kind::Time => {
            moved(Synchronization::Time, State { velocity: 0.05, acceleration: 0.4, ..State::at_rest(0.3) })
        }
        Kind::Line => moved(Synchronization::Phase, State::at_rest(0.3)),
        Kind::Points => through_points(),
    };
    Judged::new(plan).accepted().unwrap()
}

fn moved(synchronization: Synchronization, start: State) -> planner::Plan {
    let axis = |name: &str, start: State, goal: f64| AxisMoveSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        start,
        goal: State::at_rest(goal),
        limits: limits(),
    };
    let spec = RequestSpec {
        axes: vec![axis("x", State::at_rest(0.0), 0.12), axis("y", start, 0.27)],
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reverse),
        synchronization: Ok(synchronization),
        minimum_duration: None,
        end_on_cycle: false,
    };
    planner::plan(&Request::try_from(spec).unwrap()).unwrap()
}

/// Where a target is at a point of the beat, and how fast.
fn target(axis: usize, point: usize) -> (f64, f64) {
    let (size, t) = (0.03 * (axis + 1) as f64, BEAT * point as f64);
    (size * (1.0 - (2.5 * t).cos()), size * 2.5 * (2.5 * t).sin())
}

pub(crate) fn points(from: usize, to: usize) -> Points {
    let axes = ["x", "y"].iter().enumerate().map(|(axis, name)| AxisPoints {
        axis: (*name).into(),
        times: (1..=to - from).map(|point| BEAT * point as f64).collect(),
        positions: (from + 1..=to).map(|point| target(axis, point).0).collect(),
        velocities: (from + 1..=to).map(|point| target(axis, point).1).collect(),
    });
    Points { axes: axes.collect(), last: false }
}

pub(crate) const FIRST_POINTS: usize = 8;

fn through_points() -> planner::Plan {
    let axes =
        points(0, FIRST_POINTS).axes.into_iter().map(|AxisPoints { axis, times, positions, velocities }| {
            let (kind, start) = (Ok(AxisKind::Prismatic), State::at_rest(0.0));
            PvtAxisSpec { axis, kind, limits: limits(), start, times, positions, velocities }
        });
    let spec = PvtRequestSpec {
        axes: axes.collect(),
        cycle_time_ns: None,
        interpolation: Ok(PvtInterpolation::SShaped),
        policy: Ok(PvtPolicy::PreferVelocity),
        finish_unreached: false,
    };
    plan_pvt(&PvtRequest::try_from(spec).unwrap()).unwrap().plan().clone()
}

/// p, v and a go on without a jump from each cycle to the next; what comes again after a splice has the roundings of another polynomial.
fn assert_smooth(rig: &Rig) {
    let (t, scale, jerk) = (1e-3, 1e-12, limits().max_jerk * (1.0 + 1e-6));
    for (cycle, pair) in rig.played.windows(2).enumerate() {
        for (before, next) in pair[0].iter().zip(&pair[1]) {
            let (p, q): (State, State) = (before.state, next.state);
            let da = (q.acceleration - p.acceleration).abs();
            let dv = (q.velocity - p.velocity - 0.5 * t * (p.acceleration + q.acceleration)).abs();
            let dp = (q.position - p.position - 0.5 * t * (p.velocity + q.velocity)).abs();
            let fits = da <= jerk * t + 1e-9
                && dv <= jerk * t * t / 4.0 + scale
                && dp <= jerk * t * t * t / 12.0 + scale;
            assert!(fits, "jumps in cycle {cycle}: {before:?} {next:?}");
            assert!(q.velocity.abs() <= limits().max_velocity * (1.0 + 1e-9));
            assert!(q.acceleration.abs() <= limits().max_acceleration * (1.0 + 1e-9));
        }
    }
}

fn goal(axis: &str, position: f64) -> GoalSpec {
    GoalSpec { axis: axis.into(), goal: Some(State::at_rest(position)), limits: None }
}

#[derive(Clone, Debug)]
enum Step {
    Ask(Ask),
    /// So many further points, for a motion through points.
    Append(usize),
}

fn any_step() -> impl Strategy<Value = (u64, Step)> {
    let step = prop_oneof![
        3 => Just(Step::Ask(Ask::Hold)),
        4 => Just(Step::Ask(Ask::Resume)),
        3 => prop_oneof![Just(0.0), Just(1.0), 0.05..1.0].prop_map(|factor| Step::Ask(Ask::Override(factor))),
        1 => (-0.1..0.3, 0.0..0.4).prop_map(|(x, y)| Step::Ask(Ask::Retarget(vec![goal("x", x), goal("y", y)]))),
        4 => (1..5_usize).prop_map(Step::Append),
    ];
    (0..120_u64, step)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_script_on_a_path_is_played_as_planned(
        kind in prop_oneof![Just(Kind::Time), Just(Kind::Line), Just(Kind::Points)],
        steps in proptest::collection::vec(any_step(), 1..8), delay in 0..6_u64, seed: u64, stops: bool,
    ) {
        let plan = opened(kind);
        let open = Open { close_at_rest: false, ..open("x", plan.clone()) };
        let mut rig = Rig::new(open, Delays::up_to(delay, seed));
        let (mut asked, mut cycle, mut known) = (Vec::new(), 0, FIRST_POINTS);
        for (index, (after, step)) in steps.into_iter().enumerate() {
            cycle += after;
            rig.run_to(cycle);
            let ask = match step {
                Step::Ask(ask) => ask,
                Step::Append(_) if kind != Kind::Points => continue,
                Step::Append(count) => {
                    known += count;
                    Ask::Append(points(known - count, known))
                }
            };
            rig.ask(Operation::now(index.to_string(), ask.clone()));
            asked.push((index.to_string(), ask));
        }
        rig.run_to(cycle + 300);
        let last = if stops { Ask::Stop } else { Ask::Override(1.0) };
        rig.ask(Operation::now("last", last.clone()));
        asked.push(("last".into(), last));
        rig.run_to_answers(asked.len());
        let rest = rig.session().motion().last_cycle();
        rig.run_to(rest + 30);

        prop_assert!(!matches!(rig.ended, Some(Err(_))), "{:?}", rig.ended);
        prop_assert_eq!(rig.answers.len(), asked.len());
        let (mut done, mut revision): (Vec<(u64, Planned)>, u64) = (Vec::new(), 0);
        for (id, answer) in &rig.answers {
            let ask = &asked.iter().find(|asked| asked.0 == *id).unwrap().1;
            match answer {
                Ok(result) if result.revision == revision => {}
                Ok(result) => {
                    prop_assert_eq!(result.revision, revision + 1);
                    revision += 1;
                    let planned = Operation::now("x", ask.clone()).planned().unwrap();
                    done.push((result.effective_cycle, planned));
                }
                Err(rejected) => {
                    let expected: &[Reason] = match ask {
                        // Of points after those of a retarget there is nothing to go on through; beside the line there is nowhere to go.
                        Ask::Append(_) => &[Reason::AppendTooLate, Reason::ProtocolOrder, Reason::PvtUnreachable],
                        Ask::Retarget(_) => &[Reason::PhaseSynchronizationImpossible, Reason::Superseded],
                        // Goals beside the line are gone to from rest alone.
                        _ if kind == Kind::Line => &[Reason::PhaseSynchronizationImpossible, Reason::Superseded],
                        _ => &[Reason::Superseded],
                    };
                    prop_assert!(expected.contains(&rejected.reason), "{ask:?}: {rejected}");
                }
            }
        }
        let (played, digest, motion) = replay(&plan, &done, rig.executed());
        prop_assert_eq!(difference(&rig.played[1..], &played), None, "{:?}", done);
        prop_assert_eq!(*rig.digests.last().unwrap(), digest);
        prop_assert_eq!(&rig.session().motion().under_way, &motion);
        prop_assert_eq!(rig.buffer().counters().underruns, 0);
        prop_assert_eq!(rig.buffer().counters().refused_batches, 0);
        assert_smooth(&rig);
        prop_assert!(rig.played.last().unwrap().iter().all(|axis| axis.words()[1..] == [0.0; 3]));
    }
}
