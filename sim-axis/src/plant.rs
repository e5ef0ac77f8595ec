use crate::Measured;
use crate::discretise::flow;
use crate::friction::DryFriction;
use crate::model::{LoadSpec, MechanicsSpec};
use nalgebra::{Matrix2, Matrix4, Matrix5, Vector2, Vector4};
use planner::State;

/// Motor, spring and load, moved on by exact steps of one substep.
///
/// ```text
///  effort u ──►┌───────┐       k        ┌──────┐     J_m·ẍ = u − F(ẋ) − b·ẋ + k·d + c·ḋ
///              │ motor │──/\/\/\/──[]───│ load │     J_l·(ẍ + d̈) = −k·d − c·ḋ
///   friction ──┤  J_m  │          c     │  J_l │
///              └───────┘                └──────┘     d: deflection, load minus motor
///                 x                      x + d
/// ```
///
/// The state holds the deflection and not the load's position: wherever the axis stands, the spring then has
/// all its digits, and an axis at rest stays exactly at rest.
#[derive(Clone, Debug)]
pub struct Plant(Kind);

#[derive(Clone, Debug)]
enum Kind {
    Ideal { at: Measured },
    Driven(Driven),
    Prescribed(Prescribed),
}

impl Plant {
    /// The plant at `start` [mechanical units], spring relaxed, for steps of `substep` seconds.
    #[must_use]
    pub fn new(mechanics: &MechanicsSpec, start: &State, substep: f64) -> Self {
        let at = Measured { position: start.position, velocity: start.velocity };
        Self(match mechanics.load {
            LoadSpec::Ideal => Kind::Ideal { at },
            LoadSpec::Rigid { inertia } => Kind::Driven(Driven::new(mechanics, inertia, None, at, substep)),
            LoadSpec::TwoMass { motor_inertia, load_inertia, stiffness, damping } => {
                let spring = Spring { load_inertia, stiffness, damping };
                Kind::Driven(Driven::new(mechanics, motor_inertia, Some(spring), at, substep))
            }
            LoadSpec::Prescribed { load_inertia, stiffness, damping } => {
                let spring = Spring { load_inertia, stiffness, damping };
                Kind::Prescribed(Prescribed::new(spring, at, substep))
            }
        })
    }

    /// Whether an effort moves it: a drive is needed.
    #[must_use]
    pub fn is_driven(&self) -> bool {
        matches!(self.0, Kind::Driven(_))
    }

    /// What a substep makes of motor position and velocity, deflection and its rate, and of a unit of effort that is held,
    /// both without dry friction; `None` where no effort moves the plant.
    pub(crate) fn free_motion(&self) -> Option<(Matrix4<f64>, Vector4<f64>)> {
        match &self.0 {
            Kind::Driven(driven) => Some((driven.coast, driven.push / driven.motor_inertia)),
            Kind::Ideal { .. } | Kind::Prescribed(_) => None,
        }
    }

    /// One substep at a constant `effort` [N or N m]; a motor that is not driven goes `from` one commanded state
    /// `to` the next instead.
    pub fn apply(&mut self, effort: f64, from: &State, to: &State) {
        match &mut self.0 {
            Kind::Ideal { at } => *at = Measured { position: to.position, velocity: to.velocity },
            Kind::Driven(driven) => driven.apply(effort),
            Kind::Prescribed(prescribed) => prescribed.follow(from, to),
        }
    }

    /// Where the motor is.
    #[must_use]
    pub fn motor(&self) -> Measured {
        match &self.0 {
            Kind::Ideal { at } => *at,
            Kind::Driven(driven) => Measured { position: driven.state[0], velocity: driven.state[1] },
            Kind::Prescribed(prescribed) => prescribed.motor,
        }
    }

    /// Where the load is.
    #[must_use]
    pub fn load(&self) -> Measured {
        let motor = self.motor();
        let deflection = match &self.0 {
            Kind::Ideal { .. } => Vector2::zeros(),
            Kind::Driven(driven) => driven.deflection(),
            Kind::Prescribed(prescribed) => prescribed.deflection,
        };
        Measured { position: motor.position + deflection[0], velocity: motor.velocity + deflection[1] }
    }

