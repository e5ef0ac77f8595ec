//! Columns of text, as wide as what stands in them, in at most 80 columns of a terminal.

use crate::show::paint::{Paint, WIDTH, clean};

/// The most significant digits that a table shows, and the fewest that it comes down to where it is too wide.
const DIGITS: std::ops::RangeInclusive<i32> = 4..=6;
/// The most of an axis's name that a table shows [characters].
const LONGEST_NAME: usize = 16;

/// A name that fits a column.
pub(crate) fn short(name: &str) -> String {
    let name = clean(name);
    if name.chars().count() <= LONGEST_NAME {
        return name;
    }
    name.chars().take(LONGEST_NAME - 1).chain(['…']).collect()
}

/// The table with as many digits as fit.
pub(crate) fn fitted(table: impl Fn(i32) -> Table) -> Table {
    let mut digits = *DIGITS.end();
    loop {
        let fitting = table(digits);
        if fitting.width() <= WIDTH {
            return fitting;
        }
        if digits == *DIGITS.start() {
            return Table { gap: " ", ..fitting };
        }
        digits -= 1;
    }
}

/// Columns of text, each as wide as its widest cell.
#[derive(Debug)]
pub(crate) struct Table {
    columns: Vec<Column>,
    verdicts: Vec<Verdict>,
    /// Between columns.
    gap: &'static str,
}

impl Default for Table {
    fn default() -> Self {
        Self { columns: Vec::new(), verdicts: Vec::new(), gap: "  " }
    }
}

#[derive(Debug)]
struct Column {
    heading: String,
    unit: String,
    cells: Vec<String>,
    right: bool,
    width: usize,
}

/// What the judge says of one row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Ok,
    LedBack,
    NotPromised,
    Failed,
}

impl Verdict {
    fn text(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::LedBack => "led back",
            Self::NotPromised => "not promised",
            Self::Failed => "FAILED",
        }
    }

    fn painted(self, paint: Paint) -> String {
        match self {
            Self::Ok | Self::LedBack => paint.good(self.text()),
            Self::NotPromised => paint.quiet(self.text()),
            Self::Failed => paint.bad(self.text()),
        }
    }
}

impl Table {
    /// With one blank between columns, where there are many.
    pub(crate) fn narrow() -> Self {
        Self { gap: " ", ..Self::default() }
    }

    pub(crate) fn right(&mut self, heading: &str, unit: &str, cells: Vec<String>) {
        self.push(heading, unit, cells, true);
    }

    pub(crate) fn left(&mut self, heading: &str, unit: &str, cells: Vec<String>) {
        self.push(heading, unit, cells, false);
    }

    fn push(&mut self, heading: &str, unit: &str, cells: Vec<String>, right: bool) {
        let lengths = cells.iter().map(|cell| cell.chars().count());
        let width = lengths.chain([heading.chars().count(), unit.chars().count()]).max().unwrap_or(0);
        self.columns.push(Column { heading: heading.into(), unit: unit.into(), cells, right, width });
    }

    pub(crate) fn verdicts(&mut self, verdicts: Vec<Verdict>) {
        self.verdicts = verdicts;
    }

    fn width(&self) -> usize {
        let verdicts =
            self.verdicts.iter().map(|verdict| verdict.text().len() + self.gap.len()).max().unwrap_or(0);
        INDENT.len() + self.columns.iter().map(|column| column.width + self.gap.len()).sum::<usize>()
            - self.gap.len()
            + verdicts
    }

    pub(crate) fn render(&self, paint: Paint) -> String {
        let mut text = String::new();
        let rows = self.columns.first().map_or(0, |column| column.cells.len());
        for heading in [
            self.line(self.columns.iter().map(|c| (c, &c.heading))),
            self.line(self.columns.iter().map(|c| (c, &c.unit))),
        ] {
            if !heading.trim().is_empty() {
                text.push_str(&format!("{}\n", paint.quiet(&heading)));
            }
        }
        for row in 0..rows {
            text.push_str(&self.line(self.columns.iter().map(|column| (column, &column.cells[row]))));
            if let Some(verdict) = self.verdicts.get(row) {
                text.push_str(&format!("{}{}", self.gap, verdict.painted(paint)));
            }
            text.push('\n');
        }
        text
    }

    fn line<'a>(&self, cells: impl Iterator<Item = (&'a Column, &'a String)>) -> String {
        let cells = cells.map(|(column, cell)| {
            let width = column.width;
            if column.right { format!("{cell:>width$}") } else { format!("{cell:<width$}") }
        });
        format!("{INDENT}{}", cells.collect::<Vec<_>>().join(self.gap)).trim_end().to_owned()
    }
}

const INDENT: &str = "  ";
