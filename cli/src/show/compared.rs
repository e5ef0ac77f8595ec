//! Several ways to make one move, side by side.

use std::io;

use planner::{AxisKind, AxisPlan, Judged, Method, Quantity, State};
use serde_json::{Value, json};
use sim_axis::{Observation, ReportCard};

use crate::show::columns::Table;
use crate::show::number::{column, plain, unit};
use crate::show::paint::{Screen, clean, wrapped};
use crate::show::table;

/// One way to make the move: what is planned, and what an axis made of it.
#[derive(Clone, Debug)]
pub(crate) struct Compared {
    pub(crate) name: String,
    pub(crate) kind: AxisKind,
    method: Method,
    /// [s]
    pub(crate) duration: f64,
    /// Greatest velocity, acceleration and jerk, as magnitudes; infinite where it jumps.
    peaks: [f64; 3],
    pub(crate) curves: Curves,
    card: ReportCard,
    /// The most that the motor has, with its unit.
    effort_limit: String,
    /// The one limit that is kept while speeding up and while slowing down, where two are given.
    alike: Option<String>,
}

/// Cycle by cycle.
#[derive(Clone, Debug, Default)]
pub(crate) struct Curves {
    /// [s]
    pub(crate) times: Vec<f64>,
    /// Of the motor, as measured [axis units/s].
    pub(crate) velocity: Vec<f64>,
    /// Commanded minus measured at the motor, and commanded minus actual at the load [axis units].
    pub(crate) following_error: Vec<f64>,
    pub(crate) load_error: Vec<f64>,
    /// The axis has left its setpoints for good.
    diverged: bool,
}

impl Curves {
    pub(crate) fn push(&mut self, time: f64, setpoint: State, seen: Observation) {
        self.times.push(time);
        self.velocity.push(seen.measured_velocity);
        self.following_error.push(seen.following_error);
        self.load_error.push(setpoint.position - seen.load_position);
        self.diverged |= seen.diverged;
    }
}

impl Compared {
    pub(crate) fn new(
        name: String,
        judged: &Judged,
        axis: &AxisPlan,
        curves: Curves,
        card: ReportCard,
        effort_limit: String,
    ) -> Self {
        let peak = |quantity| {
            let mut checks = judged.certificate().limits.iter();
            let check = checks.find(|check| *check.axis == *axis.axis && check.quantity == quantity);
            check.map_or(0.0, |check| check.extremum.abs())
        };
        Self {
            name,
            kind: axis.kind,
            method: judged.plan().method(),
            duration: axis.profile.duration(),
            peaks: [Quantity::Velocity, Quantity::Acceleration, Quantity::Jerk].map(peak),
            curves,
            card,
            effort_limit,
            alike: table::alike(judged.plan(), axis),
        }
    }

    /// Of the load, while it moves and after.
    fn largest_load_error(&self) -> f64 {
        self.curves.load_error.iter().fold(0.0, |largest, error| error.abs().max(largest))
    }
}

/// What is planned, and how the axis followed it.
///
/// `machine` says what followed, in a sentence.
pub(crate) fn tables(screen: &mut Screen<'_>, all: &[Compared], machine: &str) -> io::Result<()> {
    let Some(kind) = all.first().map(|compared| compared.kind) else { return Ok(()) };
    let paint = screen.paint;
    writeln!(screen.out, "{}", paint.heading("The move"))?;
    screen.out.write_all(planned(all, kind).render(paint).as_bytes())?;
    for sentence in alike(all) {
        writeln!(screen.out, "{}", wrapped(&sentence, "  "))?;
    }
    writeln!(screen.out, "\n{}", paint.heading("The axis that followed it"))?;
    writeln!(screen.out, "{}", wrapped(machine, "  "))?;
    screen.out.write_all(followed(all, kind).render(paint).as_bytes())?;
    for sentence in [saturated(all), diverged(all)].into_iter().flatten() {
        writeln!(screen.out, "{}", wrapped(&sentence, "  "))?;
    }
    Ok(())
}

/// Which families have one limit for speeding up and slowing down where two are given, in a sentence for each such limit.
fn alike(all: &[Compared]) -> Vec<String> {
    let mut limits: Vec<&str> = Vec::new();
    for limit in all.iter().filter_map(|one| one.alike.as_deref()) {
        if !limits.contains(&limit) {
            limits.push(limit);
        }
    }
    let of = |limit: &str| {
        let names = all.iter().filter(|one| one.alike.as_deref() == Some(limit)).map(|one| clean(&one.name));
        let names = names.collect::<Vec<_>>().join(", ");
        format!("Alike up and down, within the smaller limit of both ({limit}): {names}.")
    };
    limits.into_iter().map(of).collect()
}

/// Where the motor came to the end of its effort, and for how long, in a sentence.
fn saturated(all: &[Compared]) -> Option<String> {
    let weak: Vec<&Compared> = all.iter().filter(|one| one.card.effort_saturated_time > 0.0).collect();
    let each = weak.iter().map(|one| {
        format!("{} for {}\u{a0}ms", clean(&one.name), plain(one.card.effort_saturated_time * 1e3))
    });
    let limit = &weak.first()?.effort_limit;
    Some(format!(
        "The drive wanted more than the {limit} of the motor: {}. What is left there is the motor's doing, not the family's: \
         lower the limits, or give a stronger axis by --model.",
        each.collect::<Vec<_>>().join(", ")
    ))
}

/// Which ways the axis lost altogether, in a sentence.
fn diverged(all: &[Compared]) -> Option<String> {
    let lost: Vec<String> =
        all.iter().filter(|one| one.curves.diverged).map(|one| clean(&one.name)).collect();
    (!lost.is_empty()).then(|| {
        format!(
            "The axis left its setpoints beyond any sense in {}: its figures there mean nothing. Lower the limits, or give \
             another axis by --model.",
            lost.join(", ")
        )
    })
}

