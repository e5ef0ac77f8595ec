use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// What a plant is made of, and what its work costs.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    /// Axes, a stream each.
    pub axes: usize,
    /// Servers, each with as many cores.
    pub replicas: usize,
    /// Cores of a server.
    pub cores: usize,
    /// Axes of a gateway, which report and ask together.
    pub gateway: usize,
    /// How far ahead an axis holds its setpoints \[s\].
    pub lead: f64,
    /// From one report of an axis to its next \[s\].
    pub batch: f64,
    /// From one end of the network to the other \[s\].
    pub trip: f64,
    /// Who goes on with the streams of a server that died.
    pub heirs: Heirs,
    /// CPU time of each kind of work.
    pub costs: Costs,
    /// Planning calls of all cells \[1/s\].
    pub plans: f64,
}

/// CPU time \[s\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Costs {
    /// Of a server, for a report and the batch that answers it.
    pub batch: f64,
    /// Of a server, to go on with a stream.
    pub take_over: f64,
    /// Of a gateway, one stream after the other: half of it until all are asked for, half of it with each answer.
    pub ask: f64,
    /// Of a server, for a call of `Plan`.
    pub plan: f64,
}

/// Who goes on with the streams of a server that died.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heirs {
    /// The next in a list that all axes have in the same order: one for all.
    Next,
    /// Whoever comes next in a list that each axis has in an order of its own.
    Any,
    /// Whoever has the fewest streams when a stream asks, as a balancer chooses: one for all, where it has just been started again.
    Fewest,
}

/// What came of a failure.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// Streams that changed their server.
    pub moved: usize,
    /// From the death to the stream being open elsewhere, for each of them in ascending order \[s\].
    pub waits: Vec<f64>,
    /// Axes, moved or not, for which a cycle was due and not held.
    pub underruns: usize,
    /// The least that an axis had still in hand when its setpoints came \[s\]; below zero they came too late.
    pub least_left: f64,
    /// CPU time of all streams and calls in a second before, in cores.
    pub busy: f64,
    /// Streams of whoever has the most, afterwards.
    pub most_streams: usize,
}

impl Outcome {
    /// Of those who waited, the longest that a share of them did not exceed \[s\]; 0 where nobody did.
    #[must_use]
    pub fn wait(&self, share: f64) -> f64 {
        let last = self.waits.len().saturating_sub(1);
        self.waits.get((last as f64 * share) as usize).copied().unwrap_or_default()
    }
}

/// Who serves whom, from one failure to the next.
#[derive(Clone, Debug)]
pub struct Fleet {
    plant: Plant,
    /// The server of each axis.
    homes: Vec<usize>,
    /// Of each server.
    streams: Vec<usize>,
    random: fastrand::Rng,
}

impl Fleet {
    /// As after a start: as many streams at each server, and the axes of a gateway at different ones.
    #[must_use]
    pub fn new(plant: Plant, seed: u64) -> Self {
        let homes = (0..plant.axes).map(|axis| axis % plant.replicas).collect();
        Self::with(plant, homes, seed)
    }

    /// With the server of each axis.
    #[must_use]
    pub fn with(plant: Plant, homes: Vec<usize>, seed: u64) -> Self {
        let mut streams = vec![0; plant.replicas];
        homes.iter().for_each(|&home| streams[home] += 1);
        Self { plant, homes, streams, random: fastrand::Rng::with_seed(seed) }
    }

    /// How many streams each server has.
    #[must_use]
    pub fn streams(&self) -> &[usize] {
        &self.streams
    }

    /// Servers that die at the same moment; with those that are down already they get no stream. All of `dead` are started again
    /// afterwards, with none.
    ///
    /// # Panics
    /// Where all are dead.
    pub fn fail(&mut self, dead: &[usize], down: &[usize]) -> Outcome {
        let is_up = |server: usize| !dead.contains(&server) && !down.contains(&server);
        let up: Vec<usize> = (0..self.plant.replicas).filter(|&server| is_up(server)).collect();
        assert!(!up.is_empty(), "somebody has to go on");
        let mut failure = Failure::begin(self, dead);
        failure.happen(self, &up);
        failure.outcome(self)
    }

