use crate::audit::{LEAST_GAIN, LEAST_SUBSTEP, MOST_SUBSTEP};
use crate::delay::DelayLine;
use crate::encoder::{Encoder, Measured};
use crate::interpolate::Quintic;
use crate::model::{AxisModel, AxisModelSpec};
use crate::monitor::{Monitor, ReportCard, Sight};
use crate::plant::Plant;
use crate::servo::{Decision, Memory, Servo};
use crate::stability;
use planner::State;

/// How an axis is run and watched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisConfig {
    /// From one setpoint to the next [s].
    pub cycle: f64,
    /// How long the axis is watched after its last setpoint [s], rounded up to whole cycles; 0 to 60.
    pub settle_window: f64,
    /// The load counts as settled within this distance of the goal [axis units], 0 or more.
    pub settle_tolerance: f64,
}

/// An axis cannot be run like this.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum InvalidConfig {
    /// No whole number of substeps makes a cycle.
    #[error(
        "a cycle of {cycle} s is not a whole number of substeps of {substep} s: choose a cycle that is, or a \
         substep of {nearest} s"
    )]
    SubstepDoesNotDivide {
        /// [s]
        cycle: f64,
        /// As given in the model [s].
        substep: f64,
        /// The nearest substep that would do [s].
        nearest: f64,
    },
    /// Too short for a substep, too long for a cycle, or no number.
    #[error("a cycle of {cycle} s is outside {least} s to {most} s: the usual one is 0.001 s")]
    Cycle {
        /// [s]
        cycle: f64,
        /// Least allowed [s].
        least: f64,
        /// Greatest allowed [s].
        most: f64,
    },
    /// Negative, longer than the record may be, or no number.
    #[error("a settle window of {window} s is outside 0 s to {most} s: half a second is usual")]
    SettleWindow {
        /// [s]
        window: f64,
        /// Greatest allowed [s].
        most: f64,
    },
    /// Negative or no number.
    #[error("a settle tolerance of {tolerance} is not 0 or more: give a distance in axis units")]
    SettleTolerance {
        /// [axis units]
        tolerance: f64,
    },
    /// The axis cannot stand there.
    #[error(
        "the axis starts at {position} with {velocity} per second, not finite: start from where it stands"
    )]
    Start {
        /// [axis units]
        position: f64,
        /// [axis units/s]
        velocity: f64,
    },
    /// Loops that grow by themselves.
    #[error(
        "the loops of the servo grow by {growth} per substep of {substep} s, and are stable up to 1: leave velocity_gain \
         and velocity_integral_time at 0, which tunes them, with a position_gain of at most {position_gain}"
    )]
    Unstable {
        /// The largest magnitude of an eigenvalue of the closed loop, per substep [1].
        growth: f64,
        /// [s]
        substep: f64,
        /// One that is stable where the velocity loop is tuned to it [1/s].
        position_gain: f64,
    },
    /// A share of the effort below nothing or above all.
    #[error("an effort scale of {scale} is outside 0 to 1: 1 is the whole effort of the model")]
    EffortScale {
        /// [1]
        scale: f64,
    },
}

/// What one cycle brought [axis units], at its end: the instant of its setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observation {
    /// By the encoder on the motor [axis units].
    pub measured_position: f64,
    /// By the encoder on the motor [axis units/s].
    pub measured_velocity: f64,
    /// Where the load really is [axis units].
    pub load_position: f64,
    /// Setpoint minus measured position [axis units].
    pub following_error: f64,
    /// Over the last substep [N or N m]; on an axis that is not driven, what the load asks of its motor.
    pub effort: f64,
    /// The drive wanted more effort than the limit in some substep of the cycle.
    pub saturated: bool,
    /// The axis has left its setpoints beyond any sense, and stands still in what is said of it since: see
    /// [`Axis::has_diverged`].
    pub diverged: bool,
}

/// One axis: a drive, a plant, and somebody who watches.
///
/// ```
/// # use planner::State;
/// # use sim_axis::{Axis, AxisConfig, AxisModel};
/// let config = AxisConfig { cycle: 1e-3, settle_window: 0.1, settle_tolerance: 1e-5 };
/// let mut axis = Axis::new(&AxisModel::flexible("x"), config, &State::at_rest(0.0))?;
/// for n in 1..=20 {
///     axis.step(&State::at_rest(0.0).after(10.0, f64::from(n) * 1e-3));
/// }
/// axis.begin_settling();
/// while !axis.settle_window_is_over() {
///     axis.rest();
/// }
/// assert!(axis.report().max_following_error < 1e-4);
/// # Ok::<(), sim_axis::InvalidConfig>(())
/// ```
#[derive(Clone, Debug)]
pub struct Axis {
    name: String,
    cycle: f64,
    substep: f64,
    substeps: usize,
    pulses_per_unit: f64,
    plant: Plant,
    encoder: Encoder,
    servo: Servo,
    full_servo: Servo,
    delay: DelayLine,
    memory: Memory,
    monitor: Monitor,
    /// The last setpoint [mechanical units].
    setpoint: State,
    measured: Measured,
    /// Where the first setpoint was, and how far others went from it [mechanical units].
    origin: f64,
    travel: f64,
    has_diverged: bool,
}

