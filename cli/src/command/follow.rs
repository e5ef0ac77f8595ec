//! Commands as they come, each answered before the next is read.

use std::io::{self, BufRead as _};

use planner::{
    Adjustment, AdjustmentReason, CycleTime, Field, InvalidFields, Limits, PvtMove, PvtPlanner,
    PvtPointReport, PvtTarget, Quantity, State, Why, wrong_time,
};
use proto::{Reason, Rejected};

use crate::args::{self, PvtArgs};
use crate::command::plan::in_flags;
use crate::failure::Failure;
use crate::law::Law;
use crate::show::number::counted;
use crate::show::paint::{Screen, refusal, wrapped};
use crate::show::{json, points};
use crate::source::{cells, number};

/// What the axis is called where nobody names it.
const AXIS: &str = "x";

/// `portamento pvt --follow`
pub(super) fn run(args: &PvtArgs, screen: &mut Screen<'_>) -> Result<(), Failure> {
    args.limits.check_jerk(Law::default())?;
    let limits = Limits::try_from(args.limits.to_spec())
        .map_err(|invalid| in_flags(Failure::refused(within_limits(invalid)), screen.json))?;
    let cycle = CycleTime::from_ns(args.method.cycle_time)
        .map_err(|invalid| in_flags(Failure::refused(invalid), screen.json))?;
    let mut axis = Following::new(args, limits, cycle);
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
            Err(rejected) if screen.json => {
                writeln!(screen.out, "{}", json::error(&rejected.with("line", index + 1)))?;
            }
            Err(rejected) => {
                let text = args::in_flags(&refusal(&rejected));
                let text = wrapped(&format!("line {}: {text}", index + 1), "");
                writeln!(screen.out, "{}", screen.paint.bad(&text))?;
            }
        }
        screen.out.flush()?;
    }
    Ok(())
}

fn within_limits(inner: InvalidFields) -> InvalidFields {
    let mut invalid = InvalidFields::default();
    invalid.extend_within(&Field::named("limits"), inner);
    invalid
}

/// How far it has got.
///
/// ```text
/// Open ── a start, or a command ──► Under way
///  │                                    ▲
///  └── a start that is refused ──► Stranded ── a start
/// ```
enum Phase {
    /// Nothing was taken yet: it rests at 0, unless a line at time 0 says otherwise.
    Open(PvtPlanner),
    /// Nobody knows where it is: the line that was to say so was refused, or it cannot rest at 0.
    Stranded,
    /// It is where it was sent, or began.
    UnderWay(PvtPlanner),
}

/// One axis on its way from command to command.
struct Following<'a> {
    args: &'a PvtArgs,
    limits: Limits,
    cycle: CycleTime,
    phase: Phase,
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
    fn new(args: &'a PvtArgs, limits: Limits, cycle: CycleTime) -> Self {
        let before = State::default();
        let at_zero = PvtPlanner::new(before, limits.clone(), args.method.policy());
        let phase = at_zero.map_or(Phase::Stranded, Phase::Open);
        Self { args, limits, cycle, phase, taken: 0, time: 0.0, shift: 0.0, before, begun: false }
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
        let numbers = match cells.as_slice() {
            [time, position, velocity] => [time, position, velocity].map(|cell| number(cell)),
            _ => {
                let cause = format!("has {}", counted(cells.len() as u64, "number"));
                return Err(self.unread(not_a_command(cause)));
            }
        };
        let [time, position, velocity] = match numbers {
            [Ok(time), Ok(position), Ok(velocity)] => [time, position, velocity],
            numbers => {
                let cause = numbers.into_iter().find_map(Result::err).unwrap_or_default();
                return Err(self.unread(not_a_command(cause)));
            }
        };
        self.begun = true;
        if time == 0.0 && !matches!(self.phase, Phase::UnderWay(_)) {
            self.start(State { position, velocity, acceleration: 0.0 })?;
            return Ok(None);
        }
        let answer = self.command(time, position, velocity).map(Some);
        // A time that is none may have been to be 0.
        if time.is_finite() { answer } else { answer.map_err(|rejected| self.unread(rejected)) }
    }

    /// Before anything was taken, a line that cannot be read may have been the one that says where the axis starts.
    fn unread(&mut self, rejected: Rejected) -> Rejected {
        self.begun = true;
        if matches!(self.phase, Phase::Open(_)) {
            self.phase = Phase::Stranded;
        }
        rejected
    }

    fn start(&mut self, start: State) -> Result<(), Rejected> {
        self.phase = Phase::Stranded;
        let planner = PvtPlanner::new(start, self.limits.clone(), self.args.method.policy());
        self.phase = Phase::UnderWay(planner.map_err(|refused| in_line(&refused, 0.0))?);
        Ok(())
    }

    fn command(&mut self, time: f64, position: f64, velocity: f64) -> Result<PvtPointReport, Rejected> {
        let interval = self.interval(time);
        let (Phase::Open(planner) | Phase::UnderWay(planner)) = &mut self.phase else {
            let text = "nobody knows where the axis is: give a line at time 0 that can be taken, as 0,0.01,0";
            return Err(Rejected::new(Reason::ProtocolOrder, text));
        };
        let duration = interval.map_err(|why| InvalidFields::one(Field::named("time"), why))?;
        let before = planner.state();
        let begin = self.time + self.shift;
        let target = PvtTarget { position, velocity, duration };
        let planned = planner.command(target).map_err(|refused| in_line(&refused, begin))?;
        if let Phase::Open(planner) = &self.phase {
            self.phase = Phase::UnderWay(planner.clone());
        }
        self.before = before;
        let report = self.report(&planned, time, duration);
        (self.time, self.taken) = (time, self.taken + 1);
        Ok(report)
    }

    /// How long there is from the command before \[s\], as a request for points asks of each: a cycle at least.
    fn interval(&self, time: f64) -> Result<f64, Why> {
        wrong_time(time, self.time, Some(self.cycle)).map_or(Ok(time - self.time), Err)
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

/// A refusal of a command in the words of its line, where all times count from the start; the command began at `begin` [s].
fn in_line(refused: &InvalidFields, begin: f64) -> InvalidFields {
    let mut invalid = InvalidFields::default();
    for refused in refused.as_slice() {
        let field = refused.field.as_str();
        let name = match field.strip_prefix("start.").unwrap_or(field) {
            "duration" => "time",
            name => name,
        };
        let mut why = refused.why.clone();
        if let Why::PvtLeavesRange { time, .. } = &mut why {
            *time += begin;
        }
        invalid.note(name, Some(why));
    }
    invalid
}
