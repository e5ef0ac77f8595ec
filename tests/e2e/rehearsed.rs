//! Operations between a session and a buffer, in simulated time: any script, any delay, lead and batch.

use e2e::{Answer, Delays, Rig, difference, move_of, open, planned, replay};
use planner::motion::Operation as Planned;
use planner::motion::Points;
use planner::{LimitsSpec, Setpoint, State};
use proptest::prelude::*;
use proto::stream::{Ask, GoalSpec, Open, Operation, OperationResult, Phase, StreamEventKind};
use proto::{Reason, Rejected};

fn rig(stay_open: bool, delay: u64) -> Rig {
    let open = Open { close_at_rest: !stay_open, ..open("cell-7/x", planned(move_of(0.05, 0.25))) };
    Rig::new(open, Delays::up_to(delay, 7))
}

fn goal(position: f64) -> Ask {
    Ask::Retarget(vec![GoalSpec { axis: "x".into(), goal: Some(State::at_rest(position)), limits: None }])
}

fn result(rig: &Rig, id: &str) -> Result<OperationResult, Rejected> {
    let mut found = rig.answers.iter().filter(|answer| answer.0 == id);
    let answer = found.next().unwrap_or_else(|| panic!("{id} was not answered")).1.clone();
    assert!(found.next().is_none(), "{id} was answered twice");
    answer
}

/// What an axis plays is what the planner says, bit for bit, whatever came in which batch.
fn assert_replays(rig: &Rig, done: &[(u64, Planned)]) {
    let plan = planned(move_of(0.05, 0.25));
    let (played, digest, motion) = replay(&plan, done, rig.executed());
    assert_eq!(difference(&rig.played[1..], &played), None);
    assert_eq!(*rig.digests.last().unwrap(), digest);
    assert_eq!(rig.session().motion().under_way, motion);
}

/// p, v and a go on without a jump, and within limits, from each cycle to the next.
fn assert_smooth(rig: &Rig, limits: &LimitsSpec) {
    let (t, scale) = (1e-3, 4.0 * f64::EPSILON * 10.0);
    for (cycle, pair) in rig.played.windows(2).enumerate() {
        for (before, next) in pair[0].iter().zip(&pair[1]) {
            let (p, q): (State, State) = (before.state, next.state);
            let jerk = limits.max_jerk * (1.0 + 1e-6);
            let da = (q.acceleration - p.acceleration).abs();
            let dv = (q.velocity - p.velocity - 0.5 * t * (p.acceleration + q.acceleration)).abs();
            let dp = (q.position - p.position - 0.5 * t * (p.velocity + q.velocity)).abs();
            assert!(da <= jerk * t + scale, "acceleration jumps in cycle {cycle}: {before:?} {next:?}");
            assert!(dv <= jerk * t * t / 4.0 + scale, "velocity jumps in cycle {cycle}: {before:?} {next:?}");
            assert!(
                dp <= jerk * t * t * t / 12.0 + scale,
                "position jumps in cycle {cycle}: {before:?} {next:?}"
            );
            assert!(q.velocity.abs() <= limits.max_velocity * (1.0 + 1e-9));
            assert!(q.acceleration.abs() <= limits.max_acceleration * (1.0 + 1e-9));
        }
    }
}

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..LimitsSpec::default() }
}

fn last(rig: &Rig) -> Setpoint {
    rig.played.last().unwrap()[0]
}