    /// What the spring pulls the motor with [N or N m]; 0 without one.
    #[must_use]
    pub fn spring_effort(&self) -> f64 {
        match &self.0 {
            Kind::Ideal { .. } => 0.0,
            Kind::Driven(driven) => driven.spring_effort(),
            Kind::Prescribed(prescribed) => prescribed.spring.effort(prescribed.deflection),
        }
    }
}

#[derive(Clone, Copy, Debug)]
struct Spring {
    load_inertia: f64,
    stiffness: f64,
    damping: f64,
}

impl Spring {
    /// On the motor, at a deflection and its rate [N or N m].
    fn effort(&self, deflection: Vector2<f64>) -> f64 {
        self.stiffness * deflection[0] + self.damping * deflection[1]
    }

    /// k/J and c/J of an inertia on this spring [1/s², 1/s].
    fn rates(&self, inertia: f64) -> (f64, f64) {
        (self.stiffness / inertia, self.damping / inertia)
    }
}

/// A motor under effort and friction. A rigid axis is one whose deflection stays 0.
///
/// Over a substep friction is held at one value, chosen so that it cannot push: the one that would bring the
/// motor to rest at the end of the substep, cut to what friction can give. Where it was not cut the motor
/// rests, and then it is locked, with dynamics of its own, until the effort breaks it away. So there is no
/// chatter about zero speed, and no creep. A stop inside a substep is placed at its end: at most `F·h²/(2·J)`
/// too far. Source: the time stepping of Moreau (1988); the locked state of Karnopp (1985).
#[derive(Clone, Debug)]
struct Driven {
    /// Motor position and velocity, deflection and its rate.
    state: Vector4<f64>,
    coast: Matrix4<f64>,
    /// Response to one unit of acceleration of the motor, held.
    push: Vector4<f64>,
    locked: Matrix2<f64>,
    motor_inertia: f64,
    spring: Option<Spring>,
    friction: DryFriction,
}

impl Driven {
    fn new(
        mechanics: &MechanicsSpec,
        inertia: f64,
        spring: Option<Spring>,
        at: Measured,
        substep: f64,
    ) -> Self {
        let (coast, push) = held_push(inertia, mechanics.friction.viscous, spring, substep);
        Self {
            state: Vector4::new(at.position, at.velocity, 0.0, 0.0),
            coast,
            push,
            locked: spring.map_or_else(Matrix2::zeros, |spring| swing(spring, substep)),
            motor_inertia: inertia,
            spring,
            friction: DryFriction::new(&mechanics.friction),
        }
    }

    fn deflection(&self) -> Vector2<f64> {
        Vector2::new(self.state[2], self.state[3])
    }

    fn spring_effort(&self) -> f64 {
        self.spring.map_or(0.0, |spring| spring.effort(self.deflection()))
    }

    fn apply(&mut self, effort: f64) {
        if self.state[1] == 0.0 && self.friction.holds(effort + self.spring_effort()) {
            self.stay();
        } else {
            self.slide(effort);
        }
    }

    fn stay(&mut self) {
        let deflection = self.locked * self.deflection();
        self.state[2] = deflection[0];
        self.state[3] = deflection[1];
    }

    fn slide(&mut self, effort: f64) {
        let unopposed = self.coast * self.state + self.push * (effort / self.motor_inertia);
        let most = self.friction.level(self.state[1]) / self.motor_inertia;
        let to_rest = unopposed[1] / self.push[1];
        self.state = unopposed - self.push * to_rest.max(-most).min(most);
        if to_rest.abs() <= most {
            self.state[1] = 0.0;
        }
    }
}

