//! Several axes and what they hold, cycle by cycle: no network, no clock, no thread.
#![expect(clippy::unwrap_used, reason = "helpers of tests are tests")]

use client::{Buffer, Record, Revision, Standing};
use planner::{
    Accepted, AxisKind, AxisMoveSpec, Judged, LimitsSpec, Request, RequestSpec, Setpoint, State,
    Synchronization,
};
use proto::Digest;
use proto::stream::{Batch, Columns, Motion, RefusalReason, Refused};
use sim_axis::{Axis, AxisConfig, AxisModel, Beat, Divergence, Observation, Player, ReportCard};

const EPOCH: u64 = 7;
const LEAD: u64 = 40;
const BATCH: u64 = 10;
const SETTLE_WINDOW: f64 = 0.05;
const SETTLE_CYCLES: usize = 50;

/// Moves of axes `a`, `b`, ... by `distances`, each on its own time.
fn plan(distances: &[f64]) -> Accepted {
    let limits =
        LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..LimitsSpec::default() };
    let axis = |(name, distance): (char, &f64)| AxisMoveSpec {
        axis: name.into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(*distance),
        limits: limits.clone(),
    };
    let spec = RequestSpec {
        axes: ('a'..).zip(distances).map(axis).collect(),
        cycle_time_ns: None,
        family: Ok(planner::Family::SCurve),
        order: None,
        short_path: Ok(planner::ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    };
    Judged::answer(&Request::try_from(spec).unwrap()).unwrap().accepted().unwrap()
}

/// Some 50 mm, as demonstrations have it: 314 cycles.
fn short() -> Accepted {
    plan(&[0.05])
}

fn player(plan: &Accepted) -> Player {
    let plan = plan.plan();
    let setpoints: Vec<Setpoint> = plan.sampler().at(0).collect();
    let buffer = Buffer::new(&Standing {
        epoch: EPOCH,
        lead_cycles: LEAD as u32,
        axis_guard: 2,
        plan,
        setpoints: &setpoints,
    });
    let config = AxisConfig {
        cycle: plan.cycle_time().as_seconds(),
        settle_window: SETTLE_WINDOW,
        settle_tolerance: 1e-5,
    };
    let axis = |(axis, start): (&planner::AxisPlan, &Setpoint)| {
        Axis::new(&AxisModel::flexible(axis.axis.clone()), config, &start.state).unwrap()
    };
    let axes = plan.axes().iter().zip(&setpoints).map(axis).collect();
    Player::new(buffer, axes, plan.cycle_count(), BATCH)
}

/// A server without a network: makes the batches of a plan.
struct Source<'a> {
    plan: &'a Accepted,
    motion: Motion,
    digest: Digest,
    sent: u64,
    rests_on: bool,
}

impl<'a> Source<'a> {
    fn of(plan: &'a Accepted) -> Self {
        let motion = Motion::opened(planner::motion::Motion::open(plan.clone()).unwrap());
        Self { plan, motion, digest: Digest::ZERO, sent: 0, rests_on: false }
    }

    /// The next cycles through `to`; the last batch ends with the plan.
    fn through(&mut self, to: u64) -> Batch {
        let end = if self.rests_on { u64::MAX } else { self.plan.plan().cycle_count() };
        let (first, last) = (self.sent + 1, to.min(end));
        let columns = Columns::of_plan(self.plan.plan(), first..last + 1);
        self.digest = columns.digests(first, self.digest).last().unwrap();
        self.sent = last;
        let tails = self.motion.tails(last).unwrap();
        let (last, digest) = (last == end, self.digest);
        Batch { first_cycle: first, revision: 0, replaces: false, last, columns, digest, tails }
    }

    fn next(&mut self) -> Batch {
        self.through(self.sent + BATCH)
    }

    /// Sends all that `player` has room for.
    fn fill(&mut self, player: &mut Player) {
        while !self.is_done() && self.sent + BATCH <= player.buffer().executed() + LEAD {
            let mut batch = self.next();
            assert_eq!(player.accept(EPOCH, &mut batch), None);
        }
    }

    fn is_done(&self) -> bool {
        !self.rests_on && self.sent == self.plan.plan().cycle_count()
    }
}

/// What a run was, for comparing it with another.
#[derive(Debug, Default, PartialEq)]
struct Trace {
    played: Vec<(u64, Observation)>,
    starved: u64,
    rested: usize,
    cards: Vec<ReportCard>,
    digest: Digest,
}

