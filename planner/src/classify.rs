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

/// The names of a shape in the papers that the planner comes from; `None` where the paper does not cover the move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Classification {
    /// Start and end velocities: Bui, Le and Doan (2021).
    pub eight_type: Option<EightType>,
    /// The largest speed reached [axis units/s], a magnitude.
    pub feed_rate: f64,
}
