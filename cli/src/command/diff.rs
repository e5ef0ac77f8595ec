use planner::{AxisKind, Plan, Quantity};

use crate::args::DiffArgs;
use crate::failure::Failure;
use crate::show::paint::Screen;
use crate::show::{differences, json};
use crate::source;

/// `portamento diff`
pub(crate) fn run(args: &DiffArgs, screen: &mut Screen<'_>) -> Result<(), Failure> {
    if args.a == args.b && args.a.as_os_str() == "-" {
        let text = "both plans are read from standard input, which has one: name a file for the other";
        return Err(Failure::Usage(text.to_owned()));
    }
    let (a, b) = (source::plan(&args.a)?, source::plan(&args.b)?);
    if a.cycle_time() != b.cycle_time() {
        return Err(Failure::Usage(format!(
            "the plans have cycles of {} ns and {} ns, so their setpoints are not of the same instants: plan both with one \
             --cycle-time",
            a.cycle_time().as_ns(),
            b.cycle_time().as_ns()
        )));
    }
    let differences = Differences::between(&a, &b, args.tolerance);
    if screen.json {
        writeln!(screen.out, "{}", json::differences(&differences))?;
    } else {
        differences::table(screen, [&a, &b], &differences)?;
    }
    if differences.none() { Ok(()) } else { Err(Failure::Differ) }
}

/// In what two plans differ.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Differences {
    /// How long each lasts [s].
    pub(crate) durations: [f64; 2],
    /// Axes that only the one has, and only the other.
    pub(crate) alone: [Vec<String>; 2],
    /// Of each axis that both have, and each quantity.
    pub(crate) worst: Vec<Worst>,
    /// Where they part, in the first axis and quantity that do.
    pub(crate) first: Option<Parting>,
}

/// The greatest difference of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Worst {
    pub(crate) axis: String,
    pub(crate) kind: AxisKind,
    pub(crate) quantity: Quantity,
    /// [units of the quantity]
    pub(crate) difference: f64,
    /// The first cycle in which it is so great.
    pub(crate) cycle: u64,
    /// The greatest value of the quantity in either plan.
    pub(crate) greatest: f64,
}

/// The first setpoint that is not the same.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Parting {
    pub(crate) cycle: u64,
    pub(crate) axis: String,
    pub(crate) kind: AxisKind,
    pub(crate) quantity: Quantity,
    pub(crate) values: [f64; 2],
}

const QUANTITIES: [Quantity; 4] =
    [Quantity::Position, Quantity::Velocity, Quantity::Acceleration, Quantity::Jerk];

/// Setpoints compared at a time.
const CHUNK: u64 = 4096;

impl Differences {
    /// Differences of at most `tolerance` times the greatest value of their quantity count as none.
    fn between(a: &Plan, b: &Plan, tolerance: f64) -> Self {
        let missing = |one: &Plan, other: &Plan| -> Vec<String> {
            let names = one.axes().iter().map(|axis| axis.axis.clone());
            names.filter(|name| place_of(other, name).is_none()).collect()
        };
        let mut found = Self {
            durations: [a.duration(), b.duration()],
            alone: [missing(a, b), missing(b, a)],
            worst: Vec::new(),
            first: None,
        };
        for (in_a, axis) in a.axes().iter().enumerate() {
            let Some(in_b) = place_of(b, &axis.axis) else { continue };
            let pair = Pair { plans: [a, b], places: [in_a, in_b] };
            let worst = pair.worst();
            // In cycles from the first one on, so that the earliest of all axes is kept.
            let allowed = [0, 1, 2, 3].map(|word| tolerance * worst[word].2);
            let until = found.first.as_ref().map_or(u64::MAX, |parting| parting.cycle);
            if let Some((cycle, word, values)) = pair.parting(allowed, until) {
                let (axis, kind, quantity) = (axis.axis.clone(), axis.kind, QUANTITIES[word]);
                found.first = Some(Parting { cycle, axis, kind, quantity, values });
            }
            found.worst.extend(worst.into_iter().zip(QUANTITIES).map(
                |((difference, cycle, greatest), quantity)| Worst {
                    axis: axis.axis.clone(),
                    kind: axis.kind,
                    quantity,
                    difference,
                    cycle,
                    greatest,
                },
            ));
        }
        found
    }

    /// Is there no difference that counts?
    pub(crate) fn none(&self) -> bool {
        self.first.is_none() && self.alone.iter().all(Vec::is_empty)
    }
}

fn place_of(plan: &Plan, name: &str) -> Option<usize> {
    plan.axes().iter().position(|axis| axis.axis == name)
}

/// One axis in both plans.
struct Pair<'a> {
    plans: [&'a Plan; 2],
    places: [usize; 2],
}

impl Pair<'_> {
    /// Of each quantity the greatest difference, its cycle, and the greatest value.
    fn worst(&self) -> [(f64, u64, f64); 4] {
        let mut worst = [(0.0_f64, 0_u64, 0.0_f64); 4];
        self.each(u64::MAX, |cycle, words| {
            for (worst, [a, b]) in worst.iter_mut().zip(words) {
                let difference = (a - b).abs();
                if difference > worst.0 {
                    (worst.0, worst.1) = (difference, cycle);
                }
                worst.2 = worst.2.max(a.abs()).max(b.abs());
            }
            true
        });
        worst
    }

    /// The first setpoint that differs by more than is allowed, before cycle `until`.
    fn parting(&self, allowed: [f64; 4], until: u64) -> Option<(u64, usize, [f64; 2])> {
        let mut found = None;
        self.each(until, |cycle, words| {
            let differs = |(word, [a, b]): &(usize, [f64; 2])| {
                // A zero without a sign is the same place as one with it; what is not a number is never the same.
                (a - b).abs().partial_cmp(&allowed[*word]).is_none_or(std::cmp::Ordering::is_gt)
            };
            found = words.into_iter().enumerate().find(differs).map(|(word, values)| (cycle, word, values));
            found.is_none()
        });
        found
    }

    /// Both setpoints of every cycle before `until`, until the longer plan has ended or `see` has seen enough.
    fn each(&self, until: u64, mut see: impl FnMut(u64, [[f64; 2]; 4]) -> bool) {
        let [a, b] = self.plans;
        let end = (a.cycle_count().max(b.cycle_count()) + 1).min(until);
        let mut samplers = [a.sampler(), b.sampler()];
        let mut from = 0;
        while from < end {
            let to = end.min(from + CHUNK);
            let count = (to - from) as usize;
            let mut columns = [(); 2].map(|()| [(); 4].map(|()| vec![0.0; count]));
            for ((sampler, place), columns) in samplers.iter_mut().zip(self.places).zip(&mut columns) {
                sampler.fill(place, from, columns.each_mut().map(Vec::as_mut_slice));
            }
            let [left, right] = columns;
            for (cycle, index) in (from..to).zip(0..) {
                if !see(cycle, [0, 1, 2, 3].map(|word| [left[word][index], right[word][index]])) {
                    return;
                }
            }
            from = to;
        }
    }
}
