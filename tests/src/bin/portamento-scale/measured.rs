//! Figures as they are measured, and as lines of a file.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::{Value, json};

use crate::Failed;

/// What was measured of one thing at one size, several times.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Point {
    /// What is asked: how does this grow with that?
    pub(crate) question: String,
    /// Of whom, or in which form.
    pub(crate) series: String,
    /// The size.
    pub(crate) n: f64,
    /// The median, the least and the greatest of all rounds, in the unit of the question.
    pub(crate) median: f64,
    pub(crate) least: f64,
    pub(crate) most: f64,
    pub(crate) rounds: usize,
}

/// Everything that was measured so far, in the order in which it was first asked.
#[derive(Debug, Default)]
pub(crate) struct Measured(Vec<(String, String, f64, Vec<f64>)>);

impl Measured {
    #[expect(clippy::float_cmp, reason = "sizes are the very same numbers in every round")]
    pub(crate) fn add(&mut self, question: &str, series: &str, n: f64, value: f64) {
        let known =
            |it: &&mut (String, String, f64, Vec<f64>)| it.0 == question && it.1 == series && it.2 == n;
        match self.0.iter_mut().find(known) {
            Some((.., values)) => values.push(value),
            None => self.0.push((question.into(), series.into(), n, vec![value])),
        }
    }

    pub(crate) fn points(&self) -> Vec<Point> {
        let point = |(question, series, n, values): &(String, String, f64, Vec<f64>)| {
            let mut values = values.clone();
            values.sort_unstable_by(f64::total_cmp);
            Point {
                question: question.clone(),
                series: series.clone(),
                n: *n,
                median: median(&values),
                least: values.first().copied().unwrap_or(f64::NAN),
                most: values.last().copied().unwrap_or(f64::NAN),
                rounds: values.len(),
            }
        };
        self.0.iter().map(point).collect()
    }
}

/// Of values in ascending order.
pub(crate) fn median(values: &[f64]) -> f64 {
    match values {
        [] => f64::NAN,
        values => 0.5 * (values[(values.len() - 1) / 2] + values[values.len() / 2]),
    }
}

/// The points of one question and series, by size.
pub(crate) fn series<'a>(points: &'a [Point], question: &str, series: &str) -> Vec<&'a Point> {
    let mut found: Vec<&Point> =
        points.iter().filter(|point| point.question == question && point.series == series).collect();
    found.sort_by(|a, b| a.n.total_cmp(&b.n));
    found
}

pub(crate) fn write(file: &Path, points: &[Point]) -> Result<(), Failed> {
    let mut text = String::new();
    for Point { question, series, n, median, least, most, rounds } in points {
        let [median, least, most] = [median, least, most].map(|value| rounded(*value));
        let line = json!({
            "question": question, "series": series, "n": n,
            "median": median, "least": least, "most": most, "rounds": rounds,
        });
        writeln!(text, "{line}")?;
    }
    Ok(std::fs::write(file, text)?)
}

/// To the five digits that a measurement has at the most.
fn rounded(value: f64) -> f64 {
    format!("{value:.4e}").parse().unwrap_or(value)
}

pub(crate) fn read(file: &Path) -> Result<Vec<Point>, Failed> {
    let text = std::fs::read_to_string(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let point = |line: &str| -> Result<Point, Failed> {
        let line: Value = serde_json::from_str(line)?;
        let text =
            |key: &str| line[key].as_str().map(str::to_owned).ok_or_else(|| format!("{key} is no text"));
        let number = |key: &str| line[key].as_f64().ok_or_else(|| format!("{key} is no number"));
        Ok(Point {
            question: text("question")?,
            series: text("series")?,
            n: number("n")?,
            median: number("median")?,
            least: number("least")?,
            most: number("most")?,
            rounds: number("rounds")? as usize,
        })
    };
    let numbered = text.lines().enumerate();
    numbered
        .map(|(index, line)| {
            point(line).map_err(|error| format!("{}:{}: {error}", file.display(), index + 1).into())
        })
        .collect()
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "they are those very values")]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_again() {
        let mut measured = Measured::default();
        for value in [3.0, 1.0, 2.0, 10.0] {
            measured.add("streams", "server", 100.0, value);
        }
        measured.add("streams", "axes", 100.0, 0.123_456_789);
        let points = measured.points();
        assert_eq!(
            (points[0].median, points[0].least, points[0].most, points[0].rounds),
            (2.5, 1.0, 10.0, 4)
        );
        let file = std::env::temp_dir().join(format!("portamento-scale-{}.jsonl", std::process::id()));
        write(&file, &points).unwrap();
        let again = read(&file).unwrap();
        std::fs::remove_file(&file).unwrap();
        assert_eq!(again[0], points[0]);
        assert_eq!(again[1].median, 0.12346);
        assert_eq!(series(&again, "streams", "axes").len(), 1);
    }
}
