use std::collections::HashSet;
use std::time::Duration;

use client::Watching;
use proto::pb;
use proto::stream::{Phase, Watch, Watched};

use crate::args::WatchArgs;
use crate::failure::Failure;
use crate::service::{Server, USUAL_SERVER};
use crate::show::number::plain;
use crate::show::paint::{Screen, clean};

/// How long to look for streams before it is said that there are none.
const LOOK: Duration = Duration::from_secs(1);

/// `portamento watch`
pub(crate) fn run(args: &WatchArgs, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let watch = asked(args)?;
    let endpoint = server.endpoint.unwrap_or(USUAL_SERVER);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let runtime = runtime.map_err(|error| Failure::Internal(error.to_string()))?;
    runtime.block_on(async {
        let mut watching = server.connect.to(endpoint).await?.watch(watch).await?;
        if args.stream.is_none() && !screen.json {
            head(screen)?;
        }
        look(args, &mut watching, endpoint, screen).await
    })
}

async fn look(
    args: &WatchArgs,
    watching: &mut Watching,
    endpoint: &str,
    screen: &mut Screen<'_>,
) -> Result<(), Failure> {
    let mut seen = HashSet::new();
    let mut axes = Vec::new();
    loop {
        let next = match tokio::time::timeout(LOOK, watching.next()).await {
            Ok(next) => next?,
            // Once is enough, and where nothing is said there is nothing.
            Err(_) if args.once => None,
            Err(_) if seen.is_empty() && args.stream.is_none() && !screen.json => {
                let text = format!("No stream is open at {endpoint}; the first one will be shown here.");
                writeln!(screen.notes, "{}", screen.notes_paint.quiet(&text))?;
                watching.next().await?
            }
            Err(_) => watching.next().await?,
        };
        let Some(watched) = next else { return Ok(()) };
        // A moment is not worth its name before the axis has said where it is.
        if args.once && args.stream.is_some() && watched.cycles.is_empty() && watched.phase != Phase::Finished
        {
            continue;
        }
        if args.once && !seen.insert(watched.stream.clone()) {
            return Ok(());
        }
        seen.insert(watched.stream.clone());
        if screen.json {
            writeln!(screen.out, "{}", proto::to_json(&pb::WatchStreamResponse::from(watched))?)?;
        } else if args.stream.is_some() {
            if axes != watched.axes {
                axes.clone_from(&watched.axes);
                head_of_stream(screen, &axes)?;
            }
            moment(screen, &watched)?;
        } else {
            summary(screen, &watched)?;
        }
        screen.out.flush()?;
        if args.once && args.stream.is_some() {
            return Ok(());
        }
    }
}

fn asked(args: &WatchArgs) -> Result<Watch, Failure> {
    let stream = args.stream.clone().unwrap_or_default();
    let period = u64::try_from(args.every).map(Duration::from_nanos).unwrap_or_default();
    if period.is_zero() || period > Watch::LONGEST_PERIOD {
        return Err(Failure::Usage("--every is to be above 0s and at most 60s".to_owned()));
    }
    let wire = pb::WatchStreamRequest { stream, max_points: args.max_points, period: None };
    Ok(Watch::try_from(wire).map_err(Failure::refused)?.every(period))
}

fn head(screen: &mut Screen<'_>) -> std::io::Result<()> {
    let head = format!(
        "{:<20}{:>12}{:>6}  {:<11}{:>9}{:>11}{:>7}",
        "stream", "cycle", "lead", "phase", "override", "underruns", "lost"
    );
    writeln!(screen.out, "{}", screen.paint.heading(&head))
}

fn summary(screen: &mut Screen<'_>, watched: &Watched) -> std::io::Result<()> {
    let Watched { stream, executed_cycle, lead_cycles, phase, override_factor, counters, .. } = watched;
    let (factor, underruns, lost) = (plain(*override_factor), counters.underruns, watched.messages_dropped);
    let phase = format!("{:<11}", name(*phase));
    writeln!(
        screen.out,
        "{:<20}{executed_cycle:>12}{lead_cycles:>6}  {phase}{factor:>9}{underruns:>11}{lost:>7}",
        short_stream(stream)
    )
}

fn head_of_stream(screen: &mut Screen<'_>, axes: &[String]) -> std::io::Result<()> {
    let mut head = format!("{:>10}{:>6}  {:<11}{:>9}", "cycle", "lead", "phase", "override");
    for axis in axes.iter().take(MOST_AXES) {
        head += &format!("{:>18}{:>12}", format!("{} position", clipped(axis, 9)), "error");
    }
    writeln!(screen.out, "{}", screen.paint.heading(&head))?;
    if axes.len() > MOST_AXES {
        let text = format!("(the first of {} axes; --json shows all)", axes.len());
        writeln!(screen.out, "{}", screen.paint.quiet(&text))?;
    }
    Ok(())
}

/// As many as eighty columns hold.
const MOST_AXES: usize = 1;

fn moment(screen: &mut Screen<'_>, watched: &Watched) -> std::io::Result<()> {
    let Watched { executed_cycle, lead_cycles, phase, override_factor, commanded, tracking, events, .. } =
        watched;
    for event in events {
        let text = format!("{:?} at cycle {}", event.kind, event.at_cycle).to_lowercase();
        writeln!(screen.out, "{}", screen.paint.quiet(&text))?;
    }
    let mut line =
        format!("{executed_cycle:>10}{lead_cycles:>6}  {:<11}{:>9}", name(*phase), plain(*override_factor));
    let last = commanded.cycles().checked_sub(1);
    for axis in 0..watched.axes.len().min(MOST_AXES) {
        let position = last.and_then(|last| commanded.at(axis, last)).map(|at| plain(at.state.position));
        let error = tracking.as_ref().and_then(|tracking| {
            let cycles = tracking.cycles as usize;
            tracking.following_error.get(axis * cycles + cycles.checked_sub(1)?).map(|error| plain(*error))
        });
        let shown = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
        line += &format!("{:>18}{:>12}", shown(position), shown(error));
    }
    writeln!(screen.out, "{line}")
}

fn name(phase: Phase) -> &'static str {
    match phase {
        Phase::Moving => "moving",
        Phase::Holding => "holding",
        Phase::Stopping => "stopping",
        Phase::Standstill => "standstill",
        Phase::Finished => "finished",
    }
}

fn short_stream(stream: &str) -> String {
    clipped(stream, 19)
}

fn clipped(text: &str, most: usize) -> String {
    let text = clean(text);
    if text.chars().count() <= most {
        return text;
    }
    text.chars().take(most - 1).chain(['…']).collect()
}