/// Exact zero-order hold of the driven plant: what a substep makes of the state, and of a unit of acceleration.
fn held_push(
    inertia: f64,
    viscous: f64,
    spring: Option<Spring>,
    substep: f64,
) -> (Matrix4<f64>, Vector4<f64>) {
    let drag = viscous / inertia;
    let (k, c, k_load, c_load) = spring.map_or((0.0, 0.0, 0.0, 0.0), |spring| {
        let (k, c) = spring.rates(inertia);
        let (k_load, c_load) = spring.rates(spring.load_inertia);
        (k, c, k_load, c_load)
    });
    #[rustfmt::skip]
    let rates = Matrix5::new(
        0.0,   1.0,            0.0,            0.0,  0.0,
        0.0, -drag,              k,              c,  1.0,
        0.0,   0.0,            0.0,            1.0,  0.0,
        0.0,  drag, -(k + k_load), -(c + c_load), -1.0,
        0.0,   0.0,            0.0,            0.0,  0.0,
    );
    // Without a spring nothing is there to lag: the deflection is left out of the dynamics.
    let rates = if spring.is_some() { rates } else { without_deflection(rates) };
    let mut flow = flow(rates, [0, 1, 0, 1, 2], substep);
    // Nothing depends on where the axis is; a rounding here would let it creep.
    flow.set_column(0, &nalgebra::Vector5::x());
    (flow.fixed_view::<4, 4>(0, 0).into_owned(), flow.fixed_view::<4, 1>(0, 4).into_owned())
}

fn without_deflection(mut rates: Matrix5<f64>) -> Matrix5<f64> {
    rates.row_mut(2).fill(0.0);
    rates.row_mut(3).fill(0.0);
    rates
}

/// The load on its spring while the motor stands.
fn swing(spring: Spring, substep: f64) -> Matrix2<f64> {
    let (k, c) = spring.rates(spring.load_inertia);
    flow(Matrix2::new(0.0, 1.0, -k, -c), [0, 1], substep)
}

/// A load behind a motor that is where it was told to be.
///
/// ```text
/// d̈ + 2ζω·ḋ + ω²·d = −a(t)        a: the motor's acceleration, a straight line over each substep
/// ```
///
/// A first-order hold of the acceleration, exact while the commanded jerk is constant over the substep. After
/// a motion from rest to rest an undamped load therefore swings with the amplitude
/// `|∫ a(t)·exp(−iωt) dt| / ω`: `d(t) = −(1/ω)·∫ a(τ)·sin(ω(t − τ)) dτ` is the imaginary part of
/// `−exp(iωt)/ω · ∫ a(τ)·exp(−iωτ) dτ`, and the integral no longer grows once `a` is 0.
#[derive(Clone, Debug)]
struct Prescribed {
    motor: Measured,
    deflection: Vector2<f64>,
    swing: Matrix2<f64>,
    held: Vector2<f64>,
    ramped: Vector2<f64>,
    spring: Spring,
}

impl Prescribed {
    fn new(spring: Spring, motor: Measured, substep: f64) -> Self {
        let (k, c) = spring.rates(spring.load_inertia);
        #[rustfmt::skip]
        let rates = Matrix4::new(
            0.0, 1.0,  0.0, 0.0,
             -k,  -c, -1.0, 0.0,
            0.0, 0.0,  0.0, 1.0 / substep,
            0.0, 0.0,  0.0, 0.0,
        );
        let flow = flow(rates, [0, 1, 2, 2], substep);
        Self {
            motor,
            deflection: Vector2::zeros(),
            swing: flow.fixed_view::<2, 2>(0, 0).into_owned(),
            held: flow.fixed_view::<2, 1>(0, 2).into_owned(),
            ramped: flow.fixed_view::<2, 1>(0, 3).into_owned(),
            spring,
        }
    }

    fn follow(&mut self, from: &State, to: &State) {
        let gained = to.acceleration - from.acceleration;
        self.deflection = self.swing * self.deflection + self.held * from.acceleration + self.ramped * gained;
        self.motor = Measured { position: to.position, velocity: to.velocity };
    }
}
