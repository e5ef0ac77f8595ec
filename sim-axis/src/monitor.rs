use crate::vibration;
use planner::State;

/// How well an axis followed, and how it came to rest [axis units].
#[derive(Clone, Debug, PartialEq)]
pub struct ReportCard {
    /// Name of the axis in the plan.
    pub axis: String,
    /// Largest |commanded − measured| in the motion, over its substeps [axis units].
    pub max_following_error: f64,
    /// When it first was that large [s since cycle 0].
    pub max_following_error_time: f64,
    /// Root mean square of commanded − measured over the substeps of the motion [axis units].
    pub rms_following_error: f64,
    /// Largest excursion of the load past the goal, in the direction of travel, since the commanded motion last
    /// turned round, and past what the commanded motion itself reaches beyond it between two setpoints [axis units]; 0
    /// while no goal is known.
    pub overshoot: f64,
    /// From the last setpoint until the load is within the tolerance of the goal for good [s], to a substep;
    /// `None`: not within the window.
    pub settling_time: Option<f64>,
    /// Half peak-to-peak of the load in the settle window [axis units]. Taken at the substeps: low by at most
    /// the share (π·frequency·substep)²/2 of a vibration.
    pub residual_vibration_amplitude: f64,
    /// Of the load in the settle window [Hz]: a damped sine fitted to its acceleration, good to 1e-6 for one
    /// undisturbed vibration, to about 1e-2 above a settling motion; `None`: no vibration stands out.
    pub residual_vibration_frequency: Option<f64>,
    /// Largest effort of the motor [N or N m].
    pub max_effort: f64,
    /// Time in which the drive wanted more effort than the limit [s].
    pub effort_saturated_time: f64,
}

/// What is seen of an axis at the end of one substep [mechanical units].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sight {
    /// Where the axis should be: between two setpoints, on the way that the drive fills in.
    pub(crate) commanded_position: f64,
    pub(crate) following_error: f64,
    pub(crate) load_position: f64,
    /// Over the substep that ends here [N or N m].
    pub(crate) effort: f64,
    pub(crate) saturated: bool,
}

/// Watches one axis, in mechanical units. A motion costs constant memory however long it is; the settle window
/// fills a record that is there from the beginning.
#[derive(Clone, Debug)]
pub(crate) struct Monitor {
    substep: f64,
    substeps_per_cycle: usize,
    settle_tolerance: f64,
    phase: Phase,
    substeps: u64,
    following: Following,
    travel: Travel,
    max_effort: f64,
    saturated_substeps: u64,
    settle_cycles: usize,
    /// Load positions by cycle in the settle window, both ends included.
    record: Vec<f64>,
}

/// ```text
///  MOVING ── the last setpoint was given ──► SETTLING ── the window has passed ──► (observes no more)
/// ```
#[derive(Clone, Copy, Debug)]
enum Phase {
    Moving,
    Settling(Settling),
}

impl Monitor {
    pub(crate) fn new(
        substep: f64,
        substeps_per_cycle: usize,
        settle_cycles: usize,
        settle_tolerance: f64,
        load_position: f64,
    ) -> Self {
        Self {
            substep,
            substeps_per_cycle,
            settle_tolerance,
            phase: Phase::Moving,
            substeps: 0,
            following: Following::default(),
            travel: Travel::new(load_position),
            max_effort: 0.0,
            saturated_substeps: 0,
            settle_cycles,
            record: Vec::with_capacity(settle_cycles + 1),
        }
    }

    /// A new setpoint is about to be followed.
    pub(crate) fn head_for(&mut self, setpoint: &State) {
        self.travel.head_for(setpoint.velocity);
    }

    pub(crate) fn observe(&mut self, seen: &Sight) {
        if self.window_is_over() {
            return;
        }
        self.substeps += 1;
        self.travel.observe(seen);
        self.max_effort = self.max_effort.max(seen.effort.abs());
        self.saturated_substeps += u64::from(seen.saturated);
        match &mut self.phase {
            Phase::Moving => self.following.observe(seen.following_error, self.substeps),
            Phase::Settling(settling) => {
                settling.observe(seen.load_position, self.settle_tolerance);
                if settling.substeps % self.substeps_per_cycle as u64 == 0 {
                    self.record.push(seen.load_position);
                }
            }
        }
    }

    /// The last setpoint was given, and the load is at `load_position`.
    pub(crate) fn begin_settling(&mut self, goal: f64, load_position: f64) {
        let mut settling = Settling::new(goal, load_position);
        settling.judge(load_position, self.settle_tolerance);
        self.phase = Phase::Settling(settling);
        self.record.clear();
        // Room was made at the beginning; a clone, which has none, makes its own here.
        self.record.reserve(self.settle_cycles + 1);
        self.record.push(load_position);
    }

    /// The axis moves again.
    pub(crate) fn go_on(&mut self) {
        self.phase = Phase::Moving;
    }

