use std::path::Path;

use client::Client;
use client::failover::Change;
use planner::motion::Motion;
use planner::{
    Accepted, AxisKind, AxisMoveSpec, Family, Judged, LimitsSpec, RequestSpec, ShortPathPolicy, State,
    Synchronization,
};
use proto::Digest;
use proto::stream::{Ask, Operation, OperationResult};
use serde_json::json;
use sim_axis::{AxisModel, Clock, TrackRequest, Tracking, TrackingReport, Update, default_settle_tolerance};

use crate::args::DemoArgs;
use crate::command::compare::{Watched, families};
use crate::command::machine::Machine;
use crate::failure::Failure;
use crate::law::Law;
use crate::record::Record;
use crate::replica::Replica;
use crate::service::Service;
use crate::show::compared;
use crate::show::number::plain;
use crate::show::paint::Screen;
use crate::show::plot::{self, Tracked};
use crate::show::watch::Watch;
use crate::show::{json as messages, report, table};

/// How far ahead the demo's axis holds setpoints [cycles]: the machine may be busy with something else.
const LEAD_CYCLES: u32 = 100;

/// What is done to the motion on its way, after the server that serves it has died: from which cycle, what the figure calls it, what the table says.
const OPERATIONS: [(u64, &str, &str, Ask); 3] = [
    (120, "override", "half its feed rate", Ask::Override(0.5)),
    (220, "hold", "holds", Ask::Hold),
    (420, "resume", "goes on", Ask::Resume),
];

/// What the demo found.
struct Outcome {
    report: TrackingReport,
    /// Who went on when the server was killed.
    change: Option<Change>,
    results: Vec<OperationResult>,
    /// What the planner says that the digest is.
    undisturbed: Digest,
    tracked: Tracked,
}

/// `portamento demo`
pub(crate) fn run(args: &DemoArgs, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build();
    let runtime = runtime.map_err(|error| Failure::Internal(error.to_string()))?;
    // Each in a runtime of its own, which can be taken from under it.
    let replicas = [Replica::start("replica-1")?, Replica::start("replica-2")?];
    let (judged, outcome) = runtime.block_on(play(args, screen, replicas))?;
    draw(&args.plot, &judged, &outcome.tracked)?;
    let Outcome { report, change, results, undisturbed, .. } = outcome;
    let model = AxisModel::flexible("x");
    let watched = Watched {
        machine: Machine::Given(&model),
        settle_tolerance: Some(default_settle_tolerance(AxisKind::Prismatic)),
    };
    let (families, chosen) =
        families(&Service::InProcess, &fifty_millimetres(), &Law::OF_EVERY_FAMILY, watched, |_, failure| {
            failure
        })?;
    if screen.json {
        let answer = json!({
            "report": messages::tracking_report(&report)?,
            "failovers": report.stream.failovers,
            "operations": operation_results(&results)?,
            "digest": u64::from(report.stream.digest).to_string(),
            "undisturbedDigest": u64::from(undisturbed).to_string(),
            "families": compared::json(&families, &chosen.limits()),
        });
        writeln!(screen.out, "{answer}")?;
    } else {
        operations(screen, change.as_ref(), &results)?;
        report::tracking(screen, judged.plan(), &report)?;
        let same = if report.stream.digest == undisturbed {
            screen.paint.good("the digest is that of a replay by the planner: not a bit was lost")
        } else {
            screen.paint.bad(&format!("the digest of a replay by the planner is {undisturbed}"))
        };
        writeln!(screen.out, "  {same}")?;
        writeln!(screen.out, "\n{}", screen.paint.heading("The same move by other families"))?;
        compared::table(screen, &families)?;
        compared::chosen_limits(screen, AxisKind::Prismatic, &chosen.limits())?;
        writeln!(screen.out, "\nDrawn in {}.", args.plot.display())?;
    }
    if report.stream.digest != undisturbed {
        return Err(Failure::Internal("the setpoints that were played are not those of the plan".into()));
    }
    if report.stream.failovers == 0 {
        return Err(Failure::Internal("the axis has not noticed that its server was killed".into()));
    }
    Ok(())
}

/// What happened on the way, and what became of each operation.
fn operations(
    screen: &mut Screen<'_>,
    change: Option<&Change>,
    results: &[OperationResult],
) -> std::io::Result<()> {
    writeln!(screen.out, "{}", screen.paint.heading("On the way"))?;
    if let Some(Change { from, to, executed_cycle, took, .. }) = change {
        let took = plain((took.as_secs_f64() * 1e4).round() / 10.0);
        let text = format!("at cycle {executed_cycle}: {to} goes on {took} ms later");
        writeln!(screen.out, "  {:24}{text}", format!("{from} is killed"))?;
    }
    for ((_, name, does, _), result) in OPERATIONS.iter().zip(results) {
        let OperationResult { effective_cycle, rest_cycle, .. } = result;
        let text = format!("from cycle {effective_cycle}: {does}; rests from {rest_cycle}");
        writeln!(screen.out, "  {name:24}{text}")?;
    }
    writeln!(screen.out)
}

fn operation_results(results: &[OperationResult]) -> Result<Vec<serde_json::Value>, Failure> {
    let wire = results.iter().map(|result| proto::pb::OperationResult::from(result.clone()));
    wire.map(|result| proto::to_json_value(&result).map_err(Failure::from)).collect()
}