impl Axis {
    /// The axis of `model`, which so far has stood at `start` or moved steadily through it [axis units]: cycle 0.
    ///
    /// # Errors
    /// Where the cycle, the settle window, the tolerance or the start cannot be simulated, and where the loops of the servo
    /// are unstable.
    pub fn new(model: &AxisModel, config: AxisConfig, start: &State) -> Result<Self, InvalidConfig> {
        let spec = model.spec();
        let substeps = substeps(config.cycle, spec.servo.substep)?;
        let substep = config.cycle / substeps as f64;
        let settle_cycles = settle_cycles(&config)?;
        if !start.is_finite() {
            return Err(InvalidConfig::Start { position: start.position, velocity: start.velocity });
        }
        let setpoint = in_mechanical_units(start, spec.pulses_per_unit);
        let plant = Plant::new(&spec.mechanics, &setpoint, substep);
        let mut encoder = Encoder::new(spec.encoder.resolution, spec.noise_seed, substep, plant.motor());
        let measured = encoder.read(plant.motor());
        let servo = Servo::new(model, substep);
        check_stability(model, substep)?;
        let delayed = libm::round(spec.servo.command_delay / substep) as usize;
        let tolerance = config.settle_tolerance / spec.pulses_per_unit;
        Ok(Self {
            name: spec.axis.clone(),
            cycle: config.cycle,
            substep,
            substeps,
            pulses_per_unit: spec.pulses_per_unit,
            monitor: Monitor::new(substep, substeps, settle_cycles, tolerance, plant.load().position),
            plant,
            encoder,
            servo,
            full_servo: servo,
            delay: DelayLine::new(delayed, setpoint),
            memory: Memory::default(),
            origin: setpoint.position,
            travel: 0.0,
            has_diverged: false,
            setpoint,
            measured,
        })
    }

    /// One cycle: the axis follows from the last setpoint to this one [axis units], which is due at its end.
    ///
    /// Allocates nothing, waits for nothing. A setpoint that is not finite spoils the axis, not the process:
    /// whoever accepts setpoints refuses those.
    pub fn step(&mut self, setpoint: &State) -> Observation {
        self.advance(in_mechanical_units(setpoint, self.pulses_per_unit))
    }

    /// One cycle at the last setpoint's position.
    pub fn rest(&mut self) -> Observation {
        self.advance(State::at_rest(self.setpoint.position))
    }

    /// The last setpoint was given: its position is the goal, and the settle window begins. Called again, it
    /// begins again. The cycles of the window are stepped like any others, by [`rest`](Self::rest).
    pub fn begin_settling(&mut self) {
        self.monitor.begin_settling(self.setpoint.position, self.plant.load().position);
    }

    /// More setpoints come after the last: the settle window is none.
    pub fn go_on(&mut self) {
        self.monitor.go_on();
    }

    /// The settle window has passed; nothing that happens now changes the report.
    #[must_use]
    pub fn settle_window_is_over(&self) -> bool {
        self.monitor.window_is_over()
    }

    /// Has the axis left its setpoints beyond any sense: by more than a thousand times its travel, or of 1 m or rad if that
    /// is more, or to where there are no numbers? Nothing since then is in the report.
    ///
    /// Stable loops do not: a lag is at most the travel, and what winds up at an effort limit a few times that. It is what is
    /// left to happen where friction, limits and counts make a loop worse than its linear part.
    #[must_use]
    pub fn has_diverged(&self) -> bool {
        self.has_diverged
    }

    /// How the axis has done so far. Fits the residual vibration: takes milliseconds, not for a control cycle.
    #[must_use]
    pub fn report(&self) -> ReportCard {
        self.monitor.report(&self.name, self.pulses_per_unit)
    }

    /// From now on the drive has `scale` of its effort limit, 0 to 1; nothing where effort is unlimited.
    ///
    /// # Errors
    /// Where `scale` is not a share.
    pub fn scale_effort_limit(&mut self, scale: f64) -> Result<(), InvalidConfig> {
        if !(0.0..=1.0).contains(&scale) {
            return Err(InvalidConfig::EffortScale { scale });
        }
        self.servo = self.full_servo.with_effort_scaled(scale);
        Ok(())
    }

