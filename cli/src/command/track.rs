use planner::Judged;
use sim_axis::{Clock, DEFAULT_SETTLE_WINDOW, RemoteAxis, TrackRequest};

use crate::args::TrackArgs;
use crate::command::demo::draw;
use crate::failure::Failure;
use crate::record::Record;
use crate::service::Server;
use crate::show::paint::Screen;
use crate::show::watch::Watch;
use crate::show::{json, report};
use crate::source;

/// Where an axis simulator listens unless it is told otherwise.
const USUAL_AXIS: &str = "http://127.0.0.1:50052";

/// `portamento track`
pub(crate) fn run(args: &TrackArgs, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let plan = source::plan(args.source.path())?;
    let judged = Judged::new(plan);
    let plan = judged.clone().accepted().map_err(Failure::refused)?;
    let request = TrackRequest {
        endpoints: args.planner.clone(),
        clock: if args.virtual_time { Clock::Virtual } else { Clock::Wall },
        lead_cycles: args.lead,
        settle_window: args.settle_window.map_or(DEFAULT_SETTLE_WINDOW, |ns| ns as f64 / 1e9),
        settle_tolerance: args.settle_tolerance,
        accept_unproved: args.accept_unproved,
        compact: args.compact,
        spread: args.spread,
        ..TrackRequest::new(args.stream.clone(), String::new(), plan)
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|error| Failure::Internal(error.to_string()))?;
    let (report, tracked) = runtime.block_on(async {
        let mut record = Record::begin(args.record.as_deref(), &args.stream, &judged)?;
        let mut watch = Watch::new(judged.plan(), request.settle_window, args.plot.is_some());
        let axis = RemoteAxis::connect_by(server.connect, server.endpoint.unwrap_or(USUAL_AXIS)).await?;
        let mut run = axis.track(request).await?;
        while let Some(update) = run.next().await? {
            record.update(&update)?;
            watch.see(update);
        }
        let report = run.finish()?;
        record.finish(&report)?;
        Ok::<_, Failure>((report, watch.finish()))
    })?;
    if let (Some(path), Some(tracked)) = (&args.plot, &tracked) {
        draw(path, &judged, tracked)?;
    }
    if screen.json {
        writeln!(screen.out, "{}", json::tracking_report(&report)?)?;
        return Ok(());
    }
    report::tracking(screen, judged.plan(), &report)?;
    Ok(())
}
