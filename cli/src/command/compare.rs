use planner::motion::Motion;
use planner::{AxisKind, AxisPlan, Judged, LimitsSpec, Plan, RequestSpec};
use proto::{Reason, Rejected};
use sim_axis::{Axis, AxisConfig, DEFAULT_SETTLE_WINDOW, ReportCard};

use crate::args::CompareArgs;
use crate::command::machine::{Machine, PULSES_PER_METRE};
use crate::command::plan::in_flags;
use crate::failure::Failure;
use crate::law::Law;
use crate::service::{Server, Service};
use crate::show::compared::{self, Compared, Curves};
use crate::show::paint::Screen;
use crate::show::plot;
use crate::source;

/// `portamento compare`
pub(crate) fn run(args: &CompareArgs, server: Server<'_>, screen: &mut Screen<'_>) -> Result<(), Failure> {
    if let Some(tolerance) =
        args.settle_tolerance.filter(|tolerance| !(0.0..f64::INFINITY).contains(tolerance))
    {
        let text = format!("--settle-tolerance is {tolerance}: give a distance of 0 or more [u]");
        return Err(Failure::Usage(text));
    }
    let service = Service::open(server)?;
    let model = args.model.as_deref().map(source::axis_model).transpose()?;
    let machine = match &model {
        Some(model) => Machine::Given(model),
        None => Machine::Usual { pulses_per_metre: args.pulses_per_metre.unwrap_or(PULSES_PER_METRE) },
    };
    let watched = Watched { machine, settle_tolerance: args.settle_tolerance };
    let (all, chosen) = if args.request.is_empty() {
        args.families.iter().try_for_each(|law| args.limits.check_jerk(*law))?;
        let spec = args.one.to_spec(args.higher.beside(&args.limits), Law::default());
        let refused = |law, failure| of_law(in_flags(failure, screen.json), law);
        families(&service, &spec, &args.families, watched, refused)?
    } else {
        let mut all = Vec::new();
        for path in &args.request {
            let name = path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy();
            all.extend(followed(&name, &service.plan(source::request(path)?)?, watched)?);
        }
        (all, Chosen::default())
    };
    let kinds: Vec<AxisKind> = all.iter().map(|compared| compared.kind).collect();
    if kinds.windows(2).any(|pair| pair[0] != pair[1]) {
        return Err(Failure::NotAlike);
    }
    let kind = kinds.first().copied().unwrap_or(AxisKind::Prismatic);
    if args.pulses_per_metre.is_some() && kind != AxisKind::Pulses {
        let text = "--pulses-per-metre is of axes in pulses, and this one is not: leave it out, or say --kind pulses";
        return Err(Failure::Usage(text.to_owned()));
    }
    let words = machine.words(kind);
    if let Some(path) = &args.plot {
        plot::write(path, &plot::of_comparison(&all, &words))?;
    }
    if screen.json {
        writeln!(screen.out, "{}", compared::json(&all, &chosen.limits()))?;
        return Ok(());
    }
    compared::tables(screen, &all, &words)?;
    compared::chosen_limits(screen, kind, &chosen.limits())?;
    Ok(())
}

/// The axis that follows, and when it counts as settled [axis units].
#[derive(Clone, Copy)]
pub(super) struct Watched<'a> {
    pub(super) machine: Machine<'a>,
    pub(super) settle_tolerance: Option<f64>,
}

/// A refusal of one of several families, in the words in which it was asked for: there is no flag for an order.
fn of_law(failure: Failure, law: Law) -> Failure {
    match failure {
        Failure::Refused(mut rejected) => {
            for violation in &mut rejected.fields {
                if violation.field == "--order" {
                    violation.field = format!("--families {law}");
                }
            }
            Failure::Refused(rejected)
        }
        other => other,
    }
}

/// The move of `spec` by each of `laws`, followed by the same axis; and the limits that had to be chosen for it. `refused` says why there is
/// none of a law.
pub(super) fn families(
    service: &Service,
    spec: &RequestSpec,
    laws: &[Law],
    watched: Watched<'_>,
    refused: impl Fn(Law, Failure) -> Failure,
) -> Result<(Vec<Compared>, Chosen), Failure> {
    let mut spec = spec.clone();
    let chosen = Chosen::fill(&mut spec, laws);
    let mut all = Vec::new();
    for law in laws {
        let spec = RequestSpec { family: Ok(law.family), order: law.order, ..spec.clone() };
        let judged = service.plan(spec).map_err(|failure| refused(*law, failure))?;
        all.extend(followed(&law.to_string(), &judged, watched)?);
    }
    Ok((all, chosen))
}

/// Limits that somebody left out and a family needs: what this tool took instead, from which order on.
#[derive(Clone, Debug, Default)]
pub(super) struct Chosen {
    first_order: usize,
    values: Vec<f64>,
}