/// The digest of `plan` with the demo's operations done to it as `results` say, without any stream.
fn replayed(plan: &Accepted, results: &[OperationResult]) -> Result<Digest, Failure> {
    let mut motion = Motion::open(plan.clone()).map_err(Failure::refused)?;
    let (mut digest, mut played) = (Digest::ZERO, 0);
    let mut play = |motion: &Motion, to: u64| {
        let mut sampler = motion.plan().sampler();
        for cycle in played + 1..=to {
            let setpoints = sampler.at(cycle - motion.from_cycle());
            digest = digest.then(cycle, setpoints.map(|setpoint| setpoint.words()));
        }
        played = to.max(played);
    };
    // In the order in which they came into effect: one that the axis had refused for being late is tried again after others.
    let mut done: Vec<_> = OPERATIONS.into_iter().zip(results).collect();
    done.sort_by_key(|(_, result)| result.revision);
    for ((.., ask), result) in done {
        play(&motion, result.effective_cycle - 1);
        let operation = Operation::now("replay", ask).planned().map_err(Failure::refused)?;
        motion = motion.splice(result.effective_cycle, &operation).map_err(Failure::refused)?.motion;
    }
    play(&motion, motion.last_cycle());
    Ok(digest)
}

/// Two servers on free ports of this machine, an axis, and a move from one to the other. The server that serves it is killed on the
/// way.
async fn play(
    args: &DemoArgs,
    screen: &mut Screen<'_>,
    replicas: [Replica; 2],
) -> Result<(Judged, Outcome), Failure> {
    let client = Client::connect(&replicas[0].endpoint()).await?;
    let judged = client.plan(fifty_millimetres()).await?;
    drop(client);
    if !screen.json {
        table::plan(screen, &judged)?;
        writeln!(screen.out)?;
        screen.out.flush()?;
    }
    let accepted = judged.clone().accepted().map_err(Failure::refused)?;
    let outcome = follow(args, replicas, &judged, accepted).await?;
    Ok((judged, outcome))
}

async fn follow(
    args: &DemoArgs,
    [first, second]: [Replica; 2],
    judged: &Judged,
    plan: Accepted,
) -> Result<Outcome, Failure> {
    let clock = if args.virtual_time { Clock::Virtual } else { Clock::Wall };
    let request = TrackRequest {
        models: vec![AxisModel::flexible("x")],
        clock,
        lead_cycles: LEAD_CYCLES,
        endpoints: vec![first.endpoint(), second.endpoint()],
        ..TrackRequest::new("demo/x", first.endpoint(), plan.clone())
    };
    let mut record = Record::begin(args.record.as_deref(), &request.stream, judged)?;
    record.request(fifty_millimetres())?;
    let mut watch = Watch::new(plan.plan(), request.settle_window, true);
    let asked = OPERATIONS.into_iter().map(|(cycle, name, _, ask)| Operation {
        not_before_cycle: Some(cycle),
        ..Operation::now(name, ask)
    });
    let (mut tracking, answers) = Tracking::begin_with(request, asked.collect()).await?;
    let (mut serving, mut change) = (Some(first), None);
    while let Some(update) = tracking.next().await {
        record.update(&update)?;
        match &update {
            // The first of them come while the axis speeds up.
            Update::Samples(_) => serving.take().into_iter().for_each(Replica::kill),
            Update::FailedOver(gone_on) => change = Some(gone_on.clone()),
            Update::Event(_) | Update::Operated(_) => {}
        }
        watch.see(update);
    }
    let mut tracked = watch.finish().unwrap_or_default();
    let report = tracking.finish().await?;
    let mut results = Vec::with_capacity(answers.len());
    for (answer, (_, name, ..)) in answers.into_iter().zip(OPERATIONS) {
        let result = answer.get().await.map_err(Failure::refused)?;
        let time = result.effective_cycle as f64 * plan.plan().cycle_time().as_seconds();
        tracked.operations.push((time, name.to_owned()));
        results.push(result);
    }
    record.finish(&report)?;
    let undisturbed = replayed(&plan, &results)?;
    serving.into_iter().chain([second]).for_each(Replica::kill);
    Ok(Outcome { report, change, results, undisturbed, tracked })
}

/// The move of Blejan and Blejan's first example: 50 mm within 0.25 m/s, 3 m/s² and 100 m/s³.
fn fifty_millimetres() -> RequestSpec {
    let limits =
        LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..LimitsSpec::default() };
    let axis = AxisMoveSpec {
        axis: "x".into(),
        kind: Ok(AxisKind::Prismatic),
        start: State::at_rest(0.0),
        goal: State::at_rest(0.05),
        limits,
    };
    RequestSpec {
        axes: vec![axis],
        cycle_time_ns: None,
        family: Ok(Family::SCurve),
        order: None,
        short_path: Ok(ShortPathPolicy::Reject),
        synchronization: Ok(Synchronization::None),
        minimum_duration: None,
        end_on_cycle: false,
    }
}

/// Draws what was commanded and what was measured.
pub(super) fn draw(path: &Path, judged: &Judged, tracked: &Tracked) -> Result<(), Failure> {
    plot::write(path, &plot::of_tracking(judged.plan(), tracked))
}