    /// The drive's period [s].
    #[must_use]
    pub fn substep_time(&self) -> f64 {
        self.substep
    }

    fn advance(&mut self, next: State) -> Observation {
        let path = Quintic::through(self.setpoint, next, self.cycle);
        self.monitor.head_for(&next);
        self.travel = self.travel.max((next.position - self.origin).abs());
        let mut from = self.setpoint;
        let mut saturated = false;
        let mut effort = 0.0;
        for n in 1..=self.substeps {
            let to = if n == self.substeps { next } else { path.at(n as f64 * self.substep) };
            let seen = self.substep(&from, &to);
            saturated |= seen.saturated;
            effort = seen.effort;
            from = to;
        }
        self.setpoint = next;
        self.observation(effort, saturated)
    }

    fn substep(&mut self, from: &State, to: &State) -> Sight {
        let commanded = self.delay.pass(*from);
        let decision = if self.plant.is_driven() {
            self.servo.decide(self.memory, &commanded, self.measured)
        } else {
            UNDRIVEN
        };
        self.memory = decision.memory;
        self.plant.apply(decision.effort, from, to);
        self.measured = self.encoder.read(self.plant.motor());
        let seen = Sight {
            commanded_position: to.position,
            following_error: to.position - self.measured.position,
            load_position: self.plant.load().position,
            effort: if self.plant.is_driven() { decision.effort } else { -self.plant.spring_effort() },
            saturated: decision.saturated,
        };
        self.has_diverged |= !self.makes_sense(&seen);
        if !self.has_diverged {
            self.monitor.observe(&seen);
        }
        seen
    }

    /// False where there are no numbers.
    fn makes_sense(&self, seen: &Sight) -> bool {
        let most = DIVERGENCE * self.travel.max(LEAST_TRAVEL);
        let load_error = seen.commanded_position - seen.load_position;
        seen.following_error.abs() <= most && load_error.abs() <= most && seen.effort.is_finite()
    }

    fn observation(&self, effort: f64, saturated: bool) -> Observation {
        let Measured { position, velocity } = self.measured;
        Observation {
            measured_position: position * self.pulses_per_unit,
            measured_velocity: velocity * self.pulses_per_unit,
            load_position: self.plant.load().position * self.pulses_per_unit,
            following_error: (self.setpoint.position - position) * self.pulses_per_unit,
            effort,
            saturated,
            diverged: self.has_diverged,
        }
    }
}

fn check_stability(model: &AxisModel, substep: f64) -> Result<(), InvalidConfig> {
    let growth = |model: &AxisModel| {
        let AxisModelSpec { mechanics, encoder, .. } = model.spec();
        stability::growth(mechanics, &Servo::new(model, substep), encoder.resolution > 0.0, substep)
            .filter(|growth| *growth > 1.0 + stability::SLACK)
    };
    let Some(given) = growth(model) else { return Ok(()) };
    // Loops slow enough are stable: the drive then sees a mass, whatever hangs on it.
    let mut position_gain = model.spec().servo.position_gain;
    while position_gain / 2.0 >= LEAST_GAIN && growth(&model.tuned_to(position_gain)).is_some() {
        position_gain /= 2.0;
    }
    Err(InvalidConfig::Unstable { growth: given, substep, position_gain })
}

const UNDRIVEN: Decision =
    Decision { effort: 0.0, saturated: false, memory: Memory { integral: 0.0, effort: 0.0 } };

fn in_mechanical_units(setpoint: &State, pulses_per_unit: f64) -> State {
    State {
        position: setpoint.position / pulses_per_unit,
        velocity: setpoint.velocity / pulses_per_unit,
        acceleration: setpoint.acceleration / pulses_per_unit,
    }
}

/// How many substeps make a cycle: those of the model, or where it leaves that open, as few as are fast enough.
fn substeps(cycle: f64, substep: f64) -> Result<usize, InvalidConfig> {
    if !(LEAST_SUBSTEP..=MOST_CYCLE).contains(&cycle) {
        return Err(InvalidConfig::Cycle { cycle, least: LEAST_SUBSTEP, most: MOST_CYCLE });
    }
    let fewest = libm::ceil(cycle / MOST_SUBSTEP * (1.0 - DIVISION_SLACK)).max(1.0);
    if substep == 0.0 {
        return Ok(fewest as usize);
    }
    let count = libm::round(cycle / substep);
    if (count * substep - cycle).abs() <= DIVISION_SLACK * cycle {
        Ok(count as usize)
    } else {
        Err(InvalidConfig::SubstepDoesNotDivide { cycle, substep, nearest: cycle / count.max(fewest) })
    }
}