impl Chosen {
    /// Completes the limits of `spec` up to the order of the highest of `laws`.
    ///
    /// Where the limits of two neighbouring derivatives are `a` and `j`, the lower takes `a/j` to its limit; the next one, `2·j²/a`,
    /// takes half of that, and so on. A polynomial reaches every limit where each of these times is at least the sum of all shorter
    /// ones, which halving keeps for any order with the least to spare: so these are the gentlest limits that are all reached.
    fn fill(spec: &mut RequestSpec, laws: &[Law]) -> Self {
        let order = laws.iter().filter_map(|law| law.order).max().unwrap_or(0) as usize;
        let mut chosen = Self::default();
        for axis in &mut spec.axes {
            let LimitsSpec { max_acceleration, max_jerk, max_snap, max_higher_derivatives, .. } =
                &mut axis.limits;
            let mut limits = vec![*max_acceleration, *max_jerk];
            limits.extend(*max_snap);
            if max_snap.is_some() {
                limits.extend(max_higher_derivatives.iter());
            }
            let given = limits.len() + 1;
            // A snap that is missing below others is the planner's to refuse.
            if max_snap.is_none() && !max_higher_derivatives.is_empty() {
                continue;
            }
            while limits.len() + 1 < order.min(planner::MAX_ORDER) {
                let (lower, upper) = (limits[limits.len() - 2], limits[limits.len() - 1]);
                limits.push(2.0 * upper * upper / lower);
            }
            chosen = Self { first_order: given + 1, values: limits[given - 1..].to_vec() };
            *max_snap = limits.get(2).copied();
            *max_higher_derivatives = limits.get(3..).unwrap_or_default().to_vec();
        }
        chosen
    }

    /// Each with its order.
    pub(super) fn limits(&self) -> Vec<(usize, f64)> {
        self.values.iter().enumerate().map(|(index, value)| (self.first_order + index, *value)).collect()
    }
}

/// The longest motion that is compared \[cycles\], ten minutes of milliseconds: every cycle of every family is kept for the
/// figure, and nobody looks at more.
const MOST_CYCLES: u64 = 600_000;

/// What every axis of a plan does, each on an axis of its own.
fn followed(name: &str, judged: &Judged, watched: Watched<'_>) -> Result<Vec<Compared>, Failure> {
    // With the closing stop that it has on a stream, where it ends at speed.
    let motion =
        Motion::open(judged.clone().accepted().map_err(Failure::refused)?).map_err(Failure::refused)?;
    let (plan, cycles) = (judged.plan(), motion.plan().cycle_count());
    if cycles > MOST_CYCLES {
        let text = format!(
            "{name} lasts {cycles} cycles, and at most {MOST_CYCLES} are compared: shorten the move, or lengthen the \
             cycle time"
        );
        let rejected = Rejected::new(Reason::TooManyCycles, text);
        return Err(Failure::refused(rejected.with("given", cycles).with("allowed", MOST_CYCLES)));
    }
    let several = plan.axes().len() > 1;
    let each = plan.axes().iter().enumerate().map(|(index, axis)| {
        let name = if several { format!("{name}, {}", axis.axis) } else { name.to_owned() };
        let (curves, card) = follow(motion.plan(), index, axis, watched)?;
        Ok(Compared::new(name, judged, axis, curves, card, watched.machine.effort_limit(axis.kind)))
    });
    each.collect()
}

fn follow(
    plan: &Plan,
    index: usize,
    axis: &AxisPlan,
    Watched { machine, settle_tolerance }: Watched<'_>,
) -> Result<(Curves, ReportCard), Failure> {
    let cycle = plan.cycle_time().as_seconds();
    let config = AxisConfig {
        cycle,
        settle_window: DEFAULT_SETTLE_WINDOW,
        settle_tolerance: settle_tolerance.unwrap_or(settled_within(axis.kind)),
    };
    let mut curves = Curves::default();
    let mut sampler = plan.sampler();
    let mut setpoint_at = |cycle| sampler.at(cycle).nth(index).unwrap_or_default().state;
    let start = setpoint_at(0);
    let model = machine.model(axis.kind).renamed(axis.axis.clone());
    let mut machine = Axis::new(&model, config, &start)
        .map_err(|cause| Failure::Simulation { axis: axis.axis.clone(), cause })?;
    for number in 1..=plan.cycle_count() {
        let setpoint = setpoint_at(number);
        curves.push(plan.cycle_time().start_of(number), setpoint, machine.step(&setpoint));
    }
    machine.begin_settling();
    let end = setpoint_at(plan.cycle_count());
    let mut number = plan.cycle_count();
    while !machine.settle_window_is_over() {
        number += 1;
        curves.push(plan.cycle_time().start_of(number), end, machine.rest());
    }
    Ok((curves, machine.report()))
}

/// How near to the goal a comparison counts as settled [axis units]: what tells smooth motions apart is small.
fn settled_within(kind: AxisKind) -> f64 {
    match kind {
        AxisKind::Prismatic | AxisKind::Revolute => 1e-6,
        AxisKind::Pulses => 1.0,
    }
}
