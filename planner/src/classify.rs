/// The eight shapes of Bui, Le and Doan (2021), 8 in its two variants, and the single ramp that ends at the nearest
/// reachable velocity.
///
/// ```text
///  cruise at the feed rate           peak below the feed rate
///  1  accelerate: a reached,  decelerate: a reached        5
///  2  accelerate: a reached,  decelerate: not              6
///  3  accelerate: not,        decelerate: a reached        7
///  4  accelerate: not,        decelerate: not              8A
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EightType {
    /// Cruise, acceleration limit reached on both sides.
    Type1,
    /// Cruise, reached while accelerating only.
    Type2,
    /// Cruise, reached while decelerating only.
    Type3,
    /// Cruise, reached on neither side.
    Type4,
    /// No cruise, acceleration limit reached on both sides.
    Type5,
    /// No cruise, reached while accelerating only.
    Type6,
    /// No cruise, reached while decelerating only.
    Type7,
    /// No cruise, reached on neither side, end velocity kept.
    Type8A,
    /// Path too short, the end velocity became the start velocity.
    Type8B,
    /// Path too short, one ramp to the nearest reachable end velocity; not in the paper.
    Type8C,
}

impl EightType {
    /// The type of a shape by what it reaches.
    #[must_use]
    pub fn of(cruises: bool, accelerating_reaches: bool, decelerating_reaches: bool) -> Self {
        match (cruises, accelerating_reaches, decelerating_reaches) {
            (true, true, true) => Self::Type1,
            (true, true, false) => Self::Type2,
            (true, false, true) => Self::Type3,
            (true, false, false) => Self::Type4,
            (false, true, true) => Self::Type5,
            (false, true, false) => Self::Type6,
            (false, false, true) => Self::Type7,
            (false, false, false) => Self::Type8A,
        }
    }

    /// The name in the paper: `1` … `7`, `8A`, `8B`, and `8C`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Type1 => "1",
            Self::Type2 => "2",
            Self::Type3 => "3",
            Self::Type4 => "4",
            Self::Type5 => "5",
            Self::Type6 => "6",
            Self::Type7 => "7",
            Self::Type8A => "8A",
            Self::Type8B => "8B",
            Self::Type8C => "8C",
        }
    }

    /// The type called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        use EightType::*;
        [Type1, Type2, Type3, Type4, Type5, Type6, Type7, Type8A, Type8B, Type8C]
            .into_iter()
            .find(|kind| kind.name() == name)
    }
}

/// The eight shapes of Li and Chen's asymmetric S-curve from rest to rest: what the acceleration reaches, and what the
/// deceleration, each with a limit of its own.
///
/// ```text
///             constant acceleration:  both  acceleration  deceleration  neither
///  cruise                              1         6             7           8
///  peak below the velocity limit       2         4             5           3
/// ```
/// The paper's figure of types 6 to 8 is known from its text alone; their order is that of 4, 5 and 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum AsymmetricType {
    /// Cruise, constant acceleration and constant deceleration.
    Type1,
    /// No cruise, constant acceleration and constant deceleration.
    Type2,
    /// No cruise, nothing constant.
    Type3,
    /// No cruise, constant acceleration only.
    Type4,
    /// No cruise, constant deceleration only.
    Type5,
    /// Cruise, constant acceleration only.
    Type6,
    /// Cruise, constant deceleration only.
    Type7,
    /// Cruise, neither.
    Type8,
}

impl AsymmetricType {
    /// Every type.
    pub const ALL: [Self; 8] = [
        Self::Type1,
        Self::Type2,
        Self::Type3,
        Self::Type4,
        Self::Type5,
        Self::Type6,
        Self::Type7,
        Self::Type8,
    ];

    /// The type of a shape by what it holds for a while.
    #[must_use]
    pub fn of(cruises: bool, constant_acceleration: bool, constant_deceleration: bool) -> Self {
        match (cruises, constant_acceleration, constant_deceleration) {
            (true, true, true) => Self::Type1,
            (false, true, true) => Self::Type2,
            (false, false, false) => Self::Type3,
            (false, true, false) => Self::Type4,
            (false, false, true) => Self::Type5,
            (true, true, false) => Self::Type6,
            (true, false, true) => Self::Type7,
            (true, false, false) => Self::Type8,
        }
    }