/// One cycle after the other until the run is over; `bring` brings data before each.
fn run(player: &mut Player, mut bring: impl FnMut(&mut Player)) -> Trace {
    let mut trace = Trace::default();
    while !player.is_over() {
        bring(player);
        match player.cycle() {
            Beat::Played => {
                trace.played.push((player.cycle_number(), player.observations()[0]));
            }
            Beat::Starved => trace.starved += 1,
            Beat::Rested => trace.rested += 1,
            Beat::Waited | Beat::Diverged | Beat::Over => {}
        }
    }
    trace.cards = player.report_cards();
    trace.digest = player.digest();
    trace
}

fn undisturbed(plan: &Accepted) -> Trace {
    let (mut player, mut source) = (player(plan), Source::of(plan));
    run(&mut player, |player| source.fill(player))
}

/// From planner and digest alone.
fn digest_of(plan: &Accepted) -> Digest {
    let mut sampler = plan.plan().sampler();
    (1..=plan.plan().cycle_count()).fold(Digest::ZERO, |digest, cycle| {
        digest.then(cycle, sampler.at(cycle).map(|setpoint| setpoint.words()))
    })
}

#[test]
fn every_cycle_is_played_once_and_in_order_and_then_the_axis_settles() {
    let plan = short();
    let trace = undisturbed(&plan);
    let numbers: Vec<u64> = trace.played.iter().map(|(cycle, _)| *cycle).collect();
    assert_eq!(numbers, (1..=plan.plan().cycle_count()).collect::<Vec<_>>());
    assert_eq!((trace.starved, trace.rested), (0, SETTLE_CYCLES));
    assert_eq!(trace.digest, digest_of(&plan));
    let card = &trace.cards[0];
    assert!(card.max_following_error < 1e-5 && card.residual_vibration_amplitude > 1e-6, "{card:?}");
}

#[test]
fn execution_begins_with_a_full_lead_or_with_the_last_batch() {
    let plan = short();
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    for _ in 0..LEAD / BATCH {
        assert!(player.is_waiting() && player.is_short_of_data(u64::MAX));
        assert_eq!(player.cycle(), Beat::Waited);
        assert_eq!(player.accept(EPOCH, &mut source.next()), None);
    }
    assert_eq!(player.cycle(), Beat::Played);

    let tiny = self::plan(&[1e-7]);
    let (mut player, mut source) = (self::player(&tiny), Source::of(&tiny));
    assert!(tiny.plan().cycle_count() < LEAD);
    let batch = source.through(LEAD);
    assert!(batch.last);
    assert_eq!(player.accept(EPOCH, &mut batch.clone()), None);
    assert_eq!(player.cycle(), Beat::Played);
    assert_eq!(run(&mut player, |_| {}).digest, digest_of(&tiny));
}

#[test]
fn bursts_and_doubled_batches_change_nothing() {
    let plan = short();
    let expected = undisturbed(&plan);
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    let mut doubled = 0;
    let trace = run(&mut player, |player| {
        // Nothing until half the lead is gone, and then all that there is room for, each batch twice.
        let held = player.buffer().held();
        if player.is_waiting() || (held <= LEAD / 2 && !source.is_done()) {
            while !source.is_done() && source.sent + BATCH <= player.buffer().executed() + LEAD {
                let batch = source.next();
                assert_eq!(player.accept(EPOCH, &mut batch.clone()), None);
                assert_eq!(player.accept(EPOCH, &mut batch.clone()), None);
                doubled += batch.columns.cycles() as u64;
            }
        }
    });
    assert_eq!(trace, expected);
    assert_eq!(player.buffer().counters().duplicate_cycles, doubled);
}

/// A server that sends no more after a full lead.
fn starving(plan: &Accepted) -> (Player, Source<'_>) {
    let (mut player, mut source) = (player(plan), Source::of(plan));
    source.fill(&mut player);
    for _ in 0..LEAD {
        assert_eq!(player.cycle(), Beat::Played);
    }
    assert!(player.setpoints()[0].state.velocity > 0.0);
    (player, source)
}

