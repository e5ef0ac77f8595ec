//! The tables of the note, in Markdown.

use std::fmt::Write as _;

use e2e::Heirs;

use crate::Failed;
use crate::fit::Fit;
use crate::measured::{Point, series};
use crate::sized::{CORES, Sized, Stream, as_measured};

/// Questions with a law, as people ask them: what n is, and the unit of the cost.
const LAWS: [(&str, &str, &str, &str); 13] = [
    ("plan", "a move of axes that arrive together", "axes", "µs"),
    ("points", "a table of points", "points", "ms"),
    ("pieces", "a plan of one axis", "pieces", "µs"),
    ("sample", "one setpoint", "pieces", "ns"),
    ("pieces memory", "the size of a plan", "pieces", "KiB"),
    ("length", "a stream, by the length of its motion", "pieces", "ms"),
    ("length memory", "memory of a stream, by the length of its motion", "pieces", "KiB"),
    ("streams", "streams of one axis", "streams", "cores"),
    ("memory", "memory of streams", "streams", "MiB"),
    ("axes of a stream", "a hundred streams", "axes of a stream", "cores"),
    ("bytes of a cycle", "traffic of a cycle, both ways", "axes of a stream", "B"),
    ("batch", "a hundred streams", "cycles of a batch", "cores"),
    ("batch bytes", "traffic of a setpoint", "cycles of a batch", "B"),
];

pub(crate) fn all(points: &[Point], seed: u64) -> Result<String, Failed> {
    let mut text = laws(points)?;
    text += &traffic(points)?;
    if !series(points, "Plan", "p50").is_empty() {
        text += &calls(points)?;
    }
    let forms: Result<Vec<_>, _> = ["plain", "compact"]
        .into_iter()
        .map(|form| Stream::measured(points, form).map(|it| (form, it)))
        .collect();
    match forms {
        Ok(forms) => {
            text += &take_over(points, &forms, seed)?;
            text += &plants(&forms, seed)?;
        }
        Err(error) => writeln!(text, "\nNo plants: {error}.")?,
    }
    Ok(text)
}

fn laws(points: &[Point]) -> Result<String, Failed> {
    let mut text =
        "| what | of | law (n: {}) | from, to | farthest | spread of rounds |\n".replace(" (n: {})", "");
    writeln!(text, "|---|---|---|---|---|---|")?;
    for (question, what, n, unit) in LAWS {
        let mut names: Vec<&str> = Vec::new();
        for point in points.iter().filter(|point| point.question == question) {
            if !names.contains(&point.series.as_str()) {
                names.push(&point.series);
            }
        }
        for name in names {
            let measured = series(points, question, name);
            let sizes: Vec<(f64, f64)> = measured.iter().map(|it| (it.n, it.median)).collect();
            let Some(fit) = Fit::of(&sizes) else { continue };
            let spread = measured.iter().map(|it| (it.most - it.least) / it.median).fold(0.0, f64::max);
            writeln!(
                text,
                "| {what} | {name} | {} {unit} | {} to {} {n} | {:.0} % | {:.0} % |",
                law(&fit),
                brief(sizes[0].0),
                brief(sizes[sizes.len() - 1].0),
                100.0 * fit.worst,
                100.0 * spread
            )?;
        }
    }
    Ok(text)
}

fn law(fit: &Fit) -> String {
    let power = match fit.power {
        1.0 => "n".to_owned(),
        power => format!("n^{power:.2}").replace("^-", "^−"),
    };
    let each = format!("{} · {power}", brief(fit.each));
    if fit.each == 0.0 {
        return brief(fit.fixed);
    }
    if fit.fixed > 0.0 { format!("{} + {each}", brief(fit.fixed)) } else { each }
}