    /// Which of those who are up goes on with a stream of `dead`.
    fn heir(&mut self, dead: usize, up: &[usize]) -> usize {
        match self.plant.heirs {
            Heirs::Next => up.iter().copied().find(|&server| server > dead).unwrap_or(up[0]),
            Heirs::Any => up[self.random.usize(..up.len())],
            Heirs::Fewest => up.iter().copied().min_by_key(|&server| self.streams[server]).unwrap_or(up[0]),
        }
    }
}

/// When something happens \[s\], 0 being the death. Times are finite, so their order is total.
#[derive(Clone, Copy, Debug, PartialEq)]
struct At(f64);

impl Eq for At {}

impl PartialOrd for At {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for At {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Event {
    /// All axes of a gateway report.
    Beat(usize),
    /// A planning call comes to a server.
    Call(usize),
    /// A stream asks its heir.
    Ask(usize),
}

/// A server's cores: work is done in the order in which it comes, by whichever core is free first.
#[derive(Clone, Debug)]
struct Cores(Vec<f64>);

impl Cores {
    /// When work that comes at `now` is done.
    fn work(&mut self, now: f64, cost: f64) -> f64 {
        let Some(free) = self.0.iter_mut().min_by(|a, b| a.total_cmp(b)) else { return f64::INFINITY };
        *free = free.max(now) + cost;
        *free
    }
}

/// A moment before and a while after servers die.
struct Failure {
    events: BinaryHeap<Reverse<(At, Event)>>,
    servers: Vec<Cores>,
    /// Of one core each.
    gateways: Vec<Cores>,
    dead: Vec<usize>,
    /// From when on a stream is served; −∞: all the time, ∞: not yet.
    served_from: Vec<f64>,
    /// When each gateway reported last before the death.
    last_beat: Vec<f64>,
    /// CPU time of what came in the whole periods before the death.
    before: f64,
    waits: Vec<f64>,
    least_left: f64,
    is_starved: Vec<bool>,
}

/// Whole periods that are looked at before the death, in which queues become what they are.
const PERIODS_BEFORE: f64 = 2.0;

impl Failure {
    fn begin(fleet: &mut Fleet, dead: &[usize]) -> Self {
        let Plant { axes, replicas, cores, gateway, batch, plans, .. } = fleet.plant;
        let mut events = BinaryHeap::new();
        let mut last_beat = Vec::new();
        let idle = |cores| Cores(vec![f64::NEG_INFINITY; cores]);
        for number in 0..axes.div_ceil(gateway) {
            let phase = fleet.random.f64() * batch;
            last_beat.push(phase - batch);
            events.push(Reverse((At(phase - PERIODS_BEFORE * batch), Event::Beat(number))));
        }
        if plans > 0.0 {
            for server in 0..replicas {
                let first = -PERIODS_BEFORE * batch + apart(&mut fleet.random, plans / replicas as f64);
                events.push(Reverse((At(first), Event::Call(server))));
            }
        }
        Self {
            events,
            servers: vec![idle(cores); replicas],
            gateways: vec![idle(1); last_beat.len()],
            dead: dead.to_vec(),
            served_from: vec![f64::NEG_INFINITY; axes],
            last_beat,
            before: 0.0,
            waits: Vec::new(),
            least_left: f64::INFINITY,
            is_starved: vec![false; axes],
        }
    }

