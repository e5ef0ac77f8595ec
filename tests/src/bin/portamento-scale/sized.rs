//! Plants, from what was measured: how many servers it takes that no axis misses a cycle when some of them die.

use e2e::{Costs, Fleet, Heirs, Life, Mortality, Outcome, Plant, live};

use crate::Failed;
use crate::fit::Fit;
use crate::measured::{Point, series};

/// Cores of a server: as many as it was measured on.
pub(crate) const CORES: usize = 2;
/// Of these cores streams and calls may take so much when servers are dead [1]: the rest is for the moment in which streams open, and
/// for what else a machine does.
const BUSY: f64 = 0.5;
/// What was measured, too.
const LEAD: f64 = 0.1;
const BATCH: f64 = 0.02;
const GATEWAY: usize = 50;
/// Within a plant's network, one way \[s\].
const TRIP: f64 = 250e-6;
/// Calls of `Plan` for each axis [1/s].
const PLANS: f64 = 0.1;
/// With so many times as many servers as streams alone would need, more of them are not what is missing.
const GIVEN_UP: usize = 4;
/// How often the same failure is simulated, each time with other phases and heirs.
const SEEDS: u64 = 5;
/// Preamble, check sum and gap of a packet of Ethernet, which the loopback interface does not have [bytes].
const ETHERNET: f64 = 24.0;

/// What a stream costs, by what was measured.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stream {
    pub(crate) costs: Costs,
    /// Both ways, with all headers [bytes/s].
    pub(crate) bytes: f64,
    /// Of a server's process, for each stream, and without any [MiB].
    pub(crate) memory: f64,
    pub(crate) base: f64,
    /// As many as a server was measured with.
    pub(crate) most: usize,
}

impl Stream {
    pub(crate) fn measured(points: &[Point], form: &str) -> Result<Self, Failed> {
        let law = |question: &str, name: &str| {
            let sizes: Vec<_> = series(points, question, name).iter().map(|it| (it.n, it.median)).collect();
            Fit::of(&sizes)
                .map(|fit| (fit, sizes))
                .ok_or_else(|| format!("nothing measured of {question}, {name}"))
        };
        // What one stream costs among many.
        let among_many = |question: &str, name: &str| {
            law(question, name).map(|(fit, sizes)| {
                let most = sizes.iter().map(|size| size.0).fold(1.0, f64::max);
                fit.at(most) / most
            })
        };
        let last = |question: &str, name: &str| {
            let found = series(points, question, name).last().map(|point| point.median);
            found.ok_or_else(|| format!("nothing measured of {question}, {name}"))
        };
        let costs = Costs {
            batch: among_many("streams", &format!("server, {form}"))? * BATCH,
            take_over: last("take-over cost", &format!("server, {form}"))? * 1e-6,
            ask: last("take-over cost", &format!("axes, {form}"))? * 1e-6,
            plan: last("Plan, by the clock", "server ns each")? * 1e-9,
        };
        let (memory, _) = law("memory", &format!("server, {form}"))?;
        let bytes = 1000.0 * (last("bytes", form)? + ETHERNET * last("packets", form)?);
        let most =
            series(points, "streams", &format!("server, {form}")).last().map_or(1, |point| point.n as usize);
        Ok(Self { costs, bytes, memory: memory.each, base: memory.fixed, most })
    }
}

/// The smallest plant that does.
#[derive(Clone, Debug)]
pub(crate) struct Sized {
    pub(crate) plant: Plant,
    /// The worst of all seeds.
    pub(crate) worst: Outcome,
    /// The same where all axes have one list of servers in one order.
    pub(crate) in_order: Outcome,
}

impl Sized {
    /// So many servers may die at the same moment, and none of the others then has more streams than servers were measured with.
    pub(crate) fn least(axes: usize, deaths: usize, stream: &Stream, seed: u64) -> Result<Self, Failed> {
        // From where the streams alone fit.
        let work = axes as f64 * (stream.costs.batch / BATCH + PLANS * stream.costs.plan);
        let fit = (work / (BUSY * CORES as f64)).ceil() as usize;
        let fewest = deaths + fit.max(axes.div_ceil(stream.most));
        for replicas in fewest..=GIVEN_UP * fewest {
            let plant = plant(axes, replicas, stream);
            let worst = worst_of(&plant, deaths, seed);
            if worst.underruns == 0 && worst.most_streams <= stream.most {
                let in_order = worst_of(&Plant { heirs: Heirs::Next, ..plant.clone() }, deaths, seed);
                return Ok(Self { plant, worst, in_order });
            }
        }
        Err(format!("{axes} axes miss cycles with {} servers, too, where {deaths} die", GIVEN_UP * fewest)
            .into())
    }

    /// A hundred deaths one after the other: a server lives for thirty days, and is back after ten seconds.
    pub(crate) fn lives(&self, heirs: Heirs, seed: u64) -> Life {
        let (between_deaths, restart) = (30.0 * 24.0, 10.0 / 3600.0);
        let horizon = 100.0 * between_deaths / self.plant.replicas as f64;
        let plant = Plant { heirs, ..self.plant.clone() };
        live(&plant, Mortality { between_deaths, restart, horizon }, seed)
    }
}

fn plant(axes: usize, replicas: usize, stream: &Stream) -> Plant {
    Plant {
        axes,
        replicas,
        cores: CORES,
        gateway: GATEWAY,
        lead: LEAD,
        batch: BATCH,
        trip: TRIP,
        heirs: Heirs::Any,
        costs: stream.costs,
        plans: PLANS * axes as f64,
    }
}

/// Of the same failure with other seeds: the one in which an axis had the least in hand.
fn worst_of(plant: &Plant, deaths: usize, seed: u64) -> Outcome {
    let dead: Vec<usize> = (0..deaths).collect();
    let outcome = |seed: u64| Fleet::new(plant.clone(), seed).fail(&dead, &[]);
    let mut worst = outcome(seed);
    for more in 1..SEEDS {
        let other = outcome(seed.wrapping_add(more));
        if other.least_left < worst.least_left {
            worst = other;
        }
    }
    worst
}

/// What was measured of a kill, simulated: one gateway that has one of the two cores, all streams at the server that dies.
pub(crate) fn as_measured(streams: usize, stream: &Stream, seed: u64) -> Outcome {
    let plant = Plant {
        cores: 1,
        gateway: streams,
        trip: 0.0,
        plans: 0.0,
        heirs: Heirs::Next,
        ..plant(streams, 2, stream)
    };
    Fleet::with(plant, vec![0; streams], seed).fail(&[0], &[])
}