#[test]
fn a_starved_axis_plays_its_way_to_rest_and_stands_there() {
    let plan = short();
    let (mut player, mut source) = starving(&plan);
    let rests = source.motion.under_way.tail(LEAD).unwrap().unwrap().motion;
    for cycle in LEAD + 1..=rests.last_cycle() {
        assert_eq!(player.cycle(), Beat::Played);
        let planned: Vec<Setpoint> = rests.setpoints(cycle).collect();
        assert_eq!(player.setpoints(), planned, "cycle {cycle}");
        let due = player.report_due();
        let tells = due.is_some_and(|report| report.tail_from_cycle == Some(LEAD + 1));
        assert!(tells || cycle > LEAD + 1, "the server is told at once");
    }
    let end = player.setpoints()[0].state;
    assert!(end.is_at_rest() && end.position < 0.05);
    for _ in 0..200 {
        assert_eq!(player.cycle(), Beat::Starved);
        assert_eq!(player.setpoints()[0], Setpoint::held(end));
    }
    assert_eq!(player.buffer().executed(), rests.last_cycle());
    assert_eq!((player.buffer().counters().underruns, player.tail_used()), (1, true));
    // What comes too late is of an epoch that is over.
    assert_eq!(player.accept(EPOCH, &mut source.next()), None);
    assert_eq!(
        (player.buffer().accepted(), player.buffer().counters().stale_epochs),
        (rests.last_cycle(), 1)
    );
}

/// Whatever was played on the way to rest, a server that is told of it goes on after it.
#[test]
fn a_server_goes_on_after_the_way_to_rest() {
    let plan = short();
    // At once, on the way, at its end, and long after it.
    for after in [0, 1, 60, 500] {
        let (mut player, source) = starving(&plan);
        let mut record = Record::opened(source.motion.clone());
        let mut again = Source::of(&plan);
        while again.sent < LEAD {
            record.carry(&again.next());
        }
        record.report(&player.buffer().report(None));
        player.cycle();
        let report = player.report_due().unwrap();
        let end = record.starve(report.tail_from_cycle.unwrap() - 1, report.digest).unwrap();
        let resume = record.resume();
        assert_eq!((resume.digest, resume.recomputed()), (end, end));
        for _ in 0..after {
            player.cycle();
        }
        let rests = record.motion().clone();
        assert_eq!(resume.next_cycle, rests.last_cycle() + 1);
        player.goes_on(EPOCH + 1, Some((Revision::of(&rests), end)));
        assert_eq!(player.report_due().unwrap().digest, end);
        // It stands still for a while, and goes on to the goal.
        let at = rests.last_cycle() + 7;
        let resumed = rests.under_way.splice(at, &planner::motion::Operation::Resume).unwrap().motion;
        let mut digest = end;
        let mut next = |from: u64, to: u64, of: &planner::motion::Motion, replaces: bool| {
            let mut columns = Columns::with_capacity((to - from + 1) as usize, 1);
            for cycle in from..=to {
                of.setpoints(cycle).for_each(|setpoint| columns.push(setpoint));
            }
            digest = columns.digests(from, digest).last().unwrap();
            let motion = Motion::opened(of.clone());
            let (revision, tails) = (of.revision(), motion.tails(to).unwrap());
            Batch { first_cycle: from, revision, replaces, last: false, columns, digest, tails }
        };
        let stands = next(resume.next_cycle, at - 1, &rests.under_way, false);
        let goes = next(at, at + 9, &resumed, false);
        // No sooner than there is room for it.
        while player.buffer().executed() + LEAD < at + 9 {
            player.cycle();
        }
        assert_eq!(player.accept(EPOCH + 1, &mut stands.clone()), None, "{after}");
        let motion = Motion { under_way: resumed.clone(), digest_before: stands.digest, ..rests.clone() };
        player.announce(EPOCH + 1, Revision::of(&motion));
        assert_eq!(player.accept(EPOCH + 1, &mut goes.clone()), None, "{after}");
        while player.buffer().held() > 0 {
            assert_eq!(player.cycle(), Beat::Played);
        }
        let at_last: Vec<Setpoint> = resumed.setpoints(at + 9).collect();
        assert_eq!(player.setpoints(), at_last, "{after}");
        assert_eq!(player.digest(), goes.digest);
        assert_eq!(player.buffer().counters().underruns, 1);
    }
}

#[test]
fn a_gap_is_refused_once_and_mended_by_sending_again() {
    let plan = short();
    let expected = undisturbed(&plan);
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    let sent: Vec<Batch> = (0..4).map(|_| source.next()).collect();
    assert_eq!(player.accept(EPOCH, &mut sent[0].clone()), None);
    let report = player.accept(EPOCH, &mut sent[2].clone()).unwrap();
    assert_eq!(report.refused, Some(Refused { revision: 0, first_cycle: 21, reason: RefusalReason::Gap }));
    assert_eq!((report.accepted_cycle, report.executed_cycle), (10, 0));
    // It was on its way when the gap was noticed: counted, not told.
    assert_eq!(player.accept(EPOCH, &mut sent[3].clone()), None);
    // It is sent again and there is a gap again: told again.
    assert!(player.accept(EPOCH, &mut sent[2].clone()).is_some());
    assert_eq!(player.buffer().counters().refused_batches, 3);
    for batch in &sent[1..] {
        assert_eq!(player.accept(EPOCH, &mut batch.clone()), None);
    }
    assert_eq!(run(&mut player, |player| source.fill(player)), expected);
}

