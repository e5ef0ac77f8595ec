use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::args::BenchArgs;
use crate::failure::Failure;
use crate::measure::{ROWS, Row, time};
use crate::show::bench as show;
use crate::show::paint::Screen;

/// For how long a row is timed, at least and at most.
const TIMES: (Duration, Duration) = (Duration::from_millis(1), Duration::from_secs(60));

/// `portamento bench`
pub(crate) fn run(args: &BenchArgs, screen: &mut Screen<'_>) -> Result<(), Failure> {
    let each = u64::try_from(args.time).map(Duration::from_nanos).unwrap_or_default();
    if each < TIMES.0 || each > TIMES.1 {
        return Err(Failure::Usage("--time is to be 1ms to 60s".to_owned()));
    }
    let asked =
        |name: &str| args.rows.is_empty() || args.rows.iter().any(|part| name.contains(part.as_str()));
    let chosen: Vec<_> = ROWS.into_iter().filter(|(name, _)| asked(name)).collect();
    if chosen.is_empty() {
        let names: Vec<&str> = ROWS.iter().map(|(name, _)| *name).collect();
        return Err(Failure::Usage(format!("no row has such a name; there are: {}", names.join(", "))));
    }
    let bar = ProgressBar::new(chosen.len() as u64).with_style(style());
    let mut rows = Vec::with_capacity(chosen.len());
    for (name, make) in chosen {
        bar.set_message(name);
        bar.tick();
        let Row { mut ours, mut peer, budget } =
            make().map_err(|wrong| Failure::Internal(format!("{name}: {wrong}")))?;
        let timed = time(ours.as_mut(), peer.as_mut().map(|(_, side)| side.as_mut()), each);
        let row = show::Measured { name, peer: peer.map(|(name, _)| name), timed, budget };
        if screen.json {
            writeln!(screen.out, "{}", row.json())?;
            screen.out.flush()?;
        }
        rows.push(row);
        bar.inc(1);
    }
    bar.finish_and_clear();
    if screen.json { Ok(()) } else { show::table(screen, &rows) }
}

fn style() -> ProgressStyle {
    // The template is a constant that its test reads.
    ProgressStyle::with_template(TEMPLATE).unwrap_or_else(|_| ProgressStyle::default_bar())
}

const TEMPLATE: &str = "  {bar:40} {pos} of {len}, {eta} left: {msg}";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_can_be_drawn() {
        assert!(ProgressStyle::with_template(TEMPLATE).is_ok());
    }
}