    /// The name in the paper: `1` … `8`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Type1 => "1",
            Self::Type2 => "2",
            Self::Type3 => "3",
            Self::Type4 => "4",
            Self::Type5 => "5",
            Self::Type6 => "6",
            Self::Type7 => "7",
            Self::Type8 => "8",
        }
    }

    /// The type called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }
}

/// The six cases of Blejan and Blejan's generator from rest to rest, equal limits: told apart by `v_a = a²/j`, the
/// least speed that takes the whole acceleration, `s_a = 2a³/j²`, the least path that does, and `s_v`, the least path
/// that takes the whole speed.
///
/// ```text
///             v ≤ v_a, s ≤ s_a   v ≤ v_a, s > s_a   v > v_a, s ≤ s_a   v > v_a, s > s_a
///  s ≥ s_v          C.1                 A                   –                D.1
///  s < s_v          C.2                 –                   B                D.2
/// ```
/// The paper leaves equalities open; here `v = v_a` and `s = s_a` do not take the whole acceleration, and `s = s_v` takes
/// the whole speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SixCase {
    /// The velocity is reached and the acceleration is not, on a path that would be long enough for it.
    A,
    /// Neither is reached, at a velocity limit that is high enough for the acceleration.
    B,
    /// The velocity is reached and the acceleration is not, on a path too short for it.
    C1,
    /// Neither is reached, at a velocity limit that is too low for the acceleration.
    C2,
    /// Both are reached.
    D1,
    /// The acceleration is reached and the velocity is not.
    D2,
}

impl SixCase {
    /// Every case.
    pub const ALL: [Self; 6] = [Self::A, Self::B, Self::C1, Self::C2, Self::D1, Self::D2];

    /// The case of a move by what its limits and its path would suffice for.
    #[must_use]
    pub fn of(
        path_takes_velocity: bool,
        path_takes_acceleration: bool,
        speed_takes_acceleration: bool,
    ) -> Self {
        match (path_takes_velocity, path_takes_acceleration, speed_takes_acceleration) {
            (true, _, true) => Self::D1,
            (true, true, false) => Self::A,
            (true, false, false) => Self::C1,
            // A path that takes the acceleration and not the velocity has a velocity that takes the acceleration.
            (false, true, _) => Self::D2,
            (false, false, true) => Self::B,
            (false, false, false) => Self::C2,
        }
    }

    /// The case of a move over `distance` within the limits of velocity, acceleration and jerk, all > 0, of which its solver
    /// knows whether the path takes the velocity: `s > 2a³/j²` and `v > a²/j`, multiplied out, since a quotient would round at the very
    /// numbers that people type.
    pub(crate) fn of_move(path_takes_velocity: bool, distance: f64, [v, a, j]: [f64; 3]) -> Self {
        let square = a * a;
        Self::of(path_takes_velocity, distance * j * j > 2.0 * square * a, v * j > square)
    }

    /// The name in the paper: `A`, `B`, `C.1`, `C.2`, `D.1`, `D.2`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
            Self::C1 => "C.1",
            Self::C2 => "C.2",
            Self::D1 => "D.1",
            Self::D2 => "D.2",
        }
    }

    /// The case called `name`.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|case| case.name() == name)
    }
}

impl core::fmt::Display for SixCase {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(self.name())
    }
}

/// The names of a shape in the papers that the planner comes from; `None` where the paper does not cover the move. A polynomial of order 3 has
/// those of the S-curve with the smaller limit of acceleration and deceleration for both, which it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Classification {
    /// Start and end velocities, equal limits for speeding up and slowing down: Bui, Le and Doan (2021).
    pub eight_type: Option<EightType>,
    /// Rest to rest, any limits: Li and Chen.
    pub asymmetric_type: Option<AsymmetricType>,
    /// Rest to rest, equal limits: Blejan and Blejan. Of cosine jerk, the case of the S-curve with half its jerk, whose
    /// times it has.
    pub six_case: Option<SixCase>,
    /// The largest speed reached [axis units/s], a magnitude.
    pub feed_rate: f64,
}

impl Classification {
    /// The greatest speed alone, for what no paper names.
    #[must_use]
    pub fn of_speed(feed_rate: f64) -> Self {
        Self { feed_rate, ..Self::default() }
    }
}