#[test]
fn a_jump_is_refused_and_what_is_held_is_kept() {
    let plan = short();
    let expected = undisturbed(&plan);
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    let honest = source.next();
    let [mut position, velocity, acceleration, jerk] = honest.columns.clone().into_parts();
    position[4] += 1e-6;
    let columns = Columns::from_parts(10, [position, velocity, acceleration, jerk]).unwrap();
    let digest = columns.digests(1, Digest::ZERO).last().unwrap();
    let jumps = Batch { columns, digest, ..honest.clone() };
    let report = player.accept(EPOCH, &mut jumps.clone()).unwrap();
    assert_eq!(report.refused.unwrap().reason, RefusalReason::JoinMismatch);
    let wrong = Batch { digest: Digest::ZERO, ..honest.clone() };
    let report = player.accept(EPOCH, &mut wrong.clone()).unwrap();
    assert_eq!(report.refused.unwrap().reason, RefusalReason::DigestMismatch);
    assert_eq!(player.accept(EPOCH, &mut honest.clone()), None);
    assert_eq!(run(&mut player, |player| source.fill(player)), expected);
}

#[test]
fn another_epoch_is_not_ours() {
    let plan = short();
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    assert_eq!(player.accept(EPOCH - 1, &mut source.next()), None);
    assert_eq!(player.buffer().accepted(), 0);
    assert_eq!(player.buffer().counters().stale_epochs, 1);
}

#[test]
fn reports_come_every_batch_and_at_the_end() {
    let plan = short();
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    let mut executed = Vec::new();
    while !player.is_over() {
        source.fill(&mut player);
        player.cycle();
        if let Some(report) = player.report_due() {
            assert_eq!(report.grant_cycle, report.executed_cycle + LEAD);
            executed.push(report.executed_cycle);
        }
    }
    let end = plan.plan().cycle_count();
    let expected: Vec<u64> = (1..).map(|n| n * BATCH).take_while(|cycle| *cycle < end).chain([end]).collect();
    assert_eq!(executed, expected);
}

#[test]
fn a_stream_that_breaks_off_is_played_to_its_end_and_to_rest() {
    let plan = short();
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    source.fill(&mut player);
    let trace = run(&mut player, |player| {
        if player.buffer().executed() == 10 {
            player.close();
        }
    });
    let motion = Motion::opened(planner::motion::Motion::open(plan.clone()).unwrap());
    let rests = motion.starved(LEAD, &motion.tails(LEAD).unwrap(), Digest::ZERO).unwrap();
    let end = rests.last_cycle();
    assert_eq!((trace.played.len() as u64, trace.starved, trace.rested), (end, 0, SETTLE_CYCLES));
    assert!(!player.has_arrived());
    // The axis came to rest on its way: that is no arrival.
    assert_eq!((player.buffer().counters().underruns, trace.cards[0].settling_time), (1, None));
    let so_far = motion.digest_from((0, Digest::ZERO), LEAD);
    assert_eq!(trace.digest, rests.digest_from((LEAD, so_far), end));
    // Closed before it began: nothing moves.
    let mut player = self::player(&plan);
    player.accept(EPOCH, &mut Source::of(&plan).next());
    player.close();
    assert_eq!(player.cycle(), Beat::Over);
    assert_eq!(player.digest(), Digest::ZERO);
}

#[test]
fn a_stream_that_stays_open_rests_and_its_rest_is_not_in_the_digest() {
    let plan = plan(&[0.05, -0.02]);
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    source.rests_on = true;
    let end = plan.plan().cycle_count();
    for _ in 0..end + 1000 {
        source.fill(&mut player);
        assert_eq!(player.cycle(), Beat::Played);
    }
    player.close();
    let held = player.buffer().held();
    let trace = run(&mut player, |_| {});
    assert_eq!((trace.played.len() as u64, trace.rested), (held, 0));
    assert_eq!(trace.digest, digest_of(&plan));
    assert_eq!(trace.cards.len(), 2);
    assert!(trace.cards.iter().all(|card| card.residual_vibration_amplitude > 0.0));
}

