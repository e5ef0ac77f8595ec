//! Commands as they come, each answered before the next is read.

use std::io::{self, BufRead as _};

use planner::{
    Adjustment, AdjustmentReason, Limits, PvtMove, PvtPlanner, PvtPointReport, PvtTarget, Quantity, State,
};
use proto::{Reason, Rejected};

use crate::args::PvtArgs;
use crate::command::plan::in_flags;
use crate::failure::Failure;
use crate::law::Law;
use crate::show::number::counted;
use crate::show::paint::{Screen, clean, wrapped};
use crate::show::{json, points};
use crate::source::{cells, number};

/// What the axis is called where nobody names it.
const AXIS: &str = "x";

/// `portamento pvt --follow`
pub(super) fn run(args: &PvtArgs, screen: &mut Screen<'_>) -> Result<(), Failure> {
    args.limits.check_jerk(Law::default())?;
    let limits = Limits::try_from(args.limits.to_spec())
        .map_err(|invalid| in_flags(Failure::refused(within_limits(invalid)), screen.json))?;
    let mut axis = Following::new(args, limits)?;
    if !screen.json {
        points::heading(screen, args.method.kind())?;
        screen.out.flush()?;
    }
    for (index, line) in io::stdin().lock().lines().enumerate() {
        let line = line.map_err(Failure::unreadable("-".as_ref()))?;
        match axis.answer(&line) {
            Ok(None) => continue,
            Ok(Some(report)) if screen.json => writeln!(screen.out, "{}", json::point(&report, AXIS)?)?,
            Ok(Some(report)) => points::row(screen, &report, axis.before.position)?,
            Err(rejected) => {
                let rejected = rejected.with("line", index + 1);
                if screen.json {
                    writeln!(screen.out, "{}", json::error(&rejected))?;
                } else {
                    let text = wrapped(&format!("line {}: {}", index + 1, clean(&rejected.to_string())), "");
                    writeln!(screen.out, "{}", screen.paint.bad(&text))?;
                }
            }
        }
        screen.out.flush()?;
    }
    Ok(())
}

fn within_limits(inner: planner::InvalidFields) -> planner::InvalidFields {
    let mut invalid = planner::InvalidFields::default();
    invalid.extend_within(&planner::Field::named("limits"), inner);
    invalid
}

/// One axis on its way from command to command.
struct Following<'a> {
    args: &'a PvtArgs,
    limits: Limits,
    planner: PvtPlanner,
    /// How many commands were taken.
    taken: usize,
    /// When the last one was to be met [s], as asked, and how much later it was [s].
    time: f64,
    shift: f64,
    /// Where it began.
    before: State,
    /// Has a line been read that has numbers?
    begun: bool,
}

impl<'a> Following<'a> {
    fn new(args: &'a PvtArgs, limits: Limits) -> Result<Self, Failure> {
        let planner = PvtPlanner::new(State::default(), limits.clone(), args.method.policy());
        let planner = planner.map_err(Failure::refused)?;
        let before = State::default();
        Ok(Self { args, limits, planner, taken: 0, time: 0.0, shift: 0.0, before, begun: false })
    }

    /// What becomes of a command; nothing for lines that are none.
    fn answer(&mut self, line: &str) -> Result<Option<PvtPointReport>, Rejected> {
        let is_head = !self.begun && line.trim_start().starts_with("time");
        if line.trim().is_empty() || is_head {
            return Ok(None);
        }
        let not_a_command = |cause: String| {
            let text = format!("{cause}: give time,position,velocity, as 0.05,0.0012,0.031");
            Rejected::new(Reason::MessageInvalid, text)
        };
        let cells = cells(line).unwrap_or_default();
        let [time, position, velocity] = cells.as_slice() else {
            return Err(not_a_command(format!("has {}", counted(cells.len() as u64, "number"))));
        };
        let read = |cell: &String| number(cell).map_err(not_a_command);
        let (time, position, velocity) = (read(time)?, read(position)?, read(velocity)?);
        let begins = !self.begun && time == 0.0;
        self.begun = true;
        if begins {
            let start = State { position, velocity, acceleration: 0.0 };
            self.planner = PvtPlanner::new(start, self.limits.clone(), self.args.method.policy())?;
            return Ok(None);
        }
        let before = self.planner.state();
        let target = PvtTarget { position, velocity, duration: time - self.time };
        let planned = self.planner.command(target)?;
        self.before = before;
        let report = self.report(&planned, time, target.duration);
        (self.time, self.taken) = (time, self.taken + 1);
        Ok(Some(report))
    }

    /// As one of a table: times from the start, not from the command before.
    fn report(&mut self, planned: &PvtMove, asked: f64, duration: f64) -> PvtPointReport {
        let motion = planned.motion();
        let reached = motion.reached();
        let is_of_time = |adjustment: &&Adjustment| adjustment.quantity == Quantity::Time;
        let extended = motion.adjustments().iter().find(is_of_time);
        self.shift += extended.map_or(0.0, |adjustment| adjustment.planned - duration);
        let time = asked + self.shift;
        let late = (self.shift > 0.0).then(|| {
            let reason = match extended {
                Some(_) => AdjustmentReason::PvtTimeExtended,
                None => AdjustmentReason::PvtTimeShifted,
            };
            Adjustment { quantity: Quantity::Time, asked, planned: time, reason }
        });
        let others = motion.adjustments().iter().filter(|adjustment| !is_of_time(adjustment));
        PvtPointReport {
            axis: 0,
            point: self.taken,
            region: Some(planned.region()),
            position: reached.position,
            velocity: reached.velocity,
            time,
            reachable: Some((planned.least_displacement(), planned.greatest_displacement())),
            adjustments: others.copied().chain(late).collect(),
        }
    }
}