/// Three digits, as people write them.
pub(crate) fn brief(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = (2.0 - value.abs().log10().floor()).clamp(0.0, 8.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn traffic(points: &[Point]) -> Result<String, Failed> {
    let mut text = "\n| streams of one axis | bytes a setpoint, both ways | packets a setpoint | runs in which an axis missed a cycle |\n|---|---|---|---|\n".to_owned();
    for form in ["plain", "compact", "alone"] {
        for point in series(points, "bytes", form) {
            let packets = series(points, "packets", form)
                .iter()
                .find(|it| it.n.total_cmp(&point.n).is_eq())
                .map(|it| brief(it.median));
            writeln!(
                text,
                "| {}, {form} | {} | {} | |",
                point.n,
                brief(point.median),
                packets.unwrap_or_default()
            )?;
        }
    }
    for point in points.iter().filter(|point| point.question == "underruns" && point.most > 0.0) {
        writeln!(text, "| {}, {} | | | up to {} of its axes |", point.n, point.series, point.most)?;
    }
    Ok(text)
}

fn calls(points: &[Point]) -> Result<String, Failed> {
    let mut text = "\n| `Plan`, 64 callers | calls/s | p50 [µs] | p99 [µs] | p99.9 [µs] | longest [µs] | server [cores] | axes that missed a cycle | least lead |\n|---|---|---|---|---|---|---|---|---|\n".to_owned();
    for (name, asked) in [
        ("Plan, by the clock", "by the clock"),
        ("Plan, by the clock, streams beside", "by the clock, 200 streams beside"),
        ("Plan", "each after its answer"),
        ("Plan, streams beside", "each after its answer, 200 streams beside"),
    ] {
        let of =
            |what: &str| series(points, name, what).first().map_or("–".to_owned(), |it| brief(it.median));
        writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            asked,
            of("calls a second"),
            of("p50"),
            of("p99"),
            of("p99.9"),
            of("longest"),
            of("server"),
            of("underruns"),
            of("least lead")
        )?;
    }
    Ok(text)
}

fn take_over(points: &[Point], forms: &[(&str, Stream)], seed: u64) -> Result<String, Failed> {
    let mut text = "\n| streams whose server is killed | p50 [ms] | longest [ms] | simulated p50 [ms] | simulated longest [ms] |\n|---|---|---|---|---|\n".to_owned();
    for (form, stream) in forms {
        for point in series(points, "take-over", &format!("p50, {form}")) {
            let longest = series(points, "take-over", &format!("longest, {form}"));
            let longest =
                longest.iter().find(|it| it.n.total_cmp(&point.n).is_eq()).map_or(f64::NAN, |it| it.median);
            let simulated = as_measured(point.n as usize, stream, seed);
            writeln!(
                text,
                "| {}, {form} | {} | {} | {} | {} |",
                point.n,
                brief(point.median),
                brief(longest),
                brief(1e3 * simulated.wait(0.5)),
                brief(1e3 * simulated.wait(1.0))
            )?;
        }
    }
    Ok(text)
}

fn plants(forms: &[(&str, Stream)], seed: u64) -> Result<String, Failed> {
    let mut text = format!(
        "\n| axes | die at once | servers of {CORES} cores | streams of each, after | cores taken of each | memory of each [MiB] | traffic of each, both ways [Mbit/s] | streams that move | longest wait [ms] | least in hand [ms] | one list for all: longest wait [ms], axes that miss cycles |\n|---|---|---|---|---|---|---|---|---|---|---|\n"
    );
    let mut lives = "\n| a hundred deaths in a row | heirs | longest wait [ms] | axes that missed cycles, all deaths together | most streams of a server |\n|---|---|---|---|---|\n".to_owned();
    for (form, stream) in forms {
        for axes in [10, 1000, 100_000] {
            for deaths in [1, 2] {
                let sized = Sized::least(axes, deaths, stream, seed)?;
                let (worst, replicas) = (&sized.worst, sized.plant.replicas);
                let most = worst.most_streams as f64;
                writeln!(
                    text,
                    "| {axes}, {form} | {deaths} | {replicas} | {} | {} | {} | {} | {} | {} | {} | {}, {} |",
                    worst.most_streams,
                    brief(worst.busy * most / axes as f64),
                    brief(stream.base + stream.memory * most),
                    brief(8e-6 * stream.bytes * most),
                    worst.moved,
                    brief(1e3 * worst.wait(1.0)),
                    brief(1e3 * worst.least_left),
                    brief(1e3 * sized.in_order.wait(1.0)),
                    sized.in_order.underruns
                )?;
                if deaths == 2 && axes > 10 {
                    for heirs in [Heirs::Next, Heirs::Any, Heirs::Fewest] {
                        let life = sized.lives(heirs, seed);
                        let name = match heirs {
                            Heirs::Next => "the next of one list",
                            Heirs::Any => "lists of their own",
                            Heirs::Fewest => "whoever has fewest",
                        };
                        let (wait, missed) = (brief(1e3 * life.worst_wait), life.underruns);
                        writeln!(
                            lives,
                            "| {axes}, {form}, {replicas} servers | {name} | {wait} | {missed} | {} |",
                            life.most_streams
                        )?;
                    }
                }
            }
        }
    }
    Ok(text + &lives)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let written = [0.012_345, 1.0, 12.345, 123_456.0, 0.1].map(brief);
        assert_eq!(written, ["0.0123", "1", "12.3", "123456", "0.1"]);
        let law = law(&Fit { fixed: 0.25, each: 3.0, power: -1.0, worst: 0.0 });
        assert_eq!(law, "0.25 + 3 · n^−1.00");
    }
}