#[test]
fn a_hold_comes_to_rest_and_is_resumed() {
    let mut rig = rig(false, 0);
    rig.run_to(100);
    rig.ask(Operation::now("h1", Ask::Hold));
    rig.run_to_answers(1);
    let held = result(&rig, "h1").unwrap();
    assert!(held.on_path && held.revision == 1 && held.effective_cycle > 100);
    assert!(rig.executed() <= 103, "confirmed within three cycles, not at {}", rig.executed());
    rig.run_to(held.rest_cycle + 200);
    assert_eq!(rig.session().phase(), Phase::Holding);
    assert_eq!(last(&rig).words()[1..], [0.0; 3]);
    assert!(rig.ended.is_none(), "what is held does not close at rest");
    rig.ask(Operation::now("r1", Ask::Resume));
    rig.run_to(u64::MAX);
    assert_eq!(rig.ended, Some(Ok(())));
    let resumed = result(&rig, "r1").unwrap();
    assert_eq!((resumed.revision, resumed.rest_cycle), (2, rig.executed()));
    assert_eq!(last(&rig).words(), [0.05, 0.0, 0.0, 0.0]);
    assert_smooth(&rig, &limits());
    assert_replays(
        &rig,
        &[(held.effective_cycle, Planned::Hold), (resumed.effective_cycle, Planned::Resume)],
    );
    assert_eq!(rig.buffer().counters().underruns, 0);
    assert_eq!(rig.buffer().counters().refused_batches, 0);
}

#[test]
fn a_stop_ends_the_stream() {
    let mut rig = rig(true, 3);
    rig.run_to(100);
    rig.ask(Operation::now("s1", Ask::Stop));
    rig.run_to_answers(1);
    assert_eq!(rig.session().phase(), Phase::Stopping);
    for ask in [Ask::Hold, Ask::Resume, Ask::Override(0.5), goal(0.1)] {
        rig.ask(Operation::now(format!("{ask:?}"), ask));
    }
    rig.run_to_answers(5);
    for (id, answer) in &rig.answers[1..] {
        assert_eq!(answer.as_ref().unwrap_err().reason, Reason::Stopped, "{id}");
    }
    rig.run_to(u64::MAX);
    let stopped = result(&rig, "s1").unwrap();
    assert_eq!(rig.ended, Some(Ok(())));
    assert!(rig.executed() >= stopped.rest_cycle);
    assert_eq!(last(&rig).words()[1..], [0.0; 3]);
    assert_eq!(rig.events.last().map(|event| event.kind), Some(StreamEventKind::Finished));
    assert_smooth(&rig, &limits());
    assert_replays(&rig, &[(stopped.effective_cycle, Planned::Stop)]);
}

#[test]
fn a_stream_that_stands_still_goes_on_to_the_next_goal() {
    let mut rig = rig(true, 2);
    rig.run_to(500);
    assert_eq!(rig.session().phase(), Phase::Standstill);
    rig.ask(Operation::now("g1", goal(0.2)));
    rig.run_to_answers(1);
    let there = result(&rig, "g1").unwrap();
    rig.run_to(there.rest_cycle);
    assert_eq!(last(&rig).words(), [0.2, 0.0, 0.0, 0.0]);
    rig.run_to(there.rest_cycle + 60);
    let standstills: Vec<u64> = rig.events.iter().map(|event| event.at_cycle).collect();
    assert_eq!(standstills, [314, there.rest_cycle]);
    rig.ask(Operation::now("s1", Ask::Stop));
    rig.run_to(u64::MAX);
    assert_eq!(rig.ended, Some(Ok(())));
    assert_eq!(result(&rig, "s1").unwrap().revision, 2);
    assert_smooth(&rig, &limits());
}

#[test]
fn the_same_request_again_has_the_same_answer_and_no_second_effect() {
    let mut rig = rig(true, 1);
    rig.run_to(60);
    rig.ask(Operation::now("o1", Ask::Override(0.5)));
    rig.ask(Operation::now("o1", Ask::Override(0.5)));
    rig.command(1, Operation::now("o1", Ask::Override(0.5)));
    rig.run_to_answers(2);
    rig.run_to(200);
    let once = result(&rig, "o1").unwrap();
    assert_eq!(rig.commanded, [(1, Ok(once.clone()))]);
    rig.ask(Operation::now("o2", Ask::Override(1.0)));
    rig.run_to_answers(3);
    rig.answers.clear();
    rig.ask(Operation::now("o1", Ask::Override(0.5)));
    rig.run_to(300);
    assert_eq!(result(&rig, "o1"), Ok(once));
    assert_eq!(rig.buffer().revision(), 2);
    // What changed nothing is remembered too: a hold of what is held does not hold again what was resumed.
    for (id, ask) in [("h1", Ask::Hold), ("h2", Ask::Hold), ("r1", Ask::Resume)] {
        rig.ask(Operation::now(id, ask));
    }
    rig.run_to(rig.executed() + 200);
    let (held, again) = (result(&rig, "h1").unwrap(), result(&rig, "h2").unwrap());
    assert_eq!((held.revision, again.revision), (3, 3));
    rig.answers.clear();
    rig.ask(Operation::now("h2", Ask::Hold));
    rig.run_to(rig.executed() + 50);
    assert_eq!(result(&rig, "h2"), Ok(again));
    assert_eq!(rig.session().motion().under_way.phase(), Phase::Moving);
}

