use std::path::Path;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use planner::motion::{AxisPoints, Points};
use planner::{AxisKind, LimitsSpec, PvtAxisSpec, State};
use proto::pb;
use proto::stream::{Ask, GoalSpec, Operation, OperationResult};
use sim_axis::RemoteAxis;

use crate::args::{CommandArgs, Order};
use crate::failure::Failure;
use crate::service::Server;
use crate::show::paint::{Screen, wrapped};
use crate::source::{self, PointTable};

/// Most operations are answered before that.
const SOON: Duration = Duration::from_secs(1);

/// `portamento command`
pub(crate) fn run(args: &CommandArgs, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let operation = Operation {
        request_id: args.request_id.clone().unwrap_or_else(fresh_id),
        not_before_cycle: args.not_before,
        ask: Some(ask(&args.order)?),
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|error| Failure::Internal(error.to_string()))?;
    let result = runtime.block_on(async {
        let axis = RemoteAxis::connect_by(server.connect, &args.axis).await?;
        let answered = axis.command(&args.stream, operation);
        tokio::pin!(answered);
        if let Ok(answered) = tokio::time::timeout(SOON, &mut answered).await {
            return answered.map_err(Failure::from);
        }
        if let Some(cycle) = args.not_before.filter(|_| !screen.json) {
            let text = format!(
                "Waiting: it takes effect at cycle {cycle}, or is refused where the motion ends before that."
            );
            writeln!(screen.notes, "{}", screen.notes_paint.quiet(&wrapped(&text, "")))?;
        }
        answered.await.map_err(Failure::from)
    })?;
    if screen.json {
        let response = pb::CommandResponse { result: Some(result.into()) };
        writeln!(screen.out, "{}", proto::to_json(&response)?)?;
    } else {
        writeln!(screen.out, "{}", wrapped(&said(args, &result), ""))?;
    }
    Ok(())
}

fn ask(order: &Order) -> Result<Ask, Failure> {
    Ok(match order {
        Order::Hold => Ask::Hold,
        Order::Resume => Ask::Resume,
        Order::Override { factor } => Ask::Override(*factor),
        Order::Retarget { request: Some(path), .. } => source::retarget(path)?,
        Order::Retarget { goals, request: None } => {
            let goal = |(axis, position): &(String, f64)| GoalSpec {
                axis: axis.clone(),
                goal: Some(State::at_rest(*position)),
                limits: None,
            };
            Ask::Retarget(goals.iter().map(goal).collect())
        }
        Order::Append { points, last } => Ask::Append(Points { axes: read_points(points)?, last: *last }),
        Order::Stop => Ask::Stop,
    })
}

/// Limits and kinds are those of the motion.
fn read_points(path: &Path) -> Result<Vec<AxisPoints>, Failure> {
    let axes = PointTable::read(path)?.axes(&LimitsSpec::default(), AxisKind::Prismatic);
    let points = axes.into_iter().map(|PvtAxisSpec { axis, times, positions, velocities, .. }| AxisPoints {
        axis,
        times,
        positions,
        velocities,
    });
    Ok(points.collect())
}

/// What became of it, in one line.
fn said(args: &CommandArgs, result: &OperationResult) -> String {
    let OperationResult { effective_cycle, rest_cycle, revision, on_path, .. } = result;
    let does = match &args.order {
        Order::Hold => "holds".to_owned(),
        Order::Resume => "goes on".to_owned(),
        Order::Override { factor } => format!("goes at {factor} of its feed rate"),
        Order::Retarget { .. } => "goes to the new goals".to_owned(),
        Order::Append { .. } => "goes on through the new points".to_owned(),
        Order::Stop => "stops".to_owned(),
    };
    let path = if *on_path { "on its path" } else { "off its path" };
    let late = match args.not_before {
        Some(asked) if *effective_cycle > asked => {
            format!("; cycle {asked} was past, or too near to reach the axis in time")
        }
        _ => String::new(),
    };
    format!(
        "{does} from cycle {effective_cycle}, rests from cycle {rest_cycle}, {path}; revision {revision}{late}"
    )
}

/// Unlike that of any request before it: the time [ns].
#[expect(clippy::disallowed_methods, reason = "only numbers a request; no setpoint depends on it")]
fn fresh_id() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    format!("portamento-{}", since.as_nanos())
}
