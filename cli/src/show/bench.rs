//! What was measured: a table for people, a row a line for programs.

use serde_json::{Value, json};

use crate::failure::Failure;
use crate::measure::{Budget, Timed};
use crate::show::columns::Table;
use crate::show::number::counted;
use crate::show::paint::{Screen, wrapped};

/// One row as it was measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    pub(crate) name: &'static str,
    pub(crate) peer: Option<&'static str>,
    pub(crate) timed: Timed,
    pub(crate) budget: Budget,
}

impl Measured {
    /// Times in nanoseconds.
    pub(crate) fn json(&self) -> Value {
        let Self { name, peer, timed, budget } = self;
        let budget_text = budget.to_string();
        json!({
            "name": name,
            "ns": timed.ns,
            "p999Ns": timed.p999_ns,
            "peer": peer,
            "peerNs": timed.peer_ns,
            "ratio": timed.ratio(),
            "budget": (!budget_text.is_empty()).then_some(budget_text),
            "met": budget.met(timed),
        })
    }
}

/// All rows, and how many budgets are met.
pub(crate) fn table(screen: &mut Screen<'_>, rows: &[Measured]) -> Result<(), Failure> {
    let each = |cell: &dyn Fn(&Measured) -> String| rows.iter().map(cell).collect::<Vec<_>>();
    let mut table = Table::narrow();
    table.left("", "", each(&|row| row.name.to_owned()));
    table.right("median", "[ns]", each(&|row| nanoseconds(Some(row.timed.ns))));
    table.right("99.9 %", "[ns]", each(&|row| nanoseconds(row.timed.p999_ns)));
    table.left("peer", "", each(&|row| row.peer.unwrap_or("-").to_owned()));
    table.right("median", "[ns]", each(&|row| nanoseconds(row.timed.peer_ns)));
    table.right("ratio", "", each(&|row| row.timed.ratio().map_or("-".to_owned(), share)));
    table.right("budget", "", each(&|row| row.budget.to_string()));
    table.left("met", "", each(&|row| met(row).to_owned()));
    screen.out.write_all(table.render(screen.paint).as_bytes())?;
    let broken = rows.iter().filter(|row| row.budget.met(&row.timed) == Some(false)).count();
    let met = rows.iter().filter(|row| row.budget.met(&row.timed) == Some(true)).count();
    let text = format!("{} met, {} broken.", counted(met as u64, "budget"), broken);
    let text = if broken > 0 { screen.paint.bad(&text) } else { screen.paint.good(&text) };
    writeln!(screen.out, "\n{text}")?;
    let how = "A budget is a share of the peer's median, or a time; after the semicolon it is for 99.9 % of the inputs.";
    writeln!(screen.out, "{}", wrapped(how, ""))?;
    if cfg!(debug_assertions) {
        let warning =
            "This program was built without optimisation: its figures say nothing. Build it with --release.";
        writeln!(screen.out, "{}", screen.paint.bad(&wrapped(warning, "")))?;
    }
    Ok(())
}

/// Three digits, or all of a whole number's.
fn nanoseconds(value: Option<f64>) -> String {
    match value {
        Some(ns) if ns < 10.0 => format!("{ns:.2}"),
        Some(ns) if ns < 100.0 => format!("{ns:.1}"),
        Some(ns) => format!("{ns:.0}"),
        None => "-".to_owned(),
    }
}

/// As a part of the peer's time, or as many times of it.
fn share(ratio: f64) -> String {
    if ratio <= 1.0 { format!("1/{:.2}", 1.0 / ratio) } else { format!("{ratio:.2}") }
}

fn met(row: &Measured) -> &'static str {
    match row.budget.met(&row.timed) {
        Some(true) => "yes",
        Some(false) => "NO",
        None => "",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_says_what_there_is_and_null_for_what_there_is_not() {
        let timed = Timed { ns: 50.0, p999_ns: None, peer_ns: Some(200.0) };
        let row = Measured { name: "x", peer: Some("p"), timed, budget: Budget::share(4.0) };
        assert_eq!(
            row.json().to_string(),
            r#"{"name":"x","ns":50.0,"p999Ns":null,"peer":"p","peerNs":200.0,"ratio":0.25,"budget":"1/4","met":true}"#
        );
        let timed = Timed { peer_ns: None, ..timed };
        let row = Measured { peer: None, timed, budget: Budget::default(), ..row };
        assert_eq!(
            row.json().to_string(),
            r#"{"name":"x","ns":50.0,"p999Ns":null,"peer":null,"peerNs":null,"ratio":null,"budget":null,"met":null}"#
        );
    }

    #[test]
    fn figures_have_three_digits() {
        let shown = [1.234, 12.34, 123.4, 12345.6].map(|ns| nanoseconds(Some(ns)));
        assert_eq!(shown, ["1.23", "12.3", "123", "12346"]);
        assert_eq!(nanoseconds(None), "-");
        assert_eq!((share(0.25), share(1.5)), ("1/4.00".to_owned(), "1.50".to_owned()));
    }
}