#[test]
fn an_id_that_was_used_is_not_used_for_something_else() {
    let mut rig = rig(true, 1);
    rig.run_to(60);
    rig.ask(Operation::now("a", Ask::Override(0.5)));
    rig.run_to(62);
    // While it is under way, and when it is done.
    rig.ask(Operation::now("a", Ask::Hold));
    rig.command(1, Operation::now("a", Ask::Override(0.25)));
    rig.run_to_answers(3);
    rig.ask(Operation::now("a", Ask::Stop));
    rig.run_to_answers(4);
    let reused = |answer: &Answer| answer.1.as_ref().is_err_and(|why| why.reason == Reason::RequestIdReused);
    assert_eq!(rig.answers.iter().filter(|answer| reused(answer)).count(), 2);
    assert_eq!(rig.commanded[0].1.as_ref().unwrap_err().reason, Reason::RequestIdReused);
    assert!(rig.answers.iter().any(|answer| answer.1.is_ok()));
    assert_eq!(rig.buffer().revision(), 1);
    // When it is to be done does not make it another one.
    rig.ask(Operation { not_before_cycle: Some(7), ..Operation::now("a", Ask::Override(0.5)) });
    rig.run_to_answers(5);
    assert!(rig.answers.last().unwrap().1.is_ok());
}

#[test]
fn what_cannot_be_done_is_refused_and_the_stream_goes_on_unharmed() {
    let mut spec = move_of(0.05, 0.25);
    spec.axes[0].limits.max_position = Some(0.1);
    let plan = planned(spec);
    let mut rig = Rig::new(open("x", plan.clone()), Delays::up_to(1, 3));
    rig.run_to(50);
    let lower = LimitsSpec { max_jerk: -1.0, ..limits() };
    let bad_limits = GoalSpec { axis: "x".into(), goal: Some(State::at_rest(0.06)), limits: Some(lower) };
    let unknown = GoalSpec { axis: "y".into(), goal: Some(State::at_rest(0.06)), limits: None };
    // Only its limits are to change: without a word it would go to zero.
    let nowhere = GoalSpec { axis: "x".into(), goal: None, limits: Some(limits()) };
    let rows = [
        (Some(Ask::Override(f64::NAN)), Reason::OverrideOutOfRange, "set_override.factor"),
        (Some(Ask::Override(-1.0)), Reason::OverrideOutOfRange, "set_override.factor"),
        (Some(Ask::Override(1e9)), Reason::OverrideOutOfRange, "set_override.factor"),
        (Some(goal(0.2)), Reason::GoalOutsideLimits, "retarget.goals[0].goal.position"),
        (Some(goal(f64::INFINITY)), Reason::NotFinite, "retarget.goals[0].goal.position"),
        (
            Some(Ask::Retarget(vec![bad_limits])),
            Reason::LimitNotPositive,
            "retarget.goals[0].limits.max_jerk",
        ),
        (Some(Ask::Retarget(vec![nowhere])), Reason::FieldMissing, "retarget.goals[0].goal"),
        (Some(Ask::Retarget(vec![unknown])), Reason::UnknownAxis, "retarget.goals[0].axis"),
        (Some(Ask::Append(Points { axes: Vec::new(), last: false })), Reason::ProtocolOrder, "append_pvt"),
        (None, Reason::ProtocolOrder, ""),
    ];
    for (index, (ask, ..)) in rows.iter().enumerate() {
        let ask = ask.clone();
        rig.ask(Operation { request_id: index.to_string(), not_before_cycle: None, ask });
    }
    rig.ask(Operation::now("", Ask::Hold));
    rig.ask(Operation { not_before_cycle: Some(u64::MAX), ..Operation::now("far", Ask::Hold) });
    rig.run_to(u64::MAX);
    for (index, (_, reason, field)) in rows.iter().enumerate() {
        let rejected = result(&rig, &index.to_string()).unwrap_err();
        let place = rejected.fields.first().map_or("", |violation| violation.field.as_str());
        assert_eq!((rejected.reason, place), (*reason, *field), "{rejected}");
    }
    assert_eq!(result(&rig, "").unwrap_err().reason, Reason::NameInvalid);
    assert_eq!(result(&rig, "far").unwrap_err().reason, Reason::ValueOutOfRange);
    let (_, digest, _) = replay(&plan, &[], rig.executed());
    assert_eq!(*rig.digests.last().unwrap(), digest);
    assert_eq!(rig.buffer().revision(), 0);
}

