//! A whole network in simulated time: replicas that die, hang and come back, lines that go silent, in thousands of seeded runs. No setpoint
//! is lost, doubled or discontinuous, and every run ends at rest, in its goal.
//!
//! A run that fails says its seed: put it into `the_seed_that_failed` and run that. The long ones:
//!
//! ```text
//! cargo test --release -p e2e --test e2e simulated -- --ignored --nocapture
//! ```

use e2e::{Axis, Faults, Network, difference, move_of, open, planned, replay};
use planner::motion::{Operation as Planned, Override};
use planner::{LimitsSpec, Setpoint};
use proto::Digest;
use proto::stream::{Ask, Open, Operation};

/// How far axes go, and for how long things go wrong on the way.
#[derive(Clone, Copy)]
struct Way {
    /// \[m\], at 0.25 m/s.
    distance: f64,
    /// \[cycles\]
    heals_at: u64,
    /// Far more than any run takes \[cycles\].
    most_ticks: u64,
}

/// Some four seconds.
const SHORT: Way = Way { distance: 0.5, heals_at: 4000, most_ticks: 60_000 };
/// An hour.
const HOUR: Way = Way { distance: 900.0, heals_at: 3_600_000, most_ticks: 4_500_000 };

const ROUGH: Faults =
    Faults { dies: 1e-3, down_for: 400, hangs: 1e-3, hangs_for: 300, line_dies: 2e-3, delay: 3 };