fn settle_cycles(config: &AxisConfig) -> Result<usize, InvalidConfig> {
    let AxisConfig { cycle, settle_window: window, settle_tolerance: tolerance } = *config;
    if !(0.0..=MOST_SETTLE_WINDOW).contains(&window) {
        return Err(InvalidConfig::SettleWindow { window, most: MOST_SETTLE_WINDOW });
    }
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(InvalidConfig::SettleTolerance { tolerance });
    }
    Ok(libm::ceil(window / cycle * (1.0 - DIVISION_SLACK)) as usize)
}

/// Beyond so many times its travel no axis that works is away from its setpoint [1].
const DIVERGENCE: f64 = 1000.0;
/// What counts as travel at least [m or rad]: an axis that is to stand still moves a little, too.
const LEAST_TRAVEL: f64 = 1.0;
/// Slack on a ratio of two decimal fractions of a second [1]: their own rounding is 1e-16, nobody means 1e-9.
const DIVISION_SLACK: f64 = 1e-9;
/// Slowest cycle [s]: slower ones are way points, not setpoints.
const MOST_CYCLE: f64 = 1.0;
/// Longest settle window [s]: a million positions at the fastest cycle.
pub(crate) const MOST_SETTLE_WINDOW: f64 = 60.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{LoadSpec, MechanicsSpec, ServoSpec};

    #[test]
    fn unstable_loops_are_refused_and_gentler_ones_named() {
        let config = AxisConfig { cycle: 1e-3, settle_window: 0.1, settle_tolerance: 1e-5 };
        let ideal = AxisModelSpec::ideal("x");
        let spec = |position_gain, velocity_gain| AxisModelSpec {
            mechanics: MechanicsSpec { load: LoadSpec::Rigid { inertia: 10.0 }, ..ideal.mechanics },
            servo: ServoSpec { position_gain, velocity_gain, ..ServoSpec::default() },
            ..ideal.clone()
        };
        let axis = |spec| Axis::new(&AxisModel::try_from(spec).unwrap(), config, &State::default());
        for (position_gain, velocity_gain) in [(1e4, 1e4), (1e4, 0.0), (50.0, 1e6)] {
            let refused = axis(spec(position_gain, velocity_gain)).unwrap_err();
            let InvalidConfig::Unstable { growth, position_gain, .. } = refused else { panic!("{refused}") };
            assert!(growth > 1.0 && position_gain >= 50.0, "{refused}");
            assert!(axis(spec(position_gain, 0.0)).is_ok(), "{refused}");
        }
    }

    #[test]
    fn an_ideal_follower_overshoots_by_nothing() {
        let config = AxisConfig { cycle: 1e-3, settle_window: 0.01, settle_tolerance: 1e-5 };
        for end in [0.314_159, 0.3, 0.000_4] {
            // At rest at 1 after `end` seconds, which is within a cycle.
            let at = |n: i32| {
                let t = (f64::from(n) * 1e-3 - end).min(0.0);
                let start = State { position: 1.0, velocity: 0.0, acceleration: 0.0 };
                start.after(100.0, t)
            };
            let mut axis = Axis::new(&AxisModel::ideal("x"), config, &at(0)).unwrap();
            for n in 1..=320 {
                axis.step(&at(n));
            }
            axis.begin_settling();
            while !axis.settle_window_is_over() {
                axis.rest();
            }
            assert_eq!(axis.report().overshoot.to_bits(), 0);
        }
    }

    #[test]
    fn a_cycle_is_cut_into_substeps_that_divide_it() {
        let rows: [(f64, f64, Result<usize, &str>); 8] = [
            (1e-3, 0.0, Ok(10)),
            (1e-3, 1e-4, Ok(10)),
            (1e-3, 50e-6, Ok(20)),
            (1.0 / 4096.0, 0.0, Ok(3)),
            (50e-6, 0.0, Ok(1)),
            (
                1e-3,
                70e-6,
                Err(
                    "a cycle of 0.001 s is not a whole number of substeps of 0.00007 s: choose a cycle that is, or a substep of 0.00007142857142857143 s",
                ),
            ),
            (1e-5, 0.0, Err("a cycle of 0.00001 s is outside 0.00005 s to 1 s: the usual one is 0.001 s")),
            (f64::NAN, 0.0, Err("a cycle of NaN s is outside 0.00005 s to 1 s: the usual one is 0.001 s")),
        ];
        for (cycle, substep, expected) in rows {
            let found = super::substeps(cycle, substep).map_err(|error| error.to_string());
            assert_eq!(found, expected.map_err(str::to_owned), "{cycle} / {substep}");
        }
    }
}
