//! Points as a table: `time,<axis>.position,<axis>.velocity,…`, a row for each point.

use std::path::{Path, PathBuf};

use planner::{PvtAxisSpec, State};

use super::text;
use crate::failure::Failure;

/// A table that was read, and where each of its numbers stands in the file.
pub(crate) struct PointTable {
    path: PathBuf,
    axes: Vec<Axis>,
    /// Line of the start, where there is one.
    start_line: Option<usize>,
    /// Of each point: its line, from 1, and its time [s].
    points: Vec<(usize, f64)>,
}

struct Axis {
    name: String,
    start: State,
    positions: Vec<f64>,
    velocities: Vec<f64>,
}

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Column {
    Time,
    Position(usize),
    Velocity(usize),
}

impl PointTable {
    pub(crate) fn read(path: &Path) -> Result<Self, Failure> {
        let text = text(path)?;
        let mut table = Self { path: path.into(), axes: Vec::new(), start_line: None, points: Vec::new() };
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let Some((index, head)) = lines.next() else {
            return Err(table.wrong(1, format!("the table is empty: begin with {HEAD}")));
        };
        let columns = table.columns(index + 1, head)?;
        for (index, line) in lines {
            table.row(index + 1, line, &columns)?;
        }
        Ok(table)
    }

    /// The axes, each with the limits and the kind that are given for all.
    pub(crate) fn axes(&self, limits: &planner::LimitsSpec, kind: planner::AxisKind) -> Vec<PvtAxisSpec> {
        let times: Vec<f64> = self.points.iter().map(|(_, time)| *time).collect();
        let axes = self.axes.iter().map(|axis| PvtAxisSpec {
            axis: axis.name.clone(),
            kind: Ok(kind),
            limits: limits.clone(),
            start: axis.start,
            times: times.clone(),
            positions: axis.positions.clone(),
            velocities: axis.velocities.clone(),
        });
        axes.collect()
    }

    /// Where the table has a field of the request: `axes[1].positions[3]` is `line 5, y.position`.
    pub(crate) fn place(&self, field: &str) -> Option<String> {
        let (axis, rest) = field.strip_prefix("axes[")?.split_once("].")?;
        let name = &self.axes.get(axis.parse::<usize>().ok()?)?.name;
        if let Some(part) = rest.strip_prefix("start.") {
            return Some(match self.start_line {
                Some(line) => format!("line {line}, {name}.{part}"),
                None => format!("{name}.{part} at time 0"),
            });
        }
        let (list, index) = rest.strip_suffix(']')?.split_once('[')?;
        let (line, _) = self.points.get(index.parse::<usize>().ok()?)?;
        match list {
            "times" => Some(format!("line {line}, time")),
            "positions" => Some(format!("line {line}, {name}.position")),
            "velocities" => Some(format!("line {line}, {name}.velocity")),
            _ => None,
        }
    }

    fn wrong(&self, line: usize, cause: String) -> Failure {
        Failure::NotPoints { path: self.path.clone(), line, cause }
    }

    fn columns(&mut self, line: usize, head: &str) -> Result<Vec<Column>, Failure> {
        let names = cells(head).ok_or_else(|| self.wrong(line, UNCLOSED.to_owned()))?;
        let mut columns = Vec::with_capacity(names.len());
        for name in names {
            let column = match name.trim().rsplit_once('.') {
                Some((axis, "position")) if !axis.is_empty() => Column::Position(self.axis(axis)),
                Some((axis, "velocity")) if !axis.is_empty() => Column::Velocity(self.axis(axis)),
                _ if ["time", "time_s"].contains(&name.trim()) => Column::Time,
                _ => {
                    let cause = format!("{name:?} is no column: name columns as in {HEAD}");
                    return Err(self.wrong(line, cause));
                }
            };
            if columns.contains(&column) {
                let cause = format!("the column {name:?} is there twice: leave one of them out");
                return Err(self.wrong(line, cause));
            }
            columns.push(column);
        }
        let there = |column| columns.contains(&column);
        let whole = |axis: &usize| there(Column::Position(*axis)) && there(Column::Velocity(*axis));
        let missing = if !there(Column::Time) {
            Some("time".to_owned())
        } else if self.axes.is_empty() {
            Some("an axis".to_owned())
        } else {
            (0..self.axes.len()).find(|axis| !whole(axis)).map(|axis| {
                let part = if there(Column::Position(axis)) { "velocity" } else { "position" };
                format!("{}.{part}", self.axes[axis].name)
            })
        };
        match missing {
            Some(missing) => {
                Err(self.wrong(line, format!("there is no column for {missing}: name columns as in {HEAD}")))
            }
            None => Ok(columns),
        }
    }