/// How long each way takes and how the axis followed, in one small table.
pub(crate) fn table(screen: &mut Screen<'_>, all: &[Compared]) -> io::Result<()> {
    let Some(kind) = all.first().map(|compared| compared.kind) else { return Ok(()) };
    let mut table = Table::default();
    table.left("", "", names(all));
    table.right("lasts", "[s]", lasts(all));
    following(&mut table, all, kind);
    swinging(&mut table, all, kind);
    screen.out.write_all(table.render(screen.paint).as_bytes())
}

/// The limits that were chosen for the caller, each with its order.
pub(crate) fn chosen_limits(
    screen: &mut Screen<'_>,
    kind: AxisKind,
    limits: &[(usize, f64)],
) -> io::Result<()> {
    if limits.is_empty() {
        return Ok(());
    }
    let each = limits.iter().map(|(order, value)| {
        let quantity = Quantity::BY_ORDER[*order];
        format!("{quantity} {} {}", plain(*value), unit(kind, quantity))
    });
    let text = format!(
        "Limits that were not given, chosen so that each derivative takes half the time of the one below to its limit: {}.",
        each.collect::<Vec<_>>().join(", ")
    );
    writeln!(screen.out, "\n{}", wrapped(&text, ""))
}

fn names(all: &[Compared]) -> Vec<String> {
    all.iter().map(|compared| clean(&compared.name)).collect()
}

fn lasts(all: &[Compared]) -> Vec<String> {
    column(&all.iter().map(|one| one.duration).collect::<Vec<_>>(), 6)
}

fn planned(all: &[Compared], kind: AxisKind) -> Table {
    let mut table = Table::default();
    table.left("", "", names(all));
    table.right("lasts", "[s]", lasts(all));
    let quantities = [Quantity::Velocity, Quantity::Acceleration, Quantity::Jerk];
    for (index, quantity) in quantities.into_iter().enumerate() {
        let finite = |one: &Compared| Some(one.peaks[index]).filter(|peak| peak.is_finite());
        let cells = column_or(all, "unlimited", 5, finite);
        table.right(&format!("peak {quantity}"), &format!("[{}]", unit(kind, quantity)), cells);
    }
    table
}

fn followed(all: &[Compared], kind: AxisKind) -> Table {
    let mut table = Table::default();
    table.left("", "", names(all));
    following(&mut table, all, kind);
    small(&mut table, all, kind, "load, most", Compared::largest_load_error);
    swinging(&mut table, all, kind);
    table
}

/// How the motor followed.
fn following(table: &mut Table, all: &[Compared], kind: AxisKind) {
    small(table, all, kind, "motor, most", |one| one.card.max_following_error);
    small(table, all, kind, "RMS", |one| one.card.rms_following_error);
}

/// What the load did after the end.
fn swinging(table: &mut Table, all: &[Compared], kind: AxisKind) {
    small(table, all, kind, "left swinging", |one| one.card.residual_vibration_amplitude);
    let settles = |one: &Compared| one.card.settling_time.map(|time| time * 1e3);
    table.right("settles", "[ms]", column_or(all, "not yet", 4, settles));
}

/// A column of small lengths, in the unit in which people say them.
fn small(table: &mut Table, all: &[Compared], kind: AxisKind, heading: &str, of: impl Fn(&Compared) -> f64) {
    let (scale, unit) = match kind {
        AxisKind::Prismatic => (1e6, "[µm]"),
        AxisKind::Revolute => (1e6, "[µrad]"),
        AxisKind::Pulses => (1.0, "[pulses]"),
    };
    let values: Vec<f64> = all.iter().map(|one| of(one) * scale).collect();
    table.right(heading, unit, column(&values, 4));
}

/// The values that there are as one column, and `other` where there is none.
fn column_or(
    all: &[Compared],
    other: &str,
    digits: i32,
    of: impl Fn(&Compared) -> Option<f64>,
) -> Vec<String> {
    let values: Vec<Option<f64>> = all.iter().map(of).collect();
    let mut texts = column(&values.iter().copied().flatten().collect::<Vec<_>>(), digits).into_iter();
    values.iter().map(|value| value.and_then(|_| texts.next()).unwrap_or_else(|| other.to_owned())).collect()
}

/// For programs, in SI units.
pub(crate) fn json(all: &[Compared], chosen: &[(usize, f64)]) -> Value {
    let each = all.iter().map(|one| {
        let card = &one.card;
        let [velocity, acceleration, jerk] = one.peaks.map(|peak| peak.is_finite().then_some(peak));
        json!({
            "name": one.name,
            "axis": card.axis,
            "family": one.method.family.name(),
            "order": one.method.order,
            "duration": one.duration,
            "peakVelocity": velocity,
            "peakAcceleration": acceleration,
            "peakJerk": jerk,
            "maxFollowingError": card.max_following_error,
            "rmsFollowingError": card.rms_following_error,
            "maxLoadError": one.largest_load_error(),
            "settlingTime": card.settling_time,
            "residualVibrationAmplitude": card.residual_vibration_amplitude,
            "residualVibrationFrequency": card.residual_vibration_frequency,
            "maxEffort": card.max_effort,
            "effortSaturatedTime": card.effort_saturated_time,
            "diverged": one.curves.diverged,
        })
    });
    let chosen = chosen.iter().map(|(order, limit)| json!({ "order": order, "limit": limit }));
    json!({ "moves": each.collect::<Vec<_>>(), "chosenLimits": chosen.collect::<Vec<_>>() })
}