/// The lead is worth what it was while the motion was not held to its end.
#[test]
fn the_least_lead_is_that_of_the_motion() {
    let plan = short();
    for rests_on in [false, true] {
        let (mut player, mut source) = (player(&plan), Source::of(&plan));
        source.rests_on = rests_on;
        source.fill(&mut player);
        while !player.has_arrived() {
            source.fill(&mut player);
            player.cycle();
        }
        player.close();
        run(&mut player, |_| {});
        let least = player.buffer().counters().least_lead_cycles;
        // Between two fills a batch is played.
        assert_eq!((least, player.buffer().counters().underruns), (LEAD - BATCH, 0), "{rests_on}");
    }
}

/// Whoever does not go by a clock waits for data at half the lead, and not at all for what does not move.
#[test]
fn a_player_that_hurries_waits_for_the_motion_and_rests_when_it_is_over() {
    let plan = short();
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    source.rests_on = true;
    let mut waits = 0;
    while !player.is_at_standstill() {
        if player.is_short_of_data(u64::MAX) {
            waits += 1;
            source.fill(&mut player);
        }
        player.cycle();
    }
    assert!(waits > 1);
    assert_eq!(player.buffer().executed(), plan.plan().cycle_count() + SETTLE_CYCLES as u64);
    assert_eq!(player.buffer().counters().least_lead_cycles, LEAD / 2);
    assert!(player.report_due().is_some(), "the server is told where time stands still");
    player.close();
    assert!(!player.is_at_standstill());
    run(&mut player, |_| {});
    assert!(player.is_over() && player.has_arrived());
}

#[test]
fn an_axis_that_diverges_ends_the_run_and_the_report_before() {
    let plan = plan(&[0.05, 0.02]);
    let setpoints: Vec<Setpoint> = plan.plan().sampler().at(0).collect();
    let config = AxisConfig { cycle: 1e-3, settle_window: SETTLE_WINDOW, settle_tolerance: 1e-5 };
    let axis = |name: &str| Axis::new(&AxisModel::flexible(name), config, &State::at_rest(0.0)).unwrap();
    let mut spoilt = axis("b");
    let nowhere = State { velocity: f64::NAN, ..State::at_rest(0.0) };
    assert!(spoilt.step(&nowhere).diverged && spoilt.has_diverged());
    let buffer = Buffer::new(&Standing {
        epoch: EPOCH,
        lead_cycles: LEAD as u32,
        axis_guard: 2,
        plan: plan.plan(),
        setpoints: &setpoints,
    });
    let mut player = Player::new(buffer, vec![axis("a"), spoilt], plan.plan().cycle_count(), BATCH);
    Source::of(&plan).fill(&mut player);
    assert_eq!(player.cycle(), Beat::Diverged);
    assert_eq!(player.divergence(), Some(Divergence { axis: 1, cycle: 1 }));
    assert!(player.is_over() && player.cycle() == Beat::Over);
    for card in player.report_cards() {
        assert!(card.max_following_error.is_finite() && card.rms_following_error.is_finite(), "{card:?}");
        assert!(card.overshoot.is_finite() && card.max_effort.is_finite(), "{card:?}");
    }
}

#[test]
fn nothing_to_move_is_a_run_of_the_settle_window() {
    let plan = plan(&[0.0]);
    let mut player = player(&plan);
    player.close();
    let trace = run(&mut player, |_| {});
    assert_eq!((trace.played.len(), trace.rested), (0, SETTLE_CYCLES));
    assert!(player.has_arrived());
    assert_eq!(trace.cards[0].settling_time, Some(0.0));
}

#[test]
fn ten_minutes_are_the_same_twice() {
    let plan = plan(&[149.9]);
    assert!(plan.plan().duration() > 599.0);
    let digest = digest_of(&plan);
    let reports = [(); 2].map(|()| {
        let (mut player, mut source) = (player(&plan), Source::of(&plan));
        while !player.is_over() {
            source.fill(&mut player);
            player.cycle();
        }
        assert_eq!(player.digest(), digest);
        player.report_cards()
    });
    assert_eq!(reports[0], reports[1]);
}

#[test]
fn a_cycle_allocates_nothing() {
    let plan = plan(&[0.05, 0.1]);
    let (mut player, mut source) = (player(&plan), Source::of(&plan));
    let mut cycles = 0;
    while !player.is_over() {
        let mut batches = Vec::new();
        while !source.is_done() && source.sent + BATCH <= player.buffer().executed() + LEAD {
            batches.push(source.next());
        }
        let counted = allocation_counter::measure(|| {
            for batch in &mut batches {
                let _ = player.accept(EPOCH, batch);
            }
            player.cycle();
            let _ = player.report_due();
        });
        assert_eq!(counted.count_total, 0, "at cycle {}", player.cycle_number());
        cycles += 1;
    }
    assert!(cycles > 300);
}