#[test]
fn a_scheduled_operation_waits_for_its_cycle_and_is_superseded_by_one_that_is_done_before() {
    let at = |id: &str, cycle, ask| Operation { not_before_cycle: Some(cycle), ..Operation::now(id, ask) };
    let mut rig = rig(false, 1);
    rig.ask(at("h", 150, Ask::Hold));
    rig.run_to(250);
    assert_eq!(result(&rig, "h").unwrap().effective_cycle, 150);
    rig.ask(at("r", 3, Ask::Resume));
    rig.run_to_answers(2);
    let resumed = result(&rig, "r").unwrap();
    assert!(resumed.effective_cycle > 250, "a cycle that is past is the next that can be");
    rig.ask(at("first", resumed.effective_cycle + 80, Ask::Override(0.5)));
    rig.ask(at("second", resumed.effective_cycle + 40, Ask::Hold));
    rig.run_to_answers(4);
    let rejected = result(&rig, "first").unwrap_err();
    assert_eq!((rejected.reason, rejected.metadata["by"].as_str()), (Reason::Superseded, "second"));
    assert_eq!(result(&rig, "second").unwrap().effective_cycle, resumed.effective_cycle + 40);
}

#[test]
fn what_is_lost_on_the_way_is_planned_again() {
    let mut rig = rig(false, 1);
    rig.run_to(100);
    rig.ask(Operation::now("h1", Ask::Hold));
    while !rig.session().has_output() && rig.buffer().revision() == 0 && rig.executed() < 104 {
        rig.tick();
    }
    rig.lose_what_is_on_its_way();
    rig.run_to(250);
    assert!(result(&rig, "h1").is_ok());
    assert_eq!(rig.buffer().counters().underruns, 0);
    assert_smooth(&rig, &limits());
}

#[test]
fn a_session_that_ends_answers_what_waits() {
    let mut rig = rig(true, 0);
    rig.run_to(50);
    rig.command(9, Operation { not_before_cycle: Some(5000), ..Operation::now("later", Ask::Hold) });
    rig.close();
    rig.run_to(60);
    let (ticket, answer) = &rig.commanded[0];
    assert_eq!((*ticket, answer.as_ref().unwrap_err().reason), (9, Reason::NotConfirmed));
}

#[test]
fn an_operation_after_the_last_cycle_of_a_stream_that_closes_is_too_late() {
    let mut rig = rig(false, 0);
    rig.ask(Operation { not_before_cycle: Some(330), ..Operation::now("late", goal(0.1)) });
    rig.run_to(u64::MAX);
    assert_eq!(result(&rig, "late").unwrap_err().reason, Reason::StreamFinished);
    assert_eq!(rig.executed(), 314);
}