    /// Everything until one lead after the last stream has moved.
    fn happen(&mut self, fleet: &mut Fleet, up: &[usize]) {
        let Plant { gateway, batch, lead, trip, plans, replicas, costs, .. } = fleet.plant;
        self.ask(fleet);
        let (mut asking, mut end) = (self.waiting(), lead);
        while let Some(Reverse((At(now), event))) = self.events.pop() {
            if asking == 0 && now > end {
                break;
            }
            match event {
                Event::Beat(number) => {
                    let streams = number * gateway..((number + 1) * gateway).min(fleet.homes.len());
                    for axis in streams {
                        self.report(fleet, axis, now);
                    }
                    self.events.push(Reverse((At(now + batch), event)));
                }
                Event::Call(server) => {
                    let to = if now >= 0.0 && !up.contains(&server) {
                        fleet.random.choice(up)
                    } else {
                        Some(&server)
                    };
                    if let Some(&server) = to {
                        self.servers[server].work(now, costs.plan);
                        self.before += if now < 0.0 { costs.plan } else { 0.0 };
                    }
                    let next = now + apart(&mut fleet.random, plans / replicas as f64);
                    self.events.push(Reverse((At(next), event)));
                }
                Event::Ask(axis) => {
                    let heir = fleet.heir(fleet.homes[axis], up);
                    fleet.streams[fleet.homes[axis]] -= 1;
                    fleet.streams[heir] += 1;
                    fleet.homes[axis] = heir;
                    let answered = self.servers[heir].work(now, costs.take_over) + trip;
                    let open = self.gateways[axis / gateway].work(answered, 0.5 * costs.ask);
                    self.served_from[axis] = open;
                    self.waits.push(open);
                    // What it holds is what was sent for its last report, and that is on its way no more.
                    let held = lead - (0.0 - self.last_beat[axis / gateway]) - 2.0 * trip;
                    self.arrive(axis, held - open);
                    (asking, end) = (asking - 1, end.max(open + lead));
                }
            }
        }
    }

    /// Every stream of a dead server asks; a gateway asks for all of its own before it hears the first answer.
    fn ask(&mut self, fleet: &Fleet) {
        let Plant { gateway, trip, costs, .. } = fleet.plant;
        let moves = |axis: usize| self.dead.contains(&fleet.homes[axis]);
        for (number, first) in (0..fleet.homes.len()).step_by(gateway).enumerate() {
            let moving: Vec<usize> =
                (first..(first + gateway).min(fleet.homes.len())).filter(|axis| moves(*axis)).collect();
            // That a server is gone is seen a trip later, and the question takes another.
            let asked = self.gateways[number].work(trip, 0.5 * costs.ask * moving.len() as f64) + trip;
            for axis in moving {
                self.served_from[axis] = f64::INFINITY;
                self.events.push(Reverse((At(asked), Event::Ask(axis))));
            }
        }
    }

    fn waiting(&self) -> usize {
        self.served_from.iter().filter(|from| from.is_infinite() && from.is_sign_positive()).count()
    }

    /// An axis reports, and is sent what it has played.
    fn report(&mut self, fleet: &Fleet, axis: usize, now: f64) {
        let Plant { lead, batch, trip, costs, .. } = fleet.plant;
        // Before the death everybody is served by whoever had the stream then.
        if now >= 0.0 && now < self.served_from[axis] {
            return;
        }
        let done = self.servers[fleet.homes[axis]].work(now, costs.batch);
        if now < 0.0 {
            self.before += costs.batch;
        } else {
            self.arrive(axis, lead - batch - (done - now) - 2.0 * trip);
        }
    }

    /// Setpoints come to an axis that had so much left in hand.
    fn arrive(&mut self, axis: usize, left: f64) {
        self.least_left = self.least_left.min(left);
        self.is_starved[axis] |= left < 0.0;
    }

    fn outcome(mut self, fleet: &Fleet) -> Outcome {
        self.waits.sort_unstable_by(f64::total_cmp);
        Outcome {
            moved: self.waits.len(),
            waits: self.waits,
            underruns: self.is_starved.iter().filter(|starved| **starved).count(),
            least_left: self.least_left,
            busy: self.before / (PERIODS_BEFORE * fleet.plant.batch),
            most_streams: fleet.streams.iter().copied().max().unwrap_or_default(),
        }
    }
}

/// From one call to the next, where calls come at a rate and know nothing of each other \[s\].
fn apart(random: &mut fastrand::Rng, rate: f64) -> f64 {
    // 1 − u is never 0.
    -(1.0 - random.f64()).ln() / rate
}

/// How servers die: each by itself, at any time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mortality {
    /// From a start to a death, on the mean \[h\].
    pub between_deaths: f64,
    /// From a death until it serves again \[h\].
    pub restart: f64,
    /// How long it is looked at \[h\].
    pub horizon: f64,
}

/// What a plant went through.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Life {
    /// Servers that died.
    pub deaths: usize,
    /// Those that died while another was down.
    pub overlapping: usize,
    /// Times that the last one died: every axis came to rest.
    pub outages: usize,
    /// Axes that missed a cycle, all failures together, without those of outages.
    pub underruns: usize,
    /// The longest that a stream was without a server \[s\].
    pub worst_wait: f64,
    /// The least that an axis had in hand \[s\].
    pub least_left: f64,
    /// The most streams that a server had.
    pub most_streams: usize,
}