    pub(crate) fn window_is_over(&self) -> bool {
        matches!(self.phase, Phase::Settling(_)) && self.record.len() > self.settle_cycles
    }

    /// The card so far, with lengths times `scale`.
    pub(crate) fn report(&self, axis: &str, scale: f64) -> ReportCard {
        let (overshoot, settled_after, half_swing) = match &self.phase {
            Phase::Moving => (0.0, None, 0.0),
            Phase::Settling(settling) => {
                (self.travel.past(settling.goal), settling.settled_after(), settling.half_swing())
            }
        };
        let cycle = self.substep * self.substeps_per_cycle as f64;
        ReportCard {
            axis: axis.to_owned(),
            max_following_error: self.following.largest * scale,
            max_following_error_time: self.following.largest_at as f64 * self.substep,
            rms_following_error: self.following.rms() * scale,
            overshoot: overshoot * scale,
            settling_time: settled_after.map(|substeps| substeps as f64 * self.substep),
            residual_vibration_amplitude: half_swing * scale,
            residual_vibration_frequency: vibration::frequency(&self.record, cycle),
            max_effort: self.max_effort,
            effort_saturated_time: self.saturated_substeps as f64 * self.substep,
        }
    }
}

#[derive(Clone, Copy, Debug, Default)]
struct Following {
    largest: f64,
    largest_at: u64,
    squares: f64,
    substeps: u64,
}

impl Following {
    fn observe(&mut self, error: f64, substep: u64) {
        if error.abs() > self.largest {
            self.largest = error.abs();
            self.largest_at = substep;
        }
        self.squares += error * error;
        self.substeps += 1;
    }

    fn rms(&self) -> f64 {
        if self.substeps == 0 { 0.0 } else { libm::sqrt(self.squares / self.substeps as f64) }
    }
}

/// How far the load got since the commanded motion last turned round: what lies past the goal is only known
/// once the goal is, and by then the load may have been there already.
#[derive(Clone, Copy, Debug)]
struct Travel {
    /// 1 or −1; 0 before the first motion.
    direction: f64,
    top_speed: f64,
    /// Furthest load position, counted in the direction.
    furthest: f64,
    /// Furthest commanded position, counted in the direction.
    furthest_commanded: f64,
    load_position: f64,
}

impl Travel {
    fn new(load_position: f64) -> Self {
        Self {
            direction: 0.0,
            top_speed: 0.0,
            furthest: 0.0,
            furthest_commanded: f64::NEG_INFINITY,
            load_position,
        }
    }

    fn head_for(&mut self, velocity: f64) {
        self.top_speed = self.top_speed.max(velocity.abs());
        let goes_on = velocity * self.direction > 0.0;
        if velocity.abs() > TURNING * self.top_speed && !goes_on {
            self.direction = velocity.signum();
            self.furthest = self.direction * self.load_position;
            self.furthest_commanded = f64::NEG_INFINITY;
        }
    }

    fn observe(&mut self, seen: &Sight) {
        self.load_position = seen.load_position;
        self.furthest = self.furthest.max(self.direction * seen.load_position);
        self.furthest_commanded = self.furthest_commanded.max(self.direction * seen.commanded_position);
    }

    /// A motion ends within a cycle, and what a drive fills in between its last two setpoints passes the goal by a share of
    /// `J·T³` (6e-11 m for 100 m/s³ at 1 ms): so far the load only follows.
    fn past(&self, goal: f64) -> f64 {
        (self.furthest - self.furthest_commanded.max(self.direction * goal)).max(0.0)
    }
}

/// Share of the top speed above which a commanded velocity says where the axis goes [1]: a profile ends at
/// rest up to its last bits, and those have any sign.
const TURNING: f64 = 1e-6;

#[derive(Clone, Copy, Debug)]
struct Settling {
    goal: f64,
    lowest: f64,
    highest: f64,
    substeps: u64,
    /// Last substep of the window with the load out of tolerance.
    last_outside: Option<u64>,
}

impl Settling {
    fn new(goal: f64, load_position: f64) -> Self {
        Self { goal, lowest: load_position, highest: load_position, substeps: 0, last_outside: None }
    }

    fn observe(&mut self, load_position: f64, tolerance: f64) {
        self.substeps += 1;
        self.lowest = self.lowest.min(load_position);
        self.highest = self.highest.max(load_position);
        self.judge(load_position, tolerance);
    }

    fn judge(&mut self, load_position: f64, tolerance: f64) {
        let is_inside = (load_position - self.goal).abs() <= tolerance;
        if !is_inside {
            self.last_outside = Some(self.substeps);
        }
    }

    fn settled_after(&self) -> Option<u64> {
        let settled_after = self.last_outside.map_or(0, |last| last + 1);
        (settled_after <= self.substeps).then_some(settled_after)
    }

    fn half_swing(&self) -> f64 {
        0.5 * (self.highest - self.lowest)
    }
}