/// What is asked for on the way: when, and what.
fn script() -> [(u64, &'static str, Ask, Planned); 4] {
    let half = Override::new(0.5).expect("a factor");
    [
        (300, "slower", Ask::Override(0.5), Planned::Override(half)),
        (900, "hold", Ask::Hold, Planned::Hold),
        (1300, "on", Ask::Resume, Planned::Resume),
        (1700, "full", Ask::Override(1.0), Planned::Override(Override::FULL)),
    ]
}

fn limits() -> LimitsSpec {
    LimitsSpec { max_velocity: 0.25, max_acceleration: 3.0, max_jerk: 100.0, ..LimitsSpec::default() }
}

/// Setpoints go on from each cycle to the next, and their digest with them.
fn assert_continuous(axis: &Axis, what: &str) {
    let (t, jerk) = (1e-3, limits().max_jerk * (1.0 + 1e-6));
    let mut digest = Digest::ZERO;
    for (cycle, pair) in axis.played.windows(2).enumerate() {
        let (p, q) = (pair[0][0].state, pair[1][0].state);
        let off = [
            ((q.acceleration - p.acceleration).abs(), jerk * t),
            (
                (q.velocity - p.velocity - 0.5 * t * (p.acceleration + q.acceleration)).abs(),
                jerk * t * t / 4.0,
            ),
            ((q.position - p.position - 0.5 * t * (p.velocity + q.velocity)).abs(), jerk * t * t * t / 12.0),
        ];
        // A few roundings of the largest number there.
        let rounding = 4.0 * f64::EPSILON * q.position.abs().max(10.0);
        for (off, bound) in off {
            assert!(off <= bound + rounding, "{what}: a jump after cycle {cycle}: {p:?} {q:?}");
        }
        digest = digest.then(cycle as u64 + 1, pair[1].iter().map(Setpoint::words));
        assert_eq!(axis.digests[cycle + 1], digest, "{what}: cycle {}", cycle + 1);
    }
}

/// What a run came to.
#[derive(Debug, Default)]
struct Tally {
    failovers: usize,
    starved: usize,
    undisturbed: usize,
    cycles: usize,
}

impl Tally {
    fn add(&mut self, other: &Self) {
        self.failovers += other.failovers;
        self.starved += other.starved;
        self.undisturbed += other.undisturbed;
        self.cycles += other.cycles;
    }
}

fn run(seed: u64, axes: usize, faults: Faults, way: Way) -> Tally {
    let plan = planned(move_of(way.distance, 0.25));
    // Every other one evaluates the motion itself.
    let opens = (0..axes).map(|axis| Open {
        lead_cycles: 60,
        compact: axis % 2 == 1,
        ..open(&format!("cell-7/{axis}"), plan.clone())
    });
    let mut network = Network::new(opens.collect(), 3, faults, seed);
    for axis in 0..axes {
        for (cycle, id, ask, _) in script() {
            let operation = Operation { not_before_cycle: Some(cycle), ..Operation::now(id, ask) };
            network.operate(axis, operation);
        }
    }
    let mut ticks = 0;
    while !network.is_over() {
        network.tick();
        ticks += 1;
        assert!(
            ticks < way.most_ticks,
            "seed {seed}: not over: {:?}",
            network
                .axes
                .iter()
                .enumerate()
                .filter(|(_, a)| a.over.is_none())
                .map(|(i, a)| (i, a.played.len(), a.failover(), a.buffer()))
                .collect::<Vec<_>>()
        );
        if ticks == way.heals_at {
            network.heal();
        }
        // Whoever has come to rest by himself goes on only when he is told to.
        if ticks > way.heals_at && ticks.is_multiple_of(500) {
            for axis in 0..axes {
                if network.axes[axis].has_starved() {
                    network.operate(axis, Operation::now(format!("again-{ticks}"), Ask::Resume));
                }
            }
        }
    }
    let mut tally = Tally::default();
    for (index, axis) in network.axes.iter().enumerate() {
        let what = format!("seed {seed}, axis {index}");
        assert_eq!(axis.over, Some(Ok(())), "{what}");
        assert_continuous(axis, &what);
        let last = axis.played.last().expect("a cycle")[0];
        assert_eq!(last.words(), [way.distance, 0.0, 0.0, 0.0], "{what}: it ends in its goal, at rest");
        tally.failovers += axis.causes.len();
        tally.cycles += axis.played.len();
        if axis.has_starved() {
            tally.starved += 1;
            continue;
        }
        // Not a bit is other than if nothing had happened.
        let done: Vec<(u64, Planned)> = script()
            .into_iter()
            .filter_map(|(_, id, _, operation)| {
                let answers = axis.answers.iter().filter(|answer| answer.0 == id);
                let mut done = answers.filter_map(|answer| answer.1.as_ref().ok());
                done.next_back().map(|result| (result.effective_cycle, operation))
            })
            .collect();
        assert_eq!(done.len(), script().len(), "{what}: {:?}", axis.answers);
        let (expected, digest, _) = replay(&plan, &done, axis.played.len() as u64 - 1);
        assert_eq!(difference(&axis.played[1..], &expected), None, "{what}");
        assert_eq!(axis.digests.last(), Some(&digest), "{what}");
        tally.undisturbed += 1;
    }
    tally
}

fn runs(seeds: std::ops::Range<u64>, axes: usize, faults: Faults) -> Tally {
    let mut tally = Tally::default();
    for seed in seeds {
        tally.add(&run(seed, axes, faults, SHORT));
    }
    tally
}

#[test]
fn nothing_is_lost_where_nothing_goes_wrong() {
    let calm = Faults { dies: 0.0, down_for: 0, hangs: 0.0, hangs_for: 0, line_dies: 0.0, delay: 3 };
    let tally = runs(0..4, 5, calm);
    assert_eq!((tally.failovers, tally.starved, tally.undisturbed), (0, 0, 20));
}

#[test]
fn replicas_die_and_nothing_is_lost() {
    // One at a time: there is always somebody who goes on.
    let deaths = Faults { dies: 1e-3, down_for: 50, hangs: 0.0, hangs_for: 0, line_dies: 0.0, delay: 2 };
    let tally = runs(0..40, 4, deaths);
    assert!(tally.failovers > 100, "{tally:?}");
    assert!(tally.undisturbed >= 150, "{tally:?}");
}

#[test]
fn whatever_goes_wrong_every_run_ends_in_its_goal() {
    let tally = runs(0..40, 4, ROUGH);
    assert!(tally.failovers > 200 && tally.undisturbed > 50, "{tally:?}");
}

/// In virtual time, while replicas die some three hundred times.
#[test]
#[ignore = "a minute: see the head of this file"]
fn an_hour() {
    let deaths = Faults { dies: 1e-4, down_for: 50, hangs: 0.0, hangs_for: 0, line_dies: 0.0, delay: 2 };
    let tally = run(1, 2, deaths, HOUR);
    println!("2 axes, an hour: {tally:?}");
    assert!(tally.failovers > 300 && tally.undisturbed == 2, "{tally:?}");
}

#[test]
#[ignore = "minutes: see the head of this file"]
fn thousands_of_networks() {
    println!("4 axes, 2000 seeds: {:?}", runs(1000..3000, 4, ROUGH));
    println!("100 axes, 20 seeds: {:?}", runs(0..20, 100, ROUGH));
}