    /// The number of the axis with this name.
    fn axis(&mut self, name: &str) -> usize {
        if let Some(index) = self.axes.iter().position(|axis| axis.name == name) {
            return index;
        }
        let (start, positions, velocities) = (State::default(), Vec::new(), Vec::new());
        self.axes.push(Axis { name: name.to_owned(), start, positions, velocities });
        self.axes.len() - 1
    }

    fn row(&mut self, line: usize, text: &str, columns: &[Column]) -> Result<(), Failure> {
        let cells = cells(text).ok_or_else(|| self.wrong(line, UNCLOSED.to_owned()))?;
        if cells.len() != columns.len() {
            let (given, wanted) = (cells.len(), columns.len());
            let cause = format!("has {given} cells, and the head {wanted}: give one for each column");
            return Err(self.wrong(line, cause));
        }
        let mut time = 0.0;
        let mut states = vec![State::default(); self.axes.len()];
        for (cell, column) in cells.iter().zip(columns) {
            let number = number(cell).map_err(|cause| self.wrong(line, cause))?;
            match column {
                Column::Time => time = number,
                Column::Position(axis) => states[*axis].position = number,
                Column::Velocity(axis) => states[*axis].velocity = number,
            }
        }
        let begins = time == 0.0 && self.points.is_empty() && self.start_line.is_none();
        for (axis, state) in self.axes.iter_mut().zip(states) {
            if begins {
                axis.start = state;
            } else {
                axis.positions.push(state.position);
                axis.velocities.push(state.velocity);
            }
        }
        if begins {
            self.start_line = Some(line);
        } else {
            self.points.push((line, time));
        }
        Ok(())
    }
}

const HEAD: &str = "time,x.position,x.velocity,y.position,y.velocity";
const UNCLOSED: &str = "a quotation mark is not closed: write \"\" for one that is part of a name";

/// A number, finite or not: what it has to be is for the planner to say.
pub(crate) fn number(cell: &str) -> Result<f64, String> {
    cell.trim().parse().map_err(|_| format!("{:?} is no number: write it as in 0.25 or -3e-4", cell.trim()))
}

/// The cells of a line, as RFC 4180 quotes them; `None` where a quotation mark is not closed.
pub(crate) fn cells(line: &str) -> Option<Vec<String>> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        let cell = cells.last_mut()?;
        match letter {
            '"' if quoted && letters.peek() == Some(&'"') => {
                letters.next();
                cell.push('"');
            }
            '"' if quoted || cell.trim().is_empty() => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            letter => cell.push(letter),
        }
    }
    (!quoted).then_some(cells)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_may_be_quoted() {
        let rows: [(&str, Option<&[&str]>); 6] = [
            ("time,x.position", Some(&["time", "x.position"])),
            ("", Some(&[""])),
            ("a,,", Some(&["a", "", ""])),
            ("\"a,b\".velocity, \"c\"", Some(&["a,b.velocity", " c"])),
            ("\"the \"\"x\"\".position\"", Some(&["the \"x\".position"])),
            ("\"open", None),
        ];
        for (line, expected) in rows {
            let expected = expected.map(|cells| cells.iter().map(|cell| (*cell).to_owned()).collect());
            assert_eq!(cells(line), expected, "{line}");
        }
    }
}