/// One operation, and after how many cycles it is asked.
fn any_step() -> impl Strategy<Value = (u64, Option<u64>, Ask)> {
    let ask = prop_oneof![
        3 => Just(Ask::Hold),
        4 => Just(Ask::Resume),
        2 => prop_oneof![Just(0.0), Just(1.0), 0.05..1.0].prop_map(Ask::Override),
        2 => (-0.3..0.3).prop_map(goal),
        1 => Just(Ask::Override(f64::NAN)),
    ];
    (0..120_u64, proptest::option::weighted(0.2, 0..600_u64), ask)
}

fn planned_operation(ask: &Ask) -> Planned {
    Operation::now("x", ask.clone()).planned().unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1_000, ..ProptestConfig::default() })]

    #[test]
    fn any_script_is_played_as_planned(
        steps in proptest::collection::vec(any_step(), 1..12), delay in 0..6_u64, seed: u64, lead in 24..=80_u32,
        batch in 1..=14_u32, stops: bool,
    ) {
        let plan = planned(move_of(0.05, 0.25));
        let open = Open {
            lead_cycles: lead, batch_cycles: batch, close_at_rest: false, ..open("x", plan.clone())
        };
        let mut rig = Rig::new(open, Delays::up_to(delay, seed));
        let mut asked = Vec::new();
        let mut cycle = 0;
        for (index, (after, ahead, ask)) in steps.into_iter().enumerate() {
            cycle += after;
            rig.run_to(cycle);
            let not_before_cycle = ahead.map(|ahead| rig.executed() + ahead);
            let request_id = index.to_string();
            rig.ask(Operation { request_id, not_before_cycle, ask: Some(ask.clone()) });
            asked.push(ask);
        }
        rig.run_to(cycle + 700);
        let last = if stops { Ask::Stop } else { Ask::Override(1.0) };
        rig.ask(Operation::now("last", last.clone()));
        rig.run_to_answers(asked.len() + 1);
        let rest = rig.session().motion().last_cycle();
        rig.run_to(rest + 30);

        prop_assert!(!matches!(rig.ended, Some(Err(_))), "{:?}", rig.ended);
        // Every operation was answered exactly once.
        let mut answered: Vec<&str> = rig.answers.iter().map(|answer| answer.0.as_str()).collect();
        answered.sort_unstable();
        let mut ids: Vec<String> = (0..asked.len()).map(|index| index.to_string()).collect();
        ids.push("last".into());
        ids.sort_unstable();
        prop_assert_eq!(&answered, &ids);

        let (mut done, mut revision): (Vec<(u64, Planned)>, u64) = (Vec::new(), 0);
        for (id, answer) in &rig.answers {
            let ask = id.parse::<usize>().map_or(&last, |index| &asked[index]);
            match answer {
                Ok(result) if result.revision == revision => {}
                Ok(result) => {
                    prop_assert_eq!(result.revision, revision + 1);
                    revision += 1;
                    done.push((result.effective_cycle, planned_operation(ask)));
                }
                Err(rejected) => {
                    let expected = match ask {
                        Ask::Override(factor) if factor.is_nan() => Reason::OverrideOutOfRange,
                        _ => Reason::Superseded,
                    };
                    prop_assert_eq!(rejected.reason, expected, "{}", rejected);
                }
            }
        }
        // It was played as the planner says, and nothing was missing.
        let (played, digest, motion) = replay(&plan, &done, rig.executed());
        prop_assert_eq!(difference(&rig.played[1..], &played), None, "{:?}", done);
        prop_assert_eq!(*rig.digests.last().unwrap(), digest);
        prop_assert_eq!(&rig.session().motion().under_way, &motion);
        prop_assert_eq!(rig.buffer().counters().underruns, 0);
        prop_assert_eq!(rig.buffer().revision(), revision);
        assert_smooth(&rig, &limits());
        // It ends at rest.
        prop_assert_eq!(&rig.played.last().unwrap()[0].words()[1..], &[0.0; 3]);
    }
}