/// One failure after the other, each beginning with the streams where the one before has left them: they do not go back by themselves.
#[must_use]
pub fn live(plant: &Plant, mortality: Mortality, seed: u64) -> Life {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut fleet = Fleet::new(plant.clone(), seed);
    let mut life = Life { least_left: f64::INFINITY, ..Life::default() };
    let mut up_again = vec![f64::NEG_INFINITY; plant.replicas];
    let mut now = 0.0;
    loop {
        now += apart(&mut random, plant.replicas as f64 / mortality.between_deaths);
        if now > mortality.horizon {
            return life;
        }
        let dead = random.usize(..plant.replicas);
        if up_again[dead] > now {
            continue;
        }
        let down: Vec<usize> = (0..plant.replicas).filter(|&server| up_again[server] > now).collect();
        up_again[dead] = now + mortality.restart;
        life.deaths += 1;
        life.overlapping += usize::from(!down.is_empty());
        if down.len() + 1 == plant.replicas {
            life.outages += 1;
            continue;
        }
        let outcome = fleet.fail(&[dead], &down);
        life.underruns += outcome.underruns;
        life.worst_wait = life.worst_wait.max(outcome.wait(1.0));
        life.least_left = life.least_left.min(outcome.least_left);
        life.most_streams = life.most_streams.max(outcome.most_streams);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn quiet() -> Plant {
        Plant {
            axes: 12,
            replicas: 3,
            cores: 1,
            gateway: 4,
            lead: 0.1,
            batch: 0.02,
            trip: 0.0,
            heirs: Heirs::Next,
            costs: Costs { batch: 0.0, take_over: 0.001, ask: 0.0, plan: 0.0 },
            plans: 0.0,
        }
    }

    /// Any plant that is not overloaded before somebody dies.
    fn any_plant() -> impl Strategy<Value = Plant> {
        let costs = (1e-6..3e-5, 1e-5..5e-4);
        let sizes = (1_usize..400, 2_usize..8, 1_usize..4, 1_usize..60);
        let heirs = prop_oneof![Just(Heirs::Next), Just(Heirs::Any), Just(Heirs::Fewest)];
        (sizes, costs, heirs).prop_map(|((axes, replicas, cores, gateway), (batch, take_over), heirs)| {
            Plant {
                axes,
                replicas,
                cores,
                gateway,
                heirs,
                costs: Costs { batch, take_over, ..quiet().costs },
                ..quiet()
            }
        })
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-9 * a.abs().max(b.abs())
    }

    #[test]
    fn streams_wait_for_one_another_and_for_nothing_else() {
        let outcome = Fleet::new(quiet(), 1).fail(&[0], &[]);
        assert_eq!((outcome.moved, outcome.underruns, outcome.most_streams), (4, 0, 8));
        for (number, wait) in outcome.waits.iter().enumerate() {
            assert!(close(*wait, 0.001 * (number + 1) as f64), "{wait}");
        }
        // A quarter of the work for each of as many cores.
        let four = Fleet::new(Plant { cores: 4, ..quiet() }, 1).fail(&[0], &[]);
        assert!(close(four.wait(1.0), 0.001), "{four:?}");
        // Two find half of it each.
        let two = Fleet::new(Plant { heirs: Heirs::Fewest, ..quiet() }, 1).fail(&[0], &[]);
        assert!(close(two.wait(1.0), 0.002) && two.most_streams == 6, "{two:?}");
    }

    #[test]
    fn a_gateway_asks_for_one_stream_after_the_other_over_its_network() {
        let costs = Costs { ask: 0.01, take_over: 0.001, ..quiet().costs };
        let plant = Plant { axes: 6, replicas: 2, gateway: 6, trip: 0.002, costs, ..quiet() };
        let outcome = Fleet::new(plant, 1).fail(&[0], &[]);
        // Asked after 2 + 3 × 5 + 2 ms, answered by a server that takes 1 ms for each, and read in 5 ms each.
        let expected = [0.027, 0.032, 0.037];
        assert!(
            outcome.waits.iter().zip(expected).all(|(wait, expected)| close(*wait, expected)),
            "{outcome:?}"
        );
    }

    #[test]
    fn what_takes_longer_than_the_lead_is_an_underrun() {
        let costs = Costs { take_over: 0.03, ..quiet().costs };
        let outcome = Fleet::new(Plant { costs, ..quiet() }, 1).fail(&[0], &[]);
        // 80 to 100 ms in hand: the fourth waits for 120 ms, the third for 90, and the four whose server takes them over wait behind all of
        // them for what they have reported within 20 ms.
        assert!((5..=6).contains(&outcome.underruns) && outcome.least_left < 0.0, "{outcome:?}");
    }

    #[test]
    fn who_was_started_again_gets_all_streams_of_the_next_from_a_balancer() {
        let mut fleet = Fleet::new(Plant { axes: 300, heirs: Heirs::Fewest, ..quiet() }, 1);
        fleet.fail(&[0], &[]);
        assert_eq!(fleet.streams(), [0, 150, 150]);
        fleet.fail(&[1], &[]);
        assert_eq!(fleet.streams(), [150, 0, 150]);
    }

    #[test]
    fn the_last_that_dies_is_an_outage() {
        let mortality = Mortality { between_deaths: 1.0, restart: 1e6, horizon: 1e3 };
        let life = live(&quiet(), mortality, 7);
        assert_eq!((life.deaths, life.overlapping, life.outages), (3, 2, 1));
    }

    proptest! {
        #[test]
        fn no_stream_is_lost_and_none_doubled(plant in any_plant(), seed: u64) {
            let mut fleet = Fleet::new(plant.clone(), seed);
            let of_dead = fleet.streams()[0];
            let outcome = fleet.fail(&[0], &[]);
            prop_assert_eq!(outcome.moved, of_dead);
            prop_assert_eq!(fleet.streams().iter().sum::<usize>(), plant.axes);
            prop_assert_eq!(fleet.streams()[0], 0);
        }

        #[test]
        fn work_is_conserved(plant in any_plant(), seed: u64) {
            let outcome = Fleet::new(plant.clone(), seed).fail(&[0], &[]);
            let expected = plant.axes as f64 * plant.costs.batch / plant.batch;
            prop_assert!(close(outcome.busy, expected), "{} and {expected}", outcome.busy);
        }

        #[test]
        fn the_same_seed_gives_the_same(plant in any_plant(), seed: u64) {
            let plant = Plant { plans: 500.0, costs: Costs { plan: 4e-5, ..plant.costs }, ..plant };
            let again = Fleet::new(plant.clone(), seed).fail(&[0], &[]);
            prop_assert_eq!(Fleet::new(plant, seed).fail(&[0], &[]), again);
        }

        // A server of twice as many has a subset of the streams, and so of what waits before anybody else.
        #[test]
        fn twice_as_many_servers_never_worsen_the_worst_wait(plant in any_plant(), seed: u64) {
            let few = Plant { heirs: Heirs::Next, ..plant };
            let many = Plant { replicas: 2 * few.replicas, ..few.clone() };
            let [few, many] = [few, many].map(|plant| Fleet::new(plant, seed).fail(&[0], &[]).wait(1.0));
            prop_assert!(many <= few * (1.0 + 1e-9), "{many} and {few}");
        }

        #[test]
        fn more_cores_never_worsen_the_worst_wait(plant in any_plant(), seed: u64) {
            let one = Plant { heirs: Heirs::Next, ..plant };
            let more = Plant { cores: one.cores + 1, ..one.clone() };
            let [one, more] = [one, more].map(|plant| Fleet::new(plant, seed).fail(&[0], &[]).wait(1.0));
            prop_assert!(more <= one * (1.0 + 1e-9), "{more} and {one}");
        }
    }
}
